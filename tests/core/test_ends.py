"""A joint ends where its two faces no longer overlap: closed forms of a brick that is pushed, or
shoved, off another.  Bricks whose joints have ended find new contacts: the hand-over from joint to
loose pair, walls that fall, and single bricks.

Both bricks of a pair are 0.1125 m long, lie on each other over their whole length, and all joints
are dry.
"""

import math
import re
from functools import partial
from unittest.mock import patch

import numpy as np
import pytest
from conftest import run_here, total_energy, wall_file
from numpy.testing import assert_allclose
from pytest import approx
from scipy.integrate import quad
from short_runs import solver_of
from test_widths import ACTIONS, act, make

from damage import Brick, Joint, ModelOptions, Opening, Wall, warnings_of
from damage.draw.run import has_heap
from damage.draw.wall import shape_at
from damage.errors import RunError
from damage.law.states import ENDED, ENDING, FAILED
from damage.mechanics import collisions
from damage.mechanics.collisions import INSIDE, LARGEST, PAIRS, SEARCHES, STORED
from damage.mechanics.tables import FRICTION, HAS_FAILED, ROTATION, X, Z
from damage.reference.solver import ReferenceSolver
from damage.run.monitor import fastest_fallen
from damage.run.settings import RESTS_BELOW_M_S
from damage.units import GRAVITY
from damage.wall.geometry import body_corners, body_table, joint_gaps
from damage.wall.layout import lay_out
from paper.falls import depth

LENGTH = 0.1125
HEIGHT = 0.075
DRY = {"tensile_strength": 0.0, "cohesion": 0.0}
FRICTION_COEFFICIENT = np.tan(Joint().friction_angle)


def pair(joint=DRY, new_contacts=False, **options):
    """Two bricks on each other, at rest under their weight; the upper one is body 1 and interface
    1."""
    wall = Wall("pair", LENGTH, 2 * HEIGHT, precompression=0.0, joint=Joint(**joint))
    layout = lay_out(wall, ModelOptions(**options))
    wall = solver_of(layout, 0.3, new_contacts=new_contacts)
    come_to_rest(wall)
    return wall


def come_to_rest(wall):
    wall.adaptive_damping = 1.0
    wall.run(3000)
    wall.adaptive_damping = 0.0
    wall.velocity = 0.0
    wall.energy[:] = 0.0
    wall.start(np.zeros((0, 2)))
    assert_allclose(wall.force[:-1, Z], GRAVITY * wall.layout.bodies.mass, rtol=1e-6)


def shove(wall, speed):
    """Give the upper brick a horizontal velocity [m/s]."""
    wall.velocity = [[0, 0, 0], [speed, 0, 0]]


def ended(wall):
    """Values of `failed` of the joint between the bricks."""
    return int(wall.system.limits[1, HAS_FAILED])


def run_to_the_end(wall, most=20_000):
    """Step by step until the joint between the bricks ends in this very step."""
    for _ in range(most):
        wall.run(1)
        if ended(wall) == ENDING:
            return
    raise AssertionError("the joint did not end")


@pytest.mark.parametrize("speed", [1.0, -1.0])
def test_a_brick_that_is_pushed_off_falls_freely_from_where_the_faces_end(speed):
    """Pushed at constant speed, not turning, on a brick that stands still: s = v t, friction takes
    mu m g s."""
    wall = pair()
    wall.system.inverse_mass[0] = wall.system.velocity[0] = 0.0
    wall.hold(np.array([1]), rotation=True)
    wall.push(speed)
    began = total_energy(wall)
    start = wall.displacement[1]
    steps = int(np.ceil((LENGTH - np.sign(speed) * start[X]) / (wall.time_step * abs(speed))))
    wall.run(steps - 1)
    assert ended(wall) == FAILED and wall.force[1, Z] == approx(
        GRAVITY * wall.layout.bodies.mass[1], rel=1e-4
    )
    wall.run(1)
    assert ended(wall) == ENDING
    for _ in range(40):
        wall.run(100)
        assert ended(wall) == ENDED and np.all(wall.force[1] == 0.0)
        # velocities belong to half steps
        time_s = (wall.step - 3000 - steps - 0.5) * wall.time_step
        assert wall.displacement[1, Z] - start[Z] == approx(-GRAVITY * time_s**2 / 2, abs=2e-8)
    assert wall.displacement[1, Z] < -HEIGHT / 5
    friction = FRICTION_COEFFICIENT * GRAVITY * wall.layout.bodies.mass[1] * LENGTH
    assert wall.energy[FRICTION] == approx(friction, rel=3e-4)
    assert total_energy(wall) - began == approx(0.0, abs=1e-4 * friction)


KINDS = {
    "dry": DRY,
    "brittle": {"tensile_strength": 1e4, "cohesion": 1e4},
    "softening": {
        "tensile_strength": 1e4,
        "cohesion": 1e4,
        "mode_i_fracture_energy": 0.1,
        "mode_ii_fracture_energy": 1.0,
    },
    "crushing": DRY | {"compressive_strength": 1e4},
}


@pytest.mark.parametrize("kind", KINDS)
def test_the_energy_balance_is_closed_through_the_end(kind):
    """To 1e-9 of the kinetic energy of the shove, off a brick that stands still: what the contacts
    had stored, friction takes.  A brick that does not turn bears on all of them until then, and is
    slowed down by mu g."""
    wall = pair(KINDS[kind])
    wall.system.inverse_mass[0] = wall.system.velocity[0] = wall.system.inverse_mass[
        1, ROTATION
    ] = 0.0
    shove(wall, 3.0)
    wall.run(10)  # a brittle bond breaks: what it takes depends on the step
    began = total_energy(wall)
    kinetic = wall.kinetic_energy()
    run_to_the_end(wall)
    stored = wall.elastic_energy()
    taken = wall.energy[FRICTION]
    wall.run(1)
    assert ended(wall) == ENDED
    assert wall.elastic_energy() < stored and wall.energy[FRICTION] > taken
    if kind in ("dry", "crushing"):
        assert wall.velocity[1, X] ** 2 == approx(
            3.0**2 - 2 * FRICTION_COEFFICIENT * GRAVITY * LENGTH, rel=1e-3
        )
    wall.run(500)
    assert total_energy(wall) - began == approx(0.0, abs=1e-9 * kinetic)


def test_contact_data_keep_the_values_of_the_end():
    wall = pair()
    shove(wall, 2.0)
    run_to_the_end(wall)
    joint = wall.layout.contacts.first >= 0
    then = wall.instants().contacts
    assert np.all(then["state"][0, joint] & ENDED) and not np.any(then["state"][0, ~joint] & ENDED)
    assert_allclose(then["offset_m"][0, joint], LENGTH, rtol=1e-3)
    wall.run(3000)
    for name, values in wall.instants().contacts.items():
        # but for the elastic part of the offset
        assert_allclose(values[0, joint], then[name][0, joint], atol=1e-7)
    assert wall.displacement[1, X] > 1.5 * LENGTH
    wall.displacement = np.zeros((2, 3))  # put back it stays without forces: a joint ends for good
    assert ended(wall) == ENDED and np.all(wall.force[1] == 0.0)


def test_the_cut_of_a_split_brick_ends_over_its_height():
    """Two halves that have split, shifted upwards against each other."""
    wall = Wall(
        "brick",
        0.225,
        HEIGHT,
        precompression=0.0,
        joint=Joint(**DRY),
        brick=Brick(tensile_strength=1e4),
    )
    split = ReferenceSolver(lay_out(wall), 1e-6)
    cut = int(np.flatnonzero(split.system.interfaces["head"])[0])
    assert split.layout.n_bricks == 2 and cut == len(split.system.interfaces) - 1
    for share, state in ((0.999, FAILED), (1.001, ENDING), (0.5, ENDED)):
        split.displacement = [[0, 0, 0], [0, share * HEIGHT, 0]]
        assert split.system.limits[cut, HAS_FAILED] == state


# --- bricks whose joints have ended find new contacts ---------------------------------------------

loose_pair = partial(pair, new_contacts=True)
DIAMETER = 2 * 0.01 * 0.225
"""Twice the radius of the corners: 1 % of a whole brick's length."""


@pytest.mark.parametrize("action", ["shaken", "damped by stiffness", "pushed to and fro"])
def test_a_wall_in_which_no_joint_ends_has_the_same_bits(action):
    wall = make("brittle")
    other = make("brittle", new_contacts=True)
    wall.system.interfaces[:] = other.system.interfaces  # the ends of the joints on supports
    for one, two in zip(act(wall, **ACTIONS[action]), act(other, **ACTIONS[action])):
        assert one == two
    assert not other.loose.counts.any() and wall.system.states["broken"].any()


def test_a_brick_that_is_lifted_off_and_let_fall_lands_on_the_other():
    """A joint that gapes by more than 2 r has ended.  From a height h a brick lands after sqrt(2 h
    / g), and lies on the other, shifted by s after it has bounced.  Two corners lie on faces and
    sink in by u, the two that hang over touch rounded corners, s^2 / (4 r) lower: m g = 2 k u + 2 k
    max(u - s^2 / (4 r), 0)."""
    wall = loose_pair()
    for height, state in ((0.99 * DIAMETER, FAILED), (0.02, ENDED)):
        wall.displacement = [[0, 0, 0], [0, height, 0]]
        wall.run(2)
        assert ended(wall) == state
    wall.velocity = np.zeros((2, 3))
    start = wall.displacement[1, Z]
    began = wall.step
    while wall.loose.energy[STORED] == 0.0:
        wall.run(1)
    fallen = start - wall.displacement[1, Z]
    assert (wall.step - began) * wall.time_step == approx(np.sqrt(2 * fallen / GRAVITY), rel=0.005)
    assert fallen == approx(0.02, abs=1e-5)
    wall.run(round(1.0 / wall.time_step))
    weight = wall.layout.bodies.mass[1] * GRAVITY
    assert wall.force[1, Z] == approx(weight, rel=1e-3)
    shift, rise = wall.displacement[1, :2] - wall.displacement[0, :2]
    touch = wall.loose.touch
    lower = shift**2 / (4 * touch.radius)
    four = (weight / touch.kn + 2 * lower) / 4
    assert -rise == approx(four if four > lower else weight / (2 * touch.kn), rel=0.01)
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
    wall = loose_pair(joint)
    held = 1e-9 * wall.system.inverse_mass[1]
    wall.system.inverse_mass[:2] = 0.0
    while ended(wall) < ENDING:
        angle = wall.displacement[1, ROTATION]
        x, z = rotated(angle, -LENGTH / 4, -HEIGHT / 2)
        wall.velocity = [[0, 0, 0], [z, -x - 1e-4, 1.0]]
        wall.run(1)
    # L/4 - r from the point to the corner of the core
    assert angle == approx(0.087, rel=0.02)
    # so that it does not move in the next step
    wall.velocity = 0.0
    wall.system.inverse_mass[1] = held
    stored = float(wall.sample_now().stored[0, wall.layout.contacts.first >= 0].sum())
    friction = wall.energy[FRICTION]
    wall.run(1)
    assert ended(wall) == ENDED and stored > 1e-3
    assert wall.loose.energy[STORED] == approx(stored, rel=0.01)
    assert wall.loose.energy[LARGEST] == approx(DIAMETER / 2, rel=0.001)
    assert wall.energy[FRICTION] - friction < 0.01 * stored


def test_a_brick_that_slides_over_its_length_on_the_ground_keeps_on_sliding():
    """Its joint ends there, and the ground bears it on: friction slows it down by mu g all
    along."""
    wall = loose_pair()
    wall.system.inverse_mass[1] = wall.system.velocity[1] = 0.0  # the upper one is out of the way
    wall.displacement = [[0, 0, 0], [0, 1.0, 0]]
    wall.run(2000)
    wall.system.place[0, X] = 0.0
    wall.system.velocity[0, X] = 2.0
    speed = []
    while wall.displacement[0, X] < 1.6 * LENGTH:
        wall.run(20)
        speed.append((wall.displacement[0, X], wall.velocity[0, X]))
    assert wall.system.limits[0, HAS_FAILED] == ENDED and wall.force[0, Z] > 0.0
    x, v = np.array(speed).T
    lost = 2.0**2 - v**2
    assert lost[-1] == approx(2 * np.tan(Joint().friction_angle) * GRAVITY * x[-1], rel=0.05)


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
    wall = fallen_wall()
    energies = []
    speeds = []
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
    low = places.min(axis=1)
    high = places.max(axis=1)
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
    wall = loose_pair()
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
    assert history.series["time_s"].iloc[-1] == approx(history.collapsed_at_s)
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


# --- single rectangles with rounded corners -------------------------------------------------------


def loose_bricks(length=0.225, height=HEIGHT, courses=1, friction=0.6, damping=0.2, time_step=2e-5):
    """Bricks on each other, at rest, whose joints have ended; damping: of impacts; time_step:
    decides how stiff their corners are, whose radius is 2 % of a length [s]."""
    joint = Joint(friction_angle=math.atan(friction), tensile_strength=0.0, cohesion=0.0)
    brick = Brick(2 * length, height, 0.1)
    wall = Wall("loose", length, courses * height, precompression=0.0, joint=joint, brick=brick)
    with patch.object(collisions, "IMPACT_DAMPING", damping):
        solver = ReferenceSolver(lay_out(wall), time_step, new_contacts=True)
    solver.displacement = [[0.0, 0.1 * (k + 1), 0.0] for k in range(courses)]
    solver.run(2)
    place(solver, [[0.0, 0.0, 0.0]] * courses)
    return solver


def place(solver, displacement):
    solver.displacement = displacement
    solver.velocity = 0.0
    solver.energy[:] = 0.0


def run_for(solver, seconds):
    solver.run(max(1, round(seconds / solver.time_step)))


def test_a_brick_that_bounces_without_friction_keeps_its_energy():
    """Contact forces are a gradient.  On a horizontal floor nothing acts along x: the centre stays
    where it is."""
    brick = loose_bricks(friction=0.0, damping=0.0)
    place(brick, [[0.0, 0.6, 0.5]])
    brick.velocity = [[0.0, 0.0, 3.0]]
    brick.run(1)
    start = total_energy(brick)
    worst = 0.0
    for _ in range(100):
        run_for(brick, 0.02)
        worst = max(worst, abs(total_energy(brick) / start - 1))
    assert worst < 0.005 and brick.loose.counts[SEARCHES] > 10
    assert brick.displacement[0, X] == approx(0.0, abs=1e-3) and not brick.energy[1:].any()


WIDTH = 0.1
TALL = 0.4
CRITICAL = np.arctan(WIDTH / TALL)


def arm_of(angle, radius):
    """From the centre of the arc of a block's lower right corner to that of the block, turned by an
    angle [m, m]."""
    x = -(WIDTH / 2 - radius)
    z = TALL / 2 - radius
    return np.cos(angle) * x + np.sin(angle) * z, np.cos(angle) * z - np.sin(angle) * x


def rocking_block(angle, damping):
    """A block that stands on its lower right corner, turned by this angle."""
    block = loose_bricks(WIDTH, TALL, friction=2.0, damping=damping, time_step=5e-6)
    radius = block.loose.touch.radius
    x, z = arm_of(angle, radius)
    place(block, [[x - arm_of(0.0, radius)[0], radius + z - TALL / 2, -angle]])
    return block


@pytest.mark.parametrize("share", [0.3, 0.6])
def test_a_rocking_block_has_the_exact_quarter_period(share):
    """A block released at an angle t0 rolls on its corner, an arc of radius r about a point that
    lies R from the centre, at the angle a to the long side.  The centre is at the height r + R
    cos(a - t) over the floor, and the block turns about the point of the floor below the arc's
    centre:

        I_c w^2 / 2 = m g R (cos(a - t0) - cos(a - t)),
        I_c = m (b^2 + h^2)/12 + m (R^2 + r^2 + 2 r R cos(a - t))

    With t = t0 - u^2 the quarter period is the integral of 2 u / w."""
    start = share * CRITICAL
    block = rocking_block(start, damping=0.0)
    began = block.step
    radius = block.loose.touch.radius
    while block.displacement[0, ROTATION] < 0 and block.step - began < 400_000:
        block.run(10)
    assert (block.step - began) * block.time_step == approx(
        quarter_period(start, radius), rel=0.005
    )


def quarter_period(start, radius):
    x, z = arm_of(start, radius)
    arm = np.hypot(x, z)
    angle = np.arctan2(-x, z)

    def slowness(u):
        inertia = (
            (WIDTH**2 + TALL**2) / 12
            + arm**2
            + radius**2
            + 2 * radius * arm * np.cos(angle + u * u)
        )
        return (
            2 * u * np.sqrt(inertia / (2 * GRAVITY * arm * (np.cos(angle) - np.cos(angle + u * u))))
        )

    return quad(slowness, 1e-9, np.sqrt(start))[0]


@pytest.mark.parametrize(("share", "topples"), [(0.97, False), (1.03, True)])
def test_a_block_returns_or_topples_on_either_side_of_its_critical_angle(share, topples):
    """Its weight acts on one side of its corner or on the other: it stands up again, or lies on its
    side."""
    block = rocking_block(share * CRITICAL, damping=0.5)
    run_for(block, 3.0)
    turned = -block.displacement[0, ROTATION]
    centre = TALL / 2 + block.displacement[0, Z]
    assert turned == approx(np.pi / 2 if topples else 0.0, abs=0.3 * CRITICAL)
    assert centre == approx((WIDTH if topples else TALL) / 2, abs=0.005)


def test_a_stack_stands_without_drifting():
    """Nothing acts along x, and friction keeps what it holds: after the first second nothing
    moves."""
    stack = loose_bricks(courses=4)
    run_for(stack, 1.0)
    start = stack.displacement
    weight = GRAVITY * stack.layout.total_mass
    assert stack.support_force[:, 1].sum() == approx(-weight, rel=1e-5)
    run_for(stack, 2.0)
    assert np.abs(stack.displacement - start).max() < 1e-9 and stack.loose.counts[INSIDE] == 0


def test_a_brick_slides_by_friction_and_stops():
    """s = v^2 / (2 mu g), and friction takes m v^2 / 2."""
    brick = loose_bricks()
    run_for(brick, 0.2)
    start = brick.displacement[0, X]
    brick.energy[:] = 0.0
    brick.velocity = [[1.0, 0.0, 0.0]]
    run_for(brick, 0.5)
    assert brick.displacement[0, X] - start == approx(1 / (2 * 0.6 * GRAVITY), rel=0.01)
    assert brick.energy[FRICTION] == approx(brick.layout.bodies.mass[0] / 2, rel=0.01)
