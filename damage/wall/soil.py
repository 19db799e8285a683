"""Soil below the base: springs in series with the base joint that carry no tension.

A Winkler foundation: a footing of width B on soil with the modulus of subgrade reaction k
(vertical) and r k (horizontal) is a spring of k B, r k B per length of the wall.  It is in series
with the base joint, which gets no tensile strength: the base lifts off where it would be pulled,
and has only friction from then on.  Supports, and with them all motion of the ground, are below the
springs.

Radiation damping: dashpots beside the springs, of a long footing that sends waves into the soil,

    vertically c = rho V_La,  horizontally c = rho V_s  [Pa s/m],  V_La = 3.4 V_s / (pi (1 - nu))

with the shear-wave velocity V_s of the soil, its density rho and Poisson's ratio nu (G. Gazetas:
Formulas and charts for impedances of surface and embedded foundations, J. Geotech. Eng. 117(9),
1991, 1363-1381, without the factors by frequency and shape, which are 1 for a long footing at high
frequency).  They act across soil and base joint, which is 70 to 250 times as stiff as the soils of
Groningen: their force is too large by that share.
"""

import math
from dataclasses import replace

import numpy as np

from damage.eigen import eigen

DENSITY = 1800.0
"""Density of the soil that radiates [kg/m3]: wet clay and sand."""
POISSON_RATIO = 0.4
"""Poisson's ratio of the soil that radiates [-]."""


def on_soil(layout):
    """The damage.wall.layout.Layout with its base contacts on the soil of its options; the same
    where that is rigid."""
    options = layout.options
    contacts = layout.contacts
    if options.soil == "rigid":
        return layout
    base = contacts.first < 0
    per_area = float(options.soil) * options.footing / layout.wall.brick.thickness
    stiffness = {
        name: np.where(
            base, _in_series(getattr(contacts, name), share * per_area), getattr(contacts, name)
        )
        for name, share in (("normal_stiffness", 1.0), ("shear_stiffness", options.soil_shear))
    }
    return replace(
        layout,
        contacts=replace(
            contacts, **stiffness, tensile_strength=np.where(base, 0.0, contacts.tensile_strength)
        ),
    )


def radiation_times(options):
    """Damping of the soil over its stiffness, vertically and horizontally [s], of a ModelOptions;
    0.0 without."""
    if options.soil == "rigid" or not options.soil_velocity:
        return 0.0, 0.0
    analog = 3.4 * options.soil_velocity / (math.pi * (1 - POISSON_RATIO))  # Lysmer's velocity
    modulus = float(options.soil)
    return DENSITY * analog / modulus, DENSITY * options.soil_velocity / (
        options.soil_shear * modulus
    )


def fastest_decay(layout):
    """Largest rate at which the dashpots alone would stop a body on the soil [1/s], of a layout;
    0.0 without."""
    times = radiation_times(layout.options)
    contacts = layout.contacts
    bodies = layout.bodies
    base = np.flatnonzero(contacts.first < 0)
    if not any(times) or len(base) == 0:
        return 0.0
    on, place = np.unique(contacts.second[base], return_inverse=True)
    second = contacts.second[base]
    zero = np.zeros(len(base))
    one = np.ones(len(base))
    arm_x = contacts.x[base] - bodies.x[second]
    arm_z = contacts.z[base] - bodies.z[second]
    rates = np.zeros((len(on), 3, 3))
    for time, stiffness, directions in (
        (times[0], contacts.normal_stiffness, (zero, one, arm_x)),
        (times[1], contacts.shear_stiffness, (one, zero, -arm_z)),
    ):
        motion = np.stack(directions, axis=1)
        dashpot = time * stiffness[base] * contacts.area[base]
        np.add.at(
            rates,
            place,
            dashpot[:, np.newaxis, np.newaxis] * motion[:, :, np.newaxis] * motion[:, np.newaxis],
        )
    mass = np.stack([bodies.mass, bodies.mass, bodies.inertia], axis=1)[on]
    root = np.sqrt(mass[:, :, np.newaxis] * mass[:, np.newaxis])
    return float(max(eigen(rate)[0].max() for rate in rates / root))


def _in_series(one, other):
    return 1 / (1 / one + 1 / other)
