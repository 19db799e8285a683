"""The tables of docs/validation/laboratory.md: tested walls whose bricks split and whose joints
crush, pushed over.

    python3 -m paper split_and_crush [--out DIR] [--drift PERCENT] [--share SHARE]
                                          [--solver reference|yade] [WALL ...]

Joints and cuts soften by the rules (docs/model/model.md); bricks have a share of their normalised
compressive strength for a tensile one, joints the masonry's compressive strength, both of
damage/data/eucentre/tests.csv.  About 15 minutes on one core in the reference solver; histories
that are already in DIR are not run again.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np

from damage.applications.cracks.capacity import mode_shares
from damage.applications.cracks.pushed import SPECIMENS, read_test
from damage.measure.summary import summarise
from damage.wall.file import load_wall
from damage.wall.parameters import softening_energies
from paper.bench import HELD, Bench, arguments, chosen, of_test, option, print_row, print_table
from paper.softening import peak_and_fall

CASES = {
    "as shipped": "",
    "bricks split": "split",
    "joints crush": "crush",
    "both": "split, crush",
}
SPEED = ["--speed", 4e-3]


def of_case(name, case, share):
    """The wall of a case; share: tensile strength of a brick over its normalised compressive
    strength."""
    wall = load_wall(name)
    does = CASES[case]
    test = of_test(SPECIMENS[name])
    tension = 1e6 * float(test["fb_norm_perp_MPa"]) * share
    pressure = 1e6 * float(test["fm_c_MPa"])
    joint = replace(
        wall.joint,
        **softening_energies(wall.joint.tensile_strength),
        compressive_strength=pressure if "crush" in does else None,
    )
    brick = replace(
        wall.brick,
        tensile_strength=tension if "split" in does else None,
        fracture_energy="rule" if "split" in does else None,
    )
    return replace(wall, joint=joint, brick=brick)


HEADS = (
    "wall",
    "",
    "peak [kN]",
    "to the test",
    "at drift [%]",
    "80 % of it left at [%]",
    "at the end [kN]",
    "failure (on stairs)",
    "bricks split [m]",
    "joints crushed [m]",
    "energy error [%]",
)


def row(history, name, case):
    """One wall in one case beside its test."""
    found = summarise(history)
    shares = mode_shares(history)
    measured = np.mean(read_test(SPECIMENS[name]).peak_force_n)
    force, drift, peak, left = peak_and_fall(history)
    error = found["energy_error_fraction"]
    print_row(
        SPECIMENS[name],
        case,
        f"{force[peak] / 1e3:.1f}",
        f"{100 * (force[peak] / measured - 1):+.0f} %",
        f"{100 * drift[peak]:.3f}",
        left,
        f"{force[-1] / 1e3:.1f}",
        f"{shares['mode']} ({100 * shares['stair_share']:.0f} %)",
        f"{found['split_length_m']:.2f}",
        f"{found['crushed_length_m']:.2f}",
        "-" if error is None else f"{100 * error:.3f}",
    )


def main():
    parsed = arguments(
        __doc__,
        option("walls", nargs="*", metavar="WALL", help=", ".join(HELD)),
        option("--out", type=Path, default=Path("results/split_and_crush")),
        option("--drift", type=float, default=0.3, help="[%%]"),
        option(
            "--share",
            type=float,
            default=0.032,
            help="tensile over normalised compressive strength",
        ),
        option("--solver", default="reference", choices=("reference", "yade")),
        option("--cases", nargs="*", default=list(CASES), choices=list(CASES)),
    )
    bench = Bench(parsed.out)
    run = bench.run if parsed.solver == "reference" else bench.run_in_yade
    print_table(*HEADS)
    for name in chosen(parsed.walls, HELD, "wall"):
        for case in parsed.cases:
            words = ["--pushover", parsed.drift, *HELD[name], *SPEED]
            row(
                run(of_case(name, case, parsed.share), words, name, case, f"{parsed.share:g}"),
                name,
                case,
            )
