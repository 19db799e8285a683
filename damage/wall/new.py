"""A wall file of one's own, in Python or as data, made of one that ships: `python3 -m damage
new-wall FILE`."""

import ast
import json
import re

from damage.checks import check_path
from damage.errors import InputError, did_you_mean
from damage.fields import short
from damage.files import write_text
from damage.wall.file import load_wall, shipped_walls

_OF_YADE = {"sys", "pathlib"}
"""Modules that the shipped files import only so that YADE finds the repository."""


def new_wall(path, source="symmetric"):
    """Write a wall file that makes the wall `source`, one that ships, under the file's name;
    returns its path.

    path: of the new file; its ending says whether it is Python or data (.toml), without one that of
    the source does. Raises InputError where it exists, for an unknown source, and for one of data
    that is to be Python.
    """
    path = check_path(path)
    named = shipped_walls()
    if source not in named:
        raise InputError(
            f"--from {source}: expected a wall that ships: {', '.join(named)}"
            f"{did_you_mean(source, named)}"
        )
    ending = named[source].suffix
    path = path if path.suffix else path.with_suffix(ending)
    if path.suffix not in {ending, ".toml"}:
        raise InputError(
            f"{path}: expected a name that ends in .toml{' or .py' * (ending == '.py')}; give"
            " it one"
        )
    if path.exists():
        raise InputError(
            f"{path} exists: expected the name of a new file; give another, or delete it"
        )
    name = re.sub(r"[^\w-]", "-", path.stem)  # in files and tables
    return write_text(path, (_python if path.suffix == ".py" else _data)(named[source], path, name))


def _data(shipped, path, name):
    """The text of a new file as data: that of a shipped one but for its name, or the records of one
    in Python."""
    if shipped.suffix == ".toml":
        text = shipped.read_text(encoding="utf-8").removeprefix(_SCHEMA)
        text = text.replace(f'name = "{shipped.stem}"', f"name = {_value(name)}", 1)
    else:
        wall = load_wall(shipped)
        text = as_toml(wall.as_dict() | {"name": name, "lintel": wall.lintel.as_dict()})
    return _SCHEMA + _HEAD_OF_DATA.format(path=path, source=shipped.stem) + text


def as_toml(table):
    """A table of `damage.Wall.as_dict` as TOML, which `damage.wall.file` reads; without what is
    None."""
    records = {
        key: value
        for key, value in table.items()
        if isinstance(value, dict)
        or (isinstance(value, list | tuple) and value and isinstance(value[0], dict))
    }
    single = {
        key: value
        for key, value in table.items()
        if key not in records and (value or not isinstance(value, tuple))
    }
    parts = ["\n".join(_pairs(single))]
    for key, value in records.items():
        head, rows = (f"[{key}]", [value]) if isinstance(value, dict) else (f"[[{key}]]", value)
        parts += ["\n".join([head, *_pairs(row)]) for row in rows]
    return "\n\n".join(parts) + "\n"


def _pairs(table):
    return [f"{key} = {_value(value)}" for key, value in table.items() if value is not None]


def _value(value):
    """A number, a word, a list or a table of these as TOML on one line."""
    if isinstance(value, dict):
        return f"{{ {', '.join(_pairs(value))} }}"
    if isinstance(value, list | tuple):
        return f"[{', '.join(map(_value, value))}]"
    if isinstance(value, float) and float(short(value)) == value:
        return short(value)
    return json.dumps(value, ensure_ascii=False)


def _python(path_of_shipped, path, name):
    """The text of the new file: imports, constants and functions of the shipped one, without what
    is for YADE."""
    shipped = path_of_shipped.read_text(encoding="utf-8")
    source = path_of_shipped.stem
    tree = ast.parse(shipped)
    title = ast.get_docstring(tree).splitlines()[0]
    nodes = [
        node
        for node in tree.body
        if isinstance(node, (ast.FunctionDef, ast.Assign, ast.Import, ast.ImportFrom))
        and not _OF_YADE & _imported(node)
    ]
    # and comments inside
    parts = ["\n".join(shipped.splitlines()[node.lineno - 1 : node.end_lineno]) for node in nodes]
    text = "".join(
        f"\n\n{part}\n" if isinstance(node, ast.FunctionDef) else f"{part}\n"
        for node, part in zip(nodes, parts)
    )
    head = _HEAD.format(path=path, source=source, title=title)
    return head + text.replace(f'name="{source}"', f'name="{name}"', 1)


_SCHEMA = "#:schema ./wall.schema.json\n"
_HEAD_OF_DATA = """# A copy of the wall {source}: change its numbers.  Units: m, kg, Pa, radians.
#
#     python3 -m damage draw {path}                            look at it, before anything shakes it
#     python3 -m damage reference {path} --harmonic 0.2 0.05   a harmonic motion, 0.2 s, 0.05 g
#     python3 -m damage wall-schema > wall.schema.json         beside this file: editors check keys

"""
_HEAD = '''"""A copy of the wall {source}: change its numbers.  Units: m, kg, Pa, radians.

{source}: {title}

    python3 -m damage modes {path}                              before anything shakes it
    python3 -m damage reference {path} --harmonic 0.2 0.05      a harmonic motion, 0.2 s, 0.05 g
    python3 -m damage reference {path} --record FILE            a recorded ground motion
"""

'''


def _imported(node):
    """Names of the modules that a node imports; none of another node."""
    return (
        {alias.name for alias in node.names}
        if isinstance(node, ast.Import)
        else ({node.module} if isinstance(node, ast.ImportFrom) else set())
    )
