"""Contacts one by one: springs from where the joint law has left them, and what of them is shown to it.

The joint law is homogeneous in the area: given stiffnesses and strengths times area, it returns forces and energies.
Between two of its decisions a contact is a linear spring, which changes no state; so only pairs with a spring
beyond what is left of its strength are shown to the law.  While open, a bond that softens is a spring by its secant.
"""

from typing import NamedTuple

import numpy as np

from damage.reference.compiled import compiled, inlined
from damage.reference.pairs import Forces
from damage.reference.tables import (
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
from damage.wall.joint_law import INTACT, ContactState, LawParameters


class Trial(NamedTuple):
    """A contact while it stays elastic: opening from where its closure has left its faces [m], normal and shear force
    [N]."""

    opening: float
    sigma: float
    tau: float


@inlined
def spring(contact, gap):
    """A contact as a spring from where the law has left it (Trial) [m, N, N]."""
    opening = gap.middle + contact.offset * gap.turn + contact.closure
    stiffness = contact.kt if opening > 0.0 else contact.kn
    return Trial(opening, stiffness * opening, contact.tau0 + contact.ks * (gap.shear - contact.shear0))


@inlined
def stresses(contact, gap):
    """A contact as what the law has left of it, a spring or nothing (Trial) [m, N, N]."""
    trial = spring(contact, gap)
    if stays_open(contact, trial.opening):
        return Trial(trial.opening, 0.0, 0.0)
    return trial


@inlined
def stays_open(contact, opening):
    """Whether a broken contact with this opening [m] is open, has no force, and needs no law."""
    return 0.0 < opening <= contact.idle and contact.tau0 == 0.0


@compiled
def sum_of_stresses(contacts, lane, start, stop, gap):
    """Forces of the contacts of a pair as what the law has left of them [N, N m]."""
    normal = along = couple = 0.0
    for i in range(start, stop):
        contact = contacts[lane, i]
        trial = stresses(contact, gap)
        normal += trial.sigma
        along += trial.tau
        couple += trial.sigma * contact.offset
    return Forces(normal, along, couple)


@inlined
def springs(contacts, lane, start, stop, gap, material):
    """Forces of a pair's contacts as springs one by one [N, N m], and whether none is beyond its strength."""
    normal, along, couple, elastic = 0.0, 0.0, 0.0, True
    for i in range(start, stop):
        contact = contacts[lane, i]
        trial = spring(contact, gap)
        if stays_open(contact, trial.opening):
            contact.shear0 = gap.shear
            continue
        elastic &= joint_law.stays_elastic(trial.sigma, trial.tau, contact.tensile_force, contact.cohesive_force,
                                           joint_law.friction_left(contact.idle >= 0.0, material))
        elastic &= joint_law.withstands(trial.sigma, contact.crushing_force)
        normal += trial.sigma
        along += trial.tau
        couple += trial.sigma * contact.offset
    return Forces(normal, along, couple), elastic


@inlined
def remember(contacts, lane, start, stop, gap):
    """Keep the shear force [N] of contacts that have slid and stick: sliding works against the last one; and the
    normal force of those that can crush, for the same reason."""
    shear = gap.shear
    for i in range(start, stop):
        contact = contacts[lane, i]
        if contact.crushing_force < np.inf:
            contact.sigma0 = spring(contact, gap).sigma
        if contact.idle >= 0.0 or contact.soft:
            contact.tau0, contact.shear0 = contact.tau0 + contact.ks * (shear - contact.shear0), shear


@compiled
def read_joints(contacts, joints, readings, lane, start, stop, gap):
    """Write opening, shear displacement [m] and stresses [Pa] of a pair's contacts.  After its forces are found every
    contact is a spring from where the law has left it, so that no law is needed."""
    for i in range(start, stop):
        trial, area = stresses(contacts[lane, i], gap), joints[0, i].area  # of all lanes
        readings[lane, READ_OPENING, i], readings[lane, READ_SHEAR, i] = trial.opening, gap.shear
        readings[lane, READ_SIGMA, i], readings[lane, READ_TAU, i] = trial.sigma / area, trial.tau / area


@inlined
def joint_forces(tables, law, lane, p, step, gap, before, damped):
    """Forces of a pair's contacts by the joint law [N, N m]; if damped, how those of the contacts that neither broke
    nor softened in this step have changed since the last one; and whether a bond is not whole any more.

    gap, before: how far its bodies have moved apart, now and in the last step (Gap)."""
    pair, contacts, joints = tables.pairs[lane, p], tables.contacts, tables.joints
    normal = along = couple = d_normal = d_along = d_couple = 0.0
    failed = False
    for i in range(pair.start, pair.stop):
        contact, joint = contacts[lane, i], joints[lane, i]
        trial, kappa = spring(contact, gap), joint.kappa
        old = stresses(contact, before) if damped else trial
        new, event = judge(contact, joint, trial.opening - contact.closure, gap.shear, law.material)
        if new.broken or new.kappa > 0.0 or new.closure > 0.0:
            log_joint(tables, law.threshold, lane, i, step, trial, new, event)
            failed = True
        sigma, tau = new.normal_stress, new.shear_stress
        if damped and event == INTACT and new.kappa == kappa:
            d_normal += sigma - old.sigma
            d_along += tau - old.tau
            d_couple += (sigma - old.sigma) * contact.offset
        normal += sigma
        along += tau
        couple += sigma * contact.offset
    return Forces(normal, along, couple), Forces(d_normal, d_along, d_couple), failed


@inlined
def judge(contact, joint, opening, shear, material):
    """Show a contact at this opening and shear displacement [m] to the joint law, and keep what it leaves of it.

    Returns what `joint_law.advance` does, in forces [N] and works [J]."""
    law = LawParameters(contact.kn, contact.ks, joint.tensile_force, joint.cohesive_force, material, joint.mode_i,
                        joint.mode_ii, contact.crushing_force)
    old = ContactState(contact.sigma0, contact.tau0, joint.slip, joint.broken, joint.at_limit, 0.0, 0.0, joint.kappa,
                       joint.gap, contact.closure)
    new, event = joint_law.advance(opening, shear - contact.shear0, old, law)
    contact.closure = new.closure
    if contact.crushing_force < np.inf:
        contact.sigma0 = new.normal_stress
    if new.broken or new.kappa > 0.0:
        contact.tensile_force, contact.cohesive_force = joint_law.strength_left(new.broken, law, new.kappa)
        contact.shear0, contact.tau0 = shear, new.shear_stress
        contact.soft, contact.kt = not new.broken, contact.kn
        if not new.broken:
            contact.kt = joint_law.tension_stiffness(contact.tensile_force, new.gap, contact.kn)
    return new, event


@inlined
def log_joint(tables, threshold, lane, i, step, trial, new, event):
    """Keep the flags and the slip [m] of a contact without a whole bond; log its work [J], its break and first
    passings of the threshold [m]."""
    contact, joint, energy = tables.contacts[lane, i], tables.joints[lane, i], tables.energy
    joint.slip, joint.broken, joint.at_limit = new.slip, new.broken, new.at_limit
    joint.kappa, joint.gap = new.kappa, new.gap
    energy[lane, FRICTION] += new.friction_work
    energy[lane, FRACTURE] += new.fracture_work
    passed = int(joint.passed)
    opening = joint_law.inelastic_opening(trial.opening, new.normal_stress, contact.kn)
    opens = opening > threshold and not passed & 1
    slips = abs(new.slip) > threshold and not passed & 2
    if event != INTACT or opens or slips:
        joint.passed = passed + opens + 2 * slips
        values = trial.sigma / joint.area, trial.tau / joint.area, opening, new.slip
        for happens, kind in ((event != INTACT, event), (opens, OPENED), (slips, SLIPPED)):
            if happens:
                log_event(tables, lane, step, i, kind, values)
    if new.broken:
        contact.idle = np.inf if int(joint.passed) & 1 else threshold


@compiled
def log_event(tables, lane, step, joint, kind, values):
    """Append an event with its stresses [Pa], opening and slip [m]; those that do not fit are counted all the same,
    so that the caller sees it."""
    n = tables.n_events[lane, 0]
    tables.n_events[lane, 0] += 1
    if n < tables.events.shape[1]:
        tables.events[lane, n, 0], tables.events[lane, n, 1], tables.events[lane, n, 2] = step, joint, kind
        for k, value in enumerate(values):
            tables.values[lane, n, k] = value
