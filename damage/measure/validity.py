"""The range of validity of joints: a joint ends where its two faces no longer overlap, and has no forces from then on.

The contact points of a joint are made once: the reference solver finds no new contacts of a brick that has left the
face that it stood on.  Histories before schema version 5 have joints that kept their forces beyond that.
"""

from types import SimpleNamespace
from typing import NamedTuple

import numpy as np

from damage.wall.kinematics import slide_limits as limits_of


def slide_limits(joints, bodies):
    """Offsets of contact points at which the faces of their joint no longer overlap, (least, most), each (n_joints,)
    [m]; infinite on the ground, which does not end.

    joints, bodies: tables of a History.
    """
    rectangles = SimpleNamespace(**{name: bodies[f"{name}_m"].to_numpy() for name in ("x", "z", "length", "height")})
    return limits_of(*(joints[f"{side}_body"].to_numpy() for side in ("first", "second")),
                     (joints["kind"] != "bed").to_numpy(), rectangles)


def offset_over_overlap(history):
    """Largest offset of any contact point over that at which the faces of its joint no longer overlap [-], the row of
    its joint and the sample; None of a history without offsets or without a joint that failed."""
    active = history.active
    if active.offset_m is None or active.offset_m.size == 0:
        return None
    least, most = (limit[active.joints] for limit in slide_limits(history.joints, history.bodies))
    share = np.maximum(active.offset_m / most, active.offset_m / least)
    sample, place = np.unravel_index(np.argmax(share), share.shape)
    return float(share[sample, place]), int(active.joints[place]), int(sample)


class Ended(NamedTuple):
    """Joints that have ended: how many, all contact points between two bodies as one; row and sample of the first."""

    count: int
    row: int
    sample: int


def ended_joints(history):
    """The Ended of a History, None where no joint has."""
    states = history.states
    if not states.ended.any():
        return None
    sample = int(np.argmax(states.ended.any(axis=1)))
    rows = states.joints[states.ended[-1]]
    pairs = history.joints[["first_body", "second_body"]].iloc[rows]
    return Ended(len(pairs.drop_duplicates()), int(states.joints[np.argmax(states.ended[sample])]), sample)
