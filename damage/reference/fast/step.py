"""Parts of the fast step that a single wall (`alone`) and a batch (`together`) have in common.

A step advances all bodies, evaluates all interfaces by their resultant springs in vectors of eight, and then evaluates
those that are not intact contact point by contact point.
"""

from typing import NamedTuple

import numpy as np

from damage.mechanics import contacts as singly
from damage.mechanics import interfaces
from damage.mechanics.tables import ENDED, ENDING, FAILED, System
from damage.reference.fast import blocks as at
from damage.reference.fast.blocks import INDEX, ONE, WIDTH, place_of
from damage.reference.fast.compiled import compiled, inlined
from damage.reference.fast.interfaces import (
    keep_last,
    last_motion,
    last_resultant,
    line_of,
    pose_of,
    push_one,
    springs_of,
)
from damage.wall.joint_law import Material


class Law(NamedTuple):
    """Joint law of a wall: Material, threshold of events [m], and plain: whether no contact softens or crushes."""

    material: Material
    threshold: float
    plain: bool


@inlined
def wall_of(tables, w):
    """System of wall w, views of the joined tables."""
    return System(tables.place[w], tables.velocity[w], tables.force[w], tables.mass[w], tables.inverse_mass[w],
                  tables.trig[w], tables.interfaces[w], tables.contacts[w], tables.states[w], tables.readings[w],
                  tables.energy[w], tables.events[w], tables.values[w], tables.n_events[w], tables.relaxation[w],
                  tables.last[w], tables.turning[w], tables.radiation[w])


@compiled
def any_above_zero(controls, column):
    """Whether a column of the controls, (walls, 5), is above zero for any wall."""
    found = False
    for w in range(controls.shape[0]):
        found |= controls[w, column] > 0.0
    return found


@inlined
def forces_by_contacts(tables, blocks, lanes, law, step, w, p, at_end, damped):
    """`damage.mechanics.step.forces_by_contacts` of interface p of wall w; at_end: as `singly` there."""
    bodies, apart = (blocks.rows, ONE) if lanes == 1 else (blocks.bodies, WIDTH)
    slot, system = INDEX(p * lanes + w), wall_of(tables, w)
    last, limits, m, held = blocks.last, blocks.limits, place_of(slot, at.LAST), place_of(slot, at.LIMITS)
    start, stop = tables.interfaces[0, p].start, tables.interfaces[0, p].stop  # equal in all walls: stays in the cache
    a, b, k = blocks.first[p] + INDEX(w), blocks.second[p] + INDEX(w), place_of(INDEX(p), at.INTERFACE)
    frame, motion = interfaces.relative_motion(line_of(blocks.interfaces, k), pose_of(bodies, a, apart),
                                               pose_of(bodies, b, apart))
    if tables.interfaces[w, p].failed >= ENDING:
        if tables.interfaces[w, p].failed == ENDING:
            singly.let_go(system, start, stop, motion)
            tables.interfaces[w, p].failed = ENDED
        return
    intact = False
    if at_end:
        intact = interfaces.stays_intact(springs_of(blocks.interfaces, k), limits[held + at.OPENING],
                                         limits[held + at.SLIDE], motion)
    resultant, elastic = singly.elastic_resultant(system.contacts, system.states, start, stop, motion)
    changed = interfaces.change(resultant, last_resultant(last, m))
    if elastic or intact:
        singly.remember(system.contacts, system.states, start, stop, motion)
    else:
        before = motion_before(tables, blocks, lanes, w, p, damped)
        resultant, changed, failed = singly.law_resultant(system, law, start, stop, step, motion, before, damped)
        if failed:
            tables.interfaces[w, p].failed = FAILED
            limits[held + at.OPENING] = -np.inf
    ends = singly.ends_now(system, p, motion)
    if at_end or ends:
        singly.read(system.contacts, system.states, system.readings, start, stop, motion)
    if damped:
        viscous, work = interfaces.add_viscous(blocks.bench[at.RATE + INDEX(w)], motion, last_motion(last, m),
                                               resultant, changed)
        keep_last(last, m, motion, resultant)
        blocks.sums[at.DAMPED + INDEX(p % 8 * lanes + w)] += work
        resultant = viscous
    push_one(bodies, a, b, apart, interfaces.forces_on_bodies(frame, resultant))


@compiled
def motion_before(tables, blocks, lanes, w, p, damped):
    """RelativeMotion of interface p of wall w in the last step: the stored one where the wall damps, otherwise
    `damage.mechanics.step.motion_before`; damped: whether any wall of the batch damps."""
    if damped and blocks.bench[at.RATE + INDEX(w)] > 0.0:
        return last_motion(blocks.last, place_of(INDEX(p * lanes + w), at.LAST))
    interface, dt, here = tables.interfaces[0, p], blocks.bench[at.STEP + INDEX(w)], INDEX(w)
    a, b = INDEX(interface.a) * INDEX(lanes) + here, INDEX(interface.b) * INDEX(lanes) + here
    first = pose_before(blocks.bodies, place_of(a, at.BODY), dt)
    second = pose_before(blocks.bodies, place_of(b, at.BODY), dt)
    return interfaces.relative_motion(line_of(blocks.interfaces, place_of(INDEX(p), at.INTERFACE)), first, second)[1]


@inlined
def pose_before(bodies, k, dt):
    """Pose of the body at index k in the last step; dt: time step [s]."""
    return interfaces.pose_before(bodies[k + at.X], bodies[k + at.Z], bodies[k + at.ROTATION], bodies[k + at.VX],
                                  bodies[k + at.VZ], bodies[k + at.VROTATION], dt)


@compiled
def remember_last(tables, blocks, lanes, which):
    """`damage.mechanics.step.remember_last` of the walls `which` (bits)."""
    bodies, apart = (blocks.rows, ONE) if lanes == 1 else (blocks.bodies, WIDTH)
    for w in range(tables.interfaces.shape[0]):
        if not which >> w & 1:
            continue
        for p in range(tables.interfaces.shape[1]):
            interface, here = tables.interfaces[w, p], INDEX(w)
            _, motion = interfaces.relative_motion(line_of(blocks.interfaces, place_of(INDEX(p), at.INTERFACE)),
                                                   pose_of(bodies, blocks.first[p] + here, apart),
                                                   pose_of(bodies, blocks.second[p] + here, apart))
            keep_last(blocks.last, place_of(INDEX(p * lanes + w), at.LAST), motion, singly.present_resultant(
                tables.contacts[w], tables.states[w], interface.start, interface.stop, motion))
