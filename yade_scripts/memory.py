"""Numbers of many contacts at once, from the memory in which YADE has them.

The work of friction needs seven numbers of every failed contact at every step.  YADE has no call
that returns those of all, and Debian none of its headers, to compile one.  Asked one by one they
take 0.6 us a contact even where YADE's own vectors compute with each other, as long as the step
itself; joined from memory 0.15 us, and the rest of a house's trackers 0.2 in place of 0.5 us.

What YADE returns by reference is an object of Boost.Python that holds its address; the depth of a
contact lies before its shear displacement.  No address is followed unless the system, which refuses
those that are not of this process, has read Python's numbers there: when this module is loaded, of
numbers that were set, and again of every contact.  A view has the bounds of its numbers, and its
contact lives on with it.  Where a build of YADE has other places, YADE is asked one by one.
"""

import ctypes
import os
from types import SimpleNamespace

import numpy as np
from yade import FrictPhys, ScGeom

_WORD = 8
_KIND, _PLACE = 6, 8  # words of an object of Boost.Python: what it holds, and where that is


def _words(held):
    return (ctypes.c_uint64 * (held.__sizeof__() // _WORD)).from_address(id(held))


def _there(address, expected):
    """Whether these numbers are at an address; read by the system, which refuses any that is not of
    this process."""
    expected = np.array(expected, float).tobytes()
    try:
        file = os.open("/proc/self/mem", os.O_RDONLY)
        try:
            return os.pread(file, len(expected), address) == expected
        finally:
            os.close(file)
    except (OSError, OverflowError):
        return False


def _place(vector, before=()):
    """A view of a vector that YADE returned by reference, and of the numbers before it, or None
    where they are elsewhere."""
    words, expected = _words(vector), [*before, *vector]
    if len(words) <= _PLACE or words[_KIND] != _HELD:
        return None
    address = words[_PLACE] - _WORD * len(before)
    if address % _WORD or not _there(address, expected):
        return None
    return (ctypes.c_double * len(expected)).from_address(address)


def _held():
    """What the objects hold that point to a contact's vectors, None of another build of YADE."""
    kinds = []
    for of in (ScGeom().shearInc, FrictPhys().shearForce):
        of[0], of[1], of[2] = 0.1, 0.7, 0.9
        words = _words(of)
        if len(words) <= _PLACE or not _there(words[_PLACE], [0.1, 0.7, 0.9]):
            return None
        kinds.append(words[_KIND])
    return kinds[0] if kinds[0] == kinds[1] else None


_HELD = _held()


class ContactNumbers:
    """Of contacts, each in a row below n."""

    def __init__(self, n):
        self._views, self._kept = [()] * n, [None] * n

    def put(self, row, geom, phys):
        """Read this row from a contact's geom and phys from now on."""
        force, slid = phys.shearForce, geom.shearInc
        self._kept[row] = geom, slid, force
        if isinstance(geom, SimpleNamespace):  # of a contact that is over
            views = np.array([geom.penetrationDepth, *slid]), np.array([*force])
        else:
            views = _place(slid, [geom.penetrationDepth]), _place(force)
        self._views[row] = None if any(view is None for view in views) else views

    def read(self, rows):
        """Depths [m], shear displacements in the last step (3, m) [m] and shear forces (3, m) [N]
        of contacts in these rows (m,)."""
        found = []
        for row in rows.tolist():
            found += self._views[row] or self._ask(row)
        table = np.frombuffer(b"".join(found)).reshape(-1, 7).T
        return table[0], table[1:4], table[4:]

    def _ask(self, row):
        geom, *vectors = self._kept[row]
        return [np.array([geom.penetrationDepth]), *map(np.array, vectors)]
