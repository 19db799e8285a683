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
from damage.measure.cracks import cracked, ends_of
from damage.units import MILLIMETRE

PRIORS = 0.1, 0.5, 0.8
"""Probabilities that the ground settled [-]."""
STRANGEST = 0.95
MOST_OFF_JOINTS = 0.2
SURE = 0.9
"""Share of worlds that is called an answer, where the whole interval is beyond it by every
prior."""
LEAST_DRAWS = 50
"""Effective number of draws of the second table.  From 35 on Wilson's interval of draws that all
agree is beyond SURE; of the answers from 35 to 50 draws 1 to 2 of 100 were wrong
(docs/paper/claims.md)."""
ROWS = ("both", "earthquakes", "settlement", "none")
BUT_FOR = ("not_without_earthquakes", "not_without_settlement", "neither_alone")
WITHOUT = ("without_earthquakes", "without_settlement")
"""Causes left out that are asked of each crack."""
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


def worlds_of(width_m, prior, likeness=None):
    """The Worlds of widths {of the states of Twins: (n,) [m]} by a prior; likeness: (2, n) weights
    of the second table, None for the first."""
    width = {
        case: np.array([width_m[state] for state in states]) for case, states in _CASES.items()
    }
    weight = np.array([[prior], [1 - prior]]) * (
        np.ones_like(width["now"]) if likeness is None else likeness
    )
    return Worlds(weight, width)


def effective(weight):
    """Effective number of draws [-] of weights (2, n) or (n,)."""
    of_draw = np.asarray(weight).reshape(-1, np.shape(weight)[-1]).sum(axis=0)
    return of_draw.sum() ** 2 / (of_draw**2).sum() if of_draw.any() else 0.0


def share(hits, weight):
    """{share, low, high, draws}: share of weights (2, n) with a hit, its interval, and the
    effective number; None without any weight."""
    total = weight.sum()
    if total == 0:
        return {"share": None, "low": None, "high": None, "draws": 0.0}
    p = (weight * hits).sum() / total
    n = effective(weight)
    low, high = wilson(p, n)
    return {"share": p, "low": low, "high": high, "draws": n}


def wilson(p, n):
    """Wilson's 95 % interval of a share p of n."""
    middle = p + Z95**2 / (2 * n)
    half = Z95 * np.sqrt(p * (1 - p) / n + Z95**2 / (4 * n * n))
    scale = 1 + Z95**2 / n
    return max(0.0, (middle - half) / scale), min(1.0, (middle + half) / scale)


def table(worlds):
    """{of ROWS and BUT_FOR: `share`} of Worlds; those of BUT_FOR are of worlds that now have
    visible cracks."""
    now, without_e, without_s, none = (cracked(worlds.width[case]) for case in _CASES)
    rows = {
        name: share(hits, worlds.weight)
        for name, hits in zip(ROWS, (now, without_s, without_e, none))
    }
    hits = ~without_e, ~without_s, ~without_e & ~without_s
    return rows | {name: share(hit, worlds.weight * now) for name, hit in zip(BUT_FOR, hits)}


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
    widths = {
        name: quantiles(width / MILLIMETRE, weight)
        for name, width in (("before", before), ("added", left - before), ("left", left))
    }
    if surveyed_mm is not None and widths["before"]:
        widths["left"] = [surveyed_mm - error_mm, surveyed_mm, surveyed_mm + error_mm]
        widths["added"] = [
            now - before for now, before in zip(widths["left"], reversed(widths["before"]))
        ]
    return widths


def quantiles(values, weight):
    """Weighted quantiles RANGE of values of any shape, a list of float; None without a weight."""
    values = np.ravel(values)
    weight = np.ravel(weight)
    if not weight.sum() > 0:
        return None
    order = np.argsort(values, kind="stable")
    sums = np.cumsum(weight[order])
    places = np.searchsorted(sums, np.array(RANGE) * sums[-1])
    return [float(value) for value in values[order][np.minimum(places, len(order) - 1)]]


def verdict(tables):
    """{of BUT_FOR: `judgement`} of {prior: `table`}."""
    return {name: judgement([table[name] for table in tables.values()]) for name in BUT_FOR}


def judgement(shares):
    """What a `share` by each prior says, "yes", "no" or "open": an answer where all of them have
    LEAST_DRAWS and agree by their whole intervals."""
    if any(row["draws"] < LEAST_DRAWS for row in shares):
        return "open"
    if all(row["low"] >= SURE - 1e-9 for row in shares):
        return "yes"
    return "no" if all(row["high"] <= 1 - SURE + 1e-9 for row in shares) else "open"


def of_cracks(twins, likeness, survey, answered=True):
    """Answers on each crack of a `damage.applications.cracks.survey.Survey`, what twins say of it
    without a cause, a list of plain dictionaries in the order of the survey.

    It would be there where one of its joints has a visible crack, of worlds where one has it now.
    Draws weigh by the likeness of the whole front, (2, n): by that of a crack's surroundings alone
    a fifth of the answers on fronts that settled alone were wrong.  Where the settlement was drawn
    nothing is said without it: an eighth of the answers were wrong, of cracks by earthquakes.

    Each has the crack's label, widest and length as surveyed, its ends, and by WITHOUT: said,
    "yes" where it would be there; shares: {prior: `share`}; width_mm: 5, 50 and 95 % of the widest
    over all priors, None without a weight.  said is "open", and shares is empty, of a crack on no
    joint; said is "open", too, unless answered.
    """
    asked = WITHOUT if twins.ground_is_known else WITHOUT[:1]
    joints = survey.table.groupby("crack")["joint"].agg(list)
    cracks = []
    for label, parts in survey.pattern.stretches.groupby("crack", sort=False):
        ends = ends_of(parts)
        row = {
            "crack": str(label),
            "width_mm": parts["width_m"].max() / MILLIMETRE,
            "length_m": parts["length_m"].sum(),
            "from_m": ends[0, 0].tolist(),
            "to_m": ends[-1, 1].tolist(),
        }
        width_m = twins.widest_of(joints[label]) if label in joints else None
        for case in WITHOUT:
            row[case] = _of_crack(width_m if case in asked else None, case, likeness, answered)
        cracks.append(row)
    return cracks


def _of_crack(width_m, case, likeness, answered):
    """What is said of a crack without a cause, by the widths of its joints, None without one; a
    wall that fell without it has the crack, of no width."""
    if width_m is None:
        return {"said": "open", "shares": {}, "width_mm": None}
    shares = {}
    ranges = []
    for prior in PRIORS:
        worlds = worlds_of(width_m, prior, likeness)
        width = worlds.width[case]
        shares[str(prior)] = share(cracked(width), worlds.weight * cracked(worlds.width["now"]))
        stands = np.isfinite(width)
        ranges.append(quantiles(width[stands] / MILLIMETRE, worlds.weight[stands]))
    middle = ranges[len(ranges) // 2]
    return {
        "said": judgement(shares.values()) if answered else "open",
        "shares": shares,
        "width_mm": middle
        and [
            min(interval[0] for interval in ranges),
            middle[1],
            max(interval[2] for interval in ranges),
        ],
    }


def reasons(survey, tables_draws, strange):
    """Why there is no answer, a list of (code, value); empty where there is one.

    survey: as dictionary (`Survey.as_dict`); tables_draws: smallest effective number of the second
    table; strange: share of draws that are less strange.
    """
    widest_mm = survey["max_width_mm"]
    limit_mm = THRESHOLD / MILLIMETRE
    off = 1 - survey["share_on_joints"]
    reasons = [
        ("draws", tables_draws, tables_draws < LEAST_DRAWS),
        ("strange", strange, strange > STRANGEST),
        ("off_joints", off, off > MOST_OFF_JOINTS),
        ("small", widest_mm, widest_mm < limit_mm * (1 - 1e-6)),
    ]
    return [(code, value) for code, value, applies in reasons if applies]
