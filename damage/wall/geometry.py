"""Where bodies and joints of a history are when the bodies move; its tables `joints` and `bodies`
in, points out."""

from typing import NamedTuple

import numpy as np
import pandas as pd

from damage.elementary import hypot
from damage.wall.kinds import CAP_COURSE, KINDS, LINTEL_COURSE, SIDE_COURSE, SLAB_COURSE, TINY, rows
from damage.wall.kinematics import rigid_displacement

_CORNERS = np.array([(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)])


def body_table(layout):
    """The bodies of a Layout as `History.bodies` has them: x_m, z_m, length_m, height_m, course."""
    bodies = layout.bodies
    return pd.DataFrame(
        {
            "x_m": bodies.x,
            "z_m": bodies.z,
            "length_m": bodies.length,
            "height_m": bodies.height,
            "course": bodies.course,
        }
    )


def kinds_of_bodies(course):
    """Words "bricks", "masses", "slabs" or "lintels" of bodies (n,) by their course; bricks of an
    arch are bricks.

    >>> kinds_of_bodies([0, -1, -2, -3, -4, -5]).tolist()
    ['bricks', 'masses', 'slabs', 'lintels', 'bricks', 'masses']
    """
    course = np.asarray(course)
    return np.select(
        [
            np.isin(course, (CAP_COURSE, SIDE_COURSE)),
            course == SLAB_COURSE,
            course == LINTEL_COURSE,
        ],
        ["masses", "slabs", "lintels"],
        "bricks",
    )


def cuts_of_lintels(joints, bodies):
    """Which joints are cuts between the segments of a lintel, bool (n_joints,)."""
    kinds = kinds_of_bodies(bodies["course"])
    return (joints["kind"] == "brick").to_numpy() & (kinds[joints["second_body"]] == "lintels")


def joint_table(layout):
    """The joints of a Layout as `History.joints` has them: kind, bodies, x_m, z_m, length_m,
    elastic."""
    contacts = layout.contacts
    n = layout.n_joints
    return pd.DataFrame(
        {
            "kind": np.array(KINDS)[contacts.kind[:n]],
            "first_body": contacts.first[:n],
            "second_body": contacts.second[:n],
            "x_m": contacts.x[:n],
            "z_m": contacts.z[:n],
            "length_m": contacts.length[:n],
            "elastic": contacts.elastic[:n],
        }
    )


class SupportMotion(NamedTuple):
    """left, right: of the part of the base that each support carries (n_supports,) [m]; motion:
    (n_supports, 3) of its middle [m, m, rad]."""

    left: np.ndarray
    right: np.ndarray
    motion: np.ndarray

    @property
    def x(self):
        """Reference points along the base (n_supports,) [m]."""
        return (self.left + self.right) / 2


AT_REST = SupportMotion(np.zeros(1), np.zeros(1), np.zeros((1, 3)))


def displaced(bodies, motion, body, points, magnify=1.0, supports=AT_REST):
    """Where points fixed to bodies go when the bodies' motion is magnified.

    motion: (n_bodies, 3) displacement of the centres [m] and rotation x towards z [rad];
    body: (n,) index of the body of each row of points, negative of a support; points: (n, k, 2)
    [m]; supports: SupportMotion; AT_REST is of however many.
    Returns (n, k, 2) [m].
    """
    row = np.minimum(rows(body, len(bodies)), len(bodies) + len(supports.x) - 1)
    ux, uz, turn = (np.vstack([motion, supports.motion])[row] * magnify).T[..., None]
    base = np.column_stack([supports.x, np.zeros(len(supports.x))])
    centre = np.vstack([bodies[["x_m", "z_m"]].to_numpy(), base])[row][:, None]
    return points + np.stack(
        rigid_displacement(ux, uz, turn, *np.moveaxis(points - centre, 2, 0)), axis=2
    )


def body_corners(bodies, motion=None, magnify=1.0):
    """Corners of every body after its magnified motion, (n_bodies, 4, 2) [m]; motion: None for
    bodies at rest."""
    motion = np.zeros((len(bodies), 3)) if motion is None else motion
    centre = bodies[["x_m", "z_m"]].to_numpy()[:, None]
    size = bodies[["length_m", "height_m"]].to_numpy()[:, None]
    return displaced(bodies, motion, np.arange(len(bodies)), centre + size * _CORNERS, magnify)


def support_outlines(supports, depth, magnify=1.0):
    """Corners of the parts of the base that supports carry after their magnified motion, down to a
    depth [m]: (n_supports, 4, 2) [m], counter-clockwise from the lower left.

    supports: SupportMotion.
    """
    half = (supports.right - supports.left)[:, None] / 2
    x = half * (-1, 1, 1, -1)
    z = np.array([[-depth, -depth, 0.0, 0.0]]) + np.zeros_like(half)
    ux, uz, rotation = (supports.motion * magnify).T[..., None]
    dx, dz = rigid_displacement(ux, uz, rotation, x, z)
    return np.stack([supports.x[:, None] + x + dx, z + dz], axis=2)


def joint_segments(joints, bodies, motion, magnify=1.0, supports=AT_REST):
    """Both ends of every joint's tributary length after the magnified motion, (n_joints, 2, 2)
    [m]."""
    ends = tributary_ends(joints)
    first, second = _on_both_sides(joints, bodies, motion, ends, magnify, supports)
    return (first + second) / 2


def joint_gaps(joints, bodies, motion, supports=AT_REST):
    """How far the middles of every joint's two sides are apart after the motion, (n_joints,)
    [m]."""
    middle = tributary_ends(joints).mean(axis=1, keepdims=True)
    first, second = _on_both_sides(joints, bodies, motion, middle, 1.0, supports)
    return hypot(*(second - first)[:, 0].T)


def _on_both_sides(joints, bodies, motion, points, magnify, supports):
    """Where points of every joint go with its first and its second body, as of `displaced`."""
    return [
        displaced(bodies, motion, joints[name].to_numpy(), points, magnify, supports)
        for name in ("first_body", "second_body")
    ]


def tributary_ends(joints):
    """Ends of the tributary lengths before any motion, (n_joints, 2, 2) [m]: bed joints along x,
    head joints and bricks' cuts along z, around the contact point, or farther in where there are
    two in a cell.  Of the points through the thickness of a house each has the whole length."""
    if "share" in joints:
        return _of_each_layer(joints)
    point = joints[["x_m", "z_m"]].to_numpy()
    length = joints["length_m"].to_numpy()
    is_head = joints["kind"].isin(("head", "brick")).to_numpy()
    along = np.where(is_head[:, None], (0.0, 1.0), (1.0, 0.0))
    middle = point + along * (_inwards(joints, point, length) * length / 2)[:, None]
    return middle[:, None] + np.array([-0.5, 0.5])[:, None] * (along * length[:, None])[:, None]


def _of_each_layer(joints):
    """`tributary_ends` of points with a `share` of the thickness, layer by layer at the same
    side."""
    ends = np.empty((len(joints), 2, 2))
    for layer in (-1, 0, 1):
        chosen = (np.sign(joints["y_m"]) == layer).to_numpy()
        ends[chosen] = tributary_ends(in_one_layer(joints[chosen]))
    return ends


def in_one_layer(joints):
    """Joints with a `share` of the thickness as those of a plane wall, of their whole lengths."""
    whole = joints["length_m"] / joints["share"]
    return joints.assign(length_m=whole).drop(columns=["share", "y_m"])


def _inwards(joints, point, length):
    """How far, in half lengths, the middle of its length lies from each point: inwards for the two
    of a pair of facing cells, at their ends or at their Gauss points; 0 for a point in the middle
    of its length.

    The middles of such a pair are as far apart as each is long.  Its points are so by the sum of
    both lengths at the ends, by 1 / sqrt(3) of it as Gauss points; neighbours in the middle of
    their lengths by half of it.
    """
    same_bodies = np.all(
        np.diff(joints[["first_body", "second_body"]].to_numpy(), axis=0) == 0, axis=1
    )
    share = np.sum(np.abs(np.diff(point, axis=0)), axis=1) / (length[:-1] + length[1:])
    side = np.zeros(len(length))
    for place in (1.0, 1 / np.sqrt(3)):
        starts = np.flatnonzero(
            same_bodies & (np.abs(share - place) * (length[:-1] + length[1:]) < TINY)
        )
        side[starts] = 2 * place - 1
        side[starts + 1] = 1 - 2 * place
    return side
