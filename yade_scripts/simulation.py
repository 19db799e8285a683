"""The stages of a run in YADE: static, motion, rest, settling."""

import builtins

import numpy as np
from yade import O, PyRunner, Vector3, utils

from damage.errors import InputError
from damage.motion.loading import TopDisplacement
from damage.run import schedule
from damage.run.settings import AT_REST, HOLD_AT_MOST_S, HOLD_S, LOCAL_DAMPING, RAMP_S, SAMPLE_S
from damage.units import GRAVITY
from yade_scripts.model import build
from yade_scripts.pushed_top import PushedTop
from yade_scripts.recorder import JOINT_STEPS, Recorder

STEP_FACTOR = 0.643
"""Working time step over the critical one: 3.0e-5 s for the shipped walls."""
_CHUNK = 500  # steps between two looks at interrupts and progress


def choose_time_step(settings, critical_s):
    """The run's time step [s]; InputError above what the damped stages stand.

    Local damping lowers the critical step by sqrt(1 + damping).
    """
    limit = critical_s / np.sqrt(1 + LOCAL_DAMPING)
    if settings.time_step_s is not None:
        if settings.time_step_s > limit:
            raise InputError(f"--dt {settings.time_step_s:g} s is above the stable time step {limit:.4g} s "
                             f"(critical {critical_s:.4g} s, lowered by damping); give a smaller one")
        return settings.time_step_s
    return settings.loading.preferred_step_s(STEP_FACTOR * critical_s)


class Simulation:
    """One wall in YADE under one loading.

    keep_going(simulation, time_s): called between chunks of steps, returns False to stop.
    """

    def __init__(self, layout, settings, time_step, writer, keep_going):
        self.settings, self.keep_going, self.writer = settings, keep_going, writer
        self.model = build(layout, time_step)
        self.layout, self.newton = layout, self.model.newton
        sample_steps = JOINT_STEPS * max(1, round(SAMPLE_S / time_step / JOINT_STEPS))
        self.schedule = schedule.stages(settings, time_step, sample_steps)
        self.recorder = Recorder(self.model, writer, sample_steps)
        builtins.masonry_recorder = self.recorder  # where the engine's command can find it
        O.engines = [*O.engines[:-1], PyRunner(command="masonry_recorder.step()", iterPeriod=1),
                     self.newton]
        _perturb(self.model, settings)

    @property
    def stage(self):
        return self.recorder.stage

    @property
    def index(self):
        """The damage index at the last sample."""
        return self.recorder.index

    @property
    def collapsed_at_s(self):
        return self.recorder.collapsed_at_s

    def settle_under_gravity(self):
        """The static stage; True when the wall came to rest, False when interrupted."""
        self.newton.damping = LOCAL_DAMPING
        self.recorder.ramp_steps = round(RAMP_S / O.dt)
        while self.keep_going(self, O.iter * O.dt):
            O.run(_CHUNK, True)
            held = O.iter * O.dt - RAMP_S
            if held >= HOLD_S and (utils.unbalancedForce() < AT_REST or held > HOLD_AT_MOST_S):
                break
        else:
            return False
        self._store_static()
        self.newton.damping = 0.0
        for state in self.recorder.scene.states:
            state.vel = state.angVel = Vector3.Zero
        return True

    def _store_static(self):
        scene = self.recorder.scene
        self.writer.static_stage(
            base_reaction_n=scene.base_reaction(), weight_n=self.layout.total_mass * GRAVITY,
            unbalanced_force=utils.unbalancedForce(), broken_joints=int(self.recorder.tracker.broken.sum()),
            duration_s=O.iter * O.dt)

    def start(self, first_mode):
        """Time zero: the base motion starts, the top is taken hold of, or the wall is kicked into its
        first mode.

        first_mode: shape (n_bodies, 3), 1 at the top.
        """
        speed = getattr(self.settings.loading, "top_velocity_m_s", 0.0)
        for state, (vx, vz, turn) in zip(self.recorder.scene.states, speed * first_mode):
            state.vel, state.angVel = Vector3(vx, 0, vz), Vector3(0, -turn, 0)
        loading, recorder = self.settings.loading, self.recorder
        if isinstance(loading, TopDisplacement):
            recorder.top = PushedTop(self.layout, recorder.scene, loading, recorder.sample_steps * O.dt)
        recorder.start_clock(schedule.base_acceleration(self.settings, self.schedule, O.dt))

    def run(self, stage, until_step):
        """Run one stage up to a step since time zero; True unless interrupted or collapsed."""
        self.recorder.stage = stage
        if self.recorder.top:
            self.newton.damping = self.settings.loading.local_damping
        else:
            self.newton.damping = LOCAL_DAMPING if stage == "settling" else 0.0
        left = until_step - round(self.recorder.time / O.dt)
        while left > 0:
            if self.collapsed_at_s is not None or not self.keep_going(self, self.recorder.time):
                return False
            steps = min(left, _CHUNK)
            O.run(steps, True)
            left -= steps
        return True

    def run_all(self):
        """All stages; True unless interrupted."""
        finished = self._run_stages()
        self.recorder.snapshot()
        return finished or self.collapsed_at_s is not None

    def _run_stages(self):
        if self.recorder.top:
            last, end = "motion", len(self.recorder.top.velocities) * self.recorder.sample_steps
            finished = self.run(last, end)
        else:
            last, end = "settling", self.schedule[-1].end_step
            finished = all(self.run(stage.name, stage.end_step) for stage in self.schedule)
        # One step more takes the last sample: the residual state.
        return finished and self.run(last, end + 1)


def _perturb(model, settings):
    """Shift every brick in its plane by normally distributed offsets."""
    if settings.perturb_m == 0:
        return
    random = np.random.default_rng(settings.seed)
    for clump, (dx, dz) in zip(model.clumps, random.normal(0, settings.perturb_m, (len(model.clumps), 2))):
        O.bodies[clump].state.pos += Vector3(dx, 0, dz)
