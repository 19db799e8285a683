"""The compiled time step of the reference solver: rigid blocks, contact points, central differences.

Units are SI.  Bodies move by (u_x, u_z, rotation x towards z) since the wall was built, in the frame
of the base; the last body is the ground and never moves.

A step is: `integrate` (bodies.py); `all_forces`, which asks for the relative motion of all pairs and what they do as
one spring each (pairs.py), eight at a time (blocks.py), and then does those that are not whole, contact by contact
(contacts.py, contacts_in_lanes.py), whose stresses are read after the last step.  It is one wall's, or that of up to
eight walls side by side, its lanes, which share the bricks and the stiffnesses of the joints; a wall's bits are the
same either way, as each of its numbers is made by the same operations in the same order.
"""

from typing import NamedTuple

import numpy as np

from damage.reference import blocks as at
from damage.reference.blocks import INDEX, NONE, ONE, WIDTH, pack, place_of, unpack
from damage.reference.bodies import adapt, clear, integrate, total
from damage.reference.compiled import compiled, inlined
from damage.reference.contacts import joint_forces, read_joints, remember, springs, sum_of_stresses
from damage.reference.contacts_in_lanes import (
    fasten,
    forces_of_loose,
    give_pair,
    loosen,
    push_waiting,
    read_whole_joints,
    take_pair,
    whole_springs,
)
from damage.reference.eight import add, bits, load, spread, store
from damage.reference.instants import observe
from damage.reference.pairs import (
    Place,
    damp,
    damp_eight,
    eight_pairs,
    keep_last,
    last_forces,
    last_gap,
    less,
    line_of,
    lines_of,
    place_of_body,
    places_in_lanes,
    push,
    push_lanes,
    push_where,
    relative_motion,
    spring_of,
    springs_of,
    stays_whole,
)
from damage.reference.rows import add_rows, rows_of, set_rows
from damage.reference.tables import DAMPING
from damage.wall.joint_law import Material

FORCES = INDEX(4)
"""Where the forces of a body begin in its row, after its place."""


class Law(NamedTuple):
    """material: of the joint law; threshold [m] of first passings; plain: whether no contact softens or crushes."""

    material: Material
    threshold: float
    plain: bool


@compiled
def run_steps(tables, blocks, lanes, law, controls, field, clock, ends, springs, samples):
    """Advance from places whose forces are known to each of these ends, where they are known again, contact by contact,
    and what is told of the walls is written.

    lanes: 1, or 8, of which the first have a row in the tables; controls: (rows, 5) time step [s], local damping [-],
    alpha [1/s], beta [s], adaptive damping [-]; field: (rows, steps + 1, 3) acceleration of the base along x and z and
    gravity, of each step and the one after them [m/s2]; clock: (rows,) steps that came before; ends: steps from here to
    each; springs, samples: as of `instants`, a sample an end.  Call `find_forces` once before the first run: out of
    numba's cache, runs then use its own machine code instead of a slower copy that is part of this function.
    """
    pack(tables, blocks, lanes)
    damped = adaptive = False
    for lane in range(controls.shape[0]):
        damped |= controls[lane, 3] > 0.0
        adaptive |= controls[lane, 4] > 0.0
    step = 0
    for k in range(len(ends)):
        if damped:
            remember_all(tables, blocks, lanes)
        if lanes > 1:
            loosen(tables, blocks)
        while step < ends[k]:
            if lanes > 1 and step == ends[k] - 1:
                fasten(tables, blocks)
            integrate(tables, blocks, lanes, controls, field, step)
            if adaptive:
                adapt(tables, blocks, lanes, controls)
            step += 1
            all_forces(tables, blocks, lanes, law, clock, step, step == ends[k], damped)
        unpack(tables, blocks, lanes)
        observe_all(tables, controls, field, step, springs, samples, k)


@compiled
def observe_all(tables, controls, field, step, springs, samples, k):
    """Write sample k of all walls, of the instant at which this step begins."""
    for lane in range(controls.shape[0]):
        observe(tables, lane, springs, field[lane, step, 0], field[lane, step, 1] + field[lane, step, 2],
                controls[lane, 0], samples, lane, k)


@compiled
def find_forces(tables, blocks, lanes, law, clock, step, singly, damped):
    """Forces [N, N m] on every body at the present places; calling it twice changes nothing.  As `all_forces`, with
    step 0 and not damped: constants from within would have each compiled once more."""
    pack(tables, blocks, lanes)
    blocks.loose[:] = 0
    clear_forces(blocks.bodies)
    all_forces(tables, blocks, lanes, law, clock, step, singly, damped)
    unpack(tables, blocks, lanes)


@compiled
def all_forces(tables, blocks, lanes, law, clock, step, singly, damped):
    """Forces of the contacts on all bodies, into the blocks, where they are zero.

    singly: no pair as one spring, so that forces are the sums of the stresses of its contacts, to the last bit; these
    are written then, too.
    """
    clear(blocks.sums, at.DAMPED, at.KINETIC)
    if lanes == 1:
        places_to_rows(blocks)
    if not singly:
        if lanes == 1:
            forces_of_one(blocks, damped)
        else:
            forces_of_lanes(tables, blocks, law, damped)
    forces_of_others(tables, blocks, lanes, law, clock, step, singly, damped)
    if lanes == 1:
        forces_from_rows(blocks)
    if damped:
        for lane in range(tables.energy.shape[0]):
            tables.energy[lane, DAMPING] += total(blocks.sums, at.DAMPED, lane, lanes)


@compiled
def clear_forces(bodies):
    """Zero forces [N] and moments [N m] of all bodies."""
    k = at.FX
    while k < INDEX(len(bodies)):
        for i in range(24):
            bodies[k + INDEX(i)] = 0.0
        k += at.BODY


@compiled
def forces_of_one(blocks, damped):
    """Forces of the pairs of one wall that are whole: eight pairs are a block."""
    pairs, rows, bench, limits, last = blocks.pairs, blocks.rows, blocks.bench, blocks.limits, blocks.last
    first, second, sums = blocks.first, blocks.second, blocks.sums
    block = NONE
    while block < INDEX(len(blocks.broken)):
        row, p = block * WIDTH, block * at.PAIR
        a, b = Place(*rows_of(rows, first, row, NONE)), Place(*rows_of(rows, second, row, NONE))
        frame, gap, forces, whole = eight_pairs(lines_of(pairs, p), springs_of(pairs, p), a, b, limits,
                                                block * at.LIMITS)
        if damped:
            forces, work = damp_eight(last, block * at.LAST, load(bench, at.RATE), gap, forces, whole)
            add(sums, at.DAMPED, work)
        blocks.broken[block] = 255 - bits(whole)
        pushed = push_where(whole, frame, forces)
        add_rows(rows, first, second, row, FORCES, (pushed.x, pushed.z, pushed.moment_a),
                 (-pushed.x, -pushed.z, -pushed.moment_b))
        block += ONE


@compiled
def forces_of_lanes(tables, blocks, law, damped):
    """Forces of the pairs of several walls that are whole: a pair in eight lanes is a block; and what those do that are
    broken, where they stay springs, for `forces_of_others`."""
    pairs, bodies, bench, limits, last = blocks.pairs, blocks.bodies, blocks.bench, blocks.limits, blocks.last
    first, second, sums = blocks.first, blocks.second, blocks.sums
    row = NONE
    while row < INDEX(len(blocks.broken)):
        a, b, p = first[row], second[row], place_of(row, at.PAIR)
        frame, gap, forces, whole = eight_pairs(line_of(pairs, p), spring_of(pairs, p), places_in_lanes(bodies, a),
                                                places_in_lanes(bodies, b), limits, row * at.LIMITS)
        if damped:
            forces, work = damp_eight(last, row * at.LAST, load(bench, at.RATE), gap, forces, whole)
            add(sums, at.DAMPED + row % WIDTH * WIDTH, work)
        blocks.broken[row] = broken = 255 - bits(whole)
        push_lanes(bodies, a, b, push_where(whole, frame, forces))
        held = broken & blocks.loose[row]
        if held:
            forces_of_loose(tables, blocks, law, row, held, frame, gap, damped)
        row += ONE


@compiled
def forces_of_others(tables, blocks, lanes, law, clock, step, singly, damped):
    """Forces of the pairs that are not whole, contact by contact: after the others, in the same order whether a wall is
    alone or among others.  If `singly`, of all pairs, none of which are done yet."""
    for block in range(len(blocks.broken)):
        flags = 255 if singly else int(blocks.broken[block])
        if flags == 0:
            continue
        if lanes > 1:
            flags = flags & ~(whole_singly(tables, blocks, block, damped) if singly else
                              push_waiting(blocks, block, flags, damped))
        k = 0
        while flags:  # hardly ever of a pair in lanes
            p, lane = (8 * block + k, 0) if lanes == 1 else (block, k)
            if flags & 1 and p < tables.pairs.shape[1] and lane < tables.pairs.shape[0]:
                forces_of_pair(tables, blocks, lanes, law, clock[lane] + step, lane, p, singly, damped)
            flags, k = flags >> 1, k + 1


@compiled
def whole_singly(tables, blocks, p, damped):
    """Forces of a pair contact by contact in the lanes where it is whole, which are returned (bits), and what its
    contacts do."""
    a, b, k = blocks.first[p], blocks.second[p], place_of(INDEX(p), at.PAIR)
    start, stop = tables.pairs[0, p].start, tables.pairs[0, p].stop
    frame, gap, _, whole = eight_pairs(line_of(blocks.pairs, k), spring_of(blocks.pairs, k),
                                       places_in_lanes(blocks.bodies, a), places_in_lanes(blocks.bodies, b),
                                       blocks.limits, INDEX(p) * at.LIMITS)
    forces = whole_springs(tables.contacts, start, stop, gap)
    read_whole_joints(tables, blocks.bench, start, stop, gap, int(bits(whole)))
    if damped:
        forces, work = damp_eight(blocks.last, INDEX(p) * at.LAST, load(blocks.bench, at.RATE), gap, forces, whole)
        add(blocks.sums, at.DAMPED + INDEX(p % 8 * 8), work)
    push_lanes(blocks.bodies, a, b, push_where(whole, frame, forces))
    return int(bits(whole))


@inlined
def forces_of_pair(tables, blocks, lanes, law, step, lane, p, singly, damped):
    """Forces of one pair contact by contact; `singly` writes what they do, too."""
    (bodies, apart), contacts, slot = bodies_of(blocks, lanes), tables.contacts, INDEX(p * lanes + lane)
    last, limits, m = blocks.last, blocks.limits, place_of(slot, at.LAST)
    start, stop = tables.pairs[0, p].start, tables.pairs[0, p].stop  # of all lanes: fewer to fetch from memory
    a, b, k = blocks.first[p] + INDEX(lane), blocks.second[p] + INDEX(lane), place_of(INDEX(p), at.PAIR)
    frame, gap = relative_motion(line_of(blocks.pairs, k), place_of_body(bodies, a, apart),
                                 place_of_body(bodies, b, apart))
    held, whole = place_of(slot, at.LIMITS), False
    if singly:
        whole = stays_whole(spring_of(blocks.pairs, k), limits[held + at.OPENING], limits[held + at.SLIDE], gap)
    loose = lanes > 1 and not singly
    if loose and blocks.loose[p] >> lane & 1:
        give_pair(tables, blocks, lane, p)
    forces, elastic = springs(contacts, lane, start, stop, gap, law.material)
    steady = less(forces, last_forces(last, m))
    if elastic or whole:
        remember(contacts, lane, start, stop, gap)
    else:
        forces, steady, failed = joint_forces(tables, law, lane, p, step, gap, last_gap(last, m), damped)
        if failed:
            tables.pairs[lane, p].broken = 1
            limits[held + at.OPENING] = -np.inf
    if loose and tables.pairs[lane, p].broken:
        take_pair(tables, blocks, lane, p)
    if singly:
        read_joints(contacts, tables.joints, tables.readings, lane, start, stop, gap)
    if damped:
        with_damping, work = damp(blocks.bench[at.RATE + INDEX(lane)], gap, last_gap(last, m), forces, steady)
        keep_last(last, m, gap, forces)
        blocks.sums[at.DAMPED + INDEX(p % 8 * lanes + lane)] += work
        forces = with_damping
    push_pair(bodies, a, b, apart, push(frame, forces))


@inlined
def bodies_of(blocks, lanes):
    """Where single pairs find the fields of their bodies, and how far these are apart."""
    if lanes == 1:
        return blocks.rows, ONE
    return blocks.bodies, WIDTH


@inlined
def push_pair(bodies, a, b, apart, pushed):
    """Add what one pair does to its bodies, whose fields are so far apart."""
    half = apart + apart
    half += half  # forces come after the four of a Place
    a += half
    b += half
    bodies[a] += pushed.x
    bodies[a + apart] += pushed.z
    bodies[a + apart + apart] += pushed.moment_a
    bodies[b] -= pushed.x
    bodies[b + apart] -= pushed.z
    bodies[b + apart + apart] -= pushed.moment_b


@compiled
def places_to_rows(blocks):
    """Copy the places of one wall's bodies into its rows, and set their forces to zero."""
    bodies, rows, starts, block = blocks.bodies, blocks.rows, blocks.starts, NONE
    while block * WIDTH < INDEX(len(starts)):
        place, zero = places_in_lanes(bodies, block * at.BODY), spread(0.0)
        set_rows(rows, starts, block * WIDTH, NONE, place.x, place.z, place.cos1, place.sin)
        set_rows(rows, starts, block * WIDTH, FORCES, zero, zero, zero, zero)
        block += ONE


@compiled
def forces_from_rows(blocks):
    """Copy the forces on one wall's bodies from its rows."""
    bodies, block = blocks.bodies, NONE
    while block * WIDTH < INDEX(len(blocks.starts)):
        k = block * at.BODY
        fx, fz, moment, _ = rows_of(blocks.rows, blocks.starts, block * WIDTH, FORCES)
        store(bodies, k + at.FX, fx)
        store(bodies, k + at.FZ, fz)
        store(bodies, k + at.MOMENT, moment)
        block += ONE


@compiled
def remember_all(tables, blocks, lanes):
    """What damping proportional to stiffness compares the next step with, of the present places."""
    if lanes == 1:
        places_to_rows(blocks)
    bodies, apart = bodies_of(blocks, lanes)
    for lane in range(tables.pairs.shape[0]):
        for p in range(tables.pairs.shape[1]):
            pair, here = tables.pairs[lane, p], INDEX(lane)
            _, gap = relative_motion(line_of(blocks.pairs, place_of(INDEX(p), at.PAIR)),
                                     place_of_body(bodies, blocks.first[p] + here, apart),
                                     place_of_body(bodies, blocks.second[p] + here, apart))
            keep_last(blocks.last, place_of(INDEX(p * lanes + lane), at.LAST), gap,
                      sum_of_stresses(tables.contacts, lane, pair.start, pair.stop, gap))
