"""How walls of a house lie in plan: which lie on each other, which stand alone, and the origin
that closes a corner that two of them miss."""

from itertools import combinations

import numpy as np

from damage.errors import InputError
from damage.wall.kinds import TINY


def check_plan(house):
    """Raise InputError for walls of a House that miss their corner, or lie on each other."""
    kinds = {frozenset(corner.walls): corner.kind for corner in house.corners}
    for placed, other in combinations(house.walls, 2):
        names = [placed.wall.name, other.wall.name]
        kind = kinds.get(frozenset(names))
        turn = (other.direction - placed.direction) % 180
        distance = _distance(placed, other)
        if abs(placed.axes[0] @ other.axes[0]) < TINY:
            fault = kind and _missed(placed, other, kind)
        elif kind:
            fault = (
                f"meet at {turn:.6g} degrees, another than a right angle: expected 90 at a corner;"
                f" give {names[1]} direction = {(other.direction - turn + 90) % 360:.6g}"
            )
        elif distance < TINY:
            fault = (
                f"{'touch' if distance > -TINY else 'lie on each other'}: expected each wall once,"
                " and a distance between walls that meet at no right angle; leave one of them out,"
                " or move it"
            )
        else:
            fault = None
        if fault:
            raise InputError(f"house {house.name}, walls {' and '.join(names)} {fault}")


def warn_of_lone_walls(building):
    """Warning of walls of a House that nothing joins to another: a list of at most one line, none
    of a damage.Wall."""
    if not building.lone_walls:
        return []
    return [
        f"house {building.name}: no corner, floor or tie joins {', '.join(building.lone_walls)} to"
        " another wall; add it, unless they stand by themselves"
    ]


def _missed(one, other, kind):
    """Say by how much two Placed walls miss their corner of this kind, and the origin of the second
    that closes it; None where they meet."""
    way = _way_to(one, other, kind)
    gap = np.linalg.norm(way)
    if gap < TINY:
        return None
    x, y = np.round(other.origin + way, 9) + 0.0
    return (
        f"miss by {gap:.4g} m: expected a {kind} corner; origin = [{x:.9g}, {y:.9g}] of"
        f" {other.wall.name} closes it, where its direction, the kind of the corner and origins in"
        " m are right"
    )


def _way_to(one, other, kind):
    """The shortest way in plan (2,) [m] of the second of two Placed walls at right angles to a
    corner of this kind."""
    axes = one.axes[:2, :2]
    half = one.wall.brick.thickness / 2
    length = one.wall.length
    ends = (other.ends - one.origin) @ axes.T
    ways = []
    for end, far_end in (ends, ends[::-1]):
        inward = half * np.sign(far_end[1] - end[1])
        if kind == "toothed":
            ways += [(x - end[0], -inward - end[1]) for x in (half, length - half)]
        else:
            ways.append((np.clip(end[0], 0.0, length) - end[0], inward - end[1]))
    if kind == "butted":  # an end of the first at a face of the second
        up = np.clip(0.0, -ends[:, 1].max(), -ends[:, 1].min())
        ways += [(x - ends[0, 0], up) for x in (-half, length + half)]
    return min(ways, key=np.linalg.norm) @ axes


def _distance(one, other):
    """Distance in plan of two Placed walls [m], below zero where they overlap: the largest along
    their axes (separating axes of rectangles)."""
    apart = []
    for axis in np.concatenate([one.axes[:2, :2], other.axes[:2, :2]]):
        first = one.corners @ axis
        second = other.corners @ axis
        apart.append(max(first.min() - second.max(), second.min() - first.max()))
    return float(max(apart))
