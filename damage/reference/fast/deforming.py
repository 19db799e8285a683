"""Fast step of a batch of up to eight walls with deformable bricks, to the same bits as by the plain step.

Contact points are evaluated one after the other, each in eight walls at once.  Where one leaves its elastic range in a
wall, the joint law is evaluated for this wall alone.  Samples are taken wall by wall from the tables, by the functions
of the plain step.
"""

import numpy as np

from damage.mechanics import contacts as singly
from damage.mechanics import interfaces, rows
from damage.mechanics.eight import add, bits, either, flags_of, load, spread, store
from damage.mechanics.interfaces import RelativeMotion, Resultant
from damage.mechanics.samples import observe
from damage.mechanics.step import remember_last
from damage.mechanics.strain import motion_at as motion_of_one
from damage.mechanics.strain import observe_modes
from damage.mechanics.tables import DAMPING, ENDED, ENDING, FAILED
from damage.reference.fast import blocks as at
from damage.reference.fast import modes as of
from damage.reference.fast.blocks import INDEX, clear, pack, place_of, total, unpack
from damage.reference.fast.compiled import compiled, entry, inlined
from damage.reference.fast.contacts import give_one, loose_springs, remember_loose, take_one, without_overlap
from damage.reference.fast.interfaces import damp_eight, keep_last, last_motion, line_of, poses_in_lanes, push_in_lanes
from damage.reference.fast.modes import adapt, motion_at, move, pack_modes, push_modes, unpack_modes
from damage.reference.fast.step import any_above_zero, wall_of
from damage.wall import joint_law


@entry
def run(tables, columns, blocks, modes, law, plain, controls, field, clock, ends, ending, stiffness, samples, taken):
    """Advance all walls and write samples; arguments as of `damage.reference.fast.together.run`.

    modes: Modes; law: damage.mechanics.tables.Law; plain: whether no contact softens or crushes.
    """
    pack(tables, blocks, 8)
    pack_modes(tables, modes)
    loosen(tables, columns, blocks, modes)
    damped, adaptive, step, k = any_above_zero(controls, 3), any_above_zero(controls, 4), 0, 0
    if damped:
        remember(tables, modes, law, 255)
    while k < len(ends):
        move(tables, blocks, modes, law.strain, controls, field, step)
        if adaptive:
            adapt(tables, blocks, modes, controls)
        step += 1
        all_forces(tables, columns, blocks, modes, law, plain, clock, step, damped)
        if step == ends[k]:
            unpack(tables, blocks, 8)
            unpack_modes(tables, modes)
            fasten(tables, columns, blocks, modes)
            observe_walls(tables, law, controls, field, step, int(ending[k]), stiffness, samples, taken)
            if damped:
                remember(tables, modes, law, int(ending[k]))
            k += 1


@compiled
def all_forces(tables, columns, blocks, modes, law, plain, clock, step, damped):
    """Forces of the contact points on all bodies and modes, into the blocks, where they are zero on entry."""
    clear(blocks.sums, at.DAMPED, at.KINETIC)
    if damped:
        forces_of_damped(tables, columns, blocks, modes, law, plain, clock, step)
        total(blocks.sums, at.DAMPED, 8)
        for w in range(tables.energy.shape[0]):
            tables.energy[w, DAMPING] += blocks.sums[at.DAMPED + INDEX(w)]
    else:
        forces_of_undamped(tables, columns, blocks, modes, law, plain, clock, step)


@compiled
def loosen(tables, columns, blocks, modes):
    """Copy the states of all contact points that are no intact springs in each wall into the blocks."""
    for i in range(tables.states.shape[1]):
        modes.failed[i] = 0
        for w in range(tables.states.shape[0]):
            if not is_intact_spring(tables.contacts[w, i], tables.states[w, i]):
                modes.failed[i] = 1
        if modes.failed[i]:
            take_all(tables, columns, blocks, i)
    for p in range(tables.interfaces.shape[1]):
        blocks.loose[p] = 0
        for w in range(tables.interfaces.shape[0]):
            if tables.interfaces[w, p].failed == FAILED:
                blocks.loose[p] |= 1 << w


@inlined
def is_intact_spring(contact, state):
    """Whether the forces of a contact point follow from its displacements and stiffnesses alone."""
    unloaded = state.shear_stress == 0.0 and state.shear0 == 0.0
    return unloaded and state.idle < 0.0 and state.kappa == 0.0 and contact.compressive_strength == np.inf


@compiled
def take_all(tables, columns, blocks, i):
    """Copy the states of contact point i in all walls into the blocks."""
    for w in range(tables.states.shape[0]):
        take_one(tables, columns, blocks, w, i)


@compiled
def fasten(tables, columns, blocks, modes):
    """Copy the changed states of contact points in the blocks back to the tables."""
    for i in range(len(modes.failed)):
        if modes.failed[i]:
            for w in range(tables.states.shape[0]):
                give_one(columns, blocks, w, i)


@compiled
def observe_walls(tables, law, controls, field, step, which, stiffness, samples, taken):
    """Write the next sample of each of the walls `which` (bits), whose tables hold the state."""
    for w in range(tables.interfaces.shape[0]):
        if which >> w & 1:
            system, dt = wall_of(tables, w), controls[w, 0]
            read_all(system, law)
            observe(system, stiffness, field[w, step], dt, samples, w, taken[w])
            observe_modes(system, law.strain, dt, samples, w, taken[w])
            taken[w] += 1


@inlined
def read_all(system, law):
    """Write the readings of all contact points, but of joints that have ended."""
    for p in range(len(system.interfaces)):
        if system.interfaces[p].failed < ENDING:
            read(system, law, system.interfaces[p])


@inlined
def read(system, law, interface):
    """`damage.mechanics.contacts.read` of all contact points of an interface."""
    _, motion = interfaces.relative_motion(rows.line_of(interface), rows.pose(system, interface.a),
                                           rows.pose(system, interface.b))
    for i in range(interface.start, interface.stop):
        singly.read(system.contacts, system.states, system.readings, i, i + 1,
                    motion_of_one(system, law.strain, interface, i, motion))


@compiled
def remember(tables, modes, law, which):
    """`damage.mechanics.step.remember_last` of the walls `which` (bits), whose tables hold the state."""
    for w in range(tables.interfaces.shape[0]):
        if which >> w & 1:
            remember_last(wall_of(tables, w), law)
            keep_all_last(tables.last[w], modes.last, w)


@inlined
def keep_all_last(of_wall, last, w):
    """Copy the table `last` of wall w into the blocks."""
    for i in range(len(of_wall)):
        for n in range(6):
            last[INDEX(i) * at.LAST + INDEX(8 * n + w)] = of_wall[i, n]


@compiled
def forces_of_undamped(tables, columns, blocks, modes, law, plain, clock, step):
    """`forces_of_all` without stiffness-proportional damping."""
    forces_of_all(tables, columns, blocks, modes, law, plain, clock, step, False)


@compiled
def forces_of_damped(tables, columns, blocks, modes, law, plain, clock, step):
    """`forces_of_all` with damping."""
    forces_of_all(tables, columns, blocks, modes, law, plain, clock, step, True)


@inlined
def forces_of_all(tables, columns, blocks, modes, law, plain, clock, step, damped):
    """Forces of all interfaces, one after the other, on the bodies and on their modes, which are zero on entry."""
    bodies, walls = blocks.bodies, (1 << tables.interfaces.shape[0]) - 1
    for p in range(tables.interfaces.shape[1]):
        a, b = blocks.first[p], blocks.second[p]
        frame, motion = interfaces.relative_motion(
            line_of(blocks.interfaces, place_of(INDEX(p), at.INTERFACE)), poses_in_lanes(bodies, a),
            poses_in_lanes(bodies, b))
        going = walls
        if modes.ended[p]:
            let_go(tables, columns, blocks, modes, law, p, motion)
            going = walls & ~int(modes.ended[p])
        resultant = forces_of_points(tables, columns, blocks, modes, law, plain, clock, step, p, going, motion, damped)
        if blocks.loose[p]:
            end_overlap(tables, columns, blocks, modes, law, p, motion)
        push_in_lanes(bodies, a, b, interfaces.forces_on_bodies(frame, resultant))


@inlined
def forces_of_points(tables, columns, blocks, modes, law, plain, clock, step, p, going, motion, damped):
    """Resultant of the contact points of interface p in the walls `going` (bits), and their forces on the modes."""
    a, b = tables.interfaces[0, p].a, tables.interfaces[0, p].b
    normal, shear, couple = spread(0.0), spread(0.0), spread(0.0)
    for i in range(tables.interfaces[0, p].start, tables.interfaces[0, p].stop):
        here = motion_at(modes, law.strain, a, b, i, motion)
        if modes.failed[i]:
            one, elastic = loose_springs(tables.contacts, blocks.contacts, plain, i, i + 1, here, flags_of(going))
            remember_loose(tables.contacts, blocks.contacts, plain, i, i + 1, here, elastic)
        else:
            one, elastic = intact_spring(tables.contacts[0, i], modes.limits, i, here, law.material.friction)
        others = going & ~int(bits(elastic))
        if damped:
            one, work = damp_eight(modes.last, INDEX(i) * at.LAST, load(blocks.bench, at.RATE), here, one,
                                   elastic & flags_of(going))
            add(blocks.sums, at.DAMPED + INDEX(i % 8 * 8), work)
        if others:
            one = forces_by_law(tables, columns, blocks, modes, law, clock, step, p, i, others, here, one, damped)
        if modes.ended[p]:
            lives = flags_of(going)
            one = Resultant(either(lives, one.normal, 0.0), either(lives, one.shear, 0.0),
                            either(lives, one.couple, 0.0))
        push_modes(modes, law.strain, a, b, i, one.normal, one.shear)
        normal, shear, couple = normal + one.normal, shear + one.shear, couple + one.couple
    return Resultant(normal, shear, couple)


@inlined
def intact_spring(contact, limits, i, motion, friction):
    """Resultant of an intact contact point in eight walls, and those (flags) in which it stays elastic."""
    # Adding zero, as the law adds closure and earlier force, turns -0 into +0: the bits stay equal.
    sigma = contact.kn * (motion.opening + contact.offset * motion.rotation + 0.0)
    tau, k = contact.ks * motion.shear + 0.0, INDEX(i) * of.LIMITS
    elastic = joint_law.stays_elastic(sigma, tau, load(limits, k + of.TENSION), load(limits, k + of.COHESION), friction)
    return Resultant(sigma, tau, sigma * contact.offset), elastic


@inlined
def forces_by_law(tables, columns, blocks, modes, law, clock, step, p, i, others, motion, one, damped):
    """Resultant of contact point i with the walls `others` (bits) by the joint law, the rest as given in `one`."""
    room = modes.room
    keep_motion(room, motion)
    store(room, of.NORMAL, one.normal)
    store(room, of.SHEAR, one.shear)
    store(room, of.COUPLE, one.couple)
    for w in range(tables.interfaces.shape[0]):
        if others >> w & 1:
            force_by_law(tables, columns, blocks, modes, law, clock[w] + step, w, p, i, damped)
    return Resultant(load(room, of.NORMAL), load(room, of.SHEAR), load(room, of.COUPLE))


@compiled
def force_by_law(tables, columns, blocks, modes, law, step, w, p, i, damped):
    """Evaluate the joint law of contact point i in wall w, of and into the room."""
    room, m, motion = modes.room, INDEX(i) * at.LAST + INDEX(w), kept_motion(modes.room, w)
    if modes.failed[i]:
        give_one(columns, blocks, w, i)
    before = last_motion(modes.last, m) if damped and blocks.bench[at.RATE + INDEX(w)] > 0.0 else motion
    resultant, changed, failed = singly.law_resultant(wall_of(tables, w), law, i, i + 1, step, motion, before, damped)
    if failed:
        tables.interfaces[w, p].failed = FAILED
        blocks.loose[p] |= 1 << w
    if modes.failed[i]:
        take_one(tables, columns, blocks, w, i)
    elif failed:
        modes.failed[i] = 1
        take_all(tables, columns, blocks, i)
    if damped:
        viscous, work = interfaces.add_viscous(blocks.bench[at.RATE + INDEX(w)], motion, before, resultant, changed)
        keep_last(modes.last, m, motion, resultant)
        blocks.sums[at.DAMPED + INDEX(i % 8 * 8 + w)] += work
        resultant = viscous
    room[of.NORMAL + INDEX(w)], room[of.SHEAR + INDEX(w)] = resultant.normal, resultant.shear
    room[of.COUPLE + INDEX(w)] = resultant.couple


@inlined
def keep_motion(room, motion):
    """Store a RelativeMotion of eight walls in the room."""
    store(room, of.HERE_OPENING, motion.opening)
    store(room, of.HERE_SHEAR, motion.shear)
    store(room, of.HERE_ROTATION, motion.rotation)


@inlined
def kept_motion(room, w):
    """RelativeMotion of wall w in the room."""
    k = INDEX(w)
    return RelativeMotion(room[of.HERE_OPENING + k], room[of.HERE_SHEAR + k], room[of.HERE_ROTATION + k])


@compiled
def end_overlap(tables, columns, blocks, modes, law, p, motion):
    """Mark interface p ENDING where its faces cease to overlap, with the readings of this step."""
    over = without_overlap(tables, p, motion) & int(blocks.loose[p]) & ~int(modes.ended[p])
    if not over:
        return
    modes.ended[p] |= over
    a, b = tables.interfaces[0, p].a, tables.interfaces[0, p].b
    for i in range(tables.interfaces[0, p].start, tables.interfaces[0, p].stop):
        keep_motion(modes.room, motion_at(modes, law.strain, a, b, i, motion))
        read_where(tables, columns, blocks, modes, over, i)
    for w in range(tables.interfaces.shape[0]):
        if over >> w & 1:
            tables.interfaces[w, p].failed = ENDING


@inlined
def read_where(tables, columns, blocks, modes, which, i):
    """Readings of contact point i in the walls `which` (bits), at the motions in the room."""
    for w in range(tables.interfaces.shape[0]):
        if which >> w & 1:
            if modes.failed[i]:
                give_one(columns, blocks, w, i)
            system = wall_of(tables, w)
            singly.read(system.contacts, system.states, system.readings, i, i + 1, kept_motion(modes.room, w))


@compiled
def let_go(tables, columns, blocks, modes, law, p, motion):
    """Set the forces of interface p to zero, permanently, in the walls where it is ENDING."""
    ending = 0
    for w in range(tables.interfaces.shape[0]):
        if tables.interfaces[w, p].failed == ENDING:
            ending |= 1 << w
            tables.interfaces[w, p].failed = ENDED
    if not ending:
        return
    a, b = tables.interfaces[0, p].a, tables.interfaces[0, p].b
    for i in range(tables.interfaces[0, p].start, tables.interfaces[0, p].stop):
        keep_motion(modes.room, motion_at(modes, law.strain, a, b, i, motion))
        let_go_where(tables, columns, blocks, modes, ending, i)


@inlined
def let_go_where(tables, columns, blocks, modes, which, i):
    """`damage.mechanics.contacts.let_go` of contact point i in the walls `which` (bits)."""
    for w in range(tables.interfaces.shape[0]):
        if which >> w & 1:
            singly.let_go(wall_of(tables, w), i, i + 1, kept_motion(modes.room, w))
            if modes.failed[i]:
                take_one(tables, columns, blocks, w, i)
