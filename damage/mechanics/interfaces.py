"""Interface between two bodies: relative motion, elastic resultant while it is intact, forces on
both bodies.

All contact points between two bodies lie on one line.  Along the mean axes of the two bodies all of
them have the same shear displacement, and each opens by the opening of the middle plus its offset
times the sine of the relative rotation. This is exact for any rotation, and the geometry is
evaluated once for each interface instead of each contact point.

The force of a contact point acts halfway between its two material points, and its axes follow the
mean rotation of both bodies.  It therefore conserves linear and angular momentum, and is the
gradient of the contact's elastic energy.

All functions accept the values of one interface, or vectors of the values of eight
(`damage.mechanics.simd`).
"""

from typing import NamedTuple

from damage.law import joint_law
from damage.mechanics.compiled import inlined
from damage.mechanics.simd import either


class Line(NamedTuple):
    """Geometry of an interface: arms (x, z) from the centres of bodies a and b to the middle of its
    contact points [m]; head: above zero for an upright interface (head joint, cut), whose normal is
    along x."""

    ax: float
    az: float
    bx: float
    bz: float
    head: float


class Pose(NamedTuple):
    """Position of a body: displacement along x and z [m], cosine less one and sine of its rotation
    [-]."""

    x: float
    z: float
    cos1: float
    sin: float


class Springs(NamedTuple):
    """Springs of an intact interface: normal and shear stiffness [N/m], first [N] and second [N m]
    moment of the normal stiffness; reach: offset of the outermost contact point [m]; slide_loss:
    reduction of the largest elastic shear displacement by an opening there [-]."""

    kn: float
    ks: float
    kn_offset: float
    kn_offset2: float
    reach: float
    slide_loss: float


class ElasticLimits(NamedTuple):
    """Up to which an intact interface is elastic: opening at the reach, -inf once a contact point
    has failed, and shear displacement without opening [m]; failed: zero, then FAILED, ENDING, ENDED
    of `damage.law.states`."""

    largest_opening: float
    largest_slide: float
    failed: float


class RelativeMotion(NamedTuple):
    """Motion of body b relative to body a along the mean axes: opening and shear displacement of
    the middle of the contact points [m], and sine of the relative rotation [-]."""

    opening: float
    shear: float
    rotation: float


class Frame(NamedTuple):
    """Mean axes of an interface: normal n and tangent t [-]; length2: their squared length, below
    one where the bodies rotate relative to each other; arms from both centres to the point of
    action of the forces [m]."""

    nx: float
    nz: float
    tx: float
    tz: float
    length2: float
    arm_ax: float
    arm_az: float
    arm_bx: float
    arm_bz: float


class Resultant(NamedTuple):
    """Resultant of the contact points of an interface on body a along the mean axes: normal and
    shear force [N], couple [N m]."""

    normal: float
    shear: float
    couple: float


class BodyForces(NamedTuple):
    """Forces of an interface on its bodies along x and z: force on a, which is minus that on b [N];
    moment on a; minus the moment on b [N m]."""

    x: float
    z: float
    moment_a: float
    moment_b: float


@inlined
def relative_motion(line, a, b):
    """Frame and RelativeMotion of an interface; line: Line; a, b: Pose of its bodies."""
    # Displacement of the middle of the line with either body by its rotation, and the distance of
    # both positions.
    dax = a.cos1 * line.ax - a.sin * line.az
    daz = a.sin * line.ax + a.cos1 * line.az
    dbx = b.cos1 * line.bx - b.sin * line.bz
    dbz = b.sin * line.bx + b.cos1 * line.bz
    dx = (b.x - a.x) + (dbx - dax)
    dz = (b.z - a.z) + (dbz - daz)
    # Normal n and tangent t, at the mean rotation.
    c = 1.0 + 0.5 * (a.cos1 + b.cos1)
    s = 0.5 * (a.sin + b.sin)
    head = line.head > 0.0
    nx = either(head, c, -s)
    nz = either(head, s, c)
    tx = either(head, -s, c)
    tz = either(head, c, s)
    rotation = (b.sin - a.sin) + (b.sin * a.cos1 - a.sin * b.cos1)
    frame = Frame(
        nx,
        nz,
        tx,
        tz,
        c * c + s * s,
        line.ax + dax + 0.5 * dx,
        line.az + daz + 0.5 * dz,
        line.bx + dbx - 0.5 * dx,
        line.bz + dbz - 0.5 * dz,
    )
    return frame, RelativeMotion(nx * dx + nz * dz, tx * dx + tz * dz, rotation)


@inlined
def stays_intact(springs, limits, motion):
    """Whether all contact points of an intact interface stay within their ElasticLimits, by
    the largest opening."""
    widest = motion.opening + springs.reach * abs(motion.rotation)
    return joint_law.stays_elastic(
        widest, motion.shear, limits.largest_opening, limits.largest_slide, springs.slide_loss
    )


@inlined
def elastic_resultant(springs, motion):
    """Resultant of an intact interface [N, N m]; springs: Springs; motion: RelativeMotion."""
    return Resultant(
        springs.kn * motion.opening + springs.kn_offset * motion.rotation,
        springs.ks * motion.shear,
        springs.kn_offset * motion.opening + springs.kn_offset2 * motion.rotation,
    )


@inlined
def forces_on_bodies(frame, resultant, motion):
    """BodyForces of a Resultant [N, N m]; frame: Frame of the interface, motion: RelativeMotion.

    The gradient of the energy E(o, s, r) by the bodies' coordinates, with r = sin(delta): the axes
    are unit vectors at the mean rotation times cos(delta/2), so that a rotation of either body also
    turns and shortens them.
    """
    x = frame.nx * resultant.normal + frame.tx * resultant.shear
    z = frame.nz * resultant.normal + frame.tz * resultant.shear
    done = (
        resultant.normal * motion.opening
        + resultant.shear * motion.shear
        + resultant.couple * motion.rotation
    )
    couple = resultant.couple * frame.length2 - 0.25 * done * motion.rotation / frame.length2
    return BodyForces(
        x,
        z,
        frame.arm_ax * z - frame.arm_az * x + couple,
        frame.arm_bx * z - frame.arm_bz * x + couple,
    )


@inlined
def add(first, second):
    """Sum of two Resultants [N, N m]."""
    return Resultant(
        first.normal + second.normal, first.shear + second.shear, first.couple + second.couple
    )


@inlined
def change(resultant, before):
    """Difference of two Resultants [N, N m]."""
    return Resultant(
        resultant.normal - before.normal,
        resultant.shear - before.shear,
        resultant.couple - before.couple,
    )


@inlined
def add_viscous(rate, motion, before, resultant, elastic_change):
    """Resultant with stiffness-proportional damping [N, N m], and the work of the damping [J].

    rate: beta over the time step [-]; motion, before: RelativeMotion now and in the last step;
    resultant: without damping; elastic_change: change of the elastic resultant since the last step.
    """
    work = (
        elastic_change.normal * (motion.opening - before.opening)
        + elastic_change.shear * (motion.shear - before.shear)
        + elastic_change.couple * (motion.rotation - before.rotation)
    )
    return (
        Resultant(
            resultant.normal + rate * elastic_change.normal,
            resultant.shear + rate * elastic_change.shear,
            resultant.couple + rate * elastic_change.couple,
        ),
        rate * work,
    )
