"""The layout of a house in space, and what changes it.

Every contact point of a wall is three through the thickness, at the faces and in the middle, with
shares of 1/6, 4/6 and 1/6 (Simpson's rule): the stiffness in bending is exact, and a dry wall rocks
about its face; with two Gauss points it would fall at 0.58 of that.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import ClassVar

import numpy as np

from damage.elementary import total
from damage.errors import InputError
from damage.house.house import House
from damage.house.placing import Placing
from damage.wall.contact_points import Contacts
from damage.wall.kinds import GROUND, SLAB_COURSE, TINY, rows
from damage.wall.layout import Bodies, Layout, Supports
from damage.wall.tables import concatenated, taken

THROUGH = np.array([-1.0, 0.0, 1.0])
"""Places of contact points through the thickness, over half of it [-]."""
SHARES = np.array([1.0, 4.0, 1.0]) / 6
"""Shares of the area that these contact points have [-]."""


@dataclass(frozen=True)
class HouseBodies(Bodies):
    """Bodies of a house, x along their unfolded walls; with wall: number of the wall of each,
    across_inertia: about the axes along the wall and upwards (n_bodies, 2) [kg m2], offset: of the
    centre from the wall's middle plane [m], depth: across the wall [m]."""

    wall: np.ndarray
    across_inertia: np.ndarray
    offset: np.ndarray
    depth: np.ndarray


@dataclass(frozen=True)
class HouseContacts(Contacts):
    """Contact points of a house, x along their unfolded walls; with wall: number of the wall of
    each, -1 between two, y: place from the middle plane of its (second) wall [m], place: in the
    house (n_contacts, 3) [m], axes: normal, tangent of a wall's shear, and the other tangent
    (n_contacts, 3, 3)."""

    wall: np.ndarray
    y: np.ndarray
    place: np.ndarray
    axes: np.ndarray


@dataclass(frozen=True, kw_only=True)
class HouseLayout(Layout):
    """A house laid out: its walls unfolded side by side along x, HouseBodies and HouseContacts in
    space, z upwards and the ground at z = 0.

    A body's coordinates are those in the plane of its wall, then its displacement across and its
    rotations about the axes along and upwards.

    house: House.
    placing: Placing of its walls.
    wall_drift_bodies, drift_heights: of each wall, as drift_bodies and drift_height of its Layout.
    ground_left, ground_right: ends of each support along the heading, from the origin of the plan
        (n_supports,) [m].
    """

    IN_SPACE: ClassVar = True
    HORIZONTAL: ClassVar = (0, 3)
    TRANSLATIONS: ClassVar = (0, 1, 3)
    SHEAR: ClassVar = complex
    MOTION_AXES: ClassVar = 3
    BASE_COLUMNS: ClassVar = ()

    house: House
    placing: Placing
    wall_drift_bodies: list
    drift_heights: np.ndarray
    ground_left: np.ndarray
    ground_right: np.ndarray
    bodies: HouseBodies
    contacts: HouseContacts

    @property
    def building(self):
        """The House that is laid out."""
        return self.house

    @property
    def more_tables(self):
        """{group of a history: arrays} of where bodies and joints are in the house."""
        n = self.n_joints
        bodies = self.bodies
        joints = self.contacts.wall[:n], self.contacts.y[:n]
        return {"placing": (bodies.wall, *joints, bodies.offset, bodies.depth)}

    @property
    def house_parameters(self):
        """{"house": parameters, for files}, with the places of its unfolded walls and their drift
        heights [m]."""
        parameters = self.house.as_dict()
        for wall, left, height in zip(parameters["walls"], self.placing.left, self.drift_heights):
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
        wall = self.contacts.wall
        between = wall < 0
        numbers = np.arange(len(wall))
        row, place = np.divmod(numbers - np.where(between, wall.argmin(), 0), 3)
        return np.column_stack(
            [numbers + 1 - place, numbers + np.where(between, 3 * (1 - row % 3), 0)]
        )

    def inner(self, joints):
        """Contact points beside these, towards the middle of the thickness."""
        return self._inner[joints]

    def box(self, body):
        """Centre (x, y, z) and size of a body, as unfolded (3,) [m]."""
        bodies = self.bodies
        centre = float(bodies.x[body]), float(bodies.offset[body]), float(bodies.z[body])
        size = bodies.length[body], bodies.depth[body], bodies.height[body]
        return centre, np.array(size)

    @property
    def of_body(self):
        """Axes of each body's wall: along it, across and upwards, (n_bodies, 3, 3)."""
        return self.placing.axes[self.bodies.wall]

    @property
    def centres(self):
        """Centres of the bodies in the house, (n_bodies, 3) [m]."""
        return self.placing.in_house(self.bodies.wall, self.unfolded[:, None])[:, 0]

    @property
    def unfolded(self):
        """Centres of the bodies in their unfolded walls (n_bodies, 3) [m]."""
        return np.column_stack([self.bodies.x, self.bodies.offset, self.bodies.z])

    def arms(self, body):
        """From the centres of these bodies, one of each contact point, to that, in axes of their
        walls (n_contacts, 3) [m]."""
        away = self.contacts.place - self.centres[body]
        return np.einsum("nij,nj->ni", self.of_body[body], away)

    @property
    def places(self):
        """Places as of Layout, in the walls as unfolded."""
        contacts = self.contacts
        normal = contacts.axes[:, 0]
        places = []
        normals = []
        for body in (contacts.first, contacts.second):
            body_index = np.maximum(body, 0)
            centre = self.unfolded[body_index]
            ground = (body < 0)[:, None]
            places.append(np.where(ground, contacts.place, centre + self.arms(body_index)))
            turned = np.einsum("nij,nj->ni", self.of_body[body_index], normal)
            normals.append(np.where(ground, normal, turned))
        return np.stack(places), np.stack(normals), contacts.reach

    def of_contacts(self, values):
        """Value of each contact point (n_contacts,) of those of the walls, between two the
        lesser."""
        contacts = self.contacts
        ends = values[self.bodies.wall[np.maximum([contacts.first, contacts.second], 0)]]
        return np.where(contacts.wall < 0, ends.min(axis=0), values[contacts.wall])

    @property
    def bases(self):
        """Bases as of Layout, one for each wall."""
        base = self.bodies.course == 0
        return [
            (np.flatnonzero(base & (self.bodies.wall == number)), float(height))
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
        walls = range(len(self.walls))
        return np.hstack([_largest(motion[:, self.bodies.wall == wall, 0]) for wall in walls])

    def top_and_drift(self, tops, of_base):
        """Top and drift as of Layout, of the wall whose drift is the largest, over the height of
        all drifts."""
        top = _largest((tops - of_base) / self.drift_heights)[:, 0] * self.drift_height
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
        slab = self.bodies.depth > self.wall.brick.thickness + TINY
        endless = contacts.wall < 0
        for end in (contacts.first, contacts.second):
            endless |= (end >= 0) & slab[end]
        limits[:, endless] = [[-np.inf], [np.inf]]
        return limits

    @property
    def rigid_mass(self):
        """Mass and inertia as of Layout, then those out of the plane, (n_bodies, 6) [kg, kg m2]."""
        return np.column_stack([super().rigid_mass, self.bodies.mass, self.bodies.across_inertia])

    @property
    def elastic_arrays(self):
        """What stiffness depends on beside the bodies and the contact points' own numbers."""
        return self.contacts.place, self.contacts.axes

    def _by_unit(self, side, points, direction):
        contacts = self.contacts
        body = (contacts.first, contacts.second)[side]
        axis = contacts.axes[points, direction]
        d = np.einsum("nij,nj->ni", self.of_body[body[points]], axis)
        turned = np.cross(self.arms(np.maximum(body, 0))[points], d)
        return np.column_stack(
            [d[:, 0], d[:, 2], -turned[:, 1], d[:, 1], turned[:, 0], turned[:, 2]]
        )


def _largest(values):
    """The value of each row (n, m) that is the largest, whatever its sign, (n, 1)."""
    return np.take_along_axis(values, np.abs(values).argmax(axis=1, keepdims=True), axis=1)


def boxes(layout, wall):
    """Lowest and highest corners of all bodies, of walls at right angles, in the axes of this wall,
    twice (n_bodies, 3) [m]."""
    bodies = layout.bodies
    axes = layout.placing.axes[wall]
    size = np.column_stack([bodies.length, bodies.depth, bodies.height])
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
    )


def _remaining(layout, drift, kept):
    """Bodies of a wall's drift that are kept (n,), else all that are kept of their course."""
    if kept[drift].any():
        return drift[kept[drift]]
    bodies = layout.bodies
    alike = bodies.course == bodies.course[drift[0]]
    return np.flatnonzero(kept & alike & (bodies.wall == bodies.wall[drift[0]]))


def with_points(layout, n, wall, **columns):
    """The HouseLayout with contact points between two walls, unfolded with this one, from row n on.

    columns: arrays, or one number for all, of the fields of HouseContacts that do not follow from
    `place` and `area`.
    """
    place = columns["place"]
    local = layout.placing.in_wall(wall, place)
    columns |= {
        "x": local[:, 0],
        "y": local[:, 1],
        "z": place[:, 2],
        "length": columns["area"] / layout.wall.brick.thickness,
        "elastic": columns["cohesion"] == np.inf,
        "wall": -1,
    }
    added = HouseContacts(
        **{
            name: np.broadcast_to(values, (len(place), *np.shape(values)[1:]))
            for name, values in columns.items()
        }
    )
    contacts = layout.contacts
    parts = taken(contacts, slice(n)), added, taken(contacts, slice(n, None))
    return replace(layout, contacts=concatenated(parts))
