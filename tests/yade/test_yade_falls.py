"""A spandrel that falls in YADE and in the reference solver: when its first brick falls, and where
the heap rests."""

import numpy as np
import pytest
from test_ends import DIAMETER

from damage.run.settings import RESTS_BELOW_M_S, RESTS_FOR_S
from paper.falls import INTERVAL_S, first_fall, in_reference, in_yade, overlaps, speeds

pytestmark = [pytest.mark.yade, pytest.mark.long]


@pytest.fixture(scope="module")
def fall():
    return in_yade()


def test_its_first_brick_falls_as_in_the_reference_solver(fall):
    """Within 10 %: the spandrel is a flat arch, so that the depth from which its corners bear
    decides."""
    assert first_fall(fall) == pytest.approx(first_fall(in_reference(0.15)), rel=0.1)


def test_its_bricks_come_to_rest_without_passing_through_each_other(fall):
    assert speeds(fall)[-round(RESTS_FOR_S / INTERVAL_S) :].max() < RESTS_BELOW_M_S
    assert 0 < max(overlaps(fall).values()) < DIAMETER


def test_no_energy_is_created(fall):
    released = fall.energy_j[0] - fall.energy_j[-1]
    assert released > 50.0 and np.diff(fall.energy_j).max() < 0.001 * released
