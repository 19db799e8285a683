"""Collisions: contacts that bricks find anew as they move, once their joints have ended.

Bricks are rectangles with rounded corners here (spheropolygons, Alonso-Marroquin 2008).

A loose brick is a rectangle with rounded corners: a core, smaller than the brick by the radius r on
all sides, and all places within r of it.  With d the distance of a corner of one core from the
nearest point of the other core, a pair of bodies stores

    V = sum over the corners of both cores of  k/2 max(0, 2 r - d - rest)^2

The force k (2 r - d - rest) acts along d, halfway between the corner and that point, with opposite
signs on both.  d is continuously differentiable, so that corners, edges and faces need no cases of
their own.  Each touching corner has a tangential spring, limited by friction and deleted when they
part, and a dashpot.

`rest` is the overlap at which a corner bears nothing: zero between bodies that meet.  Bodies that
become neighbours while they overlap keep that overlap, and it decreases as they move apart; where a
joint ends while it bears, it is such that the corners store what the joint had stored.

A pair of bodies is jointed until its joint has ended, and loose from then on.  The search for loose
pairs begins when the first joint of a wall ends.

The step (`damage.mechanics.step`) calls `may_end`, `ends_too` and `hand_over` of joints,
`add_forces`, and the sample `energy_stored`; their argument `loose` is None, and they do nothing,
in walls whose bricks do not collide.
"""

from typing import NamedTuple

import numpy as np

from damage.law.joint_law import TENSION, Material
from damage.law.states import ENDED, ENDING, FAILED
from damage.mechanics import contacts
from damage.mechanics.compiled import compiled, inlined
from damage.mechanics.rows import (
    inverse_mass_of,
    place_of,
    push_body,
    springs_of,
    strengths_of,
    velocity_of,
)
from damage.mechanics.simd import add, argument, flags_of, load, store, zero
from damage.mechanics.tables import (
    COS1,
    DAMPING,
    FRICTION,
    HAS_FAILED,
    RIGID,
    ROTATION,
    SIN,
    X,
    Z,
)
from damage.wall.kinematics import CORNER_RADIUS

CORNERS = 4
CENTRE_X, CENTRE_Z, LEFT, RIGHT, LOW, HIGH = range(6)
"""Columns of `cores`: where a body's place is counted from, and the edges of its core from there,
in its axes [m]."""
TOUCHING, REST, SLIDE, VISCOUS = range(4)
"""Fields of a corner in `springs`: 1 while it touches; rest overlap [m]; tangential spring [m];
force of the dashpot [N]."""
PAIRS, SEARCHES, WANTED, INSIDE, FULL = range(5)
"""Entries of `counts`: pairs in the list; searches so far; 1 to have the next step search, as when
the first joint has ended; how often a corner of a core lay inside another, where no normal is
defined; pairs that did not fit."""
STORED, LARGEST = range(2)
"""Entries of `energy`: stored in loose contacts now [J]; largest overlap so far [m]."""
MOST_NEIGHBOURS = 16
"""Pairs of neighbours for which there is room, over the number of bodies."""
MARGIN = 4.0
"""By how many radii two bodies may be apart to be neighbours."""
IMPACT_DAMPING = 0.2
"""Share of critical damping of a corner that touches: alone it bounces back with half of its
speed."""
GROUND_M = 20.0
"""Distance by which the ground reaches beyond the wall, and its depth, for bricks that fall on it
[m]."""
STEP_SHARE = 0.07
"""Time step over the root of mass over stiffness of a corner: a brick that bounces then keeps its
energy to 0.5 %."""


class Touch(NamedTuple):
    """Parameters of all loose contacts: radius of the corners [m], normal and tangential stiffness
    of a corner [N/m], friction [-], share of critical damping of a corner that touches [-]."""

    radius: float
    kn: float
    ks: float
    friction: float
    damping: float


@argument
class Loose(NamedTuple):
    """Tables of the loose contacts of one wall.

    cores: (bodies, 6), the supports last; bounds: (bodies, 4) left, right, low and high edge of
    each body and its margin at the last search, in which it had the places `seen` (bodies, 3) [m,
    m, rad]; order: (bodies,) of their left edges; pairs: (capacity, 2) bodies, the lower row first;
    springs: (capacity, 8, 4), corners of the first body, then of the second; kept_pairs,
    kept_springs: those of the last list; first: (bodies,), following: (capacity,) chain of the
    pairs of the last list by their first body; joints: (2 interfaces,), those of body b from row
    joints_start[b] to joints_start[b + 1]; joined: (bodies,) stamps of the search.
    """

    touch: Touch
    cores: np.ndarray
    bounds: np.ndarray
    seen: np.ndarray
    order: np.ndarray
    pairs: np.ndarray
    springs: np.ndarray
    kept_pairs: np.ndarray
    kept_springs: np.ndarray
    first: np.ndarray
    following: np.ndarray
    joints: np.ndarray
    joints_start: np.ndarray
    joined: np.ndarray
    counts: np.ndarray
    energy: np.ndarray


def stiffness_for(mass, time_step):
    """Stiffness of a corner that suits a time step [N/m]; mass: of the lightest body [kg]."""
    rate = STEP_SHARE / time_step
    return mass * (rate * rate)


def build_loose(layout, system, time_step):
    """The Loose contacts of a layout and of the System of its Tables.

    The joints of this System on supports end, too, from now on: where a brick has slid by its
    length.  The ground reaches GROUND_M beyond the wall and below it, without gaps between
    supports.
    """
    bodies = layout.bodies
    supports = layout.supports
    friction = Material(*map(float, system.material)).friction
    radius = CORNER_RADIUS * layout.wall.brick.length
    kn = stiffness_for(bodies.mass[bodies.mass > 0].min(), time_step)
    touch = Touch(radius, kn, 0.4 * kn, friction, IMPACT_DAMPING)
    edges = np.concatenate(
        [
            [supports.left[0] - GROUND_M],
            (supports.right[:-1] + supports.left[1:]) / 2,
            [supports.right[-1] + GROUND_M],
        ]
    )
    half_x = bodies.length / 2 - radius
    half_z = bodies.height / 2 - radius
    place = np.zeros(len(supports))
    cores = np.vstack(
        [
            np.column_stack([bodies.x, bodies.z, -half_x, half_x, -half_z, half_z]),
            np.column_stack(
                [
                    supports.x,
                    place,
                    edges[:-1] - supports.x,
                    edges[1:] - supports.x,
                    place - GROUND_M,
                    place - radius,
                ]
            ),
        ]
    )
    interfaces = system.interfaces
    grounded = interfaces["a"] >= len(bodies)
    length = bodies.length[interfaces["b"][grounded]]
    interfaces["slide_least"][grounded] = -length
    interfaces["slide_most"][grounded] = length
    return make_loose(touch, cores, interfaces["a"], interfaces["b"])


def make_loose(touch, cores, first, second):
    """Loose of bodies with these cores (bodies, 6); first, second: (interfaces,) rows of the bodies
    of each joint."""
    n = len(cores)
    room = MOST_NEIGHBOURS * n
    ends = np.concatenate([first, second]).astype(np.int64)
    by_body = np.argsort(ends, kind="stable")
    return Loose(
        touch=touch,
        cores=cores,
        bounds=np.zeros((n, 4)),
        seen=np.zeros((n, 3)),
        order=np.argsort(cores[:, CENTRE_X], kind="stable"),
        pairs=np.zeros((room, 2), np.int64),
        springs=np.zeros((room, 2 * CORNERS, 4)),
        kept_pairs=np.zeros((room, 2), np.int64),
        kept_springs=np.zeros((room, 2 * CORNERS, 4)),
        first=np.zeros(n, np.int64),
        following=np.zeros(room, np.int64),
        joints=by_body % max(len(first), 1),
        joints_start=np.searchsorted(ends[by_body], np.arange(n + 1)),
        joined=np.full(n, -1),
        counts=np.zeros(5, np.int64),
        energy=np.zeros(2),
    )


class Arms(NamedTuple):
    """From the centres of bodies p and c to where they touch [m]."""

    px: float
    pz: float
    cx: float
    cz: float


class Near(NamedTuple):
    """A corner of one core and the nearest point of another: their distance [m], the direction from
    that point to the corner [-], and the place halfway between them [m]."""

    distance: float
    nx: float
    nz: float
    x: float
    z: float


# --- forces ---------------------------------------------------------------------------------------


@compiled
def add_forces(n, tables, loose, dt):
    """Add the forces of all loose contacts to those on the bodies, if there are any, and search for
    neighbours first where a body has moved far enough; dt: time since they were last found [s]."""
    if loose is None:
        return
    if loose.counts[SEARCHES] + loose.counts[WANTED] > 0:
        if loose.counts[WANTED] > 0 or have_moved(n, tables, loose):
            search(n, tables, loose)
        loose.energy[STORED] = 0.0
        for row in range(loose.counts[PAIRS]):
            for k in range(2 * CORNERS):
                push_corner(n, tables, loose, row, k, dt)


@inlined
def energy_stored(n, loose):
    """Elastic energy of the loose contacts [J]."""
    if loose is None:
        return zero(n)
    return zero(n) + loose.energy[STORED]


@compiled
def push_corner(n, tables, loose, row, k, dt):
    """Forces between a corner of one core of a pair, that of its spring k, and the core of the
    other body."""
    p, c = bodies_of(loose, row, k)
    radius = loose.touch.radius
    near = nearest(n, tables, loose, p, c, k % CORNERS, 3.0 * radius)
    if near.distance <= 0.0:
        loose.counts[INSIDE] += 1
        return
    overlap = 2.0 * radius - near.distance
    rest = loose.springs[row, k, REST]
    depth = overlap - rest
    if depth <= 0.0:
        loose.springs[row, k, REST] = max(overlap, 0.0)
        if loose.springs[row, k, TOUCHING] == 0.0:
            return
        depth = 0.0
    loose.energy[LARGEST] = max(loose.energy[LARGEST], overlap)
    push_touching(n, tables, loose, row, k, near, depth, dt)


@inlined
def push_touching(n, tables, loose, row, k, near, depth, dt):
    """Forces of a corner that touches at a Near, compressed by a depth [m].

    Friction and the dashpot take half of what they would at the force before, and half at the force
    now: so central differences do work on the bodies, and the balance is that of the elastic part.
    """
    (p, c) = bodies_of(loose, row, k)
    touch = loose.touch
    springs = loose.springs
    inertia = tables.inertia
    arms = Arms(
        near.x - centre_of(n, tables, loose, p, X),
        near.z - centre_of(n, tables, loose, p, Z),
        near.x - centre_of(n, tables, loose, c, X),
        near.z - centre_of(n, tables, loose, c, Z),
    )
    vx, vz = relative_velocity(n, inertia, p, c, arms)
    closing = (vx * near.nx + vz * near.nz) * dt
    sliding = (vz * near.nx - vx * near.nz) * dt
    free_p = inverse_mass_of(n, inertia, p, Z)
    free_c = inverse_mass_of(n, inertia, c, Z)
    viscous = dashpot_force(touch, free_p + free_c, depth, closing, dt)
    normal = touch.kn * depth + viscous
    limit = touch.friction * normal / touch.ks
    old = springs[row, k, SLIDE]
    new = min(max(old + sliding, -limit), limit)
    add(n, tables.energy, 0, FRICTION, 0.5 * touch.ks * (old + new) * (old + sliding - new))
    add(n, tables.energy, 0, DAMPING, -0.5 * (springs[row, k, VISCOUS] + viscous) * closing)
    loose.energy[STORED] += 0.5 * (touch.kn * depth * depth + touch.ks * new * new)
    springs[row, k, TOUCHING] = 1.0 if depth > 0.0 else 0.0
    springs[row, k, SLIDE] = new
    springs[row, k, VISCOUS] = viscous
    fx = normal * near.nx + touch.ks * new * near.nz
    fz = normal * near.nz - touch.ks * new * near.nx
    push_body(n, tables.bodies, p, fx, fz, arms.px * fz - arms.pz * fx)
    push_body(n, tables.bodies, c, -fx, -fz, -(arms.cx * fz - arms.cz * fx))


@inlined
def relative_velocity(n, inertia, p, c, arms):
    """Velocity along x and z of body p relative to body c, where the Arms meet [m/s]."""
    turning_p = velocity_of(n, inertia, p, ROTATION)
    turning_c = velocity_of(n, inertia, c, ROTATION)
    return (
        velocity_of(n, inertia, p, X)
        - turning_p * arms.pz
        - velocity_of(n, inertia, c, X)
        + turning_c * arms.cz,
        velocity_of(n, inertia, p, Z)
        + turning_p * arms.px
        - velocity_of(n, inertia, c, Z)
        - turning_c * arms.cx,
    )


@inlined
def dashpot_force(touch, inverse, depth, closing, dt):
    """Force of the dashpot of a corner, which never pulls on it [N]; inverse: sum of the inverse
    masses of both bodies [1/kg]; closing: by which they move apart in the step of dt [m]."""
    if not (depth > 0.0 and dt > 0.0):
        return 0.0
    viscosity = 2.0 * touch.damping * np.sqrt(touch.kn / inverse) if inverse > 0.0 else 0.0
    return max(-viscosity * closing / dt, -touch.kn * depth)


@inlined
def bodies_of(loose, row, k):
    """The body whose core has corner k of a pair, and the other body."""
    a = loose.pairs[row, 0]
    b = loose.pairs[row, 1]
    return (a, b) if k < CORNERS else (b, a)


@inlined
def centre_of(n, tables, loose, b, axis):
    """Coordinate of the centre of a body, or of a support's reference point [m]."""
    return loose.cores[b, CENTRE_X + axis] + place_of(n, tables.bodies, b, axis)


@inlined
def turn_of(n, tables, b):
    """Cosine and sine of the rotation of body b."""
    return 1.0 + load(n, tables.bodies, b, COS1), load(n, tables.bodies, b, SIN)


@compiled
def nearest(n, tables, loose, p, c, corner, reach):
    """Near of a corner of the core of body p, counter-clockwise from the upper right, and the core
    of body c; farther than `reach` [m] the distance may be any above it."""
    cores = loose.cores
    right = corner == 0 or corner == 3
    high = corner < 2
    cos, sin = turn_of(n, tables, p)
    x = cores[p, RIGHT] if right else cores[p, LEFT]
    z = cores[p, HIGH] if high else cores[p, LOW]
    dx = centre_of(n, tables, loose, p, X) + cos * x - sin * z - centre_of(n, tables, loose, c, X)
    dz = centre_of(n, tables, loose, p, Z) + sin * x + cos * z - centre_of(n, tables, loose, c, Z)
    # In the axes of body c: the corner, and the point of its core that is nearest.
    cos, sin = turn_of(n, tables, c)
    x = cos * dx + sin * dz
    z = cos * dz - sin * dx
    on_x = min(max(x, cores[c, LEFT]), cores[c, RIGHT])
    on_z = min(max(z, cores[c, LOW]), cores[c, HIGH])
    apart_x = x - on_x
    apart_z = z - on_z
    if max(abs(apart_x), abs(apart_z)) > reach:
        return Near(2.0 * reach, 0.0, 0.0, 0.0, 0.0)
    distance = np.sqrt(apart_x * apart_x + apart_z * apart_z)
    if distance <= 0.0:
        return Near(0.0, 0.0, 0.0, 0.0, 0.0)
    half_x = 0.5 * (x + on_x)
    half_z = 0.5 * (z + on_z)
    return Near(
        distance,
        (cos * apart_x - sin * apart_z) / distance,
        (sin * apart_x + cos * apart_z) / distance,
        centre_of(n, tables, loose, c, X) + cos * half_x - sin * half_z,
        centre_of(n, tables, loose, c, Z) + sin * half_x + cos * half_z,
    )


# --- neighbours -----------------------------------------------------------------------------------


@compiled
def have_moved(n, tables, loose):
    """Whether a body has moved by half of the margin since the last search."""
    cores = loose.cores
    seen = loose.seen
    for b in range(len(cores)):
        reach = max(-cores[b, LEFT], cores[b, RIGHT]) + max(-cores[b, LOW], cores[b, HIGH])
        moved = abs(place_of(n, tables.bodies, b, X) - seen[b, X]) + abs(
            place_of(n, tables.bodies, b, Z) - seen[b, Z]
        )
        turned = abs(place_of(n, tables.bodies, b, ROTATION) - seen[b, ROTATION])
        if moved + turned * reach > 0.5 * MARGIN * loose.touch.radius:
            return True
    return False


@compiled
def search(n, tables, loose):
    """List the pairs of bodies that are near each other and not jointed: sort by their left edges
    and sweep."""
    order = loose.order
    bounds = loose.bounds
    counts = loose.counts
    inertia = tables.inertia
    counts[SEARCHES] = counts[SEARCHES] + 1
    counts[WANTED] = 0
    bound(n, tables, loose)
    sort(order, bounds)
    keep(loose)
    for k in range(len(order)):
        a = order[k]
        mark_joined(n, tables, loose, a)
        for other in range(k + 1, len(order)):
            b = order[other]
            if bounds[b, 0] > bounds[a, 1]:
                break
            is_free = inverse_mass_of(n, inertia, a, Z) + inverse_mass_of(n, inertia, b, Z) > 0.0
            if (
                bounds[b, 2] <= bounds[a, 3]
                and bounds[a, 2] <= bounds[b, 3]
                and loose.joined[b] != a
                and is_free
            ):
                list_pair(n, tables, loose, a, b)


@inlined
def mark_joined(n, tables, loose, a):
    """Stamp the bodies that joints which have not ended join to body a."""
    for j in range(loose.joints_start[a], loose.joints_start[a + 1]):
        joint = loose.joints[j]
        if load(n, tables.limits, joint, HAS_FAILED) != ENDED:
            loose.joined[tables.first[joint]] = loose.joined[tables.second[joint]] = a


@inlined
def sort(order, bounds):
    """Sort bodies by their left edges, by insertion: they are nearly sorted from the last time."""
    for k in range(1, len(order)):
        one = order[k]
        place = k
        while place > 0 and bounds[order[place - 1], 0] > bounds[one, 0]:
            order[place] = order[place - 1]
            place -= 1
        order[place] = one


@compiled
def bound(n, tables, loose):
    """Bounds of all bodies, grown by half of the margin between two."""
    cores = loose.cores
    bounds = loose.bounds
    grown = (1.0 + 0.5 * MARGIN) * loose.touch.radius
    for b in range(len(cores)):
        cos, sin = turn_of(n, tables, b)
        half_x = 0.5 * (cores[b, RIGHT] - cores[b, LEFT])
        half_z = 0.5 * (cores[b, HIGH] - cores[b, LOW])
        off_x = 0.5 * (cores[b, RIGHT] + cores[b, LEFT])
        off_z = 0.5 * (cores[b, HIGH] + cores[b, LOW])
        x = centre_of(n, tables, loose, b, X) + cos * off_x - sin * off_z
        z = centre_of(n, tables, loose, b, Z) + sin * off_x + cos * off_z
        wide = half_x * abs(cos) + half_z * abs(sin) + grown
        tall = half_x * abs(sin) + half_z * abs(cos) + grown
        bounds[b, 0] = x - wide
        bounds[b, 1] = x + wide
        bounds[b, 2] = z - tall
        bounds[b, 3] = z + tall
        for k in range(RIGID):
            loose.seen[b, k] = place_of(n, tables.bodies, b, k)
        loose.joined[b] = -1


@compiled
def keep(loose):
    """Keep the list of pairs as the last one, chained by their first bodies, and empty it."""
    loose.first[:] = -1
    for row in range(loose.counts[PAIRS]):
        a = loose.pairs[row, 0]
        loose.kept_pairs[row, 0] = a
        loose.kept_pairs[row, 1] = loose.pairs[row, 1]
        copy_springs(loose.springs, row, loose.kept_springs, row)
        loose.following[row] = loose.first[a]
        loose.first[a] = row
    loose.counts[PAIRS] = 0


@compiled
def list_pair(n, tables, loose, a, b):
    """Add a pair to the list, with the springs that it has had."""
    row = add_pair(loose, a, b)
    if row >= 0 and not carry_over(loose, row):
        meet(n, tables, loose, row, 0.0)


@inlined
def add_pair(loose, a, b):
    """Row of a new pair, the lower body first; -1 where there is no room."""
    row = loose.counts[PAIRS]
    if row >= len(loose.pairs):
        loose.counts[FULL] += 1
        return -1
    loose.counts[PAIRS] = row + 1
    loose.pairs[row, 0] = min(a, b)
    loose.pairs[row, 1] = max(a, b)
    return row


@inlined
def carry_over(loose, row):
    """Give a pair the springs that it had in the last list; False where it was not there."""
    last = loose.first[loose.pairs[row, 0]]
    while last >= 0 and loose.kept_pairs[last, 1] != loose.pairs[row, 1]:
        last = loose.following[last]
    if last < 0:
        return False
    copy_springs(loose.kept_springs, last, loose.springs, row)
    return True


@inlined
def copy_springs(springs, row, others, other):
    """Copy the springs of a pair to another row, one by one, since slices would have to be
    counted."""
    for k in range(2 * CORNERS):
        for i in range(springs.shape[2]):
            others[other, k, i] = springs[row, k, i]


@compiled
def meet(n, tables, loose, row, energy):
    """Start a loose pair whose overlapping corners store an energy [J], equal parts each; returns
    what they store: zero where none overlaps, at most that of an overlap of a radius in each."""
    overlapping = 0
    wide = 2.0 * loose.touch.radius
    loose.springs[row] = 0.0
    for k in range(2 * CORNERS):
        p, c = bodies_of(loose, row, k)
        loose.springs[row, k, REST] = max(
            wide - nearest(n, tables, loose, p, c, k % CORNERS, wide).distance, 0.0
        )
        overlapping += loose.springs[row, k, REST] > 0.0
    if overlapping == 0:
        return 0.0
    depth = min(
        np.sqrt(2.0 * max(energy, 0.0) / (overlapping * loose.touch.kn)), loose.touch.radius
    )
    for k in range(2 * CORNERS):
        if loose.springs[row, k, REST] > 0.0:
            loose.springs[row, k, REST] -= depth
    return 0.5 * overlapping * loose.touch.kn * depth * depth


# --- joints that end ------------------------------------------------------------------------------


@inlined
def may_end(n, loose, motion):
    """Flags of the walls in which an interface may end at this RelativeMotion although it is
    intact."""
    if loose is None:
        return flags_of(n, 0)
    return is_turned(motion)


@inlined
def is_turned(motion):
    """Whether a corner of one brick, at most a brick's length away, can lie in the other by a
    radius."""
    return abs(motion.rotation) > CORNER_RADIUS


@inlined
def ends_too(n, tables, loose, p, step, motion):
    """Whether an interface whose faces overlap ends at this RelativeMotion; step: number of the
    step in the log.

    It ends as all of it gapes by more than two radii; and any that is not elastic as a rounded
    corner of one body lies by a radius in the other, which contact points within the faces do not
    resist: what was left of its bond has failed then.
    """
    if loose is None:
        return False
    interface = tables.interfaces[p]
    failed = load(n, tables.limits, p, HAS_FAILED)
    least = motion.opening - springs_of(n, tables, p, True).reach * abs(motion.rotation)
    if failed == FAILED and least > 2.0 * loose.touch.radius:
        return True
    if failed < ENDING and is_turned(motion) and corner_inside(n, tables, loose, interface):
        return break_bonds(n, tables, interface, step, motion)
    return False


@compiled
def break_bonds(n, tables, interface, step, motion):
    """Let all bonds of an interface fail, and log those that were intact; returns False where it is
    elastic."""
    for i in range(interface.start, interface.stop):
        strengths = strengths_of(n, tables.strengths, i)
        if strengths.tensile_strength == np.inf and strengths.cohesion == np.inf:
            return False
    for i in range(interface.start, interface.stop):
        if load(n, tables.states, i, contacts.BROKEN) == 0.0:
            trial = contacts.present_forces(n, tables, i, motion)
            area = tables.contacts[i].area
            store(n, tables.states, i, contacts.BROKEN, 1.0)
            contacts.log_event(
                tables, n.lane, step, i, TENSION, (trial.sigma / area, trial.tau / area, 0.0, 0.0)
            )
    return True


@compiled
def corner_inside(n, tables, loose, interface):
    """Whether a rounded corner of one body of an interface lies by a radius in the other body."""
    radius = loose.touch.radius
    for corner in range(CORNERS):
        if (
            nearest(n, tables, loose, interface.a, interface.b, corner, radius).distance < radius
            or nearest(n, tables, loose, interface.b, interface.a, corner, radius).distance < radius
        ):
            return True
    return False


@compiled
def hand_over(n, tables, loose, interface, energy):
    """List the bodies of an interface that has ended as a loose pair.

    energy: elastic energy that the interface had stored [J], which counts as friction unless
    corners store it.
    """
    if loose is None:
        return
    if loose.counts[SEARCHES] == 0:
        loose.counts[WANTED] = 1
    row = add_pair(loose, np.int64(interface.a), np.int64(interface.b))
    if row >= 0:
        add(n, tables.energy, 0, FRICTION, -meet(n, tables, loose, row, energy))
