"""Modelling choices combined: effects of a factorial by hand."""

import numpy as np
import pytest

from paper.combinations import (
    effects,
    is_orthogonal,
)


def test_effects_of_a_full_factorial_by_hand():
    """Met by 3 of 4: a or b.  Means 1/2 and 1 at the levels of each; the variance is 3/16, of which
    each has 1/16."""
    levels = np.array([[-1, -1], [-1, 1], [1, -1], [1, 1]])
    differences, alone, pairs = effects([False, True, True, True], levels)
    assert differences == pytest.approx([0.5, 0.5])
    assert (alone, pairs) == pytest.approx((2 / 3, 1.0))
    # an interaction alone
    assert effects([True, False, False, True], levels)[1:] == pytest.approx((0.0, 1.0))
    assert is_orthogonal(levels, with_pairs=True) and not is_orthogonal(levels[:3])
    # a choice with one level only has no effect
    single = np.column_stack([levels, -np.ones(4, int)])
    differences, alone, pairs = effects([False, True, True, True], single)
    assert differences == pytest.approx([0.5, 0.5, np.nan], nan_ok=True)
    assert (alone, pairs) == pytest.approx((2 / 3, 1))
