"""Compilation of functions by numba, and the cache of its machine code.

Arithmetic follows IEEE 754: each operation is rounded by itself, in the order of the source.  A
function therefore gives the same bits in each SIMD lane as for a single value.

numba compares the file of a function with its cache, but not the files of the functions and
constants that are inlined into it.  Their digest is therefore part of the qualified name of each
function, and so of the names of its cached files: machine code of other sources is never loaded,
whatever the times of the files are.  It also takes the place of these times, so that the same
sources are not compiled again where a file was written anew.
"""

import atexit
import fcntl
import hashlib
import shutil
import sys
import tempfile
import time
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from threading import Event, Thread

import numba
from numba import njit, types
from numba.core import event
from numba.core.compiler_lock import global_compiler_lock
from numba.core.registry import CPUDispatcher

COMPILING = (
    "compiling the solver (once for each kind of run and version, about half a minute of processor"
    " time) ..."
)
LIFE_S = 5.0
"""Between two lines while a function is compiled [s]."""
SOURCES = [
    (Path(__file__).parent / f"{name}.py").resolve()
    for name in (
        "compiled",
        "simd",
        "tables",
        "bodies",
        "scaling",
        "interfaces",
        "rows",
        "contacts",
        "bonds",
        "samples",
        "strain_modes",
        "damping",
        "devices",
        "step",
        "../elementary",
        "../rounded",
        "../law/joint_law",
        "../law/states",
        "../wall/kinds",
        "../wall/split",
        "../wall/tables",
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
    for file in folder.iterdir() if folder else []:
        if file.suffix in (".nbi", ".nbc", ".lock") and DIGEST not in file.name:
            with suppress(OSError):  # another process deletes it, too, or the folder is read-only
                file.unlink()


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
        with suppress(AttributeError):  # where numba is switched off: nothing is cached
            made._cache._cache_file._source_stamp = DIGEST
        if isinstance(made, CPUDispatcher):  # not where numba is switched off
            made.__class__ = _Entry if is_entry else _Internal
        return made

    return decorate


class _Entry(CPUDispatcher):
    """A function that Python calls: processes that begin together compile it once."""

    def compile(self, sig):
        name = hashlib.sha256(f"{self.py_func.__qualname__}{sig}".encode()).hexdigest()[:12]
        # numba's own lock first: threads of a process take both in the same order
        with global_compiler_lock, alone(f"{DIGEST}-{name}.lock"):
            return super().compile(sig)


@contextmanager
def alone(name):
    """Wait until no other process holds the lock of this name beside numba's cache, which has the
    machine code by then; without a folder that can be written to, go on."""
    with ExitStack() as stack:
        with suppress(OSError):
            folder = kept_in()
            folder.mkdir(parents=True, exist_ok=True)
            file = stack.enter_context((folder / name).open("w"))
            fcntl.flock(file, fcntl.LOCK_EX)
        yield


class _Internal(CPUDispatcher):
    """A function without the code by which Python would call it: numba would call address zero."""

    def compile(self, sig):
        """Compile once for all values of a type: LLVM specializes what is inlined."""
        return super().compile(tuple(map(types.unliteral, sig)))

    def __call__(self, *arguments):
        raise TypeError(
            f"{self.py_func.__name__} is for compiled callers: expected one that is declared an"
            " entry"
        )


class _Announcement(event.Listener):
    """Prints a line when a function of this project is compiled for the first time in a process,
    and others while that lasts; numba reports nothing of functions that it loads from its cache."""

    def __init__(self):
        self.began = None
        self.depth = 0
        self.ended = Event()
        self.ended.set()

    def on_start(self, event):
        if not _is_ours(event):
            return
        if self.began is None:
            self.began = time.monotonic()
            delete_other_versions()
            print(COMPILING, flush=True)
        self.depth += 1
        if self.depth == 1:
            self.ended.clear()
            self.thread = Thread(target=self.show_life, daemon=True)
            self.thread.start()

    def on_end(self, event):
        self.depth -= _is_ours(event)
        if self.depth == 0 and not self.ended.is_set():
            self.ended.set()
            self.thread.join()  # processes are forked from this one

    def show_life(self):
        while not self.ended.wait(LIFE_S):
            print(f"compiling for {time.monotonic() - self.began:.0f} s ...", flush=True)


def _is_ours(event):
    """Whether an event of numba is about a function of this project."""
    function = getattr(event.data["dispatcher"], "py_func", None)
    return (getattr(function, "__module__", None) or "").startswith("damage.")


event.register("numba:compile", _Announcement())
compiled = _compiler()
"""Decorator of a function with machine code of its own."""
inlined = _compiler(inline=True)
"""Decorator of a function that is compiled into its callers."""
entry = _compiler(is_entry=True)
"""Decorator of a function with machine code of its own that Python calls."""
