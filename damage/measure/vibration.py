"""Periods of a vibration: zero crossings, and the natural period of a free one."""

import numpy as np

REARM = 0.02
"""Share of the largest drift that the wall must go to the other side before its next upward crossing
counts: ripples around zero are no cycles."""
NOISE = 1e-12
"""Drift ratio up to which a wall stands still; rounding gives it up to 1e-16."""


def upward_crossings(time_s, value, rearm=REARM):
    """Times (k,) [s] at which `value` passes zero upwards, linear between samples.

    time_s, value: (n_times,).  Between two that count, the value has been below -rearm max|value|, and below -NOISE.

    >>> t = np.linspace(0, 1, 1001)
    >>> upward_crossings(t, np.sin(2 * np.pi * 4 * (t - 0.1))).round(6)
    array([0.1 , 0.35, 0.6 , 0.85])
    """
    time_s, value = np.asarray(time_s, float), np.asarray(value, float)
    level = max(rearm * np.abs(value).max(initial=0.0), NOISE)
    up = np.flatnonzero((value[:-1] < 0) & (value[1:] >= 0))
    # `armed[i]`: how often the value has entered the far side up to sample i; one crossing an entry.
    armed = np.cumsum(np.diff((value < -level).astype(int), prepend=0) > 0)
    _, first = np.unique(armed[up], return_index=True)
    up = up[first[armed[up][first] > 0]]
    share = -value[up] / (value[up + 1] - value[up])
    return time_s[up] + share * (time_s[up + 1] - time_s[up])


def period_of(history):
    """Natural period [s] of a free-vibration run, None for any other."""
    if not history.loading.drive.first_mode_m_s:
        return None
    return natural_period(history.moving["time_s"].to_numpy(), history.moving["drift_ratio"].to_numpy())


def natural_period(time_s, displacement):
    """Period [s] of the strongest vibration: the frequency of the largest projection on a sinusoid.

    time_s, displacement: (n_times,).  None for less than three cycles, and where nothing moves.
    The estimate is found by least squares on a fine grid around the highest peak of the Fourier
    spectrum; it is exact for a single undamped sinusoid.
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
