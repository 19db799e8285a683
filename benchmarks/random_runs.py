"""Random legal walls and motions: the command line against `damage.run`, and whether the energy
balance is credible.

    python3 benchmarks/random_runs.py [--runs 500] [--first 0] [--csv FILE]

Each seed draws a small wall (bricks, joints, openings, gable, floors, soil and other model options,
from the plausible values of `damage.house.plausible`) and a short motion.  It runs by the command
line and by `damage.run`.
A run is faulty where their histories differ in any bit, where the energy balance error is above the
limit and one of them does not warn, or where one of them is refused or fails and the other is not.
Exit status 1 where a run is faulty.
"""

import argparse
import io
import json
import sys
import warnings
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pandas as pd

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

import damage
from benchmarks.same_bits import differences, values
from damage.errors import RunError
from damage.history.reader import read_history
from damage.measure.energy import ENERGY_ERROR
from damage.measure.summary import summarise
from damage.reference.session import run_reference
from damage.wall.layout import lay_out
from damage.wall.model_options import ModelOptions

VERTICAL = (
    ROOT / "damage/data/zeerijp_20180108/NL.BGAR..HGZ__20180108T140037Z__20180108T140122Z.mseed"
)
MOST_TRIES = 200
"""Draws of a seed until one is legal."""


def draw(seed):
    """(damage.Wall, {option of damage.run: value}) of a seed: the first of its draws that is
    legal."""
    random = np.random.default_rng(seed)
    for _ in range(MOST_TRIES):
        try:
            wall = _wall(random, seed)
            model = _model(random)
            lay_out(
                wall,
                ModelOptions(
                    **{
                        name: value
                        for name, value in model.items()
                        if name in ModelOptions.__dataclass_fields__
                    }
                ),
            )
        except damage.InputError:
            continue
        return wall, model | _motion(random)
    raise RuntimeError(f"seed {seed}: no legal wall in {MOST_TRIES} draws")


def _wall(random, seed):
    brick = damage.Brick(
        **_rounded(
            length=random.uniform(0.15, 0.6),
            height=random.uniform(0.05, 0.25),
            thickness=random.uniform(0.08, 0.4),
            density=random.uniform(600, 2600),
            young_modulus=_log(random, 5e8, 5e10),
            shear_modulus=_log(random, 2e8, 2e10),
        ),
        **_sometimes(random, 0.1, tensile_strength=3e5),
    )
    courses = random.integers(1, 9)
    length = random.uniform(0.6, 6) * brick.length
    openings = [
        damage.Opening(
            **_rounded(
                left=random.uniform(0, 0.5) * length,
                width=random.uniform(0.1, 0.6) * length,
                height=random.integers(1, courses + 1) * brick.height,
                sill=random.integers(0, courses) * brick.height,
            )
        )
        for _ in range(random.choice(3, p=(0.6, 0.3, 0.1)))
    ]
    height = round(courses * brick.height, 4)
    gable = (
        [(0, 0.6 * height), (length / 2, height), (length, 0.6 * height)]
        if random.random() < 0.1
        else ()
    )
    floors = (
        [
            damage.Floor(
                level=height,
                mass=float(round(_log(random, 20, 2000))),
                kind=str(random.choice(["timber", "concrete"])),
            )
        ]
        if random.random() < 0.15
        else ()
    )
    return damage.Wall(
        f"random-{seed}",
        length,
        height,
        openings,
        outline=gable,
        floors=floors,
        brick=brick,
        joint=_joint(random),
        precompression=float(random.choice([0, round(_log(random, 1e3, 1e6))], p=(0.3, 0.7))),
        base_course=str(random.choice(["whole", "half"])),
        lintel=str(random.choice(["courses", "concrete", "timber"])),
    )


def _joint(random):
    stiffness = _log(random, 1e9, 2e12)
    dry = random.random() < 0.3
    strengths = (
        {"tensile_strength": 0.0, "cohesion": 0.0}
        if dry
        else _rounded(tensile_strength=_log(random, 2e3, 5e5), cohesion=_log(random, 5e4, 8e5))
    )
    energies = (
        _rounded(
            mode_i_fracture_energy=_log(random, 1, 100),
            mode_ii_fracture_energy=_log(random, 10, 1000),
        )
        if not dry and random.random() < 0.15
        else {}
    )
    return damage.Joint(
        **strengths,
        **energies,
        **_rounded(
            normal_stiffness=stiffness,
            shear_stiffness=0.4 * stiffness,
            friction_angle=random.uniform(0.1, 0.9),
        ),
        **_sometimes(random, 0.1, compressive_strength=2e6),
    )


def _model(random):
    """Options of the model, {option of damage.run: value}."""
    deformable = random.random() < 0.1
    return {
        "cells": int(random.choice([1, 2, 4])),
        "top": str(random.choice(["piers", "uniform", "beam"])),
        "load": str(random.choice(["length", "piers"])),
        "lintel": str(random.choice(["elastic", "none", "1"], p=(0.4, 0.4, 0.2))),
        "contacts": "interior" if random.random() < 0.7 else "corners",
        **_sometimes(random, 0.1, strength_cov=0.3, strength_seed=3),
        **_sometimes(random, 0.1, supports="bricks"),
        **_sometimes(random, 0.15, soil=f"{_log(random, 1e6, 1e10):.3g}"),
        **({"bricks": "deformable", "contacts": "gauss", "cells": 2} if deformable else {}),
    }


def _motion(random):
    """What drives a run, {option of damage.run: value}."""
    kind = random.choice(
        ["harmonic", "record", "free", "push", "cyclic", "settle", "sequence"],
        p=(0.5, 0.15, 0.05, 0.1, 0.05, 0.05, 0.1),
    )
    shaken = {
        "rest": 0.2,
        **_sometimes(random, 0.15, beta=1e-6),
        **_sometimes(random, 0.05, scatter=0.001, seed=2),
    }
    if kind == "harmonic" or kind == "sequence":
        motion = {
            "harmonic": (round(_log(random, 0.02, 0.5), 4), round(_log(random, 0.02, 1.5), 4)),
            "cycles": 2,
        }
        return motion | shaken | ({"sequence": (1, 0.6)} if kind == "sequence" else {})
    if kind == "record":
        record = {
            "record": "BGAR_HGE",
            "window": (19.0, 20.5),
            "scale": round(_log(random, 0.5, 8), 3),
        }
        return record | shaken | _sometimes(random, 0.3, vertical=str(VERTICAL))
    if kind == "free":
        return {"free_vibration": True, **shaken}
    if kind == "settle":
        return {
            "settle": str(random.choice(["hogging", "sagging", "tilt", "knick"])),
            "distortion": "1/800",
        }
    push = {"boundary": str(random.choice(["cantilever", "fixed"])), "speed": 0.02}
    return push | ({"pushover": 0.3} if kind == "push" else {"cyclic": (0.05, 0.1), "cycles": 1})


def _log(random, least, most):
    return float(np.exp(random.uniform(np.log(least), np.log(most))))


def _rounded(**values):
    return {name: float(f"{value:.4g}") for name, value in values.items()}


def _sometimes(random, share, **values):
    return values if random.random() < share else {}


def run(seed, folder):
    """The run of a seed both ways, a row of the table; its files are in the folder."""
    wall, options = draw(seed)
    row = {
        "seed": seed,
        "wall": f"{wall.length:.2f} x {wall.built_height:.2f} m",
        "options": " ".join(f"{name}={value}" for name, value in options.items()),
    }
    file, once, again = (
        folder / f"{wall.name}{ending}" for ending in (".py", "_once.h5", "_again.h5")
    )
    plain = json.loads(json.dumps(wall.as_dict()))  # numpy 2 writes its numbers as np.float64(...)
    file.write_text(
        f"from damage import Wall\n\n\ndef wall():\n    return Wall.from_dict({plain!r})\n"
    )
    with redirect_stdout(io.StringIO()), redirect_stderr(io.StringIO()) as said:
        status = run_reference([str(file), *_words(options), "--no-pictures", "--out", str(once)])
    row |= {"status": status, "said": said.getvalue().strip().splitlines()[-1:]}
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            damage.run(wall, out=again, **options)
            stopped = None
        except (damage.InputError, RunError) as error:
            stopped = str(error)
    if status or stopped:
        same = bool(status and stopped and stopped in said.getvalue())
        return row | {"fault": "" if same else f"status {status}, damage.run: {stopped}"}
    error = summarise(read_history(once))["energy_error_fraction"]
    differs = differences(values(once), values(again))
    silent = [
        name
        for name, text in (
            ("command line", said.getvalue()),
            ("damage.run", "".join(str(one.message) for one in caught)),
        )
        if "energy balance error" not in text
    ]
    faults = [f"steps differ: {differs[0]}"] if differs else []
    faults += (
        [f"error without a warning of {' and '.join(silent)}"]
        if (error or 0) > ENERGY_ERROR and silent
        else []
    )
    return row | {"energy_error": error, "warned": not silent, "fault": "; ".join(faults)}


def _words(options):
    """The options as words of a command line."""
    for name, value in options.items():
        yield f"--{name.replace('_', '-')}"
        if name in ("sequence", "cyclic"):
            yield ",".join(map(str, value))
        elif value is not True:
            yield from map(str, value if isinstance(value, tuple) else (value,))


def runs(seeds):
    """Table of the runs of these seeds, a DataFrame."""
    with TemporaryDirectory(prefix="random-runs-") as folder:
        rows = []
        for seed in seeds:
            rows.append(run(seed, Path(folder)))
            for path in Path(folder).glob(f"random-{seed}*"):
                path.unlink()
    return pd.DataFrame(rows).reindex(
        columns=["seed", "wall", "status", "energy_error", "warned", "fault", "said", "options"]
    )


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--runs", type=int, default=500)
    parser.add_argument("--first", type=int, default=0, help="the first seed")
    parser.add_argument("--csv", type=Path, help="where the table goes")
    asked = parser.parse_args()
    table = runs(range(asked.first, asked.first + asked.runs))
    if asked.csv:
        table.to_csv(asked.csv, index=False)
    done = table[table["status"] == 0]
    error = table["energy_error"].dropna()
    print(
        f"{len(table)} runs: {len(done)} complete, {len(table) - len(done)} refused or failed;"
        f" energy balance error: median {100 * error.median():.2g} %, above {100 * ENERGY_ERROR:g}"
        f" % in {(error > ENERGY_ERROR).sum()} runs, up to {100 * error.max():.3g} %"
    )
    faulty = table[table["fault"] != ""]
    print(
        f"{len(faulty)} faulty",
        *(f"seed {one.seed}: {one.fault}" for one in faulty.itertuples()),
        sep="\n  ",
    )
    return int(len(faulty) > 0)


if __name__ == "__main__":
    sys.exit(main())
