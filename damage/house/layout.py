"""The layout of a house: those of its walls, laid out each as by itself, put together in space.

Its x is that of the walls unfolded side by side in their order, so that all that draws or measures
a wall in its plane reads it.

A concrete floor is one body of the first of its walls, in place of the strips that each would have
by itself.  Anchored joists and ties are elastic bars between bricks of two walls, without stiffness
across.
"""

from dataclasses import replace
from itertools import combinations

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
from damage.wall.floors import Floor
from damage.wall.kinds import CAP, GROUND, SLAB_COURSE, TINY
from damage.wall.layout import Cells, Supports, lay_out
from damage.wall.model_options import ModelOptions

GAP_M = 0.5
"""Between two walls that are unfolded."""
JOIST_PA, JOIST_M2 = 9e9, 0.075 * 0.2
"""Modulus of the timber of anchored joists, C18 of EN 338, and their section."""


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
            one.wall,
            replace(
                options, strength_seed=(options.strength_seed + 1000 * number) % (MOST_SEED + 1)
            ),
            scatter=scatter,
            seed=seed + 1000 * number,
        )
        for number, one in enumerate(house.bearing)
    ]
    parts = list(map(_below_slab, parts))
    options = parts[0].options
    refuse(f"house {house.name}", OF_MODELS, options, "rigid bricks on rigid ground")
    layout = _together(house, parts)
    for floor in house.floors:
        if floor.kind == "concrete":
            layout = _with_slab(layout, floor)
    met = {tuple(sorted(map(house.names.index, one.walls))): one.kind for one in house.corners}
    making_room = np.full(len(layout.bodies), GROUND)
    for pair in combinations(range(len(parts)), 2):
        making_room = np.maximum(making_room, makes_room_for(layout, *pair, met.get(pair)))
    layout = without(with_loads(layout, making_room), making_room >= 0)
    for pair in met:
        layout = joined_at(layout, *pair)
    _check_slabs(layout)
    return _with_bars(layout)


def _together(house, parts):
    """The HouseLayout of walls beside each other, three contact points through the thickness."""
    lengths = np.array([part.wall.length for part in parts])
    left = np.append(0.0, np.cumsum(lengths + GAP_M))[:-1]
    first_body = np.append(0, np.cumsum([len(part.bodies) for part in parts]))
    thickness, bodies, contacts = house.masonry.brick.thickness, [], []
    one = parts[0].options.supports == "one"
    below = np.append(0, np.cumsum([0 if one else len(part.supports) for part in parts]))
    for part, start, offset, ground in zip(parts, left, first_body, below):
        table = part.contacts
        bodies.append(replace(part.bodies, x=part.bodies.x + start))
        contacts.append(
            replace(
                table,
                x=table.x + start,
                first=np.where(table.first < 0, table.first - ground, table.first + offset),
                second=table.second + offset,
            )
        )
    # bricks of all walls first, as of one; joints before the glue of caps
    is_other = np.concatenate([np.arange(len(p.bodies)) >= p.n_bricks for p in parts])
    is_glue = np.concatenate([np.arange(len(p.contacts)) >= p.n_joints for p in parts])
    order, places = (np.argsort(flags, kind="stable") for flags in (is_other, is_glue))
    new = np.argsort(order)
    wall, joint_wall = (
        np.repeat(np.arange(len(parts)), [len(getattr(p, name)) for p in parts])[index]
        for name, index in (("bodies", order), ("contacts", places))
    )
    table = taken(concatenated(contacts), np.repeat(places, 3))
    share = np.tile(SHARES, len(places))
    table = replace(
        table,
        first=np.where(table.first < 0, table.first, new[table.first]),
        second=new[table.second],
        length=table.length * share,
        area=table.area * share,
    )
    body = taken(concatenated(bodies), order)
    y, joint_wall = np.tile(THROUGH * thickness / 2, len(places)), np.repeat(joint_wall, 3)
    along = np.array([one.axes for one in house.walls])[joint_wall]
    upright = table.upright[:, None]
    axes = np.stack(
        [
            np.where(upright, along[:, 0], along[:, 2]),
            np.where(upright, along[:, 2], along[:, 0]),
            along[:, 1],
        ],
        axis=1,
    )
    local = np.column_stack([table.x, y, table.z])
    ends = np.stack([np.maximum(table.first, 0), table.second])
    half = np.where(table.upright, body.length[ends].min(axis=0), house.masonry.brick.height) / 2
    supports = Supports(
        *(
            np.concatenate([getattr(p.supports, end) + at for p, at in zip(parts, left)])
            for end in ("left", "right")
        )
    )
    ground = _along_heading(house, parts, left, supports)
    if one:
        supports = Supports(np.array([0.0]), left[-1:] + lengths[-1:])
        ground = ground[0].min(keepdims=True), ground[1].max(keepdims=True)
    drift_bodies = [new[part.drift_bodies + offset] for part, offset in zip(parts, first_body)]
    drift_heights = np.array([part.drift_height for part in parts])
    return HouseLayout(
        wall=house.masonry,
        plan=parts[0].plan,
        options=parts[0].options,
        bodies=body,
        cells=Cells(*np.zeros((3, 0))),
        contacts=table,
        n_bricks=int((~is_other).sum()),
        n_joints=3 * int((~is_glue).sum()),
        drift_bodies=np.concatenate(drift_bodies),
        drift_height=float(drift_heights.mean()),
        supports=supports,
        house=house,
        left=left,
        wall_drift_bodies=drift_bodies,
        drift_heights=drift_heights,
        ground_left=ground[0],
        ground_right=ground[1],
        body_wall=wall,
        across_inertia=_across_inertia(body, thickness),
        offset=np.zeros(len(body)),
        depth=np.full(len(body), thickness),
        joint_wall=joint_wall,
        y=y,
        place=placed(house, left, joint_wall, local),
        axes=axes,
        reach=half,
    )


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
    own = np.column_stack([bodies.height, bodies.length]) ** 2 + thickness**2
    return (bodies.inertia / third)[:, None] * own


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
    bodies, contacts, house = layout.bodies, layout.contacts, layout.house
    walls = house.carrying(floor)
    strip = Floor(floor.level, 1.0, kind="concrete", depth=floor.depth)
    z = sum(strip.courses(walls[0].wall)) / 2 * layout.wall.brick.height
    strips = (bodies.course == SLAB_COURSE) & (np.abs(bodies.z - z) < TINY)
    strips &= np.isin(layout.body_wall, [house.walls.index(one) for one in walls])
    slab, number = np.flatnonzero(strips)[0], house.walls.index(walls[0])
    low, high = outline(walls)
    length, across = high - low
    x, y = (low + high) / 2 - walls[0].axes[:2, :2] @ walls[0].origin
    height = bodies.height[slab]
    mass = floor.mass_per_area * length * across
    own = {
        "x": x + layout.left[number],
        "length": length,
        "mass": mass,
        "inertia": mass * (length**2 + height**2) / 12,
    }
    sizes = across**2 + np.array([height, length]) ** 2
    of = {"offset": y, "depth": across, "across_inertia": mass * sizes / 12}

    def put(table, values):
        columns = {name: getattr(table, name).copy() for name in values}
        for name, value in values.items():
            columns[name][slab] = to_bits(value)
        return columns

    body = np.where(strips, slab, np.arange(len(bodies)))
    first = np.where(contacts.first < 0, contacts.first, body[contacts.first])
    contacts = replace(contacts, first=first, second=body[contacts.second])
    bodies = replace(bodies, **put(bodies, own))
    layout = replace(layout, bodies=bodies, contacts=contacts, **put(layout, of))
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
    found = []
    for what, bars in _bars(layout):
        ends = [(*end, *bar) for bar in bars for end in _bar(layout, *bar[:3])]
        if what and not ends:
            span, share, z, *_ = bars[0]
            x, y = span.at(share)[0]
            raise InputError(
                f"house {layout.house.name}, {what}: nowhere are there bricks of both, as at"
                f" ({x:.3f}, {y:.3f}, {z:.3f}) m: expected leaves beside each other; correct them"
            )
        found += ends
    if not found:
        return layout
    first, second, place, axes, spans, _, _, *forces = zip(*found)
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
    house, height, found = layout.house, layout.wall.brick.height, []
    for floor in house.floors:
        z = (round(floor.level / height) - 0.5) * height
        for span in floor.spans(house.carrying(floor)) if floor.anchor_spacing else ():
            n = max(1, int(np.ptp(span.along) / floor.anchor_spacing + TINY))
            own = z, JOIST_PA * JOIST_M2 / span.apart, np.inf, np.inf
            found.append(("", [(span, (one + 0.5) / n, *own) for one in range(n)]))
    for ties in house.ties:
        span, own = ties.span(house), (ties.stiffness, ties.tension, ties.compression)
        bars = [(span, *place, *own) for place in ties.places(span)]
        found.append((f"ties of {' and '.join(ties.walls)}", bars))
    return found


def _bar(layout, span, share, z):
    """[(both bodies, place and axes of the bar)] at this share of a Span and height [m], none where
    it ends in an opening."""
    bodies, found = layout.bodies, []
    on_course = (np.abs(bodies.z - z) < bodies.height / 2 + TINY) & (bodies.course != SLAB_COURSE)
    for wall, along in zip((span.one, span.other), span.along_at(share)):
        number = layout.house.walls.index(wall)
        away = np.abs(bodies.x - layout.left[number] - along) - bodies.length / 2
        found.append(np.flatnonzero(on_course & (layout.body_wall == number) & (away < TINY)))
    if not (len(found[0]) and len(found[1])):
        return []
    ends = np.insert(span.at(share), 2, z, axis=1)
    normal = (ends[1] - ends[0]) / span.apart
    up = np.array([0.0, 0.0, 1.0])
    axes = np.array([normal, up, np.cross(normal, up)])
    return [(found[0][0], found[1][0], ends.mean(axis=0), axes)]
