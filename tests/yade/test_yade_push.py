"""A wall's top pushed in YADE and in the reference solver: two codes, one answer."""

import numpy as np
import pytest
from conftest import SHORT, wall_file
from numpy.testing import assert_allclose

from damage import read_history
from damage.measure.summary import summarise

pytestmark = pytest.mark.yade

# A square panel: as a cantilever it rocks on its base, held at the top its joints slide.
PANEL = "Wall('panel', 0.9, 0.9, precompression=0.3e6)"
SOFT = (
    "Wall('panel', 0.45, 0.45, precompression=0.1e6, "
    "joint=Joint(mode_i_fracture_energy=5.0, mode_ii_fracture_energy=50.0))"
)
LOCAL = ("--relaxation local",)


@pytest.fixture(
    scope="module", params=[pytest.param("cantilever", marks=pytest.mark.long), "fixed"]
)
def runs(request, tmp_path_factory, in_both):
    """The same push, 0.12 % of drift with local damping, in both solvers; slower where it rocks, so
    that inertia stays below 2 % of the force."""
    folder = tmp_path_factory.mktemp(request.param)
    wall = wall_file(folder / "panel.py", PANEL)
    return request.param, in_both(
        folder,
        wall,
        f"--pushover 0.12 --boundary {request.param} --speed",
        {"cantilever": "2e-3", "fixed": "4e-3"}[request.param],
        yade=SHORT,
        reference=LOCAL,
    )


def test_initial_stiffness_and_peak_force_agree(runs):
    _, histories = runs
    yade, reference = (summarise(histories[solver]) for solver in ("yade", "reference"))
    assert_allclose(
        yade["initial_stiffness_n_per_m"], reference["initial_stiffness_n_per_m"], rtol=0.01
    )
    assert_allclose(yade["peak_force_n"], reference["peak_force_n"], rtol=0.03)


def test_the_same_mechanism(runs):
    boundary, histories = runs
    for history in histories.values():
        index = history.index().iloc[-1]
        # a bed joint opens from one end nearly to the other, none slides
        if boundary == "cantilever":
            assert 0.5 < history.joints.length_m[history.opening_m[-1] > 1e-4].sum() / 0.9 < 1
            assert index.DI_slip == 0
        else:
            assert history.joints.length_m[np.abs(history.slip_m[-1]) > 1e-4].sum() >= 0.9 * 0.8
            assert index.DI_open == 0


def test_forces_by_hand(runs):
    """Rocking about the toe at the base; friction under the cap and the course that slide."""
    boundary, histories = runs
    cap, course, wall = (
        np.array([0.3e6 * 0.9, 1900 * 9.81 * 0.9 * 0.075, 1900 * 9.81 * 0.9 * 0.9]) * 0.1025
    )
    for history in histories.values():
        force = history.series.base_shear_n
        if boundary == "cantilever":
            # The force acts 1 m above the base; contact points lie an eighth of a brick inside the
            # toe.
            assert_allclose(force.max(), (cap + wall) * (0.45 - 0.225 / 8) / 1.0, rtol=0.08)
        else:
            assert_allclose(
                force.iloc[-20:].mean(), (cap + course) * np.tan(np.radians(32)), rtol=5e-3
            )


def test_damping_that_closes_yades_balance_is_lost_energy(runs):
    """YADE's damping energy is inferred; that it only grows, to what the reference counts, is the
    check."""
    _, histories = runs
    yade, reference = (histories[solver].series for solver in ("yade", "reference"))
    lost = yade.damping_energy_j.to_numpy()
    work = yade.input_energy_j.iloc[-1]
    assert np.max(np.maximum.accumulate(lost) - lost) < 1e-3 * work
    assert_allclose(lost[-1], reference.damping_energy_j.iloc[-1], atol=0.01 * work)
    assert_allclose(work, reference.input_energy_j.iloc[-1], rtol=0.03)
    assert summarise(histories["yade"])["energy_error_fraction"] is None
    assert summarise(histories["reference"])["energy_error_fraction"] < 1e-3


@pytest.mark.long
def test_joints_that_soften_do_so_alike(tmp_path, in_both):
    """By one law in both; by itself YADE takes 0.35 of the critical step."""
    wall = wall_file(tmp_path / "panel.py", SOFT)
    yade, reference = in_both(
        tmp_path,
        wall,
        "--pushover 0.05 --speed 5e-3",
        yade=SHORT,
        reference=LOCAL,
    ).values()
    assert "warning" not in (tmp_path / "yade.txt").read_text()
    assert yade.parameters["beta_s"] == 0.0
    assert yade.time_step_s == reference.time_step_s
    # The panel vibrates: 1e-12 m of perturbation moves single samples of the force by 1 %, means of
    # five by 0.3 %.
    peaks = [
        history.series["base_shear_n"].rolling(5).mean().max() for history in (yade, reference)
    ]
    assert_allclose(*peaks, rtol=0.01)
    fracture = [history.series["fracture_energy_j"].iloc[-1] for history in (yade, reference)]
    assert fracture[1] > 0.1
    assert_allclose(*fracture, rtol=0.01)
    partly = (yade.opening_m[-1] > 0) & ~yade.broken[-1]
    assert partly.any()  # open, and not broken: a part of the bond still holds
    assert_allclose(yade.opening_m[-1], reference.opening_m[-1], atol=1e-6)
    assert_allclose(yade.offset_m[-1], reference.offset_m[-1], atol=1e-6)
    assert np.array_equal(yade.broken[-1], reference.broken[-1])


@pytest.mark.long
def test_a_rotational_spring_at_the_top_carries_its_share(tmp_path, yade_command):
    """A block on soil: springs of sway and rocking, the top's, and the weight's moment
    (tests/core/test_settlement.py)."""
    path = wall_file(
        tmp_path / "block.py",
        "Wall('block', 0.6, 1.2, precompression=0.0, brick=Brick(0.6, 1.2, 0.2))",
    )
    spring = 2e6
    yade_command(
        *SHORT,
        path,
        f"--pushover 0.005 --speed 1e-4 --top-rotation {spring} --contacts gauss --soil 1e8",
        "--footing 0.4 --dt 5e-5 --no-pictures --out",
        tmp_path / "a.h5",
        status=0,
    )
    history = read_history(tmp_path / "a.h5")
    up, along = (history.joints[f"{name}_stiffness_pa_m"][0] * 0.2 for name in ("normal", "shear"))
    rock = up * 0.6**3 / 12 + spring - 9.81 * history.bodies["mass_kg"].sum() * 0.6
    last = history.series.iloc[-1]
    expected = 1 / (1 / (along * 0.6) + 0.6**2 / rock)
    assert_allclose(last["top_force_n"] / last["top_displacement_m"], expected, rtol=5e-3)
    assert_allclose(
        last["input_energy_j"], last["elastic_energy_j"] + last["gravity_energy_j"], rtol=0.02
    )


TOE = (
    "Wall('toe', 0.45, 0.9, precompression=0.3e6, joint=Joint(compressive_strength=1e6, "
    "mode_i_fracture_energy=5.0, mode_ii_fracture_energy=50.0))"
)


@pytest.mark.long
def test_a_toe_crushes_alike(tmp_path, in_both):
    """Peak, plateau, crushed length and what is lost; the plateau by hand, of a stress block under
    the cap's centre.

    The third point of the toe comes within 0.1 % of its strength as the wall vibrates: the crushed
    lengths may differ by it.
    """
    path = wall_file(tmp_path / "toe.py", TOE)
    found = []
    crushed = []
    thickness = 0.1025
    length = 0.45
    height = 0.9
    for history in in_both(tmp_path, path, "--pushover 0.3 --speed 5e-3", reference=LOCAL).values():
        summary = summarise(history)
        force = history.series["base_shear_n"].to_numpy()
        late = history.series["drift_ratio"] > 1e-3
        found.append(
            [
                summary["peak_force_n"],
                summary["fracture_energy_j"],
                np.mean(force[late]),
            ]
        )
        crushed.append(summary["crushed_length_m"])
    assert_allclose(*found, rtol=0.02)
    assert_allclose(*crushed, atol=1.01 * length / 8)
    load = (0.3e6 + 1900 * 9.81 * height) * length * thickness
    assert_allclose(
        found[0][2], load * (length - load / 1e6 / thickness) / 2 / (height + 0.1), rtol=0.05
    )


@pytest.mark.long
def test_a_spreader_beam_keeps_the_ratio_of_its_forces(tmp_path, in_both):
    """The column of tests/core/test_floors.py: its floors move as by hand in both."""
    wall = wall_file(
        tmp_path / "column.py",
        "Wall('column', 0.3, 1.2, precompression=0, brick=Brick(length=0.6, height=0.1),"
        " floors=(Floor(0.6, 400.0), Floor(1.2, 200.0)))",
    )
    words = "--pushover 0.002 --floor-share 0.6 0.3 --floor-share 1.2 0.7 --speed 2e-4"
    both = in_both(tmp_path, wall, words, yade=SHORT, reference=LOCAL)
    for history in both.values():
        assert_allclose(history.displacement[-1, [5, 11], 0], [7.588e-6, 2.4462e-5], rtol=2e-3)
        assert_allclose(history.series["top_force_n"].iloc[-5:].mean(), 50.6, rtol=5e-3)


@pytest.mark.long
def test_a_triplet_slides_at_cohesion_and_friction(tmp_path, in_both):
    words = "walls/triplet.toml --pushover 0.05 --speed 4e-5"
    for history in in_both(tmp_path, words, reference=LOCAL).values():
        wall = history.masonry_wall
        force = history.series["top_force_n"]
        stresses = np.array([force.max(), force.iloc[-20:].mean()]) / (2 * 0.21 * 0.1)
        slides = np.tan(wall.joint.friction_angle) * wall.precompression
        assert_allclose(stresses, [slides + wall.joint.cohesion, slides], rtol=0.01)


@pytest.mark.long
def test_the_top_is_free_in_a_run_that_continues_after_a_push(tmp_path, yade_command):
    """And it can be pushed again."""
    wall = "Wall('w', 0.9, 0.3, [Opening(0.35, 0.2, 0.2)])"
    words = [*SHORT, wall_file(tmp_path / "w.py", wall), "--no-pictures --dt 2e-5 --rest 0"]
    push = "--pushover 0.01 --speed 2e-3 --top-rotation 1e5"
    first, shaken, again = (tmp_path / f"{name}.h5" for name in ("first", "shaken", "again"))
    yade_command(*words, push, "--checkpoint 10 --out", first, status=0)
    for motion, out in (("--harmonic 0.05 0.1 --cycles 1", shaken), (push, again)):
        yade_command(*words, motion, "--continue", first, "--out", out, status=0)
    top = read_history(shaken).series["top_displacement_m"]
    assert np.ptp(top) > 1e-5
    drift = read_history(again).series["drift_ratio"]
    assert drift.iloc[-1] - drift.iloc[0] == pytest.approx(1e-4, rel=0.1)
