"""Walls whose inputs are drawn from damage/data/ranges."""

import math

import numpy as np
import pytest
from pytest import approx
from short_runs import HOUSE, SMALL

from damage import Brick, Joint, Wall, run
from damage.house.drawn import INPUTS, Range, drawn, ranges
from damage.wall.restraints import Restraint

KNOWLEDGE = "tested", "typical"


@pytest.mark.parametrize("knowledge", KNOWLEDGE)
def test_factors_have_the_moments_of_their_ranges_and_are_independent(knowledge):
    of = ranges(knowledge)
    assert set(of) == set(INPUTS)
    factors = np.array(
        [
            [of[name].factor((seed, 3, 1, k)) for k, name in enumerate(INPUTS, 1)]
            for seed in range(900)
        ]
    )
    for name, one in zip(INPUTS, factors.T):
        if of[name].cov is None:
            assert of[name].low <= one.min() and one.max() <= of[name].high
            assert np.median(one) == approx(math.sqrt(of[name].low * of[name].high), rel=0.1)
        else:
            assert one.mean() == approx(1, abs=4 * of[name].cov / 30)
            assert one.std() == approx(of[name].cov, rel=0.1)
    assert np.abs(np.corrcoef(factors.T) - np.eye(len(INPUTS))).max() < 0.13


def test_each_input_scales_its_values_alone():
    wall = Wall(
        "strip",
        0.21,
        1.2,
        brick=Brick(0.42, tensile_strength=1e6, fracture_energy="rule"),
        joint=Joint(
            mode_i_fracture_energy="rule",
            mode_ii_fracture_energy="rule",
            compressive_strength=8e6,
            compressive_fracture_energy="rule",
        ),
        restraints=[Restraint("top", stiffness=3e6, friction=0.1, play=3e-3)],
    )
    half = {name: drawn(wall, {name: Range(None, 0.5, 0.5)}, 1) for name in INPUTS}
    assert half["load"].precompression == wall.precompression / 2
    assert half["bond"].joint.cohesion == wall.joint.cohesion / 2
    assert half["bond"].joint.mode_i_fracture_energy == wall.joint.mode_i_fracture_energy / 2
    assert math.tan(half["friction"].joint.friction_angle) == approx(
        math.tan(wall.joint.friction_angle) / 2, rel=1e-7
    )
    assert half["bearing_play"].restraints[0].play == 1.5e-3
    assert half["unit_strength"].brick.tensile_strength == 0.5e6
    assert half["compressive_strength"].joint.compressive_strength == 4e6
    for name, one in half.items():
        assert (one.joint == wall.joint) == (
            name not in ("stiffness", "bond", "friction", INPUTS[3])
        )
    rough = drawn(wall, {"friction": Range(None, 2.0, 2.0)}, 1).joint
    assert math.tan(rough.friction_angle) * rough.tensile_strength == approx(rough.cohesion)
    assert drawn(HOUSE, ranges("typical"), 2).floors[0].mass != HOUSE.floors[0].mass


def test_a_run_has_the_wall_that_its_seed_draws():
    words = {"harmonic": (0.06, 0.1), "cycles": 1, "rest": 0.0, "inputs": "typical"}
    walls = [run(SMALL, strength_seed=seed, **words).masonry_wall for seed in (1, 2)]
    assert walls == [drawn(SMALL, ranges("typical"), seed) for seed in (1, 2)] != [SMALL, SMALL]
