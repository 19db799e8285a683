"""Interface of `damage.run.solver` for the reference solver."""

import numpy as np

from damage.elementary import hypot, total
from damage.law.joint_law import SHEAR, TENSION
from damage.mechanics.samples import ELASTIC, KINETIC
from damage.mechanics.tables import LOGS, OPENED, RIGID, SHARED, SLIPPED, WORK, Tables
from damage.reference.wall import ReferenceWall
from damage.run.solver import LOOK_STEPS, Instants, Solver

EVENT_KINDS = {TENSION: "tension", SHEAR: "shear", OPENED: "opened", SLIPPED: "slipped"}


STATE_TABLES = (
    "place",
    "velocity",
    "force",
    "trig",
    "limits",
    "states",
    "readings",
    "energy",
    "relaxation",
    "bearings",
)
"""Fields of System that a step changes; masses, contact parameters, the log of events, and what
follows from the rest are left out."""


class ReferenceSolver(ReferenceWall, Solver):
    """A ReferenceWall as Solver of a Run; methods without a docstring:
    `damage.run.solver.Solver`."""

    stretch_samples = 60  # half of what is stored at once (`damage.history.buffer.CHUNK`)

    def start(self, base, gravity=None):
        """Start the ReferenceWall; input and dissipated energies are zero from here."""
        super().start(base, gravity)
        self.energy[:] = 0.0

    def damp(self, *, local=0.0, adaptive=0.0, alpha=0.0, beta=0.0, mean_1_s=0.0):
        self.local_damping = local
        self.adaptive_damping = adaptive
        self.alpha = alpha
        self.beta = beta
        self.mean_1_s = mean_1_s

    def set_velocities(self, velocities):
        self.velocity = velocities

    def advance(self, n_steps, sample_steps=None, on_samples=None, since=None):
        end = self.clock + n_steps
        if on_samples is None:
            while self.clock < end:
                yield self, end - self.clock
            return
        continues = self.clock > 0 or on_samples(self.instants())
        while continues and self.clock < end:
            ends = self._next_ends(sample_steps, end, self.clock if since is None else since)
            try:
                yield self, *np.diff(ends, prepend=self.clock).tolist()
            except ArithmeticError:
                # some may be of before the instability
                if len(samples := self._taken(ends, sample_steps)) > 1:
                    on_samples(self._instants_at(samples))
                raise
            samples = self._taken(ends, sample_steps)
            continues = not samples or on_samples(self._instants_at(samples))

    def _taken(self, ends, sample_steps):
        """{index in `ends`: step} of the samples taken, fewer than `ends` where the run ended
        early."""
        return {
            k: step
            for k, step in enumerate(ends)
            if step <= self.clock and step % sample_steps == 0
        }

    def _next_ends(self, sample_steps, end, since):
        """Steps of the next samples and checks, and the end; only the first where a run reacts to
        each sample."""

        def steps_of(first, interval):
            return range(self.clock - (self.clock - first) % interval + interval, end, interval)

        ends = sorted({*steps_of(0, sample_steps), *steps_of(since, LOOK_STEPS), end})
        # Prescribed velocities change at every sample.
        single = self._is_driven or self.system.bearings["stiffness"].any()
        return ends[:1] if single else ends

    def _instants_at(self, samples):
        """Instants of samples of the last `run`, {index of the end: step}."""
        steps = np.array([*samples.values()])
        rows = list(samples)
        return self._instants(steps, self.lanes.samples_of(self, rows[-1] + 1), rows)

    def instants(self):
        return self._instants(np.array([self.clock]), self.sample_now(), [0])

    def _instants(self, clock, samples, rows):
        """Instants of these rows of Samples, copied, taken at these steps; a pushed wall has one
        only, to which the present push force belongs."""
        totals = samples.totals[rows]
        moved = samples.displacement[rows]
        joints = self.active_contacts()
        n = self.layout.n_bodies
        contacts = {
            name: values[rows] for name, values in self.contact_data(samples, joints).items()
        }
        of_joints = samples.stress[rows][..., : self.layout.n_joints]
        stress = np.moveaxis(of_joints, 1, 2) if self.with_stresses else None
        input_j, friction_j, fracture_j, damping_j = totals[:, KINETIC + 1 : ELASTIC].T
        return Instants(
            clock=clock,
            displacement=moved[:, :n, :RIGID],
            support_displacement=moved[:, n:, :RIGID],
            support_force=samples.support_force[rows],
            joints=joints,
            contacts=contacts,
            top_force_n=np.full(len(clock), self.push_force()),
            kinetic_j=totals[:, KINETIC],
            elastic_j=total(samples.stored)[rows] + totals[:, ELASTIC] + self._in_bearing(),
            input_j=input_j - self._in_springs(moved[:, :n]),
            friction_j=friction_j,
            fracture_j=fracture_j,
            damping_j=damping_j,
            joint_stress_pa=stress,
        )

    def _in_bearing(self):
        """Elastic energy of the bearing of a restrained top [J]; such a wall has one sample at a
        time."""
        stiffness = self.system.bearings["stiffness"]
        force = self.system.bearings["force"]
        in_bearing = stiffness > 0
        return 0.5 * float(np.sum(force[in_bearing] ** 2 / stiffness[in_bearing]))

    def _in_springs(self, displacement):
        """Elastic energy in the rotational springs between the moved top and the wall, (n,) [J]:
        work of the push that did not enter the wall."""
        stiffness, _, rest = self.system.turning[: displacement.shape[1]].T
        return 0.5 * np.sum((displacement[..., RIGID - 1] - rest) ** 2 * stiffness, axis=-1)

    def forces(self):
        return (
            self.force[: self.layout.n_bodies],
            hypot(*self.stresses) * self.system.contacts["area"],
        )

    def base_reaction(self):
        return self.base_force()[1]

    def saved_state(self):
        return {name: np.ascontiguousarray(getattr(self.system, name)) for name in STATE_TABLES}

    def resume(self, state):
        for name in STATE_TABLES:
            getattr(self.system, name)[:] = state[name]
        self.lanes.confine(self)

    def _whole(self):
        """Views of all tables of this wall that outlast a step, {name: array}."""
        tables = self.lanes.tables
        lane = self.lanes.lane_of(self)
        return {
            name: values[lane] if name in LOGS else values[..., lane]
            for name, values in zip(Tables._fields, tables)
            if name not in SHARED + WORK
        }

    def checkpoint(self):
        count = dict.fromkeys(("events", "values"), int(self.system.n_events[0]))
        return {
            name: np.array(table[: count.get(name)], order="C")
            for name, table in self._whole().items()
        } | {"clock": np.array(self.clock), "is_driven": np.array(self._is_driven)}

    def restore(self, tables):
        for name, table in self._whole().items():
            table[: len(tables[name])] = tables[name]
        self.step = self.first_step + int(tables["clock"])
        self._is_driven = bool(tables["is_driven"])

    def drain_events(self):
        if self.system.n_events[0] == 0:
            return []  # the usual case
        return [
            (int(step), int(joint), EVENT_KINDS[kind], *values)
            for step, joint, kind, values in zip(*super().drain_events())
        ]
