"""The layout of a house: those of its walls, laid out each as by itself, put together in space.

Its x is that of the walls unfolded side by side in their order, so that all that draws or measures
a wall in its plane reads it.  `Space` says where bodies and contact points are in plan.  Every
contact point of a wall is three through the thickness, at the faces and in the middle, with shares
of 1/6, 4/6 and 1/6 (Simpson's rule): the stiffness in bending is exact, and a dry wall rocks about
its face; with two Gauss points it would fall at 0.58 of that.

Where walls are toothed, the half brick at the end of a course makes room for the whole one of the
other wall.  Contact points between two walls are where their bricks touch, 3 x 3 on each face.
"""

from dataclasses import dataclass, fields, replace
from itertools import combinations, product

import numpy as np

from damage.errors import InputError
from damage.wall.contact_points import Contacts
from damage.wall.house import House
from damage.wall.kinds import BED, GROUND, HEAD, TINY, rows
from damage.wall.layout import Cells, Supports, lay_out

THROUGH, SHARES = np.array([-1.0, 0.0, 1.0]), np.array([1.0, 4.0, 1.0]) / 6
"""Contact points through the thickness: places over half of it, and shares of the area [-]."""
GAP_M = 0.5
"""Between two walls that are unfolded."""
OF_CONTACTS = "joint_wall", "y", "place", "axes", "reach"
"""Fields of a Space with a row a contact point."""


@dataclass(frozen=True)
class Space:
    """Where the bodies and contact points of a house are, z upwards and the ground at z = 0.

    house: House; left: x of the left end of each unfolded wall (n_walls,) [m]; drift_bodies,
    drift_height: of each wall, as of its Layout.
    wall: number of that of a body (n_bodies,); across_inertia: about the axes along the wall and
    upwards (n_bodies, 2) [kg m2]; joint_wall: number of that of a contact point, -1 between two
    (n_contacts,); y: its place from the middle plane of its (second) wall [m]; place: in the house
    (n_contacts, 3) [m]; axes: its normal, the tangent of a wall's shear, and the other one
    (n_contacts, 3, 3); reach: from there to the bodies' inside along the normal (n_contacts,) [m].
    """

    house: House
    left: np.ndarray
    drift_bodies: list
    drift_height: np.ndarray
    wall: np.ndarray
    across_inertia: np.ndarray
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
    def of_body(self):
        """Axes of each body's wall: along it, across and upwards, (n_bodies, 3, 3)."""
        return np.array([one.axes for one in self.house.walls])[self.wall]

    def centres(self, bodies):
        """Of the bodies in the house, (n_bodies, 3) [m]."""
        local = np.column_stack([bodies.x, np.zeros(len(bodies)), bodies.z])
        return _placed(self.house, self.left, self.wall, local)

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
        for number, one in enumerate(house.walls)
    ]
    options = parts[0].options
    for what, refused in (
        ("--bricks deformable", options.bricks != "rigid"),
        ("--supports bricks", options.supports != "one"),
        ("--soil", options.soil != "rigid"),
    ):
        if refused:
            raise InputError(
                f"house {house.name} with {what}: expected rigid bricks on rigid ground; leave it"
                " out"
            )
    layout = _together(house, parts)
    met = {tuple(sorted(map(house.names.index, one.walls))): one.kind for one in house.corners}
    dropped = np.zeros(len(layout.bodies), bool)
    for pair in combinations(range(len(parts)), 2):
        dropped |= _making_room(layout, *pair, met.get(pair))
    layout = _without(layout, dropped)
    for pair in met:
        layout = _joined_at(layout, *pair)
    return layout


# --- together -------------------------------------------------------------------------------------


def _together(house, parts):
    """The Layout of walls beside each other, with three contact points through the thickness."""
    lengths = np.array([part.wall.length for part in parts])
    left = np.append(0.0, np.cumsum(lengths + GAP_M))[:-1]
    first_body = np.append(0, np.cumsum([len(part.bodies) for part in parts]))
    thickness, bodies, contacts = house.masonry.brick.thickness, [], []
    for part, start, offset in zip(parts, left, first_body):
        table = part.contacts
        bodies.append(replace(part.bodies, x=part.bodies.x + start))
        contacts.append(
            replace(
                table,
                x=table.x + start,
                first=np.where(table.first < 0, GROUND, table.first + offset),
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
        first=np.where(table.first < 0, GROUND, new[table.first]),
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
    space = Space(
        house,
        left,
        [new[part.drift_bodies + offset] for part, offset in zip(parts, first_body)],
        np.array([part.drift_height for part in parts]),
        wall,
        _across_inertia(body, thickness),
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
        supports=Supports(np.array([0.0]), left[-1:] + lengths[-1:]),
        space=space,
    )


def _across_inertia(bodies, thickness):
    """Moments of inertia about the axes along the wall and upwards (n_bodies, 2) [kg m2]: that of
    the layout about the third axis, by the ratio of a box's."""
    third = bodies.length**2 + bodies.height**2
    own = np.column_stack([bodies.height, bodies.length]) ** 2 + thickness**2
    return (bodies.inertia / third)[:, None] * own


# --- corners --------------------------------------------------------------------------------------


def _common(layout, one, other):
    """Boxes that the bodies of two walls at right angles have in common, in axes of the first:
    lowest and highest corners (n_pairs, 3) [m], turned inside out where two are apart, both bodies
    (n_pairs,), and the centres' distances (n_pairs, 3)."""
    space, bodies = layout.space, layout.bodies
    thick = np.full(len(bodies), layout.wall.brick.thickness)
    size = np.column_stack([bodies.length, thick, bodies.height])
    size[space.wall == other] = size[space.wall == other][:, [1, 0, 2]]
    centre = space.centres(bodies) @ space.house.walls[one].axes.T
    low, high = centre - size / 2, centre + size / 2
    i, j = (np.flatnonzero(space.wall == number) for number in (one, other))
    i, j = (index.ravel() for index in np.meshgrid(i, j, indexing="ij"))
    common = np.maximum(low[i], low[j]), np.minimum(high[i], high[j])
    return *common, i, j, centre[j] - centre[i]


def _making_room(layout, one, other, kind):
    """Which bodies (n_bodies,) make room for those of another wall; kind: of their corner, None
    without one."""
    space, dropped = layout.space, np.zeros(len(layout.bodies), bool)
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
        dropped[a if halves[a] else b] = True
    return dropped


def _without(layout, drop):
    """The Layout without these bodies (n_bodies,) and their contact points."""
    space, contacts, kept = layout.space, layout.contacts, ~drop
    new = np.append(np.cumsum(kept) - 1, GROUND)
    ends = [rows(end, len(drop)) for end in (contacts.first, contacts.second)]
    stay = np.append(kept, True)[ends].all(axis=0)
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
            **{name: getattr(space, name)[kept] for name in ("wall", "across_inertia")},
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
    end = np.zeros(len(first), int)
    local = (place - [*space.house.walls[one].origin, 0.0]) @ axes.T
    added = Contacts(
        np.where(normal == 2, BED, HEAD),
        first,
        second,
        local[:, 0] + space.left[one],
        place[:, 2],
        area / brick.thickness,
        area,
        *stiffness,
        end > 0,
        end + joint.tensile_strength,
        end + joint.cohesion,
        end + np.inf,
        end + GROUND,
        end + GROUND,
    )
    n = layout.n_joints
    more = {
        "joint_wall": end - 1,
        "y": local[:, 1],
        "place": place,
        "axes": turned,
        "reach": distance / 2,
    }
    return replace(
        layout,
        contacts=_inserted(layout.contacts, n, added),
        n_joints=n + len(end),
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
