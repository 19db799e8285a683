"""The time step: move the bodies, evaluate every interface and every loose contact, sum the forces.

This is the definition of the model.  It runs one wall or eight at once (`n`, `damage.mechanics.eight`), compiled by
numba or as plain Python (NUMBA_DISABLE_JIT=1); a wall has the same bits in both widths, whatever the others do.  Of
eight walls, some leave their elastic range, are failed, or end, which bits of integers say; the joint law is evaluated
for one wall at a time.

A wall *ends* at the steps at which a sample of it is taken: its contact points are then evaluated one by one.

Time integration is by central differences: velocities at half steps, displacements and forces at full steps.
"""

import numpy as np

from damage.elementary import cos, sin
from damage.mechanics import contacts, interfaces, rows
from damage.mechanics.bodies import SMALL, adapt, move, set_bench, small_rotation, total
from damage.mechanics.compiled import compiled, entry, inlined
from damage.mechanics.eight import (
    add,
    add_part,
    bits,
    either,
    flags_of,
    lane,
    lanes,
    load,
    rows_of,
    store,
    table_width,
    wall_of,
    widest,
    with_lane,
    zero,
)
from damage.mechanics.interfaces import Pose, RelativeMotion, Resultant
from damage.mechanics.loose import can_end, ends_too, find_loose_forces, hand_over
from damage.mechanics.samples import observe
from damage.mechanics.tables import (
    DAMPED,
    DAMPING,
    ENDED,
    ENDING,
    FAILED,
    FRICTION,
    HAS_FAILED,
    LARGEST_OPENING,
    RIGID,
    ROTATION,
    ROW,
    STEP,
    Bearing,
    X,
    Z,
)

ADVANCE, FIND_FORCES, LOOK = range(3)
"""What `run` does."""


@entry
def run(what, n, tables, law, strain, loose, matrix, controls, field, clock, ends, ending, stiffness, samples,
        taken):
    """Advance all walls to the last of the steps `ends`, and write samples.

    On entry the forces must be those at the present displacements.  On return, and at each sample, forces and readings
    (opening, shear displacement and stresses of every contact point) are those at the displacements.

    what: ADVANCE; FIND_FORCES: at the present displacements, without damping, by contact points in the walls ending[0];
    LOOK: write a sample of the walls ending[0] now.  All in one function, since each would be compiled with the rest.
    tables, law: Tables and Law; strain: Strain, None of rigid bricks; loose: Loose of one wall, None where bricks find
    no new contacts; matrix: Matrix of these walls, None without mass scaling; controls: (walls, 5) time step [s], local
    damping [-], mass-proportional [1/s] and stiffness-proportional damping [s], adaptive damping as the share of the
    rate of change of the kinetic energy [-];
    field: (walls, steps + 1, 3) acceleration of the base along x and z and gravity, in each step and the one after the
    last [m/s2]; clock: (walls,) numbers of steps before; ends: (n,) rising numbers of steps from now; ending: (n,)
    walls (bits) of which a sample is written there, all of them at the last; stiffness, samples, taken: as of
    `damage.mechanics.samples.observe`.
    """
    damped = what == ADVANCE and (controls[:, 3].any() or len(tables.radiation) > 0)
    adaptive, turns, walls = controls[:, 4].any(), tables.turning[:, 0].any(), (1 << len(controls)) - 1
    step = k = ends[0] * 0  # of no literal type, for which numba would compile all of it once more
    if strain is not None:
        mark_used(n, tables, walls)
    if what == LOOK:
        set_bench(n, tables, controls, field, step)
        observe(n, tables, strain, loose, matrix, ending[0], stiffness, samples, taken)
        return
    if what == FIND_FORCES:
        tables.bodies[:, rows.first_force(tables.bodies):] = 0.0
        tables.bench[0, STEP] = 0.0  # nothing has moved to these displacements
        all_forces(n, tables, law, strain, loose, clock, step, walls, ending[0], damped, turns, 0.0)
        return
    if damped:
        remember_last(n, tables, strain, walls)
    while k < len(ends):
        move(n, tables, strain, matrix, controls, field, step)
        if adaptive:
            adapt(n, tables, strain, controls)
        step += 1
        which = ending[k] if step >= ends[k] else 0
        all_forces(n, tables, law, strain, loose, clock, step, walls, which, damped, turns, controls[0, 0])
        if which:
            set_bench(n, tables, controls, field, step)
            observe(n, tables, strain, loose, matrix, which, stiffness, samples, taken)
            if damped:
                remember_last(n, tables, strain, which)
            k += 1


@compiled
def mark_used(n, tables, walls):
    """Mark the contact points that are no intact springs in any of the walls (bits)."""
    for i in range(len(tables.contacts)):
        tables.used[i] = bits(contacts.is_intact_spring(n, tables.states, i)) & walls != walls


# --- forces -----------------------------------------------------------------------------------------

@compiled
def all_forces(n, tables, law, strain, loose, clock, step, walls, ending, damped, turns, since):
    """Add the forces of all interfaces and loose contacts to those of the bodies, which are zero on entry.

    Intact interfaces come first, each by its resultant springs, then the others contact point by contact point.
    clock + step: number of the step in the log of events; walls: all of them (bits); ending: walls whose contact points
    are all evaluated by themselves and read, as for samples, so that forces are the sums of the stresses to the last
    bit; damped: whether interfaces damp; turns: whether bodies are held by rotational springs; since: time since the
    last forces [s], zero where nothing has moved.
    """
    tables.sums[DAMPED] = 0.0
    singly, others = ending == walls, 1
    if strain is not None:
        singly = True
    if not singly:
        others = forces_of_damped(n, tables, loose, ending) if damped else forces_of_undamped(n, tables, loose, ending)
    if others:
        forces_of_others(n, tables, law, strain, loose, clock, step, walls, ending, singly, damped)
    if turns:
        for b in range(len(tables.turning)):
            stiffness, rest = load(n, tables.turning, b, 0), load(n, tables.turning, b, 1)
            moment = stiffness * (rows.place_of(n, tables.bodies, b, ROTATION) - rest)
            add(n, tables.bodies, b, rows.first_force(tables.bodies) + ROTATION, -either(stiffness > 0.0, moment, 0.0))
    if len(tables.bearings) > 0:
        hold_top(n, tables)
    if loose is not None:
        find_loose_forces(n, tables, loose, since)
    if damped:
        total(n, tables.sums, DAMPED)
        store(n, tables.energy, 0, DAMPING, load(n, tables.energy, 0, DAMPING) + load(n, tables.sums, DAMPED, 0))


@compiled
def hold_top(n, tables):
    """Add the forces of the bearing of a restrained top, and of the constant load on it, to those of its beam.

    The bearing is a spring in series with a slider, `damage.wall.restraints`; the work of its slip is friction.
    """
    bench = rows.bench_of(n, tables.bench, 0)
    gravity = bench.pull_z - bench.base_z
    for b in range(len(tables.bearings)):
        stiffness, limit, play, weighs, slip, before = rows.bearing_of(n, tables.bearings, b)
        trial = stiffness * (rows.place_of(n, tables.bodies, b, X) - slip)
        excess = either(trial > limit, trial - limit, either(trial < -limit, trial + limit, 0.0))
        slipped = slip + excess / either(stiffness > 0.0, stiffness, 1.0)
        slipped = either(slipped > play, play, either(slipped < -play, -play, slipped))
        force = trial - stiffness * (slipped - slip)
        rows.keep_bearing(n, tables.bearings, b, True, Bearing(stiffness, limit, play, weighs, slipped, force))
        add(n, tables.energy, 0, FRICTION, 0.5 * (before + force) * (slipped - slip))
        add(n, tables.bodies, b, rows.first_force(tables.bodies) + X, -force)
        add(n, tables.bodies, b, rows.first_force(tables.bodies) + Z, -weighs * gravity)


@compiled
def forces_of_undamped(n, tables, loose, ending):
    """`forces_of_intact` without damping, compiled apart: a branch inside would need too many registers."""
    return forces_of_intact(widest(n), tables, loose, ending, False)


@compiled
def forces_of_damped(n, tables, loose, ending):
    """`forces_of_intact` with damping."""
    return forces_of_intact(widest(n), tables, loose, ending, True)


@inlined
def forces_of_intact(n, tables, loose, ending, damped):
    """Add the forces of intact interfaces, but in the walls `ending` (bits); returns whether there are others.

    n: Eight, an interface of eight walls, or Rows, eight interfaces of one wall.
    """
    everyone, any_other = (1 << lanes(n)) - 1, 0
    for p in range(0, len(tables.others), rows_of(n)):
        springs = rows.springs_of(n, tables, p)
        frame, motion = moved(n, tables, p)
        intact = interfaces.stays_intact(springs, rows.limits_of(n, tables.limits, p), motion)
        if ending:
            intact = intact & flags_of(n, everyone ^ ending)
        if loose is not None:
            intact = intact & flags_of(n, everyone ^ bits(can_end(motion)))
        other = everyone ^ bits(intact)
        any_other |= other
        if rows_of(n) == 1:
            tables.others[p] = other
        else:
            for k in range(rows_of(n)):
                tables.others[p + k] = other >> k & 1
        resultant = interfaces.elastic_resultant(springs, motion)
        if damped:
            changed = interfaces.change(resultant, rows.last_resultant(n, tables.last, p))
            resultant = damp(n, tables, p, motion, resultant, changed, intact)
        forces = interfaces.forces_on_bodies(frame, resultant, motion)
        rows.push_at(n, tables.bodies, tables.first, tables.second, p, forces, intact)
    return any_other


@inlined
def moved(n, tables, p):
    """Frame and RelativeMotion of interface p, or of eight from there on."""
    return interfaces.relative_motion(rows.line_of(n, tables, p), rows.pose_at(n, tables.bodies, tables.first, p),
                                      rows.pose_at(n, tables.bodies, tables.second, p))


@compiled
def forces_of_others(n, tables, law, strain, loose, clock, step, walls, ending, singly, damped):
    """Add the forces of the interfaces that are not intact, if `singly` of all, contact point by contact point."""
    for p in range(len(tables.interfaces)):
        here = walls if singly else walls & int(tables.others[p])
        if here:
            forces_by_contacts(n, tables, law, strain, loose, p, clock, step, here, ending, damped)


@inlined
def forces_by_contacts(n, tables, law, strain, loose, p, clock, step, here, ending, damped):
    """Add the forces of interface p in the walls `here` (bits), evaluated contact point by contact point.

    Those that share a RelativeMotion (all between rigid bricks, one between deformable ones) are springs while all stay
    in their elastic range, else the joint law applies.  Once the faces have ceased to overlap, forces are zero from the
    next step on, permanently.
    """
    interface = tables.interfaces[p]
    frame, motion = moved(n, tables, p)
    gone = bits(load(n, tables.limits, p, HAS_FAILED) >= ENDING) & here
    if gone:
        let_go(n, tables, strain, loose, p, gone, motion)
        here &= ~gone
    if here:
        lives, resultant = flags_of(n, here), Resultant(zero(n), zero(n), zero(n))
        start, size = ROW(interface.start), points_at_once(strain, interface)
        while start < interface.stop:
            at_points = motion_at(n, tables.bodies, strain, interface, start, motion)
            of_points = forces_of_points(n, tables, law, strain, p, start, start + size, clock, step, at_points, here,
                                         damped)
            push_modes(n, tables.bodies, strain, interface, start, of_points, lives)
            resultant = interfaces.add(resultant, of_points)
            start += size
        over = ends_now(n, tables, loose, p, clock, step, here, motion)
        if here & (ending | over):
            for i in range(interface.start, interface.stop):
                at_point = motion_at(n, tables.bodies, strain, interface, i, motion)
                contacts.read(n, tables, i, at_point, flags_of(n, here & (ending | over)))
        rows.push(n, tables.bodies, interface, interfaces.forces_on_bodies(frame, resultant, motion), lives)


@inlined
def ends_now(n, tables, loose, p, clock, step, here, motion):
    """Walls of `here` (bits) in which interface p ends at this RelativeMotion: there it is ENDING.

    A failed one ends as its faces cease to overlap; also as of `ends_too` where bodies find new contacts.
    """
    interface = tables.interfaces[p]
    failed = bits(load(n, tables.limits, p, HAS_FAILED) == FAILED) & here
    over = 0
    if failed:
        over = failed & bits((motion.shear <= interface.slide_least) | (motion.shear >= interface.slide_most))
    if loose is not None and over == 0 and ends_too(n, tables, loose, p, clock[0] + step, motion):
        over = 1
    if over:
        for w in range(lanes(n)):
            if over >> w & 1:
                fail(n, tables, p, w, ENDING)
    return over


@inlined
def fail(n, tables, p, w, failed):
    """Mark interface p of wall w as FAILED, ENDING or ENDED."""
    store(wall_of(n, w), tables.limits, p, HAS_FAILED, failed)
    store(wall_of(n, w), tables.limits, p, LARGEST_OPENING, -np.inf)


@inlined
def let_go(n, tables, strain, loose, p, gone, motion):
    """Set the forces of interface p to zero, permanently, in those of the walls `gone` (bits) in which it is ENDING;
    its bodies become a loose pair where there are such."""
    interface = tables.interfaces[p]
    for w in range(lanes(n)):
        one = wall_of(n, w)
        if gone >> w & 1 and load(one, tables.limits, p, HAS_FAILED) == ENDING:
            before = load(one, tables.energy, 0, FRICTION)
            for i in range(interface.start, interface.stop):
                contacts.let_go(one, tables, i, motion_at(one, tables.bodies, strain, interface, i, of_wall(motion, w)))
                tables.used[i] = 1
            fail(n, tables, p, w, ENDED)
            if loose is not None:
                hand_over(n, tables, loose, interface, load(one, tables.energy, 0, FRICTION) - before)


@inlined
def last_row(strain, p, start):
    """Row of `last` of interface p, or of its contact where bricks deform."""
    return p if strain is None else np.int64(start)


@inlined
def forces_of_points(n, tables, law, strain, p, start, stop, clock, step, motion, here, damped):
    """Resultant of contact points of interface p that share a RelativeMotion [N, N m], in the walls `here` (bits)."""
    lives, row, of_contacts, states = flags_of(n, here), last_row(strain, p, start), tables.contacts, tables.states
    if strain is not None and tables.used[start] == 0:
        resultant, elastic = contacts.intact_resultant(n, of_contacts, states, start, motion, lives)
    else:
        resultant, elastic = contacts.elastic_resultant(n, of_contacts, states, start, stop, motion, lives)
    beyond = here & ~bits(elastic)
    if beyond:
        springs, limits = rows.springs_of(n, tables, p), rows.limits_of(n, tables.limits, p)
        beyond &= ~bits(interfaces.stays_intact(springs, limits, motion))
    if strain is None or tables.used[start]:
        contacts.remember(n, of_contacts, states, start, stop, motion, flags_of(n, here & ~beyond))
    changed = resultant
    if damped:
        changed = interfaces.change(resultant, rows.last_resultant(n, tables.last, row))
    if beyond:
        resultant, changed = by_law(n, tables, law, strain, p, start, stop, clock, step, motion, beyond, damped,
                                    resultant, changed)
    if damped:
        resultant = damp(n, tables, row, motion, resultant, changed, lives)
    return resultant


@inlined
def by_law(n, tables, law, strain, p, start, stop, clock, step, motion, beyond, damped, resultant, changed):
    """Resultant of contact points, and its change since the last step, by the joint law in the walls `beyond` (bits),
    in the others as given."""
    row = last_row(strain, p, start)
    for w in range(lanes(n)):
        if beyond >> w & 1:
            one, now = wall_of(n, w), of_wall(motion, w)
            before = motion_before(one, tables, strain, p, row, now, damped)
            of_points, change, failed = contacts.law_resultant(one, tables, law, start, stop, clock[w] + step, now,
                                                               before, damped)
            resultant, changed = with_wall(resultant, w, of_points), with_wall(changed, w, change)
            if failed:
                fail(n, tables, p, w, FAILED)
                tables.used[start] = 1
    return resultant, changed


@inlined
def of_wall(motion, w):
    """RelativeMotion of wall w."""
    return RelativeMotion(lane(motion.opening, w), lane(motion.shear, w), lane(motion.rotation, w))


@inlined
def with_wall(resultant, w, of_wall):
    """Resultant with that of wall w replaced."""
    return Resultant(with_lane(resultant.normal, w, of_wall.normal), with_lane(resultant.shear, w, of_wall.shear),
                     with_lane(resultant.couple, w, of_wall.couple))


@inlined
def motion_before(n, tables, strain, p, row, motion, damped):
    """RelativeMotion of interface p of one wall in the last step, stored where the wall damps, else by velocities; the
    present one between deformable bricks."""
    if damped and (rows.bench_of(n, tables.bench, 0).rate > 0.0 or len(tables.radiation) > 0):
        return rows.last_motion(n, tables.last, row)
    if strain is not None:
        return motion
    interface = tables.interfaces[p]
    return interfaces.relative_motion(rows.line_of(n, tables, p), pose_before(n, tables, interface.a),
                                      pose_before(n, tables, interface.b))[1]


@compiled
def pose_before(n, tables, b):
    """Pose of body b of one wall in the last step."""
    places, inertia, dt = tables.bodies, tables.inertia, rows.bench_of(n, tables.bench, 0).step
    angle = rows.place_of(n, places, b, ROTATION) - dt * rows.velocity_of(n, inertia, b, ROTATION)
    cos1, sine = small_rotation(angle) if abs(angle) < SMALL else (cos(angle) - 1.0, sin(angle))
    return Pose(rows.place_of(n, places, b, X) - dt * rows.velocity_of(n, inertia, b, X),
                rows.place_of(n, places, b, Z) - dt * rows.velocity_of(n, inertia, b, Z), cos1, sine)


# --- damping of interfaces --------------------------------------------------------------------------

@inlined
def damp(n, tables, row, motion, resultant, changed, which):
    """Resultant with stiffness-proportional damping and dashpots [N, N m]; stores motion and elastic resultant for the
    next step, and adds up the work, in the walls `which` (flags).

    changed: change of the elastic resultant since the last step.
    """
    before = rows.last_motion(n, tables.last, row)
    rows.keep_motion(n, tables.last, row, which, motion)
    rows.keep_resultant(n, tables.last, row, which, resultant)
    bench = rows.bench_of(table_width(n), tables.bench, 0)
    viscous, work = interfaces.add_viscous(bench.rate, motion, before, resultant, changed)
    if len(tables.radiation) > 0:
        viscous, of_dashpots, more = interfaces.add_dashpots(
            rows.dashpots_of(n, tables.radiation, row), rows.dashpots_last(n, tables.radiation, row), bench.step,
            motion, before, viscous, changed)
        rows.keep_dashpots(n, tables.radiation, row, which, of_dashpots)
        work = work + more
    add_part(n, tables.sums, DAMPED, row, either(which, work, 0.0))
    return viscous


@compiled
def remember_last(n, tables, strain, which):
    """Store present motions and resultants of all interfaces, for stiffness-proportional damping in the next step, in
    the walls `which` (bits)."""
    asked = flags_of(n, which)
    for p in range(len(tables.interfaces)):
        interface, motion = tables.interfaces[p], moved(n, tables, p)[1]
        start, size = ROW(interface.start), points_at_once(strain, interface)
        while start < interface.stop:
            here, row = motion_at(n, tables.bodies, strain, interface, start, motion), last_row(strain, p, start)
            rows.keep_motion(n, tables.last, row, asked, here)
            rows.keep_resultant(n, tables.last, row, asked, contacts.present_resultant(
                n, tables.contacts, tables.states, start, start + size, here))
            start += size


# --- strain modes of deformable bricks ----------------------------------------------------------------
# Mode m of a body is its coordinate RIGID + m.  Its generalized force is the work of the contact forces on the opening
# and shear displacement by a unit of the mode.  Its mass, stiffness, damping and shape are equal in all walls that step
# together.  Theory: `damage.wall.strain`.

@inlined
def points_at_once(strain, interface):
    """Number of contact points that share a RelativeMotion: all of an interface between rigid bricks, else one."""
    if strain is None:
        return ROW(interface.stop - interface.start)
    return ROW(1)


@inlined
def motion_at(n, bodies, strain, interface, i, motion):
    """RelativeMotion at contact i: that of the interface plus the displacements by the strain modes of both bricks."""
    if strain is None:
        return motion
    a, b, at_a, at_b, shapes = interface.a, interface.b, strain.rows[i, 0], strain.rows[i, 1], strain.shapes
    opening, shear = zero(n), zero(n)
    for m in range(shapes.shape[2]):
        qa, qb = rows.place_of(n, bodies, a, RIGID + m), rows.place_of(n, bodies, b, RIGID + m)
        opening = opening + (shapes[at_b, 0, m] * qb - shapes[at_a, 0, m] * qa)
        shear = shear + (shapes[at_b, 1, m] * qb - shapes[at_a, 1, m] * qa)
    return RelativeMotion(motion.opening + opening, motion.shear + shear, motion.rotation)


@inlined
def push_modes(n, bodies, strain, interface, i, resultant, which):
    """Add a contact's Resultant to the generalized forces of both bricks' modes, in the walls `which` (flags)."""
    if strain is None:
        return
    a, b, at_a, at_b, shapes = interface.a, interface.b, strain.rows[i, 0], strain.rows[i, 1], strain.shapes
    normal, shear = either(which, resultant.normal, 0.0), either(which, resultant.shear, 0.0)
    for m in range(shapes.shape[2]):
        k = rows.first_force(bodies) + RIGID + m
        add(n, bodies, a, k, normal * shapes[at_a, 0, m] + shear * shapes[at_a, 1, m])
        add(n, bodies, b, k, -(normal * shapes[at_b, 0, m] + shear * shapes[at_b, 1, m]))
