"""The layout of a house in space, and what changes it.

Every contact point of a wall is three through the thickness, at the faces and in the middle, with
shares of 1/6, 4/6 and 1/6 (Simpson's rule): the stiffness in bending is exact, and a dry wall rocks
about its face; with two Gauss points it would fall at 0.58 of that.
"""

from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import ClassVar, NamedTuple

import numpy as np

from damage.elementary import total
from damage.errors import InputError
from damage.house.house import House
from damage.wall.contact_points import Contacts
from damage.wall.kinds import GROUND, SLAB_COURSE, TINY, rows
from damage.wall.layout import Layout, Supports

THROUGH = np.array([-1.0, 0.0, 1.0])
"""Places of contact points through the thickness, over half of it [-]."""
SHARES = np.array([1.0, 4.0, 1.0]) / 6
"""Shares of the area that these contact points have [-]."""
OF_BODIES = "body_wall", "across_inertia", "offset", "depth"
"""Fields of a HouseLayout with a row a body."""
OF_CONTACTS = "joint_wall", "y", "place", "axes", "reach"
"""Fields of a HouseLayout with a row a contact point."""


@dataclass(frozen=True, kw_only=True)
class HouseLayout(Layout):
    """A house laid out: its walls unfolded side by side along x, and where their bodies and contact
    points are in space, z upwards and the ground at z = 0.

    A body's coordinates are those in the plane of its wall, then its displacement across and its
    rotations about the axes along and upwards.

    house: House.
    left: x of the left end of each unfolded wall (n_walls,) [m].
    wall_drift_bodies, drift_heights: of each wall, as drift_bodies and drift_height of its Layout.
    ground_left, ground_right: ends of each support along the heading, from the origin of the plan
        (n_supports,) [m].
    body_wall: number of the wall of each body (n_bodies,).
    across_inertia: of bodies about the axes along the wall and upwards (n_bodies, 2) [kg m2].
    offset: of a body's centre from the wall's middle plane (n_bodies,) [m].
    depth: of a body across the wall (n_bodies,) [m].
    joint_wall: number of the wall of each contact point, -1 between two (n_contacts,).
    y: place of a contact point from the middle plane of its (second) wall (n_contacts,) [m].
    place: of a contact point in the house (n_contacts, 3) [m].
    axes: normal of a contact point, tangent of a wall's shear, and the other tangent (n_contacts,
        3, 3).
    reach: from a contact point to the bodies' inside along the normal (n_contacts,) [m].
    """

    IN_SPACE: ClassVar = True
    HORIZONTAL: ClassVar = (0, 3)
    TRANSLATIONS: ClassVar = (0, 1, 3)
    SHEAR: ClassVar = complex
    MOTION_AXES: ClassVar = 3
    BASE_COLUMNS: ClassVar = ()

    house: House
    left: np.ndarray
    wall_drift_bodies: list
    drift_heights: np.ndarray
    ground_left: np.ndarray
    ground_right: np.ndarray
    body_wall: np.ndarray
    across_inertia: np.ndarray
    offset: np.ndarray
    depth: np.ndarray
    joint_wall: np.ndarray
    y: np.ndarray
    place: np.ndarray
    axes: np.ndarray
    reach: np.ndarray

    @property
    def building(self):
        """The House that is laid out."""
        return self.house

    @property
    def placing(self):
        """{group of a history: arrays} of where bodies and joints are in the house."""
        n = self.n_joints
        joints = self.joint_wall[:n], self.y[:n]
        return {"placing": (self.body_wall, *joints, self.offset, self.depth)}

    @property
    def house_parameters(self):
        """{"house": parameters, for files}, with the places of its unfolded walls and their drift
        heights [m]."""
        parameters = self.house.as_dict()
        for wall, left, height in zip(parameters["walls"], self.left, self.drift_heights):
            wall |= {"left_m": float(left), "drift_height_m": float(height)}
        return {"house": parameters}

    @property
    def ground(self):
        """The Supports along the heading, from where the house begins."""
        start = self.ground_left.min()
        return Supports(self.ground_left - start, self.ground_right - start)

    @cached_property
    def _inner(self):
        # A joint of a wall has three points in a row, through the thickness; one between two walls
        # has three such rows.  A point in the middle is beside itself.
        between = self.joint_wall < 0
        numbers = np.arange(len(self.joint_wall))
        row, place = np.divmod(numbers - np.where(between, self.joint_wall.argmin(), 0), 3)
        return np.column_stack(
            [numbers + 1 - place, numbers + np.where(between, 3 * (1 - row % 3), 0)]
        )

    def inner(self, joints):
        """Contact points beside these, towards the middle of the thickness."""
        return self._inner[joints]

    def box(self, body):
        """Centre (x, y, z) and size of a body, as unfolded (3,) [m]."""
        bodies = self.bodies
        centre = float(bodies.x[body]), float(self.offset[body]), float(bodies.z[body])
        size = bodies.length[body], self.depth[body], bodies.height[body]
        return centre, np.array(size)

    @property
    def of_body(self):
        """Axes of each body's wall: along it, across and upwards, (n_bodies, 3, 3)."""
        return np.array([placed.axes for placed in self.house.walls])[self.body_wall]

    @property
    def centres(self):
        """Centres of the bodies in the house, (n_bodies, 3) [m]."""
        return placed(self.house, self.left, self.body_wall, self.unfolded)

    @property
    def unfolded(self):
        """Centres of the bodies in their unfolded walls (n_bodies, 3) [m]."""
        return np.column_stack([self.bodies.x, self.offset, self.bodies.z])

    def arms(self, body):
        """From the centres of these bodies, one of each contact point, to that, in axes of their
        walls (n_contacts, 3) [m]."""
        away = self.place - self.centres[body]
        return np.einsum("nij,nj->ni", self.of_body[body], away)

    @property
    def places(self):
        """Places as of Layout, in the walls as unfolded."""
        places = []
        normals = []
        for body in (self.contacts.first, self.contacts.second):
            body_index = np.maximum(body, 0)
            centre = self.unfolded[body_index]
            ground = (body < 0)[:, None]
            places.append(np.where(ground, self.place, centre + self.arms(body_index)))
            turned = np.einsum("nij,nj->ni", self.of_body[body_index], self.axes[:, 0])
            normals.append(np.where(ground, self.axes[:, 0], turned))
        return np.stack(places), np.stack(normals), self.reach

    def of_contacts(self, values):
        """Value of each contact point (n_contacts,) of those of the walls, between two the
        lesser."""
        contacts = self.contacts
        ends = values[self.body_wall[np.maximum([contacts.first, contacts.second], 0)]]
        return np.where(self.joint_wall < 0, ends.min(axis=0), values[self.joint_wall])

    @property
    def bases(self):
        """Bases as of Layout, one for each wall."""
        base = self.bodies.course == 0
        return [
            (np.flatnonzero(base & (self.body_wall == number)), float(height))
            for number, height in enumerate(self.drift_heights)
        ]

    def tops(self, motion):
        """Displacement along each wall of its top over the piers (n, n_walls) [m]; motion: (n,
        n_bodies, 3)."""
        return np.column_stack(
            [motion[:, bodies, 0].mean(axis=1) for bodies in self.wall_drift_bodies]
        )

    def across(self, motion):
        """Displacement across each wall of the body where it is largest (n, n_walls) [m]; motion:
        out of plane (n, n_bodies, 3)."""
        result = []
        for number in range(len(self.left)):
            of_wall = motion[:, self.body_wall == number, 0]
            result.append(of_wall[np.arange(len(of_wall)), np.abs(of_wall).argmax(axis=1)])
        return np.column_stack(result)

    def top_and_drift(self, tops, of_base):
        """Top and drift as of Layout, of the wall whose drift is the largest, over the height of
        all drifts."""
        drifts = (tops - of_base) / self.drift_heights
        largest = np.abs(drifts).argmax(axis=1)
        top = drifts[np.arange(len(drifts)), largest] * self.drift_height
        return top, top / self.drift_height

    def _carries(self, level):
        """Bodies that carry a floor: a slab, else the course below in all walls."""
        bodies = self.bodies
        on = np.abs(bodies.z + bodies.height / 2 - level) < self.wall.brick.height / 2
        slabs = on & (bodies.course == SLAB_COURSE)
        if not on.any():
            raise InputError(
                f"--floor-share at {level:g} m: house {self.wall.name} ends at"
                f" {np.max(bodies.z + bodies.height / 2):g} m: expected a level in it; correct it"
            )
        return np.flatnonzero(slabs if slabs.any() else on)

    def height_of_push(self, floor_shares=()):
        """Height of the resultant of a push [m]."""
        return float(total(self.push_shares(floor_shares) * self.bodies.z))

    @property
    def slide_limits(self):
        """Limits as of Layout; joints between two walls, and on a slab, have no end."""
        limits = super().slide_limits
        contacts = self.contacts
        slab = self.depth > self.wall.brick.thickness + TINY
        endless = self.joint_wall < 0
        for end in (contacts.first, contacts.second):
            endless |= (end >= 0) & slab[end]
        limits[:, endless] = np.array([[-np.inf], [np.inf]])
        return limits

    @property
    def rigid_mass(self):
        """Mass and inertia as of Layout, then those out of the plane, (n_bodies, 6) [kg, kg m2]."""
        return np.column_stack([super().rigid_mass, self.bodies.mass, self.across_inertia])

    @property
    def elastic_arrays(self):
        """What stiffness depends on beside the bodies and the contact points' own numbers."""
        return self.place, self.axes

    @property
    def directions(self):
        """What a unit of each coordinate of the first and the second body of each contact adds to
        the relative displacement of second to first along each of its axes, a list of three (2,
        n_contacts, 6)."""
        return [self._rows(direction) for direction in range(3)]

    def _rows(self, direction):
        contacts = self.contacts
        result = np.zeros((2, len(contacts), 6))
        for row, body, sign in (
            (result[0], contacts.first, -1.0),
            (result[1], contacts.second, 1.0),
        ):
            moving = np.flatnonzero(body >= 0)
            bodies = body[moving]
            d = np.einsum("nij,nj->ni", self.of_body[bodies], self.axes[moving, direction])
            turned = np.cross(self.arms(np.maximum(body, 0))[moving], d)
            row[moving] = sign * np.column_stack(
                [d[:, 0], d[:, 2], -turned[:, 1], d[:, 1], turned[:, 0], turned[:, 2]]
            )
        return result


class Points(NamedTuple):
    """Contact points between walls, as the fields of Contacts and of a HouseLayout."""

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
    bodies = layout.bodies
    axes = layout.house.walls[wall].axes
    size = np.column_stack([bodies.length, layout.depth, bodies.height])
    half = np.abs(np.einsum("nij,ni,kj->nk", layout.of_body, size / 2, axes))
    centre = layout.centres @ axes.T
    return centre - half, centre + half


def without(layout, drop):
    """The HouseLayout without these bodies (n_bodies,) and their contact points."""
    contacts = layout.contacts
    kept = ~drop
    ground = np.arange(len(layout.supports))
    new = np.append(np.cumsum(kept) - 1, GROUND - ground)
    ends = [rows(end, len(drop)) for end in (contacts.first, contacts.second)]
    stay = np.append(kept, ground >= 0)[ends].all(axis=0)
    drift = [new[_remaining(layout, bodies, kept)] for bodies in layout.wall_drift_bodies]
    return replace(
        layout,
        bodies=taken(layout.bodies, kept),
        contacts=taken(replace(contacts, first=new[ends[0]], second=new[ends[1]]), stay),
        n_bricks=int(kept[: layout.n_bricks].sum()),
        n_joints=int(stay[: layout.n_joints].sum()),
        drift_bodies=np.concatenate(drift),
        wall_drift_bodies=drift,
        **{name: getattr(layout, name)[kept] for name in OF_BODIES},
        **{name: getattr(layout, name)[stay] for name in OF_CONTACTS},
    )


def _remaining(layout, bodies, kept):
    """Bodies of a wall's drift that are kept (n,), else all that are kept of their course."""
    if kept[bodies].any():
        return bodies[kept[bodies]]
    alike = layout.bodies.course == layout.bodies.course[bodies[0]]
    return np.flatnonzero(kept & alike & (layout.body_wall == layout.body_wall[bodies[0]]))


def with_points(layout, n, points, wall, strength):
    """The HouseLayout with these points between two walls, unfolded with this one, from row n on;
    strength: tensile strength, cohesion and compressive strength [Pa]."""
    end = np.zeros(len(points.first), int)
    one = layout.house.walls[wall]
    place = points.place
    local = (place - [*one.origin, 0.0]) @ one.axes.T
    added = Contacts(
        points.kind + end,
        points.first,
        points.second,
        local[:, 0] + layout.left[wall],
        place[:, 2],
        points.area / layout.wall.brick.thickness,
        points.area,
        points.normal_stiffness,
        points.shear_stiffness,
        end + strength[1] == np.inf,
        *(end + value for value in strength),
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
        **{
            name: np.concatenate([getattr(layout, name)[:n], rows_, getattr(layout, name)[n:]])
            for name, rows_ in more.items()
        },
    )


def _inserted(table, n, added):
    parts = taken(table, slice(n)), added, taken(table, slice(n, None))
    return concatenated(parts)


def taken(table, index):
    return type(table)(*(getattr(table, attribute.name)[index] for attribute in fields(table)))


def concatenated(tables):
    return type(tables[0])(
        *(
            np.concatenate([getattr(table, attribute.name) for table in tables])
            for attribute in fields(tables[0])
        )
    )
