"""The processes of a study: tasks go to them, and what they leave goes into its records.

A process that is lost, as the system ends one for want of memory, costs the runs that were in it:
they begin again, each in a process of its own, and one that is lost a second time has failed.
"""

import math
import multiprocessing
import os
import signal
import sys
import time
from contextlib import suppress
from dataclasses import replace
from importlib import import_module
from multiprocessing.connection import wait

from damage.applications.studies.folder import NO_ROOM, POLITE_ENDS, handled, is_short
from damage.applications.studies.tasks import CHANGED, batch_of, company_of
from damage.errors import warn
from damage.mechanics.compiled import COMPILING, is_cached
from damage.provenance import measures_digest, versions
from damage.reference.lanes import MOST_LANES
from damage.reference.session import BACKEND
from damage.reference.solver import ReferenceSolver
from damage.start import EXIT_INTERRUPTED
from damage.wall.file import load_wall
from damage.wall.layout import lay_out

LOOK_S = 2.0
"""Between two looks at the room on the disk, and two signals that end processes [s]."""
# processes begin with all libraries, compiled code and records
_FORK = multiprocessing.get_context("fork")


def say(line):
    """Print a line at once."""
    print(line, flush=True)


class Worker:
    """A process, and the tasks that it has: in its connection, or under way.

    It starts with POLITE_ENDS blocked and unblocks them once it has handlers of its own: those of
    the parent, which it inherits, would end the other processes.
    """

    def __init__(self, work, lock):
        self.connection, theirs = _FORK.Pipe()
        self.process = _FORK.Process(target=work, args=(theirs, os.getpid(), lock), daemon=True)
        before = signal.pthread_sigmask(signal.SIG_BLOCK, POLITE_ENDS)
        try:
            self.process.start()
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)
        theirs.close()
        self.tasks = []
        self.shares = {}

    def takes(self, task, share):
        """Whether a task can go to it; share: how many runs step together in a process, all of one
        `batch_of`: of two, each would have too few."""
        return not self.tasks or (
            len(self.tasks) < share
            and all(task_.steps and not task_.alone for task_ in (task, *self.tasks))
            and batch_of(task.point) == batch_of(self.tasks[0].point)
        )

    def give(self, task):
        self.tasks.append(task)
        with suppress(OSError):  # of a process that is lost: `take` says so
            self.connection.send(task)

    def take(self):
        """What it sent, a list, and whether it is lost."""
        sent = []
        try:
            while self.connection.poll():
                sent.append(self.connection.recv())
        except (EOFError, OSError):
            return sent, True
        return sent, not self.process.is_alive() and not self.connection.poll()

    def end_politely(self):
        if self.process.is_alive():
            os.kill(self.process.pid, signal.SIGTERM)

    def close(self):
        with suppress(OSError):
            self.connection.send(None)
        self.process.join()


class Pool:
    """So many processes that do tasks in the folder of a study."""

    def __init__(self, jobs, work, lock, folder, watch=lambda shares: None):
        """work: what each of them does, `damage.applications.studies.worker.work`; lock: descriptor
        that solvers hold as long as they run; watch(shares): gets now and then {task of a run
        under way: share that is simulated}."""
        self._watch = watch
        self.jobs = jobs
        self.folder = folder
        self._work = work
        self._lock = lock
        self.interrupted = self.short = False  # ended by a signal; in want of room
        # tasks; runs that an interrupt ended
        self.failed = []
        self.n_lost = 0
        self.changed = []  # (task, words) of runs whose inputs changed meanwhile
        self._workers = []
        self._announced = False
        # runs in their order, and what comes after runs
        self._waiting = []
        self._later = []

    @property
    def ended(self):
        """Whether it was ended before its time."""
        return self.interrupted or self.short

    def run(self, tasks, follow):
        """Do tasks; follow(task, record): called when one is done, returns the tasks that follow
        from it."""
        order = {
            company: place
            for place, company in enumerate(
                dict.fromkeys(company_of(task.point) for task in tasks if task.steps)
            )
        }
        # Those that can step together, one after the other; YADE's, which take longest, after
        # results that come soon.
        self._add(sorted(tasks, key=lambda task: order.get(company_of(task.point), len(order))))
        if first := next((task for task in self._waiting if task.steps), None):
            load_compiled(first)
        with handled(self._interrupt):
            try:
                self._do(follow)
            finally:
                # after an error of this process
                for worker in filter(lambda worker: worker.tasks, self._workers):
                    worker.end_politely()
                for worker in self._workers:
                    worker.close()

    def _add(self, tasks):
        """Queue tasks: runs of the reference solver before others, pictures last."""
        for task in tasks:
            if task.draws:
                self._later.append(task)
            else:
                place = next(
                    (k for k, waiting in enumerate(self._waiting) if not waiting.steps),
                    len(self._waiting),
                )
                self._waiting.insert(place if task.steps else len(self._waiting), task)

    def _do(self, follow):
        """Let processes do tasks until none is waiting or under way."""
        looked = time.monotonic()
        while True:
            if not self.ended:
                self._hand_out()
            busy = [worker for worker in self._workers if worker.tasks]
            if not busy:
                return
            wait(
                [
                    channel
                    for worker in busy
                    for channel in (worker.connection, worker.process.sentinel)
                ],
                LOOK_S,
            )
            for worker in busy:
                self._listen(worker, follow)
            if time.monotonic() > looked + LOOK_S:
                looked = time.monotonic()
                if self.ended:  # once more: a process that was about to begin a run did not hear it
                    self._end_all()
                elif is_short(self.folder):
                    self._end_short()

    def _listen(self, worker, follow):
        """Take note of what a process sent, and whether it is lost."""
        sent, lost = worker.take()
        for task, *ended in sent:
            if task is None and ended[0] is None:
                worker.shares = ended[1]
                self._watch(self.shares)
            elif task is None:
                say(ended[0])
            elif self.ended or ended[0] != EXIT_INTERRUPTED:  # else it ends, and the task with it
                worker.tasks.remove(task)
                self._end(task, *ended, follow)
        if lost:
            self._waiting += self._bury(worker)

    @property
    def shares(self):
        """{Task of a run under way: share that is simulated}."""
        return {
            task: worker.shares.get(task.name, 0.0)
            for worker in self._workers
            for task in worker.tasks
            if not task.draws
        }

    def _hand_out(self):
        """Give tasks to processes that can take them."""
        stepping = sum(
            task.steps
            for tasks in (self._waiting, *(worker.tasks for worker in self._workers))
            for task in tasks
        )
        share = max(1, min(MOST_LANES, math.ceil(stepping / self.jobs)))
        for queue in (self._waiting, self._later):
            while queue and (worker := self._worker_for(queue[0], share)):
                if queue[0].steps and share > 1 and not self._announced:
                    self._announced = True
                    say(f"up to {share} runs step together in a process")
                worker.give(queue.pop(0))

    def _worker_for(self, task, share):
        """A process that takes a task, one that has the fewest; None where there is none now."""
        able = [worker for worker in self._workers if worker.takes(task, share)]
        if len(self._workers) < self.jobs and all(worker.tasks for worker in able):
            self._workers.append(Worker(self._work, self._lock))
            return self._workers[-1]
        return min(able, key=lambda worker: len(worker.tasks), default=None)

    def _end(self, task, status, record, follow):
        """Take note of how a task ended, and of the tasks that follow."""
        if status == EXIT_INTERRUPTED:
            self.n_lost += not task.draws
            return
        if status == CHANGED:
            self.changed.append((task, record))
            return
        if status != 0:
            self.failed.append(task)
            say(f"{task.name}: FAILED")
            return
        try:
            self._add(follow(task, record))
        except OSError as error:
            if error.errno not in NO_ROOM:
                raise
            self._end_short()

    def _bury(self, worker):
        """Take a lost process out; returns the tasks that begin again."""
        worker.process.join()
        self._workers.remove(worker)
        if self.ended:
            self.n_lost += len(worker.tasks)
            return []
        code = worker.process.exitcode
        how = signal.Signals(-code).name if code < 0 else f"status {code}"
        again = [replace(task, alone=True) for task in worker.tasks if not task.alone]
        failed = [task for task in worker.tasks if task.alone]
        self.failed += failed
        if again:
            warn(f"a process was lost ({how}): {len(again)} runs or pictures begin again")
        for task in failed:
            with open(task.log, "a", encoding="utf-8") as log:
                log.write(f"error: {task.name}: its process was ended twice ({how})\n")
            say(f"{task.name}: FAILED")
        return again

    def _end_short(self):
        self.short = True
        self._end_all()

    def _end_all(self):
        for worker in self._workers:
            worker.end_politely()

    def _interrupt(self, *_):
        if not self.interrupted:
            print("interrupted: ending what runs", file=sys.stderr, flush=True)
        self.interrupted = True
        self._end_all()


def load_compiled(task):
    """Compile the reference solver, or load it, before there are processes: once for all of them,
    as what else each would load or work out."""
    if not is_cached():
        say(COMPILING)
    wall = ReferenceSolver(lay_out(load_wall(task.point.wall)), 1e-6)
    wall.run(1)
    wall.instants()
    versions(BACKEND.code)
    measures_digest()
    import_module("scipy.signal")  # by the measures of a motion: a fifth of a second
