"""Joints of a run: largest motions of their faces, and how many failed, crushed, split and ended."""

from damage.history.schema import Column
from damage.measure.register import measure
from damage.measure.validity import ended_joints, offset_over_overlap


def with_bond(history):
    """Flags (n_joints,) of the contact points of a History that started with a bond."""
    joints = history.joints
    return ((joints["tensile_strength_pa"] > 0) | (joints["cohesion_pa"] > 0)).to_numpy()


@measure({"max_opening_mm, max_slip_mm": Column("mm", "largest opening and accumulated slip of any contact point"),
          "max_offset_mm": Column("mm", "largest offset of any contact point, empty of a history without offsets")})
def motions_of_faces(history):
    """Largest motions of the faces of a History's joints [mm]."""
    active = history.active
    return (_largest(active.opening_m) * 1e3, _largest(active.slip_m) * 1e3,
            None if active.offset_m is None else _largest(active.offset_m) * 1e3)


def _largest(frames):
    """Largest absolute value of frames (n_times, n), zero where they are empty."""
    return float(max(frames.max(initial=0.0), -frames.min(initial=0.0)))


@measure({"max_offset_over_overlap": Column("1", "largest offset of any contact point over that at which the faces of "
                                            "its joint no longer overlap, where the joint ends")})
def over_overlap(history):
    """Largest offset over the overlap [-]; zero where nothing failed, None for a history without offsets."""
    if history.active.offset_m is None:
        return None
    found = offset_over_overlap(history)
    return 0.0 if found is None else found[0]


@measure({"ended_joints": Column("1", "joints that had ended by the run's end, all contact points between two bodies "
                                 "as one")})
def count_of_ended(history):
    """Number of joints of a History that have ended."""
    return getattr(ended_joints(history), "count", 0)


@measure({"tension_breaks, shear_breaks": Column("1", "contact points whose bond broke, by the way it did")})
def breaks(history):
    """Number of failures of a History; what a survey took is no failure of the run."""
    failures = history.events["kind"]
    if history.parameters.get("cracked"):
        failures = failures[with_bond(history)[history.events["joint"]]]
    return int((failures == "tension").sum()), int((failures == "shear").sum())


@measure({"crushed_length_m": Column("m", "length of joints that has been crushed, at the run's end"),
          "split_length_m": Column("m", "length of the cuts through bricks that has split, at the run's end")})
def damaged_lengths(history):
    """Lengths of a History's joints that have been crushed, and of its bricks' cuts that have split [m]."""
    states = history.states
    broken, crushed = (states.joints[frames[-1]] for frames in (states.broken, states.crushed))
    return (float(history.joint_length_m[crushed].sum()),
            float((history.joints["length_m"] - history.joint_length_m).iloc[broken].sum()))
