"""Walls at rest under their weight, kept for runs that begin as one did before: of a study's members, those with the
same joints differ only by what shakes them, and the static stage is a tenth of a short run."""

import hashlib
import pickle
from collections import OrderedDict

MOST_BYTES = 64_000_000
"""Of what is kept: about a hundred walls of four hundred bricks."""


class SettledWalls:
    """What the solvers of runs were at the end of their static stages, the last ones used."""

    def __init__(self):
        self._kept = OrderedDict()  # {digest of all that a wall is until then: its state}

    def of(self, prepared):
        """A Settled of a Prepared run."""
        digest = _digest(prepared)
        return Settled(self, digest, digest in self._kept)

    def take(self, digest):
        """What was kept."""
        self._kept.move_to_end(digest)
        return self._kept[digest]

    def put(self, digest, state):
        """Keep one more, and no more than MOST_BYTES."""
        self._kept[digest] = state
        while sum(state.nbytes for state in self._kept.values()) > MOST_BYTES:
            self._kept.popitem(last=False)


class Settled:
    """The settled wall of one run; known: whether it was kept."""

    def __init__(self, walls, digest, known):
        self._walls, self._digest = walls, digest
        self._state = walls.take(digest) if known else None

    def recall(self, solver):
        """Make a solver that has not moved what it would be at the end of its static stage; False where that is not
        known."""
        if self._state is None:
            return False
        self._state.put_into(solver)
        return True

    def keep(self, solver):
        """Keep what a solver is at that end, unless its bricks have found new contacts by then."""
        if not solver.loose.counts.any():
            self._walls.put(self._digest, State(solver))


class State:
    """The tables of a ReferenceWall and its clock."""

    def __init__(self, wall):
        self._step, system, count = wall.step, wall.system, int(wall.system.n_events[0])
        self._tables = system._replace(events=system.events[:count], values=system.values[:count])
        self._tables = type(system)(*(table.copy() for table in self._tables))

    @property
    def nbytes(self):
        """Of the tables."""
        return sum(table.nbytes for table in self._tables)

    def put_into(self, wall):
        """Write them into a wall of the same bricks."""
        wall.step = self._step
        for table, kept in zip(wall.system, self._tables):
            table[:len(kept)] = kept


def _digest(prepared):
    """Of all that a run is until its wall is at rest."""
    settings = prepared.settings
    begins = (prepared.layout, prepared.time_step, settings.perturb_m, settings.seed, settings.relaxation,
              settings.new_contacts)
    return hashlib.sha256(pickle.dumps(begins)).digest()
