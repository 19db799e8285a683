"""Numbers of many contacts and bodies at once, from the memory in which YADE has them.

Python takes 0.3 us or more for a number of YADE, numpy some 10 ns.  What YADE returns by reference
is a Python object that holds its address; the depth of a contact lies before its shear increment,
the place of a body before its velocity.  Where a build of YADE has other places, which is tried
once, Python reads.
"""

import ctypes
from types import SimpleNamespace

import numpy as np
from yade import Quaternion, ScGeom, State, Vector3

_WORD = 8
_KIND, _PLACE = 6, 8  # words of an object of Boost.Python: what it holds, and where that is
_MEMORY = np.frombuffer((ctypes.c_double * 2**44).from_address(_WORD))  # numpy allocates at 0
_XYZ = np.arange(3)[:, None]
_BEFORE_SPEED = np.arange(-7, 0)  # centre and quaternion of a body


def _words(held):
    return (ctypes.c_uint64 * (_PLACE + 1)).from_address(id(held))


def _index(address):
    return address // _WORD - 1


def _place(vector):
    """Index of a Vector3, whose Python object must live on."""
    if _words(vector)[_KIND] == _words(_OWN)[_KIND]:
        return _index(id(vector)) + _PLACE
    return _index(_words(vector)[_PLACE])


def _is_as_known():
    geom, state = ScGeom(), State()
    slid, speed = geom.shearInc, state.vel
    state.pos, state.ori = Vector3(1, 2, 3), Quaternion(Vector3(1, 0, 0), 1.0)
    slid[0], slid[1], slid[2] = 0.1, 0.7, 0.9
    for vector in (slid, speed):
        address = _words(vector)[_PLACE]
        if not 2**20 < address < 2**47 or address % _WORD:
            return False
    depth = _place(slid) - 1
    # a depth begins as NaN
    if _MEMORY[depth + 1 :][:3].tolist() != [0.1, 0.7, 0.9] or _MEMORY[depth] == _MEMORY[depth]:
        return False
    _MEMORY[depth] = 0.3
    there = _MEMORY[_place(speed) + _BEFORE_SPEED].tolist()
    return geom.penetrationDepth == 0.3 and there == [*state.pos, *state.ori]


_OWN = Vector3(0, 0, 0)
_READS = _is_as_known()


class BodyNumbers:
    """Of the states of bodies."""

    def __init__(self, states):
        self._states, self._speeds = states, [state.vel for state in states]
        self._places = np.array([_place(one) for one in self._speeds]) if _READS else None

    def places(self):
        """Centres [m] and quaternions, the real part last (n, 7)."""
        if _READS:
            return _MEMORY[self._places[:, None] + _BEFORE_SPEED]
        return np.array([(*state.pos, *state.ori) for state in self._states])


class ContactNumbers:
    """Numbers of contacts, each in a row below n."""

    def __init__(self, n):
        self._kept = [None] * n
        self._depth, self._force, self._slid = np.zeros((3, n), int)

    def put(self, row, geom, phys):
        """Read this row from a contact's geom and phys from now on."""
        force, slid, depth = phys.shearForce, geom.shearInc, None
        if isinstance(geom, SimpleNamespace):  # of a contact that is over
            depth = np.array([geom.penetrationDepth])
        self._kept[row] = geom, phys, force, slid, depth
        if _READS:
            self._force[row], self._slid[row] = _place(force), _place(slid)
            over = depth is not None
            self._depth[row] = _index(depth.ctypes.data) if over else self._slid[row] - 1

    def depths(self, rows):
        """Of penetration, (m,) [m]."""
        if _READS:
            return _MEMORY[self._depth[rows]]
        return np.array([self._kept[row][0].penetrationDepth for row in rows])

    def forces(self, rows):
        """Shear forces (3, m) [N]."""
        return self._vectors(self._force, rows, 2)

    def increments(self, rows):
        """Shear displacements in the last step (3, m) [m]."""
        return self._vectors(self._slid, rows, 3)

    def _vectors(self, places, rows, number):
        if _READS:
            return _MEMORY[places[rows] + _XYZ]
        return np.array([tuple(self._kept[row][number]) for row in rows]).reshape(-1, 3).T
