"""Concrete floors of a house in the histories of its walls, where each is the strip in a wall."""

from dataclasses import replace

import numpy as np

from damage.wall.house import axes_of


def with_slabs_in(history, number):
    """The History of a house with the floors that this wall carries as bodies of it, where it has
    them: in the middle of its length, moved as the floor is there for small rotations."""
    house, walls = history.house, history.parameters["house"]["walls"]
    ends = history.joints[["first_body", "second_body"]].to_numpy()
    of_joint = np.repeat(house.joint_wall[:, None], 2, axis=1)
    other = (ends >= 0) & (of_joint >= 0) & (house.body_wall[ends] != of_joint)
    slabs = np.intersect1d(ends[other], ends[of_joint == number])
    if len(slabs) == 0:
        return history
    bodies, axes = history.bodies.copy(), [axes_of(one["direction"]) for one in walls]
    origins = [np.array([*one["origin"], 0.0]) for one in walls]
    length = walls[number]["wall"]["length"]
    moved, across = history.displacement.copy(), house.out_of_plane.copy()
    body_wall = house.body_wall.copy()
    middle = origins[number] + length / 2 * axes[number][0]
    for slab in slabs:
        own, left = house.body_wall[slab], walls[house.body_wall[slab]]["left_m"]
        centre = origins[own] + [bodies["x_m"][slab] - left, house.body_y_m[slab], 0.0] @ axes[own]
        along, up, turned, aside, about_x, about_z = np.vstack(
            [moved[:, slab].T, across[:, slab].T]
        )
        turns = np.column_stack([about_x, -turned, about_z]) @ axes[own]
        shift = np.column_stack([along, aside, up]) @ axes[own]
        shift = (shift + np.cross(turns, middle - centre)) @ axes[number].T
        turns = turns @ axes[number].T
        moved[:, slab] = np.column_stack([shift[:, 0], shift[:, 2], -turns[:, 1]])
        across[:, slab] = np.column_stack([shift[:, 1], turns[:, 0], turns[:, 2]])
    body_wall[slabs] = number
    bodies.loc[slabs, "x_m"] = walls[number]["left_m"] + length / 2
    bodies.loc[slabs, "length_m"] = length
    return replace(
        history,
        bodies=bodies,
        displacement=moved,
        house=house._replace(body_wall=body_wall, out_of_plane=across),
    )
