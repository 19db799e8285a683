"""Sensitivity of the paper's claims to modelling choices that its text leaves open, one at a time.

A reading is the model as it is by default but for one choice; `studies/readings.toml` runs them, on
the symmetric wall whole, on the others what the claims about them need.  Criteria are those of the
verdict.
"""

from collections.abc import Callable
from dataclasses import dataclass, field

from damage.errors import InputError
from damage.measure.damage_index import CRITERIA
from paper.evidence import ANY_STEP, SOFTENS, Evidence, comparable, exactly, gather, load_runs
from paper.report import as_table
from paper.verdict import DIFFERS, HOLDS, UNJUDGED, judge_with, shipped_records

SOLVER = "reference"
LETTERS = {"displacement": "d", "accumulated": "a", "shear-limit": "s"}
"""What a cell has for a criterion of slip by which the claim holds."""
OTHER_PERIOD = 0.01
"""Share within which the period of an intact wall is the one that a reading asks for."""


@dataclass(frozen=True)
class Reading:
    """words: what is chosen; lintel; cycles of the harmonic motions; changes: {column: function of
    it that says which runs have the choice} over `paper.evidence.USUAL`."""

    words: str
    lintel: str = "elastic"
    cycles: int = 3
    changes: dict[str, Callable] = field(default_factory=dict, hash=False)


def _symmetric_of(period_s):
    return exactly(wall="symmetric") | {
        "eigen_period_s": lambda found_s: (found_s / period_s - 1).abs() <= OTHER_PERIOD
    }


READINGS = (
    Reading("by default"),
    Reading("lintel of 2 courses", lintel="2"),
    Reading("lintel of 1 course", lintel="1"),
    Reading("no lintel", lintel="none"),
    Reading("contacts at the joints' ends", changes=exactly(contacts="corners")),
    Reading("0.3 MPa in the piers", changes=exactly(load="piers")),
    Reading("mass spread over the top", changes=exactly(top="uniform")),
    Reading("2 cycles", cycles=2),
    Reading("5 cycles", cycles=5),
    Reading("10 cycles", cycles=10),
    Reading(
        "2 % damping",
        changes={"alpha_1_s": lambda alpha: alpha > 0, "beta_s": lambda beta: beta > 0},
    ),
    Reading("softening joints", changes={SOFTENS: lambda energy: energy > 0} | ANY_STEP),
    Reading("T0 0.175 s", changes=_symmetric_of(0.175) | ANY_STEP),
)
"""The default first; the choices of `docs/paper/open-points.md` that move DI most, and what real
walls have."""


def judge_readings(folder):
    """{Reading: Findings on all claims} from the tables below a folder, of the readings that have
    runs.

    InputError where there is no table, or no run of the reference solver.
    """
    runs = load_runs(folder)
    records = shipped_records()
    runs = runs[runs["solver"] == SOLVER]
    found = {}
    for reading in READINGS:
        mine = comparable(runs, reading.changes)
        points = gather(mine)
        harmonic = [
            key for key in points if key[:2] == ("symmetric", reading.lintel) and len(key) == 4
        ]
        if all(cycles != reading.cycles for *_, cycles in harmonic):
            continue
        found[reading] = judge_with(
            SOLVER,
            [
                Evidence(
                    runs=mine,
                    points=points,
                    lintel=reading.lintel,
                    slip=slip,
                    records=records,
                    usual_cycles=reading.cycles,
                )
                for slip in CRITERIA
            ],
        )
    if not found:
        raise InputError(
            f"{folder}: its tables hold no reading of the reference solver; expected the results of"
            " ./run_all.sh readings"
        )
    return found


def table(found):
    """Lines of a Markdown table: a row a claim that a reading judges, a column a reading; below it
    how many hold."""
    claims = dict.fromkeys(claim for findings in found.values() for claim in judged(findings))
    rows = [
        [
            f"{claim.id}, {claim.text}",
            *(
                _cell([one for one in findings if one.claim == claim])
                for findings in found.values()
            ),
        ]
        for claim in claims
    ]
    for words, counted in (
        *((f"hold, slip by {slip}", [slip]) for slip in CRITERIA),
        ("hold by any", CRITERIA),
    ):
        rows.append(
            [f"**{words}**", *(len(holding(findings, counted)) for findings in found.values())]
        )
    rows.append(["**of so many judged**", *(len(judged(findings)) for findings in found.values())])
    return as_table(["claim", *(reading.words for reading in found)], rows)


def judged(findings):
    """The predicted claims that could be judged, in their order."""
    return list(
        dict.fromkeys(
            one.claim for one in findings if one.claim.predicted and one.verdict != UNJUDGED
        )
    )


def holding(findings, slips=CRITERIA):
    """The predicted claims that hold by one of these criteria of slip, in their order."""
    return list(
        dict.fromkeys(
            one.claim
            for one in findings
            if one.claim.predicted and one.verdict == HOLDS and one.slip in slips
        )
    )


def _cell(findings):
    """Letters of the criteria by which a claim holds.

    >>> from types import SimpleNamespace as One
    >>> _cell([One(slip="displacement", verdict=HOLDS), One(slip="shear-limit", verdict=DIFFERS)])
    'd'
    """
    held = "".join(LETTERS[one.slip] for one in findings if one.verdict == HOLDS)
    return held or ("–" if any(one.verdict == DIFFERS for one in findings) else "?")


def conclusions(found):
    """Lines that say which reading meets most, and what none does."""
    held = {reading.words: holding(findings) for reading, findings in found.items()}
    most = max(map(len, held.values()))
    met = {claim for claims in held.values() for claim in claims}
    predicted = [one for findings in found.values() for one in findings if one.claim.predicted]
    differing = dict.fromkeys(one.claim for one in predicted if one.verdict == DIFFERS)
    left = dict.fromkeys(
        one.claim.id for one in predicted if one.claim not in met and one.claim not in differing
    )
    best = [words for words, claims in held.items() if len(claims) == most]
    lines = [
        f"Most claims, {most}, hold in: {', '.join(best)}.",
        (
            "No reading meets, by any criterion of slip:"
            f" {_ids(claim for claim in differing if claim not in met)}."
        ),
        *([f"Not judged, for want of runs: {', '.join(left)}."] if left else []),
    ]
    (_, by_default), *others = held.items()
    for (words, claims), findings in zip(others, list(found.values())[1:]):
        differs = {one.claim for one in findings if one.verdict == DIFFERS}
        gained = [claim for claim in claims if claim not in by_default]
        lost = [claim for claim in by_default if claim in differs and claim not in claims]
        lines.append(f"{words}: gains {_ids(gained)}; loses {_ids(lost)}.")
    return lines


def _ids(claims):
    return ", ".join(claim.id for claim in claims) or "nothing"
