"""Further figures of studies: crack maps, sequences of events, and modelling choices that are
varied one at a time."""

import numpy as np
import pandas as pd
from matplotlib.lines import Line2D

from damage.draw import panels
from damage.draw.run import draw_wall, joint_handles
from damage.draw.style import (
    BLACK,
    BLUE,
    GREEN,
    LIGHT,
    MEDIUM,
    VERMILLION,
    line_handle,
    put_title,
    styled,
)
from damage.draw.wall import wall_shape
from damage.measure.cycles import shocks_table
from damage.motion.loading import Harmonic
from damage.run.settings import RunSettings
from damage.wall.model_options import USUAL_MODEL
from paper import marks
from paper.results import REFERENCE, Missing

# --- crack maps of a study: a row for each motion -------------------------------------------------

MOST_ROWS = 5
"""Rows of a page; of more motions the most damaging are shown."""
PANEL_PT = 205, 100
"""Width and height that a wall fills at most in a panel, without labels."""


@styled
def crack_maps(results, variant):
    """Walls of the strongest motions of each kind at maximum DI and at the end, in true scale.

    Where both solvers have a point, that of the reference solver is drawn.
    """
    points = variant.reference if len(variant.reference) else variant.yade
    points = points.dropna(subset="max_DI").sort_values("max_DI", ascending=False).head(MOST_ROWS)
    if len(points) == 0:
        raise Missing("no point with a damage index")
    solver = "reference solver" if len(variant.reference) else "YADE"
    histories = [
        (marks.motion_label(point), results.history(point)) for _, point in points.iterrows()
    ]
    figure, axes = panels.grid(len(histories), 2, 2.35)
    shapes = []
    for first, row, (name, history) in zip(range(0, axes.size, 2), axes, histories):
        for number, (ax, sample, when) in enumerate(
            zip(row, ("max", "end"), ("largest index", "end")), first
        ):
            shapes.append(wall_shape(history, sample).on_page(PANEL_PT))
            draw_wall(ax, shapes[-1])
            ax.label_outer()
            panels.letter(
                ax,
                number,
                f"{name}\n{when}: DI {shapes[-1].index:.3f}, displacements × "
                f"{shapes[-1].magnification:g}",
            )
    widest = max(shapes, key=lambda shape: shape.crack_width_m.max(initial=0))
    put_title(
        figure, f"Cracks, {variant.title}: the most damaging motions, first run of each, {solver}"
    )
    return panels.finish(figure, joint_handles(widest), columns=5)


# --- the damage index of a wall after each event, from a study's histories ------------------------

_LINES = {  # column of the table of shocks: label, style
    "max_DI": ("maximum DI", {"color": BLACK, "marker": "D"}),
    "residual_DI": ("residual DI", {"color": BLACK, "marker": "D", "mfc": "none", "ls": "--"}),
    "max_shear_limit_DI": ("maximum, slip by the shear limit", {"color": BLUE, "marker": "o"}),
    "residual_shear_limit_DI": (
        "residual, slip by the shear limit",
        {"color": BLUE, "marker": "o", "mfc": "none", "ls": "--"},
    ),
    "max_DI_drift": (r"maximum DI$_\mathrm{drift}$", {"color": GREEN, "marker": "^"}),
}


@styled
def sequences(results, points):
    """Maximum and residual index of every shock, a panel a sequence: medians over a point's runs,
    and ranges.

    Shocks that a fallen wall did not live to see are not there.
    """
    figure, axes = panels.grid(-(-len(points) // 2), 2, 1.9, sharex=False)
    for number, (ax, (_, point)) in enumerate(zip(axes.flat, points.iterrows())):
        histories = results.histories(point)
        if not histories:
            raise Missing(f"no history of point {point['point']}: shocks are in none of the tables")
        tables = pd.concat(map(shocks_table, histories))
        factors = list(tables.groupby("shock")["factor"].first())
        text = (
            f"{len(factors)} times"
            if len(set(factors)) == 1
            else "times " + ", ".join(f"{f:g}" for f in factors)
        )
        panels.letter(ax, number, f"{marks.motion_label(point)}, {text}")
        _draw_shocks(ax, tables)
        ax.set_ylabel("damage index [-]")
        ax.set_xlabel("shock")
        panels.from_zero(ax, marks.NOTHING)
    for ax in axes.flat[len(points) :]:
        ax.set_axis_off()
    solver = "reference solver" if points["solver"].iloc[0] == REFERENCE else "YADE"
    put_title(
        figure,
        f"Damage index shock by shock: {' and '.join(points['wall'].unique())} wall",
        f"{solver}, {marks.describe_members(points)}; residual: after each shock's rest and"
        " settling",
        marks.scale_note(axes),
    )
    handles = [
        Line2D([], [], ms=3.2, lw=0.9, label=label, **style) for label, style in _LINES.values()
    ]
    return panels.finish(figure, handles, columns=3)


def _draw_shocks(ax, tables):
    by_shock = tables.groupby("shock")
    for column, (_, style) in _LINES.items():
        values = by_shock[column].agg(["median", "min", "max"]).dropna()
        spread = np.array([values["median"] - values["min"], values["max"] - values["median"]])
        ax.errorbar(
            values.index,
            values["median"],
            spread if spread.any() else None,
            ms=3.2,
            lw=0.9,
            ecolor=MEDIUM,
            elinewidth=0.8,
            capsize=1.6,
            **style,
        )
    ax.set_xticks(sorted(tables["shock"].unique()))


# --- the damage index where a study varies modelling choices --------------------------------------

_WORDS = {
    "cycles": "{:g} cycles",
    "contacts": "contacts at {}",
    "cells": "{:g} contacts a half brick",
    "top": "top mass: {}",
    "load": "load over the {}",
    "lintel": "lintel: {}",
    "beta_s": "β = {:g} s",
}
DEFAULTS = (
    dict.fromkeys(_WORDS) | USUAL_MODEL | {"cycles": Harmonic.cycles, "beta_s": RunSettings.beta_s}
)
"""Columns that are varied, and what stands in them where they are not."""
BESIDE = 1.03  # where walls that fell are marked, in shares of a panel's width
_STYLES = {"max_DI": (BLACK, "D", "displacement"), "max_shear_limit_DI": (BLUE, "o", "shear-limit")}


@styled
def choices(points):
    """Maximum DI of the reference solver's points, medians and ranges: a panel for each motion, a
    line for each choice.

    A panel needs the default point and another one; grey lines show the default values.  Points
    with a collapsed run are marked at the right of the panel, outside the scale of the index.
    """
    points = points[points["solver"] == REFERENCE]
    points = points.assign(choice=points.apply(choice, axis=1))
    motions = [
        (name, rows)
        for name, rows in points.groupby(points.apply(marks.motion_label, axis=1), sort=False)
        if len(rows) > 1 and "default" in set(rows["choice"])
    ]
    if not motions:
        raise Missing("no motion with a default point and another choice")
    most = max(len(rows) for _, rows in motions)
    figure, axes = panels.grid(-(-len(motions) // 2), 2, 0.7 + 0.13 * most)
    fell = False
    for number, (ax, (name, rows)) in enumerate(zip(axes.flat, motions)):
        panels.letter(ax, number, name)
        fell |= _draw_choices(ax, rows)
    for ax in axes.flat[len(motions) :]:
        ax.set_axis_off()
    default = [
        words.format(DEFAULTS[name])
        for name, words in _WORDS.items()
        if name not in ("cells", "beta_s")
    ]
    walls = " and ".join(points["wall"].unique())
    put_title(
        figure,
        f"Maximum damage index by modelling choice: {walls} wall",
        f"reference solver, {marks.describe_members(points)}; default: {', '.join(default)}",
        marks.scale_note(axes, "x"),
    )
    handles = [
        line_handle(colour, marks.SLIP_LABELS[slip], line="", marker=marker, ms=4)
        for colour, marker, slip in _STYLES.values()
    ]
    if fell:
        words = "fell: beyond the scale of the index"
        handles.append(line_handle(VERMILLION, words, line="", marker="x", ms=5))
    return panels.finish(figure, handles, columns=3)


def choice(point):
    """Text: the differences of a point from the default.

    >>> choice({"cycles": 5, "top": "piers"})
    '5 cycles'
    """
    differs = [
        _WORDS.get(name, f"{name} {{}}").format(point[name])
        for name, usual in DEFAULTS.items()
        if name in point and point[name] == point[name] and point[name] not in (usual, None, "")
    ]
    return ", ".join(differs) or "default"


def _draw_choices(ax, rows):
    """Points of one motion from top to bottom, the default first; returns whether a wall
    collapsed."""
    rows = rows.sort_values("choice", key=lambda names: names != "default", kind="stable")
    fell = (rows["collapsed"] > 0).to_numpy()
    place = np.arange(len(rows))
    for shift, (column, (colour, marker, _)) in zip((-0.15, 0.15), _STYLES.items()):
        value, low, high = (
            rows[name].to_numpy(float) for name in (column, f"{column}_min", f"{column}_max")
        )
        stands = ~fell
        if stands[0]:
            ax.axvline(value[0], color=LIGHT, lw=1.0, zorder=0)
        ax.errorbar(
            value[stands],
            place[stands] + shift,
            xerr=[(value - low)[stands], (high - value)[stands]],
            ls="",
            color=colour,
            marker=marker,
            ms=3.2,
            elinewidth=0.8,
            capsize=1.6,
        )
    ax.plot(
        np.full(fell.sum(), BESIDE),
        place[fell],
        ls="",
        marker="x",
        color=VERMILLION,
        ms=5,
        clip_on=False,
        transform=ax.get_yaxis_transform(),
    )
    ax.set_yticks(place, labels=rows["choice"])
    ax.set_ylim(len(rows) - 0.5, -0.5)
    ax.set_xlim(left=min(0.0, ax.get_xlim()[0]))
    ax.set_xlabel("maximum DI [-]")
    return bool(fell.any())
