"""Floors and roofs that rest on a wall: masses on its courses, or slabs that tie its piers.

A timber floor is mass on the bricks of the course below its level, by the length of each that it
covers, with its resultant in the middle of what it covers; it neither ties nor stiffens.  A
concrete floor is one rigid body in place of the courses below its level, joined to the bricks under
and above it by bed joints like any other; its ends do not touch the bricks beside them.  Both have
their weight.
"""

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from damage.errors import InputError
from damage.fields import check_fields, choice, quantity
from damage.wall.kinds import SLAB_COURSE, TINY

KINDS_OF_FLOORS = ("timber", "concrete")


@dataclass(frozen=True)
class Floor:
    """A floor or roof.

    level [m]: of its top, laid to the nearest bed joint; mass [kg]: of all that it brings to this
    wall, with its weight; or mass_per_area [kg/m2] and tributary_width [m], across the wall: half
    of the span on each side that bears on it, from which `on` works out the mass; left, right [m]:
    of the part of the wall that it rests on, right None for the wall's end; kind: "timber" or
    "concrete" (`damage.wall.floors`); depth [m]: of a concrete slab, laid to whole courses.

    >>> from damage.wall.parameters import Wall
    >>> floor = Floor(2.7, mass_per_area=300.0, tributary_width=2.0, kind="concrete")
    >>> wall = Wall("front", 4.0, 3.0, floors=[floor])
    >>> wall.floors[0].mass, floor.span(wall), floor.courses(wall), floor.is_body  # [kg], [m]
    (2400.0, (0.0, 4.0), (34, 36), True)
    """

    level: float = quantity("m", 1e-3, 1000.0, (0.03, 50), "on the base course; a tower")
    mass: float | None = quantity(
        "kg", 1e-3, 1e8, (1, 1e6), "a shelf; the floor of a hall", default=None
    )
    left: float = quantity("m", 0.0, 1000.0, default=0.0)
    right: float | None = quantity("m", 0.0, 1000.0, default=None)
    kind: str = choice(KINDS_OF_FLOORS, default="timber")
    depth: float = quantity("m", 1e-3, 10.0, (0.01, 2), "a screed; a transfer slab", default=0.15)
    mass_per_area: float | None = quantity(
        "kg/m2",
        1e-2,
        1e5,
        (10, 3000),
        "boards on joists have some 30; a store on thick concrete",
        default=None,
    )
    tributary_width: float | None = quantity(
        "m", 1e-3, 1000.0, (0.1, 20), "a landing; half the span of a hall", default=None
    )

    def __post_init__(self):
        check_fields(self)
        if (self.mass_per_area is None) != (self.tributary_width is None):
            raise InputError(
                f"Floor at {self.level:g} m with mass_per_area = {self.mass_per_area} kg/m2 and "
                f"tributary_width = {self.tributary_width} m: expected both; give the other one"
            )
        if self.mass is None and self.mass_per_area is None:
            raise InputError(
                f"Floor at {self.level:g} m without a mass: expected mass [kg], or mass_per_area"
                " [kg/m2] and tributary_width [m]; give one of them"
            )

    def on(self, wall) -> "Floor":
        """This floor with its mass on a wall.  Raises InputError where that is given, too, and
        differs."""
        if self.mass_per_area is None or self.tributary_width is None:
            return self
        left, right = self.span(wall)
        mass = self.mass_per_area * self.tributary_width * (right - left)
        if self.mass is not None and abs(self.mass - mass) > 1e-6 * mass:
            raise InputError(
                f"wall {wall.name}, floor at {self.level:g} m: mass = {self.mass:g} kg, but"
                f" {self.mass_per_area:g} kg/m2 on {right - left:g} x {self.tributary_width:g} m"
                f" are {mass:g} kg; expected one of them; leave the other out"
            )
        return replace(self, mass=mass)

    @property
    def is_body(self) -> bool:
        """Whether it is a body of its own, a slab."""
        return self.kind == "concrete"

    def span(self, wall) -> tuple[float, float]:
        """Left and right end on a wall [m]."""
        return self.left, wall.length if self.right is None else self.right

    def courses(self, wall) -> tuple[int, int]:
        """The first course that it rests in or on, and the first above it."""
        above = round(self.level / wall.brick.height)
        return above - (max(1, round(self.depth / wall.brick.height)) if self.is_body else 1), above


class FloorPlace(NamedTuple):
    """A floor in a wall: its ends [m], the first course that it rests in or on, and the first above
    it."""

    floor: Floor
    left: float
    right: float
    first: int
    above: int


def floor_places(wall) -> tuple[FloorPlace, ...]:
    """The FloorPlace of every floor of a wall, in their order.

    >>> from damage.wall.parameters import Wall
    >>> floor_places(Wall("pier", 0.9, 1.5))
    ()
    """
    return tuple(
        FloorPlace(floor, *floor.span(wall), *floor.courses(wall)) for floor in wall.floors
    )


def check_floors(wall) -> None:
    """Raise InputError for floors outside the wall, over each other, or with nothing below them."""
    places = floor_places(wall)
    for number, place in enumerate(places, start=1):
        floor, left, right, first, above = place
        what = (
            f"wall {wall.name}, floor {number} (x {left:g} to {right:g} m, level {floor.level:g} m)"
        )
        if first < floor.is_body or above > wall.courses:
            raise InputError(
                f"{what} takes courses {first + 1} to {above} of {wall.courses}: expected a level"
                " with a course below it and not above the wall; correct the level"
            )
        if right > wall.length + TINY or right - left < wall.brick.length / 2 - TINY:
            raise InputError(
                f"{what}: expected half a brick ({wall.brick.length / 2:g} m) or more inside the"
                f" wall of {wall.length:g} m; correct left and right"
            )
        for other in places[: number - 1]:
            if (floor.is_body or other.floor.is_body) and _overlap(place, other):
                raise InputError(
                    f"{what} lies in the same courses as another floor, and one of them is"
                    " concrete: expected floors apart; move one, or join them"
                )


def _overlap(first, second):
    """Whether two FloorPlaces share courses and length."""
    return (
        min(first.right, second.right) - max(first.left, second.left) > TINY
        and min(first.above, second.above) - max(first.first, second.first) > 0
    )


def with_timber_floors(plan, bodies):
    """Bodies below the caps of a damage.wall.plan.Plan with the masses of timber floors on bricks
    and lintels, inertia growing with mass."""
    more = np.zeros(len(bodies))
    (first, last) = plan.taken
    for floor, left, right, course, _ in plan.floors:
        if not floor.is_body:
            on = (first <= course) & (course <= last) & (bodies.course != SLAB_COURSE)
            more[on] += floor.mass * _shares(bodies.x[on], bodies.length[on], left, right)
    if not more.any():  # bit for bit as without
        return bodies
    factor = 1 + more / bodies.mass
    return replace(bodies, mass=bodies.mass * factor, inertia=bodies.inertia * factor)


def _shares(x, length, left, right):
    """Shares of a load from `left` to `right` that bricks carry by the length of each that it
    covers, with a part that grows along the wall so that they have the load's resultant in its
    place: bricks act at their middles."""
    start = np.maximum(x - length / 2, left)
    end = np.minimum(x + length / 2, right)
    covered = np.maximum(end - start, 0.0)
    share = covered / covered.sum()
    middle = np.sum(share * x)
    away = np.sum(share * ((start + end) / 2 - x))
    spread = np.sum(share * (x - middle) ** 2)
    return share * (1 + away / spread * (x - middle)) if spread > TINY**2 else share
