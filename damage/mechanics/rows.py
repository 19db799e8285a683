"""Conversion between rows of the tables and the arguments and results of `damage.mechanics.interfaces`."""

from damage.mechanics.compiled import inlined
from damage.mechanics.eight import add, add_three, either, four, load, store, store_where
from damage.mechanics.interfaces import Dashpots, Line, Pose, RelativeMotion, Resultant, Springs
from damage.mechanics.tables import COS1, PLACE, RIGID, ROTATION, SIN, X, Z


@inlined
def line_of(interface):
    """Line of a row of INTERFACE."""
    return Line(interface.ax, interface.az, interface.bx, interface.bz, interface.head)


@inlined
def springs_of(interface):
    """Springs of a row of INTERFACE."""
    return Springs(interface.kn, interface.ks, interface.kn_offset, interface.kn_offset2, interface.reach,
                   interface.slide_loss)


@inlined
def line_in(n, lines, block):
    """Line of an interface, or of eight, in a block of `lines`; n: as of `in_blocks`."""
    return Line(load(n, lines, block, 0), load(n, lines, block, 1), load(n, lines, block, 2), load(n, lines, block, 3),
                load(n, lines, block, 10))


@inlined
def springs_in(n, lines, block):
    """Springs of an interface, or of eight, as `line_in`."""
    return Springs(load(n, lines, block, 4), load(n, lines, block, 5), load(n, lines, block, 6),
                   load(n, lines, block, 7), load(n, lines, block, 8), load(n, lines, block, 9))


@inlined
def pose_at(n, bodies, rows, p):
    """Pose of body rows[p], or of eight from there on."""
    cos1, sin, x, z = four(n, bodies, rows, p, COS1)
    return Pose(x, z, cos1, sin)


@inlined
def push_at(n, bodies, first, second, p, forces, which):
    """Add BodyForces to rigid bodies first[p] and second[p], or to eight of both from there on, where `which` is."""
    x, z = either(which, forces.x, 0.0), either(which, forces.z, 0.0)
    add_three(n, bodies, first, second, p, PLACE + RIGID, (x, z, either(which, forces.moment_a, 0.0)),
              (-x, -z, -either(which, forces.moment_b, 0.0)))


@inlined
def first_force(bodies):
    """Field of `bodies` of the first force."""
    return bodies.shape[1] // 2 + 1


@inlined
def pose(n, bodies, b):
    """Pose of body b."""
    return Pose(load(n, bodies, b, PLACE + X), load(n, bodies, b, PLACE + Z), load(n, bodies, b, COS1),
                load(n, bodies, b, SIN))


@inlined
def push_body(n, bodies, b, x, z, moment):
    """Add forces [N] and a moment [N m] to those on body b."""
    first = first_force(bodies)
    add(n, bodies, b, first + X, x)
    add(n, bodies, b, first + Z, z)
    add(n, bodies, b, first + ROTATION, moment)


@inlined
def push(n, bodies, interface, forces, which):
    """Add BodyForces of an interface to the forces on its bodies in the walls `which` (flags)."""
    x, z = either(which, forces.x, 0.0), either(which, forces.z, 0.0)
    push_body(n, bodies, interface.a, x, z, either(which, forces.moment_a, 0.0))
    push_body(n, bodies, interface.b, -x, -z, -either(which, forces.moment_b, 0.0))


@inlined
def last_motion(n, last, row):
    """RelativeMotion in the last step."""
    return RelativeMotion(load(n, last, row, 0), load(n, last, row, 1), load(n, last, row, 2))


@inlined
def last_resultant(n, last, row):
    """Resultant in the last step [N, N m]."""
    return Resultant(load(n, last, row, 3), load(n, last, row, 4), load(n, last, row, 5))


@inlined
def keep_last(n, last, row, motion, resultant, which):
    """Store RelativeMotion and Resultant for the next step, in the walls `which` (flags)."""
    before, old = last_motion(n, last, row), last_resultant(n, last, row)  # all before the first one is written
    store(n, last, row, 0, either(which, motion.opening, before.opening))
    store(n, last, row, 1, either(which, motion.shear, before.shear))
    store(n, last, row, 2, either(which, motion.rotation, before.rotation))
    store(n, last, row, 3, either(which, resultant.normal, old.normal))
    store(n, last, row, 4, either(which, resultant.shear, old.shear))
    store(n, last, row, 5, either(which, resultant.couple, old.couple))


@inlined
def dashpots_of(n, radiation, row):
    """Dashpots of a row of `radiation`."""
    of_last = Resultant(load(n, radiation, row, 2), load(n, radiation, row, 3), load(n, radiation, row, 4))
    return Dashpots(load(n, radiation, row, 0), load(n, radiation, row, 1), of_last)


@inlined
def keep_dashpots(n, radiation, row, resultant, which):
    """Store the Resultant of dashpots, in the walls `which` (flags)."""
    store_where(n, radiation, row, 2, which, resultant.normal)
    store_where(n, radiation, row, 3, which, resultant.shear)
    store_where(n, radiation, row, 4, which, resultant.couple)
