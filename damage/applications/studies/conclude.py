"""What a run of a study leaves: its history, record and tables, and pictures."""

import os
import shutil
import sys

from damage.applications.cracks.at_rest import patterns_of, write_patterns
from damage.applications.studies.records import record_of
from damage.errors import InputError
from damage.history.reader import read_history
from damage.measure.tables import write_run_tables
from damage.start import EXIT_FAILED, EXIT_OK


def conclude(task, finished=None):
    """Give a history its name where it stays, and make of it what it leaves; returns (exit status,
    record or None).

    finished: the HistoryInMemory, or HistoryKept, of a run that was done just now, else None.
    """
    try:
        path = task.history if task.history.is_file() else task.part
        history = read_history(path) if finished is None else finished.history(path)
        if history.status != "complete":
            raise InputError(
                f"the history is marked {history.status}; expected complete; run the study again"
            )
        if task.keeps_history and path == task.part:
            os.replace(path, task.history)
        seals = (
            {"patterns": write_patterns(patterns_of(history), task.pattern)}
            if task.patterns
            else {}
        )
        if task.tables:
            write_run_tables(history, task.folder / "tables" / task.name)
        return EXIT_OK, record_of(history, task.name, task.point.point) | seals
    except (InputError, OSError) as error:
        remedy = f"; delete {task.history}" if task.history.is_file() else ""
        print(f"error: {task.name}: {error}{remedy}", file=sys.stderr, flush=True)
        return EXIT_FAILED, None


def draw(task):
    """Draw the pictures of a run, in a folder that gets its name when all are there; returns (exit
    status, None)."""
    from damage.draw.house import save_all

    unfinished = task.pictures.with_name(f".{task.name}.part")
    try:
        shutil.rmtree(unfinished, ignore_errors=True)
        save_all(read_history(task.history), unfinished)
        os.replace(unfinished, task.pictures)
    except (InputError, OSError) as error:
        print(f"error: {task.name}: {error}", file=sys.stderr)
        return EXIT_FAILED, None
    return EXIT_OK, None
