"""How the reference solver's functions are compiled, and when what numba keeps of them is too old.

Arithmetic is IEEE's, each operation rounded by itself and in the order that is written: so a function gives the same
bits in a vector of lanes as alone.
"""

from contextlib import suppress
from pathlib import Path

from numba import njit

from damage.mechanics.cache import kept_in
from damage.wall import joint_law

_HERE = Path(__file__).parent
_SOURCES = [*_HERE.glob("*.py"), *(_HERE.parent / "reference" / "fast").glob("*.py")]


def _forget_what_is_older():
    """Delete what numba has cached of these files where one of them or the joint law is newer: numba looks at each
    function's own file alone, and would go on with what it calls as it was."""
    changed, folder = max(path.stat().st_mtime for path in (*_SOURCES, Path(joint_law.__file__))), kept_in()
    kept = [index for source in _SOURCES for index in folder.glob(f"{source.stem}.*.nbi")] if folder else []
    for index in kept:
        with suppress(OSError):  # another process is at the same work, or the folder cannot be written
            if index.stat().st_mtime < changed:
                index.unlink()


_forget_what_is_older()
# They make no arrays: without numba's counting of references to those that they are given, which would cost more than
# a contact does.
compiled = njit(cache=True, error_model="numpy", nogil=True, _nrt=False)
# Put into their callers: a call would hand on some forty words.
inlined = njit(forceinline=True, cache=True, error_model="numpy", nogil=True, _nrt=False)
