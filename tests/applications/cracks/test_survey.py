"""Surveys: straight lines on stepped paths, what a survey says of itself, its distance from
simulated patterns."""

import json
import re

import numpy as np
import pytest
from conftest import refused_with, written
from numpy.testing import assert_allclose
from small_history import make_history, small_layout

from damage.applications.cracks.crack_file import read_cracks, write_cracks
from damage.applications.cracks.crack_paths import crack_paths
from damage.applications.cracks.survey import beside, distance, read_survey, visible
from damage.errors import InputError
from damage.wall.layout import lay_out
from damage.wall.parameters import Opening, Wall

HEADER = "crack,point,x_m,z_m,width_mm,mode,offset,detection_limit_mm,width_error_mm\n"
LAYOUT = lay_out(Wall("w", 2.25, 1.5))
"""Bricks of 0.225 x 0.075 m."""
WINDOW = lay_out(Wall("window", 2.25, 1.5, [Opening(0.7875, 0.675, 0.6, 0.45)], lintel="courses"))


def survey(tmp_path, *rows, wall=LAYOUT, header=HEADER):
    path = written(tmp_path / "survey.csv", header + "\n".join(rows) + "\n")
    return read_survey(path, wall)


def line(x, z, x_end, z_end, width=1.0, mode="", offset="", limit="0.1", error="0.05", crack="A"):
    return (
        f"{crack},1,{x},{z},{width},{mode},{offset},{limit},{error}",
        f"{crack},2,{x_end},{z_end},,,,,",
    )


# --- on the joints --------------------------------------------------------------------------------


def test_a_diagonal_becomes_the_stair_that_a_surveyor_would_draw():
    """Half a brick along, one course up: the stair has as many head joints as bed joints of half a
    brick."""
    stair = np.array([[0.45, 0.3], [0.45 + 4 * 0.1125, 0.3 + 4 * 0.075]])
    paths = crack_paths([stair], LAYOUT)
    of_paths = LAYOUT.contacts.upright[paths.table["joint"]]
    length = paths.table["length_m"].to_numpy()
    assert paths.share == 1.0 and paths.apart_m < 0.1125 / 2
    assert length[of_paths].sum() == pytest.approx(4 * 0.075) and length[
        ~of_paths
    ].sum() == pytest.approx(4 * 0.1125)


def test_a_vertical_line_steps_from_head_joint_to_head_joint(tmp_path):
    found = survey(tmp_path, *line(1.0, 0.3, 1.0, 0.9, width=0.8))
    head = LAYOUT.contacts.upright[found.table["joint"]]
    assert found.share_on_joints == 1.0 and head.sum() == 8
    assert_allclose(found.width_m[found.table["joint"]], 0.8e-3)
    assert found.width_m.shape == (LAYOUT.n_joints,)


def test_a_line_along_joints_stays_on_them_with_noise_of_drawing():
    """As `--cracked` took them piece by piece: the joints of the stair alone."""
    corners = np.array(
        [
            [0.225, 0.075],
            [0.3375, 0.075],
            [0.3375, 0.15],
            [0.45, 0.15],
            [0.45, 0.225],
            [0.675, 0.225],
        ]
    )
    points = np.concatenate(
        [np.linspace(a, b, 8, endpoint=False) for a, b in zip(corners, corners[1:])]
        + [corners[-1:]]
    )
    noisy = points + np.random.default_rng(7).normal(0, 2e-3, points.shape)
    tables = [
        crack_paths(np.stack([drawn[:-1], drawn[1:]], axis=1), LAYOUT).table
        for drawn in (corners, noisy)
    ]
    assert sorted(tables[0]["joint"]) == sorted(tables[1]["joint"])
    assert tables[0]["length_m"].sum() == pytest.approx(np.abs(np.diff(corners, axis=0)).sum())


def test_a_line_across_a_window_has_no_joints_beside_it():
    """From pier to pier through the window: its part over the opening is on no joint."""
    paths = crack_paths([np.array([[0.3, 0.72], [1.9, 0.78]])], WINDOW)
    x = WINDOW.contacts.x[paths.table["joint"]]
    assert paths.share == pytest.approx(1 - 0.675 / 1.6, abs=0.12)
    assert not ((x > 0.7875 + 0.1125) & (x < 1.4625 - 0.1125)).any()


def test_a_survey_beside_the_wall_is_refused(tmp_path):
    with pytest.raises(
        InputError, match=r"survey.csv: 0.\d\d of 1.60 m .* \([0-4]\d? %\); expected at least 50 %"
    ):
        survey(tmp_path, *line(1.8, 0.4, 3.4, 0.4))


# --- what a survey says of itself -----------------------------------------------------------------

AREAS = "area,1,0,0.9,,none,,,", "area,2,2.25,1.5,,none,,,"


def bed_crack(tmp_path, width):
    """The survey of a crack of a bed joint, in a file of the first columns alone."""
    rows = f"1,1,0,0.15,{width}", "1,2,0.45,0.15,"
    return survey(tmp_path, *rows, header="crack,point,x_m,z_m,width_mm\n")


def test_a_file_of_the_first_columns_is_read_and_says_what_is_assumed(tmp_path):
    found = bed_crack(tmp_path, 0.2)
    assert (found.detection_limit_m, found.width_error_m) == (1e-4, 5e-5)
    assert found.looked_at.all() and len(found.notes) >= 3
    assert np.isnan(found.pattern.stretches["offset"]).all()
    said = found.as_dict()
    assert said["cracks"] == 1 and said["psi"] == pytest.approx(2 * 0.2**0.3)
    assert bed_crack(tmp_path, 0.03).detection_limit_m == pytest.approx(3e-5)
    assert bed_crack(tmp_path, 0).detection_limit_m == 1e-4


def test_new_columns_are_read_and_written_back(tmp_path):
    found = survey(
        tmp_path, *line(0, 0.15, 0.45, 0.15, offset="no", limit=0.05, error=0.02), *AREAS
    )
    assert (found.detection_limit_m, found.width_error_m) == (0.05e-3, 0.02e-3)
    assert_allclose(found.pattern.clear, [[0, 0.9, 2.25, 1.5]])
    z = LAYOUT.contacts.z[: LAYOUT.n_joints]
    assert (
        found.looked_at[(z > 0.9) & (z < 1.5)].all()
        and not found.looked_at[(z > 0.2) & (z < 0.8)].any()
    )
    assert found.pattern.stretches["offset"].tolist() == [0.0] and found.pattern.stretches[
        "mode"
    ].tolist() == ["tension"]
    write_cracks(tmp_path / "again.csv", read_cracks(tmp_path / "survey.csv"))
    again = read_survey(tmp_path / "again.csv", LAYOUT)
    names_file = {"file": "", "sha256": ""}
    assert again.as_dict() | names_file == found.as_dict() | names_file
    assert_allclose(again.pattern.clear, found.pattern.clear)


@pytest.mark.parametrize(
    "text, said",
    [
        (
            "crack,point,x_m,z_m,width_mm\nA,1,0,0.15,0,4\nA,2,0.45,0.15,\n",
            (
                "line 2: 6 cells; expected 5, crack, point, x_m, z_m, width_mm; decimal commas need"
                " semicolons"
            ),
        ),
        (
            "crack;point;x_m;z_m;width_mm\nA;1;0;0,15;0.4\nA;2;0,45;0,15;\n",
            "line 2: a number with a decimal point in a file with decimal commas",
        ),
        (
            'crack,point,x_m,z_m,width_mm\nA,1,0,"1,250","0,4"\nA,2,1,"1,250",\n',
            "line 2: z_m has a number in quotes whose comma may be of decimals or of thousands",
        ),
        *(
            (
                f"crack,point,x_m,z_m,width_mm\nA,1,0,0.15,{width}\nA,2,0.45,0.15,\n",
                (
                    f"line 2: width_mm = '{width}': expected a finite number, or nothing where it"
                    " is unknown; of a bound or a range"
                ),
            )
            for width in ("<0.1", "0.1-0.3")
        ),
    ],
)
def test_what_may_be_two_numbers_is_refused(tmp_path, text, said):
    refused_with(re.escape(said), read_survey, written(tmp_path / "survey.csv", text), LAYOUT)


BAD = {
    "one-corner": (AREAS[:1], "line 2: mode = 'none': expected two rows an area"),
    "two-limits": (
        (*line(0, 0.15, 0.45, 0.15, limit=0.1), *line(0, 0.3, 0.45, 0.3, limit=0.2, crack="B")),
        "line 4: detection_limit_mm = 0.2, but 0.1 in line 2",
    ),
    "offset-word": (
        line(0, 0.15, 0.45, 0.15, offset="maybe"),
        "line 2: offset = 'maybe': expected one of yes, no",
    ),
    "limit-above": (
        line(0, 0.15, 0.45, 0.15, 0.4, limit=5),
        "detection_limit_mm = 5, but the widest crack has 0.4 mm",
    ),
    "there-twice": (
        (*line(0, 0.15, 0.45, 0.15), *line(0.45, 0.15, 0, 0.15, crack="B")),
        r"the part of crack B from \(0.45, 0.15\) to \(0, 0.15\) m is there twice",
    ),
    "crack-in-area": (
        (*line(0, 0.975, 0.45, 0.975), *AREAS),
        "0.45 m of cracks lie in areas of mode none",
    ),
}


@pytest.mark.parametrize("rows, said", BAD.values(), ids=BAD)
def test_bad_surveys_are_one_line(tmp_path, rows, said):
    refused_with(said, survey, tmp_path, *rows)


# --- beside a simulated pattern -------------------------------------------------------------------


def pattern(found, factor=1.0, shift=0):
    """Opening and offset of the joints of a survey, by their index moved on, times a factor."""
    return np.roll(found.width_m, shift) * factor, np.zeros(LAYOUT.n_joints)


def test_the_distance_is_zero_for_the_survey_itself_and_one_for_another_place(tmp_path):
    found = survey(tmp_path, *line(0, 0.15, 0.45, 0.15, error=0))
    assert distance(found, *pattern(found), LAYOUT) == 0.0
    assert distance(found, *np.zeros((2, LAYOUT.n_joints)), LAYOUT) == 1.0
    far = np.where(LAYOUT.contacts.z[: LAYOUT.n_joints] == 1.2, 1e-3, 0.0)
    assert distance(found, far, 0 * far, LAYOUT) == 1.0
    assert distance(found, *pattern(found, 2.0), LAYOUT) == pytest.approx(np.sqrt(1 / 5))


def test_errors_of_widths_and_what_is_not_visible_do_not_count(tmp_path):
    found = survey(tmp_path, *line(0, 0.15, 0.45, 0.15, width=0.3, error=0.05), *AREAS)
    assert distance(found, *pattern(found, 0.34 / 0.3), LAYOUT) == 0.0
    assert distance(found, *pattern(found, 0.40 / 0.3), LAYOUT) > 0.1
    opening, offset = pattern(found)
    z = LAYOUT.contacts.z[: LAYOUT.n_joints]
    opening[z == 1.2] = 0.09e-3  # in the area without a crack, below the limit
    opening[(z > 0.3) & (z < 0.85)] = 1e-3  # where nobody looked
    assert distance(found, opening, offset, LAYOUT) == 0.0
    opening[z == 1.2] = 0.11e-3
    assert distance(found, opening, offset, LAYOUT) > 0.0
    assert set(np.flatnonzero(visible(found, opening, offset))) == set(
        np.flatnonzero((opening > 0) & ((z == 1.2) | (found.width_m > 0)))
    )


def test_an_offset_that_was_seen_or_not_tells_patterns_of_one_width_apart(tmp_path):
    slid, opened = (
        survey(tmp_path, *line(0, 0.15, 0.45, 0.15, offset=word)) for word in ("yes", "no")
    )
    width = slid.width_m
    assert distance(slid, width, 0 * width, LAYOUT) == pytest.approx(np.sqrt(0.5))
    assert distance(slid, 0.6 * width, 0.8 * width, LAYOUT) == 0.0
    assert distance(opened, width, 0 * width, LAYOUT) == 0.0
    assert distance(opened, 0.6 * width, 0.8 * width, LAYOUT) == pytest.approx(np.sqrt(0.5))


def test_compare_takes_a_survey_beside_a_run(tmp_path, output_of):
    """A bed joint opened by 0.3 mm at the end of the run, surveyed with 0.25 mm over the left two
    thirds."""
    layout = small_layout()
    joints = np.flatnonzero((layout.contacts.z == 0.15) & ~layout.contacts.upright)
    run = make_history(tmp_path / "run.h5", layout, opening={int(joint): 3e-4 for joint in joints})
    path = written(
        tmp_path / "survey.csv", "crack,point,x_m,z_m,width_mm\n1,1,0,0.15,0.25\n1,2,0.675,0.15,\n"
    )
    found = json.loads(output_of("compare", run.path, path, "--json"))[0]
    assert found["widths"]["max_width_mm"] == pytest.approx([0.25, 0.3])
    assert found["widths"]["joints_m"] == pytest.approx([0.675, 0.9]) and found["widths"][
        "cracks"
    ] == [1, 1]
    assert found["positions"]["of_survey"] == 1.0 and found["positions"]["of_run"] == pytest.approx(
        1.0, abs=0.13
    )
    assert 0.7 < found["pattern"]["fss"] < 1.0 and 0 < found["distance"] < 0.4
    nothing = beside(read_survey(path, layout), *np.zeros((2, layout.n_joints)), layout)
    assert nothing["positions"]["of_run"] is None
