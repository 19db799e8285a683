"""The joint law for the bonds of another solver, from the places of its bodies."""

import math
from typing import NamedTuple

import numpy as np

from damage.law.joint_law import ContactState, LawParameters, advance, range_left
from damage.mechanics.compiled import entry
from damage.mechanics.simd import ONE, reader, store, writer


class AdvancedBond(NamedTuple):
    """What a step of the joint law makes of a bond.

    Attributes
    ----------
    normal_stress, shear_stress : float
        After the step, tension positive [Pa].
    opening : float
        Plus the plastic closure [m].
    stiffness : float
        Normal stiffness while the bond is as open or closed as it is [Pa/m].
    strength, cohesion : float
        Tensile strength and cohesion that are left [Pa].
    fracture, friction : float
        Works of the step [J/m2].
    event : float
        Event of the joint law.
    cosine, sine : float
        Of the mean rotation of the two bodies.
    """

    normal_stress: float
    shear_stress: float
    opening: float
    stiffness: float
    strength: float
    cohesion: float
    fracture: float
    friction: float
    event: float
    cosine: float
    sine: float


PLACE = 6
"""Numbers of a body's place: x and z [m], and its quaternion x, y, z, w."""


SHEAR_STRESS = ContactState._fields.index("shear_stress")
state_of = reader(ContactState, ContactState._fields)
keep_state = writer(ContactState, ContactState._fields)


class BondTables(NamedTuple):
    """Tables of all bonds, a row each.

    Attributes
    ----------
    at_rest : (n, 2, PLACE) array
        Places of the two bodies at rest.
    arms : (n, 2, 2) array
        The contact point from these places, along x and z [m].
    upright : (n,) array of bool
        Whether the joint is upright.
    laws : (n, 6) array
        Stiffnesses [Pa/m], strengths [Pa] and fracture energies [J/m2], as of LawParameters.
    states : (n, 10, 1) array
        ContactState; the shear stress is derived from `slid`.
    slid : (n,) array
        Plastic shear displacement [m].
    """

    at_rest: np.ndarray
    arms: np.ndarray
    upright: np.ndarray
    laws: np.ndarray
    states: np.ndarray
    slid: np.ndarray


@entry
def advance_bonds(rows, places, steps, closure, bonds, material, advanced):
    """Advance bonds by one step of the joint law, in `bonds`, and write an AdvancedBond of each.

    Parameters
    ----------
    rows : (m,) array of int
        Which bonds.
    places : (m, 2, PLACE) array
        Places of their bodies at the end of the step.
    steps : (m,) array
        Shear displacements in the step [m].
    closure : (n,) array
        Plastic closure of all bonds [m].
    bonds : BondTables
    material : Material
    advanced : (m, fields of AdvancedBond) array
        Written.
    """
    for k in range(len(rows)):
        i = rows[k]
        opening, shear, cosine, sine = displacements(
            places[k], bonds.at_rest[i], bonds.arms[i], bonds.upright[i]
        )
        law = law_of(bonds.laws[i], material)
        before = shear - bonds.slid[i] - steps[k]
        store(ONE, bonds.states, i, SHEAR_STRESS, law.shear_stiffness * before)
        old = state_of(ONE, bonds.states, i)
        opening += closure[i]
        new, event = advance(opening, steps[k], old, law)
        bonds.slid[i] = shear - new.shear_stress / law.shear_stiffness
        keep_state(ONE, bonds.states, i, True, new)
        left = range_left(new, law)
        stiffness = law.normal_stiffness
        if opening > 0.0 and not new.broken:
            stiffness = left.tension_stiffness
        values = AdvancedBond(
            new.normal_stress,
            new.shear_stress,
            opening,
            stiffness,
            left.tensile_strength,
            left.cohesion,
            new.fracture_work - old.fracture_work,
            new.friction_work - old.friction_work,
            float(event),
            cosine,
            sine,
        )
        for column, value in enumerate(values):
            advanced[k, column] = value


@entry
def law_of(numbers, material):
    """LawParameters of a row of `BondTables.laws`."""
    kn, ks, strength, cohesion, mode_i, mode_ii = numbers
    return LawParameters(kn, ks, strength, cohesion, material, mode_i, mode_ii, math.inf, 0.0)


@entry
def displacements(places, at_rest, arms, upright):
    """Opening and shear displacement [m] of a contact point, as of
    `damage.wall.kinematics.ContactKinematics`; cosine and sine of the mean rotation of its bodies.

    places, at_rest: of the two bodies, (2, PLACE); arms: (2, 2) [m].
    """
    x0, z0, cosine0, sine0 = moved(places[0], at_rest[0], arms[0])
    x1, z1, cosine1, sine1 = moved(places[1], at_rest[1], arms[1])
    dx = x1 - x0
    dz = z1 - z0
    cosine = cosine0 * cosine1 - sine0 * sine1
    sine = sine0 * cosine1 + cosine0 * sine1
    along_x = cosine * dx + sine * dz
    along_z = cosine * dz - sine * dx
    if upright:
        return along_x, along_z, cosine, sine
    return along_z, along_x, cosine, sine


@entry
def moved(place, rest, arm):
    """Displacement along x and z of a point of a body [m]; cosine and sine of half the body's
    rotation from x towards z.

    The rotation is the quaternion now times the inverse of that at rest, as a clump in YADE starts
    on permuted axes.
    """
    px, pz, x, y, z, w = place
    px0, pz0, x0, y0, z0, w0 = rest
    real = w * w0 + x * x0 + y * y0 + z * z0
    about_y = w0 * y - w * y0 - z * x0 + x * z0
    size = math.sqrt(real * real + about_y * about_y)
    cosine = real / size
    sine = -about_y / size
    less = -2.0 * sine * sine  # cosine of the whole rotation, less one
    along = 2.0 * sine * cosine  # sine of the whole rotation
    return (
        px - px0 + less * arm[0] - along * arm[1],
        pz - pz0 + along * arm[0] + less * arm[1],
        cosine,
        sine,
    )
