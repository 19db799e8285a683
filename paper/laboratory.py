"""The tables of docs/validation/laboratory.md: all tested walls by all laws of the joint, beside
the tests.

    python3 -m paper laboratory [--out DIR] [TABLE ...]

TABLE: laws, cycles; both by default, in the reference solver, about half an hour on one core.  And
speed, parameters: brittle joints pushed with other speeds, damping and material; yade: pushes in
both solvers, half an hour or so; yade_cycles: what cycles dissipate in both.  Histories that are
already in DIR are not run again.
"""

import math
from dataclasses import replace
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from damage.applications.cracks import capacity
from damage.applications.cracks.pushed import SPECIMENS, read_test
from damage.measure.energy import DISSIPATED
from damage.measure.summary import summarise
from damage.wall.file import load_wall
from paper.bench import FIXED, HELD, print_row, print_table, print_tables
from paper.softening import run, stiffer

LAWS = {
    "rule, tested c and φ": "rule",
    "5/50, calibrated": "5/50",
    "11/209, clay": "11/209",
    "brittle": "brittle",
    "paper's joints, brittle": "paper",
}
"""What a table calls a case, and what the bench does."""
CLAY_MODULUS = 4850e6
"""Modulus of masonry [Pa], at which the clay walls have the measured stiffness: COMP2_4's."""
SLOW = ["--speed", 2e-3]
QUICK = ["--speed", 1e-2]
CYCLES = ["--cyclic", "0.025,0.05,0.1,0.2,0.3", "--cycles", 1, "--speed", 5e-3]


def row(history, wall, law):
    """One wall by one law beside its test."""
    test = read_test(SPECIMENS[wall])
    found = summarise(history)
    shares = capacity.mode_shares(history)
    line = capacity.bilinear(capacity.envelope(history), history.attributes["drift_height_m"])
    crack = capacity.drift_at_first_crack(history)
    most = float(history.series["drift_ratio"].abs().max())
    fell = line["ultimate_drift"] < 0.99 * most
    peak = found["peak_force_n"]
    measured = test.figures
    print_row(
        f"{test.specimen}",
        law,
        f"{peak / 1e3:.1f}",
        f"{100 * (peak / measured['peak_force_n'] - 1):+.0f} %",
        f"{found['secant_stiffness_n_per_m'] / 1e6:.0f}",
        f"{100 * (found['secant_stiffness_n_per_m'] / measured['stiffness_n_per_m'] - 1):+.0f} %",
        f"{shares['mode']} ({100 * shares['stair_share']:.0f} %)",
        test.mode,
        f"{100 * crack:.4f}" if crack else "-",
        f"{100 * test.first_crack:.4f}" if test.first_crack else "-",
        f"{100 * line['ultimate_drift']:.3f}" if fell else f"over {100 * most:.2f}",
        " / ".join(f"{100 * drift:.2f}" for drift in test.directions["ultimate_drift"]),
    )


HEADS = (
    "wall",
    "joints",
    "peak [kN]",
    "to the test",
    "secant [kN/mm]",
    "to the test",
    "failure (on stairs)",
    "test",
    "first crack at [%]",
    "test",
    "80 % of the peak left at [%]",
    "test",
)


def laws(bench):
    """All walls by all laws, pushed over at 2 mm/s."""
    print_table(*HEADS)
    for wall, held in HELD.items():
        words = ["--pushover", 0.3, *held, *SLOW]
        for label, case in LAWS.items():
            row(run(bench, wall, case, words), wall, label)
        if wall.startswith("comp"):
            row(run(bench, wall, "rule", words, CLAY_MODULUS), wall, "rule, E 4.85 GPa")


def cycles(bench):
    """Full cycles, one at each amplitude, at 5 mm/s, by the rule."""
    print_table(
        "wall",
        "amplitude [%]",
        "drift [%]",
        "force [kN]",
        "dissipated [J]",
        "equivalent damping",
        "residual drift [%]",
        "DI at both ends",
        "DI_open",
        "DI_slip",
    )
    for wall, held in HELD.items():
        cycle_rows(wall, run(bench, wall, "rule", [*CYCLES, *held]))


def cycle_rows(label, history):
    for cycle in capacity.cycles_table(history).to_dict("records"):
        pairs = [
            f"{cycle[f'{name}_at_max']:.3f}, {cycle[f'{name}_at_min']:.3f}"
            for name in ("DI", "DI_open", "DI_slip")
        ]
        print_row(
            label,
            f"{cycle['amplitude_pct']:g}",
            f"{cycle['max_drift_pct']:.3f}, {cycle['min_drift_pct']:.3f}",
            f"{cycle['max_force_kn']:.1f}, {cycle['min_force_kn']:.1f}",
            f"{cycle['dissipated_j']:.0f}",
            f"{cycle['equivalent_damping']:.2f}",
            f"{cycle['residual_max_pct']:.3f}, {cycle['residual_min_pct']:.3f}",
            *pairs,
        )


def yade(bench):
    """Pushes at 10 mm/s by the rule in both solvers, with YADE's damping."""
    print_table("wall", "solver", *HEADS[2:])
    for wall, held in HELD.items():
        words = ["--pushover", 0.12, *held, *QUICK]
        for solver, history in (
            ("reference", run(bench, wall, "rule", [*words, "--relaxation", "local"])),
            ("YADE", run(bench, wall, "rule", words, in_yade=True)),
        ):
            row(history, wall, solver)


IN_BOTH = {
    "squat_tested": ("COMP1_3", "0.05", QUICK),
    "small_wall": ("small wall", "0.1,0.2,0.4", []),
}
"""Wall -> what a table calls it, amplitudes of its cycles [%], and their speed."""

SCATTERED = 5
"""Runs in the reference solver whose strengths scatter by 0.1 %, as a measure of chance."""


def yade_cycles(bench):
    """What walls dissipate in each cycle in both solvers, by the rule: in all, and in joints."""
    print_table(
        "wall",
        "solver",
        "amplitude [%]",
        "force [kN]",
        "loop [J]",
        "YADE to reference",
        "friction and fracture [J]",
        "YADE to reference",
        "of it fracture [J]",
    )
    for wall, (label, amplitudes, speed) in IN_BOTH.items():
        words = ["--cyclic", amplitudes, "--cycles", 1, *HELD.get(wall, FIXED), *speed]
        alike = [*words, "--relaxation", "local"]
        reference = by_cycle(run(bench, wall, "rule", alike))
        yade = by_cycle(run(bench, wall, "rule", words, in_yade=True))
        scattered = [
            by_cycle(run(bench, wall, "rule", [*alike, "--scatter", 1e-3, "--seed", seed]))
            for seed in range(1, SCATTERED + 1)
        ]
        for cycles in zip(reference, yade, *scattered):
            for solver, (cycle, in_joints, fracture) in zip(("reference", "YADE"), cycles):
                (first, joints, _) = cycles[0]
                loop = cycle["dissipated_j"]
                more = [
                    f"{100 * (here / there - 1):+.1f} %" if solver == "YADE" else ""
                    for here, there in ((loop, first["dissipated_j"]), (in_joints, joints))
                ]
                print_row(
                    label,
                    solver,
                    f"{cycle['amplitude_pct']:g}",
                    f"{cycle['max_force_kn']:.1f}, {cycle['min_force_kn']:.1f}",
                    f"{loop:.1f}",
                    more[0],
                    f"{in_joints:.1f}",
                    more[1],
                    f"{fracture:.2f}",
                )
            values = zip(
                *(
                    (one["dissipated_j"], in_joints, fracture)
                    for one, in_joints, fracture in cycles[2:]
                )
            )
            loop, in_joints, fracture = (
                f"{min(of):.{digits}f} to {max(of):.{digits}f}"
                for of, digits in zip(values, (1, 1, 2))
            )
            print_row(
                label,
                f"reference, {SCATTERED} scattered",
                f"{cycle['amplitude_pct']:g}",
                "",
                loop,
                "",
                in_joints,
                "",
                fracture,
            )


def by_cycle(history):
    """[(row of `capacity.cycles_table`, dissipated by friction and fracture, by fracture [J]), ...]
    of the cycles."""
    lost = history.series[list(DISSIPATED[:2])].to_numpy()[capacity.cycle_edges(history)]
    return [
        (cycle, float(both.sum()), float(both[1]))
        for cycle, both in zip(
            capacity.cycles_table(history).to_dict("records"), np.diff(lost, axis=0)
        )
    ]


# --- brittle joints: speed, damping and material --------------------------------------------------

FRICTION_32 = math.radians(32)


class Change(NamedTuple):
    """A row of a table of pushes: what it is called, values of its joints, modulus of its masonry
    [Pa], further words of the run."""

    label: str
    joint: dict = MappingProxyType({})
    modulus: float | None = None
    words: tuple = ()


LOADINGS = [
    Change(
        f"{speed:g} mm/s, local {damping}",
        words=("--speed", speed / 1e3, "--relaxation", "local", "--damping", damping),
    )
    for speed, damping in ((1, 0.7), (2, 0.7), (4, 0.7), (8, 0.7), (2, 0.4), (2, 0.2))
]
LOADINGS += [
    Change(f"{speed:g} mm/s, adaptive", words=("--speed", speed / 1e3)) for speed in (1, 2, 4)
]
STRONGER = Change("tensile strength 0.30 MPa", {"tensile_strength": 0.30e6})
HELD_TOP = Change("top fixed against rotation", words=FIXED)
SQUAT = [
    Change("paper's material"),
    Change("cohesion 0.21 MPa", {"cohesion": 0.21e6}),
    Change("friction 0.42", {"friction_angle": math.atan(0.42)}),
    Change("tensile strength 0.10 MPa", {"tensile_strength": 0.10e6}),
    STRONGER,
    Change("masonry modulus 3256 MPa", modulus=3256e6),
    Change("joint stiffness / 4", {"normal_stiffness": 3e11, "shear_stiffness": 1e11}),
    Change("strengths scatter by 30 %", words=("--strength-cov", 0.3)),
    HELD_TOP,
]
SQUAT_TESTED = [
    Change("tested material"),
    Change("friction 0.625", {"friction_angle": FRICTION_32}),
    Change("cohesion 0.24 MPa", {"cohesion": 0.24e6}),
    STRONGER,
    Change("masonry modulus 4940 MPa", modulus=4940e6),
    HELD_TOP,
]


def speed(bench):
    """The squat wall by speed and damping of the push."""
    vary(bench, "squat", ["--pushover", 0.12], LOADINGS)


def parameters(bench):
    """Both squat walls by their material and boundary."""
    for name, rows in (("squat", SQUAT), ("squat_tested", SQUAT_TESTED)):
        vary(bench, name, ["--pushover", 0.15, *SLOW], rows)


def vary(bench, name, common, rows):
    """Print the table of a wall pushed under one change at a time."""
    print_table(
        "run",
        "initial [kN/mm]",
        "secant [kN/mm]",
        "peak [kN]",
        "at drift [%]",
        "mode",
        "stair share",
    )
    for label, values, modulus, words in rows:
        wall = load_wall(name)
        wall = replace(wall, joint=replace(wall.joint, **values))
        history = bench.run(
            stiffer(wall, modulus) if modulus else wall, [*common, *words], name, label
        )
        found = summarise(history)
        shares = capacity.mode_shares(history)
        print_row(
            label,
            f"{found['initial_stiffness_n_per_m'] / 1e6:.0f}",
            f"{found['secant_stiffness_n_per_m'] / 1e6:.0f}",
            f"{found['peak_force_n'] / 1e3:.1f}",
            f"{100 * found['drift_at_peak_force']:.3f}",
            shares["mode"],
            f"{shares['stair_share']:.2f}",
        )


TABLES = {table.__name__: table for table in (laws, cycles, speed, parameters, yade, yade_cycles)}


def main():
    print_tables(TABLES, ("laws", "cycles"), "results/laboratory", __doc__)
