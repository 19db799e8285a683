"""Strain modes of deformable bricks in a time step: relative motion at contact points, generalized forces, motion.

Mode m of a body is its coordinate RIGID + m.  Its generalized force is the work of the contact forces on the opening
and shear displacement by a unit of the mode.  Its mass, stiffness, damping and shape are equal in all walls that step
together.  Theory: `damage.wall.strain`.
"""

from damage.mechanics.compiled import inlined
from damage.mechanics.eight import add, either, wall_of, zero
from damage.mechanics.interfaces import RelativeMotion
from damage.mechanics.rows import first_force, force_of, inverse_mass_of, mass_of, place_of, velocity_of
from damage.mechanics.tables import RIGID, ROW


@inlined
def points_at_once(strain, interface):
    """Number of contact points that share a RelativeMotion: all of an interface between rigid bricks, else one."""
    if strain is None:
        return ROW(interface.stop - interface.start)
    return ROW(1)


@inlined
def motion_at(n, bodies, strain, interface, i, motion):
    """RelativeMotion at contact i: that of the interface plus the displacements by the strain modes of both bricks."""
    if strain is None:
        return motion
    a, b, at_a, at_b, shapes = interface.a, interface.b, strain.rows[i, 0], strain.rows[i, 1], strain.shapes
    opening, shear = zero(n), zero(n)
    for m in range(shapes.shape[2]):
        qa, qb = place_of(n, bodies, a, RIGID + m), place_of(n, bodies, b, RIGID + m)
        opening = opening + (shapes[at_b, 0, m] * qb - shapes[at_a, 0, m] * qa)
        shear = shear + (shapes[at_b, 1, m] * qb - shapes[at_a, 1, m] * qa)
    return RelativeMotion(motion.opening + opening, motion.shear + shear, motion.rotation)


@inlined
def push_modes(n, bodies, strain, interface, i, resultant, which):
    """Add a contact's Resultant to the generalized forces of both bricks' modes, in the walls `which` (flags)."""
    if strain is None:
        return
    a, b, at_a, at_b, shapes = interface.a, interface.b, strain.rows[i, 0], strain.rows[i, 1], strain.shapes
    normal, shear = either(which, resultant.normal, 0.0), either(which, resultant.shear, 0.0)
    for m in range(shapes.shape[2]):
        k = first_force(bodies) + RIGID + m
        add(n, bodies, a, k, normal * shapes[at_a, 0, m] + shear * shapes[at_a, 1, m])
        add(n, bodies, b, k, -(normal * shapes[at_b, 0, m] + shear * shapes[at_b, 1, m]))


@inlined
def energies_of_modes(n, bodies, inertia, strain, dt):
    """Kinetic and elastic energy of all strain modes [J].

    The velocities, known at half steps, are advanced to the time of the amplitudes.
    """
    kinetic, stored, one = zero(n), zero(n), wall_of(n, 0)
    for b in range(len(strain.stiffness)):
        for m in range(strain.shapes.shape[2]):
            place, velocity = place_of(n, bodies, b, RIGID + m), velocity_of(n, inertia, b, RIGID + m)
            rate = force_of(n, bodies, b, RIGID + m) - strain.stiffness[b, m] * place
            rate = rate * inverse_mass_of(one, inertia, b, RIGID + m)
            velocity = (velocity + 0.5 * dt * rate) / (1.0 + 0.5 * dt * strain.damping[b, m])
            kinetic = kinetic + 0.5 * mass_of(one, inertia, b, RIGID + m) * velocity * velocity
            stored = stored + 0.5 * strain.stiffness[b, m] * place * place
    return kinetic, stored
