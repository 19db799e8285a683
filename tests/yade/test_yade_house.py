"""A gable with a slab, a timber floor and a lintel, as data, in YADE and in the reference solver:
one answer."""

import numpy as np
import pytest
from conftest import written
from numpy.testing import assert_allclose

pytestmark = pytest.mark.yade

GABLE = """
name = "gable"
length = 0.8
height = 0.8
precompression = 0
outline = [[0, 0.4], [0.4, 0.8], [0.8, 0.4]]
brick = { length = 0.2, height = 0.1, thickness = 0.1 }
lintel = { kind = "stone", modulus = 1e10, height = 0.1 }
[[openings]]
left = 0.2
width = 0.4
height = 0.1
[[floors]]
level = 0.3
mass = 50
kind = "concrete"
depth = 0.1
[[floors]]
level = 0.6
mass = 20
"""


@pytest.fixture(scope="module")
def runs(tmp_path_factory, in_both):
    """The same motion, too weak for a crack, in both solvers."""
    folder = tmp_path_factory.mktemp("house")
    wall = written(folder / "gable.toml", GABLE)
    return in_both(folder, wall, "--harmonic 0.05 0.2 --cycles 1 --rest 0.02")


@pytest.mark.parametrize("solver", ["yade", "reference"])
def test_at_rest_the_base_carries_bricks_and_floors(runs, solver):
    """A course of 0.4 m, one of 0.2 m beside the lintel of 0.6 m, a whole one above the slab, then
    the gable's of 0.7, 0.5, 0.3 and 0.1 m."""
    history = runs[solver]
    assert (
        len(history.masonry_wall.floors) == 2
        and history.parameters["wall_file"]["file"] == "gable.toml"
    )
    area = (0.4 + 0.2 + 0.8 + 0.7 + 0.5 + 0.3 + 0.1) * 0.1
    assert_allclose(
        history.static["base_reaction_n"],
        9.81 * (area * 0.1 * 1900 + 0.6 * 0.1 * 0.1 * 2700 + 70),
        rtol=1e-9,
    )


def test_both_solvers_agree_before_the_first_failure(runs):
    yade, reference = (runs[name].series for name in ("yade", "reference"))
    assert not runs["yade"].broken.any()
    for name in ("drift_ratio", "base_shear_n"):
        largest = np.abs(reference[name]).max()
        assert_allclose(yade[name].abs().max(), largest, rtol=1e-3)
        assert_allclose(yade[name], reference[name], atol=0.01 * largest)
