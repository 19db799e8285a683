"""Runs that step together, up to eight at a time: each in a thread of its own, to the same bits as alone.

A run asks its solver to advance from one sample to the next, and so does every other; `Meeting` has them wait for each
other there, and moves those that are to go equally far as lanes of one block.  Nothing of a run knows of the others.
"""

import threading
from collections import deque

from damage.history.writer import HistoryWriter
from damage.memory import hold_buffers
from damage.reference.lanes import MOST_LANES, are_alike, run_together
from damage.reference.session import BACKEND, PROG
from damage.reference.solver import ReferenceSolver
from damage.run.options import parse_run
from damage.run.session import EXIT_INTERRUPTED, EXIT_OK, attended, prepare, simulate, told
from damage.wall.file import load_wall

LEAST_LANES = 6
"""Fewer walls are faster one by one: a block is of eight, however many of its lanes are used."""


def run_references(lines, histories=None):
    """Run command lines as `run_reference` does, the wall file first, in groups of up to eight; what each ended with is
    in its history, of which no summary and no picture is made.

    lines: {name: words}, each with an --out of its own; histories: {name: HistoryInMemory or HistoryKept} of runs whose
    histories are wanted in memory, each of which gets its own in place of the class.  Yields {name: exit status} of
    each group as it ends, and no group after one that was interrupted.
    """
    names = list(lines)
    for group in groups(len(names)):
        statuses = _run_group({names[k]: lines[names[k]] for k in group}, histories or {})
        yield statuses
        if EXIT_INTERRUPTED in statuses.values():
            return


def groups(count):
    """Ranges of so many runs: of eight, and of one where too few are left.

    >>> [list(group) for group in groups(10)]
    [[0, 1, 2, 3, 4, 5, 6, 7], [8], [9]]
    """
    full = count - count % MOST_LANES if count % MOST_LANES < LEAST_LANES else count
    return [range(first, min(first + MOST_LANES, full)) for first in range(0, full, MOST_LANES)] + [
        range(one, one + 1) for one in range(full, count)]


def _run_group(lines, histories):
    """{name: exit status} of runs that step together."""
    prepared, statuses = {}, {}

    def begin(name, wall, words):
        settings = parse_run(words, prog=f"{PROG} {wall}", solver=BACKEND.name)
        write = histories.get(name, HistoryWriter)
        prepared[name] = prepare(BACKEND, wall, lambda: load_wall(wall), settings, write)
        if name in histories:
            histories[name] = prepared[name].writer
        return EXIT_OK

    others = f" and {len(lines) - 1} more" if len(lines) > 1 else ""
    hold_buffers()
    with attended(f"{next(iter(lines))}{others}") as keep_going:
        for name, (wall, *words) in lines.items():
            statuses[name] = told(lambda name=name, wall=wall, words=words: begin(name, wall, words), f"{name}: ")
        meeting = Meeting(len(prepared))

        def run(name, simulate):
            try:
                statuses[name] = told(lambda: simulate(prepared[name], keep_going, meeting.solver), f"{name}: ")
            finally:
                meeting.leave()

        threads = []
        for name in prepared:
            thread = threading.Thread(target=run, args=(name, simulate), name=name)
            try:
                thread.start()
                threads.append(thread)
            except RuntimeError:  # the others would wait for it
                run(name, _give_up)
        for thread in threads:
            thread.join()
    return statuses


def _give_up(prepared, *_):
    """In place of `simulate`, where there is no thread to be had."""
    prepared.writer.finish("failed")
    raise MemoryError("for one more thread")


class Meeting:
    """Where walls wait until all that have not left are there; then each goes as far as it asked for.

    members: how many will come, each from a thread of its own, and `leave`.  When all have been moved one after the
    other has its turn until it is back: eight threads awake at once would hinder each other, as Python runs but one.
    """

    def __init__(self, members):
        self._members, self._lock = members, threading.Lock()
        self._kinds = []  # a wall of each
        self._waiting = {}  # {wall: steps}, in an order that stays
        self._moved = deque()  # walls that wait for their turn

    def solver(self, layout, time_step):
        """A ReferenceSolver that steps with the others."""
        wall = _Member(layout, time_step)
        with self._lock:
            kind = next((k for k, other in enumerate(self._kinds) if are_alike(other, wall)), len(self._kinds))
            self._kinds += [wall] * (kind == len(self._kinds))
            wall.meet(self, kind)
        return wall

    def step(self, wall, n_steps):
        """Advance a wall as soon as all others are to advance, too."""
        with self._lock:
            self._waiting[wall] = n_steps
            self._go_on()
        wall.turn.acquire()
        if wall.failure is not None:
            raise wall.failure

    def leave(self):
        """Come no more."""
        with self._lock:
            self._members -= 1
            self._go_on()

    def _go_on(self):
        """Give the turn to the next wall; where all wait advance them before."""
        if not self._moved and len(self._waiting) >= max(1, self._members):
            self._move_all()
        if self._moved:
            self._moved.popleft().turn.release()

    def _move_all(self):
        """Advance all walls."""
        companies = {}  # {(kind, steps): walls}
        for wall, n_steps in self._waiting.items():
            companies.setdefault((wall.kind, n_steps), []).append(wall)
        for (_, n_steps), walls in companies.items():
            for wall, failure in zip(walls, _advance(walls, n_steps)):
                wall.failure = failure
        self._moved += self._waiting
        self._waiting.clear()


def _advance(walls, n_steps):
    """Advance walls of a kind, in lanes where that is faster; returns what `run_together` does."""
    try:
        if len(walls) >= LEAST_LANES:
            return run_together(walls, n_steps)
        return [failure for wall in walls for failure in run_together([wall], n_steps)]
    except Exception as error:  # it is theirs, not of the thread that came last
        return [error] * len(walls)


class _Member(ReferenceSolver):
    """A ReferenceSolver that advances when the others do; kind: which of them have the same bricks; turn: released when
    it may go on; failure: of its last steps, or None."""

    def meet(self, meeting, kind):
        self._meeting, self.kind, self.failure = meeting, kind, None
        self.turn = threading.Lock()
        self.turn.acquire()

    def run(self, n_steps):
        self._meeting.step(self, n_steps)
