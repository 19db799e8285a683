"""The compiled time step of the reference solver: rigid blocks, contact points, central differences.

Units are SI.  Bodies move by (u_x, u_z, rotation x towards z) since the wall was built, in the frame
of the base; the last body is the ground and never moves.

A step is: `integrate` (bodies.py); `all_forces`, which asks for the relative motion of all pairs and what they do as
one spring each (pairs.py), eight at a time (blocks.py), and then does those that are not whole, contact by contact
(contacts.py), whose stresses are read after the last step.  It is one wall's, or that of up to eight walls side by
side, its lanes, which share the bricks and the stiffnesses of the joints; a wall's bits are the same either way, as
each of its numbers is made by the same operations in the same order.
"""

from typing import NamedTuple

import numpy as np

from damage.reference import blocks as at
from damage.reference.blocks import INDEX, NONE, ONE, WIDTH, pack, place_of, unpack
from damage.reference.bodies import adapt, clear, integrate, total
from damage.reference.compiled import block_loop, compiled
from damage.reference.contacts import joint_forces, read_joints, remember, springs, sum_of_stresses
from damage.reference.pairs import (
    Gap,
    change,
    damp,
    damped_lanes,
    damped_rows,
    keep_last,
    push,
    relative_motion,
    whole_lanes,
    whole_rows,
)
from damage.reference.tables import DAMPING
from damage.wall.joint_law import Material

CHUNK = INDEX(16)
"""Pairs that are passed by together where all are whole."""


class Law(NamedTuple):
    """material: of the joint law; threshold [m] of first passings."""

    material: Material
    threshold: float


@compiled
def run_steps(tables, blocks, lanes, law, controls, field, clock):
    """Advance from places whose forces are known; afterwards they are known again.

    lanes: 1, or 8, of which the first have a row in the tables; controls: (rows, 5) time step [s], local damping [-],
    alpha [1/s], beta [s], adaptive damping [-]; field: (rows, steps, 3) acceleration of the base along x and z and
    gravity, of each step [m/s2]; clock: (rows,) steps that came before.  Call `find_forces` once before the first run:
    out of numba's cache, runs then use its own machine code instead of a slower copy that is part of this function.
    """
    pack(tables, blocks, lanes)
    damped = adaptive = False
    for lane in range(controls.shape[0]):
        damped |= controls[lane, 3] > 0.0
        adaptive |= controls[lane, 4] > 0.0
    if damped:
        remember_all(tables, blocks, lanes)
    n_steps = field.shape[1]
    for step in range(n_steps):
        integrate(tables, blocks, lanes, controls, field, step)
        if adaptive:
            adapt(tables, blocks, lanes, controls)
        all_forces(tables, blocks, lanes, law, clock, step + 1, step == n_steps - 1, damped)
    unpack(tables, blocks, lanes)


@compiled
def find_forces(tables, blocks, lanes, law, clock, step, singly, damped):
    """Forces [N, N m] on every body at the present places; calling it twice changes nothing.  As `all_forces`, with
    step 0 and not damped: constants from within would have each compiled once more."""
    pack(tables, blocks, lanes)
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
    if not singly:
        clear(blocks.broken, NONE, INDEX(len(blocks.broken)))
        if lanes == 1:
            forces_of_one(blocks, damped)
        else:
            forces_of_lanes(blocks, damped)
    forces_of_broken(tables, blocks, lanes, law, clock, step, singly, damped)
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
    pairs, bodies, bench, own = blocks.pairs, blocks.bodies, blocks.bench, blocks.own
    first, second, sums, broken, width = blocks.first, blocks.second, blocks.sums, blocks.broken, INDEX(blocks.width)
    block = NONE
    while block < INDEX(len(own)) // at.OWN:
        row, p, m = block * WIDTH, block * at.PAIR, block * at.OWN
        fetch(bodies, first, second, row, bench)
        if damped:
            damped_rows(pairs, p, bench, at.OF_A, at.OF_B, own, m, bench, width)
            add_work(bench, sums, NONE, width)
        else:
            whole_rows(pairs, p, bench, at.OF_A, at.OF_B, own, m, bench, width)
        note_broken(broken, row // CHUNK * WIDTH, own, m, width)
        push_rows(bodies, first, second, row, bench)
        block += ONE


@compiled
def forces_of_lanes(blocks, damped):
    """Forces of the pairs of several walls that are whole: a pair in eight lanes is a block."""
    pairs, bodies, bench, own = blocks.pairs, blocks.bodies, blocks.bench, blocks.own
    first, second, sums, broken, width = blocks.first, blocks.second, blocks.sums, blocks.broken, INDEX(blocks.width)
    row = NONE
    while row < INDEX(len(own)) // at.OWN:
        a, b, p, m = first[row], second[row], place_of(row, at.PAIR), row * at.OWN
        if damped:
            damped_lanes(pairs, p, bodies, a, b, own, m, bench, width)
            add_work(bench, sums, row % WIDTH * WIDTH, width)
        else:
            whole_lanes(pairs, p, bodies, a, b, own, m, bench, width)
        push_lanes(bodies, a, b, bench, width)
        note_broken(broken, row // CHUNK * WIDTH, own, m, width)
        row += ONE


@compiled
def forces_of_broken(tables, blocks, lanes, law, clock, step, singly, damped):
    """Forces of the pairs that are not whole, or of all, contact by contact: after the others, in the same order
    whether a wall is alone or among others."""
    for chunk in range(len(blocks.broken) // 8):
        for lane in range(tables.pairs.shape[0]):
            if singly or any_broken(blocks.broken, chunk, lane, lanes):
                forces_of_chunk(tables, blocks, lanes, law, clock[lane] + step, lane, chunk, singly, damped)


@block_loop
def forces_of_chunk(tables, blocks, lanes, law, step, lane, chunk, singly, damped):
    """The same of the pairs of a chunk, in one lane."""
    for p in range(16 * chunk, min(16 * chunk + 16, tables.pairs.shape[1])):
        m = place_of(INDEX(p * lanes + lane), at.OWN)
        if singly or blocks.own[m + at.WHOLE] == 0.0:
            forces_of_pair(tables, blocks, lanes, law, step, lane, p, m, singly, damped)


@block_loop
def forces_of_pair(tables, blocks, lanes, law, step, lane, p, m, singly, damped):
    """The same of one pair, whose own fields begin at m; `singly` writes what its contacts do, too."""
    own, bodies, contacts = blocks.own, blocks.bodies, tables.contacts
    start, stop = tables.pairs[0, p].start, tables.pairs[0, p].stop  # of all lanes: fewer to fetch from memory
    a, b = blocks.first[p] + INDEX(lane), blocks.second[p] + INDEX(lane)
    frame, gap = relative_motion(blocks.pairs, place_of(INDEX(p), at.PAIR), bodies, a, b)
    forces, elastic = springs(contacts, lane, start, stop, gap, law.material)
    steady = change(own, m, forces)
    if elastic:
        remember(contacts, lane, start, stop, gap)
    else:
        before = Gap(own[m + at.MIDDLE], own[m + at.SHEAR], own[m + at.TURNED])
        forces, steady, failed = joint_forces(tables, law, lane, p, step, gap, before, damped)
        if failed:
            tables.pairs[lane, p].broken = 1
            own[m + at.OPENING] = -np.inf
    if singly:
        read_joints(contacts, tables.joints, lane, start, stop, gap)
    if damped:
        with_damping, work = damp(own, m, blocks.bench[at.RATE + INDEX(lane)], gap, forces, steady)
        keep_last(own, m, gap, forces)
        blocks.sums[at.DAMPED + INDEX(p % 8 * lanes + lane)] += work
        forces = with_damping
    push_pair(bodies, a, b, push(frame, forces))


@block_loop
def note_broken(broken, c, own, m, width):
    """Note in the eight numbers of a chunk whether a pair of a block is not whole."""
    i = NONE
    while i < width:
        broken[c + i] += 1.0 - own[m + i + at.WHOLE]
        i += ONE


@compiled
def any_broken(broken, chunk, lane, lanes):
    """Whether a pair of a chunk is not whole, in this lane."""
    if lanes > 1:
        return broken[8 * chunk + lane] > 0.0
    total = 0.0
    for i in range(8 * chunk, 8 * chunk + 8):
        total += broken[i]
    return total > 0.0


@block_loop
def push_pair(bodies, a, b, pushed):
    """Add what one pair does to its bodies."""
    bodies[a + at.FX] += pushed.x
    bodies[a + at.FZ] += pushed.z
    bodies[a + at.MOMENT] += pushed.moment_a
    bodies[b + at.FX] -= pushed.x
    bodies[b + at.FZ] -= pushed.z
    bodies[b + at.MOMENT] -= pushed.moment_b


@block_loop
def fetch(bodies, first, second, row, bench):
    """Bring the places of the bodies of eight pairs on the bench, of the rows from this one on."""
    i = NONE
    while i < WIDTH:
        a, b = first[row + i], second[row + i]
        bench[at.OF_A + at.X + i], bench[at.OF_B + at.X + i] = bodies[a + at.X], bodies[b + at.X]
        bench[at.OF_A + at.Z + i], bench[at.OF_B + at.Z + i] = bodies[a + at.Z], bodies[b + at.Z]
        bench[at.OF_A + at.COS1 + i], bench[at.OF_B + at.COS1 + i] = bodies[a + at.COS1], bodies[b + at.COS1]
        bench[at.OF_A + at.SIN + i], bench[at.OF_B + at.SIN + i] = bodies[a + at.SIN], bodies[b + at.SIN]
        i += ONE


@block_loop
def push_rows(bodies, first, second, row, bench):
    """Add what eight pairs do to their bodies."""
    i = NONE
    while i < WIDTH:
        a, b = first[row + i], second[row + i]
        bodies[a + at.FX] += bench[at.PUSH_X + i]
        bodies[a + at.FZ] += bench[at.PUSH_Z + i]
        bodies[a + at.MOMENT] += bench[at.MOMENT_A + i]
        bodies[b + at.FX] -= bench[at.PUSH_X + i]
        bodies[b + at.FZ] -= bench[at.PUSH_Z + i]
        bodies[b + at.MOMENT] -= bench[at.MOMENT_B + i]
        i += ONE


@block_loop
def push_lanes(bodies, a, b, bench, width):
    """Add what a pair does to its bodies in eight lanes."""
    i = NONE
    while i < width:
        bodies[a + at.FX + i] += bench[at.PUSH_X + i]
        bodies[a + at.FZ + i] += bench[at.PUSH_Z + i]
        bodies[a + at.MOMENT + i] += bench[at.MOMENT_A + i]
        i += ONE
    i = NONE
    while i < width:
        bodies[b + at.FX + i] -= bench[at.PUSH_X + i]
        bodies[b + at.FZ + i] -= bench[at.PUSH_Z + i]
        bodies[b + at.MOMENT + i] -= bench[at.MOMENT_B + i]
        i += ONE


@block_loop
def add_work(bench, sums, part, width):
    """Add the work of damping of eight pairs to its sum."""
    i = NONE
    while i < width:
        sums[at.DAMPED + part + i] += bench[at.WORK + i]
        i += ONE


@compiled
def remember_all(tables, blocks, lanes):
    """What damping proportional to stiffness compares the next step with, of the present places."""
    for lane in range(tables.pairs.shape[0]):
        for p in range(tables.pairs.shape[1]):
            pair, here = tables.pairs[lane, p], INDEX(lane)
            _, gap = relative_motion(blocks.pairs, place_of(INDEX(p), at.PAIR), blocks.bodies, blocks.first[p] + here,
                                     blocks.second[p] + here)
            keep_last(blocks.own, place_of(INDEX(p * lanes + lane), at.OWN), gap,
                      sum_of_stresses(tables.contacts, lane, pair.start, pair.stop, gap))
