"""The time step: move the bodies, evaluate every interface and every loose contact, sum the forces.

This is the definition of the model.  It runs one wall or eight at once (`n`,
`damage.mechanics.simd`), compiled by numba or as plain Python (NUMBA_DISABLE_JIT=1); a wall has
the same bits in both widths, whatever the others do.  Of eight walls, some leave their elastic
range, are failed, or end, which bits of integers say; the joint law is evaluated for one wall at a
time.

Python calls three functions: `advance` by many steps, each of which is `step_once`; `find_forces`
at displacements that it has set; and `look`, which writes a sample.  A wall *ends* at the steps at
which a sample of it is taken: its contact points are then evaluated one by one.

Time integration is by central differences: velocities at half steps, displacements and forces at
full steps.
"""

from typing import NamedTuple

import numpy as np

from damage.elementary import cos, sin
from damage.law.states import ENDED, ENDING, FAILED
from damage.mechanics import collisions, contacts, interfaces, rows
from damage.mechanics.bodies import SMALL, adapt, move_all, set_bench, small_rotation, total
from damage.mechanics.compiled import compiled, entry, inlined
from damage.mechanics.contacts import Points, confine
from damage.mechanics.interfaces import Pose, RelativeMotion, Resultant
from damage.mechanics.samples import observe
from damage.mechanics.scaling import move_scaled
from damage.mechanics.simd import (
    add,
    add_part,
    argument,
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
from damage.mechanics.tables import (
    ADAPTIVE,
    BETA,
    DAMPED,
    DAMPING,
    DRIVEN,
    FRICTION,
    HAS_FAILED,
    INPUT,
    KINETIC,
    LARGEST_OPENING,
    RIGID,
    ROTATION,
    ROW,
    STEP,
    SWEPT_X,
    SWEPT_Z,
    TAKEN,
    TIME_STEP,
    Beam,
    Bearing,
    Model,
    X,
    Z,
)


@argument
class Asked(NamedTuple):
    """Which forces are asked for, of all walls (bits).

    clock: (walls,) numbers of steps before those that are counted here; step: number of steps from
    there, which is added in the log of events; ending: walls (bits) whose contact points are all
    evaluated by themselves and read, as for samples, so that forces are the sums of the stresses to
    the last bit; damped: whether interfaces damp; holds: whether bodies are held by rotational
    springs or a spreader beam; since: time since the last forces [s], zero where nothing has moved.
    """

    clock: np.ndarray
    step: int
    walls: int
    ending: int
    damped: bool
    holds: bool
    since: float


@entry
def advance(n, tables, model, controls, field, clock, begin, stops, sampling):
    """Advance all walls to the last of the steps at which one ends, and write samples.

    On entry the forces must be those at the present displacements.  At each sample forces and
    readings (opening, shear displacement and stresses of every contact point) are those at the
    displacements.

    tables, model: Tables and Model; controls: (walls, 5) of `damage.mechanics.tables.TIME_STEP` to
    ADAPTIVE; field: (walls, steps + 1, 3) acceleration of the base along x and z and gravity, in
    each step and the one after the last [m/s2]; clock: (walls,) numbers of steps before; begin:
    walls (bits) that do not go on from within a call; stops: (stops, 2) rising numbers of steps
    from now, and the walls (bits) of which a sample is written there; sampling: Sampling.
    """
    damped = controls[:, BETA].any() or tables.radiates
    walls, holds = (1 << len(controls)) - 1, tables.turning[:, :2].any()
    # of no literal type, for which numba would compile all of it once more
    step = k = stops[0, 0] * 0
    mark_used(n, tables, model.strain, walls)
    if damped:
        remember_last(n, tables, model.strain, begin)
    while k < len(stops):
        step += 1
        ending = stops[k, 1] if step >= stops[k, 0] else 0
        step_once(
            n,
            tables,
            model,
            controls,
            field,
            Asked(clock, step, walls, ending, damped, holds, controls[0, TIME_STEP]),
        )
        if ending:
            look(n, tables, model, controls, field, step, ending, sampling)
            confine(n, tables, model.cuts, ending)
            if damped:
                remember_last(n, tables, model.strain, ending)
            k += 1


@inlined
def step_once(n, tables, model, controls, field, asked):
    """Move all bodies by a step, and find the forces at the places where they are then."""
    move(n, tables, model.strain, model.matrix, controls, field, asked.step - 1)
    if controls[:, ADAPTIVE].any():
        adapt(n, tables, model.strain, controls)
    # without the matrix, so that the code of forces is the same with mass scaling and without
    of_forces = Model(model.threshold, model.strain, model.loose, None, model.cuts)
    find_forces(n, tables, of_forces, asked)


@entry
def look(n, tables, model, controls, field, step, which, sampling):
    """Write a sample of the walls `which` (bits) at their present displacements; step: row of the
    field; otherwise as `advance`."""
    set_bench(n, tables, controls, field, step)
    observe(n, tables, model, which, sampling)


# --- motion ---------------------------------------------------------------------------------------


@compiled
def move(n, tables, strain, matrix, controls, field, step):
    """Advance velocities and displacements of all bodies by a step; add the work of input and
    damping [J].

    controls, field: as of `advance`; step: row of the field.
    """
    sums = tables.sums
    sums[SWEPT_X:KINETIC] = 0.0
    damped = set_bench(n, tables, controls, field, step)
    if matrix is not None:
        move_scaled(n, tables, matrix, strain, damped)
    elif damped:
        move_all(n, tables, strain, controls, True)
    else:
        move_all(n, tables, strain, controls, False)
    for kind in range(SWEPT_X, KINETIC):
        total(n, sums, kind)
    for w in range(len(controls)):
        dt = controls[w, TIME_STEP]
        swept = field[w, step, 0] * sums[SWEPT_X, 0, w] + field[w, step, 1] * sums[SWEPT_Z, 0, w]
        tables.energy[0, INPUT, w] += (sums[DRIVEN, 0, w] - 0.5 * swept) * dt
        tables.energy[0, DAMPING, w] += sums[TAKEN, 0, w] * dt


# --- forces ---------------------------------------------------------------------------------------


@entry
def find_forces(n, tables, model, asked):
    """Add the forces of all interfaces and loose contacts to those of the bodies, which are zero on
    entry, or are made so where nothing has moved; tables, model, asked: Tables, Model, Asked.

    Intact interfaces come first, each by its resultant springs, then the others contact point by
    contact point.
    """
    if asked.since == 0.0:
        tables.bodies[:, rows.first_force(tables.bodies) :] = 0.0
        tables.bench[0, STEP] = 0.0
        mark_used(n, tables, model.strain, asked.walls)
    tables.sums[DAMPED] = 0.0
    singly = asked.ending == asked.walls or deforms(model.strain)
    if singly or forces_of_springs(n, tables, model.loose, asked):
        forces_of_others(n, tables, model, asked, singly)
    if asked.holds:
        hold_rotations(n, tables)
    if len(tables.bearings) > 0:
        hold_top(n, tables)
    collisions.add_forces(n, tables, model.loose, asked.since)
    if asked.holds and asked.since > 0.0:
        spread(n, tables)
    if asked.damped:
        total(n, tables.sums, DAMPED)
        store(
            n,
            tables.energy,
            0,
            DAMPING,
            load(n, tables.energy, 0, DAMPING) + load(n, tables.sums, DAMPED, 0),
        )


@compiled
def mark_used(n, tables, strain, walls):
    """Mark the contact points between deformable bricks that are no intact springs in any of the
    walls (bits)."""
    if strain is not None:
        for i in range(len(tables.contacts)):
            tables.used[i] = bits(contacts.is_intact_spring(n, tables.states, i)) & walls != walls


@inlined
def hold_rotations(n, tables):
    """Add the moments of the rotational springs by which bodies are held."""
    for b in range(len(tables.turning)):
        stiffness, rest = load(n, tables.turning, b, 0), load(n, tables.turning, b, 2)
        moment = stiffness * (rows.place_of(n, tables.bodies, b, ROTATION) - rest)
        add(
            n,
            tables.bodies,
            b,
            rows.first_force(tables.bodies) + ROTATION,
            -either(stiffness > 0.0, moment, 0.0),
        )


@compiled
def spread(n, tables):
    """Add the force of a spreader beam, by the share of each body, to those of the bodies; add its
    work to the input.

    It is the force with which the mean displacement of these bodies, weighted by their shares, is
    that of the machine after the next step: of a beam of levers, whose forces keep their ratio.
    Local damping takes or gives a share of each body's rate by its sign: a few iterations find it.
    """
    bench = rows.bench_of(n, tables.bench, 0)
    place, velocity, before = rows.beam_of(n, tables.beam, 0)
    dt, x, force = bench.step, rows.first_force(tables.bodies) + X, before
    there, speed, local = zero(n), zero(n), bits(bench.local > 0.0) > 0
    for b in range(len(tables.turning)):
        share = load(n, tables.turning, b, 1)
        there = there + share * rows.place_of(n, tables.bodies, b, X)
        speed = speed + share * rows.velocity_of(n, tables.inertia, b, X)
    change = (place - there) / dt - (1.0 - dt * load(n, tables.relaxation, 0, 0)) * speed
    for _ in range(4 if local else 1):
        rate, freedom = zero(n), zero(n)
        for b in range(len(tables.turning)):
            share, own = load(n, tables.turning, b, 1), load(n, tables.bodies, b, x)
            power = (own + share * force) * rows.velocity_of(n, tables.inertia, b, X)
            damped = either(power > 0.0, bench.local, either(power < 0.0, -bench.local, 0.0))
            free = share * (1.0 - damped) * rows.inverse_mass_of(n, tables.inertia, b, X)
            rate, freedom = rate + free * own, freedom + free * share
        spreads = freedom > 0.0
        force = (change / dt - rate) / either(spreads, freedom, 1.0)
        force = either(spreads, force, 0.0)
    add(n, tables.energy, 0, INPUT, 0.5 * dt * speed * (before + force))
    rows.keep_beam(n, tables.beam, 0, True, Beam(place + dt * velocity, velocity, force))
    for b in range(len(tables.turning)):
        add(n, tables.bodies, b, x, load(n, tables.turning, b, 1) * force)


@compiled
def hold_top(n, tables):
    """Add the forces of the bearing of a restrained top, and of the constant load on it, to those
    of its beam.

    The bearing is a spring in series with a slider, `damage.wall.restraints`; the work of its slip
    is friction.
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
        rows.keep_bearing(
            n, tables.bearings, b, True, Bearing(stiffness, limit, play, weighs, slipped, force)
        )
        add(n, tables.energy, 0, FRICTION, 0.5 * (before + force) * (slipped - slip))
        add(n, tables.bodies, b, rows.first_force(tables.bodies) + X, -force)
        add(n, tables.bodies, b, rows.first_force(tables.bodies) + Z, -weighs * gravity)


@inlined
def forces_of_springs(n, tables, loose, asked):
    """Add the forces of intact interfaces, but in the walls that end; returns whether there are
    others."""
    if asked.damped:
        return forces_of_damped(n, tables, loose, asked.ending)
    return forces_of_undamped(n, tables, loose, asked.ending)


@compiled
def forces_of_undamped(n, tables, loose, ending):
    """`forces_of_intact` without damping, compiled apart: a branch inside would need too many
    registers."""
    if rows.are_alike(n, tables):
        return forces_of_intact(widest(n), tables, loose, ending, False, True)
    return forces_of_intact(widest(n), tables, loose, ending, False, False)


@compiled
def forces_of_damped(n, tables, loose, ending):
    """`forces_of_intact` with damping."""
    if rows.are_alike(n, tables):
        return forces_of_intact(widest(n), tables, loose, ending, True, True)
    return forces_of_intact(widest(n), tables, loose, ending, True, False)


@inlined
def forces_of_intact(n, tables, loose, ending, damped, alike):
    """Add the forces of intact interfaces, but in the walls `ending` (bits); returns whether there
    are others.

    n: Eight, an interface of eight walls, or Rows, eight interfaces of one wall; alike: of
    `damage.mechanics.rows.are_alike`.
    """
    everyone, any_other = (1 << lanes(n)) - 1, 0
    for p in range(0, len(tables.others), rows_of(n)):
        springs = rows.springs_of(n, tables, p, alike)
        frame, motion = moved(n, tables, p)
        intact = interfaces.stays_intact(springs, rows.limits_of(n, tables.limits, p), motion)
        if ending:
            intact = intact & flags_of(n, everyone ^ ending)
        intact = intact & flags_of(n, everyone ^ bits(collisions.may_end(n, loose, motion)))
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
    return interfaces.relative_motion(
        rows.line_of(n, tables, p),
        rows.pose_at(n, tables.bodies, tables.first, p),
        rows.pose_at(n, tables.bodies, tables.second, p),
    )


@compiled
def forces_of_others(n, tables, model, asked, singly):
    """Add the forces of the interfaces that are not intact, if `singly` of all, contact point by
    contact point.

    Once the faces have ceased to overlap, forces are zero from the next step on, permanently.
    """
    for p in range(len(tables.interfaces)):
        here = asked.walls if singly else asked.walls & int(tables.others[p])
        if here:
            gone = bits(load(n, tables.limits, p, HAS_FAILED) >= ENDING) & here
            if gone:
                let_go(n, tables, model, p, gone)
            if here & ~gone:
                forces_by_contacts(n, tables, model, asked, p, here & ~gone)


@inlined
def forces_by_contacts(n, tables, model, asked, p, here):
    """Add the forces of interface p in the walls `here` (bits), evaluated contact point by contact
    point.

    Those that share a RelativeMotion (all between rigid bricks, one between deformable ones) are
    springs while all stay in their elastic range, else the joint law applies.
    """
    interface, strain, lives = tables.interfaces[p], model.strain, flags_of(n, here)
    frame, motion = moved(n, tables, p)
    resultant = Resultant(zero(n), zero(n), zero(n))
    start, size = ROW(interface.start), points_at_once(strain, interface)
    while start < interface.stop:
        points = Points(p, start, start + size, last_row(strain, p, start))
        at_points = motion_at(n, tables.bodies, strain, interface, start, motion)
        of_points = forces_of_points(n, tables, model, asked, points, at_points, here)
        push_modes(n, tables.bodies, strain, interface, start, of_points, lives)
        resultant = interfaces.add(resultant, of_points)
        start += size
    over = ends_now(n, tables, model.loose, asked, p, here, motion)
    to_read = here & (asked.ending | over)
    if to_read:
        for i in range(interface.start, interface.stop):
            at_point = motion_at(n, tables.bodies, strain, interface, i, motion)
            contacts.read(n, tables, i, at_point, flags_of(n, to_read))
    rows.push(
        n, tables.bodies, interface, interfaces.forces_on_bodies(frame, resultant, motion), lives
    )


@inlined
def ends_now(n, tables, loose, asked, p, here, motion):
    """Walls of `here` (bits) in which interface p ends at this RelativeMotion: there it is ENDING.

    A failed one ends as its faces cease to overlap; also as of
    `damage.mechanics.collisions.ends_too`.
    """
    interface = tables.interfaces[p]
    over = bits(load(n, tables.limits, p, HAS_FAILED) == FAILED) & here
    if over:
        over &= bits(
            (motion.shear <= interface.slide_least) | (motion.shear >= interface.slide_most)
        )
    if over == 0 and collisions.ends_too(n, tables, loose, p, asked.clock[0] + asked.step, motion):
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
def let_go(n, tables, model, p, gone):
    """Set the forces of interface p to zero, permanently, in those of the walls `gone` (bits) in
    which it is ENDING; from then on its bodies collide."""
    interface = tables.interfaces[p]
    for w in range(lanes(n)):
        one = wall_of(n, w)
        if gone >> w & 1 and load(one, tables.limits, p, HAS_FAILED) == ENDING:
            before, motion = (
                load(one, tables.energy, 0, FRICTION),
                of_wall(moved(n, tables, p)[1], w),
            )
            for i in range(interface.start, interface.stop):
                at_point = motion_at(one, tables.bodies, model.strain, interface, i, motion)
                contacts.let_go(one, tables, i, at_point)
                tables.used[i] = 1
            fail(n, tables, p, w, ENDED)
            stored = load(one, tables.energy, 0, FRICTION) - before
            collisions.hand_over(n, tables, model.loose, interface, stored)


@inlined
def last_row(strain, p, start):
    """Row of `last` of interface p, or of its contact where bricks deform."""
    return p if strain is None else np.int64(start)


@inlined
def forces_of_points(n, tables, model, asked, points, motion, here):
    """Resultant of Points of an interface that have a RelativeMotion [N, N m], in the walls `here`
    (bits)."""
    p, damped, lives = points.p, asked.damped, flags_of(n, here)
    simple = is_known_intact(tables, model.strain, points.start)
    if simple:
        resultant, elastic = contacts.intact_resultant(n, tables, points.start, motion, lives)
    else:
        resultant, elastic = contacts.elastic_resultant(n, tables, points, motion, lives)
    beyond = here & ~bits(elastic)
    if beyond:
        springs = rows.springs_of(n, tables, p, rows.are_alike(n, tables))
        limits = rows.limits_of(n, tables.limits, p)
        beyond &= ~bits(interfaces.stays_intact(springs, limits, motion))
    if not simple:
        contacts.remember(n, tables, points, motion, flags_of(n, here & ~beyond))
    changed = resultant
    if damped:
        changed = interfaces.change(resultant, rows.last_resultant(n, tables.last, points.row))
    if beyond:
        resultant, changed = by_law(
            n, tables, model, asked, points, motion, beyond, (resultant, changed)
        )
    if damped:
        resultant = damp(n, tables, points.row, motion, resultant, changed, lives)
    return resultant


@inlined
def is_known_intact(tables, strain, i):
    """Whether contact point i between deformable bricks is marked as an intact spring in all
    walls."""
    if strain is None:
        return False
    return tables.used[i] == 0


@inlined
def by_law(n, tables, model, asked, points, motion, beyond, elastic):
    """Resultant of Points, and its change since the last step, by the joint law in the walls
    `beyond` (bits), in the others as `elastic`."""
    resultant, changed = elastic
    for w in range(lanes(n)):
        if beyond >> w & 1:
            one, now, step = wall_of(n, w), of_wall(motion, w), asked.clock[w] + asked.step
            before = motion_before(one, tables, model.strain, points, now, asked.damped)
            of_points, change, failed = contacts.law_resultant(
                one, tables, model.threshold, points, step, now, before, asked.damped
            )
            resultant, changed = with_wall(resultant, w, of_points), with_wall(changed, w, change)
            if failed:
                fail(n, tables, points.p, w, FAILED)
                tables.used[points.start] = 1
    return resultant, changed


@inlined
def of_wall(motion, w):
    """RelativeMotion of wall w."""
    return RelativeMotion(lane(motion.opening, w), lane(motion.shear, w), lane(motion.rotation, w))


@inlined
def with_wall(resultant, w, of_wall):
    """Resultant with that of wall w replaced."""
    return Resultant(
        with_lane(resultant.normal, w, of_wall.normal),
        with_lane(resultant.shear, w, of_wall.shear),
        with_lane(resultant.couple, w, of_wall.couple),
    )


@inlined
def motion_before(n, tables, strain, points, motion, damped):
    """RelativeMotion of Points of one wall in the last step, stored where the wall damps, else by
    velocities; the present one between deformable bricks."""
    if damped and (rows.bench_of(n, tables.bench, 0).rate > 0.0 or tables.radiates):
        return rows.last_motion(n, tables.last, points.row)
    if strain is not None:
        return motion
    interface = tables.interfaces[points.p]
    return interfaces.relative_motion(
        rows.line_of(n, tables, points.p),
        pose_before(n, tables, interface.a),
        pose_before(n, tables, interface.b),
    )[1]


@compiled
def pose_before(n, tables, b):
    """Pose of body b of one wall in the last step."""
    places, inertia, dt = tables.bodies, tables.inertia, rows.bench_of(n, tables.bench, 0).step
    angle = rows.place_of(n, places, b, ROTATION) - dt * rows.velocity_of(n, inertia, b, ROTATION)
    cos1, sine = small_rotation(angle) if abs(angle) < SMALL else (cos(angle) - 1.0, sin(angle))
    return Pose(
        rows.place_of(n, places, b, X) - dt * rows.velocity_of(n, inertia, b, X),
        rows.place_of(n, places, b, Z) - dt * rows.velocity_of(n, inertia, b, Z),
        cos1,
        sine,
    )


# --- damping of interfaces ------------------------------------------------------------------------


@inlined
def damp(n, tables, row, motion, resultant, changed, which):
    """Resultant with stiffness-proportional damping and dashpots [N, N m]; stores motion and
    elastic resultant for the next step, and adds up the work, in the walls `which` (flags).

    changed: change of the elastic resultant since the last step.
    """
    before = rows.last_motion(n, tables.last, row)
    rows.keep_motion(n, tables.last, row, which, motion)
    rows.keep_resultant(n, tables.last, row, which, resultant)
    bench = rows.bench_of(table_width(n), tables.bench, 0)
    viscous, work = interfaces.add_viscous(bench.rate, motion, before, resultant, changed)
    if tables.radiates:
        viscous, of_dashpots, more = interfaces.add_dashpots(
            rows.dashpots_of(n, tables.radiation, row),
            rows.dashpots_last(n, tables.radiation, row),
            bench.step,
            motion,
            before,
            viscous,
            changed,
        )
        rows.keep_dashpots(n, tables.radiation, row, which, of_dashpots)
        work = work + more
    add_part(n, tables.sums, DAMPED, row, either(which, work, 0.0))
    return viscous


@compiled
def remember_last(n, tables, strain, which):
    """Store present motions and resultants of all interfaces, for stiffness-proportional damping in
    the next step, in the walls `which` (bits)."""
    asked = flags_of(n, which)
    for p in range(len(tables.interfaces)):
        interface, motion = tables.interfaces[p], moved(n, tables, p)[1]
        start, size = ROW(interface.start), points_at_once(strain, interface)
        while start < interface.stop:
            points = Points(p, start, start + size, last_row(strain, p, start))
            here = motion_at(n, tables.bodies, strain, interface, start, motion)
            rows.keep_motion(n, tables.last, points.row, asked, here)
            rows.keep_resultant(
                n,
                tables.last,
                points.row,
                asked,
                contacts.present_resultant(n, tables, points, here),
            )
            start += size


# --- strain modes of deformable bricks ------------------------------------------------------------
# Mode m of a body is its coordinate RIGID + m.  Its generalized force is the work of the contact
# forces on the opening and shear displacement by a unit of the mode.  Its mass, stiffness, damping
# and shape are equal in all walls that step together.  Theory: `damage.wall.strain`.


@inlined
def deforms(strain):
    """Whether bricks deform."""
    return strain is not None


@inlined
def points_at_once(strain, interface):
    """Number of contact points that share a RelativeMotion: all of an interface between rigid
    bricks, else one."""
    if strain is None:
        return ROW(interface.stop - interface.start)
    return ROW(1)


@inlined
def motion_at(n, bodies, strain, interface, i, motion):
    """RelativeMotion at contact i: that of the interface plus the displacements by the strain modes
    of both bricks."""
    if strain is None:
        return motion
    a, b, at_a, at_b, shapes = (
        interface.a,
        interface.b,
        strain.rows[i, 0],
        strain.rows[i, 1],
        strain.shapes,
    )
    opening, shear = zero(n), zero(n)
    for m in range(shapes.shape[2]):
        qa, qb = rows.place_of(n, bodies, a, RIGID + m), rows.place_of(n, bodies, b, RIGID + m)
        opening = opening + (shapes[at_b, 0, m] * qb - shapes[at_a, 0, m] * qa)
        shear = shear + (shapes[at_b, 1, m] * qb - shapes[at_a, 1, m] * qa)
    return RelativeMotion(motion.opening + opening, motion.shear + shear, motion.rotation)


@inlined
def push_modes(n, bodies, strain, interface, i, resultant, which):
    """Add a contact's Resultant to the generalized forces of both bricks' modes, in the walls
    `which` (flags)."""
    if strain is None:
        return
    a, b, at_a, at_b, shapes = (
        interface.a,
        interface.b,
        strain.rows[i, 0],
        strain.rows[i, 1],
        strain.shapes,
    )
    normal, shear = either(which, resultant.normal, 0.0), either(which, resultant.shear, 0.0)
    for m in range(shapes.shape[2]):
        k = rows.first_force(bodies) + RIGID + m
        add(n, bodies, a, k, normal * shapes[at_a, 0, m] + shear * shapes[at_a, 1, m])
        add(n, bodies, b, k, -(normal * shapes[at_b, 0, m] + shear * shapes[at_b, 1, m]))
