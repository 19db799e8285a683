"""The plan of a wall by hand, and that a layout works out nothing again from the wall."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from damage import Brick, Floor, Lintel, ModelOptions, Opening, Wall
from damage.wall.layout import lay_out
from damage.wall.plan import plan_of

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


class TestByHand:
    def test_openings_lintels_runs_and_piers(self):
        plan = plan_of(HOUSE)
        (window,), (lintel,), (slab,) = plan.openings, plan.lintels, plan.slabs
        assert window[:5] == (0.6, pytest.approx(1.2), 2, 6, 8) and slab[1:] == (0.0, 2.0, 8, 10)
        assert lintel[1:5] == (pytest.approx(0.5), pytest.approx(1.3), 6, 8)
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
        plan, bodies = layout.plan, layout.bodies
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
