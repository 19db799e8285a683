"""The verdict on the paper as text, JSON, Markdown and CSV."""

from dataclasses import asdict
from itertools import groupby
from operator import attrgetter

import pandas as pd

from paper.criteria import BUILT_TO_MEET, STATEMENTS, page
from paper.margins import EDGE
from paper.verdict import DIFFERS, HOLDS, IN_PART, UNJUDGED, statement_verdict

SOLVER_NAMES = {"yade": "YADE", "reference": "reference solver"}
_SLIPS = {
    "displacement": "slip by displacement",
    "accumulated": "slip accumulated",
    "shear-limit": "slip by shear limit",
}
_FALLS = "none", "1"
"""Lintels without which spandrels fall: what next to nothing holds with has no column."""
ON_EDGE = ", borderline"
"""Suffix of a verdict that a small change of its limit would change."""


def _by(findings, name):
    """(value of an attribute, findings) in the order of the findings, of which equal values stand
    together."""
    return [(value, list(members)) for value, members in groupby(findings, attrgetter(name))]


def merged(findings):
    """(source, variants in words, value, verdict) of one claim, variants with the same outcome
    together; source: solver and model in words."""
    lines = []
    for source, members in _by(findings, "source"):
        outcomes = {}
        lintels = _distinct(members, "lintel")
        for finding in members:
            outcome = finding.value, finding.verdict + ON_EDGE * finding.on_edge
            outcomes.setdefault(outcome, set()).add((finding.lintel, finding.slip))
        lines += [
            (source_in_words(*source), variants_in_words(pairs, lintels), *outcome)
            for outcome, pairs in outcomes.items()
        ]
    return lines


def source_in_words(solver, model):
    """
    >>> source_in_words("yade", ""), source_in_words("reference", "deformable bricks")
    ('YADE', 'reference solver, deformable bricks')
    """
    return ", ".join(filter(None, (SOLVER_NAMES[solver], model)))


def lintel_in_words(lintel):
    """
    >>> lintel_in_words("elastic"), lintel_in_words("2"), lintel_in_words("none")
    ('elastic lintel', 'lintel of 2 courses', 'no lintel')
    """
    return {"elastic": "elastic lintel", "none": "no lintel", "1": "lintel of 1 course"}.get(
        lintel, f"lintel of {lintel} courses"
    )


def variants_in_words(pairs, lintels):
    """Words for a set of (lintel, slip criterion) of those that these lintels, a list, have in all.

    >>> both = ["elastic", "none"]
    >>> variants_in_words({("elastic", slip) for slip in _SLIPS}, both)
    'elastic lintel'
    >>> variants_in_words({("elastic", "displacement"), ("none", "displacement")}, both)
    'slip by displacement'
    """
    of = {lintel: [slip for slip in _SLIPS if (lintel, slip) in pairs] for lintel in lintels}
    said = {
        lintel: "" if len(slips) == len(_SLIPS) else " and ".join(_SLIPS[slip] for slip in slips)
        for lintel, slips in of.items()
        if slips
    }
    if len(said) == len(lintels) and len(set(said.values())) == 1:
        return said[lintels[0]] or "all variants"
    return "; ".join(
        ", ".join(filter(None, (lintel_in_words(lintel), words))) for lintel, words in said.items()
    )


# --- on the screen --------------------------------------------------------------------------------


def describe(findings):
    """The whole verdict as lines for people."""
    lines = []
    for claim, members in _by(findings, "claim"):
        lines.append(f"{claim.id:5s}{claim.text} ({claim.figure})")
        lines.append(f"     paper: {claim.paper}; holds if {claim.criterion}")
        lines += [
            f"     {verdict:22s}{source}, {variants}: {value}"
            for source, variants, value, verdict in merged(members)
        ]
    return "\n".join([*lines, "", *tallies(findings)])


def tallies(findings):
    """How many claims hold, lines of a Markdown table with a row a solver and lintel.

    By each criterion of slip alone, and by any of them; what the model was built to meet is counted
    apart.
    """
    head = [
        "predictions that hold",
        *_SLIPS.values(),
        "by any of these",
        "differ by all",
        "cannot be judged",
        "built to meet",
        "borderline",
    ]
    rows = []
    for source, lintel in _distinct(findings, "source", "lintel"):
        mine = [
            finding for finding in findings if (finding.source, finding.lintel) == (source, lintel)
        ]
        predicted, built = (
            [one for one in mine if one.claim.predicted == which] for which in (True, False)
        )
        best = _best(predicted)
        edge = _distinct([one for one in mine if one.on_edge], "claim.id")
        rows.append(
            [
                f"{source_in_words(*source)}, {lintel_in_words(lintel)}",
                *(
                    sum(one.verdict == HOLDS for one in predicted if one.slip == slip)
                    for slip in _SLIPS
                ),
                f"{best.count(HOLDS)} of {len(best)}",
                best.count(DIFFERS),
                best.count(UNJUDGED),
                f"{_best(built).count(HOLDS)} of {len(_best(built))}",
                ", ".join(edge) or "none",
            ]
        )
    return as_table(head, rows)


def as_table(heads, rows):
    r"""Lines of a table in Markdown.

    >>> print(*as_table(["a", "b"], [[1, ""]]), sep="\n")
    | a | b |
    | --- | --- |
    | 1 | |
    """
    return [
        ("| " + " | ".join(map(str, cells)) + " |").replace("|  ", "| ")
        for cells in (heads, ["---"] * len(heads), *rows)
    ]


def _best(findings):
    """The best verdict on each claim by any criterion of slip, a list."""
    return [
        min((finding.verdict for finding in members), key=(HOLDS, DIFFERS, UNJUDGED).index)
        for _, members in _by(findings, "claim")
    ]


def _distinct(findings, *names):
    """The distinct values of these attributes of the findings, in their order."""
    return list(dict.fromkeys(map(attrgetter(*names), findings)))


# --- JSON -----------------------------------------------------------------------------------------


def as_json(findings):
    """The verdict as plain lists and dictionaries: claims with their findings, statements with
    their verdicts."""
    claims = [
        {
            "id": claim.id,
            "statement": claim.statement,
            "predicted": claim.predicted,
            **asdict(claim),
            "findings": [
                vars(finding) | {"claim": claim.id, "on_edge": finding.on_edge}
                for finding in members
            ],
        }
        for claim, members in _by(findings, "claim")
    ]
    statements = [
        {
            "statement": statement,
            "text": STATEMENTS[statement],
            "verdicts": [
                {
                    "solver": source[0],
                    "model": source[1],
                    "lintel": lintel,
                    "slip": slip,
                    "verdict": statement_verdict(_variant(members, source, lintel, slip)),
                }
                for source, lintel, slip in _distinct(findings, "source", "lintel", "slip")
            ],
        }
        for statement, members in _by(findings, "claim.statement")
    ]
    return {"statements": statements, "claims": claims}


def _variant(findings, source, lintel, slip):
    return [
        finding
        for finding in findings
        if (finding.source, finding.lintel, finding.slip) == (source, lintel, slip)
    ]


# --- Markdown -------------------------------------------------------------------------------------


def as_markdown(findings):
    """The verdict as a document: what holds by solver and lintel, then a row a statement."""
    return page(
        "verdict.md",
        overview=overview(findings),
        tallies=tallies(findings),
        edge=EDGE,
        built=", ".join(BUILT_TO_MEET),
    )


def claims_table(findings):
    """The verdict as a DataFrame: a row for each outcome of each claim, with the claim's
    criterion."""
    rows = []
    for claim, members in _by(findings, "claim"):
        of_claim = claim.id, claim.text, claim.figure, claim.paper, claim.criterion
        rows += [(*of_claim, *outcome) for outcome in merged(members)]
    return pd.DataFrame(
        rows,
        columns=[
            "claim",
            "text",
            "figure",
            "paper",
            "holds_if",
            "solver",
            "variants",
            "value",
            "verdict",
        ],
    )


def overview(findings):
    """Lines of the Markdown table with a row a statement: its name, its words, outcomes by solver
    and lintel."""
    variants = [one for one in _distinct(findings, "source", "lintel") if one[1] not in _FALLS]
    rows = [
        [
            statement,
            STATEMENTS[statement],
            *(
                _cell([_short(_variant(members, source, lintel, slip)) for slip in _SLIPS])
                for source, lintel in variants
            ),
        ]
        for statement, members in _by(findings, "claim.statement")
    ]
    heads = (
        f"{source_in_words(*source)}, {lintel_in_words(lintel)}" for source, lintel in variants
    )
    return as_table(["", "the paper", *heads], rows)


def _cell(outcomes):
    """One outcome where all are the same, or each in the order of the criteria.

    >>> _cell(["holds", "holds", "differs"]), _cell(["holds"] * 3)
    ('holds / holds / differs', 'holds')
    """
    return " / ".join(outcomes if len(set(outcomes)) > 1 else outcomes[:1])


def _short(findings):
    """The verdict on a statement in a few words."""
    verdict = statement_verdict(findings)
    if verdict != IN_PART:
        return verdict
    judged = [finding.verdict for finding in findings if finding.verdict != UNJUDGED]
    return f"{judged.count(HOLDS)} of {len(judged)}"
