"""Psi after N equal events over that of one, beside the figures of Korswagen's finite-element runs.

    python3 -m paper repetitions shocks.csv     # tables/shocks.csv of the study repetitions

A pair is a wall and a motion in which one event leaves Psi > 0.  Psi at rest is that of the last
sample of an event's settling stage, max_psi the largest so far.
"""

from pathlib import Path

import numpy as np
import pandas as pd

from damage.errors import InputError
from paper.bench import arguments, option, show

PUBLISHED = {2: "1.01 to 1.03", 8: "1.03 to 1.08"}
"""Medians by class of Psi before (P. A. Korswagen, dissertation, TU Delft, 2024)."""


def pairs(shocks, count, psi="residual_psi"):
    """(Psi after one event, Psi after `count`) (n, 2) of the runs in which one event gives Psi > 0.

    shocks: rows of shocks.csv with columns run, shock and psi; of max_psi the largest so far
    counts.

    >>> rows = [("a", 1, 0.5), ("a", 2, 0.6), ("b", 1, 0.0), ("b", 2, 0.7), ("c", 1, 1.0)]
    >>> pairs(pd.DataFrame(rows, columns=["run", "shock", "residual_psi"]), 2)
    array([[0.5, 0.6]])
    """
    by_run = shocks.pivot_table(index="run", columns="shock", values=psi)
    if psi.startswith("max"):
        by_run = by_run.cummax(axis=1, skipna=False)
    if count not in by_run:
        raise InputError(f"no run of {count} events: expected shocks.csv of the study repetitions")
    both = by_run[[1, count]].dropna()
    return both[both[1] > 0].to_numpy()


def table(shocks):
    """A row for each number of events and kind of Psi: pairs, median and 90th percentile of the
    ratio, and the share of walls in which Psi decreased."""
    rows = []
    for psi, words in (("residual_psi", "at rest"), ("max_psi", "largest so far")):
        for count, published in PUBLISHED.items():
            if count not in set(shocks["shock"]) or not len(found := pairs(shocks, count, psi)):
                continue
            first, last = found.T
            ratio = last / first
            rows.append(
                {
                    "events": count,
                    "Psi": words,
                    "pairs": len(ratio),
                    "median": np.median(ratio),
                    "90th percentile": np.quantile(ratio, 0.9),
                    "share that decreases": np.mean(ratio < 1),
                    "published medians": published,
                }
            )
    return pd.DataFrame(rows)


def main():
    found = table(pd.read_csv(arguments(__doc__, option("shocks", type=Path)).shocks))
    show(
        found,
        (
            (f"{value:.3g}" if isinstance(value, float) else value for value in row)
            for row in found.itertuples(index=False)
        ),
    )
