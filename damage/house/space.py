"""Where the bodies and contact points of a house are in space, and what changes its layout.

Every contact point of a wall is three through the thickness, at the faces and in the middle, with
shares of 1/6, 4/6 and 1/6 (Simpson's rule): the stiffness in bending is exact, and a dry wall rocks
about its face; with two Gauss points it would fall at 0.58 of that.
"""

from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from damage.house.house import House
from damage.wall.contact_points import Contacts
from damage.wall.kinds import GROUND, rows
from damage.wall.layout import Supports

THROUGH, SHARES = np.array([-1.0, 0.0, 1.0]), np.array([1.0, 4.0, 1.0]) / 6
"""Contact points through the thickness: places over half of it, and shares of the area [-]."""
OF_BODIES = "wall", "across_inertia", "offset", "depth"
OF_CONTACTS = "joint_wall", "y", "place", "axes", "reach"
"""Fields of a Space with a row a body, or a contact point."""


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

    @cached_property
    def inner(self):
        """Rows of the contact points beside each one, towards the middle of its joint; its own row
        in the middle, (n_contacts, 2).

        A joint of a wall has three points in a row, through the thickness; one between two walls
        has three such rows.
        """
        between, own = self.joint_wall < 0, np.arange(len(self.joint_wall))
        row, place = np.divmod(own - np.where(between, self.joint_wall.argmin(), 0), 3)
        return np.column_stack([own + 1 - place, own + np.where(between, 3 * (1 - row % 3), 0)])

    @property
    def of_body(self):
        """Axes of each body's wall: along it, across and upwards, (n_bodies, 3, 3)."""
        return np.array([one.axes for one in self.house.walls])[self.wall]

    def centres(self, bodies):
        """Of the bodies in the house, (n_bodies, 3) [m]."""
        return placed(self.house, self.left, self.wall, self.unfolded(bodies))

    def unfolded(self, bodies):
        """Centres of the bodies in their unfolded walls (n_bodies, 3) [m]."""
        return np.column_stack([bodies.x, self.offset, bodies.z])

    def arms(self, bodies, body):
        """From the centres of these bodies, one of each contact point, to that, in axes of their
        walls (n_contacts, 3) [m]."""
        away = self.place - self.centres(bodies)[body]
        return np.einsum("nij,nj->ni", self.of_body[body], away)

    def lesser(self, contacts, values):
        """Of each contact point the value of its wall, between two the lesser; values:
        (n_walls,)."""
        ends = values[self.wall[np.maximum([contacts.first, contacts.second], 0)]]
        return np.where(self.joint_wall < 0, ends.min(axis=0), values[self.joint_wall])

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
        """`damage.linear.modes.kinematic_rows` in space, (2, n_contacts, 6).

        Of a body's displacement along its wall, upwards and rotation from x towards z,
        displacement across and rotations about the axes along and upwards; direction: 0 to 2, an
        axis of the contact points.
        """
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


def placed(house, left, wall, local):
    """Places in the house of (n, 3) [m] in unfolded walls of these numbers (n,)."""
    origins = np.array([(*one.origin, 0.0) for one in house.walls])
    axes = np.array([one.axes for one in house.walls])
    local = local - np.outer(left[wall], [1.0, 0.0, 0.0])
    return origins[wall] + np.einsum("ni,nij->nj", local, axes[wall])


def boxes(layout, wall):
    """Lowest and highest corners of all bodies, of walls at right angles, in the axes of this wall,
    twice (n_bodies, 3) [m]."""
    space, bodies = layout.space, layout.bodies
    axes = space.house.walls[wall].axes
    size = np.column_stack([bodies.length, space.depth, bodies.height])
    half = np.abs(np.einsum("nij,ni,kj->nk", space.of_body, size / 2, axes))
    centre = space.centres(bodies) @ axes.T
    return centre - half, centre + half


def without(layout, drop):
    """The Layout without these bodies (n_bodies,) and their contact points."""
    space, contacts, kept = layout.space, layout.contacts, ~drop
    ground = np.arange(len(layout.supports))
    new = np.append(np.cumsum(kept) - 1, GROUND - ground)
    ends = [rows(end, len(drop)) for end in (contacts.first, contacts.second)]
    stay = np.append(kept, ground >= 0)[ends].all(axis=0)
    drift = [new[_remaining(layout, one, kept)] for one in space.drift_bodies]
    return replace(
        layout,
        bodies=taken(layout.bodies, kept),
        contacts=taken(replace(contacts, first=new[ends[0]], second=new[ends[1]]), stay),
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


def with_points(layout, n, points, wall, strength):
    """The Layout with these points between two walls, unfolded with this one, from row n on;
    strength: tensile strength, cohesion and compressive strength [Pa]."""
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
        end + strength[1] == np.inf,
        *(end + one for one in strength),
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
    parts = taken(table, slice(n)), added, taken(table, slice(n, None))
    return concatenated(parts)


def taken(table, index):
    return type(table)(*(getattr(table, one.name)[index] for one in fields(table)))


def concatenated(tables):
    return type(tables[0])(
        *(
            np.concatenate([getattr(table, one.name) for table in tables])
            for one in fields(tables[0])
        )
    )
