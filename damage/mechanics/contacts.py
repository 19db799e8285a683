"""Forces of single contact points: linear springs within their elastic range, the joint law beyond
it.

`CONTACT_FIELDS` is the state of a contact point after the last evaluation of the law.  From that
state on it is a linear spring, until a trial state leaves the elastic range of the state.  `n`:
width of the step (`damage.mechanics.simd`), in functions that evaluate the law of a single wall.
"""

from typing import NamedTuple

import numpy as np

from damage.law import joint_law
from damage.law.joint_law import INTACT, LawParameters
from damage.mechanics import rows
from damage.mechanics.compiled import compiled, entry, inlined
from damage.mechanics.interfaces import Resultant
from damage.mechanics.simd import (
    add,
    bits,
    either,
    lanes,
    load,
    store,
    store_where,
    wall_of,
    zero,
)
from damage.mechanics.tables import (
    CONTACT_FIELDS,
    FRACTURE,
    FRICTION,
    LARGEST_SLIDE,
    OPENED,
    SLIPPED,
    STRENGTHS,
    Reading,
)

NORMAL_STRESS, SHEAR_STRESS, BROKEN, AT_LIMIT, SLIP, KAPPA, CLOSURE, SHEAR0, IDLE, PASSED = map(
    CONTACT_FIELDS.index,
    (
        "normal_stress",
        "shear_stress",
        "broken",
        "at_limit",
        "slip",
        "kappa",
        "closure",
        "shear0",
        "idle",
        "passed",
    ),
)
TENSION_STIFFNESS, LEFT, COHESION_LEFT = (
    CONTACT_FIELDS.index(f"elastic_{name}")
    for name in ("tension_stiffness", "tensile_strength", "cohesion")
)
COHESION = STRENGTHS.index("cohesion")


class Trial(NamedTuple):
    """Elastic trial state of a contact point: opening plus plastic closure [m], normal and shear
    force [N]."""

    opening: float
    sigma: float
    tau: float


class Points(NamedTuple):
    """Contact points of interface p that share a RelativeMotion: rows start to stop of the tables;
    row: theirs of `last`."""

    p: int
    start: int
    stop: int
    row: int


@inlined
def elastic_trial(n, tables, i, motion):
    """Trial of contact point i at a RelativeMotion of its interface."""
    offset = tables.contacts[i].offset
    states = tables.states
    kn, ks = rows.stiffness_of(n, tables, i)
    opening = motion.opening + offset * motion.rotation + load(n, states, i, CLOSURE)
    stiffness = either(opening > 0.0, load(n, states, i, TENSION_STIFFNESS), kn)
    return Trial(
        opening,
        stiffness * opening,
        load(n, states, i, SHEAR_STRESS) + ks * (motion.shear - load(n, states, i, SHEAR0)),
    )


@inlined
def stays_open(n, states, i, opening):
    """Whether failed contact point i with this opening [m] is open and free of forces, so that no
    law is evaluated."""
    return (
        (0.0 < opening)
        & (opening <= load(n, states, i, IDLE))
        & (load(n, states, i, SHEAR_STRESS) == 0.0)
    )


@inlined
def present_forces(n, tables, i, motion):
    """Trial of contact point i after the law was evaluated: its forces are zero where it stays
    open."""
    trial = elastic_trial(n, tables, i, motion)
    is_open = stays_open(n, tables.states, i, trial.opening)
    return Trial(trial.opening, either(is_open, 0.0, trial.sigma), either(is_open, 0.0, trial.tau))


@inlined
def present_resultant(n, tables, points, motion):
    """Resultant of Points after the law was evaluated [N, N m]."""
    normal = zero(n)
    shear = zero(n)
    couple = zero(n)
    for i in range(points.start, points.stop):
        trial = present_forces(n, tables, i, motion)
        normal = normal + trial.sigma
        shear = shear + trial.tau
        couple = couple + trial.sigma * tables.contacts[i].offset
    return Resultant(normal, shear, couple)


@inlined
def elastic_resultant(n, tables, points, motion, which):
    """Resultant of Points as springs [N, N m], and those of the walls `which` (flags) in which all
    stay in their elastic range."""
    states = tables.states
    normal = zero(n)
    shear = zero(n)
    couple = zero(n)
    elastic = which
    for i in range(points.start, points.stop):
        trial = elastic_trial(n, tables, i, motion)
        left = rows.range_now(n, states, i)
        is_open = stays_open(n, states, i, trial.opening) & which
        if bits(is_open):
            store_where(n, states, i, SHEAR0, is_open, motion.shear)
        within = joint_law.stays_elastic(
            trial.sigma, trial.tau, left.tensile_strength, left.cohesion, left.friction
        )
        within = within & joint_law.withstands(trial.sigma, left.compressive_strength)
        elastic = elastic & (within | is_open)
        normal = normal + either(is_open, 0.0, trial.sigma)
        shear = shear + either(is_open, 0.0, trial.tau)
        couple = couple + either(is_open, 0.0, trial.sigma * tables.contacts[i].offset)
    return Resultant(normal, shear, couple), elastic


@inlined
def intact_resultant(n, tables, i, motion, which):
    """`elastic_resultant` of contact point i that is an intact spring in all walls."""
    offset = tables.contacts[i].offset
    (kn, ks) = rows.stiffness_of(n, tables, i)
    # Adding zero, as the law adds closure and earlier force, turns -0 into +0: the bits stay equal.
    sigma = kn * (motion.opening + offset * motion.rotation + 0.0)
    tau = ks * motion.shear + 0.0
    left = rows.range_now(n, tables.states, i)
    elastic = joint_law.stays_elastic(
        sigma, tau, left.tensile_strength, left.cohesion, left.friction
    )
    return Resultant(sigma, tau, sigma * offset), elastic & which


@inlined
def is_intact_spring(n, states, i):
    """Whether the forces of contact point i follow from its displacements and stiffnesses alone."""
    left = rows.range_now(n, states, i)
    unloaded = (load(n, states, i, SHEAR_STRESS) == 0.0) & (load(n, states, i, SHEAR0) == 0.0)
    return (
        unloaded
        & (load(n, states, i, IDLE) < 0.0)
        & (load(n, states, i, KAPPA) == 0.0)
        & (left.compressive_strength == np.inf)
    )


@inlined
def remember(n, tables, points, motion, which):
    """Store the forces of Points that stayed elastic in the walls `which` (flags), for the work of
    slip and crushing in a later step."""
    states = tables.states
    for i in range(points.start, points.stop):
        crushes = which & (rows.range_now(n, states, i).compressive_strength < np.inf)
        if bits(crushes):
            store_where(
                n, states, i, NORMAL_STRESS, crushes, elastic_trial(n, tables, i, motion).sigma
            )
        moves = which & ((load(n, states, i, IDLE) >= 0.0) | (load(n, states, i, KAPPA) > 0.0))
        if bits(moves):
            more = rows.stiffness_of(n, tables, i)[1] * (motion.shear - load(n, states, i, SHEAR0))
            store_where(n, states, i, SHEAR_STRESS, moves, load(n, states, i, SHEAR_STRESS) + more)
            store_where(n, states, i, SHEAR0, moves, motion.shear)


@inlined
def law_resultant(n, tables, threshold, points, step, motion, before, damped):
    """Resultant of Points by the joint law [N, N m].

    Returns the resultant; if damped, its change since the last step by the contact points that
    stayed elastic; and whether a contact point has failed, softened or been crushed.  threshold: of
    Model; step: number of the step in the log; motion, before: RelativeMotion now and in the last
    step.
    """
    normal = shear = couple = d_normal = d_shear = d_couple = 0.0
    failed = False
    for i in range(points.start, points.stop):
        offset = tables.contacts[i].offset
        trial = elastic_trial(n, tables, i, motion)
        kappa = load(n, tables.states, i, KAPPA)
        intact = load(n, tables.states, i, BROKEN) == 0.0 and kappa == 0.0
        last = trial
        if damped or intact:
            last = present_forces(n, tables, i, before)
        new, event = ask_law(n, tables, i, trial, motion.shear)
        if intact:
            correct_fracture(n, tables, i, last, trial, new, event)
        if new.broken or new.kappa > 0.0 or new.closure > 0.0:
            log(n, tables, threshold, i, step, trial, new, event)
            failed = True
        if damped and event == INTACT and new.kappa == kappa:
            d_normal += new.normal_stress - last.sigma
            d_shear += new.shear_stress - last.tau
            d_couple += (new.normal_stress - last.sigma) * offset
        normal += new.normal_stress
        shear += new.shear_stress
        couple += new.normal_stress * offset
    return Resultant(normal, shear, couple), Resultant(d_normal, d_shear, d_couple), failed


@inlined
def ask_law(n, tables, i, trial, shear):
    """Evaluate the joint law of contact point i, and write its new state and works into the tables.

    trial: Trial; shear: shear displacement now [m].  Returns as `joint_law.advance`, with forces
    [N] and works [J].
    """
    states = tables.states
    energy = tables.energy
    parameters = parameters_of(n, tables, i)
    old = rows.law_state(n, states, i)
    opening = trial.opening - load(n, states, i, CLOSURE)
    new, event = joint_law.advance(opening, shear - load(n, states, i, SHEAR0), old, parameters)
    add(n, energy, 0, FRICTION, new.friction_work - old.friction_work)
    add(n, energy, 0, FRACTURE, new.fracture_work - old.fracture_work)
    rows.keep_law_state(n, states, i, True, new)
    rows.keep_range(n, states, i, True, joint_law.range_left(new, parameters))
    if new.broken or new.kappa > 0.0:
        store(n, states, i, SHEAR0, shear)
    else:  # the shear force of an intact bond is measured from the undeformed wall
        store(n, states, i, SHEAR_STRESS, old.shear_stress)
    return new, event


@inlined
def parameters_of(n, tables, i):
    """LawParameters of contact point i, times its area."""
    strengths = rows.strengths_of(n, tables.strengths, i)
    return LawParameters(
        *rows.stiffness_of(n, tables, i),
        strengths.tensile_strength,
        strengths.cohesion,
        rows.material_of(n, tables.material, 0),
        strengths.mode_i_energy,
        strengths.mode_ii_energy,
        strengths.compressive_strength,
        strengths.crushing_energy,
    )


@entry
def confine(n, tables, cuts, which):
    """Give the Cuts through bricks in the walls `which` (bits) what they bear in shear under the
    vertical stresses that were read last."""
    for k in range(len(cuts.interface)):
        for w in range(lanes(n)):
            if which >> w & 1:
                confine_one(wall_of(n, w), tables, cuts, k)


@inlined
def confine_one(n, tables, cuts, k):
    """`confine` of cut k of one wall."""
    p = cuts.interface[k]
    sigma = 0.0
    for m in range(cuts.start[k], cuts.start[k + 1]):
        sigma += 0.25 * rows.reading_of(n, tables.readings, cuts.contact[m]).sigma
    strength = joint_law.diagonal_tension(cuts.strength[n.lane], sigma)
    for i in range(tables.interfaces[p].start, tables.interfaces[p].stop):
        states = tables.states
        cohesion = strength * tables.contacts[i].area
        store(n, tables.strengths, i, COHESION, cohesion)
        if load(n, states, i, BROKEN) == 0.0:
            parameters = parameters_of(n, tables, i)
            kappa = load(n, states, i, KAPPA)
            store(n, states, i, COHESION_LEFT, joint_law.strength_left(False, parameters, kappa)[1])
        slide = cohesion / rows.stiffness_of(n, tables, i)[1]
        store(n, tables.limits, p, LARGEST_SLIDE, slide)


@inlined
def correct_fracture(n, tables, i, last, trial, new, event):
    """Take back what the joint law counts too much where the bond of contact point i ceases to be
    intact.

    By central differences the force of a bond that fails in a step does half of the step's work on
    the bodies, while the law counts its energy at the end of the step; and the law of a softening
    bond counts from no shear stress at all.  last, trial: Trial of the last step and now; new,
    event: as of `joint_law.advance`.
    """
    (kn, ks) = rows.stiffness_of(n, tables, i)
    sigma = new.normal_stress
    tau = new.shear_stress
    if event != INTACT:
        work = (trial.sigma - sigma) * (trial.sigma - last.sigma) / kn + (trial.tau - tau) * (
            trial.tau - last.tau
        ) / ks
        add(n, tables.energy, 0, FRACTURE, -0.5 * work)
    elif new.kappa > 0.0:
        slid = (abs(trial.tau) - abs(tau)) / ks
        before = max(last.tau if trial.tau > 0.0 else -last.tau, 0.0)
        add(n, tables.energy, 0, FRACTURE, 0.5 * before * slid)


@inlined
def log(n, tables, threshold, i, step, trial, new, event):
    """Log the failure of contact point i, and the first times that its opening and slip exceed the
    threshold [m]."""
    area = tables.contacts[i].area
    passed = int(load(n, tables.states, i, PASSED))
    kn = rows.stiffness_of(n, tables, i)[0]
    opening = joint_law.inelastic_opening(trial.opening, new.normal_stress, kn)
    opens = opening > threshold and not passed & 1
    slips = abs(new.slip) > threshold and not passed & 2
    if event != INTACT or opens or slips:
        passed = passed + opens + 2 * slips
        store(n, tables.states, i, PASSED, float(passed))
        values = trial.sigma / area, trial.tau / area, opening, new.slip
        for happens, kind in ((event != INTACT, event), (opens, OPENED), (slips, SLIPPED)):
            if happens:
                log_event(tables, n.lane, step, i, kind, values)
    if new.broken:
        store(n, tables.states, i, IDLE, np.inf if passed & 1 else threshold)


@compiled
def log_event(tables, w, step, i, kind, values):
    """Append an event of wall w with its stresses [Pa], opening and slip [m].  Events beyond the
    capacity are counted but not stored, so that the caller detects the overflow."""
    row = tables.n_events[w, 0]
    tables.n_events[w, 0] += 1
    if row < tables.events.shape[1]:
        tables.events[w, row, 0] = step
        tables.events[w, row, 1] = i
        tables.events[w, row, 2] = kind
        for k, value in enumerate(values):
            tables.values[w, row, k] = value


@inlined
def let_go(n, tables, i, motion):
    """Set the forces of contact point i to zero, one step after the faces of its interface ceased
    to overlap.

    The readings of that earlier step stay, except for the stresses.  By the trapezoidal rule of
    central differences, a force that vanishes in a step still does half of its work; the remaining
    elastic energy counts as friction.
    """
    states = tables.states
    energy = tables.energy
    contact = tables.contacts[i]
    last = rows.reading_of(n, tables.readings, i)
    sigma = last.sigma * contact.area
    tau = last.tau * contact.area
    slid = motion.shear - last.shear
    add(
        n,
        energy,
        0,
        FRICTION,
        0.5
        * sigma
        * (motion.opening + contact.offset * motion.rotation + load(n, states, i, CLOSURE)),
    )
    ks = rows.stiffness_of(n, tables, i)[1]
    add(n, energy, 0, FRICTION, 0.5 * tau * (tau / ks + slid))
    store(n, states, i, NORMAL_STRESS, 0.0)
    store(n, states, i, SHEAR_STRESS, 0.0)
    rows.keep_reading(n, tables.readings, i, True, Reading(last.opening, last.shear, 0.0, 0.0))


@inlined
def read(n, tables, i, motion, which):
    """Write opening, shear displacement [m] and stresses [Pa] of contact point i into the readings
    of the walls `which` (flags).

    Called after its forces are known: it is then a spring about its new state.
    """
    trial = present_forces(n, tables, i, motion)
    area = tables.contacts[i].area
    rows.keep_reading(
        n,
        tables.readings,
        i,
        which,
        Reading(trial.opening, motion.shear, trial.sigma / area, trial.tau / area),
    )
