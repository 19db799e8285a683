"""Envelope, cycles and failure mode of pushed walls, against closed forms; the tests' measured
figures."""

import json

import numpy as np
import pandas as pd
import pytest
from conftest import REPOSITORY, one_line_error, refused_with, run_here, written
from numpy.testing import assert_allclose
from small_history import CYCLIC, make_history, small_layout

from damage import Joint, brick_of_masonry
from damage.applications.cracks.capacity import (
    ULTIMATE_DRIFT_NOTE,
    backbone,
    bilinear,
    capacity,
    capacity_curve,
    cycles_table,
    draws_needed,
    drift_at_first_crack,
    envelope,
    mean_force,
    mode_shares,
)
from damage.applications.cracks.loops import loops_at, read_loops
from damage.applications.cracks.pushed import (
    describe,
    describe_draws,
    draws_report,
    figures,
    pushed_report,
    read_test,
)
from damage.measure.pushed import hand_capacities

# [N/m], [N] of an elastic, perfectly plastic wall
STIFFNESS = 50e6
YIELD = 20e3


def plastic_force(displacement):
    """Force of an elastic, perfectly plastic spring along a path of displacements."""
    force = np.zeros_like(displacement)
    for k, step in enumerate(np.diff(displacement)):
        force[k + 1] = np.clip(force[k] + STIFFNESS * step, -YIELD, YIELD)
    return force


@pytest.fixture(scope="module")
def plastic(tmp_path_factory):
    """Three cycles of 0.2 % of an elastic, perfectly plastic wall that cracks in stairs."""
    layout = small_layout()
    time_s = np.arange(0, CYCLIC.schedule(layout.drift_height)[0][-1] + 0.002, 0.002)
    displacement = CYCLIC.top_displacement(time_s, layout.drift_height)
    return make_history(
        tmp_path_factory.mktemp("plastic") / "small.h5",
        layout,
        stages=("motion",) * len(time_s),
        step_s=0.002,
        drift=displacement / layout.drift_height,
        row={"base_shear_n": plastic_force(displacement)},
        loading="cyclic",
    )


class TestCycles:
    def test_area_and_damping_of_a_plastic_loop(self, plastic):
        """E_d = 4 F (a - u_y), xi = (2 / pi) (1 - u_y / a) in steady cycles."""
        table = cycles_table(plastic)
        amplitude = 0.002 * small_layout().drift_height
        elastic = YIELD / STIFFNESS
        assert len(table) == 3 and list(table.amplitude_pct) == [0.2, 0.2, 0.2]
        steady = table.iloc[1]
        assert_allclose(steady.dissipated_j, 4 * YIELD * (amplitude - elastic), rtol=2e-3)
        assert_allclose(steady.equivalent_damping, 2 / np.pi * (1 - elastic / amplitude), rtol=2e-3)
        assert_allclose([steady.max_force_kn, steady.min_force_kn], [20, -20])
        residual = 100 * (amplitude - elastic) / small_layout().drift_height
        assert_allclose(
            [steady.residual_max_pct, steady.residual_min_pct], [residual, -residual], rtol=2e-3
        )
        assert_allclose(
            steady.max_drift_pct, 100 * amplitude / small_layout().drift_height, rtol=5e-4
        )

    def test_shaken_walls_have_none(self, still_history, error_of):
        assert "pushover" in error_of("cycles", still_history.path)


class TestLoops:
    DRIFT = np.array([0.3, 0.1, -0.3, -0.1, 0.3])  # [%] of a wall 2 m high
    SLIDER = np.array([10, -10, -10, 10, 10])  # [kN]

    def loops(self, path, force, drift=DRIFT, extra=""):
        rows = "".join(f"a,2,{x},{y}\n" for x, y in zip(drift, force))
        return written(path, f"loop,height_m,drift_pct,force_kn\n{rows}{extra}")

    def test_closed_forms(self, tmp_path):
        """Friction and spring: 4 F (u - F / k) = 4 x 10 kN x 4 mm, wherever zero is; rigid and
        plastic: 2 / pi; elastic: nothing."""
        path = self.loops(tmp_path / "a.csv", self.SLIDER)
        (loop,) = read_loops(path)
        assert_allclose([loop["dissipated_j"], loop["residual_max_pct"]], [160, 0.2])
        assert_allclose(loop["equivalent_damping"], 2 / np.pi * (1 - 2 / 6))
        (moved,) = read_loops(self.loops(path, self.SLIDER + 20, self.DRIFT + 1))
        assert_allclose(moved["equivalent_damping"], loop["equivalent_damping"])
        assert np.isnan(moved["residual_max_pct"])
        (plastic,) = read_loops(self.loops(path, self.SLIDER, np.array([3, 3, -3, -3, 3])))
        assert_allclose(plastic["equivalent_damping"], 2 / np.pi)
        (elastic,) = read_loops(self.loops(path, 50 * self.DRIFT))
        assert_allclose([elastic["dissipated_j"], elastic["equivalent_damping"]], 0, atol=1e-9)

    def test_a_test_beside_a_run(self, tmp_path, plastic, output_of):
        path = self.loops(tmp_path / "a.csv", self.SLIDER)
        found = json.loads(output_of("cycles", plastic.path, path, "--json"))
        assert_allclose(found["tested_loops"][0]["dissipated_j"], 160)
        assert found["tested_loops"][0]["run_dissipated_j"] is None  # cycles of 0.2 %
        between = pd.DataFrame(
            {
                "max_drift_pct": [0.3, 0.1],
                "min_drift_pct": [-0.1, -0.1],
                "dissipated_j": [40.0, 20.0],
                "equivalent_damping": [0.3, 0.1],
            }
        )
        assert_allclose(loops_at(between, 0.15), [30, 0.2])
        assert "dissipated_j" in output_of("cycles", path)

    @pytest.mark.parametrize(
        ("force", "drift", "words"),
        [
            (1e4, 1, "the largest force = 100000 kN, expected 0.01 to 10000 kN: 100000 N is"),
            (
                1,
                0.01,
                "the largest loop's drift = 0.003 %, expected 0.005 to 1.5 %: 0.003 as a ratio",
            ),
            (1, 20, "the smallest loop's drift = 6 %, expected 0.005 to 1.5 %: 6 mm is 0.3 %"),
        ],
    )
    def test_loops_in_other_units_are_named(self, tmp_path, capsys, force, drift, words):
        """A force in N, a drift as a ratio, a displacement in mm of a wall 2 m high."""
        read_loops(self.loops(tmp_path / "a.csv", force * self.SLIDER, drift * self.DRIFT))
        assert words in capsys.readouterr().err
        read_loops(self.loops(tmp_path / "b.csv", self.SLIDER))
        assert not capsys.readouterr().err

    @pytest.mark.parametrize(
        "words, force, drift, extra",
        [
            ("turn them round", -SLIDER, DRIFT, ""),
            ("closed loop", [10, -10], [0.3, -0.3], ""),
            ("two heights", SLIDER, DRIFT, "a,3,0.3,10\n"),
        ],
    )
    def test_bad_loops_are_refused(self, tmp_path, words, force, drift, extra):
        path = self.loops(tmp_path / "a.csv", force, drift, extra)
        assert words in one_line_error(read_loops, path)


class TestEnvelope:
    def test_loading_beyond_what_was_reached(self, plastic):
        for sign in (1, -1):
            curve = envelope(plastic, sign)
            assert np.all(np.diff(curve.drift_ratio) > 0)
            assert_allclose(
                curve.drift_ratio.iloc[-1], plastic.series.drift_ratio.abs().max(), rtol=5e-4
            )
            assert_allclose(curve.force_n.iloc[-1], YIELD)

    def test_of_a_triangle_by_hand(self):
        """Up to 100 kN at 0.1 %, down to 50 kN at 0.2 %, a wall 2 m high: 80 kN are left at 0.14 %,
        where the area is (50 + 36) N per unit drift times 2 m; K = 50 kN/mm, and F (d_u - F / 2 K)
        = 172 N m."""
        curve = pd.DataFrame({"drift_ratio": [1e-3, 2e-3], "force_n": [100e3, 50e3]})
        line = bilinear(curve, 2.0)
        assert_allclose(
            [line["stiffness_n_per_m"], line["ultimate_drift"], line["energy_j"]],
            [50e6, 1.4e-3, 172.0],
        )
        force = line["force_n"]
        ultimate = 2.8e-3
        assert_allclose(force * (ultimate - force / 50e6 / 2), 172.0)
        assert_allclose(line["elastic_drift"], force / 50e6 / 2)
        assert_allclose([mean_force(curve, 1e-3), mean_force(curve, 2e-3)], [50e3, 62.5e3])

    def test_a_backbone_leaves_out_the_branch_between_two_cycles(self, plastic):
        """The wall slides: in the negative direction its samples begin near zero drift with all of
        the force."""
        for sign in (1, -1):
            curve = backbone(plastic, sign)
            assert (
                curve["drift_ratio"].is_monotonic_increasing
                and (curve["force_n"] > 0.99 * YIELD).all()
            )
            assert capacity_curve(plastic, sign).equals(curve)
        assert (
            envelope(plastic, -1)["drift_ratio"].iloc[0]
            < 0.05 * backbone(plastic, -1)["drift_ratio"].iloc[0]
        )


def crack(tmp_path, *, opening=None, slip=None):
    return make_history(
        tmp_path / "cracked.h5",
        stages=("motion",) * 3,
        drift=[0, 1e-3, 5e-4],
        opening=opening,
        slip=slip,
        loading="cyclic",
    )


def stair(layout):
    """A head joint in the middle of the wall and the bed joints' points beside it."""
    contacts = layout.contacts
    brick = layout.wall.brick
    heads = np.flatnonzero((contacts.kind == 1) & (np.abs(contacts.z - 2.5 * brick.height) < 0.01))
    head = heads[len(heads) // 2]
    beside = np.flatnonzero(
        (contacts.kind == 0)
        & (np.abs(contacts.x - contacts.x[head]) < brick.length / 2)
        & (np.abs(contacts.z - contacts.z[head]) < 0.51 * brick.height)
    )
    return head, beside


def test_hand_formulas_of_a_panel(plastic):
    """0.9 x 0.45 m of bricks of 225 x 75 mm under 0.3 MPa, a cantilever."""
    found = hand_capacities(plastic.masonry_wall, "cantilever")
    top = 0.3e6 * 0.9 * 0.1025
    weight = 1900 * 9.81 * 0.9 * 0.45 * 0.1025
    assert_allclose(found["rocking"], (top + weight) * (0.45 - 0.028125) / 0.55)
    assert_allclose(found["sliding_base"], (top + weight) * np.tan(np.radians(32)))
    shear = (0.24e6 + 0.6249 * 0.3042e6) / (1 + 2 * 0.6249 / 3)
    assert_allclose(found["diagonal"], shear * 0.9 * 0.1025 / 1.5, rtol=1e-3)


class TestMode:
    def test_slip_beside_an_opened_head_joint_is_a_stair(self, tmp_path):
        head, beside = stair(small_layout())
        shares = mode_shares(
            crack(tmp_path, opening={head: 5e-4}, slip=dict.fromkeys(beside, -4e-4))
        )
        assert (
            shares["stair_share"] == 1
            and shares["mode"] == "shear, diagonal"
            and shares["opened_m"] == 0
        )

    def test_slip_along_a_bed_joint_is_not(self, tmp_path):
        layout = small_layout()
        base = np.flatnonzero((layout.contacts.kind == 0) & (layout.contacts.z < 1e-6))
        shares = mode_shares(crack(tmp_path, slip=dict.fromkeys(base, 4e-4)))
        assert shares["stair_share"] == 0 and shares["mode"] == "shear, sliding"
        assert_allclose([shares["slipped_m"], shares["slipped_m2"]], [0.9, 0.9 * 4e-4])

    def test_a_bed_joint_that_opens_is_flexure(self, tmp_path):
        assert (
            mode_shares(crack(tmp_path, opening={0: 2e-3, 1: 1e-3}, slip={7: 2e-4}))["mode"]
            == "flexure"
        )

    def test_it_is_that_of_the_largest_drift_up_to_a_limit(self, tmp_path):
        history = crack(tmp_path, opening={0: 2e-3})
        assert mode_shares(history)["drift_ratio"] == 1e-3
        assert mode_shares(history, until=6e-4)["drift_ratio"] == 5e-4

    def test_no_crack_no_mode(self, tmp_path):
        history = crack(tmp_path, opening={0: 0.9e-4})
        assert mode_shares(history)["mode"] is None and drift_at_first_crack(history) is None


def pushed_over(path, force, drift, *, seed=0, **more):
    """A push of the small wall, whose base shear and drift are as given."""
    return make_history(
        path,
        stages=("motion",) * len(drift),
        drift=drift,
        loading="pushover",
        row={"base_shear_n": force},
        model={"strength_cov": 0.35, "strength_seed": seed},
        **more,
    )


class TestFigures:
    """Figures of any wall that was pushed, as docs/validation/after-the-peak.md has them."""

    DRIFT = np.linspace(0.0, 2e-3, 2001)

    def test_a_push_is_averaged_and_its_mode_is_that_at_the_ultimate_drift(self, tmp_path):
        """20 kN to 0.1 %, with a shock of 30 kN in one sample; then 10 kN, while a joint opens
        wide."""
        force = np.where(self.DRIFT <= 1e-3, 20e3, 10e3) * np.minimum(1.0, self.DRIFT / 1e-4)
        force[500] = 30e3
        opens_late = np.where(np.arange(2001) >= 1500, 5e-3, 0.0)
        history = pushed_over(
            tmp_path / "pushed.h5", force, self.DRIFT, slip={7: 2e-4}, opening={0: opens_late}
        )
        found = capacity(history)
        # ten samples a window, and a few of eleven
        assert_allclose(found["peak_force_n"], 21e3, rtol=0.01)
        assert_allclose(found["ultimate_drift"], 1e-3, rtol=0.02)
        assert found["ended"] and found["failure"]["mode"] == "shear, sliding"
        assert mode_shares(history)["mode"] == "flexure"
        assert_allclose(
            capacity(history, 2e-3)["mean_force_n"],
            (20e3 * 0.95e-3 + 10e3 * 1e-3) / 2e-3,
            rtol=0.02,
        )
        assert capacity(history, 3e-3)["mean_force_n"] is None
        rows = {row["figure"]: row for row in pushed_report(history, 5e-4)["figures"]}
        assert_allclose(rows["mean force to 0.05 % drift"]["simulated"], 18, rtol=0.02)
        assert rows["peak force"]["measured"] is None

    def test_of_several_draws_medians_and_how_many_are_needed(self, tmp_path):
        drift = self.DRIFT[::10]
        histories = [
            pushed_over(
                tmp_path / f"{seed}.h5", size * np.minimum(drift, 1e-4) / 1e-4, drift, seed=seed
            )
            for seed, size in enumerate((18e3, 20e3, 25e3), start=1)
        ]
        found = draws_report(histories)
        (peak,) = [row for row in found["figures"] if row["figure"] == "peak force"]
        assert_allclose([peak["median"], peak["quantile_05"], peak["quantile_95"]], [20, 18, 25])
        assert peak["draws_needed"] == draws_needed([18, 20, 25]) and found["not_ended"] == 3
        assert "same draw" in one_line_error(draws_report, [histories[0], histories[0]])


PREDICTED = REPOSITORY / "docs" / "tables" / "shear_walls_prediction.csv"
TESTED_PCT = {
    "SW0.1": 0.29,
    "SW0.2": (0.30 + 0.41) / 2,
    "MW0.1": 0.19,
    "MW0.2": 0.26,
    "LW0.1": 0.18,
    "LW0.2": (0.21 + 0.25) / 2,
    "HfBW0.1": 0.305,
    "HfBW0.2": 0.345,
    "LfBW0.1": 0.19,
    "LfBW0.2": 0.15,
    "COMP2_5": 1.43,
}
"""Ultimate drifts of the tests, means of both directions."""


class TestUltimateDrift:
    def test_its_note_is_that_of_the_predicted_walls(self):
        predicted = pd.read_csv(PREDICTED).set_index("wall")["ultimate_drift_pct"]
        predicted["COMP2_5"] = 0.095
        ratios = predicted / pd.Series(TESTED_PCT)
        off = (np.abs(np.log(ratios)) > np.log(2)).sum()
        assert ULTIMATE_DRIFT_NOTE == (
            f"predicted ones were {ratios.min():.2f} to {ratios.max():.1f} of the tested ones, off"
            f" by more than a factor of 2 in {off} of {len(ratios)} walls"
        )

    def test_it_stands_beside_each(self, plastic, tmp_path):
        printed = describe(pushed_report(plastic))
        drifts = [line for line in printed.splitlines() if "ultimate drift" in line]
        values = [line for line in drifts if "failure" not in line and "mean force" not in line]
        # of both directions, and their mean
        assert sum(ULTIMATE_DRIFT_NOTE in line for line in values) == 3
        assert capacity(plastic)["ultimate_drift_note"] == ULTIMATE_DRIFT_NOTE
        drift = np.linspace(0.0, 1e-3, 200)
        histories = [
            pushed_over(
                tmp_path / f"{seed}.h5", 2e4 * np.minimum(drift, 1e-4) / 1e-4, drift, seed=seed
            )
            for seed in (1, 2)
        ]
        drawn = describe_draws(draws_report(histories))
        assert drawn.count(ULTIMATE_DRIFT_NOTE) == 1


class TestMeasured:
    def test_stiffness_and_peaks_of_the_squat_wall(self):
        test = read_test("COMP1_3")
        assert_allclose(test.directions["stiffness_n_per_m"] / 1e6, [131, 163], atol=0.5)
        assert_allclose(test.directions["peak_force_n"] / 1e3, [76.7, 77.96])
        assert test.mode == "shear" and read_test("COMP2_1").mode == "flexure"


class TestLaboratoryWalls:
    def test_masonry_softer_than_its_bricks_can_make_it_is_refused(self):
        refused_with("softer", brick_of_masonry, 1e12, Joint())

    @pytest.mark.long
    def test_squat_wall_is_near_its_test(self, tmp_path):
        """Stiffness within 25 %, peak force within 15 % of the measured means."""
        history = run_here(
            tmp_path / "squat.h5", "walls/squat.py", "--pushover", 0.1, "--speed", 2e-3
        )
        rows = {name: (simulated, measured) for name, _, simulated, measured in figures(history)}
        simulated, measured = rows["stiffness, secant to 0.7 of the peak"]
        assert_allclose(simulated, measured, rtol=0.25)
        simulated, measured = rows["peak force"]
        assert_allclose(simulated, measured, rtol=0.15)
        simulated, measured = rows["failure mode at the ultimate drift"]
        assert simulated.startswith(measured)
