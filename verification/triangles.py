"""First period of a wall of deformable bricks by a triangle mesh: an independent check of strain
modes."""

import numpy as np
from scipy.sparse import coo_matrix, diags
from scipy.sparse.linalg import eigsh

from damage.wall.strain import elasticity_of


class Mesh:
    """Constant-strain triangles on every brick of a Layout, four on each of n_x by n_z cells of a
    whole brick.

    A cell's edge should have two Gauss points: a mesh that is finer than the points is pressed in
    at each of them.
    """

    def __init__(self, layout, n_x, n_z=1):
        self.layout = layout
        self._n_z = n_z
        bodies = layout.bodies
        brick = layout.wall.brick
        self._n_x = [
            max(1, round(n_x * length / brick.length))
            for length in bodies.length[: layout.n_bricks]
        ]
        counts = [(n + 1) * (n_z + 1) + n * n_z for n in self._n_x]
        # node of each brick, then three coordinates a cap
        self._first = np.append(0, np.cumsum(counts))
        n_caps = len(bodies) - layout.n_bricks
        self._caps = 2 * self._first[-1] + 3 * np.arange(n_caps)
        self.size = 2 * self._first[-1] + 3 * n_caps

    def nodes(self, b):
        """Corners of the cells of brick b, row by row, then their middles: (n, 2) from its centre
        [m]."""
        length = self.layout.bodies.length[b]
        height = self.layout.bodies.height[b]
        x, z = (
            np.linspace(-size / 2, size / 2, n + 1)
            for size, n in ((length, self._n_x[b]), (height, self._n_z))
        )
        grids = [
            np.stack(np.meshgrid(a, c), axis=-1).reshape(-1, 2)
            for a, c in ((x, z), ((x[1:] + x[:-1]) / 2, (z[1:] + z[:-1]) / 2))
        ]
        return np.concatenate(grids)

    def triangles(self, b):
        """Rows of `nodes` (n, 3), counter-clockwise."""
        n_x = self._n_x[b]
        n_z = self._n_z
        i, j = (of.ravel() for of in np.meshgrid(np.arange(n_x), np.arange(n_z)))
        below = j * (n_x + 1) + i
        above = (j + 1) * (n_x + 1) + i
        around = np.array([below, below + 1, above + 1, above])
        middle = (n_x + 1) * (n_z + 1) + j * n_x + i
        return np.concatenate(
            [np.column_stack([around[k], around[(k + 1) % 4], middle]) for k in range(4)]
        )

    def matrices(self):
        """Stiffness (sparse) and lumped masses."""
        wall = self.layout.wall
        bodies = self.layout.bodies
        elasticity = elasticity_of(wall.brick)
        mass = np.zeros(self.size)
        rows = []
        columns = []
        values = []
        for b in range(self.layout.n_bricks):
            points = self.nodes(b)
            triangles = self.triangles(b)
            x, z = np.moveaxis(points[triangles], 2, 0)
            twice = (x[:, 1] - x[:, 0]) * (z[:, 2] - z[:, 0]) - (x[:, 2] - x[:, 0]) * (
                z[:, 1] - z[:, 0]
            )
            dx = (np.roll(z, -1, 1) - np.roll(z, -2, 1)) / twice[:, None]
            dz = (np.roll(x, -2, 1) - np.roll(x, -1, 1)) / twice[:, None]
            strain = np.zeros((len(triangles), 3, 6))
            strain[:, 0, :3] = dx
            strain[:, 1, 3:] = dz
            strain[:, 2, :3] = dz
            strain[:, 2, 3:] = dx
            of = np.einsum(
                "t,tsi,sr,trj->tij", twice / 2 * wall.brick.thickness, strain, elasticity, strain
            )
            number = 2 * (
                self._first[b] + np.concatenate([triangles, triangles], axis=1)
            ) + np.repeat([0, 1], 3)
            rows.append(np.broadcast_to(number[:, :, None], of.shape).ravel())
            columns.append(np.broadcast_to(number[:, None, :], of.shape).ravel())
            values.append(of.ravel())
            np.add.at(
                mass,
                number,
                np.repeat(wall.brick.density * wall.brick.thickness * twice / 6, 6).reshape(-1, 6),
            )
        for cap, first in enumerate(self._caps):
            b = self.layout.n_bricks + cap
            mass[first : first + 3] = bodies.mass[b], bodies.mass[b], bodies.inertia[b]
        stiffness = coo_matrix(
            (np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))),
            shape=(self.size, self.size),
        ).tocsr()
        contacts = self.layout.contacts
        for along, of in ((False, contacts.normal_stiffness), (True, contacts.shear_stiffness)):
            opening = self._relative(along)
            stiffness = stiffness + opening.T @ diags(of * contacts.area) @ opening
        return stiffness, mass

    def _relative(self, along):
        """Sparse (n_contacts, size): displacement of the second to the first body along the normal
        or the tangent."""
        contacts = self.layout.contacts
        entries = []
        for body, sign in ((contacts.second, 1.0), (contacts.first, -1.0)):
            for k in np.flatnonzero(body >= 0):
                axis = int(contacts.upright[k] == along)  # of the displacement: 0 x, 1 z
                entries += [
                    (k, column, sign * value) for column, value in self._at(body[k], k, axis)
                ]
        rows, columns, values = zip(*entries)
        return coo_matrix((values, (rows, columns)), shape=(len(contacts), self.size)).tocsr()

    def _at(self, b, k, axis):
        """(coordinate, share) of the displacement along an axis of the point of body b at contact
        k."""
        bodies = self.layout.bodies
        contacts = self.layout.contacts
        place = contacts.x[k] - bodies.x[b], contacts.z[k] - bodies.z[b]
        if b >= self.layout.n_bricks:
            first = self._caps[b - self.layout.n_bricks]
            return [(first + axis, 1.0), (first + 2, -place[1] if axis == 0 else place[0])]
        cell = []
        share = []
        for at, size, n in zip(
            place, (bodies.length[b], bodies.height[b]), (self._n_x[b], self._n_z)
        ):
            there = np.clip((at / size + 0.5) * n, 0, n)
            cell.append(min(int(there + 1e-9), n - 1))
            share.append(there - cell[-1])
        corners = [
            ((0, 0), (1 - share[0]) * (1 - share[1])),
            ((1, 0), share[0] * (1 - share[1])),
            ((0, 1), (1 - share[0]) * share[1]),
            ((1, 1), share[0] * share[1]),
        ]
        return [
            (2 * (self._first[b] + (cell[1] + j) * (self._n_x[b] + 1) + cell[0] + i) + axis, weight)
            for (i, j), weight in corners
            if weight > 1e-12
        ]

    def first_period(self):
        """[s]"""
        stiffness, mass = self.matrices()
        scale = diags(1 / np.sqrt(mass))
        (square,) = eigsh(
            (scale @ stiffness @ scale).tocsc(),
            k=1,
            sigma=0.0,
            return_eigenvectors=False,
            v0=np.ones(self.size),
        )
        return 2 * np.pi / np.sqrt(square)
