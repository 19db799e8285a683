"""Ensembles: walls of the same bricks that are moved together, as far as they can be, whatever shakes them.

A wall stops where it takes a sample.  Walls that stop at one step are moved there as lanes of one block; one that stops
elsewhere is moved by itself to where the others can follow.  Nothing of a wall depends on the others.
"""

from itertools import accumulate
from weakref import WeakKeyDictionary

from damage.reference.lanes import advance_together, kind_of
from damage.run.turns import WAITED

LEAST_LANES = 5
"""Fewer walls are faster one by one: a block is of eight, however many of its lanes are used.  One alone takes a
quarter of the time of a block with AVX-512 and a fifth with AVX2."""


class Ensemble:
    """Moves walls: those of the same bricks as lanes of one block."""

    def __init__(self):
        self._kinds = WeakKeyDictionary()  # {wall: what it shares with those that can be lanes beside it}

    def move(self, asked):
        """As `damage.run.turns.run_each`, of ReferenceSolvers, some of which wait for others."""
        alike = {}
        for wall, *steps in asked:
            if wall not in self._kinds:
                self._kinds[wall] = kind_of(wall)
            alike.setdefault(self._kinds[wall], {})[wall] = steps
        failures = {}
        for walls in alike.values():
            for group in _chosen(walls):
                failures |= zip(group, _advance(list(group.items())))
        return [failures.get(wall, WAITED) for wall, *_ in asked]


def _chosen(walls):
    """Groups of these walls, each with the steps that it is to take now: {wall: steps}.

    walls: {wall: steps that it asks for} of one kind.
    """
    if len(walls) < LEAST_LANES:
        return [{wall: steps} for wall, steps in walls.items()]
    # The next to stop for good goes first: whoever stops there, too, goes with it, and the others wait.
    ends = {wall: list(accumulate(steps)) for wall, steps in walls.items()}
    stop = min(of_wall[-1] for of_wall in ends.values())
    group = {wall: walls[wall][:of_wall.index(stop) + 1] for wall, of_wall in ends.items() if stop in of_wall}
    if len(group) >= LEAST_LANES:
        return [group]
    return [{wall: walls[wall][:1]} for wall in group]


def _advance(asked):
    """As `advance_together`, with an error that ends all of them as that of each."""
    try:
        return advance_together(asked)
    except Exception as error:
        return [error] * len(asked)
