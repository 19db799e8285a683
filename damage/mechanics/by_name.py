"""Compiled functions that copy a NamedTuple from and to a table's row by the names of its fields.

A new field of the NamedTuple needs no change here.
"""

from numba.extending import register_jitable


def reader(kind, prefix=""):
    """A function (row) that returns a table's row as NamedTuple `kind`; compiled with its caller.

    prefix: of the names of the table's fields.
    """
    values = ", ".join(_as(kind, name, f"row.{prefix}{name}") for name in kind._fields)
    return _function("read", "row", f"return kind({values})", kind)


def writer(kind, prefix=""):
    """A function (row, record) that writes a NamedTuple `kind` into a table's row; arguments as of `reader`."""
    return _function("write", "row, record", "; ".join(f"row.{prefix}{name} = record.{name}" for name in kind._fields),
                     kind)


def _as(kind, name, value):
    """Source text of a table's number in the type of the field: bool or float."""
    return f"{value} > 0.0" if kind.__annotations__[name] is bool else value


def _function(name, arguments, body, kind):
    made = {"kind": kind}
    exec(f"def {name}({arguments}):\n    {body}", made)
    return register_jitable(made[name])
