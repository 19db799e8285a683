"""Samples, events and snapshots of a run on their way to where they are kept, many at once."""

import numpy as np

from damage.history import schema

SNAPSHOT_SAMPLES = 10
"""Samples between two snapshots of the bodies."""
CHUNK = 120
"""Samples buffered before they are stored, with their snapshots: whole chunks of a file, each written once."""


class Buffer:
    """Call `append`, `event` and `snapshot` as a run goes; what comes of it has the `store` that takes them."""

    def __init__(self, layout):
        # Of the frames whole columns, of the other groups rows in the order of theirs.
        self._rows = {group: [] for group in schema.GROWING if group != "frames"}
        self._frames = [np.empty((CHUNK, layout.n_joints), column.dtype) for column in schema.FRAMES.values()]

    def append(self, stage, row, opening, slip, offset, state):
        """Add one sample.

        stage: one of STAGES; row: {column of SERIES: value}, missing ones become NaN;
        opening, slip, offset [m], state (bits BROKEN, AT_LIMIT, CRUSHED): arrays (n_joints,).
        """
        series, told = self._rows["series"], {"stage": schema.STAGES.index(stage), **row}.get
        for column, values in zip(self._frames, (opening, slip, offset, state), strict=True):
            column[len(series)] = values
        series.append([told(name, np.nan) for name in schema.SERIES])
        if len(series) == CHUNK:
            self.flush()

    def event(self, time_s, joint, kind, normal_stress=0.0, shear_stress=0.0, opening=0.0, slip=0.0):
        """Add one event; kind: one of EVENTS; stresses [Pa] at the break, opening and slip [m]."""
        code = schema.EVENTS.index(kind)
        self._rows["events"].append((time_s, joint, code, normal_stress, shear_stress, opening, slip))

    def snapshot(self, time_s, displacement):
        """Add the bodies' displacement (n_bodies, 3) [m, m, rad] since the end of the static stage."""
        self._rows["snapshots"].append((time_s, np.array(displacement, "f4")))

    def flush(self):
        """Store what is buffered."""
        columns = {group: [np.asarray(values, column.dtype)
                           for values, column in zip(zip(*rows), schema.GROWING[group].values())]
                   for group, rows in self._rows.items() if rows}
        if "series" in columns:
            columns["frames"] = [column[:len(self._rows["series"])] for column in self._frames]
        self.store(columns)
        for rows in self._rows.values():
            rows.clear()

    def store(self, columns):
        """Keep more rows, {group: arrays in the order of its columns}, which are those of the buffer itself."""
        raise NotImplementedError
