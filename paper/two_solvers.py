"""The table of docs/validation/two-solvers.md: YADE against an ensemble of the reference solver, motion by motion.

    python3 paper/two_solvers.py --out DIR

DIR keeps the histories; those that are there already are not made again.  About an hour on one core, almost all
of it YADE's.
"""

import argparse
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from damage.history.reader import read_history
from damage.measure.compare import compare
from yade_scripts import COMMAND

RECORD = ["--record", "damage/data/zeerijp_20180108/BGAR_HGE_acc_m_s2.csv", "--window", "17", "23", "--rest", "1"]
MOTIONS = {
    "0.2 s, 0.025 g": ["--harmonic", "0.2", "0.025"], "0.2 s, 0.05 g": ["--harmonic", "0.2", "0.05"],
    "0.2 s, 0.1 g": ["--harmonic", "0.2", "0.1"], "BGAR x 1": RECORD, "BGAR x 2": [*RECORD, "--scale", "2"],
}
ELASTIC = {"free vibration, 2 s": ["--free-vibration"], "0.2 s, 0.004 g": ["--harmonic", "0.2", "0.004", "--rest", "1"]}
WALLS = ("solid", "symmetric", "asymmetric")
MEMBERS = 5
LEAST_FSS = 0.8
FIGURES = {  # of damage.measure.compare.TOLERANCES: label, factor, decimals, what is allowed
    "max_drift_ratio": ("maximum drift ratio [%]", 100, 4, "2 %"),
    "cycle_length_s": ("length of the free cycles [s]", 1, 4, "2 %"),
    "peak_base_shear_n": ("peak base shear [kN]", 1e-3, 1, "6 %"),
    "DI": ("max DI", 1, 4, "10 % or 0.003"), "DI_open": ("max DI_open", 1, 4, "30 % or 0.001"),
    "DI_slip_shear_limit": ("shear-limit DI_slip", 1, 4, "20 % or 0.003"), "Psi": ("max Psi", 1, 2, "15 % or 0.1"),
}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, required=True)
    folder = parser.parse_args().out
    folder.mkdir(parents=True, exist_ok=True)
    print("| motion | quantity | YADE | reference: median (range) | allowed difference | verdict |",
          "| --- " * 6 + "|", sep="\n")
    for motion, words in MOTIONS.items():
        for line in nonlinear_rows(folder, motion, words):
            print(line, flush=True)
    print("\n| wall | motion | drift, RMS of the difference | allowed |\n" + "| --- " * 4 + "|")
    for wall in WALLS:
        for motion, words in ELASTIC.items():
            result = compare(*pair(folder, wall, motion, words))["drift"]
            rms, allowed = 100 * result["rms_before_failure"], 100 * result["allowed"]
            print(f"| {wall} | {motion} | {rms:.2f} % | {allowed:.1f} % |", flush=True)


def nonlinear_rows(folder, motion, words):
    """Lines of the table for one motion of the symmetric wall."""
    yade, _ = pair(folder, "symmetric", motion, words, reference=False)
    members = [run(folder, "reference", "symmetric", motion, [*words, "--scatter", "0.001", "--seed", str(seed)], seed)
               for seed in range(1, MEMBERS + 1)]
    result = compare(yade, members)
    for key, (label, factor, digits, allowed) in FIGURES.items():
        row = result["figures"][key]
        low, high = (f"{factor * value:.{digits}f}" for value in row["range"])
        spread = "" if low == high else f" ({low} to {high})"
        yield (f"| {motion if key == 'max_drift_ratio' else ''} | {label} | {factor * row['first']:.{digits}f} | "
               f"{factor * row['median']:.{digits}f}{spread} | {allowed} | {'holds' if row['agrees'] else 'DIFFERS'} |")
    drift, joints = result["drift"], result["joints"]
    diverged = "never" if drift["diverged_at_s"] is None else f"{drift['diverged_at_s']:.3f} s"
    yield (f"| | drift to the first failure at {drift['first_failure_s']:.4f} s, RMS | | "
           f"{100 * drift['rms_before_failure']:.3f} % | 0.5 % | {'holds' if drift['agrees'] else 'DIFFERS'} |")
    yield f"| | diverged by 1 % of the peak; kappa of the contact points | | {diverged}; {joints['kappa']:.2f} | | |"
    for what, words in (("broken", "broken joints"), ("visible", "joints over 0.1 mm")):
        yield pattern_row(words, result["patterns"][what])


def pattern_row(words, scores):
    """Line of the table for one of `damage.measure.patterns.compare_patterns`."""
    lacking = "" if scores["tells_sides"] else ", does not distinguish sides"
    holds = scores["fss"] >= LEAST_FSS and scores["fss"] > scores["shuffled"]
    return (f"| | FSS of {words} (shuffled, mirrored) | | {scores['fss']:.2f} ({scores['shuffled']:.2f}, "
            f"{scores['mirrored']:.2f}{lacking}) | {LEAST_FSS} | {'holds' if holds else 'DIFFERS'} |")


def pair(folder, wall, motion, words, reference=True):
    """Histories of YADE and, unless it is not asked for, of the reference solver."""
    return (run(folder, "yade", wall, motion, words),
            [run(folder, "reference", wall, motion, words)] if reference else None)


def run(folder, solver, wall, motion, words, seed=0):
    """The History of one run, made where it is not there."""
    name = "".join(c if c.isalnum() or c == "." else "-" for c in f"{wall}_{motion}_{solver}_{seed}")
    path = folder / f"{name}.h5"
    if not path.exists():
        program = COMMAND if solver == "yade" else (sys.executable, "-m", "damage", "reference")
        part = folder / f"{name}.part.h5"
        subprocess.run([*program, f"walls/{wall}.py", *words, "--out", str(part), "--overwrite", "--no-pictures"],
                       cwd=ROOT, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        part.rename(path)
    return read_history(path)


if __name__ == "__main__":
    main()
