"""Openings in whole courses: their height first, then their level; what differs from what is given
is said."""

from dataclasses import replace

import numpy as np
import pytest

from damage import Floor, InputError, ModelOptions, read_history
from damage.__main__ import main
from damage.measure.summary import summarise
from damage.wall.as_built import describe_lintels, describe_openings, warn_of_courses, warn_of_slabs
from damage.wall.layout import lay_out
from damage.wall.parameters import Brick, Lintel, Opening, Wall, nearest
from damage.wall.plan import plan_of

BLOCKS = Wall("blocks", 3.6, 2.8, (Opening(1.2, 1.2, 0.6, 0.9),), 0.1e6, brick=Brick(0.4, 0.2, 0.2))


def with_opening(height, sill):
    return replace(BLOCKS, openings=(Opening(1.2, 1.2, height, sill),))


def test_openings_all_over_are_as_high_as_given_and_near_their_place():
    """500 openings: the nearest number of courses, each edge within three quarters of one, inside
    the wall; where both edges by themselves gave that number, they are what they were."""
    rng = np.random.default_rng(1)
    for _ in range(500):
        course, height, sill = rng.uniform(0.05, 0.3), rng.uniform(0.3, 1.5), rng.uniform(0, 1.2)
        try:
            wall = Wall("w", 3.6, 2.8, (Opening(1.2, 1.2, height, sill),), brick=Brick(0.4, course))
        except InputError:  # not a bearing for its lintel
            continue
        first, above = wall.opening_courses(wall.openings[0])
        assert above - first == nearest(height / course) and 0 <= first and above <= wall.courses
        assert (
            max(abs(first * course - sill), abs(above * course - sill - height))
            < 0.75 * course + 1e-9
        )
        alone = round(sill / course), round((sill + height) / course)
        assert alone == (first, above) or alone[1] - alone[0] != above - first


def test_lines_and_warnings_of_what_is_built():
    assert describe_openings(plan_of(BLOCKS)) == [
        "opening 1 built 1.2 x 0.6 m, z = 1 to 1.6 m; given 1.2 x 0.6 m, z = 0.9 to 1.5 m"
    ]
    (line,) = warn_of_courses(plan_of(BLOCKS))
    assert line.startswith(
        "whole courses of 0.2 m leave differences above 0.25 of a course or 5 %: opening 1 built"
    )
    near = plan_of(with_opening(0.61, 0.82))  # 2 and 3 cm from where they are
    assert len(describe_openings(near)) == 1 and warn_of_courses(near) == []
    exact = with_opening(0.6, 0.8)
    assert describe_openings(plan_of(exact)) == warn_of_courses(plan_of(exact)) == []
    # 7 % in height, 2 cm at both edges
    (line,) = warn_of_courses(plan_of(with_opening(0.56, 0.82)))
    assert "given 1.2 x 0.56 m" in line
    (line,) = warn_of_courses(plan_of(replace(exact, height=2.89, floors=(Floor(2.47, 500.0),))))
    assert (
        "wall built 2.8 m high, z = 0 to 2.8 m; given 2.89 m" in line
        and "floor 1 built 2.4 m high" in line
    )


@pytest.mark.parametrize(
    "level, left, through",
    [(1.0, 0.0, True), (1.4, 0.0, True), (1.6, 0.0, False), (0.8, 0.0, False), (1.0, 2.4, False)],
)
def test_a_slab_through_an_opening_is_said(level, left, through):
    """The opening is x = 1.2 to 2.4, z = 0.8 to 1.4 m; the slab is 0.2 m deep, below its level."""
    wall = replace(
        with_opening(0.6, 0.8), floors=(Floor(level, 500.0, left=left, kind="concrete", depth=0.2),)
    )
    found = warn_of_slabs(plan_of(wall))
    assert len(found) == through and all(
        line.startswith(
            f"the concrete floor at {level:g} m (x = {left:g} to 3.6 m) runs through opening 1 (x ="
            " 1.2 to 2.4 m, z = 0.8 to 1.4 m)"
        )
        for line in found
    )


def test_runs_modes_and_pictures_say_it(tmp_path, capsys):
    path = tmp_path / "blocks.toml"
    path.write_text(
        'name = "blocks"\nlength = 3.6\nheight = 2.8\nprecompression = 0.1e6\n'
        "brick = { length = 0.4, height = 0.2, thickness = 0.2 }\n"
        "[[openings]]\nleft = 1.2\nwidth = 1.2\nheight = 0.6\nsill = 0.9\n"
    )
    built = "opening 1 built 1.2 x 0.6 m, z = 1 to 1.6 m; given"
    run = "reference {0} --harmonic 0.05 0.01 --cycles 1 --rest 0 --no-pictures --out {1}/a.h5"
    for words in ("modes {0}", "draw {0} --out {1}/a.png", run):
        assert main(words.format(path, tmp_path).split()) == 0
        said = capsys.readouterr()
        assert (
            "warning: whole courses of 0.2 m leave differences above 0.25 of a course or 5 %:"
            f" {built}" in said.err
        )
        assert words.startswith("draw") or any(
            line.startswith(built) for line in said.out.splitlines()
        )
    assert any(built in line for line in summarise(read_history(tmp_path / "a.h5"))["warnings"])


def test_no_wall_that_ships_is_built_otherwise(shipped_wall):
    plan = plan_of(shipped_wall)
    assert describe_openings(plan) == warn_of_courses(plan) == warn_of_slabs(plan) == []


# --- lintels --------------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", ["concrete", "steel", "timber", "arch", "courses"])
def test_a_kind_of_lintel_by_option_is_that_of_a_wall_file(kind):
    wall = replace(with_opening(0.6, 0.8), lintel="courses")
    asked = lay_out(wall, ModelOptions(lintel=kind))
    given = lay_out(replace(wall, lintel=kind))
    for name in ("x", "z", "first", "second", "elastic", "normal_stiffness"):
        assert np.array_equal(getattr(asked.contacts, name), getattr(given.contacts, name)), name
    assert np.array_equal(asked.bodies.mass, given.bodies.mass)
    assert describe_lintels(asked.plan) == describe_lintels(given.plan)
    assert len(describe_lintels(asked.plan)) == (kind != "courses")


def test_a_kind_by_option_takes_the_place_of_all_others():
    wall = Wall(
        "w", 4.0, 2.4, (Opening(0.5, 0.8, 1.2, lintel=Lintel("steel")), Opening(2.4, 0.8, 1.2))
    )
    layouts = lay_out(wall), lay_out(wall, ModelOptions(lintel="timber"))
    kinds = [[line.split()[0] for line in describe_lintels(layout.plan)] for layout in layouts]
    assert kinds == [["steel", "concrete"], ["timber", "timber"]]
