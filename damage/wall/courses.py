"""Which parts of each course are built, below the wall's outline and beside its openings; their bricks and lintels.

An outline is the line of a wall's top, from its left to its right end.  A course is built where the outline lies above
the middle of its height, so that a sloped edge keeps its area.  Bricks are rectangles: where the outline slopes, a
course ends at the nearest quarter of a brick of the bond, inwards where two are as near; at vertical steps it ends as
given.  Parts shorter than half a brick are not built.
"""

from functools import lru_cache
from itertools import pairwise

import numpy as np

from damage.errors import InputError
from damage.wall.floors import slabs
from damage.wall.lintel import lintel_courses
from damage.wall.lintels import Place, edges_of

_TINY = 1e-6  # [m], two positions closer than this are the same


def lay_course(wall, course):
    """Edges (left, right) [m] of the bricks of one course, left to right."""
    return [brick for run in built_runs(wall, course) for brick in _lay_run(wall, course, *run)]


def built_runs(wall, course):
    """Parts (left, right) [m] of a course that are of bricks, left to right: below the outline, beside the openings,
    slabs and lintels."""
    lintels = [((place.left, place.right), (place.first, place.above)) for place in lintel_places(wall)]
    return _runs(wall, course, sorted(_holes(wall) + lintels))


def _runs(wall, course, holes):
    """Parts of a course beside these holes that are half a brick long or more."""
    runs = outlined_runs(wall, course)
    for hole, (first, above) in holes:
        if first <= course < above:
            runs = [part for left, right in runs for part in _beside(hole, left, right)]
    return [(left, right) for left, right in runs if right - left > wall.brick.length / 2 - _TINY]


@lru_cache(maxsize=16)
def lintel_places(wall):
    """The damage.wall.lintels.Place of every lintel of a wall that is a body, from left to right.

    A lintel takes the courses above its opening up to what `damage.wall.lintel.lintel_courses` ends at, and its bearing
    on both sides; where less than half a brick would be left beside it, it reaches to the end of that part of the
    course, or meets the lintel that is there.
    """
    half, found = wall.brick.length / 2, []
    for opening in sorted(wall.openings, key=lambda one: (one.left, one.sill)):
        lintel = wall.lintel_of(opening)
        wanted = lintel.courses(wall.brick) if lintel.is_body else 0
        first, above = lintel_courses(wall, str(wanted) if wanted else "none", opening)
        run = _common_run(wall, range(first, above), (opening.left + opening.right) / 2)
        if run is None:
            continue
        height, width, bearing = lintel.built(wall.brick)
        left = _bearing_end(wall, opening.left, -bearing, run[0])
        right = _bearing_end(wall, opening.right, bearing, run[1])
        if above - first < wanted or lintel.kind == "arch":
            height = (above - first) * wall.brick.height
        found.append([lintel, left, right, first, above, opening, height, width])
    for one, other in ((one, other) for k, one in enumerate(found) for other in found[k + 1:]):
        apart = min(one[4], other[4]) <= max(one[3], other[3]) or one[5].right >= other[5].left
        if not apart and other[1] - one[2] < half - _TINY:
            one[2] = other[1] = _on_quarters(wall, (one[5].right + other[5].left) / 2)
    near = sorted({x for opening in wall.openings for x in (opening.left, opening.right)})
    return tuple(Place(lintel, left, right, first, above, edges_of(lintel, wall.brick, left, right, near), *section)
                 for lintel, left, right, first, above, _, *section in found)


def _common_run(wall, courses, x):
    """The part (left, right) [m] around x that all these courses have beside openings and slabs; None without any."""
    runs = [next((run for run in _runs(wall, course, _holes(wall)) if run[0] < x < run[1]), None) for course in courses]
    return None if not runs or None in runs else (max(run[0] for run in runs), min(run[1] for run in runs))


def _bearing_end(wall, edge, bearing, end):
    """End of a lintel [m] beyond an opening's edge, on the bond's quarters of bricks, or that of its part of the
    course where less than half a brick would be left beside it."""
    if not bearing:
        return edge
    x, side = _on_quarters(wall, edge + bearing), np.sign(bearing)
    if (x - edge) * side < wall.brick.length / 8:
        x += side * wall.brick.length / 4
    return end if (end - x) * side < wall.brick.length / 2 - _TINY else x


def _on_quarters(wall, x):
    """The nearest multiple of a quarter of a brick [m]."""
    return float(round(x / (wall.brick.length / 4)) * (wall.brick.length / 4))


def outlined_runs(wall, course):
    """Parts (left, right) [m] of a course below the wall's outline, openings left in."""
    if not wall.outline:
        return [(0.0, wall.length)]
    middle = (course + 0.5) * wall.brick.height
    ends = []  # (x, whether the outline slopes there), left and right in turn
    for (x, z), (next_x, next_z) in pairwise(wall.outline):
        inside, stays = z > middle - _TINY, next_z > middle - _TINY
        if inside and not ends:
            ends.append((x, False))
        if inside != stays:
            share = min(max((middle - z) / (next_z - z), 0.0), 1.0)
            ends.append((x + share * (next_x - x), next_x - x > _TINY))
    if len(ends) % 2:
        ends.append((wall.outline[-1][0], False))
    quarter = wall.brick.length / 4
    edges = [_snapped(x, quarter, is_left=not number % 2) if slopes else x for number, (x, slopes) in enumerate(ends)]
    return [(left, right) for left, right in zip(edges[::2], edges[1::2])
            if right - left > wall.brick.length / 2 - _TINY]


def drift_course(wall):
    """The course whose displacement is the wall's drift: the highest that the outline leaves at least half as long as
    the wall, or the base course; the top course of a wall without an outline."""
    least = wall.length / 2 - _TINY
    return max((course for course in range(wall.courses)
                if sum(right - left for left, right in outlined_runs(wall, course)) > least), default=0)


def check_outline(wall):
    """Raise InputError for an outline that is none, or whose wall has bricks in the air."""
    outline, what = wall.outline, f"Wall.outline of {wall.name}"
    if len(outline) < 2 or abs(outline[0][0]) > 1e-9 or abs(outline[-1][0] - wall.length) > 1e-9:
        raise InputError(f"{what} from {_point(outline[:1])} to {_point(outline[-1:])}: expected at least two points, "
                         f"the first at x = 0 and the last at x = {wall.length:g} m; add them")
    for first, second in pairwise(outline):
        if second[0] < first[0]:
            raise InputError(f"{what} runs back from {_point([first])} to {_point([second])}: expected points from "
                             "left to right; order them")
    lowest, highest = min(z for _, z in outline), max(z for _, z in outline)
    if lowest < 0 or abs(highest - wall.height) > 1e-6:
        raise InputError(f"{what} is {lowest:g} to {highest:g} m high: expected 0 or more and Wall.height = "
                         f"{wall.height:g} m at the highest point; correct one of them")
    if wall.precompression > 0:
        raise InputError(f"{what} with a precompression of {wall.precompression:g} Pa, which needs a level top: "
                         "expected none; give precompression=0, and masses by Wall.floors")
    if not outlined_runs(wall, 0):
        raise InputError(f"{what} leaves no brick in the base course: expected half a brick or more; make it higher")


def check_bearing(wall):
    """Raise InputError where a part of a course, or a slab, has nothing below one of its ends, or a timber floor no
    brick."""
    eighth = wall.brick.length / 8
    for course in range(1, wall.courses):
        below = _carriers(wall, course - 1)
        rests = [floor.span(wall) for floor in slabs(wall) if floor.courses(wall)[0] == course] + [
            (place.left, place.right) for place in lintel_places(wall)
            if place.first == course and place.lintel.bearing != 0]
        for left, right in built_runs(wall, course) + rests:
            free = [x for x in (left + eighth, right - eighth) if not any(start < x < end for start, end in below)]
            if free:
                raise InputError(f"wall {wall.name}: course {course + 1} from x = {left:g} to {right:g} m has nothing "
                                 f"below it at x = {free[0]:.4g} m: expected a bearing at both ends; move the opening "
                                 "there, or let it reach the top")
    for floor in wall.floors:
        left, right = floor.span(wall)
        runs = built_runs(wall, floor.courses(wall)[0])
        runs = runs + [(place.left, place.right) for place in lintel_places(wall)
                       if place.first <= floor.courses(wall)[0] < place.above]
        if floor.kind == "timber" and not any(min(right, end) - max(left, start) > _TINY for start, end in runs):
            raise InputError(f"wall {wall.name}, floor at {floor.level:g} m from x = {left:g} to {right:g} m has no "
                             "brick below it: expected a part of a course; move it, or the opening")


def _carriers(wall, course):
    """Parts (left, right) [m] of a course that carry: bricks, slabs and lintels."""
    return built_runs(wall, course) + [floor.span(wall) for floor in slabs(wall)
                                       if floor.courses(wall)[0] <= course < floor.courses(wall)[1]] + [
        (place.left, place.right) for place in lintel_places(wall) if place.first <= course < place.above]


def _point(points):
    return f"({points[0][0]:g}, {points[0][1]:g}) m" if points else "no point"


def _holes(wall):
    """((left, right) [m], (first course, first above)) of openings and slabs, from left to right."""
    return sorted([((opening.left, opening.right), wall.opening_courses(opening)) for opening in wall.openings]
                  + [(floor.span(wall), floor.courses(wall)) for floor in slabs(wall)])


def _beside(hole, left, right):
    """What a hole (left, right) leaves of a part of a course."""
    if hole[1] <= left or hole[0] >= right:
        return [(left, right)]
    return [part for part in ((left, hole[0]), (hole[1], right)) if part[1] > part[0]]


def _snapped(x, quarter, is_left):
    """The nearest quarter of a brick, of two equally near ones that inside the wall."""
    near = np.floor(x / quarter + 0.5 + _TINY) if is_left else np.ceil(x / quarter - 0.5 - _TINY)
    return float(near * quarter)


def _lay_run(wall, course, left, right):
    """Bricks between two free ends, cut where the bond of the whole wall meets the ends.

    A piece shorter than a quarter brick is not laid: its head joint moves a quarter brick inwards,
    which keeps a quarter brick of overlap with the courses above and below.
    """
    length = wall.brick.length
    starts_half = (course % 2 == 1) != (wall.base_course == "half")
    offset = length / 2 if starts_half else 0.0
    first = int(np.floor((left - offset + _TINY) / length)) + 1
    last = int(np.ceil((right - offset - _TINY) / length)) - 1
    joints = [offset + k * length for k in range(first, last + 1)]
    quarter = length / 4 - _TINY
    if joints and joints[0] - left < quarter:
        joints[0] += length / 4
    if joints and right - joints[-1] < quarter:
        joints[-1] -= length / 4
        if joints[-1] - left < quarter:
            joints.pop()
    edges = [left, *joints, right]
    return list(zip(edges[:-1], edges[1:]))
