"""Histories in memory, for runs that are evaluated when they end without reading, or without
writing, a file."""

import json
from functools import partial

import numpy as np

from damage.history import schema
from damage.history.reader import history_of, read_history
from damage.history.writer import (
    File,
    HistoryWriter,
    add_parameters,
    growing_columns,
    layout_tables,
)

MOST_BYTES = 10_000_000
"""Size [bytes] beyond which a history continues in its file, so that little is left to be written
where eight runs of a process are interrupted."""


class Memory:
    """Sink of a Buffer: the history in memory.

    new_file: makes the File in which it continues where the run fails, is interrupted or grows too
    large; None where there is a file beside it, which is kept alone then.
    """

    keeps_state = False

    def __init__(self, path, layout, attributes, new_file=None):
        self.path = path
        self.where = f"in memory, and in {path} should the run fail"
        self._layout = layout
        self.attributes = attributes
        self._new_file = new_file
        self._counts = dict.fromkeys(schema.GROWING, 0)
        self._values = {}
        self._n_bytes = 0
        self._file = None
        self._parts = []

    @property
    def is_torn(self):
        return self._file is not None and self._file.is_torn

    def static_stage(self, values):
        self._values = values

    def add_parameters(self, parameters):
        if self._file is not None:
            self._file.add_parameters(parameters)
        else:
            add_parameters(self.attributes, parameters)

    def rows(self):
        return list(self._counts.values())

    def store(self, columns):
        for group, rows in {path.partition("/")[0]: rows for path, rows in columns.items()}.items():
            self._counts[group] += len(rows)
        if self._file is not None:
            self._file.store(columns)
        if self._parts is None:
            return
        part = columns | {
            path: rows.copy() for path, rows in columns.items() if path.startswith("frames/")
        }
        self._parts.append(part)
        self._n_bytes += sum(rows.nbytes for rows in part.values())
        if self._n_bytes > MOST_BYTES:
            self._outgrow()

    def discard(self):
        if self._file is not None:
            self._file.discard()

    def finish(self, status, collapsed_at_s):
        if status != "complete" and self._file is None and self._new_file:
            self._outgrow()
        if self._file is not None:
            self._file.finish(status, collapsed_at_s)
        self._status = status
        self._collapsed_at_s = collapsed_at_s

    def _outgrow(self):
        if self._new_file:
            self._file = self._new_file()
            self._file.static_stage(self._values)
            self._file.store(self._columns())
        self._parts = None

    def _columns(self):
        """All rows of each growing column, {path: rows}."""
        columns = growing_columns(self._layout, json.loads(self.attributes["parameters_json"]))
        return {
            path: _together(
                [part[path] for part in self._parts if path in part],
                np.empty((0, *shape), column.dtype),
            )
            for path, (column, shape) in columns.items()
        }

    def history(self, path):
        if self._parts is None:
            return read_history(path)
        collapsed_at_s = np.nan if self._collapsed_at_s is None else self._collapsed_at_s
        values = {
            "run/status": np.uint8(schema.STATUS.index(self._status)),
            "run/collapsed_at_s": np.float64(collapsed_at_s),
            **{
                f"static/{name}": np.float64(self._values.get(name, np.nan))
                for name in schema.STATIC
            },
            **layout_tables(self._layout),
            **self._columns(),
        }
        return history_of(path, self.attributes, values)


def _together(parts, none):
    """The rows of parts, one after the other, after none; where later parts have more columns,
    zeros before them."""
    if not parts:
        return none
    rows = np.zeros((sum(map(len, parts)), *parts[-1].shape[1:]), none.dtype)
    first = 0
    for part in parts:
        rows[slice(first, first + len(part)), *map(slice, part.shape[1:])] = part
        first += len(part)
    return rows


class HistoryInMemory(HistoryWriter):
    """Replaces a HistoryWriter: a run that fails, is interrupted or grows too large leaves the same
    file as that."""

    @staticmethod
    def sinks(path, layout, attributes, overwrite):
        new_file = partial(File, path, layout, attributes, overwrite)
        return [Memory(path, layout, attributes, new_file)]


class HistoryKept(HistoryWriter):
    """Replaces a HistoryWriter and writes its file, but returns the History without reading it."""

    @staticmethod
    def sinks(path, layout, attributes, overwrite):
        return [File(path, layout, attributes, overwrite), Memory(path, layout, attributes)]
