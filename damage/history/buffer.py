"""Buffer of samples, events and snapshots, which are stored many at once."""

from collections import defaultdict

import numpy as np

from damage.history import schema
from damage.history.contacts import any_bit

SNAPSHOT_SAMPLES = 10
"""Samples between two snapshots of the bodies."""
CHUNK = 120
"""Samples buffered before they are stored, with their snapshots: whole chunks of a file, each
written once."""


class Buffer:
    """What a run writes to: call `extend`, `event` and `snapshot` as it goes, `finish` at the end.

    sink: where it goes, a file (`damage.history.writer.File`) or memory
    (`damage.history.in_memory.Memory`), which stores {"GROUP/NAME": rows}.
    active: contact points that are active already, in that order, of a history that continues.
    path: of the history's file, should it have one.
    """

    def __init__(self, layout, sink, active=()):
        self.sink = sink
        self.path = sink.path
        self._blocks = defaultdict(list)  # {"GROUP/NAME": arrays of several rows}
        self._n_samples = 0  # in the blocks
        self._n_active = len(active)
        # of each contact point in the frames, once it is active
        self._column = np.full(layout.n_joints, -1)
        self._column[list(active)] = range(len(active))

    def extend(self, stage, rows, joints, contacts, beside):
        """Add n samples.

        stage: one of STAGES; rows: {column of SERIES: (n,)}, missing ones become NaN; contacts:
        {column of FRAMES: (n, n_active)} of these joints, zero in all others, as missing ones are;
        beside: {"GROUP/NAME": (n, ...)} of the ground and, of a run that keeps them, of stresses
        and points.
        """
        count = len(next(iter(contacts.values())))
        frames = self._frames(count, joints, contacts)
        rows = {"stage": np.full(count, schema.STAGES.index(stage)), **rows}
        series = {
            f"series/{name}": rows.get(name, np.full(count, np.nan)) for name in schema.SERIES
        }
        first = 0
        while first < count:
            stop = min(count, first + CHUNK - self._n_samples)
            for path, values in (series | beside | frames).items():
                self._add(path, values[first:stop])
            self._n_samples += stop - first
            first = stop
            if self._n_samples == CHUNK:
                self.flush()

    def _frames(self, count, joints, contacts):
        """Columns of FRAMES, {"frames/NAME": (count, number of contact points that are active
        now)}."""
        joints = np.arange(len(self._column))[joints]
        has_any = np.any([any_bit(values) for values in contacts.values()], axis=0)
        new = joints[has_any & (self._column[joints] < 0)]
        if len(new) > 0:
            self._column[new] = range(self._n_active, self._n_active + len(new))
            self._n_active += len(new)
            self._add("active/joint", new)
        active = self._column[joints] >= 0
        frames = {
            f"frames/{name}": np.zeros((count, self._n_active), column.dtype)
            for name, column in schema.FRAMES.items()
        }
        for name, values in contacts.items():
            frames[f"frames/{name}"][:, self._column[joints[active]]] = values[:, active]
        return frames

    def _add(self, path, rows):
        """Add rows, which are copied, to the column "GROUP/NAME"."""
        self._blocks[path].append(np.array(rows, schema.COLUMNS[path].dtype))

    def _add_row(self, group, *values):
        """Add a row to a group, a value a column; of a plane wall they are fewer."""
        for name, value in zip(schema.GROWING[group], values):
            self._add(f"{group}/{name}", [value])

    def event(
        self, time_s, joint, kind, normal_stress=0.0, shear_stress=0.0, opening=0.0, slip=0.0
    ):
        """Add one event; kind: one of EVENTS; stresses [Pa] at the break, opening and slip [m]."""
        code = schema.EVENTS.index(kind)
        self._add_row("events", time_s, joint, code, normal_stress, shear_stress, opening, slip)

    def snapshot(self, time_s, displacement, *more):
        """Add the bodies' displacement (n_bodies, 3) [m, m, rad] since the end of the static stage;
        of a house also what of it is out of the plane (n_bodies, 3) [m, rad, rad]."""
        self._add_row("snapshots", time_s, displacement, *more)

    def look(self, time_s, unbalanced_force):
        """Add a look at the static stage: time since its start [s], unbalanced over contact forces
        [-]."""
        self._add_row("static_stage", time_s, unbalanced_force)

    def static_stage(self, **values):
        """Store the results of the static stage; keys are those of STATIC."""
        self.sink.static_stage(values)
        self.flush()

    def history(self, path=None):
        """The History of a finished run, as of `read_history`; path: of the file, where it has
        another name by now."""
        return self.sink.history(path or self.path)

    def begin_again(self, write):
        """Discard all that was written, and become the Buffer that `write` makes."""
        self.sink.discard()
        vars(self).update(vars(write()))

    def finish(self, status, collapsed_at_s=None):
        """Mark how the run ended and close the file, unless it could not be written; status: one of
        STATUS."""
        if not self.sink.is_torn:
            self.flush()
            self.sink.finish(status, collapsed_at_s)

    def flush(self):
        """Store what is buffered, on the disk, too."""
        self.sink.store({path: stacked(blocks) for path, blocks in self._blocks.items()})
        self._blocks.clear()
        self._n_samples = 0


def stacked(blocks):
    """Rows of blocks, one after the other; where later ones have more columns, zeros before
    them."""
    rows = np.zeros((sum(map(len, blocks)), *blocks[-1].shape[1:]), blocks[-1].dtype)
    first = 0
    for block in blocks:
        rows[slice(first, first + len(block)), *map(slice, block.shape[1:])] = block
        first += len(block)
    return rows
