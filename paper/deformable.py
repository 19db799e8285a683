"""Deformable bricks beside rigid ones: first periods with a triangle mesh as an independent check,
and what they cost.

    python3 -m paper deformable periods [WALL ...]  # of the shipped walls, by default
    python3 -m paper deformable cost [WALL]         # time per step and per run, processor time
    python3 -m paper deformable runs DIR            # the symmetric wall shaken, five members a row,
                                                    # as a table

`runs` keeps its histories in DIR and makes only those that are missing; the table has the rows that
are there.
"""

import json
import resource
import subprocess
import sys
import time
import timeit
from itertools import product
from pathlib import Path

import numpy as np
import pandas as pd

from damage.history.reader import read_history
from damage.law.modes import natural_modes
from damage.measure.cracks import psi_history
from damage.reference.lanes import run_together
from damage.reference.solver import ReferenceSolver
from damage.run.schedule import STEP_FACTOR
from damage.run.settings import HOLD_S, RAMP_S, SETTLE_S
from damage.units import GRAVITY
from damage.wall.file import load_wall
from damage.wall.layout import lay_out
from damage.wall.model_options import ModelOptions
from paper.bench import EXPLICIT, REPOSITORY, arguments, option, print_row, print_table, wall_file
from paper.softening import softened
from verification.triangles import Mesh

WALLS = ("solid", "symmetric", "asymmetric")
MODELS = {
    "rigid bricks": {},
    "order 2": {"bricks": "deformable"},
    "order 3": {"bricks": "deformable", "brick_order": 3},
}
CELLS = (2, 4, 8)
STEPS = 1000

DEFORM, WEAKER, STRONGER = ["--bricks", "deformable"], ["0.2", "0.05"], ["0.33", "0.1"]
# name: (words, joints, harmonic motion, options), rigid ones first: times are compared with theirs
RUNS = {
    "rigid": ("rigid", "brittle", WEAKER, []),
    "deformable": ("deformable (default: mass x 9, damped)", "brittle", WEAKER, DEFORM),
    "soft_rigid": ("rigid", "softening", WEAKER, []),
    "strong_rigid": ("rigid", "brittle", STRONGER, []),
    "strong_soft_rigid": ("rigid", "softening", STRONGER, []),
    "strong_deformable": ("deformable", "brittle", STRONGER, DEFORM),
    "soft_deformable": ("deformable", "softening", WEAKER, DEFORM),
    "strong_soft_deformable": ("deformable", "softening", STRONGER, DEFORM),
    "undamped": (
        "deformable, modes undamped, mass x 9",
        "brittle",
        WEAKER,
        [*DEFORM, "--brick-damping", "0"],
    ),
    "true_mass": (
        "deformable, damped, true mass",
        "brittle",
        WEAKER,
        [*DEFORM, "--brick-mass", "1"],
    ),
    "undamped_true_mass": (
        "deformable, undamped, true mass",
        "brittle",
        WEAKER,
        [*DEFORM, "--brick-damping", "0", "--brick-mass", "1"],
    ),
    "points": (
        "deformable, twice the contact points",
        "brittle",
        WEAKER,
        [*DEFORM, "--cells", "4"],
    ),
}
"""Runs of `runs`, in order of their importance."""


def periods(names):
    """First periods [s] by rigid bricks, both orders and triangle meshes."""
    for name in names:
        wall = load_wall(f"walls/{name}.py")
        for label, options in MODELS.items():
            layout = lay_out(wall, ModelOptions(contacts="gauss", **options))
            print(f"{name}, {label}: {natural_modes(layout, 1).period_s[0]:.4f} s", flush=True)
        for cells in CELLS:
            layout = lay_out(wall, ModelOptions(contacts="gauss", cells=cells, bricks="deformable"))
            print(
                f"{name}, triangles, {cells} cells a brick:"
                f" {Mesh(layout, cells).first_period():.4f} s",
                flush=True,
            )


def cost(name):
    """Processor time of a step, intact, and of a run of 0.6 s, rest of 2 s and settling, a wall."""
    wall, base = load_wall(f"walls/{name}.py"), None
    for together, (label, options) in product((8, 1), MODELS.items()):
        walls = [standing(wall, options) for _ in range(together)]
        layout, time_step, step = walls[0].layout, walls[0].time_step, time_of_step(walls)
        run = (
            step * ((0.0 if layout.strain else RAMP_S) + HOLD_S + 0.6 + 2.0 + SETTLE_S) / time_step
        )
        base = (step, run) if layout.strain is None else base
        print(
            f"{together} together, {label}: {len(layout.contacts)} points, time step"
            f" {1e6 * time_step:.3g} us; {1e6 * step:.1f} us a step and wall"
            f" ({step / base[0]:.1f}), {run:.1f} s a run ({run / base[1]:.1f})",
            flush=True,
        )


def time_of_step(walls):
    """Processor time of a step and wall [s], the least of three attempts."""
    run_together(walls, 10)  # compiles
    times = timeit.repeat(
        lambda: run_together(walls, STEPS), timer=time.process_time, number=1, repeat=3
    )
    return min(times) / STEPS / len(walls)


def standing(wall, options):
    """A solver of a wall at rest under its weight."""
    layout = lay_out(wall, ModelOptions(contacts="gauss", **options))
    solver = ReferenceSolver(layout, STEP_FACTOR * natural_modes(layout, 1).critical_time_step_s)
    solver.add_static_displacement()
    solver.start(np.zeros((0, 2)), np.array([GRAVITY]))
    return solver


def runs(folder):
    """Make the RUNS that are missing, and print the table of those that are there."""
    folder.mkdir(parents=True, exist_ok=True)
    wall_file(folder / "softening.toml", softened(load_wall("symmetric"), "12.4/124"))
    missing = [name for name in RUNS if not (folder / f"{name}_seconds.json").is_file()]
    for more in ([], DEFORM) if missing else ():  # compiling does not count
        simulate("walls/variants/small.py", ["0.05", "0.01"], more, folder / "warm.h5")
    for name in missing:
        _, joints, motion, options = RUNS[name]
        wall = folder / "softening.toml" if joints == "softening" else "walls/symmetric.py"
        before = _processor_s()
        simulate(wall, motion, options, folder / f"{name}.h5")
        (folder / f"{name}_seconds.json").write_text(json.dumps(_processor_s() - before))
    print_runs(folder)


def simulate(wall, motion, options, out):
    """Five members of a run."""
    subprocess.run(
        [
            sys.executable,
            "-m",
            "damage",
            "reference",
            wall,
            "--harmonic",
            *motion,
            "--rest",
            "1",
            "--contacts",
            "gauss",
            *EXPLICIT,
            *options,
            "--members",
            "5",
            "--no-pictures",
            "--quiet",
            "--overwrite",
            "--out",
            out.resolve(),
        ],
        cwd=REPOSITORY,
        check=True,
    )


def print_runs(folder):
    """Print the table of the RUNS that are in a folder, without times where FILE_seconds.json holds
    null."""
    print_table(
        "motion",
        "joints",
        "bricks",
        "T0 [s]",
        "largest drift [%]",
        "DI, slip by displacement",
        "DI, slip by shear limit",
        "failed contact points",
        "length of cracks, first member [m]",
        "time to rigid bricks",
    )
    rigid = {}
    for name, (bricks, joints, motion, _) in RUNS.items():
        if not (kept := folder / f"{name}_seconds.json").is_file():
            continue
        seconds, table = json.loads(kept.read_text()), pd.read_csv(folder / f"{name}_members.csv")
        first = rigid.setdefault((joints, *motion), seconds)
        # null where something else was compiled
        times = "" if None in (seconds, first) else f"{seconds / first:.1f}"
        print_row(
            f"{motion[0]} s, {motion[1]} g",
            joints,
            bricks,
            f"{table.eigen_period_s[0]:.4f}",
            _spread(100 * table.max_drift_ratio),
            _spread(table["max_DI"]),
            _spread(table["max_shear_limit_DI"]),
            _spread(table.tension_breaks + table.shear_breaks, "{:.0f}"),
            f"{psi_history(read_history(folder / f'{name}.h5')).crack_length_m.max():.1f}",
            times,
        )


def _spread(values, form="{:.3f}"):
    """Median and range as text."""
    return (
        f"{form.format(values.median())} ({form.format(values.min())}-{form.format(values.max())})"
    )


def _processor_s():
    """Processor time of all ended child processes [s]."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def main():
    asked = arguments(
        __doc__,
        option("what", choices=("periods", "cost", "runs")),
        option("walls", nargs="*", help="walls, or the folder of `runs`"),
    )
    {
        "periods": lambda: periods(asked.walls or WALLS),
        "runs": lambda: runs(Path(*asked.walls)),
        "cost": lambda: cost(*(asked.walls or ["symmetric"])),
    }[asked.what]()
