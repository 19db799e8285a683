"""How functions are compiled, and how numba's cache knows them again.

Arithmetic is IEEE's, each operation rounded by itself and in the order that is written: so a function gives the same
bits in a vector of lanes as alone.

numba compares a function's own file with what it has cached, but not the files of the functions and constants that are
compiled into it.  So each package states its sources, and their digest is part of each function's qualified name, and
with it of the names of its cached files: machine code of other sources is never found, whatever the files' times are.
"""

import hashlib
from contextlib import suppress
from pathlib import Path

from numba import njit
from numba.core import event

from damage.history import schema
from damage.mechanics.cache import kept_in
from damage.wall import joint_law

COMPILING = "compiling the solver (once for each version on each machine, about half a minute of processor time) ..."
PACKAGES = []
"""All of this process."""


class Package:
    """A folder of functions that are compiled.

    sources: all whose code or constants are compiled into them; digest: of these; compiled, inlined: decorators.
    """

    def __init__(self, folder, names, others):
        """names: of its modules; others: sources of other folders."""
        self.folder, self.sources = folder, [*(folder / f"{name}.py" for name in names), *others]
        self.digest = hashlib.sha256(b"\0".join(path.read_bytes() for path in self.sources)).hexdigest()[:12]
        self.compiled = self._compiler()
        self.inlined = self._compiler(forceinline=True)  # put into their callers: a call would hand on some forty words
        PACKAGES.append(self)

    def is_cached(self, function):
        """Whether numba has cached "module.function" as these sources have it, as far as its files' names say."""
        folder = kept_in(self.folder)
        return folder is not None and any(folder.glob(f"{function}-{self.digest}-*.nbi"))

    def delete_other_versions(self):
        """Delete what numba has cached of this folder's files as other sources had them: nothing else would."""
        folder = kept_in(self.folder)
        patterns = [f"{source.stem}.*.nb[ic]" for source in self.sources] + ["speed-*.json"]
        for kept in [path for pattern in patterns for path in folder.glob(pattern)] if folder else []:
            if not any(package.digest in kept.name for package in PACKAGES):  # they may share a folder
                with suppress(OSError):  # another process is at the same work, or the folder cannot be written
                    kept.unlink()

    def _compiler(self, **options):
        """A decorator that compiles a function, its machine code cached under the digest of all sources."""
        # The functions make no arrays: without numba's counting of references to those that they are given, which
        # would cost more than a contact does.
        compiler = njit(cache=True, error_model="numpy", nogil=True, _nrt=False, **options)

        def decorate(function):
            function.__qualname__ = f"{function.__qualname__}-{self.digest}"
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
            for package in PACKAGES:
                package.delete_other_versions()
            print(COMPILING, flush=True)

    def on_end(self, event):
        """Nothing: the run's own lines follow."""


event.register("numba:compile", _Announcement())
PLAIN = Package(Path(__file__).parent, (
    "compiled", "eight", "by_name", "tables", "bodies", "interfaces", "rows", "contacts", "loose", "samples", "step"),
    [Path(joint_law.__file__), Path(schema.__file__)])
compiled, inlined = PLAIN.compiled, PLAIN.inlined
