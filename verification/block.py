"""One rigid block on its joint to the ground, in the reference solver."""

import math
from dataclasses import replace

import numpy as np

from damage.linear.modes import natural_modes
from damage.reference.wall import ReferenceWall
from damage.wall.layout import lay_out
from damage.wall.model_options import ModelOptions
from damage.wall.parameters import Brick, Joint, Wall

DRY = Joint(tensile_strength=0.0, cohesion=0.0)
STICKY = replace(DRY, friction_angle=math.radians(80))
SLENDER = Brick(length=0.2, height=0.8, thickness=0.1)


def one_block(brick=None, joint=DRY, **options):
    """Layout of one brick on the ground."""
    brick = brick or Brick()
    return lay_out(
        Wall("block", brick.length, brick.height, brick=brick, joint=joint, precompression=0.0),
        ModelOptions(**options),
    )


def solver_of(layout, factor):
    """A ReferenceWall at `factor` of the critical time step."""
    return ReferenceWall(layout, factor * natural_modes(layout, 1).critical_time_step_s)


def settle(wall, gravity, seconds=0.05):
    """Let it come to rest under a gravity [m/s2]."""
    wall.adaptive_damping = 1.0
    wall.start(np.zeros((0, 2)), np.array([gravity]))
    wall.run(round(seconds / wall.time_step))
    wall.adaptive_damping = 0.0
    wall.velocity = 0.0


def foot(layout):
    """Distance of the outermost contact points from the block's middle [m]."""
    return float(np.abs(layout.contacts.x - layout.bodies.x[0]).max())
