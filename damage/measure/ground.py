"""Movement of the ground: settlement of the supports, damage at the end of the settlement, rigid
motion of the base."""

import numpy as np

from damage.history.schema import Column, measure
from damage.measure.cracks import psi_history
from damage.units import MILLIMETRE

_EQUALLY = 0.999


@measure(
    {
        "angular_distortion, deflection_ratio": Column(
            "1",
            "of the settled ground: largest distance from the chord between the wall's ends over"
            " the shorter part beside it, and over the length, positive in sagging (Burland and"
            " Wroth 1974); empty without a settlement",
        ),
        "relative_settlement_mm, ground_tilt": Column(
            "mm, 1",
            "difference between the highest and the lowest place of the "
            "settled ground; slope of the chord",
        ),
        "settled_DI, settled_psi, settled_crack_width_mm": Column(
            "1, 1, mm", "damage index, Psi and widest crack at the end of the settlement stage"
        ),
    }
)
def settlement_measures(history, threshold, drift_limit, slip, psi_from):
    """Settlement and damage of a History at the end of the settlement stage; arguments: of
    `damage.measure.summary.summarise`."""
    settlement = np.flatnonzero(history.series["stage"] == "settlement")
    if not len(settlement):
        return None
    last = settlement[-1]
    cracks = psi_history(history, psi_from)
    return *distortion(*edges_of(history, last)), *map(
        float,
        (
            history.index(threshold, drift_limit, slip)["DI"].iloc[last],
            cracks["psi"].iloc[last],
            cracks["max_width_m"].iloc[last] / MILLIMETRE,
        ),
    )


@measure(
    {
        "max_base_translation_mm, max_base_rotation_rad": Column(
            "mm, rad",
            "largest rigid motion of the base course where the ground moves, which the drift"
            " leaves out",
        )
    }
)
def base_measures(history):
    """Largest rigid motion of the base course of a History over the run."""
    translation, rotation = (
        np.abs(history.series[name]).max() for name in ("base_translation_m", "base_rotation_rad")
    )
    return [None if np.isnan(value) else float(value) for value in (1e3 * translation, rotation)]


def edges_of(history, sample):
    """Place along the wall and displacement upwards of the edges and the middle of all supports at
    a sample, two arrays (n,) [m]."""
    left, right = (history.supports[name].to_numpy() for name in ("left_m", "right_m"))
    motion = history.support_displacement[sample].astype(float)
    arm = (right - left)[:, np.newaxis] / 2 * [-1.0, 0.0, 1.0]
    x = ((left + right) / 2)[:, np.newaxis] + arm
    up = motion[:, 1:2] + arm * np.sin(motion[:, 2:])
    order = np.argsort(x, axis=None, kind="stable")
    return x.ravel()[order], up.ravel()[order]


def distortion(x, up):
    """Angular distortion, deflection ratio, relative settlement and tilt of the ground's
    displacement upwards `up` (n,) at x (n,) [m], the ends first and last.

    The tilt is the slope of the chord between the ends [-].  The deflection ratio is the largest
    distance from that chord over the length L, positive in sagging; the angular distortion is that
    distance over the length of the shorter part beside it (J. B. Burland, C. P. Wroth, Settlement
    of buildings and associated damage, 1974); the relative settlement is the difference between the
    highest and the lowest place [mm].
    """
    length = x[-1] - x[0]
    tilt = (up[-1] - up[0]) / length
    below = up[0] + tilt * (x - x[0]) - up
    shorter = np.minimum(x - x[0], x[-1] - x)
    # Of places that are equally far but for single precision that nearest to the middle.
    farthest = int(
        np.argmax(np.where(np.abs(below) >= _EQUALLY * np.abs(below).max(), shorter, -1.0))
    )
    shorter = shorter[farthest]
    deflection = float(below[farthest])
    return (
        abs(deflection) / float(shorter) if shorter > 0 else 0.0,
        deflection / float(length),
        float(np.ptp(up)) / MILLIMETRE,
        float(tilt),
    )
