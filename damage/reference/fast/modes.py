"""Strain modes of deformable bricks in the eight walls of a batch, to the same bits as `damage.mechanics.strain`.

Mass, stiffness, damping and shapes of the modes are equal in all walls; their amplitudes are vectors.
"""

from typing import NamedTuple

import numpy as np

from damage.mechanics.bodies import acceleration, adaptive_damping, damping
from damage.mechanics.eight import add, load, spread, store
from damage.mechanics.interfaces import RelativeMotion
from damage.mechanics.strain import advance_mode
from damage.mechanics.tables import FAILED, RIGID
from damage.reference.fast import blocks as at
from damage.reference.fast.blocks import INDEX, NONE, ONE, WIDTH, aligned_zeros, clear, total
from damage.reference.fast.bodies import accelerations, add_energies, add_kinetic_energy, advance, damp, set_all
from damage.reference.fast.compiled import compiled, inlined

TENSION, COHESION, LIMITS = (INDEX(8 * n) for n in range(3))
"""Indices of the fields, and size, of a block of the elastic limits of an intact contact point."""
HERE_OPENING, HERE_SHEAR, HERE_ROTATION, NORMAL, SHEAR, COUPLE, ROOM = (INDEX(8 * n) for n in range(7))
"""Indices in `Modes.room` of a RelativeMotion and a Resultant of a contact point, and its size."""


class Modes(NamedTuple):
    """Flat arrays of a batch of walls with deformable bricks.

    place, velocity, force: a vector for each body and mode; limits: LIMITS of each contact point; failed: a byte for
    each contact point, not zero where its state is in `Blocks.contacts`, as of all that are no longer intact springs;
    ended: a byte for each interface, its bits the walls in which its faces have ceased to overlap; last: `at.LAST` of
    each contact point; room: values of a contact point that pass between vectors and single walls.
    """

    place: np.ndarray
    velocity: np.ndarray
    force: np.ndarray
    limits: np.ndarray
    failed: np.ndarray
    ended: np.ndarray
    last: np.ndarray
    room: np.ndarray


def make_modes(n_bodies, n_modes, n_interfaces, n_contacts):
    """Modes of a batch, without their state, which `pack_modes` copies."""
    amplitudes = (aligned_zeros(8 * n_bodies * n_modes) for _ in range(3))
    return Modes(*amplitudes, aligned_zeros(n_contacts * int(LIMITS)), np.zeros(n_contacts, np.uint8),
                 np.zeros(n_interfaces, np.uint8), aligned_zeros(n_contacts * int(at.LAST)), aligned_zeros(int(ROOM)))


@compiled
def pack_modes(tables, modes):
    """Copy amplitudes, velocities, forces and elastic limits from the tables."""
    n_bodies, n_modes = tables.place.shape[1], tables.place.shape[2] - RIGID
    for b in range(n_bodies):
        for m in range(n_modes):
            for w in range(tables.place.shape[0]):
                k = (INDEX(b) * INDEX(n_modes) + INDEX(m)) * WIDTH + INDEX(w)
                modes.place[k] = tables.place[w, b, RIGID + m]
                modes.velocity[k] = tables.velocity[w, b, RIGID + m]
                modes.force[k] = tables.force[w, b, RIGID + m]
    for i in range(tables.states.shape[1]):
        for w in range(tables.states.shape[0]):
            k = INDEX(i) * LIMITS + INDEX(w)
            modes.limits[k + TENSION] = tables.states[w, i].elastic_tensile_strength
            modes.limits[k + COHESION] = tables.states[w, i].elastic_cohesion
    for p in range(tables.interfaces.shape[1]):
        modes.ended[p] = 0
        for w in range(tables.interfaces.shape[0]):
            if tables.interfaces[w, p].failed > FAILED:
                modes.ended[p] |= 1 << w


@compiled
def unpack_modes(tables, modes):
    """Copy amplitudes, velocities and forces back to the tables."""
    n_bodies, n_modes = tables.place.shape[1], tables.place.shape[2] - RIGID
    for b in range(n_bodies):
        for m in range(n_modes):
            for w in range(tables.place.shape[0]):
                k = (INDEX(b) * INDEX(n_modes) + INDEX(m)) * WIDTH + INDEX(w)
                tables.place[w, b, RIGID + m] = modes.place[k]
                tables.velocity[w, b, RIGID + m] = modes.velocity[k]
                tables.force[w, b, RIGID + m] = modes.force[k]


@compiled
def move(tables, blocks, modes, strain, controls, field, step):
    """`damage.mechanics.step.move` of all walls; arguments as of `damage.reference.fast.bodies.move`."""
    bench, bodies, sums = blocks.bench, blocks.bodies, blocks.sums
    clear(sums, at.SWEPT_X, at.DAMPED)
    damped, alike = set_all(bench, tables.relaxation, 8, controls, field, step), True
    for w in range(controls.shape[0]):
        alike &= controls[w, 0] == controls[0, 0]
    for b in range(tables.place.shape[1]):
        k, part, power = INDEX(b) * at.BODY, INDEX(b % 8 * 8), spread(0.0)
        rate_x, rate_z, rate_rotation = accelerations(bodies, k, bench)
        if damped:
            rate_x, power_x = damp(bodies, k, at.VX, at.MASS, at.INVERSE_X, rate_x, bench)
            rate_z, power_z = damp(bodies, k, at.VZ, at.MASS, at.INVERSE_Z, rate_z, bench)
            rate_rotation, power = damp(bodies, k, at.VROTATION, at.INERTIA, at.INVERSE_ROTATION, rate_rotation, bench)
            power = power_x + power_z + power
        advance(bodies, k, load(bench, at.STEP), rate_x, rate_z, rate_rotation, sums, part)
        if damped or not alike:
            power = move_damped_modes(tables, modes, strain, bench, b, power)
        else:
            power = move_modes(tables, modes, strain, controls[0, 0], b, power)
        add(sums, at.TAKEN + part, power)
    add_energies(tables.energy, sums, 8, controls, field, step, True)


@inlined
def move_modes(tables, modes, strain, dt, b, power):
    """Advance all modes of body b in eight walls; returns the power of damping [W] with theirs added.

    dt: time step [s], a number where it is equal in all walls: the division in `advance_mode` is then one of numbers.
    """
    n_modes = strain.shapes.shape[2]
    for m in range(n_modes):
        k = (INDEX(b) * INDEX(n_modes) + INDEX(m)) * WIDTH
        power = power + move_mode(tables, modes, strain, dt, b, m, k, rate_of(tables, modes, strain, b, m, k), 0.0)
    return power


@inlined
def move_damped_modes(tables, modes, strain, bench, b, power):
    """`move_modes` with the damping of the bench."""
    dt, alpha, local = load(bench, at.STEP), load(bench, at.ALPHA), load(bench, at.LOCAL)
    n_modes = strain.shapes.shape[2]
    for m in range(n_modes):
        k = (INDEX(b) * INDEX(n_modes) + INDEX(m)) * WIDTH
        rate = rate_of(tables, modes, strain, b, m, k)
        resistance = damping(load(modes.velocity, k), rate, tables.inverse_mass[0, b, RIGID + m], alpha, local)
        power = power + move_mode(tables, modes, strain, dt, b, m, k, rate, resistance)
    return power


@inlined
def rate_of(tables, modes, strain, b, m, k):
    """Acceleration of mode m of body b, at index k, without damping."""
    return acceleration(load(modes.force, k) - strain.stiffness[b, m] * load(modes.place, k),
                        tables.inverse_mass[0, b, RIGID + m], 0.0)


@inlined
def move_mode(tables, modes, strain, dt, b, m, k, rate, resistance):
    """Advance mode m of body b, at index k; returns the power of its damping [W]."""
    place, velocity, power = advance_mode(load(modes.place, k), load(modes.velocity, k), rate, resistance,
                                          tables.mass[0, b, RIGID + m], strain.damping[b, m], dt)
    store(modes.place, k, place)
    store(modes.velocity, k, velocity)
    store(modes.force, k, 0.0)
    return power


@compiled
def adapt(tables, blocks, modes, controls):
    """`damage.mechanics.step.adapt` of all walls."""
    sums, n_modes = blocks.sums, tables.place.shape[2] - RIGID
    clear(sums, at.KINETIC, at.SUMS)
    for b in range(tables.place.shape[1]):
        part, energy = INDEX(b % 8 * 8), spread(0.0)
        add_kinetic_energy(blocks.bodies, INDEX(b) * at.BODY, sums, part)
        for m in range(n_modes):
            velocity = load(modes.velocity, (INDEX(b) * INDEX(n_modes) + INDEX(m)) * WIDTH)
            energy = energy + 0.5 * tables.mass[0, b, RIGID + m] * velocity * velocity
        add(sums, at.KINETIC + part, energy)
    total(sums, at.KINETIC, 8)
    for w in range(controls.shape[0]):
        dt, share, kinetic = controls[w, 0], controls[w, 4], sums[at.KINETIC + INDEX(w)]
        tables.relaxation[w, 0] = adaptive_damping(kinetic, tables.relaxation[w, 1], share, dt)
        tables.relaxation[w, 1] = kinetic


@inlined
def motion_at(modes, strain, a, b, i, motion):
    """`damage.mechanics.strain.motion_at` contact i in eight walls; a, b: rows of the bodies."""
    n_modes, at_a, at_b = INDEX(strain.shapes.shape[2]), strain.rows[i, 0], strain.rows[i, 1]
    opening, shear, m = spread(0.0), spread(0.0), NONE
    of_a, of_b = INDEX(a) * n_modes * WIDTH, INDEX(b) * n_modes * WIDTH
    while m < n_modes:
        qa, qb = load(modes.place, of_a + m * WIDTH), load(modes.place, of_b + m * WIDTH)
        opening = opening + (strain.shapes[at_b, 0, m] * qb - strain.shapes[at_a, 0, m] * qa)
        shear = shear + (strain.shapes[at_b, 1, m] * qb - strain.shapes[at_a, 1, m] * qa)
        m += ONE
    return RelativeMotion(motion.opening + opening, motion.shear + shear, motion.rotation)


@inlined
def push_modes(modes, strain, a, b, i, normal, shear):
    """`damage.mechanics.strain.push_modes` of contact i in eight walls; a, b: rows of the bodies."""
    n_modes, at_a, at_b, m = INDEX(strain.shapes.shape[2]), strain.rows[i, 0], strain.rows[i, 1], NONE
    of_a, of_b = INDEX(a) * n_modes * WIDTH, INDEX(b) * n_modes * WIDTH
    while m < n_modes:
        k, j = of_a + m * WIDTH, of_b + m * WIDTH
        store(modes.force, k, load(modes.force, k) + (normal * strain.shapes[at_a, 0, m]
                                                      + shear * strain.shapes[at_a, 1, m]))
        store(modes.force, j, load(modes.force, j) - (normal * strain.shapes[at_b, 0, m]
                                                      + shear * strain.shapes[at_b, 1, m]))
        m += ONE
