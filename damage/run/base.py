"""Rigid motion of a wall's base: of the base course, which the drift leaves out where the ground moves."""

import numpy as np


class BaseMotion:
    """Rigid motion of the base course of a damage.wall.layout.Layout."""

    def __init__(self, layout):
        bodies = layout.bodies
        self._rows = np.flatnonzero(bodies.course == 0)
        x = bodies.x[self._rows]
        weight = bodies.length[self._rows] / bodies.length[self._rows].sum()
        arm = x - weight @ x
        self._mean, self._slope = weight, weight * arm / max(weight @ arm**2, 1e-12)
        self._up = layout.drift_height - float(bodies.z[self._rows].mean())

    def of(self, motion):
        """Mean horizontal displacement (n,) [m] and rotation from x towards z (n,) [rad] of the course, least squares;
        of a single brick its own.

        motion: (n, n_bodies, 3) displacement of the bodies [m, m, rad].
        """
        if len(self._rows) == 1:
            return motion[:, self._rows[0], 0], motion[:, self._rows[0], 2]
        # Contiguous rows are summed each by itself, in an order that does not depend on their number: samples taken one
        # by one and several at once give the same bits.
        return tuple(np.add.reduce(motion[:, :, axis].take(self._rows, axis=1) * weights, axis=1)
                     for axis, weights in enumerate((self._mean, self._slope)))

    def at_top(self, motion):
        """Horizontal displacement (n,) [m] of the wall's top by this rigid motion."""
        translation, rotation = self.of(motion)
        return translation - np.sin(rotation) * self._up
