"""How many members an ensemble needs: one where nothing breaks, five, or ten where five say that tails are heavy."""

import numpy as np

HEAVY = 0.1
"""Range of the first members' values over their median from which as many again are run: the median of five is then
uncertain by some percent, and a sixth member lies outside of their range in one case out of three."""
LEAST = 5
"""Least number of members for a statement on tails."""
JUDGED = ("max_DI", "max_drift_ratio")


def most_members(run):
    """How many members an ensemble may come to: `tails_are_heavy` is asked where there are as many as it needs.

    run: a damage.studies.definition.StudyRun.
    """
    return 2 * run.members if run.adaptive and run.members >= LEAST else run.members


def runs_needed(run, records):
    """Number of runs that a point needs, from the results so far.

    run: a damage.studies.definition.StudyRun; records: {number from 1: record (`damage.studies.records`)} of its runs
    so far.  Of an adaptive ensemble the first is the only one where it breaks no joint: the wall was linear, and
    strengths change nothing; and there are as many again where the first spread widely.
    """
    if not run.adaptive:
        return run.members
    first = [records[number]["row"] for number in range(1, run.members + 1) if number in records]
    if 1 not in records or records[1]["intact"]:
        return 1
    return most_members(run) if len(first) == run.members and tails_are_heavy(first) else run.members


def tails_are_heavy(rows):
    """Whether the rows of an ensemble's members (of `damage.measure.tables.summary_row`) spread so much.

    >>> drifts = [1.00e-3, 1.01e-3, 1.02e-3, 1.03e-3, 1.05e-3]
    >>> tails_are_heavy([{"max_DI": 0.1, "max_drift_ratio": drift} for drift in drifts])
    False
    >>> tails_are_heavy([{"max_DI": 0.1, "max_drift_ratio": drift} for drift in [0.9e-3, *drifts[1:]]])
    True
    """
    return len(rows) >= LEAST and any(np.ptp(values) > HEAVY * abs(np.median(values)) for values in (
        [row[name] for row in rows] for name in JUDGED))
