"""Inside YADE: microseconds a step of the intact symmetric wall, joints by face beside joints between centres.

    ./yade -n -j1 benchmarks/yade_joints.py [--rounds 4]

By engine and in all; the two models take turns, the least of all rounds counts.  Where YADE has no polyhedra there is
one model alone.
"""

import argparse
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(sys.argv[0]).resolve().parents[1]))

from yade import O

from damage.run.schedule import STEP_FACTOR
from damage.wall.file import load_wall
from damage.wall.layout import lay_out
from damage.wall.modes import natural_modes
from damage.wall.parameters import ModelOptions
from yade_scripts.leaving import run_and_leave
from yade_scripts.shapes import HAS_POLYHEDRA
from yade_scripts.solver import YadeSolver

STEPS, PARTS = 500, 6


def engine_times():
    """Microseconds a step of every engine of the scene, and of all: {name: value}."""
    for engine in O.engines:
        engine.execTime = 0
    start = time.perf_counter()
    O.run(STEPS, True)
    total = time.perf_counter() - start
    found = {type(engine).__name__: engine.execTime / STEPS / 1e3 for engine in O.engines}
    return {**found, "all": total / STEPS * 1e6}


def measure(joints):
    """The least times of PARTS parts of one model, settling under gravity."""
    layout = lay_out(load_wall("walls/symmetric.py"), ModelOptions(joints=joints))
    solver = YadeSolver(layout, STEP_FACTOR * natural_modes(layout, 1).critical_time_step_s)
    solver.damp(local=0.7)
    solver.model.newton.gravity = (0, 0, -9.81)
    O.timingEnabled = True
    O.run(200, True)
    rows = [engine_times() for _ in range(PARTS)]
    return {name: min(row[name] for row in rows) for name in rows[0]}, len(O.bodies)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=4)
    rounds = parser.parse_args(sys.argv[1:]).rounds
    models = ("face", "centres") if HAS_POLYHEDRA else ("face",)
    best, bodies = {}, {}
    for _ in range(rounds):
        for joints in models:
            times, bodies[joints] = measure(joints)
            old = best.setdefault(joints, times)
            best[joints] = {name: min(old[name], times[name]) for name in old}
    for name in best["face"]:
        told = ", ".join(f"{joints} {best[joints][name]:7.1f}" for joints in models)
        print(f"{name:24s} {told}" + (f", ratio {best['face'][name] / best['centres'][name]:.2f}"
                                      if len(models) > 1 and best["centres"][name] > 1 else ""))
    print(f"bodies: {bodies}")


run_and_leave(main)
