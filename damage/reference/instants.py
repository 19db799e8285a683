"""What is told of one wall at a sample, in one pass: most pairs are whole, and of those nothing but energy is told."""

from typing import NamedTuple

import numpy as np

from damage.history.schema import AT_LIMIT, BROKEN, CRUSHED
from damage.reference.bodies import kinetic_energy
from damage.reference.compiled import compiled, inlined
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
def observe(pairs, joints, contacts, place, motion, area, kn, ks, field_x, field_z, dt,
            opening, slip, offset, state, stored, displacement):
    """Write what is told of one wall into arrays of zeros (Observed); area, kn, ks: of contacts [m2, Pa/m].

    place, motion: (bodies + ground, 8); the rest as of `bodies.kinetic_energy`.  Returns that [J].
    """
    for c in range(len(stored)):  # of all alike: so the divisions are those of vectors
        stored[c] = area[c] * elastic_energy(joints[c].sigma, joints[c].tau, kn[c], ks[c])
    for p in range(len(pairs)):
        if pairs[p].broken:
            for c in range(pairs[p].start, pairs[p].stop):
                observe_contact(joints[c], contacts[c], ks[c], c, opening, slip, offset, state, stored)
    for k in range(len(displacement)):
        displacement[k, 0], displacement[k, 1], displacement[k, 2] = place[k, 0], place[k, 1], place[k, 7]
    return kinetic_energy(place, motion, field_x, field_z, dt)


@inlined
def observe_contact(joint, contact, ks, c, opening, slip, offset, state, stored):
    """Write what has opened, slid and been offset inelastically [m] at a contact of a broken pair, and whether it
    broke, was at its limit or has been crushed (bits); add what a bond that softens has stored by its secant [J].

    Open is what is past a broken bond, or what a softened one has given way; offset, the shear displacement less its
    elastic part, of what has broken or softened, zero elsewhere.
    """
    softened = joint.kappa > 0.0
    force = joint.sigma * joint.area
    gap = joint.opening if joint.broken else joint.opening - force / contact.kn
    opens = joint.broken or (softened and joint.opening > 0.0)
    opening[c] = 0.0 if not opens or gap <= 0.0 else gap  # and what is not finite stays so
    slip[c] = joint.slip
    offset[c] = joint.shear - joint.tau / ks if joint.broken or softened else 0.0
    state[c] = (BROKEN if joint.broken else 0) | (AT_LIMIT if joint.at_limit else 0) | (
        CRUSHED if contact.closure > 0.0 else 0)
    if contact.kt != contact.kn and joint.opening > 0.0:
        stored[c] += force * (joint.opening - force / contact.kn) / 2
