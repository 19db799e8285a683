"""The tracker that YADE's runs use sees, from samples, what the joint law knows exactly."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from damage import Brick, Joint, Wall
from damage.house.house import Diaphragm, House, Placed
from damage.house.layout import lay_out_house
from damage.law.joint_law import (
    INTACT,
    SHEAR,
    TENSION,
    ContactState,
    LawParameters,
    advance,
    material_of,
)
from damage.wall.kinds import GROUND
from damage.wall.layout import lay_out
from yade_scripts.joint_tracker import JointTracker

FIVE_FIFTY = Joint(mode_i_fracture_energy=5.0, mode_ii_fracture_energy=50.0)
KINDS = {TENSION: "tension", SHEAR: "shear"}


def follow_both(path, every):
    """Drive joint 0 by the law in every step and the tracker by samples; returns both."""
    layout = lay_out(Wall("small", 0.45, 0.15))
    tracker = JointTracker(layout, 1e-4)
    contacts = layout.contacts
    joint = layout.wall.joint
    law = LawParameters(
        contacts.normal_stiffness[0],
        contacts.shear_stiffness[0],
        joint.tensile_strength,
        joint.cohesion,
        material_of(joint),
    )
    state = ContactState()
    shear = 0.0
    events = []
    for step, (opening, target) in enumerate(path):
        trial = state.shear_stress + law.shear_stiffness * (target - shear)
        state, event = advance(opening, target - shear, state, law)
        shear = target
        if event != INTACT:
            tracker.breaks(0, KINDS[event], law.normal_stiffness * opening, trial)
        if step % every == 0 and tracker.broken[0]:
            events += tracker.sample(
                np.array([0]),
                np.array([opening]),
                np.array([shear]),
                np.array([state.shear_stress]),
            )
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


def test_friction_work_is_of_the_mean_stress_and_slip_is_said_beyond_the_threshold():
    """The threshold is 0.1 mm, passed by a joint that slides to 0.08 and to 0.12 mm while its
    pressure halves twice."""
    layout = lay_out(Wall("small", 0.45, 0.15))
    tracker = JointTracker(layout, 1e-4)
    first = np.array([0])
    stiffness = tracker.shear_stiffness[0]
    limit = 0.1e6 * tracker.friction[0]
    tracker.breaks(0, "shear", -0.1e6, 0.3e6)
    news = [
        tracker.sample(
            first, np.array([-1e-7]), np.array([slip + tau / stiffness]), np.array([tau])
        )
        for slip, tau in ((0.8e-4, limit / 2), (1.2e-4, limit / 4), (1.3e-4, limit / 4))
    ]
    work = limit * (0.75 * 0.8e-4 + 0.375 * 0.4e-4 + 0.25 * 0.1e-4)
    assert_allclose(tracker.friction_energy, work * tracker.area[0])
    assert news == [[], [(0, "slipped")], []]


def test_the_shear_that_a_joint_holds_when_it_opens_is_dissipated_once():
    """Broken in shear under 0.1 MPa it holds tau = 0.1 tan phi MPa, whose elastic energy is tau^2 /
    2 k_s an area."""
    layout = lay_out(Wall("small", 0.45, 0.15))
    tracker = JointTracker(layout, 1e-4)
    contacts = layout.contacts
    stiffness = contacts.shear_stiffness[0]
    tau = 0.1e6 * tracker.friction[0]
    tracker.breaks(0, "shear", -0.1e6, 0.3e6)
    before = tracker.friction_energy
    list(
        tracker.sample(np.array([0]), np.array([1e-5]), np.array([0.3e6 / stiffness]), np.zeros(1))
    )
    assert tracker.friction_energy - before == pytest.approx(
        tau**2 / (2 * stiffness) * contacts.area[0]
    )


def test_a_joint_whose_faces_no_longer_overlap_keeps_what_it_had():
    """Half a brick stands on the left one below, over 0.1125 m; the tip has left its face before:
    the opening seen is across the joint."""
    layout = lay_out(Wall("small", 0.45, 0.15))
    bodies = layout.bodies
    contacts = layout.contacts
    tracker = JointTracker(layout, 1e-4)
    joint = int(np.flatnonzero(contacts.first == 0)[0])
    least = (
        bodies.x[0] - bodies.length[0] / 2 - (bodies.x + bodies.length / 2)[contacts.second[joint]]
    )
    tracker.breaks(joint, "shear", -1e5, 3e5)
    for share, ended in ((0.99, False), (1.01, True)):
        assert tracker.followed.tolist() == [joint]
        tracker.sample(
            np.array([joint]),
            np.array([0.05]),
            np.array([share * least]),
            np.zeros(1),
            np.array([2e-4]),
        )
        assert tracker.ended[joint] == ended
    assert tracker.followed.size == 0
    assert (tracker.opening[joint], tracker.offset[joint]) == (2e-4, 1.01 * least)
    below = int(np.flatnonzero(contacts.first == GROUND)[0])
    tracker.breaks(below, "shear", -1e5, 3e5)
    tracker.sample(np.array([below]), np.array([1e-5]), np.array([5.0]), np.zeros(1))
    assert tracker.followed.tolist() == [below]  # the ground does not end


def test_no_joint_ends_on_a_slab_that_lies_on_two_walls():
    """Bricks of the second wall are far from the slab where walls are unfolded."""
    wall = Wall("a", 0.8, 0.8, precompression=0, brick=Brick(0.4, 0.2, 0.2))
    walls = [Placed(replace(wall, name=name), (0, y)) for name, y in (("a", 0), ("b", 1))]
    slab = Diaphragm(0.6, ("a", "b"), 300, "concrete")
    layout = lay_out_house(House("pair", walls, floors=[slab]))
    tracker = JointTracker(layout, 1e-4)
    every = np.arange(layout.n_joints)
    for joint in every:
        tracker.breaks(joint, "shear", -1e4, 1e5)
    tracker.sample(every, *np.outer([-1e-6, 2e-3, 0.0], np.ones(len(every))))
    assert not tracker.ended.any()
