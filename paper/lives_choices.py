"""Lives beside lives (`python3 -m paper choices`): the same lives by other choices, and what a
wall's own fragility says of many events.

The fragility of a wall in a single event says nothing about many.  Two readings of it bound what
may be expected: every event draws anew whether it damages the wall, or only the largest counts.
`readings` fits the curve to lives of the largest event alone and lays both beside the lives with
all events.
"""

from itertools import product

import numpy as np

from damage.applications.groningen.life.estimate import Z95, probability
from damage.applications.groningen.life.results import OUTCOMES, POPULATION, VISIBLE, beside
from damage.applications.studies.fragility import curve, solve
from damage.errors import InputError

_FELL = 9.0  # Psi by which a fallen wall counts in differences


def choices(parts):
    """How outcomes of the same lives differ by other choices, a list of rows of choices.csv: for
    each pair of points the difference of P(Psi >= 1), other minus point, with its 95 % interval,
    and the mean and largest difference of Psi at rest."""
    rows = []
    for one, other, first, second in beside(parts):
        row = {"point": one.point, "other": other.point, "lives": len(first)}
        for name in OUTCOMES:
            change = paired(second[name] >= 1.0, first[name] >= 1.0)
            row |= zip((f"change_p_{name}_1{end}" for end in ("", "_low", "_high")), change)
        change = (second["psi"].clip(upper=_FELL) - first["psi"].clip(upper=_FELL)).abs()
        rows.append(row | {"mean_change_psi": change.mean(), "most_change_psi": change.max()})
    return rows


def in_words(row):
    """A line of text of a row of choices.csv."""
    changes = (
        f"P(Psi >= 1) {when} {row[f'change_p_{name}_1']:+.3f} ({row[f'change_p_{name}_1_low']:+.3f}"
        f" to {row[f'change_p_{name}_1_high']:+.3f})"
        for name, when in OUTCOMES.items()
    )
    return (
        f"{row['other']} beside {row['point']}, {row['lives']} equal lives: {', '.join(changes)};"
        f" Psi at rest differs by {row['mean_change_psi']:.3f} in the mean,"
        f" {row['most_change_psi']:.3f} at most"
    )


def readings(parts):
    """Lives with all events beside two readings of the same wall's single events: a list of rows of
    readings.csv.

    Points without lives of the largest event alone are left out.
    """
    alone = {
        one.point: other
        for one, other, *_ in beside(parts)
        if other.point == f"{one.point}_largest"
    }
    return [row for one in parts if one.point in alone for row in _readings(one, alone[one.point])]


def _readings(lives, largest_alone):
    every, single = lives.last, largest_alone.last
    pgv = np.array([lives.draws.pgv(number)[0] for number in range(1, POPULATION + 1)])
    largest = pgv.max(axis=1)
    for name, level in product(OUTCOMES, VISIBLE):
        row = {"point": lives.point, "psi": level, "outcome": OUTCOMES[name]}
        for words, of in (("", every), ("_largest", single)):
            found = probability(of[name] >= level, of["largest_mm_s"], largest)
            row |= {
                f"lives{words}": found.lives,
                f"p{words}": found.p,
                f"p{words}_low": found.interval[0],
                f"p{words}_high": found.interval[1],
            }
        yield row | by_own_curve(single["largest_mm_s"], single[name] >= level, pgv)


def by_own_curve(largest, hits, pgv):
    """Fragility of single events of PGV `largest` (n,) [mm/s] that have an outcome or not (n,), and
    the probability of the outcome after the events `pgv` (lives, events) by both readings; NaN
    where the lives determine no curve."""
    median, dispersion, why, _ = solve(largest, np.asarray(hits, int), np.ones(len(largest), int))
    if dispersion == 0:
        median, dispersion, why = (
            np.nan,
            np.nan,
            "no life has it up to a PGV from which on all do: no dispersion",
        )
    single = curve(pgv, median, dispersion)  # NaN where the median is
    return {
        "median_mm_s": median,
        "dispersion": dispersion,
        "undetermined": why,
        "p_by_each_event": float(np.mean(1 - np.prod(1 - single, axis=1))),
        "p_by_largest": float(np.mean(single.max(axis=1))),
    }


def paired(first, second):
    """Mean of first - second (n,) over pairs with common random numbers, and its 95 % interval:
    (mean, low, high)."""
    difference = np.asarray(first, float) - np.asarray(second, float)
    if len(difference) < 2:
        raise InputError(f"{len(difference)} pairs of lives: expected at least two")
    mean, half = difference.mean(), Z95 * difference.std(ddof=1) / np.sqrt(len(difference))
    return float(mean), float(mean - half), float(mean + half)
