"""The joint law: the definition that every solver is held against.

A contact of unit area with normal opening u_n (tension positive) and shear displacement u_s:
linear springs, a tension cut-off, Mohr-Coulomb slip, and a brittle bond: exceeding either strength
removes both.  Afterwards the contact is a dry joint with the same friction angle.  Equation
numbers are those of Sarhosis et al. (2021), doi:10.1016/j.engstruct.2021.112529, with tension
positive, so that equation (11) reads |tau| >= c - sigma tan(phi).  Dilation is zero.

The functions are scalar and pure; they run as plain Python, and numba compiles them as they are.
"""


from typing import NamedTuple

import numpy as np
from numba.extending import register_jitable

INTACT, TENSION, SHEAR = 0, 1, 2
"""What `advance` reports of a step: no break, the bond broke in tension, or in shear."""


class Material(NamedTuple):
    """What all contacts of a wall share: friction = tan(phi) [-], the same before and after the bond breaks."""

    friction: float


def material_of(joint):
    """The Material of a damage.wall.parameters.Joint."""
    return Material(float(np.tan(joint.friction_angle)))


class LawParameters(NamedTuple):
    """normal_stiffness, shear_stiffness [Pa/m]; tensile_strength, cohesion [Pa] (infinite for a
    joint that stays elastic); material: Material."""

    normal_stiffness: float
    shear_stiffness: float
    tensile_strength: float
    cohesion: float
    material: Material


class ContactState(NamedTuple):
    """normal_stress, shear_stress [Pa]; slip [m]: plastic, signed, of the closed contact;
    broken: the bond is gone; at_limit: has failed in shear or slid, ever;
    friction_work, fracture_work [J/m2]: dissipated so far."""

    normal_stress: float = 0.0
    shear_stress: float = 0.0
    slip: float = 0.0
    broken: bool = False
    at_limit: bool = False
    friction_work: float = 0.0
    fracture_work: float = 0.0


@register_jitable
def stays_elastic(normal_stress, shear_stress, tensile_strength, cohesion, friction):
    """Whether a contact with these elastic stresses is within its strengths, equations (10) and (11), so that
    `advance` would change nothing but stresses.

    Strengths are those it has left (`strength_left`).  All may be forces instead of stresses [N], or, with what
    `elastic_range` returns, opening and shear displacement [m].
    """
    return (normal_stress <= tensile_strength) & (abs(shear_stress) < cohesion - normal_stress * friction)


@register_jitable
def elastic_range(parameters):
    """The strengths as displacements: `stays_elastic(opening, shear, *elastic_range(parameters))` of a contact that
    never failed.  Largest opening [m], slide [m] and its loss per opening [-]; parameters may be arrays."""
    kn, ks, strength, cohesion, material = parameters
    return strength / kn, cohesion / ks, kn / ks * friction_left(False, material)


@register_jitable
def strength_left(broken, parameters):
    """Tensile strength and cohesion that are left [Pa]: a brittle bond has both or neither."""
    if broken:
        return 0.0, 0.0
    return parameters.tensile_strength, parameters.cohesion


@register_jitable
def friction_left(broken, material):
    """The coefficient of friction [-] of a bond, or of the dry joint that it leaves."""
    return material.friction


@register_jitable
def advance(opening, shear_increment, state, parameters):
    """Advance one contact by one step.

    opening [m]: normal opening at the end of the step, negative when pressed together;
    shear_increment [m]: shear displacement during the step.
    Returns (new ContactState, INTACT | TENSION | SHEAR).
    """
    kn, ks, _, _, material = parameters
    slip, broken, at_limit = state.slip, state.broken, state.at_limit
    friction_work, fracture_work = state.friction_work, state.fracture_work
    strength, cohesion = strength_left(broken, parameters)
    sigma = kn * opening  # (7)
    trial = state.shear_stress + ks * shear_increment  # (8)
    if stays_elastic(sigma, trial, strength, cohesion, friction_left(broken, material)):  # (10), (11)
        return ContactState(sigma, trial, slip, broken, at_limit, friction_work, fracture_work), INTACT

    event = INTACT
    if not broken and sigma > strength:  # (10)
        fracture_work += elastic_energy(sigma, trial, kn, ks)
        broken, event = True, TENSION
    if broken and opening > 0.0:
        if event == INTACT:  # what shear it still held slides off as it opens
            friction_work += max(0.5 * state.shear_stress * trial / ks, 0.0)
        return ContactState(0.0, 0.0, slip, broken, at_limit, friction_work, fracture_work), event
    if broken and trial == 0.0:  # closes without shear
        return ContactState(sigma, trial, slip, broken, at_limit, friction_work, fracture_work), event

    limit = -sigma * friction_left(True, material)
    if not broken:
        if opening > 0.0:  # a bond under tension that fails in shear is open at once
            fracture_work += elastic_energy(sigma, trial, kn, ks)
            return ContactState(0.0, 0.0, slip, True, True, friction_work, fracture_work), SHEAR
        broken, event = True, SHEAR
        fracture_work += 0.5 * (abs(trial) - limit) ** 2 / ks
        friction_work += limit * (abs(trial) - limit) / ks
    else:
        # Trapezium of the stresses before and after, as central differences do work on the bodies: the
        # limit changes with the normal stress, and joints slide mostly while it falls.
        before = max(state.shear_stress if trial > 0.0 else -state.shear_stress, 0.0)
        friction_work += 0.5 * (before + limit) * (abs(trial) - limit) / ks
    sign = 1.0 if trial > 0.0 else -1.0
    slip += sign * (abs(trial) - limit) / ks
    return ContactState(sigma, sign * limit, slip, broken, True, friction_work, fracture_work), event


@register_jitable
def elastic_energy(normal_stress, shear_stress, normal_stiffness, shear_stiffness):
    """Elastic energy of a contact per area [J/m2]: sigma^2 / 2 k_n + tau^2 / 2 k_s."""
    return 0.5 * normal_stress**2 / normal_stiffness + 0.5 * shear_stress**2 / shear_stiffness
