"""Shake the wall US-1 by its run 21 in both solvers, for docs/validation/shaken-walls.md.

    python3 -m paper shaken_wall FOLDER     # two minutes; writes
                                            # docs/tables/benchmarks/us1_solvers.csv

The wall has the first bearing and brittle joints.  FOLDER has the files that
docs/validation/shaken-walls.md names; they have no licence and do not ship.
"""

import math
import sys
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pandas as pd
from scipy.optimize import brentq

from damage import Brick, Joint, Wall
from damage.linear.modes import natural_modes
from damage.measure.energy import energy_error_of
from damage.motion.intensity import response_spectrum
from damage.motion.record import Record, scaled
from damage.units import GRAVITY
from damage.wall.layout import lay_out
from damage.wall.model_options import ModelOptions
from damage.wall.restraints import Restraint
from paper.bench import REPOSITORY, Bench, arguments, option

OUT = REPOSITORY / "docs" / "tables" / "benchmarks" / "us1_solvers.csv"
HEIGHT_M, COURSES, WIDTH_M, THICK_M, DENSITY = 2.58, 43, 1.292, 0.21, 1885.0
LOAD_N = 10.35e3
"""On the top."""
COHESION_PA = 0.3e6
BEARING = {"stiffness": 3e6, "friction": 0.1, "play": 3e-3, "mass": 50.0}
"""The first bearing of the top, chosen on runs 1 to 10 [N/m, -, m, kg]."""
CELLS = 8
"""Contact points across a joint."""
PERIOD_S, DAMPING = 0.09153, 0.05
"""First period before run 1, and damping of the spectral displacement of each run at that
period."""
RIGID_PA = 1e15
"""Modulus of the bricks: all compliance is the joints', by the measured period."""
RUN, MOTION = 21, "hu12_x6_table_velocity_mm_s.txt"
"""The run, and the file of its strong phase: velocity of the table [mm/s] by STEP_S."""
STEP_S = 0.005
OPTIONS = (
    "--rest",
    0.3,
    "--contacts",
    "gauss",
    "--cells",
    CELLS,
    "--strength-cov",
    0.35,
    "--accept-implausible",
)


def strip(normal_stiffness):
    """Return the Wall with joints of this stiffness [Pa/m]."""
    joint = Joint(
        normal_stiffness,
        0.4 * normal_stiffness,
        math.radians(36.9),
        0.875 * COHESION_PA,
        COHESION_PA,
    )
    brick = Brick(
        2 * THICK_M,
        HEIGHT_M / COURSES,
        WIDTH_M,
        DENSITY,
        young_modulus=RIGID_PA,
        shear_modulus=RIGID_PA / 2.5,
    )
    return Wall(
        "us-1",
        THICK_M,
        HEIGHT_M,
        precompression=LOAD_N / (THICK_M * WIDTH_M),
        brick=brick,
        joint=joint,
        restraints=[Restraint("top", **BEARING)],
    )


def fitted():
    """Return the Wall whose first period is the measured one."""

    def excess(exponent):
        layout = lay_out(strip(10**exponent), ModelOptions(contacts="gauss", cells=CELLS))
        return natural_modes(layout, 1).period_s[0] - PERIOD_S

    return strip(10 ** brentq(excess, 8.5, 12.0, xtol=1e-4))


def displacement_mm(record):
    """Return the spectral displacement at PERIOD_S [mm]."""
    rested = replace(record, acceleration_m_s2=np.append(record.acceleration_m_s2, np.zeros(100)))
    return (
        1e3
        * GRAVITY
        * response_spectrum(rested, PERIOD_S, DAMPING)[0]
        * (PERIOD_S / 2 / math.pi) ** 2
    )


def motion(folder):
    """Return the Record of RUN, scaled to the spectral displacement that the table of runs has."""
    runs = pd.read_csv(folder / "US1_IM_vs_EDP.csv").set_index("run")
    lines = [line for line in (folder / MOTION).read_text().splitlines() if line[:1] != "#"]
    velocity = 1e-3 * np.array(" ".join(lines).split(), float)
    record = Record("HU12", STEP_S, np.gradient(velocity, STEP_S))
    return scaled(record, runs.loc[RUN, "sd_T1"] / displacement_mm(record))


def solvers(folder):
    """Run eight draws in the reference solver, and the first of them in YADE, with its own time
    step and with one of 40 microseconds; returns a row a run."""
    wall, rows = fitted(), []
    with TemporaryDirectory() as made:
        bench, file = Bench(Path(made)), Path(made) / "run.csv"
        record = motion(folder)
        samples = {"time_s": record.time_s, "acc_m_s2": record.acceleration_m_s2}
        pd.DataFrame(samples).to_csv(file, index=False, float_format="%.7g")
        for run, seed, *more in (
            *((bench.run, seed) for seed in range(1, 9)),
            (bench.run_in_yade, 1),
            (bench.run_in_yade, 1, "--dt", 4e-5),
        ):
            history = run(wall, ["--record", file, *OPTIONS, "--strength-seed", seed, *more])
            peak = (
                np.abs(history.series["drift_ratio"]).max() * history.attributes["drift_height_m"]
            )
            rows.append(
                {
                    "solver": history.solver,
                    "draw": seed,
                    "time_step_s": history.time_step_s,
                    "peak_mm_middle": 1e3 * peak,
                    "events": len(history.events),
                    "energy_balance_error_pct": 100 * energy_error_of(history),
                }
            )
    return pd.DataFrame(rows)


def main():
    folder = arguments(__doc__, option("folder", type=Path)).folder
    try:
        table = solvers(folder)
    except FileNotFoundError as error:
        print(
            f"error: no file {error.filename}: expected the files that"
            f" docs/validation/shaken-walls.md names; put them into {folder}",
            file=sys.stderr,
        )
        return 2
    table.to_csv(OUT, index=False, float_format="%.5g")
    print(OUT)
    return 0
