"""Inside YADE: the smallest spandrel of paper/repeated_loading.py, which starts this; argument: the
table's file."""

import sys

import numpy as np

from damage.mechanics.tables import RIGID, Z
from damage.units import GRAVITY
from paper.repeated_loading import Spandrel, compared
from yade_scripts.leaving import run_and_leave
from yade_scripts.solver import YadeSolver


class SpandrelInYade(Spandrel):
    """A Spandrel in YADE, without damping proportional to stiffness, which YADE does not have."""

    def _make_wall(self, time_step):
        self.wall = YadeSolver(self.layout, time_step)
        self.wall.start(np.zeros((0, 2)), np.array([GRAVITY]))
        self.wall.damp(local=0.7)

    def advance(self, time_s):
        """Advance as a Specimen."""
        self.wall.advance(max(1, round(time_s / self.wall.time_step)), 10**9, lambda _: True)

    def cracks(self):
        """Empty: the solvers are compared by force alone."""
        return {}

    def _drop(self, supports):
        """Move them down by 5 mm within 5 ms."""
        self._move(supports, -1.0)
        self.advance(5e-3)
        self._move(supports, 0.0)

    def _move(self, supports, speed):
        velocities = np.zeros((len(self.layout.supports), RIGID))
        velocities[supports, Z] = speed
        self.wall.move_supports(velocities)

    def _hold(self, bodies):
        for body in bodies:
            state = self.wall.scene.states[body]
            state.blockedDOFs = "yzXZ"
            state.vel = (state.vel[0], 0.0, 0.0)
            self.wall.scene.follows[body, 1] = 0.0

    def _places(self):
        return self.wall.scene.motion(self._ends)

    @property
    def force(self):
        """Force as of Spandrel."""
        return -float(self.wall.instants().support_force[0, self._pushed, 1].sum())


run_and_leave(lambda: compared(SpandrelInYade).to_csv(sys.argv[1], index=False))
