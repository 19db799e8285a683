"""Equations of motion of a body: central differences, and damping of its velocity.

The generalized coordinates of a rigid body are its displacements along x and z and its rotation from x towards z.  All
coordinates obey the same equation.  Where the inverse mass is zero, the velocity is prescribed.

All functions accept the values of one body, or vectors of those of a body in eight walls (`damage.mechanics.eight`).
"""

from damage.mechanics.compiled import inlined
from damage.mechanics.eight import either

SMALL = 0.01
"""Angle [rad] below which sine and cosine are evaluated by their Taylor series."""


@inlined
def acceleration(force, inverse_mass, field):
    """Acceleration of a coordinate [m/s2 or rad/s2]: force over mass less `field`, zero where the velocity is
    prescribed.  field: acceleration of the base plus gravity along the coordinate; both act against its direction."""
    return either(inverse_mass > 0.0, force * inverse_mass - field, 0.0)


@inlined
def damping(velocity, rate, inverse_mass, alpha, local):
    """Deceleration of a coordinate by damping [m/s2 or rad/s2]; zero where the velocity is prescribed.

    alpha: mass-proportional damping [1/s]; local: Cundall's local damping [-], a share of |rate| against the velocity;
    rate: acceleration without damping [m/s2 or rad/s2].
    """
    sign = either(velocity > 0.0, 1.0, either(velocity < 0.0, -1.0, 0.0))
    return either(inverse_mass > 0.0, alpha * velocity + local * abs(rate) * sign, 0.0)


@inlined
def work_of_field(mass, inverse_mass, old, new):
    """Sum of the momenta before and after a step [kg m/s], with which the field does work; zero where the velocity is
    prescribed.  old, new: velocities [m/s]."""
    return either(inverse_mass > 0.0, mass * (old + new), 0.0)


@inlined
def power_of_drive(force, inverse_mass, velocity):
    """Power of a prescribed velocity against the force of the contact points [W]; zero where the coordinate is free."""
    return -either(inverse_mass > 0.0, 0.0, force * velocity)


@inlined
def small_rotation(angle):
    """Cosine less one, and sine, of an angle below SMALL [rad], by series with a remainder below 1e-17."""
    square = angle * angle
    return (-0.5 * square * (1.0 - square * (1 / 12) * (1.0 - square * (1 / 30))),
            angle * (1.0 - square * (1 / 6) * (1.0 - square * (1 / 20) * (1.0 - square * (1 / 42)))))


@inlined
def kinetic_energy(mass, velocity):
    """Kinetic energy of a rigid body [J]; mass, velocity: of its coordinates x, z and rotation."""
    linear = velocity[0] * velocity[0] + velocity[1] * velocity[1]
    return 0.5 * (mass[0] * linear + mass[2] * velocity[2] * velocity[2])


@inlined
def adaptive_damping(kinetic, last, share, dt):
    """Mass-proportional damping [1/s] for static solutions: Cundall's adaptive global damping, as in UDEC.

    Its power is a constant share [-] of the rate of change of the kinetic energy, so that it adapts to the dominant
    mode.  kinetic, last: kinetic energy now and in the last step [J]; dt: time step [s].
    """
    if not kinetic > 0.0:
        return 0.0
    # Limited to what stops every body in two steps, since the ratio is unbounded near rest.
    return min(share * abs(kinetic - last) / (dt * (kinetic + last)), 0.5 / dt)
