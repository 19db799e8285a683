"""A brick on two supports that is pressed from above: it splits at the load of beam theory.

The supports stand an eighth of the length L from the ends; a load Q rests on two points an eighth
from the middle. Supports and load do not keep the brick, of weight W, from opening: its middle has
the moment

    M = Q L / 8 + W L / 16 = f_t t h^2 / 6

and no shear force when it splits.

Diagonal tension: a brick on the ground is pressed down, so that half of the stress below it, sigma,
is that of its middle; then its halves move up and down against each other. The cut bears

    V = t h f_t sqrt(1 + sigma / f_t) / 1.15

at most, and has dissipated its fracture energy times t h when it bears nothing.
"""

from dataclasses import fields, replace
from functools import partial

import numpy as np

from damage.mechanics.tables import FRACTURE, Z
from damage.reference.wall import ReferenceWall
from damage.wall.kinds import BED, CAP, CUT
from damage.wall.layout import lay_out
from damage.wall.model_options import ModelOptions
from damage.wall.parameters import Brick, Joint, Wall
from damage.wall.split import PEAK
from verification.block import solver_of
from verification.problem import of_both

BRICK = Brick(tensile_strength=1e6)
SHEARED = Brick(tensile_strength=1e6, fracture_energy=60.0)
APART_M = 5e-4
STEPS = 4000
"""Brick in diagonal tension, how far its halves move, and in how many steps."""
RAMP_S = 0.1
"""In which the load grows to twice what the brick bears."""


def beam():
    """The brick, its two supports, and a cap on two points; what they do along the brick is next to
    nothing."""
    wall = Wall("beam", BRICK.length, BRICK.height, brick=BRICK, precompression=1e4)
    layout = lay_out(wall, ModelOptions(top="beam"))
    contacts = layout.contacts
    middle = BRICK.length / 2
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
    wall.local_damping = 0.7
    n = round(RAMP_S / wall.time_step)
    field = ramp(layout, n)
    wall.start(np.zeros((0, 2)), field)
    while not wall.state.any() and wall.step < n:
        wall.run(10)
    return float(field[wall.step - 1] * layout.total_mass)


def on_ground():
    """A brick that stays on the ground."""
    sticks = Joint(tensile_strength=1e12, cohesion=1e12)
    return lay_out(
        Wall("one", BRICK.length, BRICK.height, brick=SHEARED, joint=sticks, precompression=0.0)
    )


def halves_moved(layout, stress):
    """Displacements (n, 2) along z [m] of the halves by which a brick on_ground is sheared under a
    vertical stress [Pa]."""
    sunk = 2 * stress / layout.contacts.normal_stiffness[layout.contacts.kind == BED][0]
    apart = np.linspace(0.0, APART_M, STEPS)
    return np.column_stack([-sunk - apart / 2, -sunk + apart / 2])


def largest_shear(stress):
    """V [N] under a vertical stress [Pa]."""
    strength = SHEARED.tensile_strength
    return SHEARED.thickness * SHEARED.height * np.sqrt(strength * (strength + stress)) / PEAK


def sheared(stress, what):
    """Results of a brick sheared under a vertical stress [Pa] in the reference solver: 0 the
    largest shear force [N], 1 the energy dissipated [J]."""
    layout = on_ground()
    wall = ReferenceWall(layout, 1e-6)
    cut = layout.contacts.kind == CUT
    forces = []
    for places in halves_moved(layout, stress):
        wall.system.place[:2, Z] = places
        wall.lanes.find_forces(singly=True)
        wall.lanes.confine(wall)
        forces.append(np.sum(wall.stresses[1, cut] * layout.contacts.area[cut]))
    return (max(forces), float(wall.energy[FRACTURE]))[what]


def problems():
    """The loads at which a brick splits, and what that takes."""
    area = SHEARED.thickness * SHEARED.height
    return [
        of_both(
            f"brick sheared under {stress / 1e6:g} MPa, {quantity}",
            quantity,
            unit,
            exact,
            source,
            1e-2,
            partial(sheared, stress, what),
            "diagonal_tension",
            stress,
            what,
        )
        for stress in (0.0, 2e6)
        for what, (quantity, unit, exact, source) in enumerate(
            (
                ("largest force", "N", largest_shear(stress), "Mann and Müller"),
                ("energy", "J", SHEARED.fracture_energy * area, "G t h"),
            )
        )
    ] + [
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
