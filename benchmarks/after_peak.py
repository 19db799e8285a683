"""The tables of docs/validation/after-the-peak.md: laws of the joint one at a time and together, beside tested walls.

    python3 benchmarks/after_peak.py [--out DIR] [TABLE ...]

TABLE: laws, prediction, cycles; all by default, in the reference solver, about 25 minutes on one core.  Histories that
are already in DIR are not run again.
"""

import contextlib
import io
import sys
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple
from unittest import mock

import numpy as np
import pandas as pd

REPOSITORY = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(REPOSITORY))

from benchmarks.softening import main, print_row, print_table
from damage import brick_of_masonry, read_history
from damage.laboratory.pushed import SPECIMENS, TESTS, read_test
from damage.measure import pushed
from damage.measure.energy import DISSIPATED
from damage.reference.session import BACKEND
from damage.run.session import run_session
from damage.wall import layout as layouts
from damage.wall.file import load_wall
from damage.wall.materials import MATERIALS
from damage.wall.parameters import crushing_energy, softening_energies

HELD = {"squat_tested": [], "comp2_4": ["--boundary", "fixed"], "comp2_1": ["--boundary", "fixed"],
        "comp2_3": ["--boundary", "fixed"]}
"""Wall -> how it is held."""
SLIDES = ("squat_tested", "comp2_4")
"""The walls whose tests failed in shear; the others rocked."""
FARTHEST = {"squat_tested": 0.3, "comp2_4": 0.3, "comp2_1": 4.0, "comp2_3": 2.0}
"""To which drift a wall is pushed [%]."""
SPEED = {True: 4e-3, False: 2e-2}
"""Speed of the top of a wall that slides, and of one that rocks [m/s]."""
CYCLES = {True: ("0.005,0.01,0.025,0.05,0.1,0.15,0.2,0.25,0.3", 8e-3), False: ("0.5,1,2,3,3.5", 8e-2)}
"""Amplitudes [%], one cycle each, and speed [m/s], of a wall that slides, and of one that rocks."""
SCATTER = 0.35
"""Coefficient of variation of the joints' strengths."""
ALONG_COURSES = 0.4
"""Correlation of the strengths of neighbouring bed joints of a course (Heffler, Stewart, Masia, Corrêa 2008)."""
MODULUS = MATERIALS["sarhosis-2021"].young_modulus


class Law(NamedTuple):
    """energies: (G_I, G_II) [J/m2], None by the rule; crushes: by the tested strength and the rule for its fracture
    energy; modulus: of the masonry [Pa], None as tested; scatter: coefficient of variation; of: function in place of
    `layouts._scattered`."""

    energies: tuple | None = None
    crushes: bool = False
    modulus: float | None = None
    scatter: float = 0.0
    of: object = None


def weaker_heads(wall, contacts, *scatters, share=0.3, usual=layouts._scattered):
    """Contacts whose head joints have 0.3 of the strengths."""
    contacts = usual(wall, contacts, *scatters)
    factor = np.where(contacts.kind == layouts.HEAD, share, 1.0)
    return replace(contacts, tensile_strength=contacts.tensile_strength * factor, cohesion=contacts.cohesion * factor)


def along_courses(wall, contacts, scatter, _):
    """Contacts whose strengths are correlated along courses, and independent between them."""
    variation, seed = scatter
    table = pd.DataFrame({"first": np.maximum(contacts.first, layouts.GROUND), "second": contacts.second,
                          "x": contacts.x, "z": contacts.z.round(4), "head": contacts.kind == layouts.HEAD})
    number = table.groupby(["first", "second"], sort=False).ngroup()
    joints = table.groupby(number)[["x", "z", "head"]].mean()
    random, normal = np.random.default_rng(seed), np.zeros(len(joints))
    for _, rows in joints.groupby(["head", "z"]):
        apart = np.abs(np.subtract.outer(rows.x.to_numpy(), rows.x.to_numpy())) / (wall.brick.length / 2)
        normal[rows.index] = np.linalg.cholesky(ALONG_COURSES**apart) @ random.standard_normal(len(rows))
    spread = np.sqrt(np.log1p(variation**2))
    factor = np.exp(spread * normal - spread**2 / 2)[number]
    return replace(contacts, **{name: np.where(contacts.elastic, np.inf, getattr(wall.joint, name) * factor)
                                for name in ("tensile_strength", "cohesion")})


LAWS = {
    "rule": Law(), "clay strong, 19/353 J/m²": Law((19.0, 353.0)), "head joints at 0.3": Law(of=weaker_heads),
    "strengths scatter by 0.35": Law(scatter=SCATTER),
    "... correlated along courses": Law(scatter=SCATTER, of=along_courses),
    "crushing softens": Law(crushes=True)}
ROCKING = ("crushing softens",)
"""Laws of walls that rock; without crushing, and with plastic crushing: benchmarks/split_and_crush.py."""
PREDICTION = Law(crushes=True, modulus=MODULUS, scatter=SCATTER)
SEEDS = (1, 2)


def wall_by(name, law):
    """The wall of a shipped file by a Law."""
    wall = load_wall(REPOSITORY / "walls" / f"{name}.py")
    energies = softening_energies(wall.joint.tensile_strength) if law.energies is None else dict(
        zip(("mode_i_fracture_energy", "mode_ii_fracture_energy"), law.energies))
    if law.crushes:
        energies["compressive_strength"] = strength = 1e6 * float(
            pd.read_csv(TESTS).set_index("Specimen").loc[SPECIMENS[name], "fm_c_MPa"])
        energies["compressive_fracture_energy"] = crushing_energy(strength)
    joint, brick = replace(wall.joint, **energies), wall.brick
    if law.modulus:
        brick = brick_of_masonry(law.modulus, joint, length=brick.length, height=brick.height,
                                 thickness=brick.thickness)
    return replace(wall, joint=joint, brick=brick)


def run(bench, name, label, law, words, seed=1):
    """The History of a wall by a Law."""
    words = [*words, *HELD[name]]
    if law.scatter:
        words += ["--strength-cov", law.scatter, "--strength-seed", seed]
    kept = "_".join([name, label, *(str(word).strip("-") for word in words)])
    out = bench.folder / f"{''.join(c if c.isalnum() or c in '._-' else '-' for c in kept)}.h5"
    if not (out.exists() and read_history(out).complete):
        quiet = io.StringIO()
        with contextlib.redirect_stdout(quiet), contextlib.redirect_stderr(quiet), \
                mock.patch.object(layouts, "_scattered", law.of or layouts._scattered):
            status = run_session(BACKEND, REPOSITORY / "walls" / f"{name}.py", lambda: wall_by(name, law), [
                *map(str, words), "--out", str(out), "--overwrite", "--no-pictures"], prog="after_peak")
        if status != 0:
            sys.exit(f"{out.stem} failed\n{quiet.getvalue()[-2000:]}")
    return read_history(out)


def push(name):
    """The words of a push of a wall."""
    return ["--pushover", FARTHEST[name], "--speed", SPEED[name in SLIDES]]


HEADS = ("wall", "law", "peak [kN]", "test", "secant [kN/mm]", "test", "bilinear [kN]", "test",
         "mean force to the test's ultimate drift [kN]", "test", "left there [kN]", "test", "ultimate drift [%]",
         "test", "friction [J]", "fracture [J]", "failure (on stairs)", "test")


def row(label, name, history):
    """A run beside its test, both as means over the directions of loading."""
    test, height = read_test(SPECIMENS[name]), history.attributes["drift_height_m"]
    curves = [pushed.capacity_curve(history, sign) for sign in ((1, -1) if history.loading.cycles else (1,))]
    if not history.loading.cycles:
        curves = [pushed.averaged(curve, float(curve["drift_ratio"].max()) / 200) for curve in curves]
    lines, reached = [pushed.bilinear(curve, height) for curve in curves], float(np.mean(test.ultimate_drift))
    far = min(float(curve["drift_ratio"].max()) for curve in curves)
    ultimate = 100 * np.mean([line["ultimate_drift"] for line in lines])
    shares, lost = pushed.mode_shares(history, until=ultimate / 100), history.series[list(DISSIPATED[:2])].iloc[-1]
    mean = lambda values, unit=1e3: f"{np.mean(values) / unit:.1f}"  # noqa: E731
    there = [(pushed.mean_force(curve, reached), float(np.interp(reached, curve["drift_ratio"], curve["force_n"])))
             for curve in curves] if far >= 0.99 * reached else []
    print_row(
        SPECIMENS[name], label, mean([curve["force_n"].max() for curve in curves]), mean(test.peak_force_n),
        mean([line["stiffness_n_per_m"] for line in lines], 1e6), mean(test.stiffness_n_per_m, 1e6),
        mean([line["force_n"] for line in lines]), mean(test.bilinear_force_n),
        *((mean([mean_force for mean_force, _ in there]) if there else "-",
           mean([energy / drift / test.height for energy, drift in zip(test.energy_j, test.ultimate_drift)]),
           mean([left for _, left in there]) if there else "-",
           mean([pushed.ULTIMATE_SHARE * force for force in test.peak_force_n]))),
        f"over {ultimate:.2f}" if ultimate > 99 * far else f"{ultimate:.3f}",
        f"{100 * reached:.2f}", f"{lost.iloc[0]:.0f}", f"{lost.iloc[1]:.0f}",
        f"{shares['mode']} ({100 * shares['stair_share']:.0f} %)", test.mode)


def laws(bench):
    """Pushes by one law at a time."""
    print_table(*HEADS)
    for name in HELD:
        for label, law in LAWS.items():
            if (name in SLIDES) != (label in ROCKING):
                row(label, name, run(bench, name, label, law, push(name)))


def prediction(bench):
    """Pushes by the prediction, with several draws of the strengths."""
    print_table(*HEADS)
    for name in HELD:
        for seed in SEEDS:
            row(f"seed {seed}", name, run(bench, name, "prediction", PREDICTION, push(name), seed))


def cycles(bench):
    """Cycles by the prediction, and of the first wall by the rule."""
    print_table(*HEADS)
    for name in (*SLIDES, "comp2_1"):
        amplitudes, speed = CYCLES[name in SLIDES]
        words = ["--cyclic", amplitudes, "--cycles", 1, "--speed", speed]
        for label, law in {"prediction": PREDICTION, **({"rule": LAWS["rule"]} if name == SLIDES[0] else {})}.items():
            row(label, name, run(bench, name, label, law, words))


TABLES = {table.__name__: table for table in (laws, prediction, cycles)}


if __name__ == "__main__":
    main(TABLES, TABLES, "results/after_peak", __doc__)
