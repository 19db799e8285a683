"""A pair of bodies: how far they have moved apart, and what the joint between them does to both.

Forces of a contact act in the middle of its two points, and its axes turn with the mean rotation of both bodies: this
makes them the gradient of the contact's elastic energy, and keeps linear and angular momentum.

All contacts between two bodies, a pair, lie on one line.  Along the mean axes their points then slide equally, and open
by what the line's middle opens plus offset times sin(difference of rotations).  This is exact, and the geometry is
worked out once a pair, not once a contact.

A pair that is whole and whose outermost opening leaves all its springs within their strength is one spring and a
couple: where that ends `joint_law.stays_elastic` says.  Eight pairs at a time go this way; those that are not whole
are then done again, contact by contact.
"""

from typing import NamedTuple

from damage.reference import blocks as at
from damage.reference.blocks import NONE, ONE
from damage.reference.compiled import block_loop, inlined
from damage.wall import joint_law


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
def relative_motion(pairs, p, bodies, a, b):
    """Mean axes of a pair (Frame) and how far its bodies have moved apart along them (Gap) [m]; p, a, b: where the
    first fields of the pair and of its bodies are."""
    pax, paz, pbx, pbz = pairs[p + at.AX], pairs[p + at.AZ], pairs[p + at.BX], pairs[p + at.BZ]
    a_cos1, a_sin, b_cos1, b_sin = bodies[a + at.COS1], bodies[a + at.SIN], bodies[b + at.COS1], bodies[b + at.SIN]
    # How the middle moves with either body, and how far its two places are apart.
    dax, daz = a_cos1 * pax - a_sin * paz, a_sin * pax + a_cos1 * paz
    dbx, dbz = b_cos1 * pbx - b_sin * pbz, b_sin * pbx + b_cos1 * pbz
    dx = (bodies[b + at.X] - bodies[a + at.X]) + (dbx - dax)
    dz = (bodies[b + at.Z] - bodies[a + at.Z]) + (dbz - daz)
    # Normal n and tangent t, turned by the mean rotation.
    c, s = 1.0 + 0.5 * (a_cos1 + b_cos1), 0.5 * (a_sin + b_sin)
    head = pairs[p + at.HEAD] > 0.0
    nx, nz, tx, tz = (c if head else -s), (s if head else c), (-s if head else c), (c if head else s)
    turn = (b_sin - a_sin) + (b_sin * a_cos1 - a_sin * b_cos1)
    frame = Frame(nx, nz, tx, tz, c * c + s * s, pax + dax + 0.5 * dx, paz + daz + 0.5 * dz,
                  pbx + dbx - 0.5 * dx, pbz + dbz - 0.5 * dz)
    return frame, Gap(nx * dx + nz * dz, tx * dx + tz * dz, turn)


@inlined
def stays_whole(pairs, p, own, m, gap):
    """Whether the outermost opening [m] leaves all contacts of a pair within their strengths."""
    widest = gap.middle + pairs[p + at.REACH] * abs(gap.turn)
    return joint_law.stays_elastic(widest, gap.shear, own[m + at.OPENING], own[m + at.SLIDE],
                                   pairs[p + at.SLIDE_LOSS])


@inlined
def whole_pair(pairs, p, gap):
    """Forces of all springs of a pair together [N, N m]."""
    kn_offset = pairs[p + at.KN_OFFSET]
    return Forces(pairs[p + at.KN] * gap.middle + kn_offset * gap.turn, pairs[p + at.KS] * gap.shear,
                  kn_offset * gap.middle + pairs[p + at.KN_OFFSET2] * gap.turn)


@inlined
def push(frame, forces):
    """The forces of a pair [N, N m] on its bodies (Push)."""
    x = frame.nx * forces.normal + frame.tx * forces.along
    z = frame.nz * forces.normal + frame.tz * forces.along
    couple = forces.couple * frame.length2
    return Push(x, z, frame.arm_ax * z - frame.arm_az * x + couple, frame.arm_bx * z - frame.arm_bz * x + couple)


@inlined
def change(own, m, forces):
    """How the forces of a pair [N, N m] have changed since the last step."""
    return Forces(forces.normal - own[m + at.NORMAL], forces.along - own[m + at.ALONG],
                  forces.couple - own[m + at.COUPLE])


@inlined
def damp(own, m, rate, gap, forces, steady):
    """The forces of a pair [N, N m] with damping proportional to stiffness, and its work [J], which is lost.

    rate: beta over the time step [-]; steady: what is damped, the change of its elastic forces since the last step."""
    work = (steady.normal * (gap.middle - own[m + at.MIDDLE]) + steady.along * (gap.shear - own[m + at.SHEAR])
            + steady.couple * (gap.turn - own[m + at.TURNED]))
    return Forces(forces.normal + rate * steady.normal, forces.along + rate * steady.along,
                  forces.couple + rate * steady.couple), rate * work


@inlined
def keep_last(own, m, gap, forces):
    """Write how far the bodies of a pair have moved apart [m] and its forces [N, N m] for the next step."""
    own[m + at.MIDDLE], own[m + at.SHEAR], own[m + at.TURNED] = gap.middle, gap.shear, gap.turn
    own[m + at.NORMAL], own[m + at.ALONG], own[m + at.COUPLE] = forces.normal, forces.along, forces.couple


@inlined
def keep_last_of(own, m, whole, gap, forces):
    """`keep_last` where the pair is whole; where not, what was there stays for what is done then."""
    own[m + at.MIDDLE] = gap.middle if whole else own[m + at.MIDDLE]
    own[m + at.SHEAR] = gap.shear if whole else own[m + at.SHEAR]
    own[m + at.TURNED] = gap.turn if whole else own[m + at.TURNED]
    own[m + at.NORMAL] = forces.normal if whole else own[m + at.NORMAL]
    own[m + at.ALONG] = forces.along if whole else own[m + at.ALONG]
    own[m + at.COUPLE] = forces.couple if whole else own[m + at.COUPLE]


@inlined
def put(bench, i, whole, pushed):
    """Write the Push of an element on the bench, nothing where it is not whole."""
    bench[at.PUSH_X + i], bench[at.PUSH_Z + i] = (pushed.x if whole else 0.0), (pushed.z if whole else 0.0)
    bench[at.MOMENT_A + i] = pushed.moment_a if whole else 0.0
    bench[at.MOMENT_B + i] = pushed.moment_b if whole else 0.0


# `while`, here and wherever eight elements are done: of numba's ranges over constants the compiler makes no vectors.
@block_loop
def whole_rows(pairs, p, bodies, a, b, own, m, bench, width):
    """What eight pairs do that are whole, and whether they are, on the bench; p, a, b, m: where the first fields of
    the first one are."""
    i = NONE
    while i < width:
        frame, gap = relative_motion(pairs, p + i, bodies, a + i, b + i)
        whole = stays_whole(pairs, p + i, own, m + i, gap)
        put(bench, i, whole, push(frame, whole_pair(pairs, p + i, gap)))
        own[m + i + at.WHOLE] = 1.0 if whole else 0.0
        i += ONE


@block_loop
def whole_lanes(pairs, p, bodies, a, b, own, m, bench, width):
    """`whole_rows` of one pair in eight lanes."""
    i = NONE
    while i < width:
        frame, gap = relative_motion(pairs, p, bodies, a + i, b + i)
        whole = stays_whole(pairs, p, own, m + i, gap)
        put(bench, i, whole, push(frame, whole_pair(pairs, p, gap)))
        own[m + i + at.WHOLE] = 1.0 if whole else 0.0
        i += ONE


@block_loop
def damped_rows(pairs, p, bodies, a, b, own, m, bench, width):
    """`whole_rows` with damping proportional to stiffness, and its work."""
    i = NONE
    while i < width:
        frame, gap = relative_motion(pairs, p + i, bodies, a + i, b + i)
        whole, forces = stays_whole(pairs, p + i, own, m + i, gap), whole_pair(pairs, p + i, gap)
        damped, work = damp(own, m + i, bench[at.RATE + i], gap, forces, change(own, m + i, forces))
        keep_last_of(own, m + i, whole, gap, forces)
        put(bench, i, whole, push(frame, damped))
        bench[at.WORK + i] = work if whole else 0.0
        own[m + i + at.WHOLE] = 1.0 if whole else 0.0
        i += ONE


@block_loop
def damped_lanes(pairs, p, bodies, a, b, own, m, bench, width):
    """`damped_rows` of one pair in eight lanes."""
    i = NONE
    while i < width:
        frame, gap = relative_motion(pairs, p, bodies, a + i, b + i)
        whole, forces = stays_whole(pairs, p, own, m + i, gap), whole_pair(pairs, p, gap)
        damped, work = damp(own, m + i, bench[at.RATE + i], gap, forces, change(own, m + i, forces))
        keep_last_of(own, m + i, whole, gap, forces)
        put(bench, i, whole, push(frame, damped))
        bench[at.WORK + i] = work if whole else 0.0
        own[m + i + at.WHOLE] = 1.0 if whole else 0.0
        i += ONE
