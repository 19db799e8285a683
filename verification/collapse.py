"""Collapse multiplier of a dry-joint wall in the reference solver: horizontal body load, raised and
held.

The wall comes to rest under its weight.  Then the base is accelerated, which is a horizontal body
load of `multiplier` times each weight in the frame of the base.  The load rises to a level and is
held there until the wall is at rest or keeps accelerating.  Bisection between a stable and an
unstable level gives the multiplier.  At rest all accelerations are nil, so that it depends neither
on the speed of loading nor on the damping, except through the path of the slips.

`find_by_falls` finds the multiplier without waiting for rest: the centre of mass of a wall that
falls under a constant load speeds up, x'' = a (multiplier - c) + k x, by what exceeds the collapse
c, and by its lean; one that creeps or sways does not.
"""

from dataclasses import dataclass

import numpy as np
from scipy.integrate import cumulative_trapezoid

from damage.linear.modes import natural_modes
from damage.reference.wall import ReferenceWall
from damage.run.schedule import STEP_FACTOR
from damage.units import GRAVITY

AT_REST = 1e-6
"""Largest displacement within `WINDOW_S` of a wall at rest, in heights of a course."""
COLLAPSED = 0.05
"""Displacement of a collapsed wall since the level was reached, in heights of a course."""
WINDOW_S = 0.5
LONGEST_S = 60.0
GROWING = 4
"""Number of windows in a row, each with no less displacement than the one before, after which the
wall has collapsed: just above its multiplier a wall of many blocks moves slowly, as its blocks
vibrate and damping slows them."""

# parts of the multiplier that `falls_of` begins at
LOADED = 0.98
LEVELS = (1.02, 1.05, 1.08)
REACH_M = 0.02
"""Distance that blocks move in a fall [m]."""
FALL_S = 1.6
"""Longest duration of a fall [s]."""
SAMPLE_S = 5e-3
"""Time between two samples of a fall [s]."""

DAMPING = 0.3
BETA = 0.3
"""Cundall's damping [-], and stiffness-proportional damping in time steps.  Cundall's alone takes
its share of the rattling of the contacts, always against the motion: a wall that ought to fall may
creep for minutes.  Both together at 0.7 and 0.3 are no longer stable at `STEP_FACTOR`."""


@dataclass(frozen=True)
class Bracket:
    """stable, unstable [-]: multipliers; motion (n_bodies, 3): displacement while it collapses [m,
    m, rad]."""

    stable: float
    unstable: float
    motion: np.ndarray

    @property
    def multiplier(self):
        """The middle of the bracket."""
        return (self.stable + self.unstable) / 2


def collapse_multiplier(layout, highest, *, tolerance=1e-3, rate_per_s=0.2, damping=DAMPING):
    """Bracket the multiplier between 0 and `highest` to a width of `tolerance` times `highest`.

    Every level starts from the highest one at which the wall was at rest, so that the load only
    grows. rate_per_s: speed at which the multiplier is raised; damping: Cundall's, while load is
    raised and held.
    """
    wall = settled_wall(layout, damping)
    stable = 0.0
    unstable = None
    motion = None
    while unstable is None or unstable - stable > tolerance * highest:
        level = highest if unstable is None else (stable + unstable) / 2
        before = [array.copy() for array in wall.system]
        moved = raise_to(wall, stable, level, rate_per_s)
        if moved is None:
            stable = level
            if unstable is None:
                raise ValueError(
                    f"the wall is stable at {highest:g}; expected a level at which it collapses"
                )
        else:
            unstable = level
            motion = moved
            for array, old in zip(wall.system, before):
                array[:] = old
    return Bracket(stable, unstable, motion)


def settled_wall(layout, damping=DAMPING):
    """A wall at rest under gravity."""
    step = STEP_FACTOR * natural_modes(layout).critical_time_step_s
    wall = ReferenceWall(layout, step, beta=BETA * step)
    wall.local_damping = damping
    ramp = round(0.2 / step)
    wall.start(np.zeros((0, 2)), GRAVITY * np.minimum(1.0, np.arange(ramp + 1) / ramp))
    wall.run(2 * ramp)
    if _hold(wall) is not None:
        raise ValueError(f"wall {layout.wall.name} does not stand under its own weight")
    return wall


def raise_to(wall, start, level, rate_per_s):
    """Raise the multiplier from `start` to `level` and hold it: None if the wall comes to rest,
    else its displacement since it was reached, (n_bodies, 3)."""
    ramp = max(1, round(abs(level - start) / rate_per_s / wall.time_step))
    wall.start(_base(np.linspace(start, level, ramp + 1)))
    wall.run(ramp)
    return _hold(wall, level)


def falls_of(layout, near):
    """Falls as of `find_by_falls` without damping, from rest at LOADED times `near`, at LEVELS
    times it."""
    wall = settled_wall(layout)
    weight = layout.bodies.mass / layout.bodies.mass.sum()
    raise_to(wall, 0.0, LOADED * near, 0.2)
    wall.local_damping = 0.0
    rest = [array.copy() for array in wall.system]
    found = []
    steps = round(SAMPLE_S / wall.time_step)
    for level in near * np.array(LEVELS):
        for array, old in zip(wall.system, rest):
            array[:] = old
        ramp = round(0.1 / wall.time_step)
        wall.start(_base(np.linspace(LOADED * near, level, ramp + 1)))
        wall.run(ramp)
        places = [wall.displacement]
        while _largest(places[-1] - places[0]) < REACH_M and len(places) < FALL_S / SAMPLE_S:
            wall.start(_base(np.full(steps, level)))
            wall.run(steps)
            places.append(wall.displacement)
        moved = (np.array(places) - places[0])[:, :, 0] @ weight
        found.append((level, steps * wall.time_step * np.arange(len(moved)), moved))
    return found


def find_by_falls(falls):
    """The multiplier c of the least squares of x = x0 + v0 t + a (multiplier - c) t^2 / 2 + k times
    the second integral of x; None where a is not positive: they do not speed up by the load.

    falls: (multiplier, times since it was reached [s], displacements of the centre of mass [m])."""
    rows = []
    for number, (level, time_s, x) in enumerate(falls):
        own = np.zeros((len(time_s), 2 * len(falls)))
        own[:, 2 * number] = 1.0
        own[:, 2 * number + 1] = time_s
        twice = cumulative_trapezoid(cumulative_trapezoid(x, time_s, initial=0), time_s, initial=0)
        square = np.square(time_s) / 2
        rows.append(np.column_stack([level * square, -square, twice, own]))
    moved = np.concatenate([x for _, _, x in falls])
    a, a_times_c = np.linalg.lstsq(np.vstack(rows), moved, rcond=None)[0][:2]
    return float(a_times_c / a) if a > 0 else None


def _hold(wall, level=0.0):
    """Hold the multiplier: None at rest, the displacement of a wall that collapses."""
    course = wall.layout.wall.brick.height
    steps = round(WINDOW_S / wall.time_step)
    begin = wall.displacement
    before = np.inf
    growing = 0
    for _ in range(round(LONGEST_S / WINDOW_S)):
        last = wall.displacement
        wall.start(_base(np.full(steps, level)))
        wall.run(steps)
        now = _largest(wall.displacement - last)
        growing = growing + 1 if now >= before else 0
        before = now
        if now < AT_REST * course:
            return None
        if growing >= GROWING or _largest(wall.displacement - begin) > COLLAPSED * course:
            return wall.displacement - begin
    raise TimeoutError(
        f"wall {wall.layout.wall.name} neither rests nor collapses within {LONGEST_S:g} s at"
        f" {level:g}"
    )


def _largest(motion):
    """Largest displacement of a body's centre along an axis [m]."""
    return float(np.abs(motion[:, :2]).max())


def _base(multipliers):
    """Base accelerations whose inertia pushes towards +x: (n, 2) [m/s2]."""
    return np.column_stack([-GRAVITY * multipliers, np.zeros(len(multipliers))])
