"""Samples of a wall: contact data, displacements of the bodies, forces on the supports, energies.

Contact data (opening, slip, offset, state) are those of the contact points of failed interfaces,
and zero elsewhere.
"""

from typing import NamedTuple

import numpy as np

from damage.law.joint_law import elastic_energy
from damage.law.states import AT_LIMIT, BROKEN, CRUSHED, ENDED, ENDING
from damage.mechanics import contacts
from damage.mechanics.bodies import energies_of_modes, kinetic_energy
from damage.mechanics.compiled import compiled, inlined
from damage.mechanics.rows import (
    bench_of,
    force_of,
    inverse_mass_of,
    mass_of,
    place_of,
    reading_of,
    stiffness_of,
    strengths_of,
    velocity_of,
)
from damage.mechanics.scaling import scaled_kinetic_energy
from damage.mechanics.simd import argument, either, lane, lanes, load, wall_of, zero
from damage.mechanics.tables import HAS_FAILED, INPUT, RIGID, ROTATION, X, Z

KINETIC = 0
"""Index of the kinetic energy [J] in the totals; `System.energy` follows."""
ELASTIC = 5
"""Index of the elastic energy of deformable bricks [J] in the totals."""
TOTALS = 6
"""Number of totals."""


FIELDS = OPENING, SLIP, OFFSET, STATE = range(4)
FIELD_NAMES = "opening_m", "slip_m", "offset_m", "state"
"""Names of FIELDS: columns of FRAMES of the history."""


@argument
class Samples(NamedTuple):
    """Samples of one or several walls.

    contacts: (walls, samples, FIELDS, contacts); stored: (walls, samples, contacts) elastic energy
    [J]; stress: (walls, samples, 2, contacts) normal, tension positive, and shear [Pa], of no
    contacts where not asked for; displacement: (walls, samples, bodies, coordinates) [m, m, rad, m
    sqrt(kg) ...], the supports last; support_force: (walls, samples, supports, 3) of the wall on
    them [N, N, N m]; totals: (walls, samples, TOTALS).
    """

    contacts: np.ndarray
    stored: np.ndarray
    stress: np.ndarray
    displacement: np.ndarray
    support_force: np.ndarray
    totals: np.ndarray

    @classmethod
    def none(cls, n_walls, n_samples, system, n_supports, with_stresses=True):
        """Samples with all values zero; system: System of one of the walls, whose last bodies are
        the supports."""
        n_contacts = len(system.contacts)
        n_bodies = len(system.place)
        return cls(
            contacts=np.zeros((n_walls, n_samples, len(FIELDS), n_contacts)),
            stored=np.zeros((n_walls, n_samples, n_contacts)),
            stress=np.zeros((n_walls, n_samples, 2, n_contacts * with_stresses)),
            displacement=np.zeros((n_walls, n_samples, n_bodies, system.place.shape[1])),
            support_force=np.zeros((n_walls, n_samples, n_supports, RIGID)),
            totals=np.zeros((n_walls, n_samples, TOTALS)),
        )

    def of_wall(self, wall, count):
        """Views of the first samples of one wall, without the axis of walls."""
        return Samples(*(values[wall, :count] for values in self))


@argument
class Sampling(NamedTuple):
    """Where samples are written: Samples of the walls, and (walls,) numbers of samples written,
    which grow."""

    samples: Samples
    taken: np.ndarray


@compiled
def observe(n, tables, model, ending, sampling):
    """Write the next sample of each of the walls `ending` (bits), at the time of its displacements.

    The bench must hold the parameters of the next step; model, sampling: Model and Sampling.
    """
    observe_stored(n, tables, ending, sampling)
    work = input_of_half_a_step(n, tables)
    kinetic, elastic = energies_of_bodies(n, tables, model.matrix, model.strain)
    for w in range(lanes(n)):
        if ending >> w & 1:
            observe_failed(wall_of(n, w), tables, sampling, w)
            observe_places(wall_of(n, w), tables, sampling, w)
            totals = sampling.samples.totals
            k = sampling.taken[w]
            totals[w, k, KINETIC] = lane(kinetic, w)
            totals[w, k, ELASTIC] = lane(elastic, w)
            for i in range(ELASTIC - KINETIC - 1):
                totals[w, k, KINETIC + 1 + i] = tables.energy[0, i, w]
            totals[w, k, KINETIC + 1 + INPUT] += lane(work, w)
            sampling.taken[w] += 1


@inlined
def observe_stored(n, tables, ending, sampling):
    """Write the elastic energies of all contact points."""
    for c in range(len(tables.contacts)):  # without a branch, so that the divisions are vectorized
        now = reading_of(n, tables.readings, c)
        strengths = strengths_of(n, tables.strengths, c)
        stored = tables.contacts[c].area * elastic_energy(
            now.sigma, now.tau, strengths.normal_stiffness, strengths.shear_stiffness
        )
        for w in range(lanes(n)):
            if ending >> w & 1:
                sampling.samples.stored[w, sampling.taken[w], c] = lane(stored, w)


@inlined
def observe_failed(n, tables, sampling, w):
    """Write the contact data of failed interfaces into the next sample of wall w; n: its width."""
    for p in range(len(tables.interfaces)):
        failed = load(n, tables.limits, p, HAS_FAILED)
        if failed > 0.0:
            ended = ENDED if failed >= ENDING else 0
            for c in range(tables.interfaces[p].start, tables.interfaces[p].stop):
                state = state_of(n, tables.states, c) | ended
                sampling.samples.contacts[w, sampling.taken[w], STATE, c] = state
                observe_contact(n, tables, sampling, w, c)


@inlined
def state_of(n, states, c):
    """State (bits) of contact c by itself: without ENDED, which is of its interface."""
    broken = BROKEN if load(n, states, c, contacts.BROKEN) > 0.0 else 0
    at_limit = AT_LIMIT if load(n, states, c, contacts.AT_LIMIT) > 0.0 else 0
    crushed = CRUSHED if load(n, states, c, contacts.CLOSURE) > 0.0 else 0
    return broken | at_limit | crushed


@inlined
def observe_contact(n, tables, sampling, w, c):
    """Write inelastic opening, slip and offset [m] of contact c, and correct its stored energy
    where a softened bond unloads with a secant stiffness.

    opening: total of a failed bond, inelastic part of a softened one; offset: shear displacement
    less its elastic part.
    """
    samples = sampling.samples
    k = sampling.taken[w]
    states = tables.states
    now = reading_of(n, tables.readings, c)
    kn = stiffness_of(n, tables, c)[0]
    broken = load(n, states, c, contacts.BROKEN) > 0.0
    softened = load(n, states, c, contacts.KAPPA) > 0.0
    force = now.sigma * tables.contacts[c].area
    inelastic = now.opening - force / kn
    opening = offset = 0.0
    if broken:
        opening = positive(now.opening)
    elif softened and now.opening > 0.0:
        opening = positive(inelastic)
    if broken or softened:
        offset = now.shear - now.tau / strengths_of(n, tables.strengths, c).shear_stiffness
    samples.contacts[w, k, OPENING, c] = opening
    samples.contacts[w, k, SLIP, c] = load(n, states, c, contacts.SLIP)
    samples.contacts[w, k, OFFSET, c] = offset
    if load(n, states, c, contacts.TENSION_STIFFNESS) != kn and now.opening > 0.0:
        samples.stored[w, k, c] += force * inelastic / 2


@inlined
def positive(value):
    """The value, zero where it is below; NaN stays."""
    if value <= 0.0:
        return 0.0
    return value


@inlined
def observe_places(n, tables, sampling, w):
    """Write displacements of the bodies, forces on the supports and, where there is room for them,
    stresses into the next sample of wall w; n: its width."""
    samples = sampling.samples
    k = sampling.taken[w]
    bodies = tables.bodies
    displacement = samples.displacement
    support_force = samples.support_force
    supports = displacement.shape[2] - support_force.shape[2]
    for b in range(displacement.shape[2]):
        for axis in range(displacement.shape[3]):
            displacement[w, k, b, axis] = place_of(n, bodies, b, axis)
        if b >= supports:
            for axis in range(RIGID):
                support_force[w, k, b - supports, axis] = force_of(n, bodies, b, axis)
    for c in range(samples.stress.shape[3]):
        now = reading_of(n, tables.readings, c)
        samples.stress[w, k, 0, c] = now.sigma
        samples.stress[w, k, 1, c] = now.tau


@inlined
def energies_of_bodies(n, tables, matrix, strain):
    """Kinetic and elastic energy of all bodies and their strain modes [J]."""
    kinetic, elastic = energies_of_modes(n, tables, strain)
    if matrix is not None:
        return scaled_kinetic_energy(n, tables, matrix, strain), elastic
    return kinetic_energy_of(n, tables) + kinetic, elastic


@inlined
def kinetic_energy_of(n, tables):
    """Kinetic energy of rigid motion at the time of the displacements [J], to which velocities are
    advanced by half a step."""
    bodies = tables.bodies
    inertia = tables.inertia
    bench = bench_of(n, tables.bench, 0)
    energy = zero(n)
    half = 0.5 * bench.step
    for b in range(len(bodies)):
        x = half_step_on(n, bodies, inertia, b, X, bench.base_x, half)
        z = half_step_on(n, bodies, inertia, b, Z, bench.pull_z, half)
        rotation = velocity_of(n, inertia, b, ROTATION) + half * force_of(
            n, bodies, b, ROTATION
        ) * inverse_mass_of(n, inertia, b, ROTATION)
        energy = energy + kinetic_energy(n, inertia, b, x, z, rotation)
    return energy


@inlined
def half_step_on(n, bodies, inertia, b, k, field, half):
    """Velocity of a coordinate, advanced by half a step; field: acceleration of the base and
    gravity [m/s2]."""
    free = inverse_mass_of(n, inertia, b, k)
    force = force_of(n, bodies, b, k)
    return velocity_of(n, inertia, b, k) + either(free > 0.0, half * (force * free - field), 0.0)


@inlined
def input_of_half_a_step(n, tables):
    """Work [J] of the base and of prescribed velocities in the half step before the displacements.

    A step adds the work from half a step before its forces to half a step after them; at a sample
    the last half is missing.
    """
    bodies = tables.bodies
    inertia = tables.inertia
    bench = bench_of(n, tables.bench, 0)
    power = zero(n)
    for b in range(len(bodies)):
        for axis in range(RIGID):
            swept = zero(n)
            velocity = velocity_of(n, inertia, b, axis)
            if axis != ROTATION:
                swept = (
                    mass_of(n, inertia, b, axis)
                    * (bench.base_x if axis == X else bench.base_z)
                    * velocity
                )
            driven = force_of(n, bodies, b, axis) * velocity
            power = power + either(inverse_mass_of(n, inertia, b, axis) == 0.0, driven, swept)
    return -0.5 * bench.step * power
