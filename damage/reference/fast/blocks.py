"""Memory layout of the fast step: blocks of eight slots, whose fields are vectors.

A slot is a row of a table of one wall.  In a single wall, slots are rows; in a batch, row r of wall w is slot 8 r + w.
Eight slots are a block.  Its fields follow one another, each a vector of eight numbers (`damage.mechanics.eight`): of
eight rows of a single wall, or of one row in eight walls.
"""

from typing import NamedTuple

import numba
import numpy as np

from damage.mechanics import eight
from damage.mechanics.eight import load, store
from damage.mechanics.tables import STATE
from damage.reference.fast.compiled import compiled

# Unsigned: numba checks signed indices for negative ones, which costs time.  Without numba the sum of a Python integer
# and an unsigned one would be a float.
INDEX = np.int64 if numba.config.DISABLE_JIT else np.uint64


def _fields(first, n, step=8):
    """Indices in a block at which n fields begin; first: number of the first of them."""
    return [INDEX(step * (first + k)) for k in range(n)]


WIDTH, ONE, NONE = INDEX(eight.WIDTH), INDEX(1), INDEX(0)
"""Slots of a block, and the constants one and zero as indices."""
# Indices of the fields, and size, of a block of bodies;
X, Z, COS1, SIN, FX, FZ, MOMENT, ROTATION, VX, VZ, VROTATION, MASS, INERTIA, INVERSE_X, INVERSE_Z, INVERSE_ROTATION, \
    BODY = _fields(0, 17)
# of interfaces, the fields of INTERFACE that are equal in all walls;
AX, AZ, BX, BZ, KN, KS, KN_OFFSET, KN_OFFSET2, REACH, SLIDE_LOSS, HEAD, INTERFACE = _fields(0, 12)
# of the elastic limits of interfaces, different in each wall;
OPENING, SLIDE, LIMITS = _fields(0, 3)
# of relative motion and resultant in the last step, for stiffness-proportional damping;
MIDDLE, SHEAR, ROTATED, NORMAL, ALONG, COUPLE, LAST = _fields(0, 7)
# of the forces of failed interfaces, which are added after those of the intact ones;
PUSH_X, PUSH_Z, MOMENT_A, MOMENT_B, WORK, WAITING = _fields(0, 6)
# of the readings of contact points, in the order of `readings`;
OPENED, SHEARED, SIGMA, TAU, READ = _fields(0, 5)
# and of the bench: parameters of the step, equal for all bodies of a wall.
BASE_X, BASE_Z, STEP, ALPHA, LOCAL, RATE, BENCH = _fields(0, 7)
# Eight partial sums, of rows 0, 8, 16 and so on, of rows 1, 9, 17 and so on: for a single wall the lanes of a vector.
SWEPT_X, SWEPT_Z, DRIVEN, TAKEN, DAMPED, KINETIC, SUMS = _fields(0, 7, 64)
# Fields of the state of a contact point of a failed interface, by name.
COPIED = ("shear_stress", "shear0", "normal_stress", "idle", "elastic_tensile_strength", "elastic_cohesion",
          "elastic_friction", "elastic_tension_stiffness", "closure", "kappa", "elastic_compressive_strength")
COLUMNS, CHANGED = tuple(STATE.names.index(name) for name in COPIED), 3
"""Columns of STATE in the order of COPIED; number of the first ones, which elastic steps change."""
SHEAR_STRESS, SHEAR0, NORMAL_STRESS, IDLE, TENSILE, COHESION, FRICTION, KT, CLOSURE, KAPPA, COMPRESSIVE, LOOSE = \
    _fields(0, len(COPIED) + 1)


class Blocks(NamedTuple):
    """Flat arrays of blocks of a single wall or of a batch.

    rows: single wall: Pose and forces of each body, eight numbers in a row; starts: (bodies,) indices of the rows;
    first, second: (interfaces,) indices of the fields of bodies a and b, in `rows` of a single wall, in `bodies` of the
    first wall of a batch; bench: parameters of the step; others: a byte for each block of interfaces, its bits those
    that are not intact; loose: a byte for each interface, its bits the walls whose contact points are in `contacts`;
    waits: those of them that stay elastic, with their forces in `waiting`; readings: of all contact points of a batch.
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
    """Blocks of walls with these interfaces (table INTERFACE), without their states, which `pack` copies.

    lanes: 1 for a single wall, 8 for a batch.
    """
    def blocks_of(rows, size):
        return -(-rows // 8) * int(size)

    row = np.zeros(-(-len(interfaces) // 8) * 8, int) + (n_bodies - 1)  # padding: the last support with itself
    a, b = row.copy(), row
    a[:len(interfaces)], b[:len(interfaces)] = interfaces["a"], interfaces["b"]
    shared = aligned_zeros(blocks_of(len(interfaces), INTERFACE)).reshape(-1, int(INTERFACE) // 8, 8)
    for number, name in enumerate(interfaces.dtype.names[:shared.shape[1]]):
        shared[:, number].flat[:len(interfaces)] = interfaces[name]
    limits = aligned_zeros(blocks_of(len(interfaces) * lanes, LIMITS))
    limits[:] = np.inf
    return Blocks(
        bodies=aligned_zeros(blocks_of(n_bodies * lanes, BODY)),
        rows=aligned_zeros(blocks_of(n_bodies, 64) if lanes == 1 else 0),
        starts=np.arange(0, 8 * blocks_of(n_bodies, 8), 8).astype(INDEX), interfaces=shared.ravel(), limits=limits,
        last=aligned_zeros(blocks_of(len(interfaces) * lanes, LAST)), bench=aligned_zeros(int(BENCH)),
        sums=aligned_zeros(int(SUMS)),
        others=np.zeros(-(-len(interfaces) * lanes // 8), np.uint8), loose=np.zeros(len(interfaces), np.uint8),
        waits=np.zeros(len(interfaces), np.uint8),
        waiting=aligned_zeros(blocks_of(len(interfaces) * lanes, WAITING) if lanes > 1 else 0),
        contacts=aligned_zeros(blocks_of(n_contacts * lanes, LOOSE) if lanes > 1 else 0),
        readings=aligned_zeros(blocks_of(n_contacts * lanes, READ) if lanes > 1 else 0),
        first=_first(a, lanes), second=_first(b, lanes))


def aligned_zeros(n):
    """Array of n zeros that is aligned to the 64 bytes of a cache line, so that a vector lies in one line."""
    bytes_ = np.zeros(8 * n + 64, np.uint8)
    first = -bytes_.ctypes.data % 64
    return bytes_[first:first + 8 * n].view(float)


def _first(row, lanes):
    """Indices `Blocks.first` or `second` for rows of bodies, (interfaces,)."""
    if lanes == 1:
        return (8 * row).astype(INDEX)
    slot = row * lanes
    return (slot // 8 * int(BODY) + slot % 8).astype(INDEX)


@compiled
def place_of(slot, size):
    """Index of the first field of a slot in an array of blocks; size: of a block."""
    return slot // WIDTH * size + slot % WIDTH


@compiled
def pack(tables, blocks, lanes):
    """Copy the state of the bodies and the elastic limits of the interfaces from the tables into the blocks."""
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
    """Copy displacements, velocities and forces of the bodies from the blocks into the tables."""
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
    """Copy the elastic limits of the interfaces into the blocks; -inf where a contact point has failed."""
    for w in range(tables.interfaces.shape[0]):
        for p in range(tables.interfaces.shape[1]):
            interface, k = tables.interfaces[w, p], place_of(INDEX(p * lanes + w), LIMITS)
            blocks.limits[k + OPENING] = -np.inf if interface.failed else interface.largest_opening
            blocks.limits[k + SLIDE] = interface.largest_slide


@compiled
def clear(sums, start, stop):
    """Set the sums from index start to before stop to zero."""
    while start < stop:
        store(sums, start, 0.0)
        start += WIDTH


@compiled
def total(sums, first, lanes):
    """Add the eight partial sums of a sum in their order; the result of wall w is at `first` + w."""
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
