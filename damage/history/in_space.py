"""Bodies and contact points of a history in x, y and z, at rest and as they move."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy  # spatial where it is used: it starts slowly

from damage.history.moments import support_motion
from damage.history.parts import motion_vectors
from damage.history.reader import History
from damage.house.placing import BOX
from damage.wall.geometry import body_corners, joint_segments, tributary_ends


def motion_of(history, snapshot):
    """Motion of the bodies in a snapshot in the planes of their walls, None for at rest, (n_bodies,
    3) [m, m, rad]."""
    return (
        np.zeros((len(history.bodies), 3))
        if snapshot is None
        else history.displacement[snapshot].astype(float)
    )


@dataclass(frozen=True)
class InPlane:
    """What the History of a plane wall has in space, the joints on its front face."""

    history: History

    @property
    def _half(self):
        """Half the thickness [m]."""
        return self.history.masonry_wall.brick.thickness / 2

    def corners(self, snapshot):
        """Corners of the bodies in a snapshot, as of `InSpace`."""
        corners = body_corners(self.history.bodies, motion_of(self.history, snapshot))
        return np.concatenate([_at(corners, y) for y in (self._half, -self._half)], axis=1)

    def ends(self, snapshot):
        """Ends of the contact points in a snapshot, as of `InSpace`."""
        history = self.history
        motion = motion_of(history, snapshot)
        supports = support_motion(history, snapshot)
        ends = joint_segments(history.joints, history.bodies, motion, supports=supports)
        return _at(ends, -self._half)


def _at(points, y):
    """Points (..., 2) of the wall's plane as (..., 3) at a depth y [m]."""
    return np.stack([points[..., 0], np.full(points.shape[:-1], y), points[..., 1]], axis=-1)


@dataclass(frozen=True)
class InSpace:
    """What the History of a house has in space.  Bodies -1 are the ground, which rests."""

    history: History

    @cached_property
    def centres(self):
        """Centres of the bodies, then of the ground, (n_bodies + 1, 3) [m]."""
        bodies = self.history.bodies
        house = self.history.house
        local = np.column_stack([bodies["x_m"], house.body_y_m, bodies["z_m"]])
        centres = self.history.placing.in_house(house.body_wall, local[:, None])[:, 0]
        return np.vstack([centres, np.zeros(3)])

    @cached_property
    def boxes(self):
        """Corners of the bodies at rest, (n_bodies, 8, 3) [m], as of BOX."""
        bodies = self.history.bodies
        house = self.history.house
        half = np.column_stack([bodies["length_m"], house.body_depth_m, bodies["height_m"]]) / 2
        turned = self.history.placing.turned(house.body_wall, half[:, None] * BOX)
        return self.centres[:-1, None] + turned

    @cached_property
    def joint_bodies(self):
        """Both bodies of each contact point, (n_joints, 2)."""
        return np.maximum(self.history.joints[["first_body", "second_body"]].to_numpy(), -1)

    @cached_property
    def joint_ends(self):
        """Ends of the tributary length of each contact point at rest, (n_joints, 2, 3) [m]."""
        joints = self.history.joints
        house = self.history.house
        ends = tributary_ends(joints)
        y = np.broadcast_to(house.joint_y_m[:, None], ends.shape[:2])
        # a place between two walls is that in the first of them
        first = house.body_wall[self.joint_bodies].min(axis=1)
        wall = np.where(house.joint_wall < 0, first, house.joint_wall)
        return self.history.placing.in_house(wall, np.stack([ends[..., 0], y, ends[..., 1]], -1))

    def motion(self, snapshot):
        """Displacement [m] and rotation [rad] of the bodies and the ground in a snapshot, None for
        at rest: two of (n_bodies + 1, 3)."""
        if snapshot is None:
            return np.zeros((2, *self.centres.shape))
        history = self.history
        out_of_plane = history.house.out_of_plane[snapshot].astype(float)
        vectors = motion_vectors(motion_of(history, snapshot), out_of_plane)
        motion = history.placing.turned(history.house.body_wall, vectors)
        return np.concatenate([motion, np.zeros((1, 2, 3))]).swapaxes(0, 1)

    def moved(self, body, places, snapshot, magnify=1.0):
        """Where places (n, k, 3) [m] go with the bodies (n,) that they are fixed to, when the
        motion of these in a snapshot is magnified."""
        shift, turn = magnify * self.motion(snapshot)
        turned = scipy.spatial.transform.Rotation.from_rotvec(turn).as_matrix()
        arms = places - self.centres[body, None]
        return places + shift[body, None] + np.einsum("nij,nkj->nki", turned[body], arms) - arms

    def corners(self, snapshot, magnify=1.0):
        """Corners of the bodies in a snapshot, (n_bodies, 8, 3) [m]."""
        return self.moved(np.arange(len(self.boxes)), self.boxes, snapshot, magnify)

    def ends(self, snapshot, magnify=1.0, joints=slice(None)):
        """Ends of contact points in a snapshot, half way between both bodies, (n, 2, 3) [m]."""
        bodies = self.joint_bodies[joints]
        places = self.joint_ends[joints]
        return sum(self.moved(body, places, snapshot, magnify) for body in bodies.T) / 2
