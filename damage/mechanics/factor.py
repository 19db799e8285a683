"""The mass matrix of selective mass scaling, M + dt^2/2 K0 + dt/2 C0, and its factor (`damage.mechanics.scaling`).

Bodies are eliminated in the order of minimum degree, ties by their rows.
"""

import hashlib
from collections import OrderedDict
from functools import cached_property
from heapq import heappop, heappush

import numpy as np
from scipy.sparse import diags
from scipy.sparse.linalg import splu

from damage.law.modes import elastic_key, joint_stiffness, mass_vector
from damage.mechanics.scaling import LOST, factorise
from damage.mechanics.tables import RIGID, ROW, Matrix, aligned_zeros
from damage.wall.soil import radiation_times

_MOST_KEPT = 8
_KEPT = OrderedDict()  # {key: ScaledMass}


def scaled_mass(layout, time_step, beta, held=()):
    """The ScaledMass of a layout for a time step and stiffness-proportional damping [s], and for coordinates `held` of
    its bodies, whose velocity is prescribed; those of the last walls are kept."""
    strain = layout.strain
    parts = (*elastic_key(layout), *((strain.damping.tobytes(),) if strain else ()),
             np.array([time_step, beta, *radiation_times(layout.options), *held], float).tobytes())
    key = hashlib.sha256(b"|".join(parts)).digest()
    if key not in _KEPT:
        while len(_KEPT) >= _MOST_KEPT:
            _KEPT.popitem(last=False)
        _KEPT[key] = ScaledMass(key, layout, time_step, beta, held)
    _KEPT.move_to_end(key)
    return _KEPT[key]


class ScaledMass:
    """Mass matrix of a wall with selective mass scaling; key: of all that it depends on; whole: sparse, with all
    coordinates of bodies and supports; free: flags of those whose velocity is not prescribed."""

    def __init__(self, key, layout, time_step, beta, held):
        self.key, self.beta, self._size = key, beta, RIGID + (layout.strain.n_modes if layout.strain else 0)
        mass = mass_vector(layout)
        self.whole = (_scaled(layout, time_step, beta, mass)).tocsr()
        self.free = np.arange(self.whole.shape[0]) < len(mass)
        self.free[:len(mass)] &= mass > 0
        self.free[list(held)] = False
        resting = np.zeros(len(self.free))
        resting[:len(mass)] = mass
        self._factor(np.where(self.free, 0.0, resting))

    def matrix(self, width):
        """The Matrix, with room for walls of this width."""
        return self._matrix._replace(room=aligned_zeros(len(self._matrix.body), 2 * LOST, width))

    def follow(self, velocity, change):
        """Change of all velocities (bodies and supports, coordinates) with that of the prescribed ones, at once: of the
        free ones by the impulse through the matrix; and the kinetic energy that these gain [J]."""
        change, impulse = change.ravel().copy(), -(self.whole @ change.ravel())[self.free]
        change[self.free] = self._solve(impulse)
        gained = impulse @ (velocity.ravel()[self.free] + 0.5 * change[self.free])
        return change.reshape(velocity.shape), float(gained)

    @cached_property
    def _solve(self):
        return splu(self.whole[self.free][:, self.free].tocsc()).solve

    def _factor(self, resting):
        """Make the Matrix; resting: (coordinates,) masses whose velocity is prescribed, which are in no equation."""
        n, nodes = len(self.free) // self._size, -(-self._size // RIGID)
        order, columns = _elimination(self.whole, self._size, self.free)
        start, below = _nodes(order, columns, nodes)
        places = np.empty(n, int)
        places[order] = np.arange(n)
        lower, diagonal = np.zeros((len(below), 9)), np.tile(np.eye(RIGID).ravel(), (n * nodes, 1))
        free = diags(self.free.astype(float))
        entries = (free @ self.whole @ free).tocoo()
        used = entries.data != 0
        row, column, data = entries.row[used], entries.col[used], entries.data[used]
        (i, s), (j, k) = ((nodes * places[at // self._size] + at % self._size // RIGID, at % self._size % RIGID)
                          for at in (row, column))
        diagonal[i[i == j], 3 * s[i == j] + k[i == j]] = data[i == j]
        blocks = np.repeat(np.arange(n * nodes), np.diff(start)) * (n * nodes) + below  # rising
        lower[np.searchsorted(blocks, (j * n * nodes + i)[i > j]), (3 * s + k)[i > j]] = data[i > j]
        inverse, start, below = np.empty_like(diagonal), start.astype(ROW), below.astype(ROW)
        factorise(start, below, lower, diagonal, inverse)
        self._matrix = Matrix(
            np.repeat(order, nodes), np.tile(np.arange(nodes) * RIGID, n), start, below, lower,
            self._without(diagonal, resting, places, nodes), inverse, np.zeros((0, 0, 1)))

    def _without(self, diagonal, resting, places, nodes):
        """D with the masses of prescribed coordinates in place of the ones that stand for them."""
        at = np.flatnonzero(~self.free)
        row, k = nodes * places[at // self._size] + at % self._size // RIGID, at % self._size % RIGID
        diagonal = diagonal.copy()
        diagonal[row, 4 * k] = resting[at]
        return diagonal


def _scaled(layout, time_step, beta, mass):
    """Sparse M + dt^2/2 K0 + dt/2 C0 of bodies and supports."""
    half, ground, strain = 0.5 * time_step, layout.contacts.first < 0, layout.strain
    share = [half * (time_step + beta + time * ground) for time in radiation_times(layout.options)]
    joints = joint_stiffness(layout, share, supports=True)
    own = np.zeros(joints.shape[0])
    own[:len(mass)] = mass
    if strain:
        modes = half * (time_step * strain.stiffness + strain.damping * strain.mass)
        own[:len(mass)] += np.hstack([np.zeros((len(layout.bodies), RIGID)), modes]).ravel()
    return joints + diags(own)


def _elimination(whole, size, free):
    """Bodies in the order of minimum degree, and for each in this order those that its column of L reaches."""
    pairs, freely = whole.tocoo(), free.reshape(-1, size).any(axis=1)
    left = {body: set() for body in range(len(freely))}
    for a, b in set(zip((pairs.row // size).tolist(), (pairs.col // size).tolist())):
        if a != b and freely[a] and freely[b]:
            left[a].add(b)
    heap, order, columns = sorted((len(of), body) for body, of in left.items()), [], []
    while heap:
        degree, body = heappop(heap)
        if body in left and degree == len(left[body]):
            of = left.pop(body)
            for other in of:
                left[other] |= of
                left[other] -= {body, other}
                heappush(heap, (len(left[other]), other))
            order.append(body)
            columns.append(of)
    return np.array(order), columns


def _nodes(order, columns, nodes):
    """`start` and `below` of a Matrix whose bodies have so many nodes each, next to each other."""
    places = {body: place for place, body in enumerate(order.tolist())}
    below = []
    for place, of in enumerate(columns):
        others = [nodes * other + k for other in sorted(map(places.get, of)) for k in range(nodes)]
        below += [[*range(nodes * place + k + 1, nodes * (place + 1)), *others] for k in range(nodes)]
    return np.cumsum([0, *map(len, below)]), np.array([row for rows in below for row in rows], int)
