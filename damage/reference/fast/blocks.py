"""The tables of up to eight walls side by side, as the compiled step works on them: blocks of eight elements.

A slot is a row of a table of one wall.  One wall alone has its rows as slots; several walls w have slot = 8 row + w.
Either way eight slots are a block, whose fields lie one after the other, eight numbers each: what is done to all
elements alike is done to eight numbers as one value (`damage.mechanics.eight`), of eight walls or of eight rows.
"""

from typing import NamedTuple

import numba
import numpy as np

from damage.mechanics import eight
from damage.mechanics.eight import load, store
from damage.mechanics.tables import STATE
from damage.reference.fast.compiled import compiled

# Unsigned, as a signed index might count from an array's end: to look costs time.  Where numba is switched off, plain
# integers and unsigned ones would add to floats.
INDEX = np.int64 if numba.config.DISABLE_JIT else np.uint64


def _fields(first, n, step=8):
    """Where n fields begin in a block, the first of them as the field of this number."""
    return [INDEX(step * (first + k)) for k in range(n)]


WIDTH, ONE, NONE = INDEX(eight.WIDTH), INDEX(1), INDEX(0)
"""Elements of a block; and indices to count with."""
# Where fields begin in a block of bodies;
X, Z, COS1, SIN, FX, FZ, MOMENT, ROTATION, VX, VZ, VROTATION, MASS, INERTIA, INVERSE_X, INVERSE_Z, INVERSE_ROTATION, \
    BODY = _fields(0, 17)
# of interfaces, those of INTERFACE that all walls share;
AX, AZ, BX, BZ, KN, KS, KN_OFFSET, KN_OFFSET2, REACH, SLIDE_LOSS, HEAD, INTERFACE = _fields(0, 12)
# of what leaves them intact, which each wall has of its own;
OPENING, SLIDE, LIMITS = _fields(0, 3)
# of the relative motion and the resultant in the last step, with which damping compares them;
MIDDLE, SHEAR, ROTATED, NORMAL, ALONG, COUPLE, LAST = _fields(0, 7)
# of what a failed interface does until its turn comes;
PUSH_X, PUSH_Z, MOMENT_A, MOMENT_B, WORK, WAITING = _fields(0, 6)
# of what a sample reads of a contact point, in the order of `readings`;
OPENED, SHEARED, SIGMA, TAU, READ = _fields(0, 5)
# and of the bench, where one block is worked on.
BASE_X, BASE_Z, STEP, ALPHA, LOCAL, RATE, BENCH = _fields(0, 7)
# Sums are taken in eight parts, the first of rows 0, 8, 16 and so on: those of one wall are the elements of a block.
SWEPT_X, SWEPT_Z, DRIVEN, TAKEN, DAMPED, KINETIC, SUMS = _fields(0, 7, 64)
# Of a contact of a failed interface: fields of its state, by name, and its compressive strength.
COPIED = ("shear_stress", "shear0", "normal_stress", "idle", "elastic_tensile_strength", "elastic_cohesion",
          "elastic_friction", "elastic_tension_stiffness", "closure", "kappa")
COLUMNS, CHANGED = tuple(STATE.names.index(name) for name in COPIED), 3
"""Columns of STATE in this order; how many of them, the first ones, a step without the law changes."""
SHEAR_STRESS, SHEAR0, NORMAL_STRESS, IDLE, TENSILE, COHESION, FRICTION, KT, CLOSURE, KAPPA, COMPRESSIVE, LOOSE = \
    _fields(0, len(COPIED) + 2)


class Blocks(NamedTuple):
    """Arrays of blocks, flat; first, second: (interfaces,) where the fields of bodies a and b begin, in `bodies` of
    the first wall, of one wall in `rows`.

    rows: of one wall alone, where places and forces of a body lie side by side, eight numbers in this order; starts:
    (bodies,) where they begin; others: a byte a block of interfaces, whose bits are those that do not stay intact;
    loose: a byte an interface, whose bits are the walls whose contacts are in `contacts`, and waits, those of them that
    stay springs and whose forces are in `waiting`; readings: of all contacts of several walls.
    """

    bodies: np.ndarray
    rows: np.ndarray
    starts: np.ndarray
    interfaces: np.ndarray
    limits: np.ndarray
    last: np.ndarray
    bench: np.ndarray
    sums: np.ndarray
    others: np.ndarray
    loose: np.ndarray
    waits: np.ndarray
    waiting: np.ndarray
    contacts: np.ndarray
    readings: np.ndarray
    first: np.ndarray
    second: np.ndarray


def make_blocks(interfaces, n_bodies, n_contacts, lanes):
    """Blocks of walls that share these interfaces (a table); their limits and states are still to be packed."""
    def blocks_of(rows, size):
        return -(-rows // 8) * int(size)

    row = np.zeros(-(-len(interfaces) // 8) * 8, int) + (n_bodies - 1)  # none: the ground against itself
    a, b = row.copy(), row
    a[:len(interfaces)], b[:len(interfaces)] = interfaces["a"], interfaces["b"]
    shared = _zeros(blocks_of(len(interfaces), INTERFACE)).reshape(-1, int(INTERFACE) // 8, 8)
    for number, name in enumerate(interfaces.dtype.names[:shared.shape[1]]):
        shared[:, number].flat[:len(interfaces)] = interfaces[name]
    limits = _zeros(blocks_of(len(interfaces) * lanes, LIMITS))
    limits[:] = np.inf
    return Blocks(
        bodies=_zeros(blocks_of(n_bodies * lanes, BODY)), rows=_zeros(blocks_of(n_bodies, 64) if lanes == 1 else 0),
        starts=np.arange(0, 8 * blocks_of(n_bodies, 8), 8).astype(INDEX), interfaces=shared.ravel(), limits=limits,
        last=_zeros(blocks_of(len(interfaces) * lanes, LAST)), bench=_zeros(int(BENCH)), sums=_zeros(int(SUMS)),
        others=np.zeros(-(-len(interfaces) * lanes // 8), np.uint8), loose=np.zeros(len(interfaces), np.uint8),
        waits=np.zeros(len(interfaces), np.uint8),
        waiting=_zeros(blocks_of(len(interfaces) * lanes, WAITING) if lanes > 1 else 0),
        contacts=_zeros(blocks_of(n_contacts * lanes, LOOSE) if lanes > 1 else 0),
        readings=_zeros(blocks_of(n_contacts * lanes, READ) if lanes > 1 else 0),
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
    """Copy places and motions of the bodies, and what leaves interfaces intact, from the tables into their blocks."""
    bodies = blocks.bodies
    for row in range(tables.place.shape[1]):
        for w in range(tables.place.shape[0]):  # within: eight walls share what is fetched
            k = place_of(INDEX(row * lanes + w), BODY)
            for field, i in ((X, 0), (Z, 1), (ROTATION, 2)):
                bodies[k + field] = tables.place[w, row, i]
            for field, i in ((FX, 0), (FZ, 1), (MOMENT, 2)):
                bodies[k + field] = tables.force[w, row, i]
            for field, i in ((VX, 0), (VZ, 1), (VROTATION, 2)):
                bodies[k + field] = tables.velocity[w, row, i]
            for field, i in ((INVERSE_X, 0), (INVERSE_Z, 1), (INVERSE_ROTATION, 2)):
                bodies[k + field] = tables.inverse_mass[w, row, i]
            for field, i in ((MASS, 0), (INERTIA, 2)):
                bodies[k + field] = tables.mass[w, row, i]
            for field, i in ((COS1, 0), (SIN, 1)):
                bodies[k + field] = tables.trig[w, row, i]
    pack_limits(tables, blocks, lanes)


@compiled
def unpack(tables, blocks, lanes):
    """Copy places, velocities and forces of the bodies from their blocks into the tables."""
    bodies = blocks.bodies
    for row in range(tables.place.shape[1]):
        for w in range(tables.place.shape[0]):  # within: eight walls share what is fetched
            k = place_of(INDEX(row * lanes + w), BODY)
            for field, i in ((X, 0), (Z, 1), (ROTATION, 2)):
                tables.place[w, row, i] = bodies[k + field]
            for field, i in ((FX, 0), (FZ, 1), (MOMENT, 2)):
                tables.force[w, row, i] = bodies[k + field]
            for field, i in ((VX, 0), (VZ, 1), (VROTATION, 2)):
                tables.velocity[w, row, i] = bodies[k + field]
            for field, i in ((COS1, 0), (SIN, 1)):
                tables.trig[w, row, i] = bodies[k + field]


@compiled
def pack_limits(tables, blocks, lanes):
    """Copy what leaves interfaces intact into their blocks: nothing where a contact has failed."""
    for w in range(tables.interfaces.shape[0]):
        for p in range(tables.interfaces.shape[1]):
            interface, k = tables.interfaces[w, p], place_of(INDEX(p * lanes + w), LIMITS)
            blocks.limits[k + OPENING] = -np.inf if interface.failed else interface.largest_opening
            blocks.limits[k + SLIDE] = interface.largest_slide


@compiled
def clear(sums, start, stop):
    """Zero the sums from one to before another."""
    while start < stop:
        store(sums, start, 0.0)
        start += WIDTH


@compiled
def total(sums, first, lanes):
    """Take the eight parts of a sum together: that of wall w is then at `first` + w."""
    if lanes == 1:
        value = 0.0
        for part in range(8):
            value += sums[first + INDEX(part)]
        sums[first] = value
        return
    values, part = eight.spread(0.0), NONE
    while part < WIDTH:
        values = values + load(sums, first + part * WIDTH)
        part += ONE
    store(sums, first, values)
