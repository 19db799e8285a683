"""The tables of docs/paper/open-points.md, in Markdown, from two studies and one that this script
writes.

    python3 -m paper underdetermined --write DIR  # DIR/more.toml: bricks, openings, members at the
                                                  # edge
    ./run_all.sh DIR/more.toml --solver reference --out DIR/more
    python3 -m paper underdetermined results/underdetermined results/sensitivity DIR/more

Maximum DI is by displacement / by the shear limit; in brackets the range over members, which rest 2
s in the second.
"""

import sys
from pathlib import Path

import numpy as np
import pandas as pd

from paper.bench import REPOSITORY, arguments, option, print_row

MOTIONS = ((0.33, 0.1), (0.2, 0.05), (0.2, 0.1), (1.0, 0.1))
"""Period [s] and amplitude [g] of each column."""
USUAL = {
    "contacts": "interior",
    "top": "piers",
    "load": "length",
    "cells": 2,
    "lintel": "elastic",
    "cycles": 3,
    "strength_cov": 0,
    "alpha_1_s": 0,
    "beta_s": 0,
}
CORNERS, SPREAD = {"contacts": "corners"}, {"top": "uniform"}
CHOICES = (
    {},
    CORNERS,
    {"cells": 4},
    SPREAD,
    CORNERS | SPREAD,
    {"top": "beam"},
    {"lintel": "none"},
    {"cycles": 1},
    {"cycles": 2},
    {"cycles": 5},
    {"cycles": 10},
    {"strength_cov": 0.3},
    {"beta_s": 1e-6},
    {"beta_s": 1e-5},
    *({"alpha_1_s": 61.3 * ratio, "beta_s": 1.553e-3 * ratio} for ratio in (0.02, 0.05)),
)
BOTH = ("max_DI", "max_shear_limit_DI")
PARTS = (
    ("last_cycle_s", "first_free_cycle_s"),
    ("max_DI_open",),
    ("max_DI_slip", "max_shear_limit_DI_slip"),
    ("residual_DI", "residual_shear_limit_DI"),
    ("residual_DI_drift",),
)
GRID = """
[[grid]]
wall = "{}"
options = {{ harmonic = "{{motion}}", rest = 1, {} }}
solvers = ["reference"]
members = 5
vary = {{ motion = {} }}
"""


def chosen(table, period_s, amplitude_g, choice):
    """The points of a motion that differ from the usual ones by a choice alone."""
    for column, value in (
        {"motion_period_s": period_s, "amplitude_g": amplitude_g} | USUAL | choice
    ).items():
        values = table[column]
        table = table[
            (
                values == value
                if isinstance(value, str)
                else np.isclose(values, value, rtol=1e-3, atol=1e-10)
            )
        ]
    return table


def span(low, high):
    """A number, or two where three decimals distinguish them."""
    return f"{low:.3f}" if f"{low:.3f}" == f"{high:.3f}" else f"{low:.3f}-{high:.3f}"


def cell(found, members, columns):
    """Medians, of several points from least to most; in brackets the range over members, if there
    are some."""
    if found.empty or found["collapsed"].any():
        return "not run" if found.empty else f"fell at {found['collapsed_at_s'].min():.2f} s"
    text = " / ".join(span(found[column].min(), found[column].max()) for column in columns)
    ranges = " / ".join(
        span(members[f"{column}_min"].min(), members[f"{column}_max"].max()) for column in columns
    )
    return f"{text} ({ranges})" if members["members"].max() > 1 else text


def rows(single, many):
    """The page's first table; then amplitudes at 0.33 s, at 1 s with the mass spread, and the
    amplitudes at 0.2 s."""

    def cells(motion, choice, columns):
        return cell(*(chosen(table, *motion, choice) for table in (single, many)), columns)

    for choice in CHOICES:
        t0_s = chosen(single, *MOTIONS[0], choice)["eigen_period_s"].iloc[0]
        yield [choice, f"{t0_s:.3f}", *(cells(motion, choice, BOTH) for motion in MOTIONS)]
    for g in (0.01, 0.025, 0.05, 0.075, 0.08, 0.085, 0.09, 0.095, 0.1):
        yield [
            f"0.33 s, {g} g",
            cells((0.33, g), {}, BOTH),
            f"1 s, {SPREAD}",
            cells((1.0, g), SPREAD, BOTH),
        ]
    for choice in ({}, {"cycles": 2}, CORNERS, CORNERS | {"cycles": 2}):
        for parts in PARTS:
            yield [
                "0.2 s",
                choice,
                parts,
                *(cells((0.2, g), choice, parts) for g in (0.01, 0.025, 0.05, 0.075, 0.1)),
            ]


def by_cycle(study):
    """Maximum DI in each cycle of the motion, medians of a point's members."""
    driven = pd.read_csv(study / "tables/cycles.csv").query("kind == 'driven'")
    for run, members in driven.groupby(
        driven["run"].str.replace(r"_s\d+$", "", regex=True), sort=False
    ):
        medians = members.groupby("cycle")[[*BOTH]].median()
        yield [run, *(", ".join(f"{di:.3f}" for di in medians[column]) for column in BOTH)]


def write_study(folder):
    """The wall files and the study of what the other two lack."""
    folder.mkdir(parents=True, exist_ok=True)
    text, edge = (
        (REPOSITORY / "walls/symmetric.py").read_text(),
        [[0.33, g] for g in (0.075, 0.08, 0.085, 0.09, 0.095)],
    )
    grids = [
        'name = "more"\npictures = "none"\n',
        GRID.format("walls/symmetric.py", 'top = "piers"', edge),
        GRID.format("walls/symmetric.py", "cycles = 2, lintel = 2", [[0.2, 0.1]]),
    ]
    for e_gpa in (4.4, 4.8, 5.2, 5.6, 6.2, 7.0):
        (folder / f"e_{e_gpa}.py").write_text(
            text.replace(
                "0.1025)", f"0.1025, young_modulus={e_gpa}e9, shear_modulus={e_gpa * 2.16 / 5.2}e9)"
            )
        )
        grids += [
            GRID.format(f"e_{e_gpa}.py", f'contacts = "{contacts}"', [[0.33, 0.1]])
            for contacts in ("interior", "corners")
            if contacts == "interior" or e_gpa >= 5.2
        ]
    for left in (2.5, 3.5):
        (folder / f"left_{left}.py").write_text(text.replace("left=4.5", f"left={left}"))
        grids.append(
            GRID.format(
                f"left_{left}.py", 'top = "piers"', [list(motion) for motion in MOTIONS[:3]]
            )
        )
    (folder / "more.toml").write_text("".join(grids))


def main():
    asked = arguments(
        __doc__,
        option(
            "studies",
            nargs="*",
            type=Path,
            metavar="STUDY_DIR",
            help="underdetermined sensitivity more",
        ),
        option(
            "--write", type=Path, metavar="DIR", help="write more.toml and its wall files there"
        ),
    )
    if bool(asked.write) == (len(asked.studies) == 3):
        sys.exit("error: expected the folders of three studies, or --write DIR")
    if asked.write:
        write_study(asked.write)
        return
    single, many, more = (pd.read_csv(study / "tables/points.csv") for study in asked.studies)
    walls = (
        [
            name,
            f"{point['eigen_period_s'].iloc[0]:.3f}",
            *(cell(point, point, parts) for parts in (BOTH, *PARTS)),
        ]
        for name, point in more.groupby("point", sort=False)
    )
    for row in (
        *rows(single, many),
        *walls,
        *by_cycle(asked.studies[0]),
        *by_cycle(asked.studies[2]),
    ):
        print_row(*row)
