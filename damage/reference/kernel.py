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
only pairs with a spring beyond what is left of its strength are shown to the law.  While open, a bond that
softens is a spring by its secant.  And a pair that is
whole and whose outermost opening leaves all its springs within their strength is one spring and a
couple.  Where that ends `joint_law.stays_elastic` says, for contacts and for pairs.

A step is: `integrate`; `contact_forces`, which for every pair asks for its relative motion, chooses how
its forces are found, and pushes both bodies; after the last one, `read_joints`.
"""

from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numba import njit

from damage.reference import tables
from damage.reference.tables import DAMPING, FRACTURE, FRICTION, INPUT, OPENED, SLIPPED
from damage.wall import joint_law
from damage.wall.joint_law import INTACT, ContactState, LawParameters


def _forget_what_is_older(*modules):
    """Delete what numba has cached of this file where the modules that it compiles in are newer: numba looks at this
    file alone, and would go on with the law as it was."""
    changed = max(Path(module.__file__).stat().st_mtime for module in modules)
    for index in Path(__file__).parent.glob(f"__pycache__/{Path(__file__).stem}.*.nbi"):
        with suppress(OSError):  # another process is at the same work, or the folder cannot be written
            if index.stat().st_mtime < changed:
                index.unlink()


_forget_what_is_older(joint_law, tables)
# Fused multiply-adds, which round once instead of twice, are all the freedom given; numba hands it on to whatever
# these functions call, the joint law too.
_compile = njit(cache=True, error_model="numpy", nogil=True, fastmath={"contract"})
# Small functions that numba puts into their callers: compiled alone they would be slower, and multiply-adds would be
# fused in other places.  They take rows of tables, no System: handing one on counts references in every pair.
_inline = njit(inline="always", error_model="numpy", nogil=True, fastmath={"contract"})


class Gap(NamedTuple):
    """How far the bodies of a pair have moved apart: opening and shear displacement [m] of the middle of their
    contacts along the mean axes, and the sine of the rotation of b against a [-], by which the line opens."""

    middle: float
    shear: float
    turn: float


class Frame(NamedTuple):
    """Mean axes of a pair, n across the joint and t along it [-]; their length squared, below one where bodies turn
    against each other; arms from both centres to where the forces act, halfway between the middle's places [m]."""

    nx: float
    nz: float
    tx: float
    tz: float
    length2: float
    arm_ax: float
    arm_az: float
    arm_bx: float
    arm_bz: float


class Forces(NamedTuple):
    """What the contacts of a pair do on a, along the mean axes: normal and shear force [N], couple [N m]."""

    normal: float
    along: float
    couple: float


class Trial(NamedTuple):
    """A contact while it stays elastic: opening [m], normal and shear force [N]."""

    opening: float
    sigma: float
    tau: float


@_compile
def run_steps(system, constants, base, gravity, first_step, n_steps):
    """Advance `n_steps` steps from places whose forces are known; afterwards they are known again.

    base: (k, 2) base acceleration by step [m/s2], zero beyond its end; gravity: (k,) [m/s2] by step,
    its last value holds beyond its end.  Call `contact_forces` once before the first run: out of numba's
    cache, runs then use its own machine code instead of a slower copy that is part of this function.
    """
    if constants.beta > 0.0:
        remember_all(system)
    for step in range(first_step, first_step + n_steps):
        ax = base[step, 0] if step < len(base) else 0.0
        az = base[step, 1] if step < len(base) else 0.0
        integrate(system, constants, ax, az, gravity[min(step, len(gravity) - 1)])
        if constants.adaptive > 0.0:
            adapt(system, constants)
        contact_forces(system, constants, step + 1, step == first_step + n_steps - 1)
    read_joints(system)


@_compile
def contact_forces(system, constants, step, singly):
    """Forces [N, N m] on every body at the present places, into `place`; calling it twice changes nothing.

    Each pair goes the shortest way that is right: as one spring, by its springs, or by the joint law.
    singly: none as one spring, so that forces are the sums of what `read_joints` then reads, to the last bit.
    """
    pairs, contacts, place, last = system.pairs, system.contacts, system.place, system.last
    damped, rate, lost = constants.beta > 0.0, constants.beta / constants.dt, 0.0
    clear_forces(place)
    for p in range(len(pairs)):
        pair = pairs[p]
        a, b = place[pair.a], place[pair.b]
        frame, gap = relative_motion(pair, a, b)
        if pair.broken == 0 and not singly and stays_whole(pair, gap):
            forces, elastic = whole_pair(pair, gap), True
        else:
            forces, elastic = springs(contacts, pair, gap, constants.material)
        steady = change(last[p], forces) if damped else forces
        if not elastic:
            forces, steady = joint_forces(system, constants, step, p, gap)
        elif pair.broken:
            remember(contacts, pair, gap.shear)
        if damped:
            forces, work = damp(last[p], rate, gap, forces, steady)
            lost += work
        push(a, b, frame, forces)
    system.energy[DAMPING] += lost


@_compile
def read_joints(system):
    """Opening, shear displacement [m] and stresses [Pa] of all contacts at the present places, into `joints`.

    After `contact_forces` every contact is a spring from where the law has left it, so that no law is needed.
    """
    pairs, contacts, joints, place = system.pairs, system.contacts, system.joints, system.place
    for p in range(len(pairs)):
        pair = pairs[p]
        _, gap = relative_motion(pair, place[pair.a], place[pair.b])
        for i in range(pair.start, pair.stop):
            opening, sigma, tau = spring(contacts[i], gap)
            if stays_open(contacts[i], opening):
                sigma = tau = 0.0
            keep_stresses(joints[i], opening, gap.shear, sigma, tau)


@_compile
def remember_all(system):
    """What damping proportional to stiffness compares the next step with, of the present places, into `last`."""
    pairs, contacts, place = system.pairs, system.contacts, system.place
    for p in range(len(pairs)):
        pair = pairs[p]
        normal = along = couple = 0.0
        _, gap = relative_motion(pair, place[pair.a], place[pair.b])
        for i in range(pair.start, pair.stop):
            trial = stresses(contacts[i], gap)
            normal += trial.sigma
            along += trial.tau
            couple += trial.sigma * contacts[i].offset
        keep_last(system.last[p], gap, Forces(normal, along, couple))


@_compile
def clear_forces(place):
    """Zero forces [N] and moments [N m] of all bodies."""
    for k in range(len(place)):
        body = place[k]
        body.fx = body.fz = body.moment = 0.0


@_inline
def relative_motion(pair, a, b):
    """Mean axes of a pair (Frame) and how far its bodies a and b have moved apart along them (Gap) [m]."""
    # How the middle moves with either body, and how far its two places are apart.
    dax, daz = a.cos1 * pair.ax - a.sin * pair.az, a.sin * pair.ax + a.cos1 * pair.az
    dbx, dbz = b.cos1 * pair.bx - b.sin * pair.bz, b.sin * pair.bx + b.cos1 * pair.bz
    dx, dz = (b.x - a.x) + (dbx - dax), (b.z - a.z) + (dbz - daz)
    # Normal n and tangent t, turned by the mean rotation.
    c, s = 1.0 + 0.5 * (a.cos1 + b.cos1), 0.5 * (a.sin + b.sin)
    if pair.head:
        nx, nz, tx, tz = c, s, -s, c
    else:
        nx, nz, tx, tz = -s, c, c, s
    turn = (b.sin - a.sin) + (b.sin * a.cos1 - a.sin * b.cos1)
    frame = Frame(nx, nz, tx, tz, c * c + s * s, pair.ax + dax + 0.5 * dx, pair.az + daz + 0.5 * dz,
                  pair.bx + dbx - 0.5 * dx, pair.bz + dbz - 0.5 * dz)
    return frame, Gap(nx * dx + nz * dz, tx * dx + tz * dz, turn)


@_inline
def push(a, b, frame, forces):
    """Add the forces of a pair [N, N m] to body a, and their opposite to b."""
    fx = frame.nx * forces.normal + frame.tx * forces.along
    fz = frame.nz * forces.normal + frame.tz * forces.along
    couple = forces.couple * frame.length2
    a.fx += fx
    a.fz += fz
    a.moment += frame.arm_ax * fz - frame.arm_az * fx + couple
    b.fx -= fx
    b.fz -= fz
    b.moment -= frame.arm_bx * fz - frame.arm_bz * fx + couple


@_inline
def stays_whole(pair, gap):
    """Whether the outermost opening [m] leaves all contacts of a pair within their strengths."""
    widest = gap.middle + pair.reach * abs(gap.turn)
    return joint_law.stays_elastic(widest, gap.shear, pair.largest_opening, pair.largest_slide, pair.slide_loss)


@_inline
def whole_pair(pair, gap):
    """Forces of all springs of a pair together [N, N m]."""
    return Forces(pair.kn * gap.middle + pair.kn_offset * gap.turn, pair.ks * gap.shear,
                  pair.kn_offset * gap.middle + pair.kn_offset2 * gap.turn)


@_compile
def springs(contacts, pair, gap, material):
    """Forces of a pair's springs one by one [N, N m], and whether none is beyond its strength."""
    normal, along, couple, elastic = 0.0, 0.0, 0.0, True
    for i in range(pair.start, pair.stop):
        contact = contacts[i]
        trial = spring(contact, gap)
        if stays_open(contact, trial.opening):
            contact.shear0 = gap.shear
            continue
        elastic &= joint_law.stays_elastic(trial.sigma, trial.tau, contact.tensile_force, contact.cohesive_force,
                                           joint_law.friction_left(contact.idle >= 0.0, material))
        normal += trial.sigma
        along += trial.tau
        couple += trial.sigma * contact.offset
    return Forces(normal, along, couple), elastic


@_compile
def keep_stresses(joint, opening, shear, sigma, tau):
    """Write opening, shear displacement [m] and the forces [N] as stresses [Pa] of a contact."""
    joint.opening, joint.shear = opening, shear
    joint.sigma, joint.tau = sigma / joint.area, tau / joint.area


@_compile
def spring(contact, gap):
    """A contact as a spring from where the law has left it (Trial) [m, N, N]."""
    opening = gap.middle + contact.offset * gap.turn
    stiffness = contact.kt if opening > 0.0 else contact.kn
    return Trial(opening, stiffness * opening, contact.tau0 + contact.ks * (gap.shear - contact.shear0))


@_compile
def stresses(contact, gap):
    """A contact as what the law has left of it, a spring or nothing (Trial) [m, N, N]."""
    trial = spring(contact, gap)
    if stays_open(contact, trial.opening):
        return Trial(trial.opening, 0.0, 0.0)
    return trial


@_compile
def stays_open(contact, opening):
    """Whether a broken contact with this opening [m] is open, has no force, and needs no law."""
    return 0.0 < opening <= contact.idle and contact.tau0 == 0.0


@_compile
def remember(contacts, pair, shear):
    """Keep the shear force [N] of contacts that have slid and stick at a shear displacement [m]: sliding works
    against the last one."""
    for i in range(pair.start, pair.stop):
        contact = contacts[i]
        if contact.tensile_force == 0.0 or contact.soft:
            contact.tau0, contact.shear0 = contact.tau0 + contact.ks * (shear - contact.shear0), shear


@_compile
def joint_forces(system, constants, step, p, gap):
    """Forces of a pair's contacts by the joint law [N, N m]; and how those of the contacts that neither broke nor
    softened in this step have changed since the last one, if damping needs it."""
    pair, last = system.pairs[p], system.last[p]
    before = Gap(last.middle, last.shear, last.turn)
    normal = along = couple = d_normal = d_along = d_couple = 0.0
    for i in range(pair.start, pair.stop):
        contact, joint = system.contacts[i], system.joints[i]
        trial, kappa = spring(contact, gap), joint.kappa
        old = stresses(contact, before) if constants.beta > 0.0 else trial
        new, event = judge(contact, joint, trial.opening, gap.shear, constants.material)
        if new.broken or new.kappa > 0.0:
            log_joint(system, constants, step, i, trial, new, event)
            pair.broken = 1
        sigma, tau = new.normal_stress, new.shear_stress
        if event == INTACT and new.kappa == kappa:
            d_normal += sigma - old.sigma
            d_along += tau - old.tau
            d_couple += (sigma - old.sigma) * contact.offset
        normal += sigma
        along += tau
        couple += sigma * contact.offset
    return Forces(normal, along, couple), Forces(d_normal, d_along, d_couple)


@_compile
def judge(contact, joint, opening, shear, material):
    """Show a contact at this opening and shear displacement [m] to the joint law, and keep what it leaves of it.

    Returns what `joint_law.advance` does, in forces [N] and works [J]."""
    law = LawParameters(contact.kn, contact.ks, joint.tensile_force, joint.cohesive_force, material, joint.mode_i,
                        joint.mode_ii)
    old = ContactState(0.0, contact.tau0, joint.slip, joint.broken, joint.at_limit, 0.0, 0.0, joint.kappa, joint.gap)
    new, event = joint_law.advance(opening, shear - contact.shear0, old, law)
    if new.broken or new.kappa > 0.0:
        contact.tensile_force, contact.cohesive_force = joint_law.strength_left(new.broken, law, new.kappa)
        contact.shear0, contact.tau0 = shear, new.shear_stress
        contact.soft, contact.kt = not new.broken, contact.kn
        if not new.broken:
            contact.kt = joint_law.tension_stiffness(contact.tensile_force, new.gap, contact.kn)
    return new, event


@_compile
def change(last, forces):
    """How the forces of a pair [N, N m] have changed since the last step."""
    return Forces(forces.normal - last.normal, forces.along - last.along, forces.couple - last.couple)


@_compile
def damp(last, rate, gap, forces, steady):
    """The forces of a pair [N, N m] with damping proportional to stiffness, and its work [J], which is lost.

    rate: beta over the time step [-]; steady: what is damped, the change of its elastic forces since the last step."""
    work = (steady.normal * (gap.middle - last.middle) + steady.along * (gap.shear - last.shear)
            + steady.couple * (gap.turn - last.turn))
    keep_last(last, gap, forces)
    return Forces(forces.normal + rate * steady.normal, forces.along + rate * steady.along,
                  forces.couple + rate * steady.couple), rate * work


@_compile
def keep_last(last, gap, forces):
    """Write how far the bodies of a pair have moved apart [m] and its forces [N, N m] for the next step."""
    last.middle, last.shear, last.turn = gap.middle, gap.shear, gap.turn
    last.normal, last.along, last.couple = forces.normal, forces.along, forces.couple


@_compile
def integrate(system, constants, ax, az, gravity):
    """Central differences: velocities half a step on, displacements a whole one; input and damping work [J].

    ax, az: acceleration of the base [m/s2], which acts on all masses backwards; gravity [m/s2].
    """
    place, motion, local, dt = system.place, system.motion, constants.local, constants.dt
    field_z = az + gravity
    alpha = constants.alpha + system.relaxation[0]
    damped = alpha > 0.0 or local > 0.0
    lost = momentum_x = momentum_z = pushed = 0.0
    for k in range(len(place) - 1):
        at, to = place[k], motion[k]
        old_x, old_z, old_spin = to.vx, to.vz, to.spin
        # A prescribed velocity stays.
        rate_x = at.fx * to.inverse_mass_x - ax if to.inverse_mass_x > 0.0 else 0.0
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
    """Deceleration by damping proportional to mass (alpha [1/s]) and by local damping [-], which is against the
    motion: of a velocity [m/s or rad/s] that changes at a rate [m/s2 or rad/s2]."""
    sign = 1.0 if velocity > 0.0 else (-1.0 if velocity < 0.0 else 0.0)
    return alpha * velocity + local * abs(rate) * sign


@_compile
def adapt(system, constants):
    """Adaptive global damping, for static solutions (Cundall's, as in UDEC): it takes a constant share of
    the rate at which the kinetic energy [J] changes, and so follows whichever mode still moves."""
    motion, old, dt = system.motion, system.relaxation[1], constants.dt
    kinetic = 0.0
    for k in range(len(motion) - 1):
        to = motion[k]
        kinetic += 0.5 * (to.mass * (to.vx * to.vx + to.vz * to.vz) + to.inertia * to.spin * to.spin)
    # No more than what would stop every body in two steps: near a standstill the ratio has no bound.
    wanted = constants.adaptive * abs(kinetic - old) / (dt * (kinetic + old)) if kinetic > 0.0 else 0.0
    system.relaxation[0], system.relaxation[1] = min(wanted, 0.5 / dt), kinetic


@_compile
def kinetic_energy(system, field_x, field_z, dt):
    """At the instant of the places, to which velocities are carried half a step on [J].

    field_x, field_z: backward and downward acceleration of all masses [m/s2]; dt: time step [s].
    """
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
    """cos(angle) - 1 and sin(angle) of an angle [rad]; by series where their remainder is below 1e-17."""
    square = angle * angle
    if square < 1e-4:  # constants in brackets: a product is cheaper than a division
        return (-0.5 * square * (1.0 - square * (1 / 12) * (1.0 - square * (1 / 30))),
                angle * (1.0 - square * (1 / 6) * (1.0 - square * (1 / 20) * (1.0 - square * (1 / 42)))))
    return np.cos(angle) - 1.0, np.sin(angle)


@_compile
def log_joint(system, constants, step, i, trial, new, event):
    """Keep the flags and the slip [m] of a contact without a whole bond; log its work [J], its break and first
    passings."""
    contact, joint = system.contacts[i], system.joints[i]
    joint.slip, joint.broken, joint.at_limit = new.slip, new.broken, new.at_limit
    joint.kappa, joint.gap = new.kappa, new.gap
    system.energy[FRICTION] += new.friction_work
    system.energy[FRACTURE] += new.fracture_work
    passed = int(joint.passed)
    opening = joint_law.inelastic_opening(trial.opening, new.normal_stress, contact.kn)
    opens = opening > constants.threshold and not passed & 1
    slips = abs(new.slip) > constants.threshold and not passed & 2
    if event != INTACT or opens or slips:
        joint.passed = passed + opens + 2 * slips
        values = trial.sigma / joint.area, trial.tau / joint.area, opening, new.slip
        for happens, kind in ((event != INTACT, event), (opens, OPENED), (slips, SLIPPED)):
            if happens:
                log_event(system, step, i, kind, values)
    if new.broken:
        contact.idle = np.inf if int(joint.passed) & 1 else constants.threshold


@_compile
def log_event(system, step, joint, kind, values):
    """Append an event with its stresses [Pa], opening and slip [m]; those that do not fit are counted all the same,
    so that the caller sees it."""
    n = system.n_events[0]
    system.n_events[0] += 1
    if n < len(system.events):
        system.events[n, 0], system.events[n, 1], system.events[n, 2] = step, joint, kind
        for k, value in enumerate(values):
            system.values[n, k] = value
