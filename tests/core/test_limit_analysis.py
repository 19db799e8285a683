"""Limit analysis of dry joints against hand calculations and a published multiplier; the solver
against it."""

import math

import numpy as np
import pytest
from conftest import refused_with
from environments import environment
from numpy.testing import assert_allclose

from damage import Brick, Joint, ModelOptions, Opening, Wall
from damage.units import GRAVITY
from damage.wall.layout import lay_out
from verification.collapse import collapse_multiplier, falls_of, find_by_falls
from verification.dry_walls import FRICTION, OPTIONS, PUBLISHED, WALLS, ask, examine, lay, main
from verification.limit_analysis import balance, body_load, collapse_load, flow, top_load


def stack(courses, friction=0.65, length=0.4, height=0.2, **more):
    """Courses of one brick's length: whole bricks and two halves in turn."""
    return lay_out(
        Wall(
            "stack",
            length,
            courses * height,
            brick=Brick(length, height, 0.1, 2000.0),
            joint=Joint(1e10, 4e9, math.atan(friction), 0.0, 0.0),
            **{"precompression": 0.0, **more},
        ),
        ModelOptions(lintel="none", contacts="corners", top="beam"),
    )


class TestByHand:
    @pytest.mark.parametrize("friction", [0.1, 0.65, 1.5])
    def test_a_low_block_slides(self, friction):
        assert_allclose(collapse_load(stack(1, friction)).multiplier, friction, rtol=1e-9)

    @pytest.mark.parametrize("height", [0.25, 0.8, 1.6])
    def test_a_high_block_tips_at_length_over_height(self, height):
        assert_allclose(
            collapse_load(stack(1, 10.0, height=height)).multiplier, 0.4 / height, rtol=1e-9
        )

    def test_a_pushed_cap_kept_from_rotating_slides_on_the_weakest_joint(self):
        """Below the top course: mu times what lies on it; free to rotate the top tips the wall
        instead."""
        layout = stack(4, 0.45, precompression=0.3e6)
        top = layout.wall.top_mass + 0.4 * 0.2 * 0.1 * 2000
        held = collapse_load(layout, load=top_load(layout), held=layout.pushed_bodies)
        assert_allclose(held.multiplier, 0.45 * top * GRAVITY, rtol=2.0**-25)
        assert collapse_load(layout, load=top_load(layout)).multiplier < 0.6 * held.multiplier

    def test_crushing_moves_the_hinge_inwards(self):
        """A tipping block on a toe that carries no more than the strength: e = (b - N / (f t)) /
        2."""
        layout = lay_out(
            stack(1, 10.0, height=1.6).wall, ModelOptions(contacts="corners", cells=16)
        )
        weight = GRAVITY * layout.total_mass
        strength = weight / (0.2 * 0.4 * 0.1)
        crushed = collapse_load(layout, crushing=strength).multiplier
        assert_allclose(crushed, 0.4 * (1 - 0.2) / 1.6, rtol=0.01)


class TestTheProgramme:
    def test_forces_balance_and_obey_the_joint(self):
        layout = lay("door")
        result = collapse_load(layout)
        contact = (balance(layout) @ np.concatenate([result.normal, result.shear])).reshape(-1, 3)
        weight = np.zeros_like(contact)
        weight[:, 1] = -GRAVITY * layout.bodies.mass
        assert_allclose(contact + weight + result.multiplier * body_load(layout), 0, atol=1e-6)
        assert result.normal.min() >= 0
        assert np.all(np.abs(result.shear) <= FRICTION * result.normal + 1e-6)

    def test_the_mechanism_is_associated_and_does_the_work_of_the_multiplier(self):
        layout = lay("benchmark")
        result = collapse_load(layout)
        opening, slip = flow(layout, result.motion)
        assert np.all(opening >= FRICTION * np.abs(slip) - 1e-12)
        assert_allclose(np.sum(body_load(layout) * result.motion), 1.0)
        assert_allclose(
            np.sum(GRAVITY * layout.bodies.mass * result.motion[:, 1]), result.multiplier
        )

    def test_more_contact_points_within_a_joint_change_nothing(self):
        fine = lay_out(lay("door").wall, ModelOptions(lintel="none", contacts="corners", cells=5))
        assert_allclose(
            collapse_load(fine).multiplier, collapse_load(lay("door")).multiplier, rtol=1e-9
        )

    def test_published_benchmark(self):
        assert_allclose(
            collapse_load(lay("benchmark")).multiplier, PUBLISHED["benchmark"], rtol=0.01
        )

    def test_a_wall_that_cannot_stand_is_refused(self):
        wall = Wall(
            "gap",
            2.0,
            1.0,
            openings=(Opening(0.6, 0.8, 0.6),),
            precompression=0.0,
            brick=Brick(0.4, 0.2, 0.1, 2000.0),
            joint=Joint(1e10, 4e9, 0.05, 0.0, 0.0),
        )
        refused_with("own weight", collapse_load, lay_out(wall, OPTIONS))


class TestTheSolver:
    @pytest.mark.parametrize("friction, height, expected", [(0.5, 0.2, 0.5), (1.0, 0.8, 0.5)])
    def test_a_block_slides_or_tips_as_by_hand(self, friction, height, expected):
        layout = stack(1, friction, height=height)
        found = collapse_multiplier(layout, 1.2 * expected, tolerance=2e-3)
        assert_allclose(found.multiplier, expected, rtol=2e-3)
        assert_allclose(find_by_falls(falls_of(layout, expected)), expected, rtol=2e-3)

    def test_the_benchmark_falls_at_its_multiplier(self):
        """Within 1 % of the published multiplier, and not above the bound."""
        layout = lay("benchmark")
        bound = collapse_load(layout).multiplier
        found = collapse_multiplier(layout, 1.02 * bound, tolerance=4e-3)
        assert_allclose(found.multiplier, PUBLISHED["benchmark"], rtol=0.01)
        assert found.stable <= bound

    @pytest.mark.long
    @pytest.mark.parametrize("name", WALLS)
    def test_walls_fall_at_or_below_the_bound(self, name):
        result = examine(name)
        assert result.solver.stable <= result.bound.multiplier
        least = 0.75 if name.startswith("ferris") else 0.9 if result.friction_governs else 0.95
        assert result.ratio >= least
        if name in ("two-windows", "ferris-3", "ferris-4"):
            assert_allclose(result.solver.multiplier, result.tipping, rtol=2e-3)


@pytest.mark.long
def test_other_programs_agree_on_a_wall_with_a_door():
    """LMGC90's collapse within 1 % of the solver's, compas_cra's bound that of the programme."""
    packages = "compas-lmgc90==0.1.11", "compas_cra==0.8.0", "compas_assembly==0.7.1"
    with environment(*packages, needs=("compas==2.15.1", "scipy", "shapely")) as python:
        result = examine("door")
        found = ask(python, result)
    assert_allclose(found["lmgc90"], result.solver.multiplier, rtol=0.01)
    assert_allclose(found["compas_cra"], result.bound.multiplier, rtol=1e-6)


@pytest.mark.long
def test_the_command_writes_its_table_and_pictures(tmp_path):
    words = f"--only benchmark --tolerance 0.05 --markdown {tmp_path}/a.md --pictures {tmp_path}/p"
    assert main(words.split()) == 0
    assert "| benchmark, published 0.643 | 33 | 0.6429 |" in (tmp_path / "a.md").read_text()
    assert (tmp_path / "p" / "mechanism_benchmark.png").stat().st_size > 10_000
