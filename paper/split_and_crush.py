"""The tables of docs/validation/laboratory.md: tested walls whose bricks split and whose joints crush, pushed over.

    python3 paper/split_and_crush.py [--out DIR] [--drift PERCENT] [--share SHARE] [--solver reference|yade]
                                          [WALL ...]

Joints soften by the rule (docs/model/model.md); bricks have a share of their normalised compressive strength for a
tensile one, joints the masonry's compressive strength, both of damage/data/eucentre/tests.csv.  About 15 minutes on one
core in the reference solver; histories that are already in DIR are not run again.
"""

import argparse
import contextlib
import io
import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd

REPOSITORY = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(REPOSITORY))

from damage import read_history
from damage.laboratory.pushed import SPECIMENS, read_test
from damage.measure.pushed import mode_shares
from damage.measure.summary import summarise
from damage.reference.session import BACKEND
from damage.run.session import run_session
from damage.wall.file import load_wall
from damage.wall.parameters import softening_energies
from paper.softening import print_row, print_table
from yade_scripts import COMMAND

WALLS = {"squat_tested": [], "comp2_1": ["--boundary", "fixed"], "comp2_3": ["--boundary", "fixed"],
         "comp2_4": ["--boundary", "fixed"]}
"""Wall -> how it is held."""
CASES = {"as shipped": "", "bricks split": "split", "joints crush": "crush", "both": "split, crush",
         "bricks split in shear, too": "split, shear"}
SPEED = ["--speed", 4e-3]
IN_YADE = '''"""The wall {name} by paper/split_and_crush.py."""

import sys

sys.path.insert(0, {repository!r})

from paper.split_and_crush import of_case


def wall():
    return of_case({name!r}, {case!r}, {share!r})


if __name__ == "__main__":
    from yade_scripts.run import main

    main(wall)
'''


def strengths(specimen, share):
    """Tensile strength of a brick and compressive strength of the masonry [Pa]; share: the former over the brick's
    normalised compressive strength."""
    table = pd.read_csv(REPOSITORY / "damage" / "data" / "eucentre" / "tests.csv").set_index("Specimen")
    return tuple(1e6 * float(table.loc[specimen, name]) * factor
                 for name, factor in (("fb_norm_perp_MPa", share), ("fm_c_MPa", 1.0)))


def of_case(name, case, share):
    """The wall of a case."""
    wall, does = load_wall(REPOSITORY / "walls" / f"{name}.py"), CASES[case]
    tension, pressure = strengths(SPECIMENS[name], share)
    joint = replace(wall.joint, **softening_energies(wall.joint.tensile_strength),
                    compressive_strength=pressure if "crush" in does else None)
    brick = replace(wall.brick, tensile_strength=tension if "split" in does else None,
                    cohesion=tension if "shear" in does else None)
    return replace(wall, joint=joint, brick=brick)


def run(folder, name, case, share, words, solver):
    """The History of a case."""
    label = "_".join([solver, name, *case.replace(",", "").split(), f"{share:g}",
                     *(str(word).strip("-") for word in words)])
    out = folder / f"{label}.h5"
    if out.exists() and read_history(out).complete:
        return read_history(out)
    words = [*map(str, words), "--out", str(out), "--overwrite", "--no-pictures"]
    if solver == "yade":
        script = folder / f"{label}.py"
        script.write_text(IN_YADE.format(name=name, repository=str(REPOSITORY), case=case, share=share))
        done = subprocess.run([*COMMAND, script, *words], capture_output=True, text=True,
                              env={**os.environ, "PYTHONPATH": str(REPOSITORY)})
        status, said = done.returncode, done.stderr
    else:
        quiet = io.StringIO()
        with contextlib.redirect_stdout(quiet), contextlib.redirect_stderr(quiet):
            status = run_session(BACKEND, REPOSITORY / "walls" / f"{name}.py", lambda: of_case(name, case, share),
                                 words, prog="split_and_crush")
        said = quiet.getvalue()
    if status != 0:
        sys.exit(f"{label} failed\n{said[-2000:]}")
    return read_history(out)


HEADS = ("wall", "", "peak [kN]", "to the test", "at drift [%]", "80 % of it left at [%]", "at the end [kN]",
         "failure (on stairs)", "bricks split [m]", "joints crushed [m]", "energy error [%]")


def row(history, name, case):
    """One wall in one case beside its test."""
    found, shares, measured = summarise(history), mode_shares(history), np.mean(read_test(SPECIMENS[name]).peak_force_n)
    force, drift = (history.series[column].abs().to_numpy() for column in ("base_shear_n", "drift_ratio"))
    peak = int(np.argmax(force))
    below = np.flatnonzero((np.arange(len(force)) > peak) & (force < 0.8 * force[peak]))
    error = found["energy_error_fraction"]
    print_row(SPECIMENS[name], case, f"{force[peak] / 1e3:.1f}", f"{100 * (force[peak] / measured - 1):+.0f} %",
              f"{100 * drift[peak]:.3f}", f"{100 * drift[below[0]]:.3f}" if len(below) else "-",
              f"{force[-1] / 1e3:.1f}", f"{shares['mode']} ({100 * shares['stair_share']:.0f} %)",
              f"{found['split_length_m']:.2f}", f"{found['crushed_length_m']:.2f}",
              "-" if error is None else f"{100 * error:.3f}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("walls", nargs="*", default=list(WALLS), metavar="WALL", help=", ".join(WALLS))
    parser.add_argument("--out", type=Path, default=Path("results/split_and_crush"))
    parser.add_argument("--drift", type=float, default=0.3, help="[%%]")
    parser.add_argument("--share", type=float, default=0.1, help="tensile over normalised compressive strength")
    parser.add_argument("--solver", default="reference", choices=("reference", "yade"))
    parser.add_argument("--cases", nargs="*", default=list(CASES), choices=list(CASES))
    parsed = parser.parse_args()
    unknown = [name for name in parsed.walls if name not in WALLS]
    if unknown:
        sys.exit(f"error: no wall {unknown[0]}; expected one of {', '.join(WALLS)}")
    parsed.out.mkdir(parents=True, exist_ok=True)
    print_table(*HEADS)
    for name in parsed.walls:
        for case in parsed.cases:
            words = ["--pushover", parsed.drift, *WALLS[name], *SPEED]
            row(run(parsed.out, name, case, parsed.share, words, parsed.solver), name, case)


if __name__ == "__main__":
    main()
