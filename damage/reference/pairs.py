"""A pair of bodies: how far they have moved apart, and what the joint between them does to both.

Forces of a contact act in the middle of its two points, and its axes turn with the mean rotation of both bodies: this
makes them the gradient of the contact's elastic energy, and keeps linear and angular momentum.

All contacts between two bodies, a pair, lie on one line.  Along the mean axes their points then slide equally, and open
by what the line's middle opens plus offset times sin(difference of rotations).  This is exact, and the geometry is
worked out once a pair, not once a contact.

A pair that is whole and whose outermost opening leaves all its springs within their strength is one spring and a
couple: where that ends `joint_law.stays_elastic` says.  Eight pairs at a time go this way; those that are not whole
are then done again, contact by contact.  All here is of one pair, or of eight (eight.py).
"""

from typing import NamedTuple

from damage.reference import blocks as at
from damage.reference.compiled import inlined
from damage.reference.eight import add, either, load, store
from damage.wall import joint_law


class Line(NamedTuple):
    """Where the middle of a pair's contacts lies from the centres of its bodies a and b [m]; head: above zero for a
    head joint."""

    ax: float
    az: float
    bx: float
    bz: float
    head: float


class Place(NamedTuple):
    """Displacement of a body [m], and the cosine less one and the sine of its rotation."""

    x: float
    z: float
    cos1: float
    sin: float


class Spring(NamedTuple):
    """All contacts of a whole pair as one spring and a couple, the fields of tables.PAIR [N/m, N, N m, m, -]."""

    kn: float
    ks: float
    kn_offset: float
    kn_offset2: float
    reach: float
    slide_loss: float


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


class Push(NamedTuple):
    """The same along the axes of the base: force on a, whose opposite is that on b [N]; moment on a, and that on b
    with its sign changed [N m]."""

    x: float
    z: float
    moment_a: float
    moment_b: float


@inlined
def line_of(pairs, p):
    """Line of the pair whose first field is at p."""
    return Line(pairs[p + at.AX], pairs[p + at.AZ], pairs[p + at.BX], pairs[p + at.BZ], pairs[p + at.HEAD])


@inlined
def lines_of(pairs, p):
    """The same of eight."""
    return Line(load(pairs, p + at.AX), load(pairs, p + at.AZ), load(pairs, p + at.BX), load(pairs, p + at.BZ),
                load(pairs, p + at.HEAD))


@inlined
def spring_of(pairs, p):
    """Spring of the pair whose first field is at p."""
    return Spring(pairs[p + at.KN], pairs[p + at.KS], pairs[p + at.KN_OFFSET], pairs[p + at.KN_OFFSET2],
                  pairs[p + at.REACH], pairs[p + at.SLIDE_LOSS])


@inlined
def springs_of(pairs, p):
    """The same of eight."""
    return Spring(load(pairs, p + at.KN), load(pairs, p + at.KS), load(pairs, p + at.KN_OFFSET),
                  load(pairs, p + at.KN_OFFSET2), load(pairs, p + at.REACH), load(pairs, p + at.SLIDE_LOSS))


@inlined
def place_of_body(bodies, a, apart):
    """Place of the body whose first field is at a, and the next ones so far apart."""
    z = a + apart
    cos1 = z + apart
    return Place(bodies[a], bodies[z], bodies[cos1], bodies[cos1 + apart])


@inlined
def places_in_lanes(bodies, a):
    """Place of a body in eight lanes."""
    return Place(load(bodies, a + at.X), load(bodies, a + at.Z), load(bodies, a + at.COS1), load(bodies, a + at.SIN))


@inlined
def relative_motion(line, a, b):
    """Mean axes of a pair (Frame) and how far its bodies have moved apart along them (Gap) [m]; a, b: their Place."""
    # How the middle moves with either body, and how far its two places are apart.
    dax, daz = a.cos1 * line.ax - a.sin * line.az, a.sin * line.ax + a.cos1 * line.az
    dbx, dbz = b.cos1 * line.bx - b.sin * line.bz, b.sin * line.bx + b.cos1 * line.bz
    dx = (b.x - a.x) + (dbx - dax)
    dz = (b.z - a.z) + (dbz - daz)
    # Normal n and tangent t, turned by the mean rotation.
    c, s = 1.0 + 0.5 * (a.cos1 + b.cos1), 0.5 * (a.sin + b.sin)
    head = line.head > 0.0
    nx, nz, tx, tz = either(head, c, -s), either(head, s, c), either(head, -s, c), either(head, c, s)
    turn = (b.sin - a.sin) + (b.sin * a.cos1 - a.sin * b.cos1)
    frame = Frame(nx, nz, tx, tz, c * c + s * s, line.ax + dax + 0.5 * dx, line.az + daz + 0.5 * dz,
                  line.bx + dbx - 0.5 * dx, line.bz + dbz - 0.5 * dz)
    return frame, Gap(nx * dx + nz * dz, tx * dx + tz * dz, turn)


@inlined
def stays_whole(spring, opening, slide, gap):
    """Whether the outermost opening [m] leaves all contacts of a pair within their limits of opening and slide [m]."""
    widest = gap.middle + spring.reach * abs(gap.turn)
    return joint_law.stays_elastic(widest, gap.shear, opening, slide, spring.slide_loss)


@inlined
def whole_pair(spring, gap):
    """Forces of all springs of a pair together [N, N m]."""
    return Forces(spring.kn * gap.middle + spring.kn_offset * gap.turn, spring.ks * gap.shear,
                  spring.kn_offset * gap.middle + spring.kn_offset2 * gap.turn)


@inlined
def push(frame, forces):
    """The forces of a pair [N, N m] on its bodies (Push)."""
    x = frame.nx * forces.normal + frame.tx * forces.along
    z = frame.nz * forces.normal + frame.tz * forces.along
    couple = forces.couple * frame.length2
    return Push(x, z, frame.arm_ax * z - frame.arm_az * x + couple, frame.arm_bx * z - frame.arm_bz * x + couple)


@inlined
def less(forces, last):
    """How forces of a pair [N, N m] differ from others."""
    return Forces(forces.normal - last.normal, forces.along - last.along, forces.couple - last.couple)


@inlined
def damp(rate, gap, last, forces, steady):
    """The forces of a pair [N, N m] with damping proportional to stiffness, and its work [J], which is lost.

    rate: beta over the time step [-]; last: the Gap of the last step; steady: what is damped, the change of its elastic
    forces since then."""
    work = (steady.normal * (gap.middle - last.middle) + steady.along * (gap.shear - last.shear)
            + steady.couple * (gap.turn - last.turn))
    return Forces(forces.normal + rate * steady.normal, forces.along + rate * steady.along,
                  forces.couple + rate * steady.couple), rate * work


@inlined
def last_gap(last, m):
    """How far the bodies of a pair had moved apart in the last step [m]."""
    return Gap(last[m + at.MIDDLE], last[m + at.SHEAR], last[m + at.TURNED])


@inlined
def last_forces(last, m):
    """The forces of a pair in the last step [N, N m]."""
    return Forces(last[m + at.NORMAL], last[m + at.ALONG], last[m + at.COUPLE])


@inlined
def last_gaps(last, m):
    """`last_gap` of eight."""
    return Gap(load(last, m + at.MIDDLE), load(last, m + at.SHEAR), load(last, m + at.TURNED))


@inlined
def last_forces_of_eight(last, m):
    """`last_forces` of eight."""
    return Forces(load(last, m + at.NORMAL), load(last, m + at.ALONG), load(last, m + at.COUPLE))


@inlined
def keep_last(last, m, gap, forces):
    """Write how far the bodies of a pair have moved apart [m] and its forces [N, N m] for the next step."""
    last[m + at.MIDDLE], last[m + at.SHEAR], last[m + at.TURNED] = gap.middle, gap.shear, gap.turn
    last[m + at.NORMAL], last[m + at.ALONG], last[m + at.COUPLE] = forces.normal, forces.along, forces.couple


@inlined
def keep_last_of(last, m, whole, gap, before, forces, old):
    """The same of those of eight pairs that are whole; where not, what was there stays for what is done then."""
    store(last, m + at.MIDDLE, either(whole, gap.middle, before.middle))
    store(last, m + at.SHEAR, either(whole, gap.shear, before.shear))
    store(last, m + at.TURNED, either(whole, gap.turn, before.turn))
    store(last, m + at.NORMAL, either(whole, forces.normal, old.normal))
    store(last, m + at.ALONG, either(whole, forces.along, old.along))
    store(last, m + at.COUPLE, either(whole, forces.couple, old.couple))


@inlined
def eight_pairs(line, spring, a, b, limits, m):
    """Frame, Gap and Forces of eight pairs as one spring each, and whether they are whole."""
    frame, gap = relative_motion(line, a, b)
    whole = stays_whole(spring, load(limits, m + at.OPENING), load(limits, m + at.SLIDE), gap)
    return frame, gap, whole_pair(spring, gap), whole


@inlined
def damp_eight(last, m, rate, gap, forces, whole):
    """Forces of eight pairs with damping, and its work where they are whole; keeps what the next step asks for."""
    before, old = last_gaps(last, m), last_forces_of_eight(last, m)
    damped, work = damp(rate, gap, before, forces, less(forces, old))
    keep_last_of(last, m, whole, gap, before, forces, old)
    return damped, either(whole, work, 0.0)


@inlined
def push_where(whole, frame, forces):
    """The Push of eight pairs, nothing of those that are not whole."""
    pushed = push(frame, forces)
    return Push(either(whole, pushed.x, 0.0), either(whole, pushed.z, 0.0), either(whole, pushed.moment_a, 0.0),
                either(whole, pushed.moment_b, 0.0))


@inlined
def push_lanes(bodies, a, b, pushed):
    """Add what a pair does to its bodies in eight lanes."""
    add(bodies, a + at.FX, pushed.x)
    add(bodies, a + at.FZ, pushed.z)
    add(bodies, a + at.MOMENT, pushed.moment_a)
    add(bodies, b + at.FX, -pushed.x)
    add(bodies, b + at.FZ, -pushed.z)
    add(bodies, b + at.MOMENT, -pushed.moment_b)
