"""Inside YADE: bricks without any bond that fall on each other and on the ground.

    yade -n loose_bricks.py RESULTS.npz

Four scenes: "corner", bricks dropped on their corners; "edges", that come down edge against edge; "step", one that
slides off a step; "stack", six bricks of which the upper ones are pushed over.  RESULTS holds for each, as SCENE_NAME,
at 100 instants:
energy (n,): kinetic, elastic and of gravity, above the start's [J]; released (n,): what gravity has given so far [J];
overlap (n,): the deepest of two bricks or of a brick in the ground [m]; place (n, n_bricks, 3) [m, m, rad].
"""

import math
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(sys.argv[0]).resolve().parents[2]))

from yade import O, Quaternion, Vector3

from damage.units import GRAVITY
from damage.wall.geometry import body_corners, body_table
from damage.wall.layout import lay_out
from damage.wall.parameters import Joint, Wall
from yade_scripts.leaving import run_and_leave
from yade_scripts.model import build
from yade_scripts.scene import SceneReader
from yade_scripts.solver import TIDY_STEPS

STEP = 3e-5  # [s], as walls are run
INSTANTS = 100


def scene_of(length, courses):
    """A wall without bonds: (layout, model, reader)."""
    layout = lay_out(Wall("loose", length, 0.075 * courses, precompression=0.0,
                          joint=Joint(tensile_strength=0.0, cohesion=0.0)))
    model = build(layout, STEP)
    reader = SceneReader(model)
    O.engines = [model.newton, *O.engines[:-1]]
    model.newton.warnNoForceReset = False
    O.step()
    for joint in range(layout.n_joints):
        model.loosen(joint)
    model.arm()
    model.newton.gravity = (0, 0, -GRAVITY)
    return layout, model, reader


def put(reader, body, x=0.0, z=0.0, turn=0.0, velocity=(0.0, 0.0)):
    """Move a body by x, z [m], rotate it clockwise [rad] and give it a velocity [m/s]."""
    state = reader.states[body]
    state.pos = state.pos + Vector3(x, 0, z)
    state.ori = Quaternion(Vector3(0, 1, 0), turn) * state.ori
    state.vel = Vector3(velocity[0], 0, velocity[1])


def corner():
    """Two half bricks, tilted, fall from 0.2 and 0.36 m."""
    scene = scene_of(0.225, 2)
    put(scene[2], 1, z=0.2, turn=0.5)
    put(scene[2], 2, z=0.36, turn=-0.9)
    return scene, 0.6


def edges():
    """A half brick comes down on its edge, 0.1 mm beside the edge of the brick below; another straight on it."""
    scene = scene_of(0.225, 2)
    half_diagonal = math.hypot(0.1125, 0.075) / 2
    turn = math.atan2(0.075, 0.1125)  # one edge is lowest, right below the centre
    put(scene[2], 2, x=0.225 + 1e-4 - 0.16875, z=0.15 + half_diagonal - 0.0375 - 0.075, turn=math.pi / 2 - turn)
    put(scene[2], 1, x=-0.05625 + 1e-5, z=0.3 + half_diagonal - 0.0375 - 0.075, turn=math.pi / 2 - turn)
    return scene, 0.6


def step():
    """A brick slides off the one below at 1 m/s."""
    scene = scene_of(0.1125, 2)
    put(scene[2], 1, velocity=(1.0, 0.0))
    return scene, 0.5


def stack():
    """Six half bricks, the upper four of them pushed to one side."""
    scene = scene_of(0.1125, 6)
    for body in range(2, 6):
        put(scene[2], body, velocity=(0.3 * (body - 1), 0.0))
    return scene, 0.8


def depth(corners):
    """Deepest overlap of any two rectangles, or of one and the ground z < 0 [m]; corners: (n, 4, 2)."""
    found = max(0.0, -float(corners[:, :, 1].min()))
    for one in range(len(corners)):
        for other in range(one):
            if np.linalg.norm(corners[one].mean(0) - corners[other].mean(0)) < 0.25:
                found = max(found, _overlap(corners[one], corners[other]))
    return found


def _overlap(one, other):
    """Depth of the overlap of two rectangles, 0 where an axis separates them (separating axis theorem)."""
    depths = []
    for sides in (one, other):
        for a, b in ((0, 1), (1, 2)):
            axis = (sides[b] - sides[a]) / np.linalg.norm(sides[b] - sides[a])
            p, q = one @ axis, other @ axis
            depths.append(min(p.max() - q.min(), q.max() - p.min()))
    return max(0.0, min(depths))


def follow(scene, seconds):
    layout, model, reader = scene
    table, mass = body_table(layout), reader.mass
    each = round(seconds / STEP / INSTANTS)
    rows, places = [], []
    O.step()  # the members go where their bricks were put
    for instant in range(INSTANTS):
        motion = reader.motion()
        speed = reader.synchronous_velocities(STEP / 2, (0.0, 0.0))
        height = GRAVITY * float(layout.bodies.mass @ motion[:, 1])
        rows.append((0.5 * float(np.sum(mass * speed**2)) + reader.elastic_energy(np.ones(layout.n_joints, bool))
                     + height, height, depth(body_corners(table, motion))))
        places.append(motion)
        O.run(each, True)
        if instant % max(1, TIDY_STEPS // each) == 0:
            model.tidy()
    energy, height, overlap = np.array(rows).T
    return {"energy": energy - energy[0], "released": np.maximum.accumulate(height[0] - height), "overlap": overlap,
            "place": np.array(places)}


def main():
    found = {}
    for make in (corner, edges, step, stack):
        found |= {f"{make.__name__}_{name}": values for name, values in follow(*make()).items()}
    np.savez(sys.argv[1], **found)


run_and_leave(main)
