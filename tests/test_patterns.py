"""Fractions skill scores of crack patterns on cases whose answer is known."""

import json

import numpy as np
import pytest
from numpy.testing import assert_allclose
from pytest import approx
from small_history import make_history

from damage.measure.compare import compare, describe
from damage.measure.patterns import compare_patterns, cracked, fractions_skill_score, places_of
from damage.wall.layout import lay_out
from damage.wall.model_options import ModelOptions
from damage.wall.parameters import Wall

LAYOUT = lay_out(Wall("wide", 3.6, 1.5))
X, Z = (getattr(LAYOUT.contacts, name)[:LAYOUT.n_joints] for name in ("x", "z"))


def history(path, joints, **more):
    """A wall of 3.6 x 1.5 m in which these joints are broken."""
    return make_history(path, LAYOUT, broken=np.flatnonzero(joints), **more)


@pytest.fixture
def left(tmp_path):
    return history(tmp_path / "left.h5", (X < 0.5) & (Z < 0.5))


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
    assert_allclose(places.fractions(broken, mirrored=True).reshape(48, 20), share[::-1], atol=1e-12)


def test_a_neighbour_scores_high_and_the_other_side_nothing(tmp_path, left):
    beside = history(tmp_path / "beside.h5", (X > 0.1) & (X < 0.6) & (Z < 0.5))
    right = history(tmp_path / "right.h5", (X > 3.1) & (Z < 0.5))
    near, far, same = (compare_patterns(left, other)["broken"] for other in (beside, right, left))
    assert same["fss"] == 1.0 and 0.85 < near["fss"] < 1.0 and far["fss"] == 0.0
    assert near["tells_sides"] and far["mirrored"] == approx(1.0) and not far["tells_sides"]
    assert near["shuffled"] < 0.5


def test_two_discretisations_of_one_pattern_score_high(tmp_path, left):
    corners = lay_out(LAYOUT.wall, ModelOptions(contacts="corners"))
    x, z = (getattr(corners.contacts, name)[:corners.n_joints] for name in ("x", "z"))
    other = make_history(tmp_path / "corners.h5", corners, broken=np.flatnonzero((x < 0.5) & (z < 0.5)))
    assert len(other.joints) != len(left.joints)
    assert compare(left, [other])["patterns"]["broken"]["fss"] > 0.9


def test_a_crack_counts_up_to_the_end_of_the_motion(tmp_path):
    stages = ("motion",) * 10 + ("rest",) * 6 + ("settling",) * 5
    for first, seen in ((4, True), (12, False)):
        opening = np.where(np.arange(21) == first, 3e-4, 0.0)
        run = make_history(tmp_path / f"{first}.h5", LAYOUT, stages=stages, opening={7: opening})
        assert cracked(run, "visible")[7] == seen and cracked(run, "visible").sum() == seen
        assert cracked(run, "broken")[7] == seen


def test_compare_tells_scores_and_controls(tmp_path, left):
    result = compare(left, [left])
    json.dumps(result["patterns"])
    assert "FSS 1.00 (controls: shuffled" in describe(result)
    assert "none in either run" in describe(result)  # nothing opened
    assert result["patterns"]["visible"]["fss"] is None
