"""Walls of houses: those that ship, one façade under five lintels, two walls in both solvers.

    python3 paper/houses.py ships              # modes, a push, BGAR x 1: a row a wall (5 minutes)
    python3 paper/houses.py facade             # lintels of an ordinary façade under BGAR x 3 (10 minutes)
    python3 paper/houses.py codes --out DIR    # YADE beside the reference solver under BGAR x 1.5 (an hour)

DIR keeps the histories of `codes`; those that are there already are not made again.
"""

import argparse
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

import damage
from damage.history.reader import read_history
from damage.law.modes import natural_modes
from damage.measure.compare import compare
from damage.measure.summary import summarise
from damage.wall.layout import lay_out
from damage.wall.materials import MATERIALS
from damage.wall.model_options import ModelOptions
from damage.wall.parameters import Joint, Opening, Wall
from yade_scripts import COMMAND

BGAR = "damage/data/zeerijp_20180108/BGAR_HGE_acc_m_s2.csv"
SHIPPED = ("terrace_end", "two_storeys", "shop_front", "calcium_silicate")
SHAKEN = {"window": (18.2, 20.2), "scatter": 0.001}
STRONG = (18.7, 19.5)
"""The strongest part of BGAR [s]."""
IN_YADE = {"terrace_end": (18.2, 20.2), "two_storeys": STRONG}
"""{wall that both solvers run: part of the record [s]}."""
PUSH_PCT = 0.02
MEMBERS = 5
FACADE = Wall("facade", 6.0, 3.0, precompression=0.1e6, openings=(
    Opening(1.8, 0.9, 2.025), *(Opening(left, 0.675, 1.425, 0.6) for left in (0.675, 3.15, 4.5))),
    joint=Joint(tensile_strength=0.1e6, cohesion=0.15e6), lintel="courses")
LINTELS = {  # words: (lintel of the wall, option)
    "all courses elastic": ("courses", "elastic"), "one course elastic": ("courses", 1),
    "timber beam": ("timber", "elastic"), "concrete beam": ("concrete", "elastic"), "flat arch": ("arch", "elastic")}
FIGURES = {  # of damage.measure.compare.TOLERANCES: label, factor, decimals
    "max_drift_ratio": ("maximum drift ratio [%]", 100, 4), "peak_base_shear_n": ("peak base shear [kN]", 1e-3, 1),
    "DI": ("maximum DI", 1, 4), "cycle_length_s": ("length of the free cycles [s]", 1, 4)}


def ships():
    """Table of the walls that ship as data."""
    _head("wall", "bricks", "first period [s]", f"base shear at {PUSH_PCT:g} % [kN]", "BGAR x 1: max DI",
          "drift ratio [%]", "base shear [kN]", "widest crack [mm]")
    for name in SHIPPED:
        path = ROOT / "walls" / f"{name}.toml"
        layout = lay_out(damage.load_wall(path))
        pushed = damage.run(str(path), pushover=PUSH_PCT)
        shaken = summarise(damage.run(str(path), BGAR, rest=0.3, window=STRONG))
        _row(f"`{name}`", layout.n_bricks, f"{natural_modes(layout).period_s[0]:.4f}",
             f"{pushed.series['base_shear_n'].abs().max() / 1e3:.1f}", f"{shaken['max']['DI']:.4f}",
             f"{100 * shaken['max_drift_ratio']:.4f}", f"{shaken['peak_base_shear_n'] / 1e3:.1f}",
             f"{shaken['max_crack_width_mm']:.3f}")


def facade(seeds):
    """Table of the façade's lintels: range over so many scatters of the strengths by 0.1 %."""
    _head("lintel", "first period [s]", "maximum DI", "drift ratio [%]", "base shear [kN]", "widest crack [mm]",
          "failed contact points", "ended")
    for words, (lintel, option) in LINTELS.items():
        wall = replace(FACADE, lintel=lintel)
        runs = [damage.run(wall, BGAR, scale=3, rest=0.3, lintel=option, **SHAKEN, seed=seed)
                for seed in range(1, seeds + 1)]
        found = [summarise(history) for history in runs]
        fell = [one["collapsed_at_s"] for one in found]
        period_s = natural_modes(lay_out(wall, ModelOptions(lintel=option))).period_s[0]
        _row(words, f"{period_s:.4f}", _range([one["max"]["DI"] for one in found], 2),
             _range([100 * one["max_drift_ratio"] for one in found], 3),
             _range([one["peak_base_shear_n"] / 1e3 for one in found], 0),
             _range([one["max_crack_width_mm"] for one in found], 1),
             _range([int(history.broken[-1].sum()) for history in runs], 0),
             "stands" if not any(fell) else f"falls at {_range([one for one in fell if one], 1)} s")


def codes(folder):
    """Table of both solvers on the gable and the two storeys that ship, as `coarse` makes them."""
    folder.mkdir(parents=True, exist_ok=True)
    _head("wall", "quantity", "YADE", "reference: median (range)", "allowed difference", "verdict")
    for name, window in IN_YADE.items():
        path = coarse(folder, name)
        words = ["--record", BGAR, "--window", *map(str, window), "--scale", "1.5", "--rest", "1"]
        yade = _history(folder, path, COMMAND, words, "yade")
        members = [_history(folder, path, (sys.executable, "-m", "damage", "reference"),
                            [*words, "--scatter", "0.001", "--seed", str(seed)], f"reference_{seed}")
                   for seed in range(1, MEMBERS + 1)]
        result = compare(yade, members)
        for key, (label, factor, digits) in FIGURES.items():
            row = result["figures"][key]
            if row["first"] is None:
                continue
            low, high = (f"{factor * value:.{digits}f}" for value in row["range"])
            _row(name, label, f"{factor * row['first']:.{digits}f}",
                 f"{factor * row['median']:.{digits}f} ({low} to {high})", f"{factor * row['allowed']:.{digits}f}",
                 "holds" if row["agrees"] else "DIFFERS")
        drift, joints = result["drift"], result["joints"]
        _row(name, "drift up to the first failure, RMS of the difference", "",
             f"{100 * drift['rms_before_failure']:.2f} %", f"{100 * drift['allowed']:.2g} %",
             "holds" if drift["agrees"] else "DIFFERS")
        _row(name, "contact points failed in either, in both", "",
             f"{joints['broke_in_either']}, {joints['broke_in_both']}", "", "")
        for what in ("broken", "visible"):
            scores = result["patterns"][what]
            if scores["fss"] is not None:
                _row(name, f"FSS of joints: {what} (shuffled)", "", f"{scores['fss']:.2f} ({scores['shuffled']:.2f})",
                     "0.8", "holds" if scores["fss"] >= 0.8 else "DIFFERS")


def coarse(folder, name):
    """The path of a shipped wall's copy, as a Python file, which YADE runs in minutes.

    Bricks are twice as long and high, joints brittle with the strengths of clay-strong, lintels of concrete: brittle
    arches of so few bricks fall by the floor's weight, in both solvers.
    """
    wall = damage.load_wall(ROOT / "walls" / f"{name}.toml")
    brick = replace(wall.brick, length=2 * wall.brick.length, height=2 * wall.brick.height)
    strong = MATERIALS["clay-strong"]
    joint = replace(wall.joint, mode_i_fracture_energy=None, mode_ii_fracture_energy=None,
                    tensile_strength=strong.tensile_strength, cohesion=strong.cohesion)
    path = folder / f"{name}.py"
    table = replace(wall, brick=brick, joint=joint, lintel="concrete").as_dict()
    path.write_text(f"import sys\n\nsys.path.insert(0, {str(ROOT)!r})\n\nfrom damage.wall.parameters import Wall\n\n"
                    f"TABLE = {table!r}\n\n\ndef wall():\n    return Wall.from_dict(TABLE)\n\n\n"
                    "if __name__ == '__main__':\n    from yade_scripts.run import main\n\n    main(wall)\n",
                    encoding="utf-8")
    return path


def _history(folder, wall, program, words, label):
    """The History of one run, made where it is not there."""
    path = folder / f"{wall.stem}_{label}.h5"
    if not path.exists():
        part = folder / f"{wall.stem}_{label}.part.h5"
        subprocess.run([*program, str(wall), *words, "--out", str(part), "--overwrite", "--no-pictures"], cwd=ROOT,
                       check=True, stdout=subprocess.DEVNULL)
        part.rename(path)
    return read_history(path)


def _range(values, digits):
    low, high = (f"{value:.{digits}f}" for value in (min(values), max(values)))
    return low if low == high else f"{low} to {high}"


def _head(*heads):
    _row(*heads)
    _row(*["---"] * len(heads))


def _row(*cells):
    print("| " + " | ".join(map(str, cells)) + " |", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=("ships", "facade", "codes"))
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--out", type=Path, default=Path("houses"))
    asked = parser.parse_args()
    {"ships": ships, "facade": lambda: facade(asked.seeds), "codes": lambda: codes(asked.out)}[asked.what]()


if __name__ == "__main__":
    main()
