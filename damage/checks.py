"""Checks of input, each in one place: what came, what was expected, how to mend it; and records made from tables."""

import math
from dataclasses import fields
from numbers import Integral, Real

from damage.errors import InputError


def check_number(what, value, wanted="a finite number", fits=lambda value: True):
    """Raise InputError unless `value` is a finite number that `fits`; what: its name; wanted: what fits, in words."""
    if isinstance(value, bool) or not isinstance(value, Real) or not math.isfinite(value) or not fits(value):
        raise InputError(f"{what} = {value!r}: expected {wanted}; mend it")


def check_positive(what, value):
    """Raise InputError unless `value` is finite and above zero."""
    check_number(what, value, "a positive number", lambda value: value > 0)


def check_not_negative(what, value):
    """Raise InputError unless `value` is finite and zero or above."""
    check_number(what, value, "a zero or positive number", lambda value: value >= 0)


def check_whole(what, value, least=0, most=math.inf):
    """Raise InputError unless `value` is a whole number within bounds."""
    if not isinstance(value, Integral) or isinstance(value, bool) or not least <= value <= most:
        upper = "or more" if most == math.inf else f"to {most}"
        raise InputError(f"{what} = {value!r}: expected a whole number, {least} {upper}; mend it")


def check_fields(record, positive=(), not_negative=()):
    """Raise InputError unless the named fields of a record are finite and of the right sign."""
    for check, names in ((check_positive, positive), (check_not_negative, not_negative)):
        for name in names:
            check(f"{type(record).__name__}.{name}", getattr(record, name))


def check_choice(what, value, choices):
    """Raise InputError unless `value` is one of `choices`."""
    if value not in choices:
        raise InputError(f"{what} = {value!r}: expected one of {', '.join(choices)}; choose one of them")


def record_from(kind, table, derived=()):
    """The frozen record `kind` of a table {field: value} from a file; fields that an older file lacks take defaults.

    derived: keys that tell what follows from the others, and are no fields.  Raises InputError for any other that is
    no field: a choice of a later version, of which this one cannot tell what it means.
    """
    names = [field.name for field in fields(kind)]
    unknown = sorted(set(table) - {*names, *derived})
    if unknown:
        raise InputError(f"{kind.__name__} with {unknown[0]} = {table[unknown[0]]!r}: expected no other than "
                         f"{', '.join(names)}; a later version wrote it, update the software")
    values = {name: tuple(table[name]) if isinstance(table[name], list) else table[name]
              for name in names if name in table}
    try:
        return kind(**values)
    except TypeError as error:
        raise InputError(f"{kind.__name__} of {table!r}: {error}; expected a table that a run wrote") from error
