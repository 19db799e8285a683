"""A brick on two supports that is pressed from above: it splits at the load of beam theory.

The supports stand an eighth of the length L from the ends; a load Q rests on two points an eighth
from the middle. Supports and load do not keep the brick, of weight W, from opening: its middle has
the moment

    M = Q L / 8 + W L / 16 = f_t t h^2 / 6

and no shear force when it splits.
"""

from dataclasses import fields, replace

import numpy as np

from damage.wall.kinds import CAP, CUT
from damage.wall.layout import lay_out
from damage.wall.model_options import ModelOptions
from damage.wall.parameters import Brick, Wall
from verification.block import solver_of
from verification.problem import of_both

BRICK = Brick(tensile_strength=1e6)
RAMP_S = 0.1
"""In which the load grows to twice what the brick bears."""


def beam():
    """The brick, its two supports, and a cap on two points; what they do along the brick is next to
    nothing."""
    wall = Wall("beam", BRICK.length, BRICK.height, brick=BRICK, precompression=1e4)
    layout = lay_out(wall, ModelOptions(top="beam"))
    contacts, middle = layout.contacts, BRICK.length / 2
    outer = np.abs(contacts.x - middle) > BRICK.length / 4
    used = np.flatnonzero((contacts.kind == CUT) | (outer != (contacts.kind == CAP)))
    kept = replace(
        contacts, **{one.name: getattr(contacts, one.name)[used] for one in fields(contacts)}
    )
    cut = kept.kind == CUT
    kept = replace(
        kept,
        elastic=~cut,
        **{
            name: np.where(cut, getattr(kept, name), np.inf)
            for name in ("tensile_strength", "cohesion")
        },
        shear_stiffness=np.where(cut, 1.0, 1e-4) * kept.shear_stiffness,
    )
    return replace(layout, contacts=kept, n_joints=int(np.sum(kept.kind != CAP)))


def splitting_load(layout):
    """Q + W [N], both grown alike until the brick splits."""
    *halves, cap = layout.bodies.mass
    moment = BRICK.tensile_strength * BRICK.thickness * BRICK.height**2 / 6
    field = moment / BRICK.length / (cap / 8 + sum(halves) / 16)
    return float(field * layout.total_mass)


def ramp(layout, n):
    """Downward acceleration in each of n steps [m/s2]."""
    return 2 * splitting_load(layout) / layout.total_mass * np.linspace(0, 1, n)


def load():
    """Q + W at the brick's first break [N]."""
    layout = beam()
    wall = solver_of(layout, 0.5)
    wall.local_damping, n = 0.7, round(RAMP_S / wall.time_step)
    field = ramp(layout, n)
    wall.start(np.zeros((0, 2)), field)
    while not wall.state.any() and wall.step < n:
        wall.run(10)
    return float(field[wall.step - 1] * layout.total_mass)


def problems():
    """The load at which a brick splits."""
    return [
        of_both(
            "splitting brick",
            "load on two supports",
            "N",
            lambda: splitting_load(beam()),
            "beam theory, f_t t h^2 / 6",
            2e-2,
            load,
            "splitting_load",
        )
    ]
