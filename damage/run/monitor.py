"""What a run watches: whether the wall is at rest, whether a brick fell, how the base moves."""

import numpy as np

from damage.elementary import hypot, sin
from damage.errors import RunError
from damage.run.settings import ACCEPTED_DROP_M
from damage.units import GRAVITY
from damage.wall.kinds import ARCH_COURSE, LINTEL_COURSE

ENERGY = "energy"
DROP = "drop"


class NotAccepted(RunError):
    """A run with mass scaling that is to be repeated; code: ENERGY or DROP."""

    def __init__(self, code, text):
        super().__init__(text)
        self.code = code


def have_fallen(layout, motion):
    """At which instants a brick has fallen, by half its height (n,); motion: (n, n_bodies, 3) since
    the static stage."""
    lowest = -layout.bodies.height[: layout.n_bricks] / 2
    return np.logical_or.reduce(motion[:, : len(lowest), 1] < lowest, axis=1)


class Borne:
    """Which bodies bear each brick, and each part of a lintel, of a layout: those below its bed
    joints or, where there is none, those that bear the nearest such bricks at its height on both
    sides."""

    def __init__(self, layout):
        bodies = layout.bodies
        contacts = layout.contacts
        borne = np.flatnonzero(
            (bodies.course >= 0) | np.isin(bodies.course, (ARCH_COURSE, LINTEL_COURSE))
        )
        x = bodies.x
        z = bodies.z
        below = [set() for _ in bodies.x]
        # The first body of a bed joint is the lower one.
        for low, high in np.column_stack([contacts.first, contacts.second])[
            ~contacts.upright
        ].tolist():
            below[high].add(low)
        lies = np.array([brick for brick in range(layout.n_bricks) if below[brick]])
        for brick in [brick for brick in borne if not below[brick]]:
            near = lies[
                np.abs(z[lies] - z[brick]) < 0.45 * (bodies.height[lies] + bodies.height[brick])
            ]
            for side in (-1, 1):
                beside = near[side * (x[near] - x[brick]) > 0]
                below[brick] |= (
                    below[min(beside, key=lambda other: abs(x[other] - x[brick]))]
                    if len(beside)
                    else set()
                )
        pairs = [(brick, low) for brick in borne for low in below[brick] if low >= 0]
        self._brick, self._low = np.array(sorted(pairs), int).reshape(-1, 2).T
        self._start = np.flatnonzero(np.diff(self._brick, prepend=-1))
        reach = bodies.length[self._low] / 2
        self._arm = np.clip(x[self._brick] - x[self._low], -reach, reach)

    def largest_drop(self, motion):
        """By how much a brick has moved down from all that bore it (n,) [m]; motion: (n, n_bodies,
        3) [m, m, rad]."""
        # rows of a body, which reduceat takes whole
        z, rotation = np.ascontiguousarray(motion.T[1:])
        drop = z[self._low] + sin(rotation)[self._low] * self._arm[:, np.newaxis] - z[self._brick]
        return np.minimum.reduceat(drop, self._start).max(axis=0, initial=0.0)


def check_drop(drop_m, time_s):
    """Raise NotAccepted where the largest drop of a brick [m] at a time [s] exceeds
    ACCEPTED_DROP_M."""
    if drop_m > ACCEPTED_DROP_M:
        raise NotAccepted(
            DROP,
            f"a brick has dropped by {1e3 * drop_m:.2g} mm at {time_s:.2f} s, more than the "
            f"{1e3 * ACCEPTED_DROP_M:g} mm accepted with mass scaling",
        )


def fastest_fallen(layout, motion, before, interval_s):
    """Largest mean speed of the bricks that have moved by more than half of their height [m/s];
    zero where none has.

    The speed is that of the centre plus that of an end by rotation.  motion, before: (n_bodies, 3)
    since the static stage [m, m, rad], interval_s apart.
    """
    moved = (motion - before)[: layout.n_bricks]
    # YADE's rotations are those within half a turn
    moved[:, 2] = np.remainder(moved[:, 2] + np.pi, 2 * np.pi) - np.pi
    moved = np.abs(moved) / interval_s
    speed = (
        hypot(moved[:, 0], moved[:, 1]) + moved[:, 2] * layout.bodies.length[: layout.n_bricks] / 2
    )
    away = (
        hypot(motion[:, 0], motion[:, 1])[: layout.n_bricks]
        > layout.bodies.height[: layout.n_bricks] / 2
    )
    return float(np.max(speed[away], initial=0.0))


def unbalanced_force(layout, on_bodies, in_contacts):
    """Mean resultant on a body, weight included, over the mean contact force [-]; large where no
    contact carries any.

    on_bodies: forces of the contacts, (n_bodies, 3) [N, N, N m]; in_contacts: (n_contacts,) [N].
    """
    restrained = layout.restrained
    resultant = hypot(
        np.where(restrained[:, 0], 0.0, on_bodies[:, 0]),
        np.where(restrained[:, 1], 0.0, on_bodies[:, 1] - GRAVITY * layout.bodies.mass),
    )
    # bricks in flight: a number all the same, fit for a history
    least = 1e-9 * GRAVITY * layout.bodies.mass.mean()
    return float(resultant.mean() / max(in_contacts.mean(), least))


class BaseMotion:
    """Rigid motion of the base course of a wall of a damage.wall.layout.Layout, one of its
    `bases`: these bodies, below a drift of this height [m]."""

    def __init__(self, layout, rows, drift_height):
        bodies = layout.bodies
        self._rows = rows
        x = bodies.x[self._rows]
        weight = bodies.length[self._rows] / bodies.length[self._rows].sum()
        arm = x - np.sum(weight * x)
        self._mean = weight
        self._slope = weight * arm / max(np.sum(weight * arm**2), 1e-12)
        self._up = drift_height - float(bodies.z[self._rows].mean())

    def components(self, motion):
        """Mean horizontal displacement (n,) [m] and rotation from x towards z (n,) [rad] of the
        course, least squares; of a single brick its own.

        motion: (n, n_bodies, 3) displacement of the bodies [m, m, rad].
        """
        if len(self._rows) == 1:
            return motion[:, self._rows[0], 0], motion[:, self._rows[0], 2]
        # Contiguous rows are summed each by itself, in an order that does not depend on their
        # number: samples taken one by one and several at once give the same bits.
        return tuple(
            np.add.reduce(motion[:, :, axis].take(self._rows, axis=1) * weights, axis=1)
            for axis, weights in enumerate((self._mean, self._slope))
        )

    def at_top(self, motion):
        """Horizontal displacement (n,) [m] of the wall's top by this rigid motion."""
        translation, rotation = self.components(motion)
        return translation - sin(rotation) * self._up
