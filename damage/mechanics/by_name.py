"""Compiled functions that copy a NamedTuple from and to a row of a table by the names of its fields.

A new field of the NamedTuple needs no change here.
"""

from numba.extending import register_jitable

from damage.mechanics.eight import load, store


def reader(kind, names, prefix=""):
    """A function (n, table, row) that returns a row of one wall as NamedTuple `kind`; compiled with its caller.

    names: of the table's fields; prefix: of those of the NamedTuple.
    """
    values = ", ".join(_as(kind, name, f"load(n, table, row, {names.index(prefix + name)})") for name in kind._fields)
    return _function("read", "n, table, row", f"return kind({values})", kind)


def writer(kind, names, prefix=""):
    """A function (n, table, row, record) that writes a NamedTuple `kind` into a row; arguments as of `reader`."""
    body = "; ".join(f"store(n, table, row, {names.index(prefix + name)}, record.{name})" for name in kind._fields)
    return _function("write", "n, table, row, record", body, kind)


def _as(kind, name, value):
    """Source text of a table's number in the type of the field: bool or float."""
    return f"{value} > 0.0" if kind.__annotations__[name] is bool else value


def _function(name, arguments, body, kind):
    made = {"kind": kind, "load": load, "store": store}
    exec(f"def {name}({arguments}):\n    {body}", made)
    return register_jitable(made[name])
