"""One wall and motion, joints of scattered strength: the range of the damage index over some draws.

python3 -m examples.scattered_strengths [WALL.py] [FOLDER]  # by default examples/two_windows.py
                                                            # into results
"""

import sys
from pathlib import Path

import pandas as pd

import damage
from damage.reference.session import run_reference

MOTION = ["--harmonic", "0.1", "0.3", "--cycles", "2", "--rest", "0.2"]


def draw(wall, seed, folder):
    """Run with strengths of a coefficient of variation of 0.3; returns the maximum and the residual
    index."""
    out = folder / f"{Path(wall).stem}_strength-{seed}.h5"
    status = run_reference(
        [
            wall,
            *MOTION,
            "--strength-cov",
            "0.3",
            "--strength-seed",
            str(seed),
            "--out",
            str(out),
            "--overwrite",
            "--no-pictures",
        ]
    )
    if status:
        sys.exit(status)
    index = damage.read_history(out).index()
    return {"seed": seed, "maximum": index.DI.max(), "residual": index.DI.iloc[-1]}


def main(wall="examples/two_windows.py", folder="results", draws=5):
    """Print a row a draw, then the range."""
    table = pd.DataFrame(
        [draw(wall, seed, Path(folder)) for seed in range(1, draws + 1)]
    ).set_index("seed")
    print(table.round(3))
    for name, values in table.items():
        print(
            f"{name} DI: median {values.median():.3f}, from {values.min():.3f} to"
            f" {values.max():.3f}"
        )


if __name__ == "__main__":
    main(*sys.argv[1:])
