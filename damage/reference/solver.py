"""The reference solver's side of a run: the verbs of `damage.run.solver` for a ReferenceWall."""

import numpy as np

from damage.reference.tables import OPENED, SLIPPED
from damage.reference.wall import ReferenceWall
from damage.run.solver import Instant, Solver
from damage.wall.joint_law import SHEAR, TENSION

EVENT_KINDS = {TENSION: "tension", SHEAR: "shear", OPENED: "opened", SLIPPED: "slipped"}


class ReferenceSolver(ReferenceWall, Solver):
    """A ReferenceWall that a Run can move; `Solver` says what each verb does."""

    @property
    def clock(self):
        """Steps since `start`."""
        return self.step - self.first_step

    def start(self, base, gravity=None):
        """As ReferenceWall.start; what came in and was dissipated counts from here."""
        super().start(base, gravity)
        self.energy[:] = 0.0

    def damp(self, *, local=0.0, adaptive=0.0, alpha=0.0, beta=0.0):
        self.local_damping, self.adaptive_damping, self.alpha, self.beta = local, adaptive, alpha, beta

    def shift(self, offsets):
        for name, offset in zip("xz", np.transpose(offsets)):
            self.system.place[name][:-1] += offset
        self.refresh()

    def set_velocities(self, velocities):
        self.velocity = velocities

    def advance(self, n_steps, sample_steps=None, on_sample=None):
        if on_sample is None:
            yield self, n_steps
            return
        end, goes_on = self.clock + n_steps, self.clock > 0 or on_sample()
        while goes_on and self.clock < end:
            yield self, min(sample_steps - self.clock % sample_steps, end - self.clock)
            goes_on = self.clock % sample_steps > 0 or on_sample()

    def instant(self, base_acceleration):
        input_j, friction_j, fracture_j, damping_j = self.energy.tolist()
        told, kinetic_j = self._observed(base_acceleration)
        opening, slip, offset, state, stored, displacement = told
        return Instant(displacement, self._of_joints(opening), self._of_joints(slip), self._of_joints(offset),
                       self._state_of_joints(state), self.base_force()[0], self.push_force(), kinetic_j,
                       float(np.add.reduce(stored)), input_j, friction_j, fracture_j, damping_j)

    def forces(self):
        return self.force[:-1], np.hypot(*self.stresses) * self.system.joints["area"]

    def base_reaction(self):
        return self.base_force()[1]

    def drain_events(self):
        if self.layout.fibres is None and self.system.n_events[0] == 0:
            return []  # as of most samples
        return [(int(step), int(joint), EVENT_KINDS[kind], *values)
                for step, joint, kind, values in zip(*super().drain_events())]
