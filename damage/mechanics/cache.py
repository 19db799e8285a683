"""Folder for the machine code that numba compiles, without which numba raises an error."""

import atexit
import shutil
import sys
import tempfile
from pathlib import Path

import numba


def find_a_place():
    """Give numba a temporary folder, deleted at exit, where it finds none that it can write to; prints a warning."""
    try:
        numba.njit(cache=True)(_any)
    except RuntimeError:  # neither NUMBA_CACHE_DIR, nor beside the sources, nor in the home folder
        numba.config.CACHE_DIR = tempfile.mkdtemp(prefix="masonry-damage-")
        atexit.register(shutil.rmtree, numba.config.CACHE_DIR, ignore_errors=True)
        print("warning: no folder can be written to keep compiled code in: it is compiled for this run alone; set "
              "NUMBA_CACHE_DIR to a folder that can", file=sys.stderr)


def kept_in(folder=Path(__file__).parent):
    """Path where numba caches the machine code of the source files in a folder; None where numba is switched off."""
    made = {}
    exec(compile("def function(): pass", folder / "__init__.py", "exec"), made)  # numba judges by a function's file
    cache = getattr(numba.njit(cache=True)(made["function"]), "_cache", None)
    return None if cache is None else Path(cache.cache_path)


def _any():
    """A function whose file decides where numba would cache."""
