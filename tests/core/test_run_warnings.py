"""Warnings of a run: the same from the command line and from Python."""

import json
import math
import pickle
from types import SimpleNamespace

import pytest
from conftest import wall_file
from pytest import approx

from damage import Brick, Joint, RunWarning, Wall, read_history, run, warnings_of
from damage.measure.energy import energy_error_of
from damage.measure.warnings import push_drag, static_warnings
from damage.reference.session import run_reference
from damage.wall.restraints import Restraint

DRY = Wall(
    "course",
    0.675,
    0.075,
    precompression=0.0,
    joint=Joint(tensile_strength=0.0, cohesion=0.0),
)
"""A dry course of three bricks, which bounce and slide within nine steps a period."""
LIGHT_STRIP = Wall(
    "strip",
    0.21,
    2.58,
    precompression=2e3,
    brick=Brick(length=0.42, height=0.06, thickness=1.29, density=1885),
    joint=Joint(
        normal_stiffness=4e9,
        shear_stiffness=1.6e9,
        tensile_strength=0.2e6,
        cohesion=0.3e6,
        friction_angle=math.atan(0.75),
    ),
    restraints=(Restraint("top", rotation="free"),),
)
FREE = {"free_vibration": True, "rest": 0.1}
ENERGY = "energy balance error 3.* % of the input, expected up to 1 %"


def codes_of(history):
    return [one.code for one in warnings_of(history)]


def test_python_warns_of_an_energy_balance_error_where_it_was_called(tmp_path):
    with pytest.warns(RunWarning, match=ENERGY) as caught:
        history = run(DRY, **FREE, out=tmp_path / "a.h5")
    assert {one.filename for one in caught} == {__file__}
    assert (
        [str(one.message) for one in caught]
        == warnings_of(history)
        == warnings_of(read_history(tmp_path / "a.h5"))
    )
    assert "energy_balance" in codes_of(history)
    assert {type(text) for text in json.loads(json.dumps(warnings_of(history)))} == {str}
    assert [one.code for one in pickle.loads(pickle.dumps(warnings_of(history)))] == codes_of(
        history
    )


def test_a_light_strip_that_is_pushed_too_fast_is_said_to_be_dragged(tmp_path):
    """The whole push takes one period of the strip at the default speed: it accelerates all the
    time, which damping resists."""

    def pushed(speed):
        out = tmp_path / f"{speed:g}.h5"
        return run(LIGHT_STRIP, pushover=0.02, speed=speed, contacts="gauss", cells=8, out=out)

    with pytest.warns(RunWarning, match="28 % of the largest force.*--speed 0.0003"):
        fast = pushed(0.005)
    slow = pushed(0.0003)
    assert "push_drag" in codes_of(fast)
    assert push_drag(slow) < 0.02 and "push_drag" not in codes_of(slow)
    # the same way of the top took as much more work as was damped
    end_fast, end_slow = (one.series.iloc[-1] for one in (fast, slow))
    more_j = end_fast["input_energy_j"] - end_slow["input_energy_j"]
    assert more_j > 0.2 * end_slow["input_energy_j"]
    assert end_fast["damping_energy_j"] - end_slow["damping_energy_j"] == approx(more_j, rel=0.02)


@pytest.mark.filterwarnings("ignore::damage.RunWarning")
def test_a_tensile_strength_beyond_the_apex_never_acts_and_is_named():
    """A pulled column fails in shear at 0.1 / 0.75 MPa, whatever strength is given beyond it."""
    runs = []
    for strength in (0.13e6, 0.2e6, 0.3e6):
        joint = Joint(tensile_strength=strength, cohesion=0.1e6, friction_angle=math.atan(0.75))
        wall = Wall("pull", 0.42, 0.15, precompression=0, joint=joint)
        runs.append(run(wall, pushover=0.02))
    peaks = [one.series["top_force_n"].abs().max() for one in runs]
    assert peaks[1] == peaks[2]
    assert ["apex" in codes_of(one) for one in runs] == [False, True, True]


def test_the_command_line_warns_alike(tmp_path, capsys):
    wall = wall_file(tmp_path / "w.py", f"Wall.from_dict({DRY.as_dict()!r})")
    words = f"{wall} --free-vibration --rest 0.1 --no-pictures --out {tmp_path}"
    assert run_reference(f"{words}/a.h5".split()) == 0
    assert capsys.readouterr().err.splitlines() == [
        f"warning: {text}" for text in warnings_of(read_history(tmp_path / "a.h5"))
    ]
    assert run_reference(f"{words}/b.h5 --quiet --members 2".split()) == 0
    assert "warning: member of seed 2: energy balance error 3" in capsys.readouterr().err


def test_a_smaller_step_balances_the_energy():
    """The error of this course is one of the time step, and falls as its square."""
    coarse, fine = (energy_error_of(run(DRY, dt=step, **FREE)) for step in (2e-5, 1e-5))
    assert coarse < 0.01 and coarse / fine == approx(4, rel=0.5)


def test_warnings_before_the_run_are_among_them():
    pier = Wall("pier", 0.45, 0.3)
    with pytest.warns(RunWarning, match="deformable with brittle joints"):
        history = run(
            pier, harmonic=(0.05, 0.01), cycles=1, rest=0, bricks="deformable", contacts="gauss"
        )
    assert codes_of(history)[0] == "deformable_bricks"


def test_energy_is_balanced_where_bonds_snap_back():
    """The fracture energy in mode II is below cohesion² / shear stiffness, 361 J/m2."""
    joint = Joint(
        3.109e9,
        1.2436e9,
        0.1846,
        73300.0,
        669900.0,
        mode_i_fracture_energy=11.82,
        mode_ii_fracture_energy=213.5,
    )
    wall = Wall(
        "soft",
        1.83977,
        1.0932,
        precompression=994780.0,
        joint=joint,
        brick=Brick(0.3752, 0.1822, 0.1551, 686.0, 3.155e9, 2.551e9),
    )
    assert energy_error_of(run(wall, harmonic=(0.2079, 0.1262), cycles=2, rest=0.1, cells=1)) < 2e-3


@pytest.mark.parametrize(
    ("broken", "unbalanced", "words"),
    [
        (0, 1e-6, []),
        (0, 2e-5, ["at rest"]),
        (0, float("nan"), []),  # interrupted before the static stage ended
        (1, 1.0, ["1 contact points failed", "at rest"]),
    ],
)
def test_an_odd_static_stage_is_reported(broken, unbalanced, words):
    history = SimpleNamespace(
        static={"broken_joints": broken, "unbalanced_force": unbalanced}, series=()
    )
    warnings = static_warnings(history)
    assert len(warnings) == len(words)
    assert all(word in warning for word, warning in zip(words, warnings))
