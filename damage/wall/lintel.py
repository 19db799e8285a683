"""Lintels of elastic courses over openings: the joints that they keep elastic, and the share that cannot fail."""

from typing import NamedTuple

import numpy as np

from damage.wall.floors import slabs
from damage.wall.lintels import KINDS_OF_LINTELS

_TINY = 1e-6  # [m], two positions closer than this are the same

LARGE_SHARE = 0.15
"""Share of the joint length that is elastic [-] above which a run is warned of: half as much again as in the façades of
the paper, 0.10, in which alone elastic lintels were compared with published results."""


class ElasticShare(NamedTuple):
    """Length of joints that are elastic and cannot fail, over the length of all joints [-]; and the same of the courses
    above openings, along the whole wall, None of a wall without."""

    of_all: float
    above_openings: float | None


def in_lintel(wall, lintel, x, z):
    """Which joints lie strictly inside a lintel: in the courses over an opening, or the lowest of them, one brick of
    bearing on each side; the bed joints under the bearing and over the highest of these courses are not inside.

    lintel: as of ModelOptions; x, z: middles of the joints' parts between two bricks [m].  Openings with a lintel of
    their own have none of these.
    """
    inside = np.zeros(len(x), dtype=bool)
    for opening in (one for one in wall.openings if not wall.lintel_of(one).is_body):
        inside |= ((x > opening.left - wall.brick.length + _TINY) & (x < opening.right + wall.brick.length - _TINY)
                   & _within(wall, lintel_courses(wall, lintel, opening), z))
    return inside


def lintel_courses(wall, lintel, opening):
    """The first course of an opening's lintel and the first above it: up to the sill of the next opening above, to the
    next slab, or to the wall's top, unless `lintel` (of ModelOptions) says fewer; a slab on the opening is its
    lintel."""
    above = wall.opening_courses(opening)[1]
    ends = [wall.opening_courses(other)[0] for other in wall.openings
            if other.left < opening.right and other.right > opening.left]
    for floor in slabs(wall):
        (left, right), (first, top) = floor.span(wall), floor.courses(wall)
        if left < opening.right and right > opening.left and top >= above:
            ends.append(max(first, above))
    top = min([end for end in ends if end >= above] + [wall.courses])
    most = {"none": 0, **dict.fromkeys(("elastic", *KINDS_OF_LINTELS), wall.courses)}.get(lintel)
    return above, min(top, above + (int(lintel) if most is None else most))


def _within(wall, courses, z):
    """Which heights z [m] lie strictly inside the courses from the first up to the second, that one excluded."""
    bottom, top = courses
    return (z > bottom * wall.brick.height + _TINY) & (z < top * wall.brick.height - _TINY)


def elastic_share(wall, joints, bodies):
    """The ElasticShare of a wall; joints, bodies: tables as of a History, or of `damage.wall.geometry`."""
    kind = joints["kind"].to_numpy()
    length = np.where(kind == "brick", 0.0, joints["length_m"])
    elastic = length * joints["elastic"].to_numpy()
    # A contact point at the end of a head joint lies at the boundary of its course: the brick beside it lies inside.
    z = np.where(kind == "head", bodies["z_m"].to_numpy()[joints["second_body"]], joints["z_m"])
    above = np.zeros(len(z), bool)
    for opening in wall.openings:
        above |= _within(wall, lintel_courses(wall, "elastic", opening), z)
    return ElasticShare(float(elastic.sum() / length.sum()),
                        float(elastic[above].sum() / length[above].sum()) if length[above].any() else None)


def describe_share(share):
    """An ElasticShare in a line for people.

    >>> describe_share(ElasticShare(0.3312, 0.784))
    '33 % of the joint length (78 % above the openings) is elastic and cannot fail'
    >>> describe_share(ElasticShare(0.0, None))
    'no joint is elastic, all can fail'
    """
    if share.of_all == 0:
        return "no joint is elastic, all can fail"
    above = "" if share.above_openings is None else f" ({100 * share.above_openings:.2g} % above the openings)"
    return f"{100 * share.of_all:.2g} % of the joint length{above} is elastic and cannot fail"


def warn_of_share(share):
    """Warnings of an ElasticShare: a list of at most one line."""
    if share.of_all <= LARGE_SHARE:
        return []
    return [f"{describe_share(share)}: above {100 * LARGE_SHARE:g} % the choice of the lintel may decide the result; "
            "compare with --lintel 1 (docs/guides/own-wall.md)"]
