"""What a solver needs of a wall in YADE's scene, whichever model of the joints it is built with."""

from dataclasses import dataclass, field

import numpy as np
import yade
from yade import O, Vector3

from damage.wall.joint_law import friction_left, material_of

UNBREAKABLE = 1e300
"""Strength of joints that stay elastic [N]."""


@dataclass
class YadeWall:
    """A wall at rest, unloaded and bonded; all in the order of the layout.

    clumps: body ids (n_bodies,); members: [ids of the members that feel contacts] of each clump; bonds: YADE
    interactions (n_contacts,); signs: +1 where YADE's second body is the layout's second (n_contacts,);
    ground: ids of the fixed bodies below the base.
    """

    layout: object
    clumps: list
    members: list
    bonds: list
    signs: np.ndarray
    ground: list
    newton: object
    law: object
    bonded: np.ndarray = field(init=False)  # (n_contacts,): whether the interaction is still the first one
    turning: list = field(init=False)  # states that show how the bodies have turned
    frayed: dict = field(init=False, default_factory=dict)  # {joint: dry contact beside a bond that holds in part}

    def __post_init__(self):
        self.turning = [O.bodies[clump].state for clump in self.clumps]
        self.bonded = np.ones(len(self.bonds), dtype=bool)

    def loosen(self, joint):
        """Make of a bond that broke the dry joint that it leaves."""
        self.bonds[joint].phys.tanFrictionAngle = friction_left(True, material_of(self.layout.wall.joint))

    def crush(self, joint, more):
        """Move the rest position of a contact point by a closure [m]; whether what rubs there is another interaction
        now."""
        self.bonds[joint].phys.initD += more
        return False

    def arm(self):
        """From now on any two bricks that meet collide, and any brick with the ground."""

    def collisions(self):
        """YADE's interactions between bricks beside those of their joints, where the model tells them apart."""
        return []

    def friction_work(self):
        """What friction has taken [J], None where YADE's law does not sum it up."""

    def follow(self, anew):
        """After every step; anew: choose anew which joints may close or slide until the next time."""

    def tidy(self):
        """Forget what need not be looked at any more: collisions that are over, joints out of reach."""


def set_clump(state, mass, inertia):
    """In-plane motion; YADE sorts a clump's inertia with permuted axes, so all three are I_yy."""
    state.mass = mass
    state.inertia = Vector3(inertia, inertia, inertia)
    state.blockedDOFs = "yXZ"
    state.refPos = state.pos
    state.refOri = state.ori


def set_bond(phys, layout, index):
    """Give a JCFpm bond the area, stiffness and strength of its contact point."""
    contacts = layout.contacts
    area = float(contacts.area[index])
    phys.isCohesive = True
    phys.crossSection = area
    phys.kn = float(contacts.normal_stiffness[index]) * area
    phys.ks = float(contacts.shear_stiffness[index]) * area
    phys.FnMax = min(UNBREAKABLE, float(contacts.tensile_strength[index]) * area)
    phys.FsMax = min(UNBREAKABLE, float(contacts.cohesion[index]) * area)
    phys.tanFrictionAngle = friction_left(False, material_of(layout.wall.joint))


def joint_law():
    """YADE's JCFpm law, as all models use it."""
    return yade.Law2_ScGeom_JCFpmPhys_JointedCohesiveFrictionalPM(neverErase=True, smoothJoint=False,
                                                                  label="jointLaw")


def brick_color(layout, body):
    """Red, green, blue [-]: bricks in turns, so that they tell apart; caps grey."""
    colors = ((0.75, 0.42, 0.32), (0.66, 0.35, 0.27), (0.82, 0.50, 0.38))
    return colors[body % len(colors)] if layout.bodies.course[body] >= 0 else (0.6, 0.6, 0.6)
