"""Compilation of functions by numba, and the keys of its cache.

Arithmetic follows IEEE 754: each operation is rounded by itself, in the order of the source.  A function therefore
gives the same bits in each SIMD lane as for a single value.

numba compares the file of a function with its cache, but not the files of the functions and constants that are inlined
into it.  Each Package therefore lists its sources.  Their digest is part of the qualified name of each function, and so
of the names of its cached files: machine code of other sources is never loaded, whatever the times of the files are.
"""

import hashlib
from contextlib import suppress
from pathlib import Path

from numba import njit
from numba.core import event
from numba.core.registry import CPUDispatcher

from damage.mechanics.cache import kept_in

COMPILING = "compiling the solver (once for each version on each machine, about half a minute of processor time) ..."
PACKAGES = []
"""All Packages of this process."""


class Package:
    """Compiled functions of a folder.

    sources: paths of all files whose code or constants are compiled into them; digest: of these files; compiled:
    decorator of a function with machine code of its own; inlined: of one that is compiled into its callers; entry: of
    one that Python calls, too.
    """

    def __init__(self, folder, names):
        """folder: path; names: of its modules, and of those of others from it."""
        self.folder, self.sources = folder, [(folder / f"{name}.py").resolve() for name in names]
        self.digest = hashlib.sha256(b"\0".join(path.read_bytes() for path in self.sources)).hexdigest()[:12]
        self.compiled, self.inlined = self._compiler(), self._compiler(inlined=True)
        self.entry = self._compiler(entry=True)
        PACKAGES.append(self)

    def is_cached(self, function):
        """Whether numba has cached "module.function" of these sources, judged by the names of its files."""
        folder = kept_in(self.folder)
        return folder is not None and any(folder.glob(f"{function}-{self.digest}-*.nbi"))

    def delete_other_versions(self):
        """Delete the machine code of other versions of these sources, which numba would never delete."""
        folder = kept_in(self.folder)
        patterns = [f"{source.stem}.*.nb[ic]" for source in self.sources] + ["speed-*.json"]
        for kept in [path for pattern in patterns for path in folder.glob(pattern)] if folder else []:
            if not any(package.digest in kept.name for package in PACKAGES):  # they may share a folder
                with suppress(OSError):  # another process deletes it, too, or the folder is read-only
                    kept.unlink()

    def _compiler(self, entry=False, inlined=False):
        """A decorator that compiles a function, its machine code cached under the digest of all sources.

        entry: whether Python may call it.  The code by which it would do so takes a third of the time of compilation.
        """
        # The functions create no arrays.  Counting references to their arguments would cost more than a contact point,
        # so that it is switched off (_nrt).  Inlined: a call would pass some forty words.
        compiler = njit(cache=True, error_model="numpy", nogil=True, _nrt=False, no_cfunc_wrapper=True,
                        no_cpython_wrapper=not entry, forceinline=inlined)

        def decorate(function):
            function.__qualname__ = f"{function.__qualname__}-{self.digest}"
            made = compiler(function)
            if not entry and isinstance(made, CPUDispatcher):  # not where numba is switched off
                made.__class__ = _Internal
            return made

        return decorate


class _Internal(CPUDispatcher):
    """A function without the code by which Python would call it: numba would call address zero."""

    def __call__(self, *arguments):
        raise TypeError(f"{self.py_func.__name__} is for compiled callers: expected one that is declared an entry")


class _Announcement(event.Listener):
    """Prints a line when a function of this project is compiled for the first time in a process; numba reports nothing
    of functions that it loads from its cache."""

    printed = False

    def on_start(self, event):
        function = getattr(event.data["dispatcher"], "py_func", None)
        if not self.printed and (getattr(function, "__module__", None) or "").startswith("damage."):
            self.printed = True
            for package in PACKAGES:
                package.delete_other_versions()
            print(COMPILING, flush=True)

    def on_end(self, event):
        """Print nothing."""


event.register("numba:compile", _Announcement())
KERNEL = Package(Path(__file__).parent, (
    "compiled", "eight", "by_name", "tables", "bodies", "interfaces", "rows", "contacts", "loose", "samples", "scaling",
    "strain", "step", "../law/joint_law", "../law/states", "../wall/kinds", "../wall/kinematics"))
compiled, inlined, entry = KERNEL.compiled, KERNEL.inlined, KERNEL.entry


def is_cached():
    """Whether numba has cached the step, which every run needs, of these sources."""
    return KERNEL.is_cached("step.run")
