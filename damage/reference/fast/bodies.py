"""Bodies in the fast step: equations of motion of eight bodies of one wall, or of one body in eight walls."""

import numpy as np

from damage.mechanics import bodies as mechanics
from damage.mechanics import eight
from damage.mechanics.eight import add, bits, load, store
from damage.mechanics.tables import DAMPING, INPUT
from damage.reference.fast import blocks as at
from damage.reference.fast.blocks import INDEX, NONE, ONE, WIDTH, clear, total
from damage.reference.fast.compiled import compiled, inlined

ALL = 2**eight.WIDTH - 1
"""The flags of a vector, all set, as bits."""


@compiled
def move(energy, relaxation, blocks, lanes, controls, field, step):
    """`damage.mechanics.step.move` of all walls.

    energy, relaxation: of their tables, passed singly since a call copies all fields of a System; blocks: Blocks;
    lanes: 1 or 8; controls: (walls, 5); field: (walls, steps, 3) acceleration of the base along x and z and gravity
    [m/s2]; step: row of it.
    """
    bench, bodies, sums = blocks.bench, blocks.bodies, blocks.sums
    clear(sums, at.SWEPT_X, at.DAMPED)
    damped = set_all(bench, relaxation, lanes, controls, field, step)
    block = NONE
    while block < INDEX(len(bodies)) // at.BODY:
        part = NONE if lanes == 1 else block % WIDTH * WIDTH
        if damped:
            move_damped(bodies, block * at.BODY, bench, sums, part)
        else:
            move_free(bodies, block * at.BODY, bench, sums, part)
        block += ONE
    add_energies(energy, sums, lanes, controls, field, step, damped)


@compiled
def add_energies(energy, sums, lanes, controls, field, step, damped):
    """Add the work of input and, if damped, of damping to the energies of all walls [J], from the sums of a step."""
    for first in (at.SWEPT_X, at.SWEPT_Z, at.DRIVEN, at.TAKEN):
        total(sums, first, lanes)
    for w in range(controls.shape[0]):
        dt, k = controls[w, 0], INDEX(w)
        swept = field[w, step, 0] * sums[at.SWEPT_X + k] + field[w, step, 1] * sums[at.SWEPT_Z + k]
        energy[w, INPUT] += (sums[at.DRIVEN + k] - 0.5 * swept) * dt
        if damped:
            energy[w, DAMPING] += sums[at.TAKEN + k] * dt


@compiled
def set_all(bench, relaxation, lanes, controls, field, step):
    """Write the parameters of the step of all walls to the bench; returns whether any wall has damping."""
    damped = False
    for w in range(controls.shape[0]):
        alpha = controls[w, 2] + relaxation[w, 0]
        damped |= alpha > 0.0 or controls[w, 1] > 0.0
        set_bench(bench, w, lanes, field[w, step], controls[w], alpha)
    return damped


@compiled
def set_bench(bench, w, lanes, field, controls, alpha):
    """Write the parameters of the step of wall w to the bench: field, time step and damping."""
    dt, local, rate = controls[0], controls[1], controls[3] / controls[0]
    for i in range(w, w + 1) if lanes > 1 else range(8):
        k = INDEX(i)
        bench[at.BASE_X + k], bench[at.BASE_Z + k], bench[at.STEP + k] = field[0], field[1] + field[2], dt
        bench[at.ALPHA + k], bench[at.LOCAL + k], bench[at.RATE + k] = alpha, local, rate


@inlined
def accelerations(bodies, k, bench):
    """Accelerations of the bodies at index k along their three coordinates [m/s2, rad/s2]."""
    return (mechanics.acceleration(load(bodies, k + at.FX), load(bodies, k + at.INVERSE_X), load(bench, at.BASE_X)),
            mechanics.acceleration(load(bodies, k + at.FZ), load(bodies, k + at.INVERSE_Z), load(bench, at.BASE_Z)),
            mechanics.acceleration(load(bodies, k + at.MOMENT), load(bodies, k + at.INVERSE_ROTATION), 0.0))


@compiled
def move_free(bodies, k, bench, sums, part):
    """Advance the eight bodies at index k by a step without damping; part: offset of their partial sums."""
    rate_x, rate_z, rate_rotation = accelerations(bodies, k, bench)
    advance(bodies, k, load(bench, at.STEP), rate_x, rate_z, rate_rotation, sums, part)


@compiled
def move_damped(bodies, k, bench, sums, part):
    """Advance the eight bodies at index k by a step with damping; arguments as of `move_free`."""
    rate_x, rate_z, rate_rotation = accelerations(bodies, k, bench)
    rate_x, power_x = damp(bodies, k, at.VX, at.MASS, at.INVERSE_X, rate_x, bench)
    rate_z, power_z = damp(bodies, k, at.VZ, at.MASS, at.INVERSE_Z, rate_z, bench)
    rate_rotation, power = damp(bodies, k, at.VROTATION, at.INERTIA, at.INVERSE_ROTATION, rate_rotation, bench)
    add(sums, at.TAKEN + part, power_x + power_z + power)
    advance(bodies, k, load(bench, at.STEP), rate_x, rate_z, rate_rotation, sums, part)


@inlined
def damp(bodies, k, velocity, mass, inverse, rate, bench):
    """Acceleration of a coordinate with damping, and the power of the damping [W]."""
    dt, old = load(bench, at.STEP), load(bodies, k + velocity)
    taken = mechanics.damping(old, rate, load(bodies, k + inverse), load(bench, at.ALPHA), load(bench, at.LOCAL))
    rate = rate - taken
    return rate, load(bodies, k + mass) * taken * (old + 0.5 * dt * rate)


@inlined
def advance(bodies, k, dt, rate_x, rate_z, rate_rotation, sums, part):
    """Advance velocities and displacements of eight bodies by a step dt [s]; set their forces to zero."""
    old_x, old_z = load(bodies, k + at.VX), load(bodies, k + at.VZ)
    vx, vz, v_rotation = old_x + dt * rate_x, old_z + dt * rate_z, load(bodies, k + at.VROTATION) + dt * rate_rotation
    mass, free_x, free_z = load(bodies, k + at.MASS), load(bodies, k + at.INVERSE_X), load(bodies, k + at.INVERSE_Z)
    add(sums, at.SWEPT_X + part, mechanics.work_of_field(mass, free_x, old_x, vx))
    add(sums, at.SWEPT_Z + part, mechanics.work_of_field(mass, free_z, old_z, vz))
    add(sums, at.DRIVEN + part, (
        mechanics.power_of_drive(load(bodies, k + at.FX), free_x, vx)
        + mechanics.power_of_drive(load(bodies, k + at.FZ), free_z, vz)
        + mechanics.power_of_drive(load(bodies, k + at.MOMENT), load(bodies, k + at.INVERSE_ROTATION), v_rotation)))
    angle = load(bodies, k + at.ROTATION) + dt * v_rotation
    store(bodies, k + at.VX, vx)
    store(bodies, k + at.VZ, vz)
    store(bodies, k + at.VROTATION, v_rotation)
    add(bodies, k + at.X, dt * vx)
    add(bodies, k + at.Z, dt * vz)
    store(bodies, k + at.ROTATION, angle)
    store(bodies, k + at.FX, 0.0)  # the next forces are added to zero
    store(bodies, k + at.FZ, 0.0)
    store(bodies, k + at.MOMENT, 0.0)
    cos1, sin = mechanics.small_rotation(angle)
    store(bodies, k + at.COS1, cos1)
    store(bodies, k + at.SIN, sin)
    if bits(abs(angle) < mechanics.SMALL) != ALL:
        rotate_far(bodies, k)


@inlined
def rotate_far(bodies, k):
    """Cosine less one, and sine, for those of the eight bodies whose rotation is not small."""
    for _ in range(eight.WIDTH):
        angle = bodies[k + at.ROTATION]
        if abs(angle) >= mechanics.SMALL:
            bodies[k + at.COS1], bodies[k + at.SIN] = np.cos(angle) - 1.0, np.sin(angle)
        k += ONE


@compiled
def adapt(relaxation, blocks, lanes, controls):
    """`damage.mechanics.step.adapt` of all walls."""
    bodies, sums = blocks.bodies, blocks.sums
    clear(sums, at.KINETIC, at.SUMS)
    block = NONE
    while block < INDEX(len(bodies)) // at.BODY:
        add_kinetic_energy(bodies, block * at.BODY, sums, NONE if lanes == 1 else block % WIDTH * WIDTH)
        block += ONE
    total(sums, at.KINETIC, lanes)
    for w in range(controls.shape[0]):
        dt, share, kinetic = controls[w, 0], controls[w, 4], sums[at.KINETIC + INDEX(w)]
        relaxation[w, 0] = mechanics.adaptive_damping(kinetic, relaxation[w, 1], share, dt)
        relaxation[w, 1] = kinetic


@compiled
def add_kinetic_energy(bodies, k, sums, part):
    """Add the kinetic energy of the eight bodies at index k [J] to the partial sums."""
    mass, inertia = load(bodies, k + at.MASS), load(bodies, k + at.INERTIA)
    add(sums, at.KINETIC + part, mechanics.kinetic_energy(
        (mass, mass, inertia), (load(bodies, k + at.VX), load(bodies, k + at.VZ), load(bodies, k + at.VROTATION))))
