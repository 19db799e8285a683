"""Bricks whose joints have ended find new contacts: the hand-over from joint to loose pair, walls
that fall."""

import re
from functools import partial

import numpy as np
import pytest
import test_ends
from conftest import run_here, wall_file
from numpy.testing import assert_allclose
from short_runs import solver_of
from test_ends import DRY, GRAVITY, HEIGHT, LENGTH, ended
from test_widths import ACTIONS, act, make

from damage import Joint, ModelOptions, Opening, Wall, warnings_of
from damage.draw.run import has_heap
from damage.draw.wall import shape_at
from damage.errors import RunError
from damage.law.states import ENDED, ENDING, FAILED
from damage.mechanics.collisions import INSIDE, LARGEST, PAIRS, SEARCHES, STORED
from damage.mechanics.tables import FRICTION, HAS_FAILED, ROTATION, X, Z
from damage.run.monitor import fastest_fallen
from damage.run.settings import RESTS_BELOW_M_S
from damage.wall.geometry import body_corners, body_table, joint_gaps
from damage.wall.layout import lay_out
from paper.falls import depth

pair = partial(test_ends.pair, new_contacts=True)
DIAMETER = 2 * 0.01 * 0.225
"""Twice the radius of the corners: 1 % of a whole brick's length."""


@pytest.mark.parametrize("action", ["shaken", "damped by stiffness", "pushed to and fro"])
def test_a_wall_in_which_no_joint_ends_has_the_same_bits(action):
    wall, other = make("brittle"), make("brittle", new_contacts=True)
    wall.system.interfaces[:] = other.system.interfaces  # the ends of the joints on supports
    for one, two in zip(act(wall, **ACTIONS[action]), act(other, **ACTIONS[action])):
        assert one == two
    assert not other.loose.counts.any() and wall.system.states["broken"].any()


def test_a_brick_that_is_lifted_off_and_let_fall_lands_on_the_other():
    """A joint that gapes by more than 2 r has ended.  From a height h a brick lands after sqrt(2 h
    / g), and lies on the other, shifted by s after it has bounced.  Two corners lie on faces and
    sink in by u, the two that hang over touch rounded corners, s^2 / (4 r) lower: m g = 2 k u + 2 k
    max(u - s^2 / (4 r), 0)."""
    wall = pair()
    for height, state in ((0.99 * DIAMETER, FAILED), (0.02, ENDED)):
        wall.displacement = [[0, 0, 0], [0, height, 0]]
        wall.run(2)
        assert ended(wall) == state
    wall.velocity = np.zeros((2, 3))
    start, began = wall.displacement[1, Z], wall.step
    while wall.loose.energy[STORED] == 0.0:
        wall.run(1)
    fallen = start - wall.displacement[1, Z]
    assert (wall.step - began) * wall.time_step == pytest.approx(
        np.sqrt(2 * fallen / GRAVITY), rel=0.005
    )
    assert fallen == pytest.approx(0.02, abs=1e-5)
    wall.run(round(1.0 / wall.time_step))
    weight = wall.layout.bodies.mass[1] * GRAVITY
    assert wall.force[1, Z] == pytest.approx(weight, rel=1e-3)
    shift, rise = wall.displacement[1, :2] - wall.displacement[0, :2]
    touch = wall.loose.touch
    lower = shift**2 / (4 * touch.radius)
    four = (weight / touch.kn + 2 * lower) / 4
    assert -rise == pytest.approx(four if four > lower else weight / (2 * touch.kn), rel=0.01)
    assert wall.loose.counts[PAIRS] >= 1 and wall.loose.counts[SEARCHES] >= 1


def rotated(angle, x, z):
    return np.cos(angle) * x - np.sin(angle) * z, np.sin(angle) * x + np.cos(angle) * z


@pytest.mark.parametrize(
    "joint",
    [
        DRY,
        {
            "tensile_strength": 1e5,
            "cohesion": 1e5,
            "mode_i_fracture_energy": 5.0,
            "mode_ii_fracture_energy": 50.0,
        },
    ],
    ids=["dry", "softening"],
)
def test_the_hand_over_passes_on_what_the_joint_has_stored(joint):
    """The upper brick is turned about its left contact point, L/4 from its centre, and pressed
    down.  Its left corner comes to lie by r in the lower brick, which contact points inside the
    faces do not resist: the joint ends, and the corner takes over its elastic energy to 1 %."""
    wall = pair(joint)
    held = 1e-9 * wall.system.inverse_mass[1]
    wall.system.inverse_mass[:2] = 0.0
    while ended(wall) < ENDING:
        angle = wall.displacement[1, ROTATION]
        x, z = rotated(angle, -LENGTH / 4, -HEIGHT / 2)
        wall.velocity = [[0, 0, 0], [z, -x - 1e-4, 1.0]]
        wall.run(1)
    # L/4 - r from the point to the corner of the core
    assert angle == pytest.approx(0.087, rel=0.02)
    # so that it does not move in the next step
    wall.velocity, wall.system.inverse_mass[1] = 0.0, held
    stored = float(wall.sample_now().stored[0, wall.layout.contacts.first >= 0].sum())
    friction = wall.energy[FRICTION]
    wall.run(1)
    assert ended(wall) == ENDED and stored > 1e-3
    assert wall.loose.energy[STORED] == pytest.approx(stored, rel=0.01)
    assert wall.loose.energy[LARGEST] == pytest.approx(DIAMETER / 2, rel=0.001)
    assert wall.energy[FRICTION] - friction < 0.01 * stored


def test_a_brick_that_slides_over_its_length_on_the_ground_keeps_on_sliding():
    """Its joint ends there, and the ground bears it on: friction slows it down by mu g all
    along."""
    wall = pair()
    wall.system.inverse_mass[1] = wall.system.velocity[1] = 0.0  # the upper one is out of the way
    wall.displacement = [[0, 0, 0], [0, 1.0, 0]]
    wall.run(2000)
    wall.system.place[0, X], wall.system.velocity[0, X] = 0.0, 2.0
    speed = []
    while wall.displacement[0, X] < 1.6 * LENGTH:
        wall.run(20)
        speed.append((wall.displacement[0, X], wall.velocity[0, X]))
    assert wall.system.limits[0, HAS_FAILED] == ENDED and wall.force[0, Z] > 0.0
    x, v = np.array(speed).T
    lost = 2.0**2 - v**2
    assert lost[-1] == pytest.approx(2 * np.tan(Joint().friction_angle) * GRAVITY * x[-1], rel=0.05)


def fallen_wall():
    """A small wall whose spandrel of three courses over an opening has lost its lintel: dry, under
    its weight."""
    wall = Wall(
        "spandrel", 1.8, 0.9, [Opening(0.45, 0.9, 0.675)], precompression=0.0, joint=Joint(**DRY)
    )
    return solver_of(lay_out(wall, ModelOptions(lintel="none")), new_contacts=True)


def test_a_spandrel_without_a_lintel_falls_and_rests():
    """Its centres fall from 0.675 m with up to sqrt(2 g h) = 3.6 m/s.  No energy is created, no
    core lies in another, and the rectangles themselves, of all pairs, overlap by less than their
    rounded corners."""
    wall, energies, speeds = fallen_wall(), [], []
    for _ in range(100):
        before = wall.displacement
        wall.run(round(0.02 / wall.time_step))
        lifted = GRAVITY * float(wall.layout.bodies.mass @ wall.displacement[:, Z])
        stored = wall.kinetic_energy() + wall.elastic_energy() + lifted
        energies.append((stored, wall.energy[1:].sum() - wall.energy[0]))
        speeds.append(
            np.hypot(*(wall.displacement - before)[: wall.layout.n_bricks, :2].T).max() / 0.02
        )
    assert 2.0 < max(speeds) < np.sqrt(2 * GRAVITY * 0.675)
    assert fastest_fallen(wall.layout, wall.displacement, before, 0.02) < RESTS_BELOW_M_S
    assert (wall.layout.bodies.z + wall.displacement[:, Z]).min() > HEIGHT / 2 - DIAMETER
    energies = np.array(energies)
    released = -energies[-1, 0]
    assert wall.loose.counts[INSIDE] == 0 and wall.loose.energy[LARGEST] < DIAMETER
    assert np.all(np.diff(energies[:, 0]) < 0.01 * released)
    assert np.abs(energies.sum(axis=1)).max() < 0.03 * released
    places = body_corners(body_table(wall.layout), wall.displacement)
    low, high = places.min(axis=1), places.max(axis=1)
    pairs = [
        (a, b)
        for a in range(len(places))
        for b in range(a)
        if np.all((low[a] < high[b]) & (low[b] < high[a]))
    ]
    assert max(depth(places[a], places[b]) for a, b in pairs) < DIAMETER
    assert wall.instants().contacts["state"].max() & ENDED


def test_bricks_that_press_each_other_too_hard_end_the_run():
    """With m v^2 / 2 = 4 k d^2 / 2 a brick stops within d: at 200 m/s that is more than the rounded
    corners hold."""
    wall = pair()
    wall.displacement = [[0, 0, 0], [0, 0.02, 0]]
    wall.run(2)
    wall.velocity = [[0, 0, 0], [0, -200.0, 0]]
    with pytest.raises(
        RunError, match="bricks press each other by more than the 4.5 mm of their rounded corners"
    ):
        wall.run(20)


def test_a_run_follows_what_falls_until_it_rests(tmp_path, capsys):
    wall = wall_file(
        tmp_path / "spandrel.py", "Wall('spandrel', 2.925, 0.525, [Opening(0.45, 2.025, 0.225)])"
    )
    history = run_here(
        tmp_path / "fall.h5",
        wall,
        "--lintel none --harmonic 0.05 0.5 --rest 0.5 --new-contacts --after-fall",
    )
    said = capsys.readouterr().out
    rest, overlap = re.search(
        r"at rest ([\d.]+) s after the first one fell; they overlapped by up to ([\d.]+) of 4.5 mm",
        said,
    ).groups()
    assert 0.3 < float(rest) < 4.0 and 0.0 < float(overlap) < 4.5
    assert (
        history.complete and history.parameters["new_contacts"] and history.parameters["after_fall"]
    )
    assert history.series["time_s"].iloc[-1] == pytest.approx(history.collapsed_at_s)
    assert history.snapshot_time_s[-1] > history.collapsed_at_s + float(rest) - 0.1
    (warning,) = [line for line in warnings_of(history) if line.code == "ended_joints"]
    assert "the bricks collide as rectangles with rounded corners" in warning
    assert has_heap(history)
    last = history.displacement[-1].astype(float)
    shape = shape_at(
        history, len(history.series) - 1, 0.1, magnify=1.0, snapshot=len(history.displacement) - 1
    )
    assert shape.time_s == history.snapshot_time_s[-1]
    assert_allclose(shape.corners, body_corners(history.bodies, last))
    hidden = np.isnan(shape.segments).any(axis=(1, 2))
    assert (
        np.array_equal(hidden, joint_gaps(history.joints, history.bodies, last) > 0.01)
        and hidden.any()
    )
