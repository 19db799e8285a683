"""Warnings of a run: the same from the command line and from Python."""

import json
import pickle
from types import SimpleNamespace

import pytest
from conftest import wall_file

import damage
from damage.history.reader import read_history
from damage.measure.energy import energy_error_of
from damage.measure.warnings import static_warnings
from damage.reference.session import run_reference

DRY = damage.Wall(
    "course",
    0.675,
    0.075,
    precompression=0.0,
    joint=damage.Joint(tensile_strength=0.0, cohesion=0.0),
)
"""A dry course of three bricks, which bounce and slide within nine steps a period."""
FREE = {"free_vibration": True, "rest": 0.1}
ENERGY = "energy balance error 3.* % of the input, expected up to 1 %"


def codes_of(history):
    return [one.code for one in damage.warnings_of(history)]


def test_python_warns_of_an_energy_balance_error_where_it_was_called(tmp_path):
    with pytest.warns(damage.RunWarning, match=ENERGY) as caught:
        history = damage.run(DRY, **FREE, out=tmp_path / "a.h5")
    assert {one.filename for one in caught} == {__file__}
    assert (
        [str(one.message) for one in caught]
        == damage.warnings_of(history)
        == damage.warnings_of(read_history(tmp_path / "a.h5"))
    )
    assert "energy_balance" in codes_of(history)
    assert {type(text) for text in json.loads(json.dumps(damage.warnings_of(history)))} == {str}
    assert [
        one.code for one in pickle.loads(pickle.dumps(damage.warnings_of(history)))
    ] == codes_of(history)


def test_the_command_line_warns_alike(tmp_path, capsys):
    wall = wall_file(tmp_path / "w.py", f"Wall.from_dict({DRY.as_dict()!r})")
    words = [str(wall), "--free-vibration", "--rest", "0.1", "--no-pictures"]
    assert run_reference([*words, "--out", str(tmp_path / "a.h5")]) == 0
    assert capsys.readouterr().err.splitlines() == [
        f"warning: {text}" for text in damage.warnings_of(read_history(tmp_path / "a.h5"))
    ]
    assert (
        run_reference([*words, "--quiet", "--members", "2", "--out", str(tmp_path / "b.h5")]) == 0
    )
    assert "warning: member of seed 2: energy balance error 3" in capsys.readouterr().err


def test_a_smaller_step_balances_the_energy():
    """The error of this course is one of the time step, and falls as its square."""
    coarse, fine = (energy_error_of(damage.run(DRY, dt=step, **FREE)) for step in (2e-5, 1e-5))
    assert coarse < 0.01 and coarse / fine == pytest.approx(4, rel=0.5)
    assert not [
        text for text in damage.warnings_of(damage.run(DRY, dt=1e-5, **FREE)) if "energy" in text
    ]


def test_warnings_before_the_run_are_among_them(capsys):
    pier = damage.Wall("pier", 0.45, 0.3)
    with pytest.warns(damage.RunWarning, match="deformable with brittle joints"):
        history = damage.run(
            pier, harmonic=(0.05, 0.01), cycles=1, rest=0, bricks="deformable", contacts="gauss"
        )
    assert any("deformable with brittle joints" in text for text in damage.warnings_of(history))
    assert codes_of(history)[0] == "deformable_bricks"
    assert "warning" not in capsys.readouterr().err


def test_energy_is_balanced_where_bonds_snap_back():
    """The fracture energy in mode II is below cohesion² / shear stiffness, 361 J/m2."""
    joint = damage.Joint(
        3.109e9,
        1.2436e9,
        0.1846,
        73300.0,
        669900.0,
        mode_i_fracture_energy=11.82,
        mode_ii_fracture_energy=213.5,
    )
    wall = damage.Wall(
        "soft",
        1.83977,
        1.0932,
        precompression=994780.0,
        joint=joint,
        brick=damage.Brick(0.3752, 0.1822, 0.1551, 686.0, 3.155e9, 2.551e9),
    )
    assert (
        energy_error_of(damage.run(wall, harmonic=(0.2079, 0.1262), cycles=2, rest=0.1, cells=1))
        < 2e-3
    )


@pytest.mark.parametrize(
    ("broken", "unbalanced", "words"),
    [
        (0, 1e-6, []),
        (3, 1e-6, ["3 contact points failed"]),
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
