"""The compiled time step of the reference solver: rigid blocks, contact points, central differences.

Units are SI.  Bodies move by (u_x, u_z, rotation x towards z) since the wall was built, in the frame
of the base; the last body is the ground and never moves.  Forces of a contact act in the middle of its
two points, and its axes turn with the mean rotation of both bodies: this makes them the gradient of
the contact's elastic energy, and keeps linear and angular momentum.

All contacts between two bodies, a pair, lie on one line.  Along the mean axes their points then slide
equally, and open by what the line's middle opens plus offset times sin(difference of rotations).  This
is exact, and the geometry is worked out once a pair, not once a contact.

The joint law is homogeneous in the area: given stiffnesses and strengths times area, it returns forces
and energies.  Between two of its decisions a contact is a linear spring, which changes no state; so
only springs beyond what is left of their strength are shown to the law.  And a pair that is whole and
whose outermost opening leaves all its springs within their strength is one spring and a couple.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from damage.wall import joint_law
from damage.wall.joint_law import INTACT, ContactState, LawParameters

OPENED, SLIPPED = 3, 4  # event kinds beside joint_law's TENSION and SHEAR
INPUT, FRICTION, FRACTURE, DAMPING = range(4)  # entries of `energy` [J]


REAL, INDEX, FLAG, BITS = np.float64, np.uint32, np.bool_, np.uint8


def _row(*fields):
    """The dtype of a table's row from its fields: (name, type, unit, meaning)."""
    return np.dtype([(name, kind) for name, kind, _, _ in fields], align=True)


PAIR = _row(
    ("ax", REAL, "m", "arm from the centre of body a to the middle of the contacts, along x"),
    ("az", REAL, "m", "the same along z"),
    ("bx", REAL, "m", "arm from the centre of body b, along x"),
    ("bz", REAL, "m", "the same along z"),
    ("kn", REAL, "N/m", "normal stiffness of all contacts together"),
    ("ks", REAL, "N/m", "shear stiffness of all contacts together"),
    ("kn_offset", REAL, "N", "sum of kn offset over the contacts"),
    ("kn_offset2", REAL, "N m", "sum of kn offset^2"),
    ("reach", REAL, "m", "offset of the outermost contact"),
    ("largest_opening", REAL, "m", "opening at the reach up to which no contact can break"),
    ("largest_slide", REAL, "m", "shear displacement below which none can, at no opening"),
    ("slide_loss", REAL, "-", "by how much an opening at the reach lowers the largest slide"),
    ("a", INDEX, "-", "row of body a"),
    ("b", INDEX, "-", "row of body b"),
    ("start", INDEX, "-", "row of the first contact"),
    ("stop", INDEX, "-", "row after the last one"),
    ("head", INDEX, "-", "1 for a head joint, 0 for a bed joint"),
    ("broken", INDEX, "-", "1 once a contact is broken"),
)
CONTACT = _row(
    ("offset", REAL, "m", "from the pair's middle, along +x in bed and -z in head joints"),
    ("kn", REAL, "N/m", "normal stiffness times area"),
    ("ks", REAL, "N/m", "shear stiffness times area"),
    ("tensile_force", REAL, "N", "tensile strength left times area, zero once broken"),
    ("cohesive_force", REAL, "N", "cohesion left times area, zero once broken"),
    ("shear0", REAL, "m", "shear displacement of the last step once broken, zero before"),
    ("tau0", REAL, "N", "shear force of the last step once broken, zero before"),
    ("idle", REAL, "m", "opening up to which an open contact needs no law, below zero until it is broken"),
)
JOINT = _row(  # beside its contact; the first four are those of a run's last step (`read_joints`)
    ("opening", REAL, "m", "normal displacement, also negative"),
    ("shear", REAL, "m", "shear displacement"),
    ("sigma", REAL, "Pa", "normal stress, tension positive"),
    ("tau", REAL, "Pa", "shear stress"),
    ("slip", REAL, "m", "plastic slip while closed, signed"),
    ("area", REAL, "m2", ""),
    ("broken", FLAG, "-", "the bond is gone"),
    ("at_limit", FLAG, "-", "has failed in shear or slid, ever"),
    ("passed", BITS, "-", "first passings of the threshold: 1 opened, 2 slipped"),
)
PLACE = _row(  # of a body
    ("x", REAL, "m", "displacement since the wall was built"),
    ("z", REAL, "m", "the same, upwards"),
    ("cos1", REAL, "-", "cosine of the rotation, less 1"),
    ("sin", REAL, "-", "sine of the rotation"),
    ("fx", REAL, "N", "force of the contacts along x"),
    ("fz", REAL, "N", "force along z"),
    ("moment", REAL, "N m", "about the centre, from x towards z"),
    ("turn", REAL, "rad", "rotation, from x towards z"),
)
MOTION = _row(  # of a body; velocities are those half a step ago
    ("vx", REAL, "m/s", ""),
    ("vz", REAL, "m/s", ""),
    ("spin", REAL, "rad/s", ""),
    ("mass", REAL, "kg", ""),
    ("inertia", REAL, "kg m2", "about the centre"),
    ("inverse_mass_x", REAL, "1/kg", "by which x follows its force; zero where vx is prescribed"),
    ("inverse_mass_z", REAL, "1/kg", "by which z follows its force; zero where vz is prescribed"),
    ("inverse_inertia", REAL, "1/(kg m2)", "by which the rotation follows; zero where spin is prescribed"),
)

# Fused multiply-adds, which round once instead of twice, are all the freedom given, and neither springs
# nor law have it: to the last bit they agree with each other, and a contact at its limit stays there.
_compile = njit(cache=True, error_model="numpy", nogil=True, fastmath={"contract"})
_exactly = njit(cache=True, error_model="numpy", nogil=True)


class System(NamedTuple):
    """Tables of one wall, a row each: pairs (PAIR), contacts (CONTACT) in the order of their pairs,
    joints (JOINT) beside contacts, place (PLACE) and motion (MOTION) of the bodies and the ground.

    energy: (4,); events: (capacity, 3) step, joint, kind; values: (capacity, 4) normal and shear
    stress [Pa], opening and slip [m]; n_events: (1,); relaxation: (2,) the mass-proportional damping that
    adapts itself [1/s], and the kinetic energy of the last step [J].
    """

    pairs: np.ndarray
    contacts: np.ndarray
    joints: np.ndarray
    place: np.ndarray
    motion: np.ndarray
    energy: np.ndarray
    events: np.ndarray
    values: np.ndarray
    n_events: np.ndarray
    relaxation: np.ndarray


class Constants(NamedTuple):
    """friction = tan(phi); threshold [m] of first passings; n_joints: contacts from there on are glue;
    local: Cundall's damping [-]; alpha [1/s], beta [s]: damping proportional to mass, to stiffness;
    adaptive: share of the change of kinetic energy that adaptive damping takes [-]."""

    friction: float
    threshold: float
    n_joints: int
    local: float
    alpha: float
    beta: float
    adaptive: float


@_compile
def run_steps(system, constants, base, gravity, first_step, n_steps, dt):
    """Advance `n_steps` steps from places whose forces are known; afterwards they are known again.

    base: (k, 2) base acceleration by step [m/s2], zero beyond its end; gravity: (k,) [m/s2] by step,
    its last value holds beyond its end.  Call `contact_forces` once before the first run: out of numba's
    cache, runs then use its own machine code instead of a slower copy that is part of this function.
    """
    for step in range(first_step, first_step + n_steps):
        ax = base[step, 0] if step < len(base) else 0.0
        az = base[step, 1] if step < len(base) else 0.0
        integrate(system, constants, ax, az + gravity[min(step, len(gravity) - 1)], ax, az, dt)
        if constants.adaptive > 0.0:
            adapt(system, constants, dt)
        contact_forces(system, constants, step + 1, dt, step == first_step + n_steps - 1)


@_compile
def contact_forces(system, constants, step, dt, keep=True):
    """Forces on every body at the present places; calling it twice changes nothing.

    keep: write opening, shear displacement and stresses of every contact into `joints`.
    """
    pairs, contacts, place, friction = system.pairs, system.contacts, system.place, constants.friction
    by_law = keep or constants.beta > 0.0
    for k in range(len(place)):
        body = place[k]
        body.fx = body.fz = body.moment = 0.0
    for p in range(len(pairs)):
        pair = pairs[p]
        a, b = place[pair.a], place[pair.b]
        # How the middle moves with either body, and how far its two places are apart.
        dax, daz = a.cos1 * pair.ax - a.sin * pair.az, a.sin * pair.ax + a.cos1 * pair.az
        dbx, dbz = b.cos1 * pair.bx - b.sin * pair.bz, b.sin * pair.bx + b.cos1 * pair.bz
        dx, dz = (b.x - a.x) + (dbx - dax), (b.z - a.z) + (dbz - daz)
        # Normal n and tangent t, turned by the mean rotation; opening and shear displacement.
        c, s = 1.0 + 0.5 * (a.cos1 + b.cos1), 0.5 * (a.sin + b.sin)
        if pair.head:
            nx, nz, tx, tz = c, s, -s, c
        else:
            nx, nz, tx, tz = -s, c, c, s
        middle, shear = nx * dx + nz * dz, tx * dx + tz * dz
        turn = (b.sin - a.sin) + (b.sin * a.cos1 - a.sin * b.cos1)
        # Normal force, shear force and couple of the pair's springs, or of the law.
        widest = middle + pair.reach * abs(turn)
        if (pair.broken == 0 and not by_law
                and joint_law.stays_elastic(widest, shear, pair.largest_opening, pair.largest_slide, pair.slide_loss)):
            normal, along = pair.kn * middle + pair.kn_offset * turn, pair.ks * shear
            couple = pair.kn_offset * middle + pair.kn_offset2 * turn
        else:
            normal, along, couple, elastic = springs(contacts, pair, middle, shear, turn, friction)
            if by_law or not elastic:
                normal, along, couple = joint_forces(system, constants, step, dt, pair, middle, shear, turn)
            elif pair.broken:
                remember(contacts, pair, shear)
        # Force on a, its opposite on b, halfway between the middle's two places.
        fx, fz, couple = nx * normal + tx * along, nz * normal + tz * along, couple * (c * c + s * s)
        a.fx += fx
        a.fz += fz
        a.moment += (pair.ax + dax + 0.5 * dx) * fz - (pair.az + daz + 0.5 * dz) * fx + couple
        b.fx -= fx
        b.fz -= fz
        b.moment -= (pair.bx + dbx - 0.5 * dx) * fz - (pair.bz + dbz - 0.5 * dz) * fx + couple


@_compile
def springs(contacts, pair, middle, shear, turn, friction):
    """Normal force, shear force and couple of a pair's springs, and whether none is beyond its strength."""
    normal, along, couple, elastic = 0.0, 0.0, 0.0, True
    for i in range(pair.start, pair.stop):
        contact = contacts[i]
        opening, sigma, tau = spring(contact, middle, shear, turn)
        if 0.0 < opening <= contact.idle and contact.tau0 == 0.0:  # stays open: no force
            contact.shear0 = shear
            continue
        elastic &= joint_law.stays_elastic(sigma, tau, contact.tensile_force, contact.cohesive_force, friction)
        normal += sigma
        along += tau
        couple += sigma * contact.offset
    return normal, along, couple, elastic


@_exactly
def spring(contact, middle, shear, turn):
    """Opening, normal force and shear force of a contact while it stays elastic."""
    opening = middle + contact.offset * turn
    return opening, contact.kn * opening, contact.tau0 + contact.ks * (shear - contact.shear0)


@_exactly
def remember(contacts, pair, shear):
    """Keep the shear force of broken contacts that stick: sliding works against the last one."""
    for i in range(pair.start, pair.stop):
        contact = contacts[i]
        if contact.tensile_force == 0.0:
            contact.tau0, contact.shear0 = contact.tau0 + contact.ks * (shear - contact.shear0), shear


@_compile
def joint_forces(system, constants, step, dt, pair, middle, shear, turn):
    """The joint law for the contacts of a pair: their normal force, shear force and couple."""
    normal = along = couple = 0.0
    for i in range(pair.start, pair.stop):
        contact, joint = system.contacts[i], system.joints[i]
        opening, sigma, tau = spring(contact, middle, shear, turn)
        new, event = judge(contact, joint, opening, shear, constants.friction)
        if new.broken:
            log_joint(system, constants, step, i, event, opening, sigma, tau, new)
            contact.tensile_force = contact.cohesive_force = 0.0
            contact.shear0, contact.tau0 = shear, new.shear_stress
            pair.broken = 1
        sigma, tau = new.normal_stress, new.shear_stress
        if constants.beta > 0.0 and event == INTACT:
            rate_sigma = constants.beta / dt * (sigma - joint.sigma * joint.area)
            rate_tau = constants.beta / dt * (tau - joint.tau * joint.area)
            system.energy[DAMPING] += rate_sigma * (opening - joint.opening) + rate_tau * (shear - joint.shear)
            sigma, tau = sigma + rate_sigma, tau + rate_tau
        joint.opening, joint.shear = opening, shear
        joint.sigma, joint.tau = new.normal_stress / joint.area, new.shear_stress / joint.area
        normal += sigma
        along += tau
        couple += sigma * contact.offset
    return normal, along, couple


@_exactly
def judge(contact, joint, opening, shear, friction):
    """The joint law of one contact, with the shear displacement since it last changed the contact."""
    law = LawParameters(contact.kn, contact.ks, contact.tensile_force, contact.cohesive_force, friction)
    old = ContactState(0.0, contact.tau0, joint.slip, joint.broken, joint.at_limit, 0.0, 0.0)
    return joint_law.advance(opening, shear - contact.shear0, old, law)


@_compile
def integrate(system, constants, field_x, field_z, ax, az, dt):
    """Central differences: velocities half a step on, displacements a whole one.

    field: downward and backward acceleration of all masses; ax, az: the base's part of it.
    """
    place, motion, local = system.place, system.motion, constants.local
    alpha = constants.alpha + system.relaxation[0]
    damped = alpha > 0.0 or local > 0.0
    lost = momentum_x = momentum_z = pushed = 0.0
    for k in range(len(place) - 1):
        at, to = place[k], motion[k]
        old_x, old_z, old_spin = to.vx, to.vz, to.spin
        # A prescribed velocity stays.
        rate_x = at.fx * to.inverse_mass_x - field_x if to.inverse_mass_x > 0.0 else 0.0
        rate_z = at.fz * to.inverse_mass_z - field_z if to.inverse_mass_z > 0.0 else 0.0
        rate_turn = at.moment * to.inverse_inertia
        if damped:
            taken_x = resistance(old_x, rate_x, alpha, local) if to.inverse_mass_x > 0.0 else 0.0
            taken_z = resistance(old_z, rate_z, alpha, local) if to.inverse_mass_z > 0.0 else 0.0
            taken_turn = resistance(old_spin, rate_turn, alpha, local) if to.inverse_inertia > 0.0 else 0.0
            rate_x, rate_z, rate_turn = rate_x - taken_x, rate_z - taken_z, rate_turn - taken_turn
            lost += (to.mass * (taken_x * (old_x + 0.5 * dt * rate_x) + taken_z * (old_z + 0.5 * dt * rate_z))
                     + to.inertia * taken_turn * (old_spin + 0.5 * dt * rate_turn))
        to.vx, to.vz, to.spin = old_x + dt * rate_x, old_z + dt * rate_z, old_spin + dt * rate_turn
        if to.inverse_mass_x > 0.0:
            momentum_x += to.mass * (old_x + to.vx)
        else:  # what moves it works against its force
            pushed -= at.fx * to.vx
        momentum_z += to.mass * (old_z + to.vz)
        at.x += dt * to.vx
        at.z += dt * to.vz
        at.turn += dt * to.spin
        at.cos1, at.sin = rotation(at.turn)
    system.energy[INPUT] += (pushed - 0.5 * (ax * momentum_x + az * momentum_z)) * dt
    system.energy[DAMPING] += lost * dt


@_compile
def resistance(velocity, rate, alpha, local):
    """Deceleration by damping proportional to mass and by local damping, which is against the motion."""
    sign = 1.0 if velocity > 0.0 else (-1.0 if velocity < 0.0 else 0.0)
    return alpha * velocity + local * abs(rate) * sign


@_compile
def adapt(system, constants, dt):
    """Adaptive global damping, for static solutions (Cundall's, as in UDEC): it takes a constant share of
    the rate at which the kinetic energy changes, and so follows whichever mode still moves."""
    motion, old = system.motion, system.relaxation[1]
    kinetic = 0.0
    for k in range(len(motion) - 1):
        to = motion[k]
        kinetic += 0.5 * (to.mass * (to.vx * to.vx + to.vz * to.vz) + to.inertia * to.spin * to.spin)
    # No more than what would stop every body in two steps: near a standstill the ratio has no bound.
    wanted = constants.adaptive * abs(kinetic - old) / (dt * (kinetic + old)) if kinetic > 0.0 else 0.0
    system.relaxation[0], system.relaxation[1] = min(wanted, 0.5 / dt), kinetic


@_compile
def kinetic_energy(system, field_x, field_z, dt):
    """At the instant of the places, to which velocities are carried half a step on [J]."""
    place, motion, total = system.place, system.motion, 0.0
    for k in range(len(place) - 1):
        at, to = place[k], motion[k]
        vx = to.vx + 0.5 * dt * (at.fx * to.inverse_mass_x - field_x) if to.inverse_mass_x > 0.0 else to.vx
        vz = to.vz + 0.5 * dt * (at.fz * to.inverse_mass_z - field_z) if to.inverse_mass_z > 0.0 else to.vz
        spin = to.spin + 0.5 * dt * at.moment * to.inverse_inertia
        total += 0.5 * (to.mass * (vx * vx + vz * vz) + to.inertia * spin * spin)
    return total


@_compile
def rotation(angle):
    """cos(angle) - 1 and sin(angle); by series where their remainder is below 1e-17."""
    square = angle * angle
    if square < 1e-4:  # constants in brackets: a product is cheaper than a division
        return (-0.5 * square * (1.0 - square * (1 / 12) * (1.0 - square * (1 / 30))),
                angle * (1.0 - square * (1 / 6) * (1.0 - square * (1 / 20) * (1.0 - square * (1 / 42)))))
    return np.cos(angle) - 1.0, np.sin(angle)


@_exactly
def log_joint(system, constants, step, i, event, opening, sigma, trial, new):
    """Keep the flags and the slip of a broken contact; log its work, its break and first passings."""
    contact, joint = system.contacts[i], system.joints[i]
    joint.slip, joint.broken, joint.at_limit = new.slip, True, new.at_limit
    system.energy[FRICTION] += new.friction_work
    system.energy[FRACTURE] += new.fracture_work
    passed = int(joint.passed)
    opens = opening > constants.threshold and not passed & 1
    slips = abs(new.slip) > constants.threshold and not passed & 2
    if event != INTACT or opens or slips:
        joint.passed = passed + opens + 2 * slips
        log_events(system.events, system.values, system.n_events, step, i, event, opens, slips,
                   sigma / joint.area, trial / joint.area, max(opening, 0.0), new.slip)
    contact.idle = np.inf if int(joint.passed) & 1 else constants.threshold


@_exactly
def log_events(events, values, n_events, step, joint, event, opens, slips, sigma, tau, opening, slip):
    """Append events; those that do not fit are counted all the same, so that the caller sees it."""
    for happens, kind in ((event != INTACT, event), (opens, OPENED), (slips, SLIPPED)):
        if happens:
            n = n_events[0]
            n_events[0] += 1
            if n < len(events):
                events[n, 0], events[n, 1], events[n, 2] = step, joint, kind
                values[n, 0], values[n, 1], values[n, 2], values[n, 3] = sigma, tau, opening, slip
