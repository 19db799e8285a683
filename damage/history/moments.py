"""Samples of a history by name, with the nearest snapshot and the state of every joint."""

from collections.abc import Sequence

import numpy as np

from damage.errors import InputError
from damage.history.reader import History
from damage.index import THRESHOLD
from damage.wall.geometry import SupportMotion

JOINT_STATES = ("intact", "broken", "slipped", "opened", "both")
"""States of a joint in the order of drawing, the gravest on top; "broken" is below the threshold,
"both" is opened and slipped."""
BREAKS = ("tension", "shear")
"""Kinds of events in which a bond breaks."""
NEAR_S = 0.05  # [s]; a shape from further away belongs to another moment of the motion


def check_samples(history: History) -> None:
    """Raise InputError where a History holds no sample."""
    if len(history.series) == 0:
        raise InputError(
            f"{history.path} holds no sample yet ({history.status}); expected one or more, "
            "let the run continue"
        )


def choose_sample(history: History, sample: str | int) -> tuple[int, float]:
    """Return the index of a sample ("max", "end" or a number) and DI at it.

    >>> choose_sample(history, "end")[0]
    20
    """
    check_samples(history)
    n_times = len(history.series)
    damage = history.largest_index
    if sample == "max":
        sample = int(np.argmax(damage))
    elif sample == "end":
        sample = n_times - 1
    elif isinstance(sample, str) or not -n_times <= sample < n_times:
        raise InputError(
            f"sample {sample!r}: expected 'max', 'end' or a whole number from 0 to "
            f"{n_times - 1}; choose one of them"
        )
    sample = int(sample) % n_times
    return sample, float(damage[sample])


def choose_samples(history: History, moments: Sequence[str | float]) -> list[int]:
    """Samples of the words `rest` (the first), `max` (of DI), `end`, or of times [s], the nearest;
    InputError for a time outside the run, by more than a sample.

    >>> choose_samples(history, ["max", 0.05])
    [0, 5]
    """
    check_samples(history)
    return [_sample_of(history, moment) for moment in moments]


def _sample_of(history, moment):
    if moment in ("rest", "max", "end"):
        return choose_sample(history, 0 if moment == "rest" else moment)[0]
    times = history.time_s
    step = np.diff(times).max(initial=0.0)
    try:
        time_s = float(moment)
    except (TypeError, ValueError):
        time_s = np.nan
    if not times[0] - step <= time_s <= times[-1] + step:
        raise InputError(
            f"--at {moment}: expected rest, max, end or a time [s] from {times[0]:g} to"
            f" {times[-1]:g}; choose another"
        )
    return nearest(times, time_s)


def spans_of(time_s: np.ndarray, chosen: np.ndarray) -> list[list[float]]:
    """[[first, last time]] [s] of each stretch of chosen samples; time_s: (n,) [s]; chosen: (n,)
    bool.

    >>> spans_of(np.array([0.0, 0.1, 0.2]), np.array([True, True, False]))
    [[0.0, 0.1]]
    """
    edges = np.flatnonzero(np.diff(np.concatenate([[0], chosen.astype(int), [0]])))
    return [
        [float(time_s[first]), float(time_s[last - 1])]
        for first, last in zip(edges[::2], edges[1::2])
    ]


def nearest(times: np.ndarray, time_s: float) -> int:
    """Index of the nearest of times (n,) to a time [s].

    >>> nearest(history.time_s, 0.051)
    5
    """
    return int(np.argmin(np.abs(times - time_s)))


def nearest_snapshot(history: History, time_s: float) -> int | None:
    """Index of the snapshot nearest to a time, None where none is near.

    >>> nearest_snapshot(history, 0.1)
    2
    """
    times = history.snapshot_time_s
    if len(times) == 0:
        return None
    snapshot = nearest(times, time_s)
    # Slow tests take their snapshots further apart than the shaking of a wall does.
    near = max(NEAR_S, float(np.median(np.diff(times)))) if len(times) > 1 else NEAR_S
    return snapshot if abs(times[snapshot] - time_s) <= near else None


def support_motion(history: History, snapshot: int | None) -> SupportMotion | None:
    """SupportMotion at a snapshot, None for the end of the static stage."""
    motion = np.zeros((len(history.supports), 3))
    if snapshot is not None and len(history.series):
        sample = nearest(history.time_s, history.snapshot_time_s[snapshot])
        motion = history.support_displacement[sample].astype(float)
    supports = history.supports
    return SupportMotion(supports["left_m"].to_numpy(), supports["right_m"].to_numpy(), motion)


def joint_states(history: History, sample: int) -> np.ndarray:
    """Return the index into JOINT_STATES of every joint at a sample, (n_joints,), by the criteria
    of the index.

    >>> joint_states(history, -1)[:2].tolist()
    [3, 3]
    """
    opened = history.opening_m[sample] > THRESHOLD
    slipped = np.abs(history.offset_m[sample]) > THRESHOLD
    return state_codes(opened, slipped, history.broken[sample])


def state_codes(
    opened: np.ndarray, slipped: np.ndarray, broken: np.ndarray | bool = False
) -> np.ndarray:
    """Index into JOINT_STATES of joints, of bool arrays of one shape.

    >>> state_codes(np.array([True, False]), np.array([True, False])).tolist()
    [4, 0]
    """
    codes = [JOINT_STATES.index(name) for name in ("both", "opened", "slipped", "broken")]
    return np.select(
        [opened & slipped, opened, slipped, np.broadcast_to(broken, np.shape(opened))],
        codes,
        default=JOINT_STATES.index("intact"),
    )
