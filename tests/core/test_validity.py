"""How far joints have slid over the overlap of their faces: by hand, of bricks of 0.225 m laid half
over half."""

import numpy as np
import pytest
from small_history import make_history, small_layout

from damage.measure.joints import ended_joints, slide_limits
from damage.measure.summary import summarise
from damage.measure.tables import joints_table
from damage.run.report import describe

LAYOUT = small_layout()
CONTACTS = LAYOUT.contacts


def joint_of(kind, course, fits=lambda row: True):
    """Row of a joint of this kind (0 bed, 1 head) under, or in, the course that fits."""
    return next(
        row
        for row in range(LAYOUT.n_joints)
        if CONTACTS.kind[row] == kind
        and LAYOUT.bodies.course[CONTACTS.second[row]] == course
        and fits(row)
    )


def on_its_left(row):
    """Whether a whole brick stands with its right half on the brick below: it falls off to the left
    at 0.1125 m."""
    first, second = CONTACTS.first[row], CONTACTS.second[row]
    x, length = LAYOUT.bodies.x, LAYOUT.bodies.length
    return (x[first] - x[second], length[first], length[second]) == pytest.approx(
        (0.1125, 0.225, 0.225)
    )


BED, HEAD, BASE = joint_of(0, 2, on_its_left), joint_of(1, 2), joint_of(0, 0)


def test_faces_end_where_bricks_do(still_history):
    least, most = slide_limits(still_history.joints, still_history.bodies)
    assert (least[BED], most[BED]) == pytest.approx((-0.1125, 0.3375))
    assert (least[HEAD], most[HEAD]) == pytest.approx((-0.075, 0.075))
    assert (least[BASE], most[BASE]) == (-np.inf, np.inf)


@pytest.mark.parametrize(
    "offset, share",
    [
        ({}, 0.0),
        ({BED: -0.09}, 0.8),
        ({BED: 0.09}, 0.8 / 3),
        ({BASE: 5.0}, 0.0),
        ({HEAD: 0.03, BED: -0.045}, 0.4),
        ({BED: -0.18}, 1.6),
    ],
)
def test_the_largest_share_of_the_overlap_is_reported_and_warned_of_from_one_on(
    tmp_path, offset, share
):
    ramp = np.minimum(np.arange(21), 10) / 10
    history = make_history(
        tmp_path / "a.h5",
        offset={row: value * ramp for row, value in offset.items()},
        broken=tuple(offset),
    )
    summary = summarise(history)
    assert summary["max_offset_over_overlap"] == pytest.approx(share, abs=1e-7)


def test_joints_that_ended_are_counted_and_warned_of_in_one_line(tmp_path):
    """Two contact points of one joint, one of another."""
    twin = BED + 1 if CONTACTS.second[BED + 1] == CONTACTS.second[BED] else BED - 1
    assert (CONTACTS.first[twin], CONTACTS.second[twin]) == (
        CONTACTS.first[BED],
        CONTACTS.second[BED],
    )
    history = make_history(
        tmp_path / "a.h5",
        offset={BED: -0.113, twin: -0.113, HEAD: 0.076},
        ended={BED: 7, twin: 7, HEAD: 12},
    )
    assert ended_joints(history) == (2, min(BED, twin), 7)
    summary = summarise(history)
    assert summary["ended_joints"] == 2 and summary["max_offset_over_overlap"] >= 1
    (line,) = [line for line in summary["warnings"] if "ended" in line]
    assert (
        line.startswith("2 joints ended, the first the bed joint at x = ")
        and "(t = 0.07 s)" in line
    )
    assert "joints that ended, as their faces no longer overlapped: 2" in describe(summary)
    assert np.flatnonzero(joints_table(history)["ended"]).tolist() == sorted([BED, twin, HEAD])
    none = summarise(make_history(tmp_path / "b.h5"))
    assert none["ended_joints"] == 0 and "ended" not in describe(none)
