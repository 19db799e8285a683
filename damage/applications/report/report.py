"""The file itself: `python3 -m damage report PATH... [--out FILE.html]`."""

import re
from dataclasses import dataclass
from functools import cache, partial
from pathlib import Path

from jinja2.utils import htmlsafe_json_dumps

from damage.applications.report.charts import RUN_STYLES, over_time, states_legend
from damage.applications.report.figures import documents, figures
from damage.applications.report.house_part import house_part
from damage.applications.report.run_part import run_part
from damage.applications.report.study_charts import BELOW, LEFT, TALL, WIDE
from damage.applications.report.study_part import studies_below, study_part
from damage.applications.report.tables import energy_balance, measures, parameters, versions
from damage.applications.report.words import PAGE, environment
from damage.applications.report.words import words as texts
from damage.errors import InputError
from damage.files import json_text, write_text
from damage.history.reader import read_history
from damage.index import THRESHOLD
from damage.measure.summary import summarise
from damage.provenance import commit
from damage.units import MILLIMETRE
from damage.version import VERSION


@cache
def plotly_code():
    """The code of plotly.js, text: its partial bundle `basic` as its makers publish it (MIT
    licence, beside it), `npm pack plotly.js-basic-dist-min@4.1.1`.  The whole library, which the
    Python package plotly ships, makes reports 2 MB larger and takes twice as long to draw."""
    return (PAGE / "plotly-basic.min.js").read_text(encoding="utf-8")


def plotly_version():
    """Version of plotly.js, from its code.

    >>> plotly_version()
    '4.1.1'
    """
    return re.search(r"plotly\.js \(basic - minified\) v([\d.]+)", plotly_code())[1]


MARKS = (
    "M-4,0a4,4 0 1,0 8,0a4,4 0 1,0 -8,0",
    "M-3.6,-3.6h7.2v7.2h-7.2z",
    "M0,-5L4.6,3.6H-4.6z",
    "M0,-5.2L4.6,0L0,5.2L-4.6,0z",
    "M0,5L4.6,-3.6H-4.6z",
    "M-5,-1.6h3.4v-3.4h3.2v3.4h3.4v3.2h-3.4v3.4h-3.2v-3.4h-3.4z",
)
"""Paths of the marks of walls in charts, beside their colours."""
LETTERS = "ABCDEF"
"""Letters of runs side by side, whose number is limited to these."""


@dataclass(frozen=True)
class Heading:
    """Texts of a report: title, None for wall and motion; author; text with blank lines between
    paragraphs; language of its summary."""

    title: str | None = None
    author: str | None = None
    text: str | None = None
    language: str = "en"

    @property
    def paragraphs(self):
        """The text by paragraphs."""
        return [part.strip() for part in re.split(r"\n\s*\n", self.text or "") if part.strip()]


def write_report(paths, out=None, heading=Heading()):
    """Write the report of histories and of folders of studies; returns its path.

    heading: title, author and text that the report begins with.
    paths: of histories, up to as many as LETTERS has, and of folders that hold the tables of
    studies; out: by default beside the first, NAME.html of a history, report.html in a folder.
    Raises InputError of a file that is no history or has no sample, of a folder without tables, and
    of another ending.
    """
    paths = list(map(Path, paths))
    if out is None:
        first = paths[0]
        out = first / "report.html" if first.is_dir() else first.with_suffix(".html")
    out = Path(out)
    if out.suffix.lower() not in (".html", ".htm"):
        raise InputError(f"--out {out}: expected a name that ends in .html; give it one")
    files, folders = (
        [path for path in paths if path.is_dir() == of_study] for of_study in (False, True)
    )
    return write_text(out, page(files, folders, heading))


def page(files, folders, heading=Heading()):
    """The text of the report of histories (paths) and of folders of studies, below its Heading."""
    if len(files) > len(LETTERS):
        raise InputError(
            f"{len(files)} histories: expected up to {len(LETTERS)} side by side; name fewer, or"
            " the folder of their study"
        )
    studies = [study for folder in folders for study in studies_below(folder)]
    histories = [read_history(path) for path in files]
    walls = [part for history in histories for part in history.parts]
    if len(walls) > len(LETTERS):  # of a large house no wall by itself
        walls = [history for history in histories if history.kind == "wall"]
    runs = [run_part(*part, heading.language) for part in zip(walls, LETTERS)]
    houses = _houses(histories, runs)
    parts = [study_part(folder) for folder in studies]
    title = _title(houses, runs, parts)
    return (
        environment()
        .get_template("report.html")
        .render(
            runs=runs,
            language=heading.language,
            words=partial(texts, heading.language),
            houses=houses,
            studies=parts,
            # the part of a study has its own
            of_folders=[
                {
                    "name": path.resolve().name,
                    "documents": documents(path),
                    "figures": figures(path),
                }
                for path in folders
                if path not in studies
            ],
            first=_read_first(runs, parts),
            title=heading.title or title,
            subject=title if heading.title else "",
            author=heading.author,
            paragraphs=heading.paragraphs,
            measures=measures(runs),
            energies=energy_balance(runs),
            parameters=parameters,
            versions=versions,
            threshold_mm=THRESHOLD / MILLIMETRE,
            data=htmlsafe_json_dumps(_drawn(runs), dumps=json_text),  # safe inside HTML
            marks=MARKS,
            colours=[colour for colour, _ in RUN_STYLES],
            size={"wide": WIDE, "tall": TALL, "left": LEFT, "below": BELOW},
            style=(PAGE / "report.css").read_text(encoding="utf-8"),
            program=(PAGE / "report.js").read_text(encoding="utf-8"),
            library=plotly_code() if runs else "",
            plotly_version=plotly_version,
            made_by=f"masonry-damage {VERSION}, commit {commit()}",
        )
    )


def _houses(histories, runs):
    known = {run["history"].path: run["summary"] for run in runs}
    return [
        house_part(
            history, {part.wall: known.get(part.path) or summarise(part) for part in history.parts}
        )
        for history in histories
        if history.kind == "house"
    ]


def _read_first(runs, studies):
    """(Name, lines) of what a reader has to know of runs and studies before their numbers."""
    alone = len(runs) == 1 and not studies
    parts = [
        *((run["file"] if alone else f"Run {run['letter']}, {run['file']}", run) for run in runs),
        *((f"Study {study['name']}", study) for study in studies),
    ]
    return [(name, part["first"]) for name, part in parts if part["first"]]


def _drawn(runs):
    """What the page's program draws."""
    return {
        "runs": [{"letter": run["letter"], **run["drawn"]} for run in runs],
        "charts": over_time(runs),
        "threshold_mm": THRESHOLD / MILLIMETRE,
        "states": states_legend(runs),
    }


def _title(houses, runs, studies):
    if len(houses) == 1 and not studies:
        return houses[0]["title"]
    if studies:
        return ", ".join(f"study {part['name']}" for part in studies)
    return runs[0]["title"] if len(runs) == 1 else f"{len(runs)} runs side by side"
