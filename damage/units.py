"""Constants and the conversions used at the boundary; everything inside is SI and radians."""

GRAVITY = 9.81
"""Acceleration of gravity [m/s2], and 1 g in every file and result.

The standard gravity of 9.80665 m/s2 is 0.03 % less.  Both kinds of files in g (CSV, AT2), weights and amplitudes of
motions use this one value, so that a motion of 1 g equals the weight of the wall.
"""

MILLIMETRE = 1e-3
"""One millimetre [m]."""
