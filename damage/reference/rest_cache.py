"""Cache of walls at rest under their weight, for runs with the same static stage.

Runs of a study with equal walls differ in their motions only, and the static stage takes a tenth of
a short run.
"""

import hashlib
import io
import pickle
from dataclasses import replace

from damage.run.settings import NONE

MOST_BYTES = 64_000_000
"""Largest size of the cache: about a hundred walls of four hundred bricks."""


class Rest:
    """Access of one run to a cache of walls at rest.

    checkpoints: {digest of all inputs of the static stage: (checkpoint of the solver at its end,
    looks at it)}, an OrderedDict; prepared: the Prepared run.
    """

    def __init__(self, checkpoints, prepared):
        self._checkpoints = checkpoints
        self._digest = digest_of(prepared)

    def recall(self, solver):
        """Set a solver that has not moved to the end of its static stage; returns the looks at that
        stage, None where the cache lacks it."""
        if self._digest not in self._checkpoints:
            return None
        self._checkpoints.move_to_end(self._digest)
        tables, looks = self._checkpoints[self._digest]
        solver.restore(tables)
        return looks

    def keep(self, solver, looks):
        """Add the state of a solver at the end of its static stage, and the looks at it, (time [s],
        unbalanced force); delete the least recently used ones beyond MOST_BYTES."""
        self._checkpoints[self._digest] = solver.checkpoint(), tuple(looks)
        while sum(map(_bytes_of, self._checkpoints.values())) > MOST_BYTES:
            self._checkpoints.popitem(last=False)


def _bytes_of(entry):
    tables, _ = entry
    return sum(table.nbytes for table in tables.values())


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
