"""Inside YADE: two bricks, the lower one fixed, the upper one moved from corner to corner of a path.

    yade -n offset_of_two_bricks.py CORNERS.npy RESULTS.npy

CORNERS is (n, 2), opening and shear displacement [m] of the joint between the bricks; RESULTS gets (n, 3): its opening,
slip and offset [m] at each corner, as a run records them.
"""

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(sys.argv[0]).resolve().parents[2]))

from damage.run.solver import NO_MOTION
from damage.wall.kinds import BED
from damage.wall.layout import lay_out
from damage.wall.parameters import Wall
from yade_scripts.leaving import run_and_leave
from yade_scripts.solver import FOLLOW_STEPS, YadeSolver

STEP = 1e-6  # [s]; nothing is free to move, so any step will do
STEPS = 200  # from corner to corner


def main():
    layout = lay_out(Wall("pair", length=0.1125, height=0.15, precompression=0.0))
    joints = np.flatnonzero((layout.contacts.kind == BED) & (layout.contacts.first >= 0))
    solver = YadeSolver(layout, STEP)
    for state in solver.scene.states:
        state.blockedDOFs = "xyzXYZ"
    solver.start(NO_MOTION, np.zeros(1))
    rows, here = [], np.zeros(2)
    for there in np.load(sys.argv[1]):
        opening, shear = (there - here) / (STEPS * STEP)
        for velocity, steps in (((shear, opening, 0.0), STEPS), (np.zeros(3), FOLLOW_STEPS)):
            solver.set_velocities([np.zeros(3), velocity])
            solver.advance(steps, FOLLOW_STEPS, lambda now: True)
        now, here = solver.instants(), there
        rows.append([np.mean(values[0, joints]) for values in (
            now.contacts[name] for name in ("opening_m", "slip_m", "offset_m"))])
    np.save(sys.argv[2], rows)


run_and_leave(main)
