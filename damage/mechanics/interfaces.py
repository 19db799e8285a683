"""The interface between two bodies: their relative motion, its springs while it is intact, the forces on both.

All contact points between two bodies lie on one line.  Along the mean axes of the two bodies these points slide
equally, and open by what the middle of the line opens plus offset times the sine of the relative rotation.  This is
exact for any rotation, and the geometry is evaluated once per interface instead of once per contact point.

The force of a contact point acts halfway between its two material points, and its axes follow the mean rotation of
both bodies.  It is therefore the gradient of the contact's elastic energy, and conserves linear and angular momentum.

Every function takes the numbers of one interface, or of eight at once (`damage.mechanics.eight`).
"""

from typing import NamedTuple

from damage.mechanics.compiled import inlined
from damage.mechanics.eight import either
from damage.wall import joint_law


class Line(NamedTuple):
    """Arms from the centres of bodies a and b to the middle of their contact points [m]; head: above zero for an
    upright interface (head joint, cut), whose normal is along x."""

    ax: float
    az: float
    bx: float
    bz: float
    head: float


class Pose(NamedTuple):
    """Displacement of a body [m], and the cosine less one and the sine of its rotation [-]."""

    x: float
    z: float
    cos1: float
    sin: float


class Springs(NamedTuple):
    """An intact interface as one spring and a couple: stiffness along the normal and in shear [N/m], first [N] and
    second moment [N m] of the normal stiffness, offset of the outermost contact point [m], and by how much an opening
    there reduces the largest elastic shear displacement [-]."""

    kn: float
    ks: float
    kn_offset: float
    kn_offset2: float
    reach: float
    slide_loss: float


class RelativeMotion(NamedTuple):
    """Motion of body b relative to a: opening and shear displacement [m] of the middle of the contact points along the
    mean axes, and sine of the relative rotation [-]."""

    opening: float
    shear: float
    rotation: float


class Frame(NamedTuple):
    """Mean axes: normal n and tangent t [-]; their length squared, below one where the bodies rotate relative to each
    other; arms from both centres to the point where the forces act [m]."""

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
    """Forces of all contact points of an interface on a along the mean axes: normal and shear force [N], couple
    [N m]."""

    normal: float
    shear: float
    couple: float


class BodyForces(NamedTuple):
    """The same along the axes of the base: force on a, and on b with the opposite sign [N]; moment on a; moment on b
    with the opposite sign [N m]."""

    x: float
    z: float
    moment_a: float
    moment_b: float


@inlined
def relative_motion(line, a, b):
    """Frame and RelativeMotion of an interface; a, b: Pose of its bodies."""
    # How the middle of the line moves with either body, and how far its two places are apart.
    dax, daz = a.cos1 * line.ax - a.sin * line.az, a.sin * line.ax + a.cos1 * line.az
    dbx, dbz = b.cos1 * line.bx - b.sin * line.bz, b.sin * line.bx + b.cos1 * line.bz
    dx = (b.x - a.x) + (dbx - dax)
    dz = (b.z - a.z) + (dbz - daz)
    # Normal n and tangent t, at the mean rotation.
    c, s = 1.0 + 0.5 * (a.cos1 + b.cos1), 0.5 * (a.sin + b.sin)
    head = line.head > 0.0
    nx, nz, tx, tz = either(head, c, -s), either(head, s, c), either(head, -s, c), either(head, c, s)
    rotation = (b.sin - a.sin) + (b.sin * a.cos1 - a.sin * b.cos1)
    frame = Frame(nx, nz, tx, tz, c * c + s * s, line.ax + dax + 0.5 * dx, line.az + daz + 0.5 * dz,
                  line.bx + dbx - 0.5 * dx, line.bz + dbz - 0.5 * dz)
    return frame, RelativeMotion(nx * dx + nz * dz, tx * dx + tz * dz, rotation)


@inlined
def stays_intact(springs, largest_opening, largest_slide, motion):
    """Whether every contact point of an intact interface stays within its elastic limits, which the outermost opening
    decides; largest_opening, largest_slide: limits of opening and shear displacement [m]."""
    widest = motion.opening + springs.reach * abs(motion.rotation)
    return joint_law.stays_elastic(widest, motion.shear, largest_opening, largest_slide, springs.slide_loss)


@inlined
def parted(motion, least, most):
    """Whether the two faces of an interface no longer overlap, as they do between these shear displacements [m]."""
    return (motion.shear <= least) | (motion.shear >= most)


@inlined
def elastic_resultant(springs, motion):
    """Resultant of an intact interface [N, N m]."""
    return Resultant(springs.kn * motion.opening + springs.kn_offset * motion.rotation, springs.ks * motion.shear,
                     springs.kn_offset * motion.opening + springs.kn_offset2 * motion.rotation)


@inlined
def forces_on_bodies(frame, resultant):
    """BodyForces of a Resultant [N, N m]."""
    x = frame.nx * resultant.normal + frame.tx * resultant.shear
    z = frame.nz * resultant.normal + frame.tz * resultant.shear
    couple = resultant.couple * frame.length2
    return BodyForces(x, z, frame.arm_ax * z - frame.arm_az * x + couple,
                      frame.arm_bx * z - frame.arm_bz * x + couple)


@inlined
def add(one, other):
    """Sum of two Resultants [N, N m]."""
    return Resultant(one.normal + other.normal, one.shear + other.shear, one.couple + other.couple)


@inlined
def change(resultant, before):
    """Difference of two Resultants [N, N m]."""
    return Resultant(resultant.normal - before.normal, resultant.shear - before.shear,
                     resultant.couple - before.couple)


@inlined
def add_viscous(rate, motion, before, resultant, elastic_change):
    """Resultant with stiffness-proportional damping [N, N m], and the work of the damping [J].

    rate: beta over the time step [-]; before: RelativeMotion of the last step; elastic_change: change of the elastic
    resultant since then.
    """
    work = (elastic_change.normal * (motion.opening - before.opening)
            + elastic_change.shear * (motion.shear - before.shear)
            + elastic_change.couple * (motion.rotation - before.rotation))
    return Resultant(resultant.normal + rate * elastic_change.normal, resultant.shear + rate * elastic_change.shear,
                     resultant.couple + rate * elastic_change.couple), rate * work
