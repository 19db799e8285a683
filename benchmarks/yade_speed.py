"""Inside YADE: seconds a step of the intact symmetric wall, for benchmarks/speed.py."""

import sys
import timeit
from pathlib import Path

sys.path.insert(0, str(Path(sys.argv[0]).resolve().parents[1]))

from yade import O

from damage.linear.modes import natural_modes
from damage.run.schedule import STEP_FACTOR
from damage.wall.file import load_wall
from damage.wall.layout import lay_out
from yade_scripts.leaving import run_and_leave
from yade_scripts.model import build


def main():
    layout = lay_out(load_wall("walls/symmetric.py"))
    step = STEP_FACTOR * natural_modes(layout).critical_time_step_s
    model = build(layout, step)
    model.newton.gravity = (0, 0, -9.81)
    model.newton.damping = 0.7
    O.run(500, True)
    least = min(timeit.repeat(lambda: O.run(500, True), number=1, repeat=12)) / 500
    print(f"speed {least} {step}")


run_and_leave(main)
