"""Soil, floors and gables in YADE beside the reference solver; a run that continues in YADE."""

import numpy as np
import pytest
from conftest import SHORT, wall_file, written
from numpy.testing import assert_allclose, assert_array_equal

from damage import read_history
from damage.applications.cracks.compare import compare_drift
from damage.measure.energy import energy_error_of

pytestmark = pytest.mark.yade

SMALL = "Wall('small', 1.125, 0.6, [Opening(0.3375, 0.45, 0.3, 0.15)], joint=Joint({joint}))"
SOFT = "mode_i_fracture_energy=12.4, mode_ii_fracture_energy=124.0"


def test_a_wall_on_soil_lifts_off_alike(tmp_path, in_both):
    """Softening joints, undamped.  A base joint has cohesion and no tensile
    strength, which YADE's law would not check."""
    path = wall_file(tmp_path / "pier.py", f"Wall('pier', 0.45, 0.6, joint=Joint({SOFT}))")
    yade, reference = histories = in_both(
        tmp_path,
        path,
        "--harmonic 0.1 0.2 --cycles 1 --rest 0.05 --soil 3e8",
        yade=SHORT,
        reference=("--beta 0 --mass-scaling none",),
    ).values()
    assert_allclose(
        *(history.series["drift_ratio"].abs().max() for history in histories), rtol=0.01
    )
    assert compare_drift(yade, reference)["rms_before_failure"] < 5e-3
    base = (reference.joints["first_body"] < 0).to_numpy()
    assert reference.broken[-1][base].any() and reference.opening_m[:, base].max() > 5e-4
    assert_allclose(yade.opening_m[:, base].max(), reference.opening_m[:, base].max(), rtol=0.01)
    assert max(map(energy_error_of, histories)) < 1e-3


@pytest.fixture(scope="module")
def halves(tmp_path_factory, yade_command):
    """A folder with one run of two events, whole.h5, its first event, first.h5, and its second one
    from the end of the first, second.h5; what the last run printed."""
    folder = tmp_path_factory.mktemp("halves")
    path = wall_file(folder / "small.py", SMALL.format(joint=""))

    def run(words):
        # No joint opens or slides by 0.4 mm, from which bricks collide and a run that continues
        # sums in another order.
        return yade_command(
            *SHORT,
            path,
            "--harmonic 0.06 0.3 --cycles 1 --rest 0 --no-pictures",
            words,
            cwd=folder,
        )

    done = [
        run("--sequence 1,0.6 --out whole.h5"),
        run("--out first.h5 --checkpoint 10"),
        run("--sequence 0.6 --continue first.h5 --out second.h5"),
    ]
    assert [one.returncode for one in done] == [0, 0, 0], done
    return folder, done[-1].stderr


@pytest.mark.long
def test_a_run_that_continues_starts_from_a_checkpoint_and_says_what_that_executes(halves):
    folder, said = halves
    assert (
        "first.checkpoint: YADE executes the names of the engines in the scene that it holds"
        in said
    )
    assert not (folder / "whole.checkpoint").exists()
    whole, second = (read_history(folder / f"{name}.h5") for name in ("whole", "second"))
    n = len(second.series)
    assert second.broken[0].any() and n == np.sum(whole.series["shock"] == 2) + 1
    for name in second.series.columns.drop(["time_s", "shock", "stage"]):
        expected = whole.series[name].to_numpy()[1 - n :]
        # The work that comes in is summed over time, which begins at zero again: the length of a
        # step rounds otherwise.
        assert_allclose(
            second.series[name].to_numpy()[1:],
            expected,
            err_msg=name,
            rtol=0,
            atol=(
                1e-12 * np.max(np.abs(expected), initial=0)
                if name in ("input_energy_j", "damping_energy_j")
                else 0
            ),
        )
    for name in ("opening_m", "slip_m", "offset_m", "broken", "at_limit", "support_force"):
        assert_array_equal(getattr(second, name), getattr(whole, name)[-n:], name)


# --- a gable with a slab, a timber floor and a lintel ---------------------------------------------

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
    return in_both(folder, wall, "--harmonic 0.05 0.2 --cycles 1 --rest 0.02 --stresses")


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


def test_both_solvers_have_the_same_stresses(runs):
    """At rest and in the motion; YADE's static stage is kept, too."""
    yade, reference = runs.values()
    largest = np.abs(reference.joint_stress_pa[0]).max()
    assert_allclose(yade.joint_stress_pa[0], reference.joint_stress_pa[0], atol=1e-5 * largest)
    n = min(len(yade.series), len(reference.series))
    moving, expected = (history.joint_stress_pa[:n] for history in (yade, reference))
    assert_allclose(moving, expected, atol=2e-3 * largest)
    assert len(yade.static_stage) > 5 and yade.static_stage["unbalanced_force"].iloc[-1] < 1e-5
