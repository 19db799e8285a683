"""Inside YADE: a brick whose bonds are gone falls 5 mm back onto the brick below, a quarter brick aside.

    yade -n loose_brick.py RESULT.npz

RESULT holds `height` (n,), of the brick over where it was bonded [m], from the drop to rest, and
`contacts`, how many pairs of cells touch at the end.
"""

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(sys.argv[0]).resolve().parents[2]))

from yade import O, Vector3

from damage.wall.layout import BED, lay_out
from damage.wall.parameters import Wall
from yade_scripts.leaving import run_and_leave
from yade_scripts.model import build


def drop():
    layout = lay_out(Wall("pair", length=0.1125, height=0.15, precompression=0.0))
    model = build(layout, 2e-6)
    O.step()
    for joint in np.flatnonzero((layout.contacts.kind == BED) & (layout.contacts.first >= 0)):
        model.bonds[joint].phys.isCohesive = False
        model.bonds[joint].phys.FnMax = model.bonds[joint].phys.FsMax = 0.0
        O.interactions.erase(model.bonds[joint].id1, model.bonds[joint].id2)
    brick = O.bodies[model.clumps[1]].state
    start = brick.pos[2]
    brick.pos = Vector3(brick.pos[0] + 0.028, brick.pos[1], start + 5e-3)
    model.newton.gravity, model.newton.damping = (0, 0, -9.81), 0.3
    heights = []
    for _ in range(300):
        O.run(200, True)
        heights.append(brick.pos[2] - start)
    touching = sum(1 for i in O.interactions if i.isReal and i.phys.normalForce.norm() > 0)
    return np.array(heights), touching


def main():
    height, contacts = drop()
    np.savez(sys.argv[1], height=height, contacts=contacts)


run_and_leave(main)
