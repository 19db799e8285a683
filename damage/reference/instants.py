"""What is told of one wall at a sample, in one pass: most pairs are whole, and of those nothing but energy is told."""

from typing import NamedTuple

import numpy as np

from damage.history.schema import AT_LIMIT, BROKEN, CRUSHED
from damage.reference.bodies import kinetic_energy
from damage.reference.compiled import compiled, inlined
from damage.reference.tables import READ_OPENING, READ_SHEAR, READ_SIGMA, READ_TAU
from damage.wall.joint_law import elastic_energy


class Observed(NamedTuple):
    """Of the kernel's contacts: opening, slip and offset [m], state (bits), stored energy [J]; of the bodies
    displacement (n_bodies, 3) [m, m, rad]."""

    opening: np.ndarray
    slip: np.ndarray
    offset: np.ndarray
    state: np.ndarray
    stored: np.ndarray
    displacement: np.ndarray

    @classmethod
    def none(cls, n_contacts, n_bodies):
        """Zero throughout, as of whole contacts."""
        n = n_contacts  # one by one: arrays of this size get the memory that the last ones have left
        return cls(np.zeros(n), np.zeros(n), np.zeros(n), np.zeros(n, "u1"), np.empty(n), np.empty((n_bodies, 3)))


@compiled
def observe(pairs, joints, contacts, readings, place, motion, area, kn, ks, field_x, field_z, dt,
            opening, slip, offset, state, stored, displacement):
    """Write what is told of one wall into arrays of zeros (Observed); area, kn, ks: of contacts [m2, Pa/m].

    place, motion: (bodies + ground, 8); the rest as of `bodies.kinetic_energy`.  Returns that [J].
    """
    sigma, tau = readings[READ_SIGMA], readings[READ_TAU]
    for c in range(len(stored)):  # of all alike: so the divisions are those of vectors
        stored[c] = area[c] * elastic_energy(sigma[c], tau[c], kn[c], ks[c])
    for p in range(len(pairs)):
        if pairs[p].broken:
            for c in range(pairs[p].start, pairs[p].stop):
                observe_contact(joints[c], contacts[c], readings, ks[c], c, opening, slip, offset, state, stored)
    for k in range(len(displacement)):
        displacement[k, 0], displacement[k, 1], displacement[k, 2] = place[k, 0], place[k, 1], place[k, 7]
    return kinetic_energy(place, motion, field_x, field_z, dt)


@inlined
def observe_contact(joint, contact, readings, ks, c, opening, slip, offset, state, stored):
    """Write what has opened, slid and been offset inelastically [m] at a contact of a broken pair, and whether it
    broke, was at its limit or has been crushed (bits); add what a bond that softens has stored by its secant [J].

    Open is what is past a broken bond, or what a softened one has given way; offset, the shear displacement less its
    elastic part, of what has broken or softened, zero elsewhere.
    """
    wide, softened = readings[READ_OPENING, c], joint.kappa > 0.0
    force = readings[READ_SIGMA, c] * joint.area
    gap = wide if joint.broken else wide - force / contact.kn
    opens = joint.broken or (softened and wide > 0.0)
    opening[c] = 0.0 if not opens or gap <= 0.0 else gap  # and what is not finite stays so
    slip[c] = joint.slip
    offset[c] = readings[READ_SHEAR, c] - readings[READ_TAU, c] / ks if joint.broken or softened else 0.0
    state[c] = (BROKEN if joint.broken else 0) | (AT_LIMIT if joint.at_limit else 0) | (
        CRUSHED if contact.closure > 0.0 else 0)
    if contact.kt != contact.kn and wide > 0.0:
        stored[c] += force * (wide - force / contact.kn) / 2
