"""How far a value is from the limit of its criterion, as a share of that limit: zero or more where
it holds, else less.

Of several that all have to hold the least counts, `min`: as long as they do the one that fails
first, and where some fail the one that is farthest from holding.
"""

import math

EDGE = 0.05
"""A claim is borderline where 5 % more or less of the limit would change its verdict: by so much
two correct solvers differ in maximum drift (docs/validation/two-solvers.md)."""


def at_most(value, limit):
    """
    >>> at_most(0.75, 1.0), at_most(1.0, 1.0)
    (0.25, 0.0)
    """
    return _share(limit - value, limit)


def at_least(value, limit):
    """
    >>> round(at_least(0.124, 1.01 * 0.125), 3)
    -0.018
    """
    return _share(value - limit, limit)


def above(value, limit):
    """As `at_least`, but the limit itself does not hold."""
    return at_least(value, limit) or math.nextafter(0.0, -1.0)


def within(value, target, tolerance):
    """The distance to the nearer end of target - tolerance to target + tolerance.

    >>> round(within(0.22, 0.2, 0.04), 3), round(within(0.264, 0.2, 0.04), 3)
    (0.083, -0.1)
    """
    return _share(
        tolerance - abs(value - target), target + math.copysign(tolerance, value - target)
    )


def _share(distance, limit):
    if distance == 0 or limit == 0:
        return math.copysign(math.inf, distance) if distance else 0.0
    return float(distance / abs(limit))
