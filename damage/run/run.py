"""One wall under one loading, with any solver: static stage, events or a push."""

import math
from functools import cached_property

import numpy as np

from damage.errors import RunError
from damage.history.buffer import SNAPSHOT_SAMPLES
from damage.linear.modes import first_mode, mass_vector, natural_modes
from damage.measure.warnings import AT_REST
from damage.motion.loading import mean_velocities
from damage.run import monitor, schedule
from damage.run.initial_state import as_bytes
from damage.run.sampler import Sampler
from damage.run.settings import (
    ADAPTIVE_DAMPING,
    AFTER_FALL_S,
    HOLD_AT_MOST_S,
    HOLD_S,
    LOCAL_DAMPING,
    RAMP_S,
    RESTS_BELOW_M_S,
    RESTS_FOR_S,
    SELECTIVE,
    SETTLED_BELOW,
)
from damage.run.solver import LOOK_STEPS, MOST_WORK, NO_MOTION
from damage.units import GRAVITY


class Run:
    """The stages of a run, in order: `come_to_rest`, `start`, `run_all`.

    The first and the last are generators of the steps that the solver hands out, for
    `damage.run.cooperative.as_they_end`: a run does not know whether it is alone.

    layout: damage.wall.layout.Layout; settings: RunSettings; solver: damage.run.solver.Solver of
    this layout; writer: a Buffer of a history; keep_going(run, time_s): called now and then,
    returns False to stop (an interrupt); settled: where the wall at rest is found, or kept, as
    damage.reference.rest_cache.Rest; state: of a solver at the end of another run
    (`damage.run.initial_state.read_state`, `damage.run.checkpoint.read_end`), which this one
    continues in place of the static stage; checkpoints: damage.run.checkpoint.Checkpoints, or None;
    resumed: tables of the checkpoint of this very run from which it continues, or None. stage,
    index, time: where the run is; sampler: damage.run.sampler.Sampler; rests_at_s: since when
    bricks rest that were followed.
    """

    def __init__(
        self,
        layout,
        settings,
        solver,
        writer,
        keep_going,
        settled=None,
        state=None,
        *,
        checkpoints=None,
        resumed=None,
    ):
        self.layout = layout
        self.settings = settings
        self.solver = solver
        self.writer = writer
        self.keep_going = keep_going
        self._settled = settled
        self._state = state
        self._checkpoints = checkpoints
        self._resumed = resumed
        self._number = -1  # of the stage, in a checkpoint
        self.stage = "static"
        self.rests_at_s = None
        self.sample_steps = schedule.sample_steps(solver.time_step, settings.mass_scaling)
        self.stages = schedule.stages(settings, layout, solver.time_step, self.sample_steps)
        self._zero_step = schedule.zero_step(self.stages)
        self.sampler = Sampler(
            layout, settings, solver, writer, state=state, zero_step=self._zero_step
        )
        # (velocities in each interval, what moves by them, first interval)
        self._prescribed = []
        # at time zero
        self._modal_velocity = None
        solver.with_stresses = settings.stresses
        # (time [s], unbalanced force) in the static stage
        self._looks = []
        # Short steps make a ramp long; weight that came at once would make deformable bricks ring,
        # and joints fail.
        self._ramp_s = 0.0 if settings.model.has_modes else RAMP_S

    @cached_property
    def _period_s(self):
        """First natural period of the intact wall [s], by which a push is damped and followed."""
        return float(natural_modes(self.layout).period_s[0])

    @property
    def share(self):
        """Share of the work that is done since the static stage."""
        if self.stage == "static":
            return 0.0
        is_over = self.collapsed_at_s is not None
        return 1.0 if is_over else self._work(self.solver.clock) / self._work(math.inf)

    def _work(self, clock):
        """Work of the steps since the static stage up to a clock, in steps of a motion."""
        weight = schedule.settlement_work(self.layout.n_joints)
        steps = min(clock, self.stages[-1].end_step)
        settling = min(clock, self._zero_step)
        return steps + (weight - 1.0) * settling * bool(self.solver.stretch_samples)

    @property
    def time(self):
        """Since the start of the static stage in that stage, then since time zero, at which the
        first motion starts; negative while the ground settles [s]."""
        return (
            self.solver.clock - (0 if self.stage == "static" else self._zero_step)
        ) * self.solver.time_step

    @property
    def index(self):
        """The damage index now."""
        return self.sampler.index(self.solver.instants())

    @property
    def collapsed_at_s(self):
        """When the first brick had fallen [s], None where none has."""
        return self.sampler.collapsed_at_s

    @property
    def duration_s(self):
        """From time zero to the end of the last stage [s]."""
        return (self.stages[-1].end_step - self._zero_step) * self.solver.time_step

    # --- the stages -----------------------------------------------------------------------------

    def come_to_rest(self):
        """The static stage, or what another run ended with; returns True when the wall came to
        rest, False when interrupted."""
        solver = self.solver
        dt = self.solver.time_step
        n = round(self._ramp_s / dt)
        solver.damp(**self._damping("static"))
        if n == 0 and self._state is None:
            solver.add_static_displacement()
        solver.start(NO_MOTION, GRAVITY * (np.arange(n + 1) / n if n else np.ones(1)))
        if self._resumed is not None:
            if self._resumed["stage"] >= 0:  # the rest is in the history
                return True
            solver.restore(self._resumed)
        if self._state is not None:
            solver.resume(self._state)
        elif (
            self._resumed is not None
            or self._settled is None
            or (looks := self._settled.recall(solver)) is None
        ):
            finished = yield from self._advance_to_rest()
            if not finished:
                return False
            if self._settled is not None:
                self._settled.keep(solver, self._looks)
        else:
            for look in looks:
                self.writer.look(*look)
        events = solver.drain_events()
        now = solver.instants()
        self.writer.static_stage(
            base_reaction_n=solver.base_reaction(),
            weight_n=self.layout.total_mass * GRAVITY,
            unbalanced_force=self._unbalanced_force(),
            broken_joints=int(np.sum(now.contacts["state"] > 0)),
            duration_s=self.time,
        )
        self.sampler.write_events(events, since=-solver.clock)
        return True

    def _advance_to_rest(self):
        """Advance until the wall is at rest; returns False when interrupted."""
        while self._continues():
            yield from self._advance(LOOK_STEPS)
            hold_s = self.time - self._ramp_s
            unbalanced = self._unbalanced_force()
            self._looks.append((self.time, unbalanced))
            self.writer.look(*self._looks[-1])
            if hold_s >= HOLD_S and (unbalanced < AT_REST or hold_s > HOLD_AT_MOST_S):
                return True
        return False

    def start(self):
        """The end of the static stage.  The ground begins to settle or, at time zero, the base
        motion starts, the top is taken hold of, or the wall is kicked into its first mode."""
        solver = self.solver
        drive = self.settings.loading.drive
        settlement = self.settings.settlement
        base = schedule.base_acceleration(
            self.settings, self.stages, solver.time_step, self.layout.MOTION_AXES
        )
        speed = drive.first_mode_m_s
        self._modal_velocity = (
            speed * first_mode(self.layout)
            if speed
            else np.zeros_like(mass_vector(self.layout)).reshape(self.layout.n_bodies, -1)
        )
        if self._state is None:
            solver.set_velocities(0 * self._modal_velocity if settlement else self._modal_velocity)
        solver.start(base, np.array([GRAVITY]))
        if self._state is not None:
            solver.resume(self._state)
        if not settlement:
            self._take_hold()
        interval_s = self.sample_steps * solver.time_step
        zero = self._zero_step // self.sample_steps
        interval = interval_s, self.stages[-1].end_step // self.sample_steps - zero
        top = mean_velocities(drive.top, *interval, self.layout.height_of_push(drive.floor_shares))
        supports = mean_velocities(drive.supports, *interval, self.layout.supports.x)
        ground = settlement and settlement.velocities(interval_s, zero, self.layout.ground)
        self._prescribed = [
            (velocities, move, first)
            for velocities, move, first in (
                (top, solver.push, zero),
                (supports, solver.move_supports, zero),
                (ground, solver.move_supports, 0),
            )
            if velocities is not None
        ]
        self.sampler.begin(base, self._state)
        if drive.top:  # a push begins where the wall stands, which may continue another run
            self.sampler.at_rest = self.sampler.last[1]
        self.stage = self.stages[0].name
        if self._resumed is not None and self._resumed["stage"] >= 0:
            self._restore(self._resumed)

    @property
    def _spreads(self):
        """Whether a spreader beam pushes."""
        drive = self.settings.loading.drive
        return bool(drive.floor_shares or (drive.top and self.layout.IN_SPACE))

    def _take_hold(self):
        drive = self.settings.loading.drive
        if self._spreads:
            self.solver.spread(self.layout.push_shares(drive.floor_shares))
        elif drive.top:
            self.solver.hold(self.layout.pushed_bodies, not drive.top_rotates, drive.top_stiffness)

    def _set_in_motion(self):
        """Time zero after a settlement: the wall is at rest, or has its initial velocity, and a
        pushed top is held."""
        solver = self.solver
        self._check_rest()
        now = solver.instants()
        before = now.kinetic_j[0]
        self.sampler.at_rest = self.sampler.motion(now)
        solver.set_velocities(self._modal_velocity)
        self._take_hold()
        self.sampler.set_in_motion_j += float(solver.instants().kinetic_j[0] - before)
        self._prescribe(self.sampler.count - 1)  # what waited for this

    def _check_rest(self):
        unbalanced = self._unbalanced_force()
        if unbalanced > SETTLED_BELOW:
            raise RunError(
                f"{self.layout.wall.name}: not at rest on the settled ground, unbalanced force "
                f"{unbalanced:.2g} of the contact forces, expected up to {SETTLED_BELOW:g}: the "
                "wall topples or slides; give a smaller --distortion"
            )

    def run_all(self):
        """All stages; returns True unless interrupted (a collapse is an end, too)."""
        finished = yield from self._run_stages()
        if finished and not self.settings.loading.moves:
            self._check_rest()
        self.sampler.write_events(self.solver.drain_events())
        self.writer.snapshot(*self.sampler.last)
        if finished and self.collapsed_at_s is None:
            if (state := self.solver.saved_state()) is not None:
                self.writer.sink.keep_state(as_bytes(state | self.sampler.carried))
            if self._checkpoints and self._checkpoints.keeps_end:
                self._checkpoints.write(self.tables())
        if self.collapsed_at_s is not None and self.settings.after_fall:
            return (yield from self._follow_the_fall())
        return finished or self.collapsed_at_s is not None

    def tables(self):
        """Everything that the next steps depend on, {name: array}: a checkpoint."""
        return self.solver.checkpoint() | self.sampler.tables() | {"stage": np.array(self._number)}

    def _restore(self, tables):
        """Go back to where a checkpoint was written after the static stage."""
        self._number = int(tables["stage"])
        self.stage = self.stages[self._number].name
        if self.settings.settlement and self._number > 0:
            self._take_hold()
        self.solver.restore(tables)
        self.sampler.restore(tables)

    def _continues(self):
        """Whether no one interrupts; writes a checkpoint where one does, or where it is due."""
        continues = self.keep_going(self, self.time)
        if self._checkpoints and (not continues or self._checkpoints.due()):
            self._checkpoints.write(self.tables())
        return continues

    def _follow_the_fall(self):
        """Follow the bricks after the first one has fallen, by snapshots only: samples of joints no
        longer describe the wall.  Returns True unless interrupted."""
        solver = self.solver
        moves_until = (len(self.sampler.base) - self._zero_step) * solver.time_step
        end = max(self.time, moves_until) + AFTER_FALL_S
        solver.damp(**self._damping("motion"))
        solver.damp_impacts()
        # beyond the last interval they rest
        self._prescribe(self.stages[-1].end_step // self.sample_steps)
        last = self.sampler.last
        while self.time < end:
            if not self.keep_going(self, self.time):
                return False
            yield from self._advance(SNAPSHOT_SAMPLES * self.sample_steps)
            instant = solver.instants()
            now = self.sampler.snapshot(self.time, instant, self.sampler.motion(instant), -1)
            self.writer.snapshot(*now)
            if self._rest(last, now, moves_until):
                break
            last = now
        return True

    def _rest(self, last, now, moves_until):
        """Whether the base is at rest and all fallen bricks have been slower than RESTS_BELOW_M_S
        for RESTS_FOR_S.

        last, now: snapshots (time [s], motion, ...).
        """
        fastest = monitor.fastest_fallen(self.layout, now[1], last[1], now[0] - last[0])
        if fastest > RESTS_BELOW_M_S or now[0] < moves_until:
            self.rests_at_s = None
        elif self.rests_at_s is None:
            self.rests_at_s = last[0]
        return self.rests_at_s is not None and now[0] - self.rests_at_s >= RESTS_FOR_S

    @property
    def fall(self):
        """A line on when the fallen bricks rest; None where none were followed."""
        if self.collapsed_at_s is None or not self.settings.after_fall:
            return None
        rests = (
            "not at rest"
            if self.rests_at_s is None
            else f"at rest {self.rests_at_s - self.collapsed_at_s:.2f} s after the first one fell"
        )
        return f"bricks followed to {self.time:.2f} s: {rests}"

    def _run_stages(self):
        solver = self.solver
        for number in range(max(self._number, 0), len(self.stages)):
            stage = self.stages[number]
            has_begun = number == self._number
            self.stage = stage.name
            self._number = number
            if stage.start_step == self._zero_step > 0 and not has_begun:
                self._set_in_motion()
            solver.damp(**self._damping(stage.name))
            while solver.clock < stage.end_step:
                if self.collapsed_at_s is not None or not self._continues():
                    return False
                yield from self._advance(
                    min(stage.end_step - solver.clock, self._stretch()),
                    self.sample_steps,
                    self.take_samples,
                    stage.start_step,
                )
        return True

    def _stretch(self):
        """Number of steps to the next look or, where the solver prefers samples in groups, to the
        end of a group, which is smaller where it would hold up an interrupt."""
        if not self.solver.stretch_samples:
            return LOOK_STEPS
        most = MOST_WORK // (self.sample_steps * len(self.layout.contacts))
        samples = max(1, min(self.solver.stretch_samples, most))
        return samples * self.sample_steps - self.solver.clock % self.sample_steps

    def _advance(self, *how):
        """Let the solver advance; a run that blows up ends at once."""
        try:
            yield from self.solver.advance(*how)
        except ArithmeticError as error:
            raise self._failure(error) from error

    def _failure(self, problem, time_s=None):
        time_s = self.time if time_s is None else time_s
        stage = f"static stage, {time_s:.6g} s" if self.stage == "static" else f"{time_s:.6g} s"
        return RunError(
            f"the run blew up ({stage}): {problem}; expected finite numbers; give a smaller --dt,"
            " or look at the wall's stiffnesses and masses"
        )

    def _unbalanced_force(self):
        return monitor.unbalanced_force(self.layout, *self.solver.forces())

    def _damping(self, stage):
        """Local or adaptive damping while settling, that of the settings otherwise: both at once
        are unstable at this step.  With mass scaling local damping would do positive work.

        A push needs damping of the vibration about its steady motion: what opposes the whole
        velocity has one sign until the wave is faster than the push, and takes nothing from it.
        It is critical in the first mode: a quarter of it leaves a wall that slides shaking.
        """
        drive = self.settings.loading.drive
        local = LOCAL_DAMPING
        if stage == "settlement":
            is_adaptive = self.settings.mass_scaling == SELECTIVE
        elif stage == "static":
            is_adaptive = self.settings.relaxation == "adaptive"
        elif drive.quasi_static and self.settings.relaxation == "local":
            is_adaptive = False
            local = drive.local_damping
        elif drive.quasi_static:
            # no more than what the step resolves: a few stiff bricks would blow up
            alpha_1_s = min(4 * math.pi / self._period_s, 0.5 / self.solver.time_step)
            return {"alpha": alpha_1_s, "mean_1_s": 1 / self._period_s}
        elif stage == "settling":
            is_adaptive = self.settings.settles == "adaptive"
        else:
            return {"alpha": self.settings.alpha_1_s, "beta": self.settings.beta_s}
        return {"adaptive": ADAPTIVE_DAMPING} if is_adaptive else {"local": local}

    # --- what is prescribed ----------------------------------------------------------------------

    def take_samples(self, now):
        """Write samples (Instants), and prescribe the next velocities; False where the run has to
        end, with the last one that is written."""
        not_finite = self.sampler.take(now, self.stage)
        if not_finite is not None:
            problem, time_s = not_finite
            raise self._failure(f"{problem} is no longer finite", time_s)
        self._prescribe(self.sampler.count - 1, self._behind(now))
        return self.collapsed_at_s is None

    def _behind(self, now):
        """How far the course of the drift is behind what is asked for at the last of these Instants
        [m], of a wall whose top is held.  The top is above that course, and turns."""
        drive = self.settings.loading.drive
        if self.stage == "settlement" or not drive.top or self._spreads:
            return 0.0
        motion = self.sampler.motion(now)[-1:] - self.sampler.at_rest
        top, _ = self.sampler.top_and_drift(motion)
        return float(drive.top(self.sampler.time_s(now)[-1:], self.layout.drift_height)[0] - top[0])

    def _catching_up(self, behind_m):
        """Velocity [m/s] that a push adds so that the course of the drift catches up: in a quarter
        of the first period, in two intervals at least, as it would overshoot in less."""
        catch_up_s = max(self._period_s / 4, 2 * self.sample_steps * self.solver.time_step)
        return behind_m / catch_up_s

    def _prescribe(self, interval, behind_m=0.0):
        """Move the top and the supports by their velocities in this interval; they rest after the
        last."""
        for velocities, move, first in self._prescribed:
            if self.stage == "settlement" and first > 0:  # the top is not held yet
                continue
            if first <= interval < first + len(velocities):
                more = self._catching_up(behind_m) if move == self.solver.push else 0.0
                move(velocities[interval - first] + more)
            elif interval == first + len(velocities):
                move(0 * velocities[0])
        if self._prescribed and all(
            interval >= first + len(velocities) for velocities, _, first in self._prescribed
        ):
            self.solver.prescribe_no_more()
