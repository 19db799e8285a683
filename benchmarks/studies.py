"""Runs an hour of a study: members one after another and in lanes, a piece of the fragility study, in turns.

    python3 benchmarks/studies.py                              # 2 points of 8 members, 3 rounds, about 4 minutes
    python3 benchmarks/studies.py --members 4 --rounds 1

All ways do all that a member needs: a record, a history, its tables' rows.  One after another is a process that does
a member whole before the next, as studies did up to now, its summary printed and its history read again for the
tables; in lanes is what `damage/batch/worker.py` does with a group in one process, where all histories are kept
and where those of each point's first run are.  A round does each of the points in every way, and the last way first
every second time; the ratio is of the processor's seconds, its median and range over the rounds.  Then come the account
of the time in each, timed in one more round without which the ratio is taken, the time of two processes at once, bytes
of a run, and what they say of 100 000 runs on a node of 64 cores.
"""

import argparse
import contextlib
import io
import json
import multiprocessing
import statistics
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from damage.history.in_memory import HistoryInMemory, HistoryKept
from damage.history.reader import read_history
from damage.history.writer import HistoryWriter
from damage.measure.tables import RUN_TABLES, summary_row, write_run_tables
from damage.reference import lanes
from damage.reference import session as of_reference
from damage.reference.session import run_reference, run_references
from damage.reference.solver import ReferenceSolver
from damage.run import session
from damage.run.run import Run
from damage.studies.records import record_of

BGAR = ROOT / "damage/data/zeerijp_20180108/BGAR_HGE_acc_m_s2.csv"
SCALES = (1.5, 0.5)
"""Of the points: one cracks widely, one hardly."""
RUNS, CORES = 100_000, 64
"""What is extrapolated to."""


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--members", type=int, default=8)
    parser.add_argument("--rounds", type=int, default=3)
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        measure(folder, asked.members, asked.rounds)


def measure(folder, members, rounds):
    """Measure and print all."""
    ways = {"one after another": one_after_another, "in lanes": in_lanes, "in lanes, summary": in_lanes_for_a_summary}
    for way in ways.values():  # compiles, or loads what is compiled
        timed(way, folder, lines(folder, SCALES[0], 1))
    seconds = {name: [] for name in ways}
    for number in range(rounds):
        for name in sorted(ways, reverse=number % 2 == 1):
            seconds[name].append(sum(timed(ways[name], folder, lines(folder, scale, members)) for scale in SCALES))
            print(f"round {number + 1}, {name}: {seconds[name][-1] / members / len(SCALES):.3f} s a run", flush=True)
    for name in list(ways)[1:]:
        ratios = [one / other for one, other in zip(seconds["one after another"], seconds[name])]
        print(f"ratio of runs an hour, {name}: {statistics.median(ratios):.2f} ({min(ratios):.2f} to "
              f"{max(ratios):.2f})")
    count = members * len(SCALES)
    for name, way in ways.items():
        print_account(name, way, folder, members)
    alone, both = (wall_time(folder, members, processes) for processes in (1, 2))
    print(f"in lanes, at {SCALES[0]}: {3600 * members / alone:.0f} runs an hour of one process, "
          f"{3600 * 2 * members / both:.0f} of two at once")
    histories = [path.stat().st_size for path in folder.rglob("*.h5")]
    records = [len(json.dumps(record_of(read_history(path), path.stem, "p"))) for path in folder.rglob("*.h5")]
    print_extrapolation(statistics.median(seconds["in lanes"]) / count, alone / both, histories, records)


def print_extrapolation(a_run_s, scaling, histories, records):
    """Print what a large study would take: by the processor's seconds a run, by the share of it that is left of a core
    where its neighbour works, too, and by the mean sizes [bytes]."""
    history, record = statistics.mean(histories), statistics.mean(records)
    hours = RUNS * a_run_s / scaling / CORES / 3600
    print(f"a history has {history / 1e6:.2f} MB, a record {record / 1e3:.1f} kB")
    print(f"{RUNS} runs on {CORES} cores: {hours:.2f} h, {RUNS * history / 1e9:.0f} GB with all histories, "
          f"{(RUNS * record + RUNS / 25 * history) / 1e9:.1f} GB with those of one member of 25")


def lines(folder, scale, members):
    """{name: words} of a point's members."""
    return {f"{scale}_s{k}": [
        str(ROOT / "walls/symmetric.py"), "--record", str(BGAR), "--scale", str(scale), "--window", "18.2", "22.1",
        "--rest", "0.1", "--strength-cov", "0.3", "--strength-seed", str(k), "--no-pictures", "--overwrite",
        "--out", str(folder / f"{scale}_s{k}.h5")] for k in range(1, members + 1)}


def one_after_another(folder, asked):
    """As an ensemble was run before there were lanes."""
    for number, (name, words) in enumerate(asked.items()):
        run_reference(words)
        history = read_history(folder / f"{name}.h5")
        write_run_tables(history, folder / name, RUN_TABLES if number == 0 else ("cycles",))
        summary_row(history)


def in_lanes(folder, asked, in_memory=()):
    """As `damage/batch/worker.py` runs a group; in_memory: names of those whose histories are not kept."""
    histories = {name: HistoryInMemory if name in in_memory else HistoryKept for name in asked}
    for _ in run_references(asked.items(), histories):
        pass
    for number, name in enumerate(asked):
        history = histories.pop(name).history()
        if number == 0:
            write_run_tables(history, folder / name)
        record_of(history, name, "p")


def in_lanes_for_a_summary(folder, asked):
    """The same with --keep summary."""
    in_lanes(folder, asked, list(asked)[1:])


def timed(way, *arguments):
    """Seconds of the processor."""
    start = time.process_time()
    with contextlib.redirect_stdout(io.StringIO()):
        way(*arguments)
    return time.process_time() - start


def wall_time(folder, members, processes):
    """Seconds that so many processes take side by side, each with the members of the first point in lanes."""
    def work(number):
        mine = folder / str(number)
        mine.mkdir(exist_ok=True)
        timed(in_lanes, mine, lines(mine, SCALES[0], members))

    workers = [multiprocessing.get_context("fork").Process(target=work, args=(number,)) for number in range(processes)]
    start = time.monotonic()
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    return time.monotonic() - start


# --- where the time goes ----------------------------------------------------------------------------

PARTS = {
    "record, options": (session, ["parse_run"]), "layout": (session, ["lay_out"]),
    "modes": (session, ["natural_modes"]),
    "history: begin": (HistoryWriter, ["__init__"]),
    "history: write": (HistoryWriter, ["append", "extend", "event", "snapshot", "static_stage", "flush"]),
    "history: seal": (HistoryWriter, ["finish"]),
    "history in memory": (HistoryInMemory, ["__init__", "static_stage", "flush", "finish", "history"]),
    "steps": (lanes.kernel, ["run"]),
    "between stretches": (lanes.Lanes, ["run", "__init__"]),
    "instants, events": (ReferenceSolver, ["instants", "drain_events", "forces", "base_reaction"]),
    "samples": (Run, ["take_samples"]),
    "stages": (session, ["take_turns"]), "stages and turns": (of_reference, ["as_they_end"]),
    "summary": (session, ["report"]), "reading": (sys.modules[__name__], ["read_history"]),
    "tables": (sys.modules[__name__], ["write_run_tables", "summary_row", "record_of"]),
}


def print_account(name, way, folder, members):
    """Print the processor's seconds a run by parts, each without those within it."""
    spent, within, undo = Counter(), [], []
    for part, (owner, names) in PARTS.items():
        for one in names:
            undo.append((owner, one, getattr(owner, one)))
            setattr(owner, one, counted(getattr(owner, one), part, spent, within))
    try:
        total = sum(timed(way, folder, lines(folder, scale, members)) for scale in SCALES)
    finally:
        for owner, one, function in undo:
            setattr(owner, one, function)
    count = members * len(SCALES)
    print(f"{name}: {total / count:.3f} s a run")
    for part, value in [*spent.most_common(), ("the rest", total - sum(spent.values()))]:
        print(f"  {part:20s}{value / count:8.4f} s {100 * value / total:5.1f} %")


def counted(function, part, spent, within):
    """A function whose time, without that of others in it, is added to `spent`; within: times of what is in those that
    are under way [s]."""
    def run(*arguments, **named):
        start = time.thread_time()
        within.append(0.0)
        try:
            return function(*arguments, **named)
        finally:
            took = time.thread_time() - start
            spent[part] += took - within.pop()
            if within:
                within[-1] += took
    return run


if __name__ == "__main__":
    main()
