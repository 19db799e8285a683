"""Floors and roofs that rest on a wall: masses on its courses, or slabs that tie its piers.

A timber floor is mass on the bricks of the course below its level, by the length of each that it covers, with its
resultant in the middle of what it covers; it neither ties nor stiffens.  A concrete floor is one rigid body in place of
the courses below its level, joined to the bricks under and above it by bed joints like any other; its ends do not touch
the bricks beside them.  Both have their weight.
"""

from dataclasses import dataclass, replace

import numpy as np

from damage.errors import InputError
from damage.wall.fields import check_fields, choice, quantity

KINDS_OF_FLOORS = ("timber", "concrete")
SLAB_COURSE = -2
"""`course` of a slab, beside -1 of a top mass."""
_TINY = 1e-6  # [m]


@dataclass(frozen=True)
class Floor:
    """A floor or roof.

    level [m]: of its top, laid to the nearest bed joint; mass [kg]: of all that it brings to this wall, with its
    weight; left, right [m]: of the part of the wall that it rests on, right None for the wall's end; kind: "timber" or
    "concrete" (`damage.wall.floors`); depth [m]: of a concrete slab, laid to whole courses.
    """

    level: float = quantity("m", 1e-3, 1000.0, (0.03, 50), "on the base course; a tower")
    mass: float = quantity("kg", 1e-3, 1e8, (1, 1e6), "a shelf; the floor of a hall")
    left: float = quantity("m", 0.0, 1000.0, default=0.0)
    right: float | None = quantity("m", 0.0, 1000.0, default=None)
    kind: str = choice(KINDS_OF_FLOORS, default="timber")
    depth: float = quantity("m", 1e-3, 10.0, (0.01, 2), "a screed; a transfer slab", default=0.15)

    def __post_init__(self):
        check_fields(self)

    def span(self, wall):
        """Left and right end on a wall [m]."""
        return self.left, wall.length if self.right is None else self.right

    def courses(self, wall):
        """The first course that it rests in or on, and the first above it."""
        above = round(self.level / wall.brick.height)
        return above - (max(1, round(self.depth / wall.brick.height)) if self.kind == "concrete" else 1), above


def check_floors(wall):
    """Raise InputError for floors outside the wall, over each other, or with nothing below them."""
    for number, floor in enumerate(wall.floors, start=1):
        (left, right), (first, above) = floor.span(wall), floor.courses(wall)
        what = f"wall {wall.name}, floor {number} (x {left:g} to {right:g} m, level {floor.level:g} m)"
        if first < (floor.kind == "concrete") or above > wall.courses:
            raise InputError(f"{what} takes courses {first + 1} to {above} of {wall.courses}: expected a level with a "
                             "course below it and not above the wall; correct the level")
        if right > wall.length + _TINY or right - left < wall.brick.length / 2 - _TINY:
            raise InputError(f"{what}: expected half a brick ({wall.brick.length / 2:g} m) or more inside the wall of "
                             f"{wall.length:g} m; correct left and right")
        for other in wall.floors[:number - 1]:
            if "concrete" in (floor.kind, other.kind) and _overlap(wall, floor, other):
                raise InputError(f"{what} lies in the same courses as another floor, and one of them is concrete: "
                                 "expected floors apart; move one, or join them")


def _overlap(wall, floor, other):
    """Whether two floors share courses and length."""
    (left, right), (first, above) = floor.span(wall), floor.courses(wall)
    (other_left, other_right), (other_first, other_above) = other.span(wall), other.courses(wall)
    return (min(right, other_right) - max(left, other_left) > _TINY
            and min(above, other_above) - max(first, other_first) > 0)


def slabs(wall):
    """The concrete floors of a wall, a list."""
    return [floor for floor in wall.floors if floor.kind == "concrete"]


def with_timber_floors(wall, bodies, first, last):
    """Bodies with the masses of timber floors on their bricks and lintels, inertia growing with mass; first, last:
    courses that each takes (n_bodies,)."""
    more = np.zeros(len(bodies))
    for floor in wall.floors:
        if floor.kind == "timber":
            course = floor.courses(wall)[0]
            on = (first <= course) & (course <= last) & (bodies.course != SLAB_COURSE)
            more[on] += floor.mass * _shares(bodies.x[on], bodies.length[on], *floor.span(wall))
    if not more.any():  # bit for bit as without
        return bodies
    factor = 1 + more / bodies.mass
    return replace(bodies, mass=bodies.mass * factor, inertia=bodies.inertia * factor)


def _shares(x, length, left, right):
    """Shares of a load from `left` to `right` that bricks carry by the length of each that it covers, with a part that
    grows along the wall so that they have the load's resultant in its place: bricks act at their middles."""
    start, end = np.maximum(x - length / 2, left), np.minimum(x + length / 2, right)
    covered = np.maximum(end - start, 0.0)
    share = covered / covered.sum()
    middle, away = share @ x, share @ ((start + end) / 2 - x)
    spread = share @ (x - middle)**2
    return share * (1 + away / spread * (x - middle)) if spread > _TINY**2 else share


def slab_bodies(wall):
    """{field: values} of the slabs of a wall as bodies, in the order of the floors."""
    found = [(*floor.span(wall), *floor.courses(wall), floor.mass) for floor in slabs(wall)]
    left, right, first, above, mass = np.array(found, dtype=float).reshape(-1, 5).T
    length, height = right - left, (above - first) * wall.brick.height
    return {"x": (left + right) / 2, "z": (first + above) / 2 * wall.brick.height, "length": length, "height": height,
            "mass": mass, "inertia": mass * (length**2 + height**2) / 12, "course": np.full(len(mass), SLAB_COURSE)}


def describe_floors(wall):
    """Lines on the floors of a wall, upwards: kind, level and length as laid, mass."""
    lines = []
    for floor in sorted(wall.floors, key=lambda one: one.level):
        left, right = floor.span(wall)
        lines.append(f"{floor.kind} floor at {floor.courses(wall)[1] * wall.brick.height:.4g} m, x = {left:.4g} to "
                     f"{right:.4g} m: {floor.mass / 1e3:.3g} t")
    return lines
