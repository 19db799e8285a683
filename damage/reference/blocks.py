"""The tables of up to eight walls side by side, as the compiled step works on them: blocks of eight elements.

A slot is a row of a table in one lane.  One wall alone has its rows as slots; several have eight lanes, slot = 8 row +
lane.  Either way eight slots are a block, whose fields lie one after the other, eight numbers each: what is done to
all elements alike is done to eight numbers as one value (eight.py), of eight lanes or of eight rows.
"""

from typing import NamedTuple

import numba
import numpy as np

from damage.reference.compiled import compiled

# Unsigned, as a signed index might count from an array's end: to look costs time.  Where numba is switched off, plain
# integers and unsigned ones would add to floats.
INDEX = np.int64 if numba.config.DISABLE_JIT else np.uint64


def _fields(first, n, step=8):
    """Where n fields begin in a block, the first of them as the field of this number."""
    return [INDEX(step * (first + k)) for k in range(n)]


WIDTH, ONE, NONE = INDEX(8), INDEX(1), INDEX(0)
"""Elements of a block; and indices to count with."""
# Where fields begin in a block of bodies, those of PLACE and MOTION;
X, Z, COS1, SIN, FX, FZ, MOMENT, TURN, VX, VZ, SPIN, MASS, INERTIA, INVERSE_X, INVERSE_Z, INVERSE_TURN, BODY = \
    _fields(0, 17)
# of pairs, those of PAIR that all lanes share;
AX, AZ, BX, BZ, KN, KS, KN_OFFSET, KN_OFFSET2, REACH, SLIDE_LOSS, HEAD, PAIR = _fields(0, 12)
# of what leaves them whole, which each lane has of its own;
OPENING, SLIDE, LIMITS = _fields(0, 3)
# of how far their bodies had moved apart and the forces were in the last step, with which damping compares them;
MIDDLE, SHEAR, TURNED, NORMAL, ALONG, COUPLE, LAST = _fields(0, 7)
# of a contact in eight lanes, where its pair is broken, those of CONTACT, of which any wall needs the first;
TAU0, SHEAR0, IDLE, TENSILE, COHESIVE, KT, CLOSURE, CRUSHING, SIGMA0, MOVES, LOOSE = _fields(0, 11)
# of what a broken pair does until its turn comes;
PUSH_X, PUSH_Z, MOMENT_A, MOMENT_B, WORK, WAITING = _fields(0, 6)
# and of the bench, where one block is worked on.
BASE_X, BASE_Z, STEP, ALPHA, LOCAL, RATE = _fields(0, 6)
OPENED, SHEARED, SIGMA, TAU, BENCH = _fields(6, 5)
# Sums are taken in eight parts, the first of rows 0, 8, 16 and so on: those of one wall are the elements of a block.
MOMENTUM_X, MOMENTUM_Z, PUSHED, LOST, DAMPED, KINETIC, SUMS = _fields(0, 7, 64)


class Blocks(NamedTuple):
    """Arrays of blocks, flat; first, second: (pairs,) where the fields of a pair's bodies a and b begin, in `bodies` of
    the first lane, of one wall in `rows`.

    rows: of one wall alone, where places and forces of a body lie side by side, eight numbers in the order of PLACE;
    starts: (bodies,) where they begin; broken: a byte a block of pairs, whose bits are those that are not whole; loose:
    a byte a pair, whose bits are the lanes whose contacts are in `contacts`, and waits, those of them that stay springs
    and whose forces are in `waiting`.
    """

    bodies: np.ndarray
    rows: np.ndarray
    starts: np.ndarray
    pairs: np.ndarray
    limits: np.ndarray
    last: np.ndarray
    bench: np.ndarray
    sums: np.ndarray
    broken: np.ndarray
    loose: np.ndarray
    waits: np.ndarray
    waiting: np.ndarray
    contacts: np.ndarray
    first: np.ndarray
    second: np.ndarray


def make_blocks(pairs, n_bodies, n_contacts, lanes):
    """Blocks of walls that share these pairs (a table of PAIR); their limits and states are still to be packed."""
    def blocks_of(rows, size):
        return -(-rows // 8) * int(size)

    row = np.zeros(-(-len(pairs) // 8) * 8, int) + (n_bodies - 1)  # none: the ground against itself
    a, b = row.copy(), row
    a[:len(pairs)], b[:len(pairs)] = pairs["a"], pairs["b"]
    shared = _zeros(blocks_of(len(pairs), PAIR)).reshape(-1, int(PAIR) // 8, 8)
    for number, name in enumerate(pairs.dtype.names[:shared.shape[1]]):
        shared[:, number].flat[:len(pairs)] = pairs[name]
    limits = _zeros(blocks_of(len(pairs) * lanes, LIMITS))
    limits[:] = np.inf
    return Blocks(
        bodies=_zeros(blocks_of(n_bodies * lanes, BODY)), rows=_zeros(blocks_of(n_bodies, 64) if lanes == 1 else 0),
        starts=np.arange(0, 8 * blocks_of(n_bodies, 8), 8).astype(INDEX), pairs=shared.ravel(), limits=limits,
        last=_zeros(blocks_of(len(pairs) * lanes, LAST)), bench=_zeros(int(BENCH)), sums=_zeros(int(SUMS)),
        broken=np.zeros(-(-len(pairs) * lanes // 8), np.uint8), loose=np.zeros(len(pairs), np.uint8),
        waits=np.zeros(len(pairs), np.uint8),
        waiting=_zeros(blocks_of(len(pairs) * lanes, WAITING) if lanes > 1 else 0),
        contacts=_zeros(blocks_of(n_contacts * lanes, LOOSE) if lanes > 1 else 0),
        first=_first(a, lanes), second=_first(b, lanes))


def _zeros(n):
    """An array of zeros that begins where a line of the processor's cache does, 64 bytes: eight numbers of a block are
    then one line, and not the end of one and the beginning of the next."""
    bytes_ = np.zeros(8 * n + 64, np.uint8)
    first = -bytes_.ctypes.data % 64
    return bytes_[first:first + 8 * n].view(float)


def _first(row, lanes):
    if lanes == 1:
        return (8 * row).astype(INDEX)
    slot = row * lanes
    return (slot // 8 * int(BODY) + slot % 8).astype(INDEX)


@compiled
def place_of(slot, size):
    """Where the first field of a slot lies in an array of blocks of this size."""
    return slot // WIDTH * size + slot % WIDTH


@compiled
def pack(tables, blocks, lanes):
    """Copy places and motions of the bodies, and what leaves pairs whole, from the tables into their blocks."""
    place, motion, bodies = tables.place, tables.motion, blocks.bodies
    for row in range(place.shape[1]):
        for lane in range(place.shape[0]):  # within: eight lanes share what is fetched
            k = place_of(INDEX(row * lanes + lane), BODY)
            for field in range(8):
                bodies[k + X + INDEX(8 * field)] = place[lane, row, field]
                bodies[k + VX + INDEX(8 * field)] = motion[lane, row, field]
    pack_limits(tables, blocks, lanes)


@compiled
def unpack(tables, blocks, lanes):
    """Copy places and motions of the bodies from their blocks into the tables."""
    place, motion, bodies = tables.place, tables.motion, blocks.bodies
    for row in range(place.shape[1]):
        for lane in range(place.shape[0]):  # within: eight lanes share what is fetched
            k = place_of(INDEX(row * lanes + lane), BODY)
            for field in range(8):
                place[lane, row, field] = bodies[k + X + INDEX(8 * field)]
                motion[lane, row, field] = bodies[k + VX + INDEX(8 * field)]


@compiled
def pack_limits(tables, blocks, lanes):
    """Copy what leaves pairs whole into their blocks: nothing where a contact is broken."""
    for lane in range(tables.pairs.shape[0]):
        for p in range(tables.pairs.shape[1]):
            pair, at = tables.pairs[lane, p], place_of(INDEX(p * lanes + lane), LIMITS)
            blocks.limits[at + OPENING] = -np.inf if pair.broken else pair.largest_opening
            blocks.limits[at + SLIDE] = pair.largest_slide
