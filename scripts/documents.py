"""Holds the generated parts of documents against the tables and the code that they come from.

    python3 scripts/documents.py [ROOT]     # ROOT: a folder with README.md and docs/, by default the repository

Prints a line for each part that is not current; the exit status is 1 if there is one.
"""

import re
import sys
import tempfile
from itertools import chain, combinations, product
from pathlib import Path

import pandas as pd

from damage.measure.columns import CRITERIA, read_table
from damage.paper import report
from damage.paper.criteria import CLAIMS
from damage.paper.verdict import Finding, judge

SOLVERS = {words: solver for solver, words in report.SOLVER_NAMES.items()}
RENEW = "renew it: python3 -m damage paper RESULTS_DIR --markdown docs/paper-verdict.md --readme README.md"


def verdict_is_whole(root):
    """The verdict's document is what its own claims' values, with today's code and criteria, make of it."""
    if report.as_markdown(_read_verdict(root)) != _text(root / "docs/paper-verdict.md"):
        yield f"docs/paper-verdict.md: not as the code writes it; {RENEW}"


def verdict_follows_from_the_tables(root):
    """Values and verdicts are those of docs/tables, but for what these lack: cycles of single runs, their number."""
    told = {_key(finding): (_without_counts(finding.value), finding.verdict) for finding in _read_verdict(root)}
    for finding in _judge_tables(root / "docs/tables"):
        made = (_without_counts(finding.value), finding.verdict)
        if not finding.value.startswith("no table of cycles") and told.get(_key(finding)) != made:
            where = " ".join(_key(finding))
            yield f"docs/paper-verdict.md, {where}: {told.get(_key(finding))}, but docs/tables say {made}; {RENEW}"


def readme_quotes_the_verdict(root):
    """What stands between the README's markers stands in the document, too."""
    _, begin, rest = _text(root / "README.md").partition(report.BEGIN)
    block, end, _ = rest.partition(report.END)
    known = _text(root / "docs/paper-verdict.md").splitlines()
    if not (begin and end and block.strip()):
        yield f"README.md: no verdict between its two markers; {RENEW}"
    for line in block.splitlines():
        if line not in known:
            yield f"README.md: {line[:60]!r} is not in docs/paper-verdict.md; {RENEW}"


CHECKS = [verdict_is_whole, verdict_follows_from_the_tables, readme_quotes_the_verdict]
"""Functions of ROOT that yield a line for each part that is not current: add those of further parts."""


def _text(path):
    return path.read_text(encoding="utf-8")


def _key(finding):
    return finding.claim.id, finding.solver, finding.lintel, finding.slip


def _without_counts(value):
    return re.sub(r"\d+ runs$", "runs", value)


def _read_verdict(root):
    """The findings that docs/paper-verdict.md shows, in its order."""
    claims, lines = {claim.id: claim for claim in CLAIMS}, _text(root / "docs/paper-verdict.md").splitlines()
    lintels, findings, claim = _lintels_of_solvers(lines), [], None
    of_words = {solver: _pairs_of_words(mine) for solver, mine in lintels.items()}
    old = {solver: f"- {report.before_offsets(solver)}" in lines for solver in lintels}
    for line in lines:
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        if head := re.match(r"\*\*(\w+)\*\*", line):
            claim = claims.get(head[1])
        elif claim and len(cells) == 4 and cells[1] in of_words.get(SOLVERS.get(cells[0]), ()):
            solver, (verdict, edge, _) = SOLVERS[cells[0]], cells[3].partition(report.ON_EDGE)
            findings += [Finding(claim, solver, *variant, cells[2], verdict, 0.0 if edge else None, old[solver])
                         for variant in of_words[solver][cells[1]]]  # how near the edge is not told
    return sorted(findings, key=lambda one: (
        CLAIMS.index(one.claim), list(SOLVERS.values()).index(one.solver), lintels[one.solver].index(one.lintel),
        list(CRITERIA).index(one.slip)))


def _lintels_of_solvers(lines):
    """{solver: its lintels} of the verdict's document, by the columns of its overview."""
    head = next((line for line in lines if line.startswith("| | the paper |")), "")
    told = [cell.strip().split(", ") for cell in head.strip("|").split("|")[2:]]
    numbers = {lintel: lintel.split()[2] for _, lintel in told if lintel.startswith("lintel of")}
    lintels = {"elastic lintel": "elastic", "no lintel": "none"} | numbers
    found = {}
    for solver, lintel in told:
        found.setdefault(SOLVERS[solver], []).append(lintels[lintel])
    return found


def _pairs_of_words(lintels):
    """{words: pairs (lintel, slip criterion)} of all that a document may say of these lintels."""
    every = list(product(lintels, CRITERIA))
    return {report.variants_in_words(set(some), lintels): some
            for some in chain.from_iterable(combinations(every, n) for n in range(1, len(every) + 1))}


def _judge_tables(folder):
    """The verdict on the points of docs/tables: each as three runs, with its medians, minima and maxima."""
    with tempfile.TemporaryDirectory() as made:
        for path in sorted(folder.glob("*_points.csv")):
            place = Path(made) / path.stem / "tables"
            place.mkdir(parents=True)
            points = read_table(path)
            runs = [_member(points, ending) for ending in ("", "_min", "_max")]
            pd.concat(runs, ignore_index=True).to_csv(place / "summary.csv", index=False)
        return judge(Path(made))


def _member(points, ending):
    ranged = points[points["members"] > 1] if ending else points
    values = {name.removesuffix(ending): ranged[name] for name in ranged if ending and name.endswith(ending)}
    return ranged.assign(run=ranged["point"], **values)


def main(arguments):
    """Run all checks on ROOT; returns 1 if a part is not current."""
    root = Path(arguments[0]) if arguments else Path(__file__).resolve().parents[1]
    told = [line for check in CHECKS for line in check(root)]
    print(*told, sep="\n", end="\n" if told else "")
    return 1 if told else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
