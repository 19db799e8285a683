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

    sinks: where it goes, none to keep nothing: a file (`damage.history.writer.File`), memory
    (`damage.history.in_memory.Memory`), or both, the file first.  A sink stores {"GROUP/NAME":
    array}; the arrays of frames are used again.
    active: contact points that are active already, in that order, of a history that continues.
    path: of the history's file, should it have one; where: the history is, in words.
    """

    def __init__(self, layout, *sinks, active=()):
        self._sinks = sinks
        self.path, self.where = (sinks[0].path, sinks[0].where) if sinks else (None, "nowhere")
        self._rows = {"active": [], "events": [], "snapshots": [], "static_stage": []}
        self._blocks = defaultdict(list)  # {"GROUP/NAME": arrays of several rows}
        self._frames = {
            name: np.zeros((CHUNK, layout.n_joints), column.dtype)
            for name, column in schema.FRAMES.items()
        }
        self._count = 0
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
        active, places = self._activate(joints, contacts)
        contacts = {name: values[:, active] for name, values in contacts.items()}
        rows = {"stage": np.full(count, schema.STAGES.index(stage)), **rows}
        columns = {
            f"series/{name}": rows.get(name, np.full(count, np.nan)) for name in schema.SERIES
        } | beside
        first = 0
        while first < count:
            stop = min(count, first + CHUNK - self._count)
            taken = slice(first, stop)
            given = slice(self._count, self._count + stop - first)
            for name, values in contacts.items():
                self._frames[name][given, places] = values[taken]
            for path, values in columns.items():
                self._blocks[path].append(np.array(values[taken], schema.COLUMNS[path].dtype))
            self._count = given.stop
            first = stop
            if self._count == CHUNK:
                self.flush()

    def _activate(self, joints, contacts):
        """Flags of those of these joints that are active now, and their columns in the frames."""
        joints = np.arange(len(self._column))[joints]
        has_any = np.any([any_bit(values) for values in contacts.values()], axis=0)
        new = joints[has_any & (self._column[joints] < 0)]
        self._column[new] = range(self._n_active, self._n_active + len(new))
        self._n_active += len(new)
        self._rows["active"] += [(joint,) for joint in new]
        active = self._column[joints] >= 0
        return active, self._column[joints[active]]

    def event(
        self, time_s, joint, kind, normal_stress=0.0, shear_stress=0.0, opening=0.0, slip=0.0
    ):
        """Add one event; kind: one of EVENTS; stresses [Pa] at the break, opening and slip [m]."""
        code = schema.EVENTS.index(kind)
        self._rows["events"].append(
            (time_s, joint, code, normal_stress, shear_stress, opening, slip)
        )

    def snapshot(self, time_s, displacement, *more):
        """Add the bodies' displacement (n_bodies, 3) [m, m, rad] since the end of the static stage;
        of a house also what of it is out of the plane (n_bodies, 3) [m, rad, rad]."""
        self._rows["snapshots"].append(
            (time_s, *(np.array(column, "f4") for column in (displacement, *more)))
        )

    def look(self, time_s, unbalanced_force):
        """Add a look at the static stage: time since its start [s], unbalanced over contact forces
        [-]."""
        self._rows["static_stage"].append((time_s, unbalanced_force))

    def static_stage(self, **values):
        """Store the results of the static stage; keys are those of STATIC."""
        for sink in self._sinks:
            sink.static_stage(values)
        self.flush()

    @property
    def keeps_state(self):
        """Whether the history has a file, which keeps the state of the solver at the end of the
        run."""
        return any(sink.keeps_state for sink in self._sinks)

    @property
    def attributes(self):
        """Attributes of the history's run."""
        return self._sinks[0].attributes

    def rows(self):
        """Numbers of rows that are stored, of each group of GROWING in turn."""
        return self._sinks[0].rows()

    def keep_state(self, state):
        """Keep the state of the solver at the end of the run, bytes (n,), in the file of the
        history."""
        for sink in self._sinks:
            if sink.keeps_state:
                sink.keep_state(state)

    def history(self, path=None):
        """The History of a finished run, as of `read_history`; path: of the file, where it has
        another name by now."""
        return self._sinks[-1].history(path or self.path)

    def add_parameters(self, parameters):
        """Add parameters, fit for JSON, to those of the run."""
        for sink in self._sinks:
            sink.add_parameters(parameters)

    def begin_again(self, write):
        """Discard all that was written, and become the Buffer that `write` makes."""
        for sink in self._sinks:
            sink.discard()
        vars(self).update(vars(write()))

    def finish(self, status, collapsed_at_s=None):
        """Mark how the run ended and close the file, unless it could not be written; status: one of
        STATUS."""
        if any(sink.is_torn for sink in self._sinks):
            return
        self.flush()
        for sink in self._sinks:
            sink.finish(status, collapsed_at_s)

    def flush(self):
        """Store what is buffered, on the disk, too."""
        columns = {
            f"{group}/{name}": np.asarray(values, column.dtype)
            for group, rows in self._rows.items()
            for name, values in zip(schema.GROWING[group], zip(*rows))  # of a plane wall fewer
            for column in [schema.GROWING[group][name]]
        }
        columns |= {path: np.concatenate(blocks) for path, blocks in self._blocks.items() if blocks}
        if self._count > 0:
            columns |= {
                f"frames/{name}": rows[: self._count, : self._n_active]
                for name, rows in self._frames.items()
            }
        for sink in self._sinks:
            sink.store(columns)
        for rows in (*self._rows.values(), *self._blocks.values()):
            rows.clear()
        for column in self._frames.values():
            column[: self._count] = 0
        self._count = 0
