"""Sensitivity of the laboratory walls' results to speed and damping of the loading and to the material.

    python3 paper/laboratory_parameters.py [--out DIR] [TABLE ...]

Pushes the walls in the reference solver under one changed parameter at a time, and prints each table in Markdown.
Histories that are already in DIR are not run again.
"""

import argparse
import math
import sys
from dataclasses import replace
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(REPOSITORY))

from damage import brick_of_masonry, read_history
from damage.measure.pushed import mode_shares
from damage.measure.summary import summarise
from damage.reference.session import BACKEND
from damage.run.session import run_session
from damage.wall.file import load_wall

FRICTION_32 = math.radians(32)


def stiffer(wall, modulus):
    """The wall with bricks for masonry of that modulus [Pa]."""
    brick = wall.brick
    return replace(wall, brick=brick_of_masonry(modulus, wall.joint, length=brick.length, height=brick.height,
                                                thickness=brick.thickness))


def joint(wall, **values):
    """The wall with other values of its joints."""
    return replace(wall, joint=replace(wall.joint, **values))


# Table -> its wall, the words of all its runs, and its rows: name, change of the wall, more words.
LOADING = [(f"{speed:g} mm/s, local {damping}", None,
            ["--speed", speed / 1e3, "--relaxation", "local", "--damping", damping])
           for speed, damping in ((1, 0.7), (2, 0.7), (4, 0.7), (8, 0.7), (2, 0.4), (2, 0.2))]
LOADING += [(f"{speed:g} mm/s, adaptive", None, ["--speed", speed / 1e3]) for speed in (1, 2, 4)]
SLOW = ["--speed", 2e-3]
TABLES = {
    "loading": ("squat", ["--pushover", 0.12], LOADING),
    "squat": ("squat", ["--pushover", 0.15, *SLOW], [
        ("paper's material", None, []),
        ("cohesion 0.21 MPa", lambda wall: joint(wall, cohesion=0.21e6), []),
        ("friction 0.42", lambda wall: joint(wall, friction_angle=math.atan(0.42)), []),
        ("tensile strength 0.10 MPa", lambda wall: joint(wall, tensile_strength=0.10e6), []),
        ("tensile strength 0.30 MPa", lambda wall: joint(wall, tensile_strength=0.30e6), []),
        ("masonry modulus 3256 MPa", lambda wall: stiffer(wall, 3256e6), []),
        ("joint stiffness / 4", lambda wall: joint(wall, normal_stiffness=3e11, shear_stiffness=1e11), []),
        ("strengths scatter by 30 %", None, ["--strength-cov", 0.3]),
        ("top fixed against rotation", None, ["--boundary", "fixed"]),
    ]),
    "squat_tested": ("squat_tested", ["--pushover", 0.15, *SLOW], [
        ("tested material", None, []),
        ("friction 0.625", lambda wall: joint(wall, friction_angle=FRICTION_32), []),
        ("cohesion 0.24 MPa", lambda wall: joint(wall, cohesion=0.24e6), []),
        ("tensile strength 0.30 MPa", lambda wall: joint(wall, tensile_strength=0.30e6), []),
        ("masonry modulus 4940 MPa", lambda wall: stiffer(wall, 4940e6), []),
        ("top fixed against rotation", None, ["--boundary", "fixed"]),
    ]),
    "comp2_1": ("comp2_1", ["--pushover", 0.2, "--boundary", "fixed", *SLOW], [
        ("tested material", None, []),
        ("paper's joints", lambda wall: joint(wall, cohesion=0.24e6, tensile_strength=0.21e6,
                                              friction_angle=FRICTION_32), []),
        ("masonry modulus 4850 MPa", lambda wall: stiffer(wall, 4850e6), []),
    ]),
    "comp2_4": ("comp2_4", ["--pushover", 0.1, "--boundary", "fixed", *SLOW], [
        ("tested material", None, []),
        ("paper's joints", lambda wall: joint(wall, cohesion=0.24e6, tensile_strength=0.21e6,
                                              friction_angle=FRICTION_32), []),
        ("cohesion 0.24 MPa", lambda wall: joint(wall, cohesion=0.24e6), []),
        ("friction 0.625", lambda wall: joint(wall, friction_angle=FRICTION_32), []),
        ("tensile strength 0.30 MPa", lambda wall: joint(wall, tensile_strength=0.30e6), []),
        ("masonry modulus 4850 MPa", lambda wall: stiffer(wall, 4850e6), []),
        ("paper's joints, modulus 4850 MPa", lambda wall: stiffer(joint(
            wall, cohesion=0.24e6, tensile_strength=0.21e6, friction_angle=FRICTION_32), 4850e6), []),
    ]),
}


def run(folder, table, number, wall, words):
    """The History of one row, from the folder or run now."""
    out = folder / f"{table}_{number}.h5"
    if not (out.exists() and read_history(out).complete):
        words = [str(word) for word in (*words, "--out", out, "--overwrite", "--no-pictures")]
        if run_session(BACKEND, __file__, lambda: wall, words, prog="laboratory_parameters") != 0:
            sys.exit(f"{table}, row {number} failed")
    return read_history(out)


def print_table(folder, table):
    name, common, rows = TABLES[table]
    wall = load_wall(REPOSITORY / "walls" / f"{name}.py")
    lines = []
    for number, (label, change, words) in enumerate(rows):
        history = run(folder, table, number, change(wall) if change else wall, [*common, *words])
        summary, shares = summarise(history), mode_shares(history)
        lines.append(f"| {label} | {summary['initial_stiffness_n_per_m'] / 1e6:.0f} | "
                     f"{summary['secant_stiffness_n_per_m'] / 1e6:.0f} | {summary['peak_force_n'] / 1e3:.1f} | "
                     f"{100 * summary['drift_at_peak_force']:.3f} | {shares['mode']} | "
                     f"{shares['stair_share']:.2f} |")
    print(f"\n{name} {' '.join(map(str, common))}\n\n"
          "| run | initial [kN/mm] | secant [kN/mm] | peak [kN] | at drift [%] | mode | stair share |\n"
          "| --- | --- | --- | --- | --- | --- | --- |", *lines, sep="\n", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("tables", nargs="*", default=list(TABLES), metavar="TABLE", help=", ".join(TABLES))
    parser.add_argument("--out", type=Path, default=Path("results/laboratory_parameters"))
    parsed = parser.parse_args()
    parsed.out.mkdir(parents=True, exist_ok=True)
    for table in parsed.tables:
        print_table(parsed.out, table)


if __name__ == "__main__":
    main()
