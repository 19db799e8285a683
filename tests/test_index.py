"""The damage index: equations (1) to (4), thresholds, clipping, criteria."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from damage.errors import InputError
from damage.index import damage_index

LENGTH = np.array([1.0, 2.0, 3.0, 4.0])  # [m], 10 m in all


def index_of(drift=0.0, opening=(0, 0, 0, 0), slip=(0, 0, 0, 0), at_limit=(0, 0, 0, 0), **options):
    frame = damage_index([0.0], [drift], np.array([opening], float), np.array([slip], float),
                         np.array([at_limit], bool), LENGTH, **options)
    return frame.iloc[0]


def test_lengths_over_the_threshold_add_up():
    row = index_of(opening=(2e-4, 0, 0.9e-4, 1.1e-4), slip=(0, -2e-4, 0, 0))
    assert row.DI_open == pytest.approx(0.5) and row.DI_slip == pytest.approx(0.2)


def test_index_combines_the_three_by_equation_one():
    row = index_of(drift=-0.005, opening=(2e-4, 0, 0, 0), slip=(0, 2e-4, 0, 0))
    assert row.DI_drift == pytest.approx(0.25)
    assert row.DI == pytest.approx(1 - 0.75 * 0.9 * 0.8)


def test_lengths_that_are_left_out_count_in_the_total():
    row = index_of(opening=(2e-4, 0, 0, 0), slip=(0, 2e-4, 0, 0), total_length=20.0)
    assert (row.DI_open, row.DI_slip) == pytest.approx((0.05, 0.1))


def test_no_damage_is_exactly_zero_and_all_damage_exactly_one():
    assert index_of().DI == 0.0
    assert index_of(opening=(1, 1, 1, 1)).DI == 1.0


def test_drift_is_clipped_and_kept():
    row = index_of(drift=0.05)
    assert row.DI_drift == 1.0 and row.drift_over_limit == pytest.approx(2.5)


def test_the_two_slip_criteria():
    joints = {"slip": (2e-4, 0, 0, 0), "at_limit": (0, 0, 1, 1)}
    assert index_of(**joints).DI_slip == pytest.approx(0.1)
    assert index_of(**joints, slip_criterion="shear-limit").DI_slip == pytest.approx(0.7)


def test_threshold_and_drift_limit_can_be_set():
    row = index_of(drift=0.005, opening=(2e-4, 0, 0, 0), threshold=3e-4, drift_limit=0.01)
    assert row.DI_open == 0.0 and row.DI_drift == pytest.approx(0.5)


def test_index_is_now_and_not_ever():
    frame = damage_index([0.0, 1.0], [0.01, 0.0], np.array([[1e-3] * 4, [0.0] * 4]), np.zeros((2, 4)),
                         np.zeros((2, 4), bool), LENGTH)
    assert_allclose(frame.DI, [1.0, 0.0])


@pytest.mark.parametrize("options", [{"threshold": 0.0}, {"drift_limit": -1.0}, {"threshold": float("nan")},
                                     {"slip_criterion": "sliding"}])
def test_bad_options_are_refused(options):
    with pytest.raises(InputError, match="expected"):
        index_of(**options)
