"""Runs that step together, eight at a time, to the same bits as alone.

A run goes on from samples to the next ones and hands out the steps between, and so does every other; those that can be
are moved as lanes of one block.  The next run begins where one has ended.  Nothing of a run knows of the others.
"""

from functools import partial

from damage.history.writer import HistoryWriter
from damage.memory import hold_buffers
from damage.provenance import shown_path
from damage.reference.ensembles import Ensemble
from damage.reference.lanes import MOST_LANES
from damage.reference.session import BACKEND, PROG
from damage.reference.settled import SettledWalls
from damage.run.options import parse_run
from damage.run.session import EXIT_INTERRUPTED, EXIT_OK, attended, prepare, reported, simulate, with_errors_reported
from damage.run.turns import as_they_end
from damage.wall.file import load_wall


def run_references(lines, histories=None, settled=None, most=MOST_LANES):
    """Run command lines as `run_reference` does, the wall file first, so many at a time; what each ended with is in its
    history, of which no summary and no picture is made.

    lines: (name, words) of each, with an --out of its own, asked for when a run can begin; (None, None) where there is
    none now, which ends all where none is under way; histories: {name: HistoryInMemory or HistoryKept} of runs whose
    histories are wanted in memory, each of which gets its own in place of the class; settled: SettledWalls of runs
    before, for more to come.  Yields (name, exit status) of each as it ends;
    none begins after one was interrupted.
    """
    histories, settled = {} if histories is None else histories, settled or SettledWalls()
    names, interrupted = [], []

    def runs():
        for name, line in lines:
            if interrupted:
                return
            names.append(name)
            yield line and _run(name, line, histories, settled, keep_going)

    hold_buffers()
    with attended("runs that step together" if most > 1 else "a run") as keep_going:
        for number, status in as_they_end(runs(), Ensemble().move, most):
            if status == EXIT_INTERRUPTED:
                interrupted.append(names[number])
            yield names[number], status


def _run(name, line, histories, settled, keep_going):
    """One run from its command line on: a generator as of `simulate`."""
    wall, *words = line
    prepared = []
    status = reported(partial(_prepare, wall, words, histories.get(name, HistoryWriter), prepared), f"{name}: ")
    if status != EXIT_OK:
        return status
    (one,) = prepared
    if name in histories:
        histories[name] = one.writer
    return (yield from with_errors_reported(f"{name}: ", simulate(one, keep_going, settled.of(one))))


def _prepare(wall, words, write, prepared):
    """Append the Prepared run of a command line; returns the exit status."""
    settings = parse_run(words, prog=f"{PROG} {shown_path(wall)}", solver=BACKEND.name)
    prepared.append(prepare(BACKEND, wall, lambda: load_wall(wall), settings, write))
    return EXIT_OK
