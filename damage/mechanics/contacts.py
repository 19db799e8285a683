"""Forces of single contact points: linear springs within their elastic range, the joint law beyond it.

`STATE` is the state of a contact point after the last evaluation of the law.  From that state on it is a linear spring,
until a trial state leaves the elastic range of the state.
"""

from typing import NamedTuple

import numpy as np

from damage.mechanics.by_name import reader, writer
from damage.mechanics.compiled import compiled, inlined
from damage.mechanics.interfaces import Resultant, no_overlap
from damage.mechanics.tables import (
    ENDING,
    FAILED,
    FRACTURE,
    FRICTION,
    OPENED,
    READ_OPENING,
    READ_SHEAR,
    READ_SIGMA,
    READ_TAU,
    SLIPPED,
)
from damage.wall import joint_law
from damage.wall.joint_law import INTACT, ContactState, ElasticRange, LawParameters

law_state, keep_law_state = reader(ContactState), writer(ContactState)
keep_range = writer(ElasticRange, prefix="elastic_")


class Trial(NamedTuple):
    """Elastic trial state of a contact point: opening plus plastic closure [m], normal and shear force [N]."""

    opening: float
    sigma: float
    tau: float


@inlined
def elastic_trial(contact, state, motion):
    """Trial of a contact point at a RelativeMotion of its interface; contact, state: rows of the tables."""
    opening = motion.opening + contact.offset * motion.rotation + state.closure
    stiffness = state.elastic_tension_stiffness if opening > 0.0 else contact.kn
    return Trial(opening, stiffness * opening, state.shear_stress + contact.ks * (motion.shear - state.shear0))


@inlined
def stays_open(state, opening):
    """Whether a failed contact point with this opening [m] is open and free of forces, so that no law is evaluated."""
    return 0.0 < opening <= state.idle and state.shear_stress == 0.0


@inlined
def present_forces(contact, state, motion):
    """Trial of a contact point after the law was evaluated: its forces are zero where it stays open."""
    trial = elastic_trial(contact, state, motion)
    if stays_open(state, trial.opening):
        return Trial(trial.opening, 0.0, 0.0)
    return trial


@compiled
def present_resultant(contacts, states, start, stop, motion):
    """Resultant [N, N m] of an interface's contact points (rows start to stop) after the law was evaluated."""
    normal = shear = couple = 0.0
    for i in range(start, stop):
        trial = present_forces(contacts[i], states[i], motion)
        normal += trial.sigma
        shear += trial.tau
        couple += trial.sigma * contacts[i].offset
    return Resultant(normal, shear, couple)


@inlined
def elastic_resultant(contacts, states, start, stop, motion):
    """Resultant of an interface's contact points as springs [N, N m], and whether all stay in their elastic range."""
    normal, shear, couple, elastic = 0.0, 0.0, 0.0, True
    for i in range(start, stop):
        contact, state = contacts[i], states[i]
        trial = elastic_trial(contact, state, motion)
        if stays_open(state, trial.opening):
            state.shear0 = motion.shear
            continue
        elastic &= joint_law.stays_elastic(trial.sigma, trial.tau, state.elastic_tensile_strength,
                                           state.elastic_cohesion, state.elastic_friction)
        elastic &= joint_law.withstands(trial.sigma, state.elastic_compressive_strength)
        normal += trial.sigma
        shear += trial.tau
        couple += trial.sigma * contact.offset
    return Resultant(normal, shear, couple), elastic


@inlined
def remember(contacts, states, start, stop, motion):
    """Store the forces of contact points that stayed elastic, for the work of slip and crushing in a later step."""
    for i in range(start, stop):
        contact, state = contacts[i], states[i]
        if contact.compressive_strength < np.inf:
            state.normal_stress = elastic_trial(contact, state, motion).sigma
        if state.idle >= 0.0 or state.kappa > 0.0:
            state.shear_stress += contact.ks * (motion.shear - state.shear0)
            state.shear0 = motion.shear


@inlined
def law_resultant(system, law, start, stop, step, motion, before, damped):
    """Resultant of contact points of an interface by the joint law [N, N m].

    Returns the resultant; if damped, its change since the last step by the contact points that stayed elastic; and
    whether a contact point has failed, softened or been crushed.  start, stop: rows of the contact points; step: number
    of the step in the log; motion, before: RelativeMotion now and in the last step.

    By central differences the force of a bond that fails in a step does half of the step's work on the bodies, while
    the joint law counts its energy at the end of the step: what is too much is taken back here.
    """
    contacts, states = system.contacts, system.states
    normal = shear = couple = d_normal = d_shear = d_couple = 0.0
    failed = False
    for i in range(start, stop):
        contact, state = contacts[i], states[i]
        trial, kappa = elastic_trial(contact, state, motion), state.kappa
        intact = state.broken == 0.0 and kappa == 0.0
        old = present_forces(contact, state, before) if damped or intact else trial
        new, event = ask_law(system.energy, contact, state, trial.opening - state.closure, motion.shear, law.material)
        if new.broken or new.kappa > 0.0 or new.closure > 0.0:
            log(system, law.threshold, i, step, trial, new, event)
            failed = True
        sigma, tau = new.normal_stress, new.shear_stress
        if intact and event != INTACT:
            system.energy[FRACTURE] -= 0.5 * ((trial.sigma - sigma) * (trial.sigma - old.sigma) / contact.kn
                                              + (trial.tau - tau) * (trial.tau - old.tau) / contact.ks)
        if damped and event == INTACT and new.kappa == kappa:
            d_normal += sigma - old.sigma
            d_shear += tau - old.tau
            d_couple += (sigma - old.sigma) * contact.offset
        normal += sigma
        shear += tau
        couple += sigma * contact.offset
    return Resultant(normal, shear, couple), Resultant(d_normal, d_shear, d_couple), failed


@inlined
def ask_law(energy, contact, state, opening, shear, material):
    """Evaluate the joint law of a contact point, and write its new state and works into the tables.

    opening, shear: displacements now [m].  Returns as `joint_law.advance`, with forces [N] and works [J].
    """
    parameters = LawParameters(contact.kn, contact.ks, contact.tensile_strength, contact.cohesion, material,
                               contact.mode_i_energy, contact.mode_ii_energy, contact.compressive_strength,
                               contact.crushing_energy)
    old = law_state(state)
    new, event = joint_law.advance(opening, shear - state.shear0, old, parameters)
    energy[FRICTION] += new.friction_work - old.friction_work
    energy[FRACTURE] += new.fracture_work - old.fracture_work
    keep_law_state(state, new)
    keep_range(state, joint_law.range_left(new, parameters))
    if new.broken or new.kappa > 0.0:
        state.shear0 = shear
    else:  # the shear force of an intact bond is measured from the undeformed wall
        state.shear_stress = old.shear_stress
    return new, event


@inlined
def log(system, threshold, i, step, trial, new, event):
    """Log the failure of contact point i, and the first times that its opening and slip exceed the threshold [m]."""
    contact, state = system.contacts[i], system.states[i]
    passed = int(state.passed)
    opening = joint_law.inelastic_opening(trial.opening, new.normal_stress, contact.kn)
    opens = opening > threshold and not passed & 1
    slips = abs(new.slip) > threshold and not passed & 2
    if event != INTACT or opens or slips:
        passed = passed + opens + 2 * slips
        state.passed = passed
        values = trial.sigma / contact.area, trial.tau / contact.area, opening, new.slip
        for happens, kind in ((event != INTACT, event), (opens, OPENED), (slips, SLIPPED)):
            if happens:
                log_event(system, step, i, kind, values)
    if new.broken:
        state.idle = np.inf if passed & 1 else threshold


@compiled
def log_event(system, step, i, kind, values):
    """Append an event with its stresses [Pa], opening and slip [m].  Events beyond the capacity are counted but not
    stored, so that the caller detects the overflow."""
    n = system.n_events[0]
    system.n_events[0] += 1
    if n < system.events.shape[0]:
        system.events[n, 0], system.events[n, 1], system.events[n, 2] = step, i, kind
        for k, value in enumerate(values):
            system.values[n, k] = value


@inlined
def ends_now(system, p, motion):
    """Whether the faces of a failed interface cease to overlap at this RelativeMotion; it is then marked ENDING."""
    interface = system.interfaces[p]
    ends = interface.failed == FAILED and no_overlap(motion, interface.slide_least, interface.slide_most)
    if ends:
        interface.failed = ENDING
    return ends


@compiled
def let_go(system, start, stop, motion):
    """Set the forces of an interface's contact points to zero, one step after its faces ceased to overlap.

    The readings of that earlier step stay, except for the stresses.  By the trapezoidal rule of central differences, a
    force that vanishes in a step still does half of its work; the remaining elastic energy counts as friction.
    """
    readings = system.readings
    for i in range(start, stop):
        contact, state = system.contacts[i], system.states[i]
        sigma, tau = readings[READ_SIGMA, i] * contact.area, readings[READ_TAU, i] * contact.area
        slid = motion.shear - readings[READ_SHEAR, i]
        system.energy[FRICTION] += 0.5 * sigma * (motion.opening + contact.offset * motion.rotation + state.closure)
        system.energy[FRICTION] += 0.5 * tau * (tau / contact.ks + slid)
        state.normal_stress = state.shear_stress = 0.0
        readings[READ_SIGMA, i] = readings[READ_TAU, i] = 0.0


@inlined
def read(contacts, states, readings, start, stop, motion):
    """Write opening, shear displacement [m] and stresses [Pa] of an interface's contact points into the readings.

    Called after its forces are known: each contact point is then a spring about its new state.
    """
    for i in range(start, stop):
        trial, area = present_forces(contacts[i], states[i], motion), contacts[i].area
        readings[READ_OPENING, i], readings[READ_SHEAR, i] = trial.opening, motion.shear
        readings[READ_SIGMA, i], readings[READ_TAU, i] = trial.sigma / area, trial.tau / area
