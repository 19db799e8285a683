"""The compiled time step of the reference solver: rigid blocks, contact points, central differences.

Units are SI.  Bodies move by (u_x, u_z, rotation x towards z) since the wall was built, in the frame
of the base; the last body is the ground and never moves.  Forces of a contact act in the middle of its
two points, and its axes turn with the mean rotation of both bodies: this makes them the gradient of
the contact's elastic energy, and keeps linear and angular momentum.

What belongs to one contact or one body lies side by side in one row of a table, whose columns are
named below: the step is bound by memory, and this is what makes it fast.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from damage import joint_law
from damage.joint_law import INTACT, ContactState, LawParameters

OPENED, SLIPPED = 3, 4  # event kinds beside joint_law's TENSION and SHEAR

# Columns of `contacts`: arms from the bodies' centres to the point [m], head joint or not, area [m2],
# stiffnesses [Pa/m], strengths [Pa].
ARM_AX, ARM_AZ, ARM_BX, ARM_BZ, HEAD, AREA, KN, KS, FT, COHESION = range(10)
# Columns of `joints`: opening (also negative) and shear displacement [m], stresses [Pa], plastic slip
# [m], flags, bits of first passings (1 opened, 2 slipped).
OPENING, SHEAR, SIGMA, TAU, SLIP, BROKEN, AT_LIMIT, PASSED = range(8)
# Columns of `place`: displacement [m], cos - 1 and sin of the rotation, rotation [rad].
X, Z, COS1, SIN, TURN = range(5)
# Columns of `mass`: mass [kg], inertia [kg m2], and whether x, z, rotation move by their forces.
MASS, INERTIA, FREE = 0, 1, 2
# Entries of `energy` [J].
INPUT, FRICTION, FRACTURE, DAMPING = range(4)

_compile = njit(cache=True, error_model="numpy", nogil=True)
_inline = njit(error_model="numpy", inline="always")


class System(NamedTuple):
    """Tables of one wall; `n` contacts, `m` bodies and the ground after them.

    ends: (n, 2) bodies of each contact; contacts: (n, 10); joints: (n, 8); place: (m + 1, 5);
    velocity: (m + 1, 3) half a step ago; force: (m + 1, 3); mass: (m + 1, 5);
    energy: (4,); events: (capacity, 3) step, joint, kind; values: (capacity, 4) normal and shear
    stress [Pa], opening and slip [m]; n_events: (1,).
    """

    ends: np.ndarray
    contacts: np.ndarray
    joints: np.ndarray
    place: np.ndarray
    velocity: np.ndarray
    force: np.ndarray
    mass: np.ndarray
    energy: np.ndarray
    events: np.ndarray
    values: np.ndarray
    n_events: np.ndarray


class Constants(NamedTuple):
    """friction = tan(phi); threshold [m] of first passings; n_joints: contacts from there on are glue;
    local: Cundall's damping [-]; alpha [1/s], beta [s]: damping proportional to mass, to stiffness."""

    friction: float
    threshold: float
    n_joints: int
    local: float
    alpha: float
    beta: float


@_compile
def run_steps(system, constants, base, gravity, first_step, n_steps, dt):
    """Advance `n_steps` steps.

    base: (k, 2) base acceleration by step [m/s2], zero beyond its end; gravity: (k,) [m/s2] by step,
    its last value holds beyond its end.
    """
    for step in range(first_step, first_step + n_steps):
        ax = base[step, 0] if step < len(base) else 0.0
        az = base[step, 1] if step < len(base) else 0.0
        contact_forces(system, constants, step, dt)
        integrate(system, constants, ax, az + gravity[min(step, len(gravity) - 1)], ax, az, dt)


@_compile
def contact_forces(system, constants, step, dt):
    """Forces on every body at the present places; calling it twice changes nothing."""
    place, contacts, joints, force, ends = (system.place, system.contacts, system.joints, system.force,
                                            system.ends)
    force[:] = 0.0
    friction_work = fracture_work = damping_work = 0.0
    for i in range(len(ends)):
        a, b = ends[i, 0], ends[i, 1]
        # Arms to the contact's two points, turned with their bodies, and how far the points are apart.
        rax, raz, rbx, rbz = contacts[i, ARM_AX], contacts[i, ARM_AZ], contacts[i, ARM_BX], contacts[i, ARM_BZ]
        ca, sa, cb, sb = place[a, COS1], place[a, SIN], place[b, COS1], place[b, SIN]
        dax, daz = ca * rax - sa * raz, sa * rax + ca * raz
        dbx, dbz = cb * rbx - sb * rbz, sb * rbx + cb * rbz
        dx, dz = place[b, X] - place[a, X] + dbx - dax, place[b, Z] - place[a, Z] + dbz - daz
        # Along the joint's axes, turned by the mean rotation.
        c, s = 1.0 + 0.5 * (ca + cb), 0.5 * (sa + sb)
        along_x, along_z = c * dx + s * dz, c * dz - s * dx
        head = contacts[i, HEAD] != 0.0
        opening, shear = (along_x, along_z) if head else (along_z, along_x)
        # The joint law.
        law = LawParameters(contacts[i, KN], contacts[i, KS], contacts[i, FT], contacts[i, COHESION],
                            constants.friction)
        old = ContactState(joints[i, SIGMA], joints[i, TAU], joints[i, SLIP], joints[i, BROKEN] != 0.0,
                           joints[i, AT_LIMIT] != 0.0, 0.0, 0.0)
        increment = shear - joints[i, SHEAR]
        new, event = joint_law.advance(opening, increment, old, law)
        area = contacts[i, AREA]
        if new.broken:
            friction_work += new.friction_work * area
            fracture_work += new.fracture_work * area
            log_joint(system, constants, step, i, event, opening, old.shear_stress + law[1] * increment, new)
        sigma, tau = new.normal_stress, new.shear_stress
        if constants.beta > 0.0 and event == INTACT:
            rate_sigma = constants.beta / dt * (sigma - old.normal_stress)
            rate_tau = constants.beta / dt * (tau - old.shear_stress)
            damping_work += (rate_sigma * (opening - joints[i, OPENING]) + rate_tau * increment) * area
            sigma, tau = sigma + rate_sigma, tau + rate_tau
        joints[i, OPENING], joints[i, SHEAR] = opening, shear
        joints[i, SIGMA], joints[i, TAU] = new.normal_stress, new.shear_stress
        # Force on b, its opposite on a, in the middle of the two points.
        normal, along = -sigma * area, -tau * area
        fx = c * normal - s * along if head else c * along - s * normal
        fz = s * normal + c * along if head else s * along + c * normal
        rax, raz, rbx, rbz = rax + dax + 0.5 * dx, raz + daz + 0.5 * dz, rbx + dbx - 0.5 * dx, rbz + dbz - 0.5 * dz
        force[a, 0] -= fx
        force[a, 1] -= fz
        force[a, 2] -= rax * fz - raz * fx
        force[b, 0] += fx
        force[b, 1] += fz
        force[b, 2] += rbx * fz - rbz * fx
    system.energy[FRICTION] += friction_work
    system.energy[FRACTURE] += fracture_work
    system.energy[DAMPING] += damping_work


@_compile
def integrate(system, constants, field_x, field_z, ax, az, dt):
    """Central differences: velocities half a step on, displacements a whole one.

    field: downward and backward acceleration of all masses; ax, az: the base's part of it.
    """
    place, velocity, force, mass = system.place, system.velocity, system.force, system.mass
    work = lost = 0.0
    for body in range(len(mass) - 1):
        for dof in range(3):
            if mass[body, FREE + dof] == 0.0:  # the velocity is prescribed
                work -= force[body, dof] * velocity[body, dof]
                continue
            m = mass[body, INERTIA] if dof == 2 else mass[body, MASS]
            old = velocity[body, dof]
            rate = force[body, dof] / m - (field_x if dof == 0 else (field_z if dof == 1 else 0.0))
            taken = constants.alpha * old + constants.local * abs(rate) * np.sign(old)
            new = old + dt * (rate - taken)
            velocity[body, dof] = new
            momentum = 0.5 * (old + new) * m
            lost += taken * momentum
            work -= (ax if dof == 0 else (az if dof == 1 else 0.0)) * momentum
        place[body, X] += dt * velocity[body, 0]
        place[body, Z] += dt * velocity[body, 1]
        place[body, TURN] += dt * velocity[body, 2]
        place[body, COS1], place[body, SIN] = rotation(place[body, TURN])
    system.energy[INPUT] += work * dt
    system.energy[DAMPING] += lost * dt


@_compile
def rotation(angle):
    """cos(angle) - 1 and sin(angle); by series where their remainder is below 1e-17."""
    square = angle * angle
    if square < 1e-4:
        return (-0.5 * square * (1.0 - square / 12.0 * (1.0 - square / 30.0)),
                angle * (1.0 - square / 6.0 * (1.0 - square / 20.0 * (1.0 - square / 42.0))))
    return np.cos(angle) - 1.0, np.sin(angle)


@_inline
def log_joint(system, constants, step, i, event, opening, trial, new):
    """Keep the flags and the slip of a broken contact; log its break and first passings."""
    joints = system.joints
    joints[i, SLIP], joints[i, BROKEN] = new.slip, 1.0
    joints[i, AT_LIMIT] = 1.0 if new.at_limit else 0.0
    passed = int(joints[i, PASSED])
    opens = opening > constants.threshold and not passed & 1
    slips = abs(new.slip) > constants.threshold and not passed & 2
    if event != INTACT or opens or slips:
        joints[i, PASSED] = passed + opens + 2 * slips
        log_events(system.events, system.values, system.n_events, step, i, event, opens, slips,
                   system.contacts[i, KN] * opening, trial, max(opening, 0.0), new.slip)


@_compile
def log_events(events, values, n_events, step, joint, event, opens, slips, sigma, tau, opening, slip):
    """Append events; those that do not fit are counted all the same, so that the caller sees it."""
    for happens, kind in ((event != INTACT, event), (opens, OPENED), (slips, SLIPPED)):
        if happens:
            n = n_events[0]
            n_events[0] += 1
            if n < len(events):
                events[n, 0], events[n, 1], events[n, 2] = step, joint, kind
                values[n, 0], values[n, 1], values[n, 2], values[n, 3] = sigma, tau, opening, slip
