"""The table docs/tables/shear_walls_prediction.csv: shear walls of hollow clay by the rule of
docs/guides/tested-wall.md, sealed before their results were seen.

    python3 -m paper shear_walls INPUTS.csv [--out DIR] [WALL ...]

INPUTS has a row a wall: sizes, strengths, friction, precompression of the tests' report.  Peak and
secant stiffness are medians of three pushes, the rest is of one cyclic run, means over both
directions.  About 5 minutes on one core.
"""

from pathlib import Path

import numpy as np
import pandas as pd

from damage.applications.cracks.capacity import capacity, cycle_edges, loaded_curves
from damage.measure.pushed import first_loading
from damage.wall.file import wall_from
from damage.wall.parameters import nearest
from paper.bench import FIXED, Bench, arguments, option

UNITS, COURSE = (0.31, 0.25), 0.2
"""Length along the wall and thickness of a unit with its mortar, height of a course [m]."""
SHARE = 0.08
"""Tensile strength of a unit over its compressive strength along the wall."""
AMPLITUDES = 0.025, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.4
DRAWN = ["--strength-cov", 0.35, "--strength-seed"]


def wall_of(row):
    """The wall of a row of the inputs."""
    halves, cohesion = nearest(2 * row.length_m / UNITS[0]), 1e6 * row.cohesion_mpa
    return wall_from(
        {
            "name": row.wall.lower().replace(".", "_"),
            "length": row.length_m,
            "height": row.height_m,
            "precompression": 1e6 * row.precompression_mpa,
            "masonry": {"young_modulus": 4.9e9},
            "brick": {
                "length": 2 * row.length_m / halves,
                "height": COURSE,
                "thickness": row.thickness_m,
                "density": 1100.0,
                "tensile_strength": SHARE * 1e6 * row.unit_strength_parallel_mpa,
                "fracture_energy": "rule",
            },
            "joint": {
                "cohesion": cohesion,
                "friction": row.friction,
                "tensile_strength": 0.875 * cohesion,
                "mode_i_fracture_energy": "rule",
                "mode_ii_fracture_energy": "rule",
                "compressive_strength": 1e6 * row.compressive_strength_mpa,
                "compressive_fracture_energy": "rule",
            },
        }
    )


def loop_energies(history, height):
    """{amplitude [%]: energy of its closed loop of base shear and displacement at this height [J]}
    of a cyclic History."""
    force = history.series["base_shear_n"].to_numpy()
    moved, found = height * history.series["drift_ratio"].to_numpy(), {}
    for amplitude, first, last in zip(
        AMPLITUDES, cycle_edges(history)[:-1], cycle_edges(history)[1:]
    ):
        u, f = moved[first:last], force[first:last]
        found[amplitude] = abs(0.5 * float(np.sum(u * np.roll(f, -1) - np.roll(u, -1) * f)))
    return found


def predicted(bench, row):
    """One wall's row of the table."""
    wall = wall_of(row)
    push = ["--pushover", 0.3, *FIXED, "--speed", 0.004, *DRAWN]
    pushes = [bench.run(wall, [*push, seed], row.wall) for seed in (1, 2, 3)]
    cyclic = ["--cyclic", ",".join(map(str, AMPLITUDES)), "--cycles", 1, *FIXED, "--speed", 0.008]
    cycles = bench.run(wall, [*cyclic, *DRAWN, 1], row.wall)
    curves, loops = loaded_curves(cycles).values(), loop_energies(cycles, row.height_m)
    left = {
        f"left_at_{drift}_pct": np.mean(
            [np.interp(drift / 100, *_points(curve)) / curve["force_n"].max() for curve in curves]
        )
        for drift in (0.2, 0.3, 0.4)
    }
    stiffness = [first_loading(one)["secant_stiffness_n_per_m"] for one in pushes]
    return {
        "wall": row.wall,
        "peak_kn": np.median([capacity(one)["peak_force_n"] for one in pushes]) / 1e3,
        "secant_stiffness_kn_per_mm": np.median(stiffness) / 1e6,
        **left,
        "ultimate_drift_pct": 100 * capacity(cycles)["ultimate_drift"],
        **{f"loop_at_{drift}_pct_j": loops.get(drift, np.nan) for drift in (0.1, 0.2, 0.3)},
    }


def _points(curve):
    return curve["drift_ratio"], curve["force_n"]


def main():
    parsed = arguments(
        __doc__,
        option("inputs", type=Path),
        option("walls", nargs="*", metavar="WALL"),
        option("--out", type=Path, default=Path("results/shear_walls")),
    )
    bench, inputs = Bench(parsed.out), pd.read_csv(parsed.inputs)
    for row in inputs.itertuples():
        if not parsed.walls or row.wall in parsed.walls:
            made = predicted(bench, row)
            print(",".join(made) if row.Index == 0 else "", end="\n" if row.Index == 0 else "")
            print(
                ",".join(v if isinstance(v, str) else f"{v:.3g}" for v in made.values()), flush=True
            )
