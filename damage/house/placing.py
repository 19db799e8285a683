"""Where the walls of a house stand in space, from what the parameters of its history keep.

Places in a wall are x along it as unfolded, y from its middle plane and z; in the house x, y, z.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from damage.house.house import Placed
from damage.wall.parameters import Wall

FACES = "outside", "inside"
_SIDE = (-1, -1), (1, -1), (1, 1), (-1, 1)
BOX = np.array([(x, y, z) for y in (1, -1) for x, z in _SIDE])
"""Corners of a body from its centre, in half sizes: counter-clockwise from the lower left, at +y,
then at -y."""


@dataclass(frozen=True)
class Placing:
    """Places of the walls of a house: Placed walls, and the left end of each as unfolded (n_walls,)
    [m]."""

    walls: Sequence[Placed]
    left: np.ndarray

    @property
    def names(self):
        """Names of the walls."""
        return [placed.wall.name for placed in self.walls]

    @cached_property
    def axes(self):
        """Axes of the walls in the house: along, across and upwards (n_walls, 3, 3)."""
        return np.array([placed.axes for placed in self.walls])

    @cached_property
    def origin(self):
        """Origins of the walls in the house (n_walls, 3) [m]."""
        return np.array([(*placed.origin, 0.0) for placed in self.walls])

    @property
    def length(self):
        """Lengths of the walls (n_walls,) [m]."""
        return np.array([placed.wall.length for placed in self.walls])

    def in_house(self, wall, places):
        """Places (n, k, 3) [m] in walls (n,) as places in the house (n, k, 3) [m]."""
        return self.origin[wall][:, None] + self.turned(
            wall, places - self.left[wall][:, None, None] * [1.0, 0.0, 0.0]
        )

    def in_wall(self, wall, places):
        """The inverse: places in the house (n, 3) [m] as places in a wall, by its number."""
        return (places - self.origin[wall]) @ self.axes[wall].T + [self.left[wall], 0.0, 0.0]

    def turned(self, wall, vectors):
        """Vectors (n, k, 3) along, across and up walls (n,) along the axes of the house."""
        return np.einsum("nki,nij->nkj", vectors, self.axes[wall])

    def sign_of(self, face):
        """Sign of y of a face of FACES, of each wall (n_walls,): outside is away from the middle of
        the plan; of a wall through it, towards y."""
        ends = np.array([placed.ends for placed in self.walls])
        middle = (ends.min(axis=(0, 1)) + ends.max(axis=(0, 1))) / 2
        away = np.einsum("ni,ni->n", ends.mean(axis=1) - middle, self.axes[:, 1, :2])
        half = np.array([placed.wall.brick.thickness / 2 for placed in self.walls])
        outside = np.where(away < -half, -1, 1)
        return outside if face == "outside" else -outside


def placing_of(walls):
    """The Placing of the walls of a house, tables as a history's parameters have them."""
    placed = [
        Placed(Wall.from_dict(wall["wall"]), wall["origin"], wall["direction"]) for wall in walls
    ]
    return Placing(placed, np.array([wall["left_m"] for wall in walls]))
