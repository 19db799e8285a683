"""Range of validity of joints: a joint ends, and transmits no force, from when its two faces cease to overlap.

The reference solver creates contacts once.  It finds no new contacts of a brick that has slid off the face below it.
In histories before schema version 5 joints kept their forces beyond the overlap.
"""

from types import SimpleNamespace
from typing import NamedTuple

import numpy as np

from damage.wall.kinematics import slide_limits as limits_of


def slide_limits(joints, bodies):
    """Offsets (least, most) at which the faces of a joint cease to overlap, (n_joints,) each [m]; infinite on supports.

    joints, bodies: tables of a History.
    """
    rectangles = SimpleNamespace(**{name: bodies[f"{name}_m"].to_numpy() for name in ("x", "z", "length", "height")})
    return limits_of(*(joints[f"{side}_body"].to_numpy() for side in ("first", "second")),
                     (joints["kind"] != "bed").to_numpy(), rectangles)


def offset_over_overlap(history):
    """Largest ratio of the offset of a contact point to that at which the faces of its joint cease to overlap.

    Returns (ratio [-], row of the contact point, sample), or None for a history without offsets or failed joints.
    """
    active = history.active
    if active.offset_m is None or active.offset_m.size == 0:
        return None
    least, most = (limit[active.joints] for limit in slide_limits(history.joints, history.bodies))
    share = np.maximum(active.offset_m / most, active.offset_m / least)
    sample, place = np.unravel_index(np.argmax(share), share.shape)
    return float(share[sample, place]), int(active.joints[place]), int(sample)


class Ended(NamedTuple):
    """Ended joints: their count (the contact points between two bodies are one joint), and contact point (row of
    `history.joints`) and sample of the first."""

    count: int
    row: int
    sample: int


def ended_joints(history):
    """The Ended of a History; None where no joint has ended."""
    states = history.states
    if not states.ended.any():
        return None
    sample = int(np.argmax(states.ended.any(axis=1)))
    rows = states.joints[states.ended[-1]]
    pairs = history.joints[["first_body", "second_body"]].iloc[rows]
    return Ended(len(pairs.drop_duplicates()), int(states.joints[np.argmax(states.ended[sample])]), sample)
