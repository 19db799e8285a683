"""The damage index and the measures of a run, on signals and histories whose values are known.

Bricks are 0.225 m long and laid half over half."""

import re

import numpy as np
import pandas as pd
import pytest
from conftest import refused_with
from numpy.testing import assert_allclose
from pytest import approx
from small_history import make_history, small_layout

from damage.index import damage_index
from damage.measure.cycles import CYCLES, cycle_measures, cycles_table, upward_crossings
from damage.measure.energy import (
    DISSIPATED,
    STORED,
    Balance,
    energy_error,
    energy_measures,
    imbalance,
)
from damage.measure.joints import ended_joints
from damage.measure.limits import LIMITS, classes
from damage.measure.summary import summarise
from damage.measure.tables import joints_table, summary_row
from damage.motion.intensity import motion_measures
from damage.run.report import describe

STEP_S = 0.002
# samples: 0.6 s of motion, 1.4 s of rest, 0.5 s of settling
MOTION = 300
REST = 700
SETTLING = 250
STAGES = ("motion",) * MOTION + ("rest",) * REST + ("settling",) * SETTLING
TIME_S = STEP_S * np.arange(len(STAGES))


@pytest.fixture
def harmonic(tmp_path):
    """Make histories of three cycles of 0.2 s, then rest and settling; returns the maker."""

    def make(drift, **options):
        return make_history(
            tmp_path / "run.h5", stages=STAGES, step_s=STEP_S, drift=drift, **options
        )

    return make


def softening(free_period_s):
    """A sine of 0.2 s up to 0.6 s, then one of another period, zero at 0.6 s."""
    driven = np.sin(2 * np.pi * TIME_S / 0.2)
    return 1e-3 * np.where(TIME_S < 0.6, driven, np.sin(2 * np.pi * (TIME_S - 0.6) / free_period_s))


def test_crossings_of_a_sine_lie_a_period_apart():
    time_s = np.arange(0, 3, 0.0021)
    crossings = upward_crossings(time_s, np.sin(2 * np.pi * (time_s - 0.03) / 0.237))
    assert np.diff(crossings) == approx(0.237, rel=1e-4)


def test_ripples_around_zero_are_no_cycles():
    time_s = np.arange(0, 2, 0.0001)
    # steeper than it
    rippled = np.sin(2 * np.pi * 4 * (time_s - 0.1)) - 0.018 * np.sin(2 * np.pi * 300 * time_s)
    assert np.diff(upward_crossings(time_s, rippled)) == approx(0.25, abs=0.004)
    assert len(upward_crossings(time_s, rippled, rearm=0.0)) > 8


def test_the_energy_balance_counts_all_that_is_stored_and_dissipated():
    """8 J come in, of which each term takes 1 J, and 2 J are missing; what was there at first does
    not count."""
    series = pd.DataFrame(
        {
            "stage": "motion",
            "input_energy_j": [0.0, 8.0],
            **{name: [5.0, 6.0] for name in STORED},
            **{name: [0.0, 1.0] for name in DISSIPATED},
        }
    )
    assert imbalance(series) == approx([0.0, -2.0])
    assert energy_error(series) == approx(0.25)
    balance = Balance(noise=0.0)
    balance.add(
        {name: series[name].to_numpy() for name in (*STORED, *DISSIPATED, "input_energy_j")}
    )
    assert balance.error == approx(0.25)


def test_free_cycle_shows_the_softened_period(harmonic):
    history = harmonic(softening(0.3))
    history.parameters["eigen_period_s"] = 0.2
    found = cycle_measures(history)
    assert found["last_cycle_s"] == approx(0.2, rel=1e-3)
    assert found["first_free_cycle_s"] == approx(0.3, rel=1e-3)
    assert found["period_elongation"] == approx(1.5, rel=1e-3)


def test_cycles_of_the_motion_then_free_ones(harmonic):
    drift = softening(0.25) * np.select([TIME_S < 0.2, TIME_S < 0.4, TIME_S < 0.6], [1, 2, 3], 2)
    table = cycles_table(harmonic(drift))
    assert list(table.columns) == list(CYCLES)
    driven, free = (table[table["kind"] == kind] for kind in ("driven", "free"))
    assert driven["start_s"].tolist() == approx([0, 0.2, 0.4])
    assert driven["duration_s"].tolist() == approx([0.2] * 3)
    assert driven["max_drift_ratio"].tolist() == approx([1e-3, 2e-3, 3e-3], rel=1e-3)
    assert driven["max_DI_drift"].tolist() == approx([0.05, 0.10, 0.15], rel=1e-3)
    assert free["duration_s"].to_numpy() == approx(0.25, rel=1e-3)
    assert free["max_DI"].to_numpy() == approx(0.10, rel=1e-3)
    assert free["cumulative_max_DI"].to_numpy() == approx(0.15, rel=1e-3)


def test_cycles_count_an_opening_only_where_it_is(harmonic):
    opening = {3: np.where((TIME_S >= 0.25) & (TIME_S < 0.35), 0.2e-3, 0.0)}
    table = cycles_table(harmonic(0.0, opening=opening))
    share = small_layout().contacts.length[3] / small_layout().total_joint_length
    assert table["max_DI_open"].tolist() == approx([0, share, 0])
    assert table["cumulative_max_DI"].tolist() == approx([0, share, share])


def test_a_run_cut_short_has_its_whole_cycles_only(tmp_path):
    history = make_history(tmp_path / "cut.h5", stages=("motion",) * 131, step_s=STEP_S)
    assert cycles_table(history)["end_s"].tolist() == approx([0.2])
    assert set(cycle_measures(history).values()) == {None}


def test_energies_leave_the_damping_of_the_settling_out(harmonic):
    settling = np.array(STAGES) == "settling"
    found = energy_measures(
        harmonic(
            0.0,
            row={
                "friction_energy_j": 3 * TIME_S,
                "fracture_energy_j": 0.5,
                "input_energy_j": 7.0,
                "damping_energy_j": np.where(settling, 10.0, TIME_S / TIME_S[MOTION + REST - 1]),
            },
        )
    )
    assert found["dissipated_energy_j"] == approx(3 * TIME_S[-1] + 0.5)
    assert found["input_energy_j"] == 7.0
    assert found["damping_energy_j"] == approx(1.0)


def test_classes_of_published_limits():
    assert list(classes(0.0009, 1.2, 0.5).values()) == [
        "light",
        "light",
        "minor",
        "up to 0.5 %",
        "up to 1/600",
        "visible",
        "very slight",
    ]


@pytest.mark.parametrize("limits", LIMITS, ids=lambda limits: limits.name)
def test_limits_rise_and_part_the_classes(limits):
    assert list(limits.bounds) == sorted(limits.bounds)
    just_below = [limits.classify(bound * (1 - 1e-9)) for bound in limits.bounds]
    assert (*just_below, limits.classify(1e9)) == limits.classes
    assert limits.classify(limits.bounds[0]) == limits.classes[1]
    assert limits.classify(None) is None
    assert limits.source


WRITTEN = {
    "pgv_m_s": 0.02,
    "pgv_rotd100_m_s": 0.03,
    "avg_sa_g": 0.3,
    "sa_eigen_period_g": 0.4,
    "arias_m_s": 0.1,
    "d5_75_s": 2.0,
    "d5_95_s": None,
}


class TestMotion:
    def test_what_the_run_wrote_grows_with_its_strongest_shock(self, tmp_path):
        history = make_history(tmp_path / "a.h5", loading="record")
        history.parameters.update(WRITTEN, sequence=[0.5, -2.0])
        # velocity and acceleration with the factor, squares with its square, durations not at all
        assert motion_measures(history) == approx(
            {
                "pgv_m_s": 0.04,
                "pgv_rotd100_m_s": 0.06,
                "avg_sa_g": 0.6,
                "sa_eigen_period_g": 0.8,
                "arias_m_s": 0.4,
                "d5_75_s": 2.0,
                "d5_95_s": None,
            }
        )
        row = summary_row(history)
        assert {name: row[name] for name in WRITTEN} == motion_measures(history)


# --- the index: equations (1) to (4), thresholds, clipping, criteria ------------------------------

LENGTH = np.array([1.0, 2.0, 3.0, 4.0])  # [m], 10 m in all


def index_of(drift=0.0, opening=(0, 0, 0, 0), slip=(0, 0, 0, 0), at_limit=(0, 0, 0, 0), **options):
    frame = damage_index(
        [0.0],
        [drift],
        np.array([opening], float),
        np.array([slip], float),
        np.array([at_limit], bool),
        LENGTH,
        **options,
    )
    return frame.iloc[0]


FIRST = (2e-4, 0, 0, 0)
SECOND = (0, 2e-4, 0, 0)
LIMITED = (0, 0, 1, 1)


@pytest.mark.parametrize(
    ("given", "expected"),
    [
        (
            {"opening": (2e-4, 0, 0.9e-4, 1.1e-4), "slip": (0, -2e-4, 0, 0)},
            {"DI_open": 0.5, "DI_slip": 0.2},
        ),
        (
            {"drift": -0.005, "opening": FIRST, "slip": SECOND},
            {"DI_drift": 0.25, "DI": 1 - 0.75 * 0.9 * 0.8},
        ),
        (
            {"opening": FIRST, "slip": SECOND, "total_length": 20.0},
            {"DI_open": 0.05, "DI_slip": 0.1},
        ),
        ({"drift": 0.05}, {"DI_drift": 1.0, "drift_over_limit": 2.5}),
        ({"slip": FIRST, "at_limit": LIMITED}, {"DI_slip": 0.1}),
        ({"slip": FIRST, "at_limit": LIMITED, "slip_criterion": "shear-limit"}, {"DI_slip": 0.7}),
        (
            {"drift": 0.005, "opening": FIRST, "threshold": 3e-4, "drift_limit": 0.01},
            {"DI_open": 0.0, "DI_drift": 0.5},
        ),
    ],
    ids=[
        "lengths over the threshold add up",
        "equation (1)",
        "joints that are left out count in the total",
        "drift is clipped and kept",
        "slip",
        "slip by the shear limit",
        "threshold and drift limit can be set",
    ],
)
def test_the_index_of_an_instant(given, expected):
    row = index_of(**given)
    assert {name: row[name] for name in expected} == approx(expected)


def test_index_is_now_and_not_ever():
    frame = damage_index(
        [0.0, 1.0],
        [0.01, 0.0],
        np.array([[1e-3] * 4, [0.0] * 4]),
        np.zeros((2, 4)),
        np.zeros((2, 4), bool),
        LENGTH,
    )
    assert_allclose(frame.DI, [1.0, 0.0])


@pytest.mark.parametrize(
    "options",
    [
        {"drift_limit": -1.0},
        {"slip_criterion": "sliding"},
    ],
)
def test_bad_options_are_refused(options):
    refused_with("expected", index_of, **options)


# --- slip over the overlap of the faces -----------------------------------------------------------

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
    first = CONTACTS.first[row]
    second = CONTACTS.second[row]
    x = LAYOUT.bodies.x
    length = LAYOUT.bodies.length
    return (x[first] - x[second], length[first], length[second]) == approx((0.1125, 0.225, 0.225))


BED = joint_of(0, 2, on_its_left)
HEAD = joint_of(1, 2)
BASE = joint_of(0, 0)


def test_faces_end_where_bricks_do():
    least, most = LAYOUT.slide_limits
    assert (least[BED], most[BED]) == approx((-0.1125, 0.3375))
    assert (least[HEAD], most[HEAD]) == approx((-0.075, 0.075))
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
    assert summary["max_offset_over_overlap"] == approx(share, abs=1e-7)


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
    ended = r"^ended joints +2 +whose faces no longer overlap$"
    assert re.search(ended, describe(summary), re.MULTILINE)
    assert np.flatnonzero(joints_table(history)["ended"]).tolist() == sorted([BED, twin, HEAD])
    none = summarise(make_history(tmp_path / "b.h5"))
    assert none["ended_joints"] == 0 and "ended joints" not in describe(none)
