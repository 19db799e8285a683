"""Cracks of a wall at one sample: cracked contact points, how they connect, and Korswagen's Psi.

P. A. Korswagen's damage parameter for light damage of masonry (dissertation, TU Delft),

    Psi = 2 n^0.15 c_w^0.3,   c_w = sum(c_i^2 L_i) / sum(c_i L_i)  [mm],
    c_i^2 = opening^2 + slip^2

with the number n of cracks and the length L_i of each cracked contact point.  Psi = 1 is one crack
that is just visible (0.1 mm), about 2 one of 1 mm, 3.5 the end of light damage (5 mm).

Slip is the present offset of the two faces (`History.slip_by`).  A contact point is cracked over
its tributary length where its width c_i reaches 0.02 mm.  This is below the visible width, so that
values of Psi below 1 exist as they do in Korswagen's work.  Cracked lengths closer than 10 mm are
one crack: a stepped crack through bed and head joints counts once.  All criteria refer to the state
at the sample, not to the largest so far.
"""

import numpy as np
import pandas as pd
import scipy  # spatial where it is used: it starts slowly

# SciPy 1.11 takes graphs with the long indices of a coo_array for empty ones
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from damage.checks import check_positive
from damage.history.moments import choose_sample
from damage.history.reader import History
from damage.history.schema import Column, measure
from damage.index import THRESHOLD
from damage.units import MILLIMETRE
from damage.wall.geometry import tributary_ends

ENDS = ("x_start_m", "z_start_m", "x_end_m", "z_end_m")
"""Columns of every table of cracks: both ends of a straight segment [m]."""
PSI_FROM = 0.02 * MILLIMETRE
"""Width from which a crack counts in Psi [m]."""
JOINING_GAP = 10 * MILLIMETRE
"""Cracked lengths closer than this are one crack [m] (Korswagen)."""
_PRECISION = 1e-6  # histories store widths in single precision: 0.1 mm comes back as 0.09999999 mm


def psi_value(count, mean_width):
    """Psi [-] of a number of cracks and their mean width c_w [m]; 0 without a crack; scalars or
    arrays.

    >>> round(float(psi_value(1, 0.1e-3)), 3), round(float(psi_value(0, 0.0)), 3)
    (1.002, 0.0)
    """
    return (
        2 * np.asarray(count, float) ** 0.15 * (np.asarray(mean_width, float) / MILLIMETRE) ** 0.3
    )


def mean_width(width: np.ndarray, length: np.ndarray) -> np.ndarray:
    """Mean crack width c_w = sum(c^2 L) / sum(c L) over the last axis, in the unit of width; 0
    without a crack.

    width: (..., n), 0 where not cracked; length: (n,) [m].

    >>> mean_width(np.array([1e-3, 3e-3]), np.array([1.0, 1.0])).round(5).tolist()
    0.0025
    """
    width = np.asarray(width, float)
    length = np.asarray(length, float)
    weight = width @ length
    return np.divide(width**2 @ length, weight, out=np.zeros_like(weight), where=weight > 0)


def cracked(width: np.ndarray, threshold: float = THRESHOLD) -> np.ndarray:
    """Whether widths [m] reach the threshold [m], bool of the same shape; NaN does not.

    Raises InputError for a threshold that is not positive.

    >>> cracked([0.5e-4, 1e-4, np.nan]).tolist()
    [False, True, False]
    """
    check_positive("crack width threshold", threshold)
    return np.asarray(width) >= threshold * (1 - _PRECISION)


def close_pairs(ends: np.ndarray) -> np.ndarray:
    """Pairs of segments whose distance is below JOINING_GAP [m], (n_pairs, 2) indices.

    ends: (n, 2, 2) [m], both ends of segments along x or along z.

    >>> close_pairs(np.array([[[0, 0], [1, 0]], [[1.005, 0], [2, 0]], [[3, 0], [4, 0]]])).tolist()
    [[0, 1]]
    """
    if len(ends) < 2:
        return np.zeros((0, 2), int)
    low = ends.min(axis=1)
    high = ends.max(axis=1)
    reach = np.max(high - low) + JOINING_GAP
    pairs = scipy.spatial.cKDTree((low + high) / 2).query_pairs(reach, output_type="ndarray")
    first, second = pairs.T
    apart = np.maximum(np.maximum(low[first] - high[second], low[second] - high[first]), 0)
    return pairs[np.hypot(*apart.T) < JOINING_GAP]


def crack_numbers(is_cracked: np.ndarray, pairs: np.ndarray) -> np.ndarray:
    """Number of the crack that each segment belongs to, (n,) int from 1; 0 where it is not cracked.

    is_cracked: (n,) bool; pairs: (n_pairs, 2) from `close_pairs`.

    >>> crack_numbers(np.array([True, True, False, True]), np.array([[0, 1]])).tolist()
    [1, 1, 0, 2]
    """
    joined = pairs[is_cracked[pairs].all(axis=1)]
    graph = coo_matrix((np.ones(len(joined)), joined.T), shape=(len(is_cracked),) * 2)
    group = connected_components(graph, directed=False)[1]
    numbers = np.zeros(len(is_cracked), int)
    numbers[is_cracked] = np.unique(group[is_cracked], return_inverse=True)[1] + 1
    return numbers


def crack_table(
    ends: np.ndarray, opening: np.ndarray, slip: np.ndarray, threshold: float = THRESHOLD
) -> pd.DataFrame:
    """Table of the cracked segments, ordered by crack.

    ends: (n, 2, 2) [m], both ends (x, z) of each segment; opening, slip: (n,) [m], slip signed;
    threshold: crack width from which a segment is cracked [m].
    Returns a DataFrame: crack (from 1), joint (index of the segment), ENDS, length_m, opening_m,
    slip_m, width_m.

    >>> ends = np.array([[[0.0, 0.0], [0.1, 0.0]], [[0.1, 0.0], [0.2, 0.0]]])
    >>> crack_table(ends, np.array([2e-4, 0.0]), np.zeros(2))["opening_m"].tolist()
    [0.0002]
    """
    opening = np.asarray(opening, float)
    slip = np.asarray(slip, float)
    width = np.hypot(opening, slip)
    numbers = crack_numbers(cracked(width, threshold), close_pairs(ends))
    table = pd.DataFrame(
        {
            "crack": numbers,
            "joint": np.arange(len(width)),
            **dict(zip(ENDS, ends.reshape(-1, 4).T)),
            "length_m": np.abs(ends[:, 1] - ends[:, 0]).sum(axis=1),
            "opening_m": opening,
            "slip_m": slip,
            "width_m": width,
        }
    )
    return table[numbers > 0].sort_values(["crack", "joint"], ignore_index=True)


def ends_of(table: pd.DataFrame) -> np.ndarray:
    """Both ends of the rows of a table with ENDS, (n, 2, 2) [m].

    >>> ends_of(cracks_at(history, -1)).shape
    (3, 2, 2)
    """
    return table[list(ENDS)].to_numpy(float).reshape(-1, 2, 2)


def points_along(ends: np.ndarray, number: int = 20) -> np.ndarray:
    """Points in the middles of equal parts of straight lines with these ends (n, 2, 2), (n, number,
    2) [m].

    >>> points_along(np.array([[[0.0, 0.0], [1.0, 2.0]]]), 2).tolist()
    [[[0.25, 0.5], [0.75, 1.5]]]
    """
    share = (np.arange(number) + 0.5) / number
    return ends[:, :1] + share[:, np.newaxis] * (ends[:, 1:] - ends[:, :1])


def cracks_at(history: History, sample: int, threshold: float = THRESHOLD) -> pd.DataFrame:
    """`crack_table` of a History at a sample, with slip by displacement.

    sample: index into its series, negative ones from the end; threshold: crack width [m].  Raises
    InputError where there is no such sample.

    >>> cracks_at(history, -1)["width_m"].round(5).tolist()
    [0.0002, 0.0004, 0.0002]
    """
    sample, _ = choose_sample(history, sample)
    return crack_table(
        tributary_ends(history.joints),
        history.opening_m[sample],
        history.offset_m[sample],
        threshold,
    )


def psi(table: pd.DataFrame) -> float:
    """Psi [-] of a `crack_table`.

    >>> ends = np.array([[[0.0, 0.0], [0.1, 0.0]]])
    >>> round(psi(crack_table(ends, np.array([1e-4]), np.zeros(1))), 3)
    1.002
    """
    return float(
        psi_value(table["crack"].nunique(), mean_width(table["width_m"], table["length_m"]))
    )


def psi_history(history: History, threshold: float = PSI_FROM) -> pd.DataFrame:
    """Cracks of a History over time; threshold: width from which a crack counts [m].

    Returns a DataFrame, a row a sample: time_s, psi [-], cracks (their number), crack_length_m,
    mean_width_m (c_w), max_width_m (0 without a crack).

    >>> psi_history(history)["psi"].iloc[-1:].round(2).tolist()
    [1.55]
    """
    opening = history.active.opening_m
    slip = history.active.offset_m
    # Where opening and |slip| both stay below 0.7 of the threshold, the width stays below it: most
    # contact points.
    least = threshold * 0.7
    wide = (opening >= least).any(axis=0) | (np.abs(slip) >= least).any(axis=0)
    ever = history.active.joints[wide]
    width = np.hypot(opening[:, wide].astype(float), slip[:, wide].astype(float))
    is_cracked = cracked(width, threshold)
    width = np.where(is_cracked, width, 0.0)
    joints = history.joints.iloc[ever]
    length = joints["length_m"].to_numpy()
    count = count_cracks(is_cracked, close_pairs(tributary_ends(history.joints)[ever]))
    mean = mean_width(width, length)
    return pd.DataFrame(
        {
            "time_s": history.time_s,
            "psi": psi_value(count, mean),
            "cracks": count,
            "crack_length_m": is_cracked @ length,
            "mean_width_m": mean,
            "max_width_m": width.max(axis=1, initial=0.0),
        }
    )


def count_cracks(is_cracked: np.ndarray, pairs: np.ndarray) -> np.ndarray:
    """Number of cracks at each sample, (n_times,) int; is_cracked: (n_times, n) bool; pairs: from
    `close_pairs`.

    One graph serves all samples at which a segment changes; its nodes are the segments of each of
    them.

    >>> count_cracks(np.array([[True, True], [True, False]]), np.array([[0, 1]])).tolist()
    [1, 1]
    """
    changed = np.ones(len(is_cracked), bool)
    changed[1:] = (is_cracked[1:] != is_cracked[:-1]).any(axis=1)
    states = is_cracked[changed]
    if not states.any():
        return np.zeros(len(is_cracked), int)
    when, which = np.nonzero(states[:, pairs[:, 0]] & states[:, pairs[:, 1]])
    numbers = crack_numbers(states.ravel(), pairs[which] + states.shape[1] * when[:, np.newaxis])
    _, first = np.unique(numbers[states.ravel()], return_index=True)
    return np.bincount(np.nonzero(states)[0][first], minlength=len(states))[np.cumsum(changed) - 1]


@measure(
    {
        "max_crack_width_mm, residual_crack_width_mm": Column(
            "mm",
            "width of the widest crack, sqrt(opening² + slip²), where it reaches `psi_from_mm`;"
            " largest over the run, and at its end",
        ),
        "max_psi, residual_psi": Column(
            "1",
            "Korswagen's damage parameter Psi = 2 n^0.15 c_w^0.3 of the cracks from "
            "`psi_from_mm` on",
        ),
    }
)
def psi_summary(history: History, psi_from: float = PSI_FROM) -> list:
    """Psi and crack widths of a History; psi_from: width from which a crack counts [m].

    Those at its end are None where the run is not complete (`damage.measure.summary.summarise`).
    """
    over_time = psi_history(history, psi_from)
    return [
        value
        for values in (over_time["max_width_m"] / MILLIMETRE, over_time["psi"])
        for value in (float(values.max()), float(values.iloc[-1]) if history.complete else None)
    ]
