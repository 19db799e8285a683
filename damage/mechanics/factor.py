"""The mass matrix of selective mass scaling, M + dt^2/2 K0 + dt/2 C0, and its factor (`damage.mechanics.bodies`).

Bodies are eliminated in the order of minimum degree, ties by their rows.
"""

import hashlib
from heapq import heappop, heappush
from itertools import pairwise

import numpy as np
from scipy.sparse import diags

from damage.law.modes import elastic_key, joint_stiffness, mass_vector
from damage.mechanics.bodies import LOST
from damage.mechanics.tables import RIGID, ROW, Matrix, aligned_zeros
from damage.wall.soil import radiation_times

MASSLESS = 1e-30
"""What stands for the mass of a coordinate without one, whose velocity is prescribed [kg or kg m2]."""
_MOST_KEPT = 8
_KEPT = {}  # {key: ScaledMass}, the last used at the end


def scaled_mass(layout, time_step, beta, held=()):
    """The ScaledMass of a layout for a time step and stiffness-proportional damping [s], with bodies (rows) of which
    coordinates are `held` (their numbers): their velocity is prescribed; those of the last walls are kept."""
    numbers = np.array([time_step, beta, *radiation_times(layout.options), *held], float)
    damping = layout.strain.damping.tobytes() if layout.strain else b""
    key = hashlib.sha256(b"|".join((*elastic_key(layout), damping, numbers.tobytes()))).digest()
    _KEPT[key] = _KEPT.pop(key, None) or ScaledMass(key, layout, time_step, beta, list(held))
    if len(_KEPT) > _MOST_KEPT:
        del _KEPT[next(iter(_KEPT))]
    return _KEPT[key]


class ScaledMass:
    """Mass matrix of a wall with selective mass scaling; key: of all that it depends on; whole: sparse, (coordinates of
    the bodies, the same), in which prescribed velocities are coupled to no other."""

    def __init__(self, key, layout, time_step, beta, held):
        self.key, self.beta, self._supports = key, beta, len(layout.supports)
        self._size = RIGID + (layout.strain.n_modes if layout.strain else 0)
        self.whole = _scaled(layout, time_step, beta, held)
        self._matrix = self._factor()

    def matrix(self, width):
        """The Matrix, with room for walls of this width."""
        return self._matrix._replace(room=aligned_zeros(len(self._matrix.body), 2 * LOST, width))

    def _factor(self):
        whole, size, nodes = self.whole.tocoo(), self._size, -(-self._size // RIGID)
        bodies = whole.shape[0] // size
        order, columns = _elimination(set(zip((whole.row // size).tolist(), (whole.col // size).tolist())), bodies)
        places = np.argsort(order)
        start, below = _nodes(places, columns, nodes)
        n = nodes * (bodies + self._supports)
        lower, diagonal = np.zeros((len(below), 9)), np.tile(MASSLESS * np.eye(RIGID).ravel(), (n, 1))
        (i, s), (j, k) = ((nodes * places[at // size] + at % size // RIGID, at % size % RIGID)
                          for at in (whole.row, whole.col))
        diagonal[i[i == j], (3 * s + k)[i == j]] = whole.data[i == j]
        start = np.append(start, np.full(n + 1 - len(start), start[-1]))
        known = np.repeat(np.arange(n), np.diff(start)) * n + below  # rising
        lower[np.searchsorted(known, (j * n + i)[i > j]), (3 * s + k)[i > j]] = whole.data[i > j]
        inverse = _factorise(start, below, known, lower.reshape(-1, 3, 3), diagonal.reshape(-1, 3, 3))
        order = [*order, *range(bodies, bodies + self._supports)]
        first = np.arange(0, size, RIGID)
        return Matrix(np.repeat(order, nodes), np.tile(first, len(order)),
                      np.tile(np.minimum(size - first, RIGID), len(order)), start.astype(ROW), below.astype(ROW), lower,
                      diagonal, inverse.reshape(-1, 9), np.zeros((0, 0, 1)))


def _scaled(layout, time_step, beta, held):
    """`whole` of a ScaledMass."""
    half, ground, strain, mass = 0.5 * time_step, layout.contacts.first < 0, layout.strain, mass_vector(layout)
    share = [half * (time_step + beta + time * ground) for time in radiation_times(layout.options)]
    own, free = np.where(mass > 0, mass, MASSLESS), (mass > 0).astype(float)
    if strain:
        own.reshape(len(strain.mass), -1)[:, RIGID:] += half * (time_step * strain.stiffness
                                                                + strain.damping * strain.mass)
    free[held] = 0.0
    coupled = diags(free) @ joint_stiffness(layout, share) @ diags(free) + diags(own)
    coupled.eliminate_zeros()
    return coupled


def _elimination(pairs, n):
    """Bodies in the order of minimum degree, and those that the column of L of each of them reaches; pairs: (body,
    body) that are coupled."""
    left = {body: set() for body in range(n)}
    for a, b in pairs:
        left[a] |= {b} - {a}
    heap, order, columns = sorted((len(of), body) for body, of in left.items()), [], []
    while heap:
        degree, body = heappop(heap)
        if body in left and degree == len(left[body]):
            of = left.pop(body)
            for other in of:
                left[other] = (left[other] | of) - {body, other}
                heappush(heap, (len(left[other]), other))
            order.append(body)
            columns.append(of)
    return order, columns


def _nodes(places, columns, nodes):
    """`start` and `below` of a Matrix whose bodies, at these places in the order, have so many nodes each."""
    below = []
    for place, of in enumerate(columns):
        others = [nodes * other + k for other in sorted(places[list(of)].tolist()) for k in range(nodes)]
        below += [[*range(nodes * place + k + 1, nodes * (place + 1)), *others] for k in range(nodes)]
    return np.cumsum([0, *map(len, below)]), np.array([row for rows in below for row in rows], int)


def _factorise(start, below, known, lower, diagonal):
    """Replace the blocks (n, 3, 3) of a symmetric positive definite matrix by those of L D L', as of `Matrix`; returns
    the inverse blocks of D.  known: column times rows plus row of each block of L, rising."""
    inverse = np.empty_like(diagonal)
    for i, (first, stop) in enumerate(pairwise(start)):
        a, b, c = diagonal[i]
        cofactors = np.array([np.cross(b, c), np.cross(c, a), np.cross(a, b)])
        inverse[i] = cofactors / sum(a * cofactors[0])
        column, rows = lower[first:stop], below[first:stop]
        change = _product(column[:, None], _product(inverse[i], column.swapaxes(1, 2)))  # (rows, rows, 3, 3)
        upper, under = np.triu_indices(len(rows), 1)
        lower[np.searchsorted(known, rows[upper] * len(diagonal) + rows[under])] -= change[under, upper]
        diagonal[rows] -= change[np.arange(len(rows)), np.arange(len(rows))]
        lower[first:stop] = _product(column, inverse[i])
    return inverse


def _product(left, right):
    """Products of blocks (..., 3, 3), in one order of operations on every machine."""
    return sum(left[..., k, None] * right[..., None, k, :] for k in range(3))
