"""Contact points of an interface in the eight walls of a batch, to the same bits as `damage.mechanics.contacts`.

The contact points of a failed interface are copied from the tables into blocks.  They are updated there while all of
them stay elastic, and copied back before the joint law is evaluated and at the end of a run.
"""

import numpy as np

from damage.mechanics.eight import add, bits, either, flags_of, load, spread, store
from damage.mechanics.interfaces import BodyForces, Resultant, no_overlap
from damage.mechanics.tables import FAILED, READ_OPENING, READ_SHEAR, READ_SIGMA, READ_TAU
from damage.reference.fast import blocks as at
from damage.reference.fast.blocks import INDEX
from damage.reference.fast.compiled import compiled, inlined
from damage.reference.fast.interfaces import damp_eight, forces_where, push_in_lanes
from damage.wall import joint_law


@compiled
def loosen(tables, columns, blocks):
    """Copy the contact points of all failed interfaces into the blocks.

    columns: the states as an array of numbers, (walls, contacts, fields).
    """
    blocks.loose[:] = 0
    for w in range(tables.interfaces.shape[0]):
        for p in range(tables.interfaces.shape[1]):
            if tables.interfaces[w, p].failed == FAILED:
                take(tables, columns, blocks, w, p)


@compiled
def fasten(tables, columns, blocks, which):
    """Copy changed states of the contact points in the blocks back to the tables, for the walls `which` (bits)."""
    for p in range(tables.interfaces.shape[1]):
        for w in range(tables.interfaces.shape[0]):
            if blocks.loose[p] & which & 1 << w:
                give(tables, columns, blocks, w, p)


@inlined
def take(tables, columns, blocks, w, p):
    """Copy the contact points of interface p of wall w into the blocks."""
    for i in range(tables.interfaces[0, p].start, tables.interfaces[0, p].stop):
        take_one(tables, columns, blocks, w, i)
    blocks.loose[p] |= 1 << w


@inlined
def take_one(tables, columns, blocks, w, i):
    """Copy contact point i of wall w into the blocks."""
    k = INDEX(i) * at.LOOSE + INDEX(w)
    for n in range(len(at.COLUMNS)):
        blocks.contacts[k + INDEX(8 * n)] = columns[w, i, at.COLUMNS[n]]


@inlined
def give(tables, columns, blocks, w, p):
    """Copy changed states of the contact points of interface p of wall w back to the tables."""
    for i in range(tables.interfaces[0, p].start, tables.interfaces[0, p].stop):
        give_one(columns, blocks, w, i)


@inlined
def give_one(columns, blocks, w, i):
    """Copy changed states of contact point i of wall w back to the tables."""
    k = INDEX(i) * at.LOOSE + INDEX(w)
    for n in range(at.CHANGED):
        columns[w, i, at.COLUMNS[n]] = blocks.contacts[k + INDEX(8 * n)]


@inlined
def intact_springs(contacts, start, stop, motion):
    """Resultant of an intact interface as the sum over its contact points [N, N m]."""
    normal, shear, couple = spread(0.0), spread(0.0), spread(0.0)
    for i in range(start, stop):
        contact = contacts[0, i]
        sigma = contact.kn * (motion.opening + contact.offset * motion.rotation)
        normal = normal + sigma
        shear = shear + contact.ks * motion.shear
        couple = couple + sigma * contact.offset
    return Resultant(normal, shear, couple)


@inlined
def read_intact(contacts, readings, start, stop, motion):
    """`damage.mechanics.contacts.read` of an intact interface, into the blocks."""
    for i in range(start, stop):
        contact, k = contacts[0, i], INDEX(i) * at.READ
        # Adding zero, as the law adds closure and earlier force, turns -0 into +0: the bits stay equal.
        opening = motion.opening + contact.offset * motion.rotation + 0.0
        store(readings, k + at.OPENED, opening)
        store(readings, k + at.SHEARED, motion.shear)
        store(readings, k + at.SIGMA, contact.kn * opening / contact.area)
        store(readings, k + at.TAU, (contact.ks * motion.shear + 0.0) / contact.area)


@inlined
def read_loose(contacts, blocks, law, start, stop, motion, which):
    """`damage.mechanics.contacts.read` of a failed interface in the walls `which` (flags), into the blocks."""
    for i in range(start, stop):
        contact, k, r = contacts[0, i], INDEX(i) * at.LOOSE, INDEX(i) * at.READ
        opening, sigma, tau, is_open = loose_trial(contact, blocks.contacts, k, motion, law.plain)
        sigma, tau = either(is_open, 0.0, sigma), either(is_open, 0.0, tau)
        for field, value in ((at.OPENED, opening), (at.SHEARED, motion.shear), (at.SIGMA, sigma / contact.area),
                             (at.TAU, tau / contact.area)):
            store(blocks.readings, r + field, either(which, value, load(blocks.readings, r + field)))


@inlined
def keep_readings(tables, blocks, w, p):
    """Copy the readings of interface p of wall w into the blocks."""
    for i in range(tables.interfaces[0, p].start, tables.interfaces[0, p].stop):
        k = INDEX(i) * at.READ + INDEX(w)
        for field, row in ((at.OPENED, READ_OPENING), (at.SHEARED, READ_SHEAR), (at.SIGMA, READ_SIGMA),
                           (at.TAU, READ_TAU)):
            blocks.readings[k + field] = tables.readings[w, row, i]


@inlined
def give_readings(tables, blocks, w, start, stop):
    """Copy the readings of the contact points start to stop of wall w back to the tables."""
    for i in range(start, stop):
        k = INDEX(i) * at.READ + INDEX(w)
        for field, row in ((at.OPENED, READ_OPENING), (at.SHEARED, READ_SHEAR), (at.SIGMA, READ_SIGMA),
                           (at.TAU, READ_TAU)):
            tables.readings[w, row, i] = blocks.readings[k + field]


@inlined
def without_overlap(tables, p, motion):
    """Walls (bits) in which the faces of interface p do not overlap at this RelativeMotion."""
    return int(bits(no_overlap(motion, tables.interfaces[0, p].slide_least, tables.interfaces[0, p].slide_most)))


@inlined
def forces_of_loose(tables, blocks, law, p, held, frame, motion, damped):
    """Forces of failed interface p in the walls `held` (bits), where all its contact points stay elastic.

    They are stored, and added after those of the intact interfaces, in the order of the plain step.  Returns the walls
    (bits) in which they stay elastic.
    """
    waiting, k, m = blocks.waiting, p * at.WAITING, p * at.LAST
    start, stop = tables.interfaces[0, p].start, tables.interfaces[0, p].stop
    resultant, elastic = loose_springs(tables.contacts, blocks.contacts, law.plain, start, stop, motion,
                                       flags_of(held & ~without_overlap(tables, p, motion)))
    remember_loose(tables.contacts, blocks.contacts, law.plain, start, stop, motion, elastic)
    if damped:
        resultant, work = damp_eight(blocks.last, m, load(blocks.bench, at.RATE), motion, resultant, elastic)
        store(waiting, k + at.WORK, work)
    forces = forces_where(elastic, frame, resultant)
    store(waiting, k + at.PUSH_X, forces.x)
    store(waiting, k + at.PUSH_Z, forces.z)
    store(waiting, k + at.MOMENT_A, forces.moment_a)
    store(waiting, k + at.MOMENT_B, forces.moment_b)
    return int(bits(elastic))


@inlined
def push_waiting(blocks, p, flags, damped):
    """Add the stored forces of interface p to its bodies in the walls `flags` (bits); returns those that had any."""
    waits = flags & int(blocks.loose[p]) & int(blocks.waits[p])
    if waits:
        waiting, k = blocks.waiting, INDEX(p) * at.WAITING
        push_in_lanes(blocks.bodies, blocks.first[p], blocks.second[p], BodyForces(
            load(waiting, k + at.PUSH_X), load(waiting, k + at.PUSH_Z), load(waiting, k + at.MOMENT_A),
            load(waiting, k + at.MOMENT_B)))
        if damped:
            add(blocks.sums, at.DAMPED + INDEX(p % 8 * 8), load(waiting, k + at.WORK))
    return waits


@inlined
def loose_spring(contact, loose, k, motion, plain):
    """Opening plus plastic closure [m] and normal force [N] of a contact point in eight walls, as
    `damage.mechanics.contacts.elastic_trial`; plain: no contact point softens or crushes."""
    opening = motion.opening + contact.offset * motion.rotation
    if plain:
        opening = opening + 0.0  # as with a closure of zero
        return opening, contact.kn * opening
    opening = opening + load(loose, k + at.CLOSURE)
    return opening, either(opening > 0.0, load(loose, k + at.KT), contact.kn) * opening


@inlined
def loose_trial(contact, loose, k, motion, plain):
    """Result of `loose_spring`, shear force [N], and whether the contact point stays open (`contacts.stays_open`)."""
    opening, sigma = loose_spring(contact, loose, k, motion, plain)
    tau0 = load(loose, k + at.SHEAR_STRESS)
    tau = tau0 + contact.ks * (motion.shear - load(loose, k + at.SHEAR0))
    return opening, sigma, tau, (opening > 0.0) & (opening <= load(loose, k + at.IDLE)) & (tau0 == 0.0)


@inlined
def loose_springs(contacts, loose, plain, start, stop, motion, elastic):
    """`damage.mechanics.contacts.elastic_resultant` in eight walls.

    Returns the Resultant, and those of the walls `elastic` (flags) in which all contact points stay elastic.
    """
    held = elastic
    normal, shear, couple = spread(0.0), spread(0.0), spread(0.0)
    for i in range(start, stop):
        contact, k = contacts[0, i], INDEX(i) * at.LOOSE
        _, sigma, tau, is_open = loose_trial(contact, loose, k, motion, plain)
        store(loose, k + at.SHEAR0, either(held & is_open, motion.shear, load(loose, k + at.SHEAR0)))
        within = joint_law.stays_elastic(sigma, tau, load(loose, k + at.TENSILE), load(loose, k + at.COHESION),
                                         load(loose, k + at.FRICTION))
        if not plain:
            within = within & joint_law.withstands(sigma, load(loose, k + at.COMPRESSIVE))
        elastic = elastic & (within | is_open)
        normal = normal + either(is_open, 0.0, sigma)
        shear = shear + either(is_open, 0.0, tau)
        couple = couple + either(is_open, 0.0, sigma * contact.offset)
    return Resultant(normal, shear, couple), elastic


@inlined
def remember_loose(contacts, loose, plain, start, stop, motion, elastic):
    """`damage.mechanics.contacts.remember` in the walls `elastic` (flags)."""
    for i in range(start, stop):
        contact, k = contacts[0, i], INDEX(i) * at.LOOSE
        moves = elastic & (load(loose, k + at.IDLE) >= 0.0)
        if not plain:
            compressive, before = load(loose, k + at.COMPRESSIVE), load(loose, k + at.NORMAL_STRESS)
            _, sigma = loose_spring(contact, loose, k, motion, plain)
            store(loose, k + at.NORMAL_STRESS, either(elastic & (compressive < np.inf), sigma, before))
            moves = elastic & ((load(loose, k + at.IDLE) >= 0.0) | (load(loose, k + at.KAPPA) > 0.0))
        tau0, shear0 = load(loose, k + at.SHEAR_STRESS), load(loose, k + at.SHEAR0)
        store(loose, k + at.SHEAR_STRESS, either(moves, tau0 + contact.ks * (motion.shear - shear0), tau0))
        store(loose, k + at.SHEAR0, either(moves, motion.shear, shear0))
