"""Free fall and elastic bounce of one block.

The block falls a height H, meets its joint (stiffness k, omega^2 = k/m) with v = sqrt(2 g H), and
is thrown back: m z'' = -k z - m g while z < 0 gives

    deepest point   z = g/omega^2 + sqrt((g/omega^2)^2 + (v/omega)^2)
    contact time    t = (2/omega) (pi - arctan(v omega/g))

and, since nothing is lost, the height H again.
"""

import math
from functools import cache

import numpy as np

from damage.units import GRAVITY
from verification.block import one_block, solver_of
from verification.problem import of_both

FALL_S = 0.1
HEIGHT = 1e-3
FIGURES = "force", "height", "time"
"""Figures of a bounce."""


def problems():
    """Free fall for 0.1 s; drop from 1 mm: largest contact force, rebound height, time between two
    apexes."""
    layout = one_block()
    mass = float(layout.bodies.mass[0])
    stiffness = _stiffness(layout)
    omega = math.sqrt(stiffness / mass)
    speed = math.sqrt(2 * GRAVITY * HEIGHT)
    sag = GRAVITY / omega**2
    force = stiffness * (sag + math.hypot(sag, speed / omega))
    contact = 2 / omega * (math.pi - math.atan(speed * omega / GRAVITY))
    bounce = "closed form of a mass on a one-sided spring, see the module"
    return [
        of_both(
            "free fall",
            f"way in {FALL_S:g} s",
            "m",
            GRAVITY * FALL_S**2 / 2,
            "Galilei, z = g t^2/2",
            1e-9,
            _fall,
            "fall",
            FALL_S,
        ),
        *(
            of_both(
                f"elastic bounce, {what}",
                quantity,
                unit,
                exact,
                bounce,
                2e-3,
                lambda key=what: _bounce()[key],
                "bounce",
                HEIGHT,
                float(FIGURES.index(what)),
            )
            for what, quantity, unit, exact in (
                ("force", "largest contact force after 1 mm", "N", force),
                ("height", "rebound height", "m", HEIGHT),
                ("time", "time between two apexes", "s", 2 * speed / GRAVITY + contact),
            )
        ),
    ]


def _stiffness(layout):
    return float((layout.contacts.normal_stiffness * layout.contacts.area).sum())


def _fall():
    wall = solver_of(one_block(), 0.5)
    wall.displacement = (0.0, 10.0, 0.0)
    start = wall.displacement[0, 1]
    steps = round(FALL_S / wall.time_step)
    # half a step ago, so that it is at rest now
    wall.velocity = (0.0, GRAVITY * wall.time_step / 2, 0.0)
    wall.run(steps)
    # Its whole number of steps is not quite 0.1 s.
    return (start - wall.displacement[0, 1]) * (FALL_S / (steps * wall.time_step)) ** 2


@cache
def _bounce():
    layout = one_block()
    wall = solver_of(layout, 0.01)
    wall.displacement = (0.0, HEIGHT, 0.0)
    wall.velocity = (0.0, GRAVITY * wall.time_step / 2, 0.0)
    steps = round(2.2 * math.sqrt(2 * HEIGHT / GRAVITY) / wall.time_step)
    track = np.empty(steps)
    force = 0.0
    for k in range(steps):
        wall.run(1)
        track[k] = wall.displacement[0, 1]
        force = max(force, wall.force[0, 1])
    return apexes(track, wall.time_step, force)


def apexes(track, dt, force):
    """Figures of a track of heights [m], one a step from the first on, and the largest force
    [N]."""
    lowest = int(np.argmin(track))
    top = lowest + int(np.argmax(track[lowest:]))
    low, mid, high = track[top - 1 : top + 2]
    fine = 0.5 * (low - high) / (low - 2 * mid + high)  # a parabola through three samples
    return dict(zip(FIGURES, (force, float(mid), (top + 1 + fine) * dt)))
