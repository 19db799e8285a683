"""Charts of the points of a study: damage over the intensity of the motion."""

import numpy as np
from matplotlib.ticker import MaxNLocator

from damage.applications.report.charts import RUN_STYLES
from damage.applications.studies.states import column_words, intensities_of

WIDE = 420
"""Width of a chart, in pixels of its own."""
TALL = 270
"""Height of a chart."""
LEFT = 68
"""Room for labels on the left of a chart."""
BELOW = 38
"""Room for labels below a chart."""
PLOTTED = ("max_DI", "residual_DI")
"""Measures that are drawn over the intensity."""


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


def charts(points, alike, chosen=None):
    """Charts of PLOTTED over the intensity of points, the chosen one if they have it: labels, ticks
    (place, words), of each point its place and its range over the members, and lines through those
    that are alike but for the intensity; [] where points have none, as of pushed walls."""
    known = intensities_of(points)
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
