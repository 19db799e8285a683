"""Fast step of a batch of up to eight walls, each in one SIMD lane, with the results of single walls bit by bit.

A wall *ends* at the steps at which a sample of it is taken, which differ between walls.  At these steps its contact
points are evaluated one by one, while the other walls take an ordinary step.
"""

import numpy as np

from damage.history.schema import ENDED
from damage.mechanics.eight import add, bits, either, flags_of, load, spread, store
from damage.mechanics.interfaces import Resultant
from damage.mechanics.samples import KINETIC, observe_contact
from damage.mechanics.tables import DAMPING, ENDING, FAILED, INPUT, RIGID, ROTATION, X, Z
from damage.reference.fast import blocks as at
from damage.reference.fast.blocks import INDEX, NONE, ONE, WIDTH, clear, pack, pack_limits, place_of, total, unpack
from damage.reference.fast.bodies import ALL, adapt, move, set_all
from damage.reference.fast.compiled import compiled, entry, inlined
from damage.reference.fast.contacts import (
    fasten,
    forces_of_loose,
    give,
    give_readings,
    intact_springs,
    keep_readings,
    loose_springs,
    loosen,
    push_waiting,
    read_intact,
    read_loose,
    remember_loose,
    take,
    without_overlap,
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


@entry
def run(tables, columns, blocks, law, controls, field, clock, ends, ending, stiffness, samples, taken):
    """Advance all walls to the last of the steps `ends`, and write samples, as `damage.mechanics.step.run`.

    tables: joined System; columns: its states as an array of numbers, (walls, contacts, fields); controls: (walls, 5)
    as of `damage.mechanics.tables.Controls`; field: (walls, steps + 1, 3) acceleration of the base along x and z and
    gravity, in each step and the one after the last [m/s2]; clock: (walls,) numbers of steps before; ends: (n,) rising
    numbers of steps from now; ending: (n,) walls (bits) of which a sample is written there, all of them at the last;
    stiffness, samples: as of `damage.mechanics.samples`; taken: (walls,) numbers of samples written, zero on entry.
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
            observe(tables, columns, blocks, field, step, which, stiffness, samples, taken)
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
    """Forces of the contact points on all bodies, into the blocks, where they are zero on entry.

    ending: walls (bits) whose contact points are all evaluated by themselves, as `singly` of
    `damage.mechanics.step.find_forces`; all_end: whether these are all walls.
    """
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
    """Set the elastic limits of all interfaces of the walls `which` (bits) to -inf, until `pack_limits`.

    `forces_of_intact` then leaves them out, without a test that would take time in steps at which no wall ends.
    """
    for p in range(tables.interfaces.shape[1]):
        for w in range(tables.interfaces.shape[0]):
            if which >> w & 1:
                blocks.limits[INDEX(p) * at.LIMITS + INDEX(w) + at.OPENING] = -np.inf


@compiled
def forces_of_undamped(tables, blocks, law, going):
    """`forces_of_intact` without damping, compiled apart: a branch inside would need too many registers."""
    return forces_of_intact(tables, blocks, law, going, False)


@compiled
def forces_of_damped(tables, blocks, law, going):
    """`forces_of_intact` with damping."""
    return forces_of_intact(tables, blocks, law, going, True)


@inlined
def forces_of_intact(tables, blocks, law, going, damped):
    """Forces of the intact interfaces, one in eight walls at a time.

    For failed interfaces whose contact points stay elastic, in the walls `going` (bits) that do not end, the forces are
    stored for `forces_of_others`.  Returns whether there are interfaces that are not intact.
    """
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
    """Forces of the interfaces that are not intact, and of all in the walls that end, contact point by contact point,
    after the others."""
    for p in range(len(blocks.others)):
        flags = ending if all_end else int(blocks.others[p])
        if flags == 0:
            continue
        done = end_interface(tables, blocks, law, p, ending, damped) if ending else 0
        flags = flags & ~(done | push_waiting(blocks, p, flags & ~ending, damped))
        w = 0
        while flags:  # rarely
            if flags & 1 and w < tables.interfaces.shape[0]:
                forces_by_law(tables, columns, blocks, law, clock[w] + step, w, p, ending >> w & 1 > 0, damped)
            flags, w = flags >> 1, w + 1


@inlined
def forces_by_law(tables, columns, blocks, law, step, w, p, ends, damped):
    """Forces of interface p of wall w, which leaves its elastic range; ends: whether a sample of the wall is taken."""
    if blocks.loose[p] >> w & 1:
        give(tables, columns, blocks, w, p)
        blocks.loose[p] &= 255 - (1 << w)
    forces_by_contacts(tables, blocks, LANES, law, step, w, p, ends, damped)
    failed = tables.interfaces[w, p].failed
    if failed == FAILED:
        take(tables, columns, blocks, w, p)
    if ends or failed >= ENDING:  # an ended interface keeps its readings
        keep_readings(tables, blocks, w, p)


@inlined
def end_interface(tables, blocks, law, p, ending, damped):
    """Forces and readings of interface p by contact points in the walls `ending` (bits), where it is intact or all its
    contact points stay elastic; returns these walls (bits)."""
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
                                       flags_of(held & ~without_overlap(tables, p, motion)))
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
def observe(tables, columns, blocks, field, step, which, stiffness, samples, taken):
    """Write the next sample of each of the walls `which` (bits), as `damage.mechanics.samples.observe`.

    The bench must hold the parameters of the next step.
    """
    kinetic_energy(blocks)
    for w in range(tables.place.shape[0]):
        if which >> w & 1:
            observe_places(tables, blocks, field[w, step], w, samples, taken[w])
    observe_stored(blocks, which, stiffness, samples, taken)
    for w in range(tables.place.shape[0]):
        if which >> w & 1:
            observe_failed(tables, columns, blocks, w, stiffness, samples, taken[w])
            taken[w] += 1


@compiled
def observe_places(tables, blocks, field, w, samples, k):
    """Write displacements of the bodies, forces on the supports and totals of wall w into its sample k."""
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
    samples.totals[w, k, KINETIC + 1 + INPUT] += input_of_half_a_step(tables, blocks, field, w)


@compiled
def input_of_half_a_step(tables, blocks, field, w):
    """`damage.mechanics.samples.input_of_half_a_step` of wall w."""
    power, bodies = 0.0, blocks.bodies
    for b in range(tables.place.shape[1]):
        slot = INDEX(b) * at.BODY + INDEX(w)
        for axis in range(RIGID):
            velocity = bodies[slot + at.VX] if axis == X else bodies[slot + at.VZ] if axis == Z else bodies[
                slot + at.VROTATION]
            if tables.inverse_mass[w, b, axis] == 0.0:
                power += (bodies[slot + at.FX] if axis == X else bodies[slot + at.FZ] if axis == Z else bodies[
                    slot + at.MOMENT]) * velocity
            elif axis != ROTATION:
                power += tables.mass[w, b, axis] * (field[0] if axis == X else field[1]) * velocity
    return -0.5 * blocks.bench[at.STEP + INDEX(w)] * power


@inlined
def half_step_on(bodies, k, velocity, force, inverse, field, dt):
    """Velocities of a coordinate of eight bodies, advanced by half a step; arguments: indices of its fields."""
    free = load(bodies, k + inverse)
    return load(bodies, k + velocity) + either(
        free > 0.0, 0.5 * dt * (load(bodies, k + force) * free - field), 0.0)


@compiled
def kinetic_energy(blocks):
    """`damage.mechanics.samples.kinetic_energy` of all walls [J], into the sums from KINETIC on."""
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
    """Write the elastic energies of all contact points into the samples of the walls `which` (bits)."""
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
    """Write the contact data of the failed interfaces of wall w into its sample k."""
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
