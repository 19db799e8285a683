"""The plan of a wall: what it consists of, worked out once and handed on to all that lay out, check
or describe it.

An outline is the line of a wall's top, from its left to its right end.  A course is built where the
outline lies above the middle of its height, so that a sloped edge keeps its area.  Bricks are
rectangles: where the outline slopes, a course ends at the nearest quarter of a brick of the bond,
inwards where two are as near; at vertical steps it ends as given.  Parts shorter than half a brick
are not built.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import chain, combinations, pairwise
from typing import Any, NamedTuple

import numpy as np

from damage.errors import InputError
from damage.wall.floors import FloorPlace, floor_places
from damage.wall.kinds import TINY
from damage.wall.lintels import Lintel, LintelPlace, edges_of
from damage.wall.model_options import ModelOptions
from damage.wall.restraints import top_of


class OpeningPlace(NamedTuple):
    """An opening in a wall: its ends [m], its first course and the first above it, the first course
    above its spandrel, which ends at the sill of the next opening above, at the next slab, or at
    the wall's top, and its lintel."""

    left: float
    right: float
    first: int
    above: int
    spandrel: int
    lintel: Lintel


@dataclass(frozen=True)
class Plan:
    """What a wall consists of.

    wall: with the lintels that are built (`damage.Wall.with_lintels`).
    openings, floors, lintels: their places, in the wall's order; lintels that are bodies, from left
    to right.
    runs: parts (left, right) [m] of each course that are of bricks, upwards and from left to right:
        below the outline, beside openings, slabs and lintels; bricks: the edges of the bricks of
        each course, in the same way.
    piers: parts (left, right) [m] of the length that carry the top.
    drift_course: whose displacement is the wall's drift: the highest that the outline leaves at
        least half as long as the wall, or the base course; the top course of a wall without an
        outline; that at mid-height where a restraint holds the top.

    >>> from damage.wall.parameters import Floor, Wall
    >>> plan = plan_of(Wall("pier", 0.9, 1.5, floors=[Floor(1.2, 500.0, kind="concrete")]))
    >>> plan.n_bricks, plan.piers, [slab.above for slab in plan.slabs]  # bricks, [m], courses
    (81, ((0.0, 0.9),), [16])
    """

    wall: Any
    openings: tuple[OpeningPlace, ...]
    floors: tuple[FloorPlace, ...]
    lintels: tuple[LintelPlace, ...]
    runs: tuple[tuple[tuple[float, float], ...], ...]
    bricks: tuple[tuple[tuple[float, float], ...], ...]
    piers: tuple[tuple[float, float], ...]
    drift_course: int

    @property
    def slabs(self) -> list[FloorPlace]:
        """Places of the floors that are bodies, a list."""
        return [place for place in self.floors if place.floor.is_body]

    @property
    def n_bricks(self) -> int:
        """Number of bricks."""
        return sum(map(len, self.bricks))

    @cached_property
    def taken(self) -> np.ndarray:
        """First and last course that each brick, slab and part of a lintel takes, (2, n) in the
        order of bodies."""
        places = [(course, course + 1, len(bricks)) for course, bricks in enumerate(self.bricks)]
        places += [(slab.first, slab.above, 1) for slab in self.slabs]
        places += [(place.first, place.above, place.parts) for place in self.lintels]
        first, above, number = np.array(places).T
        return np.repeat([first, above - 1], number, axis=1)

    @cached_property
    def ends(self) -> np.ndarray:
        """Left and right end [m] of each of these, (2, n)."""
        return np.array(
            [
                *chain(*self.bricks),
                *((slab.left, slab.right) for slab in self.slabs),
                *chain(*(pairwise(place.edges) for place in self.lintels)),
            ]
        ).T

    def bears(self, course: int) -> list[tuple[float, float]]:
        """Parts (left, right) [m] of a course that bear what lies on it: bricks, slabs and
        lintels."""
        places: list[FloorPlace | LintelPlace] = [*self.slabs, *self.lintels]
        return [
            *self.runs[course],
            *((place.left, place.right) for place in places if place.first <= course < place.above),
        ]

    @property
    def rests(self) -> Iterator[tuple]:
        """What bears what: ((left, right) [m] of a part of bricks, a slab or a lintel with a
        bearing, its first course, and the parts (left, right) [m] below that bear it), upwards;
        what starts at the base left out."""
        borne: list[FloorPlace | LintelPlace] = [
            *self.slabs,
            *(place for place in self.lintels if place.lintel.bearing != 0),
        ]
        for course in range(1, len(self.runs)):
            below = self.bears(course - 1)
            for part in (
                *self.runs[course],
                *((place.left, place.right) for place in borne if place.first == course),
            ):
                yield part, course, below


def plan_of(wall, options: ModelOptions | None = None) -> Plan:
    """The Plan of a damage.Wall under ModelOptions, whose `lintel` says which lintels are built;
    None: as given.

    >>> from damage.wall.parameters import Wall
    >>> len(plan_of(Wall("pier", 0.9, 1.5)).runs)
    20
    """
    wall = wall if options is None else wall.with_lintels(options.lintel)
    floors = floor_places(wall)
    brick = wall.brick
    slabs = [place for place in floors if place.floor.is_body]
    openings = _opening_places(wall, slabs)
    outlined = [outlined_runs(wall, course) for course in range(wall.courses)]
    holes = [*openings, *slabs]
    lintels = _lintel_places(brick, openings, _beside_all(outlined, holes, brick.length / 2))
    runs = _beside_all(outlined, [*holes, *lintels], brick.length / 2)
    offsets = [
        brick.length / 2 if (course % 2 == 1) != (wall.base_course == "half") else 0.0
        for course in range(wall.courses)
    ]
    bricks = tuple(
        tuple(chain(*(_lay_run(brick.length, offset, *run) for run in parts)))
        for parts, offset in zip(runs, offsets)
    )
    least = wall.length / 2 - TINY
    drift_course = max(
        (
            course
            for course, parts in enumerate(outlined)
            if math.fsum(right - left for left, right in parts) > least
        ),
        default=0,
    )
    if top_of(wall):
        drift_course = wall.courses // 2
    return Plan(
        wall=wall,
        openings=openings,
        floors=floors,
        lintels=lintels,
        runs=runs,
        bricks=bricks,
        piers=_find_piers(wall.length, openings),
        drift_course=drift_course,
    )


def _opening_places(wall, slabs):
    """The OpeningPlace of every opening, in their order; a slab on an opening is its lintel."""
    places = [
        OpeningPlace(
            opening.left,
            opening.right,
            *wall.opening_courses(opening),
            spandrel=wall.courses,
            lintel=wall.lintel_of(opening),
        )
        for opening in wall.openings
    ]
    others = [*places, *slabs]
    return tuple(
        place._replace(
            spandrel=min(
                (
                    max(other.first, place.above)
                    for other in others
                    if other is not place
                    and (
                        other.left < place.right
                        and other.right > place.left
                        and other.above >= place.above
                    )
                ),
                default=wall.courses,
            )
        )
        for place in places
    )


def _find_piers(length, openings):
    """Piers that carry the top: parts of the length without an opening of the top storey, left to
    right.

    The top storey's openings are those between the top and the first full course below an opening.
    Over those farther down stands a pier, or a full course and all above it, which carry.
    """
    storey = []
    sill = np.inf
    for opening in sorted(openings, key=lambda place: -place.above):
        if storey and opening.above < sill:
            break
        sill = min(sill, opening.first)
        storey.append(opening._replace(first=0, above=1))
    return _beside_all([[(0.0, length)]], storey, 2 * TINY)[0]


def _lintel_places(brick, openings, runs):
    """The LintelPlace of every lintel that is a body, from left to right; runs: parts of each
    course without them.

    A lintel takes the courses above its opening up to the end of the spandrel, and its bearing on
    both sides; where less than half a brick would be left beside it, it reaches to the end of that
    part of the course, or meets the lintel that is there.
    """
    length = brick.length
    places = []  # without edges
    below = []  # the openings of these
    for opening in sorted(openings, key=lambda place: (place.left, place.first)):
        lintel = opening.lintel
        wanted = lintel.courses(brick) if lintel.is_body else 0
        first = opening.above
        above = min(opening.spandrel, first + wanted)
        run = _common_run(runs[first:above], (opening.left + opening.right) / 2)
        if run is None:
            continue
        height, width, bearing = lintel.built(brick)
        if above - first < wanted or lintel.kind == "arch":
            height = (above - first) * brick.height
        places.append(
            LintelPlace(
                lintel,
                left=_bearing_end(length, opening.left, -bearing, run[0]),
                right=_bearing_end(length, opening.right, bearing, run[1]),
                first=first,
                above=above,
                edges=(),
                height=height,
                width=width,
            )
        )
        below.append(opening)
    for k, m in combinations(range(len(places)), 2):
        start = below[k].right
        end = below[m].left
        shares = min(places[k].above, places[m].above) > max(places[k].first, places[m].first)
        if shares and start < end and places[m].left - places[k].right < length / 2 - TINY:
            middle = _on_quarters(length, (start + end) / 2)
            places[k] = places[k]._replace(right=middle)
            places[m] = places[m]._replace(left=middle)
    near = sorted({x for place in openings for x in (place.left, place.right)})
    return tuple(
        place._replace(edges=edges_of(place.lintel, brick, place.left, place.right, near))
        for place in places
    )


def _common_run(courses, x):
    """The part (left, right) [m] around x that the runs of all these courses have; None without
    any."""
    runs = [next((run for run in runs if run[0] < x < run[1]), None) for runs in courses]
    return (
        None
        if not runs or None in runs
        else (max(run[0] for run in runs), min(run[1] for run in runs))
    )


def _bearing_end(length, edge, bearing, end):
    """End of a lintel [m] beyond an opening's edge, on the bond's quarters of bricks of this
    length, or that of its part of the course where less than half a brick would be left beside
    it."""
    if not bearing:
        return edge
    x = _on_quarters(length, edge + bearing)
    side = np.sign(bearing)
    if (x - edge) * side < length / 8:
        x += side * length / 4
    return end if (end - x) * side < length / 2 - TINY else x


def _on_quarters(length, x):
    """The nearest multiple of a quarter of a brick of this length [m]."""
    return float(round(x / (length / 4)) * (length / 4))


def outlined_runs(wall, course: int) -> list[tuple[float, float]]:
    """Parts (left, right) [m] of a course below the wall's outline, openings left in."""
    if not wall.outline:
        return [(0.0, wall.length)]
    middle = (course + 0.5) * wall.brick.height
    ends = []  # (x, whether the outline slopes there), left and right in turn
    for (x, z), (next_x, next_z) in pairwise(wall.outline):
        inside = z > middle - TINY
        stays = next_z > middle - TINY
        if inside and not ends:
            ends.append((x, False))
        if inside != stays:
            share = min(max((middle - z) / (next_z - z), 0.0), 1.0)
            ends.append((x + share * (next_x - x), next_x - x > TINY))
    if len(ends) % 2:
        ends.append((wall.outline[-1][0], False))
    quarter = wall.brick.length / 4
    edges = [
        _snapped(x, quarter, is_left=not number % 2) if slopes else x
        for number, (x, slopes) in enumerate(ends)
    ]
    return [
        (left, right)
        for left, right in zip(edges[::2], edges[1::2])
        if right - left > wall.brick.length / 2 - TINY
    ]


def _snapped(x, quarter, is_left):
    """The nearest quarter of a brick, of two equally near ones that inside the wall."""
    near = np.floor(x / quarter + 0.5 + TINY) if is_left else np.ceil(x / quarter - 0.5 - TINY)
    return float(near * quarter)


def _beside_all(courses, holes, half):
    """Parts (left, right) [m] that holes, places of openings, slabs and lintels, leave of these
    parts of each course, if they are half a brick long or more."""
    beside = []
    for course, parts in enumerate(courses):
        left_over = parts
        for hole in holes:
            if hole.first <= course < hole.above:
                left_over = [
                    part
                    for left, right in left_over
                    for part in ((left, min(right, hole.left)), (max(left, hole.right), right))
                    if part[1] > part[0]
                ]
        beside.append(
            tuple((left, right) for left, right in left_over if right - left > half - TINY)
        )
    return tuple(beside)


def _lay_run(length, offset, left, right):
    """Edges (left, right) [m] of bricks between two free ends, cut where the bond of the whole wall
    meets the ends; length: of a brick, offset: of the bond's head joints from the wall's left end
    [m].

    A piece shorter than a quarter brick is not laid: its head joint moves a quarter brick inwards,
    which keeps a quarter brick of overlap with the courses above and below.
    """
    first = int(np.floor((left - offset + TINY) / length)) + 1
    last = int(np.ceil((right - offset - TINY) / length)) - 1
    joints = [offset + k * length for k in range(first, last + 1)]
    quarter = length / 4 - TINY
    if joints and joints[0] - left < quarter:
        joints[0] += length / 4
    if joints and right - joints[-1] < quarter:
        joints[-1] -= length / 4
        if joints[-1] - left < quarter:
            joints.pop()
    return list(pairwise([left, *joints, right]))


def check_outline(wall) -> None:
    """Raise InputError for an outline that is none, or whose wall has bricks in the air."""
    outline = wall.outline
    what = f"Wall.outline of {wall.name}"
    if len(outline) < 2 or abs(outline[0][0]) > 1e-9 or abs(outline[-1][0] - wall.length) > 1e-9:
        raise InputError(
            f"{what} from {_point(outline[:1])} to {_point(outline[-1:])}: expected at least two"
            f" points, the first at x = 0 and the last at x = {wall.length:g} m; add them"
        )
    for first, second in pairwise(outline):
        if second[0] < first[0]:
            raise InputError(
                f"{what} runs back from {_point([first])} to {_point([second])}: expected points"
                " from left to right; order them"
            )
    lowest = min(z for _, z in outline)
    highest = max(z for _, z in outline)
    if lowest < 0 or abs(highest - wall.height) > 1e-6:
        raise InputError(
            f"{what} is {lowest:g} to {highest:g} m high: expected 0 or more and Wall.height = "
            f"{wall.height:g} m at the highest point; correct one of them"
        )
    if wall.precompression > 0:
        raise InputError(
            f"{what} with a precompression of {wall.precompression:g} Pa, which needs a level top: "
            "expected none; give precompression=0, and masses by Wall.floors"
        )
    if not outlined_runs(wall, 0):
        raise InputError(
            f"{what} leaves no brick in the base course: expected half a brick or more; make it"
            " higher"
        )


def check_bearing(plan: Plan) -> None:
    """Raise InputError where a part of a course, or a slab, has nothing below one of its ends, or a
    timber floor no brick."""
    wall = plan.wall
    eighth = plan.wall.brick.length / 8
    for (left, right), course, below in plan.rests:
        free = [
            x
            for x in (left + eighth, right - eighth)
            if not any(start < x < end for start, end in below)
        ]
        if free:
            raise InputError(
                f"wall {wall.name}: course {course + 1} from x = {left:g} to {right:g} m has"
                f" nothing below it at x = {free[0]:.4g} m: expected a bearing at both ends; move"
                " the opening there, or let it reach the top"
            )
    for floor, left, right, course, _ in plan.floors:
        if not floor.is_body and not any(
            min(right, end) - max(left, start) > TINY for start, end in plan.bears(course)
        ):
            raise InputError(
                f"wall {wall.name}, floor at {floor.level:g} m from x = {left:g} to {right:g} m has"
                " no brick below it: expected a part of a course; move it, or the opening"
            )


def _point(points):
    return f"({points[0][0]:g}, {points[0][1]:g}) m" if points else "no point"
