"""What twins say of a claim: shares of walls by cause, but-for, widths, and where there is no
answer.

A world is a draw and whether the ground settled, whose probability is a prior.  What stands there
is `both` where it settled, else `earthquakes`; without the earthquakes it were `settlement`, else
`none`.  In the second table each world has the weight of its likeness to the survey, too
(`damage.applications.groningen.claim.likeness`).  Intervals are of 95 %, Wilson's, with the
effective number of draws (sum W)^2 / sum W^2, where W is the weight of both worlds of a draw.
"""

from typing import NamedTuple

import numpy as np

from damage.applications.groningen.life.estimate import Z95
from damage.index import THRESHOLD
from damage.measure.cracks import cracked
from damage.units import MILLIMETRE

PRIORS = 0.1, 0.5, 0.8
"""Probabilities that the ground settled [-]."""
LEAST_DRAWS = 50
"""Effective number of draws of the second table."""
STRANGEST, MOST_OFF_JOINTS = 0.95, 0.2
SURE = 0.9
"""Share of worlds that is called an answer, where the whole interval is beyond it by every
prior."""
ROWS = ("both", "earthquakes", "settlement", "none")
BUT_FOR = ("not_without_earthquakes", "not_without_settlement", "neither_alone")
RANGE = 0.05, 0.5, 0.95


class Worlds(NamedTuple):
    """Worlds of twins, (2, n) each, the first where the ground settled: weight; width [m] of what
    stands there, without the earthquakes, without the settlement, and without both."""

    weight: np.ndarray
    width: dict


_CASES = {
    "now": ("both", "earthquakes"),
    "without_earthquakes": ("settlement", "none"),
    "without_settlement": ("earthquakes", "earthquakes"),
    "without_both": ("none", "none"),
}


def worlds_of(twins, prior, likeness=None):
    """The Worlds of Twins by a prior; likeness: (2, n) weights of the second table, None for the
    first."""
    width = {
        case: np.array([twins.width_m[one] for one in states]) for case, states in _CASES.items()
    }
    weight = np.array([[prior], [1 - prior]]) * (
        np.ones((2, len(twins))) if likeness is None else likeness
    )
    return Worlds(weight, width)


def effective(weight):
    """Effective number of draws [-] of weights (2, n) or (n,)."""
    of_draw = np.asarray(weight).reshape(-1, np.shape(weight)[-1]).sum(axis=0)
    return float(of_draw.sum() ** 2 / (of_draw**2).sum()) if of_draw.any() else 0.0


def share(hits, weight):
    """{share, low, high, draws}: share of weights (2, n) with a hit, its interval, and the
    effective number; None without any weight."""
    total = weight.sum()
    if total == 0:
        return {"share": None, "low": None, "high": None, "draws": 0.0}
    p, n = float((weight * hits).sum() / total), effective(weight)
    low, high = wilson(p, n)
    return {"share": p, "low": low, "high": high, "draws": n}


def wilson(p, n):
    """Wilson's 95 % interval of a share p of n."""
    middle, half = p + Z95**2 / (2 * n), Z95 * np.sqrt(p * (1 - p) / n + Z95**2 / (4 * n * n))
    return float(max(0.0, (middle - half) / (1 + Z95**2 / n))), float(
        min(1.0, (middle + half) / (1 + Z95**2 / n))
    )


def table(worlds):
    """{of ROWS and BUT_FOR: `share`} of Worlds; those of BUT_FOR are of worlds that now have
    visible cracks."""
    now, without_e, without_s, none = (cracked(worlds.width[case]) for case in _CASES)
    rows = {
        name: share(hits, worlds.weight)
        for name, hits in zip(ROWS, (now, without_s, without_e, none))
    }
    hits = ~without_e, ~without_s, ~without_e & ~without_s
    return rows | {name: share(of, worlds.weight * now) for name, of in zip(BUT_FOR, hits)}


def widths(worlds, surveyed_mm=None, error_mm=0.0):
    """Widest crack [mm] of worlds that stand: {before, added, left: [5, 50, 95 %]}, None without a
    weight; before: without the earthquakes.  With a survey, `left` is its widest crack, within its
    error, and `added` is `left` less `before`: what the draws added themselves would be too little
    for a crack wider than theirs."""
    stands = np.isfinite(worlds.width["now"]) & np.isfinite(worlds.width["without_earthquakes"])
    weight = np.where(stands, worlds.weight, 0.0)
    left, before = (
        np.where(stands, worlds.width[case], 0.0) for case in ("now", "without_earthquakes")
    )
    found = {
        name: quantiles(of / MILLIMETRE, weight)
        for name, of in (("before", before), ("added", left - before), ("left", left))
    }
    if surveyed_mm is not None and found["before"]:
        found["left"] = [surveyed_mm - error_mm, surveyed_mm, surveyed_mm + error_mm]
        found["added"] = [now - one for now, one in zip(found["left"], reversed(found["before"]))]
    return found


def quantiles(values, weight, shares=RANGE):
    """Weighted quantiles of values of any shape, a list of float; None without a weight."""
    values, weight = np.ravel(values), np.ravel(weight)
    if not weight.sum() > 0:
        return None
    order = np.argsort(values, kind="stable")
    sums = np.cumsum(weight[order])
    places = np.searchsorted(sums, np.array(shares) * sums[-1])
    return [float(one) for one in values[order][np.minimum(places, len(order) - 1)]]


def verdict(tables):
    """{of BUT_FOR: "yes", "no" or "open"} of {prior: `table`}: an answer where all priors agree by
    their whole intervals."""
    found = {}
    for name in BUT_FOR:
        rows = [one[name] for one in tables.values()]
        known = all(row["share"] is not None for row in rows)
        found[name] = (
            "yes"
            if known and all(row["low"] >= SURE - 1e-9 for row in rows)
            else "no"
            if known and all(row["high"] <= 1 - SURE + 1e-9 for row in rows)
            else "open"
        )
    return found


def reasons(survey, tables_draws, strange):
    """Why there is no answer, a list of (code, value); empty where there is one.

    survey: as dictionary (`Survey.as_dict`); tables_draws: smallest effective number of the second
    table; strange: share of draws that are less strange.
    """
    widest_mm, limit_mm = survey["max_width_mm"], THRESHOLD / MILLIMETRE
    off = 1 - survey["share_on_joints"]
    found = [
        ("draws", tables_draws, tables_draws < LEAST_DRAWS),
        ("strange", strange, strange > STRANGEST),
        ("off_joints", off, off > MOST_OFF_JOINTS),
        ("small", widest_mm, widest_mm < limit_mm * (1 - 1e-6)),
    ]
    return [(code, value) for code, value, applies in found if applies]
