"""The built-in reference solver: a wall of rigid blocks, explicit in time, in the plane.

The same layout, joint law, stages, loading and history file as the walls in YADE; the time step itself
is `damage.reference.kernel`.  Walls that share bricks and stiffnesses can step together, `run_together` of
`damage.reference.lanes`.
"""

import numpy as np

from damage.index import THRESHOLD
from damage.reference import tables
from damage.reference.instants import KINETIC, Springs
from damage.reference.lanes import Lanes, run_together
from damage.units import GRAVITY
from damage.wall.joint_law import LawParameters, elastic_range, material_of
from damage.wall.layout import CUT, GROUND

_CAPACITY = 100_000  # events between two drains of the log


class ReferenceWall:
    """One wall and its state; time is counted in steps.

    layout: damage.wall.layout.Layout; time_step [s]; beta: stiffness-proportional damping [s];
    alpha: mass-proportional damping [1/s].  These, `local_damping` (Cundall's) and `adaptive_damping` (the
    share of the change of kinetic energy that adaptive global damping takes) can be set at any time.
    """

    def __init__(self, layout, time_step, *, beta=0.0, alpha=0.0):
        self.layout, self.time_step, self.step = layout, time_step, 0
        self.beta, self.alpha, self.local_damping, self.adaptive_damping = beta, alpha, 0.0, 0.0
        self.base, self.gravity = np.zeros((0, 2)), np.array([GRAVITY])
        self.first_step = 0  # step at which `base` and `gravity` begin
        self.system = _make_system(layout)
        row = slice(None) if layout.fibres is None else layout.fibres.contact
        self.springs = Springs(self.system.joints["area"].copy(), layout.contacts.normal_stiffness[row],
                               layout.contacts.shear_stiffness[row])
        self.lanes = None  # those that the wall was last moved in
        self._held, self._told = None, (0, np.empty(0, int))
        self._passed = {kind: np.zeros(layout.n_joints, bool) for kind in (tables.OPENED, tables.SLIPPED)}
        self.refresh()

    # --- state, as arrays in the layout's order -------------------------------------------------

    @property
    def displacement(self):
        """(n_bodies, 3) [m, m, rad] since the wall was built."""
        return _columns(self.system.place[:-1], "x", "z", "turn")

    @property
    def velocity(self):
        """(n_bodies, 3) [m/s, m/s, rad/s] half a step ago; can be assigned."""
        return _columns(self.system.motion[:-1], "vx", "vz", "spin")

    @velocity.setter
    def velocity(self, values):
        values = np.broadcast_to(values, (len(self.layout.bodies), 3))
        for name, column in zip(("vx", "vz", "spin"), values.T):
            self.system.motion[name][:-1] = column

    @property
    def force(self):
        """Of the contacts on each body, the ground last: (n_bodies + 1, 3) [N, N, N m]."""
        return _columns(self.system.place, "fx", "fz", "moment")

    @property
    def opening(self):
        """Inelastic opening (n_joints,) [m]: past the broken bond, or what a softened one has given way."""
        return self.of_joints(self.told_now().opening[0])

    @property
    def slip(self):
        """Plastic slip of the closed contacts (n_joints,) [m]."""
        return self.of_joints(self.system.joints["slip"])

    @property
    def offset(self):
        """Shear displacement less its elastic part (n_joints,) [m] of what has broken or softened, zero elsewhere; of
        fibres by their shares, each with its own stress."""
        return self.of_joints(self.told_now().offset[0])

    @property
    def state(self):
        """Bits BROKEN, AT_LIMIT and CRUSHED (n_joints,)."""
        return self.state_of_joints(self.told_now().state[0])

    @property
    def energy(self):
        """Input, friction, fracture and damping energy [J] since `reset_energy`."""
        return self.system.energy

    @property
    def stresses(self):
        """Normal stress, tension positive, and shear stress of the kernel's contacts (2, contacts) [Pa]."""
        return self.system.readings[[tables.READ_SIGMA, tables.READ_TAU]]

    def told_now(self):
        """Samples of one, of this instant: what is told of the kernel's contacts and of the bodies."""
        x, z = self.base_now()
        return self.lanes.told_now(self, (float(x), GRAVITY + float(z)))

    def base_now(self):
        """Acceleration of the base in this step along x and z [m/s2]."""
        step = self.step - self.first_step
        return self.base[step] if step < len(self.base) else (0.0, 0.0)

    def joints_told(self):
        """Joints that something may be told of, those of broken pairs: indices, or a slice."""
        if self.layout.fibres is not None:
            return slice(None)
        pairs = self.system.pairs
        broken = pairs["broken"] > 0
        if (count := np.count_nonzero(broken)) != self._told[0]:  # a pair that is broken stays so
            self._told = count, np.flatnonzero(np.repeat(broken, pairs["stop"] - pairs["start"]))
        return self._told[1]

    def state_of_joints(self, state):
        """Bits of the kernel's contacts as those of the joints (..., n_joints): fibres by the last of each."""
        return (state if self.layout.fibres is None else state[..., self.layout.fibres.last])[
            ..., :self.layout.n_joints]

    def of_joints(self, values):
        """Values of the kernel's contacts as those of the joints (..., n_joints): fibres by their shares."""
        fibres = self.layout.fibres
        return (values if fibres is None else fibres.mean(values))[..., :self.layout.n_joints]

    # --- what moves it --------------------------------------------------------------------------

    def run(self, *steps):
        """Advance by these numbers of steps, one after the other; before and after each forces and stresses belong to
        the present places, and `lanes.told` tells what was."""
        (failure,) = run_together([self], *steps)
        if failure is not None:
            raise failure

    def refresh(self):
        """Forces and stresses, to be called where places or contacts were changed by hand."""
        contacts = self.system.contacts
        contacts["kt"] = np.where(contacts["soft"], contacts["kt"], contacts["kn"])
        _sum_springs(self.system.pairs, contacts, self.material)
        Lanes([self]).find_forces(singly=True)

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
        if count > _CAPACITY:
            raise OverflowError(f"{count} events between two samples, {_CAPACITY} fit; sample more often")
        self.system.n_events[0] = 0
        events, values = self.system.events[:count].copy(), self.system.values[:count].copy()
        if self.layout.fibres is not None:
            events, values = self._events_of_fibres(events, values)
        return events[:, 0], events[:, 1], events[:, 2], values

    def _events_of_fibres(self, events, values):
        """A contact breaks with the last of its fibres; what it opens and slips is known now, at the sample."""
        fibres = self.layout.fibres
        told = fibres.last[events[:, 1]] & (events[:, 2] < tables.OPENED)
        events, values = events[told], values[told]
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
        self._held = bodies
        motion = self.system.motion
        for inverse, velocity in (("inverse_mass_x", "vx"), *([("inverse_inertia", "spin")] if rotation else [])):
            motion[inverse][bodies] = motion[velocity][bodies] = 0.0

    def push(self, velocity):
        """Prescribe the horizontal velocity of the held bodies [m/s]; the jump's work is input."""
        old, mass = self.system.motion["vx"][self._held], self.layout.bodies.mass[self._held]
        self.energy[tables.INPUT] += 0.5 * np.sum(mass * (velocity**2 - old**2))
        self.system.motion["vx"][self._held] = velocity

    def push_force(self):
        """Horizontal force that moves the held bodies [N], NaN where none are held."""
        if self._held is None:
            return np.nan
        return -float(self.system.place["fx"][self._held].sum())

    # --- what is measured -----------------------------------------------------------------------

    def base_force(self):
        """Horizontal and downward force of the wall on the ground [N]."""
        _, _, _, _, fx, fz, *_ = self.system.place[-1].item()
        return fx, -fz

    def kinetic_energy(self):
        """At the instant of the places: velocities are carried half a step on [J]."""
        return float(self.told_now().totals[0, KINETIC])

    def elastic_energy(self):
        """Of all contacts [J]."""
        return float(np.sum(self.told_now().stored))


def _columns(table, *names):
    """Fields of a table of numbers alone as columns (n, len(names))."""
    return table.view(tables.REAL).reshape(len(table), -1).take([table.dtype.names.index(name) for name in names], 1)


def _table(dtype, n, **fields):
    """A structured array of n rows; fields that are not given are zero."""
    table = np.zeros(n, dtype)
    for name, values in fields.items():
        table[name][:len(values)] = values
    return table


def _make_system(layout):
    """The kernel's tables for a wall at rest; its contacts are the layout's, or their fibres."""
    contacts, bodies, joint = layout.contacts, layout.bodies, layout.wall.joint
    fibres = layout.fibres
    row, share = (np.arange(len(contacts)), 1.0) if fibres is None else (fibres.contact, fibres.share)
    strengths = fibres or contacts
    n, m = len(row), len(bodies)
    pairs, middle = _make_pairs(layout, row)
    area = contacts.area[row] * share
    # Offsets turn with the joint's axes: along +x in bed joints, along -z in head joints.
    offset = np.where(contacts.upright[row], middle[1] - contacts.z[row], contacts.x[row] - middle[0])
    kn, ks = contacts.normal_stiffness[row] * area, contacts.shear_stiffness[row] * area
    limits = {"tensile_force": strengths.tensile_strength * area, "cohesive_force": strengths.cohesion * area}
    mode_i, mode_ii = (0.0, 0.0) if fibres or not joint.softens else (
        np.where(contacts.kind == CUT, 0.0, energy)
        for energy in (joint.mode_i_fracture_energy, joint.mode_ii_fracture_energy))
    return tables.System(
        pairs=pairs,
        contacts=_table(tables.CONTACT, n, offset=offset, kn=kn, ks=ks, idle=np.full(n, -1.0),
                        crushing_force=contacts.compressive_strength[row] * area, **limits),
        joints=_table(tables.JOINT, n, area=area, mode_i=mode_i * area, mode_ii=mode_ii * area, **limits),
        readings=np.zeros((4, n)),
        place=np.zeros(m + 1, tables.PLACE),
        motion=_table(tables.MOTION, m + 1, mass=bodies.mass, inertia=bodies.inertia, inverse_mass_x=1 / bodies.mass,
                      inverse_mass_z=1 / bodies.mass, inverse_inertia=1 / bodies.inertia),
        energy=np.zeros(4), events=np.zeros((_CAPACITY, 3), np.int64), values=np.zeros((_CAPACITY, 4)),
        n_events=np.zeros(1, np.int64), relaxation=np.zeros(2))


def _make_pairs(layout, row):
    """Table of the pairs of bodies, whose contacts the layout gives one after the other; and the middle
    (x, z) of its pair for every contact of the kernel, which is of the layout's contact in `row`."""
    contacts, bodies = layout.contacts, layout.bodies
    first, second = np.where(contacts.first == GROUND, len(bodies), contacts.first)[row], contacts.second[row]
    changes = np.any([np.diff(first) != 0, np.diff(second) != 0], axis=0)
    start = np.append(0, np.flatnonzero(changes) + 1)
    stop = np.append(start[1:], len(row))
    middle = [(np.minimum.reduceat(place[row], start) + np.maximum.reduceat(place[row], start)) / 2
              for place in (contacts.x, contacts.z)]
    x, z = np.append(bodies.x, 0.0), np.append(bodies.z, 0.0)
    a, b = first[start], second[start]
    pairs = _table(tables.PAIR, len(start), ax=middle[0] - x[a], az=middle[1] - z[a], bx=middle[0] - x[b],
                   bz=middle[1] - z[b], a=a, b=b, start=start, stop=stop, head=contacts.upright[row][start])
    return pairs, [np.repeat(values, stop - start) for values in middle]


def _sum_springs(pairs, contacts, material):
    """Write into the pairs what their contacts do as long as none of them can break."""
    start = pairs["start"]
    kn, ks, offset = contacts["kn"], contacts["ks"], contacts["offset"]
    for name, values in (("kn", kn), ("ks", ks), ("kn_offset", kn * offset), ("kn_offset2", kn * offset**2)):
        pairs[name] = np.add.reduceat(values, start)
    pairs["reach"] = np.maximum.reduceat(np.abs(offset), start)
    with np.errstate(divide="ignore", invalid="ignore"):
        opening, slide, ratio = elastic_range(
            LawParameters(kn, ks, contacts["tensile_force"], contacts["cohesive_force"], material))
        pairs["largest_opening"] = np.minimum.reduceat(opening, start)
        pairs["largest_slide"] = np.minimum.reduceat(slide, start)
    pairs["slide_loss"] = ratio[start]
    # The outermost opening decides for all only where they slide alike; elsewhere each is looked at.
    alike = np.isclose(np.repeat(ratio[start], np.diff(start, append=len(kn))), ratio, rtol=1e-12, atol=0)
    # Nor does it of what can crush.
    alike &= contacts["crushing_force"] == np.inf
    pairs["largest_opening"][~np.logical_and.reduceat(alike, start)] = -np.inf
