"""Concrete floors of a house in the histories of its walls, where each is the strip in a wall."""

from dataclasses import replace

import numpy as np


def with_slabs_in(history, number):
    """The History of a house with the floors that this wall carries as bodies of it, where it has
    them: in the middle of its length, moved as the floor is there for small rotations."""
    house, placing = history.house, history.placing
    ends = history.joints[["first_body", "second_body"]].to_numpy()
    of_joint = np.repeat(house.joint_wall[:, None], 2, axis=1)
    other = (ends >= 0) & (of_joint >= 0) & (house.body_wall[ends] != of_joint)
    slabs = np.intersect1d(ends[other], ends[of_joint == number])
    if len(slabs) == 0:
        return history
    bodies, body_wall = history.bodies.copy(), house.body_wall.copy()
    moved, across = history.displacement.copy(), house.out_of_plane.copy()
    middle = placing.left[number] + placing.length[number] / 2
    for slab in slabs:
        own = [house.body_wall[slab]]
        centre = np.array([[[bodies["x_m"][slab], house.body_y_m[slab], 0.0]]])
        arm = placing.in_house([number], np.array([[[middle, 0.0, 0.0]]]))
        arm = (arm - placing.in_house(own, centre))[0]
        along, up, turned = moved[:, slab].T
        aside, about_x, about_z = across[:, slab].T
        shift, turns = (
            placing.turned(own, np.column_stack(one)[np.newaxis])[0]
            for one in ((along, aside, up), (about_x, -turned, about_z))
        )
        to_wall = placing.axes[number].T
        shift, turns = (shift + np.cross(turns, arm)) @ to_wall, turns @ to_wall
        moved[:, slab] = np.column_stack([shift[:, 0], shift[:, 2], -turns[:, 1]])
        across[:, slab] = np.column_stack([shift[:, 1], turns[:, 0], turns[:, 2]])
    body_wall[slabs] = number
    bodies.loc[slabs, "x_m"], bodies.loc[slabs, "length_m"] = middle, placing.length[number]
    return replace(
        history,
        bodies=bodies,
        displacement=moved,
        house=house._replace(body_wall=body_wall, out_of_plane=across),
    )
