"""One wall under one loading, with any solver: static stage, events or a push, samples into a history."""

import math

import numpy as np

from damage.errors import RunError
from damage.history.buffer import SNAPSHOT_SAMPLES
from damage.measure.energy import Balance, noise_j
from damage.measure.warnings import AT_REST
from damage.run import schedule
from damage.run.settings import (
    ADAPTIVE_DAMPING,
    AFTER_FALL_S,
    HOLD_AT_MOST_S,
    HOLD_S,
    LOCAL_DAMPING,
    RAMP_S,
    RESTS_BELOW_M_S,
    RESTS_FOR_S,
)
from damage.run.solver import LOOK_STEPS, NO_MOTION
from damage.run.watch import fastest_fallen, have_fallen, have_left, index_now, lowest_places, unbalanced_force
from damage.units import GRAVITY
from damage.wall.strain import stress_by_modes


class Run:
    """The stages of a run, in order: `settle_under_gravity`, `start`, `run_all`.

    The first and the last are generators of the steps that the solver hands out, for `damage.run.turns.take_turns`:
    a run does not know whether it is alone.

    layout: damage.wall.layout.Layout; settings: RunSettings; solver: damage.run.solver.Solver of this layout;
    writer: HistoryWriter; keep_going(run, time_s): called now and then, returns False to stop (an interrupt); settled:
    where the wall at rest is found, or kept, as damage.reference.settled.Settled.
    stage, index, time, collapsed_at_s: where the run is; rests_at_s: since when bricks rest that were followed.
    """

    def __init__(self, layout, settings, solver, writer, keep_going, settled=None):
        self.layout, self.settings, self.solver = layout, settings, solver
        self.writer, self.keep_going, self._settled = writer, keep_going, settled
        self.stage, self.collapsed_at_s, self.rests_at_s, self._samples = "static", None, None, 0
        self.sample_steps = schedule.sample_steps(solver.time_step)
        self.stages = schedule.stages(settings, layout, solver.time_step, self.sample_steps)
        self.base, self._top_velocities, self._support_velocities = NO_MOTION, None, None
        self._zero = None  # instant of time zero
        self._last = None  # snapshot of the last sample: of what else is kept all samples share the memory
        self._stress = stress_by_modes(layout) if settings.model.deforms else None
        self._lowest = lowest_places(layout)
        # Short steps make a ramp long; weight that came at once would make deformable bricks ring, and joints fail.
        self._ramp_s = 0.0 if settings.model.deforms else RAMP_S
        self._balance_j = self._damped_j = 0.0
        self._balance = Balance(noise_j(layout.total_mass, layout.wall.built_height))
        if settings.perturb_m > 0:
            random = np.random.default_rng(settings.seed)
            solver.shift(random.normal(0, settings.perturb_m, (len(layout.bodies), 2)))

    @property
    def time(self):
        """Since the start of the stage under way: of the static one, or of all that follow it [s]."""
        return self.solver.clock * self.solver.time_step

    @property
    def index(self):
        """The damage index now."""
        now = self.solver.instants()
        drift = self._top(self._motion(now))[-1] / self.layout.drift_height
        return index_now(self.layout, drift, now.joints, now.contacts["opening_m"][-1],
                         now.contacts["offset_m"][-1])

    @property
    def energy_error(self):
        """Of the samples so far: `damage.measure.energy.energy_error` [-], None where hardly anything came in."""
        return self._balance.error

    @property
    def duration_s(self):
        """Of all stages after the static one [s]."""
        return self.stages[-1].end_step * self.solver.time_step

    # --- the stages -----------------------------------------------------------------------------

    def settle_under_gravity(self):
        """The static stage; returns True when the wall came to rest, False when interrupted."""
        solver, dt = self.solver, self.solver.time_step
        n = round(self._ramp_s / dt)
        solver.damp(**self._relaxation(LOCAL_DAMPING))
        if n == 0:
            solver.add_static_displacement()
        solver.start(NO_MOTION, GRAVITY * (np.arange(n + 1) / n if n else np.ones(1)))
        if self._settled is None or not self._settled.recall(solver):
            finished = yield from self._come_to_rest()
            if not finished:
                return False
            if self._settled is not None:
                self._settled.keep(solver)
        events, now = solver.drain_events(), solver.instants()
        self.writer.static_stage(
            base_reaction_n=solver.base_reaction(), weight_n=self.layout.total_mass * GRAVITY,
            unbalanced_force=self._unbalanced_force(), broken_joints=int(np.sum(now.contacts["state"] > 0)),
            duration_s=self.time)
        self._write_events(events, first_step=-solver.clock)
        return True

    def _come_to_rest(self):
        """Advance until the wall is at rest; returns False when interrupted."""
        while self.keep_going(self, self.time):
            yield from self._advance(LOOK_STEPS)
            held = self.time - self._ramp_s
            if held >= HOLD_S and (self._unbalanced_force() < AT_REST or held > HOLD_AT_MOST_S):
                return True
        return False

    def start(self, first_mode):
        """Time zero: the base motion starts, the top is taken hold of, or the wall is kicked into its first mode.

        first_mode: shape (n_bodies, 3), 1 at the top.
        """
        solver, drive = self.solver, self.settings.loading.drive
        self.base = schedule.base_acceleration(self.settings, self.stages, solver.time_step)
        solver.set_velocities(drive.first_mode_m_s * first_mode)
        solver.start(self.base, np.array([GRAVITY]))
        if drive.top:
            solver.hold(self.layout.pushed_bodies, rotation=not drive.top_rotates)
        interval = self.sample_steps * solver.time_step, self.stages[-1].end_step // self.sample_steps
        self._top_velocities = drive.top_velocities(*interval, self.layout.pushed_height)
        self._support_velocities = drive.support_velocities(*interval, self.layout.supports.x)
        self._zero = solver.instants()
        self._last = self._snapshot(0.0, self._zero, self._motion(self._zero), -1)
        self.stage = self.stages[0].name

    def run_all(self):
        """All stages; returns True unless interrupted (a collapse is an end, too)."""
        finished = yield from self._run_stages()
        self._write_events(self.solver.drain_events())
        self.writer.snapshot(*self._last)
        if self.collapsed_at_s is not None and (self.settings.past_collapse_s > 0 or self.settings.after_fall):
            return (yield from self._follow_the_fall())
        return finished or self.collapsed_at_s is not None

    def _follow_the_fall(self):
        """What becomes of the bricks after the first one fell: snapshots alone, since joints no longer say what a wall
        is; returns True unless interrupted."""
        solver, settings = self.solver, self.settings
        until_rest, moves_until = settings.after_fall, len(self.base) * solver.time_step
        end = max(self.time, moves_until) + AFTER_FALL_S if until_rest else \
            self.collapsed_at_s + settings.past_collapse_s
        solver.damp(**self._damping("motion"))
        if until_rest:
            self._prescribe(self.stages[-1].end_step)  # top and supports stand still
        last = self._last
        while self.time < end:
            if not self.keep_going(self, self.time):
                return False
            yield from self._advance(SNAPSHOT_SAMPLES * self.sample_steps)
            instant = solver.instants()
            now = self._snapshot(self.time, instant, self._motion(instant), -1)
            self.writer.snapshot(*now)
            if until_rest and self._rest(last, now, moves_until):
                break
            last = now
        return True

    def _rest(self, last, now, moves_until):
        """Whether no brick that fell has moved for RESTS_FOR_S since the base stands still; last, now: snapshots, which
        begin with time [s] and motion."""
        fastest = fastest_fallen(self.layout, now[1], last[1], now[0] - last[0])
        if fastest > RESTS_BELOW_M_S or now[0] < moves_until:
            self.rests_at_s = None
        elif self.rests_at_s is None:
            self.rests_at_s = last[0]
        return self.rests_at_s is not None and now[0] - self.rests_at_s >= RESTS_FOR_S

    @property
    def fall(self):
        """What became of the bricks that were followed until they rest, in a line; None where none were."""
        if self.collapsed_at_s is None or not self.settings.after_fall:
            return None
        overlap = self.solver.largest_overlap_m()
        rests = "not at rest" if self.rests_at_s is None else \
            f"at rest {self.rests_at_s - self.collapsed_at_s:.2f} s after the first one fell"
        return (f"bricks followed to {self.time:.2f} s: {rests}; they overlapped by up to {1e3 * overlap[0]:.2g} of "
                f"{1e3 * overlap[1]:.2g} mm")

    def _run_stages(self):
        solver = self.solver
        for stage in self.stages:
            self.stage = stage.name
            solver.damp(**self._damping(stage.name))
            while solver.clock < stage.end_step:
                if self.collapsed_at_s is not None or not self.keep_going(self, self.time):
                    return False
                yield from self._advance(min(stage.end_step - solver.clock, self._stretch()), self.sample_steps,
                                         self.take_samples, stage.start_step)
        return True

    def _stretch(self):
        """Steps to ask for at once: to the next look, or to a sample of several more."""
        samples = self.solver.stretch_samples
        return samples * self.sample_steps - self.solver.clock % self.sample_steps if samples else LOOK_STEPS

    def _advance(self, *how):
        """Let the solver advance; a run that blows up ends at once."""
        try:
            yield from self.solver.advance(*how)
        except ArithmeticError as error:
            raise self._failure(error) from error

    def _failure(self, problem, time_s=None):
        time_s = self.time if time_s is None else time_s
        stage = f"static stage, {time_s:.6g} s" if self.stage == "static" else f"{time_s:.6g} s"
        return RunError(f"the run blew up ({stage}): {problem}; expected finite numbers; give a smaller --dt, or look "
                        "at the wall's stiffnesses and masses")

    def _unbalanced_force(self):
        return unbalanced_force(self.layout, *self.solver.forces())

    def _relaxation(self, local):
        """How static solutions are found: by adaptive damping, or by so much local damping."""
        return {"adaptive": ADAPTIVE_DAMPING} if self.settings.relaxation == "adaptive" else {"local": local}

    def _damping(self, stage):
        """Local damping while settling, that of the settings otherwise: both at once are unstable at this step."""
        drive = self.settings.loading.drive
        if drive.quasi_static:
            return self._relaxation(drive.local_damping)
        if stage == "settling":
            return {"local": LOCAL_DAMPING}
        return {"alpha": self.settings.alpha_1_s, "beta": self.settings.beta_s}

    # --- samples ---------------------------------------------------------------------------------

    def take_samples(self, now):
        """Write one sample after the other of everything (Instants), and prescribe the next velocities; False where the
        run has to end, with the last one that is written."""
        time_s, motion, base = now.clock * self.solver.time_step, self._motion(now), self._base_at(now.clock)
        top = self._top(motion)
        rows = {
            "time_s": time_s, "base_acceleration_x_m_s2": base[:, 0], "base_acceleration_z_m_s2": base[:, 1],
            "top_displacement_m": top, "drift_ratio": top / self.layout.drift_height,
            "base_shear_n": now.support_force[:, :, 0].sum(axis=1), **self._energies(now, motion)}
        problem, end = self._first_not_finite(rows, {
            "motion": motion, **now.contacts})
        fell = np.flatnonzero(self._have_fallen(motion[:end], now))
        if len(fell) > 0:
            problem, end, self.collapsed_at_s = None, fell[0] + 1, float(time_s[fell[0]])
        self._write({**rows, "top_force_n": now.top_force_n}, motion, now, end)
        if problem is not None:
            raise self._failure(f"{problem} is no longer finite", time_s[end])
        self._prescribe(self._samples - 1)
        return self.collapsed_at_s is None

    def _have_fallen(self, motion, now):
        """At which of the first Instants a brick has fallen (n,)."""
        if not self.settings.new_contacts:
            return have_fallen(motion, self._lowest)
        return have_left(self.layout, motion, now.joints, now.contacts["state"][:len(motion)])

    def _prescribe(self, interval):
        """Move the top and the supports by their velocities in this interval; they rest after the last."""
        for velocities, move in ((self._top_velocities, self.solver.push),
                                 (self._support_velocities, self.solver.move_supports)):
            if velocities is not None:
                move(velocities[interval] if interval < len(velocities) else 0 * velocities[0])

    def _write(self, rows, motion, now, end):
        """Write the first samples, up to this one, with their snapshots and events."""
        rows = {name: values[:end] for name, values in rows.items()}
        ground = {"displacement": now.support_displacement - self._zero.support_displacement,
                  "force": now.support_force}
        self.writer.extend(self.stage, rows, now.joints, *({name: values[:end] for name, values in columns.items()}
                                                           for columns in (now.contacts, ground)))
        if self.stage != "settling" and end > 0:
            self._balance.add(rows)
        for k in range(-self._samples % SNAPSHOT_SAMPLES, end, SNAPSHOT_SAMPLES):
            self.writer.snapshot(*self._snapshot(rows["time_s"][k], now, motion, k))
        events = self.solver.drain_events()
        if end > 0:
            self._last = self._snapshot(float(rows["time_s"][-1]), now, motion, end - 1)
        if self.collapsed_at_s is not None or end < len(motion):  # the solver may have gone on
            events = [event for event in events if end > 0 and event[0] <= now.clock[end - 1]]
        self._write_events(events)
        self._samples += end

    def _snapshot(self, time_s, now, motion, k):
        """Time, motion and, of deformable bricks, stresses of sample k, as the writer takes them."""
        stress = () if self._stress is None else (np.einsum("bpsm,bm->bps", self._stress, now.strain[k]),)
        return time_s, motion[k], *stress

    def _first_not_finite(self, rows, arrays):
        """What is not finite at the first sample where anything is not, and which that is: None and their number where
        all is.  rows: {name: (n,)}; arrays: {name: (n, ...)}."""
        count = len(rows["time_s"])
        # A sum is finite where all of it is, unless it is beyond all sense; BLAS would begin threads for its product.
        sums = [float(np.add.reduce(values, axis=None)) for values in (rows | arrays).values()]
        if math.isfinite(sum(sums)):
            return None, count
        for k in range(count):
            for name, values in (rows | arrays).items():
                if not math.isfinite(float(np.add.reduce(values[k], axis=None))):
                    return name, k
        return None, count

    def _energies(self, now, motion):
        """Energies since time zero (n,) [J].  Damping that the solver does not compute is the remainder of the balance
        while the wall settles or is pushed; in any other stage there is none."""
        zero, mass = self._zero, self.layout.bodies.mass
        energies = {
            "kinetic_energy_j": now.kinetic_j, "elastic_energy_j": now.elastic_j - zero.elastic_j,
            "gravity_energy_j": GRAVITY * np.array([mass @ one[:, 1] for one in motion]),
            "friction_energy_j": now.friction_j - zero.friction_j,
            "fracture_energy_j": now.fracture_j - zero.fracture_j,
        }
        damped = now.damping_j
        if damped is None:
            balance = sum(energies.values()) - now.input_j
            if self.stage == "settling" or self.settings.loading.drive.quasi_static:
                damped = self._balance_j - balance
            else:
                damped = np.full(len(balance), self._damped_j)
                self._balance_j = balance[-1] + self._damped_j
            self._damped_j = damped[-1]
        return {**energies, "input_energy_j": now.input_j, "damping_energy_j": damped}

    def _motion(self, now):
        """Displacement of the bodies since time zero, (n, n_bodies, 3) [m, m, rad]."""
        return now.displacement - self._zero.displacement

    def _top(self, motion):
        """Mean displacement of the top course over the piers since time zero (n,) [m]; motion: `_motion`."""
        top = motion[:, :, 0].take(self.layout.drift_bodies, axis=1)
        return np.add.reduce(top, axis=1) / top.shape[1]

    def _base_at(self, clock):
        """Acceleration of the base in these steps, (n, 2) [m/s2]."""
        found = np.zeros((len(clock), 2))
        moves = clock < len(self.base)
        found[moves] = self.base[clock[moves]]
        return found

    def _write_events(self, events, first_step=0):
        """Write what a solver drained; first_step: of its clock's zero, since time zero."""
        for step, *event in events:
            self.writer.event((first_step + step) * self.solver.time_step, *event)
