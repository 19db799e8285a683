"""A process of a study: up to eight runs of the reference solver that step together, or one run in
YADE, or pictures.

It takes tasks from a connection and sends what becomes of them: (task, exit status, record or
None), (task, CHANGED, how its inputs changed, words), a line for the person at the terminal,
(None, line, None), or (None, None, {name of a run under way: share that is simulated}).
"""

import os
import re
import shutil
import signal
import subprocess
import sys
import time
from collections import deque
from functools import partial
from types import MappingProxyType

from damage.applications.cracks.kept import patterns_of, write_patterns
from damage.applications.studies.folder import (
    POLITE_ENDS,
    ROOT,
    end_with_parent,
    environment,
    open_log,
)
from damage.applications.studies.inputs import differences, inputs_of
from damage.applications.studies.records import record_of
from damage.applications.studies.tasks import CHANGED, PICTURES
from damage.errors import InputError, some_of
from damage.files import YADE
from damage.history.buffer import Buffer
from damage.history.in_memory import HistoryInMemory, Memory
from damage.history.reader import read_history
from damage.history.writer import File, run_attributes
from damage.measure.tables import write_run_tables
from damage.memory import return_freed
from damage.reference.rest_cache import RestCache
from damage.reference.session import run_references
from damage.run.checkpoint import checkpoint_path
from damage.run.options import words_of
from damage.start import EXIT_FAILED, EXIT_INTERRUPTED, EXIT_OK

PATIENCE_S = 60.0
"""How long an interrupted solver may take to close its history before it is killed [s]."""
SHARES_S = 2.0
"""Between two looks at how far runs are [s]."""
# of damage.run.progress.Progress
_PROGRESS = re.compile(r"\bt = +(-?[\d.]+) of ([\d.]+) s ")


def work(connection, parent, lock, inputs=MappingProxyType({}), processes=1):
    """Do tasks until None comes.  Runs end politely at SIGTERM; when the parent has died the system
    kills this process, whose runs nobody would record, and its solver.  lock: descriptor that a
    solver holds as long as it runs; inputs: {StudyRun.id: its inputs when the study began
    (`damage.applications.studies.inputs.as_json`)}; processes: of the study."""
    # SIGTERM interrupts runs (damage.run.progress.attended) and nothing else: those that have ended
    # leave their records.
    signal.signal(signal.SIGTERM, lambda *_: None)
    for name in (signal.SIGINT, signal.SIGHUP):  # of a terminal: the parent's to answer
        signal.signal(name, signal.SIG_IGN)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, POLITE_ENDS)
    end_with_parent(parent)
    os.chdir(ROOT)
    waiting = deque()
    settled = RestCache()
    while True:
        try:
            task = waiting.popleft() if waiting else connection.recv()
        except EOFError:
            return
        if task is None:
            return
        if task.steps:
            status = _do_runs(task, connection, waiting, settled, inputs, processes)
        else:
            task.log.unlink(missing_ok=True)
            print_into(task.log)
            status, record = (
                _draw(task) if task.kind == PICTURES else _run_yade(task, connection, lock, inputs)
            )
            connection.send((task, status, record))
        if status == EXIT_INTERRUPTED:  # nothing more begins
            return


def print_into(path):
    """Let all that this process prints go to the end of a log, line by line."""
    with open_log(path, "ab") as log:
        for stream in (1, 2):
            os.dup2(log.fileno(), stream)
    sys.stdout, sys.stderr = (
        open(stream, "w", buffering=1, errors="replace", closefd=False)  # noqa: SIM115
        for stream in (1, 2)
    )


def _do_runs(first, connection, waiting, settled, inputs, processes):
    """Simulate runs that are not there, the first one and those that come meanwhile; sends each as
    it ends.  Returns EXIT_INTERRUPTED where they were interrupted."""
    print_into(first.log)
    waiting.appendleft(first)
    group = Group(connection, waiting, inputs)
    interrupted = EXIT_OK
    for name, status in run_references(
        group.lines(), group.histories, settled, group.watch, processes
    ):
        interrupted = EXIT_INTERRUPTED if EXIT_INTERRUPTED in (status, interrupted) else EXIT_OK
        group.end(name, status)
        return_freed()
    return interrupted


class Group:
    """Runs of a process that step together; histories: {name: as of `run_references`}.  Arguments
    as of `_do_runs`."""

    def __init__(self, connection, waiting, inputs):
        self._connection = connection
        self._waiting = waiting
        self._inputs = inputs
        self._tasks = {}
        self.histories = {}
        self._shares = {}
        self._said = time.monotonic()

    def lines(self):
        """(name, run) of the next runs, as `run_references` takes them; (None, None) where there is
        none now."""
        while True:
            while self._connection.poll():
                self._waiting.append(self._connection.recv())
            if not self._waiting or not self._waiting[0] or not self._waiting[0].steps:
                yield None, None
            elif self._begins(task := self._waiting.popleft()):
                print("---", task.name, flush=True)
                yield task.name, (task.point.wall, partial(_settings, task))

    def _begins(self, task):
        """Whether a task is to be simulated; sends what becomes of it otherwise."""
        if task.history.is_file():
            self._connection.send((task, *conclude(task)))
        elif _stands(task) and (changed := changes(task, self._inputs)):
            self._connection.send((task, CHANGED, changed))
        else:
            self._tasks[task.name] = task
            kind = HistoryKept if task.kept else HistoryInMemory
            self.histories[task.name] = Begun(task, self._inputs, kind)
            return True
        return False

    def watch(self, name, share):
        """Send now and then which share of each run is simulated."""
        self._shares[name] = share
        if time.monotonic() > self._said + SHARES_S:
            self._said = time.monotonic()
            under_way = self._shares.keys() & self._tasks.keys()
            self._connection.send((None, None, {task: self._shares[task] for task in under_way}))

    def end(self, name, status):
        """Send what became of a run, by its exit status."""
        task = self._tasks.pop(name)
        history = self.histories.pop(name)
        if status not in (EXIT_OK, EXIT_INTERRUPTED) and _stands(task):
            # of another version, or of other options: it begins again
            checkpoint_path(task.part).unlink()
            self._waiting.append(task)
        elif isinstance(history, Begun):  # of a run that never had one
            self._connection.send(
                (task, CHANGED, history.changes) if history.changes else (task, status, None)
            )
        else:
            self._connection.send(
                (task, *(conclude(task, history) if status == EXIT_OK else (status, None)))
            )


class Begun:
    """Makes the history of a run, of a kind, which has read all of its inputs by then, and refuses
    it where these are others than the study began with; changes: how they differ, words; None
    before, and empty of a run that is repeated.
    """

    def __init__(self, task, inputs, kind):
        self._task = task
        self._inputs = inputs
        self._kind = kind
        self.changes = None

    def __call__(self, path, layout, **more):
        if self.changes is None:
            self.changes = changes(self._task, self._inputs, layout.wall)
        if self.changes:
            raise InputError(
                f"not made, as its inputs changed since the study began: {some_of(self.changes)}"
            )
        return self._kind(path, layout, **more)


def changes(task, inputs, wall=None):
    """How the inputs of a task differ from those in `inputs` (as of `work`), a list of words; wall:
    as its run has it, which may have imported modules that this process has of before."""
    note = inputs.get(task.point.id)
    return differences(note, inputs_of(task.point, ROOT, wall)) if note else []


def _settings(task, prog):
    """RunSettings of a task, whose paths start from the working folder."""
    return task.point.settings(None, task.number, prog, _where(task))


def _where(task):
    """The options of a task beside those of its point."""
    place = {"resume": str(task.part)} if _stands(task) else {"out": str(task.part)}
    return place | {"overwrite": "out" in place, "pictures": False}


def _stands(task):
    """Whether a run was interrupted, and can continue from there."""
    return task.steps and task.part.is_file() and checkpoint_path(task.part).is_file()


def conclude(task, kept=None):
    """Give a history its name where it stays, and make of it what it leaves; returns (exit status,
    record or None).

    kept: the HistoryInMemory, or HistoryKept, of a run that was done just now, else None.
    """
    try:
        path = task.history if task.history.is_file() else task.part
        history = read_history(path) if kept is None else kept.history(path)
        if history.status != "complete":
            raise InputError(
                f"the history is marked {history.status}; expected complete; run the study again"
            )
        if task.kept and path == task.part:
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


def _run_yade(task, connection, lock, inputs):
    """Run YADE into the part of a history; returns (exit status, record or None), or as of
    CHANGED."""
    if task.history.is_file():
        return conclude(task)
    try:
        return _run_yade_on(task, connection, lock, inputs)
    except InputError as error:
        print(f"error: {task.name}: {error}")
        return EXIT_FAILED, None


def _run_yade_on(task, connection, lock, inputs):
    """As `_run_yade`: the inputs are compared before and after, as YADE reads them by itself."""
    if changed := changes(task, inputs):
        return CHANGED, changed
    connection.send((None, f"{task.name}: started", None))
    status = _run_solver(
        [*YADE, task.point.wall, *words_of(task.point.options_of(task.number) | _where(task))],
        task.folder,
        lock,
        lambda share: connection.send((None, None, {task.name: share})),
    )
    if status == EXIT_OK and (
        changed := changes(task, inputs, read_history(task.part).masonry_wall)
    ):
        task.part.unlink()
        return CHANGED, changed
    return conclude(task) if status == EXIT_OK else (status, None)


def _run_solver(command, folder, lock, announce):
    """Run a command with its output into this process's; returns its exit status.  SIGTERM ends it
    politely, an alarm kills it if it lingers."""
    came = []
    try:
        solver = subprocess.Popen(
            command,
            cwd=ROOT,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            errors="replace",
            env=environment(folder),
            pass_fds=(lock,),
            process_group=0,
            preexec_fn=partial(end_with_parent, os.getpid()),
        )
    except OSError as error:
        print(f"error: {command[0]} does not start: {error.strerror}")
        return EXIT_FAILED

    def end(*_):
        if not came:
            solver.terminate()
            signal.alarm(int(PATIENCE_S))
        came.append(True)

    before = signal.signal(signal.SIGTERM, end)
    signal.signal(signal.SIGALRM, lambda *_: solver.kill())
    try:
        _follow(solver.stdout, announce)
        status = solver.wait()
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGTERM, before)
    if came and status != 0:
        return EXIT_INTERRUPTED
    if status < 0:
        print(f"error: {command[0]} was ended by signal {-status} ({signal.Signals(-status).name})")
    return status if status >= 0 else 128 - status


def _follow(lines, announce):
    """Print a solver's lines; announce the share that is simulated."""
    for line in lines:
        print(line, end="")
        if (progress := _PROGRESS.search(line)) is not None:
            time_s, duration_s = map(float, progress.groups())
            announce(max(0.0, time_s) / max(duration_s, 1e-9))


def _draw(task):
    """Draw the pictures of a run, in a folder that gets its name when all are there; returns (exit
    status, None)."""
    from damage.draw.run import save_all

    unfinished = task.pictures.with_name(f".{task.name}.part")
    try:
        shutil.rmtree(unfinished, ignore_errors=True)
        save_all(read_history(task.history), unfinished)
        os.replace(unfinished, task.pictures)
    except (InputError, OSError) as error:
        print(f"error: {task.name}: {error}", file=sys.stderr)
        return EXIT_FAILED, None
    return EXIT_OK, None


class HistoryKept(Buffer):
    """Replaces a HistoryWriter and writes its file, but returns the History without reading it."""

    def __init__(self, path, layout, *, solver, parameters, versions, overwrite=False):
        attributes = run_attributes(layout, solver, parameters, versions)
        super().__init__(
            layout, File(path, layout, attributes, overwrite), Memory(path, layout, attributes)
        )
