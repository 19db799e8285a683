"""Interfaces in blocks: vectors of eight interfaces of one wall or of one in eight walls, and single interfaces."""

from damage.mechanics import interfaces
from damage.mechanics.eight import add, either, load, store
from damage.mechanics.interfaces import BodyForces, Line, Pose, RelativeMotion, Resultant, Springs
from damage.reference.fast import blocks as at
from damage.reference.fast.compiled import inlined


@inlined
def line_of(array, p):
    """Line of the single interface at index p."""
    return Line(array[p + at.AX], array[p + at.AZ], array[p + at.BX], array[p + at.BZ], array[p + at.HEAD])


@inlined
def lines_of(array, p):
    """Lines of the eight interfaces at index p."""
    return Line(load(array, p + at.AX), load(array, p + at.AZ), load(array, p + at.BX), load(array, p + at.BZ),
                load(array, p + at.HEAD))


@inlined
def springs_of(array, p):
    """Springs of the single interface at index p."""
    return Springs(array[p + at.KN], array[p + at.KS], array[p + at.KN_OFFSET], array[p + at.KN_OFFSET2],
                   array[p + at.REACH], array[p + at.SLIDE_LOSS])


@inlined
def springs_of_eight(array, p):
    """Springs of the eight interfaces at index p."""
    return Springs(load(array, p + at.KN), load(array, p + at.KS), load(array, p + at.KN_OFFSET),
                   load(array, p + at.KN_OFFSET2), load(array, p + at.REACH), load(array, p + at.SLIDE_LOSS))


@inlined
def pose_of(bodies, k, apart):
    """Pose of a single body at index k; apart: distance of its fields."""
    return Pose(bodies[k], bodies[k + apart], bodies[k + apart + apart], bodies[k + apart + apart + apart])


@inlined
def poses_in_lanes(bodies, k):
    """Pose of a body in eight walls, at index k."""
    return Pose(load(bodies, k + at.X), load(bodies, k + at.Z), load(bodies, k + at.COS1), load(bodies, k + at.SIN))


@inlined
def evaluate(line, springs, a, b, limits, m):
    """Frame, RelativeMotion and elastic Resultant of eight interfaces, and whether they stay intact (flags)."""
    frame, motion = interfaces.relative_motion(line, a, b)
    intact = interfaces.stays_intact(springs, load(limits, m + at.OPENING), load(limits, m + at.SLIDE), motion)
    return frame, motion, interfaces.elastic_resultant(springs, motion), intact


@inlined
def last_motion(last, m):
    """RelativeMotion of the single interface at index m in the last step."""
    return RelativeMotion(last[m + at.MIDDLE], last[m + at.SHEAR], last[m + at.ROTATED])


@inlined
def last_resultant(last, m):
    """Resultant of the single interface at index m in the last step [N, N m]."""
    return Resultant(last[m + at.NORMAL], last[m + at.ALONG], last[m + at.COUPLE])


@inlined
def keep_last(last, m, motion, resultant):
    """Store RelativeMotion and Resultant of the single interface at index m for the next step."""
    last[m + at.MIDDLE], last[m + at.SHEAR], last[m + at.ROTATED] = motion.opening, motion.shear, motion.rotation
    last[m + at.NORMAL], last[m + at.ALONG], last[m + at.COUPLE] = resultant.normal, resultant.shear, resultant.couple


@inlined
def damp_eight(last, m, rate, motion, resultant, intact):
    """Resultant of eight interfaces with stiffness-proportional damping [N, N m], and its work [J].

    Where they are intact (flags), motion and resultant are stored for the next step; elsewhere the work is zero.
    """
    before = RelativeMotion(load(last, m + at.MIDDLE), load(last, m + at.SHEAR), load(last, m + at.ROTATED))
    old = Resultant(load(last, m + at.NORMAL), load(last, m + at.ALONG), load(last, m + at.COUPLE))
    damped, work = interfaces.add_viscous(rate, motion, before, resultant, interfaces.change(resultant, old))
    store(last, m + at.MIDDLE, either(intact, motion.opening, before.opening))
    store(last, m + at.SHEAR, either(intact, motion.shear, before.shear))
    store(last, m + at.ROTATED, either(intact, motion.rotation, before.rotation))
    store(last, m + at.NORMAL, either(intact, resultant.normal, old.normal))
    store(last, m + at.ALONG, either(intact, resultant.shear, old.shear))
    store(last, m + at.COUPLE, either(intact, resultant.couple, old.couple))
    return damped, either(intact, work, 0.0)


@inlined
def forces_where(intact, frame, resultant):
    """BodyForces of eight interfaces, zero where they are not intact."""
    forces = interfaces.forces_on_bodies(frame, resultant)
    return BodyForces(either(intact, forces.x, 0.0), either(intact, forces.z, 0.0),
                      either(intact, forces.moment_a, 0.0), either(intact, forces.moment_b, 0.0))


@inlined
def push_in_lanes(bodies, a, b, forces):
    """Add BodyForces of an interface to its bodies in eight walls; a, b: indices of the bodies."""
    add(bodies, a + at.FX, forces.x)
    add(bodies, a + at.FZ, forces.z)
    add(bodies, a + at.MOMENT, forces.moment_a)
    add(bodies, b + at.FX, -forces.x)
    add(bodies, b + at.FZ, -forces.z)
    add(bodies, b + at.MOMENT, -forces.moment_b)


@inlined
def push_one(bodies, a, b, apart, forces):
    """Add BodyForces of a single interface to its bodies at indices a, b; apart: distance of their fields."""
    half = apart + apart
    half += half  # forces follow the four fields of a Pose
    a += half
    b += half
    bodies[a] += forces.x
    bodies[a + apart] += forces.z
    bodies[a + apart + apart] += forces.moment_a
    bodies[b] -= forces.x
    bodies[b + apart] -= forces.z
    bodies[b + apart + apart] -= forces.moment_b
