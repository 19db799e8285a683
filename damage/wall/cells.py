"""Cells: rectangular parts of the bodies, so that those of two courses face each other.

A body's cells break at every head joint of the wall and at the edges of lintels' parts, and beyond
that into so many as the model options say.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from damage.errors import InputError
from damage.wall.kinds import TINY


@dataclass(frozen=True)
class Cells:
    """Cells of the bodies, body by body and from left to right, (n_cells,).

    body: of each; left, right: its edges [m]; column: the same number of cells that face each
    other.
    """

    body: np.ndarray
    left: np.ndarray
    right: np.ndarray
    column: np.ndarray


def segments_of(options):
    """Segments of a joint of half a brick.

    Corner contacts lie at both ends of a segment, so one segment less gives as many points; of
    Gauss points there are two in each, so that half as many do.
    """
    return {
        "interior": options.cells,
        "corners": max(1, options.cells - 1),
        "gauss": options.cells // 2,
    }[options.contacts]


def cells_of(plan, options, bodies):
    """The Cells of bodies of a damage.wall.plan.Plan; InputError where a cell would be too narrow
    to compute with."""
    breaks = _breaks(plan, options)
    cells = []
    ends = zip(bodies.x - bodies.length / 2, bodies.x + bodies.length / 2)
    for body, (start, end) in enumerate(ends):
        inside = breaks[(breaks > start + TINY) & (breaks < end - TINY)]
        cells += [(body, left, right) for left, right in pairwise([start, *inside, end])]
    body, left, right = map(np.array, zip(*cells))
    return Cells(body, left, right, np.searchsorted(breaks, (left + right) / 2))


def _breaks(plan, options):
    """Sorted positions x [m] at which every brick that spans them is divided."""
    segments = segments_of(options)
    wall = plan.wall
    slabs = slice(plan.n_bricks, plan.n_bricks + len(plan.slabs))
    edges = np.unique(np.round(np.delete(plan.ends, slabs, axis=1), 9))
    breaks = [edges[0]]
    for left, right in pairwise(edges):
        width = right - left
        if width < 1e-3:
            raise InputError(
                f"wall {wall.name}: head joints or openings' edges at x = {left:.6f} and"
                f" {right:.6f} m leave a cell of {width * 1e3:.3g} mm, at least 1 mm is needed;"
                " move an opening's edge"
            )
        parts = max(1, round(segments * width / (wall.brick.length / 2)))
        breaks.extend(left + width * np.arange(1, parts + 1) / parts)
    return np.array(breaks)
