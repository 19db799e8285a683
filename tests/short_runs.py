"""Solvers of walls, and histories of short runs in the reference solver: `run_of` of `conftest.py`
makes each once, where a test asks for it.

They are of the small wall that ships, five bricks by eight courses with a window, but for the
house.
"""

from dataclasses import replace

from damage import Brick, Floor, Joint, Wall
from damage.linear.modes import natural_modes
from damage.reference.solver import ReferenceSolver
from walls.variants.small import wall


def solver_of(layout, share=0.6, **how):
    """The ReferenceSolver of a layout, with a step of this share of the critical one."""
    step_s = share * natural_modes(layout, 1).critical_time_step_s
    return ReferenceSolver(layout, step_s, **how)


SMALL = wall()
SOFT = replace(
    SMALL, joint=replace(SMALL.joint, mode_i_fracture_energy=12.4, mode_ii_fracture_energy=124.0)
)
STRONG = Joint(tensile_strength=1e6, cohesion=1e6)
HOUSE = Wall(
    "house",
    2.0,
    2.2,
    precompression=0.0,
    brick=Brick(0.2, 0.1, 0.1, 2000.0),
    joint=STRONG,
    outline=((0.0, 1.6), (1.0, 2.2), (2.0, 1.6)),
    floors=(Floor(0.8, 500.0, kind="concrete", depth=0.1), Floor(1.4, 300.0)),
)
"""Two storeys below a gable: a slab above the first, a timber floor above the second."""
SHAKEN = {"harmonic": (0.06, 0.6), "cycles": 2, "rest": 0.1}
GROUND = {"settle": "hogging", "distortion": 1 / 500, "lintel": 2}

RUNS = {  # name: wall, words of damage.run
    "free": (SMALL, {"free_vibration": True, "rest": 0.3}),
    "shaken": (SMALL, SHAKEN),
    "twice": (SMALL, SHAKEN | {"sequence": (1.0, 1.0)}),
    "stresses": (SMALL, SHAKEN | {"stresses": True}),
    "softening": (SOFT, SHAKEN | {"harmonic": (0.06, 0.9)}),
    "deformable": (
        SOFT,
        SHAKEN
        | {
            "harmonic": (0.05, 1.2),
            "bricks": "deformable",
            "contacts": "gauss",
            "mass_scaling": "none",  # scaled strain modes are code of their own
        },
    ),
    "pushed": (SMALL, {"pushover": 0.05, "lintel": 2}),
    "settled": (SMALL, GROUND | {"harmonic": (0.06, 0.2), "rest": 0.1}),
    "settled, pushed": (
        SMALL,
        {"settle": "knick", "distortion": 1 / 1000, "lintel": 2, "pushover": 0.05},
    ),
    "on soil": (SMALL, {"harmonic": (0.1, 0.15), "rest": 0.2, "soil": 5e7}),
    "house": (HOUSE, {"harmonic": (0.05, 0.2), "cycles": 1, "rest": 0.1}),
}
