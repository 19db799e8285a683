"""The history of a house, cut into those of its walls and of their faces."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from damage.errors import InputError
from damage.history.contacts import Contacts
from damage.house.placing import FACES
from damage.wall.geometry import in_one_layer


class HouseRows(NamedTuple):
    """What the history of a house has beside that of a plane wall: number of the wall of each body
    and of each contact point, -1 between two, place of that and of each body's centre from the
    wall's middle plane, size of the bodies across it [m]; of each sample and wall displacement of
    the top along it, the largest across it, and that of the top across it (n_times, n_walls) [m];
    acceleration of the ground across the heading (n_times,) [m/s2], number of failed ties
    (n_times,); displacement across and
    rotations about the axes along the wall and upwards (n_snapshots, n_bodies, 3) [m, rad, rad];
    outside: sign of y outside of the one wall that they are of, 0 of all walls of a house."""

    body_wall: np.ndarray
    joint_wall: np.ndarray
    joint_y_m: np.ndarray
    body_y_m: np.ndarray
    body_depth_m: np.ndarray
    top_displacement_m: np.ndarray
    across_m: np.ndarray
    top_across_m: np.ndarray
    base_acceleration_m_s2: np.ndarray
    failed_ties: np.ndarray
    out_of_plane: np.ndarray
    outside: int = 0

    def of(self, number, body, joint, outside):
        """The rows of a wall, by flags of its bodies and contact points."""
        return self._replace(
            body_wall=0 * self.body_wall[body],
            joint_wall=0 * self.joint_wall[joint],
            joint_y_m=self.joint_y_m[joint],
            body_y_m=self.body_y_m[body],
            body_depth_m=self.body_depth_m[body],
            top_displacement_m=self.top_displacement_m[:, [number]],
            across_m=self.across_m[:, [number]],
            top_across_m=self.top_across_m[:, [number]],
            out_of_plane=self.out_of_plane[:, body],
            outside=outside,
        )


def wall_of(history, name):
    """`History.of_wall`."""
    house = history.house
    names = () if house is None else FACES if house.outside else history.placing.names
    if name not in names:
        raise InputError(
            f"{history.path} has no wall or face {name}: expected"
            f" {'one of ' + ', '.join(names) if names else 'a plain name, as of no house'};"
            " correct it"
        )
    if house.outside:
        part = _of_face(history, name)
    else:
        number = names.index(name)
        part = _of_wall(_with_slabs_in(history, number), name, number)
    path = history.path
    return replace(part, path=path.with_name(f"{path.stem}:{name}{path.suffix}"))


def _of_wall(history, name, number):
    walls = history.parameters["house"]["walls"]
    house = history.house
    wall, left, height = (walls[number][key] for key in ("wall", "left_m", "drift_height_m"))
    outside = int(history.placing.sign_of("outside")[number])
    body = house.body_wall == number
    joint = house.joint_wall == number
    new_body = np.cumsum(body) - 1
    part = _with_joints(history, joint)
    joints = part.joints.assign(x_m=part.joints["x_m"] - left)
    for end in ("first_body", "second_body"):
        joints[end] = np.where(joints[end] < 0, joints[end], new_body[joints[end]])
    top = house.top_displacement_m[:, number]
    supports, moved, below = _ground_of(history, number)
    # -1 is the first
    first = joints["first_body"]
    shift = -np.cumsum(below)
    joints["first_body"] = np.where(first < 0, shift[np.maximum(-1 - first, 0)], first)
    return replace(
        part,
        supports=supports,
        support_displacement=moved,
        support_force=history.support_force[:, below],
        wall=name,
        parameters=history.parameters
        | {
            "wall": wall,
            "house": history.parameters["house"] | {"walls": [walls[number] | {"left_m": 0.0}]},
        },
        attributes=part.attributes
        | {"wall": name, "drift_height_m": height, "length_m": wall["length"]},
        joints=joints,
        bodies=history.bodies[body].assign(x_m=history.bodies["x_m"] - left).reset_index(drop=True),
        series=history.series.assign(top_displacement_m=top, drift_ratio=top / height),
        displacement=history.displacement[:, body],
        house=house.of(number, body, joint, outside),
    )


def _ground_of(history, number):
    """Supports of a wall of a house, their displacement in its plane (n_times, n, 3) [m, m,
    rad], and which of those of the house they are."""
    if len(history.supports) == 1:
        return history.supports, history.support_displacement, np.array([True])
    placing = history.placing
    turn = np.radians(history.parameters["house"]["heading"])
    left = placing.left[number]
    length = placing.length[number]
    middle = history.supports[["left_m", "right_m"]].mean(axis=1)
    below = ((middle > left) & (middle < left + length)).to_numpy()
    facing = placing.axes[number, 0] @ [np.cos(turn), np.sin(turn), 0.0]
    moved = history.support_displacement[:, below] * [facing, 1.0, facing]
    return (history.supports[below] - left).reset_index(drop=True), moved, below


def _of_face(history, face):
    sign = history.house.outside * (1 if face == "outside" else -1)
    part = _with_joints(history, (np.sign(history.joints["y_m"]) == sign).to_numpy())
    joints = in_one_layer(part.joints)
    total = {"total_joint_length_m": float(joints["length_m"].sum())}
    return replace(
        part,
        joints=joints,
        attributes=history.attributes | total,
        house=None,
    )


def _with_joints(history, kept):
    """The History with these joints alone, (n_joints,) bool."""
    joints = history.joints[kept].reset_index(drop=True)
    events = history.events
    events = events[kept[events["joint"]]].reset_index(drop=True)
    new = np.cumsum(kept) - 1
    active = kept[history.contacts.joints]
    contacts = Contacts(*(values[..., active] for values in history.contacts))
    stress = history.joint_stress_pa
    return replace(
        history,
        joints=joints,
        events=events.assign(joint=new[events["joint"]]),
        contacts=contacts._replace(joints=new[contacts.joints]),
        joint_stress_pa=None if stress is None else stress[:, kept],
        attributes=history.attributes | {"total_joint_length_m": float(joints["length_m"].sum())},
    )


def _with_slabs_in(history, number):
    """The History of a house with the concrete floors that this wall carries as bodies of it: in
    the middle of its length, moved as the floor is there for small rotations."""
    house = history.house
    placing = history.placing
    ends = history.joints[["first_body", "second_body"]].to_numpy()
    of_joint = np.repeat(house.joint_wall[:, None], 2, axis=1)
    other = (ends >= 0) & (of_joint >= 0) & (house.body_wall[ends] != of_joint)
    slabs = np.intersect1d(ends[other], ends[of_joint == number])
    if len(slabs) == 0:
        return history
    bodies = history.bodies.copy()
    body_wall = house.body_wall.copy()
    moved = history.displacement.copy()
    across = house.out_of_plane.copy()
    middle = placing.left[number] + placing.length[number] / 2
    to_wall = placing.axes[number].T
    for slab in slabs:
        carrying = [house.body_wall[slab]]
        centre = np.array([[[bodies["x_m"][slab], house.body_y_m[slab], 0.0]]])
        place = placing.in_house([number], np.array([[[middle, 0.0, 0.0]]]))
        arm = (place - placing.in_house(carrying, centre))[0]
        vectors = motion_vectors(moved[:, slab], across[:, slab])
        shift, turns = placing.turned(carrying * len(vectors), vectors).swapaxes(0, 1)
        along, aside, up = ((shift + np.cross(turns, arm)) @ to_wall).T
        about_along, about_across, about_up = (turns @ to_wall).T
        moved[:, slab] = np.column_stack([along, up, -about_across])
        across[:, slab] = np.column_stack([aside, about_along, about_up])
    body_wall[slabs] = number
    bodies.loc[slabs, "x_m"] = middle
    bodies.loc[slabs, "length_m"] = placing.length[number]
    return replace(
        history,
        bodies=bodies,
        displacement=moved,
        house=house._replace(body_wall=body_wall, out_of_plane=across),
    )


def motion_vectors(in_plane, out_of_plane):
    """Displacement [m] and rotation [rad] of bodies along, across and up their walls (n, 2, 3), of
    their motion in the plane (n, 3) [m, m, rad] and out of it (n, 3) [m, rad, rad]."""
    along, up, turn = in_plane.T
    across, about_along, about_up = out_of_plane.T
    shift = np.column_stack([along, across, up])
    return np.stack([shift, np.column_stack([about_along, -turn, about_up])], axis=1)
