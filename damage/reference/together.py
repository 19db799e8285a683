"""Runs that step together, up to eight at a time, to the same bits as alone.

A run goes on from one sample to the next and hands out the steps between, and so does every other; when all have done
so, those that are to go equally far are moved as lanes of one block.  Nothing of a run knows of the others.
"""

from damage.history.writer import HistoryWriter
from damage.memory import hold_buffers
from damage.provenance import shown_path
from damage.reference.companies import LEAST_LANES, Companies
from damage.reference.lanes import MOST_LANES
from damage.reference.session import BACKEND, PROG
from damage.reference.settled import SettledWalls
from damage.run.options import parse_run
from damage.run.session import EXIT_INTERRUPTED, EXIT_OK, attended, prepare, reported, simulate, with_errors_reported
from damage.run.turns import take_turns
from damage.wall.file import load_wall


def run_references(lines, histories=None, settled=None):
    """Run command lines as `run_reference` does, the wall file first, in groups of up to eight; what each ended with is
    in its history, of which no summary and no picture is made.

    lines: {name: words}, each with an --out of its own; histories: {name: HistoryInMemory or HistoryKept} of runs whose
    histories are wanted in memory, each of which gets its own in place of the class; settled: SettledWalls of runs
    before, for more to come.  Yields {name: exit status} of each group as it ends, and no group after one that was
    interrupted.
    """
    names = list(lines)
    for group in groups(len(names)):
        statuses = _run_group({names[k]: lines[names[k]] for k in group}, histories or {}, settled or SettledWalls())
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


def _run_group(lines, histories, settled):
    """{name: exit status} of runs that step together."""
    prepared, statuses = {}, {}

    def begin(name, wall, words):
        settings = parse_run(words, prog=f"{PROG} {shown_path(wall)}", solver=BACKEND.name)
        write = histories.get(name, HistoryWriter)
        prepared[name] = prepare(BACKEND, wall, lambda: load_wall(wall), settings, write)
        if name in histories:
            histories[name] = prepared[name].writer
        return EXIT_OK

    others = f" and {len(lines) - 1} more" if len(lines) > 1 else ""
    hold_buffers()
    with attended(f"{next(iter(lines))}{others}") as keep_going:
        for name, (wall, *words) in lines.items():
            statuses[name] = reported(lambda name=name, wall=wall, words=words: begin(name, wall, words), f"{name}: ")
        runs = [with_errors_reported(f"{name}: ", simulate(one, keep_going, wall))
                for (name, one), wall in zip(prepared.items(), settled.of_group(prepared.values()))]
        statuses |= zip(prepared, take_turns(runs, Companies().move))
    return statuses
