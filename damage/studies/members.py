"""How many members an ensemble needs: five, or ten where five say that the tails are heavy."""

import numpy as np

HEAVY = 0.1
"""Range of the first members' values over their median from which as many again are run: the median of five is then
uncertain by some percent, and a sixth member lies outside of their range in one case out of three."""
JUDGED = ("max_DI", "max_drift_ratio")


def tails_are_heavy(rows):
    """Whether the rows of an ensemble's members (of `damage.measure.tables.summary_row`) spread so much.

    >>> tails_are_heavy([{"max_DI": 0.1, "max_drift_ratio": drift} for drift in (1.00e-3, 1.02e-3, 1.05e-3)])
    False
    >>> tails_are_heavy([{"max_DI": 0.1, "max_drift_ratio": drift} for drift in (0.5e-3, 1.0e-3, 1.1e-3)])
    True
    """
    return any(np.ptp(values) > HEAVY * abs(np.median(values)) for values in (
        [row[name] for row in rows] for name in JUDGED))
