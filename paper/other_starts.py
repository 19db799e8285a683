"""Three cycles that start and end otherwise than a sine from zero, as records: the rows of docs/paper/open-points.md.

    python3 paper/other_starts.py [--out DIR] [--motion PERIOD_S AMPLITUDE_G ...] [cosine] [ramp] [in-and-out]

Each runs on walls/symmetric.py in the reference solver, by default at the document's four motions; prints rows in
Markdown, of all motions together, then the last cycle begun in each motion and the first free one.
Histories that are already in DIR are not run again.
"""

import argparse
import sys
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(REPOSITORY))

import numpy as np
import pandas as pd

from damage import read_history
from damage.measure.summary import summarise
from damage.reference.session import run_reference

CYCLES, PER_PERIOD = 3, 400
MOTIONS = ((0.33, 0.1), (0.2, 0.05), (0.2, 0.1), (1.0, 0.1))
"""Period [s] and amplitude [g] of each column."""
SHAPES = {
    "cosine": lambda cycle: np.cos(2 * np.pi * cycle),
    "ramp": lambda cycle: np.sin(2 * np.pi * cycle) * np.minimum(cycle, 1),
    "in-and-out": lambda cycle: np.sin(2 * np.pi * cycle) * np.minimum(1, np.minimum(cycle, CYCLES - cycle)),
}
"""Acceleration over its amplitude at a time counted in cycles."""


def run(shape, period_s, amplitude_g, folder):
    """The History of one motion, from `folder` if it is there."""
    name = f"{shape}_{period_s:g}s_{amplitude_g:g}g"
    record, history = folder / f"{name}.csv", folder / f"{name}.h5"
    if not history.exists():
        cycle = np.arange(CYCLES * PER_PERIOD + 1) / PER_PERIOD
        pd.DataFrame({"time_s": np.round(cycle * period_s, 7), "acc_g": amplitude_g * SHAPES[shape](cycle)}).to_csv(
            record, index=False)
        run_reference([str(REPOSITORY / "walls" / "symmetric.py"), "--record", str(record), "--rest", "1",
                       "--out", str(history), "--no-pictures"])
    return read_history(history)


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("shapes", nargs="*", metavar="SHAPE", help=f"of {', '.join(SHAPES)}; by default all")
    parser.add_argument("--motion", nargs=2, type=float, action="append", metavar=("PERIOD_S", "AMPLITUDE_G"),
                        help="instead of the four; can be given again")
    parser.add_argument("--out", type=Path, default=Path("results/other_starts"), metavar="DIR")
    asked = parser.parse_args(arguments)
    if set(asked.shapes) - set(SHAPES):
        parser.error(f"shapes {' '.join(asked.shapes)}: expected some of {', '.join(SHAPES)}")
    asked.out.mkdir(parents=True, exist_ok=True)
    for shape in asked.shapes or SHAPES:
        cells, cycles = [], []
        for motion in asked.motion or MOTIONS:
            found = summarise(run(shape, *motion, asked.out))
            cells.append(f"{found['max']['DI']:.3f} / {found['max_shear_limit']['DI']:.3f}")
            cycles.append(", ".join("-" if found[name] is None else f"{found[name]:.3f}"
                                    for name in ("last_cycle_s", "first_free_cycle_s")))
        print(f"| {shape} | {' | '.join(cells)} | last and first free cycle [s]: {' | '.join(cycles)} |", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
