"""Joints of a run: largest motions of their faces, and how many failed, crushed, split and ended.

A joint ends, and transmits no force, from when its two faces cease to overlap.  The reference
solver creates contacts once: it finds no new contacts of a brick that has slid off the face below
it.
"""

from types import SimpleNamespace

import numpy as np

from damage.history.schema import Column, measure
from damage.wall.kinematics import slide_limits as limits_of


def slide_limits(joints, bodies):
    """Offsets (least, most) at which the faces of a joint cease to overlap, (n_joints,) each [m];
    infinite on supports.

    joints, bodies: tables of a History.
    """
    rectangles = SimpleNamespace(
        **{name: bodies[f"{name}_m"].to_numpy() for name in ("x", "z", "length", "height")}
    )
    return limits_of(
        *(joints[f"{side}_body"].to_numpy() for side in ("first", "second")),
        (joints["kind"] != "bed").to_numpy(),
        rectangles,
    )


def offset_over_overlap(history):
    """Largest ratio of the offset of a contact point to that at which the faces of its joint cease
    to overlap.

    Returns (ratio [-], row of the contact point, sample), or None for a history without failed
    joints.
    """
    active = history.active
    if active.offset_m.size == 0:
        return None
    least, most = (limit[active.joints] for limit in slide_limits(history.joints, history.bodies))
    share = np.maximum(active.offset_m / most, active.offset_m / least)
    sample, place = np.unravel_index(np.argmax(share), share.shape)
    return float(share[sample, place]), int(active.joints[place]), int(sample)


def ended_joints(history):
    """Joints of a History that have ended; the contact points between two bodies are one joint.

    Returns (their number, row of the contact point and sample of the first), or None where none has
    ended.
    """
    states = history.states
    if not states.ended.any():
        return None
    sample = int(np.argmax(states.ended.any(axis=1)))
    rows = states.joints[states.ended[-1]]
    pairs = history.joints[["first_body", "second_body"]].iloc[rows]
    return len(pairs.drop_duplicates()), int(states.joints[np.argmax(states.ended[sample])]), sample


def with_bond(history):
    """Flags (n_joints,) of the contact points of a History that started with a bond."""
    joints = history.joints
    return ((joints["tensile_strength_pa"] > 0) | (joints["cohesion_pa"] > 0)).to_numpy()


@measure(
    {
        "max_opening_mm, max_slip_mm": Column(
            "mm", "largest opening and accumulated slip of any contact point"
        ),
        "max_offset_mm": Column("mm", "largest offset of any contact point"),
        "max_offset_over_overlap": Column(
            "1",
            "largest offset of any contact point over that at which the faces of its "
            "joint no longer overlap, where the joint ends",
        ),
        "ended_joints": Column(
            "1",
            "joints that had ended by the run's end, all contact points between two bodies as one",
        ),
    }
)
def motions_of_faces(history):
    """Largest motions of the faces of a History's joints, zero where nothing failed, and how many
    have ended."""
    opening, slip, offset = (
        _largest(frames) * 1e3
        for frames in (history.active.opening_m, history.active.slip_m, history.active.offset_m)
    )
    share = (offset_over_overlap(history) or [0.0])[0]
    return opening, slip, offset, share, (ended_joints(history) or [0])[0]


def _largest(frames):
    """Largest absolute value of frames (n_times, n), zero where they are empty."""
    return float(max(frames.max(initial=0.0), -frames.min(initial=0.0)))


@measure(
    {
        "tension_breaks, shear_breaks": Column(
            "1", "contact points whose bond broke, by the way it did"
        ),
        "crushed_length_m": Column("m", "length of joints that has been crushed, at the run's end"),
        "split_length_m": Column(
            "m", "length of the cuts through bricks that has split, at the run's end"
        ),
    }
)
def failures(history):
    """Failures of a History's contact points, and lengths that have been crushed and split; what a
    survey took is no failure of the run."""
    kinds = history.events["kind"]
    states = history.states
    if history.parameters.get("cracked"):
        kinds = kinds[with_bond(history)[history.events["joint"]]]
    broken, crushed = (states.joints[frames[-1]] for frames in (states.broken, states.crushed))
    return (
        int((kinds == "tension").sum()),
        int((kinds == "shear").sum()),
        float(history.joint_length_m[crushed].sum()),
        float((history.joints["length_m"] - history.joint_length_m).iloc[broken].sum()),
    )
