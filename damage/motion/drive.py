"""Drive: everything that a loading prescribes on a wall from time zero on."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Drive:
    """Prescribed motion of a wall; None where the loading prescribes nothing.

    base: time_s (n,) -> (n, 2), acceleration along x and z of the frame in which the wall and all supports are
        computed [m/s2];
    supports: time_s (n,), x_m (k,) -> (n, k, 3), displacement in that frame of the supports whose reference points
        stand at x_m [m, m, rad];
    top: time_s (n,), height_m -> (n,), horizontal displacement of the bodies that carry the top, at that height [m];
    top_rotates: whether these may rotate while they are moved; top_stiffness: of a rotational spring between each of
        them and what moves it [N m/rad];
    first_mode_m_s: velocity of the top in the first mode at time zero [m/s];
    local_damping: Cundall's, of a quasi-static loading [-]; None of a dynamic one.
    """

    base: Callable | None = None
    supports: Callable | None = None
    top: Callable | None = None
    top_rotates: bool = True
    top_stiffness: float = 0.0
    first_mode_m_s: float = 0.0
    local_damping: float | None = None

    @property
    def quasi_static(self):
        """Whether the loading is so slow that the wall stays in equilibrium."""
        return self.local_damping is not None

    def top_velocities(self, interval_s, n, height_m):
        """Velocity of the top in the first n intervals (n,) [m/s], None where the top is free."""
        return None if self.top is None else _mean(self.top(_edges(interval_s, n), height_m), interval_s)

    def support_velocities(self, interval_s, n, x_m):
        """Velocities of supports at x_m (k,) in the first n intervals (n, k, 3) [m/s, m/s, rad/s], None where they
        rest."""
        return None if self.supports is None else _mean(self.supports(_edges(interval_s, n), np.asarray(x_m)),
                                                        interval_s)


def _edges(interval_s, n):
    return np.arange(n + 1) * interval_s


def _mean(displacement, interval_s):
    """Mean velocity in every interval: constant within it, it leads to the displacement at its end."""
    return np.diff(displacement, axis=0) / interval_s
