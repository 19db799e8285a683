"""The time step, plain: move the bodies, evaluate every interface and every loose contact, sum the forces.

This is the definition of the model.  It runs every wall, compiled by numba or as plain Python (NUMBA_DISABLE_JIT=1).
The fast step of the reference solver does the same for eight walls, or eight interfaces, at once, to the same bits:
sums here are therefore taken in the order that suits both.

Central differences: velocities belong to half steps, places and forces to whole ones.
"""

import numpy as np

from damage.mechanics import bodies, contacts, interfaces
from damage.mechanics.compiled import compiled, inlined
from damage.mechanics.loose import STORED, can_end, ends_now, find_loose_forces, has_ended
from damage.mechanics.rows import change_since_last, keep_last, last_motion, line_of, pose, springs_of
from damage.mechanics.samples import observe
from damage.mechanics.tables import DAMPING, FAILED, INPUT, RIGID, ROTATION, X, Z

PARTS = 8
"""Sums over bodies and interfaces are taken in so many parts, of rows 0, 8, 16 and so on, of 1, 9, 17 and so on."""

SWEPT_X, SWEPT_Z, DRIVEN, TAKEN, KINETIC = range(5)
"""Rows of `sums`."""


@compiled
def run(system, law, controls, field, clock, ends, scratch, stiffness, samples, w, loose):
    """Advance from places whose forces are known to each of these ends, where forces and readings are known again and a
    sample is written.

    field: (steps + 1, 3) acceleration of the base along x and z and gravity, of each step and the one after them
    [m/s2]; clock: steps that came before; ends: steps from here to each; scratch: Scratch of this system; stiffness,
    samples, w: as of `damage.mechanics.samples.observe`; loose: Loose contacts.
    """
    step = 0
    for k in range(len(ends)):
        if controls.beta > 0.0:
            remember_last(system)
        while step < ends[k]:
            move(system, controls, field[step], scratch.sums)
            if controls.adaptive > 0.0:
                adapt(system, controls, scratch.sums[KINETIC])
            step += 1
            find_forces(system, law, controls, clock + step, step == ends[k], scratch, loose, controls.time_step)
        observe(system, stiffness, field[step], controls.time_step, samples, w, k)
        samples.loose[w, k] = loose.energy[STORED]


@inlined
def move(system, controls, field, sums):
    """Central differences of every coordinate of every body; input and damping work [J]."""
    dt, alpha = controls.time_step, controls.alpha + system.relaxation[0]
    sums[:] = 0.0
    for b in range(len(system.place)):
        part, driven, lost = b % PARTS, 0.0, 0.0
        for k in range(RIGID):
            backwards = field[0] if k == X else field[1] + field[2] if k == Z else 0.0
            swept, power, taken = move_coordinate(system, dt, alpha, controls.local, backwards, b, k)
            if k < ROTATION:
                sums[k, part] += swept
            driven += power
            lost += taken
        for k in range(RIGID, system.place.shape[1]):
            _, power, taken = move_coordinate(system, dt, alpha, controls.local, 0.0, b, k)
            driven += power
            lost += taken
        sums[DRIVEN, part] += driven
        sums[TAKEN, part] += lost
        angle = system.place[b, ROTATION]
        if abs(angle) < bodies.SMALL:
            system.trig[b, 0], system.trig[b, 1] = bodies.small_rotation(angle)
        else:
            system.trig[b, 0], system.trig[b, 1] = np.cos(angle) - 1.0, np.sin(angle)
    swept = field[0] * total(sums[SWEPT_X]) + field[1] * total(sums[SWEPT_Z])
    system.energy[INPUT] += (total(sums[DRIVEN]) - 0.5 * swept) * dt
    system.energy[DAMPING] += total(sums[TAKEN]) * dt


@inlined
def move_coordinate(system, dt, alpha, local, backwards, b, k):
    """Velocity and place of coordinate k of body b a step on; its momentum, on which the field does work, and the power
    of what drives it and of its damping."""
    old, free, taken = system.velocity[b, k], system.inverse_mass[b, k], 0.0
    rate = bodies.acceleration(system.force[b, k], free, backwards)
    if alpha > 0.0 or local > 0.0:
        resistance = bodies.damping(old, rate, free, alpha, local)
        rate -= resistance
        taken = system.mass[b, k] * resistance * (old + 0.5 * dt * rate)
    new = old + dt * rate
    driven = bodies.power_of_drive(system.force[b, k], free, new)
    system.velocity[b, k] = new
    system.place[b, k] += dt * new
    system.force[b, k] = 0.0
    return bodies.work_of_field(system.mass[b, k], free, old, new), driven, taken


@compiled
def total(parts):
    """Sum of the parts of a sum."""
    value = 0.0
    for part in parts:
        value += part
    return value


@inlined
def adapt(system, controls, parts):
    """Adaptive damping of the next step, by the kinetic energy of this one."""
    for b in range(len(system.velocity)):
        parts[b % PARTS] += bodies.kinetic_energy(system.mass[b], system.velocity[b])
    kinetic = total(parts)
    system.relaxation[0] = bodies.adaptive_damping(kinetic, system.relaxation[1], controls.adaptive, controls.time_step)
    system.relaxation[1] = kinetic


@inlined
def find_forces(system, law, controls, step, singly, scratch, loose, since):
    """Forces of all interfaces on the bodies, where they are zero: first those that stay intact, each as one spring,
    then the others contact by contact; and of the loose contacts.

    singly: none as one spring, so that forces are the sums of the contacts' stresses to the last bit; these are read
    then, too.  Samples are taken so.  since: time since the last forces [s], zero where nothing has moved.
    """
    others, damped = 0, scratch.sums[TAKEN]
    damped[:] = 0.0
    for p in range(len(system.interfaces)):
        interface = system.interfaces[p]
        frame, motion = interfaces.relative_motion(line_of(interface), pose(system, interface.a),
                                                   pose(system, interface.b))
        if singly or not stays_intact(interface, motion) or can_end(loose, motion):
            scratch.others[others] = p
            others += 1
            continue
        resultant = interfaces.elastic_resultant(springs_of(interface), motion)
        if controls.beta > 0.0:
            resultant = damp(system, controls, p, motion, resultant, change_since_last(system, p, resultant), damped)
        push(system, interface, interfaces.forces_on_bodies(frame, resultant))
    for k in range(others):
        forces_by_contacts(system, law, controls, scratch.others[k], step, singly, damped, loose)
    find_loose_forces(system, loose, since)
    system.energy[DAMPING] += total(damped)


@inlined
def forces_by_contacts(system, law, controls, p, step, singly, damped, loose):
    """Forces of one interface contact by contact: as springs while all stay in their elastic range, else by the joint
    law; from the step after its faces ceased to overlap none, for good."""
    interface = system.interfaces[p]
    start, stop = interface.start, interface.stop
    frame, motion = interfaces.relative_motion(line_of(interface), pose(system, interface.a), pose(system, interface.b))
    if has_ended(system, loose, p, motion):
        return
    resultant, elastic = contacts.elastic_resultant(system.contacts, system.states, start, stop, motion)
    changed = change_since_last(system, p, resultant)
    if elastic or stays_intact(interface, motion):
        contacts.remember(system.contacts, system.states, start, stop, motion)
    else:
        resultant, changed, failed = contacts.law_resultant(system, law, p, step, motion, last_motion(system, p),
                                                            controls.beta > 0.0)
        if failed:
            interface.failed = FAILED
    if ends_now(system, loose, p, step, motion) or singly:
        contacts.read(system.contacts, system.states, system.readings, start, stop, motion)
    if controls.beta > 0.0:
        resultant = damp(system, controls, p, motion, resultant, changed, damped)
    push(system, interface, interfaces.forces_on_bodies(frame, resultant))


@inlined
def damp(system, controls, p, motion, resultant, changed, damped):
    """Resultant of an interface with stiffness-proportional damping; keeps what the next step compares with."""
    before = last_motion(system, p)
    keep_last(system, p, motion, resultant)
    viscous, work = interfaces.add_viscous(controls.beta / controls.time_step, motion, before, resultant, changed)
    damped[p % PARTS] += work
    return viscous


@inlined
def push(system, interface, forces):
    """Add the forces of an interface to those on its bodies."""
    a, b = interface.a, interface.b
    system.force[a, X] += forces.x
    system.force[a, Z] += forces.z
    system.force[a, ROTATION] += forces.moment_a
    system.force[b, X] -= forces.x
    system.force[b, Z] -= forces.z
    system.force[b, ROTATION] -= forces.moment_b


@inlined
def stays_intact(interface, motion):
    """Whether no contact of an interface has failed, nor leaves its elastic range at this RelativeMotion."""
    return interface.failed == 0 and interfaces.stays_intact(
        springs_of(interface), interface.largest_opening, interface.largest_slide, motion)


@compiled
def remember_last(system):
    """What stiffness-proportional damping compares the next step with, at the present places."""
    for p in range(len(system.interfaces)):
        interface = system.interfaces[p]
        _, motion = interfaces.relative_motion(line_of(interface), pose(system, interface.a),
                                               pose(system, interface.b))
        keep_last(system, p, motion, contacts.present_resultant(system.contacts, system.states, interface.start,
                                                                interface.stop, motion))
