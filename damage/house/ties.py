"""Spans between parallel walls, and the ties across the cavity of two leaves.

A tie is an elastic bar between the units of both leaves at its place, which resists along itself
alone.  It pulls out, or buckles, at its strength and carries nothing from then on.
"""

from dataclasses import dataclass
from itertools import product
from typing import NamedTuple

import numpy as np

from damage.errors import InputError
from damage.fields import check_fields, quantity
from damage.wall.kinds import TINY


class Span(NamedTuple):
    """Between two Placed walls: their distance, and its left and right end on either [m]."""

    one: object
    other: object
    apart: float
    along: list[float]
    other_along: list[float]

    def along_at(self, share):
        """Places along both walls at a share of it, (2,) [m]."""
        facing = self.one.axes[0] @ self.other.axes[0] > 0
        (left, right) = self.along
        (start, end) = self.other_along
        other = start + (end - start) * (share if facing else 1 - share)
        return left + (right - left) * share, other

    def at(self, share):
        """Places of both walls in plan at a share of it, (2, 2) [m]."""
        return np.array(
            [
                wall.origin + along * wall.axes[0, :2]
                for wall, along in zip((self.one, self.other), self.along_at(share))
            ]
        )


def spans_between(walls, what):
    """The Spans between parallel Placed walls, each and its next one; what: for messages."""
    axes = walls[0].axes[:2, :2]
    place = [axes @ placed.origin for placed in walls]
    order = sorted(range(len(walls)), key=lambda number: place[number][1])
    ends = [sorted(axes[0] @ end for end in wall.ends) for wall in walls]
    spans = []
    for one, other in zip(order, order[1:]):
        left, right = (pick(ends[one][k], ends[other][k]) for k, pick in ((0, max), (1, min)))
        if right - left < TINY:
            raise InputError(
                f"{what}: walls {walls[one].wall.name} and {walls[other].wall.name} face each"
                " other nowhere, so that it is in the air: expected walls beside each other;"
                " correct them, or their order"
            )
        along = []
        for number in (one, other):
            sign = walls[number].axes[0, :2] @ axes[0]
            along.append(sorted(sign * (end - place[number][0]) for end in (left, right)))
        spans.append(Span(walls[one], walls[other], place[other][1] - place[one][1], *along))
    return spans


@dataclass(frozen=True)
class Ties:
    """Ties between two parallel walls of these names.

    per_area [1/m2]: in a square grid on what both walls face, as near as whole numbers of rows and
    columns allow; stiffness [N/m], tension and compression [N]: of one tie along itself, and the
    forces at which it fails.
    """

    walls: tuple[str, str]
    per_area: float = quantity("1/m2", 0.01, 1000.0, (0.5, 20), "a tie a square metre; a test")
    stiffness: float = quantity("N/m", 1.0, 1e12, (1e4, 1e8), "a thin wire; a steel bar")
    tension: float = quantity("N", 1e-3, 1e9, (50, 2e4), "a corroded tie; an anchor")
    compression: float = quantity("N", 1e-3, 1e9, (50, 2e4), "a corroded tie; an anchor")

    def __post_init__(self):
        check_fields(self)

    def span(self, house):
        """The Span between its walls of a House; raises InputError where they are no leaves of a
        cavity wall."""
        what = f"house {house.name}, ties of {' and '.join(self.walls)}"
        walls = [placed for placed in house.walls if placed.wall.name in self.walls]
        if len(walls) != 2 or abs(walls[0].axes[0] @ walls[1].axes[0]) < 1 - TINY:
            raise InputError(
                f"{what}: expected two of its walls, {', '.join(house.names)}, that are parallel;"
                " correct them"
            )
        (span,) = spans_between(walls, what)
        if span.apart < house.masonry.brick.thickness + TINY:
            raise InputError(
                f"{what}: {span.apart:.3g} m between their middles at"
                f" {tuple(map(float, walls[1].origin))} m: expected a cavity, more than the"
                f" thickness of {house.masonry.brick.thickness:g} m; correct the origin"
            )
        return span

    def places(self, span):
        """[(share of the Span, height [m])] of each tie."""
        high = min(span.one.wall.built_height, span.other.wall.built_height)
        columns, rows = (
            max(1, round(size * self.per_area**0.5)) for size in (np.ptp(span.along), high)
        )
        return [
            ((column + 0.5) / columns, (row + 0.5) / rows * high)
            for column, row in product(range(columns), range(rows))
        ]
