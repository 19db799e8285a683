"""How the reference solver's functions are compiled, and how numba's cache knows them again.

Arithmetic is IEEE's, each operation rounded by itself and in the order that is written: so a function gives the same
bits in a vector of lanes as alone.

numba compares a function's own file with what it has cached, but not the files of the functions and constants that are
compiled into it.  So the digest of all these sources is part of each function's qualified name, and with it of the
names of its cached files: machine code of other sources is never found, whatever the files' times are.
"""

import hashlib
from contextlib import suppress
from pathlib import Path

from numba import njit
from numba.core import event

from damage.history import schema
from damage.mechanics.cache import kept_in
from damage.wall import joint_law

_HERE = Path(__file__).parent
FAST = _HERE.parent / "reference" / "fast"
SOURCES = [*(_HERE / f"{name}.py" for name in (
    "compiled", "eight", "by_name", "tables", "bodies", "interfaces", "contacts", "samples", "step")),
    *(FAST / f"{name}.py" for name in ("blocks", "rows", "bodies", "interfaces", "contacts", "step")),
    Path(joint_law.__file__), Path(schema.__file__)]
"""All whose code or constants are compiled."""
DIGEST = hashlib.sha256(b"\0".join(path.read_bytes() for path in SOURCES)).hexdigest()[:12]


COMPILING = "compiling the solver (once for each version on each machine, about a minute of processor time) ..."


def is_cached():
    """Whether numba has cached the solver as these sources have it, as far as its files' names say."""
    folder = kept_in(FAST)
    return folder is not None and any(folder.glob(f"step.run-{DIGEST}-*.nbi"))


def _delete_other_versions():
    """Delete what numba has cached of these folders' files as other sources had them: nothing else would."""
    patterns = [f"{source.stem}.*.nb[ic]" for source in SOURCES] + ["speed-*.json"]
    folders = filter(None, map(kept_in, (_HERE, FAST)))
    for kept in [path for folder in folders for pattern in patterns for path in folder.glob(pattern)]:
        if DIGEST not in kept.name:
            with suppress(OSError):  # another process is at the same work, or the folder cannot be written
                kept.unlink()


def _compiler(**options):
    """A decorator that compiles a function, its machine code cached under the digest of all sources."""
    # The functions make no arrays: without numba's counting of references to those that they are given, which would
    # cost more than a contact does.
    compiler = njit(cache=True, error_model="numpy", nogil=True, _nrt=False, **options)

    def decorate(function):
        function.__qualname__ = f"{function.__qualname__}-{DIGEST}"
        return compiler(function)

    return decorate


class _Announcement(event.Listener):
    """Prints a line when a function of this package is compiled, the first time in a process: of what is cached numba
    tells nothing."""

    printed = False

    def on_start(self, event):
        function = getattr(event.data["dispatcher"], "py_func", None)
        if not self.printed and (getattr(function, "__module__", None) or "").startswith("damage."):
            self.printed = True
            _delete_other_versions()
            print(COMPILING, flush=True)

    def on_end(self, event):
        """Nothing: the run's own lines follow."""


event.register("numba:compile", _Announcement())
compiled = _compiler()
inlined = _compiler(forceinline=True)  # put into their callers: a call would hand on some forty words
