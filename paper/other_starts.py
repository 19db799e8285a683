"""Three cycles that start and end otherwise than a sine from zero, as records: the rows of
docs/paper/open-points.md.

    python3 -m paper other_starts [--out DIR] [cosine] [ramp] [in-and-out]

Each runs on walls/symmetric.py in the reference solver at the document's four motions; prints rows
in
Markdown, of all motions together, then the last cycle begun in each motion and the first free one.
Histories that are already in DIR are not run again.
"""

from pathlib import Path

import numpy as np
import pandas as pd

from damage.measure.summary import summarise
from paper.bench import Bench, arguments, chosen, option, print_row
from paper.underdetermined import MOTIONS

CYCLES, PER_PERIOD = 3, 400
SHAPES = {
    "cosine": lambda cycle: np.cos(2 * np.pi * cycle),
    "ramp": lambda cycle: np.sin(2 * np.pi * cycle) * np.minimum(cycle, 1),
    "in-and-out": (
        lambda cycle: np.sin(2 * np.pi * cycle) * np.minimum(1, np.minimum(cycle, CYCLES - cycle))
    ),
}
"""Acceleration over its amplitude at a time counted in cycles."""


def run(bench, shape, period_s, amplitude_g):
    """The History of one motion."""
    record = bench.path(shape, period_s, amplitude_g, ending=".csv")
    cycle = np.arange(CYCLES * PER_PERIOD + 1) / PER_PERIOD
    pd.DataFrame(
        {"time_s": np.round(cycle * period_s, 7), "acc_g": amplitude_g * SHAPES[shape](cycle)}
    ).to_csv(record, index=False)
    return bench.run("symmetric", ["--record", record, "--rest", "1"], shape)


def main():
    asked = arguments(
        __doc__,
        option(
            "shapes", nargs="*", metavar="SHAPE", help=f"of {', '.join(SHAPES)}; by default all"
        ),
        option("--out", type=Path, default=Path("results/other_starts"), metavar="DIR"),
    )
    bench = Bench(asked.out)
    for shape in chosen(asked.shapes, SHAPES, "shape"):
        found = [summarise(run(bench, shape, *motion)) for motion in MOTIONS]
        cycles = [
            ", ".join(
                "-" if one[name] is None else f"{one[name]:.3f}"
                for name in ("last_cycle_s", "first_free_cycle_s")
            )
            for one in found
        ]
        cycles[0] = f"last and first free cycle [s]: {cycles[0]}"
        print_row(
            shape,
            *(f"{one['max']['DI']:.3f} / {one['max_shear_limit']['DI']:.3f}" for one in found),
            *cycles,
        )
