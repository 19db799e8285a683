"""How walls of a house lie in plan: which lie on each other, which stand alone, and what closes a
corner that two of them miss."""

from dataclasses import replace
from itertools import combinations

import numpy as np

from damage.errors import InputError
from damage.house.house import KINDS_OF_CORNERS
from damage.wall.kinds import TINY

SIZES = {"mm": 1e-3, "cm": 1e-2}
"""Units [m] in which a building model may have origins."""


def check_plan(house):
    """Raise InputError for walls of a House that miss their corner, or lie on each other."""
    kinds = {frozenset(corner.walls): corner.kind for corner in house.corners}
    for placed, other in combinations(house.walls, 2):
        names = [placed.wall.name, other.wall.name]
        kind = kinds.get(frozenset(names))
        turn = (other.direction - placed.direction) % 180
        distance = _distance(placed, other)
        if abs(placed.axes[0] @ other.axes[0]) < TINY:
            fault = kind and _missed(house, placed, other, kind)
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


def _missed(house, one, other, kind):
    """Say by how much two Placed walls of a House miss their corner of this kind, and which single
    change closes most of its corners; None where they meet."""
    way = _way_to(one, other, kind)
    if np.linalg.norm(way) < TINY:
        return None
    walls = {placed.wall.name: placed for placed in house.walls}
    kinds = {corner.walls: corner.kind for corner in house.corners}
    pair = next(names for names in kinds if set(names) == {one.wall.name, other.wall.name})
    other_kind = KINDS_OF_CORNERS[kind == KINDS_OF_CORNERS[0]]
    changes = {f'kind = "{other_kind}"': (walls, kinds | {pair: other_kind})}
    for placed, step in ((other, way), (one, -way)):
        name = placed.wall.name
        turned = replace(placed, direction=(placed.direction + 180) % 360)
        moved = replace(placed, origin=placed.origin + step)
        x, y = np.round(moved.origin, 9) + 0.0
        changes[f"direction = {turned.direction:g} of {name}"] = walls | {name: turned}, kinds
        changes[f"origin = [{x:.9g}, {y:.9g}] of {name}"] = walls | {name: moved}, kinds
    for unit, size in SIZES.items():
        scaled = {
            name: replace(placed, origin=size * np.array(placed.origin))
            for name, placed in walls.items()
        }
        changes[f"origins in m, as all are in {unit},"] = scaled, kinds
    open_corners = {text: _open_corners(*change) for text, change in changes.items()}
    least = min(open_corners.values())
    best = " or ".join(text for text, number in open_corners.items() if number == least)
    gap = np.linalg.norm(way)
    return f"miss by {gap:.4g} m: expected a {kind} corner; {best} closes it"


def _open_corners(walls, kinds):
    """Count the corners {names: kind} that walls {name: Placed} miss."""
    return sum(
        float(np.linalg.norm(_way_to(walls[placed], walls[other], kind))) > TINY
        for (placed, other), kind in kinds.items()
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
        across = np.clip(0.0, -ends[:, 1].max(), -ends[:, 1].min())
        ways += [(x - ends[0, 0], across) for x in (-half, length + half)]
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
