"""Selective mass scaling in a time step: central differences with a constant matrix in place of the masses.

    (M + dt^2/2 K0 + dt/2 C0) (v(t + dt/2) - v(t - dt/2)) = dt (f(u(t)) - M (g + a_base(t)))

K0: stiffness of the intact wall; C0: its damping.  No frequency of a wall whose tangent stiffness is at most K0 exceeds
sqrt(2) / dt.  The kinetic energy has the same matrix, by which the energy balance holds; input is work on M alone.
The solution is by a block factor L D L' (`damage.mechanics.factor`), one order of operations for any width.
"""

import numpy as np

from damage.mechanics import bodies
from damage.mechanics.compiled import compiled, inlined
from damage.mechanics.eight import add_part, bits, lane, lanes, load, rows_of, store, wall_of, zero
from damage.mechanics.rows import first_force
from damage.mechanics.tables import (
    ALPHA,
    BASE_X,
    COS1,
    DRIVEN,
    INVERSE_MASS,
    LOCAL,
    MASS,
    PLACE,
    PULL_Z,
    RIGID,
    ROTATION,
    ROW,
    SIN,
    STEP,
    SWEPT_X,
    TAKEN,
    VELOCITY,
    X,
    Z,
)

LOST = 3
"""First field of the room with mass times deceleration by damping."""


@inlined
def move_scaled(n, tables, matrix, strain, damped):
    """Advance all bodies by a step; damped: whether the bench has damping."""
    dt, coordinates = load(n, tables.bench, 0, STEP), tables.inertia.shape[1] // 3
    find_rates(n, tables, matrix, strain, damped)
    for i in range(len(matrix.body)):
        b = matrix.body[i]
        for k in range(min(RIGID, coordinates - matrix.first[i])):
            move_coordinate(n, tables, matrix.room, dt, i, k, b, matrix.first[i] + k)
        if matrix.first[i] == 0:
            turn(n, tables.bodies, b)


@inlined
def move_coordinate(n, tables, room, dt, i, k, b, c):
    """Advance coordinate c of body b, which is k of node i; add its momenta and powers to their sums."""
    inertia, places, sums = tables.inertia, tables.bodies, tables.sums
    old, rate, lost = load(n, inertia, b, VELOCITY + 3 * c), load(n, room, i, k), load(n, room, i, LOST + k)
    free, mass = load(n, inertia, b, INVERSE_MASS + 3 * c), load(n, inertia, b, MASS + 3 * c)
    new = old + dt * rate
    if c in (X, Z):
        add_part(n, sums, SWEPT_X + c, b, bodies.work_of_field(mass, free, old, new))
    add_part(n, sums, DRIVEN, b, bodies.power_of_drive(load(n, places, b, first_force(places) + c), free, new))
    add_part(n, sums, TAKEN, b, lost * (old + 0.5 * dt * rate))
    store(n, inertia, b, VELOCITY + 3 * c, new)
    store(n, places, b, PLACE + c, load(n, places, b, PLACE + c) + dt * new)
    store(n, places, b, first_force(places) + c, 0.0)


@inlined
def turn(n, places, b):
    """Write cosine less one and sine of body b."""
    angle = load(n, places, b, PLACE + ROTATION)
    cos1, sin = bodies.small_rotation(angle)
    store(n, places, b, COS1, cos1)
    store(n, places, b, SIN, sin)
    far = bits(abs(angle) >= bodies.SMALL)
    if far:
        turn_far(n, places, b, far, angle)


@compiled
def turn_far(n, places, b, far, angle):
    """Write cosine less one, and sine, of those rotations `far` (bits) of body b that are not small."""
    for w in range(lanes(n)):
        if far >> w & 1:
            row = b + w if rows_of(n) > 1 else b
            store(wall_of(n, w), places, row, COS1, np.cos(lane(angle, w)) - 1.0)
            store(wall_of(n, w), places, row, SIN, np.sin(lane(angle, w)))


@compiled
def find_rates(n, tables, matrix, strain, damped):
    """Write the rates of change of all velocities into the room, and behind them mass times deceleration by damping;
    damped: as of `move_scaled`."""
    room, coordinates = matrix.room, tables.inertia.shape[1] // 3
    for i in range(len(matrix.body)):
        for k in range(min(RIGID, coordinates - matrix.first[i])):
            rate, lost = momentum_rate(n, tables, strain, matrix.body[i], matrix.first[i] + k, damped)
            store(n, room, i, k, rate)
            store(n, room, i, LOST + k, lost)
    solve(n, matrix)


@inlined
def momentum_rate(n, tables, strain, b, c, damped):
    """Right-hand side of coordinate c of body b, and the part of its damping in it [N or N m]; zero where its velocity
    is prescribed."""
    places, inertia, bench = tables.bodies, tables.inertia, tables.bench
    old, mass, free = (load(n, inertia, b, VELOCITY + 3 * c), load(n, inertia, b, MASS + 3 * c),
                       load(n, inertia, b, INVERSE_MASS + 3 * c))
    force, field, lost = load(n, places, b, first_force(places) + c), zero(n), zero(n)
    if c == X:
        field = load(n, bench, 0, BASE_X)
    if c == Z:
        field = load(n, bench, 0, PULL_Z)
    if strain is not None and c >= RIGID:
        force = force - strain.stiffness[b, c - RIGID] * load(n, places, b, PLACE + c)
        lost = mass * (strain.damping[b, c - RIGID] * old)
    rate = bodies.acceleration(force, free, field)
    if damped:
        lost = lost + mass * bodies.damping(old, rate, free, load(n, bench, 0, ALPHA), load(n, bench, 0, LOCAL))
    return mass * rate - lost, lost


@inlined
def solve(n, matrix):
    """Replace the first three fields of the room by the solution of L D L' x = them."""
    room, lower, inverse, e, i = matrix.room, matrix.lower, matrix.inverse, ROW(0), ROW(len(matrix.body))
    for node in range(len(matrix.body)):
        x, z, r = load(n, room, node, 0), load(n, room, node, 1), load(n, room, node, 2)
        while e < matrix.start[node + 1]:
            for k in range(3):
                store(n, room, matrix.below[e], k, load(n, room, matrix.below[e], k) - (
                    lower[e, 3 * k] * x + lower[e, 3 * k + 1] * z + lower[e, 3 * k + 2] * r))
            e += ROW(1)
    while i > ROW(0):
        i -= ROW(1)
        x, z, r = load(n, room, i, 0), load(n, room, i, 1), load(n, room, i, 2)
        u = inverse[i, 0] * x + inverse[i, 1] * z + inverse[i, 2] * r
        v = inverse[i, 3] * x + inverse[i, 4] * z + inverse[i, 5] * r
        w = inverse[i, 6] * x + inverse[i, 7] * z + inverse[i, 8] * r
        while e > matrix.start[i]:
            e -= ROW(1)
            x, z, r = (load(n, room, matrix.below[e], 0), load(n, room, matrix.below[e], 1),
                       load(n, room, matrix.below[e], 2))
            u = u - (lower[e, 0] * x + lower[e, 3] * z + lower[e, 6] * r)
            v = v - (lower[e, 1] * x + lower[e, 4] * z + lower[e, 7] * r)
            w = w - (lower[e, 2] * x + lower[e, 5] * z + lower[e, 8] * r)
        store(n, room, i, 0, u)
        store(n, room, i, 1, v)
        store(n, room, i, 2, w)


@compiled
def scaled_kinetic_energy(n, tables, matrix, strain):
    """Kinetic energy at the time of the displacements [J], to which velocities are advanced by half a step."""
    find_rates(n, tables, matrix, strain, False)
    room, coordinates, half = matrix.room, tables.inertia.shape[1] // 3, 0.5 * load(n, tables.bench, 0, STEP)
    for i in range(len(matrix.body)):
        for k in range(min(RIGID, coordinates - matrix.first[i])):
            velocity = load(n, tables.inertia, matrix.body[i], VELOCITY + 3 * (matrix.first[i] + k))
            store(n, room, i, k, velocity + half * load(n, room, i, k))
    energy, lower, of, e = zero(n), matrix.lower, matrix.diagonal, ROW(0)
    for i in range(len(matrix.body)):
        x, z, r = load(n, room, i, 0), load(n, room, i, 1), load(n, room, i, 2)
        while e < matrix.start[i + 1]:
            for k in range(3):
                v = load(n, room, matrix.below[e], k)
                x, z, r = x + lower[e, 3 * k] * v, z + lower[e, 3 * k + 1] * v, r + lower[e, 3 * k + 2] * v
            e += ROW(1)
        energy = energy + 0.5 * (x * (of[i, 0] * x + of[i, 1] * z + of[i, 2] * r)
                                 + z * (of[i, 3] * x + of[i, 4] * z + of[i, 5] * r)
                                 + r * (of[i, 6] * x + of[i, 7] * z + of[i, 8] * r))
    return energy
