"""Rows of the tables as records, by the names of their fields, and the coordinates of a body."""

from numba.extending import overload

from damage.law.joint_law import ContactState, ElasticRange, Material
from damage.mechanics.compiled import inlined
from damage.mechanics.interfaces import (
    ElasticLimits,
    Line,
    Pose,
    RelativeMotion,
    Resultant,
    Springs,
    relative_motion,
)
from damage.mechanics.simd import (
    Eight,
    add,
    add_three,
    column,
    either,
    filled,
    four,
    in_blocks,
    lanes,
    load,
    reader,
    writer,
)
from damage.mechanics.tables import (
    CONTACT_FIELDS,
    COS1,
    INERTIAL,
    INVERSE_MASS,
    LAST,
    LIMITS,
    LINES,
    MASS,
    MEAN,
    PARTS,
    PLACE,
    READINGS,
    RIGID,
    ROTATION,
    SPRINGS,
    STRENGTHS,
    VELOCITY,
    Beam,
    Bearing,
    Bench,
    Reading,
    Strengths,
    X,
    Z,
)

NORMAL_STIFFNESS, SHEAR_STIFFNESS = map(STRENGTHS.index, ("normal_stiffness", "shear_stiffness"))
law_state = reader(ContactState, CONTACT_FIELDS)
keep_law_state = writer(ContactState, CONTACT_FIELDS)
range_now = reader(ElasticRange, CONTACT_FIELDS, "elastic_")
keep_range = writer(ElasticRange, CONTACT_FIELDS, "elastic_")
strengths_of = reader(Strengths, STRENGTHS)
material_of = reader(Material, Material._fields)
reading_of = reader(Reading, READINGS)
keep_reading = writer(Reading, READINGS)
bench_of = reader(Bench, Bench._fields)
keep_bench = writer(Bench, Bench._fields)
bearing_of = reader(Bearing, Bearing._fields)
keep_bearing = writer(Bearing, Bearing._fields)
beam_of = reader(Beam, Beam._fields)
keep_beam = writer(Beam, Beam._fields)
limits_of = reader(ElasticLimits, LIMITS)
line_in = reader(Line, LINES)
shared_in = reader(Springs, LINES)
springs_in = reader(Springs, SPRINGS)
last_motion = reader(RelativeMotion, LAST)
last_resultant = reader(Resultant, LAST, "last_")
keep_motion = writer(RelativeMotion, LAST)
keep_resultant = writer(Resultant, LAST, "last_")


@inlined
def line_of(n, tables, p):
    """Line of interface p, or of eight from there on; equal in all walls."""
    return line_in(in_blocks(n, p), tables.lines, p // PARTS)


@inlined
def are_alike(n, tables):
    """Whether all walls have the same springs."""
    return lanes(n) == 1 or tables.alike


def springs_of(n, tables, p, alike):
    """Springs of interface p, or of eight from there on; alike: `are_alike`."""
    if alike:
        return shared_in(in_blocks(n, p), tables.lines, p // PARTS)
    return springs_in(n, tables.springs, p)


@overload(springs_of)
def _springs_of(n, tables, p, alike):
    """Both branches have to give one type, of eight walls vectors."""

    def of_one(n, tables, p, alike):
        return shared_in(in_blocks(n, p), tables.lines, p // PARTS)

    def of_eight(n, tables, p, alike):
        if alike:
            return filled(n, shared_in(in_blocks(n, p), tables.lines, p // PARTS))
        return springs_in(n, tables.springs, p)

    return of_eight if n.instance_class is Eight else of_one


@inlined
def stiffness_of(n, tables, i):
    """Normal and shear stiffness of contact point i [N/m]."""
    area = tables.contacts[i].area
    return (
        load(n, tables.strengths, i, NORMAL_STIFFNESS) * area,
        load(n, tables.strengths, i, SHEAR_STIFFNESS) * area,
    )


@inlined
def pose_at(n, bodies, rows, p):
    """Pose of body rows[p], or of eight from there on."""
    cos1, sin, x, z = four(n, bodies, rows, p, COS1)
    return Pose(x, z, cos1, sin)


@inlined
def push_at(n, bodies, first, second, p, forces, which):
    """Add BodyForces to rigid bodies first[p] and second[p], or to eight of both from there on,
    where `which` is."""
    x = either(which, forces.x, 0.0)
    z = either(which, forces.z, 0.0)
    add_three(
        n,
        bodies,
        first,
        second,
        p,
        PLACE + RIGID,
        (x, z, either(which, forces.moment_a, 0.0)),
        (-x, -z, -either(which, forces.moment_b, 0.0)),
    )


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
    x = either(which, forces.x, 0.0)
    z = either(which, forces.z, 0.0)
    push_body(n, bodies, interface.a, x, z, either(which, forces.moment_a, 0.0))
    push_body(n, bodies, interface.b, -x, -z, -either(which, forces.moment_b, 0.0))


# --- coordinate k of body b: X, Z, ROTATION, then strain modes ------------------------------------


@inlined
def first_force(bodies):
    """Field of `bodies` of the first force."""
    return bodies.shape[1] // 2 + 1


@inlined
def force_of(n, bodies, b, k):
    """Force on it [N or N m]."""
    return load(n, bodies, b, first_force(bodies) + k)


place_of = column(PLACE, 1)
"""(n, bodies, b, k): coordinate [m or rad]."""
velocity_of = column(VELOCITY, INERTIAL)
"""(n, inertia, b, k): velocity half a step ago [m/s or rad/s]."""
mass_of = column(MASS, INERTIAL)
"""(n, inertia, b, k): mass [kg] or moment of inertia [kg m2]."""
inverse_mass_of = column(INVERSE_MASS, INERTIAL)
"""(n, inertia, b, k): inverse of the mass, zero where the velocity is prescribed."""
mean_of = column(MEAN, INERTIAL)
"""(n, inertia, b, k): running mean of the velocity [m/s or rad/s]."""


@inlined
def moved(n, tables, p):
    """Frame and RelativeMotion of interface p, or of eight from there on."""
    return relative_motion(
        line_of(n, tables, p),
        pose_at(n, tables.bodies, tables.first, p),
        pose_at(n, tables.bodies, tables.second, p),
    )
