"""Movement of the ground: settlement of the supports, damage at the end of the settlement, rigid motion of the base."""

import numpy as np

from damage.measure.cracks import PSI_FROM, psi_history
from damage.units import MILLIMETRE

SETTLEMENT = ("angular_distortion", "deflection_ratio", "relative_settlement_mm", "ground_tilt")
SETTLED = ("settled_DI", "settled_psi", "settled_crack_width_mm")
_EQUALLY = 0.999
BASE = ("max_base_translation_mm", "max_base_rotation_rad")


def ground_measures(history, psi_from=PSI_FROM):
    """Measures of a History whose ground moves, {column: value}; None where they do not apply.

    Columns: SETTLEMENT, of the supports, and SETTLED, the damage, both at the end of the settlement stage; BASE, the
    largest rigid motion of the base course over the run.

    psi_from: width from which a crack counts in Psi [m].
    """
    found = dict.fromkeys((*SETTLEMENT, *SETTLED, *BASE))
    settlement = np.flatnonzero(history.series["stage"] == "settlement")
    if len(settlement):
        last, cracks = settlement[-1], psi_history(history, psi_from)
        found |= zip(SETTLEMENT, distortion(*edges_of(history, last)))
        found |= zip(SETTLED, map(float, (history.index()["DI"].iloc[last], cracks["psi"].iloc[last],
                                          cracks["max_width_m"].iloc[last] / MILLIMETRE)))
    for name, column, factor in zip(BASE, ("base_translation_m", "base_rotation_rad"), (1 / MILLIMETRE, 1.0)):
        largest = np.abs(history.series[column]).max()
        found[name] = None if np.isnan(largest) else float(factor * largest)
    return found


def edges_of(history, sample):
    """Place along the wall and displacement upwards of the edges and the middle of all supports at a sample, two arrays
    (n,) [m]."""
    left, right = (history.supports[name].to_numpy() for name in ("left_m", "right_m"))
    motion, half = history.support_displacement[sample].astype(float), (right - left) / 2
    side = np.array([[-1.0], [0.0], [1.0]])
    x, up = (left + right) / 2 + side * half, motion[:, 1] + side * half * np.sin(motion[:, 2])
    order = np.argsort(x.T.ravel(), kind="stable")
    return x.T.ravel()[order], up.T.ravel()[order]


def distortion(x, up):
    """Values of SETTLEMENT of the ground's displacement upwards `up` (n,) at x (n,) [m], the ends first and last.

    The tilt is the slope of the chord between the ends [-].  The deflection ratio is the largest distance from that
    chord over the length L, positive in sagging; the angular distortion is that distance over the length of the
    shorter part beside it (J. B. Burland, C. P. Wroth, Settlement of buildings and associated damage, 1974); the
    relative settlement is the difference between the highest and the lowest place [mm].
    """
    length = x[-1] - x[0]
    tilt = (up[-1] - up[0]) / length
    below = up[0] + tilt * (x - x[0]) - up
    shorter = np.minimum(x - x[0], x[-1] - x)
    # Of places that are equally far but for single precision that nearest to the middle.
    farthest = int(np.argmax(np.where(np.abs(below) >= _EQUALLY * np.abs(below).max(), shorter, -1.0)))
    shorter, deflection = shorter[farthest], float(below[farthest])
    return (abs(deflection) / float(shorter) if shorter > 0 else 0.0, deflection / float(length),
            float(np.ptp(up)) / MILLIMETRE, float(tilt))
