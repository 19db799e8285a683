"""Strain modes of deformable bricks in a time step: relative motion at contact points, generalized forces, motion.

Mode m of a body is its coordinate RIGID + m.  Its generalized force is the work of the contact forces on the opening
and shear displacement by a unit of the mode.  Its mass, stiffness, damping and shape are equal in all walls that step
together.  Theory: `damage.wall.strain`.
"""

from damage.mechanics.bodies import acceleration, damping
from damage.mechanics.compiled import inlined
from damage.mechanics.eight import add, either, load, store, wall_of, zero
from damage.mechanics.interfaces import RelativeMotion
from damage.mechanics.rows import first_force, force_of, inverse_mass_of, mass_of, place_of, velocity_of
from damage.mechanics.tables import ALPHA, LOCAL, PLACE, RIGID, ROW, VELOCITY


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
def move_modes(n, bodies, inertia, bench, strain, dt, b, lost, damped):
    """Advance velocities and amplitudes of all modes of body b by a step; returns `lost` plus the powers of their
    damping [W].

    dt: time step [s], a number where it is equal in all walls: the division in `advance_mode` is then one of numbers;
    damped: whether the bench has damping.
    """
    one = wall_of(n, 0)  # masses are equal in all walls
    for m in range(strain.shapes.shape[2]):
        k, resistance = RIGID + m, zero(n)
        old, place, free = velocity_of(n, inertia, b, k), place_of(n, bodies, b, k), inverse_mass_of(one, inertia, b, k)
        rate = acceleration(force_of(n, bodies, b, k) - strain.stiffness[b, m] * place, free, 0.0)
        if damped:
            resistance = damping(old, rate, free, load(n, bench, 0, ALPHA), load(n, bench, 0, LOCAL))
        place, new, power = advance_mode(place, old, rate, resistance, mass_of(one, inertia, b, k),
                                         strain.damping[b, m], dt)
        store(n, bodies, b, PLACE + k, place)
        store(n, inertia, b, VELOCITY + 3 * k, new)
        store(n, bodies, b, first_force(bodies) + k, 0.0)
        lost = lost + power
    return lost


@inlined
def advance_mode(place, old, rate, resistance, mass, damping, dt):
    """Amplitude and velocity of a mode after a step, and the power of its damping [W].

    The damping of the mode itself is implicit, so that it does not shorten the stable time step.  place, old:
    amplitude, and velocity half a step ago; rate, resistance: its acceleration, and what other damping takes off it;
    damping: of Strain [1/s].
    """
    half = 0.5 * dt * damping
    new = ((1.0 - half) * old + dt * (rate - resistance)) * (1.0 / (1.0 + half))
    middle = 0.5 * (old + new)
    return place + dt * new, new, mass * (resistance + damping * middle) * middle


@inlined
def kinetic_of_modes(n, inertia, strain, b):
    """Kinetic energy of the strain modes of body b [J]."""
    energy = zero(n)
    for k in range(RIGID, RIGID + strain.shapes.shape[2]):
        velocity = velocity_of(n, inertia, b, k)
        energy = energy + 0.5 * mass_of(wall_of(n, 0), inertia, b, k) * velocity * velocity
    return energy


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
