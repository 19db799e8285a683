"""Inside YADE: what the samples of a run cost, as a share of its steps' time: the symmetric wall
under 0.2 s, 0.05 g.

    ./yade -n -j1 benchmarks/yade_sampling.py [--rounds 4]

Intact, at its beginning, and cracked: once as a run goes, which follows joints and energies and
writes samples, and once by steps alone, in turns.  Processor time; the least of all rounds counts.
"""

import argparse
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(sys.argv[0]).resolve().parents[1]))

from damage.history.writer import HistoryWriter
from damage.law.modes import natural_modes
from damage.run.cooperative import take_turns
from damage.run.options import parse_run
from damage.run.run import Run
from damage.run.schedule import STEP_FACTOR
from damage.wall.file import load_wall
from damage.wall.layout import lay_out
from yade_scripts.leaving import run_and_leave
from yade_scripts.solver import YadeSolver

STEPS, CRACKED_S = 500, 0.4


def prepare(folder):
    """A Run at time zero, whose wall carries its weight after a short static stage."""
    settings = parse_run(
        ["--harmonic", "0.2", "0.05", "--rest", "1"], prog="samples", solver="yade"
    )
    layout = lay_out(load_wall("walls/symmetric.py"), settings.model)
    modes = natural_modes(layout, 1)
    solver = YadeSolver(layout, STEP_FACTOR * modes.critical_time_step_s)
    writer = HistoryWriter(folder / "samples.h5", layout, solver="yade", parameters={}, versions={})
    run = Run(layout, settings, solver, writer, lambda *_: True)
    take_turns([run.come_to_rest()])
    run.start()
    solver.damp()
    return run


def microseconds(run, sampled):
    """Of one step."""
    start = time.process_time()
    run.solver.advance(STEPS, *((run.sample_steps, run.take_samples) if sampled else ()))
    return (time.process_time() - start) / STEPS * 1e6


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=4)
    rounds = parser.parse_args(sys.argv[1:]).rounds
    with tempfile.TemporaryDirectory() as folder:
        run = prepare(Path(folder))
        for name, until_s in (("intact", 0.0), ("cracked", CRACKED_S)):
            while run.time < until_s:
                run.solver.advance(STEPS, run.sample_steps, run.take_samples)
            times = [
                [microseconds(run, sampled) for sampled in (True, False)] for _ in range(rounds)
            ]
            with_samples, alone = map(min, zip(*times))
            broken = int((run.solver.instants().contacts["state"] > 0).sum())
            print(
                f"{name}, {broken} broken: {with_samples:.0f} us a step as a run goes, {alone:.0f}"
                f" by steps alone: {100 * (with_samples / alone - 1):.0f} % more; a sample every"
                f" {run.sample_steps} steps",
                flush=True,
            )
        run.writer.finish("interrupted")
    return 0


run_and_leave(main)
