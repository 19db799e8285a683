"""Conversion between rows of the tables and the arguments and results of `damage.mechanics.interfaces`."""

from damage.mechanics import interfaces
from damage.mechanics.compiled import inlined
from damage.mechanics.interfaces import Line, Pose, RelativeMotion, Resultant, Springs
from damage.mechanics.tables import X, Z


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
def pose(system, b):
    """Pose of body b."""
    return Pose(system.place[b, X], system.place[b, Z], system.trig[b, 0], system.trig[b, 1])


@inlined
def last_motion(system, p):
    """RelativeMotion of interface p in the last step."""
    return RelativeMotion(system.last[p, 0], system.last[p, 1], system.last[p, 2])


@inlined
def change_since_last(system, p, resultant):
    """Change of the resultant of interface p since the last step [N, N m]."""
    return interfaces.change(resultant, Resultant(system.last[p, 3], system.last[p, 4], system.last[p, 5]))


@inlined
def keep_last(system, p, motion, resultant):
    """Store RelativeMotion and Resultant of interface p for the next step."""
    system.last[p, 0], system.last[p, 1], system.last[p, 2] = motion.opening, motion.shear, motion.rotation
    system.last[p, 3], system.last[p, 4], system.last[p, 5] = resultant.normal, resultant.shear, resultant.couple
