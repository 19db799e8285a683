"""Openings in whole courses: their height first, then their level; what differs from what is given
is said.  Lintels: a beam's deflection, places, data, words; the share of joints that courses in
their place keep elastic."""

import json
import re
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from pytest import approx
from small_history import make_history

from damage import (
    Brick,
    Floor,
    InputError,
    Joint,
    Lintel,
    ModelOptions,
    Opening,
    Wall,
    read_history,
)
from damage.__main__ import main
from damage.history.in_memory import HistoryInMemory
from damage.linear.modes import static_displacement
from damage.measure.summary import summarise
from damage.measure.tables import summary_row
from damage.run.report import describe
from damage.units import GRAVITY
from damage.wall.as_built import (
    describe_lintels,
    describe_openings,
    replaced_lintels,
    warn_of_courses,
    warn_of_slabs,
)
from damage.wall.file import wall_from
from damage.wall.geometry import body_table, joint_table
from damage.wall.kinds import ARCH_COURSE, CUT, HEAD, LINTEL_COURSE
from damage.wall.layout import lay_out
from damage.wall.lintels import LARGE_SHARE, USUAL, elastic_share, warn_of_share
from damage.wall.parameters import nearest
from damage.wall.plan import plan_of

BLOCKS = Wall("blocks", 3.6, 2.8, (Opening(1.2, 1.2, 0.6, 0.9),), 0.1e6, brick=Brick(0.4, 0.2, 0.2))


def with_opening(height, sill):
    return replace(BLOCKS, openings=(Opening(1.2, 1.2, height, sill),))


def test_openings_all_over_are_as_high_as_given_and_near_their_place():
    """500 openings: the nearest number of courses, each edge within three quarters of one, inside
    the wall; where both edges by themselves gave that number, they are what they were."""
    rng = np.random.default_rng(1)
    for _ in range(500):
        course = rng.uniform(0.05, 0.3)
        height = rng.uniform(0.3, 1.5)
        sill = rng.uniform(0, 1.2)
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


# --- lintels of their own -------------------------------------------------------------------------

BRICK = Brick(length=0.2, height=0.1, thickness=0.1, density=2000.0)


def wall(openings, length=2.4, height=1.2, **more):
    return Wall("w", length, height, openings, precompression=0.0, brick=BRICK, **more)


DOOR = Opening(0.8, 0.8, 0.8)


def over_two_piers(lintel, span=2.0):
    """A wall whose lintel lies on two piers of half a brick and ends with them, in joints so soft
    that it turns freely on them."""
    return lay_out(
        wall(
            (Opening(0.1, span - 0.1, 0.3, 0.0, lintel),),
            length=span + 0.1,
            height=0.3 + lintel.height,
            joint=SOFT,
        )
    )


SOFT = Joint(normal_stiffness=1e7, shear_stiffness=1e7)


class TestBeam:
    """Its weight on two bearings: Timoshenko's beam of span L between their middles, a = 0.05 m
    beyond each of them."""

    @pytest.mark.parametrize(
        "lintel",
        [
            Lintel("timber", 0.2),
            Lintel("concrete", 0.2),
            Lintel("steel", 0.1, width=0.01),
            Lintel("stone", 0.3, modulus=2e10),
        ],
        ids=lambda lintel: lintel.kind,
    )
    @pytest.mark.parametrize("span", [2.0, 0.8])
    def test_its_deflection_is_that_of_beam_theory(self, lintel, span):
        layout = over_two_piers(lintel, span)
        middle, bearing = (below(layout, x) for x in (span / 2 + 0.05, 0.05))
        assert_allclose(middle - bearing, deflection(lintel, span, 0.05), rtol=0.03)


def below(layout, x):
    """How far the lintel lies below its place at x [m] under its weight."""
    bodies = layout.bodies
    part = np.flatnonzero(
        (bodies.course == LINTEL_COURSE) & (np.abs(bodies.x - x) <= bodies.length / 2 + 1e-9)
    )[0]
    _, up, turn = static_displacement(layout)[part]
    return -up - turn * (x - bodies.x[part])


def deflection(lintel, span, beyond):
    """Deflection [m] of the middle below the bearings by the beam's weight."""
    width = lintel.width or BRICK.thickness
    young = lintel.value_of("modulus")
    density = lintel.value_of("density")
    load = density * GRAVITY * width * lintel.height
    bending = young * width * lintel.height**3 / 12
    shear = 5 / 6 * young / USUAL[lintel.kind].shear_ratio * width * lintel.height
    return (
        5 * load * span**4 / 384 - load * beyond**2 * span**2 / 16
    ) / bending + load * span**2 / (8 * shear)


class TestPlaces:
    """Bricks of 0.2 x 0.1 m; a door from 0.8 to 1.6 m, 0.8 m high."""

    def spans(self, *openings, **more):
        return [
            (round(place.left, 9), round(place.right, 9), place.first, place.above)
            for place in plan_of(wall(openings, **more)).lintels
        ]

    def test_a_lintel_takes_its_courses_and_its_bearing(self):
        assert self.spans(replace(DOOR, lintel=Lintel("stone", 0.2, 0.15, 2e10))) == [
            (0.65, 1.75, 8, 10)
        ]
        assert self.spans(replace(DOOR, lintel=Lintel("arch", bearing=0.0))) == [(0.8, 1.6, 8, 10)]
        assert plan_of(wall((DOOR,))).runs[8] == (
            (0.0, approx(0.7)),
            (approx(1.7), 2.4),
        )

    def test_it_ends_with_the_wall_or_meets_another_where_less_than_half_a_brick_would_be_left(
        self,
    ):
        assert self.spans(Opening(0.1, 1.0, 0.8)) == [(0.0, 1.2, 8, 9)]
        assert self.spans(Opening(0.4, 0.6, 0.8), Opening(1.2, 0.6, 0.8)) == [
            (0.3, 1.1, 8, 9),
            (1.1, 1.9, 8, 9),
        ]

    def test_it_ends_below_the_next_opening_and_below_the_top(self):
        assert self.spans(DOOR, Opening(0.8, 0.8, 0.2, 0.9), lintel=Lintel("timber", 0.3)) == [
            (0.7, 1.7, 8, 9),
            (0.7, 1.7, 11, 12),
        ]
        assert self.spans(Opening(0.8, 0.8, 1.0, 0.2)) == []
        assert self.spans(DOOR, floors=(Floor(1.0, 100.0, kind="concrete", depth=0.2),)) == []

    @pytest.mark.parametrize(
        "lintel", ["concrete", "arch", Lintel("steel", 0.2, width=0.01)], ids=str
    )
    @pytest.mark.parametrize("contacts", ["interior", "gauss"])
    def test_bricks_and_lintels_fill_the_wall_and_joints_surround_them(self, lintel, contacts):
        """As many metres of bed joints above and below as the lintel is long, where it has bearing,
        and of head joints as it is high at each end; an arch of 10 bricks has nine joints more."""
        layout = lay_out(wall((replace(DOOR, lintel=lintel),)), ModelOptions(contacts=contacts))
        (place,) = layout.plan.lintels
        bodies = layout.bodies
        contact = layout.contacts
        parts = np.flatnonzero(bodies.course < 0)
        assert layout.n_below_caps - layout.n_bricks == len(parts) == place.parts
        of = np.isin(contact.first, parts), np.isin(contact.second, parts)
        high = (place.above - place.first) * 0.1
        joints = contact.kind != CUT
        assert_allclose(contact.length[of[0] & ~of[1] & ~contact.upright].sum(), 1.0)
        assert_allclose(contact.length[~of[0] & of[1] & ~contact.upright].sum(), 0.2)
        assert_allclose(contact.length[(of[0] ^ of[1]) & (contact.kind == HEAD)].sum(), 2 * high)
        inner = of[0] & of[1]
        if set(bodies.course[parts]) == {ARCH_COURSE}:
            assert place.parts == 10 and joints[inner].all() and not contact.elastic.any()
            assert_allclose(contact.length[inner].sum(), 9 * high)
        else:
            assert (
                np.array_equal(contact.elastic, contact.kind == CUT)
                and inner[contact.kind == CUT].all()
            )


class TestOptions:
    def test_courses_take_the_place_of_lintels_where_the_option_asks_for_them(self):
        made = wall((DOOR,))
        plain = wall((DOOR,), lintel="courses")
        for option in ("1", "none"):
            one, other = (lay_out(of, ModelOptions(lintel=option)) for of in (made, plain))
            assert np.array_equal(one.contacts.elastic, other.contacts.elastic)
            assert np.array_equal(one.bodies.mass, other.bodies.mass) and not one.plan.lintels
        assert lay_out(made).plan.lintels and not lay_out(plain).plan.lintels

    def test_a_run_tells_which_lintels_of_the_wall_an_option_replaces(self):
        made = wall((DOOR, Opening(1.9, 0.3, 0.2, 0.4, "arch")))
        (line,) = replaced_lintels(made, "timber")
        assert line.endswith("of wall w: opening 1 concrete, opening 2 arch")
        assert replaced_lintels(made, "elastic") == []
        assert replaced_lintels(wall((DOOR,), lintel="courses"), "none") == []


TABLE = {
    "name": "w",
    "length": 2.4,
    "height": 1.2,
    "lintel": "timber",
    "openings": [
        {"left": 0.2, "width": 0.6, "height": 0.8},
        {
            "left": 1.2,
            "width": 0.6,
            "height": 0.8,
            "lintel": {"kind": "steel", "height": 0.1, "width": 0.01},
        },
    ],
}


class TestData:
    def test_a_table_is_the_wall_that_python_makes(self):
        made = wall_from(TABLE)
        assert made == Wall(
            "w",
            2.4,
            1.2,
            [
                Opening(0.2, 0.6, 0.8),
                Opening(1.2, 0.6, 0.8, lintel=Lintel("steel", 0.1, width=0.01)),
            ],
            lintel="timber",
        )
        assert Wall.from_dict(json.loads(json.dumps(made.as_dict()))) == made

    def test_a_history_without_lintels_is_of_elastic_courses_and_other_walls_have_concrete_ones(
        self,
    ):
        old = wall_from(TABLE | {"lintel": "courses", "openings": TABLE["openings"][:1]}).as_dict()
        assert "lintel" not in old and "lintel" not in old["openings"][0]
        assert Wall.from_dict(old).lintel.kind == "courses"
        assert Wall("w", 2.4, 1.2, [DOOR]).lintel == Lintel("concrete")
        assert Wall.from_dict(Wall("w", 2.4, 1.2).as_dict()) == Wall("w", 2.4, 1.2)


# --- the share of joints that a lintel keeps elastic ----------------------------------------------

DOOR_WALL = Wall("door", 1.8, 0.6, (Opening(0.45, 0.9, 0.45),), lintel="courses")
"""Eight bricks by eight courses, a door of four bricks by six courses in it."""
FACADE = Wall(
    "facade",
    6.0,
    3.0,
    precompression=0.1e6,
    lintel="courses",
    openings=(
        Opening(0.6, 0.9, 2.0),
        *(Opening(left, 0.675, 1.4, 0.6) for left in (2.1, 3.375, 4.65)),
    ),
)


def share_of(wall, **options):
    layout = lay_out(wall, ModelOptions(**options))
    return elastic_share(layout.plan, joint_table(layout), body_table(layout))


def test_the_share_of_a_door_by_hand():
    """Above it: 1.8 m of bed joint between two courses, and head joints of 75 mm, seven in the one
    course (whole bricks) and eight in the other (half ones at the ends).  Elastic, within 0.225 and
    1.575 m: 1.35 m of bed joint and the five and six head joints that lie strictly inside."""
    above = 1.8 + 15 * 0.075
    elastic = 1.35 + (5 + 6) * 0.075
    share = share_of(DOOR_WALL)
    total = lay_out(DOOR_WALL).total_joint_length
    assert share.above_openings == approx(elastic / above)
    assert share.of_all == approx(elastic / total)


def test_an_ordinary_facade_has_three_times_the_share_of_the_paper_s_walls(symmetric_wall):
    assert share_of(FACADE) == approx((0.331, 0.784), abs=5e-4)
    assert share_of(symmetric_wall) == approx((0.100, 0.608), abs=5e-4)
    assert share_of(FACADE, lintel="1") == approx((0.007, 0.016), abs=5e-4)
    assert share_of(Wall("solid", 1.8, 0.6)) == (0.0, None)
    assert warn_of_share(share_of(symmetric_wall)) == [] != warn_of_share(share_of(FACADE))
    assert 0.1 < LARGE_SHARE < 0.33


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """A History of the wall with a door; a few joints of its lintel are between others that
    crack."""
    return make_history(
        tmp_path_factory.mktemp("door") / "door.h5",
        lay_out(DOOR_WALL),
        opening={0: 3e-4 * np.ones(21)},
    )


def test_every_summary_tells_the_share(run):
    share = share_of(DOOR_WALL)
    summary = summarise(run)
    row = summary_row(run)
    for table in (summary, row):
        assert (
            table["elastic_joint_share"],
            table["elastic_joint_share_above_openings"],
        ) == approx(share)
    assert summary["warnings"] == warn_of_share(share) != []
    above = r"^elastic above openings +74 +% of the joint length there$"
    assert re.search(above, describe(summary), re.MULTILINE)
    solid = summarise(make_history(run.path, write=HistoryInMemory))
    assert (solid["elastic_joint_share"], solid["elastic_joint_share_above_openings"]) == (
        0.0,
        None,
    )
    assert solid["warnings"] == []
    assert re.search(r"^elastic joints +0 +% of the joint length$", describe(solid), re.MULTILINE)


@pytest.mark.parametrize("kind", ["concrete", "timber", "steel", "arch"])
def test_a_lintel_that_takes_all_above_the_opening_leaves_no_joints_there(kind):
    wall = Wall("low", 0.9, 0.525, (Opening(0.1125, 0.675, 0.45),), lintel=kind)
    assert (share_of(wall).above_openings is None) == (kind != "arch")
