"""Contacts of an interface in eight walls at once, to the same bits as `damage.mechanics.contacts` one by one.

Those of a failed interface are copied into a block, change there while all of them stay elastic, and are copied back
where the joint law is asked and where a wall is left.
"""

import numpy as np

from damage.mechanics.eight import add, bits, either, flags_of, load, spread, store
from damage.mechanics.interfaces import BodyForces, Resultant, parted
from damage.mechanics.tables import FAILED, READ_OPENING, READ_SHEAR, READ_SIGMA, READ_TAU
from damage.reference.fast import blocks as at
from damage.reference.fast.blocks import INDEX
from damage.reference.fast.compiled import compiled, inlined
from damage.reference.fast.interfaces import damp_eight, forces_where, push_in_lanes
from damage.wall import joint_law


@compiled
def loosen(tables, columns, blocks):
    """Copy the contacts of all failed interfaces into their blocks; columns: the states as numbers."""
    blocks.loose[:] = 0
    for w in range(tables.interfaces.shape[0]):
        for p in range(tables.interfaces.shape[1]):
            if tables.interfaces[w, p].failed == FAILED:
                take(tables, columns, blocks, w, p)


@compiled
def fasten(tables, columns, blocks, which):
    """Copy what has changed of those of these walls (bits) back."""
    for p in range(tables.interfaces.shape[1]):
        for w in range(tables.interfaces.shape[0]):
            if blocks.loose[p] & which & 1 << w:
                give(tables, columns, blocks, w, p)


@compiled
def take(tables, columns, blocks, w, p):
    """Copy the contacts of an interface of one wall into their blocks."""
    for i in range(tables.interfaces[0, p].start, tables.interfaces[0, p].stop):
        k = INDEX(i) * at.LOOSE + INDEX(w)
        for n in range(len(at.COLUMNS)):
            blocks.contacts[k + INDEX(8 * n)] = columns[w, i, at.COLUMNS[n]]
        blocks.contacts[k + at.COMPRESSIVE] = tables.contacts[w, i].compressive_strength
    blocks.loose[p] |= 1 << w


@compiled
def give(tables, columns, blocks, w, p):
    """Copy what has changed of them back."""
    for i in range(tables.interfaces[0, p].start, tables.interfaces[0, p].stop):
        k = INDEX(i) * at.LOOSE + INDEX(w)
        for n in range(at.CHANGED):
            columns[w, i, at.COLUMNS[n]] = blocks.contacts[k + INDEX(8 * n)]


@inlined
def intact_springs(contacts, start, stop, motion):
    """Resultant of an intact interface contact by contact [N, N m]."""
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
    """`damage.mechanics.contacts.read` of an interface that is intact, into blocks."""
    for i in range(start, stop):
        contact, k = contacts[0, i], INDEX(i) * at.READ
        # Zero is added as a closure and a force of before would be: it takes the sign from what is zero.
        opening = motion.opening + contact.offset * motion.rotation + 0.0
        store(readings, k + at.OPENED, opening)
        store(readings, k + at.SHEARED, motion.shear)
        store(readings, k + at.SIGMA, contact.kn * opening / contact.area)
        store(readings, k + at.TAU, (contact.ks * motion.shear + 0.0) / contact.area)


@inlined
def read_loose(contacts, blocks, law, start, stop, motion, which):
    """The same of one that has failed, in these walls (flags)."""
    for i in range(start, stop):
        contact, k, r = contacts[0, i], INDEX(i) * at.LOOSE, INDEX(i) * at.READ
        opening, sigma, tau, is_open = loose_trial(contact, blocks.contacts, k, motion, law.plain)
        sigma, tau = either(is_open, 0.0, sigma), either(is_open, 0.0, tau)
        for field, value in ((at.OPENED, opening), (at.SHEARED, motion.shear), (at.SIGMA, sigma / contact.area),
                             (at.TAU, tau / contact.area)):
            store(blocks.readings, r + field, either(which, value, load(blocks.readings, r + field)))


@compiled
def keep_readings(tables, blocks, w, p):
    """Copy the readings of an interface of one wall into their blocks."""
    for i in range(tables.interfaces[0, p].start, tables.interfaces[0, p].stop):
        k = INDEX(i) * at.READ + INDEX(w)
        for field, row in ((at.OPENED, READ_OPENING), (at.SHEARED, READ_SHEAR), (at.SIGMA, READ_SIGMA),
                           (at.TAU, READ_TAU)):
            blocks.readings[k + field] = tables.readings[w, row, i]


@compiled
def give_readings(tables, blocks, w, start, stop):
    """Copy the readings of contacts of one wall back."""
    for i in range(start, stop):
        k = INDEX(i) * at.READ + INDEX(w)
        for field, row in ((at.OPENED, READ_OPENING), (at.SHEARED, READ_SHEAR), (at.SIGMA, READ_SIGMA),
                           (at.TAU, READ_TAU)):
            tables.readings[w, row, i] = blocks.readings[k + field]


@inlined
def parted_in(tables, p, motion):
    """Lanes (bits) in which the faces of an interface no longer overlap at this RelativeMotion."""
    return int(bits(parted(motion, tables.interfaces[0, p].slide_least, tables.interfaces[0, p].slide_most)))


@inlined
def forces_of_loose(tables, blocks, law, p, held, frame, motion, damped):
    """What an interface does in those walls that are held (bits), where its contacts stay springs, which are returned:
    it waits until the intact interfaces have pushed their bodies."""
    waiting, k, m = blocks.waiting, p * at.WAITING, p * at.LAST
    start, stop = tables.interfaces[0, p].start, tables.interfaces[0, p].stop
    resultant, elastic = loose_springs(tables.contacts, blocks.contacts, law.plain, start, stop, motion,
                                       flags_of(held & ~parted_in(tables, p, motion)))
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
    """Add to its bodies what an interface does in those walls (bits) that wait, which are returned."""
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
    """`damage.mechanics.contacts.elastic_trial` in eight walls: opening [m] and normal force [N]; plain: where nothing
    softens or crushes."""
    opening = motion.opening + contact.offset * motion.rotation
    if plain:
        opening = opening + 0.0  # as a closure of zero would be
        return opening, contact.kn * opening
    opening = opening + load(loose, k + at.CLOSURE)
    return opening, either(opening > 0.0, load(loose, k + at.KT), contact.kn) * opening


@inlined
def loose_trial(contact, loose, k, motion, plain):
    """The same with the shear force [N], and where the contact is open and needs no law."""
    opening, sigma = loose_spring(contact, loose, k, motion, plain)
    tau0 = load(loose, k + at.SHEAR_STRESS)
    tau = tau0 + contact.ks * (motion.shear - load(loose, k + at.SHEAR0))
    return opening, sigma, tau, (opening > 0.0) & (opening <= load(loose, k + at.IDLE)) & (tau0 == 0.0)


@inlined
def loose_springs(contacts, loose, plain, start, stop, motion, elastic):
    """`damage.mechanics.contacts.elastic_resultant` in eight walls, of which it leaves those elastic whose contacts all
    are."""
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
    """`damage.mechanics.contacts.remember` in the walls that are elastic."""
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
