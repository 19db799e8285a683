"""Inside YADE: the joint between two bricks (`verification.softening`), driven along paths.

    ./yade -n -j1 verification/yade_paths.py PATHS.npz RESULTS.npz CHANGES

PATHS holds one array (n, 2) a path, opening and shear displacement [m]; RESULTS gets (n, 2) under
the same names, normal and shear stress on the joint [Pa], and as NAME/energies friction, fracture
and stored [J/m2].  CHANGES: of the joint's parameters, as JSON.
"""

import json
import sys
from pathlib import Path

sys.path.insert(0, str(Path(sys.argv[0]).resolve().parents[1]))

import numpy as np
from yade import O, Vector3

from verification.softening import joint_area, pair
from yade_scripts.leaving import run_and_leave
from yade_scripts.solver import YadeSolver

STEP = 1e-6  # [s]; nothing is free to move, so any step will do


def drive(path, changes):
    """Stresses (n, 2) along a path, and the energies at its end."""
    layout = pair(**changes)
    solver = YadeSolver(layout, STEP)
    area = joint_area(layout)
    states = solver.scene.states
    scene = solver.scene
    for state in states:
        state.blockedDOFs = "xyzXYZ"
    stresses = []
    here = np.zeros(2)
    for there in path:
        opening, shear = (there - here) / STEP
        states[1].vel = Vector3(shear, 0, opening)
        here = there
        O.step()  # a run of one step would wait 40 ms for its end
        if solver._raised:
            raise solver._raised
        solver._follow_joints()
        along, upward, _ = scene.resultants()[1]
        stresses.append((-upward / area, -along / area))
    tracker = solver.tracker
    energies = (
        tracker.friction_energy,
        tracker.fracture_energy,
        scene.elastic_energy(tracker.broken),
    )
    return np.array(stresses), np.array(energies) / area


def main():
    paths, out, changes = sys.argv[1:]
    found = {}
    with np.load(paths) as given:
        for name in given:
            found[name], found[f"{name}/energies"] = drive(given[name], json.loads(changes))
    np.savez(out, **found)


run_and_leave(main)
