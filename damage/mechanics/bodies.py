"""How a coordinate of a body follows its force: central differences, and damping that acts on bodies.

A body has as many coordinates as its motion needs, for a rigid one displacement along x and z and rotation from x
towards z.  All follow the same equation; where the inverse of a mass is zero, the velocity is prescribed.

Every function takes the numbers of one body, or of eight at once (`damage.mechanics.eight`).
"""

from damage.mechanics.compiled import inlined
from damage.mechanics.eight import either

SMALL = 0.01
"""Angle [rad] below which sine and cosine are evaluated by their series."""


@inlined
def acceleration(force, inverse_mass, field):
    """Acceleration by a force and by a field that acts on all masses backwards [m/s2 or rad/s2]; zero where the
    velocity is prescribed."""
    return either(inverse_mass > 0.0, force * inverse_mass - field, 0.0)


@inlined
def damping(velocity, rate, inverse_mass, alpha, local):
    """Deceleration by mass-proportional damping (alpha [1/s]) and by Cundall's local damping [-], which opposes the
    motion; rate: acceleration without damping [m/s2 or rad/s2]."""
    sign = either(velocity > 0.0, 1.0, either(velocity < 0.0, -1.0, 0.0))
    return either(inverse_mass > 0.0, alpha * velocity + local * abs(rate) * sign, 0.0)


@inlined
def work_of_field(mass, inverse_mass, old, new):
    """Twice the momentum at half the step [kg m/s], on which the field does work; zero where the velocity is
    prescribed."""
    return either(inverse_mass > 0.0, mass * (old + new), 0.0)


@inlined
def power_of_drive(force, inverse_mass, velocity):
    """Power of what prescribes a velocity against the force of the contacts [W]; zero where the body is free."""
    return -either(inverse_mass > 0.0, 0.0, force * velocity)


@inlined
def small_rotation(angle):
    """Cosine less one and sine of a small angle by their series, whose remainder is below 1e-17."""
    square = angle * angle
    return (-0.5 * square * (1.0 - square * (1 / 12) * (1.0 - square * (1 / 30))),
            angle * (1.0 - square * (1 / 6) * (1.0 - square * (1 / 20) * (1.0 - square * (1 / 42)))))


@inlined
def kinetic_energy(mass, velocity):
    """Of a body [J]; mass, velocity: of its coordinates."""
    linear = velocity[0] * velocity[0] + velocity[1] * velocity[1]
    return 0.5 * (mass[0] * linear + mass[2] * velocity[2] * velocity[2])


@inlined
def adaptive_damping(kinetic, last, share, dt):
    """Mass-proportional damping [1/s] for static solutions (Cundall's, as in UDEC): it takes a constant share of the
    rate at which the kinetic energy [J] changes, and so follows whichever mode still moves."""
    if not kinetic > 0.0:
        return 0.0
    # No more than what would stop every body in two steps: near a standstill the ratio has no bound.
    return min(share * abs(kinetic - last) / (dt * (kinetic + last)), 0.5 / dt)
