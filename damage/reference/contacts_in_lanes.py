"""Contacts of a pair in eight lanes at once, to the same bits as contacts.py one by one.

Of a whole pair they are springs that nothing has happened to, where their stresses are read.  Of a broken pair they are
springs from where the law has left them: that is copied into a block when the pair breaks, changes there while none of
them is beyond its strength, and goes back where the law is asked and where a run ends.
"""

import numpy as np

from damage.reference import blocks as at
from damage.reference.blocks import INDEX
from damage.reference.compiled import compiled, inlined
from damage.reference.eight import add, bits, either, flags_of, load, spread, store
from damage.reference.pairs import Forces, Push, damp_eight, push_lanes, push_where
from damage.reference.tables import READ_OPENING, READ_SHEAR, READ_SIGMA, READ_TAU
from damage.wall import joint_law


@compiled
def loosen(tables, blocks):
    """Copy the contacts of all broken pairs into their blocks."""
    blocks.loose[:] = 0
    for lane in range(tables.pairs.shape[0]):
        for p in range(tables.pairs.shape[1]):
            if tables.pairs[lane, p].broken:
                take_pair(tables, blocks, lane, p)


@compiled
def fasten(tables, blocks):
    """Copy them back."""
    for p in range(tables.pairs.shape[1]):
        for lane in range(tables.pairs.shape[0]):
            if blocks.loose[p] >> lane & 1:
                give_pair(tables, blocks, lane, p)
    blocks.loose[:] = 0


@compiled
def take_pair(tables, blocks, lane, p):
    """Copy the contacts of a pair in this lane into their blocks."""
    for i in range(tables.pairs[0, p].start, tables.pairs[0, p].stop):
        contact, k, loose = tables.contacts[lane, i], INDEX(i) * at.LOOSE + INDEX(lane), blocks.contacts
        loose[k + at.KT], loose[k + at.TAU0], loose[k + at.SHEAR0] = contact.kt, contact.tau0, contact.shear0
        loose[k + at.TENSILE], loose[k + at.COHESIVE] = contact.tensile_force, contact.cohesive_force
        loose[k + at.IDLE] = contact.idle
        loose[k + at.CLOSURE], loose[k + at.CRUSHING] = contact.closure, contact.crushing_force
        loose[k + at.SIGMA0] = contact.sigma0
        loose[k + at.MOVES] = 1.0 if contact.idle >= 0.0 or contact.soft else 0.0
    blocks.loose[p] |= 1 << lane


@compiled
def give_pair(tables, blocks, lane, p):
    """Copy what has changed of them back."""
    for i in range(tables.pairs[0, p].start, tables.pairs[0, p].stop):
        contact, k = tables.contacts[lane, i], INDEX(i) * at.LOOSE + INDEX(lane)
        contact.tau0, contact.shear0 = blocks.contacts[k + at.TAU0], blocks.contacts[k + at.SHEAR0]
        contact.sigma0 = blocks.contacts[k + at.SIGMA0]


@inlined
def whole_springs(contacts, start, stop, gap):
    """Forces of a whole pair's contacts one by one [N, N m]."""
    normal, along, couple = spread(0.0), spread(0.0), spread(0.0)
    for i in range(start, stop):
        contact = contacts[0, i]
        sigma = contact.kn * (gap.middle + contact.offset * gap.turn)
        normal = normal + sigma
        along = along + contact.ks * gap.shear
        couple = couple + sigma * contact.offset
    return Forces(normal, along, couple)


@inlined
def read_whole_joints(tables, bench, start, stop, gap, whole):
    """`contacts.read_joints` of a pair in those of its lanes that are whole (bits), by way of the bench."""
    readings = tables.readings
    for i in range(start, stop):
        contact, area = tables.contacts[0, i], tables.joints[0, i].area
        # Zero is added as a closure and a force of before would be: it takes the sign from what is zero.
        opening = gap.middle + contact.offset * gap.turn + 0.0
        store(bench, at.OPENED, opening)
        store(bench, at.SHEARED, gap.shear)
        store(bench, at.SIGMA, contact.kn * opening / area)
        store(bench, at.TAU, (contact.ks * gap.shear + 0.0) / area)
        for lane in range(tables.joints.shape[0]):
            if whole >> lane & 1:
                k = INDEX(lane)
                readings[lane, READ_OPENING, i] = bench[at.OPENED + k]
                readings[lane, READ_SHEAR, i] = bench[at.SHEARED + k]
                readings[lane, READ_SIGMA, i] = bench[at.SIGMA + k]
                readings[lane, READ_TAU, i] = bench[at.TAU + k]


@inlined
def forces_of_loose(tables, blocks, law, p, held, frame, gap, damped):
    """What a pair does in those of its lanes that are held (bits), where its contacts stay springs: it waits, until the
    pairs that are whole have done what they do."""
    waiting, k, m = blocks.waiting, p * at.WAITING, p * at.LAST
    start, stop = tables.pairs[0, p].start, tables.pairs[0, p].stop
    forces, elastic = loose_springs(tables.contacts, blocks.contacts, law, start, stop, gap, flags_of(held))
    remember_loose(tables.contacts, blocks.contacts, law.plain, start, stop, gap, elastic)
    if damped:
        forces, work = damp_eight(blocks.last, m, load(blocks.bench, at.RATE), gap, forces, elastic)
        store(waiting, k + at.WORK, work)
    pushed = push_where(elastic, frame, forces)
    store(waiting, k + at.PUSH_X, pushed.x)
    store(waiting, k + at.PUSH_Z, pushed.z)
    store(waiting, k + at.MOMENT_A, pushed.moment_a)
    store(waiting, k + at.MOMENT_B, pushed.moment_b)
    blocks.waits[p] = bits(elastic)


@inlined
def push_waiting(blocks, p, flags, damped):
    """Add to its bodies what a pair does in those of its lanes (bits) that wait, which are returned."""
    waits, waiting, k = flags & int(blocks.loose[p]) & int(blocks.waits[p]), blocks.waiting, INDEX(p) * at.WAITING
    if waits:
        push_lanes(blocks.bodies, blocks.first[p], blocks.second[p],
                   Push(load(waiting, k + at.PUSH_X), load(waiting, k + at.PUSH_Z), load(waiting, k + at.MOMENT_A),
                        load(waiting, k + at.MOMENT_B)))
        if damped:
            add(blocks.sums, at.DAMPED + INDEX(p % 8 * 8), load(waiting, k + at.WORK))
    return waits


@inlined
def loose_spring(contact, loose, k, gap, plain):
    """`contacts.spring` in eight lanes: opening [m] and normal force [N]; plain: where nothing softens or crushes."""
    opening = gap.middle + contact.offset * gap.turn
    if plain:
        opening = opening + 0.0  # as a closure of zero would be
        return opening, contact.kn * opening
    opening = opening + load(loose, k + at.CLOSURE)
    return opening, either(opening > 0.0, load(loose, k + at.KT), contact.kn) * opening


@inlined
def loose_springs(contacts, loose, law, start, stop, gap, elastic):
    """`contacts.springs` in eight lanes, of which it leaves those elastic whose contacts all are."""
    held = elastic
    normal, along, couple = spread(0.0), spread(0.0), spread(0.0)
    for i in range(start, stop):
        contact, k = contacts[0, i], INDEX(i) * at.LOOSE
        opening, sigma = loose_spring(contact, loose, k, gap, law.plain)
        tau0, shear0, idle = load(loose, k + at.TAU0), load(loose, k + at.SHEAR0), load(loose, k + at.IDLE)
        tau = tau0 + contact.ks * (gap.shear - shear0)
        is_open = (opening > 0.0) & (opening <= idle) & (tau0 == 0.0)
        store(loose, k + at.SHEAR0, either(held & is_open, gap.shear, shear0))
        within = joint_law.stays_elastic(sigma, tau, load(loose, k + at.TENSILE), load(loose, k + at.COHESIVE),
                                         joint_law.friction_left(idle >= 0.0, law.material))
        if not law.plain:
            within = within & joint_law.withstands(sigma, load(loose, k + at.CRUSHING))
        elastic = elastic & (within | is_open)
        normal = normal + either(is_open, 0.0, sigma)
        along = along + either(is_open, 0.0, tau)
        couple = couple + either(is_open, 0.0, sigma * contact.offset)
    return Forces(normal, along, couple), elastic


@inlined
def remember_loose(contacts, loose, plain, start, stop, gap, elastic):
    """`contacts.remember` in the lanes that are elastic."""
    for i in range(start, stop):
        contact, k = contacts[0, i], INDEX(i) * at.LOOSE
        if plain:
            moves = elastic & (load(loose, k + at.IDLE) >= 0.0)
        else:
            crushing, sigma0 = load(loose, k + at.CRUSHING), load(loose, k + at.SIGMA0)
            _, sigma = loose_spring(contact, loose, k, gap, plain)
            store(loose, k + at.SIGMA0, either(elastic & (crushing < np.inf), sigma, sigma0))
            moves = elastic & (load(loose, k + at.MOVES) > 0.0)
        tau0, shear0 = load(loose, k + at.TAU0), load(loose, k + at.SHEAR0)
        store(loose, k + at.TAU0, either(moves, tau0 + contact.ks * (gap.shear - shear0), tau0))
        store(loose, k + at.SHEAR0, either(moves, gap.shear, shear0))
