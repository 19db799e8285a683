"""Constants and the conversions used at the boundary; everything inside is SI and radians."""

GRAVITY = 9.81
"""Acceleration of gravity [m/s2]; 1 g of base motion is this, too."""

MILLIMETRE = 1e-3
"""One millimetre [m]."""
