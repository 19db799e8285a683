"""Tables of docs/validation: step and damping, ensembles, crack patterns.

    python3 -m paper softening [--out DIR] [TABLE ...]

TABLE: steps, damping, scatter, patterns; all of these by default, which run in the
reference solver, about half an hour on one core.  And yade_steps, yade_shaken: YADE beside the
reference solver, half an hour on one core. Histories that are already in DIR are not run again.
"""

import math
from dataclasses import replace

import numpy as np

from damage.applications.cracks.compare import compare_joints
from damage.applications.cracks.patterns import compare_patterns
from damage.linear.modes import natural_modes
from damage.measure.summary import summarise
from damage.wall.file import load_wall
from damage.wall.layout import lay_out
from damage.wall.parameters import brick_of_masonry, softening_energies
from paper.bench import REPOSITORY, print_row, print_table, print_tables

SMALL_WALL = REPOSITORY / "walls" / "variants" / "small.py"
PAPERS_JOINT = {"cohesion": 0.24e6, "tensile_strength": 0.21e6, "friction_angle": math.radians(32)}
"""Sarhosis et al. (2021), Table 1."""
MILD = ("symmetric", ["--harmonic", 0.2, 0.05, "--rest", 0.5])
HARD = (
    "solid",
    ["--harmonic", 0.1, 0.3, "--rest", 0.5],
)
SHIPPED = (0.35, 1e-6)
MEMBERS = 10


def run(bench, name, case, words, modulus=None, step=None, in_yade=False):
    """The History of a wall file with the joints of a case (`softened`); modulus: of its masonry
    [Pa], None as in the file; step: share of the critical one, None as by default."""
    wall = softened(load_wall(SMALL_WALL if name == "small_wall" else name), case)
    if modulus:
        wall = stiffer(wall, modulus)
    if step:
        words = [*words, "--dt", f"{step * natural_modes(lay_out(wall)).critical_time_step_s:.5e}"]
    return (bench.run_in_yade if in_yade else bench.run)(
        wall, words, name, case, f"{modulus or 0:g}"
    )


def stiffer(wall, modulus):
    """The wall with bricks for masonry of that modulus [Pa]."""
    sizes = {size: getattr(wall.brick, size) for size in ("length", "height", "thickness")}
    return replace(wall, brick=brick_of_masonry(modulus, wall.joint, **sizes))


def softened(wall, case):
    """The wall with the fracture energies of a case."""
    if case == "brittle":
        return wall
    if case == "paper":
        return replace(wall, joint=replace(wall.joint, **PAPERS_JOINT))
    energies = (
        softening_energies(wall.joint.tensile_strength)
        if case == "rule"
        else dict(
            zip(("mode_i_fracture_energy", "mode_ii_fracture_energy"), map(float, case.split("/")))
        )
    )
    return replace(wall, joint=replace(wall.joint, **energies))


def numbers(history):
    """DI, drift [%], length of joints that travel more than 0.1 mm [m], energy error [%], as
    text."""
    summary = summarise(history)
    length = history.joint_length_m
    travel = np.abs(np.diff(history.slip_m, axis=0)).sum(axis=0)
    return (
        f"{summary['max']['DI']:.4f}",
        f"{100 * summary['max_drift_ratio']:.4f}",
        f"{length[travel > 1e-4].sum():.1f}",
        f"{100 * summary['energy_error_fraction']:.3f}",
    )


def steps(bench):
    """Step and stiffness-proportional damping, 5/50."""
    print_table(
        "wall and motion",
        "step over the critical",
        "β [s]",
        "max DI",
        "max drift [%]",
        "slid to and fro by over 0.1 mm [m]",
        "energy error [%]",
    )
    for name, words in (MILD, HARD):
        for step in (0.643, 0.35, 0.175):
            for beta in (0.0, 1e-6):
                history = run(bench, name, "5/50", [*words, "--beta", beta], step=step)
                print_row(
                    f"{name} {' '.join(map(str, words[1:3]))}", step, f"{beta:g}", *numbers(history)
                )


def damping(bench):
    """No damping, the shipped one, and Rayleigh's of 1 and 2 %."""
    print_table(
        "wall and motion",
        "joints",
        "damping",
        "max DI",
        "max drift [%]",
        "slid to and fro by over 0.1 mm [m]",
        "energy error [%]",
        "FSS of broken joints with the shipped",
    )
    for (name, words), (first, second) in ((MILD, (5, 20)), (HARD, (16, 64))):
        for case in ("brittle", "5/50"):
            usual = run(bench, name, case, [*words, "--beta", 1e-6], step=SHIPPED[0])
            runs = {
                "none": run(bench, name, case, [*words, "--beta", 0], step=SHIPPED[0]),
                "β 1e-6 s": usual,
            }
            runs |= {
                f"{ratio:.0%} at {first} and {second} Hz": run(
                    bench, name, case, [*words, "--rayleigh", ratio, first, second]
                )
                for ratio in (0.01, 0.02)
            }
            for label, history in runs.items():
                print_row(
                    f"{name} {' '.join(map(str, words[1:3]))}",
                    case,
                    label,
                    *numbers(history),
                    _score(compare_patterns(history, usual)["broken"]["fss"]),
                )


def scatter(bench):
    """Ensembles by scattered strengths."""
    print_table(
        "wall and motion",
        "joints",
        "members differ by",
        "max drift [%]: median (range)",
        "max DI: median (range)",
        "largest energy error [%]",
    )
    for (name, words), number in ((HARD, MEMBERS), (MILD, MEMBERS // 2)):
        for case in ("brittle", "5/50"):
            for size in (1e-4, 1e-3, 1e-2, 5e-2):
                drawn = [*words, "--strength-cov", size, "--strength-seed"]
                members = [
                    summarise(run(bench, name, case, [*drawn, one])) for one in range(1, number + 1)
                ]
                print_row(
                    f"{name} {' '.join(map(str, words[1:3]))}",
                    case,
                    f"strengths, {100 * size:g} %",
                    _range([100 * one["max_drift_ratio"] for one in members]),
                    _range([one["max"]["DI"] for one in members]),
                    f"{100 * max(one['energy_error_fraction'] for one in members):.3f}",
                )


def patterns(bench):
    """Crack patterns of pairs that should agree, and of controls that should not."""
    print_table(
        "joints",
        "pair",
        "kappa",
        "FSS, broken (shuffled, mirrored)",
        "FSS, over 0.1 mm (shuffled, mirrored)",
        "max DI",
    )
    name, (harmonic, *motion, rest, rest_s) = MILD

    def shaken(case, step, motion, *more):
        return run(bench, name, case, [harmonic, *motion, rest, rest_s, *more], step=step)

    for case, step, more in (
        ("brittle", 0.643, []),
        ("brittle", 0.35, ["--beta", 1e-6]),
        ("5/50", 0.35, []),
    ):
        label = f"{case}, {step} of the critical step" + (", β 1e-6 s" if step < 0.6 else "")
        first = shaken(case, step, motion, *more)
        others = {
            f"scatter 0.1 %, members {seed} and {seed + 1}": [
                shaken(case, step, motion, *more, "--scatter", 0.001, "--seed", one)
                for one in (seed, seed + 1)
            ]
            for seed in (1, 3)
        }
        others |= {
            "half the step": [first, shaken(case, step / 2, motion, *more)],
            "control: 0.025 g": [first, shaken(case, step, (0.2, 0.025), *more)],
            "control: 0.33 s, 0.1 g": [first, shaken(case, step, (0.33, 0.1), *more)],
        }
        for pair, (here, there) in others.items():
            scores = compare_patterns(here, there)
            print_row(
                label,
                pair,
                _score(compare_joints(here, there)["kappa"]),
                *(
                    f"{_score(score['fss'])} ({_score(score['shuffled'])},"
                    f" {_score(score['mirrored'])})"
                    for score in (scores["broken"], scores["visible"])
                ),
                " / ".join(f"{history.index()['DI'].max():.4f}" for history in (here, there)),
            )


def _score(value):
    return "-" if value is None else f"{value:.2f}"


def _range(values):
    return f"{np.median(values):.4f} ({min(values):.4f} to {max(values):.4f})"


def yade_steps(bench):
    """The step that softening joints need in YADE, beside the reference solver's with and without
    its damping."""
    print_table(
        "wall and motion",
        "step over the critical",
        "solver",
        "max DI",
        "max drift [%]",
        "slid to and fro by over 0.1 mm [m]",
        "energy error [%]",
    )
    for amplitude in (0.2, 0.4):
        words = ["--harmonic", 0.1, amplitude, "--rest", 0.1]
        for step in (0.643, 0.35, 0.175):
            runs = {
                f"reference, β {beta:g} s": run(
                    bench, "small_wall", "5/50", [*words, "--beta", beta], step=step
                )
                for beta in (0.0, 1e-6)
            }
            runs |= {"YADE": run(bench, "small_wall", "5/50", words, step=step, in_yade=True)}
            for solver, history in runs.items():
                print_row(f"small_wall 0.1 {amplitude}", step, solver, *numbers(history))


def yade_shaken(bench):
    """The symmetric wall under the mild motion in both solvers, without damping."""
    print_table(
        "joints",
        "solver",
        "max DI",
        "max drift [%]",
        "slid to and fro by over 0.1 mm [m]",
        "energy error [%]",
        "kappa",
        "FSS, broken",
        "FSS, over 0.1 mm",
    )
    name, words = MILD
    there = run(bench, name, "5/50", [*words, "--beta", 0])
    for solver, here in (
        ("reference", there),
        ("YADE", run(bench, name, "5/50", words, in_yade=True)),
    ):
        scores = compare_patterns(here, there)
        print_row(
            "5/50",
            solver,
            *numbers(here),
            _score(compare_joints(here, there)["kappa"]),
            *(_score(scores[which]["fss"]) for which in ("broken", "visible")),
        )


USUAL = {table.__name__: table for table in (steps, damping, scatter, patterns)}
TABLES = USUAL | {table.__name__: table for table in (yade_steps, yade_shaken)}


def main():
    print_tables(TABLES, USUAL, "results/softening", __doc__)
