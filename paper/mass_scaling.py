"""Tables of docs/validation/mass-scaling.md: walls with softening joints in explicit steps and with mass scaling.

    python3 paper/mass_scaling.py runs DIR [--draws 16] [--cases CASE ...]        # rows of DIR/runs.csv; goes on there
    python3 paper/mass_scaling.py table DIR/runs.csv                              # medians, two-sample tests
    python3 paper/mass_scaling.py curves DIR/runs.csv                             # fragility and lives
    python3 paper/mass_scaling.py periods | rocking | falling

A draw is one of the joints' strengths (coefficient of variation 0.3), or a life of the address.  Runs are not repeated
where their energy balance is off, so that each step is judged by itself.  `runs`, 16 draws of all cases: half an hour
on one idle core.
"""

import argparse
import csv
import sys
import time
from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np
import pandas as pd
from scipy.stats import binomtest, ks_2samp

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from damage.reference.together import run_references

import damage
from damage.history.in_memory import HistoryInMemory
from damage.law.modes import natural_modes
from damage.measure.tables import summary_row
from damage.mechanics.tables import FRACTURE, FRICTION
from damage.motion.intensity import pgv_m_s
from damage.reference.wall import ReferenceWall
from damage.run import scheme as schemes_of_runs
from damage.run.options import parse_run
from damage.run.schedule import SOFTENING_STEP_FACTOR
from damage.studies.fragility import fit
from damage.units import GRAVITY
from damage.wall.file import load_wall
from damage.wall.layout import lay_out
from damage.wall.parameters import Joint, Wall

DATA = "damage/data/zeerijp_20180108/"
BGAR = ["--record", f"{DATA}BGAR_HGE_acc_m_s2.csv", "--window", "18.2", "20.7", "--rest", "0.1"]
BZN1 = ["--record", f"{DATA}BZN1_HGE_acc_m_s2.csv", "--window", "17.5", "20", "--rest", "0.1"]
MID1 = ["--record", "damage/data/huizinge_20120816_synthetic/MID1_N_synthetic_acc_m_s2.csv", "--window", "0.8", "2.5",
        "--rest", "0.1"]
SYMMETRIC, ASYMMETRIC, SOLID = (f"walls/variants/{name}_softening.py" for name in ("symmetric", "asymmetric", "solid"))
TERRACE, HOUSE = "walls/terrace_end.toml", "walls/two_storeys.toml"
HARMONIC = ["--harmonic", "0.2", "0.05", "--rest", "0.1"]
CASES = {
    **{f"symmetric_mid1_{scale:g}": (SYMMETRIC, [*MID1, "--scale", str(scale)]) for scale in (1, 2, 3)},
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
    "deformable_mid1": (SYMMETRIC, [*MID1, "--scale", "2.5", "--bricks", "deformable", "--contacts", "gauss"]),
    "symmetric_pushed": (SYMMETRIC, ["--cyclic", "0.05,0.1", "--speed", "0.01"]),
}
"""{case: (wall file, words)}: the most telling first."""
SCHEMES = {"explicit": ["--settling", "adaptive"], "2e-4": ["--mass-scaling", "selective", "--dt", "2e-4"],
           "1e-4": ["--mass-scaling", "selective", "--dt", "1e-4"],
           "4e-4": ["--mass-scaling", "selective", "--dt", "4e-4"], "half": ["--settling", "adaptive"],
           "5e-5": ["--mass-scaling", "selective", "--dt", "5e-5"]}
"""{scheme: its words}; half: half of the explicit step; 5e-5: of deformable bricks alone, in place of half and 4e-4."""
MEASURES = ("max_DI", "max_drift_ratio", "residual_DI", "settled_psi", "max_psi", "max_crack_width_mm",
            "failed_length_m")
COMPARED = {"max_DI": "max DI", "max_drift_ratio": "drift", "residual_DI": "residual DI", "max_psi": "Psi",
            "max_crack_width_mm": "widest crack", "failed_length_m": "failed length"}


def runs(folder, draws, first, names):
    """Append rows of all cases, draws and schemes that runs.csv lacks."""
    schemes_of_runs.ACCEPTED_ERROR = schemes_of_runs.ACCEPTED_DROP_M = np.inf
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "runs.csv"
    done = set() if not path.is_file() else {
        tuple(row) for row in pd.read_csv(path)[["case", "scheme", "draw"]].astype(str).to_numpy()}
    for start, case, scheme in product(range(first, first + draws, 8), names, SCHEMES):
        asked = [draw for draw in range(start, min(start + 8, first + draws)) if (case, scheme, str(draw)) not in done]
        if asked and _is_wanted(case, scheme, start > first):
            _append(path, _batch(folder, case, scheme, asked))


def _is_wanted(case, scheme, later):
    """Whether a case is run with a scheme; later: after the first eight draws."""
    deforms = "deformable" in case
    return scheme not in (("half", "4e-4") if deforms else ("5e-5",)) and not (
        later and (deforms or scheme in ("half", "4e-4")))


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
             **(_values(histories[name].history()) if statuses[name] == 0 else {})}
            for draw, name in zip(draws, lines)]


def _draw(words, draw):
    if "--address" in words:
        return ["--life", str(draw), "--strength-cov", "0.3"]
    return ["--strength-cov", "0.3", "--strength-seed", str(draw)]


SOFTENED = """from dataclasses import replace
from itertools import product

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


def _values(history):
    """What the table needs of a History."""
    row = summary_row(history)
    row["failed_length_m"] = float(history.joint_length_m[history.broken[-1]].sum())
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


def table(path):
    """Print medians of each step beside explicit ones, and the least p of two-sample tests over the measures."""
    found = pd.read_csv(path)
    _head("wall and motion", "step", "draws", *(f"{words} [%]" if words != "residual DI" else words
                                                for words in COMPARED.values()),
          "least p", "energy error [%]", "time [s]")
    for case, of_case in found.groupby("case", sort=False):
        explicit = of_case[of_case["scheme"] == "explicit"].set_index("draw")
        for scheme, rows in of_case.groupby("scheme", sort=False):
            own = rows.set_index("draw")
            other = explicit.loc[own.index]
            error = 100 * own["energy_error_fraction"]
            tests = [ks_2samp(own[name], other[name]).pvalue for name in COMPARED]
            _row(case.replace("_", " "), scheme, len(own), *(_difference(own[name].median(), other[name].median(), name)
                                                             for name in COMPARED),
                 f"{min(tests):.2f}", f"{error.median():.3f} to {error.max():.3f}", f"{own['cpu_s'].median():.2f}")


def _difference(value, other, name):
    """A median as the table has it: of residual DI itself, of the others what it is above the explicit one [%]."""
    return f"{value:.4f}" if name == "residual_DI" else "0" if value == other else f"{100 * (value / other - 1):+.1f}"


def curves(path):
    """Print medians and dispersions of fragility over the PGV of records, and the shares of lives, by both steps, with
    95 % intervals: by 500 replicates of the draws, and Wilson's."""
    found = pd.read_csv(path)
    pgv = {case: 1e3 * pgv_m_s(parse_run(words, "", "reference").loading.applied())
           for case, (wall, words) in CASES.items() if wall == SYMMETRIC and words[0] == "--record"
           and not {"--sequence", "--bricks"} & set(words)}
    _head("exceeding", "step", "median [mm/s]", "dispersion")
    for measure, level in (("max_DI", 0.1), ("max_psi", 2.5)):
        for scheme in ("explicit", "1e-4", "2e-4"):
            runs = found[(found["scheme"] == scheme) & found["case"].isin(pgv)]
            over = runs.assign(over=runs[measure] >= level).pivot(index="draw", columns="case", values="over")
            drawn = np.random.default_rng(1).integers(len(over), size=(500, len(over)))
            intensity = np.array([pgv[case] for case in over.columns])
            fits = np.array([fit(intensity, over.iloc[rows].sum().to_numpy(), np.full(len(intensity), len(over)))
                             for rows in (range(len(over)), *drawn)])
            low, high = np.quantile(fits[1:], (0.025, 0.975), axis=0)
            _row(f"{measure} {level:g}", scheme, *(
                f"{value:.{digits}f} ({a:.{digits}f} to {b:.{digits}f})"
                for value, a, b, digits in zip(fits[0], low, high, (1, 2))))
    _head("lives with", "step", "share")
    for measure, level in (("max_psi", 1.0), ("max_psi", 2.0), ("max_DI", 0.05)):
        for scheme in ("explicit", "1e-4", "2e-4"):
            lives = found[(found["case"] == "symmetric_life") & (found["scheme"] == scheme)]
            count = int((lives[measure] >= level).sum())
            interval = binomtest(count, len(lives)).proportion_ci(method="wilson")
            _row(f"{measure} {level:g}", scheme, f"{count} of {len(lives)} ({interval.low:.2f} to {interval.high:.2f})")


def periods():
    """Print by how much the scheme lengthens natural periods, by its closed form."""
    _head("wall", "step [s]", "T1 [%]", "T2 [%]", "T3 [%]", "30 Hz [%]")
    for wall in (SYMMETRIC, ASYMMETRIC, SOLID, TERRACE, HOUSE):
        omega = 2 * np.pi / np.append(natural_modes(lay_out(load_wall(ROOT / wall))).period_s[:3], 1 / 30)
        for step in (1e-4, 2e-4, 4e-4):
            slower = 2 / step * np.arcsin(step / 2 * omega / np.sqrt(1 + 0.5 * (step * omega)**2))
            _row(Path(wall).stem, f"{step:g}", *(f"{100 * (one / other - 1):.4f}" for one, other in zip(omega, slower)))


def rocking():
    """Print free rocking of a pier whose base, or whose every joint, is dry, released with a speed of its top."""
    plain = Wall("pier", 4.5 * 0.225, 33 * 0.075, precompression=0.3e6,
                 joint=Joint(tensile_strength=0.21e6, cohesion=0.24e6))
    _head("dry joints", "step", "peak [mm]", "second upward crossing [s]", "last peak [mm]", "friction [J]",
          "of kinetic energy [J]", "imbalance [J]")
    for name, speed in (("base", 0.25), ("all", 0.15)):
        layout = lay_out(plain)
        dry = (layout.contacts.first < 0) | (name == "all")
        layout = replace(layout, contacts=replace(layout.contacts, **{
            strength: np.where(dry, 0.0, getattr(layout.contacts, strength))
            for strength in ("tensile_strength", "cohesion")}))
        modes = natural_modes(layout)
        for step in (0.643 * modes.critical_time_step_s, 5e-5, 1e-4, 2e-4, 4e-4):
            _row(name, f"{step:.3g}", *_rocked(layout, step, step > modes.critical_time_step_s,
                                               speed * modes.shape[0]))


def _rocked(layout, step, scaled, velocity):
    """Cells of a row of `rocking`."""
    wall = ReferenceWall(layout, step, scaled=scaled)
    wall.adaptive_damping = 1.0
    wall.start(np.zeros((0, 2)), GRAVITY * np.minimum(1.0, np.arange(round(0.2 / step)) * step / 0.2))
    wall.run(round(0.5 / step))
    wall.adaptive_damping = 0.0
    wall.start(np.zeros((0, 2)))
    wall.energy[:] = 0.0
    wall.velocity = velocity
    rest, kinetic, before = wall.displacement, wall.kinetic_energy(), _stored(wall, layout)
    every, top = round(2e-3 / step), []
    for _ in range(1250):
        wall.run(every)
        top.append(1e3 * (wall.displacement - rest)[layout.drift_bodies, 0].mean())
    top, time_s = np.array(top), np.arange(1, 1251) * every * step
    rises = np.flatnonzero((top[:-1] < 0) & (top[1:] >= 0))
    imbalance = _stored(wall, layout) - before + wall.energy[FRICTION] + wall.energy[FRACTURE]
    crossing = f"{time_s[rises[1]]:.3f}" if len(rises) > 1 else ""
    return (f"{np.abs(top).max():.2f}", crossing, f"{np.abs(top[-312:]).max():.2f}", f"{wall.energy[FRICTION]:.1f}",
            f"{kinetic:.1f}", f"{imbalance:.3f}")


def _stored(wall, layout):
    return (wall.kinetic_energy() + wall.elastic_energy()
            + GRAVITY * float(layout.bodies.mass @ wall.displacement[:, 1]))


def falling():
    """Print when a spandrel without a lintel falls: explicitly, with mass scaling, and as a user gets it."""
    accepted = schemes_of_runs.ACCEPTED_DROP_M
    _head("draw", "explicit [s]", "mass scaling alone [s]", "as offered [s]", "repeated for")
    for draw in range(1, 9):
        times = []
        for limit, words in ((accepted, {"settling": "adaptive"}), (np.inf, {"mass_scaling": "selective", "dt": 2e-4}),
                             (accepted, {"mass_scaling": "selective", "dt": 2e-4})):
            schemes_of_runs.ACCEPTED_DROP_M = limit
            history = damage.run(str(ROOT / SYMMETRIC), str(ROOT / BGAR[1]), window=(18.2, 20.7), scale=2.5, rest=0.1,
                                 lintel="none", strength_cov=0.3, strength_seed=draw, **words)
            times.append(history.collapsed_at_s)
        _row(draw, *("stands" if one is None else f"{one:.3f}" for one in times), history.parameters["repeated_for"])


def _head(*names):
    print("\n| " + " | ".join(names) + " |\n" + "| --- " * len(names) + "|", flush=True)


def _row(*cells):
    print("| " + " | ".join(map(str, cells)) + " |", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=("runs", "table", "curves", "periods", "rocking", "falling"))
    parser.add_argument("paths", type=Path, nargs="*", metavar="PATH")
    parser.add_argument("--cases", nargs="+", choices=CASES, default=list(CASES))
    parser.add_argument("--draws", type=int, default=16)
    parser.add_argument("--first", type=int, default=1)
    asked = parser.parse_args()
    if asked.what in ("periods", "rocking", "falling"):
        globals()[asked.what]()
    elif not asked.paths:
        parser.error(f"{asked.what}: expected a path; give one")
    elif asked.what == "runs":
        runs(asked.paths[0], asked.draws, asked.first, asked.cases)
    else:
        {"table": table, "curves": curves}[asked.what](asked.paths[0])


if __name__ == "__main__":
    main()
