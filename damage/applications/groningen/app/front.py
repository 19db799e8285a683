"""The front of a claim as the page draws it, and a photograph of it as marked by hand."""

import tomllib

import numpy as np

from damage.applications.groningen.app.photo import homography, turns
from damage.applications.groningen.claim.sheet import outside_at_rest
from damage.applications.report.words import LANGUAGES
from damage.errors import InputError
from damage.wall.file import read_wall
from damage.wall.layout import lay_out
from damage.wall.model_options import ModelOptions

POINT_ERROR_M = 0.02
"""How far a marked place may be from the corner of the outline that it stands for [m]."""


def laid_out(path):
    return lay_out(read_wall(path), ModelOptions(supports="bricks"))


def _edges(wall):
    """Corners of a Wall's outline (n, 2) [m]: both of its base, then its top from the right end to
    the left."""
    length = wall.length
    height = wall.built_height
    top = wall.outline or ((0.0, height), (length, height))
    return np.array([(0.0, 0.0), (length, 0.0), *reversed(top)])


def drawn(layout, text):
    """What the page draws of a Layout, fit for JSON [m]: size, corners to straighten by, outline,
    bricks (x, z, length, height) and openings (left, lower, right, upper edge) as built; its text
    in TOML, and the table of that."""
    bodies = layout.bodies
    n = layout.n_below_caps
    wall = layout.wall
    bricks = np.column_stack([bodies.x, bodies.z, bodies.length, bodies.height])[:n]
    return {
        "text": text,
        "table": tomllib.loads(text),
        "name": wall.name,
        "length": wall.length,
        "height": wall.built_height,
        "corners": _edges(wall)[[0, 1, 2, -1]].tolist(),
        "bricks": np.round(bricks, 4).tolist(),
        "course": wall.brick.height,
        "brick": wall.brick.length,
        "outline": _edges(wall).tolist(),
        "openings": np.round(_openings(layout.plan), 4).tolist(),
        "contact_points": layout.n_joints,
        "outside": {language: outside_at_rest(layout, language) for language in LANGUAGES},
    }


def view(layout):
    """What a photograph is straightened by: corners of the outline and edges of openings [m]."""
    return _edges(layout.wall).tolist(), _openings(layout.plan).tolist()


def _openings(plan):
    """Openings of a Plan as built, (n, 4) of left, lower, right and upper edge [m]."""
    course = plan.wall.brick.height
    boxes = [
        (opening.left, course * opening.first, opening.right, course * opening.above)
        for opening in plan.openings
    ]
    return np.array(boxes, float).reshape(-1, 4)


def check_marks(layout, pixels, places, openings):
    """InputError where marks in a photograph are not those of a front: four points, pixels and
    places x, z [m], (4, 2), and of each opening two opposite corners in pixels (2, 2)."""
    edges = _edges(layout.wall)
    off = np.linalg.norm(places[:, np.newaxis] - edges, axis=2).min(axis=1)
    if (off > POINT_ERROR_M).any():
        x, z = places[off.argmax()]
        raise InputError(
            f"the four points: ({x:g}, {z:g}) m; expected corners of the front's outline:"
            f" {', '.join(f'({x:g}, {z:g})' for x, z in edges)}; the front may differ from the"
            " photograph"
        )
    if turns(pixels)[0] * turns(places)[0] > 0:  # y is down, z is up
        raise InputError(
            "the four points make a mirrored photograph; expected them in the order of their"
            " places, from the lower left corner; mark them again"
        )
    _compare_openings(layout.plan, openings, homography(pixels, places))


def _compare_openings(plan, marked, to_wall):
    """InputError where openings that were marked in a photograph, two opposite corners in pixels
    each, lie more than a course from those of a Plan; to_wall: (3, 3) from pixels to the wall."""
    built = _openings(plan)
    course = plan.wall.brick.height
    if len(built) and not len(marked):
        raise InputError(
            "no opening of the photograph is marked; expected two opposite corners of one or more;"
            " mark them after the four points"
        )
    for pixels in marked:
        u, v, w = to_wall @ np.column_stack([pixels, np.ones(2)]).T
        x = np.sort(u / w)
        z = np.sort(v / w)
        apart = np.abs(built - [x[0], z[0], x[1], z[1]]).max(axis=1)
        if not (apart <= course).any():
            raise InputError(
                f"the opening from ({x[0]:.2f}, {z[0]:.2f}) to ({x[1]:.2f}, {z[1]:.2f}) m of the"
                " photograph lies more than a course from each of the front; expected openings"
                " where they are; correct the front, or mark its corners again"
            )
