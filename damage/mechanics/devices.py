"""Devices of tests that hold the top of a wall: rotational springs, a spreader beam, a bearing."""

from damage.mechanics import rows
from damage.mechanics.compiled import compiled, inlined
from damage.mechanics.simd import add, bits, either, load, zero
from damage.mechanics.tables import FRICTION, INPUT, ROTATION, Beam, Bearing, X, Z


@inlined
def hold_rotations(n, tables):
    """Add the moments of the rotational springs by which bodies are held."""
    for b in range(len(tables.turning)):
        stiffness = load(n, tables.turning, b, 0)
        rest = load(n, tables.turning, b, 2)
        moment = stiffness * (rows.place_of(n, tables.bodies, b, ROTATION) - rest)
        add(
            n,
            tables.bodies,
            b,
            rows.first_force(tables.bodies) + ROTATION,
            -either(stiffness > 0.0, moment, 0.0),
        )


@compiled
def spread(n, tables):
    """Add the force of a spreader beam, by the share of each body, to those of the bodies; add its
    work to the input.

    It is the force with which the mean displacement of these bodies, weighted by their shares, is
    that of the machine after the next step: of a beam of levers, whose forces keep their ratio.
    Local damping takes or gives a share of each body's rate by its sign: a few iterations find it.
    """
    bench = rows.bench_of(n, tables.bench, 0)
    place, velocity, before = rows.beam_of(n, tables.beam, 0)
    dt = bench.step
    x = rows.first_force(tables.bodies) + X
    force = before
    total = zero(n)
    speed = zero(n)
    mean = zero(n)
    local = bits(bench.local > 0.0) > 0
    for b in range(len(tables.turning)):
        share = load(n, tables.turning, b, 1)
        total = total + share * rows.place_of(n, tables.bodies, b, X)
        speed = speed + share * rows.velocity_of(n, tables.inertia, b, X)
        mean = mean + share * rows.mean_of(n, tables.inertia, b, X)
    lost = bench.alpha * (1.0 - bench.follow) * (speed - mean)
    change = (place - total) / dt - speed + dt * lost
    for _ in range(4 if local else 1):
        rate = zero(n)
        freedom = zero(n)
        for b in range(len(tables.turning)):
            share = load(n, tables.turning, b, 1)
            coordinate = load(n, tables.bodies, b, x)
            power = (coordinate + share * force) * rows.velocity_of(n, tables.inertia, b, X)
            damped = either(power > 0.0, bench.local, either(power < 0.0, -bench.local, 0.0))
            free = share * (1.0 - damped) * rows.inverse_mass_of(n, tables.inertia, b, X)
            rate = rate + free * coordinate
            freedom = freedom + free * share
        spreads = freedom > 0.0
        force = (change / dt - rate) / either(spreads, freedom, 1.0)
        force = either(spreads, force, 0.0)
    add(n, tables.energy, 0, INPUT, 0.5 * dt * speed * (before + force))
    rows.keep_beam(n, tables.beam, 0, True, Beam(place + dt * velocity, velocity, force))
    for b in range(len(tables.turning)):
        add(n, tables.bodies, b, x, load(n, tables.turning, b, 1) * force)


@compiled
def hold_top(n, tables):
    """Add the forces of the bearing of a restrained top, and of the constant load on it, to those
    of its beam.

    The bearing is a spring in series with a slider, `damage.wall.restraints`; the work of its slip
    is friction.
    """
    bench = rows.bench_of(n, tables.bench, 0)
    gravity = bench.pull_z - bench.base_z
    for b in range(len(tables.bearings)):
        stiffness, limit, play, weighs, slip, before = rows.bearing_of(n, tables.bearings, b)
        trial = stiffness * (rows.place_of(n, tables.bodies, b, X) - slip)
        excess = either(trial > limit, trial - limit, either(trial < -limit, trial + limit, 0.0))
        slipped = slip + excess / either(stiffness > 0.0, stiffness, 1.0)
        slipped = either(slipped > play, play, either(slipped < -play, -play, slipped))
        force = trial - stiffness * (slipped - slip)
        rows.keep_bearing(
            n, tables.bearings, b, True, Bearing(stiffness, limit, play, weighs, slipped, force)
        )
        add(n, tables.energy, 0, FRICTION, 0.5 * (before + force) * (slipped - slip))
        add(n, tables.bodies, b, rows.first_force(tables.bodies) + X, -force)
        add(n, tables.bodies, b, rows.first_force(tables.bodies) + Z, -weighs * gravity)
