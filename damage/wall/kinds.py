"""Kinds of contact points, and the numbers of supports."""

import numpy as np

GROUND = -1
"""The first support, body -1; others follow as -2, -3, ... (`damage.wall.layout.Supports`)."""
BED, HEAD, CUT, CAP = 0, 1, 2, 3
KINDS = ("bed", "head", "brick", "cap")
"""On bed and head joints, on the cuts where bricks can split, on the caps' glue."""


def rows(body, n_bodies):
    """Rows of bodies (n,), supports among them, in tables in which the supports follow n_bodies bricks and caps.

    >>> rows([3, -1, -2], 10)
    array([ 3, 10, 11])
    """
    body = np.asarray(body)
    return np.where(body < 0, n_bodies + GROUND - body, body)
