"""Part of the page on a study: what is missing, damage over intensity, each point with its wall,
table of points, figures, fragility, and documents made of its tables.

It holds no moving wall: those of six runs made files of 4 MB.
"""

import math
from itertools import starmap

import numpy as np
import pandas as pd

from damage.applications.report.figures import documents, drawn, figures
from damage.applications.report.packing import as_png
from damage.applications.report.study_charts import axes, charts
from damage.applications.report.tables import cell, digits_of, meaning_of
from damage.applications.studies.fragility import choices_of, fit_all, fragility_table, mixed
from damage.applications.studies.fragility_picture import fragility_pictures
from damage.applications.studies.plan import unfinished
from damage.applications.studies.read import read_table
from damage.applications.studies.spread import repeated
from damage.applications.studies.states import INTENSITIES, STUDY_FILE, column_words
from damage.draw.run import wall_picture
from damage.draw.words import record_label, wall_words
from damage.errors import InputError
from damage.history.reader import file_of, read_history
from damage.history.schema import each
from damage.measure.columns import PARAMETERS
from damage.provenance import shown_path
from damage.toml_file import read_toml

COLUMNS = (
    "solver",
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
OFTEN_SHARED = COLUMNS[:6]
"""Columns of which a value that all points share is shown once, above the table."""
OF_POINTS = {
    "members": "how many runs the point has in its solver",
    "collapsed": "how many of them collapsed",
    "status": "complete when all its runs are",
}
NEEDED = ("point", "solver", "wall", "members")
"""Columns that every table of points has."""
MOST_WALLS_MB = 0.3
"""Largest size of all pictures of cracked walls; the points of the largest damage come first."""
_FOLLOWS = {
    *("point", "solver", "wall", "motion", "record", "record_unit", "scale", "amplitude_g"),
    *("motion_period_s", "cycles", "d5_75_s", "d5_95_s", "window_start_s", "window_end_s"),
    *("motion_duration_s", "lost_by_lines", "time_step_s", "eigen_period_s", *INTENSITIES),
    *("total_joint_length_m", "elastic_joint_share", "elastic_joint_share_above_openings"),
}
"""Parameters that a point's wall and motion say, or that follow from them."""
REPLICATES = 200
"""Bootstrap samples of a fragility curve's bounds; `python3 -m damage fragility` takes more."""


def studies_below(folder):
    """Folders of the studies in or below a folder, those with tables; InputError where there are
    none."""
    studies = sorted(path.parents[1] for path in folder.rglob("tables/summary.csv"))
    if not studies:
        raise InputError(
            f"{folder}: no tables/summary.csv in it or below it; expected a history (.h5) or the"
            f" folder of a study; {unfinished(folder) or 'give one, as ./run_all.sh makes it'}"
        )
    return studies


def study_part(folder):
    """Everything about the study in a folder, a dictionary for the page."""
    tables = folder / "tables"
    summary = read_table(
        tables / "summary.csv", ("run", "point", "solver", "status", "collapsed_at_s")
    )
    points = read_table(tables / "points.csv", NEEDED)
    content = [name for name in COLUMNS if name in points and points[name].notna().any()]
    shared = [
        name for name in OFTEN_SHARED if name in content and points[name].nunique(dropna=False) == 1
    ]
    content = [name for name in content if name not in shared]
    heads = [
        {
            "name": name,
            "meaning": OF_POINTS.get(name) or meaning_of(name),
            "words": column_words(name),
        }
        for name in content
    ]
    try:
        about = read_toml(folder / "study.toml", *STUDY_FILE)
    except InputError:
        about = {}
    titles, labels_of = labels(points)
    walls, unread = cracked_walls(folder, summary, points)
    kinds = {name: list(dict.fromkeys(values)) for name, values in labels_of.items()}
    return {
        "name": str(about.get("name") or folder.resolve().name),
        "title": str(about.get("title") or ""),
        "folder": shown_path(folder),
        "shared": [(column_words(name), _cell(points.iloc[0][name], name)[0]) for name in shared],
        "first": said_first(folder, summary) + unread,
        "heads": heads,
        "rows": [
            {
                "runs": _runs_of(row, summary),
                "cells": [(*_cell(row[name], name), _range(row, name)) for name in content],
                "number": number,
                "words": titles[number],
                "of": [
                    str(kinds[name].index(values[number])) for name, values in labels_of.items()
                ],
                "picture": walls.get(number),
            }
            for number, (_, row) in enumerate(points.iterrows())
        ],
        "kinds": {name: column_words(name) for name in kinds},
        "axes": axes(kinds),
        "legend": kinds,
        "shown": next(iter(walls), None),
        "charts": charts(points, list(zip(*labels_of.values())), about.get("intensity")),
        "n_runs": len(summary),
        "figures": figures(folder),
        "fragility": _fragility(folder, summary),
        "documents": documents(folder),
    }


def labels(points):
    """Titles of points, (n,), without names of files; and {"wall", "solver", "motion", and what
    else differs between points: its text of each point}."""
    motions = [_motion(row) for _, row in points.iterrows()]
    texts = {
        "wall": [wall_words(str(name)) for name in points["wall"]],
        "solver": list(map(str, points["solver"])),
        "motion": [motion for motion, _ in motions],
    }
    titles = [motion + factor for motion, factor in motions]
    for name in each(PARAMETERS):
        if name in points and name not in _FOLLOWS and points[name].nunique(dropna=False) > 1:
            texts[name] = [_cell(value, name)[0] for value in points[name]]
            titles = [
                f"{title}, {column_words(name)} {text}" for title, text in zip(titles, texts[name])
            ]
    return titles, texts


def _motion(row):
    """Words for a point's motion, and the factor on it."""
    scale = row.get("scale")
    amplitude = row.get("amplitude_g")
    cycles = "" if pd.isna(row.get("cycles")) else f", {row['cycles']:g} cycles"
    if isinstance(row.get("record"), str):
        return record_label(row["record"]), "" if pd.isna(scale) else f" × {scale:g}"
    if not pd.isna(amplitude):
        return f"harmonic, {row['motion_period_s']:g} s{cycles}", f" of {amplitude:g} g"
    motion = row.get("motion")
    text = motion.replace("_", " ") if isinstance(motion, str) else "several motions"
    return f"{text}{cycles}", ""


def cracked_walls(folder, summary, points):
    """({number of a point: its first run's wall at the largest DI, PNG in base64}, why histories
    cannot be read), as many as MOST_WALLS_MB holds, the largest damage first."""
    pictures = {}
    unread = []
    left = MOST_WALLS_MB * 1e6
    damage = points.reindex(columns=["max_DI"])["max_DI"].astype(float).fillna(0.0)
    for number in np.argsort(-damage.to_numpy(), kind="stable"):
        row = points.iloc[number]
        path = folder / "runs" / f"{next(iter(_runs_of(row, summary)), '')}.h5"
        if left <= 0 or not file_of(path).is_file():
            continue
        try:
            figure = wall_picture(read_history(path))
        except InputError as error:
            unread.append(f"cannot be read: {error}")
            continue
        figure.suptitle("")  # the page says what it is
        pictures[int(number)] = as_png(figure, 80)
        left -= len(pictures[int(number)])
    return pictures, unread


def said_first(folder, summary):
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
    fell = summary["collapsed_at_s"].notna()
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


def _runs_of(row, summary):
    """Names of the runs of a point, a list of str."""
    same = (summary["point"] == row["point"]) & (summary["solver"] == row["solver"])
    return list(map(str, summary.loc[same, "run"]))


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
    low = row.get(f"{name}_min", np.nan)
    high = row.get(f"{name}_max", np.nan)
    return f"{low:.3g} to {high:.3g}" if low < high else ""


def _fragility(folder, summary):
    """Curves, figures and bounds of a study with scattered strengths, or why it has none; None of
    another."""
    if not (summary.reindex(columns=["strength_cov"])["strength_cov"].astype(float) > 0).any():
        return None
    try:
        runs, intensity, states = choices_of(folder)
        fits = fit_all(runs, intensity, REPLICATES, states)
    except InputError as error:
        return {"why": str(error)}
    table = fragility_table(fits)
    return {
        "notes": list(mixed(runs)),
        "heads": list(table),
        "rows": [[_cell(value) for value in row] for row in table.to_numpy(object)],
        "figures": list(starmap(drawn, fragility_pictures(runs, fits))),
    }
