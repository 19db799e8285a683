"""The fast step of up to eight walls side by side, each to the same bits as alone.

Walls end, where a sample is taken, at steps of their own: the contacts of a wall that ends are evaluated one by one,
while the others go on as always.
"""

import numpy as np

from damage.history.schema import ENDED
from damage.mechanics.eight import add, bits, either, flags_of, load, spread, store
from damage.mechanics.interfaces import Resultant
from damage.mechanics.samples import KINETIC, observe_contact
from damage.mechanics.tables import DAMPING, ENDING, FAILED, ROTATION, X, Z
from damage.reference.fast import blocks as at
from damage.reference.fast.blocks import INDEX, NONE, ONE, WIDTH, clear, pack, pack_limits, place_of, total, unpack
from damage.reference.fast.bodies import ALL, adapt, move, set_all
from damage.reference.fast.compiled import compiled, inlined
from damage.reference.fast.contacts import (
    fasten,
    forces_of_loose,
    give,
    give_readings,
    intact_springs,
    keep_readings,
    loose_springs,
    loosen,
    parted_in,
    push_waiting,
    read_intact,
    read_loose,
    remember_loose,
    take,
)
from damage.reference.fast.interfaces import (
    damp_eight,
    evaluate,
    forces_where,
    line_of,
    poses_in_lanes,
    push_in_lanes,
    springs_of,
)
from damage.reference.fast.step import any_above_zero, forces_by_contacts, remember_last, wall_of
from damage.wall.joint_law import elastic_energy

LANES = 8


@compiled
def run(tables, columns, blocks, law, controls, field, clock, ends, ending, stiffness, samples, taken):
    """Advance from places whose forces are known to the last of these ends, where those of all walls are known again.

    columns: the states of the tables as numbers (walls, contacts, fields); controls: (walls, 5) as of
    `damage.mechanics.tables.Controls`; field: (walls, steps + 1, 3) acceleration of the base along x and z and gravity,
    of each step and the one after them [m/s2]; clock: (walls,) steps that came before; ends: steps from here to each;
    ending: the walls (bits) that end there, all at the last one: a sample of each is written; stiffness, samples: as of
    `damage.mechanics.samples`; taken: (walls,) samples that each has, zero at first.
    """
    pack(tables, blocks, LANES)
    damped, adaptive, step = any_above_zero(controls, 3), any_above_zero(controls, 4), 0
    at_start, full, k = (1 << controls.shape[0]) - 1, (1 << controls.shape[0]) - 1, 0
    loosen(tables, columns, blocks)
    if damped:
        remember_last(tables, blocks, LANES, at_start)
    while k < len(ends):
        move(tables.energy, tables.relaxation, blocks, LANES, controls, field, step)
        if adaptive:
            adapt(tables.relaxation, blocks, LANES, controls)
        step += 1
        which = int(ending[k]) if step == ends[k] else 0
        all_forces(tables, columns, blocks, law, clock, step, which, which == full, damped)
        if which:
            set_all(blocks.bench, tables.relaxation, LANES, controls, field, step)
            observe(tables, columns, blocks, which, stiffness, samples, taken)
            if damped:
                fasten(tables, columns, blocks, which)
                remember_last(tables, blocks, LANES, which)
            k += 1
    fasten(tables, columns, blocks, full)
    unpack(tables, blocks, LANES)
    for w in range(controls.shape[0]):
        give_readings(tables, blocks, w, 0, tables.contacts.shape[1])


@compiled
def all_forces(tables, columns, blocks, law, clock, step, ending, all_end, damped):
    """Forces of the contacts on all bodies, into the blocks, where they are zero; ending: walls (bits) whose contacts
    are all evaluated one by one, as `singly` of `damage.mechanics.step.find_forces`; all_end: whether these are all."""
    clear(blocks.sums, at.DAMPED, at.KINETIC)
    others = True
    if not all_end:
        if ending:
            take_limits(tables, blocks, ending)
        others = forces_of_damped(tables, blocks, law, ALL - ending) if damped else forces_of_undamped(
            tables, blocks, law, ALL - ending)
        if ending:
            pack_limits(tables, blocks, LANES)
    if others:
        forces_of_others(tables, columns, blocks, law, clock, step, ending, all_end, damped)
    if damped:
        total(blocks.sums, at.DAMPED, LANES)
        for w in range(tables.energy.shape[0]):
            tables.energy[w, DAMPING] += blocks.sums[at.DAMPED + INDEX(w)]


@compiled
def take_limits(tables, blocks, which):
    """Let no interface of these walls (bits) count as intact until its limits are packed again: `forces_of_intact` then
    leaves them out, which costs nothing in the steps at which no wall ends."""
    for p in range(tables.interfaces.shape[1]):
        for w in range(tables.interfaces.shape[0]):
            if which >> w & 1:
                blocks.limits[INDEX(p) * at.LIMITS + INDEX(w) + at.OPENING] = -np.inf


@compiled
def forces_of_undamped(tables, blocks, law, going):
    """`forces_of_intact` without damping: apart, as what a branch would need leaves no room in registers."""
    return forces_of_intact(tables, blocks, law, going, False)


@compiled
def forces_of_damped(tables, blocks, law, going):
    """The same with damping."""
    return forces_of_intact(tables, blocks, law, going, True)


@inlined
def forces_of_intact(tables, blocks, law, going, damped):
    """Forces of the intact interfaces: one of them in eight walls is a block; and what the failed ones do, in the walls
    that do not end (bits), where their contacts stay springs, for `forces_of_others`.  Returns whether there are
    others."""
    bodies, first, second, any_other = blocks.bodies, blocks.first, blocks.second, 0
    row = NONE
    while row < INDEX(len(blocks.others)):
        p, a, b = place_of(row, at.INTERFACE), first[row], second[row]
        frame, motion, resultant, intact = evaluate(
            line_of(blocks.interfaces, p), springs_of(blocks.interfaces, p), poses_in_lanes(bodies, a),
            poses_in_lanes(bodies, b), blocks.limits, row * at.LIMITS)
        if damped:
            resultant, work = damp_eight(blocks.last, row * at.LAST, load(blocks.bench, at.RATE), motion, resultant,
                                         intact)
            add(blocks.sums, at.DAMPED + row % WIDTH * WIDTH, work)
        others = ALL - int(bits(intact))
        push_in_lanes(bodies, a, b, forces_where(intact, frame, resultant))
        held, waits = others & int(blocks.loose[row]) & going, 0
        if held:
            waits = forces_of_loose(tables, blocks, law, row, held, frame, motion, damped)
        blocks.others[row], blocks.waits[row] = others, waits
        any_other |= others
        row += ONE
    return any_other > 0


@compiled
def forces_of_others(tables, columns, blocks, law, clock, step, ending, all_end, damped):
    """Forces of the interfaces that do not stay intact, contact by contact, after all others; of all in the walls that
    end."""
    for p in range(len(blocks.others)):
        flags = ending if all_end else int(blocks.others[p])
        if flags == 0:
            continue
        done = end_interface(tables, blocks, law, p, ending, damped) if ending else 0
        flags = flags & ~(done | push_waiting(blocks, p, flags & ~ending, damped))
        w = 0
        while flags:  # hardly ever
            if flags & 1 and w < tables.interfaces.shape[0]:
                forces_by_law(tables, columns, blocks, law, clock[w] + step, w, p, ending >> w & 1 > 0, damped)
            flags, w = flags >> 1, w + 1


@inlined
def forces_by_law(tables, columns, blocks, law, step, w, p, ends, damped):
    """Forces of an interface of wall w that does not stay elastic."""
    if blocks.loose[p] >> w & 1:
        give(tables, columns, blocks, w, p)
        blocks.loose[p] &= 255 - (1 << w)
    forces_by_contacts(tables, blocks, LANES, law, step, w, p, ends, damped)
    failed = tables.interfaces[w, p].failed
    if failed == FAILED:
        take(tables, columns, blocks, w, p)
    if ends or failed >= ENDING:  # readings of an interface that has ended stay, whatever its lanes are read as
        keep_readings(tables, blocks, w, p)


@compiled
def end_interface(tables, blocks, law, p, ending, damped):
    """Forces of an interface contact by contact in the walls that end (bits), where it is intact or its contacts stay
    springs, and the readings of its contacts there; returns these walls."""
    k, a, b = place_of(INDEX(p), at.INTERFACE), blocks.first[p], blocks.second[p]
    start, stop = tables.interfaces[0, p].start, tables.interfaces[0, p].stop
    frame, motion, _, intact = evaluate(
        line_of(blocks.interfaces, k), springs_of(blocks.interfaces, k), poses_in_lanes(blocks.bodies, a),
        poses_in_lanes(blocks.bodies, b), blocks.limits, INDEX(p) * at.LIMITS)
    intact = intact & flags_of(ending)
    resultant = intact_springs(tables.contacts, start, stop, motion)
    read_intact(tables.contacts, blocks.readings, start, stop, motion)
    springs, held = intact, ending & int(blocks.loose[p]) & ~int(bits(intact))
    if held:
        loose, elastic = loose_springs(tables.contacts, blocks.contacts, law.plain, start, stop, motion,
                                       flags_of(held & ~parted_in(tables, p, motion)))
        remember_loose(tables.contacts, blocks.contacts, law.plain, start, stop, motion, elastic)
        read_loose(tables.contacts, blocks, law, start, stop, motion, elastic)
        resultant = Resultant(either(elastic, loose.normal, resultant.normal),
                              either(elastic, loose.shear, resultant.shear),
                              either(elastic, loose.couple, resultant.couple))
        springs = intact | elastic
    if damped:
        resultant, work = damp_eight(blocks.last, INDEX(p) * at.LAST, load(blocks.bench, at.RATE), motion, resultant,
                                     springs)
        add(blocks.sums, at.DAMPED + INDEX(p % 8 * 8), work)
    push_in_lanes(blocks.bodies, a, b, forces_where(springs, frame, resultant))
    return int(bits(springs))


@compiled
def observe(tables, columns, blocks, which, stiffness, samples, taken):
    """Write the next sample of each of these walls (bits), as `damage.mechanics.samples.observe`, by the bench of the
    step that begins now."""
    kinetic_energy(blocks)
    for w in range(tables.place.shape[0]):
        if which >> w & 1:
            observe_places(tables, blocks, w, samples, taken[w])
    observe_stored(blocks, which, stiffness, samples, taken)
    for w in range(tables.place.shape[0]):
        if which >> w & 1:
            observe_failed(tables, columns, blocks, w, stiffness, samples, taken[w])
            taken[w] += 1


@compiled
def observe_places(tables, blocks, w, samples, k):
    """Write the places of the bodies of wall w, the forces on its supports and the totals of the sample with this
    number."""
    supports = tables.place.shape[1] - samples.support_force.shape[2]
    for b in range(tables.place.shape[1]):
        slot = INDEX(b) * at.BODY + INDEX(w)
        samples.displacement[w, k, b, X] = blocks.bodies[slot + at.X]
        samples.displacement[w, k, b, Z] = blocks.bodies[slot + at.Z]
        samples.displacement[w, k, b, ROTATION] = blocks.bodies[slot + at.ROTATION]
        if b >= supports:
            samples.support_force[w, k, b - supports, X] = blocks.bodies[slot + at.FX]
            samples.support_force[w, k, b - supports, Z] = blocks.bodies[slot + at.FZ]
            samples.support_force[w, k, b - supports, ROTATION] = blocks.bodies[slot + at.MOMENT]
    samples.totals[w, k, KINETIC] = blocks.sums[at.KINETIC + INDEX(w)]
    for i in range(tables.energy.shape[1]):
        samples.totals[w, k, KINETIC + 1 + i] = tables.energy[w, i]


@inlined
def half_step_on(bodies, k, velocity, force, inverse, field, dt):
    """Velocities half a step on."""
    free = load(bodies, k + inverse)
    return load(bodies, k + velocity) + either(
        free > 0.0, 0.5 * dt * (load(bodies, k + force) * free - field), 0.0)


@compiled
def kinetic_energy(blocks):
    """`damage.mechanics.samples.kinetic_energy` of all walls, where the sum of kinetic energies begins."""
    bodies, bench = blocks.bodies, blocks.bench
    energy, block, dt = spread(0.0), NONE, load(bench, at.STEP)
    while block < INDEX(len(bodies)) // at.BODY:
        k = block * at.BODY
        vx = half_step_on(bodies, k, at.VX, at.FX, at.INVERSE_X, load(bench, at.BASE_X), dt)
        vz = half_step_on(bodies, k, at.VZ, at.FZ, at.INVERSE_Z, load(bench, at.BASE_Z), dt)
        rotating = load(bodies, k + at.VROTATION) + 0.5 * dt * load(bodies, k + at.MOMENT) * load(
            bodies, k + at.INVERSE_ROTATION)
        energy = energy + 0.5 * (load(bodies, k + at.MASS) * (vx * vx + vz * vz)
                                 + load(bodies, k + at.INERTIA) * rotating * rotating)
        block += ONE
    store(blocks.sums, at.KINETIC, energy)


@compiled
def observe_stored(blocks, which, stiffness, samples, taken):
    """Write the elastic energy of all contacts."""
    readings, room = blocks.readings, blocks.sums
    for c in range(samples.stored.shape[2]):
        k = INDEX(c) * at.READ
        store(room, at.SWEPT_X, stiffness.area[c] * elastic_energy(
            load(readings, k + at.SIGMA), load(readings, k + at.TAU), stiffness.normal[c], stiffness.shear[c]))
        for w in range(samples.stored.shape[0]):
            if which >> w & 1:
                samples.stored[w, taken[w], c] = room[at.SWEPT_X + INDEX(w)]


@compiled
def observe_failed(tables, columns, blocks, w, stiffness, samples, k):
    """Write what the contacts of failed interfaces of wall w are."""
    system = wall_of(tables, w)
    for p in range(tables.interfaces.shape[1]):
        if tables.interfaces[w, p].failed:
            start, stop = tables.interfaces[0, p].start, tables.interfaces[0, p].stop
            if blocks.loose[p] >> w & 1:
                give(tables, columns, blocks, w, p)
            give_readings(tables, blocks, w, start, stop)
            ended = ENDED if tables.interfaces[w, p].failed >= ENDING else 0
            for c in range(start, stop):
                observe_contact(system, stiffness.shear[c], ended, samples, w, k, c)
