"""Numbers that decide a run, each against what it stands for in figures of its own: without YADE,
in milliseconds."""

import math

import numpy as np
import pytest
from conftest import parsed
from numpy.testing import assert_allclose
from small_history import small_layout

from damage.law.states import BROKEN, ENDED
from damage.run import settings as run_settings
from damage.run.monitor import (
    fastest_fallen,
    have_fallen,
    have_left,
    lowest_places,
    unbalanced_force,
)
from damage.run.schedule import choose_time_step

CRITICAL_S = 4.67e-5


def step_of(words="", softens=False):
    return choose_time_step(parsed(f"--free-vibration {words}"), CRITICAL_S, softens)


def test_the_time_step_is_a_share_of_the_critical_one():
    """And below 0.85 of the step that local damping of 0.7 leaves stable, 1 / sqrt(1.7)."""
    assert_allclose(step_of(), 0.643 * CRITICAL_S, rtol=1e-5)
    assert_allclose(step_of(softens=True), 0.35 * CRITICAL_S, rtol=1e-5)
    assert 0.643 < 0.85 / math.sqrt(1.7)


@pytest.mark.parametrize("beta_s", [2e-5, 1e-4, 1e-3])
def test_with_viscous_damping_the_time_step_is_085_of_the_stable_one(beta_s):
    """(2 / omega) (sqrt(1 + xi^2) - xi) with xi = beta omega / 2 and omega = 2 / critical step."""
    xi = beta_s / CRITICAL_S
    stable = CRITICAL_S * (math.sqrt(1 + xi**2) - xi)
    assert 0.85 * stable < 0.643 * CRITICAL_S
    assert_allclose(step_of(f"--beta {beta_s}"), 0.85 * stable, rtol=1e-5)


def test_a_brick_has_fallen_when_it_is_half_its_height_below_its_place():
    layout = small_layout()
    height = layout.bodies.height[3]
    motion = np.zeros((3, len(layout.bodies), 3))
    motion[:, 3, 1] = -0.49 * height, -0.51 * height, -0.6 * height
    assert have_fallen(motion, lowest_places(layout)).tolist() == [False, True, True]
    motion[:, 3, 1], motion[2, layout.n_bricks :, 1] = 0.0, -1.0  # nor does a rigid top mass count
    assert not have_fallen(motion, lowest_places(layout)).any()


def test_where_bricks_collide_one_fell_when_its_joints_ended_and_it_moved_by_its_height():
    layout = small_layout()
    contacts, height = layout.contacts, layout.bodies.height[3]
    joints = np.flatnonzero((contacts.first == 3) | (contacts.second == 3))
    motion = np.zeros((4, len(layout.bodies), 3))
    motion[:, 3, 0], motion[:, 3, 1] = (
        (
            0.6 * height,
            0.6 * height,
            0.9 * height,
            0.9 * height,
        ),
        -0.6 * height,
    )
    state = np.full((4, len(joints)), BROKEN | ENDED)
    state[2, 0] = BROKEN  # one joint still holds it
    assert have_left(layout, motion, joints, state).tolist() == [False, False, False, True]
    assert not have_left(layout, motion, joints, 0 * state + BROKEN).any()
    assert not have_left(layout, 0 * motion, joints, state).any()


def test_bricks_in_flight_are_far_from_rest_by_a_number():
    """No contact carries force, every brick falls freely: the ratio is large, and no infinity goes
    into a history."""
    layout = small_layout()
    flying = unbalanced_force(
        layout, np.zeros((len(layout.bodies), 3)), np.zeros(len(layout.contacts.x))
    )
    assert flying == pytest.approx(1e9)


def test_a_wall_rests_when_no_brick_that_fell_moves():
    """Bodies that are still in their place may vibrate; the speed is that of centre and end."""
    layout = small_layout()
    height, length = layout.bodies.height[3], layout.bodies.length[3]
    before, now = np.zeros((2, len(layout.bodies), 3))
    now[3] = 0.4 * height, 0.0, 0.0
    assert fastest_fallen(layout, now, before, 0.02) == 0.0
    before[3], now[3] = (0.6 * height, 0, 0.1), (0.6 * height + 3e-4, -4e-4, 0.1 - 1e-3)
    assert_allclose(fastest_fallen(layout, now, before, 0.02), (5e-4 + 1e-3 * length / 2) / 0.02)
    assert (run_settings.RESTS_BELOW_M_S, run_settings.RESTS_FOR_S, run_settings.AFTER_FALL_S) == (
        0.05,
        0.2,
        10.0,
    )
