"""Kinds of contact points, and the number of the first support."""

GROUND = -1
"""The first support, body -1; others follow as -2, -3, ... (`damage.wall.supports`)."""
BED, HEAD, CUT, CAP = 0, 1, 2, 3
KINDS = ("bed", "head", "brick", "cap")
"""On bed and head joints, on the cuts where bricks can split, on the caps' glue."""
