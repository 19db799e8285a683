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
from damage.house.placing import Placing
from damage.house.space import (
    SHARES,
    THROUGH,
    HouseBodies,
    HouseContacts,
    HouseLayout,
    boxes,
    with_points,
    without,
)
from damage.rounded import to_bits
from damage.wall.floors import Floor
from damage.wall.kinds import CAP, GROUND, SLAB_COURSE, TINY
from damage.wall.layout import Supports, lay_out
from damage.wall.model_options import ModelOptions
from damage.wall.tables import concatenated, inertia_of, taken

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


def _together(house, parts):
    """The HouseLayout of walls beside each other, three contact points through the thickness."""
    lengths = np.array([part.wall.length for part in parts])
    placing = Placing(house.walls, np.append(0.0, np.cumsum(lengths + GAP_M))[:-1])
    first_body = np.append(0, np.cumsum([part.n_bodies for part in parts]))
    bodies = concatenated([_bodies_of(placing, *part) for part in enumerate(parts)])
    contacts = concatenated([_contacts_of(placing, *part) for part in enumerate(parts)])
    # bricks of all walls first, as of one; joints before the glue of caps
    order = np.argsort(bodies.course < 0, kind="stable")
    new = np.argsort(order)
    has_one = parts[0].options.supports == "one"
    below = np.append(0, np.cumsum([0 if has_one else len(part.supports) for part in parts]))
    first = contacts.first
    contacts = replace(
        contacts,
        first=np.where(
            first < 0, first - below[contacts.wall], new[first + first_body[contacts.wall]]
        ),
        second=new[contacts.second + first_body[contacts.wall]],
    )
    is_glue = contacts.kind == CAP
    supports, ground_left, ground_right = _ground(house, placing, parts)
    drift_bodies = [new[part.drift_bodies + start] for part, start in zip(parts, first_body)]
    drift_heights = np.array([part.drift_height for part in parts])
    return HouseLayout(
        wall=house.masonry,
        plan=parts[0].plan,
        options=parts[0].options,
        bodies=taken(bodies, order),
        contacts=taken(contacts, np.argsort(is_glue, kind="stable")),
        n_bricks=sum(part.n_bricks for part in parts),
        n_joints=int(np.sum(~is_glue)),
        drift_bodies=np.concatenate(drift_bodies),
        drift_height=float(drift_heights.mean()),
        supports=supports,
        house=house,
        placing=placing,
        wall_drift_bodies=drift_bodies,
        drift_heights=drift_heights,
        ground_left=ground_left,
        ground_right=ground_right,
    )


def _bodies_of(placing, number, part):
    """The HouseBodies of a wall, by its number, of which this is the Layout."""
    bodies = part.bodies
    thickness = part.wall.brick.thickness
    return HouseBodies(
        **vars(replace(bodies, x=bodies.x + placing.left[number])),
        wall=np.full(len(bodies), number),
        across_inertia=_across_inertia(bodies, thickness),
        offset=np.zeros(len(bodies)),
        depth=np.full(len(bodies), thickness),
    )


def _contacts_of(placing, number, part):
    """The HouseContacts of a wall, by its number, between bodies of its Layout alone."""
    brick = part.wall.brick
    n_points = len(part.contacts)
    table = taken(part.contacts, np.repeat(np.arange(n_points), len(THROUGH)))
    share = np.tile(SHARES, n_points)
    wall = np.full(len(table), number)
    x = table.x + placing.left[number]
    y = np.tile(THROUGH * brick.thickness / 2, n_points)
    local = np.column_stack([x, y, table.z])
    length = part.bodies.length
    shorter = np.minimum(length[table.first], length[table.second])
    upright = table.upright[:, None]
    along, across, up = placing.axes[number]
    axes = (
        np.where(upright, along, up),
        np.where(upright, up, along),
        np.broadcast_to(across, local.shape),
    )
    moved = {
        "x": x,
        "length": table.length * share,
        "area": table.area * share,
        "reach": np.where(table.upright, shorter, brick.height) / 2,
    }
    return HouseContacts(
        **vars(table) | moved,
        wall=wall,
        y=y,
        place=placing.in_house(wall, local[:, None])[:, 0],
        axes=np.stack(axes, axis=1),
    )


def _ground(house, placing, parts):
    """Supports below unfolded walls, and their ends along the heading (n_supports,) [m], each as
    thick as its wall."""
    supports = concatenated(
        [
            Supports(part.supports.left + start, part.supports.right + start)
            for part, start in zip(parts, placing.left)
        ]
    )
    turn = np.radians(house.heading)
    heading = np.round([np.cos(turn), np.sin(turn), 0.0], 15)
    wall = np.repeat(np.arange(len(parts)), [len(part.supports) for part in parts])
    half = house.masonry.brick.thickness / 2
    corners = [
        placing.in_house(wall, np.column_stack([x, 0 * x + side, 0 * x])[:, None])[:, 0] @ heading
        for x in (supports.left, supports.right)
        for side in (-half, half)
    ]
    left = np.min(corners, axis=0)
    right = np.max(corners, axis=0)
    if parts[0].options.supports != "one":
        return supports, left, right
    whole = Supports(np.array([0.0]), supports.right[-1:])
    return whole, left.min(keepdims=True), right.max(keepdims=True)


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
    strips &= np.isin(bodies.wall, [house.walls.index(wall) for wall in walls])
    slab = np.flatnonzero(strips)[0]
    number = house.walls.index(walls[0])
    low, high = outline(walls)
    length, across = high - low
    x, y = (low + high) / 2 - walls[0].axes[:2, :2] @ walls[0].origin
    height = bodies.height[slab]
    mass = floor.mass_per_area * length * across
    of_slab = {
        "x": x + layout.placing.left[number],
        "length": length,
        "mass": mass,
        "inertia": inertia_of(mass, length, height),
        "offset": y,
        "depth": across,
        "across_inertia": inertia_of(mass, across, np.array([height, length])),
    }
    columns = {name: getattr(bodies, name).copy() for name in of_slab}
    for name, value in of_slab.items():
        columns[name][slab] = to_bits(value)
    body = np.where(strips, slab, np.arange(len(bodies)))
    first = np.where(contacts.first < 0, contacts.first, body[contacts.first])
    contacts = replace(contacts, first=first, second=body[contacts.second])
    strips[slab] = False
    return without(replace(layout, bodies=replace(bodies, **columns), contacts=contacts), strips)


def _check_slabs(layout):
    """Raise InputError for bodies in the way of a concrete floor."""
    house = layout.house
    for slab in np.flatnonzero(layout.bodies.depth > layout.wall.brick.thickness + TINY):
        low, high = boxes(layout, layout.bodies.wall[slab])
        common = np.minimum(high, high[slab]) - np.maximum(low, low[slab])
        for body in np.flatnonzero((common > TINY).all(axis=1)):
            if body != slab:
                place = layout.centres[body]
                raise InputError(
                    f"house {house.name}, floor at {high[slab, 2]:g} m: wall"
                    f" {house.names[layout.bodies.wall[body]]} is in its way at"
                    f" ({place[0]:.3f}, {place[1]:.3f}, {place[2]:.3f}) m: expected it among the"
                    " floor's walls, or a wall that ends below; correct it"
                )


def _with_bars(layout):
    """The Layout with bars for anchored joists and ties, behind all other contact points."""
    house = layout.house
    height = layout.wall.brick.height
    for floor in house.floors:
        z = (round(floor.level / height) - 0.5) * height
        for span in floor.spans(house.carrying(floor)) if floor.anchor_spacing else ():
            n = max(1, int(np.ptp(span.along) / floor.anchor_spacing + TINY))
            bars = _bars(layout, span, [((part + 0.5) / n, z) for part in range(n)])
            if bars:
                stiffness = JOIST_PA * JOIST_M2 / span.apart
                layout = _joined(layout, span, bars, stiffness, np.inf, np.inf)
    for ties in house.ties:
        span = ties.span(house)
        places = ties.places(span)
        bars = _bars(layout, span, places)
        if not bars:
            share, z = places[0]
            x, y = span.at(share)[0]
            raise InputError(
                f"house {house.name}, ties of {' and '.join(ties.walls)}: nowhere are there bricks"
                f" of both, as at ({x:.3f}, {y:.3f}, {z:.3f}) m: expected leaves beside each other;"
                " correct them"
            )
        layout = _joined(layout, span, bars, ties.stiffness, ties.tension, ties.compression)
    return layout


def _joined(layout, span, bars, stiffness, tension, compression):
    """The Layout with bars across a Span, of this stiffness [N/m] and these strengths [N]."""
    first, second, place, axes = map(np.array, zip(*bars))
    return with_points(
        layout,
        len(layout.contacts),
        0,
        kind=CAP,
        first=first,
        second=second,
        place=place,
        axes=axes,
        reach=span.apart / 2,
        area=JOIST_M2,
        normal_stiffness=stiffness / JOIST_M2,
        shear_stiffness=1e-6 * (stiffness / JOIST_M2),
        tensile_strength=tension / JOIST_M2,
        cohesion=np.inf,
        compressive_strength=compression / JOIST_M2,
    )


def _bars(layout, span, places):
    """[(both bodies, place and axes of a bar)] at these places, (share of a Span, height [m]), none
    where one ends in an opening."""
    bodies = layout.bodies
    up = np.array([0.0, 0.0, 1.0])
    bars = []
    for share, z in places:
        on_course = np.abs(bodies.z - z) < bodies.height / 2 + TINY
        on_course &= bodies.course != SLAB_COURSE
        sides = []
        for wall, along in zip((span.one, span.other), span.along_at(share)):
            number = layout.house.walls.index(wall)
            away = np.abs(bodies.x - layout.placing.left[number] - along) - bodies.length / 2
            sides.append(np.flatnonzero(on_course & (bodies.wall == number) & (away < TINY)))
        if all(map(len, sides)):
            ends = np.insert(span.at(share), 2, z, axis=1)
            normal = (ends[1] - ends[0]) / span.apart
            axes = np.array([normal, up, np.cross(normal, up)])
            bars.append((sides[0][0], sides[1][0], ends.mean(axis=0), axes))
    return bars
