"""Points of the figures of studies, with their ranges and legends; motions and records, their order
and markers."""

import numpy as np

from damage.draw.panels import finish
from damage.draw.style import BLACK, BLUE, GREEN, MEDIUM, ORANGE, VERMILLION, line_handle
from damage.draw.words import EVENTS, record_label, station_of

COMPONENTS = {  # column of the tables: label, colour, marker
    "DI": ("DI", BLACK, "D"),
    "DI_drift": (r"DI$_\mathrm{drift}$", GREEN, "^"),
    "DI_open": (r"DI$_\mathrm{open}$", ORANGE, "s"),
    "DI_slip": (r"DI$_\mathrm{slip}$", BLUE, "o"),
}
SLIP_LABELS = {
    "displacement": "slipped: offset by more than 0.1 mm",
    "accumulated": "slipped: accumulated more than 0.1 mm while closed",
    "shear-limit": "slipped: ever at the shear limit",
}
NOTHING = 0.01
"""Least upper limit of the axes of the index."""
SCALES_APART = 2.0
"""Ratio of the scales of panels from which the heading mentions it."""


def scale_note(axes, axis="y"):
    """Text for the heading where the scales of visible panels differ by SCALES_APART or more, else
    "".

    axes: array of any shape of panels with one quantity along that axis ("x" or "y").
    """
    spans = [
        np.ptp(ax.get_ylim() if axis == "y" else ax.get_xlim())
        for ax in np.ravel(axes)
        if ax.axison
    ]
    ratio = max(spans) / min(spans)
    return (
        ""
        if ratio < SCALES_APART
        else (
            f"The panels have {'vertical' if axis == 'y' else 'horizontal'} scales of their own:"
            f" the widest spans {ratio:.2g} times the narrowest"
        )
    )


def numbers(points, column):
    """A column of a table as floats, (n,), NaN where it is missing or empty."""
    if column not in points:
        return np.full(len(points), np.nan)
    return points[column].to_numpy(dtype=float)


def median_and_range(points, name):
    """Median of a measure, (n,), and the distances of its minimum and maximum from it, (2, n)."""
    median = numbers(points, name)
    spread = np.array(
        [median - numbers(points, f"{name}_min"), numbers(points, f"{name}_max") - median]
    )
    return median, np.clip(np.nan_to_num(spread), 0, None)


def draw_points(ax, points, x, y, colour, marker, shift=0.0):
    """Draw medians of the reference solver with their ranges, joined by a line; x, y: names of
    measures.

    shift: along x, in its unit, so that ranges of several measures do not coincide.
    """
    points = points.iloc[np.argsort(numbers(points, x))]
    _draw_with_range(ax, points, x, y, shift, color=colour, marker=marker, ms=3.2, lw=0.7, zorder=3)


def draw_cloud(ax, points, x, y, colour, marker):
    """Draw medians of the reference solver, not joined, with their ranges in grey."""
    _draw_with_range(
        ax,
        points,
        x,
        y,
        0.0,
        color=colour,
        marker=marker,
        ms=5,
        mew=1.0,
        ls="",
        zorder=3,
        ecolor=MEDIUM,
    )


def draw_yade(ax, points, x, y, colour, marker, shift=0.0):
    """Draw runs of YADE with hollow markers, larger than those of the medians, so that both are
    visible."""
    _draw_with_range(
        ax,
        points,
        x,
        y,
        shift,
        ecolor=colour,
        marker=marker,
        mfc="none",
        mec=colour,
        mew=0.8,
        ms=5.6,
        ls="",
        zorder=4,
    )


def _draw_with_range(ax, points, x, y, shift, **style):
    """Draw points, with bars where there is a range."""
    (place, place_range), (value, value_range) = (median_and_range(points, name) for name in (x, y))
    ax.errorbar(
        place + shift,
        value,
        value_range if value_range.any() else None,
        place_range if place_range.any() else None,
        elinewidth=0.8,
        capsize=1.6,
        capthick=0.6,
        **style,
    )


def draw_components(ax, reference, yade, x, prefix):
    """Draw the index and its components (columns prefix + name) of both solvers against x.

    Returns whether any run collapsed; points with such runs are crossed out.
    """
    span = max(
        (np.nanmax(numbers(points, x)) for points in (reference, yade) if len(points)), default=0.0
    )
    shifts = dict(zip(COMPONENTS, span * np.array((-0.009, -0.003, 0.003, 0.009))))
    for name, (_, colour, marker) in COMPONENTS.items():
        draw_points(ax, reference, x, prefix + name, colour, marker, shifts[name])
        draw_yade(ax, yade, x, prefix + name, colour, marker, shifts[name])
    return any(
        [mark_collapses(ax, points, x, prefix + "DI", shifts["DI"]) for points in (reference, yade)]
    )


def fallen(points):
    """Whether a run of each point collapsed, (n,) bool: their index is that at which the run
    stopped."""
    return np.isfinite(numbers(points, "collapsed_at_s")) | (numbers(points, "collapsed") > 0)


def mark_collapses(ax, points, x, y, shift=0.0):
    """Draw a cross over each point with a collapsed run; returns whether there is one."""
    collapsed = fallen(points)
    ax.plot(
        numbers(points, x)[collapsed] + shift,
        numbers(points, y)[collapsed],
        ls="",
        marker="x",
        ms=7,
        mew=1.1,
        color=VERMILLION,
        zorder=5,
    )
    return bool(collapsed.any())


def solver_handles(variant, collapse=False):
    """Legend entries of the solvers."""
    handles = []
    if len(variant.reference):
        label = f"reference: {describe_members(variant.reference)}"
        handles.append(line_handle(MEDIUM, label, 0.7, marker="o", ms=3.2))
    if len(variant.yade):
        label = f"YADE: {describe_members(variant.yade)}"
        mark = {"marker": "o", "mfc": "none", "mew": 0.8, "ms": 5.6}
        handles.append(line_handle(MEDIUM, label, line="", **mark))
    if collapse:
        handles.append(collapse_handle())
    return handles


def collapse_handle():
    """Legend entry of `mark_collapses`."""
    label = "a run collapsed: index as it fell"
    return line_handle(VERMILLION, label, line="", marker="x", ms=6)


def describe_members(points):
    """Text: number of runs of each point."""
    low = int(points["members"].min())
    high = int(points["members"].max())
    if high == 1:
        return "single runs"
    return f"median, range of {'' if low == high else 'up to '}{high} runs"


def component_handles(slip_marker=True):
    """Legend entries of the index and its components."""
    return [
        line_handle(colour, label, marker=marker if slip_marker else "", ms=3.2)
        for label, colour, marker in COMPONENTS.values()
    ]


def finish_components(figure, variant, collapsed, more):
    """Add the legend of components, solvers and more handles to a figure; returns the figure."""
    return finish(
        figure, component_handles() + solver_handles(variant, collapsed) + more, columns=7
    )


OTHER_MARKERS = "4|_*"
SINGLE_MARKERS = "osD^v"
"""Hollow markers of the records, in their order, for single runs where all lines share a colour."""


def motion_label(point):
    """The motion of a point (a row of points.csv) in words, as "0.2 s, 0.1 g" or "Zeerijp, BGAR
    east × 2"."""
    if isinstance(point.get("record"), str):
        return f"{record_label(point['record'])} × {point['scale']:g}"
    return f"{point['motion_period_s']:g} s, {point['amplitude_g']:g} g"


def in_order(names):
    """Names of records in the order of EVENTS, unknown ones last."""
    stations = [*EVENTS, None]
    return sorted(names, key=lambda name: (stations.index(station_of(name)), name))


def record_markers(names):
    """A marker for each record, the paper's for the two that it uses."""
    others = iter(OTHER_MARKERS * len(names))
    return {name: EVENTS.get(station_of(name), ("", ""))[1] or next(others) for name in names}
