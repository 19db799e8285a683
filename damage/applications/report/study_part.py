"""Part of the page on a study: what is missing, damage over intensity, each point with its wall,
table of points, figures, fragility, and documents made of its tables.

It holds no moving wall: those of six runs made files of 4 MB.
"""

import base64
import math
import re
from itertools import starmap

import numpy as np
import pandas as pd
from matplotlib.image import imread
from matplotlib.ticker import MaxNLocator

from damage.applications.report.charts import RUN_STYLES
from damage.applications.report.packing import as_png
from damage.applications.report.tables import COLUMNS as MEANING
from damage.applications.report.tables import cell, digits_of
from damage.applications.studies.fragility import choices_of, fit_all, fragility_table, mixed
from damage.applications.studies.fragility_picture import fragility_pictures
from damage.applications.studies.plan import unfinished
from damage.applications.studies.read import read_table
from damage.applications.studies.spread import repeated
from damage.applications.studies.states import (
    INTENSITIES,
    STUDY_FILE,
    label,
    there,
)
from damage.draw.run import wall_picture
from damage.draw.words import record_label, wall_words
from damage.errors import InputError
from damage.history.reader import read_history
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
OFTEN_SHARED = ("solver", "members", "status", "collapsed", "pga_g", "pgv_m_s")
"""Columns of which a value that all points share is shown once, above the table."""
OF_POINTS = {
    "members": "how many runs the point has in its solver",
    "collapsed": "how many of them collapsed",
    "status": "complete when all its runs are",
}
NEEDED = ("point", "solver", "wall", "members")
"""Columns that every table of points has."""
MOST_DOCUMENT_MB = 0.2
"""Largest size of a document that is shown."""
MOST_FIGURES_MB = 0.3
"""Largest size of all embedded figures; others are listed by name."""
MOST_WALLS_MB = 0.3
"""Largest size of all pictures of cracked walls; the points of the largest damage come first."""
PLOTTED = ("max_DI", "residual_DI")
"""Measures that are drawn over the intensity."""
_FOLLOWS = {
    *("point", "solver", "wall", "motion", "record", "record_unit", "scale", "amplitude_g"),
    *("motion_period_s", "d5_75_s", "d5_95_s", "window_start_s", "window_end_s"),
    *("motion_duration_s", "lost_by_lines", "time_step_s", "eigen_period_s", *INTENSITIES),
    *("total_joint_length_m", "elastic_joint_share", "elastic_joint_share_above_openings"),
}
"""Parameters that a point's wall and motion say, or that follow from them."""
WIDE = 420
TALL = 270
LEFT = 68
BELOW = 38
"""Size of a chart, and room for its labels on the left and below, pixels of its own."""
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
    studies = sorted(path.parents[1] for path in folder.rglob("tables/summary.csv"))
    if not studies:
        raise InputError(
            f"{folder}: no tables/summary.csv in it or below it; expected a history (.h5) or the"
            f" folder of a study; {unfinished(folder) or 'give one, as ./run_all.sh makes it'}"
        )
    return studies


def runs_of(folder):
    """(summary, points) of a study's folder, DataFrames."""
    tables = folder / "tables"
    return (
        read_table(tables / "summary.csv", ("run", "point", "solver", "status")),
        read_table(tables / "points.csv", NEEDED),
    )


def study_part(folder):
    """Everything about the study in a folder, a dictionary for the page."""
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
            "words": column_words(name),
        }
        for name in content
    ]
    try:
        about = read_toml(folder / "study.toml", *STUDY_FILE)
    except InputError:
        about = {}
    words, labels_of = labels(points)
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
            _point(row, content, summary)
            | {
                "number": number,
                "words": words[number],
                "of": [
                    str(kinds[name].index(values[number])) for name, values in labels_of.items()
                ],
                "picture": walls.get(number),
            }
            for number, (_, row) in enumerate(points.iterrows())
        ],
        "filters": {name: values for name, values in kinds.items() if len(values) > 1},
        "kinds": {name: column_words(name) for name in kinds},
        "walls": kinds["wall"],
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
    """What points are called, (n,), without names of files; and {"wall", "solver", "motion", and
    what else differs between points: its words of each point}."""
    of = {
        "wall": [wall_words(str(name)) for name in points["wall"]],
        "solver": list(map(str, points["solver"])),
        "motion": [_motion(row)[0] for _, row in points.iterrows()],
    }
    factors = [_motion(row)[1] for _, row in points.iterrows()]
    for name in each(PARAMETERS):
        if name in points and name not in _FOLLOWS and points[name].nunique(dropna=False) > 1:
            of[name] = [_cell(value, name)[0] for value in points[name]]
    more = [name for name in of if name not in ("wall", "solver", "motion")]
    words = [
        ", ".join(
            [
                f"{of['motion'][k]}{factors[k]}",
                *(f"{column_words(name)} {of[name][k]}" for name in more),
            ]
        )
        for k in range(len(points))
    ]
    return words, of


def column_words(name):
    """A column's name in words, with its unit.

    >>> column_words("max_crack_width_mm"), column_words("pgv_m_s"), column_words("wall")
    ('maximum crack width [mm]', 'PGV [m/s]', 'wall')
    """
    return re.sub(r"[$_{}\\]|mathrm", "", label(name)).replace(" [-]", "")


def axes(kinds):
    """The two names of `labels` that colours and marks show: what varies, the study's own keys
    before the motion, and what has more values than there are colours last; one name twice where no
    other varies.

    kinds: {name: its different values}.
    """
    keys = [name for name in kinds if name not in ("motion", "solver")]
    varied = [name for name in (*keys, "motion") if len(kinds[name]) > 1]
    varied.sort(key=lambda name: len(kinds[name]) > len(RUN_STYLES))
    return [*varied, *varied, "wall", "wall"][:2] if len(varied) < 2 else varied[:2]


def _motion(row):
    """Words for a point's motion, and the factor on it."""
    scale = row.get("scale")
    amplitude = row.get("amplitude_g")
    if isinstance(row.get("record"), str):
        return record_label(row["record"]), "" if pd.isna(scale) else f" × {scale:g}"
    if not pd.isna(amplitude) and amplitude is not None:
        return f"harmonic, {row['motion_period_s']:g} s", f" of {amplitude:g} g"
    motion = row.get("motion")
    return motion.replace("_", " ") if isinstance(motion, str) else "several motions", ""


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
        if left <= 0 or not path.is_file():
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


def charts(points, alike, chosen=None):
    """Charts of PLOTTED over the intensity of points, the chosen one if they have it: labels, ticks
    (place, words), of each point its place and its range over the members, and lines through those
    that are alike but for the intensity; [] where points have none, as of pushed walls."""
    known = there(points)
    names = [name for name in (chosen, "pgv_m_s", *known) if name in known]
    if not names:
        return []
    x = points[names[0]].astype(float).to_numpy()
    return [
        _chart(points, x, alike, names[0], name) for name in PLOTTED if points[name].notna().any()
    ]


def _chart(points, x, alike, intensity, measure):
    y = points[measure].astype(float).to_numpy()
    ends = [
        points[f"{measure}_{end}"].astype(float).to_numpy() if f"{measure}_{end}" in points else y
        for end in ("min", "max")
    ]
    (across, x_ticks) = _scale(x, LEFT, WIDE - 20)
    (up, y_ticks) = _scale(ends[1], TALL - BELOW, 8)
    places = np.round([across(x), up(y), *map(up, ends)], 1).T
    lines = {}
    for number in np.argsort(x, kind="stable").tolist():
        if not np.isnan(places[number]).any():
            lines.setdefault(alike[number], []).append(number)
    return {
        "x": column_words(intensity),
        "y": {"max_DI": "maximum DI", "residual_DI": "residual DI"}[measure],
        "x_ticks": x_ticks,
        "y_ticks": y_ticks,
        "dots": [None if np.isnan(place).any() else place.tolist() for place in places],
        "lines": list(lines.values()),
    }


def _scale(values, first, last):
    """A function from values to places between first and last, which begins at zero, and its ticks,
    (place, words)."""
    ticks = MaxNLocator(5).tick_values(0, np.nanmax(values, initial=1e-6))
    ticks = ticks[ticks >= 0]

    def place(value):
        return first + (last - first) * value / ticks[-1]

    return place, [(round(float(place(tick)), 1), f"{tick:g}") for tick in ticks]


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


def _runs_of(row, summary):
    """Names of the runs of a point, a list of str."""
    same = (summary["point"] == row["point"]) & (summary["solver"] == row["solver"])
    return list(map(str, summary.loc[same, "run"]))


def _point(row, content, summary):
    """One row of the table: names of its runs, its cells with their range."""
    cells = [(*_cell(row[name], name), _range(row, name)) for name in content]
    return {"runs": _runs_of(row, summary), "cells": cells}


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
    low = row.get(f"{name}_min")
    high = row.get(f"{name}_max")
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
    embedded = []
    named = []
    left = MOST_FIGURES_MB * 1e6
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
    caption = next((words for start, words in FIGURE_WORDS.items() if name.startswith(start)), None)
    return f"{caption} ({name})" if caption else f"Figure {name}"


# --- fragility, documents -------------------------------------------------------------------------


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
    table = fragility_table(fits, intensity)
    return {
        "notes": list(mixed(runs)),
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
