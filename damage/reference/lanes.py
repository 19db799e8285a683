"""Batches: a wall by itself, or up to eight that advance together, one in each SIMD lane of the
vector instructions.

    run_together([wall, another, ...], 70, 70, 10)     # each as wall.run would, to the same bits

Members are ReferenceWalls with equal bricks and joint positions; state, motion, stiffnesses,
friction, strengths, damping and time step may differ.  The tables of a member are views of the
tables of its batch (`Lanes`), so that it can be read, changed and run alone at any time.  A batch
is built anew where the walls differ from those of the last call, so that walls that have ended are
left out.
"""

import hashlib
import weakref

import numpy as np

from damage.index import THRESHOLD
from damage.mechanics import step as kernel
from damage.mechanics import tables
from damage.mechanics.factor import matrix_of
from damage.mechanics.samples import Samples, Sampling
from damage.mechanics.simd import EIGHT, ONE, WIDTH, bits
from damage.run.cooperative import WAITED

MOST_LANES = WIDTH
"""Largest number of walls in a batch: the SIMD lanes of a vector (`damage.mechanics.simd`)."""


def run_together(walls, *steps):
    """Advance walls by the same numbers of steps, as `ReferenceWall.run`.

    Returns for each None, or the FloatingPointError that ends it.  Raises ValueError where their
    bricks differ.
    """
    return advance_together([(wall, steps) for wall in walls])


def advance_together(asked):
    """Advance walls until the first has taken all of its steps; returns and raises as
    `run_together`, of the others WAITED: they go on where they are asked for the same steps again.

    asked: (wall, numbers of steps) of each.
    """
    for first in range(0, len(asked), MOST_LANES):
        walls, steps = zip(*asked[first : first + MOST_LANES])
        lanes = walls[0].lanes
        if not lanes.are_of(walls):
            lanes = Lanes(walls)
        lanes.run(*steps)
    return [WAITED if wall.taken else wall.failure() for wall, _ in asked]


class Lanes:
    """Batch of up to eight walls, whose tables become views of the tables of the batch.

    Raises ValueError where their bricks differ.
    """

    def __init__(self, walls, built=None):
        """built: Tables of a single wall that has none yet."""
        # which hold this object: no cycle keeps the tables
        self._walls = [weakref.ref(wall) for wall in walls]
        self._kind = None if len(walls) == 1 else _common_kind(walls)
        self._n = ONE if len(walls) == 1 else EIGHT
        self.tables = built or tables.join(
            [(wall.lanes.tables, wall.lanes.lane_of(wall)) for wall in walls]
        )
        for w, wall in enumerate(walls):
            wall.system = tables.system_of(self.tables, w)
            wall.lanes = self
        masses = [wall.mass for wall in walls]
        width = self.tables.bench.shape[2]
        matrix = masses[0] and matrix_of(masses, width)
        strength = np.concatenate([wall.cuts.strength for wall in walls])
        cuts = walls[0].cuts._replace(strength=strength)
        self._model, self._of_forces = (
            tables.Model(THRESHOLD, walls[0].strain, array, cuts) for array in (matrix, None)
        )
        self._sampling = self.room(0)

    @property
    def kind(self):
        """`kind_of` each of the walls; of a single one worked out where it is asked for first."""
        self._kind = self._kind or kind_of(next(filter(None, self.walls)))
        return self._kind

    @property
    def walls(self):
        """The walls, None where one is in use no longer."""
        return [wall() for wall in self._walls]

    def lane_of(self, wall):
        """Place of a wall in the tables."""
        return self.walls.index(wall)

    def are_of(self, walls):
        """Whether the batch consists of these walls, in this order, all still bound to it."""
        return len(walls) == len(self._walls) and all(
            wall is other and wall.lanes is self for wall, other in zip(walls, self.walls)
        )

    def run(self, *steps):
        """Advance the walls by their numbers of steps, a sequence for each, until the first has
        taken all; `samples_of` returns the samples."""
        walls = self.walls
        begin = bits(np.array([wall.taken == 0 for wall in walls]))
        for wall in walls:
            if wall.taken == 0:
                wall.earlier.clear()
            if wall.adaptive_damping == 0.0:
                wall.system.relaxation[:] = 0.0
        longest = max(map(len, steps))
        room = self._sampling.samples
        if longest > room.totals.shape[1] or (
            any(wall.with_stresses for wall in walls) and not room.stress.shape[3]
        ):
            self._sampling = self.room(longest)
        ends = [np.cumsum(of_wall) - wall.taken for wall, of_wall in zip(walls, steps)]
        last = int(min(of_wall[-1] for of_wall in ends))
        if last == 0:
            return
        self._sampling.taken[:] = 0
        field = np.array([wall.field(last + 1) for wall in walls])
        (clock, controls) = self._now()
        kernel.advance(
            self._n,
            self.tables,
            self._model,
            controls,
            field,
            clock,
            begin,
            _in_turn([of_wall[(0 < of_wall) & (of_wall <= last)] for of_wall in ends]),
            self._sampling,
        )
        for wall, of_wall in zip(walls, ends):
            wall.step += last
            wall.taken = wall.taken + last if of_wall[-1] > last else 0
            if wall.taken:
                wall.earlier.append(type(now := self._samples_now(wall))(*map(np.copy, now)))

    def _now(self):
        """(walls,) steps since `start` and (walls, 6) `controls`; for a wall in use no longer those
        of another."""
        any_wall = next(filter(None, self.walls))
        walls = [wall or any_wall for wall in self.walls]
        return np.array([wall.clock for wall in walls]), np.array(
            [wall.controls for wall in walls], float
        )

    def room(self, n_samples):
        """Sampling of all walls, all zero."""
        walls = list(filter(None, self.walls))
        n_supports = len(walls[0].layout.supports)
        with_stresses = any(wall.with_stresses for wall in walls)
        samples = Samples.none(
            len(self._walls), n_samples, walls[0].system, n_supports, with_stresses
        )
        return Sampling(samples, np.zeros(len(self._walls), int))

    def samples_of(self, wall, count):
        """The first samples of the steps that a wall was asked for last, views that the next `run`
        overwrites."""
        parts = [*wall.earlier, self._samples_now(wall)]
        if len(parts) == 1:
            return self._sampling.samples.of_wall(self.lane_of(wall), count)
        return Samples(*(np.concatenate(of_parts)[:count] for of_parts in zip(*parts)))

    def _samples_now(self, wall):
        """Samples of a wall from the last `run`, its stresses where it has them."""
        w = self.lane_of(wall)
        samples = self._sampling.samples.of_wall(w, self._sampling.taken[w])
        return samples if wall.with_stresses else samples._replace(stress=samples.stress[..., :0])

    def sample_now(self, wall, field):
        """Samples with a single sample of a wall, of the present time; field: (3,) acceleration of
        the base and gravity."""
        sampling = self.room(1)
        w = self.lane_of(wall)
        field = np.tile(field, (len(self._walls), 1, 1))
        kernel.look(self._n, self.tables, self._model, self._now()[1], field, 0, 1 << w, sampling)
        return sampling.samples.of_wall(w, 1)

    def confine(self, wall):
        """Bring what the cuts through a wall's bricks bear up to date with its last readings."""
        kernel.confine(self._n, self.tables, self._model.cuts, 1 << self.lane_of(wall))

    def find_forces(self, singly=True):
        """Forces of a single wall at the present displacements without damping; if singly, by
        contact points and with readings."""
        holds = bool(self.tables.turning[:, tables.SPRING_STIFFNESS].any())
        kernel.find_forces(
            self._n,
            self.tables,
            self._of_forces,
            kernel.Asked(
                self._now()[0], 0, walls=1, ending=int(singly), damped=False, holds=holds, since=0.0
            ),
        )


def kind_of(wall):
    """Key that is equal for walls that can be members of one batch: a digest of the arrays of
    bricks, strain modes and couplings of the scaled mass that all of them share."""
    system = wall.system
    of_modes = (system.mass[:, tables.RIGID :], *wall.strain) if wall.strain else ()
    shared = [
        *(
            table[name]
            for table in (system.interfaces, system.contacts)
            for name in table.dtype.names
        ),
        *of_modes,
        *wall.cuts[:-1],
        np.array([len(system.bearings)]),
        *(wall.mass.matrix[:6] if wall.mass else ()),
    ]
    parts = [np.ascontiguousarray(values).tobytes() for values in shared]
    return hashlib.sha256(b"".join(parts)).digest()


def _in_turn(ends):
    """Steps at which any wall ends, and the walls that do as bits, (n, 2)."""
    steps = np.unique(np.concatenate(ends))
    walls = np.zeros(len(steps), np.int64)
    for lane, of_wall in enumerate(ends):
        walls[np.searchsorted(steps, of_wall)] |= 1 << lane
    return np.column_stack([steps, walls])


def _common_kind(walls):
    """The `kind_of` that all walls of a batch have; ValueError where they cannot be in one."""
    first, *others = map(kind_of, walls)
    for lane, kind in enumerate(others, 1):
        if kind != first:
            raise ValueError(
                f"wall {lane} of those to step together has other bricks than wall 0; step it by"
                " itself"
            )
    return first
