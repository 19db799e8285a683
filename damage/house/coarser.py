"""A wall in larger units: the same wall in fewer bodies, for many runs.

A unit stands for a by b bricks, along the wall and upwards.  The compliance of the wall along and
across its courses is kept, per length: with c = 1/k of a joint and s = 1/E of bricks of l by h,

    c' + b h s' = b (c + h s)        a stack of b courses
    c' + a l s' = a (c + l s)        a row of a bricks

of which follow c' = a b (l - h) c / (a l - b h) and s' = s + (a - b) c / (a l - b h); the same in
shear, of k_s and G.  With a = b bricks keep their moduli and c' = a c.  Mass, strengths and
fracture energies per area stay.

What changes: cracks are as far apart as units are long and run up in steps of b h by a l / 2, which
are steeper than those of the bond where b > a; a softer stiffness of a joint with the same energy
leaves less of it beyond the peak; openings, floors and outlines lie on higher courses.
"""

import math
from dataclasses import replace

from damage.errors import InputError
from damage.wall.parameters import nearest
from damage.wall.plan import plan_of


def in_units(wall, units):
    """A damage.Wall, or each wall of a House, in units of so many bricks and courses (2,)."""
    return wall.with_each(lambda one: coarser(one, *units))


def coarser(wall, along, up):
    """The damage.Wall in units of `along` bricks by `up` courses, whole numbers.

    Courses get higher or lower by so much that a whole number of them has the wall's height.
    Raises InputError for units that no joints or bricks would suit, and, with its place, for what
    cannot be built of them.
    """
    if (along, up) == (1, 1):
        return wall
    brick = wall.brick
    course = wall.built_height / max(1, nearest(wall.courses / up))
    size = f"units of {along * brick.length:.4g} x {course:.4g} m"
    joint = {}
    bricks = {}
    for stiffness, modulus in (
        ("normal_stiffness", "young_modulus"),
        ("shear_stiffness", "shear_modulus"),
    ):
        joint[stiffness], bricks[modulus] = _equivalent(
            wall, along, course / brick.height, stiffness, modulus, size
        )
    try:
        coarse = replace(
            wall,
            brick=replace(brick, length=along * brick.length, height=course, **bricks),
            joint=replace(wall.joint, **joint),
            lintel=_as_high(wall.lintel, brick),
            openings=tuple(
                replace(opening, lintel=opening.lintel and _as_high(opening.lintel, brick))
                for opening in wall.openings
            ),
        )
        _check_spandrels(coarse)
        return coarse
    except InputError as error:
        raise InputError(f"in {size}: {error}; or give smaller units") from error


def _equivalent(wall, along, up, stiffness, modulus, size):
    """Stiffness of a Joint and modulus of a Brick, fields of these names, of the units; up: in
    courses, not always a whole number."""
    brick = wall.brick
    joint = 1 / getattr(wall.joint, stiffness)
    of_brick = 1 / getattr(brick, modulus)
    least = 1e-3
    if math.isclose(along, up):
        return 1 / (along * joint), 1 / of_brick
    excess = along * brick.length - up * brick.height
    share = (brick.length - brick.height) / excess if excess else -1.0
    softer = of_brick + (along - up) * joint / excess if excess else -1.0
    if share <= 0 or softer < least * of_brick:
        raise InputError(
            f"wall {wall.name} in {size}: no {stiffness.replace('_', ' ')} and"
            f" {modulus.replace('_', ' ')} keep the wall as stiff along and across its courses:"
            " expected units longer than high, or as many bricks long as courses high; give others"
        )
    return 1 / (along * up * share * joint), 1 / softer


def _check_spandrels(wall):
    """InputError for an opening below a single course without a lintel: head joints of one contact
    point would be hinges."""
    for number, opening in enumerate(plan_of(wall).openings, 1):
        if opening.spandrel - opening.above == 1 and not opening.lintel.is_body:
            raise InputError(
                f"wall {wall.name}, opening {number} (x {opening.left:g} to {opening.right:g} m):"
                " one course above it, which bears nothing without a lintel: expected two courses,"
                " or a lintel; give one"
            )


def _as_high(lintel, brick):
    """A Lintel as high and with the bearing that it has in a wall of these bricks, where these
    follow from them: an arch's."""
    if lintel.kind != "arch":
        return lintel
    height, _, bearing = lintel.built(brick)
    return replace(lintel, height=height, bearing=bearing)
