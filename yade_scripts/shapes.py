"""Which shape this YADE has for a brick: a polyhedron where it was built with CGAL, else its box."""

import yade
from yade import log, utils

HAS_POLYHEDRA = hasattr(yade, "Polyhedra") or ("CGAL" in yade.config.features and hasattr(utils, "polyhedron"))

BRICK_SHAPE = "polyhedra" if HAS_POLYHEDRA else "boxes"
"""Said in the log and in a history's versions."""

if HAS_POLYHEDRA:
    log.setLevel("Polyhedra_support.cpp", 0)  # it warns at every brick of a legitimate shape


def brick_shape(centre, half, material, color):
    """A polyhedron of a brick, for the eye alone: centre and half sizes (x, y, z) [m]."""
    corners = [tuple(c + s * h for c, s, h in zip(centre, signs, half))
               for signs in ((a, b, c) for a in (-1, 1) for b in (-1, 1) for c in (-1, 1))]
    brick = utils.polyhedron(corners, material=material, color=color, wire=False)
    brick.bounded = False
    return brick
