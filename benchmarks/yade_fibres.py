"""Inside YADE: what a step of the symmetric wall costs by fibres, over a step of brittle joints.

    ./yade -n -j1 benchmarks/yade_fibres.py [--rounds 6]

Intact, and with 30 % of the joints broken, or by fibres, half broken: each of these is a bond and a
dry contact. Processor time, joints followed as in a run; the three take turns, the least of all
rounds counts.
"""

import argparse
import sys
import time
from dataclasses import replace
from pathlib import Path

sys.path.insert(0, str(Path(sys.argv[0]).resolve().parents[1]))

import numpy as np
from yade import O

from damage.law.modes import natural_modes
from damage.run.schedule import SOFTENING_STEP_FACTOR
from damage.wall.file import load_wall
from damage.wall.layout import lay_out
from damage.wall.model_options import ModelOptions
from yade_scripts.leaving import run_and_leave
from yade_scripts.solver import YadeSolver

STEPS, SHARE = 400, 0.3
NUMBERS = (0, 8, 16)


def wall_of(fibres):
    wall = load_wall("walls/symmetric.py")
    if fibres:
        wall = replace(
            wall,
            joint=replace(wall.joint, mode_i_fracture_energy=5.0, mode_ii_fracture_energy=50.0),
        )
    return lay_out(wall, ModelOptions(fibres=fibres))


def break_some(solver):
    """Break joints, or half of their fibres, without a force left in them."""
    layout, scene, tracker = solver.layout, solver.scene, solver.tracker
    weak = np.flatnonzero(~layout.contacts.elastic)
    for joint in np.random.default_rng(1).choice(weak, int(SHARE * len(weak)), replace=False):
        scene.holding.remove(joint)
        if layout.fibres is None:
            solver.model.loosen(joint)
            tracker.breaks(joint, "tension", 0.0, 0.0)
            continue
        strengths = layout.fibres.tensile_strength[layout.fibres.contact == joint]
        for share, kind, last in scene.give_way(
            joint, strengths[len(strengths) // 2 - 1] * (1 + 1e-9), 0.0
        ):
            tracker.fibre_breaks(joint, kind, 0.0, 0.0, share, last)
    O.forces.reset()  # what held them open


def measure(fibres, broken):
    """Milliseconds a step."""
    layout = wall_of(fibres)
    solver = YadeSolver(
        layout, SOFTENING_STEP_FACTOR * natural_modes(layout, 1).critical_time_step_s
    )
    solver.start(np.zeros((0, 2)), np.zeros(1))
    if broken:
        break_some(solver)
    solver.advance(50, 10**9, lambda now: True)
    start = time.process_time()
    solver.advance(STEPS, 10**9, lambda now: True)
    return (time.process_time() - start) / STEPS * 1e3


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=6)
    rounds = parser.parse_args(sys.argv[1:]).rounds
    for broken in (False, True):
        best = np.min(
            [[measure(fibres, broken) for fibres in NUMBERS] for _ in range(rounds)], axis=0
        )
        softening = ", ".join(
            f"{fibres} fibres {value:.2f} ms ({value / best[0]:.2f})"
            for fibres, value in zip(NUMBERS[1:], best[1:])
        )
        print(
            f"{f'{SHARE:.0%} broken' if broken else 'intact':12s} brittle {best[0]:.2f} ms,"
            f" {softening}",
            flush=True,
        )


run_and_leave(main)
