"""How bodies move under their forces: central differences, and damping of them."""

import numpy as np

from damage.reference import blocks as at
from damage.reference.blocks import INDEX, NONE, ONE, WIDTH
from damage.reference.compiled import compiled, inlined
from damage.reference.eight import add, bits, either, load, store
from damage.reference.tables import DAMPING, INPUT

SMALL = 0.01
"""Angle [rad] below which the series of its sine and cosine are taken as they are here."""


@compiled
def integrate(tables, blocks, lanes, controls, field, step):
    """Central differences: velocities half a step on, displacements a whole one; input and damping work [J].

    field: (lanes in use, steps, 3) acceleration of the base along x and z, which acts on all masses backwards, and
    gravity [m/s2].
    """
    bench, bodies, sums = blocks.bench, blocks.bodies, blocks.sums
    clear(sums, at.MOMENTUM_X, at.DAMPED)
    damped = False
    for lane in range(controls.shape[0]):
        relaxed = controls[lane, 2] + tables.relaxation[lane, 0]
        damped |= relaxed > 0.0 or controls[lane, 1] > 0.0
        set_bench(bench, lane, lanes, field[lane, step], controls[lane], relaxed)
    block = NONE
    while block < INDEX(len(bodies)) // at.BODY:
        part = NONE if lanes == 1 else block % WIDTH * WIDTH
        if damped:
            move_damped(bodies, block * at.BODY, bench, sums, part)
        else:
            move_free(bodies, block * at.BODY, bench, sums, part)
        block += ONE
    for lane in range(controls.shape[0]):
        dt = controls[lane, 0]
        swept = (field[lane, step, 0] * total(sums, at.MOMENTUM_X, lane, lanes)
                 + field[lane, step, 1] * total(sums, at.MOMENTUM_Z, lane, lanes))
        tables.energy[lane, INPUT] += (total(sums, at.PUSHED, lane, lanes) - 0.5 * swept) * dt
        if damped:
            tables.energy[lane, DAMPING] += total(sums, at.LOST, lane, lanes) * dt


@compiled
def set_bench(bench, lane, lanes, field, controls, alpha):
    """Put what acts on all bodies of a lane, or of the one wall, on the bench."""
    dt, local, rate = controls[0], controls[1], controls[3] / controls[0]
    for i in range(lane, lane + 1) if lanes > 1 else range(8):
        k = INDEX(i)
        bench[at.BASE_X + k], bench[at.BASE_Z + k], bench[at.STEP + k] = field[0], field[1] + field[2], dt
        bench[at.ALPHA + k], bench[at.LOCAL + k], bench[at.RATE + k] = alpha, local, rate


@compiled
def total(sums, first, lane, lanes):
    """The eight parts of a sum together, of one lane."""
    value, step = 0.0, ONE if lanes == 1 else WIDTH
    for part in range(8):
        value += sums[first + INDEX(part) * step + INDEX(lane)]
    return value


@compiled
def clear(sums, start, stop):
    """Zero the sums from one to before another."""
    while start < stop:
        sums[start] = 0.0
        start += ONE


@compiled
def move_free(bodies, k, bench, sums, part):
    """Move eight bodies whose fields begin at k by a step, undamped; add to the parts of the sums at `part` what moves
    them."""
    rate_x, rate_z, rate_turn, _, _ = rates(bodies, k, bench)
    advance(bodies, k, load(bench, at.STEP), rate_x, rate_z, rate_turn, sums, part)


@compiled
def move_damped(bodies, k, bench, sums, part):
    """The same with damping, and what that takes."""
    dt, alpha, local = load(bench, at.STEP), load(bench, at.ALPHA), load(bench, at.LOCAL)
    old_x, old_z, old_spin = load(bodies, k + at.VX), load(bodies, k + at.VZ), load(bodies, k + at.SPIN)
    rate_x, rate_z, rate_turn, free_x, free_z = rates(bodies, k, bench)
    taken_x = either(free_x, resistance(old_x, rate_x, alpha, local), 0.0)
    taken_z = either(free_z, resistance(old_z, rate_z, alpha, local), 0.0)
    taken_turn = either(load(bodies, k + at.INVERSE_TURN) > 0.0, resistance(old_spin, rate_turn, alpha, local), 0.0)
    rate_x, rate_z, rate_turn = rate_x - taken_x, rate_z - taken_z, rate_turn - taken_turn
    add(sums, at.LOST + part, (
        load(bodies, k + at.MASS) * (taken_x * (old_x + 0.5 * dt * rate_x) + taken_z * (old_z + 0.5 * dt * rate_z))
        + load(bodies, k + at.INERTIA) * taken_turn * (old_spin + 0.5 * dt * rate_turn)))
    advance(bodies, k, dt, rate_x, rate_z, rate_turn, sums, part)


@inlined
def rates(bodies, k, bench):
    """Acceleration of eight bodies by their forces [m/s2, rad/s2], and which are free along x and along z."""
    inverse_x, inverse_z = load(bodies, k + at.INVERSE_X), load(bodies, k + at.INVERSE_Z)
    free_x, free_z = inverse_x > 0.0, inverse_z > 0.0  # a prescribed velocity stays
    rate_x = either(free_x, load(bodies, k + at.FX) * inverse_x - load(bench, at.BASE_X), 0.0)
    rate_z = either(free_z, load(bodies, k + at.FZ) * inverse_z - load(bench, at.BASE_Z), 0.0)
    return rate_x, rate_z, load(bodies, k + at.MOMENT) * load(bodies, k + at.INVERSE_TURN), free_x, free_z


@inlined
def advance(bodies, k, dt, rate_x, rate_z, rate_turn, sums, part):
    """Velocities and places of eight bodies whose fields begin at k, a step of dt [s] on with these accelerations;
    their momentum, and the work on them where their velocity is prescribed, for the sums."""
    free, mass = load(bodies, k + at.INVERSE_X) > 0.0, load(bodies, k + at.MASS)
    old_x, old_z = load(bodies, k + at.VX), load(bodies, k + at.VZ)
    vx, vz, spin = old_x + dt * rate_x, old_z + dt * rate_z, load(bodies, k + at.SPIN) + dt * rate_turn
    add(sums, at.MOMENTUM_X + part, either(free, mass * (old_x + vx), 0.0))
    add(sums, at.MOMENTUM_Z + part, mass * (old_z + vz))
    add(sums, at.PUSHED + part, -either(free, 0.0, load(bodies, k + at.FX) * vx))
    turn = load(bodies, k + at.TURN) + dt * spin
    store(bodies, k + at.VX, vx)
    store(bodies, k + at.VZ, vz)
    store(bodies, k + at.SPIN, spin)
    add(bodies, k + at.X, dt * vx)
    add(bodies, k + at.Z, dt * vz)
    store(bodies, k + at.TURN, turn)
    store(bodies, k + at.FX, 0.0)  # for those of the next places
    store(bodies, k + at.FZ, 0.0)
    store(bodies, k + at.MOMENT, 0.0)
    # cos(turn) - 1 and sin(turn) by series, whose remainder is below 1e-17 while the angle is SMALL.
    square = turn * turn
    store(bodies, k + at.COS1, -0.5 * square * (1.0 - square * (1 / 12) * (1.0 - square * (1 / 30))))
    store(bodies, k + at.SIN, turn * (1.0 - square * (1 / 6) * (1.0 - square * (1 / 20) * (1.0 - square * (1 / 42)))))
    if bits(abs(turn) < SMALL) != 255:
        turn_far(bodies, k)


@inlined
def resistance(velocity, rate, alpha, local):
    """Deceleration by damping proportional to mass (alpha [1/s]) and by local damping [-], which is against the
    motion: of velocities [m/s or rad/s] that change at a rate [m/s2 or rad/s2]."""
    sign = either(velocity > 0.0, 1.0, either(velocity < 0.0, -1.0, 0.0))
    return alpha * velocity + local * abs(rate) * sign


@inlined
def turn_far(bodies, k):
    """cos(angle) - 1 and sin(angle) of those of eight bodies that have turned by more than is small."""
    for _ in range(8):
        angle = bodies[k + at.TURN]
        if abs(angle) >= SMALL:
            bodies[k + at.COS1], bodies[k + at.SIN] = np.cos(angle) - 1.0, np.sin(angle)
        k += ONE


@compiled
def adapt(tables, blocks, lanes, controls):
    """Adaptive global damping, for static solutions (Cundall's, as in UDEC): it takes a constant share of
    the rate at which the kinetic energy [J] changes, and so follows whichever mode still moves."""
    bodies, sums = blocks.bodies, blocks.sums
    clear(sums, at.KINETIC, at.SUMS)
    block = NONE
    while block < INDEX(len(bodies)) // at.BODY:
        kinetic_block(bodies, block * at.BODY, sums, NONE if lanes == 1 else block % WIDTH * WIDTH)
        block += ONE
    for lane in range(controls.shape[0]):
        dt, share, kinetic = controls[lane, 0], controls[lane, 4], total(sums, at.KINETIC, lane, lanes)
        old = tables.relaxation[lane, 1]
        # No more than what would stop every body in two steps: near a standstill the ratio has no bound.
        wanted = share * abs(kinetic - old) / (dt * (kinetic + old)) if kinetic > 0.0 else 0.0
        tables.relaxation[lane, 0], tables.relaxation[lane, 1] = min(wanted, 0.5 / dt), kinetic


@compiled
def kinetic_block(bodies, k, sums, part):
    """Add the kinetic energy [J] of eight bodies, whose velocities are those half a step ago."""
    vx, vz, spin = load(bodies, k + at.VX), load(bodies, k + at.VZ), load(bodies, k + at.SPIN)
    add(sums, at.KINETIC + part, 0.5 * (load(bodies, k + at.MASS) * (vx * vx + vz * vz)
                                        + load(bodies, k + at.INERTIA) * spin * spin))


@compiled
def kinetic_energy(place, motion, field_x, field_z, dt):
    """At the instant of the places, to which velocities are carried half a step on [J].

    place, motion: (bodies + ground, 8) of one wall; field_x, field_z: backward and downward acceleration of all masses
    [m/s2]; dt: time step [s].
    """
    total = 0.0
    for k in range(len(place) - 1):
        fx, fz, moment = place[k, 4], place[k, 5], place[k, 6]
        vx, vz, spin, mass, inertia = motion[k, 0], motion[k, 1], motion[k, 2], motion[k, 3], motion[k, 4]
        inverse_x, inverse_z, inverse_turn = motion[k, 5], motion[k, 6], motion[k, 7]
        if inverse_x > 0.0:
            vx += 0.5 * dt * (fx * inverse_x - field_x)
        if inverse_z > 0.0:
            vz += 0.5 * dt * (fz * inverse_z - field_z)
        spin += 0.5 * dt * moment * inverse_turn
        total += 0.5 * (mass * (vx * vx + vz * vz) + inertia * spin * spin)
    return total
