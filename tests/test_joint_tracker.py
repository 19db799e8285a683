"""The tracker that YADE's runs use sees, from samples, what the joint law knows exactly."""


import numpy as np
import pytest
from numpy.testing import assert_allclose

from damage.wall.joint_law import INTACT, SHEAR, TENSION, ContactState, LawParameters, advance, material_of
from damage.wall.layout import lay_out
from damage.wall.parameters import Wall
from yade_scripts.joint_tracker import JointTracker

KINDS = {TENSION: "tension", SHEAR: "shear"}


def follow_both(path, every):
    """Drive joint 0 by the law in every step and the tracker by samples; returns both."""
    layout = lay_out(Wall("small", 0.45, 0.15))
    tracker, contacts = JointTracker(layout, 1e-4), layout.contacts
    joint = layout.wall.joint
    law = LawParameters(contacts.normal_stiffness[0], contacts.shear_stiffness[0], joint.tensile_strength,
                        joint.cohesion, material_of(joint))
    state, shear, events = ContactState(), 0.0, []
    for step, (opening, target) in enumerate(path):
        trial = state.shear_stress + law.shear_stiffness * (target - shear)
        state, event = advance(opening, target - shear, state, law)
        shear = target
        if event != INTACT:
            tracker.breaks(0, KINDS[event], law.normal_stiffness * opening, trial)
        if step % every == 0 and tracker.broken[0]:
            events += tracker.sample(np.array([0]), np.array([opening]), np.array([shear]),
                                     np.array([state.shear_stress]))
    return state, tracker, contacts.area[0], events


def shaken(n=4000, pressure=2e-6):
    """Two cycles of sliding under pressure, an opening by 0.3 mm while it slides, and closing."""
    time = np.linspace(0, 1, n)
    shear = 3e-4 * np.sin(2 * np.pi * 2 * time)
    opening = np.where((time > 0.4) & (time < 0.55), 3e-4, -pressure)
    return list(zip(opening, shear))


@pytest.mark.parametrize("every", [1, 5])
def test_slip_work_and_flags_follow_the_law(every):
    state, tracker, area, _ = follow_both(shaken(), every)
    step = 3e-4 * 2 * np.pi * 2 / 4000  # [m] of the fastest step
    # Slip over the samples in which the joint opens and closes is not counted: one sample each.
    assert_allclose(tracker.slip[0], state.slip, atol=4 * every * step)
    assert_allclose(tracker.friction_energy, state.friction_work * area, rtol=0.01 * every)
    assert_allclose(tracker.fracture_energy, state.fracture_work * area, rtol=1e-9)
    assert tracker.at_limit[0] and state.at_limit


def test_slip_is_frozen_while_open():
    path = [(4e-6, 0.0), *[(2e-4, 1e-5 * k) for k in range(50)], *[(-1e-6, 4.9e-4)] * 5]
    _, tracker, _, events = follow_both(path, 1)
    assert tracker.slip[0] == 0.0 and tracker.opening[0] == 0.0
    assert events == [(0, "opened")]


def test_first_passing_is_told_once():
    _, _, _, events = follow_both(shaken(), 1)
    assert sorted(events) == [(0, "opened"), (0, "slipped")]


def test_a_joint_that_sticks_is_not_at_its_limit():
    path = [(4e-6, 0.0), *[(-5e-6, 1e-8 * k) for k in range(20)]]
    state, tracker, _, _ = follow_both(path, 1)
    assert not state.at_limit and not tracker.at_limit[0]
