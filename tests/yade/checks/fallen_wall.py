"""Inside YADE: the spandrel of a small dry wall without a lintel falls and comes to rest.

    yade -n fallen_wall.py CONTACTS SECONDS RESULTS.npz

The wall is `spandrel` of tests/core/test_ends.py, here under its weight from the first
step.  RESULTS holds every 0.01 s: time_s (n,); place (n, n_bodies, 3) [m, m, rad]; energy_j (n,),
elastic, kinetic and of gravity.  Impacts are damped once a brick has fallen by half its height, as
in a run.
"""

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(sys.argv[0]).resolve().parents[3]))

from damage import Joint, ModelOptions, Opening, Wall
from damage.linear.modes import natural_modes
from damage.run.monitor import have_fallen, lowest_places
from damage.run.solver import NO_MOTION
from damage.units import GRAVITY
from damage.wall.layout import lay_out
from yade_scripts.leaving import run_and_leave
from yade_scripts.solver import FOLLOW_STEPS, YadeSolver

INTERVAL_S = 0.01


def main():
    joint = Joint(tensile_strength=0.0, cohesion=0.0)
    layout = lay_out(
        Wall("spandrel", 1.8, 0.9, [Opening(0.45, 0.9, 0.675)], precompression=0.0, joint=joint),
        ModelOptions(lintel="none", contacts=sys.argv[1]),
    )
    solver = YadeSolver(layout, 0.6 * natural_modes(layout).critical_time_step_s, new_contacts=True)
    solver.start(NO_MOTION, np.array([GRAVITY]))
    rows = {name: [] for name in ("time_s", "place", "energy_j")}

    def keep(now):
        rows["time_s"].append(now.clock[0] * solver.time_step)
        rows["place"].append(now.displacement[0])
        rows["energy_j"].append(
            now.kinetic_j[0]
            + now.elastic_j[0]
            + GRAVITY * layout.bodies.mass @ now.displacement[0, :, 1]
        )
        return True

    steps = FOLLOW_STEPS * round(INTERVAL_S / solver.time_step / FOLLOW_STEPS)
    lowest = lowest_places(layout)
    fell = False
    while not rows["time_s"] or rows["time_s"][-1] < float(sys.argv[2]):
        solver.advance(steps, steps, keep)
        if not fell and have_fallen(rows["place"][-1][None], lowest)[0]:
            fell = True
            solver.damp_impacts()
    np.savez(sys.argv[3], **rows)


run_and_leave(main)
