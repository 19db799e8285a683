"""Samples of a wall: contact data, displacements of the bodies, forces on the supports, energies.

Contact data (opening, slip, offset, state) are those of the contact points of failed interfaces, and zero elsewhere.
"""

from typing import NamedTuple

import numpy as np

from damage.history.schema import AT_LIMIT, BROKEN, CRUSHED, ENDED
from damage.mechanics.compiled import compiled, entry, inlined
from damage.mechanics.tables import (
    ENDING,
    INPUT,
    READ_OPENING,
    READ_SHEAR,
    READ_SIGMA,
    READ_TAU,
    RIGID,
    ROTATION,
    X,
    Z,
)
from damage.wall.joint_law import elastic_energy

KINETIC, ELASTIC, TOTALS = 0, 5, 6
"""Indices in the totals: kinetic energy [J], followed by `System.energy`; elastic energy of deformable bricks and of
loose contacts [J]; and length of the totals."""


FIELDS = OPENING, SLIP, OFFSET, STATE = range(4)
FIELD_NAMES = "opening_m", "slip_m", "offset_m", "state"
"""Names of FIELDS: columns of FRAMES of the history."""


class Stiffness(NamedTuple):
    """Area [m2], normal and shear stiffness [Pa/m] of the contacts, each (contacts,)."""

    area: np.ndarray
    normal: np.ndarray
    shear: np.ndarray


class Samples(NamedTuple):
    """Samples of one or several walls.

    contacts: (walls, samples, FIELDS, contacts); stored: (walls, samples, contacts) elastic energy [J]; displacement:
    (walls, samples, bodies, coordinates) [m, m, rad, m sqrt(kg) ...], the supports last; support_force: (walls,
    samples, supports, 3) of the wall on them [N, N, N m]; totals: (walls, samples, TOTALS).
    """

    contacts: np.ndarray
    stored: np.ndarray
    displacement: np.ndarray
    support_force: np.ndarray
    totals: np.ndarray

    @classmethod
    def none(cls, n_walls, n_samples, system, n_supports):
        """Samples with all values zero; system: System of one of the walls, whose last bodies are the supports."""
        n_contacts, n_bodies = len(system.contacts), len(system.place)
        return cls(np.zeros((n_walls, n_samples, len(FIELDS), n_contacts)), np.zeros((n_walls, n_samples, n_contacts)),
                   np.zeros((n_walls, n_samples, n_bodies, system.place.shape[1])),
                   np.zeros((n_walls, n_samples, n_supports, RIGID)), np.zeros((n_walls, n_samples, TOTALS)))

    def of(self, wall, which):
        """Samples of one wall, without the axis of walls; which: slice or indices of samples."""
        return Samples(*(values[wall, which] for values in self))


@entry
def observe(system, stiffness, field, dt, samples, w, k):
    """Write sample k of a wall into row w of the samples, at the time of its displacements.

    stiffness: Stiffness; field: (3,) acceleration of the base along x and z and gravity [m/s2]; dt: time step [s].
    """
    readings, displacement, totals = system.readings, samples.displacement, samples.totals
    support_force = samples.support_force
    for c in range(len(system.contacts)):  # without a branch, so that the divisions are vectorized
        samples.stored[w, k, c] = stiffness.area[c] * elastic_energy(
            readings[READ_SIGMA, c], readings[READ_TAU, c], stiffness.normal[c], stiffness.shear[c])
    for p in range(len(system.interfaces)):
        if system.interfaces[p].failed:
            ended = ENDED if system.interfaces[p].failed >= ENDING else 0
            for c in range(system.interfaces[p].start, system.interfaces[p].stop):
                observe_contact(system, stiffness.shear[c], ended, samples, w, k, c)
    supports = len(system.place) - support_force.shape[2]
    for b in range(len(system.place)):
        for axis in range(RIGID):
            displacement[w, k, b, axis] = system.place[b, axis]
            if b >= supports:
                support_force[w, k, b - supports, axis] = system.force[b, axis]
    totals[w, k, KINETIC] = kinetic_energy(system, field, dt)
    for i in range(len(system.energy)):
        totals[w, k, KINETIC + 1 + i] = system.energy[i]
    totals[w, k, KINETIC + 1 + INPUT] += input_of_half_a_step(system, field, dt)


@inlined
def observe_contact(system, ks, ended, samples, w, k, c):
    """Write inelastic opening, slip and offset [m] and state (bits) of contact c, and correct its stored energy where a
    softened bond unloads with a secant stiffness.

    opening: total of a failed bond, inelastic part of a softened one; offset: shear displacement less its elastic part;
    ks: shear stiffness [Pa/m]; ended: bit of its interface.
    """
    contact, state, readings = system.contacts[c], system.states[c], system.readings
    broken, softened, wide = state.broken > 0.0, state.kappa > 0.0, readings[READ_OPENING, c]
    force = readings[READ_SIGMA, c] * contact.area
    opening = wide if broken else wide - force / contact.kn
    opens = broken or (softened and wide > 0.0)
    fields = samples.contacts
    fields[w, k, OPENING, c] = 0.0 if not opens or opening <= 0.0 else opening  # NaN passes
    fields[w, k, SLIP, c] = state.slip
    fields[w, k, OFFSET, c] = readings[READ_SHEAR, c] - readings[READ_TAU, c] / ks if broken or softened else 0.0
    fields[w, k, STATE, c] = (BROKEN if broken else 0) | (AT_LIMIT if state.at_limit > 0.0 else 0) | (
        CRUSHED if state.closure > 0.0 else 0) | ended
    if state.elastic_tension_stiffness != contact.kn and wide > 0.0:
        samples.stored[w, k, c] += force * (wide - force / contact.kn) / 2


@compiled
def kinetic_energy(system, field, dt):
    """Kinetic energy at the time of the displacements [J], to which velocities are advanced by half a step.

    field, dt: as of `observe`.
    """
    force, velocity, mass, inverse = system.force, system.velocity, system.mass, system.inverse_mass
    energy = 0.0
    for b in range(len(velocity)):
        vx, vz, rotating = velocity[b, X], velocity[b, Z], velocity[b, ROTATION]
        if inverse[b, X] > 0.0:
            vx += 0.5 * dt * (force[b, X] * inverse[b, X] - field[0])
        if inverse[b, Z] > 0.0:
            vz += 0.5 * dt * (force[b, Z] * inverse[b, Z] - (field[1] + field[2]))
        rotating += 0.5 * dt * force[b, ROTATION] * inverse[b, ROTATION]
        energy += 0.5 * (mass[b, X] * (vx * vx + vz * vz) + mass[b, ROTATION] * rotating * rotating)
    return energy


@compiled
def input_of_half_a_step(system, field, dt):
    """Work [J] of the base and of prescribed velocities in the half step before the displacements.

    A step adds the work from half a step before its forces to half a step after them; at a sample the last half is
    missing.  field, dt: as of `observe`.
    """
    power = 0.0
    for b in range(len(system.velocity)):
        for axis in range(RIGID):
            velocity = system.velocity[b, axis]
            if system.inverse_mass[b, axis] == 0.0:
                power += system.force[b, axis] * velocity
            elif axis != ROTATION:
                power += system.mass[b, axis] * (field[0] if axis == X else field[1]) * velocity
    return -0.5 * dt * power
