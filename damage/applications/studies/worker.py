"""A process of a study: up to eight runs of the reference solver that step together, or one run in
YADE, or pictures.

It takes tasks from a connection and sends what becomes of them: (task, exit status, record or
None), (task, CHANGED, how its inputs changed, words), a line for the person at the terminal,
(None, line, None), or (None, None, {name of a run under way: share that is simulated}).
"""

import os
import signal
import sys
import time
from collections import OrderedDict, deque
from types import MappingProxyType

from damage.applications.studies.conclude import conclude, draw
from damage.applications.studies.folder import POLITE_ENDS, ROOT, end_with_parent, open_log
from damage.applications.studies.inputs import changes
from damage.applications.studies.tasks import CHANGED
from damage.applications.studies.yade_process import run_yade
from damage.errors import InputError, some_of
from damage.history.in_memory import HistoryInMemory, HistoryKept
from damage.memory import return_freed
from damage.reference.session import run_references
from damage.run.checkpoint import checkpoint_path
from damage.start import EXIT_INTERRUPTED, EXIT_OK

SHARES_S = 2.0
"""Between two looks at how far runs are [s]."""


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
    settled = OrderedDict()
    while True:
        try:
            task = waiting.popleft() if waiting else connection.recv()
        except EOFError:
            return
        if task is None:
            return
        if task.steps:
            interrupted = _do_runs(
                task, connection, waiting, settled, inputs=inputs, processes=processes
            )
        else:
            task.log.unlink(missing_ok=True)
            print_into(task.log)
            status, record = draw(task) if task.draws else run_yade(task, connection, lock, inputs)
            connection.send((task, status, record))
            interrupted = status == EXIT_INTERRUPTED
        if interrupted:  # nothing more begins
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
    it ends.  Returns whether they were interrupted."""
    print_into(first.log)
    waiting.appendleft(first)
    group = Group(connection, waiting, inputs)
    interrupted = False
    for name, status in run_references(
        group.lines(), group.histories, settled, group.watch, processes
    ):
        interrupted |= status == EXIT_INTERRUPTED
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
        self._last_message = time.monotonic()

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
                yield task.name, (task.point.wall, task.settings)

    def _begins(self, task):
        """Whether a task is to be simulated; sends what becomes of it otherwise."""
        if task.history.is_file():
            self._connection.send((task, *conclude(task)))
        elif task.stands and (differences := changes(task, self._inputs)):
            self._connection.send((task, CHANGED, differences))
        else:
            self._tasks[task.name] = task
            kind = HistoryKept if task.keeps_history else HistoryInMemory
            self.histories[task.name] = Begun(task, self._inputs, kind)
            return True
        return False

    def watch(self, name, share):
        """Send now and then which share of each run is simulated."""
        self._shares[name] = share
        if time.monotonic() > self._last_message + SHARES_S:
            self._last_message = time.monotonic()
            self._connection.send((None, None, self._shares))

    def end(self, name, status):
        """Send what became of a run, by its exit status."""
        task = self._tasks.pop(name)
        self._shares.pop(name, None)
        history = self.histories.pop(name)
        if status not in (EXIT_OK, EXIT_INTERRUPTED) and task.stands:
            # of another version, or of other options: it begins again
            checkpoint_path(task.part).unlink()
            self._waiting.append(task)
            return
        ended = status, None
        if isinstance(history, Begun) and history.changes:
            ended = CHANGED, history.changes
        elif status == EXIT_OK:
            ended = conclude(task, history)
        self._connection.send((task, *ended))


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
