"""What every solver looks at while it runs: the index of this instant, and whether a brick fell."""

import numpy as np

from damage.index import THRESHOLD, combine, drift_component, length_fraction


def index_now(layout, drift_ratio, opening, slip):
    """The damage index of one instant, displacement criterion; opening, slip: (n_joints,) [m]."""
    length = layout.contacts.length[:layout.n_joints]
    return float(combine(min(1.0, drift_component(drift_ratio)), length_fraction(opening > THRESHOLD, length),
                         length_fraction(np.abs(slip) > THRESHOLD, length)))


def has_collapsed(layout, motion):
    """Whether a brick has dropped by half its height; motion: (n_bodies, 3) since the static stage."""
    bricks = slice(0, layout.n_bricks)
    return bool(np.any(-motion[bricks, 1] > layout.bodies.height[bricks] / 2))
