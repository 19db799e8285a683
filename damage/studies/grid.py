"""Grids of a study: every combination of listed values becomes a run.

    [[grid]]
    wall = "walls/{wall}.py"
    options = { harmonic = ["{period}", "{amplitude}"], rest = 2 }
    vary = { wall = ["solid", "symmetric"], period = [0.06, 0.2], amplitude = [0.05, 0.1] }

"{name}" within a string is replaced by the value; a string that is nothing but "{name}" becomes the value itself,
whatever its type.  `{ from = 1, to = 25 }` stands for the whole numbers 1 to 25.
"""

import itertools
import math
import re

from damage.errors import InputError

MOST_POINTS = 100_000
"""Runs that a grid may stand for."""

_NAME = re.compile(r"\{([A-Za-z_][A-Za-z0-9_]*)\}")


def expand(grid, where):
    """The tables that a grid stands for, in the order of its values, the last named varying fastest.

    grid: a table with `vary` and any others, which are kept; raises InputError, which says what is wrong.
    """
    kept = {key: value for key, value in grid.items() if key != "vary"}
    vary = grid.get("vary")
    if not isinstance(vary, dict) or not vary:
        raise InputError(f"{where}: vary = {vary!r}; expected a table of lists, like vary = {{ scale = [0.5, 1] }}")
    lists = {name: _values(name, values, where) for name, values in vary.items()}
    count = math.prod(map(len, lists.values()))
    if count > MOST_POINTS:
        raise InputError(f"{where}: vary stands for {count} runs; expected up to {MOST_POINTS}; take some values out")
    unused = sorted(set(lists) - _names(kept))
    if unused:
        raise InputError(f"{where}: vary names {unused[0]!r}, which nothing uses; expected {{{unused[0]}}} in its "
                         "wall or options; write it there or take it out")
    return [_replaced(kept, dict(zip(lists, chosen)), where) for chosen in itertools.product(*lists.values())]


def _values(name, values, where):
    """The values of one name; { from, to } are whole numbers."""
    if isinstance(values, dict) and set(values) == {"from", "to"} and all(type(end) is int for end in values.values()):
        values = range(values["from"], min(values["to"], values["from"] + MOST_POINTS) + 1)
    if not isinstance(values, list | range) or not values:
        raise InputError(f"{where}: vary holds {name} = {values!r}; expected a list with values, or "
                         "{ from = 1, to = 25 }; mend it")
    return values


def _names(value):
    """Names in braces in all strings of a value."""
    if isinstance(value, str):
        return set(_NAME.findall(value))
    parts = value.values() if isinstance(value, dict) else value if isinstance(value, list) else ()
    return set().union(*map(_names, parts))


def _replaced(value, chosen, where):
    if isinstance(value, dict):
        return {key: _replaced(part, chosen, where) for key, part in value.items()}
    if isinstance(value, list):
        return [_replaced(part, chosen, where) for part in value]
    if not isinstance(value, str):
        return value
    unknown = sorted(_names(value) - set(chosen))
    if unknown:
        raise InputError(f"{where}: {value!r} names {unknown[0]!r}, which vary does not; expected one of "
                         f"{', '.join(chosen)}; mend its spelling")
    whole = _NAME.fullmatch(value)
    return chosen[whole[1]] if whole else _NAME.sub(lambda found: str(chosen[found[1]]), value)
