"""The damage index, equations (1) to (4) of Sarhosis et al. (2021),
doi:10.1016/j.engstruct.2021.112529.

Lengths add up per contact point with its tributary length; criteria are met *now*, not ever,
but for the shear limit, which is latched.
"""

import numpy as np
import pandas as pd

from damage.checks import check_choice, check_positive
from damage.units import MILLIMETRE

THRESHOLD = 0.1 * MILLIMETRE
"""Opening, and slip, from which a crack is visible [m] (Burland, as the paper cites)."""
DRIFT_LIMIT = 0.02
"""Near-collapse drift ratio [-] (Eurocode 8, NTC 2008, as the paper cites)."""
SLIP_CRITERIA = ("displacement", "accumulated", "shear-limit")
"""When a contact point counts as slipped: its two faces are offset by more than the threshold now;
what it slid while it was closed adds up to more than that now; it has failed in shear or slid,
ever."""
COMPONENTS = ("DI", "DI_drift", "DI_open", "DI_slip")


def combine(drift, opened, slipped):
    """DI = 1 - (1 - DI_drift)(1 - DI_open)(1 - DI_slip), equation (1); scalars or arrays in [0, 1].

    >>> round(combine(0.1, 0.2, 0.0), 12)
    0.28
    """
    return 1 - (1 - drift) * (1 - opened) * (1 - slipped)


def drift_component(drift_ratio, drift_limit=DRIFT_LIMIT):
    """|drift ratio| / limit, equation (2), not clipped.

    >>> drift_component(-0.005)
    0.25
    """
    return abs(drift_ratio) / drift_limit


def length_fraction(
    selected: np.ndarray, length: np.ndarray, total_length: float | None = None
) -> np.ndarray:
    """Length of the selected joints over the length of all, equations (3) and (4).

    selected: bool (..., n_joints); length: (n_joints,) [m]; total_length: of all joints [m], where
    these are not all. Returns (...,).

    >>> float(length_fraction(np.array([True, False]), np.array([0.1, 0.3])))
    0.25
    """
    return (
        np.asarray(selected, float)
        @ length
        / (np.sum(length) if total_length is None else total_length)
    )


def damage_index(
    time_s: np.ndarray,
    drift_ratio: np.ndarray,
    opening: np.ndarray,
    slip: np.ndarray,
    at_limit: np.ndarray,
    length: np.ndarray,
    *,
    threshold: float = THRESHOLD,
    drift_limit: float = DRIFT_LIMIT,
    slip_criterion: str = "displacement",
    total_length: float | None = None,
) -> pd.DataFrame:
    """The index over time.

    time_s, drift_ratio: (n_times,); opening, slip [m] and at_limit (bool): (n_times, n_joints);
    length: (n_joints,) [m]; threshold [m]; drift_limit [-].
    slip_criterion: "displacement" or "accumulated", |slip| over the threshold now, where slip is
    what the criterion counts (`damage.history.reader.History.slip_by`); or "shear-limit", ever at
    it.
    total_length: of all joints [m], given where inactive contact points are left out of the other
    arrays. Returns a DataFrame with time_s, DI_drift, DI_open, DI_slip, DI, and drift_over_limit,
    which is DI_drift before it was clipped to [0, 1].

    >>> index = damage_index(
    ...     np.array([0.0, 0.1]),
    ...     np.array([0.0, 0.002]),
    ...     opening=np.array([[0.0, 0.0], [2e-4, 0.0]]),
    ...     slip=np.zeros((2, 2)),
    ...     at_limit=np.zeros((2, 2), bool),
    ...     length=np.array([0.1, 0.3]),
    ... )
    >>> index[["DI_drift", "DI_open", "DI"]].round(3).values.tolist()
    [[0.0, 0.0, 0.0], [0.1, 0.25, 0.325]]
    """
    check_choice("slip criterion", slip_criterion, SLIP_CRITERIA)
    check_positive("threshold", threshold)
    check_positive("drift limit", drift_limit)
    slipped = at_limit if slip_criterion == "shear-limit" else np.abs(slip) > threshold
    over_limit = drift_component(np.asarray(drift_ratio, float), drift_limit)
    drift = np.clip(over_limit, 0, 1)
    opened = np.clip(length_fraction(np.asarray(opening) > threshold, length, total_length), 0, 1)
    slipped = np.clip(length_fraction(slipped, length, total_length), 0, 1)
    return pd.DataFrame(
        {
            "time_s": time_s,
            "DI_drift": drift,
            "DI_open": opened,
            "DI_slip": slipped,
            "DI": combine(drift, opened, slipped),
            "drift_over_limit": over_limit,
        }
    )
