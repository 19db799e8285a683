"""The layout of a house: those of its walls, laid out each as by itself, put together in space.

Its x is that of the walls unfolded side by side in their order, so that all that draws or measures
a wall in its plane reads it.  `Space` says where bodies and contact points are in plan.  Every
contact point of a wall is three through the thickness, at the faces and in the middle, with shares
of 1/6, 4/6 and 1/6 (Simpson's rule): the stiffness in bending is exact, and a dry wall rocks about
its face; with two Gauss points it would fall at 0.58 of that.

A concrete floor is one body of the first of its walls, in place of the strips that each would have
by itself.  Anchored joists are elastic bars between bricks of two walls, without stiffness across.

Where walls are toothed, the half brick at the end of a course makes room for the whole one of the
other wall.  Contact points between two walls are where their bricks touch, 3 x 3 on each face.
"""

from dataclasses import dataclass, fields, replace
from itertools import combinations, product
from typing import NamedTuple

import numpy as np

from damage.errors import InputError
from damage.rounded import to_bits
from damage.wall.contact_points import Contacts
from damage.wall.floors import Floor
from damage.wall.house import House, outline
from damage.wall.kinds import BED, CAP, GROUND, HEAD, SLAB_COURSE, TINY, rows
from damage.wall.layout import Cells, Supports, lay_out

THROUGH, SHARES = np.array([-1.0, 0.0, 1.0]), np.array([1.0, 4.0, 1.0]) / 6
"""Contact points through the thickness: places over half of it, and shares of the area [-]."""
GAP_M = 0.5
"""Between two walls that are unfolded."""
OF_BODIES = "wall", "across_inertia", "offset", "depth"
OF_CONTACTS = "joint_wall", "y", "place", "axes", "reach"
"""Fields of a Space with a row a body, or a contact point."""
JOIST_PA, JOIST_M2 = 9e9, 0.075 * 0.2
"""Modulus of the timber of anchored joists, C18 of EN 338, and their section."""


@dataclass(frozen=True)
class Space:
    """Where the bodies and contact points of a house are, z upwards and the ground at z = 0.

    house: House; left: x of the left end of each unfolded wall (n_walls,) [m]; drift_bodies,
    drift_height: of each wall, as of its Layout; ground_left, ground_right: ends of each support
    along the heading, from the middle of the plan's axes (n_supports,) [m].
    wall: number of that of a body (n_bodies,); across_inertia: about the axes along the wall and
    upwards (n_bodies, 2) [kg m2]; offset: of its centre from the wall's middle plane, and depth
    across the wall (n_bodies,) [m]; joint_wall: number of that of a contact point, -1 between two
    (n_contacts,); y: its place from the middle plane of its (second) wall [m]; place: in the house
    (n_contacts, 3) [m]; axes: its normal, the tangent of a wall's shear, and the other one
    (n_contacts, 3, 3); reach: from there to the bodies' inside along the normal (n_contacts,) [m].
    """

    house: House
    left: np.ndarray
    drift_bodies: list
    drift_height: np.ndarray
    ground_left: np.ndarray
    ground_right: np.ndarray
    wall: np.ndarray
    across_inertia: np.ndarray
    offset: np.ndarray
    depth: np.ndarray
    joint_wall: np.ndarray
    y: np.ndarray
    place: np.ndarray
    axes: np.ndarray
    reach: np.ndarray

    def as_dict(self):
        """All parameters of the house as a plain dictionary, with the places of its unfolded walls
        and their drift heights [m]."""
        found = self.house.as_dict()
        for one, left, height in zip(found["walls"], self.left, self.drift_height):
            one |= {"left_m": float(left), "drift_height_m": float(height)}
        return found

    @property
    def ground(self):
        """The Supports along the heading, from where the house begins."""
        start = self.ground_left.min()
        return Supports(self.ground_left - start, self.ground_right - start)

    @property
    def of_body(self):
        """Axes of each body's wall: along it, across and upwards, (n_bodies, 3, 3)."""
        return np.array([one.axes for one in self.house.walls])[self.wall]

    def centres(self, bodies):
        """Of the bodies in the house, (n_bodies, 3) [m]."""
        return _placed(self.house, self.left, self.wall, self.unfolded(bodies))

    def unfolded(self, bodies):
        """Centres of the bodies in their unfolded walls (n_bodies, 3) [m]."""
        return np.column_stack([bodies.x, self.offset, bodies.z])

    def arms(self, bodies, body):
        """From the centres of these bodies, one of each contact point, to that, in axes of their
        walls (n_contacts, 3) [m]."""
        away = self.place - self.centres(bodies)[body]
        return np.einsum("nij,nj->ni", self.of_body[body], away)

    def tops(self, motion):
        """Displacement along each wall of its top over the piers (n, n_walls) [m]; motion: (n,
        n_bodies, 3)."""
        return np.column_stack([motion[:, one, 0].mean(axis=1) for one in self.drift_bodies])

    def across(self, motion):
        """Displacement across each wall of the body where it is largest (n, n_walls) [m]; motion:
        out of plane (n, n_bodies, 3)."""
        found = []
        for number in range(len(self.left)):
            of = motion[:, self.wall == number, 0]
            found.append(of[np.arange(len(of)), np.abs(of).argmax(axis=1)])
        return np.column_stack(found)

    def rows(self, contacts, bodies, direction):
        """`damage.law.modes.kinematic_rows` in space, (2, n_contacts, 6): of a body's displacement
        along its wall, upwards and rotation from x towards z, displacement across and rotations
        about the axes along and upwards; direction: 0 to 2, an axis of the contact points."""
        found = np.zeros((2, len(contacts), 6))
        for row, body, sign in ((found[0], contacts.first, -1.0), (found[1], contacts.second, 1.0)):
            moving = np.flatnonzero(body >= 0)
            of = body[moving]
            d = np.einsum("nij,nj->ni", self.of_body[of], self.axes[moving, direction])
            turned = np.cross(self.arms(bodies, np.maximum(body, 0))[moving], d)
            row[moving] = sign * np.column_stack(
                [d[:, 0], d[:, 2], -turned[:, 1], d[:, 1], turned[:, 0], turned[:, 2]]
            )
        return found


def _placed(house, left, wall, local):
    """Places in the house of (n, 3) [m] in unfolded walls of these numbers (n,)."""
    origins = np.array([(*one.origin, 0.0) for one in house.walls])
    axes = np.array([one.axes for one in house.walls])
    local = local - np.outer(left[wall], [1.0, 0.0, 0.0])
    return origins[wall] + np.einsum("ni,nij->nj", local, axes[wall])


def lay_out_house(house, options=None, *, scatter=0.0, seed=0):
    """The Layout of a House with its `space`; arguments as of `damage.wall.layout.lay_out`.

    The first wall has the strengths of that wall by itself, of the same seed.  Raises InputError,
    with the place, of walls that do not meet at their corner, or overlap.
    """
    parts = [
        lay_out(one.wall, options, scatter=scatter, seed=seed + 1000 * number)
        for number, one in enumerate(house.bearing)
    ]
    parts = list(map(_below_slab, parts))
    options = parts[0].options
    for what, refused in (
        ("--bricks deformable", options.bricks != "rigid"),
        ("--soil", options.soil != "rigid"),
    ):
        if refused:
            raise InputError(
                f"house {house.name} with {what}: expected rigid bricks on rigid ground; leave it"
                " out"
            )
    layout = _together(house, parts)
    for floor in house.floors:
        if floor.kind == "concrete":
            layout = _with_slab(layout, floor)
    met = {tuple(sorted(map(house.names.index, one.walls))): one.kind for one in house.corners}
    making_room = np.full(len(layout.bodies), GROUND)
    for pair in combinations(range(len(parts)), 2):
        making_room = np.maximum(making_room, _making_room(layout, *pair, met.get(pair)))
    layout = _without(_with_loads(layout, making_room), making_room >= 0)
    for pair in met:
        layout = _joined_at(layout, *pair)
    _check_slabs(layout)
    return _with_joists(layout)


# --- together -------------------------------------------------------------------------------------


def _together(house, parts):
    """The Layout of walls beside each other, with three contact points through the thickness."""
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
    table = _taken(_concatenated(contacts), np.repeat(places, 3))
    share = np.tile(SHARES, len(places))
    table = replace(
        table,
        first=np.where(table.first < 0, table.first, new[table.first]),
        second=new[table.second],
        length=table.length * share,
        area=table.area * share,
    )
    body = _taken(_concatenated(bodies), order)
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
    space = Space(
        house,
        left,
        [new[part.drift_bodies + offset] for part, offset in zip(parts, first_body)],
        np.array([part.drift_height for part in parts]),
        *ground,
        wall,
        _across_inertia(body, thickness),
        np.zeros(len(body)),
        np.full(len(body), thickness),
        joint_wall,
        y,
        _placed(house, left, joint_wall, local),
        axes,
        half,
    )
    return replace(
        parts[0],
        wall=house.masonry,
        bodies=body,
        cells=Cells(*np.zeros((3, 0))),
        contacts=table,
        n_bricks=int((~is_other).sum()),
        n_joints=3 * int((~is_glue).sum()),
        drift_bodies=np.concatenate(space.drift_bodies),
        drift_height=float(space.drift_height.mean()),
        supports=supports,
        space=space,
    )


def _along_heading(house, parts, left, supports):
    """Ends along the heading (n_supports,) [m] of Supports below unfolded walls, each as thick as
    its wall."""
    turn = np.radians(house.heading)
    heading = np.round([np.cos(turn), np.sin(turn), 0.0], 15)
    wall = np.repeat(np.arange(len(parts)), [len(part.supports) for part in parts])
    y = house.masonry.brick.thickness / 2
    corners = [
        _placed(house, left, wall, np.column_stack([x, 0 * x + side, 0 * x])) @ heading
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


# --- floors ---------------------------------------------------------------------------------------


def _below_slab(part):
    """The Layout of a wall, its drift that of the course below a slab on its top."""
    bodies = part.bodies
    if bodies.course[part.drift_bodies[0]] != SLAB_COURSE:
        return part
    below = bodies.z[: part.n_bricks].max() - TINY
    drift = np.flatnonzero(bodies.z[: part.n_bricks] > below)
    return replace(part, drift_bodies=drift, drift_height=float(bodies.z[drift].mean()))


def _with_slab(layout, floor):
    """The Layout with the strips of a concrete floor as one body."""
    space, bodies, contacts = layout.space, layout.bodies, layout.contacts
    house = space.house
    walls = house.carrying(floor)
    strip = Floor(floor.level, 1.0, kind="concrete", depth=floor.depth)
    z = sum(strip.courses(walls[0].wall)) / 2 * layout.wall.brick.height
    strips = (bodies.course == SLAB_COURSE) & (np.abs(bodies.z - z) < TINY)
    strips &= np.isin(space.wall, [house.walls.index(one) for one in walls])
    slab, number = np.flatnonzero(strips)[0], house.walls.index(walls[0])
    low, high = outline(walls)
    length, across = high - low
    x, y = (low + high) / 2 - walls[0].axes[:2, :2] @ walls[0].origin
    height = bodies.height[slab]
    mass = floor.mass_per_area * length * across
    own = {
        "x": x + space.left[number],
        "length": length,
        "mass": mass,
        "inertia": mass * (length**2 + height**2) / 12,
    }
    sizes = across**2 + np.array([height, length]) ** 2
    of = {"offset": y, "depth": across, "across_inertia": mass * sizes / 12}

    def put(table, values):
        found = {name: getattr(table, name).copy() for name in values}
        for name, value in values.items():
            found[name][slab] = to_bits(value)
        return replace(table, **found)

    body = np.where(strips, slab, np.arange(len(bodies)))
    first = np.where(contacts.first < 0, contacts.first, body[contacts.first])
    contacts = replace(contacts, first=first, second=body[contacts.second])
    layout = replace(layout, bodies=put(bodies, own), contacts=contacts, space=put(space, of))
    strips[slab] = False
    return _without(layout, strips)


def _check_slabs(layout):
    """Raise InputError for bodies in the way of a concrete floor."""
    space, house = layout.space, layout.space.house
    for slab in np.flatnonzero(space.depth > layout.wall.brick.thickness + TINY):
        low, high = _boxes(layout, space.wall[slab])
        common = np.minimum(high, high[slab]) - np.maximum(low, low[slab])
        for body in np.flatnonzero((common > TINY).all(axis=1)):
            if body != slab:
                place = space.centres(layout.bodies)[body]
                raise InputError(
                    f"house {house.name}, floor at {high[slab, 2]:g} m: wall"
                    f" {house.names[space.wall[body]]} is in its way at"
                    f" ({place[0]:.3f}, {place[1]:.3f}, {place[2]:.3f}) m: expected it among the"
                    " floor's walls, or a wall that ends below; correct it"
                )


def _with_joists(layout):
    """The Layout with bars for anchored joists, behind all other contact points."""
    space, found = layout.space, []
    for floor in space.house.floors:
        walls = space.house.carrying(floor)
        for span in floor.spans(walls) if floor.anchor_spacing else ():
            n = int(np.ptp(span.along) / floor.anchor_spacing + TINY)
            for share in (np.arange(n) + 0.5) / max(n, 1):
                found += _joist(layout, floor, span, share)
    if not found:
        return layout
    first, second, apart, place, axes = map(np.array, zip(*found))
    area = np.full(len(found), JOIST_M2)
    stiffness = JOIST_PA / apart
    return _with_points(
        layout,
        len(layout.contacts),
        Points(CAP, first, second, place, axes, apart / 2, area, stiffness, 1e-6 * stiffness),
    )


def _joist(layout, floor, span, share):
    """[(both bodies, distance, place and axes of the bar)] of a joist at this share of a Span, none
    where it ends in an opening."""
    space, bodies, height = layout.space, layout.bodies, layout.wall.brick.height
    z, found, ends = (round(floor.level / height) - 0.5) * height, [], []
    on_course = (np.abs(bodies.z - z) < bodies.height / 2) & (bodies.course != SLAB_COURSE)
    for one, (left, right) in ((span.one, span.along), (span.other, span.other_along)):
        number = space.house.walls.index(one)
        facing = one.axes[0] @ span.one.axes[0] > 0
        along = left + (right - left) * (share if facing else 1 - share)
        away = np.abs(bodies.x - space.left[number] - along) - bodies.length / 2
        found.append(np.flatnonzero(on_course & (space.wall == number) & (away < TINY)))
        ends.append(np.array([*(one.origin + along * one.axes[0, :2]), z]))
    if not (len(found[0]) and len(found[1])):
        return []
    normal = (ends[1] - ends[0]) / span.apart
    up = np.array([0.0, 0.0, 1.0])
    axes = np.array([normal, up, np.cross(normal, up)])
    return [(found[0][0], found[1][0], span.apart, (ends[0] + ends[1]) / 2, axes)]


# --- corners --------------------------------------------------------------------------------------


def _common(layout, one, other):
    """Boxes that the bodies of two walls at right angles have in common, in axes of the first:
    lowest and highest corners (n_pairs, 3) [m], turned inside out where two are apart, both bodies
    (n_pairs,), and the centres' distances (n_pairs, 3)."""
    space = layout.space
    low, high = _boxes(layout, one)
    centre, own = (low + high) / 2, space.depth < layout.wall.brick.thickness + TINY
    i, j = (np.flatnonzero((space.wall == number) & own) for number in (one, other))
    i, j = (index.ravel() for index in np.meshgrid(i, j, indexing="ij"))
    common = np.maximum(low[i], low[j]), np.minimum(high[i], high[j])
    return *common, i, j, centre[j] - centre[i]


def _boxes(layout, wall):
    """Lowest and highest corners of all bodies, of walls at right angles, in the axes of this wall,
    twice (n_bodies, 3) [m]."""
    space, bodies = layout.space, layout.bodies
    axes = space.house.walls[wall].axes
    size = np.column_stack([bodies.length, space.depth, bodies.height])
    half = np.abs(np.einsum("nij,ni,kj->nk", space.of_body, size / 2, axes))
    centre = space.centres(bodies) @ axes.T
    return centre - half, centre + half


def _making_room(layout, one, other, kind):
    """The body of another wall for which each makes room (n_bodies,), GROUND of those that stay;
    kind: of their corner, None without one."""
    space, dropped = layout.space, np.full(len(layout.bodies), GROUND)
    house, walls = space.house, space.house.walls
    where = f"house {house.name}, walls {house.names[one]} and {house.names[other]}"
    if abs(walls[one].axes[0] @ walls[other].axes[0]) > TINY:
        if kind:
            raise InputError(f"{where} meet at another than a right angle: expected 90 degrees")
        return dropped
    low, high, i, j, _ = _common(layout, one, other)
    least = (high - low).min(axis=1)  # below zero: by what two are apart
    nearest, overlap = least.argmax(), least > TINY
    place = ((low + high)[nearest] / 2) @ walls[one].axes
    at = "at ({:.3f}, {:.3f}, {:.3f}) m".format(*place)
    if kind is None and least[nearest] > -TINY:
        raise InputError(
            f"{where} touch {at}: expected a corner of theirs in [[corners]], or a distance; add"
            " it, or move one"
        )
    if kind and least[nearest] < -TINY:
        raise InputError(
            f"{where} do not meet: expected their corner {at}, where {-least[nearest]:.4g} m are"
            " between them; move one, or leave the corner out"
        )
    halves = layout.bodies.course >= 0
    halves &= np.abs(layout.bodies.length - layout.wall.brick.thickness) < TINY
    if (kind == "butted" and overlap.any()) or (kind == "toothed" and not overlap.any()):
        raise InputError(
            f"{where} {'overlap' if overlap.any() else 'touch'} {at}: expected"
            f" {'an end at a face' if overlap.any() else 'ends in one another'} of a {kind} corner;"
            " correct the origin or the kind"
        )
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


def _with_loads(layout, making_room):
    """The Layout with what bodies that make room carried on those in their place."""
    space, bodies, brick = layout.space, layout.bodies, layout.wall.brick
    loads = bodies.mass - brick.density * bodies.length * space.depth * bodies.height
    gone = making_room >= 0
    more = np.bincount(making_room[gone], loads[gone], len(bodies))
    more[more < TINY] = 0.0
    factor = 1 + more / bodies.mass
    mass, inertia = to_bits(bodies.mass * factor), to_bits(bodies.inertia * factor)
    return replace(
        layout,
        bodies=replace(bodies, mass=mass, inertia=inertia),
        space=replace(space, across_inertia=space.across_inertia * factor[:, None]),
    )


def _without(layout, drop):
    """The Layout without these bodies (n_bodies,) and their contact points."""
    space, contacts, kept = layout.space, layout.contacts, ~drop
    ground = np.arange(len(layout.supports))
    new = np.append(np.cumsum(kept) - 1, GROUND - ground)
    ends = [rows(end, len(drop)) for end in (contacts.first, contacts.second)]
    stay = np.append(kept, ground >= 0)[ends].all(axis=0)
    drift = [new[_remaining(layout, one, kept)] for one in space.drift_bodies]
    return replace(
        layout,
        bodies=_taken(layout.bodies, kept),
        contacts=_taken(replace(contacts, first=new[ends[0]], second=new[ends[1]]), stay),
        n_bricks=int(kept[: layout.n_bricks].sum()),
        n_joints=int(stay[: layout.n_joints].sum()),
        drift_bodies=np.concatenate(drift),
        space=replace(
            space,
            drift_bodies=drift,
            **{name: getattr(space, name)[kept] for name in OF_BODIES},
            **{name: getattr(space, name)[stay] for name in OF_CONTACTS},
        ),
    )


def _remaining(layout, bodies, kept):
    """Those of a wall's drift that are kept (n,), else all that are kept of their course."""
    if kept[bodies].any():
        return bodies[kept[bodies]]
    alike = layout.bodies.course == layout.bodies.course[bodies[0]]
    return np.flatnonzero(kept & alike & (layout.space.wall == layout.space.wall[bodies[0]]))


def _joined_at(layout, one, other):
    """The Layout with contact points where bricks of two walls touch, behind all other joints."""
    space, brick, joint = layout.space, layout.wall.brick, layout.wall.joint
    low, high, i, j, apart = _common(layout, one, other)
    axes, span, found = space.house.walls[one].axes, high - low, []
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
                found.append((*ends, normal, abs(apart[k, normal]), area, place @ axes))
    first, second, normal, distance, area, place = map(np.array, zip(*found))
    turned = axes[[[0, 2, 1], [1, 2, 0], [2, 0, 1]]][normal]
    stiffness = [
        1 / (1 / of_joint + distance / modulus)
        for of_joint, modulus in (
            (joint.normal_stiffness, brick.young_modulus),
            (joint.shear_stiffness, brick.shear_modulus),
        )
    ]
    kind, n = np.where(normal == 2, BED, HEAD), layout.n_joints
    points = Points(kind, first, second, place, turned, distance / 2, area, *stiffness)
    strength = joint.tensile_strength, joint.cohesion
    return replace(_with_points(layout, n, points, one, strength), n_joints=n + len(first))


class Points(NamedTuple):
    """Contact points between walls, as the fields of Contacts and of a Space."""

    kind: np.ndarray
    first: np.ndarray
    second: np.ndarray
    place: np.ndarray
    axes: np.ndarray
    reach: np.ndarray
    area: np.ndarray
    normal_stiffness: np.ndarray
    shear_stiffness: np.ndarray


def _with_points(layout, n, points, wall=0, strength=(np.inf, np.inf)):
    """The Layout with these points between two walls, unfolded with this one, from row n on;
    strength: tensile strength and cohesion [Pa]."""
    space, end = layout.space, np.zeros(len(points.first), int)
    one, place = space.house.walls[wall], points.place
    local = (place - [*one.origin, 0.0]) @ one.axes.T
    added = Contacts(
        points.kind + end,
        points.first,
        points.second,
        local[:, 0] + space.left[wall],
        place[:, 2],
        points.area / layout.wall.brick.thickness,
        points.area,
        points.normal_stiffness,
        points.shear_stiffness,
        end + strength[0] == np.inf,
        end + strength[0],
        end + strength[1],
        end + np.inf,
        end + GROUND,
        end + GROUND,
    )
    more = {
        "joint_wall": end - 1,
        "y": local[:, 1],
        "place": place,
        "axes": points.axes,
        "reach": points.reach,
    }
    return replace(
        layout,
        contacts=_inserted(layout.contacts, n, added),
        space=replace(
            space,
            **{
                name: np.concatenate([getattr(space, name)[:n], rows_, getattr(space, name)[n:]])
                for name, rows_ in more.items()
            },
        ),
    )


def _inserted(table, n, added):
    parts = _taken(table, slice(n)), added, _taken(table, slice(n, None))
    return _concatenated(parts)


def _taken(table, index):
    return type(table)(*(getattr(table, one.name)[index] for one in fields(table)))


def _concatenated(tables):
    return type(tables[0])(
        *(
            np.concatenate([getattr(table, one.name) for table in tables])
            for one in fields(tables[0])
        )
    )
