"""A shard of a study: its runs in the reference solver, on all processors that it is given.

    run_shard.py DIR/shards/NUMBER.json --jobs N

Runs of walls that share their bricks step together (`damage.reference.together`), eight in a process.  A run grows in
runs/NAME.part.h5.  When it is whole its record comes into NUMBER.rows (`damage.studies.records`), and its history gets
the name runs/NAME.h5; with "keep": "summary" that of every other run than the first of its point is in memory alone.
What is there is not done again.  A point that is done leaves runs/POINT.members, the names of its runs, and the tables
of the first one.  The part of a run that failed stays.

Exit status: 0 all done, 130 interrupted, otherwise that of the last run that failed.
"""

import argparse
import json
import math
import multiprocessing
import os
import signal
import sys
from concurrent.futures import FIRST_COMPLETED, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass, replace
from functools import cache
from importlib import import_module
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))  # PYTHONSAFEPATH leaves it out

from shards import FIRST_TABLES
from shared import announce, end_with_parent

from damage.errors import InputError
from damage.files import plain_file, write_text
from damage.history.in_memory import HistoryInMemory, HistoryKept
from damage.history.reader import read_history
from damage.measure.tables import write_run_tables
from damage.mechanics.compiled import COMPILING, is_cached
from damage.memory import return_freed
from damage.provenance import measures_digest, versions
from damage.reference.lanes import MOST_LANES
from damage.reference.session import BACKEND
from damage.reference.settled import SettledWalls
from damage.reference.solver import ReferenceSolver
from damage.reference.together import run_references
from damage.run.options import parse_run
from damage.run.session import EXIT_FAILED, EXIT_INTERRUPTED, EXIT_OK
from damage.studies.definition import StudyRun
from damage.studies.members import most_members, runs_needed
from damage.studies.records import add_record, read_records, record_of
from damage.wall.file import load_wall
from damage.wall.layout import lay_out

_SETTLED = SettledWalls()  # of this process
# Tasks on their way to the processes, and what their runs leave: (task, status, record).
_TASKS, _ENDED = (multiprocessing.get_context("fork").SimpleQueue() for _ in range(2))
_TAKING = multiprocessing.get_context("fork").Lock()
STOCK, LOOK_S = 2 * MOST_LANES, 0.1  # tasks that are under way or next, a process; between two looks at what ended [s]


def main():
    """Run one shard; returns the exit status."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("shard", type=Path)
    parser.add_argument("--jobs", type=int, default=1)
    asked = parser.parse_args()
    try:
        return Shard(asked.shard, asked.jobs).run()
    except (InputError, OSError) as error:
        print(f"error: {error}", file=sys.stderr)
    except BrokenProcessPool:  # what ended it has said so
        print("error: a process of this shard was ended from outside, or could not go on", file=sys.stderr)
    return EXIT_FAILED


@dataclass(frozen=True)
class Task:
    """A run to be done: the one with this number of a point; kept: whether its history stays."""

    folder: Path
    point: StudyRun
    number: int
    kept: bool

    @property
    def name(self):
        return self.point.name(self.number)

    @property
    def history(self):
        """Where the history is in the end."""
        return self.folder / "runs" / f"{self.name}.h5"

    @property
    def part(self):
        """Where it grows."""
        return self.folder / "runs" / f"{self.name}.part.h5"

    @property
    def company(self):
        """Properties that runs share which step together from beginning to end."""
        return company_of(self.point)


@cache
def company_of(point):
    """As Task.company, of all runs of a point."""
    settings = parse_run(point.command(1)[1:], prog="", solver="reference")
    return (point.wall, replace(settings.model, strength_seed=0), settings.time_step_s, settings.alpha_1_s,
            settings.beta_s)


class Point:
    """A point on its way: which of its runs are done, asked for, failed."""

    def __init__(self, run, folder, keeps_all, records):
        self.run, self.folder, self._keeps_all = run, folder, keeps_all
        self._asked = set()
        names = {number: run.name(number) for number in range(1, most_members(run) + 1)}
        self._records = {number: records[name] for number, name in names.items()
                         if name in records and self._is_there(self._task(number))}

    def _task(self, number):
        return Task(self.folder, self.run, number, self._keeps_all or number == 1)

    def _is_there(self, task):
        """Whether what a run with a record leaves besides is there."""
        return not task.kept or (task.history.is_file() and (task.number > 1 or all(
            task.folder.joinpath("tables", f"{task.name}_{table}.csv").is_file() for table in FIRST_TABLES)))

    @property
    def done(self):
        """How many of its runs are done."""
        return len(self._records)

    def next_tasks(self):
        """The tasks that the results so far ask for and that were not handed out yet."""
        numbers = set(range(1, runs_needed(self.run, self._records) + 1)) - self._records.keys() - self._asked
        self._asked |= numbers
        return [self._task(number) for number in sorted(numbers)]

    def add(self, number, record):
        """Take note of a run that is done."""
        self._records[number] = record
        self.mark()

    def mark(self, visible=True):
        """Name the runs of a point that is done, and announce it."""
        count = runs_needed(self.run, self._records)
        if all(number in self._records for number in range(1, count + 1)):
            if self.run.is_ensemble:
                write_text(self.folder / "runs" / f"{self.run.id}.members",
                           "".join(f"{self.run.name(number)}\n" for number in range(1, count + 1)))
            if visible:
                announce(f"{self.run.id}: done")


class Shard:
    """The points of a shard on their way, `jobs` groups of runs at a time."""

    def __init__(self, path, jobs):
        job = json.loads(path.read_text(encoding="utf-8"))
        folder, self.rows, self.jobs = path.parents[1], path.with_suffix(".rows"), jobs
        records = read_records(self.rows)
        runs = [StudyRun(**{name: tuple(value) if isinstance(value, list) else value for name, value in one.items()})
                for one in job["points"]]
        self.points = {run.id: Point(run, folder, job["keep"] == "all", records) for run in runs}
        self.status, self.interrupted, self.lost = EXIT_OK, False, 0

    def run(self):
        """Bring all points up to date; returns the exit status."""
        waiting = [task for point in self.points.values() for task in point.next_tasks()]
        order = {company: place for place, company in enumerate(dict.fromkeys(task.company for task in waiting))}
        waiting.sort(key=lambda task: order[task.company])  # those that can step together, one after the other
        for point in self.points.values():
            point.mark(visible=False)
        if not waiting:
            return EXIT_OK
        for name in (signal.SIGINT, signal.SIGTERM):
            signal.signal(name, self._interrupt)
        load_compiled(waiting[0])
        with open(self.rows, "a", encoding="utf-8", opener=plain_file) as rows, ProcessPoolExecutor(
                self.jobs, multiprocessing.get_context("fork"), _begin_worker) as workers:
            rows.write("\n")  # ends a line that a kill tore
            self._work(waiting, workers, rows)
        if self.interrupted:
            ended = sum(point.done for point in self.points.values())
            announce(f"interrupted: {self.lost} runs were under way and are lost; {ended} that had ended are kept")
        return EXIT_INTERRUPTED if self.interrupted else self.status

    def _work(self, waiting, workers, rows):
        """Let processes take runs until none is waiting or under way."""
        under_way, begun, announced = set(), 0, False
        while True:
            while waiting and begun < STOCK * self.jobs and not self.interrupted:
                _TASKS.put(waiting.pop(0))
                begun += 1
            lanes = max(1, min(MOST_LANES, math.ceil(begun / self.jobs)))
            while len(under_way) < self.jobs and not (_TASKS.empty() or self.interrupted):
                under_way.add(workers.submit(do_runs, lanes))
            if not under_way:
                return
            if lanes > 1 and not announced:
                announced = True
                announce(f"up to {lanes} runs step together in a process: an interruption loses those under way")
            done, under_way = wait(under_way, LOOK_S, FIRST_COMPLETED)
            while not _ENDED.empty():  # before the error of a process that was ended from outside
                begun -= 1
                waiting += self._note(*_ENDED.get(), rows)
            for future in done:
                future.result()

    def _note(self, task, status, record, rows):
        """Take note of how a run ended; returns the tasks that follow."""
        if record is None:
            self.interrupted |= status == EXIT_INTERRUPTED
            self.lost += status == EXIT_INTERRUPTED
            self.status = status
            announce(f"{task.name}: {'interrupted' if status == EXIT_INTERRUPTED else 'FAILED'}")
            return []
        add_record(rows, record)
        if not task.kept:
            task.part.unlink(missing_ok=True)
        point = self.points[task.point.id]
        point.add(task.number, record)
        return point.next_tasks()

    def _interrupt(self, *_):
        """End what runs, politely, and begin nothing more."""
        self.interrupted = True
        for worker in multiprocessing.active_children():
            os.kill(worker.pid, signal.SIGTERM)


def load_compiled(task):
    """Compile the reference solver, or load it, before there are processes: once for all of them, as what else each
    would load or work out."""
    if not is_cached():
        announce(COMPILING)
    wall = ReferenceSolver(lay_out(load_wall(task.point.wall)), 1e-6)
    wall.run(1)
    wall.instants()
    versions(BACKEND.code)
    measures_digest()
    import_module("scipy.signal")  # by the measures of a motion: a fifth of a second


def _begin_worker():
    """A worker leaves interrupts to its parent, and ends with it; its lines are whole among others."""
    # SIGTERM interrupts runs (damage.run.session.attended) and nothing else: those that have ended leave their records.
    signal.signal(signal.SIGTERM, leave_without_parent)
    end_with_parent(signal.SIGTERM)
    for stream in (sys.stdout, sys.stderr):
        stream.reconfigure(line_buffering=True, write_through=False)
    signal.signal(signal.SIGINT, signal.SIG_IGN)


def leave_without_parent(*_):
    """End this process where its parent has died."""
    parent = multiprocessing.parent_process()
    if parent is not None and os.getppid() != parent.pid:
        os._exit(EXIT_INTERRUPTED)


def do_runs(lanes):
    """Simulate runs that are not there, so many at a time; puts (task, exit status, record or None) of each into _ENDED
    when it ends, and takes the next from _TASKS while there are any."""
    tasks, histories = {}, {}
    for name, status in run_references(_lines(tasks, histories), histories, _SETTLED, lanes):
        leave_without_parent()  # whose death interrupted them
        task, history = tasks.pop(name), histories.pop(name)
        _ENDED.put((task, *(conclude(task, history) if status == EXIT_OK else (status, None))))
        del history
        return_freed()


def _lines(tasks, histories):
    """(name, words) of the next runs, as `run_references` takes them, and what `do_runs` needs to know of them."""
    while True:
        task = _next_task()
        if task is None:
            yield None, None
            continue
        if task.history.is_file():
            _ENDED.put((task, *conclude(task)))
            continue
        tasks[task.name], histories[task.name] = task, HistoryKept if task.kept else HistoryInMemory
        print("---", task.name, flush=True)
        yield task.name, [*task.point.command(task.number), "--out", str(task.part), "--overwrite", "--no-pictures"]


def _next_task():
    """The next of _TASKS, None where there is none now."""
    with _TAKING:
        return None if _TASKS.empty() else _TASKS.get()


def conclude(task, kept=None):
    """Give a history its name where it stays, and make of it what it leaves; returns (exit status, record or None).

    kept: the HistoryInMemory, or HistoryKept, of a run that was done just now, else None.
    """
    path = task.history if task.kept or task.history.is_file() else task.part
    if path == task.history and not path.is_file():
        os.replace(task.part, path)
    try:
        history = read_history(path) if kept is None else kept.history(path)
        if task.number == 1:
            write_run_tables(history, task.folder / "tables" / task.name)
        return EXIT_OK, record_of(history, task.name, task.point.point)
    except InputError as error:
        print(f"error: {task.name}: {error}; delete it", file=sys.stderr, flush=True)
        return EXIT_FAILED, None


if __name__ == "__main__":
    sys.exit(main())
