"""A wall file of one's own, as data, made of one that ships: `python3 -m damage new-wall FILE`."""

import json
import re

from damage.checks import check_path
from damage.errors import InputError, did_you_mean
from damage.fields import short
from damage.files import write_text
from damage.wall.file import load_wall, shipped_walls


def new_wall(path, source="symmetric"):
    """Write a wall file that makes the wall `source`, one that ships, under the file's name; return
    its path, which ends in .toml.

    Raises InputError where the file exists, and for an unknown source.
    """
    path = check_path(path)
    named = shipped_walls()
    if source not in named:
        raise InputError(
            f"--from {source}: expected a wall that ships: {', '.join(named)}"
            f"{did_you_mean(source, named)}"
        )
    path = path if path.suffix else path.with_suffix(".toml")
    if path.suffix != ".toml":
        raise InputError(f"{path}: expected a name that ends in .toml; give it one")
    if path.exists():
        raise InputError(
            f"{path} exists: expected the name of a new file; give another, or delete it"
        )
    name = re.sub(r"[^\w-]", "-", path.stem)  # in files and tables
    head = _SCHEMA + _HEAD.format(path=path, source=source)
    return write_text(path, head + _text_of(named[source], name))


def _text_of(shipped, name):
    """Return the TOML of a shipped wall under another name: its text, or its records if it is
    Python."""
    if shipped.suffix == ".toml":
        text = shipped.read_text(encoding="utf-8").removeprefix(_SCHEMA)
        return text.replace(f'name = "{shipped.stem}"', f"name = {_value(name)}", 1)
    wall = load_wall(shipped)
    return as_toml(wall.as_dict() | {"name": name, "lintel": wall.lintel.as_dict()})


def as_toml(table):
    """A table of `damage.Wall.as_dict` as TOML, which `damage.wall.file` reads; without what is
    None."""
    single = {}
    records = []
    for key, value in table.items():
        if isinstance(value, dict):
            records.append((f"[{key}]", value))
        elif isinstance(value, list | tuple) and value and isinstance(value[0], dict):
            records += [(f"[[{key}]]", row) for row in value]
        elif value != ():
            single[key] = value
    parts = [_pairs(single), *([head, *_pairs(row)] for head, row in records)]
    return "\n\n".join(map("\n".join, parts)) + "\n"


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


_SCHEMA = "#:schema ./wall.schema.json\n"
_HEAD = """# A copy of the wall {source}: change its numbers.  Units: m, kg, Pa, radians.
#
#     python3 -m damage draw {path}                            look at it, before anything shakes it
#     python3 -m damage reference {path} --harmonic 0.2 0.05   a harmonic motion, 0.2 s, 0.05 g
#     python3 -m damage wall-schema > wall.schema.json         beside this file: editors check keys

"""
