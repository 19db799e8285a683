"""Every solver against closed forms; `python3 -m verification` prints the figures."""

import math
import shutil

import pytest
from conftest import REPOSITORY
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp

from damage import load_wall
from damage.linear.modes import natural_modes
from damage.motion.loading import Harmonic
from damage.wall.layout import lay_out
from verification import rocking, sliding
from verification.__main__ import all_problems, main
from verification.loaded import loaded_period
from verification.problem import Problem

PROBLEMS = {problem.name: problem for problem in all_problems()}
QUICK_IN_YADE = (
    "incline of 40°",
    "stack of ten bricks",
    "crushed column",
    "splitting brick",
    "brick sheared under 2 MPa, energy",
)
LARGE = (
    *(f"{name} wall under its load" for name in ("solid", "symmetric", "asymmetric")),
    "rocking from 0.8 alpha",
)
"""Problems beside which a smaller one is, or another of their kind."""


@pytest.mark.parametrize(
    "name",
    [pytest.param(name, marks=[pytest.mark.long] if name in LARGE else []) for name in PROBLEMS],
)
def test_reference(name):
    result = PROBLEMS[name].judge("reference")
    assert result.holds, result


def yade_problems():
    for name, problem in PROBLEMS.items():
        if not isinstance(problem.solvers["yade"], str):
            yield pytest.param(name, marks=[] if name in QUICK_IN_YADE else pytest.mark.long)


@pytest.mark.yade
@pytest.mark.skipif(shutil.which("yade") is None, reason="YADE is not installed")
@pytest.mark.parametrize("name", yade_problems())
def test_yade(name):
    result = PROBLEMS[name].judge("yade")
    assert result.holds, result


def test_newmark_by_plain_integration():
    motion = Harmonic(0.1, 0.5, 2)
    angle = math.radians(20)
    friction = math.tan(math.radians(32))
    omega = 2 * math.pi / 0.1
    gravity = 9.81
    dt = 1e-6
    speed = 0.0
    way = 0.0
    time = 0.0
    while time < 0.3:
        base = 0.5 * gravity * math.sin(omega * time) if time <= 0.2 else 0.0
        drive = gravity * math.sin(angle) - base
        resist = gravity * math.cos(angle) * friction
        speed = max(0.0, speed + dt * (drive - resist))
        way = way + dt * speed
        time = time + dt
    assert_allclose(sliding.newmark_slip(motion, angle, friction), way, rtol=1e-3)


def test_quarter_period_by_plain_integration():
    slenderness = 0.25
    rate = 4.0
    share = 0.6
    upright = lambda t, y: y[0]  # noqa: E731
    upright.terminal = True
    solved = solve_ivp(
        lambda t, y: [y[1], -(rate**2) * math.sin(slenderness - y[0])],
        (0, 5),
        [share * slenderness, 0.0],
        events=upright,
        rtol=1e-10,
        atol=1e-12,
    )
    assert_allclose(
        rocking.quarter_period(share, slenderness, rate), solved.t_events[0][0], rtol=1e-6
    )
    assert_allclose(rocking.housner(share, rate), solved.t_events[0][0], rtol=1e-2)


@pytest.mark.parametrize(
    "contacts, least, most, housner",
    [("interior", 0.02, 0.03, 0.955), ("corners", 0.06, 0.08, 0.831)],
)
def test_what_a_rocking_block_loses_at_its_impact_is_frictions(contacts, least, most, housner):
    """By its energy before and after; Housner's rigid block keeps (1 - 2 b^2 / (I / m + b^2 +
    h^2))^2 of it."""
    found = rocking.rock(0.5, contacts)
    assert least < found.friction < most
    assert found.left + found.friction == pytest.approx(1, abs=0.01)
    assert housner < found.left < 1 and 0.8 < found.tilt < 1


def test_a_wall_without_weight_has_the_period_of_its_springs():
    layout = lay_out(load_wall(REPOSITORY / "walls" / "variants" / "small.py"))
    springs = natural_modes(layout, 1).period_s[0]
    assert_allclose(loaded_period(layout, gravity=0.0), springs, rtol=2.0**-25)
    assert loaded_period(layout) > (1 + 1e-6) * springs  # the load leans


def test_a_wrong_answer_fails(capsys, monkeypatch):
    wrong = Problem(
        "wrong", "one", "m", 1.0, "made up", {"reference": 1e-3}, {"reference": lambda: 1.1}
    )
    monkeypatch.setattr("verification.__main__.all_problems", lambda: [wrong])
    assert main(["--solver", "reference"]) == 1
    assert "FAILS" in capsys.readouterr().out
    assert main(["nothing"]) == 2
