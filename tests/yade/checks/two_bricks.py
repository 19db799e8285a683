"""Inside YADE: two bricks, the lower one fixed, the upper one driven along prescribed paths.

    yade -n two_bricks.py PATHS.npz RESULTS.npz

PATHS holds one array (n_steps, 2) a case, opening and shear displacement [m] of the joint between
the bricks; RESULTS gets (n_steps, 2), normal and shear stress [Pa] on it, under the same names.
"""

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(sys.argv[0]).resolve().parents[3]))

from yade import O, Vector3

from damage import Wall
from damage.wall.kinds import BED
from damage.wall.layout import lay_out
from yade_scripts.leaving import run_and_leave
from yade_scripts.model import build
from yade_scripts.scene import SceneReader

STEP = 1e-6  # [s]; nothing is free to move, so any step will do


def drive(path):
    """Stresses (n_steps, 2) along one path."""
    layout = lay_out(Wall("pair", length=0.1125, height=0.15, precompression=0.0))
    model = build(layout, STEP)
    scene = SceneReader(model)
    joint = np.flatnonzero((layout.contacts.kind == BED) & (layout.contacts.first >= 0))
    lower, upper = (O.bodies[clump].state for clump in model.clumps)
    lower.blockedDOFs = upper.blockedDOFs = "xyzXYZ"
    area = layout.contacts.area[joint].sum()
    O.step()  # YADE takes the bonds' zero in the first step
    stresses, here = [], np.zeros(2)
    for there in path:
        opening, shear = (there - here) / STEP
        upper.vel, here = Vector3(shear, 0, opening), there
        O.step()  # moves at the step's end ...
        upper.vel = Vector3.Zero
        O.step()  # ... and feels it in the next
        for broken in scene.beyond_strength()[0]:
            model.loosen(broken)
        force = sum(
            (
                model.signs[j] * (scene.physics[j].normalForce + scene.physics[j].shearForce)
                for j in joint
            ),
            Vector3.Zero,
        )
        stresses.append((-force[2] / area, -force[0] / area))
    return np.array(stresses)


def main():
    with np.load(sys.argv[1]) as paths:
        np.savez(sys.argv[2], **{name: drive(paths[name]) for name in paths})


run_and_leave(main)
