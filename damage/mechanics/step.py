"""The time step: move the bodies, evaluate every interface, sum the forces.

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
from damage.mechanics import (
    contacts,
    damping,
    devices,
    interfaces,
    rows,
    strain_modes,
)
from damage.mechanics.bodies import SMALL, adapt, move_all, set_bench, small_rotation, total
from damage.mechanics.compiled import compiled, entry, inlined
from damage.mechanics.contacts import Points, confine
from damage.mechanics.interfaces import Pose, RelativeMotion, Resultant
from damage.mechanics.samples import observe
from damage.mechanics.scaling import move_scaled
from damage.mechanics.simd import (
    argument,
    bits,
    flags_of,
    lane,
    lanes,
    load,
    rows_of,
    store,
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
    HAS_FAILED,
    INPUT,
    KINETIC,
    LARGEST_OPENING,
    ROTATION,
    ROW,
    STEP,
    SWEPT_X,
    SWEPT_Z,
    TAKEN,
    TIME_STEP,
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

    tables, model: Tables and Model; controls: (walls, 6) of `damage.mechanics.tables.TIME_STEP` to
    FOLLOW; field: (walls, steps + 1, 3) acceleration of the base along x and z and gravity, in
    each step and the one after the last [m/s2]; clock: (walls,) numbers of steps before; begin:
    walls (bits) that do not go on from within a call; stops: (stops, 2) rising numbers of steps
    from now, and the walls (bits) of which a sample is written there; sampling: Sampling.
    """
    damped = controls[:, BETA].any()
    walls = (1 << len(controls)) - 1
    holds = tables.turning[:, :2].any()
    # of no literal type, for which numba would compile all of it once more
    step = k = stops[0, 0] * 0
    mark_used(n, tables, model.strain, walls)
    if damped:
        damping.remember_last(n, tables, model.strain, begin)
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
                damping.remember_last(n, tables, model.strain, ending)
            k += 1


@inlined
def step_once(n, tables, model, controls, field, asked):
    """Move all bodies by a step, and find the forces at the places where they are then."""
    move(n, tables, model.strain, model.matrix, controls, field, asked.step - 1)
    if controls[:, ADAPTIVE].any():
        adapt(n, tables, model.strain, controls)
    # without the matrix, so that the code of forces is the same with mass scaling and without
    of_forces = Model(model.threshold, model.strain, None, model.cuts)
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
    """Add the forces of all interfaces to those of the bodies, which are zero on entry, or are made
    so where nothing has moved; tables, model, asked: Tables, Model, Asked.

    Intact interfaces come first, each by its resultant springs, then the others contact point by
    contact point.
    """
    if asked.since == 0.0:
        tables.bodies[:, rows.first_force(tables.bodies) :] = 0.0
        tables.bench[0, STEP] = 0.0
        mark_used(n, tables, model.strain, asked.walls)
    tables.sums[DAMPED] = 0.0
    singly = asked.ending == asked.walls or strain_modes.deforms(model.strain)
    if singly or forces_of_springs(n, tables, asked):
        forces_of_others(n, tables, model, asked, singly)
    if asked.holds:
        devices.hold_rotations(n, tables)
    if len(tables.bearings) > 0:
        devices.hold_top(n, tables)
    if asked.holds and asked.since > 0.0:
        devices.spread(n, tables)
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
def forces_of_springs(n, tables, asked):
    """Add the forces of intact interfaces, but in the walls that end; returns whether there are
    others."""
    if asked.damped:
        return forces_of_damped(n, tables, asked.ending)
    return forces_of_undamped(n, tables, asked.ending)


@compiled
def forces_of_undamped(n, tables, ending):
    """`forces_of_intact` without damping, compiled apart: a branch inside would need too many
    registers."""
    if rows.are_alike(n, tables):
        return forces_of_intact(widest(n), tables, ending, False, True)
    return forces_of_intact(widest(n), tables, ending, False, False)


@compiled
def forces_of_damped(n, tables, ending):
    """`forces_of_intact` with damping."""
    if rows.are_alike(n, tables):
        return forces_of_intact(widest(n), tables, ending, True, True)
    return forces_of_intact(widest(n), tables, ending, True, False)


@inlined
def forces_of_intact(n, tables, ending, damped, alike):
    """Add the forces of intact interfaces, but in the walls `ending` (bits); returns whether there
    are others.

    n: Eight, an interface of eight walls, or Rows, eight interfaces of one wall; alike: of
    `damage.mechanics.rows.are_alike`.
    """
    everyone = (1 << lanes(n)) - 1
    any_other = 0
    for p in range(0, len(tables.others), rows_of(n)):
        springs = rows.springs_of(n, tables, p, alike)
        frame, motion = rows.moved(n, tables, p)
        intact = interfaces.stays_intact(springs, rows.limits_of(n, tables.limits, p), motion)
        if ending:
            intact = intact & flags_of(n, everyone ^ ending)
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
            resultant = damping.damp(n, tables, p, motion, resultant, changed, intact)
        forces = interfaces.forces_on_bodies(frame, resultant, motion)
        rows.push_at(n, tables.bodies, tables.first, tables.second, p, forces, intact)
    return any_other


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
    interface = tables.interfaces[p]
    strain = model.strain
    lives = flags_of(n, here)
    frame, motion = rows.moved(n, tables, p)
    resultant = Resultant(zero(n), zero(n), zero(n))
    start = ROW(interface.start)
    size = strain_modes.points_at_once(strain, interface)
    while start < interface.stop:
        points = Points(p, start, start + size, strain_modes.last_row(strain, p, start))
        at_points = strain_modes.motion_at(n, tables.bodies, strain, interface, start, motion)
        of_points = forces_of_points(n, tables, model, asked, points, at_points, here)
        strain_modes.push_modes(n, tables.bodies, strain, interface, start, of_points, lives)
        resultant = interfaces.add(resultant, of_points)
        start += size
    over = ends_now(n, tables, p, here, motion)
    to_read = here & (asked.ending | over)
    if to_read:
        for i in range(interface.start, interface.stop):
            at_point = strain_modes.motion_at(n, tables.bodies, strain, interface, i, motion)
            contacts.read(n, tables, i, at_point, flags_of(n, to_read))
    rows.push(
        n, tables.bodies, interface, interfaces.forces_on_bodies(frame, resultant, motion), lives
    )


@inlined
def ends_now(n, tables, p, here, motion):
    """Walls of `here` (bits) in which interface p, which has failed, ends at this RelativeMotion,
    as its faces cease to overlap: there it is ENDING."""
    interface = tables.interfaces[p]
    over = bits(load(n, tables.limits, p, HAS_FAILED) == FAILED) & here
    if over:
        over &= bits(
            (motion.shear <= interface.slide_least) | (motion.shear >= interface.slide_most)
        )
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
    which it is ENDING."""
    interface = tables.interfaces[p]
    for w in range(lanes(n)):
        wall = wall_of(n, w)
        if gone >> w & 1 and load(wall, tables.limits, p, HAS_FAILED) == ENDING:
            motion = of_wall(rows.moved(n, tables, p)[1], w)
            for i in range(interface.start, interface.stop):
                at_point = strain_modes.motion_at(
                    wall, tables.bodies, model.strain, interface, i, motion
                )
                contacts.let_go(wall, tables, i, at_point)
                tables.used[i] = 1
            fail(n, tables, p, w, ENDED)


@inlined
def forces_of_points(n, tables, model, asked, points, motion, here):
    """Resultant of Points of an interface that have a RelativeMotion [N, N m], in the walls `here`
    (bits)."""
    p = points.p
    damped = asked.damped
    lives = flags_of(n, here)
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
        resultant = damping.damp(n, tables, points.row, motion, resultant, changed, lives)
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
            wall = wall_of(n, w)
            now = of_wall(motion, w)
            step = asked.clock[w] + asked.step
            before = motion_before(wall, tables, model.strain, points, now, asked.damped)
            of_points, change, failed = contacts.law_resultant(
                wall, tables, model.threshold, points, step, now, before, asked.damped
            )
            resultant = with_wall(resultant, w, of_points)
            changed = with_wall(changed, w, change)
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
    if damped and rows.bench_of(n, tables.bench, 0).rate > 0.0:
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
    places = tables.bodies
    inertia = tables.inertia
    dt = rows.bench_of(n, tables.bench, 0).step
    angle = rows.place_of(n, places, b, ROTATION) - dt * rows.velocity_of(n, inertia, b, ROTATION)
    cos1, sine = small_rotation(angle) if abs(angle) < SMALL else (cos(angle) - 1.0, sin(angle))
    return Pose(
        rows.place_of(n, places, b, X) - dt * rows.velocity_of(n, inertia, b, X),
        rows.place_of(n, places, b, Z) - dt * rows.velocity_of(n, inertia, b, Z),
        cos1,
        sine,
    )
