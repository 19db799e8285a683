"""The table docs/tables/shear_walls_prediction.csv: shear walls of hollow clay by the rule of
docs/guides/tested-wall.md, sealed before their results were seen.

    python3 -m paper shear_walls INPUTS.csv [--out DIR] [--tries] [WALL ...]

INPUTS has a row a wall: sizes, strengths, friction, precompression of the tests' report.  Peak and
secant stiffness are medians of three pushes, the rest is of one cyclic run, means over both
directions.  About 5 minutes on one core.  With --tries the table of docs/validation/laboratory.md:
one push and one cyclic run of each wall in each of TRIES.
"""

from dataclasses import replace
from pathlib import Path
from unittest.mock import patch

import numpy as np
import pandas as pd

from damage.applications.cracks.capacity import capacity, cycle_edges, loaded_curves
from damage.measure.pushed import first_loading
from damage.run import prepare
from damage.wall.file import wall_from
from damage.wall.kinds import BED, HEAD
from damage.wall.parameters import nearest
from paper.bench import FIXED, Bench, arguments, option, print_row, print_table

UNITS = (0.31, 0.25)
"""Length along the wall and thickness of a unit with its mortar [m]."""
COURSE = 0.2
"""Height of a course [m]."""
SHARE = 0.08
"""Tensile strength of a unit over its compressive strength along the wall."""
AMPLITUDES = 0.025, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.4
DRAWN = ["--strength-cov", 0.35, "--strength-seed"]
PUSH = ["--pushover", 0.3, *FIXED, "--speed", 0.004, *DRAWN]
CYCLES = ["--cyclic", ",".join(map(str, AMPLITUDES)), "--cycles", 1, *FIXED, "--speed", 0.008]


def wall_of(row):
    """The wall of a row of the inputs."""
    halves = nearest(2 * row.length_m / UNITS[0])
    cohesion = 1e6 * row.cohesion_mpa
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
    moved = height * history.series["drift_ratio"].to_numpy()
    found = {}
    for amplitude, first, last in zip(
        AMPLITUDES, cycle_edges(history)[:-1], cycle_edges(history)[1:]
    ):
        u = moved[first:last]
        f = force[first:last]
        found[amplitude] = abs(0.5 * float(np.sum(u * np.roll(f, -1) - np.roll(u, -1) * f)))
    return found


def predicted(bench, row):
    """One wall's row of the table."""
    wall = wall_of(row)
    pushes = [bench.run(wall, [*PUSH, seed], row.wall) for seed in (1, 2, 3)]
    cycles = bench.run(wall, [*CYCLES, *DRAWN, 1], row.wall)
    curves = loaded_curves(cycles).values()
    loops = loop_energies(cycles, row.height_m)
    left = {f"left_at_{drift}_pct": force_left(curves, drift) for drift in (0.2, 0.3, 0.4)}
    stiffness = [first_loading(one)["secant_stiffness_n_per_m"] for one in pushes]
    return {
        "wall": row.wall,
        "peak_kn": np.median([capacity(one)["peak_force_n"] for one in pushes]) / 1e3,
        "secant_stiffness_kn_per_mm": np.median(stiffness) / 1e6,
        **left,
        "ultimate_drift_pct": 100 * capacity(cycles)["ultimate_drift"],
        **{f"loop_at_{drift}_pct_j": loops.get(drift, np.nan) for drift in (0.1, 0.2, 0.3)},
    }


def force_left(curves, drift):
    """Force at a drift [%] over the largest one, mean of the curves of both directions."""
    return np.mean(
        [
            np.interp(drift / 100, curve["drift_ratio"], curve["force_n"]) / curve["force_n"].max()
            for curve in curves
        ]
    )


def scaled(which, **factors):
    """A change of a Layout's contacts: columns times a factor where which(contacts)."""

    def change(contacts):
        values = {name: getattr(contacts, name) for name in factors}
        chosen = which(contacts)
        return replace(
            contacts, **{n: np.where(chosen, factors[n] * v, v) for n, v in values.items()}
        )

    return change


def heads(contacts):
    return contacts.kind == HEAD


def at_the_ends(contacts):
    return (contacts.kind == BED) & ((contacts.first < 0) | (contacts.z == contacts.z.max()))


def bricks(**factors):
    """A change of a Wall: of its bricks' numbers, by factors; None leaves one out."""
    return lambda wall: replace(
        wall,
        brick=replace(
            wall.brick, **{n: f and f * getattr(wall.brick, n) for n, f in factors.items()}
        ),
    )


TRIES = {
    "as sealed": (None, None),
    "head joints with 0.3 of the bond": (
        None,
        scaled(heads, tensile_strength=0.3, cohesion=0.3),
    ),
    "head joints without bond": (None, scaled(heads, tensile_strength=1e-3, cohesion=1e-3)),
    "bed joints with 0.05 of f_t": (None, scaled(lambda c: c.kind == BED, tensile_strength=0.05)),
    "first and last bed joint 0.3 as stiff": (
        None,
        scaled(at_the_ends, normal_stiffness=0.3, shear_stiffness=0.3),
    ),
    "G / E = 0.2": (bricks(shear_modulus=0.5), None),
    "G of a split twice": (bricks(fracture_energy=2), None),
    "G of a split five times": (bricks(fracture_energy=5), None),
    "G of a split 30 times": (bricks(fracture_energy=30), None),
    "bricks do not split": (bricks(tensile_strength=None, fracture_energy=None), None),
}
"""Change of the Wall, and of its Layout's contacts, by name."""


def tried(bench, row, name):
    """A row of the table of tries: the wall of a row of the inputs, changed."""
    of_wall, of_contacts = TRIES[name]
    wall = wall_of(row)
    lay_out = prepare.lay_out_building

    def changed(*given, **options):
        layout = lay_out(*given, **options)
        return replace(layout, contacts=of_contacts(layout.contacts)) if of_contacts else layout

    with patch.object(prepare, "lay_out_building", changed):
        push, cycles = (
            bench.run(of_wall(wall) if of_wall else wall, [*words, 1], row.wall, name)
            for words in (PUSH, [*CYCLES, *DRAWN])
        )
    curves = loaded_curves(cycles).values()
    loops = loop_energies(cycles, row.height_m)
    first = first_loading(push)
    print_row(
        row.wall,
        name,
        f"{capacity(push)['peak_force_n'] / 1e3:.0f}",
        f"{first['initial_stiffness_n_per_m'] / 1e6:.0f}",
        f"{first['secant_stiffness_n_per_m'] / 1e6:.0f}",
        *(f"{force_left(curves, drift):.2f}" for drift in (0.2, 0.3)),
        f"{100 * capacity(cycles)['ultimate_drift']:.2f}",
        *(f"{loops[drift]:.0f}" for drift in (0.1, 0.2)),
    )


def main():
    parsed = arguments(
        __doc__,
        option("inputs", type=Path),
        option("walls", nargs="*", metavar="WALL"),
        option("--out", type=Path, default=Path("results/shear_walls")),
        option("--tries", action="store_true"),
    )
    bench = Bench(parsed.out)
    inputs = pd.read_csv(parsed.inputs)
    rows = [row for row in inputs.itertuples() if row.wall in (parsed.walls or [*inputs.wall])]
    if parsed.tries:
        print_table(
            "wall",
            "try",
            "peak [kN]",
            "initial [kN/mm]",
            "secant [kN/mm]",
            "left at 0.2 %",
            "left at 0.3 %",
            "ultimate drift [%]",
            "loop at 0.1 % [J]",
            "loop at 0.2 % [J]",
        )
        for row, name in ((row, name) for row in rows for name in TRIES):
            tried(bench, row, name)
        return
    for number, row in enumerate(rows):
        made = predicted(bench, row)
        print(",".join(made) + "\n" if number == 0 else "", end="")
        print(",".join(v if isinstance(v, str) else f"{v:.3g}" for v in made.values()), flush=True)
