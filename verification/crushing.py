"""Joints that crush: a toe under a rigid block, a column, and cycles of a joint.

A rigid block on a joint of compressive strength f_c, pressed by N and pushed sideways at its centre, h / 2 up, turns
about a toe on which the stress is f_c: a stress block of length N / (f_c t), so that

    H h / 2 = N / 2 (L - N / (f_c t)).

With n contact points of length l the toe's last one is crushed in part; that puts the resultant up to l / 8 over the
toe's length in points aside.  A column bears no more than f_c A.  A joint that is pressed further each time, and
unloaded between, dissipates f_c times its closure; so does one that crushes and is then pulled apart, beside G_I.
"""

from dataclasses import replace
from functools import cache

import numpy as np

from damage.units import GRAVITY
from damage.wall.layout import lay_out
from damage.wall.parameters import ModelOptions, Wall
from verification import softening
from verification.block import STICKY, one_block, settle, solver_of
from verification.problem import Problem, ask_yade
from verification.softening import Driven

TOE = 0.25
"""Share of the block's length that its toe takes."""
BLOCK = replace(softening_block := one_block().wall.brick, length=0.4, height=0.8, thickness=0.1)
