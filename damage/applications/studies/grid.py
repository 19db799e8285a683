"""Grids of a study: every combination of listed values becomes a run.

    [[grid]]
    wall = "walls/{wall}.py"
    options = { harmonic = ["{period}", "{amplitude}"], rest = 2 }
    vary = { wall = ["solid", "symmetric"], period = [0.06, 0.2], amplitude = [0.05, 0.1] }

"{name}" within a string is replaced by the value; a string that is nothing but "{name}" becomes the
value itself, whatever its type.  `{ from = 1, to = 25 }` stands for the whole numbers 1 to 25.

What belongs together, as a record, its window and its scales, comes by rows = "FILE.csv", a table
whose columns are names: every row goes with every combination of `vary`, which may then be missing.
"""

import itertools
import math
import re

from damage.csv_table import read_csv
from damage.errors import InputError

MOST_POINTS = 100_000
"""Runs that a grid may stand for."""

_NAME = re.compile(r"\{([A-Za-z_][A-Za-z0-9_]*)\}")


def expand(grid, rows=None):
    """Return the tables that a grid stands for: row by row, in the order of its values, the last
    named varying fastest.

    grid: a table with `vary` and any others, which are kept; rows: dictionaries of values that
    belong together, as `read_rows` returns them.  Raises InputError, which says what is wrong.
    """
    fixed = {key: value for key, value in grid.items() if key not in ("vary", "rows")}
    rows = rows or [{}]
    vary = grid.get("vary", {} if "rows" in grid else None)
    if not isinstance(vary, dict) or not (vary or "rows" in grid):
        raise InputError(
            f"vary = {vary!r}; expected a table of lists, like vary = {{ scale = [0.5, 1] }}"
        )
    lists = {name: _values(name, values) for name, values in vary.items()}
    count = len(rows) * math.prod(map(len, lists.values()))
    if count > MOST_POINTS:
        raise InputError(
            f"vary stands for {count} runs; expected up to {MOST_POINTS}; take some values out"
        )
    if twice := sorted(lists.keys() & rows[0].keys()):
        raise InputError(
            f"vary and rows both name {twice[0]!r}; expected it in one of them; take one out"
        )
    if unused := sorted({*lists, *rows[0]} - _names(fixed)):
        raise InputError(
            f"vary names {unused[0]!r}, which nothing uses; expected {{{unused[0]}}} in"
            " its wall or options; write it there or take it out"
        )
    return [
        _replaced(fixed, row | dict(zip(lists, chosen)))
        for row in rows
        for chosen in itertools.product(*lists.values())
    ]


def read_rows(path):
    """The rows of a CSV table as dictionaries, numbers as numbers; raises InputError, which says
    what is wrong."""
    table = read_csv(path, most_rows=MOST_POINTS)
    table.refuse_empty(*table.names)
    if odd := [name for name in table.names if not _NAME.fullmatch(f"{{{name}}}")]:
        raise InputError(
            f"{path} has a column {odd[0]!r}; expected names like record or scale, in its first"
            " line; correct it"
        )
    return [
        {name: _number_or_word(word) for name, word in row.items()}
        for row in table.rows.to_dict("records")
    ]


def _number_or_word(text):
    """A number where a text is one, of whole ones an int."""
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            pass
    return text


def _values(name, values):
    """The values of one name; { from, to } are whole numbers."""
    if (
        isinstance(values, dict)
        and set(values) == {"from", "to"}
        and all(type(end) is int for end in values.values())
    ):
        values = range(values["from"], min(values["to"], values["from"] + MOST_POINTS) + 1)
    if not isinstance(values, list | range) or not values:
        raise InputError(
            f"vary holds {name} = {values!r}; expected a list with values, or "
            "{ from = 1, to = 25 }; correct it"
        )
    return values


def _names(value):
    """Names in braces in all strings of a value."""
    if isinstance(value, str):
        return set(_NAME.findall(value))
    parts = value.values() if isinstance(value, dict) else value if isinstance(value, list) else ()
    return set().union(*map(_names, parts))


def _replaced(value, chosen):
    """A value of a table with the names in its strings replaced by chosen values."""
    if isinstance(value, dict):
        return {key: _replaced(part, chosen) for key, part in value.items()}
    if isinstance(value, list):
        return [_replaced(part, chosen) for part in value]
    if not isinstance(value, str):
        return value
    if unknown := sorted(_names(value) - set(chosen)):
        raise InputError(
            f"{value!r} names {unknown[0]!r}, which vary does not; expected one of "
            f"{', '.join(chosen)}; correct its spelling"
        )
    whole = _NAME.fullmatch(value)
    return chosen[whole[1]] if whole else _NAME.sub(lambda match: str(chosen[match[1]]), value)
