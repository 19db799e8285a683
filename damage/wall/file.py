"""Load a wall file: a Python file with a function `wall()` that returns a `damage.Wall`."""

import runpy
import traceback
from pathlib import Path

from damage.checks import check_path
from damage.errors import InputError
from damage.wall.parameters import Wall


def load_wall(path):
    """The wall of the file at `path`; InputError where the file is missing or makes no wall."""
    path = check_path(path)
    if not path.is_file():
        raise InputError(f"{path}: no such wall file; give one like walls/symmetric.py")

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
        told = str(error) if isinstance(error, InputError) else f"failed with {_told(error)}; mend the file"
        raise InputError(f"{path}{_line(error, path)}: {told}") from error
    if not isinstance(wall, Wall):
        raise InputError(f"{path} has no function wall() that returns a damage.Wall; copy walls/symmetric.py")
    return wall


def _told(error):
    return f"{type(error).__name__}: {error.msg if isinstance(error, SyntaxError) else error}"


def _line(error, path):
    """The line of the file in which an error came up, " line 7", or nothing where it is not known."""
    if isinstance(error, SyntaxError):
        line = error.lineno
    else:
        lines = [frame.lineno for frame in traceback.extract_tb(error.__traceback__)
                 if Path(frame.filename).name == path.name]
        line = lines[-1] if lines else None
    return f" line {line}" if line else ""
