"""Outlines: gables, wings, parapets, openings that reach the top; what is built, by hand and by
closed forms; the plan of a wall."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from pytest import approx

from damage import Brick, Floor, Lintel, ModelOptions, Opening, Wall
from damage.wall.layout import lay_out
from damage.wall.plan import plan_of

BRICK = Brick(length=0.2, height=0.1, thickness=0.1, density=2000.0)
GABLE = ((0.0, 0.4), (0.8, 1.2), (1.6, 0.4))


def wall(length, outline, **more):
    """A wall of bricks of 0.2 x 0.1 m below an outline, without precompression."""
    return Wall(
        "w",
        length,
        max(z for _, z in outline),
        precompression=0.0,
        brick=BRICK,
        outline=outline,
        **more,
    )


class TestByHand:
    """Bricks and total joint length of small walls, counted on squared paper."""

    def test_a_rectangle_as_an_outline_is_the_rectangle(self):
        flat = lay_out(wall(1.2, ((0.0, 0.4), (1.2, 0.4))))
        plain = lay_out(Wall("w", 1.2, 0.4, precompression=0.0, brick=BRICK))
        for name in ("x", "z", "length", "mass"):
            assert np.array_equal(getattr(flat.bodies, name), getattr(plain.bodies, name))
        assert flat.total_joint_length == plain.total_joint_length

    def test_a_lower_wing(self):
        """Four courses of 1.2 m on the left 0.6 m, two on the rest: beds 1.2 + 1.2 + 0.6 + 0.6;
        heads 5, 6, 2 and 3."""
        layout = lay_out(wall(1.2, ((0.0, 0.4), (0.6, 0.4), (0.6, 0.2), (1.2, 0.2))))
        assert [len(runs) for runs in layout.plan.runs] == [1, 1, 1, 1]
        assert layout.n_bricks == 6 + 7 + 3 + 4
        assert_allclose(layout.total_joint_length, 3.6 + 0.1 * (5 + 6 + 2 + 3), rtol=1e-12)

    def test_a_gable_of_45_degrees(self):
        """Over two courses of 0.8 m the slopes take 0.05 m a side of the third course and 0.1 m
        more of each next: beds 0.8 + 0.8 + 0.7 + 0.5 + 0.3 + 0.1; heads 3, 4, and one of each whole
        brick's end inside the others."""
        layout = lay_out(wall(0.8, ((0.0, 0.2), (0.4, 0.6), (0.8, 0.2))))
        lengths = [right - left for runs in layout.plan.runs for left, right in runs]
        assert_allclose(lengths, [0.8, 0.8, 0.7, 0.5, 0.3, 0.1])
        # third course, 0.05 to 0.75: joints at 0.2, 0.4, 0.6; fourth, 0.15 to 0.65: at 0.3 and 0.5,
        # no sliver's at 0.1; fifth, 0.25 to 0.55: at 0.4; sixth, 0.35 to 0.45: none at the
        # quarter's edge but at its middle
        heads = 3 + 4 + 3 + 2 + 1 + 0
        assert_allclose(
            layout.total_joint_length, 0.8 + 0.8 + 0.7 + 0.5 + 0.3 + 0.1 + 0.1 * heads, rtol=1e-12
        )

    def test_a_parapet_with_an_opening_that_reaches_the_top(self):
        """Two courses of 1.2 m; above them a gap of 0.4 m between two battlements of 0.4 m, two
        courses high."""
        layout = lay_out(
            Wall("w", 1.2, 0.4, (Opening(0.4, 0.4, 0.2, 0.2),), precompression=0.0, brick=BRICK)
        )
        beds = 1.2 + 1.2 + 0.8 + 0.8
        heads = 0.1 * (5 + 6 + (1 + 1) + (2 + 2))
        assert_allclose(layout.total_joint_length, beds + heads, rtol=1e-12)
        assert layout.plan.piers == ((0.0, 0.4), (0.8, 1.2))


class TestDrift:
    @pytest.mark.parametrize(
        ("outline", "course"),
        [
            (((0.0, 0.6), (1.6, 0.6)), 5),
            (GABLE, 7),  # 0.8 m long in its middle
            (
                ((0.0, 1.0), (0.9, 1.0), (0.9, 0.4), (1.6, 0.4)),
                9,
            ),  # the higher part is the longer one
            (((0.0, 1.0), (0.7, 1.0), (0.7, 0.4), (1.6, 0.4)), 3),
            (((0.0, 0.6), (0.2, 0.6), (0.2, 0.4), (1.6, 0.4)), 3),  # a chimney does not count
        ],
    )
    def test_it_is_of_the_highest_course_half_as_long_as_the_wall(self, outline, course):
        layout = lay_out(wall(1.6, outline))
        assert layout.plan.drift_course == course
        assert_allclose(layout.drift_height, 0.1 * course + 0.05)
        assert set(layout.bodies.course[layout.drift_bodies]) == {course}


# --- the plan of a wall ---------------------------------------------------------------------------

HOUSE = Wall(
    "house",
    2.0,
    1.0,
    (Opening(0.6, 0.6, 0.4, 0.2),),
    0.0,
    brick=Brick(length=0.2, height=0.1, thickness=0.1),
    floors=(Floor(1.0, 500.0, kind="concrete", depth=0.2), Floor(0.5, 100.0)),
    lintel=Lintel(height=0.2),
)
"""Ten courses: a window from the third to the sixth, a concrete lintel in two, and a slab in the
two at the top."""


class TestPlan:
    def test_openings_lintels_runs_and_piers(self):
        plan = plan_of(HOUSE)
        (window,) = plan.openings
        (lintel,) = plan.lintels
        (slab,) = plan.slabs
        assert window[:5] == (0.6, approx(1.2), 2, 6, 8) and slab[1:] == (0.0, 2.0, 8, 10)
        assert lintel[1:5] == (approx(0.5), approx(1.3), 6, 8)
        assert [len(runs) for runs in plan.runs] == [1, 1, 2, 2, 2, 2, 2, 2, 0, 0]
        assert_allclose(plan.runs[3], [(0.0, 0.6), (1.2, 2.0)])
        assert_allclose(plan.piers, [(0.0, 0.6), (1.2, 2.0)])
        assert plan.drift_course == 9

    def test_what_bears_what(self):
        """The lintel lies on both piers, the slab on two runs of bricks and on the lintel, whose
        last course it is."""
        rests = {
            (course, round(left, 9)): below for (left, _), course, below in plan_of(HOUSE).rests
        }
        assert len(rests) == 1 + 4 * 2 + 3 + 2 + 1
        assert_allclose(rests[6, 0.5], [(0.0, 0.6), (1.2, 2.0)])
        assert_allclose(rests[8, 0.0], [(0.0, 0.5), (1.3, 2.0), (0.5, 1.3)])

    def test_courses_and_ends_are_those_of_the_bodies(self):
        layout = lay_out(HOUSE)
        plan = layout.plan
        bodies = layout.bodies
        first, last = plan.taken
        assert (
            len(bodies)
            == len(first)
            == layout.n_below_caps
            == plan.n_bricks + 1 + plan.lintels[0].parts
        )
        assert_allclose(
            np.column_stack([bodies.z - bodies.height / 2, bodies.z + bodies.height / 2]),
            np.column_stack([first, last + 1]) * 0.1,
            atol=1e-12,
        )
        assert_allclose(
            [bodies.x - bodies.length / 2, bodies.x + bodies.length / 2], plan.ends, atol=1e-12
        )

    def test_options_say_which_lintels_are_built(self):
        assert plan_of(HOUSE, ModelOptions(lintel="none")).lintels == ()
        assert plan_of(HOUSE, ModelOptions(lintel="arch")).lintels[0].lintel.kind == "arch"
        assert lay_out(HOUSE, ModelOptions(lintel="2")).plan.lintels == ()
