"""Periods of vibration: zero crossings, and the natural period of a free vibration."""

import numpy as np

from damage.history.schema import Column
from damage.measure.register import measure

REARM = 0.02
"""Share of the largest |drift| [-] below zero that the drift must reach before its next upward crossing counts, so that
ripples around zero are not counted as cycles."""
NOISE = 1e-12
"""Drift ratio [-] below which a wall counts as at rest; rounding errors reach 1e-16."""


def upward_crossings(time_s, value, rearm=REARM):
    """Times at which `value` crosses zero upwards, (k,) [s], linearly interpolated between samples.

    time_s, value: (n_times,); rearm [-].  A crossing counts if the value has been below -max(rearm max|value|, NOISE)
    since the crossing before.

    >>> t = np.linspace(0, 1, 1001)
    >>> upward_crossings(t, np.sin(2 * np.pi * 4 * (t - 0.1))).round(6)
    array([0.1 , 0.35, 0.6 , 0.85])
    """
    time_s, value = np.asarray(time_s, float), np.asarray(value, float)
    level = max(rearm * np.abs(value).max(initial=0.0), NOISE)
    up = np.flatnonzero((value[:-1] < 0) & (value[1:] >= 0))
    # `armed[i]`: how often the value has fallen below -level up to sample i; one crossing counts for each time.
    armed = np.cumsum(np.diff((value < -level).astype(int), prepend=0) > 0)
    _, first = np.unique(armed[up], return_index=True)
    up = up[first[armed[up][first] > 0]]
    share = -value[up] / (value[up + 1] - value[up])
    return time_s[up] + share * (time_s[up + 1] - time_s[up])


@measure({"period_s": Column("s", "natural period of a run in free vibration")})
def period_of(history):
    """Natural period of a History of free vibration [s]; None for another loading."""
    if not history.loading.drive.first_mode_m_s:
        return None
    return natural_period(history.moving["time_s"].to_numpy(), history.moving["drift_ratio"].to_numpy())


def natural_period(time_s, displacement):
    """Period of the dominant vibration [s]: that of the sinusoid with an offset that fits best by least squares.

    time_s, displacement: (n_times,), equally spaced.  The search is around the highest peak of the Fourier spectrum,
    and exact for a single undamped sinusoid.  None for fewer than three cycles or 16 samples, and where the
    displacement varies by less than NOISE.
    """
    from scipy.optimize import minimize_scalar

    if len(time_s) < 16 or np.ptp(displacement) < NOISE:
        return None
    step = (time_s[-1] - time_s[0]) / (len(time_s) - 1)
    centred = displacement - displacement.mean()
    spectrum = np.abs(np.fft.rfft(centred))
    peak = int(np.argmax(spectrum[1:]) + 1)
    if peak < 3:
        return None
    width = 1 / (step * len(time_s))

    def misfit(frequency):
        phase = 2 * np.pi * frequency * time_s
        basis = np.column_stack([np.cos(phase), np.sin(phase), np.ones_like(phase)])
        return np.sum((basis @ np.linalg.lstsq(basis, displacement, rcond=None)[0] - displacement) ** 2)

    best = minimize_scalar(misfit, bounds=((peak - 1) * width, (peak + 1) * width), method="bounded",
                           options={"xatol": 1e-6 * width})
    return float(1 / best.x)
