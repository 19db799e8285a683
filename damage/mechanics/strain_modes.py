"""Strain modes of deformable bricks at the contact points; theory: `damage.wall.strain`.

Mode m of a body is its coordinate RIGID + m.  Its generalized force is the work of the contact
forces on the opening and shear displacement by a unit of the mode.  Its mass, stiffness, damping
and shape are equal in all walls that step together.
"""

import numpy as np

from damage.mechanics import rows
from damage.mechanics.compiled import inlined
from damage.mechanics.interfaces import RelativeMotion
from damage.mechanics.simd import add, either, zero
from damage.mechanics.tables import (
    RIGID,
    ROW,
)


@inlined
def deforms(strain):
    """Whether bricks deform."""
    return strain is not None


@inlined
def points_at_once(strain, interface):
    """Number of contact points that share a RelativeMotion: all of an interface between rigid
    bricks, else one."""
    if strain is None:
        return ROW(interface.stop - interface.start)
    return ROW(1)


@inlined
def motion_at(n, bodies, strain, interface, i, motion):
    """RelativeMotion at contact i: that of the interface plus the displacements by the strain modes
    of both bricks."""
    if strain is None:
        return motion
    a = interface.a
    b = interface.b
    at_a = strain.rows[i, 0]
    at_b = strain.rows[i, 1]
    shapes = strain.shapes
    opening = zero(n)
    shear = zero(n)
    for m in range(shapes.shape[2]):
        qa = rows.place_of(n, bodies, a, RIGID + m)
        qb = rows.place_of(n, bodies, b, RIGID + m)
        opening = opening + (shapes[at_b, 0, m] * qb - shapes[at_a, 0, m] * qa)
        shear = shear + (shapes[at_b, 1, m] * qb - shapes[at_a, 1, m] * qa)
    return RelativeMotion(motion.opening + opening, motion.shear + shear, motion.rotation)


@inlined
def push_modes(n, bodies, strain, interface, i, resultant, which):
    """Add a contact's Resultant to the generalized forces of both bricks' modes, in the walls
    `which` (flags)."""
    if strain is None:
        return
    a = interface.a
    b = interface.b
    at_a = strain.rows[i, 0]
    at_b = strain.rows[i, 1]
    shapes = strain.shapes
    normal = either(which, resultant.normal, 0.0)
    shear = either(which, resultant.shear, 0.0)
    for m in range(shapes.shape[2]):
        k = rows.first_force(bodies) + RIGID + m
        add(n, bodies, a, k, normal * shapes[at_a, 0, m] + shear * shapes[at_a, 1, m])
        add(n, bodies, b, k, -(normal * shapes[at_b, 0, m] + shear * shapes[at_b, 1, m]))


@inlined
def last_row(strain, p, start):
    """Row of `last` of interface p, or of its contact where bricks deform."""
    return p if strain is None else np.int64(start)
