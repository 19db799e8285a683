"""How bodies move under their forces: central differences, and damping of them."""

import numpy as np

from damage.reference import blocks as at
from damage.reference.blocks import INDEX, NONE, ONE, WIDTH
from damage.reference.compiled import block_loop, compiled, inlined
from damage.reference.tables import DAMPING, INPUT

SMALL = 0.01
"""Angle [rad] below which the series of its sine and cosine are taken as they are here."""


@compiled
def integrate(tables, blocks, lanes, controls, field, step):
    """Central differences: velocities half a step on, displacements a whole one; input and damping work [J].

    field: (lanes in use, steps, 3) acceleration of the base along x and z, which acts on all masses backwards, and
    gravity [m/s2].
    """
    bench, bodies, sums, width = blocks.bench, blocks.bodies, blocks.sums, INDEX(blocks.width)
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
            move_damped(bodies, block * at.BODY, bench, sums, part, width)
        else:
            move_free(bodies, block * at.BODY, bench, sums, part, width)
        turn_far(bodies, block * at.BODY)
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


@block_loop
def move_free(bodies, k, bench, sums, part, width):
    """Move eight bodies whose fields begin at k by a step, undamped; add to the parts of the sums at `part` what moves
    them."""
    i = NONE
    while i < width:
        dt, inverse_x, inverse_z = bench[at.STEP + i], bodies[k + at.INVERSE_X], bodies[k + at.INVERSE_Z]
        # A prescribed velocity stays.
        rate_x = bodies[k + at.FX] * inverse_x - bench[at.BASE_X + i] if inverse_x > 0.0 else 0.0
        rate_z = bodies[k + at.FZ] * inverse_z - bench[at.BASE_Z + i] if inverse_z > 0.0 else 0.0
        rate_turn = bodies[k + at.MOMENT] * bodies[k + at.INVERSE_TURN]
        advance(bodies, k, dt, rate_x, rate_z, rate_turn, sums, part + i)
        i += ONE
        k += ONE


@block_loop
def move_damped(bodies, k, bench, sums, part, width):
    """The same with damping, and what that takes."""
    i = NONE
    while i < width:
        dt, inverse_x, inverse_z = bench[at.STEP + i], bodies[k + at.INVERSE_X], bodies[k + at.INVERSE_Z]
        alpha, local, inverse_turn = bench[at.ALPHA + i], bench[at.LOCAL + i], bodies[k + at.INVERSE_TURN]
        old_x, old_z, old_spin = bodies[k + at.VX], bodies[k + at.VZ], bodies[k + at.SPIN]
        rate_x = bodies[k + at.FX] * inverse_x - bench[at.BASE_X + i] if inverse_x > 0.0 else 0.0
        rate_z = bodies[k + at.FZ] * inverse_z - bench[at.BASE_Z + i] if inverse_z > 0.0 else 0.0
        rate_turn = bodies[k + at.MOMENT] * inverse_turn
        taken_x = resistance(old_x, rate_x, alpha, local) if inverse_x > 0.0 else 0.0
        taken_z = resistance(old_z, rate_z, alpha, local) if inverse_z > 0.0 else 0.0
        taken_turn = resistance(old_spin, rate_turn, alpha, local) if inverse_turn > 0.0 else 0.0
        rate_x, rate_z, rate_turn = rate_x - taken_x, rate_z - taken_z, rate_turn - taken_turn
        sums[at.LOST + part + i] += (
            bodies[k + at.MASS] * (taken_x * (old_x + 0.5 * dt * rate_x) + taken_z * (old_z + 0.5 * dt * rate_z))
            + bodies[k + at.INERTIA] * taken_turn * (old_spin + 0.5 * dt * rate_turn))
        advance(bodies, k, dt, rate_x, rate_z, rate_turn, sums, part + i)
        i += ONE
        k += ONE


@inlined
def advance(bodies, k, dt, rate_x, rate_z, rate_turn, sums, part):
    """Velocities and places of the body whose fields begin at k, a step of dt [s] on with these accelerations; its
    momentum, and the work on it where its velocity is prescribed, for the sums."""
    free, mass, old_x, old_z = bodies[k + at.INVERSE_X] > 0.0, bodies[k + at.MASS], bodies[k + at.VX], bodies[k + at.VZ]
    vx, vz, spin = old_x + dt * rate_x, old_z + dt * rate_z, bodies[k + at.SPIN] + dt * rate_turn
    sums[at.MOMENTUM_X + part] += mass * (old_x + vx) if free else 0.0
    sums[at.MOMENTUM_Z + part] += mass * (old_z + vz)
    sums[at.PUSHED + part] -= 0.0 if free else bodies[k + at.FX] * vx
    turn = bodies[k + at.TURN] + dt * spin
    bodies[k + at.VX], bodies[k + at.VZ], bodies[k + at.SPIN] = vx, vz, spin
    bodies[k + at.X], bodies[k + at.Z] = bodies[k + at.X] + dt * vx, bodies[k + at.Z] + dt * vz
    bodies[k + at.TURN] = turn
    bodies[k + at.FX] = bodies[k + at.FZ] = bodies[k + at.MOMENT] = 0.0  # for those of the next places
    # cos(turn) - 1 and sin(turn) by series, whose remainder is below 1e-17 while the angle is SMALL.
    square = turn * turn
    bodies[k + at.COS1] = -0.5 * square * (1.0 - square * (1 / 12) * (1.0 - square * (1 / 30)))
    bodies[k + at.SIN] = turn * (1.0 - square * (1 / 6) * (1.0 - square * (1 / 20) * (1.0 - square * (1 / 42))))


@inlined
def resistance(velocity, rate, alpha, local):
    """Deceleration by damping proportional to mass (alpha [1/s]) and by local damping [-], which is against the
    motion: of a velocity [m/s or rad/s] that changes at a rate [m/s2 or rad/s2]."""
    sign = 1.0 if velocity > 0.0 else (-1.0 if velocity < 0.0 else 0.0)
    return alpha * velocity + local * abs(rate) * sign


@block_loop
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
    bodies, sums, width = blocks.bodies, blocks.sums, INDEX(blocks.width)
    clear(sums, at.KINETIC, at.SUMS)
    block = NONE
    while block < INDEX(len(bodies)) // at.BODY:
        kinetic_block(bodies, block * at.BODY, sums, NONE if lanes == 1 else block % WIDTH * WIDTH, width)
        block += ONE
    for lane in range(controls.shape[0]):
        dt, share, kinetic = controls[lane, 0], controls[lane, 4], total(sums, at.KINETIC, lane, lanes)
        old = tables.relaxation[lane, 1]
        # No more than what would stop every body in two steps: near a standstill the ratio has no bound.
        wanted = share * abs(kinetic - old) / (dt * (kinetic + old)) if kinetic > 0.0 else 0.0
        tables.relaxation[lane, 0], tables.relaxation[lane, 1] = min(wanted, 0.5 / dt), kinetic


@block_loop
def kinetic_block(bodies, k, sums, part, width):
    """Add the kinetic energy [J] of eight bodies, whose velocities are those half a step ago."""
    i = NONE
    while i < width:
        vx, vz, spin = bodies[k + at.VX], bodies[k + at.VZ], bodies[k + at.SPIN]
        sums[at.KINETIC + part + i] += 0.5 * (bodies[k + at.MASS] * (vx * vx + vz * vz)
                                              + bodies[k + at.INERTIA] * spin * spin)
        i += ONE
        k += ONE


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
