"""Devices of tests that hold the top of a wall: rotational springs, a spreader beam, a bearing.

They add their forces to those of the contacts on body b.
"""

from damage.mechanics import rows
from damage.mechanics.compiled import compiled, inlined
from damage.mechanics.simd import add, bits, either, load, zero
from damage.mechanics.tables import (
    BEAM_SHARE,
    FRICTION,
    INPUT,
    ROTATION,
    SPRING_REST,
    SPRING_STIFFNESS,
    Beam,
    Bearing,
    X,
    Z,
)


@inlined
def hold_rotations(n, tables):
    """Add the moments of the rotational springs by which bodies are held."""
    for b in range(len(tables.turning)):
        stiffness = load(n, tables.turning, b, SPRING_STIFFNESS)
        rest = load(n, tables.turning, b, SPRING_REST)
        moment = stiffness * (rows.place_of(n, tables.bodies, b, ROTATION) - rest)
        add_force(n, tables, b, ROTATION, -either(stiffness > 0.0, moment, 0.0))


@inlined
def add_force(n, tables, b, coordinate, force):
    """Add a force to a coordinate of body b [N or N m]."""
    add(n, tables.bodies, b, rows.first_force(tables.bodies) + coordinate, force)


@compiled
def spread(n, tables):
    """Add the force of a spreader beam to the bodies, by the share of each, and its work to the
    input.

    After the next step the mean displacement of these bodies, weighted by their shares, is that of
    the machine: the beam is one of levers, whose forces keep their ratio.  Local damping takes or
    gives a share of each body's rate by its sign: a few iterations find it.
    """
    bench = rows.bench_of(n, tables.bench, 0)
    place, speed, before = rows.beam_of(n, tables.beam, 0)  # of the machine
    dt = bench.step
    x = rows.first_force(tables.bodies) + X
    # of the bodies, by their shares: displacement, velocity and its running mean
    displacement = zero(n)
    velocity = zero(n)
    running_mean = zero(n)
    for b in range(len(tables.turning)):
        share = load(n, tables.turning, b, BEAM_SHARE)
        displacement = displacement + share * rows.place_of(n, tables.bodies, b, X)
        velocity = velocity + share * rows.velocity_of(n, tables.inertia, b, X)
        running_mean = running_mean + share * rows.mean_of(n, tables.inertia, b, X)
    resistance = bench.alpha * (1.0 - bench.follow) * (velocity - running_mean)
    missing = (place - displacement) / dt - velocity + dt * resistance  # velocity to be added
    force = before
    for _ in range(4 if bits(bench.local > 0.0) > 0 else 1):
        rate = zero(n)  # of the mean velocity, without the beam
        rate_by_force = zero(n)
        for b in range(len(tables.turning)):
            share = load(n, tables.turning, b, BEAM_SHARE)
            by_contacts = load(n, tables.bodies, b, x)
            power = (by_contacts + share * force) * rows.velocity_of(n, tables.inertia, b, X)
            damped = either(power > 0.0, bench.local, either(power < 0.0, -bench.local, 0.0))
            moves = share * (1.0 - damped) * rows.inverse_mass_of(n, tables.inertia, b, X)
            rate = rate + moves * by_contacts
            rate_by_force = rate_by_force + moves * share
        spreads = rate_by_force > 0.0
        force = (missing / dt - rate) / either(spreads, rate_by_force, 1.0)
        force = either(spreads, force, 0.0)
    add(n, tables.energy, 0, INPUT, 0.5 * dt * velocity * (before + force))
    rows.keep_beam(n, tables.beam, 0, True, Beam(place + dt * speed, speed, force))
    for b in range(len(tables.turning)):
        add(n, tables.bodies, b, x, load(n, tables.turning, b, BEAM_SHARE) * force)


@compiled
def hold_top(n, tables):
    """Add the force of the bearing of a restrained top to its beam, and the constant load on it.

    The bearing is a spring in series with a slider, `damage.wall.restraints`; the work of its slip
    is friction.
    """
    bench = rows.bench_of(n, tables.bench, 0)
    gravity = bench.pull_z - bench.base_z
    for b in range(len(tables.bearings)):
        stiffness, limit, play, load_mass, slip, before = rows.bearing_of(n, tables.bearings, b)
        trial = stiffness * (rows.place_of(n, tables.bodies, b, X) - slip)
        excess = trial - clipped(trial, limit)
        slipped = clipped(slip + excess / either(stiffness > 0.0, stiffness, 1.0), play)
        force = trial - stiffness * (slipped - slip)
        rows.keep_bearing(
            n, tables.bearings, b, True, Bearing(stiffness, limit, play, load_mass, slipped, force)
        )
        add(n, tables.energy, 0, FRICTION, 0.5 * (before + force) * (slipped - slip))
        add_force(n, tables, b, X, -force)
        add_force(n, tables, b, Z, -load_mass * gravity)


@inlined
def clipped(value, limit):
    """A value between minus a limit and the limit."""
    return either(value > limit, limit, either(value < -limit, -limit, value))
