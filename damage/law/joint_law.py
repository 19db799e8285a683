"""Joint law: stresses, slip, failure and dissipation of a contact point.  All solvers are compared
with it.

A contact point of unit area has a normal opening u_n (tension positive) and a shear displacement
u_s.  It has linear springs, a tension cut-off, Mohr-Coulomb slip, and a bond.  A brittle bond fails
at once: exceeding either strength removes both.  A bond with fracture energies G_I, G_II softens
(`soften`).  After failure the contact point is a dry joint with the same friction angle.  Dilation
is zero.  Equations (7) to (11) are those of Sarhosis et al. (2021),
doi:10.1016/j.engstruct.2021.112529, here with tension positive, so that (11) reads |tau| >= c -
sigma tan(phi). Softening:

    (S1)  sigma <= f_t exp(-kappa)
    (S2)  |tau| <= c exp(-kappa) - sigma tan(phi), never below zero
    (S3)  d kappa = (1 - GONE) (f_t dw / G_I + c ds / G_II),  kappa = 0 at first, the bond fails at
          -ln(GONE)
    (S4)  sigma = k_n u_n while closed; f_t exp(-kappa) u_n / u_max while
          0 < u_n <= u_max = w + f_t exp(-kappa) / k_n
    (S5)  d tau = k_s (d u_s - ds)

w: largest inelastic opening so far; ds >= 0: increment of inelastic slip.  Tension unloads to the
origin, shear with the elastic stiffness; friction acts from the start and does not soften.  The
limit G -> 0 is the brittle bond. Exponential softening of the cohesion and elastic unloading in
shear follow Lourenço and Rots (1997, J. Eng. Mech. 123(7), 660-668).  The last hundredth of the
strengths is lost at once; the factor 1 - GONE keeps the fracture energies.

Crushing is plastic in compression, with or without a bond: perfectly, or with a fracture energy G_c
softening:

    (C1)  sigma >= -f
    (C2)  sigma = k_n (u_n + d) while closed; the plastic closure d only grows, and only at
          sigma = -f
    (C3)  f = f_c; with a fracture energy f = f_c exp(-f_c d / G_c)

All other equations hold with u_n + d in place of u_n: the joint unloads with k_n and opens at u_n >
-d, the friction limit follows the reduced sigma, and an intact bond stays intact.  Crushing
dissipates f dd, G_c in all by (C3).

The functions are scalar and without side effects; they run as plain Python or compiled by numba.
"""

import math
from typing import NamedTuple

from numba.extending import register_jitable

from damage.elementary import exp, tan
from damage.rounded import to_bits
from damage.wall.split import PEAK

INTACT = 0
"""Result of `advance`: no bond failed in the step."""
TENSION = 1
"""Result of `advance`: the bond failed in tension."""
SHEAR = 2
"""Result of `advance`: the bond failed in shear."""
GONE = 0.01
"""Remaining share of its strengths [-] at which a softening bond fails."""
AREA = 1.0 - GONE
"""Integral of `share_left` over kappa until a softening bond fails [-]."""


class Material(NamedTuple):
    """Parameters common to all contact points of a wall; friction: tan(phi) [-], equal before and
    after failure.

    A field that is added has a default that changes nothing (CONTRIBUTING.md).
    """

    friction: float


def material_of(joint) -> Material:
    """The Material of a damage.wall.parameters.Joint.

    >>> from types import SimpleNamespace
    >>> round(material_of(SimpleNamespace(friction_angle=0.5)).friction, 4)
    0.5463
    """
    return Material(float(to_bits(tan(joint.friction_angle))))


class LawParameters(NamedTuple):
    """Parameters of a contact point: normal_stiffness, shear_stiffness [Pa/m]; tensile_strength,
    cohesion [Pa] of the intact bond, infinite for a joint that stays elastic; material: Material;
    mode_i_energy, mode_ii_energy: fracture energies [J/m2], zero for a brittle bond;
    compressive_strength [Pa], infinite without crushing; crushing_energy: its fracture energy G_c
    [J/m2], zero where its strength stays."""

    normal_stiffness: float
    shear_stiffness: float
    tensile_strength: float
    cohesion: float
    material: Material
    mode_i_energy: float = 0.0
    mode_ii_energy: float = 0.0
    compressive_strength: float = math.inf
    crushing_energy: float = 0.0


class ContactState(NamedTuple):
    """State of a contact point: normal_stress, shear_stress [Pa]; slip: plastic shear displacement
    while closed, signed [m]; broken: whether the bond has failed; at_limit: whether it ever failed
    in shear, or slid afterwards; friction_work, fracture_work: dissipated so far, the latter with
    crushing [J/m2]; kappa: softening variable [-]; gap: largest inelastic opening w [m]; closure:
    plastic closure d [m]."""

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
    """Elastic range of a contact point in its present state: tensile_strength, cohesion [Pa];
    tension_stiffness: normal stiffness while open [Pa/m]; friction: coefficient [-];
    compressive_strength [Pa]."""

    tensile_strength: float
    cohesion: float
    tension_stiffness: float
    friction: float
    compressive_strength: float


@register_jitable
def stays_elastic(normal_stress, shear_stress, tensile_strength, cohesion, friction):
    """Whether elastic trial stresses are within the remaining strengths, equations (10) and (11).

    If so, `advance` changes the stresses only.  All arguments but friction [-] are stresses [Pa],
    or forces [N], or, with the result of `elastic_range`, displacements [m].  Strengths: as of
    `strength_left`.

    >>> stays_elastic(-0.3e6, 0.1e6, 0.2e6, 0.24e6, 0.6)
    True
    """
    return (normal_stress <= tensile_strength) & (
        abs(shear_stress) < cohesion - normal_stress * friction
    )


@register_jitable
def withstands(normal_stress, compressive_strength):
    """Whether an elastic trial stress [Pa] causes no crushing, (C1); both arguments may be forces
    [N].

    >>> withstands(-5e6, 6e6), withstands(-7e6, 6e6)
    (True, False)
    """
    return normal_stress >= -compressive_strength


@register_jitable
def elastic_range(parameters: LawParameters) -> tuple:
    """Elastic range of an intact contact point in displacements: `stays_elastic(opening, shear,
    *elastic_range(...))`.

    Returns the largest opening [m], the largest shear displacement without opening [m], and its
    reduction per opening [-].  parameters: LawParameters, also of arrays.
    """
    kn = parameters.normal_stiffness
    ks = parameters.shear_stiffness
    return (
        parameters.tensile_strength / kn,
        parameters.cohesion / ks,
        kn / ks * friction_left(False, parameters.material),
    )


@register_jitable
def strength_left(
    broken: bool, parameters: LawParameters, kappa: float = 0.0
) -> tuple[float, float]:
    """Remaining tensile strength and cohesion [Pa]: zero after failure, else by (S1), (S2); kappa:
    of softening [-]."""
    if broken:
        return 0.0, 0.0
    if kappa == 0.0:
        return parameters.tensile_strength, parameters.cohesion
    share = share_left(kappa, parameters.material)
    return parameters.tensile_strength * share, parameters.cohesion * share


@register_jitable
def share_left(kappa: float, material: Material) -> float:
    """Share of its strengths [-] that is left of a softening bond at kappa [-], (S1), (S2).

    It falls from 1 at zero; its integral until the bond fails is AREA.

    >>> round(float(share_left(1.0, Material(0.6))), 4)
    0.3679
    """
    return exp(-kappa)


@register_jitable
def friction_left(broken: bool, material: Material) -> float:
    """Coefficient of friction [-] of an intact or, if broken, failed contact point.

    >>> friction_left(True, Material(0.6))
    0.6
    """
    return material.friction


@register_jitable
def diagonal_tension(strength: float, sigma: float) -> float:
    """Mean shear stress [Pa] that the middle of a brick bears under a vertical stress, tension
    positive [Pa], by its tensile strength [Pa] (`damage.wall.split`).

    >>> round(diagonal_tension(1e6, -1e6) / 1e6, 3)
    1.23
    """
    return math.sqrt(max(strength * (strength - sigma), 0.0)) / PEAK


@register_jitable
def crushing_strength_left(closure: float, parameters: LawParameters) -> float:
    """Remaining compressive strength [Pa] at a plastic closure [m], (C3)."""
    strength = parameters.compressive_strength
    if closure == 0.0 or parameters.crushing_energy == 0.0:
        return strength
    return strength * exp(-strength * closure / parameters.crushing_energy)


@register_jitable
def tension_stiffness(tensile_strength: float, gap: float, normal_stiffness: float) -> float:
    """Secant normal stiffness of an open contact point [Pa/m], (S4).

    tensile_strength: remaining [Pa]; gap: largest inelastic opening [m]; normal_stiffness: elastic
    [Pa/m].

    >>> round(tension_stiffness(0.2e6, 1e-3, 1e12) / 1e9, 3)
    0.2
    """
    if gap == 0.0:
        return normal_stiffness
    return tensile_strength / (gap + tensile_strength / normal_stiffness)


@register_jitable
def range_left(state: ContactState, parameters: LawParameters) -> ElasticRange:
    """ElasticRange in a ContactState; parameters: LawParameters, also of arrays of contact points
    in the same state."""
    strength, cohesion = strength_left(state.broken, parameters, state.kappa)
    stiffness = parameters.normal_stiffness
    if state.kappa > 0.0 and not state.broken:
        stiffness = tension_stiffness(strength, state.gap, stiffness)
    return ElasticRange(
        strength,
        cohesion,
        stiffness,
        friction_left(state.broken, parameters.material),
        crushing_strength_left(state.closure, parameters),
    )


@register_jitable
def advance(
    opening: float, shear_increment: float, state: ContactState, parameters: LawParameters
) -> tuple[ContactState, int]:
    """State of a contact point after a step, equations (7) to (11), (S1) to (S5), (C1) to (C3).

    opening: at the end of the step [m], negative under compression; shear_increment: shear
    displacement in the step [m]; state: ContactState before it; parameters: LawParameters.  Returns
    (ContactState, INTACT | TENSION | SHEAR).

    >>> brittle = LawParameters(1e12, 4e11, 0.2e6, 0.24e6, Material(0.6))
    >>> state, event = advance(0.1e-6, 0.0, ContactState(), brittle)
    >>> round(state.normal_stress), event == INTACT  # [Pa]
    (100000, True)
    >>> state, event = advance(0.3e-6, 0.0, state, brittle)
    >>> state.normal_stress, state.broken, event == TENSION
    (0.0, True, True)
    """
    closure, work = crush(opening, state, parameters)
    new, event = advance_uncrushed(opening + closure, shear_increment, state, parameters)
    return (
        ContactState(
            new.normal_stress,
            new.shear_stress,
            new.slip,
            new.broken,
            new.at_limit,
            new.friction_work,
            new.fracture_work + work,
            new.kappa,
            new.gap,
            closure,
        ),
        event,
    )


@register_jitable
def crush(opening: float, state: ContactState, parameters: LawParameters) -> tuple[float, float]:
    """Plastic closure [m] at an opening [m] by (C1) to (C3), and the work of its growth in the step
    [J/m2]."""
    strength = crushing_strength_left(state.closure, parameters)
    more, left = closure_growth(-(opening + state.closure), state.closure, strength, parameters)
    if not more > 0.0:
        return state.closure, 0.0
    # Trapezoidal rule over the step, which is the work of central differences on the bodies.
    before = min(max(-state.normal_stress, 0.0), strength)
    return state.closure + more, 0.5 * (before + left) * more


@register_jitable
def closure_growth(
    depth: float, closure: float, strength: float, parameters: LawParameters
) -> tuple[float, float]:
    """Growth of the plastic closure [m] of a contact point pressed by `depth` beyond its rest
    position, and the strength that is left then [Pa]; a number that is not positive means no
    growth.

    depth: closing displacement less the plastic closure [m]; strength: left at the plastic closure
    [Pa].  The growth m is the smallest solution of k_n (depth - m) = f(closure + m), found by
    fixed-point iteration from below; below f_c^2 / k_n (snap-back) it may jump.
    """
    more = depth - strength / parameters.normal_stiffness
    if parameters.crushing_energy == 0.0 or not more > 0.0:
        return more, strength
    left = strength
    for _ in range(200):
        left = crushing_strength_left(closure + more, parameters)
        grown = depth - left / parameters.normal_stiffness
        done = grown - more <= 1e-13 * depth
        more = grown
        if done:
            break
    return more, crushing_strength_left(closure + more, parameters)


@register_jitable
def advance_uncrushed(
    opening: float, shear_increment: float, state: ContactState, parameters: LawParameters
) -> tuple[ContactState, int]:
    """`advance` without crushing; opening: plus the plastic closure [m]."""
    broken = state.broken
    gap = state.gap
    material = parameters.material
    strength, cohesion = strength_left(broken, parameters, state.kappa)
    sigma = parameters.normal_stiffness * opening  # (7)
    if gap > 0.0 and opening > 0.0 and not broken:
        sigma = tension_stiffness(strength, gap, parameters.normal_stiffness) * opening  # (S4)
    trial = state.shear_stress + parameters.shear_stiffness * shear_increment  # (8)
    # (10), (11)
    if stays_elastic(sigma, trial, strength, cohesion, friction_left(broken, material)):
        return (
            ContactState(
                sigma,
                trial,
                state.slip,
                broken,
                state.at_limit,
                state.friction_work,
                state.fracture_work,
                state.kappa,
                gap,
            ),
            INTACT,
        )
    if parameters.mode_i_energy > 0.0 and not broken:
        return soften(opening, trial, state, parameters)
    return break_or_slide(opening, sigma, trial, state, parameters)


@register_jitable
def break_or_slide(
    opening: float, sigma: float, trial: float, state: ContactState, parameters: LawParameters
) -> tuple[ContactState, int]:
    """State of a brittle bond, or of a failed contact point, beyond its strengths; returns as
    `advance`.

    opening: at the end of the step [m]; sigma, trial: elastic normal and shear stress there [Pa].
    """
    kn = parameters.normal_stiffness
    ks = parameters.shear_stiffness
    slip = state.slip
    at_limit = state.at_limit
    event = INTACT
    friction_work = state.friction_work
    fracture_work = state.fracture_work
    if not state.broken:
        strength, _ = strength_left(False, parameters)
        event = TENSION if sigma > strength else SHEAR  # (10), else (11)
    limit = -sigma * friction_left(True, parameters.material)
    beyond = abs(trial) - limit
    tau = trial
    if event == TENSION or (event == SHEAR and opening > 0.0):
        fracture_work += elastic_energy(sigma, trial, kn, ks)
    if opening > 0.0:  # without a bond it is open
        if event == INTACT:  # its remaining elastic shear energy dissipates by friction as it opens
            friction_work += max(0.5 * state.shear_stress * trial / ks, 0.0)
        sigma = tau = 0.0
        at_limit = at_limit or event == SHEAR
    elif event == SHEAR or trial != 0.0:
        if event == SHEAR:
            fracture_work += 0.5 * beyond * beyond / ks
            friction_work += limit * beyond / ks
        else:
            # Trapezoidal rule over the step, which is the work of central differences on the
            # bodies: the limit changes with the normal stress, and joints slide mostly while it
            # decreases.
            before = max(state.shear_stress if trial > 0.0 else -state.shear_stress, 0.0)
            friction_work += 0.5 * (before + limit) * beyond / ks
        sign = 1.0 if trial > 0.0 else -1.0
        slip += sign * beyond / ks
        tau = sign * limit
        at_limit = True
    return (
        ContactState(
            sigma, tau, slip, True, at_limit, friction_work, fracture_work, state.kappa, state.gap
        ),
        event,
    )


@register_jitable
def soften(
    opening: float, trial: float, state: ContactState, parameters: LawParameters
) -> tuple[ContactState, int]:
    """State of a softening bond beyond its strengths, (S1) to (S5); returns as `advance`.

    opening: at the end of the step [m]; trial: elastic shear stress there [Pa].
    """
    kn = parameters.normal_stiffness
    ks = parameters.shear_stiffness
    rate_i, rate_ii = softening_rates(parameters)
    kappa, share, sigma, gap, tau = softened(opening, trial, state, parameters)
    old_share = share_left(state.kappa, parameters.material)
    event = INTACT
    if share <= GONE:
        event = SHEAR if rate_ii * (abs(trial) - tau) / ks > rate_i * (gap - state.gap) else TENSION
        share = 0.0
        sigma, gap, tau = on_the_envelope(share, opening, trial, state.gap, parameters)
    slid = (abs(trial) - tau) / ks
    fracture_work = state.fracture_work
    slip = state.slip
    at_limit = state.at_limit
    if opening > 0.0:  # work of the decrease of the secant stiffness
        strength = old_share * parameters.tensile_strength
        old = tension_stiffness(strength, state.gap, kn)
        new = sigma / opening
        fracture_work += (
            0.5 * min(state.gap + strength / kn, opening) * opening * max(old - new, 0.0)
        )
    sign = 1.0 if trial > 0.0 else -1.0
    # Trapezoidal rule over the step, as in `break_or_slide`.
    lost = 0.5 * (max(sign * state.shear_stress, 0.0) + tau) * slid
    of_the_bond = min(lost, 0.5 * parameters.cohesion * (old_share + share) * slid)
    if opening <= 0.0:
        slip += sign * slid
    if event == SHEAR or (event == TENSION and opening <= 0.0 and slid > 0.0):
        at_limit = True
    return (
        ContactState(
            sigma,
            sign * tau,
            slip,
            event != INTACT,
            at_limit,
            state.friction_work + (lost - of_the_bond),
            fracture_work + of_the_bond,
            kappa,
            gap,
        ),
        event,
    )


@register_jitable
def softening_rates(parameters: LawParameters) -> tuple[float, float]:
    """Increments of kappa by inelastic opening and by inelastic slip, (S3) [1/m]."""
    return (
        AREA * parameters.tensile_strength / parameters.mode_i_energy,
        AREA * parameters.cohesion / parameters.mode_ii_energy,
    )


@register_jitable
def softened(
    opening: float, trial: float, state: ContactState, parameters: LawParameters
) -> tuple[float, float, float, float, float]:
    """kappa after the step [-], the share of the strengths there [-], and with it
    `on_the_envelope`; arguments as of `soften`.

    kappa is the smallest solution of the implicit equation kappa = grown(kappa).  `grown` increases
    with kappa, so that fixed-point iteration from the old kappa converges to it from below; where
    its steps more than halve, Aitken's extrapolation follows two of them.  A solution exists for
    all fracture energies; below f_t^2 / k_n or c^2 / k_s (snap-back) it may jump.
    """
    rate_i, rate_ii = softening_rates(parameters)
    ks = parameters.shear_stiffness
    kappa = state.kappa
    share = share_left(kappa, parameters.material)
    step = 0.0
    for _ in range(200):
        sigma, gap, tau = on_the_envelope(share, opening, trial, state.gap, parameters)
        grown = state.kappa + rate_i * (gap - state.gap) + rate_ii * (abs(trial) - tau) / ks
        before = step
        step = grown - kappa
        if abs(step) <= 1e-13 * (1.0 + kappa):
            break
        kappa = grown
        if 0.0 < step < 0.5 * before:
            kappa += step * step / (before - step)
            step = 0.0
        share = share_left(kappa, parameters.material)
    return kappa, share, sigma, gap, tau


@register_jitable
def on_the_envelope(
    share: float, opening: float, trial: float, gap: float, parameters: LawParameters
) -> tuple[float, float, float]:
    """Normal stress [Pa], gap [m] and |shear stress| [Pa] at a remaining share of the strengths
    [-]: (S1), (S2), (S4).

    opening [m]; trial: elastic shear stress [Pa]; gap: largest inelastic opening before [m].
    """
    kn = parameters.normal_stiffness
    strength = share * parameters.tensile_strength
    gap = max(gap, opening - strength / kn)
    sigma = kn * opening
    if opening > 0.0:
        sigma = tension_stiffness(strength, gap, kn) * opening
    limit = share * parameters.cohesion - sigma * friction_left(False, parameters.material)
    return sigma, gap, min(abs(trial), max(limit, 0.0))


@register_jitable
def elastic_energy(
    normal_stress: float, shear_stress: float, normal_stiffness: float, shear_stiffness: float
) -> float:
    """Elastic energy per area [J/m2]: sigma^2 / 2 k_n + tau^2 / 2 k_s; stresses [Pa], stiffnesses
    [Pa/m].

    >>> elastic_energy(0.0, 1e5, 1e12, 1e12)
    0.005
    """
    return (
        0.5 * normal_stress * normal_stress / normal_stiffness
        + 0.5 * shear_stress * shear_stress / shear_stiffness
    )


@register_jitable
def inelastic_opening(opening: float, normal_stress: float, normal_stiffness: float) -> float:
    """Inelastic part of an opening [m], from the normal stress [Pa] and stiffness [Pa/m]; zero
    where closed.

    >>> inelastic_opening(1e-4, 0.0, 1e12)
    0.0001
    """
    return opening - normal_stress / normal_stiffness if opening > 0.0 else 0.0
