"""Command `python3 -m damage reference WALL.py [MOTION] [OPTIONS]`: a run in the reference solver,
or many."""

from collections import OrderedDict
from functools import partial
from pathlib import Path

import numba

from damage.errors import InputError
from damage.history.writer import HistoryWriter
from damage.house.house import load_wall_or_house
from damage.linear.modes import inside_lintels
from damage.memory import hold_buffers
from damage.provenance import shown_path
from damage.reference.ensembles import move
from damage.reference.lanes import MOST_LANES
from damage.reference.rest_cache import Rest
from damage.reference.solver import ReferenceSolver
from damage.run.cooperative import as_they_end
from damage.run.options import parse_run
from damage.run.prepare import Backend, prepare
from damage.run.progress import attended
from damage.run.session import run_session, simulate, with_errors_reported
from damage.run.settings import LINTELS, SELECTIVE
from damage.start import EXIT_INTERRUPTED, reported
from damage.wall.file import wall_path

PROG = "python3 -m damage reference"


def _make(layout, time_step, settings):
    return ReferenceSolver(
        layout,
        time_step,
        beta=settings.beta_s,
        scaled={LINTELS: inside_lintels(layout), SELECTIVE: slice(None)}.get(settings.mass_scaling),
    )


BACKEND = Backend(
    "reference",
    {"numba": numba.__version__},
    _make,
    Path(__file__).parent,
    most=MOST_LANES,
)


def run_reference(arguments):
    """Run the command with these words, the wall first (a file, or the name of a wall that ships);
    returns the exit status."""
    return reported(lambda: _session(*(arguments or ["--help"])))


def _session(wall, *options):
    if wall in ("-h", "--help"):
        return run_session(BACKEND, "", lambda: None, ["--help"], prog=f"{PROG} WALL")
    if wall.startswith("-"):
        raise InputError(f"{wall} comes where a wall file should; give {PROG} WALL.py [OPTIONS]")
    return run_session(
        BACKEND,
        wall_path(wall),
        lambda: load_wall_or_house(wall),
        list(options),
        prog=f"{PROG} {shown_path(wall)}",
    )


def run_references(
    lines, histories=None, settled=None, watch=lambda name, share: None, processes=1
):
    """Run command lines as `run_reference`, up to eight at a time, the next where one has ended,
    without summaries and pictures; the results of a run do not depend on the others, bit for bit.

    lines: iterable of (name, words), the wall file first, each with an --out of its own, or (name,
    (wall file, function of the words before its options that returns RunSettings)); an element is
    taken when a run can begin, and (None, None) means that there is none now; if no run is in
    progress then, all ends.  histories:
    {name: HistoryInMemory or HistoryKept} of runs whose histories are wanted in memory; the class
    is replaced by the object.  settled: checkpoints of earlier runs, as of Rest.  watch: called now
    and then with a run's name and the share of it that is simulated.  processes: that do so at
    once.

    Yields (name, exit status) of each run as it ends.  No run begins after an interrupt.
    """
    histories = {} if histories is None else histories
    settled = OrderedDict() if settled is None else settled
    names = []
    interrupted = []

    def watched(keep_going, name):
        def go_on(run, time_s):
            watch(name, run.share)
            return keep_going(run, time_s)

        return go_on

    def runs():
        for name, line in lines:
            if interrupted:
                return
            names.append(name)
            yield line and with_errors_reported(
                f"{name}: ", _run(name, line, histories, settled, watched(keep_going, name))
            )

    hold_buffers()
    with attended("runs that step together", several=True) as keep_going:
        for number, status in as_they_end(runs(), partial(move, processes=processes), BACKEND.most):
            if status == EXIT_INTERRUPTED:
                interrupted.append(names[number])
            yield names[number], status


def _run(name, line, histories, settled, keep_going):
    """One run: a generator as `damage.run.session.simulate`."""
    wall, *words = line
    make_settings = (
        words[0] if callable(words[0]) else partial(parse_run, words, solver=BACKEND.name)
    )
    settings = make_settings(prog=f"{PROG} {shown_path(wall)}")
    prepared = prepare(
        BACKEND,
        wall,
        lambda: load_wall_or_house(wall),
        settings,
        histories.get(name, HistoryWriter),
    )
    if name in histories:
        histories[name] = prepared.writer
    return (yield from simulate(prepared, keep_going, Rest(settled, prepared)))
