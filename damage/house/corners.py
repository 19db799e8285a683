"""Where two walls of a house meet: half bricks make room for whole ones, and bricks that touch are
joined by contact points, 3 x 3 on each face."""

from dataclasses import replace
from itertools import product

import numpy as np

from damage.errors import InputError
from damage.house.space import SHARES, THROUGH, boxes, with_points
from damage.rounded import to_bits
from damage.wall.kinds import BED, GROUND, HEAD, TINY


def makes_room_for(layout, one, other, kind):
    """The body of another wall for which each makes room (n_bodies,), GROUND of those that stay;
    kind: of their corner, None without one."""
    dropped = np.full(layout.n_bodies, GROUND)
    house = layout.house
    walls = layout.house.walls
    where = f"house {house.name}, walls {house.names[one]} and {house.names[other]}"
    if abs(walls[one].axes[0] @ walls[other].axes[0]) > TINY:
        return dropped
    low, high, i, j, _ = _common(layout, one, other)
    least = (high - low).min(axis=1)  # below zero: by what two are apart
    nearest = least.argmax()
    overlap = least > TINY
    place = ((low + high)[nearest] / 2) @ walls[one].axes
    at = "at ({:.3f}, {:.3f}, {:.3f}) m".format(*place)
    if kind is None and least[nearest] > -TINY:
        raise InputError(
            f"{where} touch {at}: expected a corner of theirs in [[corners]], or a distance; add"
            " it, or move one"
        )
    halves = layout.bodies.course >= 0
    halves &= np.abs(layout.bodies.length - layout.wall.brick.thickness) < TINY
    for a, b, size in zip(i[overlap], j[overlap], (high - low)[overlap]):
        if halves[a] == halves[b] or np.ptp(size[:2]) > TINY:
            raise InputError(
                f"{where} overlap {at}: expected a half brick of one in the place of a whole one of"
                " the other, in turn by courses; make bricks twice as long as thick, base_course"
                ' "half" of one, and give --top uniform, as caps overlap'
            )
        half, whole = (a, b) if halves[a] else (b, a)
        dropped[half] = whole
    return dropped


def with_loads(layout, making_room):
    """The HouseLayout with what bodies that make room carried on those in their place."""
    bodies = layout.bodies
    density = np.array([wall.brick.density for wall in layout.walls])[bodies.wall]
    loads = bodies.mass - density * bodies.length * bodies.depth * bodies.height
    gone = making_room >= 0
    more = np.bincount(making_room[gone], loads[gone], len(bodies))
    more[more < TINY] = 0.0
    factor = 1 + more / bodies.mass
    heavier = replace(
        bodies,
        mass=to_bits(bodies.mass * factor),
        inertia=to_bits(bodies.inertia * factor),
        across_inertia=bodies.across_inertia * factor[:, None],
    )
    return replace(layout, bodies=heavier)


def joined_at(layout, one, other):
    """The HouseLayout with contact points where bricks of two walls touch, behind all other joints.

    Each property is that of the wall where it is less.
    """

    def least(part, name):
        walls = layout.walls[one], layout.walls[other]
        return min(getattr(getattr(wall, part), name) for wall in walls)

    low, high, i, j, apart = _common(layout, one, other)
    axes = layout.house.walls[one].axes
    span = high - low
    joined = []
    bricks = np.maximum(i, j) < layout.n_bricks
    for normal in range(3):
        u, v = (k for k in range(3) if k != normal)
        touch = np.abs(span[:, normal]) < TINY
        for k in np.flatnonzero(touch & (span[:, u] > TINY) & (span[:, v] > TINY) & bricks):
            ends = (i[k], j[k]) if apart[k, normal] > 0 else (j[k], i[k])
            for (pu, su), (pv, sv) in product(zip(THROUGH, SHARES), repeat=2):
                place = (low[k] + high[k]) / 2
                place[[u, v]] += np.array([pu, pv]) * span[k, [u, v]] / 2
                area = span[k, u] * span[k, v] * su * sv
                joined.append((*ends, normal, abs(apart[k, normal]), area, place @ axes))
    first, second, normal, distance, area, place = map(np.array, zip(*joined))
    turned = axes[[[0, 2, 1], [1, 2, 0], [2, 0, 1]]][normal]
    stiffness = [
        1 / (1 / least("joint", of_joint) + distance / least("brick", modulus))
        for of_joint, modulus in (
            ("normal_stiffness", "young_modulus"),
            ("shear_stiffness", "shear_modulus"),
        )
    ]
    n = layout.n_joints
    layout = with_points(
        layout,
        n,
        one,
        kind=np.where(normal == 2, BED, HEAD),
        first=first,
        second=second,
        place=place,
        axes=turned,
        reach=distance / 2,
        area=area,
        normal_stiffness=stiffness[0],
        shear_stiffness=stiffness[1],
        tensile_strength=least("joint", "tensile_strength"),
        cohesion=least("joint", "cohesion"),
        compressive_strength=np.inf,
    )
    return replace(layout, n_joints=n + len(first))


def _common(layout, one, other):
    """Boxes that the bodies of two walls at right angles have in common, in axes of the first:
    lowest and highest corners (n_pairs, 3) [m], turned inside out where two are apart, both bodies
    (n_pairs,), and the centres' distances (n_pairs, 3)."""
    low, high = boxes(layout, one)
    centre = (low + high) / 2
    bodies = layout.bodies
    overlapping = bodies.depth < layout.wall.brick.thickness + TINY
    i, j = (np.flatnonzero((bodies.wall == number) & overlapping) for number in (one, other))
    i, j = (index.ravel() for index in np.meshgrid(i, j, indexing="ij"))
    common = np.maximum(low[i], low[j]), np.minimum(high[i], high[j])
    return *common, i, j, centre[j] - centre[i]
