"""Supports: the ground below the base as bodies whose motion is prescribed.

Support k is body `GROUND - k` of contact points: -1, -2, ...  In tables of all bodies the supports follow the bricks
and caps (`rows`).  Their reference points lie at the base, z = 0.
"""

from dataclasses import dataclass

import numpy as np

from damage.wall.kinds import GROUND


@dataclass(frozen=True)
class Supports:
    """left, right [m]: the part of the base that each support carries, (n_supports,)."""

    left: np.ndarray
    right: np.ndarray

    def __len__(self):
        return len(self.left)

    @property
    def x(self):
        """Reference points along the wall, (n_supports,) [m]."""
        return (self.left + self.right) / 2


def rows(body, n_bodies):
    """Rows of bodies (n,), supports among them, in tables in which the supports follow n_bodies bricks and caps.

    >>> rows([3, -1, -2], 10)
    array([ 3, 10, 11])
    """
    body = np.asarray(body)
    return np.where(body < 0, n_bodies + GROUND - body, body)


def supports_below(bodies, wall, kind):
    """The Supports of a wall: "one" below all of it, or "bricks": one below each brick of the base."""
    if kind == "one":
        return Supports(np.array([0.0]), np.array([float(wall.length)]))
    base = bodies.course == 0
    half = bodies.length[base] / 2
    return Supports(bodies.x[base] - half, bodies.x[base] + half)
