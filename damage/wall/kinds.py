"""Kinds of contact points, and the body that is none: the ground."""

GROUND = -1
BED, HEAD, CUT, CAP = 0, 1, 2, 3
KINDS = ("bed", "head", "brick", "cap")
"""On bed and head joints, on the cuts where bricks can split, on the caps' glue."""
