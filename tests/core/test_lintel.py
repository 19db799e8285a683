"""The share of joints that a lintel keeps elastic: by hand, alike in layout and history, reported
and warned of."""

import numpy as np
import pytest
from conftest import parsed
from small_history import make_history

from damage import ModelOptions, Opening, Wall
from damage.history.in_memory import HistoryInMemory
from damage.linear.modes import natural_modes
from damage.measure.summary import summarise
from damage.measure.tables import summary_row
from damage.run.banner import wall_lines
from damage.run.report import describe
from damage.wall.geometry import body_table, joint_table
from damage.wall.layout import lay_out
from damage.wall.lintels import LARGE_SHARE, elastic_share, warn_of_share

DOOR = Wall("door", 1.8, 0.6, (Opening(0.45, 0.9, 0.45),), lintel="courses")
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
    above, elastic = 1.8 + 15 * 0.075, 1.35 + (5 + 6) * 0.075
    share, total = share_of(DOOR), lay_out(DOOR).total_joint_length
    assert share.above_openings == pytest.approx(elastic / above)
    assert share.of_all == pytest.approx(elastic / total)


def test_an_ordinary_facade_has_three_times_the_share_of_the_paper_s_walls(symmetric_wall):
    assert share_of(FACADE) == pytest.approx((0.331, 0.784), abs=5e-4)
    assert share_of(symmetric_wall) == pytest.approx((0.100, 0.608), abs=5e-4)
    assert share_of(FACADE, lintel="1") == pytest.approx((0.007, 0.016), abs=5e-4)
    assert share_of(Wall("solid", 1.8, 0.6)) == (0.0, None)
    assert warn_of_share(share_of(symmetric_wall)) == [] != warn_of_share(share_of(FACADE))
    assert 0.1 < LARGE_SHARE < 0.33


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """A History of the wall with a door; a few joints of its lintel are between others that
    crack."""
    return make_history(
        tmp_path_factory.mktemp("door") / "door.h5", lay_out(DOOR), opening={0: 3e-4 * np.ones(21)}
    )


def test_every_summary_tells_the_share(run):
    share, summary, row = share_of(DOOR), summarise(run), summary_row(run)
    for table in (summary, row):
        assert (
            table["elastic_joint_share"],
            table["elastic_joint_share_above_openings"],
        ) == pytest.approx(share)
    assert summary["warnings"] == warn_of_share(share) != []
    assert "(74 % above the openings) is elastic and cannot fail" in describe(summary)
    solid = summarise(make_history(run.path, write=HistoryInMemory))
    assert (solid["elastic_joint_share"], solid["elastic_joint_share_above_openings"]) == (
        0.0,
        None,
    )
    assert solid["warnings"] == [] and "no joint is elastic, all can fail" in describe(solid)


def test_a_run_tells_strengths_masses_period_and_share_at_its_start():
    layout, loading = lay_out(DOOR), parsed().loading
    modes, brickwork_t = natural_modes(layout), 1.9 * 0.1025 * (1.8 * 0.6 - 0.9 * 0.45)
    lines = "\n".join(wall_lines(layout, loading, modes, 1e-5))
    for words in (
        f"{layout.n_bricks} bricks ({brickwork_t:.3g} t together)",
        "top: 5.64 t",
        "tensile strength 0.21 MPa",
        "cohesion 0.24 MPa",
        "friction angle 32 deg, brittle",
        "modulus 5200 MPa",
        f"first period by eigenvalue {modes.period_s[0]:.4f} s",
        "(74 % above the openings) is elastic",
    ):
        assert words in lines


@pytest.mark.parametrize("kind", ["concrete", "timber", "steel", "arch"])
def test_a_lintel_that_takes_all_above_the_opening_leaves_no_joints_there(kind):
    wall = Wall("low", 0.9, 0.525, (Opening(0.1125, 0.675, 0.45),), lintel=kind)
    assert (share_of(wall).above_openings is None) == (kind != "arch")
