"""Strain modes of deformable bricks in a time step: relative motion at contact points, generalized forces, motion.

Mode m of a body is its coordinate RIGID + m.  Its generalized force is the work of the contact forces on the opening
and shear displacement by a unit of the mode.  Theory: `damage.wall.strain`.
"""

from damage.mechanics import bodies
from damage.mechanics.compiled import entry, inlined
from damage.mechanics.interfaces import RelativeMotion
from damage.mechanics.samples import ELASTIC, KINETIC
from damage.mechanics.tables import INDEX, RIGID

ONE = INDEX(1)


@inlined
def points_at_once(strain, interface):
    """Number of contact points that share a RelativeMotion: all of an interface between rigid bricks, else one."""
    return interface.stop - interface.start if strain.shapes.shape[2] == 0 else ONE


@inlined
def motion_at(system, strain, interface, i, motion):
    """RelativeMotion at contact i: that of the interface plus the displacements by the strain modes of both bricks."""
    if strain.shapes.shape[2] == 0:
        return motion
    a, b, at_a, at_b = interface.a, interface.b, strain.rows[i, 0], strain.rows[i, 1]
    opening = shear = 0.0
    for m in range(strain.shapes.shape[2]):
        qa, qb = system.place[a, RIGID + m], system.place[b, RIGID + m]
        opening += strain.shapes[at_b, 0, m] * qb - strain.shapes[at_a, 0, m] * qa
        shear += strain.shapes[at_b, 1, m] * qb - strain.shapes[at_a, 1, m] * qa
    return RelativeMotion(motion.opening + opening, motion.shear + shear, motion.rotation)


@inlined
def push_modes(system, strain, interface, i, normal, shear):
    """Add a contact's forces along normal and tangent [N] to the generalized forces of both bricks' modes."""
    a, b, at_a, at_b = interface.a, interface.b, strain.rows[i, 0], strain.rows[i, 1]
    for m in range(strain.shapes.shape[2]):
        system.force[a, RIGID + m] += normal * strain.shapes[at_a, 0, m] + shear * strain.shapes[at_a, 1, m]
        system.force[b, RIGID + m] -= normal * strain.shapes[at_b, 0, m] + shear * strain.shapes[at_b, 1, m]


@inlined
def move_mode(system, strain, dt, alpha, local, b, m):
    """Advance velocity and amplitude of mode m of body b by a step; returns the power of its damping [W]."""
    k, resistance = RIGID + m, 0.0
    old, inverse_mass = system.velocity[b, k], system.inverse_mass[b, k]
    rate = bodies.acceleration(system.force[b, k] - strain.stiffness[b, m] * system.place[b, k], inverse_mass, 0.0)
    if alpha > 0.0 or local > 0.0:
        resistance = bodies.damping(old, rate, inverse_mass, alpha, local)
    system.place[b, k], system.velocity[b, k], power = advance_mode(
        system.place[b, k], old, rate, resistance, system.mass[b, k], strain.damping[b, m], dt)
    system.force[b, k] = 0.0
    return power


@inlined
def advance_mode(place, old, rate, resistance, mass, damping, dt):
    """Amplitude and velocity of a mode after a step, and the power of its damping [W].

    The damping of the mode itself is implicit, so that it does not shorten the stable time step.  place, old:
    amplitude, and velocity half a step ago; rate, resistance: its acceleration, and what other damping takes off it;
    damping: of Strain [1/s].  Takes numbers of one wall, or vectors of those of eight.
    """
    half = 0.5 * dt * damping
    new = ((1.0 - half) * old + dt * (rate - resistance)) * (1.0 / (1.0 + half))
    middle = 0.5 * (old + new)
    return place + dt * new, new, mass * (resistance + damping * middle) * middle


@inlined
def kinetic_of_modes(mass, velocity):
    """Kinetic energy of the strain modes of a body [J]; mass, velocity: of all its coordinates."""
    energy = 0.0
    for k in range(RIGID, len(mass)):
        energy += 0.5 * mass[k] * velocity[k] * velocity[k]
    return energy


@entry
def observe_modes(system, strain, dt, samples, w, k):
    """Add the amplitudes of all strain modes to sample k of wall w, and their kinetic and elastic energy [J].

    The velocities, known at half steps, are advanced to the time of the amplitudes.
    """
    kinetic = stored = 0.0
    for b in range(len(system.place)):
        for m in range(strain.shapes.shape[2]):
            place, velocity = system.place[b, RIGID + m], system.velocity[b, RIGID + m]
            rate = (system.force[b, RIGID + m] - strain.stiffness[b, m] * place) * system.inverse_mass[b, RIGID + m]
            velocity = (velocity + 0.5 * dt * rate) / (1.0 + 0.5 * dt * strain.damping[b, m])
            kinetic += 0.5 * system.mass[b, RIGID + m] * velocity * velocity
            stored += 0.5 * strain.stiffness[b, m] * place * place
            samples.displacement[w, k, b, RIGID + m] = place
    samples.totals[w, k, KINETIC] += kinetic
    samples.totals[w, k, ELASTIC] = stored
