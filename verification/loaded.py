"""The first period of the shipped walls under their load.

The eigenvalue of the springs alone leaves out that the load leans with the wall.  The stiffness of
the loaded wall is the derivative of the contacts' forces at rest, taken by central differences of
the reference solver's forces: of a tower of weight W on springs it is k - W/h.
`damage.linear.modes`, without gravity, is met to 1e-11.
"""

import math
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from scipy.linalg import eigh

from damage.history.reader import read_history
from damage.linear.modes import natural_modes
from damage.measure.summary import summarise
from damage.reference.wall import ReferenceWall
from damage.units import GRAVITY
from damage.wall.file import load_wall
from damage.wall.layout import lay_out
from verification.problem import ROOT, Problem
from yade_scripts import COMMAND

WALLS = ("solid", "symmetric", "asymmetric")
COMMANDS = {"reference": [sys.executable, "-m", "damage", "reference"], "yade": COMMAND}
_MOVE = 1e-9  # [m, m, rad]: forces are linear over it, and their rounding does not count


def problems():
    """First period of each wall in free vibration, by the real commands."""
    return [
        Problem(
            name=f"{name} wall under its load",
            quantity="first period",
            unit="s",
            exact=lambda name=name: loaded_period(lay_out(load_wall(_file(name)))),
            source="eigenvalue of the derivative of the forces at rest",
            tolerance={"reference": 5e-4, "yade": 5e-4},
            solvers={
                solver: lambda name=name, solver=solver: free_period(name, solver)
                for solver in COMMANDS
            },
        )
        for name in WALLS
    ]


def loaded_period(layout, gravity=GRAVITY):
    """First period [s] of a wall at rest under gravity [m/s2]."""
    wall = ReferenceWall(layout, 0.6 * natural_modes(layout, 1).critical_time_step_s)
    wall.start(np.zeros((0, 2)), np.array([gravity]))
    wall.local_damping = 0.7
    wall.run(30_000)
    stiffness = np.column_stack(
        [_derivative(wall, *which) for which in np.ndindex(len(layout.bodies), 3)]
    )
    mass = np.column_stack([layout.bodies.mass, layout.bodies.mass, layout.bodies.inertia]).ravel()
    lowest = eigh(
        (stiffness + stiffness.T) / 2, np.diag(mass), eigvals_only=True, subset_by_index=[0, 0]
    )[0]
    return 2 * math.pi / math.sqrt(lowest)


def _derivative(wall, body, component):
    """Derivative of minus all bodies' forces by one displacement of one body (3 n_bodies,)."""
    rest = wall.displacement
    forces = []
    for sign in (1, -1):
        moved = rest.copy()
        moved[body, component] += sign * _MOVE
        wall.place_bodies(moved)
        # without the set-up of a new wall, as a new displacement has it
        wall.lanes.find_forces(singly=True)
        forces.append(wall.force[:-1].ravel())
    wall.place_bodies(rest)
    return (forces[1] - forces[0]) / (2 * _MOVE)


def free_period(name, solver):
    """Period [s] of a wall's free vibration, from a run of this solver."""
    with tempfile.TemporaryDirectory() as folder:
        history = Path(folder) / "free.h5"
        subprocess.run(
            [
                *COMMANDS[solver],
                _file(name),
                "--free-vibration",
                "--rest",
                "2",
                "--out",
                history,
                "--no-pictures",
            ],
            cwd=ROOT,
            check=True,
            capture_output=True,
        )
        return summarise(read_history(history))["period_s"]


def _file(name):
    return ROOT / "walls" / f"{name}.py"
