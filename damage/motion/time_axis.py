"""The time step of a record by its column of times, and what such a column may be instead."""

import math

import numpy as np

from damage.errors import InputError

TIME_TOLERANCE = 0.01
"""Largest distance of a CSV time from a uniform grid, as a share of the step.

Room for the rounding of the printed times: four decimals at 150 Hz are 0.75 % of the step.
"""

LONGEST_STEP_S = 0.05
"""Of a record's samples: beyond it nothing above 10 Hz is recorded, and walls have their first mode at 5 to 30 Hz."""

_ROUNDED_SHARE = 0.05
"""Of the steps that differ from the usual one: fewer are lost samples, more are rounding."""

_WAY_OUT = "write seconds, or give --sample-step S, the time between two samples [s]"


def check_step(path, step_s: float):
    """Raise InputError where samples are too far apart for the motion of a wall."""
    if step_s > LONGEST_STEP_S:
        raise InputError(f"{path}: a time step of {step_s:g} s; expected at most {LONGEST_STEP_S:g} s, or the motion "
                         f"of a wall is not in the record: {_WAY_OUT}")


@np.errstate(over="ignore", invalid="ignore")  # of times that no clock shows, which are refused
def uniform_step(path, lines: list[int], time_s: np.ndarray, given_s: float | None = None) -> float:
    """The constant step [s] of a column of times (n_samples,) in these lines; given_s: what --sample-step says of it.

    Raises InputError with the line, or with what the column has in place of seconds.
    """
    if given_s is not None:
        return _given_step(path, time_s, given_s)
    steps = np.diff(time_s)
    usual = float(np.median(steps))
    step = (time_s[-1] - time_s[0]) / steps.size
    off_grid = np.abs(time_s - time_s[0] - step * np.arange(time_s.size))
    uniform = steps.min() > 0 and off_grid.max() <= TIME_TOLERANCE * step
    if not uniform:
        _refuse_rounded(path, time_s, steps, usual)
    if not steps.min() > 0:
        k = int(np.argmax(steps <= 0))
        raise InputError(f"{path}: line {lines[k + 1]}: time {time_s[k + 1]:g} s after {time_s[k]:g} s;"
                         " expected times that increase, sort the rows")
    if not uniform:
        k = int(np.argmax(np.abs(steps - usual)))
        raise InputError(f"{path}: line {lines[k + 1]}: a step of {steps[k]:g} s among {usual:g} s;"
                         f" expected uniform times within {TIME_TOLERANCE:.0%} of the step, resample the record")
    # twelve digits: the 0.01 s that was meant, not the nearest double of 0.29 s / 29
    step = float(f"{step:.12g}")
    if step > LONGEST_STEP_S and step == round(step) <= 50:
        what = "sample numbers, or milliseconds at 1000 Hz" if step == 1 else "milliseconds, or every so many samples"
        raise InputError(f"{path}: times {time_s[0]:g}, {time_s[1]:g}, {time_s[2 % time_s.size]:g}, ... are no seconds "
                         f"but {what}; expected a step of at most {LONGEST_STEP_S:g} s: {_WAY_OUT}")
    return step


def _refuse_rounded(path, time_s, steps, usual):
    """Raise InputError where times have too few decimals for their step."""
    decimals = _decimals(time_s)
    last_place = 10.0**-decimals
    unlike = np.abs(steps - usual) > 0.5 * last_place
    if steps.min() < 0 or np.ptp(steps) > 1.5 * last_place or unlike.sum() < max(2, _ROUNDED_SHARE * steps.size):
        return
    places = f"{decimals} decimal{'s' if decimals != 1 else ''}"
    raise InputError(f"{path}: times are rounded to {places}: {time_s.size} samples from {time_s[0]:g} to "
                     f"{time_s[-1]:g} s; expected steps that are equal within {TIME_TOLERANCE:.0%}: write times with "
                     f"{decimals + 1} or more decimals, or give --sample-step S, the time between two samples [s]")


def _decimals(time_s) -> int:
    """Decimals with which times are printed, up to nine."""
    for decimals in range(9):
        scaled = time_s * 10.0**decimals
        if np.abs(scaled - np.round(scaled)).max() < 1e-4:
            return decimals
    return 9


def _given_step(path, time_s, given_s: float) -> float:
    """The step by --sample-step; InputError unless the times are multiples of it in seconds or milliseconds, as far as
    they are rounded, or numbers of samples."""
    if not (math.isfinite(given_s) and given_s > 0):
        raise InputError(f"--sample-step {given_s:g}: expected the time between two samples [s]; correct it")
    elapsed, numbers = time_s - time_s[0], np.arange(time_s.size)
    room = 10.0**-_decimals(time_s)
    for step in (given_s, 1e3 * given_s, 1.0):
        if np.abs(elapsed - step * numbers).max() <= max(TIME_TOLERANCE * step, room if step != 1.0 else 0.0):
            return given_s
    raise InputError(f"{path}: times step by {np.median(np.diff(time_s)):g} s, --sample-step by {given_s:g} s; "
                     "expected the same; leave --sample-step out, or keep the column of accelerations alone")
