"""Walls that step together, in lockstep: one vector instruction does for eight what it would do for one.

    run_together([wall, another, ...], 70, 70, 10)     # each as wall.run would, to the same bits

Walls are ReferenceWalls of any state, motion, strength, damping and time step that share bricks, joints' places and
stiffnesses, and friction.  Each stays a wall of its own: its tables are views on those of its lanes, and it may be
read, changed and run alone at any time.  Lanes are made anew where the walls that are asked for are not those of the
last time, so that a wall that has ended is simply left out.
"""

import hashlib

import numpy as np

from damage.index import THRESHOLD
from damage.mechanics import tables
from damage.reference.fast import alone, together
from damage.reference.fast.blocks import make_blocks
from damage.reference.fast.step import Law
from damage.reference.plain import Alone

MOST_LANES = 8
"""Walls that one block holds; more are moved in groups of so many."""
SHARED = ("interfaces", tables.SHARED), ("contacts", ("offset", "kn", "ks", "area"))
"""Columns of the tables that are equal in all walls of a block."""


def run_together(walls, *steps):
    """Advance walls as `ReferenceWall.run` does; returns for each None, or the error that ends it.

    ValueError where they are not of the same bricks and stiffnesses.
    """
    return advance_together([(wall, steps) for wall in walls])


def advance_together(asked):
    """Advance walls by steps of their own, which are as many for all; returns as `run_together`.

    asked: (wall, numbers of steps) of each.
    """
    most = MOST_LANES if all(wall.fast for wall, _ in asked) else 1
    for first in range(0, len(asked), most):
        walls, steps = zip(*asked[first:first + most])
        lanes = walls[0].lanes
        if lanes is None or not lanes.are_of(walls):
            lanes = bind(walls)
        lanes.run(*steps)
    return [wall.failure() for wall, _ in asked]


def bind(walls):
    """What moves these walls: the fast step all of them, or the plain one a single wall.

    Walls whose bodies find new contacts do not qualify for the fast step: they are not `fast`."""
    if all(wall.fast for wall in walls):
        return Lanes(walls)
    (wall,) = walls
    wall.lanes = Alone(wall)
    return wall.lanes


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
        """Advance the walls by their numbers of steps, a sequence of each; `samples_of` gives what was after each."""
        for wall in self.walls:
            if wall.adaptive_damping == 0.0:
                wall.system.relaxation[:] = 0.0
        if (longest := max(map(len, steps))) > self._samples.totals.shape[1]:
            self._samples = self.room(longest)
        ends = [np.cumsum(of_wall) for of_wall in steps]
        last = int(ends[0][-1])
        if any(of_wall[-1] != last for of_wall in ends):
            raise ValueError(f"walls asked to go {sorted({int(one[-1]) for one in ends})} steps together: expected "
                             "equally many")
        how = self._law, self._controls(), self._field(last + 1)
        if self._width == 1:
            alone.run(self.tables, self._blocks, *how, self._clock()[0], ends[0], self.walls[0].stiffness,
                      self._samples)
        else:
            together.run(self.tables, self._columns, self._blocks, *how, self._clock(), *_in_turn(ends),
                         self.walls[0].stiffness, self._samples, np.zeros(len(self.walls), int))
        for wall in self.walls:
            wall.step += last

    def room(self, n_samples):
        """Samples of all walls, empty."""
        return self.walls[0].room(len(self.walls), n_samples)

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
        for table, names in SHARED for name in names)


def kind_of(wall):
    """What walls have in common that are `are_alike`, in short."""
    parts = [np.ascontiguousarray(getattr(wall.system, table)[name]).tobytes()
             for table, names in SHARED for name in names]
    return wall.fast, wall.material, hashlib.sha256(b"".join(parts)).digest()


def _in_turn(ends):
    """The steps at which any wall ends, and the walls that do (bits)."""
    steps = np.unique(np.concatenate(ends))
    return steps, sum(np.isin(steps, of_wall) << lane for lane, of_wall in enumerate(ends)).astype(np.int64)


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
