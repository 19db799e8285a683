"""Walls that step together, in lockstep: one vector instruction does for eight what it would do for one.

    run_together([wall, another, ...], 70, 70, 10)     # each as wall.run would, to the same bits

Walls are ReferenceWalls of any state, motion, strength, damping and time step that share bricks, joints' places and
stiffnesses, and friction.  Each stays a wall of its own: its tables are views on those of its lanes, and it may be
read, changed and run alone at any time.  Lanes are made anew where the walls that are asked for are not those of the
last time, so that a wall that has ended is simply left out.
"""

import math

import numpy as np

from damage.index import THRESHOLD
from damage.reference import kernel, tables
from damage.reference.blocks import make_blocks
from damage.reference.instants import Samples, observe

MOST_LANES = 8
"""Walls that one block holds; more are moved in groups of so many."""


def run_together(walls, *steps):
    """Advance walls as `ReferenceWall.run` does; returns for each None, or the FloatingPointError that ends it.

    ValueError where they are not of the same bricks and stiffnesses.
    """
    failures = []
    for first in range(0, len(walls), MOST_LANES):
        group = walls[first:first + MOST_LANES]
        lanes = group[0].lanes
        if lanes is None or not lanes.are_of(group):
            lanes = Lanes(group)
        lanes.run(*steps)
        failures += [_failure(wall) for wall in group]
    return failures


def _failure(wall):
    if math.isfinite(wall.system.place["fx"].sum()):
        return None
    return FloatingPointError(f"forces are no longer finite at step {wall.step}: the time step of "
                              f"{wall.time_step:.3g} s is too large for this wall")


class Lanes:
    """The tables of up to eight walls as one; making them binds the walls' own to them."""

    def __init__(self, walls):
        self.walls = list(walls)
        _check(self.walls)
        self.tables = _join([wall.system for wall in self.walls])
        for lane, wall in enumerate(self.walls):
            wall.system, wall.lanes = _lane(self.tables, lane), self
        self._width = 1 if len(self.walls) == 1 else MOST_LANES
        self._law = kernel.Law(self.walls[0].material, THRESHOLD, _is_plain(self.tables))
        self._blocks = make_blocks(self.tables.pairs[0], self.tables.place.shape[1], self.tables.contacts.shape[1],
                                   self._width)
        self._samples = self.room(0)

    def are_of(self, walls):
        """Whether these are the walls, in this order, and still bound to these tables."""
        return len(walls) == len(self.walls) and all(
            one is other and one.lanes is self for one, other in zip(walls, self.walls))

    def run(self, *steps):
        """Advance all walls by these numbers of steps, one after the other; `told` tells what was after each."""
        for wall in self.walls:
            if wall.adaptive_damping == 0.0:
                wall.system.relaxation[:] = 0.0
        if len(steps) > self._samples.totals.shape[1]:
            self._samples = self.room(len(steps))
        ends = np.cumsum(steps)
        kernel.run_steps(self.tables, self._blocks, self._width, self._law, self._controls(),
                         self._field(ends[-1] + 1), self._clock(), ends, self.walls[0].springs, self._samples)
        for wall in self.walls:
            wall.step += int(ends[-1])

    def room(self, n_samples):
        """Samples of all walls, empty."""
        return Samples.none(len(self.walls), n_samples, self.tables.contacts.shape[1], self.tables.place.shape[1] - 1)

    def told(self, wall, which):
        """Samples of this wall after these of the last run's numbers of steps, a slice."""
        return self._samples.of(self.walls.index(wall), which)

    def told_now(self, wall, field):
        """Samples of this wall, the one of this instant; field: backward and downward acceleration of all masses
        [m/s2]."""
        samples = Samples.none(1, 1, *self._samples.opening.shape[2:], self._samples.displacement.shape[2])
        observe(self.tables, self.walls.index(wall), wall.springs, *field, wall.time_step, samples, 0, 0)
        return samples.of(0, slice(1))

    def find_forces(self, singly):
        """Forces at the present places without damping; and, if `singly`, stresses: then each contact by itself."""
        kernel.find_forces(self.tables, self._blocks, self._width, self._law, self._clock(), 0, singly, False)

    def _controls(self):
        return np.array([wall.controls for wall in self.walls], float)

    def _field(self, n_steps):
        """Acceleration of each wall's base along x and z, zero beyond its end, and gravity, whose last value holds
        beyond its end: (walls, n_steps, 3) [m/s2] of the next steps."""
        field = np.zeros((len(self.walls), n_steps, 3))
        for wall, rows in zip(self.walls, field):
            first = wall.step - wall.first_step
            base, gravity = wall.base[first:first + n_steps], wall.gravity[first:first + n_steps]
            rows[:len(base), :2] = base
            rows[:len(gravity), 2], rows[len(gravity):, 2] = gravity, wall.gravity[-1]
        return field

    def _clock(self):
        return np.array([wall.step - wall.first_step for wall in self.walls])


def are_alike(wall, other):
    """Whether two walls have the same bricks, stiffnesses and friction, so that they can be lanes of one block."""
    one, two = wall.system, other.system
    return wall.material == other.material and len(one.contacts) == len(two.contacts) and all(
        np.array_equal(getattr(one, table)[name], getattr(two, table)[name], equal_nan=True)
        for table, names in (("pairs", tables.SHARED), ("contacts", ("offset", "kn", "ks")), ("joints", ("area",)))
        for name in names)


def _is_plain(system):
    """Whether no contact softens or crushes."""
    joints = system.joints
    return bool(np.all(system.contacts["crushing_force"] == np.inf) and not joints["mode_i"].any()
                and not joints["mode_ii"].any())


def _check(walls):
    """Raise ValueError of walls that differ in what lanes share."""
    for lane, wall in enumerate(walls[1:], 1):
        if not are_alike(walls[0], wall):
            raise ValueError(f"wall {lane} of those to step together has other bricks, stiffnesses or friction than "
                             "wall 0; step it by itself")


def _join(systems):
    """Tables of several walls with the lane as first axis; of one wall those that it has, seen so."""
    def join(name):
        arrays = [getattr(system, name) for system in systems]
        if name in ("place", "motion"):
            arrays = [array.view(tables.REAL).reshape(-1, 8) for array in arrays]
        if len(arrays) == 1:
            return arrays[0][np.newaxis]
        if name not in ("events", "values"):
            return np.stack(arrays)
        joined = np.zeros((len(arrays), *arrays[0].shape), arrays[0].dtype)  # touches no more memory than there are
        for lane, system in enumerate(systems):
            count = min(int(system.n_events[0]), len(arrays[lane]))
            joined[lane, :count] = arrays[lane][:count]
        return joined

    return tables.System(*map(join, tables.System._fields))


def _lane(joined, lane):
    """The tables of one wall of those joined, as views."""
    system = tables.System(*(array[lane] for array in joined))
    return system._replace(place=system.place.view(tables.PLACE)[:, 0], motion=system.motion.view(tables.MOTION)[:, 0])
