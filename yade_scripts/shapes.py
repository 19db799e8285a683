"""Visible shape of a brick: a polyhedron where YADE was built with CGAL, else a box."""

import yade
from yade import log, utils

HAS_POLYHEDRA = hasattr(yade, "Polyhedra") or (
    "CGAL" in yade.config.features and hasattr(utils, "polyhedron")
)

BRICK_SHAPE = "polyhedra" if HAS_POLYHEDRA else "boxes"
"""Shape of bricks, in the log and in the versions of a history."""

if HAS_POLYHEDRA:
    log.setLevel("Polyhedra_support.cpp", 0)  # it warns at every brick of a legitimate shape


def brick_shape(centre, half, material, color):
    """A polyhedron in the shape of a brick, for display only; centre, half: centre and half sizes
    (x, y, z) [m]."""
    corners = [
        tuple(c + s * h for c, s, h in zip(centre, signs, half))
        for signs in ((a, b, c) for a in (-1, 1) for b in (-1, 1) for c in (-1, 1))
    ]
    brick = utils.polyhedron(corners, material=material, color=color, wire=False)
    brick.bounded = False
    return brick
