"""Histories in memory, for runs that are evaluated when they end without reading, or without
writing, a file."""

from collections import defaultdict
from functools import partial

import numpy as np

from damage.history.buffer import stacked
from damage.history.reader import history_of, read_history
from damage.history.writer import (
    File,
    HistoryWriter,
    add_parameters,
    fixed_tables,
    growing_columns,
)

MOST_BYTES = 10_000_000
"""Size [bytes] beyond which a history continues in its file, so that little is left to be written
where eight runs of a process are interrupted."""


class Memory:
    """Sink of a Buffer: the history in memory.

    It continues in its file where the run fails, is interrupted, writes a checkpoint or grows too
    large.  is_kept: whether the file is there from the beginning.
    """

    def __init__(self, path, layout, attributes, overwrite, is_kept=False):
        self.path = path
        self.where = str(path) if is_kept else f"in memory, and in {path} should the run fail"
        self.attributes = attributes
        self._layout = layout
        self._new_file = partial(File, path, layout, attributes, overwrite)
        self._file = self._new_file() if is_kept else None
        self._values = {}
        # {"GROUP/NAME": arrays of several rows}; None where the file alone has them
        self._blocks = defaultdict(list)
        self._n_bytes = 0

    @property
    def is_torn(self):
        return self._file is not None and self._file.is_torn

    def static_stage(self, values):
        self._values = values
        if self._file is not None:
            self._file.static_stage(values)

    def add_parameters(self, parameters):
        add_parameters(self.attributes, parameters)
        if self._file is not None:
            self._file.add_parameters(parameters)

    def keep_state(self, state):
        if self._file is not None:
            self._file.keep_state(state)

    def rows(self):
        if self._file is None:
            self._continue_in_file()
        return self._file.rows()

    def store(self, columns):
        if self._file is not None:
            self._file.store(columns)
        if self._blocks is None:
            return
        for path, rows in columns.items():
            self._blocks[path].append(rows)
            self._n_bytes += rows.nbytes
        if self._n_bytes > MOST_BYTES:
            self._continue_in_file()

    def discard(self):
        if self._file is not None:
            self._file.discard()

    def finish(self, status, collapsed_at_s):
        if status != "complete" and self._file is None:
            self._continue_in_file()
        if self._file is not None:
            self._file.finish(status, collapsed_at_s)
        self._end = status, collapsed_at_s

    def _continue_in_file(self):
        if self._file is None:
            self._file = self._new_file()
            self._file.static_stage(self._values)
            self._file.store(self._columns())
        self._blocks = None

    def _columns(self):
        """All rows of each growing column, {path: rows}."""
        return {
            path: stacked(self._blocks[path] or [np.empty((0, *shape), column.dtype)])
            for path, (column, shape) in growing_columns(self._layout, self.attributes).items()
        }

    def history(self, path):
        if self._blocks is None:
            return read_history(path)
        values = fixed_tables(self._layout, *self._end, self._values) | self._columns()
        return history_of(path, self.attributes, values)


class HistoryInMemory(HistoryWriter):
    """Replaces a HistoryWriter: a run that fails, is interrupted or grows too large leaves the same
    file as that."""

    make_sink = Memory


class HistoryKept(HistoryWriter):
    """Replaces a HistoryWriter and writes its file, but returns the History without reading it."""

    make_sink = partial(Memory, is_kept=True)
