"""A wall of the reference solver: rigid bodies in the plane, integrated explicitly in time.

Layout, joint law, stages, loading and history file are those of walls in YADE.  The time step is
`damage.mechanics.step`.  Walls with equal bricks can advance together (`damage.reference.lanes`).
"""

import math

import numpy as np

from damage.elementary import sin, total
from damage.linear.modes import static_displacement
from damage.mechanics import tables
from damage.mechanics.build import (
    CAPACITY,
    build,
    cut_tables,
    law_of,
    strain_tables,
    sum_springs,
)
from damage.mechanics.factor import scaled_mass
from damage.mechanics.samples import ELASTIC, FIELD_NAMES, KINETIC
from damage.mechanics.tables import (
    BEAM_SHARE,
    RIGID,
    ROTATION,
    SPRING_REST,
    SPRING_STIFFNESS,
    X,
    copy_lines,
)
from damage.reference.lanes import Lanes, run_together
from damage.units import GRAVITY


class ReferenceWall:
    """A wall and its state; time is counted in steps.

    layout: damage.wall.layout.Layout; time_step [s]; beta: stiffness-proportional damping [s];
    alpha: mass-proportional damping [1/s]; scaled: contact points whose stiffness scales the masses
    (`damage.mechanics.scaling`) for this time step and beta: None, a mask (n_contacts,), or
    slice(None) for all, which goes without local damping.  time_step, beta, alpha, `local_damping`
    (Cundall's, [-]) and `adaptive_damping` (`damage.mechanics.bodies.adaptive_damping`, [-]) can be
    changed at any time.
    with_stresses: whether samples hold the stresses of the joints.
    """

    with_stresses = False

    def __init__(self, layout, time_step, *, beta=0.0, alpha=0.0, scaled=None):
        self.layout = layout
        self.time_step = time_step
        self.step = 0
        self.beta = beta
        self.alpha = alpha
        self.local_damping = 0.0
        self.adaptive_damping = 0.0
        self.mean_1_s = 0.0
        self.base = np.zeros((0, 2))
        self.gravity = np.array([GRAVITY])
        self.first_step = 0  # step at which `base` and `gravity` begin
        # in a batch: of the steps asked for, those taken, and the samples before its last call
        self.taken = 0
        self.earlier = []
        built = build(layout)
        self.strain = strain_tables(layout)
        self.cuts = cut_tables(layout, built.interfaces)
        self.mass = None if scaled is None else scaled_mass(layout, time_step, beta, points=scaled)
        self.lanes = Lanes([self], built)  # of the last step; sets `system`, too
        self._pushed = None
        self._is_driven = False
        self._spreads = False
        self._active = (0, np.empty(0, int))
        self.refresh()

    @property
    def clock(self):
        """Steps since `start`."""
        return self.step - self.first_step

    # --- state, as arrays in the layout's order -------------------------------------------------

    @property
    def displacement(self):
        """Displacements and rotations since the wall was built, (n_bodies, 3) [m, m, rad]; can be
        assigned."""
        return self.system.place[: self.layout.n_bodies, :RIGID].copy()

    @displacement.setter
    def displacement(self, values):
        self.place_bodies(values)
        self.refresh()

    def place_bodies(self, values):
        """Set the displacements of the bodies, (n_bodies, 3) [m, m, rad], without updating
        forces."""
        bodies = slice(self.layout.n_bodies)
        self.system.place[bodies, :RIGID] = values
        angle = self.system.place[bodies, ROTATION]
        self.system.trig[bodies, 0] = -2 * sin(angle / 2) ** 2
        self.system.trig[bodies, 1] = sin(angle)

    @property
    def velocity(self):
        """Velocities half a step ago, (n_bodies, 3) [m/s, m/s, rad/s]; can be assigned."""
        return self.system.velocity[: self.layout.n_bodies, :RIGID].copy()

    @velocity.setter
    def velocity(self, values):
        # rigid coordinates, or strain modes, too
        given = np.shape(values)[-1] if np.ndim(values) else None
        self.system.velocity[: self.layout.n_bodies, :given] = values

    def add_static_displacement(self):
        """Move all coordinates by the linear static solution of the intact wall under its
        weight."""
        self.system.place[: self.layout.n_bodies] += static_displacement(self.layout)
        self.displacement = self.displacement  # and what follows from it

    @property
    def force(self):
        """Forces of the contact points on each body, the supports last, (n_bodies + n_supports, 3)
        [N, N, N m]."""
        return self.system.force[:, :RIGID].copy()

    @property
    def opening(self):
        """Inelastic opening of failed and softened contact points, (n_joints,) [m]."""
        return self.contact_data(self.sample_now())["opening_m"][0]

    @property
    def slip(self):
        """Accumulated slip: plastic shear displacement while closed, (n_joints,) [m]."""
        return self.system.states["slip"][: self.layout.n_joints]

    @property
    def offset(self):
        """Shear displacement less its elastic part, (n_joints,) [m]; zero where intact."""
        return self.contact_data(self.sample_now())["offset_m"][0]

    @property
    def state(self):
        """State of the contact points, (n_joints,) bits BROKEN, AT_LIMIT, CRUSHED, ENDED of
        damage.law.states."""
        return self.contact_data(self.sample_now())["state"][0]

    @property
    def energy(self):
        """Input, friction, fracture and damping energy since `start`, (4,) [J]."""
        return self.system.energy

    @property
    def stresses(self):
        """Normal stress, tension positive, and shear stress of the contacts of the tables, (2,
        contacts) [Pa]."""
        return self.system.readings[tables.READINGS.index("sigma") :].copy()

    def sample_now(self):
        """Samples with a single sample, of the present time."""
        field = self.field(1)[0]
        field[2] = GRAVITY
        return self.lanes.sample_now(self, field)

    def field(self, n_steps):
        """Acceleration of the base along x and z and gravity in the next steps, (n_steps, 3)
        [m/s2].

        After their ends the base is at rest and gravity keeps its last value.
        """
        first = self.clock
        rows = np.zeros((n_steps, 3))
        base = self.base[first : first + n_steps]
        gravity = self.gravity[first : first + n_steps]
        rows[: len(base), :2] = base
        rows[: len(gravity), 2] = gravity
        rows[len(gravity) :, 2] = self.gravity[-1]
        return rows

    def active_contacts(self):
        """Indices of the active contact points, those of failed interfaces."""
        interfaces = self.system.interfaces
        failed = self.system.limits[:, tables.HAS_FAILED] > 0
        if (count := np.count_nonzero(failed)) != self._active[0]:  # failure is permanent
            self._active = (
                count,
                np.flatnonzero(np.repeat(failed, interfaces["stop"] - interfaces["start"])),
            )
        return self._active[1]

    def contact_data(self, samples, joints=slice(None)):
        """Contact data of Samples of this wall, {name of FIELD_NAMES: (n, n_selected)}; joints:
        indices or a slice."""
        columns = {
            name: values[:, : self.layout.n_joints][:, joints]
            for name, values in zip(FIELD_NAMES, np.moveaxis(samples.contacts, 1, 0))
        }
        columns["state"] = columns["state"].astype("u1")
        return columns

    # --- loading and time steps -----------------------------------------------------------------

    def run(self, *steps):
        """Advance by numbers of steps, one after the other; after each there is a sample
        (`lanes.samples_of`).

        Forces and stresses are those at the present displacements before and after.  Raises
        FloatingPointError where forces are no longer finite.
        """
        (failure,) = run_together([self], *steps)
        if failure is not None:
            raise failure

    def refresh(self):
        """Recompute forces and stresses; to be called after displacements or contacts were changed
        directly."""
        system = self.system
        intact = system.states["kappa"] == 0.0
        kn = law_of(system).normal_stiffness
        system.states["elastic_tension_stiffness"][intact] = kn[intact]
        sum_springs(system, self.layout.strain)
        if not self.lanes.are_of([self]):
            Lanes([self])
        copy_lines(self.lanes.tables)
        self.lanes.find_forces()

    @property
    def controls(self):
        """Values of the columns of `controls`, `damage.mechanics.tables`."""
        damping = self.local_damping, self.alpha, self.beta, self.adaptive_damping
        return self.time_step, *damping, self.mean_1_s

    def start(self, base, gravity=None):
        """Set the acceleration of the base along x, z, (k, 2) [m/s2], and gravity, (k,) [m/s2],
        from this step on."""
        self.base = np.ascontiguousarray(base, float).reshape(-1, 2)
        self.gravity = (
            np.array([GRAVITY]) if gravity is None else np.ascontiguousarray(gravity, float)
        )
        self.first_step = self.step

    def drain_events(self):
        """Events logged since the last call: steps since `start`, contact points, kinds, each (n,),
        and values, (n, 4).

        Values: as of damage.mechanics.tables.System.  Raises OverflowError where more than CAPACITY
        were logged.
        """
        count = int(self.system.n_events[0])
        if count > CAPACITY:
            raise OverflowError(
                f"{count} events between two samples, {CAPACITY} fit; sample more often"
            )
        self.system.n_events[0] = 0
        events = self.system.events[:count].copy()
        values = self.system.values[:count].copy()
        return events[:, 0], events[:, 1], events[:, 2], values

    def hold(self, bodies, rotation, stiffness=0.0):
        """Prescribe the horizontal velocity of bodies (indices) from now on, first zero; rotation:
        prevent it, too; stiffness: of a rotational spring on each, from the present rotation on [N
        m/rad]."""
        self.system.turning[bodies, SPRING_STIFFNESS] = stiffness
        self.system.turning[bodies, SPRING_REST] = self.system.place[bodies, ROTATION]
        self._pushed = bodies
        self._is_driven = True
        for coordinate in (X, ROTATION) if rotation else (X,):
            self.system.inverse_mass[bodies, coordinate] = self.system.velocity[
                bodies, coordinate
            ] = 0.0
        if self.mass:
            prescribed = np.flatnonzero(self.system.inverse_mass[: self.layout.n_bodies] == 0)
            self.mass = scaled_mass(
                self.layout, self.time_step, self.mass.beta, prescribed.tolist(), self.mass.points
            )
            Lanes([self])

    def spread(self, shares):
        """Move bodies by a spreader beam from now on, first not at all: by forces in the ratio of
        shares (n_bodies,), whose sum is 1, so that the mean displacement of the bodies by these
        shares follows `push`."""
        bodies = slice(self.layout.n_bodies)
        self.system.turning[bodies, BEAM_SHARE] = shares
        place = float(total(shares * self.system.place[bodies, X]))
        self.system.beam[:] = (place, 0.0, 0.0)
        self._pushed = np.flatnonzero(shares)
        self._is_driven = True
        self._spreads = True

    def push(self, velocity):
        """Prescribe the horizontal velocity of the held bodies, or of a spreader beam [m/s]; the
        change of kinetic energy is input."""
        if self._spreads:
            self.system.beam["velocity"] = velocity
            return
        old = self.system.velocity[self._pushed, X]
        mass = self.layout.bodies.mass[self._pushed]
        self.energy[tables.INPUT] += 0.5 * np.sum(mass * (velocity * velocity - old * old))
        self._prescribe((self._pushed, X), velocity)

    def move_supports(self, velocity):
        """Prescribe the velocity of the supports, (n_supports, 3) or (3,) [m/s, m/s, rad/s]; their
        work is input."""
        self._is_driven = True
        self._prescribe((slice(self.layout.n_bodies, None), slice(RIGID)), velocity)

    def prescribe_no_more(self):
        """Supports keep their velocity from here; a held top is followed from sample to sample all
        the same."""
        self._is_driven = self._pushed is not None

    def _prescribe(self, which, velocity):
        """Set prescribed velocities; their work in the half step before now is that of the old ones
        (`damage.mechanics.samples.input_of_half_a_step`)."""
        change = velocity - self.system.velocity[which]
        self.energy[tables.INPUT] += (
            0.5 * self.time_step * np.sum(self.system.force[which] * change)
        )
        self.system.velocity[which] = velocity

    @property
    def support_force(self):
        """Forces of the wall on the supports, (n_supports, 3) [N, N, N m], moments about their
        reference points."""
        return self.system.force[self.layout.n_bodies :, :RIGID].copy()

    def push_force(self):
        """Horizontal force on the held bodies by their prescribed motion [N]; NaN where none are
        held."""
        if self._pushed is None:
            return np.nan
        if self._spreads:
            return float(self.system.beam["force"][0])
        return -float(self.system.force[self._pushed, X].sum())

    # --- results --------------------------------------------------------------------------------

    def base_force(self):
        """Horizontal and downward force of the wall on all supports [N]."""
        fx, fz, _ = self.support_force.sum(axis=0)
        return float(fx), -float(fz)

    def kinetic_energy(self):
        """Kinetic energy at the time of the displacements [J]: velocities are advanced by half a
        step."""
        return float(self.sample_now().totals[0, KINETIC])

    def elastic_energy(self):
        """Elastic energy of all contact points and of deformable bricks [J]."""
        now = self.sample_now()
        return float(np.sum(now.stored)) + float(now.totals[0, ELASTIC])

    def failure(self):
        """The error that ends a run of this wall in its present state, None where there is none."""
        if not math.isfinite(self.system.force.sum()):
            return FloatingPointError(
                f"forces are no longer finite at step {self.step}: the time step of "
                f"{self.time_step:.3g} s is too large for this wall"
            )
        return None
