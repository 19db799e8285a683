"""The stages of a run in the reference solver: static, motion, rest, settling."""

import numpy as np

from damage.history.writer import SNAPSHOT_SAMPLES
from damage.motion.loading import TopDisplacement
from damage.reference.wall import EVENT_KINDS, ReferenceWall
from damage.run import schedule
from damage.run.settings import ADAPTIVE_DAMPING, AT_REST, HOLD_AT_MOST_S, HOLD_S, LOCAL_DAMPING, RAMP_S, SAMPLE_S
from damage.run.watch import has_collapsed, index_now
from damage.units import GRAVITY


class ReferenceRun:
    """One wall in the reference solver under one loading, written to a history.

    keep_going(run, time_s): called at every sample, returns False to stop (an interrupt).
    """

    def __init__(self, layout, settings, time_step, writer, keep_going):
        self.layout, self.settings, self.writer, self.keep_going = layout, settings, writer, keep_going
        self.wall = ReferenceWall(layout, time_step)
        self.sample_steps = max(1, round(SAMPLE_S / time_step))
        self.schedule = schedule.stages(settings, time_step, self.sample_steps)
        self.stage, self.samples, self.drift, self.collapsed_at_s = "static", 0, 0.0, None
        self._zero = None
        if settings.perturb_m > 0:
            offsets = np.random.default_rng(settings.seed).normal(0, settings.perturb_m, (len(layout.bodies), 2))
            for name, offset in zip("xz", offsets.T):
                self.wall.system.place[name][:-1] += offset
            self.wall.refresh()

    @property
    def time(self):
        """Time since the start of the motion [s]."""
        return (self.wall.step - self.wall.first_step) * self.wall.time_step

    @property
    def index(self):
        """The damage index of this instant, for the progress line."""
        return index_now(self.layout, self.drift, self.wall.opening, self.wall.slip)

    def settle_under_gravity(self):
        """The static stage; True when the wall came to rest, False when interrupted."""
        wall, dt = self.wall, self.wall.time_step
        if self.settings.relaxation == "adaptive":
            wall.adaptive_damping = ADAPTIVE_DAMPING
        else:
            wall.local_damping = LOCAL_DAMPING
        wall.start(np.zeros((0, 2)), GRAVITY * np.minimum(1.0, np.arange(round(RAMP_S / dt) + 1) * dt / RAMP_S))
        while self.keep_going(self, self.time):
            wall.run(self.sample_steps)
            held = self.time - RAMP_S
            if held >= HOLD_S and (wall.unbalanced_force() < AT_REST or held > HOLD_AT_MOST_S):
                break
        else:
            return False
        self.writer.static_stage(
            base_reaction_n=wall.base_force()[1], weight_n=self.layout.total_mass * GRAVITY,
            unbalanced_force=wall.unbalanced_force(), broken_joints=int(np.sum(wall.state > 0)),
            duration_s=self.time)
        self._log_events(start_s=-self.time)
        return True

    def start(self, first_mode):
        """Time zero: the base motion starts, or the wall is kicked into its first mode.

        first_mode: shape (n_bodies, 3), 1 at the top.
        """
        wall, loading = self.wall, self.settings.loading
        wall.start(schedule.base_acceleration(self.settings, self.schedule, wall.time_step))
        if isinstance(loading, TopDisplacement):
            wall.hold(self.layout.pushed_bodies, rotation=loading.boundary == "fixed")
            wall.local_damping = loading.local_damping if self.settings.relaxation == "local" else 0.0
        else:
            wall.adaptive_damping = 0.0
            self._damp(settling=False)
            wall.velocity = getattr(loading, "top_velocity_m_s", 0.0) * first_mode
        wall.energy[:] = 0.0
        self._zero = wall.displacement.copy(), wall.elastic_energy()
        self.stage = "motion"
        self.record()

    def run_pushed(self):
        """Move the top as a quasi-static loading says; True unless interrupted."""
        interval = self.sample_steps * self.wall.time_step
        for velocity in self.settings.loading.velocities(interval, self.layout.pushed_height):
            if not self.keep_going(self, self.time):
                return False
            self.wall.push(velocity)
            self.wall.run(self.sample_steps)
            self.record()
            if self.collapsed_at_s is not None:
                break
        return True

    def run_all(self):
        """Motion, rest and settling; True unless interrupted."""
        finished = self._run_stages()
        self.writer.snapshot(self.time, self.wall.displacement - self._zero[0])
        return finished

    def _run_stages(self):
        if isinstance(self.settings.loading, TopDisplacement):
            return self.run_pushed()
        for stage in self.schedule:
            self.stage = stage.name
            self._damp(settling=stage.name == "settling")
            while self.wall.step - self.wall.first_step < stage.end_step:
                if not self.keep_going(self, self.time):
                    return False
                self.wall.run(self.sample_steps)
                self.record()
                if self.collapsed_at_s is not None:
                    return True
        return True

    def _damp(self, settling):
        """Local damping while settling, that of the settings otherwise: both at once are unstable at this step."""
        wall, settings = self.wall, self.settings
        wall.local_damping = LOCAL_DAMPING if settling else 0.0
        wall.alpha, wall.beta = (0.0, 0.0) if settling else (settings.alpha_1_s, settings.beta_s)

    def record(self):
        """Write one sample of everything."""
        wall = self.wall
        motion = wall.displacement - self._zero[0]
        top = float(motion[self.layout.drift_bodies, 0].mean())
        self.drift = top / self.layout.drift_height
        base = wall.base[step] if (step := wall.step - wall.first_step) < len(wall.base) else np.zeros(2)
        row = {
            "time_s": self.time, "base_acceleration_x_m_s2": base[0], "base_acceleration_z_m_s2": base[1],
            "top_displacement_m": top, "drift_ratio": self.drift,
            "base_shear_n": wall.base_force()[0], "top_force_n": wall.push_force(),
            "kinetic_energy_j": wall.kinetic_energy(base),
            "elastic_energy_j": wall.elastic_energy() - self._zero[1],
            "gravity_energy_j": GRAVITY * float(self.layout.bodies.mass @ motion[:, 1]),
            **dict(zip(("input_energy_j", "friction_energy_j", "fracture_energy_j", "damping_energy_j"),
                       wall.energy.tolist())),
        }
        self.writer.append(self.stage, row, wall.opening, wall.slip, wall.state)
        if self.samples % SNAPSHOT_SAMPLES == 0:
            self.writer.snapshot(self.time, motion)
        self.samples += 1
        self._log_events()
        if has_collapsed(self.layout, motion):
            self.collapsed_at_s = self.time

    def _log_events(self, start_s=0.0):
        for step, joint, kind, (sigma, tau, opening, slip) in zip(*self.wall.drain_events()):
            self.writer.event(start_s + step * self.wall.time_step, joint, EVENT_KINDS[kind], sigma, tau, opening, slip)
