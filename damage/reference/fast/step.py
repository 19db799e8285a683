"""The fast step: what `damage.mechanics.step` does, of one wall or of up to eight side by side, to the same bits.

Walls that step together share the bricks and the stiffnesses of the joints.  A step moves all bodies; evaluates all
interfaces as one spring each, eight at a time; and evaluates those that do not stay intact contact by contact.
"""

from typing import NamedTuple

import numpy as np

from damage.mechanics import contacts as singly
from damage.mechanics import interfaces
from damage.mechanics.compiled import compiled, inlined
from damage.mechanics.eight import add, bits, load, spread, store
from damage.mechanics.samples import observe
from damage.mechanics.tables import DAMPING, FAILED, System
from damage.reference.fast import blocks as at
from damage.reference.fast.blocks import INDEX, NONE, ONE, WIDTH, pack, place_of, unpack
from damage.reference.fast.bodies import adapt, clear, move, total
from damage.reference.fast.contacts import (
    fasten,
    forces_of_loose,
    give,
    intact_springs,
    loosen,
    push_waiting,
    read_intact,
    take,
)
from damage.reference.fast.interfaces import (
    damp_eight,
    evaluate,
    forces_where,
    keep_last,
    last_motion,
    last_resultant,
    line_of,
    lines_of,
    pose_of,
    poses_in_lanes,
    push_in_lanes,
    push_one,
    springs_of,
    springs_of_eight,
)
from damage.reference.fast.rows import add_rows, rows_of, set_rows
from damage.wall.joint_law import Material

FORCES = INDEX(4)
"""Where the forces of a body begin in its row, after its pose."""


class Law(NamedTuple):
    """material: of the joint law; threshold [m] of events; plain: whether no contact softens or crushes."""

    material: Material
    threshold: float
    plain: bool


@inlined
def wall_of(tables, w):
    """The tables of one wall."""
    return System(tables.place[w], tables.velocity[w], tables.force[w], tables.mass[w], tables.inverse_mass[w],
                  tables.trig[w], tables.interfaces[w], tables.contacts[w], tables.states[w], tables.readings[w],
                  tables.energy[w], tables.events[w], tables.values[w], tables.n_events[w], tables.relaxation[w],
                  tables.last[w])


@compiled
def run(tables, columns, blocks, lanes, law, controls, field, clock, ends, stiffness, samples):
    """Advance from places whose forces are known to each of these ends, where forces and readings are known again and a
    sample of every wall is written.

    columns: the states of the tables as numbers (walls, contacts, fields); lanes: 1, or 8, of which the first have a
    wall in the tables; controls: (walls, 5) as of `damage.mechanics.step.Controls`; field: (walls, steps + 1, 3)
    acceleration of the base along x and z and gravity, of each step and the one after them [m/s2]; clock: (walls,)
    steps that came before; ends: steps from here to each; stiffness, samples: as of `damage.mechanics.samples`.  Call
    `find_forces` once before the first run: out of numba's cache, runs then use its own machine code instead of a
    slower copy that is part of this function.
    """
    pack(tables, blocks, lanes)
    damped = adaptive = False
    for w in range(controls.shape[0]):
        damped |= controls[w, 3] > 0.0
        adaptive |= controls[w, 4] > 0.0
    step = 0
    for k in range(len(ends)):
        if damped:
            remember_last(tables, blocks, lanes)
        if lanes > 1:
            loosen(tables, columns, blocks)
        while step < ends[k]:
            if lanes > 1 and step == ends[k] - 1:
                fasten(tables, columns, blocks)
            move(tables.energy, tables.relaxation, blocks, lanes, controls, field, step)
            if adaptive:
                adapt(tables.relaxation, blocks, lanes, controls)
            step += 1
            all_forces(tables, columns, blocks, lanes, law, clock, step, step == ends[k], damped)
        unpack(tables, blocks, lanes)
        observe_all(tables, controls, field, step, stiffness, samples, k)


@compiled
def observe_all(tables, controls, field, step, stiffness, samples, k):
    """Write sample k of all walls, of the instant at which this step begins."""
    for w in range(controls.shape[0]):
        observe(wall_of(tables, w), stiffness, field[w, step], controls[w, 0], samples, w, k)


@compiled
def find_forces(tables, columns, blocks, lanes, law, clock, step, at_end, damped):
    """Forces [N, N m] on every body at the present places; calling it twice changes nothing.  As `all_forces`, with
    step 0 and not damped: constants from within would have each compiled once more."""
    pack(tables, blocks, lanes)
    blocks.loose[:] = 0
    clear_forces(blocks.bodies)
    all_forces(tables, columns, blocks, lanes, law, clock, step, at_end, damped)
    unpack(tables, blocks, lanes)


@compiled
def clear_forces(bodies):
    """Zero forces [N] and moments [N m] of all bodies."""
    k = at.FX
    while k < INDEX(len(bodies)):
        for i in range(24):
            bodies[k + INDEX(i)] = 0.0
        k += at.BODY


@inlined
def all_forces(tables, columns, blocks, lanes, law, clock, step, at_end, damped):
    """Forces of the contacts on all bodies, into the blocks, where they are zero; at_end: as `singly` of
    `damage.mechanics.step.find_forces`."""
    clear(blocks.sums, at.DAMPED, at.KINETIC)
    if lanes == 1:
        poses_to_rows(blocks)
    others = at_end
    if not at_end:
        others = forces_of_one(blocks, damped) if lanes == 1 else forces_of_lanes(tables, blocks, law, damped)
    if others:
        forces_of_others(tables, columns, blocks, lanes, law, clock, step, at_end, damped)
    if lanes == 1:
        forces_from_rows(blocks)
    if damped:
        for w in range(tables.energy.shape[0]):
            tables.energy[w, DAMPING] += total(blocks.sums, at.DAMPED, w, lanes)


@compiled
def forces_of_one(blocks, damped):
    """Forces of the intact interfaces of one wall: eight of them are a block.  Returns whether there are others."""
    rows, first, second, any_other = blocks.rows, blocks.first, blocks.second, False
    block = NONE
    while block < INDEX(len(blocks.others)):
        row, p = block * WIDTH, block * at.INTERFACE
        a, b = interfaces.Pose(*rows_of(rows, first, row, NONE)), interfaces.Pose(*rows_of(rows, second, row, NONE))
        frame, motion, resultant, intact = evaluate(
            lines_of(blocks.interfaces, p), springs_of_eight(blocks.interfaces, p), a, b, blocks.limits,
            block * at.LIMITS)
        if damped:
            resultant, work = damp_eight(blocks.last, block * at.LAST, load(blocks.bench, at.RATE), motion, resultant,
                                         intact)
            add(blocks.sums, at.DAMPED, work)
        blocks.others[block] = others = 255 - bits(intact)
        any_other |= others > 0
        forces = forces_where(intact, frame, resultant)
        add_rows(rows, first, second, row, FORCES, (forces.x, forces.z, forces.moment_a),
                 (-forces.x, -forces.z, -forces.moment_b))
        block += ONE
    return any_other


@compiled
def forces_of_lanes(tables, blocks, law, damped):
    """Forces of the intact interfaces of several walls: one of them in eight walls is a block; and what the failed ones
    do where their contacts stay springs, for `forces_of_others`.  Returns whether there are any."""
    bodies, first, second, any_other = blocks.bodies, blocks.first, blocks.second, False
    row = NONE
    while row < INDEX(len(blocks.others)):
        a, b, p = first[row], second[row], place_of(row, at.INTERFACE)
        frame, motion, resultant, intact = evaluate(
            line_of(blocks.interfaces, p), springs_of(blocks.interfaces, p), poses_in_lanes(bodies, a),
            poses_in_lanes(bodies, b), blocks.limits, row * at.LIMITS)
        if damped:
            resultant, work = damp_eight(blocks.last, row * at.LAST, load(blocks.bench, at.RATE), motion, resultant,
                                         intact)
            add(blocks.sums, at.DAMPED + row % WIDTH * WIDTH, work)
        blocks.others[row] = others = 255 - bits(intact)
        any_other |= others > 0
        push_in_lanes(bodies, a, b, forces_where(intact, frame, resultant))
        held = others & blocks.loose[row]
        if held:
            forces_of_loose(tables, blocks, law, row, held, frame, motion, damped)
        row += ONE
    return any_other


@compiled
def forces_of_others(tables, columns, blocks, lanes, law, clock, step, at_end, damped):
    """Forces of the interfaces that do not stay intact, contact by contact, after all others; at the end of all."""
    for block in range(len(blocks.others)):
        flags = 255 if at_end else int(blocks.others[block])
        if flags == 0:
            continue
        if lanes > 1:
            flags = flags & ~(read_and_push(tables, blocks, block, damped) if at_end else
                              push_waiting(blocks, block, flags, damped))
        k = 0
        while flags:  # hardly ever of an interface in lanes
            p, w = (8 * block + k, 0) if lanes == 1 else (block, k)
            if flags & 1 and p < tables.interfaces.shape[1] and w < tables.interfaces.shape[0]:
                forces_by_contacts(tables, columns, blocks, lanes, law, clock[w] + step, w, p, at_end, damped)
            flags, k = flags >> 1, k + 1


@compiled
def read_and_push(tables, blocks, p, damped):
    """Forces of an interface contact by contact in the walls where it stays intact, which are returned (bits), and the
    readings of its contacts."""
    a, b, k = blocks.first[p], blocks.second[p], place_of(INDEX(p), at.INTERFACE)
    start, stop = tables.interfaces[0, p].start, tables.interfaces[0, p].stop
    frame, motion, _, intact = evaluate(
        line_of(blocks.interfaces, k), springs_of(blocks.interfaces, k), poses_in_lanes(blocks.bodies, a),
        poses_in_lanes(blocks.bodies, b), blocks.limits, INDEX(p) * at.LIMITS)
    resultant = intact_springs(tables.contacts, start, stop, motion)
    read_intact(tables, blocks.bench, start, stop, motion, int(bits(intact)))
    if damped:
        resultant, work = damp_eight(blocks.last, INDEX(p) * at.LAST, load(blocks.bench, at.RATE), motion, resultant,
                                     intact)
        add(blocks.sums, at.DAMPED + INDEX(p % 8 * 8), work)
    push_in_lanes(blocks.bodies, a, b, forces_where(intact, frame, resultant))
    return int(bits(intact))


@inlined
def forces_by_contacts(tables, columns, blocks, lanes, law, step, w, p, at_end, damped):
    """`damage.mechanics.step.forces_by_contacts` of wall w."""
    bodies, apart = (blocks.rows, ONE) if lanes == 1 else (blocks.bodies, WIDTH)
    slot, system = INDEX(p * lanes + w), wall_of(tables, w)
    last, limits, m, held = blocks.last, blocks.limits, place_of(slot, at.LAST), place_of(slot, at.LIMITS)
    start, stop = tables.interfaces[0, p].start, tables.interfaces[0, p].stop  # of all walls: fewer to fetch
    a, b, k = blocks.first[p] + INDEX(w), blocks.second[p] + INDEX(w), place_of(INDEX(p), at.INTERFACE)
    frame, motion = interfaces.relative_motion(line_of(blocks.interfaces, k), pose_of(bodies, a, apart),
                                               pose_of(bodies, b, apart))
    if singly.has_ended(system, p, motion):
        return
    intact = False
    if at_end:
        intact = interfaces.stays_intact(springs_of(blocks.interfaces, k), limits[held + at.OPENING],
                                         limits[held + at.SLIDE], motion)
    loose = lanes > 1 and not at_end
    if loose and blocks.loose[p] >> w & 1:
        give(tables, columns, blocks, w, p)
    resultant, elastic = singly.elastic_resultant(system.contacts, system.states, start, stop, motion)
    changed = interfaces.change(resultant, last_resultant(last, m))
    if elastic or intact:
        singly.remember(system.contacts, system.states, start, stop, motion)
    else:
        resultant, changed, failed = singly.law_resultant(system, law, p, step, motion, last_motion(last, m), damped)
        if failed:
            tables.interfaces[w, p].failed = FAILED
            limits[held + at.OPENING] = -np.inf
    ends = singly.ends_now(system, p, motion)
    if loose and tables.interfaces[w, p].failed == FAILED:
        take(tables, columns, blocks, w, p)
    if at_end or ends:
        singly.read(system.contacts, system.states, system.readings, start, stop, motion)
    if damped:
        viscous, work = interfaces.add_viscous(blocks.bench[at.RATE + INDEX(w)], motion, last_motion(last, m),
                                               resultant, changed)
        keep_last(last, m, motion, resultant)
        blocks.sums[at.DAMPED + INDEX(p % 8 * lanes + w)] += work
        resultant = viscous
    push_one(bodies, a, b, apart, interfaces.forces_on_bodies(frame, resultant))


@compiled
def poses_to_rows(blocks):
    """Copy the poses of one wall's bodies into its rows, and set their forces to zero."""
    bodies, rows, starts, block = blocks.bodies, blocks.rows, blocks.starts, NONE
    while block * WIDTH < INDEX(len(starts)):
        pose, zero = poses_in_lanes(bodies, block * at.BODY), spread(0.0)
        set_rows(rows, starts, block * WIDTH, NONE, pose.x, pose.z, pose.cos1, pose.sin)
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
def remember_last(tables, blocks, lanes):
    """`damage.mechanics.step.remember_last` of all walls."""
    if lanes == 1:
        poses_to_rows(blocks)
    bodies, apart = (blocks.rows, ONE) if lanes == 1 else (blocks.bodies, WIDTH)
    for w in range(tables.interfaces.shape[0]):
        for p in range(tables.interfaces.shape[1]):
            interface, here = tables.interfaces[w, p], INDEX(w)
            _, motion = interfaces.relative_motion(line_of(blocks.interfaces, place_of(INDEX(p), at.INTERFACE)),
                                                   pose_of(bodies, blocks.first[p] + here, apart),
                                                   pose_of(bodies, blocks.second[p] + here, apart))
            keep_last(blocks.last, place_of(INDEX(p * lanes + w), at.LAST), motion, singly.present_resultant(
                tables.contacts[w], tables.states[w], interface.start, interface.stop, motion))
