"""Kinds of bodies and contact points, the numbers of supports, and the stiffness of each kind:
compliance is lumped here alone."""

import numpy as np

TINY = 1e-6
"""Distance below which two positions are the same [m]."""
GROUND = -1
"""The first support, body -1; others follow as -2, -3, ... (`damage.wall.layout.Supports`)."""
BED = 0
"""Kind of a contact point on a bed joint."""
HEAD = 1
"""Kind of a contact point on a head joint."""
CUT = 2
"""Kind of a contact point on the cut where a brick can split."""
CAP = 3
"""Kind of a contact point on a cap's glue."""
KINDS = ("bed", "head", "brick", "cap")
"""Names of these kinds in histories."""
CAP_COURSE = -1
"""`course` of a cap, or of the beam of a restrained top."""
SLAB_COURSE = -2
"""`course` of a concrete floor."""
LINTEL_COURSE = -3
"""`course` of a segment of a lintel's beam."""
ARCH_COURSE = -4
"""`course` of a brick of an arch."""
SIDE_COURSE = -5
"""`course` of a party wall."""
CAP_HEIGHT = 0.20
"""Height of a cap [m], settled: its centre lies 0.10 m above the wall's top."""


def rows(body, n_bodies):
    """Rows of bodies (n,), supports among them, in tables in which the supports follow n_bodies
    bricks and caps.

    >>> rows([3, -1, -2], 10)
    array([ 3, 10, 11])
    """
    body = np.asarray(body)
    return np.where(body < 0, n_bodies + GROUND - body, body)


def contact_stiffness(wall, options, bodies, kind, first, second):
    """Normal and shear stiffness of contact points [Pa/m], two arrays (n_contacts,): of the joint
    alone between bricks that deform by themselves, else with the compliance of rigid bricks.

    A joint is in series with the bricks on both sides: 1/k = 1/k_joint + d/E, with G in shear; d is
    the distance of the brick centres across the joint, half a brick at the base and at restraints.
    Rigid top masses are glued with the stiffness of a bed joint between bricks.  A cut through a
    brick has the stiffness of the brick between the centres of its parts; in shear that of halves
    is six times stiffer (`damage.wall.split`).

    Under a uniform shear stress bricks in a bond slide along horizontal boundaries above all, which
    get the compliance of the brick, 1/G.

    wall: damage.wall.parameters.Wall; options: damage.wall.model_options.ModelOptions; bodies:
    damage.wall.layout.Bodies; kind, first, second: of the contact points, as in
    damage.wall.contact_points.Contacts.
    """
    brick = wall.brick
    joint = wall.joint
    if options.has_modes:
        stiffnesses = joint.normal_stiffness, joint.shear_stiffness
        return tuple(np.full(len(kind), stiffness) for stiffness in stiffnesses)
    upright = (kind == HEAD) | (kind == CUT)
    distance = np.full(len(kind), brick.height)
    distance[(first < 0) | ((kind == BED) & (bodies.course[second] == CAP_COURSE))] = (
        brick.height / 2
    )
    reach = np.where(bodies.course == SIDE_COURSE, bodies.length / 2, 0.0)
    distance[upright] = (bodies.x - reach)[second[upright]] - (bodies.x + reach)[first[upright]]
    return tuple(
        np.where(kind == CUT, of_cut * modulus / distance, 1 / (1 / stiffness + distance / modulus))
        for stiffness, modulus, of_cut in (
            (joint.normal_stiffness, brick.young_modulus, 1),
            (joint.shear_stiffness, brick.shear_modulus, 6),
        )
    )
