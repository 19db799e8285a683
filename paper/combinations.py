"""Modelling choices that the paper leaves open, combined: which combinations meet most claims,
which choices matter.

`studies/combinations.toml` runs a two-level factorial design; a claim is met by a combination where
it holds by any criterion of slip.  In a balanced design whose columns are orthogonal, effects
follow from means alone (Box, Hunter and Hunter 2005, Statistics for Experimenters, chapters 5 and
6).
"""

from dataclasses import dataclass
from itertools import combinations, product

import numpy as np

from damage.errors import InputError
from damage.measure.damage_index import CRITERIA
from paper.evidence import Evidence, comparable, exactly, gather, load_runs
from paper.readings import SOLVER, holding, judged
from paper.report import as_table
from paper.verdict import HOLDS, judge_with, shipped_records

LIGHT = "_mass85"
"""Ending of the names of the walls with 0.85 of the mass on top (`walls/variants`)."""
CHOICES = {
    "contacts": ("contact points", {"interior": "inside", "corners": "ends"}),
    "load": ("0.3 MPa over", {"length": "length", "piers": "piers"}),
    "top": ("mass on", {"piers": "piers", "uniform": "whole top"}),
    "lintel": ("lintel", {"elastic": "all courses", "2": "2 courses"}),
    "mass": ("mass", {"": "1", LIGHT: "0.85"}),
    "cycles": ("cycles", {3: "3", 2: "2"}),
}
"""{choice: (words, {level: words})}; the default level is the first."""
BEST = 8
"""Combinations that are listed, at least; those that meet as many claims as the last come in
addition."""
DEPENDS = 0.25
"""Difference between the shares of combinations that meet a claim from which the claim depends on
the choice."""


@dataclass(frozen=True)
class Combination:
    """levels: of each of CHOICES; period_s: of the intact symmetric wall; runs: their names, those
    with the other number of cycles included; own_runs: number of those of walls with openings and
    this number of cycles; findings: of `judge_with`."""

    levels: tuple
    period_s: float
    runs: frozenset
    own_runs: int
    findings: list

    def met(self, slips=CRITERIA):
        """The predicted claims that hold by any of these criteria of slip."""
        return holding(self.findings, slips)

    def holds(self, claim_id):
        """Whether a claim holds by any criterion of slip."""
        return any(one.claim.id == claim_id and one.verdict == HOLDS for one in self.findings)

    @property
    def words(self):
        """Words of the levels, a list."""
        return [known[level] for (_, known), level in zip(CHOICES.values(), self.levels)]


def judge_combinations(folder):
    """The Combinations from the tables below a folder, those with fewer runs than others left out.

    Raises InputError where there is none.
    """
    runs = load_runs(folder)
    records = shipped_records()
    found = []
    runs = runs[runs["solver"] == SOLVER]
    *of_walls, of_cycles = (known for _, known in CHOICES.values())
    for levels in product(*of_walls):
        mine = _runs_of(runs, *levels)
        if not (mine["wall"] == "symmetric").any():  # a solid wall alone is no combination
            continue
        points = gather(mine)
        lintel = levels[list(CHOICES).index("lintel")]
        for cycles in of_cycles:
            if ("symmetric", lintel, 0.2, cycles) in points:
                findings = judge_with(
                    SOLVER,
                    [
                        Evidence(
                            runs=mine,
                            points=points,
                            lintel=lintel,
                            slip=slip,
                            records=records,
                            usual_cycles=cycles,
                        )
                        for slip in CRITERIA
                    ],
                )
                period_s = float(mine.loc[mine["wall"] == "symmetric", "eigen_period_s"].median())
                own = (mine["wall"] != "solid") & (
                    mine["cycles"].isna() | (mine["cycles"] == cycles)
                )
                found.append(
                    Combination(
                        (*levels, cycles), period_s, frozenset(mine["run"]), own.sum(), findings
                    )
                )
    if not found:
        raise InputError(
            f"{folder}: its tables hold no combination of choices; expected the results of "
            "./run_all.sh combinations"
        )
    most = max(one.own_runs for one in found)
    return [one for one in found if one.own_runs == most]


def _runs_of(runs, contacts, load, top, lintel, mass):
    """The runs of one set of walls, renamed as the paper's; a solid wall has neither piers nor a
    lintel."""
    walls = {f"{name}{mass}": name for name in ("symmetric", "asymmetric", "solid")}
    mine = runs[runs["wall"].isin(walls)]
    mine = mine[
        (mine["wall"] == f"solid{mass}") | ((mine["load"] == load) & (mine["lintel"] == lintel))
    ]
    changes = exactly(contacts=contacts, top=top) | {"load": lambda column: column.notna()}
    return comparable(mine, changes).replace({"wall": walls})


def judged_by_some(found):
    """The predicted claims that a combination could be judged on; one that cannot be judged on them
    counts as if it did not meet them, such as a wall without the free cycle that a claim is
    about."""
    return list(dict.fromkeys(claim for one in found for claim in judged(one.findings)))


def signs(found):
    """-1 for the default level of each choice and +1 for the other, (n_combinations, n_choices)."""
    return np.array(
        [
            [
                2 * list(known).index(level) - 1
                for (_, known), level in zip(CHOICES.values(), one.levels)
            ]
            for one in found
        ]
    )


def effects(met, levels):
    """Differences of the share met between the two levels of each choice, (n_choices,), nan of one
    with one level only; the share of the variance that these explain, and with the interactions of
    two choices, nan where these are mixed.

    met: bool (n,); levels: -1 or +1, (n, n_choices), balanced and orthogonal.

    >>> levels = np.array([[-1, -1], [-1, 1], [1, -1], [1, 1]])
    >>> effects(np.array([False, False, True, True]), levels)
    (array([1., 0.]), 1.0, 1.0)
    """
    met = np.asarray(met, float)
    alone = np.where(np.ptp(levels, axis=0) > 0, np.mean(met[:, None] * levels, axis=0), np.nan)
    varied = levels[:, ~np.isnan(alone)]
    two = [
        np.mean(met * varied[:, i] * varied[:, j])
        for i, j in combinations(range(varied.shape[1]), 2)
    ]
    variance = met.var() or np.inf
    explained = float(np.nansum(alone**2) / variance)
    pairs = (
        float(np.sum(np.square(two)) / variance)
        if is_orthogonal(levels, with_pairs=True)
        else np.nan
    )
    return 2 * alone, explained, explained + pairs


def is_orthogonal(levels, with_pairs=False):
    """Whether means separate the main effects, with pairs also the interactions of two choices:
    columns that are balanced and orthogonal.  A choice that has one level only is left out."""
    varied = levels[:, np.ptp(levels, axis=0) > 0]
    pairs = [
        varied[:, i] * varied[:, j]
        for i, j in combinations(range(varied.shape[1]), 2)
        if with_pairs
    ]
    columns = np.column_stack([np.ones(len(levels)), varied, *pairs])
    return np.array_equal(columns.T @ columns, len(levels) * np.eye(columns.shape[1]))


def table_of_effects(found):
    """Lines of a Markdown table: a row a claim that some combinations meet and others do not."""
    levels = signs(found)
    rows = []
    if not is_orthogonal(levels):
        return ["The design is incomplete: effects cannot be separated."]
    for claim in judged_by_some(found):
        met = np.array([one.holds(claim.id) for one in found])
        if met.all() or not met.any():
            continue
        by, alone, pairs = effects(met, levels)
        rows.append(
            [
                f"{claim.id}, {claim.text}",
                f"{met.mean():.0%}",
                *map(_difference, by),
                f"{alone:.0%}",
                _or_dash(f"{pairs:.0%}"),
            ]
        )
    heads = [f"{words}: {list(known.values())[1]}" for words, known in CHOICES.values()]
    total = effects_on_count(found, levels)
    rows.append(
        ["**claims met, on average**", "", *(_or_dash(f"**{one:+.1f}**") for one in total), "", ""]
    )
    return as_table(["claim", "met by", *heads, "main effects", "and of two"], rows)


def effects_on_count(found, levels):
    """Difference of the mean number of claims met between the two levels of each choice,
    (n_choices,)."""
    return effects([len(one.met()) for one in found], levels)[0]


def _difference(share):
    """
    >>> _difference(0.5), _difference(-0.125), _difference(0.0)
    ('**+50**', '-12', '0')
    """
    text = _or_dash(f"{100 * share:+.0f}" if share else "0")
    return f"**{text}**" if abs(share) >= DEPENDS else text


def _or_dash(number):
    """A dash for text that says nan."""
    return "–" if "nan" in number else number


def best(found):
    """The combinations that meet most claims, by any criterion of slip, then by one: BEST and those
    as good."""
    ranked = sorted(
        found, key=lambda one: (-len(one.met()), -max(len(one.met([slip])) for slip in CRITERIA))
    )
    least = len(ranked[min(BEST, len(ranked)) - 1].met())
    return [one for one in ranked if len(one.met()) >= least]


def table_of_best(found):
    """Lines of a Markdown table of the best combinations, and of the default below them."""
    heads = [*(words for words, _ in CHOICES.values()), "T0 [s]", "P2a", *CRITERIA, "any"]
    default = [
        one
        for one in found
        if one.levels == tuple(next(iter(known)) for _, known in CHOICES.values())
    ]
    chosen = {
        one.levels: one for one in (*best(found), *_most(of_the_papers_period(found)), *default)
    }
    return as_table(heads, map(_row, chosen.values()))


def of_the_papers_period(found):
    """The combinations in which the symmetric wall has the paper's period, which meet P2a."""
    return [one for one in found if one.holds("P2a")]


def _most(found):
    """Those that meet most claims."""
    most = max((len(one.met()) for one in found), default=0)
    return [one for one in found if len(one.met()) == most]


def _row(one):
    counts = [str(len(one.met([slip]))) for slip in CRITERIA]
    return [
        *one.words,
        f"{one.period_s:.3f}",
        "holds" if one.holds("P2a") else "differs",
        *counts,
        f"**{len(one.met())}**",
    ]


def conclusions(found):
    """Lines that say which combination meets most claims, what each choice changes and what none
    meets."""
    claims = judged_by_some(found)
    levels = signs(found)
    alike = of_the_papers_period(found)
    never = [claim.id for claim in claims if not any(one.holds(claim.id) for one in found)]
    always = [claim.id for claim in claims if all(one.holds(claim.id) for one in found)]
    count = [len(one.met()) for one in found]
    runs = len(frozenset.union(*(one.runs for one in found)))
    lines = [
        (
            f"{len(found)} combinations, {runs} runs: {min(count)} to {max(count)} of {len(claims)}"
            " claims are met by any criterion of slip, by one criterion at most"
            f" {max(len(one.met([slip])) for one in found for slip in CRITERIA)}."
        ),
        f"Most, {max(count)}, are met with {_or(_most(found))}.",
    ]
    if alike:
        lines.append(
            f"Of the {len(alike)} with the paper's period of 0.2 s (P2a), most,"
            f" {len(_most(alike)[0].met())}, are met with {_or(_most(alike))}."
        )
    if is_orthogonal(levels):
        moved = sorted(
            (
                (change, words)
                for change, words in zip(effects_on_count(found, levels), CHOICES.values())
                if not np.isnan(change)
            ),
            key=lambda one: -abs(one[0]),
        )
        lines.append(
            "On average a choice changes the number of claims met by: "
            + ", ".join(
                f"{change:+.1f} ({words} {list(known.values())[1]})"
                for change, (words, known) in moved
            )
            + "."
        )
    same = [words for (words, _), column in zip(CHOICES.values(), levels.T) if np.ptp(column) == 0]
    if same:
        lines.append(f"Not varied in these runs: {', '.join(same)}.")
    if not is_orthogonal(levels, with_pairs=True):
        lines.append(
            "By these runs alone interactions of two choices cannot be separated, and are left out."
        )
    if some := [
        claim.id for claim in claims if not all(claim in judged(one.findings) for one in found)
    ]:
        lines.append(
            "Without the values that a claim needs, and counted as not met: some with"
            f" {', '.join(some)}."
        )
    unjudged = {
        one.claim.id: None
        for each in found
        for one in each.findings
        if one.claim.predicted and one.claim not in claims
    }
    if unjudged:
        lines.append(f"Not judged, for want of runs: {', '.join(unjudged)}.")
    return [
        *lines,
        f"No combination meets {', '.join(never) or 'nothing'}.",
        f"Every combination meets {', '.join(always) or 'nothing'}.",
    ]


def _or(found):
    return "; or ".join(in_words(one) for one in found)


def in_words(one):
    """Where a combination differs from the default."""
    other = [
        f"{words} {known[level]}"
        for (words, known), level in zip(CHOICES.values(), one.levels)
        if level != next(iter(known))
    ]
    return ", ".join(other) or "the default"
