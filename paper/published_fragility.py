"""Fragility of light damage beside a published one: table and picture of
docs/paper/published-fragility.md.

    ./run_all.sh published --solver reference
    python3 -m paper published_fragility results/published [--out DIR]

Psi over 1 and 2 by PGV: this model's symmetric wall, with stress, period and damping switched in
turn, and the shares of P. A. Korswagen and others (2022).  `--soil` prints, without a study, the
periods that the walls would have on his soil springs.
"""

from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.lines import Line2D
from scipy.sparse.linalg import LinearOperator, eigsh, splu

from damage.applications.studies.fragility import curve, exceeding, fragility, load_runs
from damage.draw.panels import add_heading, finish, grid, letter
from damage.draw.style import (
    BLACK,
    BLUE,
    GREEN,
    MEDIUM,
    ORANGE,
    SKY,
    VERMILLION,
    save_figures,
    styled,
)
from damage.law.modes import mass_vector, natural_modes, stiffness_matrix
from damage.motion.formats import read_record
from damage.motion.intensity import response_spectrum
from damage.wall.file import load_wall
from damage.wall.layout import lay_out
from paper.bench import REPOSITORY, arguments, option, print_row, print_table

MODELS = {
    ("symmetric", False): ("0.6 MPa in the piers, 0.200 s, undamped (default)", BLACK, "-"),
    ("symmetric_light_slow", False): ("0.12 MPa, 0.200 s", BLUE, "--"),
    ("symmetric_fast", False): ("0.6 MPa, 0.111 s", GREEN, "-."),
    ("symmetric", True): ("0.6 MPa, 0.200 s, 2 % damping", ORANGE, (0, (1, 1))),
    ("symmetric_light", False): ("0.12 MPa, 0.094 s", SKY, (0, (6, 1))),
    ("symmetric_light", True): (
        "0.12 MPa, 0.094 s, 2 % damping",
        VERMILLION,
        (0, (4, 1, 1, 1, 1, 1)),
    ),
}
"""(wall, whether it is damped): words, colour, line."""
LEVELS = (1.0, 2.0)
KORSWAGEN_MM_S = np.array([5, 10, 15, 20, 30, 40])
KORSWAGEN = {
    "Korswagen, undamaged": (0.01, 0.06, 0.19, 0.32, 0.48, 0.60),
    "Korswagen, Psi of 0.5 before": (0.06, 0.21, 0.40, 0.52, 0.61, 0.66),
}
"""Shares of his runs that reach Psi of 1, at KORSWAGEN_MM_S."""
KORSWAGEN_2 = (40, 0.06)
"""PGV [mm/s], and the share that reaches Psi of 2 there."""

SOILS_N_M3 = {"peat": (1.21e8, 1.04e8), "sand": (4.36e8, 3.76e8)}
"""Subgrade moduli of his soils, up and along [N/m3]."""
RECORDS = REPOSITORY / "studies/records.csv"
STRIPS_M = (0.3, 0.5)
"""Widths of a foundation strip [m], assumed here."""


def soil_table():
    """Print the table of first periods on a fixed base and on soil springs, and by what the
    records' spectral acceleration there is more, or less."""
    records = [read_record(REPOSITORY / path) for path in pd.read_csv(RECORDS)["record"].unique()]
    columns = [(soil, width) for soil in SOILS_N_M3 for width in STRIPS_M]
    print_table("wall", "fixed base", *(f"{soil}, strip of {width:g} m" for soil, width in columns))
    for name in ("symmetric", "variants/symmetric_light"):
        layout = lay_out(load_wall(REPOSITORY / "walls" / f"{name}.py"))
        periods = [
            natural_modes(layout).period_s[0],
            *(period_on_soil(layout, *SOILS_N_M3[soil], width) for soil, width in columns),
        ]
        spectra = np.array([response_spectrum(record, periods) for record in records])
        ratios = spectra / spectra[:, :1]
        cells = [
            f"{period:.3f} s, {ratio.min():.2f} to {ratio.max():.2f}"
            for period, ratio in zip(periods, ratios.T)
        ]
        print_row(
            MODELS[Path(name).name, False][0].split(",")[0], f"{periods[0]:.3f} s", *cells[1:]
        )


def period_on_soil(layout, up, along, width):
    """First period [s] of an intact wall on a rigid strip without mass, `width` [m] wide, on
    springs `up` and `along` [N/m3]: the flexibility of the strip adds to the wall's."""
    length, bodies = layout.wall.length, layout.bodies
    # of every body, when the strip moves along, up, and turns about its middle
    rigid = np.zeros((len(bodies.x), 3, 3))
    rigid[:, 0, 0] = rigid[:, 1, 1] = rigid[:, 2, 2] = 1.0
    rigid[:, 0, 2], rigid[:, 1, 2] = -bodies.z, bodies.x - length / 2
    rigid = rigid.reshape(-1, 3)
    flexibility = 1 / (width * length * np.array([along, up, up * length**2 / 12]))
    root, solve = np.sqrt(mass_vector(layout)), splu(stiffness_matrix(layout).tocsc()).solve

    def dynamic(vector):
        forces = root * vector.ravel()
        return root * (solve(forces) + rigid @ (flexibility * (rigid.T @ forces)))

    largest = eigsh(
        LinearOperator((len(root),) * 2, matvec=dynamic), k=1, return_eigenvectors=False
    )[0]
    return 2 * np.pi * np.sqrt(largest)


def fits(runs):
    """{(wall, damped): {level: Fragility by PGV}} of the models that have runs."""
    of = dict(list(runs.groupby(["wall", "damped"])))
    return {
        model: {level: fragility(of[model], "max_psi", level, "pgv_m_s") for level in LEVELS}
        for model in MODELS
        if model in of
    }


def table(found):
    """Print the table of the fits; what the runs, or bootstrap samples, do not determine is a
    dash."""
    print_table(
        "model",
        "Psi over",
        "runs",
        "median PGV [mm/s] (90 %, records drawn anew)",
        "dispersion",
        "at 10, 20, 40 mm/s [%]",
    )
    for model, by_level in found.items():
        for level, one in by_level.items():
            low, high = 1e3 * one.median_bounds("records")[:, 0]
            shares = ", ".join(
                f"{100 * share:.0f}" for share in one.probability(np.array([0.01, 0.02, 0.04]))
            )
            cells = (
                MODELS[model][0],
                f"{level:g}",
                f"{one.n_exceeding} of {one.n_runs}",
                f"{1e3 * one.median:.1f} ({low:.1f} to {high:.1f})",
                f"{one.dispersion:.2f}",
                shares,
            )
            print_row(*(cell.replace("nan", "-") for cell in cells))


@styled
def picture(runs, found):
    """A panel a level."""
    figure, axes = grid(1, len(LEVELS), 2.6)
    x = np.linspace(0.5, 80, 200)
    for number, (ax, level) in enumerate(zip(axes[0], LEVELS)):
        for model, by_level in found.items():
            _, colour, line = MODELS[model]
            mine = runs[(runs["wall"] == model[0]) & (runs["damped"] == model[1])]
            shares = (
                exceeding(mine, "max_psi", level).groupby(1e3 * mine["pgv_m_s"].round(6)).mean()
            )
            ax.plot(shares.index, shares, "o", color=colour, ms=2, alpha=0.5)
            if np.isfinite(by_level[level].median):
                ax.plot(
                    x,
                    curve(x, 1e3 * by_level[level].median, by_level[level].dispersion),
                    color=colour,
                    ls=line,
                )
        if level == 1.0:
            for shares, marker in zip(KORSWAGEN.values(), "sD"):
                ax.plot(KORSWAGEN_MM_S, shares, color=MEDIUM, marker=marker, ls=":", ms=4)
        else:
            ax.plot(*KORSWAGEN_2, color=MEDIUM, marker="s", ls="", ms=4)
        letter(ax, number, rf"$\Psi$ > {level:g}")
        ax.set(xlabel="PGV [mm/s]", xlim=(0, x[-1]), ylim=(-0.03, 1.03))
    axes[0, 0].set_ylabel("probability of exceeding")
    add_heading(
        figure,
        "Light damage by PGV, this model and a published one",
        "5 draws of the joints' strengths x 5 records x 4 scales each; dots: shares of the runs at"
        " one PGV",
    )
    handles = [
        Line2D([], [], color=MODELS[model][1], ls=MODELS[model][2], label=MODELS[model][0])
        for model in found
    ]
    handles += [
        Line2D(
            [], [], color=MEDIUM, marker=marker, ls=":", ms=4, label=words.replace("Psi", r"$\Psi$")
        )
        for words, marker in zip(KORSWAGEN, "sD")
    ]
    return finish(figure, handles, columns=2)


def main():
    asked = arguments(
        __doc__,
        option("study", type=Path, nargs="?"),
        option("--out", type=Path),
        option("--soil", action="store_true"),
    )
    if asked.soil:
        soil_table()
    if asked.study is None:
        return
    runs = load_runs(asked.study)
    runs["damped"] = runs["alpha_1_s"].fillna(0) > 0
    found = fits(runs)
    table(found)
    save_figures(
        [("published_fragility", picture(runs, found))],
        asked.out or asked.study / "fragility",
        f"study {asked.study}",
    )
