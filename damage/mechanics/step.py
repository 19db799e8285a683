"""The plain time step: move the bodies, evaluate every interface and every loose contact, sum the forces.

This is the definition of the model.  It runs every wall, compiled by numba or as plain Python (NUMBA_DISABLE_JIT=1).
The fast step of the reference solver computes eight walls, or eight interfaces of one wall, at once, to the same bits.
The order of summation is therefore one that both can follow (PARTS).

Time integration is by central differences: velocities at half steps, displacements and forces at full steps.
"""

import numpy as np

from damage.mechanics import bodies, contacts, interfaces
from damage.mechanics.compiled import compiled, entry, inlined, inlined_entry
from damage.mechanics.interfaces import Resultant
from damage.mechanics.loose import STORED, can_end, ends_now, find_loose_forces, hand_over
from damage.mechanics.rows import change_since_last, keep_last, last_motion, line_of, pose, springs_of
from damage.mechanics.samples import ELASTIC, observe
from damage.mechanics.strain import kinetic_of_modes, motion_at, move_mode, observe_modes, points_at_once, push_modes
from damage.mechanics.tables import DAMPING, ENDED, ENDING, FAILED, FRICTION, INDEX, INPUT, RIGID, ROTATION, X, Z

PARTS = 8
"""Number of partial sums over bodies and interfaces: rows 0, 8, 16 and so on, rows 1, 9, 17 and so on."""

SWEPT_X, SWEPT_Z, DRIVEN, TAKEN, KINETIC = range(5)
"""Rows of `sums`: momenta along x and z, power of prescribed velocities, power of damping, kinetic energy."""


@entry
def run(system, law, controls, field, clock, ends, scratch, stiffness, samples, w, loose):
    """Advance a wall and write a sample at each of the steps `ends`.

    On entry the forces must be those at the present displacements.  On return, and at each sample, forces and readings
    (opening, shear displacement and stresses of every contact point, `System.readings`) are those at the displacements.
    system, law, controls: System, Law and Controls; field: (steps + 1, 3) acceleration of the base along x and z and
    gravity, in each step and the one after the last [m/s2]; clock: number of steps before; ends: (n,) rising numbers of
    steps from now; scratch: Scratch; stiffness, samples, w: as of `damage.mechanics.samples.observe`; loose: Loose.
    """
    step = 0
    for k in range(len(ends)):
        if is_damped(system, controls):
            remember_last(system, law)
        while step < ends[k]:
            move(system, law, controls, field[step], scratch.sums)
            if controls.adaptive > 0.0:
                adapt(system, controls, scratch.sums[KINETIC])
            step += 1
            find_forces(system, law, controls, clock + step, step == ends[k], scratch, loose, controls.time_step)
        observe(system, stiffness, field[step], controls.time_step, samples, w, k)
        observe_modes(system, law.strain, controls.time_step, samples, w, k)
        samples.totals[w, k, ELASTIC] += loose.energy[STORED]


@inlined
def move(system, law, controls, field, sums):
    """Advance velocities and displacements of all bodies by a step; add the work of input and damping [J].

    field: (3,) as of `run`; sums: of Scratch.
    """
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
        for m in range(law.strain.shapes.shape[2]):
            lost += move_mode(system, law.strain, dt, alpha, controls.local, b, m)
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
    """Advance velocity and displacement of coordinate k of body b by a step.

    backwards: acceleration of the field [m/s2].  Returns the sum of its momenta before and after [kg m/s], and the
    powers of its prescribed velocity and of its damping [W].
    """
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
    """Sum of the partial sums, in their order."""
    value = 0.0
    for part in parts:
        value += part
    return value


@inlined
def adapt(system, controls, parts):
    """Set the adaptive damping of the next step from the kinetic energy of this one; parts: zero on entry."""
    for b in range(len(system.velocity)):
        parts[b % PARTS] += bodies.kinetic_energy(system.mass[b], system.velocity[b])
        if system.place.shape[1] > RIGID:
            parts[b % PARTS] += kinetic_of_modes(system.mass[b], system.velocity[b])
    kinetic = total(parts)
    system.relaxation[0] = bodies.adaptive_damping(kinetic, system.relaxation[1], controls.adaptive, controls.time_step)
    system.relaxation[1] = kinetic


@inlined_entry
def find_forces(system, law, controls, step, singly, scratch, loose, since):
    """Add the forces of all interfaces and loose contacts to those of the bodies, which are zero on entry.

    Intact interfaces come first, each by its resultant springs, then the others contact point by contact point.
    step: number of the step in the log of events; singly: evaluate every contact point by itself and write the
    readings, as for samples, so that forces are the sums of the stresses to the last bit; since: time since the last
    forces [s], zero where nothing has moved.
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
        if is_damped(system, controls):
            resultant = damp(system, controls, p, motion, resultant, change_since_last(system, p, resultant), damped)
        push(system, interface, interfaces.forces_on_bodies(frame, resultant))
    for k in range(others):
        forces_by_contacts(system, law, controls, scratch.others[k], step, singly, damped, loose)
    for b in range(len(system.turning)):
        if system.turning[b, 0] > 0.0:
            system.force[b, ROTATION] -= system.turning[b, 0] * (system.place[b, ROTATION] - system.turning[b, 1])
    find_loose_forces(system, loose, since)
    system.energy[DAMPING] += total(damped)


@inlined
def forces_by_contacts(system, law, controls, p, step, singly, damped, loose):
    """Add the forces of interface p, evaluated contact point by contact point.

    Those that share a RelativeMotion (all between rigid bricks, one between deformable ones) are springs while all stay
    in their elastic range, else the joint law applies.  Once the faces have ceased to overlap, forces are zero from the
    next step on, permanently.
    """
    interface = system.interfaces[p]
    start, size = interface.start, points_at_once(law.strain, interface)
    frame, motion = interfaces.relative_motion(line_of(interface), pose(system, interface.a), pose(system, interface.b))
    if interface.failed >= ENDING:
        if interface.failed == ENDING:
            let_go(system, law, p, motion, loose)
        return
    resultant = Resultant(0.0, 0.0, 0.0)
    while start < interface.stop:
        here = motion_at(system, law.strain, interface, start, motion)
        of_points = forces_of_points(system, law, controls, p, start, start + size, step, here, damped)
        push_modes(system, law.strain, interface, start, of_points.normal, of_points.shear)
        resultant = interfaces.add(resultant, of_points)
        start += size
    if ends_now(system, loose, p, step, motion) or singly:
        start = interface.start
        while start < interface.stop:
            contacts.read(system.contacts, system.states, system.readings, start, start + size,
                          motion_at(system, law.strain, interface, start, motion))
            start += size
    push(system, interface, interfaces.forces_on_bodies(frame, resultant))


@inlined
def let_go(system, law, p, motion, loose):
    """Set the forces of interface p to zero, permanently; its bodies become a loose pair where there are such."""
    interface, before = system.interfaces[p], system.energy[FRICTION]
    start, size = interface.start, points_at_once(law.strain, interface)
    while start < interface.stop:
        contacts.let_go(system, start, start + size, motion_at(system, law.strain, interface, start, motion))
        start += size
    interface.failed = ENDED
    if len(loose.cores) > 0:
        hand_over(system, loose, interface, system.energy[FRICTION] - before)


@inlined
def forces_of_points(system, law, controls, p, start, stop, step, motion, damped):
    """Resultant of contact points of an interface that share a RelativeMotion [N, N m]."""
    interface, row = system.interfaces[p], last_row(law, p, start)
    resultant, elastic = contacts.elastic_resultant(system.contacts, system.states, start, stop, motion)
    changed = change_since_last(system, row, resultant)
    if elastic or stays_intact(interface, motion):
        contacts.remember(system.contacts, system.states, start, stop, motion)
    else:
        before = motion
        if is_damped(system, controls):
            before = last_motion(system, row)
        elif law.strain.shapes.shape[2] == 0:
            before = motion_before(system, interface, controls.time_step)
        resultant, changed, failed = contacts.law_resultant(system, law, start, stop, step, motion, before,
                                                            is_damped(system, controls))
        if failed:
            interface.failed = FAILED
    if is_damped(system, controls):
        resultant = damp(system, controls, row, motion, resultant, changed, damped)
    return resultant


@inlined
def is_damped(system, controls):
    """Whether interfaces damp: by stiffness-proportional damping, or by dashpots of the soil."""
    return controls.beta > 0.0 or (len(system.radiation) > 0 and controls.time_step > 0.0)


@inlined
def motion_before(system, interface, dt):
    """RelativeMotion of an interface between rigid bodies in the last step, by their velocities; dt: time step [s]."""
    return interfaces.relative_motion(line_of(interface), pose_before(system, interface.a, dt),
                                      pose_before(system, interface.b, dt))[1]


@inlined
def pose_before(system, b, dt):
    """Pose of body b in the last step."""
    velocity = system.velocity[b]
    return interfaces.pose_before(system.place[b, X], system.place[b, Z], system.place[b, ROTATION], velocity[X],
                                  velocity[Z], velocity[ROTATION], dt)


@inlined
def last_row(law, p, start):
    """Row of `System.last` of interface p, or of its contact where bricks deform."""
    return INDEX(p) if law.strain.shapes.shape[2] == 0 else start


@inlined
def damp(system, controls, p, motion, resultant, changed, damped):
    """Resultant of interface p with stiffness-proportional damping and dashpots [N, N m]; stores motion and elastic
    resultant for the next step.

    changed: change of the elastic resultant since the last step; damped: partial sums of the work [J].
    """
    before = last_motion(system, p)
    keep_last(system, p, motion, resultant)
    viscous, work = interfaces.add_viscous(controls.beta / controls.time_step, motion, before, resultant, changed)
    if len(system.radiation) > 0:
        viscous, more = interfaces.add_dashpots(system.radiation[p], controls.time_step, motion, before, viscous,
                                                changed)
        work += more
    damped[p % PARTS] += work
    return viscous


@inlined
def push(system, interface, forces):
    """Add BodyForces of an interface to the forces on its bodies."""
    a, b = interface.a, interface.b
    system.force[a, X] += forces.x
    system.force[a, Z] += forces.z
    system.force[a, ROTATION] += forces.moment_a
    system.force[b, X] -= forces.x
    system.force[b, Z] -= forces.z
    system.force[b, ROTATION] -= forces.moment_b


@inlined
def stays_intact(interface, motion):
    """Whether no contact point of an interface has failed or leaves its elastic range at this RelativeMotion."""
    return interface.failed == 0 and interfaces.stays_intact(
        springs_of(interface), interface.largest_opening, interface.largest_slide, motion)


@compiled
def remember_last(system, law):
    """Store present motions and resultants of all interfaces, for stiffness-proportional damping in the next step."""
    for p in range(len(system.interfaces)):
        interface = system.interfaces[p]
        start, size = interface.start, points_at_once(law.strain, interface)
        _, motion = interfaces.relative_motion(line_of(interface), pose(system, interface.a),
                                               pose(system, interface.b))
        while start < interface.stop:
            here = motion_at(system, law.strain, interface, start, motion)
            keep_last(system, last_row(law, p, start), here, contacts.present_resultant(
                system.contacts, system.states, start, start + size, here))
            start += size
