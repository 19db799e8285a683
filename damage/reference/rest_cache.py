"""Cache of walls at rest under their weight, for runs with the same static stage.

Runs of a study with equal walls differ in their motions only, and the static stage takes a tenth of
a short run.
"""

import hashlib
import io
import pickle
from collections import OrderedDict
from dataclasses import replace

from damage.run.settings import NONE

MOST_BYTES = 64_000_000
"""Largest size of the cache: about a hundred walls of four hundred bricks."""


class RestCache:
    """Checkpoints of solvers at the end of their static stages, the least recently used deleted
    first."""

    def __init__(self):
        # {digest of all inputs of the static stage: (checkpoint, looks at the stage)}
        self._checkpoints = OrderedDict()

    def rest(self, prepared):
        """Rest of a Prepared run."""
        return Rest(self, digest_of(prepared))

    def take(self, digest):
        """(checkpoint, looks) with this digest, None where there is none."""
        if digest in self._checkpoints:
            self._checkpoints.move_to_end(digest)
        return self._checkpoints.get(digest)

    def put(self, digest, tables, looks=()):
        """Add a checkpoint, {name: array}, and looks, and delete the oldest ones beyond
        MOST_BYTES."""
        self._checkpoints[digest] = tables, looks
        while (
            sum(
                table.nbytes
                for tables, _ in self._checkpoints.values()
                for table in tables.values()
            )
            > MOST_BYTES
        ):
            self._checkpoints.popitem(last=False)


class Rest:
    """Access of one run to the cache of walls at rest."""

    def __init__(self, walls, digest):
        self._walls = walls
        self._digest = digest
        self._entry = walls.take(digest)

    def recall(self, solver):
        """Set a solver that has not moved to the end of its static stage; returns the looks at that
        stage, None where the cache lacks it."""
        if self._entry is None:
            return None
        tables, looks = self._entry
        solver.restore(tables)
        return looks

    def keep(self, solver, looks):
        """Store the state of a solver at the end of its static stage, and the looks at it, (time
        [s], unbalanced force)."""
        self._walls.put(self._digest, solver.checkpoint(), tuple(looks))


def digest_of(prepared):
    """Digest of all inputs of the static stage of a Prepared run."""
    settings = prepared.settings
    content = io.BytesIO()
    layout = replace(prepared.layout, plan=None)  # which follows from the wall and the options
    begins = (
        layout,
        prepared.time_step,
        settings.relaxation,
        settings.mass_scaling,
        settings.mass_scaling != NONE and settings.beta_s,
    )
    pickler = pickle.Pickler(content)
    pickler.fast = True  # equal values give equal bytes, be they one object or two
    pickler.dump(begins)
    return hashlib.sha256(content.getbuffer()).digest()
