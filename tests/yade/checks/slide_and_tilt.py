"""Inside YADE: forces of a dry joint during large slip, and contact points of a tilted block.

    yade -n slide_and_tilt.py RESULTS.npz

RESULTS holds, of two bricks under a brick that is pressed on them and slid by 10 mm: `slid` (n,)
[m], `pressure`, `shear` (n,) [Pa] and `couple` (n,), the sum of all moments about one point [N m];
of a block of 0.8 m that was tilted about its outermost contact point: `tilt` (m,) [rad] and
`overlap` (m,) [m].
"""

import math
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(sys.argv[0]).resolve().parents[3]))

from yade import O, Quaternion, Vector3

from damage import Brick, Joint, Wall
from damage.wall.kinds import BED
from damage.wall.layout import lay_out
from yade_scripts.leaving import run_and_leave
from yade_scripts.model import build
from yade_scripts.scene import SceneReader

STEP = 1e-6  # [s]; nothing is free to move, so any step will do
PRESSURE = 0.3e6  # [Pa]


class Scene:
    """A wall whose bodies all have prescribed motions."""

    def __init__(self, wall):
        self.layout = lay_out(wall)
        self.model = build(self.layout, STEP)
        self.reader = SceneReader(self.model)
        for state in self.reader.states:
            state.blockedDOFs = "xyzXYZ"

    def step(self):
        O.step()
        for joint in self.reader.beyond_strength()[0]:
            self.model.loosen(joint)

    def move(self, bodies, dx, dz, steps):
        for _ in range(steps):
            for body in bodies:
                self.reader.states[body].vel = Vector3(dx / steps / STEP, 0, dz / steps / STEP)
            self.step()
            for body in bodies:
                self.reader.states[body].vel = Vector3.Zero
            self.step()


def slide():
    scene = Scene(Wall("pair", length=0.225, height=0.15, precompression=0.0))
    contacts = scene.layout.contacts
    upper = [1, 2]
    joint = np.flatnonzero((contacts.kind == BED) & (contacts.first >= 0))
    area = contacts.area[joint].sum()
    scene.step()
    scene.move(upper, 0.0, -PRESSURE / contacts.normal_stiffness[joint[0]], 100)
    rows = []
    for slid in np.linspace(0, 0.0104, 27)[1:]:
        scene.move(upper, 0.0004, 0.0, 200)
        force = sum(
            (
                scene.model.signs[j]
                * (scene.reader.physics[j].normalForce + scene.reader.physics[j].shearForce)
                for j in joint
            ),
            Vector3.Zero,
        )
        on_bodies = scene.reader.resultants()
        couple = sum(
            moment + state.pos[0] * fz - state.pos[2] * fx
            for (fx, fz, moment), state in zip(on_bodies, scene.reader.states)
        )
        rows.append((slid, force[2] / area, -force[0] / area, couple))
    return np.array(rows).T


def tilt():
    block = Brick(length=0.2, height=0.8, thickness=0.1)
    dry = Joint(tensile_strength=0.0, cohesion=0.0)
    scene = Scene(Wall("block", 0.2, 0.8, brick=block, joint=dry, precompression=0.0))
    contacts = scene.layout.contacts
    state = scene.reader.states[0]
    outermost = int(np.argmax(contacts.x))
    arm = np.array([0.1 - contacts.x[outermost], 0.4])  # from the contact point to the centre
    scene.move([0], 0.0, 1e-4, 3)  # breaks all bonds
    scene.move([0], 0.0, -1e-4, 3)
    upright = state.ori  # now that the tips are on
    rows = []
    for angle in (0.006, 0.025, 0.062):
        cos = math.cos(angle)
        sin = math.sin(angle)
        state.pos = Vector3(
            contacts.x[outermost] + cos * arm[0] + sin * arm[1], 0, cos * arm[1] - sin * arm[0]
        )
        state.ori = Quaternion(Vector3(0, 1, 0), angle) * upright
        scene.step()  # the members follow ...
        scene.step()  # ... and are felt
        rows.append((angle, max(-scene.reader.opening_of(joint) for joint in range(len(contacts)))))
    return np.array(rows).T


def main():
    slid, pressure, shear, couple = slide()
    angle, overlap = tilt()
    np.savez(
        sys.argv[1],
        slid=slid,
        pressure=pressure,
        shear=shear,
        couple=couple,
        tilt=angle,
        overlap=overlap,
    )


run_and_leave(main)
