"""Constants and the conversions used at the boundary; everything inside is SI and radians."""

import math
from decimal import Decimal

GRAVITY = 9.81
"""Acceleration of gravity [m/s2]; 1 g of base motion is this, too."""

MILLIMETRE = 1e-3
"""One millimetre [m]."""


def rounded(value, digits):
    """A number as text with so many significant digits, never with an exponent.

    >>> rounded(10.037, 2), rounded(0.14562, 3), rounded(12345.6, 3), rounded(0.0, 2)
    ('10', '0.146', '12300', '0')
    """
    if not math.isfinite(value):
        return str(value)
    exact = Decimal(f"{value:.{digits - 1}e}")
    return f"{exact:f}" if exact else "0"
