"""Part of the page on a study: completeness, points and runs, figures, fragility, and documents
made of its tables."""

import base64
import math
from itertools import starmap

import numpy as np
from matplotlib.image import imread

from damage.applications.report.packing import as_png
from damage.applications.report.tables import COLUMNS as MEANING
from damage.applications.report.tables import cell, digits_of
from damage.applications.studies.fragility import fit_all, fragility_table, load_runs
from damage.applications.studies.fragility_picture import fragility_pictures
from damage.applications.studies.plan import unfinished
from damage.applications.studies.states import STUDY_FILE, leading
from damage.errors import InputError
from damage.measure.columns import read_table
from damage.measure.tables import repeated
from damage.provenance import shown_path
from damage.toml_file import read_toml

COLUMNS = (
    "solver",
    "wall",
    "motion",
    "members",
    "status",
    "collapsed",
    "pga_g",
    "pgv_m_s",
    "max_DI",
    "residual_DI",
    "max_drift_ratio",
    "residual_drift_ratio",
    "max_crack_width_mm",
    "max_psi",
    "peak_base_shear_n",
    "energy_error_fraction",
)
"""Columns of the table of points, shown where they have a value."""
OFTEN_SHARED = ("solver", "wall", "motion", "members", "status", "collapsed")
"""Columns of which a value that all points share is shown once, above the table."""
OF_POINTS = {
    "members": "how many runs the point has in its solver",
    "collapsed": "how many of them collapsed",
    "status": "complete when all its runs are",
}
NEEDED = ("point", "solver", "wall", "members")
"""Columns that every table of points has."""
MOST_DOCUMENT_MB = 1.0
"""Largest size of a document that is shown."""
MOST_FIGURES_MB = 3.0
"""Largest size of all embedded figures; others are listed by name."""
REPLICATES = 200
"""Bootstrap samples of a fragility curve's bounds; `python3 -m damage fragility` takes more."""
FIGURE_WORDS = {
    "fig06": "The harmonic motions that shook the walls",
    "fig07": "Damage index and its components over time",
    "fig08": "Damage index against the amplitude of the motion",
    "fig09": "Drift over time by amplitude",
    "fig10": "The records that shook the walls, with their spectra",
    "fig11": "Residual damage against peak acceleration",
    "fig12": "Damage index against the largest drift",
    "cracks": "Cracked joints of the walls of single runs",
    "sequences": "Damage over sequences of shocks",
    "sensitivity": "How much modelling choices move the damage",
    "life": "Lives of a wall: damage over the years, and the events that caused it",
    "fragility": "Probability of exceeding levels of damage against intensity",
}


def studies_below(folder):
    """Folders of the studies in or below a folder, those with tables; InputError where there are
    none."""
    found = sorted(path.parents[1] for path in folder.rglob("tables/summary.csv"))
    if not found:
        raise InputError(
            f"{folder}: no tables/summary.csv in it or below it; expected a history (.h5) or the"
            f" folder of a study; {unfinished(folder) or 'give one, as ./run_all.sh makes it'}"
        )
    return found


def runs_of(folder):
    """(summary, points) of a study's folder, DataFrames."""
    tables = folder / "tables"
    return (
        read_table(tables / "summary.csv", ("run", "point", "solver", "status")),
        read_table(tables / "points.csv", NEEDED),
    )


def study_part(folder, letters):
    """Everything about the study in a folder, a dictionary for the page.

    letters: {name of a run: letter of its own part of the page}, of those that have one.
    """
    summary, points = runs_of(folder)
    content = [name for name in COLUMNS if name in points and points[name].notna().any()]
    shared = [
        name for name in OFTEN_SHARED if name in content and points[name].nunique(dropna=False) == 1
    ]
    content = [name for name in content if name not in shared]
    heads = [
        {
            "name": name,
            "unit": MEANING.get(name, ("", ""))[0],
            "meaning": OF_POINTS.get(name) or MEANING[name][1],
        }
        for name in content
    ]
    try:
        about = read_toml(folder / "study.toml", *STUDY_FILE)
    except InputError:
        about = {}
    return {
        "name": str(about.get("name") or folder.resolve().name),
        "title": str(about.get("title") or ""),
        "folder": shown_path(folder),
        "shared": [(name, _cell(points.iloc[0][name], name)[0]) for name in shared],
        "first": said_first(folder, summary, points),
        "heads": heads,
        "rows": [_point(row, content, summary, letters) for _, row in points.iterrows()],
        "n_runs": len(summary),
        "figures": figures(folder),
        "fragility": _fragility(folder),
        "documents": documents(folder),
    }


def said_first(folder, summary, points):
    """Notes on a study before its results: missing, growing and unfinished runs, collapses; a list
    of str."""
    lines = [line for line in [unfinished(folder)] if line]
    growing = sorted(path.name for path in (folder / "runs").glob("*.part.h5"))
    if growing:
        lines.append(f"growing, or cut short: {', '.join(growing)}")
    ended = summary["status"] == "complete"
    if not ended.all():
        lines.append(
            f"did not come to their end: {', '.join(summary.loc[~ended, 'run'].astype(str))}"
        )
    fell = summary["collapsed_at_s"].notna() if "collapsed_at_s" in summary else ended & False
    if fell.any():
        lines.append(
            f"{int(fell.sum())} of {len(summary)} runs collapsed: their maxima are those until then"
        )
    if again := repeated(summary):
        lines.append(
            f"{again} of {len(summary)} runs were repeated in smaller steps "
            "(docs/validation/step-and-damping.md)"
        )
    return lines


def _point(row, content, summary, letters):
    """One row of the table: its point, its runs with the letters of their parts, its cells with
    their range."""
    same = (summary["point"] == row["point"]) & (summary["solver"] == row["solver"])
    runs = [(str(name), letters.get(str(name))) for name in summary.loc[same, "run"]]
    cells = [(*_cell(row[name], name), _range(row, name)) for name in content]
    return {"point": str(row["point"]), "runs": runs, "cells": cells}


def _cell(value, name=""):
    """(text, number or None) of a cell of a table, which may be numpy's, NaN where it is empty;
    name: of its column."""
    value = value.item() if isinstance(value, np.generic) else value
    if isinstance(value, float) and (
        math.isnan(value) or (value.is_integer() and abs(value) < 1e6)
    ):
        value = None if math.isnan(value) else int(value)
    return cell(value, digits_of(name))


def _range(row, name):
    """Words "least to most" over the members, "" where they are one or agree."""
    low, high = row.get(f"{name}_min"), row.get(f"{name}_max")
    return "" if low is None or high is None or not low < high else f"{low:.3g} to {high:.3g}"


# --- figures --------------------------------------------------------------------------------------


def figures(folder):
    """{"embedded": [figure], "named": [paths that are too large to embed]} of the PNG files of a
    study.

    They are looked for in its folders `figures` and `pictures` and in itself; pictures of single
    runs are left out.
    """
    places = folder / "figures", folder / "pictures", folder
    paths = [path for place in places for path in sorted(place.glob("*.png"))]
    embedded, named, left = [], [], MOST_FIGURES_MB * 1e6
    for path in paths:
        if path.stat().st_size > left:
            named.append(path.relative_to(folder).as_posix())
        else:
            left -= path.stat().st_size
            embedded.append(_embedded(path))
    return {"embedded": embedded, "named": named}


def _embedded(path):
    """One figure: name, data, width and height [px], what it shows in words."""
    try:
        height, width = imread(path).shape[:2]
    except (OSError, ValueError, SyntaxError) as error:
        raise InputError(
            f"{path} cannot be read as a picture ({error}); expected a PNG file, draw it again"
        ) from error
    return {
        "name": path.stem,
        "data": base64.b64encode(path.read_bytes()).decode("ascii"),
        "width": width,
        "height": height,
        "words": figure_words(path.stem),
    }


def figure_words(name):
    """Caption of a figure, from its name.

    >>> figure_words("fig12_drift_symmetric"), figure_words("mine")
    ('Damage index against the largest drift (fig12_drift_symmetric)', 'Figure mine')
    """
    found = next((words for start, words in FIGURE_WORDS.items() if name.startswith(start)), None)
    return f"{found} ({name})" if found else f"Figure {name}"


# --- fragility, documents -------------------------------------------------------------------------


def _fragility(folder):
    """Curves, figures and bounds of a study with scattered strengths, None of another."""
    try:
        runs = load_runs(folder)
        intensity = leading(runs)
        fits = fit_all(runs, intensity, REPLICATES)
    except InputError:
        return None
    table = fragility_table(fits, intensity)
    return {
        "heads": list(table),
        "rows": [[_cell(value) for value in row] for row in table.to_numpy(object)],
        "figures": list(starmap(_drawn, fragility_pictures(runs, fits, intensity))),
    }


def _drawn(name, figure):
    """A matplotlib Figure as an embedded figure; width and height give its aspect ratio only."""
    width, height = (round(100 * inches) for inches in figure.get_size_inches())
    return {
        "name": name,
        "data": as_png(figure),
        "width": width,
        "height": height,
        "words": figure_words(name),
    }


def documents(folder):
    """[(name, text)] of the documents that programs made of a folder's tables, as `conclusion` of a
    study does."""
    return [
        (path.stem, path.read_text(encoding="utf-8", errors="replace"))
        for path in sorted((folder / "tables").glob("*.md"))
        if path.stat().st_size < MOST_DOCUMENT_MB * 1e6
    ]
