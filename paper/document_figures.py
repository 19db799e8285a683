"""Figures of six documents, drawn from docs/tables.

    python3 -m paper document_figures [FOLDER]      # by default docs/pictures

writes thirty_years.png (docs/paper/thirty-years.md), settled_walls.png
(docs/paper/settled-walls.md), after_the_peak.png (docs/validation/after-the-peak.md),
shaken_walls.png (docs/validation/shaken-walls.md), claim_calibration.png (docs/paper/claims.md) and
model_contact_points.png (docs/model/model.md).
"""

from pathlib import Path

import numpy as np
import pandas as pd

from damage.draw.panels import finish, grid, letter
from damage.draw.style import (
    BLACK,
    BLUE,
    BRICK_COLOUR,
    DARK,
    GREEN,
    LIGHT,
    MEDIUM,
    ORANGE,
    SKY,
    VERMILLION,
    put_title,
    save_picture,
    styled,
)
from paper.bench import REPOSITORY, arguments, option
from paper.thirty_years import ADDRESSES, LIVES, WALLS, read_lives

TABLES = REPOSITORY / "docs" / "tables"
WIDTH = 150 / 25.4  # [inch], of a page of text


def panels(height, *titles, **options):
    """Returns a figure and its panels, one beside the other, each with a title."""
    figure, axes = grid(1, len(titles), height, WIDTH, **options)
    for number, (ax, title) in enumerate(zip(axes.flat, titles)):
        letter(ax, number, title)
    return figure, list(axes.flat)


def finished(figure, columns, *heading):
    """Adds a heading, and a legend of what is drawn with a label; returns the figure."""
    put_title(figure, *heading)
    labelled = {}
    for ax in figure.axes:
        for handle, label in zip(*ax.get_legend_handles_labels()):
            labelled.setdefault(label, handle)
    return finish(figure, list(labelled.values()), columns)


def name_rows(ax, names):
    """Labels the rows of a panel, the first one above."""
    ax.set_yticks(range(len(names)), labels=names)
    ax.set_ylim(len(names) - 0.5, -0.5)


def marks(ax, x, y, label, marker, color, **more):
    """Draws marks without a line between them; those that are not hollow are filled."""
    ax.plot(x, y, ls="", label=label, marker=marker, color=color, **{"ms": 4, "zorder": 5, **more})


@styled
def thirty_years():
    """Draws P(Psi >= 1) after the last earthquake by wall, joints and ground before: a panel an
    address."""
    final, lives = read_lives(LIVES)
    largest = lives.drop_duplicates(["point", "seed", "life"]).groupby("point")["largest_mm_s"]
    speeds = largest.median()[[f"{WALLS['symmetric, softening']}_{name}" for name in ADDRESSES]]
    titles = [f"{name.capitalize()}, {speed:.0f} mm/s" for name, speed in zip(ADDRESSES, speeds)]
    figure, axes = panels(2.1, *titles, sharey=True)
    looks = (
        ("", "o", BLUE, -0.18, "ground at rest before the first earthquake"),
        ("_settled", "s", ORANGE, 0.18, "ground settled before it (hogging by 1/4000)"),
    )
    for ax, address in zip(axes, ADDRESSES):
        for ending, marker, color, shift, label in looks:
            rows = final.loc[[f"{wall}_{address}{ending}" for wall in WALLS.values()]]
            p, low, high = 100 * rows[["p_psi_1", "p_psi_1_low", "p_psi_1_high"]].to_numpy().T
            ax.errorbar(
                p,
                np.arange(len(WALLS)) + shift,
                xerr=[p - low, high - p],
                ls="",
                marker=marker,
                color=color,
                label=label,
                ms=4,
                capsize=2,
                clip_on=False,
            )
        ax.set_xlim(0, 100)
    name_rows(axes[0], [f"{wall} joints" for wall in WALLS])
    axes[1].set_xlabel("walls that end with visible cracks (Ψ ≥ 1) [%], 95 % interval")
    return finished(
        figure,
        2,
        "Visible cracks after thirty years of earthquakes, 1991 to 2022, by wall and address",
        f"{final['lives'].max()} draws of motions and joint strengths a point; mm/s: largest"
        " peak ground velocity, median of the draws",
    )


@styled
def settled_walls():
    """Draws Psi after an earthquake of 10 mm/s over Psi before, of every run."""
    runs = pd.read_csv(TABLES / "cracks_before.csv")
    figure, axes = grid(1, 1, 2.4, WIDTH)
    ax = axes[0, 0]
    spread = np.random.default_rng(1).uniform(-0.04, 0.04, len(runs)) * (runs["psi_0"] == 0)
    for name, marker, color, shift, label in (
        ("undisturbed", "D", BLACK, -0.05, "ground at rest"),
        ("invisible", "o", BLUE, 0.05, "ground hogged by 1/5000"),
        ("about 0.5", "^", GREEN, 0.0, "ground hogged by about 1/4000"),
        ("about 1", "s", ORANGE, 0.0, "ground hogged by 1/3700 to 1/2400"),
    ):
        rows = runs[runs["class"] == name]
        place = rows["psi_0"] + spread[rows.index] + shift
        marks(ax, place, rows["psi_end"], label, marker, color, ms=2.5, mew=0, clip_on=False)
    ax.axhline(1.0, color=VERMILLION, ls="--", label="visible cracks: Ψ ≥ 1")
    ax.plot([0, 1.25], [0, 1.25], color=DARK, label="the earthquake adds nothing")
    ax.set(xlabel="Ψ before the earthquake [-], from 0 spread sideways", xlim=(-0.12, 1.25))
    ax.set(ylabel="Ψ after the earthquake [-]", ylim=(0, 1.35))
    return finished(
        figure,
        3,
        "What an earthquake of 10 mm/s adds to the cracks of a settled wall",
        f"{len(runs)} runs of the symmetric wall with softening joints; Ψ before: left by"
        " settlement of the ground",
    )


@styled
def after_the_peak():
    """Draws force and ultimate drift of the prediction over those of the test, by wall: a panel a
    quantity."""
    rows = predicted()
    walls = rows.drop_duplicates("wall")
    place = rows["wall"].map(dict(zip(walls["wall"], range(len(walls)))))
    names = walls["wall"].str.removeprefix("ABRAMS_") + ", " + walls["test (failure (on stairs))"]
    figure, axes = panels(2.6, "peak force", "bilinear force", "ultimate drift", sharey=True)
    forces = {"xlim": (0.6, 1.8), "xticks": (0.75, 1, 1.5)}
    drifts = {"xlim": (0.11, 8), "xticks": (0.25, 1, 4)}
    for ax, (column, test, scale) in zip(
        axes,
        (
            ("peak [kN]", "test", forces),
            ("bilinear [kN]", "test (bilinear [kN])", forces),
            ("ultimate drift [%]", "test (ultimate drift [%])", drifts),
        ),
    ):
        more = rows[column].str.startswith("over ")
        ratio = rows[column].str.removeprefix("over ").astype(float) / rows[test].astype(float)
        for which, label, marker, color, face, shift in (
            (
                ~rows["cycled"] & ~more,
                "pushed, two draws of the strengths",
                "o",
                BLUE,
                "none",
                -0.14,
            ),
            (rows["cycled"] & ~more, "cycles, one draw", "s", ORANGE, ORANGE, 0.14),
            (more, "pushed, force still over 0.8 of the peak", ">", BLUE, "none", -0.14),
        ):
            marks(ax, ratio[which], place[which] + shift, label, marker, color, mfc=face)
        ax.axvspan(1 / 1.15, 1.15, color=LIGHT, lw=0)
        ax.axvline(1.0, color=DARK, lw=0.8)
        for last in np.flatnonzero(np.diff(walls["group"])):
            ax.axhline(last + 0.5, color=LIGHT)
        ax.set(xscale="log", **scale, xticklabels=map(str, scale["xticks"]))
        ax.minorticks_off()
    name_rows(axes[0], names)
    axes[1].set_xlabel("prediction over test [-]; grey: within 15 %")
    return finished(
        figure,
        2,
        "Prediction over test for twelve walls, each with its failure in the test",
        "above: EUCENTRE's walls, first the four known when options were chosen; below: other"
        " laboratories'",
    )


def predicted():
    """Reads the tables of the prediction: a row a wall and run, whether it was cycled, and the
    group of the wall."""
    tables = []
    for group, name in enumerate(("", "_cycles", "_unseen", "_elsewhere")):
        table = pd.read_csv(TABLES / "benchmarks" / f"after_peak{name}.csv", dtype=str)
        cycled = table["law"].eq("cycles") | (name == "_cycles")
        table = table.assign(group=max(0, group - 1), cycled=cycled)
        tables.append(table[table["law"] != "rule"])
    return pd.concat(tables, ignore_index=True)


@styled
def shaken_walls():
    """Draws peaks of the wall US-1 by run: of the test and with both bearings."""
    runs = pd.read_csv(TABLES / "benchmarks" / "us1_heights.csv")
    figure, axes = grid(1, 1, 2.0, WIDTH)
    ax = axes[0, 0]
    for name, label, marker, color, face in (
        ("tested", "test", "o", ORANGE, ORANGE),
        ("first", "first bearing", "x", SKY, SKY),
        ("later", "later bearing", "s", BLUE, "none"),
    ):
        marks(ax, runs["run"], runs[f"{name}_peak_mm_2060"], label, marker, color, mfc=face)
    ax.set(yscale="log", xlabel="run", ylabel="largest displacement [mm]", ylim=(0.1, 60))
    return finished(figure, 3, "The wall US-1 on a shaking table at 2.06 m, beside the test")


LENGTH = 0.225
HEIGHT = 0.075
"""Height of a brick in the figure of contact points, with its half joints [m]; places there are
complex numbers, x + i z."""


@styled
def claim_calibration():
    """Draws how often "not without the earthquakes" is true over how often it is stated, by
    wall."""
    rows = pd.read_csv(TABLES / "benchmarks" / "claim_calibration.csv")
    figure, axes = grid(1, 1, 2.4, WIDTH)
    ax = axes[0, 0]
    looks = zip("os^Dv", (BLUE, ORANGE, GREEN, SKY, VERMILLION))
    for (wall, points), (marker, color) in zip(rows.groupby("wall", sort=False), looks):
        marks(ax, points["mean stated"], points["true of 100"], wall, marker, color, clip_on=False)
    ax.plot([0, 100], [0, 100], color=DARK, label="as stated")
    ax.set(xlabel="stated of 100: not without the earthquakes", xlim=(0, 100))
    ax.set(ylabel="true of 100", ylim=(0, 100))
    return finished(
        figure,
        3,
        "How often a statement of the sheet is true",
        "claims of known truth, in five classes of what is stated; assumed probability of"
        " settlement 0.5",
    )


def brick(ax, name, centre, turned=0.0):
    """Draws a brick, turned about its centre [rad], and its name."""
    half = (LENGTH + 1j * HEIGHT) / 2
    corners = np.array([half, -np.conj(half), -half, np.conj(half)])
    corners = centre + corners * np.exp(1j * turned)
    ax.fill(corners.real, corners.imag, fc=BRICK_COLOUR, ec=MEDIUM, lw=0.8)
    ax.plot(centre.real, centre.imag, marker="+", color=BLACK)
    ax.text(centre.real, centre.imag - 0.022, f"${name}$", ha="center")


def arrow(ax, start, end, colour, text, place):
    """Draws an arrow, and a text that begins at a place."""
    style = {"arrowstyle": "-|>", "color": colour, "shrinkA": 0, "shrinkB": 0}
    ax.annotate("", (end.real, end.imag), (start.real, start.imag), arrowprops=style)
    ax.text(place.real, place.imag, text, color=colour)


@styled
def model_contact_points():
    """Draws contact points of three bricks of two courses, and opening and shear displacement of
    one of them."""
    figure, (left, right) = panels(
        1.6,
        "at rest: contact points of bricks a, b, c",
        "b moved: displacements of one point",
        width_ratios=(0.47, 0.395),
    )
    a = (LENGTH + 1j * HEIGHT) / 2
    b = LENGTH + 1.5j * HEIGHT
    head = LENGTH + 0.5j * HEIGHT
    points = LENGTH * np.array([0.625, 0.875, 1.125, 1.375]) + 1j * HEIGHT
    point = points[0]
    for name, centre in (("a", a), ("b", b), ("c", a + LENGTH)):
        brick(left, name, centre)
    left.hlines(HEIGHT, LENGTH / 2, 0.75 * LENGTH, SKY, lw=4)
    left.text(-0.03, 0.105, "tributary length", color=BLUE)
    arrow(left, b, point, BLUE, "$r_b$", 0.175 + 0.107j)
    arrow(left, points[3], points[3] + 0.035j, VERMILLION, "bed joint: $n$", 0.32 + 0.102j)
    arrow(left, head, head + 0.035, VERMILLION, "head joint: $n$", 0.25 + 0.052j)
    marks(left, points.real, points.imag, "", "o", BLACK, mfc="white")
    marks(left, [head.real], [head.imag], "", "o", BLACK, mfc="white")

    turn = np.exp(1j * np.radians(12.0))
    moved = b + 0.03 + 0.05j
    brick(right, "a", a)
    brick(right, "b", moved, np.angle(turn))
    end = moved + (point - b) * turn
    along = np.sqrt(turn)  # the joint turns by the mean of its bricks
    sheared = point + ((end - point) / along).real * along
    for axis in (along, 1j * along):
        line = point + np.array([-0.02, 0.085]) * axis
        right.plot(line.real, line.imag, color=MEDIUM, lw=0.7, ls="--")
    arrow(right, moved, end, BLUE, "$r_b$", 0.21 + 0.15j)
    arrow(right, point, sheared, VERMILLION, "$u_s$", 0.158 + 0.058j)
    arrow(right, sheared, end, VERMILLION, "$u_n$", 0.192 + 0.09j)
    marks(right, [point.real, end.real], [point.imag, end.imag], "", "o", BLACK, mfc="white")
    for ax, width in ((left, 0.465), (right, 0.39)):
        arrow(ax, a, point, BLUE, "$r_a$", 0.103 + 0.063j)
        ax.set(aspect="equal", xlim=(-0.035, width), ylim=(-0.005, 0.24))
        ax.set_axis_off()
    return figure


FIGURES = (
    thirty_years,
    settled_walls,
    after_the_peak,
    shaken_walls,
    claim_calibration,
    model_contact_points,
)


def main():
    folder = arguments(
        __doc__, option("folder", nargs="?", type=Path, default=REPOSITORY / "docs" / "pictures")
    ).folder
    for draw in FIGURES:
        print(save_picture(draw(), folder / f"{draw.__name__}.png", "paper/document_figures.py"))
