"""A history that a run goes on with after an interruption or a kill."""

import fcntl
import json
import os

from damage.history.reader import opened
from damage.history.schema import GROWING
from damage.history.writer import File, HistoryWriter, lock


def continued_history(path, layout, counts, attributes):
    """A HistoryWriter that goes on with the history at `path` after so many rows of each group of GROWING.

    What the file holds up to there is copied into a new one, which takes its place once it is whole; attributes: of its
    run, which stay.  Raises InputError where another run still writes it, ValueError where it has fewer rows.
    """
    lock(path, fcntl.LOCK_EX).close()  # HDF5 takes one of its own to read
    with opened(path) as old:
        there = [len(next(iter(old[group].values()))) if group in old and len(old[group]) else 0 for group in GROWING]
        if any(not 0 <= count <= has for count, has in zip(counts, there)):
            raise ValueError(f"it has {there} rows, expected {counts}")
        beside = path.with_name(f".{path.stem}.{os.getpid()}.h5")
        file = File(beside, layout, attributes, json.loads(attributes["versions_json"]), overwrite=True)
        try:
            file.copy_rows(old, counts)
            os.replace(beside, path)
        except BaseException:
            beside.unlink(missing_ok=True)
            raise
    file.path, file.where = path, str(path)
    return HistoryWriter.of(layout, file)
