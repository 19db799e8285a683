"""Load a wall file: a Python file with a function `wall()` that returns a `damage.Wall`, or TOML
(`damage.wall.data`)."""

import re
import runpy
import traceback
from dataclasses import fields
from difflib import get_close_matches
from pathlib import Path

from damage.checks import check_path
from damage.errors import InputError, did_you_mean
from damage.files import shipped_files
from damage.wall.data import read_wall
from damage.wall.floors import Floor
from damage.wall.lintels import Lintel
from damage.wall.parameters import Brick, Joint, Opening, Wall

_RECORDS = Wall, Opening, Floor, Lintel, Brick, Joint


def shipped_walls():
    """{name: path} of the walls that ship, in Python and as data."""
    return shipped_files("walls", ".py") | shipped_files("walls", ".toml")


def wall_path(word):
    """Path of a wall file, given by its path or by the name of a wall that ships, like symmetric; a file of that name
    comes first.  Raises InputError where there is neither."""
    path, named = check_path(word), shipped_walls()
    if path.is_file():
        return path
    if str(path) in named:
        return named[str(path)]
    meant = did_you_mean(path.stem, named) or did_you_mean(path, map(str, path.parent.glob("*.py")))
    raise InputError(f"{path}: no such wall file; expected the path of one, or the name of a wall that ships: "
                     f"{', '.join(named)}{meant}")


def load_wall(path):
    """The wall of a file, by its path or the name of a wall that ships; InputError where the file is missing or makes
    no wall."""
    path = wall_path(path)
    if path.suffix.lower() == ".toml":
        return wall_of(lambda: read_wall(path), path)

    def make():
        make_wall = runpy.run_path(str(path), run_name="wall_file").get("wall")
        return make_wall() if callable(make_wall) else None

    return wall_of(make, path)


def wall_of(make_wall, path):
    """The wall that `make_wall()` returns, a function of the file at `path`; InputError, with the line, where it fails
    or returns none."""
    try:
        wall = make_wall()
    except (Exception, SystemExit) as error:
        message = str(error) if isinstance(error, InputError) else f"failed with {_message_of(error)}; correct the file"
        where = "" if message.startswith(str(path)) else f"{path}{_line(error, path)}: "
        raise InputError(f"{where}{message}") from error
    if not isinstance(wall, Wall):
        raise InputError(f"{path} has no function wall() that returns a damage.Wall; start from the copy that the "
                         "command new-wall writes")
    return wall


def _message_of(error):
    """Message of an error in a wall file; for an unknown keyword also the known ones."""
    message = f"{type(error).__name__}: {error.msg if isinstance(error, SyntaxError) else error}"
    found = re.search(r"(\w+)\.__init__\(\) got an unexpected keyword argument '(\w+)'", message)
    kind = found and next((one for one in _RECORDS if one.__name__ == found[1]), None)
    if not kind:
        return message
    names = [one.name for one in fields(kind)]
    near = get_close_matches(found[2], names, n=1)
    return (f"{kind.__name__}({found[2]}=...): expected " + (f"{near[0]}; it has " if near else "one of ")
            + ", ".join(names))


def _line(error, path):
    """The line of the file in which an error came up, " line 7", or nothing where it is not known."""
    if isinstance(error, SyntaxError):
        line = error.lineno
    else:
        lines = [frame.lineno for frame in traceback.extract_tb(error.__traceback__)
                 if Path(frame.filename).name == path.name]
        line = lines[-1] if lines else None
    return f" line {line}" if line else ""
