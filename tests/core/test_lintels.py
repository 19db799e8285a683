"""Lintels of their own: a beam's deflection, an arch's thrust line, places, data, pictures, what is
refused."""

import json
from dataclasses import replace

import numpy as np
import pytest
from conftest import parsed
from numpy.testing import assert_allclose

from damage import Brick, Floor, Joint, ModelOptions, Opening, Wall
from damage.linear.modes import natural_modes, static_displacement
from damage.run.banner import wall_lines
from damage.run.options import parse_run
from damage.units import GRAVITY
from damage.wall.as_built import replaced_lintels
from damage.wall.file import wall_from
from damage.wall.kinds import ARCH_COURSE, CUT, HEAD, LINTEL_COURSE
from damage.wall.layout import lay_out
from damage.wall.lintels import USUAL, Lintel
from damage.wall.plan import plan_of
from verification.collapse import settled_wall

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
    young, density = lintel.of("modulus"), lintel.of("density")
    load = density * GRAVITY * width * lintel.height
    bending = young * width * lintel.height**3 / 12
    shear = 5 / 6 * young / USUAL[lintel.kind].shear_ratio * width * lintel.height
    return (
        5 * load * span**4 / 384 - load * beyond**2 * span**2 / 16
    ) / bending + load * span**2 / (8 * shear)


class TestArch:
    """A flat arch on two piers that it spreads: joints without tension, which do not slide and
    hardly compress.

    Its thrust passes the top of the arch in the middle of the span L and the bottom at its ends, so
    that H h = V L / 4 with its height h and half its weight V = g h L / 2, g per area.  A pier of
    width B below its springing at the height z turns about its outer toe where H z > V B + W B / 2,
    W = g B (z + h): the arch stands if

        h / z > (L^2 / 8 - B^2 / 2) / (L B / 2 + B^2 / 2)

    which is 0.6 for L = 4 B.
    """

    def test_it_falls_5_percent_below(self):
        """Four courses of arch above seven.  Five above eight, 4 % above, stand:
        `test_joint_stress.py`."""
        assert 4 / 7 == pytest.approx(0.95 * 0.6, rel=0.01)
        brick = Brick(length=0.36, height=0.06, thickness=0.1)
        lintel = Lintel("arch", 4 * brick.height, 0.0)
        opening = Opening(brick.length, 4 * brick.length, 7 * brick.height, 0.0, lintel)
        made = Wall(
            "arch",
            6 * brick.length,
            11 * brick.height,
            (opening,),
            0.0,
            brick=brick,
            joint=Joint(2e10, 1e10, 1.2, 0.0, 1e7),
        )
        with pytest.raises(ValueError, match="does not stand under its own weight"):
            settled_wall(lay_out(made, ModelOptions(contacts="corners")))


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
            (0.0, pytest.approx(0.7)),
            (pytest.approx(1.7), 2.4),
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
        (place,), bodies, contact = layout.plan.lintels, layout.bodies, layout.contacts
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
        made, plain = wall((DOOR,)), wall((DOOR,), lintel="courses")
        for option in ("1", "none"):
            one, other = (lay_out(of, ModelOptions(lintel=option)) for of in (made, plain))
            assert np.array_equal(one.contacts.elastic, other.contacts.elastic)
            assert np.array_equal(one.bodies.mass, other.bodies.mass) and not one.plan.lintels
        assert lay_out(made).plan.lintels and not lay_out(plain).plan.lintels

    def test_a_run_tells_its_lintels(self):
        layout = lay_out(wall((DOOR, Opening(1.9, 0.3, 0.2, 0.4, "arch"))))
        lines = wall_lines(layout, parsed().loading, natural_modes(layout), 1e-5)
        assert "concrete lintel at 0.8 m, x = 0.7 to 1.7 m: 0.1 x 0.15 m, modulus 30 GPa" in lines
        assert any(line.startswith("arch lintel at 0.6 m") for line in lines)
        assert "lintels of their own: no joint is elastic, all can fail" in lines

    def test_a_run_tells_which_lintels_of_the_wall_an_option_replaces(self):
        made = wall((DOOR, Opening(1.9, 0.3, 0.2, 0.4, "arch")))
        for option, place in (("timber", "timber lintel at 0.8 m"), ("none", "lintel none")):
            layout = lay_out(made, ModelOptions(lintel=option))
            lines = wall_lines(
                layout, parse_run([], "test", "reference").loading, natural_modes(layout), 1e-5
            )
            says = f"--lintel {option} in place of the lintels of wall w"
            assert f"{says}: opening 1 concrete, opening 2 arch" in lines
            assert any(line.startswith(place) for line in lines)
            assert not any(line.startswith("lintels of their own") for line in lines)
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
