"""What is told of walls at a sample, in one pass: most pairs are whole, and of those nothing but energy is told."""

from typing import NamedTuple

import numpy as np

from damage.history.schema import AT_LIMIT, BROKEN, CRUSHED
from damage.reference.bodies import kinetic_energy
from damage.reference.compiled import compiled, inlined
from damage.reference.tables import READ_OPENING, READ_SHEAR, READ_SIGMA, READ_TAU
from damage.wall.joint_law import elastic_energy

BASE_SHEAR, KINETIC, TOTALS = 0, 1, 6
"""Of the totals the horizontal force on the ground [N], kinetic energy [J], and from there on `System.energy`."""


class Springs(NamedTuple):
    """Of the kernel's contacts area [m2], normal and shear stiffness [Pa/m], (contacts,)."""

    area: np.ndarray
    normal: np.ndarray
    shear: np.ndarray


class Samples(NamedTuple):
    """What is told of each of some walls at one sample after the other.

    opening, slip, offset [m], state (bits): (walls, samples, contacts) of the kernel's contacts, written where their
    pair is broken alone, and zero elsewhere; stored: energy [J] of all; displacement: (walls, samples, bodies, 3)
    [m, m, rad]; totals: (walls, samples, TOTALS).
    """

    opening: np.ndarray
    slip: np.ndarray
    offset: np.ndarray
    state: np.ndarray
    stored: np.ndarray
    displacement: np.ndarray
    totals: np.ndarray

    @classmethod
    def none(cls, n_walls, n_samples, n_contacts, n_bodies):
        """Zero throughout, as of whole pairs."""
        shape = n_walls, n_samples, n_contacts
        return cls(np.zeros(shape), np.zeros(shape), np.zeros(shape), np.zeros(shape, "u1"), np.zeros(shape),
                   np.zeros((n_walls, n_samples, n_bodies, 3)), np.zeros((n_walls, n_samples, TOTALS)))

    def of(self, wall, which):
        """Samples of one wall, without that axis; which: a slice."""
        return Samples(*(values[wall, which] for values in self))


@compiled
def observe(tables, lane, springs, field_x, field_z, dt, samples, wall, k):
    """Write what is told of the wall in this lane now: sample k of this wall; field_x, field_z, dt: as of
    `bodies.kinetic_energy`."""
    readings, stored, displacement = tables.readings, samples.stored, samples.displacement
    for c in range(stored.shape[2]):  # of all alike: so the divisions are those of vectors
        stored[wall, k, c] = springs.area[c] * elastic_energy(
            readings[lane, READ_SIGMA, c], readings[lane, READ_TAU, c], springs.normal[c], springs.shear[c])
    for p in range(tables.pairs.shape[1]):
        if tables.pairs[lane, p].broken:
            for c in range(tables.pairs[lane, p].start, tables.pairs[lane, p].stop):
                observe_contact(tables, lane, springs.shear[c], c, samples, wall, k)
    for b in range(displacement.shape[2]):
        for axis, column in ((0, 0), (1, 1), (2, 7)):
            displacement[wall, k, b, axis] = tables.place[lane, b, column]
    totals = samples.totals
    totals[wall, k, BASE_SHEAR] = tables.place[lane, displacement.shape[2], 4]
    totals[wall, k, KINETIC] = kinetic_energy(tables.place[lane], tables.motion[lane], field_x, field_z, dt)
    for i in range(tables.energy.shape[1]):
        totals[wall, k, KINETIC + 1 + i] = tables.energy[lane, i]


@inlined
def observe_contact(tables, lane, ks, c, samples, wall, k):
    """Write what has opened, slid and been offset inelastically [m] at a contact of a broken pair, and whether it
    broke, was at its limit or has been crushed (bits); add what a bond that softens has stored by its secant [J].

    Open is what is past a broken bond, or what a softened one has given way; offset, the shear displacement less its
    elastic part, of what has broken or softened, zero elsewhere.
    """
    joint, contact, readings = tables.joints[lane, c], tables.contacts[lane, c], tables.readings
    wide, softened = readings[lane, READ_OPENING, c], joint.kappa > 0.0
    force = readings[lane, READ_SIGMA, c] * joint.area
    gap = wide if joint.broken else wide - force / contact.kn
    opens = joint.broken or (softened and wide > 0.0)
    samples.opening[wall, k, c] = 0.0 if not opens or gap <= 0.0 else gap  # and what is not finite stays so
    samples.slip[wall, k, c] = joint.slip
    samples.offset[wall, k, c] = (readings[lane, READ_SHEAR, c] - readings[lane, READ_TAU, c] / ks
                                  if joint.broken or softened else 0.0)
    samples.state[wall, k, c] = (BROKEN if joint.broken else 0) | (AT_LIMIT if joint.at_limit else 0) | (
        CRUSHED if contact.closure > 0.0 else 0)
    if contact.kt != contact.kn and wide > 0.0:
        samples.stored[wall, k, c] += force * (wide - force / contact.kn) / 2
