"""A wall that advances by the plain step."""

import weakref

import numpy as np

from damage.index import THRESHOLD
from damage.mechanics import step as plain
from damage.mechanics import tables


class Alone:
    """A single wall, with the methods of `damage.reference.lanes.Lanes`."""

    def __init__(self, wall):
        self._wall = weakref.ref(wall)  # which holds this object: no cycle keeps the tables
        self._law = tables.Law(wall.material, THRESHOLD, wall.strain)
        self._scratch = tables.Scratch(np.zeros(len(wall.system.interfaces), np.int64), np.zeros((5, plain.PARTS)))
        self._samples = self._room(0)

    @property
    def wall(self):
        """The wall."""
        return self._wall()

    def are_of(self, walls):
        """Whether `walls` is this wall alone, still bound to this object and to the plain step."""
        same = len(walls) == 1 and walls[0] is self.wall and self.wall.lanes is self
        return same and not (self.wall.fast and self.wall.layout.strain is None)

    def run(self, steps):
        """Advance by numbers of steps, one after the other; `samples_of` returns the samples after each."""
        wall = self.wall
        if wall.adaptive_damping == 0.0:
            wall.system.relaxation[:] = 0.0
        if len(steps) > self._samples.totals.shape[1]:
            self._samples = self._room(len(steps))
        ends = np.cumsum(steps)
        plain.run(wall.system, self._law, tables.Controls(*map(float, wall.controls)), wall.field(ends[-1] + 1),
                  wall.step - wall.first_step, ends, self._scratch, wall.stiffness, self._samples, 0,
                  wall.loose)
        wall.step += int(ends[-1])

    def samples_of(self, wall, which):
        """Samples of the last `run`; which: slice or indices of its numbers of steps."""
        return self._samples.of(0, which)

    def find_forces(self, singly):
        """Forces at the present displacements without damping; if singly, with the readings."""
        self.wall.system.force[:] = 0.0
        undamped = tables.Controls(0.0, 0.0, 0.0, 0.0, 0.0)
        plain.find_forces(self.wall.system, self._law, undamped, self.wall.step - self.wall.first_step, singly,
                          self._scratch, self.wall.loose, 0.0)

    def _room(self, n_samples):
        return self.wall.room(1, n_samples)
