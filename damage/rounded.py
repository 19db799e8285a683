"""Rounding of what enters a time step, by which the last bits of libraries do not reach it.

Inputs are made by sums, products and `damage.elementary` wherever that is possible, then rounded
here, once each, to grids that are coarse beside the errors of libraries and fine beside what is
known of walls and motions:

    accelerations of the base [m/s2]           ACCELERATION = 2**-24 (6e-8 m/s2)
    displacements of the ground [m]            DISPLACEMENT = 2**-30 (1e-9 m)
    strengths, stiffnesses, masses, friction,
    amplitudes of a pushed top                 BITS = 26 significant bits (1.5e-8 of the value)
    critical time step [s]                     down to three digits

A value next to an edge between two grid points can still go either way: the chance in a run is the
error over the grid times the number of values.  docs/model/model.md states it for each kind of
input.
"""

from decimal import ROUND_FLOOR, Decimal

import numpy as np

ACCELERATION = 2.0**-24
DISPLACEMENT = 2.0**-30
BITS = 26
_EDGE = 2.0**-20
"""Share by which a number may lie below one of three digits and still be taken for it."""


def to_bits(values):
    """Values, or a number, with BITS significant bits; infinite ones stay."""
    part, power = np.frexp(values)
    return np.ldexp(np.rint(np.ldexp(part, BITS)), power - BITS)


def to_grid(values, step):
    """Values, or a number, as multiples of a step that is a power of two."""
    return np.rint(np.asarray(values, float) * (1.0 / step)) * step + 0.0  # no negative zeros


def down_to_three_digits(value):
    """A positive number rounded down to three digits.

    >>> down_to_three_digits(4.7159e-05), down_to_three_digits(0.3 - 1e-15)
    (4.71e-05, 0.3)
    """
    exact = Decimal(float(value) * (1.0 + _EDGE))
    return float(exact.quantize(Decimal(1).scaleb(exact.adjusted() - 2), rounding=ROUND_FLOOR))
