"""Compares the generated parts of documents with the tables and the code that they come from, or
renews them.

    python3 scripts/documents.py [--renew] [ROOT]  # ROOT: a folder with README.md and docs/, by
                                                   # default the repository

Prints a line for each part that is not current; the exit status is 1 if there is one, 2 where there
are no tables.
"""

import re
import sys
import tempfile
from difflib import unified_diff
from functools import cache
from pathlib import Path

import pandas as pd

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from damage.applications.studies.definition import load_study
from damage.applications.studies.read import read_table
from damage.errors import InputError
from damage.fields import short
from damage.files import write_text
from damage.house.plausible import RANGES as WALL_RANGES
from damage.measure.columns import MADE_BY, RUN
from damage.measure.evidence import QUANTITIES
from damage.measure.summary import MEASURES
from damage.motion.formats import FORMATS, READ
from damage.motion.plausible import RANGES as MOTION_RANGES
from paper import report
from paper.verdict import judge
from scripts import gallery
from scripts.document_tables import as_markdown, with_tables

VERDICT = "docs/paper/verdict.md"
CLAIMS = "docs/tables/verdict.csv"
RENEW = "renew it: python3 scripts/documents.py --renew"
BLOCK = re.compile(r"(<!-- table of (.+?) -->\n).*?(<!-- end of table -->)", re.DOTALL)
"""A table in a document that the code makes: see `tables_of_code`."""


def verdict_follows_from_the_tables(root):
    """Compare the verdict's document and table of claims with the verdict of the code on
    docs/tables."""
    for name, made in _verdict_of(root).items():
        yield from _differences(name, _text(root / name), made)


def _verdict_of(root):
    """{file: its text} of the verdict's document and its table of claims."""
    findings = judge_tables(root / "docs/tables")
    return {
        VERDICT: report.as_markdown(findings),
        CLAIMS: report.claims_table(findings).to_csv(index=False),
    }


def _differences(name, text, made):
    """A line for each line in which a document's text differs from what is made of the tables."""
    for line in unified_diff(text.splitlines(), made.splitlines(), lineterm="", n=0):
        if line[:1] in "+-" and line[:3] not in ("+++", "---"):
            side = "docs/tables say" if line.startswith("+") else "it says"
            yield f"{name}: {side} {line[1:100]!r}; {RENEW}"


def tables_show_the_files(root):
    """The tables of all documents show what the files in docs/tables hold, and what the code
    defines."""
    for path in documents_below(root):
        text = _text(path)
        yield from _differences(path.relative_to(root), text, _renewed(text, root))


def _renewed(text, root):
    return with_tables_of_code(with_tables(text, root / "docs/tables"))


def with_tables_of_code(text):
    """A document's text with its tables of columns, datasets, studies, plausible values and
    validity as the code has them.

    Raises InputError where a block names what is none of them.
    """
    known = tables_of_code()

    def made(block):
        if block[2] not in known:
            raise InputError(f"a table of {block[2]!r}: expected one of {', '.join(known)}")
        return f"{block[1]}\n{known[block[2]]}\n\n{block[3]}"

    return BLOCK.sub(made, text)


def tables_of_code():
    """{name: table in Markdown} of what the code defines and documents show."""
    summary = {"run": RUN, "made by": MADE_BY, **MEASURES}
    return {
        **{f"summary.csv: {name}": columns_table(columns) for name, columns in summary.items()},
        "plausible values": ranges_table("field", WALL_RANGES),
        "plausible motions": ranges_table("option", MOTION_RANGES),
        "the range of validity": validity_table(),
        "record formats that are read": as_markdown(
            ["read", "how"], ((one.name, one.help) for one in READ)
        ),
        "record formats that are not read": as_markdown(
            ["not read", "convert"], ((one.name, one.help) for one in FORMATS if not one.read)
        ),
        "studies that ship": table_of_studies(ROOT / "studies"),
        "gallery": gallery.markdown(),
    }


def columns_table(columns):
    """A row for each of {name: Column}; names that share a row are separated by commas."""
    rows = (
        (f"`{name.replace(', ', '`, `')}`", column.unit, column.meaning)
        for name, column in columns.items()
    )
    return as_markdown(["name", "unit", "meaning"], rows)


def ranges_table(what, ranges):
    """A row for each of {name: Range}; what: the heading of the names."""
    rows = (
        (
            f"`{name}`",
            short(one.least),
            short(one.most),
            one.unit,
            "yes" * one.zero,
            one.why,
        )
        for name, one in ranges.items()
    )
    return as_markdown([what, "from", "to", "unit", "or 0", "near the limits"], rows)


def validity_table():
    """The range of validity, a row a quantity."""
    rows = (
        (one.name, one.supported.format(range=one.range), one.evidence, one.beyond)
        for one in QUANTITIES
    )
    return as_markdown(["quantity", "supported by evidence", "evidence", "beyond it"], rows)


@cache
def table_of_studies(folder):
    """Table in Markdown of the studies in a folder: title, points and largest number of runs of
    each solver."""
    rows = []
    for path in sorted(folder.glob("*.toml")):
        study = load_study(path, "both", root=ROOT)
        runs = {
            solver: sum(run.most_members for run in study.runs if run.solver == solver)
            for solver in ("reference", "yade")
        }
        rows.append(
            [
                f"`{path.stem}`",
                study.title,
                str(len({run.point for run in study.runs})),
                *map(str, runs.values()),
            ]
        )
    return as_markdown(
        ["study", "content", "points", "runs at most, reference solver", "YADE"], rows
    )


def documents_below(root):
    """The Markdown files that may have tables: README.md and those below docs."""
    return [root / "README.md", *sorted((root / "docs").rglob("*.md"))]


CHECKS = [verdict_follows_from_the_tables, tables_show_the_files]
"""Functions of ROOT that yield a line for each part that is not current: add those of further
parts."""


def _text(path):
    return path.read_text(encoding="utf-8")


@cache  # the tables are as they are as long as this program runs
def judge_tables(folder):
    """The verdict on the tables that `scripts/keep_tables.py` keeps in a folder: findings.

    Raises InputError where there are none.
    """
    tables = sorted(folder.glob("*_points.csv"))
    if not tables:
        raise InputError(
            f"{folder}: no STUDY_points.csv in it; expected the tables of studies, as "
            "scripts/keep_tables.py keeps them"
        )
    with tempfile.TemporaryDirectory() as made:
        for path in tables:
            place = Path(made) / path.stem / "tables"
            place.mkdir(parents=True)
            _as_runs(read_table(path)).to_csv(place / "summary.csv", index=False)
            cycles = path.with_name(path.name.replace("_points", "_cycles"))
            if cycles.is_file():
                _cycles_as_runs(read_table(cycles)).to_csv(place / "cycles.csv", index=False)
        return judge(Path(made))


def _as_runs(points):
    """A table of runs that has the medians, ranges and numbers of runs of a table of points."""
    low, high = (
        _with_values_of(points[points["members"] > 1], ending) for ending in ("_min", "_max")
    )
    between = points.loc[points.index.repeat((points["members"] - 2).clip(lower=0))]
    runs = pd.concat([points[points["members"] == 1], low, between, high], ignore_index=True)
    return runs.assign(run=runs["point"] + "_" + runs["solver"])


def _with_values_of(points, ending):
    return points.assign(
        **{name.removesuffix(ending): points[name] for name in points if name.endswith(ending)}
    )


def _cycles_as_runs(cycles):
    return cycles.assign(run=cycles["point"] + "_" + cycles["solver"])


def renew(root):
    """Writes the verdict's document and claims, and the tables of all documents."""
    for name, made in _verdict_of(root).items():
        write_text(root / name, made)
    for path in documents_below(root):
        text = _text(path)
        renewed = _renewed(text, root)
        if renewed != text:
            write_text(path, renewed)


def main(arguments):
    """Run all checks on ROOT; returns 1 if a part is not current, 2 where there are no tables."""
    wanted, *root = arguments if "--renew" in arguments[:1] else ["", *arguments]
    root = Path(root[0]) if root else ROOT
    try:
        if wanted:
            renew(root)
        stale = [line for check in CHECKS for line in check(root)]
    except InputError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    print(*stale, sep="\n", end="\n" if stale else "")
    return 1 if stale else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
