"""Samples of a run: rows of its series, snapshots, events and energies since time zero."""

import math

import numpy as np

from damage.elementary import total
from damage.history.buffer import SNAPSHOT_SAMPLES
from damage.index import damage_index
from damage.measure.energy import Balance, noise_j
from damage.run import monitor
from damage.run.initial_state import with_zero, zero_of
from damage.run.settings import SELECTIVE
from damage.run.solver import NO_MOTION
from damage.units import GRAVITY


class Sampler:
    """Writes the samples of a run into its history.

    layout, settings, solver, writer, state: as of `damage.run.run.Run`; zero_step: the solver's
    clock at time zero.

    zero: Instants at the end of the static stage, from which displacements and energies count; None
    before
    base: acceleration of the base, a row a step (n_steps, 2 or 3) [m/s2]
    at_rest: `motion` at the end of settling, or where a push begins
    set_in_motion_j: energy that came in at time zero [J]
    count: number of samples so far
    last: `snapshot` of the last one, not its Instants, which share the memory of many
    collapsed_at_s: when the first brick had fallen, None where none has
    """

    def __init__(self, layout, settings, solver, writer, state, zero_step):
        self._layout = layout
        self._settings = settings
        self._solver = solver
        self._writer = writer
        self._zero_step = zero_step
        self.base = NO_MOTION
        self.zero = None
        self.at_rest = 0.0
        self.set_in_motion_j = 0.0
        self.count = 0
        self.last = None
        self.collapsed_at_s = None
        moves = settings.ground_moves or bool(state and state["base_moves"])
        self._base_motions = [monitor.BaseMotion(layout, *base) for base in layout.bases if moves]
        self._borne = monitor.Borne(layout) if settings.mass_scaling == SELECTIVE else None
        # of damping that the solver does not compute
        self._balance_j, self._damped_j = (
            state["inferred_j"] if state and "inferred_j" in state else (0.0, 0.0)
        )
        self._balance = Balance(noise_j(layout.total_mass, layout.wall.built_height))

    @property
    def carried(self):
        """What a run that continues needs beside the solver's state, {name: array}."""
        return with_zero(
            {
                "set_in_motion_j": np.array(self.set_in_motion_j),
                "base_moves": np.array(bool(self._base_motions)),
            },
            self.zero or self._solver.instants(),
        )

    def tables(self):
        """What the next samples depend on, {name: array}, for a checkpoint."""
        now = self._solver.instants()
        return self.carried | {
            "samples": np.array(self.count),
            "inferred_j": np.array([self._balance_j, self._damped_j], float),
            "balance": self._balance.state,
            "at_rest": np.zeros_like(now.displacement) + self.at_rest,
        }

    def restore(self, tables):
        """Go back to where a checkpoint was written."""
        self.count = int(tables["samples"])
        self.zero = zero_of(tables, self.zero)
        self.set_in_motion_j = float(tables["set_in_motion_j"])
        now = self._solver.instants()
        self.last = self.snapshot(float(self.time_s(now)[-1]), now, self.motion(now), -1)
        self._balance_j, self._damped_j = tables["inferred_j"].tolist()
        self._balance.state = tables["balance"]
        self.at_rest = tables["at_rest"]

    def begin(self, base, state):
        """Count from now on, or as the state of another run does; base: as of the class."""
        self.base = base
        now = self.zero = self._solver.instants()
        if state is not None:
            self.zero = zero_of(state, now)
            self.set_in_motion_j = float(state["set_in_motion_j"])
        self.last = self.snapshot(0.0, now, self.motion(now), -1)

    @property
    def energy_error(self):
        """Energy balance error of the samples so far, `damage.measure.energy.energy_error` [-],
        None where hardly anything came in."""
        return self._balance.error

    def index(self, now):
        """The damage index at the last of these Instants, slip by displacement."""
        _, drift = self.top_and_drift(self.motion(now))
        length = self._layout.joint_length
        index = damage_index(
            self.time_s(now)[-1:],
            drift[-1:],
            opening=now.contacts["opening_m"][-1:],
            slip=now.contacts["offset_m"][-1:],
            at_limit=None,  # for which this slip does not ask
            length=length[now.joints],
            total_length=length.sum(),
        )
        return float(index["DI"].iloc[0])

    def time_s(self, now):
        """Time of Instants since time zero (n,) [s]."""
        return (now.clock - self._zero_step) * self._solver.time_step

    def motion(self, now):
        """Displacement of the bodies since the end of the static stage, (n, n_bodies, 3) [m, m,
        rad]."""
        return now.displacement - self.zero.displacement

    def top_and_drift(self, motion):
        """Displacement of the top [m] and drift ratio [-], both (n,), the latter without the rigid
        motion of a base on ground that moves; motion: as of `motion`."""
        return self._layout.top_and_drift(self._layout.tops(motion), self._tops_by_base(motion))

    def take(self, now, stage):
        """Write Instants of a stage, up to the first at which a brick has fallen or anything is not
        finite; returns what is not and when [s], None where all is."""
        time_s = self.time_s(now)
        motion = self.motion(now)
        base = self._base_at(now.clock)
        top, drift = self.top_and_drift(motion)
        rows = {
            "time_s": time_s,
            "base_acceleration_x_m_s2": base[:, 0],
            "base_acceleration_z_m_s2": base[:, 1],
            "top_displacement_m": top,
            "drift_ratio": drift,
            **self._base_rows(motion),
            "base_shear_n": now.support_force[:, :, 0].sum(axis=1),
            **self._energies(now, motion, stage),
        }
        problem, end = _first_not_finite(rows | {"motion": motion} | now.contacts)
        if self._borne and stage != "settlement" and end > 0:
            monitor.check_drop(
                self._borne.largest_drop(motion[:end] - self.at_rest).max(), time_s[end - 1]
            )
        fell = np.flatnonzero(self._have_fallen(motion[:end], now))
        if self._borne and len(fell) > 0:
            monitor.check_drop(-motion[fell[0], :, 1].min(), time_s[fell[0]])
        if len(fell) > 0:
            problem = None
            end = fell[0] + 1
            self.collapsed_at_s = float(time_s[fell[0]])
        # before it is pushed
        free = stage == "settlement" and self._settings.loading.drive.top is not None
        rows["top_force_n"] = np.zeros(len(time_s)) if free else now.top_force_n
        self._write(stage, rows, motion, now, end)
        return None if problem is None else (problem, time_s[end])

    def snapshot(self, time_s, now, motion, k):
        """Return arguments of the writer's `snapshot`: time and motion of sample k, of a house also
        that out of the plane."""
        if now.out_of_plane is None:
            return time_s, motion[k]
        return time_s, motion[k], now.out_of_plane[k] - self.zero.out_of_plane[0]

    def write_events(self, events, since=0):
        """Write what a solver drained; since: its clock's zero, in steps since the end of the
        static stage."""
        for step, *event in events:
            time_s = (since + step - self._zero_step) * self._solver.time_step
            self._writer.event(time_s, *event)

    def _have_fallen(self, motion, now):
        """Flags (n,) of the samples at which a brick has fallen; motion: (n, n_bodies, 3) of the
        first n Instants."""
        if self._base_motions:
            # with the ground, of this run or of one before, no brick has fallen
            lowest = (now.support_displacement - self.zero.support_displacement)[
                : len(motion), :, 1
            ].min(axis=1)
            motion = motion - np.array([0.0, 1.0, 0.0]) * lowest[:, np.newaxis, np.newaxis]
        return monitor.have_fallen(self._layout, motion)

    def _write(self, stage, rows, motion, now, end):
        """Write the first samples, up to this one, with their snapshots and events."""
        rows = {name: values[:end] for name, values in rows.items()}
        self._writer.extend(
            stage,
            rows,
            now.joints,
            *(
                {name: values[:end] for name, values in columns.items()}
                for columns in (now.contacts, self._beside(now, motion))
            ),
        )
        if stage != "settling" and end > 0:
            self._balance.add(rows)
        for k in range(-self.count % SNAPSHOT_SAMPLES, end, SNAPSHOT_SAMPLES):
            self._writer.snapshot(*self.snapshot(rows["time_s"][k], now, motion, k))
        events = self._solver.drain_events()
        if end > 0:
            self.last = self.snapshot(float(rows["time_s"][-1]), now, motion, end - 1)
        if self.collapsed_at_s is not None or end < len(motion):  # the solver may have gone on
            events = [event for event in events if end > 0 and event[0] <= now.clock[end - 1]]
        self.write_events(events)
        self.count += end

    def _beside(self, now, motion):
        """Motion of the supports and forces on them; of a run that keeps them stresses of the
        joints; as of `Buffer.extend`."""
        columns = {
            "ground/displacement": now.support_displacement - self.zero.support_displacement,
            "ground/force": now.support_force,
        }
        if now.out_of_plane is not None:
            across = now.out_of_plane - self.zero.out_of_plane
            columns |= {
                "house/top_displacement_m": self._layout.tops(motion) - self._tops_by_base(motion),
                "house/across_m": self._layout.across(across),
                "house/top_across_m": self._layout.tops(across),
                "house/base_acceleration_m_s2": self._base_at(now.clock)[:, -1],
                "house/failed_ties": now.failed_ties,
            }
        if now.joint_stress_pa is not None:
            columns["stresses/joint_stress_pa"] = now.joint_stress_pa
        return columns

    def _energies(self, now, motion, stage):
        """Energies since time zero (n,) [J].  Damping that the solver does not compute is the
        remainder of the balance while the wall settles or is pushed; in any other stage there is
        none."""
        zero = self.zero
        energies = {
            "kinetic_energy_j": now.kinetic_j,
            "elastic_energy_j": now.elastic_j - zero.elastic_j,
            "gravity_energy_j": GRAVITY * total(motion[:, :, 1] * self._layout.weighing),
            "friction_energy_j": now.friction_j - zero.friction_j,
            "fracture_energy_j": now.fracture_j - zero.fracture_j,
        }
        damped = now.damping_j
        input_j = now.input_j + self.set_in_motion_j
        if damped is None:
            balance = sum(energies.values()) - input_j
            if stage in ("settlement", "settling") or self._settings.loading.drive.quasi_static:
                damped = self._balance_j - balance
            else:
                damped = np.full(len(balance), self._damped_j)
                self._balance_j = balance[-1] + self._damped_j
            self._damped_j = damped[-1]
        return {**energies, "input_energy_j": input_j, "damping_energy_j": damped}

    def _tops_by_base(self, motion):
        """Displacement of each wall's top by the rigid motion of its base (n, n_walls) [m], zero on
        ground that rests."""
        if not self._base_motions:
            return np.zeros((len(motion), len(self._layout.walls)))
        return np.column_stack([base.at_top(motion) for base in self._base_motions])

    def _base_rows(self, motion):
        """Rigid motion of the base of a plane wall where the ground moves, {column of the series:
        (n,)}."""
        components = self._base_motions[0].components(motion) if self._base_motions else ()
        return dict(zip(self._layout.BASE_COLUMNS, components))

    def _base_at(self, clock):
        """Acceleration of the base in these steps, (n, 2 or 3) [m/s2]."""
        acceleration = np.zeros((len(clock), self.base.shape[1]))
        moves = clock < len(self.base)
        acceleration[moves] = self.base[clock[moves]]
        return acceleration


def _first_not_finite(samples):
    """What is not finite at the first sample where anything is not, and which that is: None and
    their number where all is.  samples: {name: (n, ...)}."""
    count = len(samples["time_s"])
    # A sum is finite where all of it is, unless it is beyond all sense; BLAS would begin threads
    # for its product.
    if math.isfinite(sum(float(np.add.reduce(values, axis=None)) for values in samples.values())):
        return None, count
    return next(
        (
            (name, k)
            for k in range(count)
            for name, values in samples.items()
            if not math.isfinite(float(np.add.reduce(values[k], axis=None)))
        ),
        (None, count),
    )
