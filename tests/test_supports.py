"""Supports are bodies whose velocity is prescribed: what they do to a wall, and the work that it takes."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose

from damage.mechanics.tables import INPUT
from damage.reference.wall import ReferenceWall
from damage.units import GRAVITY
from damage.wall.layout import lay_out
from damage.wall.modes import natural_modes
from damage.wall.parameters import Joint, Opening, Wall

STRONG = Joint(tensile_strength=1e9, cohesion=1e9)
SETTLEMENT = 1e-3


@pytest.fixture(params=[True, False], ids=["fast", "plain"])
def wall(request):
    """A small wall with an opening, at rest under its weight."""
    layout = lay_out(Wall("pier", 1.35, 0.6, [Opening(0.45, 0.45, 0.3)], joint=STRONG))
    found = ReferenceWall(layout, 0.6 * natural_modes(layout).critical_time_step_s, fast=request.param)
    come_to_rest(found)
    return found


def come_to_rest(wall, steps=6000):
    wall.adaptive_damping = 1.0
    wall.run(steps)
    wall.adaptive_damping = 0.0
    assert_allclose(wall.force[:-1, 1], weights(wall), rtol=1e-9)


def weights(wall):
    return GRAVITY * wall.layout.bodies.mass


def test_a_settlement_at_constant_velocity_moves_the_wall_as_a_rigid_body(wall):
    """And its work is the weight times the settlement: the wall and its support begin together."""
    before, steps = wall.displacement, 20_000
    velocity = np.array([0.0, -SETTLEMENT / (steps * wall.time_step), 0.0])
    wall.velocity = velocity
    wall.move_supports(velocity)
    wall.energy[:] = 0.0
    wall.run(steps)
    assert_allclose(wall.displacement - before, np.tile([0, -SETTLEMENT, 0], (len(before), 1)), rtol=0, atol=1e-9)
    work = weights(wall).sum() * SETTLEMENT
    assert wall.energy[INPUT] == pytest.approx(-work, abs=1e-9 * work)


def test_work_of_a_support_that_rotates_closes_the_balance(wall):
    """Suddenly and about its edge, so that the wall vibrates: what came in is kinetic, elastic and of gravity."""
    def stored():
        return (wall.kinetic_energy() + wall.elastic_energy()
                + float(weights(wall) @ wall.displacement[:, 1]))

    wall.energy[:] = 0.0
    before = stored()
    wall.move_supports((0.01, -0.02, 0.1))
    wall.run(3000)
    change = stored() - before
    assert abs(change) > 0.1
    # Central differences take the work of a step by the force at its beginning: exact but for a share of (omega dt)^2.
    assert wall.energy[INPUT] == pytest.approx(change, rel=1e-3)


def test_reactions_on_tilted_ground_are_those_of_statics(wall):
    """The whole weight, no thrust, and its moment about the ground's first place."""
    tilt, steps = 0.02, 4000
    wall.local_damping = 0.7
    wall.move_supports((0.0, 0.0, tilt / (steps * wall.time_step)))
    wall.run(steps)
    wall.move_supports(0.0)
    wall.local_damping = 0.0
    come_to_rest(wall, 20_000)
    (fx, fz, moment), = wall.support_force
    weight, x = weights(wall), wall.layout.bodies.x + wall.displacement[:, 0]
    assert_allclose((fx, fz), (0.0, -weight.sum()), rtol=1e-9, atol=1e-9 * weight.sum())
    assert_allclose(moment, -weight @ x, rtol=1e-9)
    x, z = wall.layout.bodies.x, wall.layout.bodies.z
    assert_allclose(wall.displacement[:, 0], -math.sin(tilt) * z + (math.cos(tilt) - 1) * x, atol=1e-4)
