"""A wall as it is built, in lines for people: what differs from what is given, since courses are
whole, its rigid top masses (caps) and the stress below them, its floors and lintels."""

from typing import NamedTuple

from damage.elementary import tan
from damage.units import GRAVITY
from damage.wall.kinds import CAP_COURSE
from damage.wall.restraints import top_of

_SAME = 1e-4  # [m], sizes and places closer than this are as given
WARN_COURSE = 0.25
"""Distance of an edge from its place, in courses, above which a run warns."""
WARN_HEIGHT = 0.05
"""Distance of an edge from its place, as a share of a height, above which a run warns."""


class Part(NamedTuple):
    """A part of a wall: its name; z [m] of its lower and upper edge as given and as built; length
    [m], None where it is as given or of no interest."""

    what: str
    given: tuple[float, float]
    built: tuple[float, float]
    length: float | None = None

    @property
    def differs(self):
        """Whether it is built otherwise."""
        return any(abs(given - other) > _SAME for given, other in zip(self.given, self.built))

    def far(self, course):
        """Whether it is built far from what is given, in a wall of courses of this height [m]."""
        height, built = (high - low for low, high in (self.given, self.built))
        return (
            any(
                abs(given - other) > WARN_COURSE * course + _SAME
                for given, other in zip(self.given, self.built)
            )
            or abs(built - height) > WARN_HEIGHT * height + _SAME
        )

    def describe(self):
        """It in a line."""
        return (
            f"{self.what} built {_sized(self.built, self.length)}; given"
            f" {_sized(self.given, self.length)}"
        )


def _sized(edges, length):
    low, high = edges
    size = f"{length:.4g} x {high - low:.4g} m" if length else f"{high - low:.4g} m high"
    return f"{size}, z = {low:.4g} to {high:.4g} m"


def openings_as_built(plan):
    """The openings of a damage.wall.plan.Plan, a list of Part in their order."""
    course = plan.wall.brick.height
    return [
        Part(
            f"opening {number}",
            (opening.sill, opening.sill + opening.height),
            (course * place.first, course * place.above),
            opening.width,
        )
        for number, (opening, place) in enumerate(zip(plan.wall.openings, plan.openings), start=1)
    ]


def describe_openings(plan):
    """Lines on the openings of a Plan that are built otherwise than given."""
    return [difference.describe() for difference in openings_as_built(plan) if difference.differs]


def warn_of_courses(plan):
    """Warnings of parts of a Plan's wall that are built far from what is given: a list of at most
    one line."""
    wall = plan.wall
    course = plan.wall.brick.height
    levels = [
        Part(f"floor {number}", (0.0, place.floor.level), (0.0, course * place.above))
        for number, place in enumerate(plan.floors, start=1)
    ]
    whole = Part("wall", (0.0, wall.height), (0.0, wall.built_height))
    far = [
        difference.describe()
        for difference in (whole, *openings_as_built(plan), *levels)
        if difference.far(course)
    ]
    return (
        [
            f"whole courses of {course:.4g} m leave differences above {WARN_COURSE:g} of a course"
            f" or {100 * WARN_HEIGHT:g} %: {'. '.join(far)}. Give multiples of a course, or look at"
            " the picture of python3 -m damage draw"
        ]
        if far
        else []
    )


def warn_of_slabs(plan):
    """Warnings of openings of a Plan that a concrete floor runs through: a list of str.

    The slab is built and the opening's other courses stay open, so that one opening becomes two, or
    a lower one.
    """
    course = plan.wall.brick.height
    return [
        f"the concrete floor at {slab.floor.level:g} m (x = {slab.left:g} to {slab.right:g} m) runs"
        f" through opening {number} (x = {hole.left:g} to {hole.right:g} m, z ="
        f" {course * hole.first:.4g} to {course * hole.above:.4g} m): the slab is built. Move one"
        " of them, unless this is meant"
        for slab in plan.slabs
        for number, hole in enumerate(plan.openings, start=1)
        if min(slab.right, hole.right) - max(slab.left, hole.left) > _SAME
        and slab.first < hole.above
        and hole.first < slab.above
    ]


def warn_of_apex(joint):
    """Warning of a damage.Joint whose tensile strength never acts: a list of at most one line."""
    if not joint.is_beyond_apex:
        return []
    apex = joint.cohesion / tan(joint.friction_angle)
    return [
        f"the tensile strength of joints, {joint.tensile_strength / 1e6:.4g} MPa, never acts: bonds"
        f" fail in shear at a tension of {apex / 1e6:.4g} MPa, cohesion / tan(friction angle); give"
        " a lower one, or more cohesion"
    ]


def describe_floors(plan):
    """Lines on the floors of a Plan, upwards: kind, level and length as laid, mass."""
    return [
        f"{floor.kind} floor at {above * plan.wall.brick.height:.4g} m, x = {left:.4g} to"
        f" {right:.4g} m: {floor.mass / 1e3:.3g} t"
        + (
            f" ({floor.mass_per_area:g} kg/m2 over {floor.tributary_width:g} m)"
            if floor.mass_per_area
            else ""
        )
        for floor, left, right, _, above in sorted(plan.floors, key=lambda place: place.floor.level)
    ]


def describe_lintels(plan):
    """Lines on the lintels of a Plan that are bodies, from left to right: kind, place as laid, and
    section or number of bricks."""
    course = plan.wall.brick.height
    lines = []
    for place in plan.lintels:
        what = (
            f"{place.parts} bricks on end, {place.height:.3g} m high"
            if place.lintel.kind == "arch"
            else (
                f"{place.width:.3g} x {place.height:.3g} m, modulus"
                f" {place.lintel.value_of('modulus') / 1e9:.3g} GPa"
            )
        )
        lines.append(
            f"{place.lintel.kind} lintel at {place.first * course:.4g} m, x = {place.left:.4g} to "
            f"{place.right:.4g} m: {what}"
        )
    return lines


def replaced_lintels(wall, option):
    """What the option `lintel` of a run replaces in a damage.Wall: a list of at most one line."""
    built = wall.with_lintels(option)
    replaced = [
        f"opening {number} {wall.lintel_of(opening).kind}"
        for number, (opening, other) in enumerate(zip(wall.openings, built.openings), start=1)
        if wall.lintel_of(opening) != built.lintel_of(other)
    ]
    if not replaced:
        return []
    return [f"--lintel {option} in place of the lintels of wall {wall.name}: {', '.join(replaced)}"]


def caps(x, length, mass, thickness):
    """[{"left_m", "right_m", "mass_kg", "stress_pa"}] of caps by their centres [m], lengths [m] and
    masses [kg].

    thickness [m]: of the wall; stress: that of their weight on what lies under them.

    >>> caps([0.5], [1.0], [1000.0], 0.1)
    [{'left_m': 0.0, 'right_m': 1.0, 'mass_kg': 1000.0, 'stress_pa': 98100.0}]
    """
    return [
        {
            "left_m": float(place - long / 2),
            "right_m": float(place + long / 2),
            "mass_kg": float(heavy),
            "stress_pa": float(heavy * GRAVITY / (long * thickness)),
        }
        for place, long, heavy in zip(x, length, mass)
    ]


def describe_cap(cap):
    """A cap in one line.

    >>> describe_cap({"left_m": 0.0, "right_m": 1.0125, "mass_kg": 6350.0, "stress_pa": 6e5})
    'rigid top mass from x = 0 to 1.0125 m: 6.35 t, 0.6 MPa below it'
    """
    left = cap["left_m"]
    right = cap["right_m"]
    return (
        f"rigid top mass from x = {left:.5g} to {right:.5g} m: {cap['mass_kg'] / 1e3:.3g} t, "
        f"{cap['stress_pa'] / 1e6:.3g} MPa below it"
    )


def describe_top(layout):
    """Lines on a damage.wall.layout.Layout: the stress in its piers by the load on top, each cap
    and restraint."""
    options = layout.options
    bodies = layout.bodies
    wall = layout.wall
    restraints = [restraint.describe(layout.top_mass) for restraint in wall.restraints]
    if layout.top_mass == 0:
        return ["no mass on top: no precompression", *restraints]
    on_top = (bodies.course == CAP_COURSE) & (top_of(wall) is None)
    over = "the length of the wall" if options.load == "length" else "the piers alone"
    places = ", ".join(f"{left:.5g} to {right:.5g} m" for left, right in layout.plan.piers)
    return [
        (
            f"top: {layout.top_mass / 1e3:.3g} t ({wall.precompression / 1e6:g} MPa over {over}), "
            f"{layout.pier_stress / 1e6:.3g} MPa in the piers below, x = {places}"
        ),
        *map(
            describe_cap,
            caps(
                bodies.x[on_top], bodies.length[on_top], bodies.mass[on_top], wall.brick.thickness
            ),
        ),
        *restraints,
    ]
