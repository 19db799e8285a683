"""Restraints: strips in one-way bending between floors, and party walls, against closed forms and
in both solvers."""

import math
import tomllib
from itertools import pairwise

import numpy as np
import pytest
from conftest import written
from numpy.testing import assert_allclose, assert_array_equal
from scipy.optimize import brentq
from short_runs import solver_of

from damage import Brick, Joint, ModelOptions, Wall
from damage.linear.modes import natural_modes
from damage.mechanics.tables import FRICTION
from damage.reference.lanes import run_together
from damage.reference.solver import ReferenceSolver
from damage.units import GRAVITY
from damage.wall.file import wall_from
from damage.wall.layout import lay_out
from damage.wall.new import as_toml
from damage.wall.restraints import THICK_M, Restraint

THICK = 0.21
WIDTH = 1.292
DENSITY = 1885.0
DRY = Joint(1e10, 4e9, math.atan(0.75), 0.0, 0.0)
GAUSS = ModelOptions(contacts="gauss", cells=4)
TOP = Restraint("top")


def strip(
    courses=10, course=0.258, joint=DRY, load=38e3, modulus=1e15, restraint=TOP, options=GAUSS
):
    """Layout of a column of courses one brick long: a strip of a wall in one-way bending."""
    brick = Brick(
        2 * THICK, course, WIDTH, DENSITY, young_modulus=modulus, shear_modulus=modulus / 2.5
    )
    return lay_out(
        Wall(
            "strip",
            THICK,
            courses * course,
            precompression=load,
            brick=brick,
            joint=joint,
            restraints=[restraint],
        ),
        options,
    )


class TestStrip:
    @staticmethod
    def mechanism(layout, k, free):
        """Force [N] on the pushed course and its displacement [m] at which it vanishes, of rigid
        blocks that turn about the outermost contact points of the base, joint k and the top; a free
        top turns about the beam's middle."""
        wall = layout.wall
        bodies = layout.bodies
        lever = np.ptp(layout.contacts.x)
        height = wall.built_height
        low = k * wall.brick.height
        high = height - k * wall.brick.height + (THICK_M / 2 if free else 0.0)
        below = GRAVITY * bodies.mass[:k].sum()
        above = GRAVITY * bodies.mass[k:-1].sum()
        load = GRAVITY * layout.top_mass
        bricks = below / 2 / low + above * (1 / low + 0.5 / high)
        force = (load * (1 / low + (0.5 if free else 1.0) / high) + bricks) * lever
        slope = load * (1 / low + 1 / high) + bricks
        up = bodies.z[layout.drift_bodies[0]]
        # of the pushed course over that of the hinge
        moved = min(up / low, (low + high - up) / high)
        return force / moved, force / slope * moved

    @pytest.mark.parametrize(
        ("rotation", "load"),
        [
            ("fixed", 38e3),
            pytest.param("fixed", 150e3, marks=pytest.mark.long),
            ("free", 38e3),
        ],
    )
    def test_mechanism_load_and_displacement_capacity_follow_the_closed_form(self, rotation, load):
        layout = strip(load=load, restraint=Restraint("top", rotation))
        wall = solver_of(layout)
        wall.damp(local=0.7)
        wall.run(round(0.4 / wall.time_step))
        wall.hold(layout.pushed_bodies, rotation=False)
        wall.push(speed := 1e-3)
        wall.run(round(0.02 / speed / wall.time_step))
        found = []
        while (place := wall.displacement[layout.drift_bodies[0], 0]) < 0.07:
            wall.run(40)
            found.append((place, wall.push_force()))
        slope, at_first = np.polyfit(*np.transpose(found), 1)
        force, capacity = min(self.mechanism(layout, k, rotation == "free") for k in range(1, 10))
        assert_allclose([at_first, -at_first / slope], [force, capacity], rtol=0.02)
        moved = wall.displacement[-1]
        assert moved[0] == 0.0 and (moved[2] == 0.0) == (rotation == "fixed") and moved[1] > 1e-3

    def test_the_first_period_is_that_of_a_clamped_timoshenko_beam(self):
        """Symmetric modes of cosh and cos about the middle, deflection and rotation zero at the
        ends."""
        young = 2.5e9
        shear = 1e9
        half = 2.58 / 2
        layout = strip(43, 0.06, Joint(1e14, 4e13, tensile_strength=0.2e6), modulus=young)
        area = THICK * WIDTH
        radius2 = THICK**2 / 12

        def ends(frequency):
            inertia = DENSITY * (2 * math.pi * frequency) ** 2
            b = inertia * (1 / young + 1 / shear)
            c = inertia / young * (inertia / shear - 1 / radius2)
            root = math.sqrt(b**2 / 4 - c)
            # w = cosh p x, cos q x
            p = math.sqrt(root - b / 2)
            q = math.sqrt(root + b / 2)
            turn_p = p + inertia / shear / p
            turn_q = q - inertia / shear / q
            return math.cosh(p * half) * turn_q * math.sin(q * half) + turn_p * math.sinh(
                p * half
            ) * math.cos(q * half)

        assert_allclose(natural_modes(layout).period_s[0], 1 / brentq(ends, 10.0, 60.0), rtol=0.02)
        assert area * 2.58 * DENSITY == pytest.approx(layout.bodies.mass[:-1].sum())

    def test_the_load_stays_constant_on_a_light_beam(self):
        light, heavy = (strip(restraint=Restraint("top", mass=mass)) for mass in (100.0, None))
        assert (
            light.total_mass == pytest.approx(heavy.total_mass) and light.bodies.mass[-1] == 100.0
        )
        for layout in (light, heavy):
            wall = solver_of(layout)
            wall.damp(local=0.7)
            wall.run(round(0.5 / wall.time_step))
            assert_allclose(wall.base_reaction(), GRAVITY * layout.total_mass, rtol=1e-4)


class TestBearing:
    TOP = Restraint("top", stiffness=2e6, friction=0.3, play=0.004)

    def path(self):
        return np.interp(
            np.arange(81), np.arange(0, 81, 16), [0.0, 0.02, -0.02, 0.02, -0.003, 0.001]
        )

    def test_the_step_follows_the_law_and_its_slip_is_friction(self):
        """k (u - s), |F| up to mu N while the play lasts."""
        layout = strip(restraint=self.TOP)
        load = GRAVITY * layout.top_mass
        slip = 0.0
        forces = []
        wall = ReferenceSolver(layout, 1e-5)
        beam = len(layout.bodies) - 1
        for place in self.path():
            moved = wall.displacement
            moved[beam, 0] = place
            wall.displacement = moved
            slip = self.TOP.slip(place, slip, load)
            forces.append(2e6 * (place - slip))
            assert_allclose(
                wall.system.bearings[beam][["slip", "force"]].tolist(),
                [slip, forces[-1]],
                rtol=1e-12,
            )
            if place in (0.02, -0.02):
                assert slip == math.copysign(0.004, place)
        work = (
            sum(
                0.5 * (one + other) * (b - a)
                for (one, other), (a, b) in zip(
                    pairwise([0.0, *forces]), pairwise([0.0, *self.path()])
                )
            )
            - 0.5 * forces[-1] ** 2 / 2e6
        )
        assert_allclose(wall.energy[FRICTION], work, rtol=1e-9)

    def test_eight_walls_together_have_the_bits_of_each_alone(self):
        def make(k):
            joint = Joint(4e9, 1.6e9, tensile_strength=2e4, cohesion=4e4)
            wall = ReferenceSolver(
                strip(
                    joint=joint,
                    restraint=self.TOP,
                    options=ModelOptions(strength_cov=0.2, strength_seed=k),
                ),
                1e-4,
            )
            wall.run(100)
            wall.start(np.column_stack([6 * np.sin(np.arange(4000) * 1e-4 * 50), np.zeros(4000)]))
            return wall

        together, alone = [[make(k) for k in range(5)] for _ in range(2)]
        run_together(together, 4000)
        for wall in alone:
            wall.run(4000)
        for one, other in zip(together, alone):
            assert_array_equal(one.displacement, other.displacement)
            assert_array_equal(one.system.bearings, other.system.bearings)
            assert one.system.bearings["slip"][-1] != 0.0


def test_party_walls_share_the_inertia_of_a_block_by_their_stiffness():
    """One brick under a steady acceleration: u = m a / (k_s A of the bed joint + k_n A of both head
    joints)."""
    brick = Brick(0.225, 0.075, 0.1, 2000.0, young_modulus=1e15, shear_modulus=1e15)
    layout = lay_out(
        Wall(
            "block",
            0.225,
            0.075,
            precompression=0.0,
            brick=brick,
            joint=Joint(1e9, 4e7, cohesion=1e9, tensile_strength=1e9),
            restraints=[Restraint("left"), Restraint("right")],
        )
    )
    wall = solver_of(layout, 0.3)
    wall.damp(local=0.7)
    wall.start(np.full((4000, 2), [2.0, 0.0]))
    wall.run(4000)
    stiffness = 4e7 * 0.225 * 0.1 + 2 * 1e9 * 0.075 * 0.1
    assert_allclose(wall.displacement[0, 0], -layout.bodies.mass[0] * 2.0 / stiffness, rtol=5e-3)
    assert_array_equal(wall.displacement[1:], 0.0)


SMALL = """
name = "small"
length = 0.21
height = 1.5
precompression = 38e3
brick = { length = 0.42, height = 0.15, thickness = 1.292, density = 1885 }
joint.normal_stiffness = 4e9
joint.shear_stiffness = 1.6e9
joint.tensile_strength = 0.05e6
joint.cohesion = 0.08e6
restraints = [{ side = "top", stiffness = 2e6, friction = 0.3, play = 0.002, mass = 200 }]
"""
PARTY = as_toml(
    Wall(
        "party",
        0.7,
        0.6,
        precompression=200e3,
        joint=Joint(1e10, 4e9, tensile_strength=0.1e6, cohesion=0.2e6),
        restraints=[Restraint("left")],
    ).as_dict()
)


@pytest.mark.yade
@pytest.mark.long
@pytest.mark.parametrize(
    ("text", "period", "peak"),
    [
        pytest.param(SMALL, 0.15, 0.45, id="top"),
        pytest.param(PARTY, 0.1, 0.2, id="side"),
    ],
)
def test_both_solvers_agree(tmp_path, in_both, text, period, peak):
    yade, reference = in_both(
        tmp_path,
        written(tmp_path / "wall.toml", text),
        "--harmonic",
        period,
        peak,
        "--rest 0.1 --contacts gauss --cells 4 --quiet",
    ).values()
    drift = [history.series["drift_ratio"].to_numpy() for history in (yade, reference)]
    assert np.abs(drift[1]).max() > 1e-5 and len(reference.events) > 0
    assert_allclose(drift[0], drift[1], atol=0.05 * np.abs(drift[1]).max())
    assert reference.masonry_wall == wall_from_text(text)


def wall_from_text(text):
    return wall_from(tomllib.loads(text))


def test_a_wall_of_its_dictionary_has_its_restraints():
    wall = wall_from_text(SMALL)
    assert (
        Wall.from_dict(wall.as_dict()) == wall
        and "restraints" not in Wall("plain", 1.0, 1.0).as_dict()
    )


def test_a_push_that_keeps_the_middle_from_turning_is_refused(tmp_path, error_of):
    wall = written(tmp_path / "wall.toml", SMALL)
    assert "leave --boundary out" in error_of(
        "reference", wall, "--pushover", 1, "--boundary", "fixed"
    )
