"""The Python engine inside YADE: moves the base, logs every break, samples joints and energies.

It runs in every step, between the interaction loop and the integration, where positions and forces
belong to the same instant.
"""

import numpy as np
from yade import O

from damage.history.schema import AT_LIMIT, BROKEN
from damage.history.writer import SNAPSHOT_SAMPLES
from damage.index import THRESHOLD
from damage.run.watch import has_collapsed, index_now
from damage.units import GRAVITY
from damage.wall.kinematics import ContactKinematics
from yade_scripts.joint_tracker import JointTracker
from yade_scripts.scene import SceneReader

JOINT_STEPS = 10  # steps between two samples of the broken joints


class Recorder:
    """Observes a YadeWall and writes its history.

    Outside the static stage call `start_clock` once; then every step goes to the file.
    """

    def __init__(self, model, writer, sample_steps):
        self.model, self.writer, self.layout = model, writer, model.layout
        self.scene = SceneReader(model)
        self.kinematics = ContactKinematics(model.layout)
        self.tracker = JointTracker(model.layout, THRESHOLD)
        self.sample_steps = sample_steps
        self.stage, self.samples, self.index = "static", 0, 0.0
        self.collapsed_at_s = None
        self.base = np.zeros((1, 2))  # base acceleration of every step [m/s2]; zero afterwards
        self.top = None  # a PushedTop where the wall is pushed
        self.ramp_steps = 1  # over which the static stage brings gravity up
        self._first_step, self._breaks_seen, self._early_events = None, 0, []
        self._zero, self._known = None, (0, None)
        self._input_power, self._input_time, self._input_energy = 0.0, 0.0, 0.0
        self._undamped_balance = self._damped = 0.0

    # --- the clock ------------------------------------------------------------------------------

    @property
    def time(self):
        """Time since the start of the motion [s]."""
        return (O.iter - self._first_step) * O.dt

    def start_clock(self, base_acceleration):
        """The static stage is over: time zero, energies and drift count from here."""
        self._zero = (self.scene.motion(), self.scene.elastic_energy(self.tracker.broken),
                      self.tracker.friction_energy, self.tracker.fracture_energy)
        self.base = base_acceleration
        self._first_step = O.iter
        for step, *event in self._early_events:
            self.writer.event((step - O.iter) * O.dt, *event)
        self.stage = "motion"

    def base_acceleration(self):
        """Base acceleration (x, z) of this step [m/s2]."""
        step = O.iter - self._first_step if self._first_step is not None else len(self.base)
        return self.base[step] if step < len(self.base) else (0.0, 0.0)

    # --- one step -------------------------------------------------------------------------------

    def step(self):
        """What the engine does in every step."""
        ax, az = self.base_acceleration()
        gravity = GRAVITY * min(1.0, O.iter / self.ramp_steps)
        self.model.newton.gravity = (-float(ax), 0.0, -gravity - float(az))
        law = self.model.law
        if law.nbTensCracks + law.nbShearCracks != self._breaks_seen:
            self._log_breaks()
        if self.stage == "static":
            return
        step = O.iter - self._first_step
        if step % JOINT_STEPS == 0:
            self._sample_joints()
            self._integrate_input((ax, az))
        if step % self.sample_steps == 0:
            self.record()
            if self.top:
                self._push(step // self.sample_steps)

    def _log_breaks(self):
        law, tracker = self.model.law, self.tracker
        self._breaks_seen = law.nbTensCracks + law.nbShearCracks
        new = np.flatnonzero(~self.scene.still_bonded() & ~tracker.broken)
        _, shear = self.kinematics.displacements(self.scene.motion(), new)
        for joint, slip in zip(new, shear):
            opening = self.scene.opening_of(joint)
            sigma = tracker.normal_stiffness[joint] * opening
            tau = tracker.shear_stiffness[joint] * slip
            kind = "tension" if sigma > self.layout.contacts.tensile_strength[joint] else "shear"
            tracker.breaks(joint, kind, sigma, tau)
            self._event(int(joint), kind, sigma, tau)

    def _sample_joints(self):
        broken = np.flatnonzero(self.tracker.broken)
        if len(broken) == 0:
            return
        _, shear = self.kinematics.displacements(self.scene.motion(self._bodies_at(broken)), broken)
        opening = np.array([self.scene.opening_of(i) for i in broken])
        tau = self.scene.shear_stresses(broken)
        for joint, kind in self.tracker.sample(broken, opening, shear, tau):
            self._event(joint, kind, opening=self.tracker.opening[joint], slip=self.tracker.slip[joint])

    def _bodies_at(self, joints):
        """Bodies on either side of the joints, kept between samples as long as the joints are."""
        if len(joints) != self._known[0]:
            ends = np.concatenate([end[joints] for end in self.kinematics.ends])
            self._known = len(joints), np.unique(ends[ends < len(self.layout.bodies)])
        return self._known[1]

    def _event(self, joint, kind, *values, **named):
        if self._first_step is None:
            self._early_events.append((O.iter, joint, kind, *values))
        else:
            self.writer.event(self.time, joint, kind, *values, **named)

    def _push(self, interval):
        self._input_energy += self.top.prescribe(interval)
        self._input_power = self.top.power()

    def _integrate_input(self, base):
        """Work of the pushed top, or of the base's inertia forces in the frame that moves with it, by trapezia."""
        if self.top:
            power = self.top.power()
        else:
            power = -float(np.dot(base, self._momentum())) if np.any(base) else 0.0
        self._input_energy += (power + self._input_power) / 2 * (self.time - self._input_time)
        self._input_power, self._input_time = power, self.time

    def _momentum(self):
        half = O.dt / 2
        mass, total = self.scene.mass[:, 0], self.scene.mass[:, 0].sum()
        momentum = mass @ self.scene.velocities()[:, :2]
        force = np.array([-self.scene.base_shear(), self.scene.base_reaction()])
        return momentum + half * (force + total * np.array(self.model.newton.gravity)[[0, 2]])

    # --- one sample -----------------------------------------------------------------------------

    def record(self):
        """Write one sample of everything."""
        motion = self.scene.motion() - self._zero[0]
        top = float(motion[self.layout.drift_bodies, 0].mean())
        drift = top / self.layout.drift_height
        state = BROKEN * self.tracker.broken + AT_LIMIT * self.tracker.at_limit
        ax, az = self.base_acceleration()
        row = {"time_s": self.time, "base_acceleration_x_m_s2": ax, "base_acceleration_z_m_s2": az,
               "top_displacement_m": top, "drift_ratio": drift, "base_shear_n": self.scene.base_shear(),
               "top_force_n": self.top.force() if self.top else np.nan,
               **self._energies(motion, (ax, az))}
        self.writer.append(self.stage, row, self.tracker.opening, self.tracker.slip, state)
        if self.samples % SNAPSHOT_SAMPLES == 0:
            self.writer.snapshot(self.time, motion)
        self.samples += 1
        self._watch(motion, drift)

    def snapshot(self):
        """Write the bodies' displacement now: the last shape of a run."""
        self.writer.snapshot(self.time, self.scene.motion() - self._zero[0])

    def _energies(self, motion, base):
        """Energies since the end of the static stage [J]; damping is what local damping took in
        the settling stages, or while the top is pushed, inferred from the balance there: YADE's own sum of
        it takes the contacts' forces alone, without the weights that balance them."""
        speed = self.scene.synchronous_velocities(O.dt / 2, base)
        _, elastic, friction, fracture = self._zero
        energies = {
            "kinetic_energy_j": 0.5 * float(np.sum(self.scene.mass * speed**2)),
            "elastic_energy_j": self.scene.elastic_energy(self.tracker.broken) - elastic,
            "gravity_energy_j": GRAVITY * float(self.scene.mass[:, 0] @ motion[:, 1]),
            "friction_energy_j": self.tracker.friction_energy - friction,
            "fracture_energy_j": self.tracker.fracture_energy - fracture,
        }
        balance = sum(energies.values()) - self._input_energy
        if self.stage == "settling" or self.top:
            self._damped = self._undamped_balance - balance
        else:
            self._undamped_balance = balance + self._damped
        return {**energies, "input_energy_j": self._input_energy, "damping_energy_j": self._damped}

    def _watch(self, motion, drift):
        """Note a collapse, and the index for the progress line."""
        if self.collapsed_at_s is None and has_collapsed(self.layout, motion):
            self.collapsed_at_s = self.time
        self.index = index_now(self.layout, drift, self.tracker.opening, self.tracker.slip)
