"""Tables of docs/validation/mass-scaling.md: walls with softening joints in explicit steps and with mass scaling.

    python3 paper/mass_scaling.py runs DIR [--draws 16] [--first 1] [--cases CASE ...]    # rows of DIR/runs.csv; goes on there
    python3 paper/mass_scaling.py table DIR/runs.csv [--accepted]                 # medians, differences, tests
    python3 paper/mass_scaling.py curves DIR/runs.csv                             # fragility of the symmetric wall
    python3 paper/mass_scaling.py periods | rocking | falling

A draw is one of the joints' strengths (coefficient of variation 0.3), or a life of the address.  Runs are not repeated
where their energy balance is off, so that each step is judged by itself; --accepted puts together what a user gets.
`runs`, 16 draws of all cases: hours on one core.
"""

import argparse
import csv
import sys
import time
from pathlib import Path

import numpy as np
import pandas as pd
from scipy.stats import ks_2samp

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from damage.history.in_memory import HistoryInMemory
from damage.law.modes import natural_modes
from damage.measure.tables import summary_row
from damage.reference.together import run_references
from damage.run import scheme as schemes_of_runs
from damage.run.schedule import SOFTENING_STEP_FACTOR
from damage.run.settings import ACCEPTED_ERROR
from damage.wall.file import load_wall
from damage.wall.layout import lay_out

DATA = "damage/data/zeerijp_20180108/"
BGAR = ["--record", f"{DATA}BGAR_HGE_acc_m_s2.csv", "--window", "18.2", "20.7", "--rest", "0.1"]
BZN1 = ["--record", f"{DATA}BZN1_HGE_acc_m_s2.csv", "--window", "17.5", "20", "--rest", "0.1"]
MID1 = ["--record", "damage/data/huizinge_20120816_synthetic/MID1_N_synthetic_acc_m_s2.csv", "--window", "0.8", "2.5",
        "--rest", "0.1"]
SYMMETRIC, ASYMMETRIC, SOLID = (f"walls/variants/{name}_softening.py" for name in ("symmetric", "asymmetric", "solid"))
TERRACE, HOUSE = "walls/terrace_end.toml", "walls/two_storeys.toml"
HARMONIC = ["--harmonic", "0.2", "0.05", "--rest", "0.1"]
CASES = {
    "symmetric_mid1": (SYMMETRIC, [*MID1, "--scale", "2.5"]),
    "symmetric_bgar": (SYMMETRIC, [*BGAR, "--scale", "2.5"]),
    "asymmetric_mid1": (ASYMMETRIC, [*MID1, "--scale", "2.5"]),
    "solid_harmonic": (SOLID, ["--harmonic", "0.1", "0.3", "--rest", "0.1"]),
    "terrace_bgar": (TERRACE, [*BGAR, "--scale", "2"]),
    "symmetric_harmonic": (SYMMETRIC, HARMONIC),
    "asymmetric_bgar": (ASYMMETRIC, [*BGAR, "--scale", "2.5"]),
    "symmetric_settled": (SYMMETRIC, ["--settle", "hogging", "--distortion", "1/600", *MID1, "--scale", "1.5"]),
    "symmetric_bzn1": (SYMMETRIC, [*BZN1, "--scale", "3"]),
    "symmetric_mid1_1.5": (SYMMETRIC, [*MID1, "--scale", "1.5"]),
    "symmetric_sequence": (SYMMETRIC, [*MID1, "--scale", "2", "--sequence", "1,0.8,1,0.6"]),
    "house_mid1": (HOUSE, [*MID1, "--scale", "1.5"]),
    "solid_mid1": (SOLID, [*MID1, "--scale", "4"]),
    "symmetric_mid1_3.5": (SYMMETRIC, [*MID1, "--scale", "3.5"]),
    "symmetric_life": (SYMMETRIC, ["--address", "studies/addresses/garsthuizen.toml", "--rest", "0.1"]),
    "symmetric_pushed": (SYMMETRIC, ["--cyclic", "0.05,0.1", "--speed", "0.01"]),
}
"""{case: (wall file, words)}: the most telling first."""
SCHEMES = {"explicit": ["--settling", "adaptive"], "2e-4": ["--mass-scaling", "selective", "--dt", "2e-4"],
           "1e-4": ["--mass-scaling", "selective", "--dt", "1e-4"],
           "4e-4": ["--mass-scaling", "selective", "--dt", "4e-4"], "half": ["--settling", "adaptive"]}
"""{scheme: its words}; half: half of the explicit step."""
MEASURES = {"max_DI": 1, "max_drift_ratio": 100, "residual_DI": 1, "settled_psi": 1, "max_psi": 1, "max_crack_width_mm": 1,
            "failed_length_m": 1}
LENGTH = "failed_length_m"


def runs(folder, draws, first, names):
    """Append rows of all cases, draws and schemes that runs.csv lacks."""
    schemes_of_runs.ACCEPTED_ERROR = schemes_of_runs.ACCEPTED_DROP_M = np.inf
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "runs.csv"
    done = set() if not path.is_file() else {
        tuple(row) for row in pd.read_csv(path)[["case", "scheme", "draw"]].astype(str).to_numpy()}
    for start in range(first, first + draws, 8):
        for case in names:
            for scheme in SCHEMES:
                asked = [draw for draw in range(start, min(start + 8, first + draws))
                         if (case, scheme, str(draw)) not in done]
                if asked and not (scheme in ("half", "4e-4") and start > first):
                    _append(path, _batch(folder, case, scheme, asked))


def _batch(folder, case, scheme, draws):
    """Rows of a case with a scheme, one a draw."""
    wall, words = _wall(folder, CASES[case][0]), CASES[case][1]
    step = ["--dt", repr(0.5 * SOFTENING_STEP_FACTOR * natural_modes(lay_out(load_wall(wall))).critical_time_step_s)]
    lines = {f"{case}_{scheme}_{draw}": [wall, *words, *SCHEMES[scheme], *(step if scheme == "half" else ()),
                                         *_draw(words, draw), "--no-pictures", "--overwrite", "--out",
                                         str(folder / f"{case}_{scheme}_{draw}.h5")] for draw in draws}
    histories = dict.fromkeys(lines, HistoryInMemory)
    begun, statuses = time.process_time(), dict(run_references(lines.items(), histories))
    spent = (time.process_time() - begun) / len(draws)
    return [{"case": case, "scheme": scheme, "draw": draw, "status": statuses[name], "cpu_s": round(spent, 3),
             **(_row(histories[name].history()) if statuses[name] == 0 else {})}
            for draw, name in zip(draws, lines)]


def _draw(words, draw):
    if "--address" in words:
        return ["--life", str(draw), "--strength-cov", "0.3"]
    return ["--strength-cov", "0.3", "--strength-seed", str(draw)]


SOFTENED = """from dataclasses import replace

from damage.wall.file import load_wall
from damage.wall.parameters import softening_energies


def wall():
    made = load_wall({path!r})
    return replace(made, joint=replace(made.joint, **softening_energies(made.joint.tensile_strength)))
"""


def _wall(folder, wall):
    """Path of the wall, of one with brittle joints that of a copy with fracture energies by the rule."""
    path = ROOT / wall
    if load_wall(path).joint.softens:
        return str(path)
    made = folder / f"{path.stem}_softening.py"
    made.write_text(SOFTENED.format(path=str(path)), encoding="utf-8")
    return str(made)


def _row(history):
    """What the table needs of a History."""
    row = summary_row(history)
    row[LENGTH] = float(history.joint_length_m[history.broken[-1]].sum())
    return {name: row[name] for name in (*MEASURES, "energy_error_fraction", "time_step_s", "collapsed_at_s")}


def _append(path, rows):
    fields = ["case", "scheme", "draw", "status", "cpu_s", *MEASURES, "energy_error_fraction", "time_step_s",
              "collapsed_at_s"]
    new = not path.is_file()
    with path.open("a", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, fields)
        if new:
            writer.writeheader()
        writer.writerows(rows)
    print(rows[0]["case"], rows[0]["scheme"], len(rows), f"{rows[0]['cpu_s']:.2f} s a run", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=("runs", "table", "curves", "periods", "rocking", "falling"))
    parser.add_argument("path", type=Path, nargs="?")
    parser.add_argument("--cases", nargs="+", choices=CASES, default=list(CASES))
    parser.add_argument("--draws", type=int, default=16)
    parser.add_argument("--first", type=int, default=1)
    parser.add_argument("--accepted", action="store_true")
    asked = parser.parse_args()
    if asked.what == "runs":
        runs(asked.path, asked.draws, asked.first, asked.cases)


if __name__ == "__main__":
    main()
