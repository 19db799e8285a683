"""Joint properties from couplets and triplets: a made-up line by hand, and virtual tests whose
inputs come back."""

import json
from dataclasses import replace

import numpy as np
import pytest
from conftest import REPOSITORY, refused_with, written
from pytest import approx

import damage
from damage.applications.cracks.calibrate import calibrated, describe, read_tests, rows_of
from damage.wall.file import load_wall

TRIPLET, COUPLET = (
    load_wall(REPOSITORY / "walls" / f"{name}.toml") for name in ("triplet", "couplet")
)
HEAD = "specimen,normal_stress_mpa,opening_mm,shear_stress_mpa,slip_mm\n"


def test_virtual_tests_give_their_inputs_back(tmp_path, output_of):
    """Between two samples the shear stress grows by 2.3 kPa, by which a peak can be missed."""
    for stress in (0.2e6, 0.6e6, 1e6):
        damage.run(
            replace(TRIPLET, precompression=stress),
            pushover=0.06,
            speed=2e-5,
            out=tmp_path / f"t{stress:g}.h5",
        )
    damage.run(COUPLET, pushover=0.004, speed=2e-5, contacts="gauss", out=tmp_path / "c.h5")
    histories = sorted(tmp_path.glob("*.h5"))
    table = tmp_path / "tests.csv"
    said = output_of("calibrate", *histories, "--csv", table)
    found = json.loads(output_of("calibrate", table, "--json"))
    joint = TRIPLET.joint
    for name, expected, rel in (
        ("normal_stiffness", joint.normal_stiffness, 0.01),
        ("shear_stiffness", joint.shear_stiffness, 0.01),
        ("cohesion", joint.cohesion, 0.013),
        ("friction", np.tan(joint.friction_angle), 0.01),
    ):
        assert found[name]["value"] == approx(expected, rel=rel), name
    assert found["shear_stiffness"]["specimens"] == found["cohesion"]["specimens"] == 3
    assert "EN 1052-3 asks for 3 under each of 3" in found["notes"][0]
    # what is printed is a wall file's
    wall = f'name = "a"\nlength = 1.0\nheight = 1.0\n{said}'
    read = load_wall(written(tmp_path / "a.toml", wall)).joint
    assert read.cohesion == approx(joint.cohesion, rel=0.013)


def test_a_line_by_hand(tmp_path):
    """Nine peaks at 0.2 + 0.6 sigma, of a level 0.01 MPa off by turns: least squares by hand."""
    stresses = np.repeat([0.2, 0.6, 1.0], 3)
    off = np.tile([-0.01, 0.0, 0.01], 3)
    shear = 0.2 + 0.6 * stresses + off
    rows = [
        f"t{k},{-sigma},,{share * tau},{share * tau / 50}"
        for k, (sigma, tau) in enumerate(zip(stresses, shear))
        for share in (0, 0.2, 0.4, 1.0, 0.7)
    ]
    pressed = [
        f"c{k},{-share},{-share / (90 + 10 * k)},," for k in (0, 1, 2) for share in (0, 1, 2, 5)
    ]
    tests = read_tests(written(tmp_path / "a.csv", HEAD + "\n".join(rows + pressed)))
    found = calibrated(tests)
    error = np.sqrt(6e-4 / 7)  # of one peak
    spread = np.sum((stresses - 0.6) ** 2)
    assert found["friction"] == approx(
        {
            "value": 0.6,
            "standard_error": error / np.sqrt(spread),
            "scatter": found["cohesion"]["scatter"],
            "specimens": 9,
            "characteristic": 0.48,
        }
    )
    of_line = error * np.sqrt(1 / 9 + 0.36 / spread)
    assert found["cohesion"]["standard_error"] == approx(1e6 * of_line)
    assert found["cohesion"]["scatter"] == approx(np.sqrt(np.sum((off / (shear - off)) ** 2) / 7))
    assert found["shear_stiffness"]["value"] == approx(50e9)
    assert found["normal_stiffness"] == approx(
        {"value": 100e9, "standard_error": 10e9 / np.sqrt(3), "scatter": 0.1, "specimens": 3}
    )
    assert found["notes"] == [] and "cohesion = 2e+05 " in describe(found)


@pytest.mark.parametrize(
    ("rows", "words"),
    [
        ("t1,-0.2,,0.3,\nt2,-0.2,,0.31,\nt3,-0.2,,0.31,", "3 triplets under 1 precompression"),
        ("t1,0.2,,0.3,", "line 2: normal_stress_mpa above zero of a triplet"),
        ("t1,-0.2,,,", "line 2: expected opening_mm of a couplet, or shear_stress_mpa"),
        ("c1,-0.05,0,,\nc1,-0.9,-1,,", "specimen c1: no rows between 0.1 and 0.5 of its largest"),
        ("c1,-0.6,0,,\nc1,-0.7,-1,,\nc1,-0.9,-2,,", "0.9, the first row at 0.67 of it; expected"),
        # a gauge that does not resolve the opening ended in a traceback
        (
            "c1,0,0,,\nc1,-0.3,0,,\nc1,-0.4,0,,\nc1,-0.9,0,,",
            "specimen c1: two rows .* expected two or more whose opening_mm differs",
        ),
        (",-0.1,0,,", "line 2: no specimen"),
    ],
)
def test_tests_that_say_too_little(tmp_path, rows, words):
    path = written(tmp_path / "a.csv", HEAD + rows)
    refused_with(words, lambda: calibrated(read_tests(path)))


@pytest.mark.parametrize(
    ("stress", "slip", "line", "notes"),
    [
        (1.0, 1.0, (0.22, 0.7), []),
        # kPa, and m, under the columns of MPa and mm
        (1e3, 1.0, (0.22, 0.7), ["shear_stiffness is 10 times", "cohesion is 22 times"]),
        (1.0, 1e-3, (0.22, 0.7), ["shear_stiffness is 10 times the largest plausible value, 1e13"]),
        # loads of the specimens swapped
        (1.0, 1.0, (1.06, -0.7), ["the line has a negative friction"]),
        (1.0, 1.0, (-0.02, 0.7), ["the line has a negative cohesion"]),
        (1.0, 1.0, (0.1, 3.0), ["friction is 1.2 times the largest plausible value, 2.57215 [-]"]),
    ],
)
def test_values_that_no_joint_has_are_named(tmp_path, stress, slip, line, notes):
    """A shear stiffness of 1e11 Pa/m and three triplets at 0.2, 0.6 and 1 MPa."""
    rows = [
        f"t{load},{-load * stress},,{share * peak * stress},{share * peak * slip / 100}"
        for load in (0.2, 0.6, 1.0)
        for peak in [line[0] + line[1] * load]
        for share in (0, 0.2, 0.4, 1)
    ]
    tests = read_tests(written(tmp_path / "a.csv", HEAD + "\n".join(rows)))
    named = [note for note in calibrated(tests)["notes"] if "EN 1052-3" not in note]
    assert len(named) == len(notes)
    assert all(note.startswith(start) for note, start in zip(named, notes)), named


def test_a_first_row_under_load_is_no_zero(tmp_path):
    """The elastic range lies between 0.1 and 0.5 of 2 MPa, in which the slope is 0.1 MPa per 1e-4
    mm; counted from the first row, at 0.4 MPa, it would lie between 0.56 and 1.2 MPa."""
    points = [(0.4, 4e-4), (0.6, 6e-4), (0.9, 9e-4), (1.1, 2e-3), (2.0, 8e-3)]
    rows = "\n".join(f"c1,{-stress},{-opening},," for stress, opening in points)
    tests = read_tests(written(tmp_path / "a.csv", HEAD + rows))
    assert calibrated(tests)["normal_stiffness"]["value"] == approx(1e12)


def test_the_tests_of_the_guide(tmp_path, output_of):
    guide = (REPOSITORY / "docs" / "guides" / "tested-wall.md").read_text(encoding="utf-8")
    table = written(tmp_path / "a.csv", HEAD + guide.partition(HEAD)[2].partition("```")[0])
    found = json.loads(output_of("calibrate", table, "--json"))
    # by hand: 0.4 MPa over 0.4 um; 0.08 MPa over 0.2 um; 0.36, 0.61, 0.88 MPa at 0.2, 0.6, 1 MPa
    for name, value in (
        ("normal_stiffness", 1e12),
        ("shear_stiffness", 4e11),
        ("friction", 0.65),
        ("cohesion", 1.85e6 / 3 - 0.39e6),
    ):
        assert found[name]["value"] == approx(value), name


def test_a_specimen_of_two_files(tmp_path, error_of):
    path = written(tmp_path / "a.csv", HEAD + "c1,-0.1,0,,")
    assert "specimen c1 is in two files" in error_of("calibrate", path, path)


def test_a_wall_is_no_specimen(still_history):
    refused_with("give one of --pushover", rows_of, still_history)
