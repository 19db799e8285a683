"""What docs/validation/after-the-peak.md rests on beside the runs: the prototype of dilatancy, and
how many draws."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import trapezoid

from damage.applications.cracks.capacity import draws_needed
from damage.applications.cracks.pushed import SPECIMENS
from damage.units import GRAVITY
from damage.wall.kinds import HEAD
from damage.wall.layout import lay_out
from damage.wall.parameters import Wall
from paper import after_peak, dilatancy
from paper.after_peak import PREDICTION, wall_by


def test_two_bricks_lift_by_the_integral_of_their_dilatancy_and_keep_their_friction():
    layout = dilatancy.two_bricks()
    done = dilatancy.push(layout, 5e-4, 5e-4, dilatancy=0.4)
    slips = np.abs(done.slip[layout.contacts.second == 1])
    slip = np.linspace(0.0, slips.mean(), 2001)
    by_hand = trapezoid(0.4 * np.exp(-dilatancy.DECAY * slip), slip)
    assert_allclose(dilatancy.thickening(slips.mean(), 0.4), by_hand, rtol=1e-5)
    assert_allclose(done.lift[-1], dilatancy.integral(layout, done.slip, 0.4), rtol=1e-3)
    load = GRAVITY * layout.bodies.mass[1:].sum()
    assert_allclose(
        done.force[-50:].mean(), load * np.tan(layout.wall.joint.friction_angle), rtol=1e-3
    )


@pytest.mark.parametrize("deviation", [0.01, 0.1])
def test_enough_draws_narrow_the_median_to_five_percent(deviation):
    """Medians of that many draws of a normal variable lie within 5 % in about 95 of 100 cases."""
    random = np.random.default_rng(3)
    number = max(2, draws_needed(random.normal(1.0, deviation, 100_000)))
    medians = np.median(random.normal(1.0, deviation, (4000, number)), axis=1)
    assert np.mean(np.abs(medians - 1) < 0.05) > 0.93


def test_weaker_head_joints_have_their_share_of_the_strengths():
    layout = lay_out(Wall("w", length=0.9, height=0.3))
    bonded = ~layout.contacts.elastic
    head = layout.contacts.kind == HEAD
    weak = after_peak.weaker_heads(layout.wall, layout.contacts, (0.0, 0))
    assert 0 < head.sum() < bonded.sum()
    for name in ("tensile_strength", "cohesion"):
        expected = np.where(head, 0.3, 1.0) * getattr(layout.wall.joint, name)
        assert_allclose(getattr(weak, name)[bonded], expected[bonded])


@pytest.mark.parametrize("name", after_peak.FARTHEST)
def test_the_table_of_tests_alone_makes_the_predicted_walls(name):
    """The rules of docs/guides/tested-wall.md; bricks of the wall's exact length and height differ
    by up to 0.5 %."""
    made = after_peak.tested_wall(SPECIMENS[name])
    shipped = wall_by(name, PREDICTION)
    assert made.courses == shipped.courses
    assert_same_numbers(made, shipped, 6e-3)


def assert_same_numbers(made, other, rtol):
    """Walls, bricks and joints have the same numbers, but for those that the other wall lacks."""
    for one, like in ((made, other), (made.brick, other.brick), (made.joint, other.joint)):
        for name, value in vars(one).items():
            if isinstance(value, float) and vars(like)[name] is not None:
                assert_allclose(value, vars(like)[name], rtol=rtol, err_msg=name)
