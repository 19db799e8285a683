"""Load a wall file: a Python file with a function `wall()` that returns a `damage.Wall`."""

import runpy
import traceback
from pathlib import Path

from damage.errors import InputError
from damage.wall.parameters import Wall


def load_wall(path):
    """The wall of the file at `path`; InputError where the file is missing or makes no wall."""
    path = Path(path)
    if not path.is_file():
        raise InputError(f"{path}: no such wall file; give one like walls/symmetric.py")
    try:
        make_wall = runpy.run_path(str(path), run_name="wall_file").get("wall")
        wall = make_wall() if callable(make_wall) else None
    except InputError:
        raise
    except Exception as error:
        last = traceback.extract_tb(error.__traceback__)[-1]
        raise InputError(f"{path} failed with {type(error).__name__}: {error} (line {last.lineno} of "
                         f"{Path(last.filename).name}); mend the file") from error
    if not isinstance(wall, Wall):
        raise InputError(f"{path} has no function wall() that returns a damage.Wall; copy walls/symmetric.py")
    return wall
