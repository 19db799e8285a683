"""Checks of input, each in one place: what came, what was expected, how to mend it; and records made from tables."""

from dataclasses import fields

from damage.errors import InputError


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
