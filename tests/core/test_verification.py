"""Every solver against closed forms; `python3 -m verification` prints the figures."""

import shutil

import pytest
from conftest import REPOSITORY
from numpy.testing import assert_allclose

from damage import load_wall
from damage.linear.modes import natural_modes
from damage.wall.layout import lay_out
from verification import rocking
from verification.__main__ import all_problems, main
from verification.loaded import loaded_period
from verification.problem import Problem

PROBLEMS = {problem.name: problem for problem in all_problems()}
QUICK_IN_YADE = (
    "incline of 40°",
    "crushed column",
    "splitting brick",
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
