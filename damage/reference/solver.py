"""The reference solver's side of a run: the verbs of `damage.run.solver` for a ReferenceWall."""

import numpy as np

from damage.mechanics.loose import LARGEST
from damage.mechanics.samples import KINETIC
from damage.mechanics.tables import OPENED, SLIPPED, X, Z
from damage.reference.wall import ReferenceWall
from damage.run.solver import LOOK_STEPS, Instants, Solver
from damage.wall.joint_law import SHEAR, TENSION

EVENT_KINDS = {TENSION: "tension", SHEAR: "shear", OPENED: "opened", SLIPPED: "slipped"}


class ReferenceSolver(ReferenceWall, Solver):
    """A ReferenceWall that a Run can move; `Solver` says what each verb does."""

    stretch_samples = 28  # some two thousand steps

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
        self.system.place[:len(self.layout.bodies), X:Z + 1] += offsets
        self.refresh()

    def set_velocities(self, velocities):
        self.velocity = velocities

    def advance(self, n_steps, sample_steps=None, on_samples=None, since=None):
        end = self.clock + n_steps
        if on_samples is None:
            while self.clock < end:
                yield self, end - self.clock
            return
        goes_on = self.clock > 0 or on_samples(self.instants())
        while goes_on and self.clock < end:
            ends = self._next_ends(sample_steps, end, self.clock if since is None else since)
            try:
                yield self, *np.diff(ends, prepend=self.clock).tolist()
            except ArithmeticError:
                if len(samples := self._taken(ends, sample_steps)) > 1:  # some may be of before it blew up
                    on_samples(self._instants_at(samples))
                raise
            samples = self._taken(ends, sample_steps)
            goes_on = not samples or on_samples(self._instants_at(samples))

    def _taken(self, ends, sample_steps):
        """Which of these ends were samples, of those that the wall has come to: maybe fewer than it asked for."""
        return {k: step for k, step in enumerate(ends) if step <= self.clock and step % sample_steps == 0}

    def _next_ends(self, sample_steps, end, since):
        """The next samples and looks, and the end; only the next of these where a sample has to be looked at there and
        then."""
        def steps_of(first, interval):
            return range(self.clock - (self.clock - first) % interval + interval, end, interval)

        ends = sorted({*steps_of(0, sample_steps), *steps_of(since, LOOK_STEPS), end})
        # Prescribed velocities change at every sample; events of parallel elements are known at the sample alone.
        return ends[:1] if self._is_driven or self.layout.fibres is not None else ends

    def _instants_at(self, samples):
        """Instants of those ends of the last `run` that are samples, {number of the end: step}."""
        return self._instants(np.array([*samples.values()]), self.lanes.samples_of(self, list(samples)))

    def instants(self):
        return self._instants(np.array([self.clock]), self.sample_now())

    def _instants(self, clock, samples):
        """Instants of Samples at these steps; the top is held of the last one, which is the only one then."""
        totals, joints = samples.totals, self.active_contacts()
        bodies, supports = np.split(samples.displacement, [len(self.layout.bodies)], axis=1)
        return Instants(clock, bodies, supports, samples.support_force, joints, self.contact_data(samples, joints),
                        np.full(len(clock), self.push_force()), totals[:, KINETIC],
                        np.add.reduce(samples.stored, axis=1) + samples.loose, *totals[:, KINETIC + 1:].T)

    def forces(self):
        return self.force[:len(self.layout.bodies)], np.hypot(*self.stresses) * self.system.contacts["area"]

    def largest_overlap_m(self):
        loose = self.loose
        return (loose.energy[LARGEST], 2 * loose.touch.radius) if len(loose.cores) else None

    def base_reaction(self):
        return self.base_force()[1]

    def drain_events(self):
        if self.layout.fibres is None and self.system.n_events[0] == 0:
            return []  # as of most samples
        return [(int(step), int(joint), EVENT_KINDS[kind], *values)
                for step, joint, kind, values in zip(*super().drain_events())]
