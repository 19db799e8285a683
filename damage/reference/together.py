"""Runs that advance together, eight at a time, with the bitwise identical results of single runs.

Each run yields the steps up to its next samples; those of walls that can be in one batch are taken together.  The next
run begins when one has ended.  The results of a run do not depend on the others.
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
    """Run command lines as `run_reference`, several at a time, without summaries and pictures.

    lines: iterable of (name, words), the wall file first, each with an --out of its own; an element is taken when a run
    can begin, and (None, None) means that there is none now; if no run is in progress then, all ends.  histories:
    {name: HistoryInMemory or HistoryKept} of runs whose histories are wanted in memory; the class is replaced by the
    object.  settled: SettledWalls of earlier runs; most: number of runs at a time.

    Yields (name, exit status) of each run as it ends.  No run begins after an interrupt.
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
    """One run from its command line: a generator as `damage.run.session.simulate`."""
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
