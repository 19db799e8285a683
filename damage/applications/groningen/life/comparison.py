"""Lives beside lives: the same lives by other choices, and what a wall's own fragility says of many
events.

The fragility of a wall in a single event says nothing about many.  Two readings of it bound what
may be expected: every event draws anew whether it damages the wall, or only the largest counts.
`readings` fits the curve to lives of the largest event alone and lays both beside the lives with
all events.
"""

from dataclasses import replace
from itertools import product

import numpy as np

from damage.applications.groningen.life.estimate import paired, probability
from damage.applications.studies.fragility import curve, solve
from damage.history.schema import Column

VISIBLE = 1.0, 2.0
"""Psi whose probability is reported."""
OUTCOMES = {"psi": "at rest", "max_psi": "at any moment"}
POPULATION = 4000
"""Lives that are drawn and not run, for the distribution of PGV."""
_FELL = 9.0  # Psi by which a fallen wall counts in differences


def bounds(name, meaning):
    """Columns of a value with its 95 % interval."""
    return {
        name: Column("1", meaning),
        f"{name}_low": Column("1", f"lower 95 % bound of {name}"),
        f"{name}_high": Column("1", f"upper 95 % bound of {name}"),
    }


CHOICES = {
    "point": Column("", "of the study"),
    "other": Column("", "point of the same lives by another choice"),
    "lives": Column("1", "number of lives that both have"),
    **bounds("change_p_psi_1", "difference of P(Psi >= 1) at rest at the end, other minus point"),
    **bounds("change_p_max_psi_1", "the same of P(Psi >= 1) at any moment"),
    "mean_change_psi": Column("1", "mean absolute difference of Psi at rest at the end"),
    "most_change_psi": Column("1", "largest absolute difference of it"),
}
"""Columns of choices.csv."""
READINGS = {
    "point": Column("", "of the study"),
    "psi": Column("1", "Psi that is reached or not"),
    "outcome": Column("", "at rest at the end, or at any moment"),
    "lives": Column("1", "number of lives"),
    **bounds("p", "probability with all events"),
    "lives_largest": Column("1", "number of lives with the largest event alone"),
    **bounds("p_largest", "probability with the largest event alone"),
    "median_mm_s": Column("mm/s", "median PGV of the wall's fragility in a single event"),
    "dispersion": Column("1", "its logarithmic standard deviation"),
    "undetermined": Column("", "why the lives determine no curve, empty where they do"),
    "p_by_each_event": Column("1", "probability by this curve if every event draws anew"),
    "p_by_largest": Column("1", "probability by this curve if only the largest event counts"),
}
"""Columns of readings.csv."""


def beside(parts):
    """[(Lives, other Lives of the same wall and place by other choices, states of both as
    DataFrames of `Lives.until` with equal rows)] where the name of the other point is that of the
    first and one word more."""
    found = []
    for one, other in product(parts, repeat=2):
        if (
            other.point.rpartition("_")[0] == one.point
            and one.draws.exposure.place == other.draws.exposure.place
        ):
            first, second = one.last, other.last
            both = first.index.intersection(second.index)
            found += [(one, other, first.loc[both], second.loc[both])] if len(both) > 1 else []
    return found


def largest_alone(parts):
    """{point: (lives with all events, the same with the largest alone)} of the points that have
    both, as DataFrames of `Lives.until` with equal rows."""
    return {
        one.point: (first, second)
        for one, other, first, second in beside(parts)
        if other.draws.choices
        == replace(one.draws.choices, largest_alone=True)
        != one.draws.choices
    }


def choices(parts):
    """How outcomes of the same lives differ by other choices: a list of rows of CHOICES."""
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
    READINGS.

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
