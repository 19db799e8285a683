"""Contacts that bricks find as they move: single rectangles with rounded corners against closed
forms."""

import math
from unittest.mock import patch

import numpy as np
import pytest
from conftest import total_energy
from scipy.integrate import quad

from damage import Brick, Joint, Wall
from damage.mechanics import collisions
from damage.mechanics.collisions import (
    INSIDE,
    SEARCHES,
)
from damage.mechanics.tables import FRICTION, ROTATION, X, Z
from damage.reference.solver import ReferenceSolver
from damage.units import GRAVITY
from damage.wall.layout import lay_out

LENGTH, HEIGHT = 0.225, 0.075


def loose_bricks(
    length=LENGTH, height=HEIGHT, courses=1, friction=0.6, damping=0.2, time_step=2e-5
):
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
    solver.displacement, solver.velocity = displacement, 0.0
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
    start, worst = total_energy(brick), 0.0
    for _ in range(100):
        run_for(brick, 0.02)
        worst = max(worst, abs(total_energy(brick) / start - 1))
    assert worst < 0.005 and brick.loose.counts[SEARCHES] > 10
    assert brick.displacement[0, X] == pytest.approx(0.0, abs=1e-3) and not brick.energy[1:].any()


WIDTH, TALL = 0.1, 0.4
CRITICAL = np.arctan(WIDTH / TALL)


def arm_of(angle, radius):
    """From the centre of the arc of a block's lower right corner to that of the block, turned by an
    angle [m, m]."""
    x, z = -(WIDTH / 2 - radius), TALL / 2 - radius
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
    began, radius = block.step, block.loose.touch.radius
    while block.displacement[0, ROTATION] < 0 and block.step - began < 400_000:
        block.run(10)
    assert (block.step - began) * block.time_step == pytest.approx(
        quarter_period(start, radius), rel=0.005
    )


def quarter_period(start, radius):
    x, z = arm_of(start, radius)
    arm, angle = np.hypot(x, z), np.arctan2(-x, z)

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
    turned, centre = -block.displacement[0, ROTATION], TALL / 2 + block.displacement[0, Z]
    assert turned == pytest.approx(np.pi / 2 if topples else 0.0, abs=0.3 * CRITICAL)
    assert centre == pytest.approx((WIDTH if topples else TALL) / 2, abs=0.005)


def test_a_stack_stands_without_drifting():
    """Nothing acts along x, and friction keeps what it holds: after the first second nothing
    moves."""
    stack = loose_bricks(courses=4)
    run_for(stack, 1.0)
    start, weight = stack.displacement, GRAVITY * stack.layout.total_mass
    assert stack.support_force[:, 1].sum() == pytest.approx(-weight, rel=1e-5)
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
    assert brick.displacement[0, X] - start == pytest.approx(1 / (2 * 0.6 * GRAVITY), rel=0.01)
    assert brick.energy[FRICTION] == pytest.approx(brick.layout.bodies.mass[0] / 2, rel=0.01)
