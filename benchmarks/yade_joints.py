"""Inside YADE: microseconds a step of the intact symmetric wall, by engine and in all; the least of
all parts counts.

    ./yade -n -j1 benchmarks/yade_joints.py [--parts 24]
"""

import argparse
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(sys.argv[0]).resolve().parents[1]))

from yade import O

from damage.law.modes import natural_modes
from damage.run.schedule import STEP_FACTOR
from damage.wall.file import load_wall
from damage.wall.layout import lay_out
from yade_scripts.leaving import run_and_leave
from yade_scripts.solver import YadeSolver

STEPS = 500


def engine_times():
    """Microseconds a step of every engine of the scene, and of all: {name: value}."""
    for engine in O.engines:
        engine.execTime = 0
    start = time.perf_counter()
    O.run(STEPS, True)
    total = time.perf_counter() - start
    found = {type(engine).__name__: engine.execTime / STEPS / 1e3 for engine in O.engines}
    return {**found, "all": total / STEPS * 1e6}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--parts", type=int, default=24)
    parts = parser.parse_args(sys.argv[1:]).parts
    layout = lay_out(load_wall("walls/symmetric.py"))
    solver = YadeSolver(layout, STEP_FACTOR * natural_modes(layout, 1).critical_time_step_s)
    solver.damp(local=0.7)
    solver.model.newton.gravity = (0, 0, -9.81)
    O.timingEnabled = True
    O.run(200, True)
    rows = [engine_times() for _ in range(parts)]
    for name in rows[0]:
        print(f"{name:24s} {min(row[name] for row in rows):7.1f}")
    print(f"bodies: {len(O.bodies)}")


run_and_leave(main)
