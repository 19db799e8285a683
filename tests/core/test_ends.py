"""A joint ends where its two faces no longer overlap: closed forms of a brick that is pushed, or
shoved, off another.

Both bricks of a pair are 0.1125 m long, lie on each other over their whole length, and all joints
are dry.
"""

import numpy as np
import pytest
from conftest import total_energy
from numpy.testing import assert_allclose
from pytest import approx
from short_runs import solver_of

from damage import Brick, Joint, ModelOptions, Wall
from damage.law.states import ENDED, ENDING, FAILED
from damage.mechanics.tables import FRICTION, HAS_FAILED, ROTATION, X, Z
from damage.reference.solver import ReferenceSolver
from damage.units import GRAVITY
from damage.wall.layout import lay_out

LENGTH = 0.1125
HEIGHT = 0.075
DRY = {"tensile_strength": 0.0, "cohesion": 0.0}
FRICTION_COEFFICIENT = np.tan(Joint().friction_angle)


def pair(joint=DRY, **options):
    """Two bricks on each other, at rest under their weight; the upper one is body 1 and interface
    1."""
    wall = Wall("pair", LENGTH, 2 * HEIGHT, precompression=0.0, joint=Joint(**joint))
    layout = lay_out(wall, ModelOptions(**options))
    wall = solver_of(layout, 0.3)
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
