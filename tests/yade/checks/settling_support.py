"""A pier whose left support settles and rotates, in either solver: `settle`, or inside YADE

yade -n settling_support.py RESULTS.npz
"""

import sys
from pathlib import Path

import numpy as np

if __name__ == "__main__":  # in YADE, which does not look here by itself
    sys.path.insert(0, str(Path(sys.argv[0]).resolve().parents[3]))

from damage import Joint, ModelOptions, Wall
from damage.linear.modes import natural_modes
from damage.run.schedule import sample_steps
from damage.run.solver import NO_MOTION
from damage.units import GRAVITY
from damage.wall.layout import lay_out

RAMP_S = 0.1
SETTLES_S = 0.1
RESTS_S = 0.4
MOTION = 2e-4, -1e-3, 2e-3
"""Motion of the left support's reference point at the end [m, m, rad]."""


def pier():
    """(Layout, time step [s]) of a pier on two supports, one below each brick of its base, that
    cannot crack."""
    layout = lay_out(
        Wall(
            "pier", 0.45, 0.6, precompression=0.1e6, joint=Joint(tensile_strength=1e9, cohesion=1e9)
        ),
        ModelOptions(supports="bricks"),
    )
    return layout, 0.4 * natural_modes(layout).critical_time_step_s


def settle(solver):
    """Let the left support settle and the pier come to rest; {name: values}, energies and motion
    since it began."""
    dt = solver.time_step
    every = sample_steps(dt)
    solver.damp(local=0.7)
    ramp = round(RAMP_S / dt)
    solver.start(NO_MOTION, GRAVITY * np.arange(ramp + 1) / ramp)
    advance(solver, 4 * ramp)
    solver.start(NO_MOTION, np.array([GRAVITY]))
    before = solver.instants()
    steps = every * round(SETTLES_S / dt / every)
    velocities = np.zeros((2, 3))
    velocities[0] = np.divide(MOTION, steps * dt)
    solver.move_supports(velocities)
    advance(solver, steps, every)
    solver.move_supports(0.0 * velocities)
    advance(solver, every * round(RESTS_S / dt / every), every)
    now = solver.instants()
    return {
        "moved": now.displacement[0] - before.displacement[0],
        "supports": now.support_displacement[0] - before.support_displacement[0],
        "reactions": now.support_force[0],
        "input_j": now.input_j - before.input_j,
    }


def advance(solver, n_steps, every=None):
    for one, *steps in solver.advance(n_steps, every, (lambda now: True) if every else None):
        one.run(*steps)


if __name__ == "__main__":
    from yade_scripts.leaving import run_and_leave
    from yade_scripts.solver import YadeSolver

    run_and_leave(lambda: np.savez(sys.argv[1], **settle(YadeSolver(*pier()))))
