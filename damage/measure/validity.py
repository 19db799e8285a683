"""The range of validity of joints: a joint ends where its two faces no longer overlap.

The contact points of a joint are made once.  A brick that slides beyond the end of the face that it stands on keeps
their forces, though nothing carries it there: what a run says after that is not valid.
"""

import numpy as np


def slide_limits(joints, bodies):
    """Offsets of contact points at which the faces of their joint no longer overlap, (least, most), each (n_joints,)
    [m]; infinite on the ground, which does not end.

    joints, bodies: tables of a History.
    """
    second = joints["second_body"].to_numpy()
    on_ground = (joints["first_body"] < 0).to_numpy()
    first = np.where(on_ground, second, joints["first_body"])
    x, length, height = (bodies[name].to_numpy() for name in ("x_m", "length_m", "height_m"))
    left, right = x - length / 2, x + length / 2
    bed = (joints["kind"] == "bed").to_numpy()
    least = np.where(bed, left[first] - right[second], -height[second])
    most = np.where(bed, right[first] - left[second], height[second])
    return np.where(on_ground, -np.inf, least), np.where(on_ground, np.inf, most)


def offset_over_overlap(history):
    """Largest offset of any contact point over that at which the faces of its joint no longer overlap [-], the row of
    its joint and the sample; None of a history without offsets or without a joint that failed."""
    active = history.told
    if active.offset_m is None or active.offset_m.size == 0:
        return None
    least, most = (limit[active.joints] for limit in slide_limits(history.joints, history.bodies))
    share = np.maximum(active.offset_m / most, active.offset_m / least)
    sample, place = np.unravel_index(np.argmax(share), share.shape)
    return float(share[sample, place]), int(active.joints[place]), int(sample)
