"""Compilation of functions by numba, and the cache of its machine code.

Arithmetic follows IEEE 754: each operation is rounded by itself, in the order of the source.  A
function therefore gives the same bits in each SIMD lane as for a single value.

numba compares the file of a function with its cache, but not the files of the functions and
constants that are inlined into it.  Their digest is therefore part of the qualified name of each
function, and so of the names of its cached files: machine code of other sources is never loaded,
whatever the times of the files are.
"""

import atexit
import hashlib
import shutil
import sys
import tempfile
from contextlib import suppress
from pathlib import Path

import numba
from numba import njit
from numba.core import event
from numba.core.registry import CPUDispatcher

COMPILING = (
    "compiling the solver (once for each version on each machine, about half a minute of processor"
    " time) ..."
)
SOURCES = [
    (Path(__file__).parent / f"{name}.py").resolve()
    for name in (
        "compiled",
        "eight",
        "tables",
        "bodies",
        "scaling",
        "interfaces",
        "rows",
        "contacts",
        "collisions",
        "samples",
        "step",
        "../elementary",
        "../rounded",
        "../law/joint_law",
        "../law/states",
        "../wall/kinds",
        "../wall/kinematics",
        "../wall/split",
    )
]
"""All files whose code or constants are compiled."""
DIGEST = hashlib.sha256(b"\0".join(path.read_bytes() for path in SOURCES)).hexdigest()[:12]


def find_a_place():
    """Give numba a temporary folder, deleted at exit, where it finds none that it can write to;
    prints a warning."""
    try:
        njit(cache=True)(_any)
    except RuntimeError:  # neither NUMBA_CACHE_DIR, nor beside the sources, nor in the home folder
        numba.config.CACHE_DIR = tempfile.mkdtemp(prefix="masonry-damage-")
        atexit.register(shutil.rmtree, numba.config.CACHE_DIR, ignore_errors=True)
        print(
            "warning: no folder can be written to keep compiled code in: it is compiled for this"
            " run alone; set NUMBA_CACHE_DIR to a folder that can",
            file=sys.stderr,
        )


def kept_in():
    """Path where numba caches the machine code of this folder; None where numba is switched off."""
    cache = getattr(njit(cache=True)(_any), "_cache", None)
    return None if cache is None else Path(cache.cache_path)


def _any():
    """A function whose file decides where numba would cache."""


def is_cached():
    """Whether numba has cached the step, which every run needs, of these sources, judged by the
    names of its files."""
    folder = kept_in()
    return folder is not None and any(folder.glob(f"step.advance-{DIGEST}-*.nbi"))


def delete_other_versions():
    """Delete the machine code of other versions of these sources, which numba would never
    delete."""
    folder = kept_in()
    for kept in folder.glob("*.nb[ic]") if folder else []:
        if DIGEST not in kept.name:
            with suppress(OSError):  # another process deletes it, too, or the folder is read-only
                kept.unlink()


def _compiler(is_entry=False, inline=False):
    """A decorator that compiles a function, its machine code cached under the digest of all
    sources.

    is_entry: whether Python may call it.  The code by which it would do so takes a third of the
    time of compilation.
    """
    # The functions create no arrays.  Counting references to their arguments would cost more than a
    # contact point, so that it is switched off (_nrt).  Inlined: a call would pass some forty
    # words.
    compiler = njit(
        cache=True,
        error_model="numpy",
        nogil=True,
        _nrt=False,
        no_cfunc_wrapper=True,
        no_cpython_wrapper=not is_entry,
        forceinline=inline,
    )

    def decorate(function):
        function.__qualname__ = f"{function.__qualname__}-{DIGEST}"
        made = compiler(function)
        if not is_entry and isinstance(made, CPUDispatcher):  # not where numba is switched off
            made.__class__ = _Internal
        return made

    return decorate


class _Internal(CPUDispatcher):
    """A function without the code by which Python would call it: numba would call address zero."""

    def __call__(self, *arguments):
        raise TypeError(
            f"{self.py_func.__name__} is for compiled callers: expected one that is declared an"
            " entry"
        )


class _Announcement(event.Listener):
    """Prints a line when a function of this project is compiled for the first time in a process;
    numba reports nothing of functions that it loads from its cache."""

    printed = False

    def on_start(self, event):
        function = getattr(event.data["dispatcher"], "py_func", None)
        if not self.printed and (getattr(function, "__module__", None) or "").startswith("damage."):
            self.printed = True
            delete_other_versions()
            print(COMPILING, flush=True)

    def on_end(self, event):
        """Print nothing."""


event.register("numba:compile", _Announcement())
compiled, inlined, entry = _compiler(), _compiler(inline=True), _compiler(is_entry=True)
"""Decorators of a function with machine code of its own, of one that is compiled into its callers,
of one that Python calls, too."""
