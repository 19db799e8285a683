"""Where the bricks of a house stand in space, from what its history keeps: `walls` of its
parameters, tables of bodies and joints, motion in the plane of each wall and across it.

Places in a wall are x along it as unfolded, y from its middle plane and z; in the house x, y, z.
"""

from typing import NamedTuple

import numpy as np

from damage.wall.house import Placed
from damage.wall.parameters import Wall

FACES = "outside", "inside"
_SIDE = (-1, -1), (1, -1), (1, 1), (-1, 1)
BOX = np.array([(x, y, z) for y in (1, -1) for x, z in _SIDE])
"""Corners of a body from its centre, in half sizes: counter-clockwise from the lower left, at +y,
then at -y."""


class Placing(NamedTuple):
    """Of the walls of a house: names; left end of each as unfolded (n_walls,) [m]; origin (n_walls,
    3) [m] and axes, along, across and upwards (n_walls, 3, 3), in the house; length and thickness
    (n_walls,) [m]."""

    names: list
    left: np.ndarray
    origin: np.ndarray
    axes: np.ndarray
    length: np.ndarray
    thickness: np.ndarray

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
        ends = (
            self.origin[:, None]
            + np.multiply.outer(self.length, [0.0, 1.0])[..., None] * self.axes[:, None, 0]
        )
        middle = (ends.min(axis=(0, 1)) + ends.max(axis=(0, 1))) / 2
        away = np.einsum("ni,ni->n", ends.mean(axis=1) - middle, self.axes[:, 1])
        outside = np.where(away < -self.thickness / 2, -1, 1)
        return outside if face == "outside" else -outside


def placing_of(walls):
    """The Placing of the walls of a house, tables as a history's parameters have them."""
    placed = [Placed(Wall.from_dict(one["wall"]), one["origin"], one["direction"]) for one in walls]
    return Placing(
        [one.wall.name for one in placed],
        np.array([one["left_m"] for one in walls]),
        np.array([(*one.origin, 0.0) for one in placed]),
        np.array([one.axes for one in placed]),
        np.array([one.wall.length for one in placed]),
        np.array([one.wall.brick.thickness for one in placed]),
    )


def moved(bodies, motion, across, body, places, magnify=1.0):
    """Where places (n, k, 3) [m] in walls go with the bodies (n,) that they are fixed to, -1 of the
    ground, when the bodies' motion is magnified; (n, k, 3) [m].

    bodies: table of a history; motion: (n_bodies, 3) along the wall, upwards [m] and from x towards
    z [rad]; across: (n_bodies, 3) across it [m], about the axes along it and upwards [rad].
    """
    shift = np.column_stack([motion[:, 0], across[:, 0], motion[:, 1]])
    turn = np.column_stack([across[:, 1], -motion[:, 2], across[:, 2]])
    centre = np.column_stack([bodies["x_m"], np.zeros(len(bodies)), bodies["z_m"]])
    shift, turn, centre = (
        np.vstack([values, np.zeros(3)])[body, None] for values in (shift, turn, centre)
    )
    arms = places - centre
    return places + magnify * shift + _turned(magnify * turn, arms) - arms


def _turned(turn, arms):
    """Vectors (n, k, 3) after the rotations (n, 1, 3) [rad], by Rodrigues' formula."""
    angle = np.linalg.norm(turn, axis=-1, keepdims=True)
    once = np.cross(turn, arms)
    half = np.sinc(angle / (2 * np.pi)) ** 2 / 2
    return arms + np.sinc(angle / np.pi) * once + half * np.cross(turn, once)


def box_corners(bodies, thickness):
    """Corners of the bodies at rest in their walls, (n_bodies, 8, 3) [m], as of BOX; thickness
    (n_bodies,) [m]."""
    half = np.column_stack([bodies["length_m"], thickness, bodies["height_m"]]) / 2
    centre = np.column_stack([bodies["x_m"], np.zeros(len(bodies)), bodies["z_m"]])
    return centre[:, None] + half[:, None] * BOX
