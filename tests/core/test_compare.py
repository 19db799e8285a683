"""Comparison of histories, and fractions skill scores of crack patterns: cases whose answer is
known."""

import json

import numpy as np
import pytest
from numpy.testing import assert_allclose
from pytest import approx
from small_history import make_history

from damage import Wall
from damage.applications.cracks.compare import cohens_kappa, compare, compare_drift, describe
from damage.applications.cracks.patterns import (
    compare_patterns,
    cracked,
    fractions_skill_score,
    places_of,
)
from damage.wall.layout import lay_out

N = 1200
TIME = 1e-3 * np.arange(N)


def history(path, drift, **options):
    """A motion and rest of 1.2 s with that drift, no settling."""
    stages = options.pop("stages", ["motion"] * 200 + ["rest"] * (N - 200))
    return make_history(path, stages=stages, step_s=1e-3, drift=drift, **options)


def wave(amplitude=1e-3, period=0.1, late=0.0):
    return amplitude * np.sin(2 * np.pi * (TIME - late) / period)


def test_a_run_agrees_with_itself(tmp_path):
    run = history(tmp_path / "a.h5", wave(), opening={0: 3e-4}, broken={0: 1}, at_limit={1: 1})
    result = compare(run, [run])
    assert result["agrees"] and result["drift"]["rms_whole"] == 0.0
    assert all(row["first"] == row["median"] for row in result["figures"].values())
    assert "within the tolerances" in describe(result)
    json.dumps(result)


def test_drift_rms_is_the_relative_amplitude_of_the_difference(tmp_path):
    first = history(tmp_path / "a.h5", wave(1.00e-3))
    second = history(tmp_path / "b.h5", wave(1.01e-3))
    assert compare_drift(first, second)["rms_before_failure"] == approx(0.01, rel=1e-6)
    assert not compare_drift(first, second)["agrees"]


def test_the_median_of_an_ensemble_is_judged(tmp_path):
    first = history(tmp_path / "a.h5", wave(1.0e-3))
    others = [
        history(tmp_path / f"{k}.h5", wave(scale * 1e-3))
        for k, scale in enumerate((0.5, 0.99, 3.0))
    ]
    row = compare(first, others)["figures"]["max_drift_ratio"]
    assert row["median"] == approx(0.99e-3, rel=1e-3) and row["agrees"]
    assert row["range"] == approx([0.5e-3, 3e-3], rel=1e-3)


@pytest.mark.parametrize(("factor", "agrees"), [(1.019, True), (1.022, False)])
def test_tolerance_of_the_maximum_drift(tmp_path, factor, agrees):
    first = history(tmp_path / "a.h5", wave(factor * 1e-3))
    row = compare(first, [history(tmp_path / "b.h5", wave(1e-3))])["figures"]["max_drift_ratio"]
    assert row["agrees"] is agrees


@pytest.mark.parametrize(("width", "agrees"), [(1.58, True), (1.62, False)])
def test_psi_is_compared(tmp_path, width, agrees):
    """Psi grows as the width to the power 0.3: 1.15 times at 1.593 times the width."""
    first, second = (
        history(tmp_path / f"{name}.h5", wave(), opening={0: opening}, broken={0: 1})
        for name, opening in (("a", width * 1e-3), ("b", 1e-3))
    )
    row = compare(first, [second])["figures"]["Psi"]
    assert row["median"] == approx(2.0) and row["agrees"] is agrees
    assert "Psi " in describe(compare(first, [second]))


class TestKappa:
    def test_by_hand(self):
        # 2 x 2 table 20, 5, 10, 15: observed 0.7, by chance 0.5, kappa 0.4.
        here = [0] * 25 + [1] * 25
        there = [0] * 20 + [1] * 5 + [0] * 10 + [1] * 15
        assert cohens_kappa(here, there) == approx(0.4)


# --- patterns of cracks ---------------------------------------------------------------------------

LAYOUT = lay_out(Wall("wide", 3.6, 1.5))
X, Z = (getattr(LAYOUT.contacts, name)[: LAYOUT.n_joints] for name in ("x", "z"))


def patterned(path, joints, **more):
    """A wall of 3.6 x 1.5 m in which these joints are broken."""
    return make_history(path, LAYOUT, broken=np.flatnonzero(joints), **more)


@pytest.fixture
def left(tmp_path):
    return patterned(tmp_path / "left.h5", (X < 0.5) & (Z < 0.5))


def test_scores_by_hand():
    half = np.array([0.5, 0.5, 0.0])
    assert fractions_skill_score(half, half) == 1.0
    assert fractions_skill_score(half, np.array([0.0, 0.0, 1.0])) == 0.0
    # 1 - 0.25 / (0.5 + 0.25)
    assert fractions_skill_score(half, np.array([0.5, 0.0, 0.0])) == approx(2 / 3)
    assert fractions_skill_score(0 * half, 0 * half) is None


def test_fractions_are_shares_of_the_joint_length_in_a_window(left):
    places, broken = places_of(left), cracked(left, "broken")
    assert_allclose(places.fractions(np.ones(len(X), bool)), 1.0)
    share = places.fractions(broken).reshape(48, 20)  # windows every 0.075 m
    assert share[2, 2] == 1.0 and share[24, 10] == 0.0
    assert_allclose(
        places.fractions(broken, mirrored=True).reshape(48, 20), share[::-1], atol=1e-12
    )


def test_a_neighbour_scores_high_and_the_other_side_nothing(tmp_path, left):
    beside = patterned(tmp_path / "beside.h5", (X > 0.1) & (X < 0.6) & (Z < 0.5))
    right = patterned(tmp_path / "right.h5", (X > 3.1) & (Z < 0.5))
    near, far, same = (compare_patterns(left, other)["broken"] for other in (beside, right, left))
    assert same["fss"] == 1.0 and 0.85 < near["fss"] < 1.0 and far["fss"] == 0.0
    assert near["tells_sides"] and far["mirrored"] == approx(1.0) and not far["tells_sides"]
    assert near["shuffled"] < 0.5


def test_a_crack_counts_up_to_the_end_of_the_motion(tmp_path):
    stages = ("motion",) * 10 + ("rest",) * 6 + ("settling",) * 5
    for first, seen in ((4, True), (12, False)):
        opening = np.where(np.arange(21) == first, 3e-4, 0.0)
        run = make_history(tmp_path / f"{first}.h5", LAYOUT, stages=stages, opening={7: opening})
        assert cracked(run, "visible")[7] == seen and cracked(run, "visible").sum() == seen
        assert cracked(run, "broken")[7] == seen
