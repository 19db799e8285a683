"""Time that is left of work in progress, by the time that its parts took on this machine."""

import math
import time

import numpy as np

LEAST_S = 4.0
"""Time that is followed before a pace is known [s]."""
LEAST_SHARE = 0.1
"""Share of all work that is followed before a pace is known [-]."""
STEADY = 1.5
"""Ratio of the paces of two stretches of work up to which they are one."""
FACTOR = 2.0
"""A time that is shown is at least what follows over this factor, and at most that times it."""
THIN = 0.01
"""Share of the time so far between two notes."""


class Pace:
    """Work done over time, in any unit; what comes before the first of it, as compilation, does not
    count."""

    def __init__(self):
        self._times = []
        self._works = []

    def note(self, done):
        """Note how much work is done by now."""
        now_s = time.monotonic()
        times = self._times
        if done > 0 and (not times or now_s - times[-1] > THIN * (now_s - times[0])):
            times.append(now_s)
            # a run that begins again takes some back
            self._works.append(max([done, *self._works[-1:]]))

    def left_s(self, least, most=None):
        """Time [s] for work to come, from least to most; None where it is not known within FACTOR.

        The pace is that of the last stretch with as much work as is to come, half of the work at
        most, and has to be that of the stretch before.
        """
        most = least if most is None else most
        if most <= 0.0:
            return 0.0
        if len(self._times) < 3 or most > FACTOR * least:
            return None
        began = self._times[0]
        now = self._times[-1]
        done = self._works[-1]
        made = done - self._works[0]
        if now - began < LEAST_S or made < LEAST_SHARE * (made + least):
            return None
        middle = np.interp(done - min(least, made / 2), self._works, self._times)
        middle = min(middle, now - LEAST_S / 2)
        ends = [max(began, 2 * middle - now), middle, now]
        before, last = np.diff(np.interp(ends, self._times, self._works)) / np.diff(ends)
        if not 0.0 < max(before, last) <= STEADY * min(before, last):
            return None
        return math.sqrt(least * most) / last


def time_left(left_s):
    """A time that is left [s] in words, in minutes and seconds; None: not known.

    >>> time_left(65.2), time_left(4.0), time_left(None)
    ('time left about 1:05', 'time left below 0:10', 'time left not known yet')
    """
    if left_s is None:
        return "time left not known yet"
    if FACTOR * left_s < 10.0:
        return "time left below 0:10"
    minutes, seconds = divmod(round(left_s), 60)
    return f"time left about {minutes}:{seconds:02d}"
