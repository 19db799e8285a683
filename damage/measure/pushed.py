"""Measures of the force on a wall: peak of any run, first loading of a pushed wall.

Force is the base shear and displacement that of the top course, as measured in a laboratory.
"""

import numpy as np

from damage.history.reader import History
from damage.history.schema import Column, measure

INITIAL_SHARE = 0.15
"""Share of the peak force at which the initial stiffness is taken, on first loading [-]."""
SECANT_SHARE = 0.7
"""Share of the peak force at which the secant stiffness is taken, on first loading [-]."""


def since_the_push(history: History) -> tuple[np.ndarray, ...]:
    """Base shear [N], drift ratio [-] and top displacement [m] of all samples, (n,) each.  The
    latter two are counted from time zero, the last sample of a settlement stage, where the push
    begins; before it all are zero.

    >>> shear, drift, top = since_the_push(pushed)
    >>> round(float(drift.max()), 4), shear.shape
    (0.002, (21,))
    """
    force, drift, top = (
        history.series[name].to_numpy()
        for name in ("base_shear_n", "drift_ratio", "top_displacement_m")
    )
    start = max(0, np.count_nonzero(history.series["stage"] == "settlement") - 1)
    before = np.arange(len(force)) < start
    return tuple(
        np.where(before, 0.0, values) for values in (force, drift - drift[start], top - top[start])
    )


@measure(
    {
        "peak_base_shear_n": Column(
            "N", "largest absolute horizontal force of the wall on the ground"
        )
    }
)
def peak_base_shear(history: History) -> float:
    """Largest |base shear| of a History under any loading [N].

    >>> float(peak_base_shear(pushed)["peak_base_shear_n"])
    10000.0
    """
    return float(np.abs(history.series["base_shear_n"]).max())


@measure(
    {
        "peak_force_n, drift_at_peak_force": Column(
            "N, 1", "of a pushed wall: largest base shear, the drift there"
        ),
        "peak_force_wave_n": Column(
            "N",
            "of a pushed wall: amplitude of the base shear about a straight line in the first"
            " period before its peak, by which that depends on the speed",
        ),
        "initial_stiffness_n_per_m, secant_stiffness_n_per_m": Column(
            "N/m",
            "of a pushed wall: base shear over top displacement at 0.15 and 0.7 of the peak, on"
            " first loading",
        ),
    }
)
def first_loading(history: History):
    """Peak force and stiffnesses of a pushed History.

    A quasi-static push does not vibrate; the wave tells how far this one is from it.  The
    stiffnesses are taken where |base shear| first reaches INITIAL_SHARE and SECANT_SHARE of the
    peak.  They are of the entire run, in whichever direction each is reached first; `bilinear` uses
    the envelope in one direction.

    >>> float(first_loading(pushed)["drift_at_peak_force"])
    0.001
    """
    if history.loading.drive.top is None:
        return None
    # The base shear in place of the force at the top: the two differ by inertia and damping only,
    # and the steps of a prescribed velocity excite the base shear less.
    force, drift, displacement = since_the_push(history)
    peak = int(np.argmax(np.abs(force)))
    values = [float(abs(force[peak])), float(abs(drift[peak])), _wave(history, force, peak)]
    for share in (INITIAL_SHARE, SECANT_SHARE):
        first = int(np.argmax(np.abs(force) >= share * values[0]))
        values.append(
            float(force[first] / displacement[first]) if displacement[first] != 0 else None
        )
    return values


def _wave(history, force, peak):
    """Amplitude of a sine [N] that scatters about a straight line as the forces do in the first
    period up to the sample `peak`; None where that has no more than two samples."""
    time_s = history.series["time_s"].to_numpy()
    since = time_s[peak] - (history.eigen_period_s or 0.0)
    before = slice(int(np.searchsorted(time_s, since)), peak + 1)
    if peak + 1 - before.start < 3:
        return None
    line = np.polynomial.Polynomial.fit(time_s[before], force[before], 1)
    return float(np.sqrt(2) * np.std(force[before] - line(time_s[before])))
