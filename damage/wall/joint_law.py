"""The joint law: the definition that every solver is compared with.

A contact of unit area with normal opening u_n (tension positive) and shear displacement u_s:
linear springs, a tension cut-off, Mohr-Coulomb slip, and a bond.  A brittle bond goes at once: exceeding
either strength removes both.  A bond with fracture energies G_I, G_II softens (`soften`).  Once it is gone
the contact is a dry joint with the same friction angle.  Equation numbers are those of Sarhosis et al. (2021),
doi:10.1016/j.engstruct.2021.112529, with tension positive, so that equation (11) reads
|tau| >= c - sigma tan(phi).  Dilation is zero.  The softening bond's are:

    (S1)  sigma <= f_t exp(-kappa)
    (S2)  |tau| <= c exp(-kappa) - sigma tan(phi), never below zero
    (S3)  d kappa = (1 - GONE) (f_t dw / G_I + c ds / G_II),  kappa = 0 at first, the bond fails at -ln(GONE)
    (S4)  sigma = k_n u_n while closed; f_t exp(-kappa) u_n / u_max while 0 < u_n <= u_max = w + f_t exp(-kappa) / k_n
    (S5)  d tau = k_s (d u_s - ds)

w: the largest inelastic opening so far; ds >= 0: inelastic slip.  Tension unloads to the origin, shear with its
stiffness; friction is there from the start and does not soften.  G -> 0 is the brittle bond.  Cohesion that
decays exponentially and shear that unloads elastically are Lourenço and Rots (1997, J. Eng. Mech. 123(7),
660-668); the last hundredth of the bond fails at once, and 1 - GONE makes up for the energy that its tail had.

A joint that crushes is perfectly plastic in compression, whatever its bond:

    (C1)  sigma >= -f_c
    (C2)  sigma = k_n (u_n + d) while closed, with a closure d that only grows: d d > 0 at sigma = -f_c alone

All of the law holds with u_n + d in place of u_n: it unloads with k_n, opens at u_n > -d, has friction by the sigma
that is left, and whole bonds hang together across the closure.  Crushing takes f_c dd.

The functions are scalar and pure; they run as plain Python, and numba compiles them as they are.
"""

import math
from typing import NamedTuple

import numpy as np
from numba.extending import register_jitable

INTACT, TENSION, SHEAR = 0, 1, 2
"""What `advance` reports of a step: no break, the bond broke in tension, or in shear."""
GONE = 0.01
"""Share of its strengths [-] at which a softening bond fails."""


class Material(NamedTuple):
    """Parameters common to all contacts of a wall: friction = tan(phi) [-], equal before and after the bond fails."""

    friction: float


def material_of(joint):
    """The Material of a damage.wall.parameters.Joint."""
    return Material(float(np.tan(joint.friction_angle)))


class LawParameters(NamedTuple):
    """normal_stiffness, shear_stiffness [Pa/m]; tensile_strength, cohesion [Pa] of the whole bond (infinite
    for a joint that stays elastic); material: Material; mode_i_energy, mode_ii_energy [J/m2]: zero for a
    brittle bond; compressive_strength [Pa], infinite where nothing crushes."""

    normal_stiffness: float
    shear_stiffness: float
    tensile_strength: float
    cohesion: float
    material: Material
    mode_i_energy: float = 0.0
    mode_ii_energy: float = 0.0
    compressive_strength: float = math.inf


class ContactState(NamedTuple):
    """normal_stress, shear_stress [Pa]; slip [m]: plastic, signed, of the closed contact;
    broken: the bond has failed; at_limit: has failed in shear or slid without a bond, ever;
    friction_work, fracture_work [J/m2]: dissipated so far, of the latter by crushing, too; kappa [-], gap [m]: of a
    bond that softens, how far, and its largest inelastic opening w; closure [m]: by how much it is crushed, d."""

    normal_stress: float = 0.0
    shear_stress: float = 0.0
    slip: float = 0.0
    broken: bool = False
    at_limit: bool = False
    friction_work: float = 0.0
    fracture_work: float = 0.0
    kappa: float = 0.0
    gap: float = 0.0
    closure: float = 0.0


class ElasticRange(NamedTuple):
    """What is left of a contact's elastic range: tensile_strength, cohesion [Pa]; tension_stiffness [Pa/m] while it is
    open; friction: its coefficient [-]."""

    tensile_strength: float
    cohesion: float
    tension_stiffness: float
    friction: float


@register_jitable
def stays_elastic(normal_stress, shear_stress, tensile_strength, cohesion, friction):
    """Whether a contact with these elastic stresses is within its strengths, equations (10) and (11), so that
    `advance` would change nothing but stresses.

    Strengths are those it has left (`strength_left`).  All may be forces instead of stresses [N], or, with what
    `elastic_range` returns, opening and shear displacement [m].
    """
    return (normal_stress <= tensile_strength) & (abs(shear_stress) < cohesion - normal_stress * friction)


@register_jitable
def withstands(normal_stress, compressive_strength):
    """Whether a contact with this elastic stress does not crush, (C1); both may be forces [N]."""
    return normal_stress >= -compressive_strength


@register_jitable
def elastic_range(parameters):
    """The strengths as displacements: `stays_elastic(opening, shear, *elastic_range(parameters))` of a contact that
    never failed.  Largest opening [m], slide [m] and its loss per opening [-]; parameters may be arrays."""
    kn, ks = parameters.normal_stiffness, parameters.shear_stiffness
    return (parameters.tensile_strength / kn, parameters.cohesion / ks,
            kn / ks * friction_left(False, parameters.material))


@register_jitable
def strength_left(broken, parameters, kappa=0.0):
    """Tensile strength and cohesion that are left [Pa]: none once the bond has failed, else those of (S1), (S2)."""
    if broken:
        return 0.0, 0.0
    if kappa == 0.0:
        return parameters.tensile_strength, parameters.cohesion
    return parameters.tensile_strength * math.exp(-kappa), parameters.cohesion * math.exp(-kappa)


@register_jitable
def friction_left(broken, material):
    """The coefficient of friction [-] of a bond, or of the dry joint that it leaves."""
    return material.friction


@register_jitable
def tension_stiffness(tensile_strength, gap, normal_stiffness):
    """Normal stiffness of an open contact [Pa/m], (S4): of the tensile strength left [Pa] and its gap [m]."""
    if gap == 0.0:
        return normal_stiffness
    return tensile_strength / (gap + tensile_strength / normal_stiffness)


@register_jitable
def range_left(state, parameters):
    """The ElasticRange that a ContactState leaves; parameters may be arrays of contacts that share the state."""
    strength, cohesion = strength_left(state.broken, parameters, state.kappa)
    stiffness = parameters.normal_stiffness
    if state.kappa > 0.0 and not state.broken:
        stiffness = tension_stiffness(strength, state.gap, stiffness)
    return ElasticRange(strength, cohesion, stiffness, friction_left(state.broken, parameters.material))


@register_jitable
def advance(opening, shear_increment, state, parameters):
    """Advance one contact by one step.

    opening [m]: normal opening at the end of the step, negative when pressed together;
    shear_increment [m]: shear displacement during the step.
    Returns (new ContactState, INTACT | TENSION | SHEAR).
    """
    closure, work = crush(opening, state, parameters)
    new, event = advance_uncrushed(opening + closure, shear_increment, state, parameters)
    return ContactState(new.normal_stress, new.shear_stress, new.slip, new.broken, new.at_limit, new.friction_work,
                        new.fracture_work + work, new.kappa, new.gap, closure), event


@register_jitable
def crush(opening, state, parameters):
    """Closure [m] at an opening [m], (C1), (C2), and the work that its growth takes [J/m2]."""
    strength = parameters.compressive_strength
    more = -(opening + state.closure) - strength / parameters.normal_stiffness
    if not more > 0.0:
        return state.closure, 0.0
    # Trapezium of the stresses before and after, as central differences do work on the bodies.
    before = min(max(-state.normal_stress, 0.0), strength)
    return state.closure + more, 0.5 * (before + strength) * more


@register_jitable
def advance_uncrushed(opening, shear_increment, state, parameters):
    """`advance` at an opening from where the contact's closure has left its faces [m]."""
    kn, ks, material = parameters.normal_stiffness, parameters.shear_stiffness, parameters.material
    slip, broken, at_limit, kappa, gap = state.slip, state.broken, state.at_limit, state.kappa, state.gap
    friction_work, fracture_work = state.friction_work, state.fracture_work
    strength, cohesion = strength_left(broken, parameters, kappa)
    sigma = kn * opening  # (7)
    if gap > 0.0 and opening > 0.0 and not broken:
        sigma = tension_stiffness(strength, gap, kn) * opening  # (S4)
    trial = state.shear_stress + ks * shear_increment  # (8)
    if stays_elastic(sigma, trial, strength, cohesion, friction_left(broken, material)):  # (10), (11)
        return ContactState(sigma, trial, slip, broken, at_limit, friction_work, fracture_work, kappa, gap), INTACT
    if parameters.mode_i_energy > 0.0 and not broken:
        return soften(opening, trial, state, parameters)
    return break_or_slide(opening, sigma, trial, state, parameters)


@register_jitable
def break_or_slide(opening, sigma, trial, state, parameters):
    """What a brittle bond, or the joint without one, makes of an opening [m] and elastic stresses [Pa] that are beyond
    its strengths; returns as `advance` does."""
    kn, ks, material = parameters.normal_stiffness, parameters.shear_stiffness, parameters.material
    slip, broken, at_limit, kappa, gap = state.slip, state.broken, state.at_limit, state.kappa, state.gap
    friction_work, fracture_work = state.friction_work, state.fracture_work
    strength, _ = strength_left(broken, parameters)
    event = INTACT
    if not broken and sigma > strength:  # (10)
        fracture_work += elastic_energy(sigma, trial, kn, ks)
        broken, event = True, TENSION
    if broken and opening > 0.0:
        if event == INTACT:  # what shear it still held slides off as it opens
            friction_work += max(0.5 * state.shear_stress * trial / ks, 0.0)
        return ContactState(0.0, 0.0, slip, broken, at_limit, friction_work, fracture_work, kappa, gap), event
    if broken and trial == 0.0:  # closes without shear
        return ContactState(sigma, trial, slip, broken, at_limit, friction_work, fracture_work, kappa, gap), event

    limit = -sigma * friction_left(True, material)
    if not broken:
        if opening > 0.0:  # a bond under tension that fails in shear is open at once
            fracture_work += elastic_energy(sigma, trial, kn, ks)
            return ContactState(0.0, 0.0, slip, True, True, friction_work, fracture_work, kappa, gap), SHEAR
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
    return ContactState(sigma, sign * limit, slip, broken, True, friction_work, fracture_work, kappa, gap), event


@register_jitable
def soften(opening, trial, state, parameters):
    """What a bond with fracture energies makes of an opening [m] and a trial shear stress [Pa] that are beyond its
    strengths; returns as `advance` does.

    kappa after the step fulfils (S1) to (S5) with itself: kappa = grown(kappa).  `grown` never falls, so that from
    the old kappa the iteration climbs to the first solution; for fracture energies above f_t^2 / k_n and c^2 / k_s,
    and any below, which then jump, there is one.
    """
    kn, ks = parameters.normal_stiffness, parameters.shear_stiffness
    rate_i = (1.0 - GONE) * parameters.tensile_strength / parameters.mode_i_energy
    rate_ii = (1.0 - GONE) * parameters.cohesion / parameters.mode_ii_energy
    kappa = state.kappa
    for _ in range(200):
        sigma, gap, tau = on_the_envelope(math.exp(-kappa), opening, trial, state.gap, parameters)
        grown = state.kappa + rate_i * (gap - state.gap) + rate_ii * (abs(trial) - tau) / ks
        done = abs(grown - kappa) <= 1e-13 * (1.0 + kappa)
        kappa = grown
        if done:
            break

    share, event = math.exp(-kappa), INTACT
    if share <= GONE:
        event = SHEAR if rate_ii * (abs(trial) - tau) / ks > rate_i * (gap - state.gap) else TENSION
        share = 0.0
    sigma, gap, tau = on_the_envelope(share, opening, trial, state.gap, parameters)
    slid = (abs(trial) - tau) / ks
    fracture_work, slip, at_limit = state.fracture_work, state.slip, state.at_limit
    old_share = math.exp(-state.kappa)
    if opening > 0.0:  # the secant has become less steep
        strength = old_share * parameters.tensile_strength
        old, new = tension_stiffness(strength, state.gap, kn), sigma / opening
        fracture_work += 0.5 * min(state.gap + strength / kn, opening) * opening * max(old - new, 0.0)
    sign = 1.0 if trial > 0.0 else -1.0
    # Trapezium of the stresses before and after, as in `advance`.
    lost = 0.5 * (max(sign * state.shear_stress, 0.0) + tau) * slid
    of_the_bond = min(lost, 0.5 * parameters.cohesion * (old_share + share) * slid)
    if opening <= 0.0:
        slip += sign * slid
    if event == SHEAR or (event == TENSION and opening <= 0.0 and slid > 0.0):
        at_limit = True
    return ContactState(sigma, sign * tau, slip, event != INTACT, at_limit, state.friction_work + (lost - of_the_bond),
                        fracture_work + of_the_bond, kappa, gap), event


@register_jitable
def on_the_envelope(share, opening, trial, gap, parameters):
    """Normal stress [Pa], gap [m] and size of the shear stress [Pa] with this share of the strengths left [-]:
    (S1), (S4), (S2)."""
    kn, strength = parameters.normal_stiffness, share * parameters.tensile_strength
    gap = max(gap, opening - strength / kn)
    sigma = kn * opening
    if opening > 0.0:
        sigma = tension_stiffness(strength, gap, kn) * opening
    limit = share * parameters.cohesion - sigma * friction_left(False, parameters.material)
    return sigma, gap, min(abs(trial), max(limit, 0.0))


@register_jitable
def elastic_energy(normal_stress, shear_stress, normal_stiffness, shear_stiffness):
    """Elastic energy of a contact per area [J/m2]: sigma^2 / 2 k_n + tau^2 / 2 k_s."""
    return (0.5 * normal_stress * normal_stress / normal_stiffness
            + 0.5 * shear_stress * shear_stress / shear_stiffness)


@register_jitable
def inelastic_opening(opening, normal_stress, normal_stiffness):
    """Inelastic part of an opening [m]: all of it once the bond has failed, none while it is intact."""
    return opening - normal_stress / normal_stiffness if opening > 0.0 else 0.0
