"""Constants and the conversions used at the boundary; everything inside is SI and radians."""

import math
from decimal import Decimal

GRAVITY = 9.81
"""Acceleration of gravity [m/s2], and 1 g in every file and result.

The standard gravity of 9.80665 m/s2 is 0.03 % less.  Both kinds of files in g (CSV, AT2), weights
and amplitudes of motions use this one value, so that a motion of 1 g equals the weight of the wall.
"""

MILLIMETRE = 1e-3
"""One millimetre [m]."""


def rounded(value, digits):
    """A number as text with so many significant digits, six decimals at most, never with an
    exponent.

    >>> rounded(10.037, 2), rounded(0.14562, 3), rounded(12345.6, 3), rounded(-1.7e-10, 3)
    ('10', '0.146', '12300', '0')
    """
    if not math.isfinite(value):
        return str(value)
    exact = Decimal(f"{round(value, 6):.{digits - 1}e}")
    return f"{exact:f}" if exact else "0"
