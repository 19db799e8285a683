"""Contacts that bricks find as they move: single rectangles with rounded corners against closed forms."""

import numpy as np
import pytest
from scipy.integrate import quad

from damage.law.joint_law import material_of
from damage.mechanics import step, tables
from damage.mechanics.eight import ONE
from damage.mechanics.loose import (
    CENTRE_X,
    CENTRE_Z,
    INSIDE,
    LARGEST,
    SEARCHES,
    STEP_SHARE,
    STORED,
    WANTED,
    Touch,
    make_loose,
)
from damage.mechanics.samples import Samples, Stiffness
from damage.mechanics.tables import DAMPING, FRICTION, ROTATION, Law, X, Z, table
from damage.units import GRAVITY
from damage.wall.parameters import Joint

DENSITY, THICKNESS = 1900.0, 0.1025
LENGTH, HEIGHT = 0.225, 0.075
FLOOR = (0.0, -0.5, 0.0, 20.0, 1.0)
"""x, z, rotation, length and height of a support whose upper face is z = 0."""


class Boxes:
    """Rectangles of masonry under gravity, moved by the plain step, without joints."""

    def __init__(self, boxes, supports=(FLOOR,), friction=0.6, support_friction=None, damping=0.0, radius=None,
                 stiffness=None, step_share=STEP_SHARE, gravity=GRAVITY):
        """boxes, supports: (x, z, rotation, length, height) of each [m, m, rad, m, m]; radius: default 1 % of the
        shortest length; stiffness: [N/m] of a corner, default 1e7."""
        rows = np.array([*boxes, *supports], float)
        n, length, height = len(boxes), rows[:, 3], rows[:, 4]
        weight = DENSITY * THICKNESS * length * height
        mass = np.column_stack([weight, weight, weight * (length**2 + height**2) / 12])
        mass[n:] = 0.0
        inverse = np.zeros_like(mass)
        inverse[:n] = 1 / mass[:n]
        self.n, self.radius = n, radius or 0.01 * length[:n].min()
        half_x, half_z = length / 2 - self.radius, height / 2 - self.radius
        cores = np.column_stack([rows[:, 0], rows[:, 1], -half_x, half_x, -half_z, half_z])
        stiffness = stiffness or 1e7
        self.time_step = step_share * np.sqrt(weight[:n].min() / stiffness)
        touch = Touch(self.radius, stiffness, 0.4 * stiffness, friction,
                      friction if support_friction is None else support_friction, damping)
        self.loose = make_loose(touch, cores, np.zeros(0), np.zeros(0))
        self.loose.counts[WANTED] = 1
        self._tables = tables.make_tables(len(rows), 3, table(tables.INTERFACE, 0), table(tables.CONTACT, 0), 0, 0, 0,
                                          1)
        self.system = tables.system_of(self._tables, 0)
        self.system.place[:, ROTATION] = rows[:, 2]
        self.system.trig[:] = np.column_stack([np.cos(rows[:, 2]) - 1, np.sin(rows[:, 2])])
        self.system.mass[:], self.system.inverse_mass[:] = mass, inverse
        self._law = Law(material_of(Joint()), 1e-4)
        self._stiffness = Stiffness(np.zeros(0), np.zeros(0), np.zeros(0))
        self._samples = Samples.none(1, 1, self.system, len(supports))
        self.gravity, self.time = gravity, 0.0

    def run(self, duration):
        """Advance by so many seconds, at least a step; returns self."""
        n = max(1, round(duration / self.time_step))
        field = np.zeros((1, n + 1, 3))
        field[..., 2] = self.gravity
        step.run(step.ADVANCE, ONE, self._tables, self._law, None, self.loose, None,
                 np.array([[self.time_step, 0, 0, 0, 0]]), field, np.zeros(1, int), np.array([n]), np.ones(1, int),
                 self._stiffness, self._samples, np.zeros(1, int))
        self.time += n * self.time_step
        return self

    @property
    def place(self):
        """x, z, rotation of the free boxes (n, 3)."""
        return (self.system.place + np.pad(self.loose.cores[:, [CENTRE_X, CENTRE_Z]], [(0, 0), (0, 1)]))[:self.n]

    @property
    def kinetic(self):
        return float(self._samples.totals[0, 0, 0])

    @property
    def stored(self):
        """Kinetic and elastic energy and that of the height over the origin [J]."""
        lifted = self.gravity * float(self.system.mass[:self.n, Z] @ self.place[:, Z])
        return self.kinetic + self.loose.energy[STORED] + lifted

    @property
    def dissipated(self):
        return self.system.energy[FRICTION] + self.system.energy[DAMPING]


def spinning_brick(**options):
    boxes = Boxes([(0, 0.6, 0.5, LENGTH, HEIGHT)], friction=0.0, **options)
    boxes.system.velocity[0, ROTATION] = 3.0
    return boxes


def test_a_brick_that_bounces_without_friction_keeps_its_energy():
    """Contact forces are a gradient: kinetic, elastic and potential energy add up to m g z + I w^2 / 2 of the start.

    Without friction and on a horizontal floor nothing acts along x: the centre stays where it is."""
    brick = spinning_brick().run(0)
    start, worst = brick.stored, 0.0
    mass, inertia = brick.system.mass[0, [Z, ROTATION]]
    assert start == pytest.approx(mass * GRAVITY * 0.6 + inertia * 3.0**2 / 2, rel=1e-5)
    for _ in range(400):
        brick.run(0.01)
        worst = max(worst, abs(brick.stored / start - 1))
    assert worst < 0.005
    assert brick.loose.counts[SEARCHES] > 10 and brick.loose.energy[LARGEST] < brick.radius
    assert brick.place[0, X] == pytest.approx(0.0, abs=1e-3) and brick.dissipated == 0.0


WIDTH, TALL = 0.1, 0.4
CRITICAL = np.arctan(WIDTH / TALL)


def arm_of(angle, radius):
    """From the centre of the arc of a block's lower right corner to that of the block, turned by an angle [m, m]."""
    x, z = -(WIDTH / 2 - radius), TALL / 2 - radius
    return np.cos(angle) * x + np.sin(angle) * z, np.cos(angle) * z - np.sin(angle) * x


def rocking_block(angle, radius, **options):
    """A block that stands on its lower right corner, turned by this angle."""
    x, z = arm_of(angle, radius)
    return Boxes([(x, radius + z, -angle, WIDTH, TALL)], friction=2.0, stiffness=1e9, radius=radius, **options)


@pytest.mark.parametrize("share", [0.3, 0.6])
@pytest.mark.parametrize("radius", [0.01 * WIDTH, 0.002 * WIDTH])
def test_a_rocking_block_has_the_exact_quarter_period(share, radius):
    """A block released at an angle t0 rolls on its corner, an arc of radius r about a point that lies R from the
    centre, at the angle a to the long side.  The centre is at the height r + R cos(a - t) over the floor, and the block
    turns about the point of the floor below the arc's centre:

        I_c w^2 / 2 = m g R (cos(a - t0) - cos(a - t)),  I_c = m (b^2 + h^2)/12 + m (R^2 + r^2 + 2 r R cos(a - t))

    With t = t0 - u^2 the quarter period is the integral of 2 u / w.  For r = 0 it is that of a sharp corner, 4/3 m R^2,
    from which it differs by 2 to 3 % where r is 1 % of the width, and by 0.6 % where it is 0.2 %."""
    start = share * CRITICAL
    exact, sharp = quarter_period(start, radius), quarter_period(start, 0.0)
    block = rocking_block(start, radius=radius)
    while block.place[0, ROTATION] < 0 and block.time < 2:
        block.run(10 * block.time_step)
    assert block.time == pytest.approx(exact, rel=0.005)
    assert block.time == pytest.approx(sharp, rel=0.01 if radius < 0.005 * WIDTH else 0.03)


def quarter_period(start, radius):
    x, z = arm_of(start, radius)
    arm, angle = np.hypot(x, z), np.arctan2(-x, z)

    def slowness(u):
        inertia = (WIDTH**2 + TALL**2) / 12 + arm**2 + radius**2 + 2 * radius * arm * np.cos(angle + u * u)
        return 2 * u * np.sqrt(inertia / (2 * GRAVITY * arm * (np.cos(angle) - np.cos(angle + u * u))))

    return quad(slowness, 1e-9, np.sqrt(start))[0]


@pytest.mark.parametrize(("share", "topples"), [(0.98, False), (1.02, True)])
def test_a_block_returns_or_topples_on_either_side_of_its_critical_angle(share, topples):
    """Its weight acts on one side of its corner or on the other: it stands up again, or lies on its side."""
    block = rocking_block(share * CRITICAL, radius=2e-4, damping=0.2).run(8.0)
    turned = -block.place[0, ROTATION]
    assert turned == pytest.approx(np.pi / 2 if topples else 0.0, abs=0.01)
    assert block.place[0, Z] == pytest.approx((WIDTH if topples else TALL) / 2, abs=1e-4)


def test_a_brick_that_is_pushed_off_a_support_tips_falls_and_comes_to_rest():
    """The last point that bears is the edge of the support less r, where its rounded corner begins.  A brick that is
    pushed at its centre tips when weight and friction have no moment about that point: x = edge - r - mu h / 2.  It
    then falls by the height of the support and comes to rest flat or on end; what it had is dissipated."""
    boxes = Boxes([(0, 1.5 * HEIGHT, 0, LENGTH, HEIGHT)], [FLOOR, (0, HEIGHT / 2, 0, LENGTH, HEIGHT)], friction=0.2,
                  damping=0.2)
    boxes.run(0.1)
    start = boxes.stored
    last = LENGTH / 2 - boxes.radius - 0.2 * HEIGHT / 2
    boxes.system.inverse_mass[0, X], boxes.system.velocity[0, X] = 0.0, 0.05  # as a pushed top: its work is input
    tipped_at = None
    while boxes.place[0, ROTATION] > -0.01:
        boxes.run(0.001)
        assert boxes.time < 4
        tipped_at = tipped_at or (boxes.place[0, X] if boxes.place[0, ROTATION] < -2e-4 else None)
    assert tipped_at == pytest.approx(last, abs=0.01 * LENGTH)
    boxes.system.inverse_mass[0, X] = 1 / boxes.system.mass[0, X]
    boxes.run(3.0)
    assert boxes.kinetic < 1e-6 and boxes.loose.counts[INSIDE] == 0
    assert boxes.place[0, Z] == pytest.approx(HEIGHT / 2, abs=1e-4) or boxes.place[0, Z] == pytest.approx(
        LENGTH / 2, abs=1e-4)
    supplied = boxes.system.energy[tables.INPUT] + 0.05**2 / 2 * boxes.system.mass[0, X]
    assert boxes.dissipated == pytest.approx(start - boxes.stored + supplied, rel=0.02)


def test_a_stack_stands_for_a_minute_without_drifting():
    """Nothing acts along x, and friction keeps what it holds: after the first second nothing moves."""
    stack = Boxes([(0.01 * (k % 3), (k + 0.5) * HEIGHT, 0, LENGTH, HEIGHT) for k in range(4)], damping=0.2).run(1.0)
    start = stack.place
    weight = stack.system.mass[0, Z] * GRAVITY
    assert stack.system.force[-1, Z] == pytest.approx(-4 * weight, rel=1e-6)
    stack.run(59.0)
    assert np.abs(stack.place - start).max() < 1e-9
    assert stack.kinetic < 1e-12


def test_a_brick_slides_by_friction_and_stops():
    """s = v^2 / (2 mu g), and friction takes m v^2 / 2."""
    boxes = Boxes([(0, HEIGHT / 2, 0, LENGTH, HEIGHT)], friction=0.6, damping=0.2).run(0.2)
    start = boxes.place[0, X]
    boxes.system.energy[:] = 0.0
    boxes.system.velocity[0, X] = 1.0
    boxes.run(0.5)
    assert boxes.place[0, X] - start == pytest.approx(1 / (2 * 0.6 * GRAVITY), rel=0.01)
    assert boxes.system.energy[FRICTION] == pytest.approx(boxes.system.mass[0, X] / 2, rel=0.01)


def test_a_core_corner_inside_another_core_is_counted():
    boxes = Boxes([(0, HEIGHT / 2 - 0.02, 0, LENGTH, HEIGHT)])
    assert boxes.run(0).loose.counts[INSIDE] > 0


def test_bodies_that_overlap_as_they_become_neighbours_are_not_pushed_apart():
    """The overlap is a rest gap, which decreases as they part: without gravity nothing moves."""
    boxes = Boxes([(0, HEIGHT / 2 - 0.001, 0, LENGTH, HEIGHT)], gravity=0.0).run(0.01)
    assert np.all(boxes.system.force == 0.0) and np.all(boxes.system.velocity == 0.0)
    boxes.system.velocity[0, Z] = 0.1
    boxes.run(0.05)
    boxes.system.velocity[0, Z] = -0.1
    boxes.run(0.2)  # it comes back, and bounces where the faces meet
    assert boxes.system.velocity[0, Z] == pytest.approx(0.1, rel=1e-3)
    assert boxes.loose.energy[LARGEST] < 0.0009
