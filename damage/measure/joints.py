"""Joints of a run: largest motions of their faces, and how many failed, crushed, split and ended.

A joint ends, and transmits no force, from when its two faces cease to overlap.  The reference
solver creates contacts once: it finds no new contacts of a brick that has slid off the face below
it.
"""

from types import SimpleNamespace

import numpy as np

from damage.history.schema import Column, measure
from damage.wall.kinematics import slide_limits


def offset_over_overlap(history):
    """Largest ratio of the offset of a contact point to that at which the faces of its joint cease
    to overlap [-]; zero of a history without failed joints."""
    active = history.active
    joints = history.joints.iloc[active.joints]
    rectangles = SimpleNamespace(
        **{name: history.bodies[f"{name}_m"].to_numpy() for name in ("x", "z", "length", "height")}
    )
    least, most = slide_limits(
        joints["first_body"].to_numpy(),
        joints["second_body"].to_numpy(),
        (joints["kind"] != "bed").to_numpy(),
        rectangles,
    )
    share = np.maximum(active.offset_m / most, active.offset_m / least)
    return float(share.max(initial=0.0))


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
    active = history.active
    opening, slip, offset = (
        float(np.abs(frames).max(initial=0.0)) * 1e3
        for frames in (active.opening_m, active.slip_m, active.offset_m)
    )
    ended, *_ = ended_joints(history) or [0]
    return opening, slip, offset, offset_over_overlap(history), ended


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
