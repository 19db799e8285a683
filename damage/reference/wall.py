"""The built-in reference solver: a wall of rigid blocks, explicit in time, in the plane.

The same layout, joint law, stages, loading and history file as the walls in YADE; the time step itself
is `damage.reference.kernel`.  Walls that share bricks and stiffnesses can step together, `run_together` of
`damage.reference.lanes`.
"""

import math

import numpy as np

from damage.errors import RunError
from damage.index import THRESHOLD
from damage.mechanics import tables
from damage.mechanics.build import CAPACITY, build, build_loose, contact_rows, sum_springs
from damage.mechanics.loose import FULL, INSIDE, NONE, STORED
from damage.mechanics.samples import FIELD_NAMES, KINETIC, Samples, Stiffness, observe
from damage.mechanics.tables import RIGID, ROTATION, X
from damage.reference.lanes import bind, run_together
from damage.units import GRAVITY
from damage.wall.joint_law import material_of


class ReferenceWall:
    """One wall and its state; time is counted in steps.

    layout: damage.wall.layout.Layout; time_step [s]; beta: stiffness-proportional damping [s];
    alpha: mass-proportional damping [1/s].  These, `local_damping` (Cundall's) and `adaptive_damping` (the
    share of the change of kinetic energy that adaptive global damping takes) can be set at any time.
    fast: move it by the fast step, which does not find new contacts; new_contacts: bodies whose joints have ended, or
    that had none, collide.
    """

    def __init__(self, layout, time_step, *, beta=0.0, alpha=0.0, fast=True, new_contacts=False):
        self.layout, self.time_step, self.step, self.fast = layout, time_step, 0, fast and not new_contacts
        self.beta, self.alpha, self.local_damping, self.adaptive_damping = beta, alpha, 0.0, 0.0
        self.base, self.gravity = np.zeros((0, 2)), np.array([GRAVITY])
        self.first_step = 0  # step at which `base` and `gravity` begin
        self.system, row = build(layout, self.material), contact_rows(layout)[0]
        self.loose = build_loose(layout, self.system, time_step, self.material) if new_contacts else NONE
        self.stiffness = Stiffness(self.system.contacts["area"].copy(), layout.contacts.normal_stiffness[row],
                                   layout.contacts.shear_stiffness[row])
        self.lanes = None  # those that the wall was last moved in
        self._held, self._is_driven, self._active = None, False, (0, np.empty(0, int))
        self._passed = {kind: np.zeros(layout.n_joints, bool) for kind in (tables.OPENED, tables.SLIPPED)}
        self.refresh()

    # --- state, as arrays in the layout's order -------------------------------------------------

    @property
    def displacement(self):
        """(n_bodies, 3) [m, m, rad] since the wall was built; can be assigned."""
        return self.system.place[:len(self.layout.bodies), :RIGID].copy()

    @displacement.setter
    def displacement(self, values):
        self.place_bodies(values)
        self.refresh()

    def place_bodies(self, values):
        """Give the bodies displacements (n_bodies, 3) [m, m, rad], without their forces."""
        bodies = slice(len(self.layout.bodies))
        self.system.place[bodies, :RIGID] = values
        angle = self.system.place[bodies, ROTATION]
        self.system.trig[bodies, 0], self.system.trig[bodies, 1] = -2 * np.sin(angle / 2)**2, np.sin(angle)

    @property
    def velocity(self):
        """(n_bodies, 3) [m/s, m/s, rad/s] half a step ago; can be assigned."""
        return self.system.velocity[:len(self.layout.bodies), :RIGID].copy()

    @velocity.setter
    def velocity(self, values):
        self.system.velocity[:len(self.layout.bodies), :RIGID] = values

    @property
    def force(self):
        """Of the contacts on each body, the supports last: (n_bodies + supports, 3) [N, N, N m]."""
        return self.system.force[:, :RIGID].copy()

    @property
    def opening(self):
        """Inelastic opening (n_joints,) [m]: past the broken bond, or what a softened one has given way."""
        return self.contact_data(self.sample_now())["opening_m"][0]

    @property
    def slip(self):
        """Plastic slip of the closed contacts (n_joints,) [m]."""
        return self.of_joints(self.system.states["slip"])

    @property
    def offset(self):
        """Shear displacement less its elastic part (n_joints,) [m] of what has broken or softened, zero elsewhere; of
        fibres by their shares, each with its own stress."""
        return self.contact_data(self.sample_now())["offset_m"][0]

    @property
    def state(self):
        """Bits BROKEN, AT_LIMIT and CRUSHED (n_joints,)."""
        return self.contact_data(self.sample_now())["state"][0]

    @property
    def energy(self):
        """Input, friction, fracture and damping energy [J] since `start`."""
        return self.system.energy

    @property
    def stresses(self):
        """Normal stress, tension positive, and shear stress of the kernel's contacts (2, contacts) [Pa]."""
        return self.system.readings[[tables.READ_SIGMA, tables.READ_TAU]]

    def sample_now(self):
        """Samples of one: contact data, places and energies of this instant."""
        samples = self.room(1, 1)
        field = self.field(1)[0]
        field[2] = GRAVITY
        observe(self.system, self.stiffness, field, self.time_step, samples, 0, 0)
        samples.loose[0, 0] = self.loose.energy[STORED]
        return samples.of(0, slice(1))

    def room(self, n_walls, n_samples):
        """Samples of so many walls like this, zero."""
        return Samples.none(n_walls, n_samples, self.system, len(self.layout.supports))

    def field(self, n_steps):
        """Acceleration of the base along x and z, zero beyond its end, and gravity, whose last value holds beyond its
        end: (n_steps, 3) [m/s2] of the next steps."""
        first, rows = self.step - self.first_step, np.zeros((n_steps, 3))
        base, gravity = self.base[first:first + n_steps], self.gravity[first:first + n_steps]
        rows[:len(base), :2] = base
        rows[:len(gravity), 2], rows[len(gravity):, 2] = gravity, self.gravity[-1]
        return rows

    def active_contacts(self):
        """The active contact points, those of failed interfaces: indices, or a slice where parallel elements fail."""
        if self.layout.fibres is not None:
            return slice(None)
        interfaces = self.system.interfaces
        failed = interfaces["failed"] > 0
        if (count := np.count_nonzero(failed)) != self._active[0]:  # an interface that has failed stays so
            self._active = count, np.flatnonzero(np.repeat(failed, interfaces["stop"] - interfaces["start"]))
        return self._active[1]

    def contact_data(self, samples, joints=slice(None)):
        """{name of FIELD_NAMES: (n, n_selected)} of Samples of this wall, at these joints; parallel elements by their
        shares, and the state by the last of each that fails."""
        fibres, n, found = self.layout.fibres, self.layout.n_joints, {}
        for name, values in zip(FIELD_NAMES, np.moveaxis(samples.contacts, 1, 0)):
            of_joints = values if fibres is None else values[:, fibres.last] if name == "state" else fibres.mean(values)
            found[name] = of_joints[:, :n][:, joints]
        found["state"] = found["state"].astype("u1")
        return found

    def of_joints(self, values):
        """Values of the kernel's contacts as those of the joints (..., n_joints): fibres by their shares."""
        fibres = self.layout.fibres
        return (values if fibres is None else fibres.mean(values))[..., :self.layout.n_joints]

    # --- what moves it --------------------------------------------------------------------------

    def run(self, *steps):
        """Advance by these numbers of steps, one after the other; before and after each forces and stresses belong to
        the present places, and `lanes.samples_of` gives what was."""
        (failure,) = run_together([self], *steps)
        if failure is not None:
            raise failure

    def refresh(self):
        """Forces and stresses, to be called where places or contacts were changed by hand."""
        system = self.system
        intact = system.states["kappa"] == 0.0
        system.states["elastic_tension_stiffness"][intact] = system.contacts["kn"][intact]
        sum_springs(system.interfaces, system.contacts, self.material)
        bind([self]).find_forces(singly=True)

    @property
    def material(self):
        """What the joint law's contacts share."""
        return material_of(self.layout.wall.joint)

    @property
    def controls(self):
        """Time step [s], local damping [-], alpha [1/s], beta [s] and adaptive damping [-]."""
        return self.time_step, self.local_damping, self.alpha, self.beta, self.adaptive_damping

    def start(self, base, gravity=None):
        """From this step on move the base by `base` (k, 2) [m/s2] under `gravity` (k,) [m/s2]."""
        self.base = np.ascontiguousarray(base, float).reshape(-1, 2)
        self.gravity = np.array([GRAVITY]) if gravity is None else np.ascontiguousarray(gravity, float)
        self.first_step = self.step

    def drain_events(self):
        """(steps since `start`, joints, kinds, values (n, 4)) logged since the last call."""
        count = int(self.system.n_events[0])
        if count > CAPACITY:
            raise OverflowError(f"{count} events between two samples, {CAPACITY} fit; sample more often")
        self.system.n_events[0] = 0
        events, values = self.system.events[:count].copy(), self.system.values[:count].copy()
        if self.layout.fibres is not None:
            events, values = self._events_of_fibres(events, values)
        return events[:, 0], events[:, 1], events[:, 2], values

    def _events_of_fibres(self, events, values):
        """A contact breaks with the last of its fibres; what it opens and slips is known now, at the sample."""
        fibres = self.layout.fibres
        of_contacts = fibres.last[events[:, 1]] & (events[:, 2] < tables.OPENED)
        events, values = events[of_contacts], values[of_contacts]
        events[:, 1] = fibres.contact[events[:, 1]]
        stresses = map(self.of_joints, self.stresses)
        now = np.column_stack([*stresses, self.opening, self.slip])
        for kind, size in ((tables.OPENED, now[:, 2]), (tables.SLIPPED, np.abs(now[:, 3]))):
            new = np.flatnonzero((size > THRESHOLD) & ~self._passed[kind])
            self._passed[kind][new] = True
            step = np.full(len(new), self.step - self.first_step)
            events = np.vstack([events, np.column_stack([step, new, np.full(len(new), kind)])])
            values = np.vstack([values, now[new]])
        return events, values

    def hold(self, bodies, rotation):
        """From now on prescribe the horizontal velocity of bodies, and no rotation if `rotation`."""
        self._held, self._is_driven = bodies, True
        for coordinate in (X, ROTATION) if rotation else (X,):
            self.system.inverse_mass[bodies, coordinate] = self.system.velocity[bodies, coordinate] = 0.0

    def push(self, velocity):
        """Prescribe the horizontal velocity of the held bodies [m/s]; the jump's work is input."""
        old, mass = self.system.velocity[self._held, X], self.layout.bodies.mass[self._held]
        self.energy[tables.INPUT] += 0.5 * np.sum(mass * (velocity**2 - old**2))
        self.system.velocity[self._held, X] = velocity

    def move_supports(self, velocity):
        """Prescribe the velocity of the supports, (n_supports, 3) or one of all [m/s, m/s, rad/s]; their work on the
        wall is input."""
        self._is_driven = True
        self.system.velocity[len(self.layout.bodies):, :RIGID] = velocity

    @property
    def support_force(self):
        """Of the wall on each support, (n_supports, 3) [N, N, N m]; moments about the support's reference point."""
        return self.system.force[len(self.layout.bodies):, :RIGID].copy()

    def push_force(self):
        """Horizontal force that moves the held bodies [N], NaN where none are held."""
        if self._held is None:
            return np.nan
        return -float(self.system.force[self._held, X].sum())

    # --- what is measured -----------------------------------------------------------------------

    def base_force(self):
        """Horizontal and downward force of the wall on its supports [N]."""
        fx, fz, _ = self.support_force.sum(axis=0)
        return float(fx), -float(fz)

    def kinetic_energy(self):
        """At the instant of the places: velocities are carried half a step on [J]."""
        return float(self.sample_now().totals[0, KINETIC])

    def elastic_energy(self):
        """Of all contacts [J]."""
        return float(np.sum(self.sample_now().stored) + self.loose.energy[STORED])

    def failure(self):
        """The error that ends a run of this wall as it is, None where there is none."""
        if not math.isfinite(self.system.force.sum()):
            return FloatingPointError(f"forces are no longer finite at step {self.step}: the time step of "
                                      f"{self.time_step:.3g} s is too large for this wall")
        loose, before_s = self.loose, (self.step - self.first_step) * self.time_step
        if loose.counts[INSIDE]:
            return RunError(f"new contacts: bricks press each other by more than the {2e3 * loose.touch.radius:.3g} mm "
                            f"of their rounded corners before {before_s:.4g} s; expected less; give a smaller --dt: a "
                            "third of it makes them nine times as stiff")
        if loose.counts[FULL]:
            return RunError(f"new contacts: more than {len(loose.pairs)} pairs of bricks are near each other before "
                            f"{before_s:.4g} s; expected fewer; end the run with its first fallen brick, without "
                            "--after-fall")
        return None
