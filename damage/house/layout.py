"""The layout of a house: those of its walls, laid out each as by itself, put together in space.

Its x is that of the walls unfolded side by side in their order, so that all that draws or measures
a wall in its plane reads it.

A concrete floor is one body of the first of its walls, in place of the strips that each would have
by itself.  Anchored joists and ties are elastic bars between bricks of two walls, without stiffness
across.
"""

from dataclasses import replace
from itertools import combinations
from typing import NamedTuple

import numpy as np

from damage.errors import InputError
from damage.fields import MOST_SEED
from damage.house.corners import joined_at, makes_room_for, with_loads
from damage.house.house import House, outline
from damage.house.limits import OF_MODELS, refuse
from damage.house.meeting import check_plan
from damage.house.space import (
    SHARES,
    THROUGH,
    HouseLayout,
    Points,
    boxes,
    concatenated,
    placed,
    taken,
    with_points,
    without,
)
from damage.rounded import to_bits
from damage.wall.contact_points import Contacts
from damage.wall.floors import Floor
from damage.wall.kinds import CAP, GROUND, SLAB_COURSE, TINY
from damage.wall.layout import Bodies, Cells, Supports, lay_out
from damage.wall.model_options import ModelOptions

GAP_M = 0.5
"""Distance between two walls that are unfolded [m]."""
JOIST_PA = 9e9
"""Modulus of the timber of anchored joists [Pa], C18 of EN 338."""
JOIST_M2 = 0.075 * 0.2
"""Section of an anchored joist [m2]."""


def lay_out_building(building, options=None, *, scatter=0.0, seed=0):
    """The Layout of a damage.Wall, or the HouseLayout of a House; arguments and errors as of
    `damage.wall.layout.lay_out`."""
    lay = lay_out_house if isinstance(building, House) else lay_out
    return lay(building, options, scatter=scatter, seed=seed)


def lay_out_house(house, options=None, *, scatter=0.0, seed=0):
    """The HouseLayout of a House; arguments as of `damage.wall.layout.lay_out`.

    The first wall has the strengths of that wall by itself, of the same seed; those of joints at
    corners do not scatter.  Raises InputError, with the place, of walls that do not meet at their
    corner, or overlap.
    """
    options = options or ModelOptions()
    check_plan(house)
    parts = [
        lay_out(
            placed.wall,
            replace(
                options, strength_seed=(options.strength_seed + 1000 * number) % (MOST_SEED + 1)
            ),
            scatter=scatter,
            seed=seed + 1000 * number,
        )
        for number, placed in enumerate(house.bearing)
    ]
    parts = list(map(_below_slab, parts))
    options = parts[0].options
    refuse(f"house {house.name}", OF_MODELS, options, "rigid bricks on rigid ground; leave it out")
    layout = _together(house, parts)
    for floor in house.floors:
        if floor.kind == "concrete":
            layout = _with_slab(layout, floor)
    met = {
        tuple(sorted(map(house.names.index, corner.walls))): corner.kind for corner in house.corners
    }
    making_room = np.full(layout.n_bodies, GROUND)
    for pair in combinations(range(len(parts)), 2):
        making_room = np.maximum(making_room, makes_room_for(layout, *pair, met.get(pair)))
    layout = without(with_loads(layout, making_room), making_room >= 0)
    for pair in met:
        layout = joined_at(layout, *pair)
    _check_slabs(layout)
    return _with_bars(layout)


class _Beside(NamedTuple):
    """Walls beside each other.

    bodies, contacts: of all; body_wall, joint_wall: number of the wall of each.
    new: number among them of each body, part by part (n_bodies,).
    first_body: of each part, in that order.
    n_bricks, n_joints: of all.
    """

    bodies: Bodies
    contacts: Contacts
    body_wall: np.ndarray
    joint_wall: np.ndarray
    new: np.ndarray
    first_body: np.ndarray
    n_bricks: int
    n_joints: int


def _beside(parts, left):
    """Layouts of walls _Beside each other, whose left ends are at these places [m]."""
    first_body = np.append(0, np.cumsum([len(part.bodies) for part in parts]))
    has_one = parts[0].options.supports == "one"
    below = np.append(0, np.cumsum([0 if has_one else len(part.supports) for part in parts]))
    bodies = []
    contacts = []
    for part, start, offset, ground in zip(parts, left, first_body, below):
        table = part.contacts
        first = np.where(table.first < 0, table.first - ground, table.first + offset)
        moved = replace(table, x=table.x + start, first=first, second=table.second + offset)
        bodies.append(replace(part.bodies, x=part.bodies.x + start))
        contacts.append(moved)
    # bricks of all walls first, as of one; joints before the glue of caps
    is_other = np.concatenate([np.arange(len(part.bodies)) >= part.n_bricks for part in parts])
    is_glue = np.concatenate([np.arange(len(part.contacts)) >= part.n_joints for part in parts])
    order = np.argsort(is_other, kind="stable")
    places = np.argsort(is_glue, kind="stable")
    new = np.argsort(order)
    wall_of = np.arange(len(parts))
    table = taken(concatenated(contacts), places)
    return _Beside(
        bodies=taken(concatenated(bodies), order),
        contacts=replace(
            table,
            first=np.where(table.first < 0, table.first, new[table.first]),
            second=new[table.second],
        ),
        body_wall=np.repeat(wall_of, [len(part.bodies) for part in parts])[order],
        joint_wall=np.repeat(wall_of, [len(part.contacts) for part in parts])[places],
        new=new,
        first_body=first_body,
        n_bricks=int((~is_other).sum()),
        n_joints=int((~is_glue).sum()),
    )


def _together(house, parts):
    """The HouseLayout of walls beside each other, three contact points through the thickness."""
    lengths = np.array([part.wall.length for part in parts])
    left = np.append(0.0, np.cumsum(lengths + GAP_M))[:-1]
    thickness = house.masonry.brick.thickness
    n_rows = len(THROUGH)
    walls = _beside(parts, left)
    n_points = len(walls.contacts)
    table = taken(walls.contacts, np.repeat(np.arange(n_points), n_rows))
    share = np.tile(SHARES, n_points)
    table = replace(table, length=table.length * share, area=table.area * share)
    y = np.tile(THROUGH * thickness / 2, n_points)
    joint_wall = np.repeat(walls.joint_wall, n_rows)
    local = np.column_stack([table.x, y, table.z])
    ends = np.stack([np.maximum(table.first, 0), table.second])
    shorter = walls.bodies.length[ends].min(axis=0)
    supports, ground_left, ground_right = _ground(house, parts, left)
    drift_bodies = [
        walls.new[part.drift_bodies + offset] for part, offset in zip(parts, walls.first_body)
    ]
    drift_heights = np.array([part.drift_height for part in parts])
    return HouseLayout(
        wall=house.masonry,
        plan=parts[0].plan,
        options=parts[0].options,
        bodies=walls.bodies,
        cells=Cells(*np.zeros((3, 0))),
        contacts=table,
        n_bricks=walls.n_bricks,
        n_joints=n_rows * walls.n_joints,
        drift_bodies=np.concatenate(drift_bodies),
        drift_height=float(drift_heights.mean()),
        supports=supports,
        house=house,
        left=left,
        wall_drift_bodies=drift_bodies,
        drift_heights=drift_heights,
        ground_left=ground_left,
        ground_right=ground_right,
        body_wall=walls.body_wall,
        across_inertia=_across_inertia(walls.bodies, thickness),
        offset=np.zeros(len(walls.bodies)),
        depth=np.full(len(walls.bodies), thickness),
        joint_wall=joint_wall,
        y=y,
        place=placed(house, left, joint_wall, local),
        axes=_axes(house, joint_wall, table.upright[:, None]),
        reach=np.where(table.upright, shorter, house.masonry.brick.height) / 2,
    )


def _axes(house, joint_wall, upright):
    """Axes of contact points of these walls (n_contacts, 3, 3); upright: (n_contacts, 1)."""
    along, across, up = np.array([placed.axes for placed in house.walls])[joint_wall].transpose(
        1, 0, 2
    )
    normal = np.where(upright, along, up)
    tangent = np.where(upright, up, along)
    return np.stack([normal, tangent, across], axis=1)


def _ground(house, parts, left):
    """Supports below unfolded walls, and their ends along the heading (n_supports,) [m]."""
    ends = [
        np.concatenate([getattr(part.supports, end) + start for part, start in zip(parts, left)])
        for end in ("left", "right")
    ]
    supports = Supports(*ends)
    ground_left, ground_right = _along_heading(house, parts, left, supports)
    if parts[0].options.supports != "one":
        return supports, ground_left, ground_right
    last = Supports(np.array([0.0]), left[-1:] + parts[-1].wall.length)
    return last, ground_left.min(keepdims=True), ground_right.max(keepdims=True)


def _along_heading(house, parts, left, supports):
    """Ends along the heading (n_supports,) [m] of Supports below unfolded walls, each as thick as
    its wall."""
    turn = np.radians(house.heading)
    heading = np.round([np.cos(turn), np.sin(turn), 0.0], 15)
    wall = np.repeat(np.arange(len(parts)), [len(part.supports) for part in parts])
    y = house.masonry.brick.thickness / 2
    corners = [
        placed(house, left, wall, np.column_stack([x, 0 * x + side, 0 * x])) @ heading
        for x in (supports.left, supports.right)
        for side in (-y, y)
    ]
    return np.min(corners, axis=0), np.max(corners, axis=0)


def _across_inertia(bodies, thickness):
    """Moments of inertia about the axes along the wall and upwards (n_bodies, 2) [kg m2]: that of
    the layout about the third axis, by the ratio of a box's."""
    third = bodies.length**2 + bodies.height**2
    squares = np.column_stack([bodies.height, bodies.length]) ** 2 + thickness**2
    return (bodies.inertia / third)[:, None] * squares


def _below_slab(part):
    """The Layout of a wall, its drift that of the course below a slab on its top."""
    bodies = part.bodies
    if bodies.course[part.drift_bodies[0]] != SLAB_COURSE:
        return part
    below = bodies.z[: part.n_bricks].max() - TINY
    drift = np.flatnonzero(bodies.z[: part.n_bricks] > below)
    return replace(part, drift_bodies=drift, drift_height=float(bodies.z[drift].mean()))


def _with_slab(layout, floor):
    """The HouseLayout with the strips of a concrete floor as one body."""
    bodies = layout.bodies
    contacts = layout.contacts
    house = layout.house
    walls = house.carrying(floor)
    strip = Floor(floor.level, 1.0, kind="concrete", depth=floor.depth)
    z = sum(strip.courses(walls[0].wall)) / 2 * layout.wall.brick.height
    strips = (bodies.course == SLAB_COURSE) & (np.abs(bodies.z - z) < TINY)
    strips &= np.isin(layout.body_wall, [house.walls.index(wall) for wall in walls])
    slab = np.flatnonzero(strips)[0]
    number = house.walls.index(walls[0])
    low, high = outline(walls)
    length, across = high - low
    x, y = (low + high) / 2 - walls[0].axes[:2, :2] @ walls[0].origin
    height = bodies.height[slab]
    mass = floor.mass_per_area * length * across
    in_plane = {
        "x": x + layout.left[number],
        "length": length,
        "mass": mass,
        "inertia": mass * (length**2 + height**2) / 12,
    }
    sizes = across**2 + np.array([height, length]) ** 2
    across_plane = {"offset": y, "depth": across, "across_inertia": mass * sizes / 12}

    def put(table, values):
        columns = {name: getattr(table, name).copy() for name in values}
        for name, value in values.items():
            columns[name][slab] = to_bits(value)
        return columns

    body = np.where(strips, slab, np.arange(len(bodies)))
    first = np.where(contacts.first < 0, contacts.first, body[contacts.first])
    contacts = replace(contacts, first=first, second=body[contacts.second])
    bodies = replace(bodies, **put(bodies, in_plane))
    layout = replace(layout, bodies=bodies, contacts=contacts, **put(layout, across_plane))
    strips[slab] = False
    return without(layout, strips)


def _check_slabs(layout):
    """Raise InputError for bodies in the way of a concrete floor."""
    house = layout.house
    for slab in np.flatnonzero(layout.depth > layout.wall.brick.thickness + TINY):
        low, high = boxes(layout, layout.body_wall[slab])
        common = np.minimum(high, high[slab]) - np.maximum(low, low[slab])
        for body in np.flatnonzero((common > TINY).all(axis=1)):
            if body != slab:
                place = layout.centres[body]
                raise InputError(
                    f"house {house.name}, floor at {high[slab, 2]:g} m: wall"
                    f" {house.names[layout.body_wall[body]]} is in its way at"
                    f" ({place[0]:.3f}, {place[1]:.3f}, {place[2]:.3f}) m: expected it among the"
                    " floor's walls, or a wall that ends below; correct it"
                )


def _with_bars(layout):
    """The Layout with bars for anchored joists and ties, behind all other contact points."""
    new_bars = []
    for what, bars in _bars(layout):
        ends = [(*end, *bar) for bar in bars for end in _bar(layout, *bar[:3])]
        if what and not ends:
            span, share, z, *_ = bars[0]
            x, y = span.at(share)[0]
            raise InputError(
                f"house {layout.house.name}, {what}: nowhere are there bricks of both, as at"
                f" ({x:.3f}, {y:.3f}, {z:.3f}) m: expected leaves beside each other; correct them"
            )
        new_bars += ends
    if not new_bars:
        return layout
    first, second, place, axes, spans, _, _, *forces = zip(*new_bars)
    apart = np.array([span.apart for span in spans])
    stiffness, tension, compression = np.array(forces) / JOIST_M2
    points = Points(
        CAP,
        *map(np.array, (first, second, place, axes)),
        apart / 2,
        np.full(len(apart), JOIST_M2),
        stiffness,
        1e-6 * stiffness,
    )
    return with_points(layout, len(layout.contacts), points, 0, (tension, np.inf, compression))


def _bars(layout):
    """(words of what has to be somewhere, [(Span, share of it, height [m], stiffness [N/m],
    strength in tension and compression [N])]) of each floor and of all Ties."""
    house = layout.house
    height = layout.wall.brick.height
    crossings = []
    for floor in house.floors:
        z = (round(floor.level / height) - 0.5) * height
        for span in floor.spans(house.carrying(floor)) if floor.anchor_spacing else ():
            n = max(1, int(np.ptp(span.along) / floor.anchor_spacing + TINY))
            strengths = z, JOIST_PA * JOIST_M2 / span.apart, np.inf, np.inf
            crossings.append(("", [(span, (part + 0.5) / n, *strengths) for part in range(n)]))
    for ties in house.ties:
        span = ties.span(house)
        strengths = (ties.stiffness, ties.tension, ties.compression)
        bars = [(span, *place, *strengths) for place in ties.places(span)]
        crossings.append((f"ties of {' and '.join(ties.walls)}", bars))
    return crossings


def _bar(layout, span, share, z):
    """[(both bodies, place and axes of the bar)] at this share of a Span and height [m], none where
    it ends in an opening."""
    bodies = layout.bodies
    sides = []
    on_course = (np.abs(bodies.z - z) < bodies.height / 2 + TINY) & (bodies.course != SLAB_COURSE)
    for wall, along in zip((span.one, span.other), span.along_at(share)):
        number = layout.house.walls.index(wall)
        away = np.abs(bodies.x - layout.left[number] - along) - bodies.length / 2
        sides.append(np.flatnonzero(on_course & (layout.body_wall == number) & (away < TINY)))
    if not (len(sides[0]) and len(sides[1])):
        return []
    ends = np.insert(span.at(share), 2, z, axis=1)
    normal = (ends[1] - ends[0]) / span.apart
    up = np.array([0.0, 0.0, 1.0])
    axes = np.array([normal, up, np.cross(normal, up)])
    return [(sides[0][0], sides[1][0], ends.mean(axis=0), axes)]
