"""Symmetric matrices of a wall by blocks, one for each pair of bodies that contact points join, and
their factor.

Sums and products are made one by one in one order, so that matrices, factors and solutions have the
same bits on every machine; those of sparse libraries have not.  Bodies are eliminated in the order
of minimum degree, ties by their rows.
"""

from heapq import heappop, heappush
from itertools import pairwise, starmap
from typing import NamedTuple

import numpy as np
from scipy.sparse import coo_matrix

SIZE = 3
"""Coordinates of a node, of which a body has one or more."""


class Blocks(NamedTuple):
    """Lower triangle of a symmetric matrix: row, column: (n,) bodies of each block, rising by rows
    and in these by columns, all of the diagonal among them; values: (n, coordinates,
    coordinates)."""

    row: np.ndarray
    column: np.ndarray
    values: np.ndarray

    def bounded(self, free, diagonal):
        """These with more on the diagonal, where coordinates that are not free, bool (n_bodies,
        coordinates), are coupled to no other."""
        values = self.values * free[self.row][:, :, None] * free[self.column][:, None, :]
        index = np.arange(free.shape[1])
        values[np.flatnonzero(self.row == self.column)[:, None], index, index] += diagonal
        return self._replace(values=values)

    def sparse(self):
        """The whole matrix, sparse and compressed by rows."""
        size = self.values.shape[1]
        block, k, m = np.nonzero(self.values)
        value = self.values[block, k, m]
        i = size * self.row[block] + k
        j = size * self.column[block] + m
        above = self.row[block] != self.column[block]
        n = size * int(np.sum(self.row == self.column))
        return coo_matrix(
            (np.append(value, value[above]), (np.append(i, j[above]), np.append(j, i[above]))),
            shape=(n, n),
        ).tocsr()


def sum_of_products(n_bodies, bodies, rows, weights):
    """Blocks of the sum of w b b' over vectors b of the coordinates of two bodies each.

    bodies: (2, n), two different ones, or one and a negative number; rows: (2, n, coordinates) of
    b; weights: w (n,).
    """
    order = np.argsort(bodies, axis=0)
    low, high = np.take_along_axis(bodies, order, axis=0)
    of_low, of_high = np.take_along_axis(rows, order[:, :, None], axis=0)
    highs = high, of_high
    lows = low, of_low
    terms = []
    for (i, left), (j, right) in ((highs, highs), (lows, lows), (highs, lows)):
        moves = j >= 0
        terms.append((i[moves], j[moves], left[moves], right[moves], weights[moves]))
    i, j, left, right, weights = map(np.concatenate, zip(*terms))
    number, place = np.unique(
        np.append(np.arange(n_bodies) * (n_bodies + 1), i * n_bodies + j), return_inverse=True
    )
    place = place[n_bodies:]
    size = rows.shape[2]
    values = np.zeros((len(number), size, size))
    for k in range(size):
        for m in range(size):
            values[:, k, m] = np.bincount(place, weights * (left[:, k] * right[:, m]), len(number))
    return Blocks(*np.divmod(number, n_bodies), values)


class Factor(NamedTuple):
    """L D L' of Blocks, a body's coordinates in nodes of SIZE, in the order of elimination.

    order: (n_bodies,); start: (nodes + 1,) first block of each
    column of L; below: (n,) node of each block's row; lower: (n, SIZE, SIZE) these blocks;
    diagonal, inverse: (nodes, SIZE, SIZE) of D and of its inverse.
    """

    order: np.ndarray
    start: np.ndarray
    below: np.ndarray
    lower: np.ndarray
    diagonal: np.ndarray
    inverse: np.ndarray

    def solve(self, right):
        """The solution (n_bodies, coordinates) for such a right side."""
        x = right[self.order].reshape(-1, SIZE)
        spans = list(starmap(slice, pairwise(self.start.tolist())))
        for node, span in enumerate(spans):
            x[self.below[span]] -= _times(self.lower[span], x[node])
        x = _times(self.inverse, x[:, None])
        lower = self.lower.swapaxes(1, 2)
        for node, span in zip(reversed(range(len(spans))), reversed(spans)):
            x[node] -= np.add.reduce(_times(lower[span], x[self.below[span]][:, None]), axis=0)
        solution = np.empty(right.shape)
        solution[self.order] = x.reshape(right.shape)
        return solution


def factorised(blocks):
    """The Factor of positive definite Blocks."""
    nodes = blocks.values.shape[1] // SIZE
    coupled = np.any(blocks.values, axis=(1, 2))
    row = blocks.row[coupled]
    column = blocks.column[coupled]
    values = blocks.values[coupled]
    order, columns = _elimination(list(zip(row.tolist(), column.tolist())), row[-1] + 1)
    places = np.argsort(order)
    start, below = _structure(places, columns, nodes)
    n = nodes * len(order)
    turned = (places[row] < places[column])[:, None, None]
    values = np.where(turned, values.swapaxes(1, 2), values)
    parts = values.reshape(-1, nodes, SIZE, nodes, SIZE).swapaxes(2, 3)
    low, high = nodes * np.sort([places[row], places[column]], axis=0)[:, :, None, None]
    node = np.arange(nodes)
    i, j = np.broadcast_arrays(high + node[:, None], low + node)
    lower = np.zeros((len(below), SIZE, SIZE))
    diagonal = np.empty((n, SIZE, SIZE))
    diagonal[i[i == j]] = parts[i == j]
    known = np.repeat(np.arange(n), np.diff(start)) * n + below  # rising
    lower[np.searchsorted(known, (j * n + i)[i > j])] = parts[i > j]
    inverse = _factorise(start, below, known, lower, diagonal)
    return Factor(
        order=np.array(order),
        start=start,
        below=below,
        lower=lower,
        diagonal=diagonal,
        inverse=inverse,
    )


def _elimination(pairs, n):
    """Bodies in the order of minimum degree, and those that the column of L of each of them
    reaches; pairs: (body, body) that are coupled."""
    left = {body: set() for body in range(n)}
    for a, b in pairs:
        left[a] |= {b} - {a}
        left[b] |= {a} - {b}
    heap = sorted((len(rows), body) for body, rows in left.items())
    order = []
    columns = []
    while heap:
        degree, body = heappop(heap)
        if body in left and degree == len(left[body]):
            rows = left.pop(body)
            for other in rows:
                left[other] = (left[other] | rows) - {body, other}
                heappush(heap, (len(left[other]), other))
            order.append(body)
            columns.append(rows)
    return order, columns


def _structure(places, columns, nodes):
    """`start` and `below` of a Factor whose bodies, at these places in the order, have so many
    nodes each."""
    below = []
    for place, column in enumerate(columns):
        others = nodes * np.sort(places[list(column)])[:, None] + np.arange(nodes)
        end = nodes * (place + 1)
        below += [[*range(end - k, end), *others.flat] for k in reversed(range(nodes))]
    return np.cumsum([0, *map(len, below)]), np.array([row for rows in below for row in rows], int)


def _factorise(start, below, known, lower, diagonal):
    """Replace the blocks of a symmetric positive definite matrix by those of L D L', as of Factor;
    returns the inverse blocks of D.  known: column times rows plus row of each block of L,
    rising."""
    inverse = np.empty_like(diagonal)
    for i, (first, stop) in enumerate(pairwise(start.tolist())):
        block = diagonal[i]
        cofactors = np.cross(block[[1, 2, 0]], block[[2, 0, 1]])
        inverse[i] = cofactors / _times(block[:1], cofactors[0])
        column = lower[first:stop].reshape(-1, SIZE)
        rows = below[first:stop]
        over = _product(column, inverse[i])
        change = _product(over, column.T).reshape(len(rows), SIZE, len(rows), SIZE)
        under, upper = np.tril_indices(len(rows), -1)
        lower[np.searchsorted(known, rows[upper] * len(diagonal) + rows[under])] -= change[
            under, :, upper
        ]
        each = np.arange(len(rows))
        diagonal[rows] -= change[each, :, each]
        lower[first:stop] = over.reshape(-1, SIZE, SIZE)
    return inverse


def _product(left, right):
    """Product of matrices (n, SIZE) and (SIZE, m)."""
    return left[:, :1] * right[0] + left[:, 1:2] * right[1] + left[:, 2:] * right[2]


def _times(blocks, vectors):
    """Products of blocks (n, SIZE, SIZE) and vectors (SIZE,), or (n, 1, SIZE): (n, SIZE)."""
    terms = blocks * vectors
    return terms[..., 0] + terms[..., 1] + terms[..., 2]
