"""Speed of both solvers on the symmetric wall, in one run: python3 benchmarks/speed.py

Each solver moves the intact wall and a wall that has been shaken, at its own working time step; the
least of several pieces counts, since other programs use the machine, too.  Figures are ratios and
seconds of one core for one second of motion, without recording.
"""

import shutil
import subprocess
import sys
import timeit
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from damage.linear.modes import natural_modes
from damage.motion.loading import Harmonic
from damage.reference.wall import ReferenceWall
from damage.run.schedule import STEP_FACTOR
from damage.wall.file import load_wall
from damage.wall.layout import lay_out
from yade_scripts import COMMAND

PIECES = 30
STEPS = 2000


def reference_seconds():
    """{state of the wall: seconds a step}, and the time step [s]."""
    layout = lay_out(load_wall(ROOT / "walls/symmetric.py"))
    step = STEP_FACTOR * natural_modes(layout).critical_time_step_s
    wall = ReferenceWall(layout, step)
    wall.local_damping = 0.7
    wall.run(round(0.4 / step))
    wall.local_damping = 0.0
    result = {"intact": _least(wall)}
    motion = Harmonic(0.2, 0.1)
    wall.start(motion.base_acceleration(np.arange(round(0.6 / step)) * step))
    wall.run(round(0.6 / step))
    result["shaken"] = _least(wall)
    return result, step, len(layout.contacts), int(np.sum(wall.state > 0))


def _least(wall):
    return min(timeit.repeat(lambda: wall.run(STEPS), number=1, repeat=PIECES)) / STEPS


def yade_seconds():
    """Seconds a step of the intact wall in YADE on one core, and its time step [s]."""
    done = subprocess.run(
        [*COMMAND, str(ROOT / "benchmarks/yade_speed.py")],
        capture_output=True,
        text=True,
        cwd=ROOT,
        check=True,
    )
    words = next(line for line in done.stdout.splitlines() if line.startswith("speed")).split()
    return float(words[1]), float(words[2])


def main():
    seconds, step, contacts, broken = reference_seconds()
    print(f"reference, {contacts} contacts, step {step:.3g} s")
    for state, value in seconds.items():
        note = f", {broken} broken" if state == "shaken" else ""
        print(
            f"  {state}{note}: {value / contacts * 1e9:.1f} ns a contact and step, "
            f"{value / step:.2f} s of one core for 1 s of motion"
        )
    if shutil.which("yade") is None:
        print("YADE is not installed: no ratio")
        return
    yade, yade_step = yade_seconds()
    print(
        f"YADE, the same contacts, step {yade_step:.3g} s\n  intact: {yade / contacts * 1e9:.0f} ns"
        f" a contact and step, {yade / yade_step:.1f} s of one core for 1 s of motion"
    )
    print(
        f"ratio for 1 s of motion: {(yade / yade_step) / (seconds['intact'] / step):.1f}; "
        f"a step: {yade / seconds['intact']:.1f}"
    )


if __name__ == "__main__":
    main()
