"""Joints that crush: a toe under a rigid block, a column, and a joint that is pressed again and
again.

A rigid block on a joint of compressive strength f_c, pressed by N and pushed sideways at its
centre, h / 2 up, turns about a toe on which the stress is f_c: a stress block of length N / (f_c
t), so that

    H h / 2 = N / 2 (L - N / (f_c t)).

Contact points of length l crush one by one; that shifts the resultant by up to l / 8 over the toe's
length in points. A column bears no more than f_c A.  A joint that is pressed further each time, and
unloaded between, dissipates f_c times its closure, whatever its bond; pulled apart then, its bond's
energy besides.  With a fracture energy G_c of crushing it dissipates G_c (1 - exp(-f_c d / G_c))
over a closure d, where k_n (u - d) = f_c exp(-f_c d / G_c) at the deepest closing displacement u.
"""

from functools import cache
from itertools import product

import numpy as np
from scipy.optimize import brentq

from damage.units import GRAVITY
from damage.wall.layout import lay_out
from damage.wall.model_options import ModelOptions
from damage.wall.parameters import Brick, Joint, Wall
from verification.block import settle, solver_of
from verification.problem import SOLVERS, Problem, of_both
from verification.softening import between, drive, drive_in_yade, pair

BLOCK = Brick(length=0.4, height=0.8, thickness=0.1)
TOE = 0.25
"""Share of the block's length that its toe takes [-]."""
PUSH_M_S = 4e-4
"""Largest speed of the block's centre, which grows in parts from nothing [m/s]."""
PUSHED_M = 2e-4
"""Distance that the centre is pushed [m]: 0.2 mm shift the load by 0.13 %."""
PARTS = 20
"""Number of parts in which the speed grows."""
STRENGTH = 2e6
"""Compressive strength of the joint that is pressed again and again [Pa]."""
PRESSED = (2.0, 3.0, 4.0)
"""How far, over the depth at which it crushes, the joint is pressed each time."""
DRY = "without a bond, to 1.2 mm"
"""Form whose bond is broken first."""
OPENED = 10.0
"""Opening of that form, and how far it is pressed then, over the others [-]."""
SOFTENS = "softening in compression, without a bond"
"""Form whose crushing has a fracture energy."""
ENERGY = 1000.0
"""Fracture energy of that form [J/m2]."""
_BRITTLE = {"mode_i_fracture_energy": None, "mode_ii_fracture_energy": None}
FORMS = {
    "brittle": _BRITTLE,
    DRY: {"tensile_strength": 0.0, "cohesion": 0.0, **_BRITTLE},
    SOFTENS: {
        "tensile_strength": 0.0,
        "cohesion": 0.0,
        "compressive_fracture_energy": ENERGY,
        **_BRITTLE,
    },
    "softening": {},
    "softening in tension and compression": {"compressive_fracture_energy": ENERGY},
}
"""Name -> what is changed of JOINT beside its compressive strength."""


def block():
    """The block on a dry joint that does not slide, sixteen contact points, crushed over a quarter
    by its weight."""
    weight_n = BLOCK.density * BLOCK.length * BLOCK.height * BLOCK.thickness * GRAVITY
    joint = Joint(
        tensile_strength=0.0,
        cohesion=0.0,
        friction_angle=1.4,
        compressive_strength=weight_n / (TOE * BLOCK.length * BLOCK.thickness),
    )
    return lay_out(
        Wall("block", BLOCK.length, BLOCK.height, brick=BLOCK, joint=joint, precompression=0.0),
        ModelOptions(cells=8),
    )


def toe():
    """The force that pushes the block's centre, at the end [N]."""
    wall = solver_of(block(), 0.5)
    settle(wall, GRAVITY)
    wall.local_damping = 0.7
    wall.hold(np.array([0]), rotation=False)
    for speed, steps in pushes(wall.time_step):
        wall.push(speed)
        wall.run(steps)
    return wall.push_force()


def pushes(time_step):
    """[(speed [m/s], steps), ...] of the push."""
    speeds = PUSH_M_S * np.arange(1, PARTS + 1) / PARTS
    return [(float(speed), round(PUSHED_M / speeds.sum() / time_step)) for speed in speeds]


def column_force(layout):
    """f_c A [N]."""
    return layout.wall.joint.compressive_strength * BLOCK.length * BLOCK.thickness


def column():
    """The largest force under the block while it has twice the weight that its joint bears [N]."""
    layout = block()
    wall = solver_of(layout, 0.5)
    forces = []
    wall.start(np.zeros((0, 2)), np.array([2 * column_force(layout) / layout.bodies.mass[0]]))
    for _ in range(200):
        wall.run(1)
        forces.append(wall.base_force()[1])
    return max(forces)


def joint_of(form):
    """{parameter: value} of a form's joint: what makes of JOINT one that crushes."""
    return {"compressive_strength": STRENGTH, **FORMS[form]}


def cycles(form, steps=400):
    """Path (n, 2) of opening and shear displacement [m]: pressed further each time and unloaded, at
    last to nothing."""
    depth = STRENGTH / _stiffness()
    dry = form in (DRY, SOFTENS)
    further = OPENED if dry else 1.0
    corners = [0.0, depth, 0.0] if dry else [0.0]
    for pressed in PRESSED:
        corners += [-further * pressed * depth, -closure(form, further * pressed * depth)]
    parts = [np.linspace(a, b, steps, endpoint=False) for a, b in zip(corners[:-1], corners[1:])]
    opening = np.concatenate([*parts, corners[-1:]])
    return np.column_stack([opening, np.zeros_like(opening)])


def crushed_and_slid(pressing=4000, sliding=400):
    """Path (n, 2) of opening and shear displacement [m] of a dry joint that crushes: slid to and
    fro at three depths, the last of which leaves it a third of its strength, and unloaded between.

    pressing, sliding: steps to each corner.  In YADE the friction limit of a step is that of its
    pressure before crushing, too high by k_n times what the joint closes in the step.
    """
    depth = STRENGTH / _stiffness()
    corners = [(0.0, 0.0), (depth, 0.0)]
    steps = [sliding]
    for pressed in (5 * depth, 10 * depth, 20 * depth):
        corners += [
            (-pressed, 0.0),
            (-pressed, 2e-4),
            (-pressed, -2e-4),
            (-pressed + 0.2 * depth, 0.0),
        ]
        steps += [pressing, sliding, sliding, sliding]
    parts = [
        np.linspace(a, b, number, endpoint=False)
        for a, b, number in zip(corners[:-1], corners[1:], steps)
    ]
    return np.vstack([*parts, corners[-1]])


def softens(form):
    """Whether the crushing of a form has a fracture energy."""
    return "compressive_fracture_energy" in FORMS[form]


def closure(form, deepest):
    """Plastic closure [m] of a form's joint that was closed by `deepest` [m], where k_n (deepest -
    d) is what is left of its strength."""
    stiffness = _stiffness()
    if not softens(form):
        return deepest - STRENGTH / stiffness
    return brentq(
        lambda d: stiffness * (deepest - d) - STRENGTH * np.exp(-STRENGTH * d / ENERGY),
        0.0,
        deepest,
    )


def _stiffness():
    """k_n of the joint [Pa/m]."""
    layout = pair()
    return float(layout.contacts.normal_stiffness[between(layout)])


def lost(form):
    """What the joint dissipates in the cycles [J/m2]."""
    path = cycles(form)
    if not softens(form):
        return -STRENGTH * float(path[-1, 0])
    return ENERGY * -np.expm1(-STRENGTH * closure(form, -float(path[:, 0].min())) / ENERGY)


@cache
def driven(solver, form):
    """The joint Driven through the cycles."""
    return driven_along(solver, form, cycles(form))


def driven_along(solver, form, path):
    """The joint of a form Driven along a path."""
    if solver == "reference":
        return drive(path, **joint_of(form))
    return drive_in_yade({"path": path}, **joint_of(form))["path"]


def problems():
    """Toe, column, cycles."""
    layout = block()
    weight_n = float(layout.bodies.mass[0]) * GRAVITY
    found = [
        of_both(
            "crushing toe",
            "force that turns a block about its toe",
            "N",
            weight_n * (1 - TOE) * BLOCK.length / BLOCK.height,
            "stress block of f_c",
            2e-2,
            toe,
            "toe",
        ),
        of_both(
            "crushed column",
            "largest force under it",
            "N",
            column_force(layout),
            "f_c A",
            {"reference": 2e-8, "yade": 2e-2},
            column,
            "column",
        ),
    ]
    for form, (quantity, measure) in product(
        FORMS,
        (
            ("energy dissipated", lambda done: done.dissipated),
            ("... by its own account", lambda done: done.fracture),
        ),
    ):
        found.append(
            Problem(
                name=f"crushing in cycles, {form}",
                quantity=quantity,
                unit="J/m²",
                exact=lost(form),
                source="G_c (1 - exp(-f_c d / G_c))" if softens(form) else "f_c times the closure",
                tolerance=dict.fromkeys(SOLVERS, 1e-3 if softens(form) else 5e-3),
                solvers={
                    "reference": lambda form=form, measure=measure: measure(
                        driven("reference", form)
                    ),
                    "yade": lambda form=form, measure=measure: measure(driven("yade", form)),
                },
            )
        )
    return found
