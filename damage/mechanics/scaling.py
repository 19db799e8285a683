"""Selective mass scaling: bodies follow their forces by a constant matrix in place of the masses.

    (M + dt^2/2 K0 + dt/2 C0) (v(t + dt/2) - v(t - dt/2)) = dt (f(u(t)) - M (g + a_base(t)))

K0: stiffness of the intact wall; C0: its damping.  No frequency of a wall whose tangent stiffness
is at most K0 exceeds sqrt(2) / dt.  The kinetic energy has the same matrix, by which the energy
balance holds; input is work on M alone.  The solution is by a block factor L D L' that
`damage.mechanics.factor` makes, one order of operations for any width.
"""

from typing import NamedTuple

from damage.mechanics.bodies import advance, coordinates, move_rigidly, put, rates
from damage.mechanics.compiled import compiled, inlined
from damage.mechanics.rows import (
    bench_of,
    first_force,
    force_of,
    mass_of,
    place_of,
    velocity_of,
)
from damage.mechanics.simd import (
    add_part,
    load,
    of_each,
    rows_of,
    store,
    widest,
    zero,
)
from damage.mechanics.tables import DRIVEN, PLACE, RIGID, ROW, SWEPT_X, TAKEN, X, Z

LOST = 3
"""First field of a Matrix's room with mass times deceleration by damping."""


class Node(NamedTuple):
    """Values of the three coordinates of a node."""

    x: float
    z: float
    r: float


@inlined
def move_scaled(n, tables, matrix, strain, damped):
    """Advance all bodies by a step with mass scaling; damped: as of
    `damage.mechanics.bodies.rates`."""
    places = tables.bodies
    sums = tables.sums
    room = matrix.room
    bench = bench_of(n, tables.bench, 0)
    move_alone(n, tables, matrix, damped)
    find_rates(n, tables, matrix, strain, damped, matrix.alone)
    for i in range(matrix.alone, len(matrix.body)):
        b = matrix.body[i]
        first = matrix.first[i]
        for k in range(matrix.count[i]):
            c = first + k
            rate = load(n, room, i, k)
            lost = load(n, room, i, LOST + k)
            force = force_of(n, places, b, c)
            swept, driven, taken, new = advance(
                n, tables.inertia, b, c, bench.step, rate, lost, force
            )
            if c in (X, Z):
                add_part(n, sums, SWEPT_X + c, b, swept)
            add_part(n, sums, DRIVEN, b, driven)
            add_part(n, sums, TAKEN, b, taken)
            store(n, places, b, PLACE + c, place_of(n, places, b, c) + bench.step * new)
            store(n, places, b, first_force(places) + c, 0.0)
        if first == 0:
            put(n, tables, b, *coordinates(n, places, tables.every, b)[:3])


@inlined
def move_alone(n, tables, matrix, damped):
    """Advance the uncoupled bodies by a step; of a single wall eight at once where all eight rows
    of a block of the table are uncoupled."""
    wide = widest(n)
    bench = bench_of(n, tables.bench, 0)
    i = 0
    while i < matrix.alone:
        b = matrix.body[i]
        last = i + rows_of(wide) - 1
        if b % rows_of(wide) == 0 and last < matrix.alone and matrix.body[last] - b == last - i:
            add_part(wide, tables.sums, TAKEN, b, move_rigidly(wide, tables, bench, b, damped))
            i = last + 1
        else:
            add_part(n, tables.sums, TAKEN, b, move_rigidly(n, tables, bench, b, damped))
            i += 1


@compiled
def find_rates(n, tables, matrix, strain, damped, since):
    """Write the rates of change of the velocities of the nodes from `since` on into the room, and
    behind them mass times deceleration by damping; damped: as of `damage.mechanics.bodies.rates`.
    """
    places = tables.bodies
    inertia = tables.inertia
    room = matrix.room
    bench = bench_of(n, tables.bench, 0)
    for i in range(since, len(matrix.body)):
        b = matrix.body[i]
        for k in range(matrix.count[i]):
            c = matrix.first[i] + k
            lost = zero(n)
            old = velocity_of(n, inertia, b, c)
            mass = mass_of(n, inertia, b, c)
            force = force_of(n, places, b, c)
            if strain is not None and c >= RIGID:
                force = force - strain.stiffness[b, c - RIGID] * place_of(n, places, b, c)
                lost = mass * (strain.damping[b, c - RIGID] * old)
            field = bench.base_x if c == X else bench.pull_z if c == Z else zero(n)
            rate, resistance = rates(n, inertia, b, c, bench, field, force, damped)
            lost = lost + mass * resistance
            store(n, room, i, k, mass * rate - lost)
            store(n, room, i, LOST + k, lost)
    solve(n, matrix, since)


@inlined
def solve(n, matrix, since):
    """Replace the first three fields of the room by the solution of L D L' x = them; nothing
    couples the nodes before `since`."""
    room = matrix.room
    start = matrix.start
    below = matrix.below
    e = ROW(0)
    for node in range(since, len(matrix.body)):
        known = values_of(n, room, node)
        while e < start[node + 1]:
            change = product(n, matrix.lower, e, known)
            keep_values(n, room, below[e], less(values_of(n, room, below[e]), change))
            e += ROW(1)
    node = ROW(len(matrix.body))
    while node > ROW(since):
        node -= ROW(1)
        solution = product(n, matrix.inverse, node, values_of(n, room, node))
        while e > start[node]:
            e -= ROW(1)
            solution = less(
                solution, product_across(n, matrix.lower, e, values_of(n, room, below[e]))
            )
        keep_values(n, room, node, solution)


@inlined
def values_of(n, room, node):
    """Node of the first three fields of the room."""
    return Node(load(n, room, node, 0), load(n, room, node, 1), load(n, room, node, 2))


@inlined
def keep_values(n, room, node, values):
    """Write a Node into the first three fields of the room."""
    store(n, room, node, 0, values.x)
    store(n, room, node, 1, values.z)
    store(n, room, node, 2, values.r)


@inlined
def less(first, second):
    """Difference of two Nodes."""
    return Node(first.x - second.x, first.z - second.z, first.r - second.r)


@inlined
def product(n, blocks, i, node):
    """Node: block i times a Node."""
    return Node(
        along(n, blocks, i, 0, 1, node),
        along(n, blocks, i, 3, 1, node),
        along(n, blocks, i, 6, 1, node),
    )


@inlined
def product_across(n, blocks, i, node):
    """Node: block i, transposed, times a Node."""
    return Node(
        along(n, blocks, i, 0, 3, node),
        along(n, blocks, i, 1, 3, node),
        along(n, blocks, i, 2, 3, node),
    )


@inlined
def along(n, blocks, i, first, apart, node):
    """Three entries of block i, the first one and those so far apart, times a Node."""
    return (
        of_each(n, blocks, i, first) * node.x
        + of_each(n, blocks, i, first + apart) * node.z
        + of_each(n, blocks, i, first + 2 * apart) * node.r
    )


@compiled
def scaled_kinetic_energy(n, tables, matrix, strain):
    """Kinetic energy at the time of the displacements [J], to which velocities are advanced by half
    a step."""
    find_rates(n, tables, matrix, strain, False, 0)
    room = matrix.room
    half = 0.5 * bench_of(n, tables.bench, 0).step
    for i in range(len(matrix.body)):
        for k in range(matrix.count[i]):
            velocity = velocity_of(n, tables.inertia, matrix.body[i], matrix.first[i] + k)
            store(n, room, i, k, velocity + half * load(n, room, i, k))
    energy = zero(n)
    lower = matrix.lower
    e = ROW(0)
    for i in range(len(matrix.body)):
        x, z, r = values_of(n, room, i)
        while e < matrix.start[i + 1]:
            for k in range(3):
                v = load(n, room, matrix.below[e], k)
                x = x + of_each(n, lower, e, 3 * k) * v
                z = z + of_each(n, lower, e, 3 * k + 1) * v
                r = r + of_each(n, lower, e, 3 * k + 2) * v
            e += ROW(1)
        momentum = product(n, matrix.diagonal, i, Node(x, z, r))
        energy = energy + 0.5 * (x * momentum.x + z * momentum.z + r * momentum.r)
    return energy
