"""Fragility by the damage before an event: each event of a sequence as a run of its own
(`python3 -m paper shocks`).

A wall enters its second event with the cracks of the first, which Psi counts, so events are
classified by Psi at rest before them, as in P. A. Korswagen's curves for walls with damage
(docs/paper/published-fragility.md).
"""

from itertools import cycle

import numpy as np
import pandas as pd
from matplotlib.lines import Line2D

from damage.applications.studies.fragility import REPLICATES, curve, exceeding, fragility
from damage.applications.studies.fragility_picture import (
    STYLES,
    draw_shares,
    few_note,
    fit_handles,
    records_named,
)
from damage.applications.studies.read import read_table
from damage.applications.studies.states import (
    INTENSITIES,
    LEVELS,
    STATES,
    State,
    check_states,
    in_picture,
    in_unit,
    label,
    unit_of,
)
from damage.draw.panels import add_heading, finish, grid, letter
from damage.draw.style import styled
from damage.errors import InputError

BEFORE = {
    "undamaged": (0.0, 0.25),
    "Psi about 0.5": (0.25, 0.75),
    "Psi about 1": (0.75, 1.25),
    "Psi about 1.5": (1.25, 1.75),
}
"""Words for Psi at rest before a shock: from, up to [-]; a single crack of 0.02 mm is 0.62."""
LEAST_SHOCKS = 20
"""Fewer of a class of damage before are not fitted."""
PSI = tuple(State("max_psi", level) for level in LEVELS["max_psi"])
"""The states that a figure shows by default."""
_SQUARED = ("arias_m_s",)
"""Intensities that go with the square of the motion."""


def load_shocks(runs, folder, states=STATES):
    """Rows like those of summary.csv for each event of runs, with `shock`, `psi_before` [-] and its
    class `before`, one of BEFORE, else "more".

    Measures are those within the event.  Intensities are those of the run, which belong to its
    strongest event, scaled by the factors.  Events that several runs share, such as equal first
    ones, count once.
    folder: that of the study, with tables/shocks.csv; states: State of each measure, a column
    there.  Raises InputError where there is no sequence, or events of a run or a measure are
    missing.
    """
    path, rows, known = folder / "tables" / "shocks.csv", [], set()
    if not path.is_file():
        raise InputError(
            f"{folder} holds no tables/shocks.csv; expected a study of sequences, as "
            "studies/aftershocks.toml, summed up by this version: run ./run_all.sh again"
        )
    measures = list(dict.fromkeys(state.measure for state in states))
    shocks = read_table(path, ("run", "shock", "factor", "end_s", "residual_psi"))
    # a wall that fell lacks its last shocks
    check_states(shocks.assign(collapsed_at_s=0.0), states, "shocks.csv")
    by_run = dict(list(shocks.groupby("run")))
    for _, run in runs[runs["shocks"] > 1].iterrows():
        if run["run"] not in by_run:
            raise InputError(
                f"{path} lacks the shocks of {run['run']}; expected those of every run, run "
                "./run_all.sh again"
            )
        table = by_run[run["run"]]
        strongest = table["factor"].abs().max()
        before = table["residual_psi"].shift(1, fill_value=0.0)
        for (_, shock), psi in zip(table.iterrows(), before):
            factor = abs(shock["factor"]) / strongest
            so_far = table["factor"][table["shock"] <= shock["shock"]] * (run["pga_g"] / strongest)
            story = (
                run["wall"],
                str(run["record"]),
                run["strength_seed"],
                *so_far.round(9),
                *shock[measures],
            )
            if story in known:
                continue
            known.add(story)
            fell = run["collapsed_at_s"] <= shock["end_s"] + 1e-9
            rows.append(
                run.to_dict()
                | {
                    name: run[name] * factor ** (2 if name in _SQUARED else 1)
                    for name in INTENSITIES
                    if name in run
                }
                | {name: shock[name] for name in measures}
                | {
                    "shock": int(shock["shock"]),
                    "psi_before": psi,
                    "before": _class(psi),
                    "collapsed_at_s": run["collapsed_at_s"] if fell else None,
                }
            )
    if not rows:
        raise InputError(
            f"{folder} holds no run of several shocks; expected a study of sequences, as "
            "studies/aftershocks.toml"
        )
    return pd.DataFrame(rows)


def _class(psi):
    return next((words for words, (low, high) in BEFORE.items() if low <= psi < high), "more")


def table_after_damage(shocks, intensity, states=STATES, replicates=REPLICATES):
    """A DataFrame with a row for each wall, class of the damage before and State: fits of
    `fragility`.

    intensity: a name of INTENSITIES.  Raises InputError where no class has enough events."""
    if intensity not in INTENSITIES or shocks[intensity].isna().any():
        raise InputError(
            f"--intensity {intensity}: expected one of {', '.join(INTENSITIES)} that"
            " every run has, as how it follows a shock's factor must be known; choose one"
        )
    rows = []
    for (wall, before), of_class in shocks.groupby(["wall", "before"], sort=False):
        if len(of_class) < LEAST_SHOCKS:
            continue
        for state in states:
            one = fragility(
                of_class, state.measure, state.level, intensity, replicates, name=state.name
            )
            rows.append({"wall": wall, "before": before, "intensity": intensity, **one.row()})
    if not rows:
        raise InputError(
            f"{len(shocks)} shocks; expected {LEAST_SHOCKS} or more of one class of damage before;"
            " run more of them"
        )
    table = pd.DataFrame(rows)
    order = {words: place for place, words in enumerate([*BEFORE, "more"])}
    return table.sort_values(
        "before", key=lambda column: column.map(order), kind="stable", ignore_index=True
    )


@styled
def picture_after_damage(wall, shocks, table, intensity, states=PSI):
    """A panel for each State, a curve for each class of the damage before; shocks, table: of one
    wall, of `damage.applications.studies.after_damage`."""
    figure, axes = grid(1, len(states), 3.0)
    x = np.linspace(0.005, 1.08, 200) * shocks[intensity].max()
    for number, (ax, state) in enumerate(zip(axes[0], states)):
        rows = table[table["state"] == state.words]
        handles = [
            _draw_after(ax, x, shocks, row, style, intensity)
            for (_, row), style in zip(rows.iterrows(), cycle(STYLES))
        ]
        ax.legend(
            handles=handles, loc="lower left", bbox_to_anchor=(0, 1.1), ncols=1, borderaxespad=0
        )
        words, unit = in_picture(state.measure)
        words = words.removeprefix("maximum ") if state.measure in LEVELS else words
        letter(ax, number, state.name or f"{words} > {state.level:g} {unit.strip('-')}")
        ax.set(xlabel=label(intensity), xlim=(0, x[-1]), ylim=(-0.03, 1.03))
    axes[0, 0].set_ylabel("probability of exceeding")
    records = shocks["record"].dropna().unique()
    add_heading(
        figure,
        f"{wall} wall, {len(shocks)} shocks, by the damage before",
        records_named(records),
        few_note(len(records)),
    )
    return finish(
        figure,
        fit_handles("lognormal fit", "shocks"),
        columns=2,
    )


def _draw_after(ax, x, shocks, row, style, intensity):
    """Shares and curve of one class of the damage before; returns the legend's entry."""
    colour, marker, line = style
    mine, median = shocks[shocks["before"] == row["before"]], row[in_unit("median", intensity)]
    draw_shares(ax, exceeding(mine, row["measure"], row["level"]), mine[intensity].round(6), style)
    text = f"{row['before']}: no curve, {row['exceeding']} of {row['runs']} shocks exceed it"
    if np.isfinite(median):
        ax.plot(x, curve(x, median, row["dispersion"]), color=colour, ls=line)
        unit = unit_of(intensity)[1]
        low, high = (row[in_unit(f"median_walls_{end}", intensity)] for end in ("low", "high"))
        text = f"{row['before']}: " + (
            f"median {median:#.3g} {unit}, dispersion {row['dispersion']:.2f}"
            if row["dispersion"] > 0
            else f"between {low:#.3g} and {high:#.3g} {unit}"
        )
    return Line2D(
        [], [], color=colour, marker=marker, ls=line, ms=3, label=text.replace("Psi", r"$\Psi$")
    )
