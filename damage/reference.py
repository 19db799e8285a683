"""The built-in reference solver: a wall of rigid blocks, explicit in time, in the plane.

The same layout, joint law, stages, loading and history file as the walls in YADE; the time step itself
is `damage.reference_kernel`.
"""

import numpy as np

from damage import reference_kernel as kernel
from damage.errors import InputError
from damage.history import AT_LIMIT, BROKEN
from damage.index import THRESHOLD
from damage.joint_law import SHEAR, TENSION, elastic_energy
from damage.layout import GROUND, HEAD
from damage.units import GRAVITY

STEP_FACTOR = 0.35
"""Working time step over the critical one: undamped joints that open and close heat up at larger ones."""
EVENT_KINDS = {TENSION: "tension", SHEAR: "shear", kernel.OPENED: "opened", kernel.SLIPPED: "slipped"}
_CAPACITY = 100_000  # events between two drains of the log


class ReferenceWall:
    """One wall and its state; time is counted in steps.

    layout: damage.layout.Layout; time_step [s]; beta: stiffness-proportional damping [s];
    alpha: mass-proportional damping [1/s].
    """

    def __init__(self, layout, time_step, *, beta=0.0, alpha=0.0):
        self.layout, self.time_step, self.step = layout, time_step, 0
        self.beta, self.alpha, self.local_damping = beta, alpha, 0.0
        self.base, self.gravity = np.zeros((0, 2)), np.array([GRAVITY])
        self.first_step = 0  # step at which `base` and `gravity` begin
        self.system = _make_system(layout)
        self._held = None

    # --- state, as arrays in the layout's order -------------------------------------------------

    @property
    def displacement(self):
        """(n_bodies, 3) [m, m, rad] since the wall was built."""
        return self.system.place[:-1][:, [kernel.X, kernel.Z, kernel.TURN]]

    @property
    def velocity(self):
        """(n_bodies, 3) half a step ago; assign into it."""
        return self.system.velocity[:-1]

    @property
    def opening(self):
        """Opening past the broken bond (n_joints,) [m]."""
        joints = self.system.joints[:self.layout.n_joints]
        return np.where(joints[:, kernel.BROKEN] > 0, np.maximum(joints[:, kernel.OPENING], 0.0), 0.0)

    @property
    def slip(self):
        """Plastic slip of the closed contacts (n_joints,) [m]."""
        return self.system.joints[:self.layout.n_joints, kernel.SLIP]

    @property
    def state(self):
        """Bits BROKEN and AT_LIMIT (n_joints,)."""
        joints = self.system.joints[:self.layout.n_joints]
        return (BROKEN * (joints[:, kernel.BROKEN] > 0) + AT_LIMIT * (joints[:, kernel.AT_LIMIT] > 0)).astype("u1")

    @property
    def energy(self):
        """Input, friction, fracture and damping energy [J] since `reset_energy`."""
        return self.system.energy

    # --- what moves it --------------------------------------------------------------------------

    def run(self, n_steps):
        """Advance; afterwards forces and stresses belong to the present places."""
        step = self.step - self.first_step
        kernel.run_steps(self.system, self._constants(), self.base, self.gravity, step, n_steps, self.time_step)
        self.step += n_steps
        self.refresh()

    def refresh(self):
        """Forces and stresses at the present places."""
        kernel.contact_forces(self.system, self._constants(), self.step - self.first_step, self.time_step)
        if not np.isfinite(self.system.force).all():
            raise FloatingPointError(f"forces are no longer finite at step {self.step}: the time step of "
                                     f"{self.time_step:.3g} s is too large for this wall")

    def start(self, base, gravity=None):
        """From this step on move the base by `base` (k, 2) [m/s2] under `gravity` (k,) [m/s2]."""
        self.base = np.ascontiguousarray(base, float).reshape(-1, 2)
        self.gravity = np.array([GRAVITY]) if gravity is None else np.ascontiguousarray(gravity, float)
        self.first_step = self.step

    def _constants(self):
        joint = self.layout.wall.joint
        return kernel.Constants(float(np.tan(joint.friction_angle)), THRESHOLD, self.layout.n_joints,
                                self.local_damping, self.alpha, self.beta)

    def drain_events(self):
        """(steps since `start`, joints, kinds, values (n, 4)) logged since the last call."""
        count = int(self.system.n_events[0])
        if count > _CAPACITY:
            raise OverflowError(f"{count} events between two samples, {_CAPACITY} fit; sample more often")
        self.system.n_events[0] = 0
        events = self.system.events[:count].copy()
        return events[:, 0], events[:, 1], events[:, 2], self.system.values[:count].copy()

    def hold(self, bodies, rotation):
        """From now on prescribe the horizontal velocity of bodies, and no rotation if `rotation`."""
        self._held = bodies
        self.system.mass[bodies, kernel.FREE] = 0.0
        self.system.velocity[bodies, 0] = 0.0
        if rotation:
            self.system.mass[bodies, kernel.FREE + 2] = 0.0
            self.system.velocity[bodies, 2] = 0.0

    def push(self, velocity):
        """Prescribe the horizontal velocity of the held bodies [m/s]; the jump's work is input."""
        old = self.system.velocity[self._held, 0]
        self.energy[kernel.INPUT] += 0.5 * np.sum(self.layout.bodies.mass[self._held] * (velocity**2 - old**2))
        self.system.velocity[self._held, 0] = velocity

    def push_force(self):
        """Horizontal force that moves the held bodies [N], NaN where none are held."""
        if self._held is None:
            return np.nan
        return -float(self.system.force[self._held, 0].sum())

    # --- what is measured -----------------------------------------------------------------------

    def base_force(self):
        """Horizontal and downward force of the wall on the ground [N]."""
        force = self.system.force[-1]
        return float(force[0]), float(-force[1])

    def unbalanced_force(self):
        """Mean resultant on a body, weight included, over the mean contact force [-]."""
        mass, force = self.layout.bodies.mass, self.system.force[:-1]
        resultant = np.hypot(force[:, 0], force[:, 1] - GRAVITY * mass)
        joints, area = self.system.joints, self.layout.contacts.area
        contact = np.hypot(joints[:, kernel.SIGMA], joints[:, kernel.TAU]) * area
        return float(resultant.mean() / contact.mean())

    def kinetic_energy(self, base_acceleration=(0.0, 0.0)):
        """At the instant of the places: velocities are carried half a step on [J]."""
        bodies = self.layout.bodies
        mass = np.column_stack([bodies.mass, bodies.mass, bodies.inertia])
        field = np.array([-base_acceleration[0], -GRAVITY - base_acceleration[1], 0.0])
        moves = self.system.mass[:-1, kernel.FREE:]
        speed = self.velocity + self.time_step / 2 * (self.system.force[:-1] / mass + field) * moves
        return 0.5 * float(np.sum(mass * speed**2))

    def elastic_energy(self):
        """Of all contacts [J]."""
        contacts, joints = self.layout.contacts, self.system.joints
        return float(np.sum(contacts.area * elastic_energy(
            joints[:, kernel.SIGMA], joints[:, kernel.TAU], contacts.normal_stiffness, contacts.shear_stiffness)))


def _make_system(layout):
    """The kernel's tables for a wall at rest."""
    contacts, bodies = layout.contacts, layout.bodies
    n, m = len(contacts), len(bodies)
    x, z = np.append(bodies.x, 0.0), np.append(bodies.z, 0.0)
    ends = [np.where(body == GROUND, m, body) for body in (contacts.first, contacts.second)]
    joint = layout.wall.joint
    table = np.column_stack([
        *(arm for end in ends for arm in (contacts.x - x[end], contacts.z - z[end])),
        contacts.kind == HEAD, contacts.area, contacts.normal_stiffness, contacts.shear_stiffness,
        np.where(contacts.elastic, np.inf, joint.tensile_strength),
        np.where(contacts.elastic, np.inf, joint.cohesion)])
    mass = np.zeros((m + 1, 5))
    mass[:m] = np.column_stack([bodies.mass, bodies.inertia, np.ones((m, 3))])
    return kernel.System(
        ends=np.column_stack(ends).astype(np.int64), contacts=np.ascontiguousarray(table, float),
        joints=np.zeros((n, 8)), place=np.zeros((m + 1, 5)), velocity=np.zeros((m + 1, 3)),
        force=np.zeros((m + 1, 3)), mass=mass, energy=np.zeros(4),
        events=np.zeros((_CAPACITY, 3), np.int64), values=np.zeros((_CAPACITY, 4)),
        n_events=np.zeros(1, np.int64))


def choose_time_step(settings, critical_s):
    """The run's time step [s]; InputError above the stable one.

    Stiffness-proportional damping lowers the critical step to
    (2 / omega) (sqrt(1 + xi^2) - xi), xi = beta omega / 2; local damping by sqrt(1 + damping).
    """
    from damage.options import LOCAL_DAMPING

    xi = settings.beta_s / critical_s
    limit = critical_s * min(np.sqrt(1 + xi**2) - xi, 1 / np.sqrt(1 + LOCAL_DAMPING))
    if settings.time_step_s is None:
        return settings.loading.preferred_step_s(min(STEP_FACTOR * critical_s, 0.8 * limit))
    if settings.time_step_s > limit:
        raise InputError(f"--dt {settings.time_step_s:g} s is above the stable time step {limit:.4g} s "
                         f"(critical {critical_s:.4g} s, lowered by damping); give a smaller one")
    return settings.time_step_s
