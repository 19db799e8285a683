"""What the strain modes of deformable bricks add to a step: to the relative motion at a contact point, to the forces,
and their own motion (`damage.wall.strain`).

Mode m of a body is its coordinate RIGID + m, of generalized force the gradient of the contacts' opening and shear.
"""

from damage.mechanics import bodies
from damage.mechanics.compiled import compiled, inlined
from damage.mechanics.interfaces import RelativeMotion
from damage.mechanics.samples import ELASTIC, KINETIC
from damage.mechanics.tables import INDEX, RIGID

ONE = INDEX(1)


@inlined
def points_at_once(strain, interface):
    """How many contact points of an interface share a RelativeMotion: all between rigid bricks, else one."""
    return interface.stop - interface.start if strain.shapes.shape[2] == 0 else ONE


@inlined
def motion_at(system, strain, interface, i, motion):
    """RelativeMotion at contact i: that of the interface, and what the strain modes of both bricks move there."""
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
    """Velocity and amplitude of mode m of body b a step on, its own damping implicit; the power of all damping [W]."""
    k = RIGID + m
    old, free, mass = system.velocity[b, k], system.inverse_mass[b, k], system.mass[b, k]
    rate = bodies.acceleration(system.force[b, k] - strain.stiffness[b, m] * system.place[b, k], free, 0.0)
    resistance = bodies.damping(old, rate, free, alpha, local)
    half = 0.5 * dt * strain.damping[b, m]
    new = ((1.0 - half) * old + dt * (rate - resistance)) / (1.0 + half)
    middle = 0.5 * (old + new)
    system.velocity[b, k] = new
    system.place[b, k] += dt * new
    system.force[b, k] = 0.0
    return mass * (resistance + strain.damping[b, m] * middle) * middle


@inlined
def kinetic_of_modes(mass, velocity):
    """Of a body [J]; mass, velocity: of its coordinates."""
    energy = 0.0
    for k in range(RIGID, len(mass)):
        energy += 0.5 * mass[k] * velocity[k] * velocity[k]
    return energy


@compiled
def observe_modes(system, strain, dt, samples, w, k):
    """Add to a sample the amplitudes of all strain modes, their kinetic energy, velocities carried to the instant of
    the places, and their stored energy [J]."""
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
