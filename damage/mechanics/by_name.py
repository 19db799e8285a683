"""Records written and read field by field, by the names of a NamedTuple: a field that it gains needs no line more."""

from numba.extending import register_jitable


def reader(kind, prefix=""):
    """A function of a table's row that returns the NamedTuple `kind` of its fields; compiled where its caller is."""
    values = ", ".join(_as(kind, name, f"row.{prefix}{name}") for name in kind._fields)
    return _function("read", "row", f"return kind({values})", kind)


def writer(kind, prefix=""):
    """A function (row, record) that writes the fields of the NamedTuple `kind` into a table's row."""
    return _function("write", "row, record", "; ".join(f"row.{prefix}{name} = record.{name}" for name in kind._fields),
                     kind)


def _as(kind, name, value):
    """A table's number as what the field holds: a flag, or itself."""
    return f"{value} > 0.0" if kind.__annotations__[name] is bool else value


def _function(name, arguments, body, kind):
    made = {"kind": kind}
    exec(f"def {name}({arguments}):\n    {body}", made)
    return register_jitable(made[name])
