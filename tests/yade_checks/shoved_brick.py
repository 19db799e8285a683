"""Inside YADE: a brick is pushed across another that is at rest, until it has fallen by half its height.

    yade -n shoved_brick.py SPEED RESULTS.npz

SPEED [m/s] of the shove.  RESULTS holds at the samples: time_s (n,) since the shove; place (n, 3) of the brick [m, m,
rad]; opening_m, offset_m, state (n, contact points) of the joint between the bricks; energy_j (n,) of all kinds.
"""

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(sys.argv[0]).resolve().parents[2]))

from damage.law.modes import natural_modes
from damage.run.solver import NO_MOTION
from damage.units import GRAVITY
from damage.wall.layout import lay_out
from damage.wall.parameters import Joint, Wall
from yade_scripts.leaving import run_and_leave
from yade_scripts.solver import FOLLOW_STEPS, YadeSolver


def main():
    joint = Joint(tensile_strength=0.0, cohesion=0.0)
    layout = lay_out(Wall("pair", 0.1125, 0.15, precompression=0.0, joint=joint))
    solver = YadeSolver(layout, 0.3 * natural_modes(layout).critical_time_step_s)
    solver.scene.states[0].blockedDOFs = "xyzXYZ"
    solver.start(NO_MOTION, np.array([GRAVITY]))
    solver.damp(local=0.7)
    solver.advance(4000)
    solver.damp()
    solver.start(NO_MOTION, np.array([GRAVITY]))
    solver.set_velocities([np.zeros(3), (float(sys.argv[1]), 0.0, 0.0)])
    joints = np.flatnonzero(layout.contacts.first[:layout.n_joints] >= 0)
    rows = {name: [] for name in ("time_s", "place", "energy_j", "opening_m", "offset_m", "state")}

    def keep(now):
        energies = now.kinetic_j + now.elastic_j + now.friction_j + now.fracture_j - now.input_j
        row = {"time_s": now.clock[0] * solver.time_step, "place": now.displacement[0, 1],
               "energy_j": energies[0] + GRAVITY * layout.bodies.mass @ now.displacement[0, :, 1],
               **{name: values[0, joints].copy() for name, values in now.contacts.items() if name in rows}}
        for name, value in row.items():
            rows[name].append(value)
        return fallen() < layout.bodies.height[1] / 2

    def fallen():
        return -rows["place"][-1][1]

    while not rows["place"] or fallen() < layout.bodies.height[1] / 2:
        solver.advance(20 * FOLLOW_STEPS, FOLLOW_STEPS, keep)
    np.savez(sys.argv[2], **rows)


run_and_leave(main)
