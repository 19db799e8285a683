"""Figure of modelling choices: the damage index where a study varies them one at a time."""

import numpy as np
from matplotlib.lines import Line2D

from damage.draw.panels import add_heading, describe_members, finish, grid, letter, motion_label, scale_note, slip_label
from damage.draw.style import BLACK, BLUE, LIGHT, VERMILLION, styled
from damage.motion.loading import Harmonic
from damage.run.settings import RunSettings
from damage.wall.model_options import USUAL_MODEL
from paper.results import REFERENCE, Missing

_WORDS = {"cycles": "{:g} cycles", "contacts": "contacts at {}", "cells": "{:g} contacts a half brick",
          "top": "top mass: {}", "load": "load over the {}", "lintel": "lintel: {}",
          "beta_s": "β = {:g} s"}
DEFAULTS = dict.fromkeys(_WORDS) | USUAL_MODEL | {"cycles": Harmonic.cycles, "beta_s": RunSettings.beta_s}
"""Columns that are varied, and what stands in them where they are not."""
BESIDE = 1.03  # where walls that fell are marked, in shares of a panel's width
_STYLES = {"max_DI": (BLACK, "D", "displacement"), "max_shear_limit_DI": (BLUE, "o", "shear-limit")}


@styled
def choices(points):
    """Maximum DI of the reference solver's points, medians and ranges: a panel for each motion, a line for each choice.

    A panel needs the default point and another one; grey lines show the default values.  Points with a collapsed run
    are marked at the right of the panel, outside the scale of the index.
    """
    points = points[points["solver"] == REFERENCE]
    points = points.assign(choice=points.apply(choice, axis=1))
    motions = [(name, rows) for name, rows in points.groupby(points.apply(motion_label, axis=1), sort=False)
               if len(rows) > 1 and "default" in set(rows["choice"])]
    if not motions:
        raise Missing("no motion with a default point and another choice")
    most = max(len(rows) for _, rows in motions)
    figure, axes = grid(-(-len(motions) // 2), 2, 0.7 + 0.13 * most)
    fell = False
    for number, (ax, (name, rows)) in enumerate(zip(axes.flat, motions)):
        letter(ax, number, name)
        fell |= _draw(ax, rows)
    for ax in axes.flat[len(motions):]:
        ax.set_axis_off()
    default = [words.format(DEFAULTS[name]) for name, words in _WORDS.items() if name not in ("cells", "beta_s")]
    add_heading(figure, f"Maximum damage index by modelling choice: {' and '.join(points['wall'].unique())} wall",
                f"reference solver, {describe_members(points)}; default: {', '.join(default)}",
                scale_note(axes, "x"))
    handles = [Line2D([], [], color=colour, marker=marker, ls="", ms=4, label=slip_label(points, slip))
               for colour, marker, slip in _STYLES.values()]
    if fell:
        handles.append(Line2D([], [], color=VERMILLION, marker="x", ls="", ms=5,
                              label="fell: beyond the scale of the index"))
    return finish(figure, handles, columns=3)


def choice(point):
    """Text: the differences of a point from the default.

    >>> choice({"cycles": 5, "top": "piers"})
    '5 cycles'
    """
    differs = [_WORDS.get(name, f"{name} {{}}").format(point[name]) for name, usual in DEFAULTS.items()
               if name in point and point[name] == point[name] and point[name] not in (usual, None, "")]
    return ", ".join(differs) or "default"


def _draw(ax, rows):
    """Points of one motion from top to bottom, the default first; returns whether a wall collapsed."""
    rows = rows.sort_values("choice", key=lambda names: names != "default", kind="stable")
    fell = (rows["collapsed"] > 0).to_numpy()
    place = np.arange(len(rows))
    for shift, (column, (colour, marker, _)) in zip((-0.15, 0.15), _STYLES.items()):
        value, low, high = (rows[name].to_numpy(float) for name in (column, f"{column}_min", f"{column}_max"))
        stands = ~fell
        if stands[0]:
            ax.axvline(value[0], color=LIGHT, lw=1.0, zorder=0)
        ax.errorbar(value[stands], place[stands] + shift, xerr=[(value - low)[stands], (high - value)[stands]], ls="",
                    color=colour, marker=marker, ms=3.2, elinewidth=0.8, capsize=1.6)
    ax.plot(np.full(fell.sum(), BESIDE), place[fell], ls="", marker="x", color=VERMILLION, ms=5, clip_on=False,
            transform=ax.get_yaxis_transform())
    ax.set_yticks(place, labels=rows["choice"])
    ax.set_ylim(len(rows) - 0.5, -0.5)
    ax.set_xlim(left=min(0.0, ax.get_xlim()[0]))
    ax.set_xlabel("maximum DI [-]")
    return bool(fell.any())
