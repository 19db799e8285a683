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
from damage.mechanics import tables
from damage.mechanics.samples import Samples
from damage.reference.fast import alone, together
from damage.reference.fast.blocks import make_blocks
from damage.reference.fast.step import Law
from damage.reference.plain import Alone

MOST_LANES = 8
"""Walls that one block holds; more are moved in groups of so many."""


def run_together(walls, *steps):
    """Advance walls as `ReferenceWall.run` does; returns for each None, or the FloatingPointError that ends it.

    ValueError where they are not of the same bricks and stiffnesses.
    """
    most = MOST_LANES if all(wall.fast for wall in walls) else 1
    for first in range(0, len(walls), most):
        group = walls[first:first + most]
        lanes = group[0].lanes
        if lanes is None or not lanes.are_of(group):
            lanes = bind(group)
        lanes.run(*steps)
    return [_failure(wall) for wall in walls]


def bind(walls):
    """What moves these walls: the fast step all of them, or the plain one a single wall."""
    if all(wall.fast for wall in walls):
        return Lanes(walls)
    (wall,) = walls
    wall.lanes = Alone(wall)
    return wall.lanes


def _failure(wall):
    if math.isfinite(wall.system.force.sum()):
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
        self._law = Law(self.walls[0].material, THRESHOLD, _is_plain(self.tables))
        self._columns = self.tables.states.view(tables.REAL).reshape(*self.tables.states.shape, tables.STATE_FIELDS)
        self._blocks = make_blocks(self.tables.interfaces[0], self.tables.place.shape[1],
                                   self.tables.contacts.shape[1], self._width)
        self._samples = self.room(0)

    def are_of(self, walls):
        """Whether these are the walls, in this order, and still bound to these tables."""
        return len(walls) == len(self.walls) and all(
            one is other and one.lanes is self and one.fast for one, other in zip(walls, self.walls))

    def run(self, *steps):
        """Advance all walls by these numbers of steps, one after the other; `samples_of` gives what was after each."""
        for wall in self.walls:
            if wall.adaptive_damping == 0.0:
                wall.system.relaxation[:] = 0.0
        if len(steps) > self._samples.totals.shape[1]:
            self._samples = self.room(len(steps))
        ends = np.cumsum(steps)
        if self._width == 1:
            alone.run(self.tables, self._blocks, self._law, self._controls(), self._field(ends[-1] + 1),
                      self._clock()[0], ends, self.walls[0].stiffness, self._samples)
        else:
            together.run(self.tables, self._columns, self._blocks, self._law, self._controls(),
                         self._field(ends[-1] + 1), self._clock(), ends,
                         np.full(len(ends), (1 << len(self.walls)) - 1), self.walls[0].stiffness, self._samples,
                         np.zeros(len(self.walls), int))
        for wall in self.walls:
            wall.step += int(ends[-1])

    def room(self, n_samples):
        """Samples of all walls, empty."""
        return Samples.none(len(self.walls), n_samples, self.tables.contacts.shape[1], self.tables.place.shape[1] - 1)

    def samples_of(self, wall, which):
        """Samples of this wall after these of the last run's numbers of steps, a slice."""
        return self._samples.of(self.walls.index(wall), which)

    def find_forces(self, singly):
        """Forces at the present places without damping; and, if `singly`, stresses: then each contact by itself."""
        alone.find_forces(self.tables, self._blocks, self._law, self._clock()[0], singly, False)

    def _controls(self):
        return np.array([wall.controls for wall in self.walls], float)

    def _field(self, n_steps):
        """(walls, n_steps, 3) as ReferenceWall.field."""
        return np.array([wall.field(n_steps) for wall in self.walls])

    def _clock(self):
        return np.array([wall.step - wall.first_step for wall in self.walls])


def are_alike(wall, other):
    """Whether two walls have the same bricks, stiffnesses and friction, so that they can be lanes of one block."""
    one, two = wall.system, other.system
    return wall.material == other.material and len(one.contacts) == len(two.contacts) and all(
        np.array_equal(getattr(one, table)[name], getattr(two, table)[name], equal_nan=True)
        for table, names in (("interfaces", tables.SHARED), ("contacts", ("offset", "kn", "ks", "area")))
        for name in names)


def _is_plain(system):
    """Whether no contact softens or crushes."""
    contacts = system.contacts
    return bool(np.all(contacts["compressive_strength"] == np.inf) and not contacts["mode_i_energy"].any()
                and not contacts["mode_ii_energy"].any())


def _check(walls):
    """Raise ValueError of walls that differ in what lanes share."""
    for lane, wall in enumerate(walls[1:], 1):
        if not are_alike(walls[0], wall):
            raise ValueError(f"wall {lane} of those to step together has other bricks, stiffnesses or friction than "
                             "wall 0; step it by itself")


def _join(systems):
    """Tables of several walls with the wall as first axis; of one wall those that it has, seen so."""
    def join(name):
        arrays = [getattr(system, name) for system in systems]
        if len(arrays) == 1:
            return arrays[0][np.newaxis]
        if name not in ("events", "values"):
            return np.stack(arrays)
        joined = np.zeros((len(arrays), *arrays[0].shape), arrays[0].dtype)  # touches no more memory than there are
        for row, system in enumerate(systems):
            count = min(int(system.n_events[0]), len(arrays[row]))
            joined[row, :count] = arrays[row][:count]
        return joined

    return tables.System(*map(join, tables.System._fields))


def _lane(joined, lane):
    """The tables of one wall of those joined, as views."""
    return tables.System(*(array[lane] for array in joined))
