"""Walls that are to go equally far are moved together, as far as they can be."""

from damage.reference.lanes import are_alike, run_together

LEAST_LANES = 6
"""Fewer walls are faster one by one: a block is of eight, however many of its lanes are used."""


class Companies:
    """Moves walls: those of the same bricks that are to go equally far as lanes of one block."""

    def __init__(self):
        self._kinds = {}  # {wall: the first of those that have the same bricks}

    def move(self, asked):
        """As `damage.run.turns.run_each`, of ReferenceSolvers."""
        companies = {}  # {(kind, what is asked): walls}
        for wall, *steps in asked:
            companies.setdefault((self._kind(wall), *steps), []).append(wall)
        failures = {}
        for (_, *steps), walls in companies.items():
            for group in [walls] if len(walls) >= LEAST_LANES else [[wall] for wall in walls]:
                failures |= zip(group, _advance(group, *steps))
        return [failures[wall] for wall, *_ in asked]

    def _kind(self, wall):
        if wall not in self._kinds:
            self._kinds[wall] = next((kind for kind in self._kinds.values() if are_alike(kind, wall)), wall)
        return self._kinds[wall]


def _advance(walls, *steps):
    """As `run_together`, with an error that ends all of them as that of each."""
    try:
        return run_together(walls, *steps)
    except Exception as error:
        return [error] * len(walls)
