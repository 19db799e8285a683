"""Batches: up to eight walls advance together, one in each SIMD lane of the vector instructions.

    run_together([wall, another, ...], 70, 70, 10)     # each as wall.run would, to the same bits

Members are ReferenceWalls with equal bricks, joint positions, stiffnesses and friction; state, motion, strengths,
damping and time step may differ.  The tables of a member are views of the tables of its batch (`Lanes`), so that it can
be read, changed and run alone at any time.  A batch is built anew where the walls differ from those of the last call,
so that walls that have ended are left out.
"""

import hashlib
import weakref

import numpy as np

from damage.index import THRESHOLD
from damage.mechanics import tables
from damage.reference.fast import alone, deforming, together
from damage.reference.fast.blocks import make_blocks
from damage.reference.fast.modes import make_modes
from damage.reference.fast.step import Law
from damage.reference.plain import Alone

MOST_LANES = 8
"""Largest number of walls in a batch: the SIMD lanes of a vector (`damage.mechanics.eight`)."""
SHARED = ("interfaces", tables.SHARED), ("contacts", ("offset", "kn", "ks", "area"))
"""(table, columns) that are equal in all walls of a batch."""


def run_together(walls, *steps):
    """Advance walls by the same numbers of steps, as `ReferenceWall.run`.

    Returns for each None, or the FloatingPointError that ends it.  Raises ValueError where they differ in bricks,
    stiffnesses or friction.
    """
    return advance_together([(wall, steps) for wall in walls])


def advance_together(asked):
    """Advance walls by different numbers of steps with equal sums; returns and raises as `run_together`.

    asked: (wall, numbers of steps) of each; ValueError, too, where the sums differ.
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
    """Bind walls to what advances them: Lanes with the fast step, or Alone with the plain step for a single wall.

    A single wall with deformable bricks takes the plain step, which is as fast as a batch of eight lanes.
    """
    if all(wall.fast for wall in walls) and walls[0].layout.strain is None:
        return Lanes(walls)
    if all(wall.fast for wall in walls) and len(walls) > 1:
        return DeformingLanes(walls)
    (wall,) = walls
    wall.lanes = Alone(wall)
    return wall.lanes


class Lanes:
    """Batch of up to eight walls, whose tables become views of the joined tables of the batch.

    Raises ValueError where the walls differ in bricks, stiffnesses or friction.
    """

    def __init__(self, walls):
        self._walls = [weakref.ref(wall) for wall in walls]  # which hold this object: no cycle keeps the tables
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

    @property
    def walls(self):
        """The walls, None where one is in use no longer."""
        return [wall() for wall in self._walls]

    def are_of(self, walls):
        """Whether the batch consists of these walls, in this order, all still bound to it."""
        return len(walls) == len(self.walls) and all(
            one is other and one.lanes is self and one.fast for one, other in zip(walls, self.walls))

    def run(self, *steps):
        """Advance the walls by their numbers of steps, a sequence for each; `samples_of` returns the samples.

        Raises ValueError where their sums differ.
        """
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
        self._advance(how, ends)
        for wall in self.walls:
            wall.step += last

    def _advance(self, how, ends):
        """Advance to the steps `ends`; how: Law, controls and field."""
        if self._width == 1:
            alone.run(self.tables, self._blocks, *how, self._clock()[0], ends[0], self.walls[0].stiffness,
                      self._samples)
        else:
            together.run(self.tables, self._columns, self._blocks, *how, self._clock(), *_in_turn(ends),
                         self.walls[0].stiffness, self._samples, np.zeros(len(self.walls), int))

    def room(self, n_samples):
        """Samples of all walls, all zero."""
        return self.walls[0].room(len(self.walls), n_samples)

    def samples_of(self, wall, which):
        """Samples of a wall from the last `run`; which: slice or indices of its numbers of steps."""
        return self._samples.of(self.walls.index(wall), which)

    def find_forces(self, singly):
        """Forces at the present displacements without damping; if singly, by contact points and with readings."""
        alone.find_forces(self.tables, self._blocks, self._law, self._clock()[0], singly, False)

    def _controls(self):
        """(walls, 5) as of damage.mechanics.tables.Controls."""
        return np.array([wall.controls for wall in self.walls], float)

    def _field(self, n_steps):
        """(walls, n_steps, 3) as of ReferenceWall.field."""
        return np.array([wall.field(n_steps) for wall in self.walls])

    def _clock(self):
        """(walls,) steps since the last `start` of each."""
        return np.array([wall.step - wall.first_step for wall in self.walls])


class DeformingLanes(Lanes):
    """Batch of walls with deformable bricks, eight SIMD lanes wide."""

    def __init__(self, walls):
        super().__init__(walls)
        wall, n_contacts = self.walls[0], self.tables.contacts.shape[1]
        self._blocks = make_blocks(self.tables.interfaces[0], self.tables.place.shape[1], n_contacts, MOST_LANES)
        self._modes = make_modes(self.tables.place.shape[1], wall.strain.shapes.shape[2],
                                 self.tables.interfaces.shape[1], n_contacts)

    def _advance(self, how, ends):
        wall, (law, controls, field) = self.walls[0], how
        deforming.run(self.tables, self._columns, self._blocks, self._modes,
                      tables.Law(law.material, law.threshold, wall.strain), law.plain, controls, field, self._clock(),
                      *_in_turn(ends), wall.stiffness, self._samples, np.zeros(len(self.walls), int))


def are_alike(wall, other):
    """Whether two walls have equal bricks, stiffnesses and friction, so that they can be members of one batch."""
    return wall.material == other.material and all(
        np.array_equal(one, two, equal_nan=True) for one, two in zip(_shared(wall), _shared(other)))


def kind_of(wall):
    """Key that is equal for walls that are `are_alike`: step, material and a digest of what is shared."""
    parts = [np.ascontiguousarray(values).tobytes() for values in _shared(wall)]
    return wall.fast, wall.material, hashlib.sha256(b"".join(parts)).digest()


def _shared(wall):
    """Arrays that are equal in all walls of a batch."""
    of_modes = (wall.system.mass[:, tables.RIGID:], *wall.strain) if wall.layout.strain else ()
    return [*(getattr(wall.system, table)[name] for table, names in SHARED for name in names), *of_modes]


def _in_turn(ends):
    """Steps at which any wall ends, (n,), and the walls that do as bits, (n,)."""
    steps = np.unique(np.concatenate(ends))
    return steps, sum(np.isin(steps, of_wall) << lane for lane, of_wall in enumerate(ends)).astype(np.int64)


def _is_plain(system):
    """Whether no contact softens or crushes."""
    contacts = system.contacts
    return bool(np.all(contacts["compressive_strength"] == np.inf) and not contacts["mode_i_energy"].any()
                and not contacts["mode_ii_energy"].any())


def _check(walls):
    """Raise ValueError where the walls cannot be in one batch."""
    for lane, wall in enumerate(walls[1:], 1):
        if not are_alike(walls[0], wall):
            raise ValueError(f"wall {lane} of those to step together has other bricks, stiffnesses or friction than "
                             "wall 0; step it by itself")


def _join(systems):
    """Tables of several walls stacked along a first axis; of a single wall, views with a first axis of length one."""
    def join(name):
        arrays = [getattr(system, name) for system in systems]
        if len(arrays) == 1:
            return arrays[0][np.newaxis]
        if name not in ("events", "values"):
            return np.stack(arrays)
        joined = np.zeros((len(arrays), *arrays[0].shape), arrays[0].dtype)  # untouched rows take no memory
        for row, system in enumerate(systems):
            count = min(int(system.n_events[0]), len(arrays[row]))
            joined[row, :count] = arrays[row][:count]
        return joined

    return tables.System(*map(join, tables.System._fields))


def _lane(joined, lane):
    """Views of the tables of one wall of a batch."""
    return tables.System(*(array[lane] for array in joined))
