"""Pictures: they show the data of the history, and legends do not hide it."""

import re
import subprocess
import sys
from dataclasses import replace
from itertools import combinations

import matplotlib
import numpy as np
import pytest
from conftest import one_line_error, refused_with
from matplotlib.figure import Figure
from numpy.testing import assert_allclose
from PIL import Image
from small_history import make_history, small_layout

import damage
from damage.draw import run as pictures
from damage.draw.run import (
    PICTURES,
    drift_picture,
    energy_picture,
    has_heap,
    heap_picture,
    hysteresis_picture,
    index_picture,
    plot_wall,
    save_all,
    wall_picture,
)
from damage.draw.wall import line_width, round_125, wall_shape
from damage.draw.words import motion_words, run_title
from damage.history.moments import STATES
from damage.motion.loading import RecordedMotion
from damage.units import MILLIMETRE
from damage.wall.geometry import body_corners, joint_segments, tributary_ends
from damage.wall.layout import lay_out
from damage.wall.model_options import ModelOptions
from damage.wall.parameters import Wall

SINGLE = 1e-6  # relative: frames and snapshots are stored in single precision
ROUND_OFF = 1e-12  # a few operations in double precision
LAYOUT = small_layout()
REST = np.zeros((len(LAYOUT.bodies), 3))
PULSE = np.sin(np.pi * np.arange(21) / 20)  # largest at sample 10
OPENING = {0: 3.0e-4 * PULSE, 1: 2.0e-4 * PULSE, 20: 1.5e-4 * PULSE, 30: 0.9e-4 * PULSE}
SLIP = {0: -4.0e-4 * PULSE, 5: 2.5e-4 * PULSE}
PEAK = {"opened": [1, 20], "slipped": [5], "both": [0], "broken": [30, 7, 8, 12]}  # joints at sample 10
CASES = {
    "cracked": {"opening": OPENING, "slip": SLIP, "broken": (7, 8), "at_limit": (12,), "drift": 1e-3 * PULSE},
    "nothing happens": {},
    "one sample": {"stages": ("motion",), "status": "interrupted", "snapshots": {}},
    "killed": {"stages": ("motion",) * 3, "status": "unfinished", "drift": 1e-4},
    "no settling": {"stages": ("motion",) * 8 + ("rest",) * 2, "status": "interrupted"},
    "long name": {"loading": "record", "status": "interrupted", "snapshots": {}},
    "failed": {"status": "failed", "drift": np.append(np.zeros(20), 1e3)},
    "free vibration": {"stages": ("rest",) * 16 + ("settling",) * 5, "loading": "free_vibration",
                       "drift": 1.02e-5 * np.sin(np.arange(21)), "row": {"input_energy_j": 0.0}},
    "collapsed": {"stages": ("motion",) * 21, "collapsed_at_s": 0.2, "drift": 0.05 * np.arange(21) / 20,
                  "opening": dict.fromkeys(range(20), 0.02), "row": {"base_acceleration_z_m_s2": 0.1}},
}


@pytest.fixture
def history(tmp_path):
    def make(**options):
        return make_history(tmp_path / "small.h5", LAYOUT, overwrite=True, **options)
    return make


@pytest.fixture(scope="module")
def cracked(tmp_path_factory):
    return make_history(tmp_path_factory.mktemp("cracked") / "small.h5", LAYOUT, **CASES["cracked"])


def collection(figure, label):
    found, = (c for c in figure.axes[0].collections if c.get_label() == label)
    return found


def lengths(segments):
    return sum(np.hypot(*(end - start)) for start, end in segments)


def title(figure):
    return figure._suptitle.get_text()


def line(ax, label):
    found, = (drawn for drawn in ax.get_lines() if drawn.get_label().startswith(label))
    return found


def labels(figure):
    return [text.get_text() for legend in figure.legends for text in legend.get_texts()]


class TestJoints:
    @pytest.mark.parametrize("state", PEAK)
    def test_states_by_hand(self, cracked, state):
        shape = wall_shape(cracked, 10)
        assert sorted(shape.select(state)) == sorted(PEAK[state])
        assert len(collection(wall_picture(cracked, 10), state).get_segments()) == len(PEAK[state])

    @pytest.mark.parametrize("slip", ["displacement", "shear-limit"])
    @pytest.mark.parametrize("threshold", [1e-4, 1.8e-4])
    @pytest.mark.parametrize("sample", [0, 4, 10, 20])
    def test_drawn_lengths_are_those_the_index_counts(self, cracked, sample, threshold, slip):
        figure = wall_picture(cracked, sample, slip, threshold, magnify=0)
        drawn = {state: lengths(collection(figure, state).get_segments()) for state in STATES}
        counted = cracked.index(threshold=threshold, slip=slip).iloc[sample]
        total = LAYOUT.total_joint_length
        assert sum(drawn.values()) == pytest.approx(total, rel=ROUND_OFF)
        assert (drawn["opened"] + drawn["both"]) / total == pytest.approx(counted["DI_open"], rel=ROUND_OFF)
        assert (drawn["slipped"] + drawn["both"]) / total == pytest.approx(counted["DI_slip"], rel=ROUND_OFF)

    def test_crack_width_joins_opening_and_slip(self, cracked):
        # 0.3 mm of opening and 0.4 mm of slip are 0.5 mm.
        drawn = collection(wall_picture(cracked, 10), "both").get_linewidths()
        assert_allclose(drawn, line_width(0.5 * MILLIMETRE), rtol=SINGLE)

    def test_wider_cracks_are_drawn_wider(self, history):
        widths_m = np.geomspace(1.1e-4, 4.9e-3, LAYOUT.n_joints)
        figure = wall_picture(history(opening=dict(enumerate(widths_m))))
        drawn = collection(figure, "opened").get_linewidths()
        assert len(drawn) == LAYOUT.n_joints
        assert np.all(np.diff(drawn) > 0)
        assert line_width(0.02) == line_width(0.005)

    def test_a_stroke_hides_no_more_than_half_of_a_brick(self, tmp_path):
        layout = lay_out(Wall("large", 4.05, 2.7))
        run = make_history(tmp_path / "large.h5", layout, stages=("motion",) * 2,
                           opening={joint: np.array([0, 0.02]) for joint in range(layout.n_joints)})
        figure = wall_picture(run, "end", magnify=0)
        (_, low), (_, high) = figure.axes[0].transData.transform([(0, 0), (0, LAYOUT.bodies.height[0])])
        course_pt = (high - low) / figure.dpi * 72
        widest = collection(figure, "opened").get_linewidths()
        assert 0.4 * course_pt < max(widest) <= 0.5 * course_pt
        assert figure.legends[0].get_lines()[-1].get_linewidth() == pytest.approx(max(widest))  # 5 mm and more

    def test_legend_bounds_the_widest_crack_and_shows_true_widths(self, cracked):
        figure = wall_picture(cracked, 9)  # 0.494 mm at most
        legend = figure.legends[0]
        widths = [handle.get_linewidth() for handle in legend.get_lines()]
        assert labels(figure)[-3:] == ["0.1 mm wide", "0.2 mm wide", "0.5 mm wide"]
        assert_allclose(widths[-3:], line_width(np.array([0.1, 0.2, 0.5]) * MILLIMETRE))

    @pytest.mark.parametrize("contacts", ["interior", "corners", "gauss"])
    def test_tributary_lengths_tile_every_joint(self, tmp_path, contacts):
        layout = lay_out(Wall("small", 0.9, 0.45), ModelOptions(contacts=contacts))
        joints = make_history(tmp_path / "a.h5", layout, stages=("motion",)).joints
        ends = tributary_ends(joints)
        is_bed = (joints["kind"] == "bed").to_numpy()
        for course in range(6):
            # Bed joints: gapless from end to end, at one height, in every course.
            bed = ends[is_bed & np.isclose(joints["z_m"], course * 0.075)]
            bed = bed[np.argsort(bed[:, 0, 0])]
            assert_allclose(bed[1:, 0, 0], bed[:-1, 1, 0], atol=1e-12)
            assert_allclose([bed[0, 0], bed[-1, 1]], [(0, course * 0.075), (0.9, course * 0.075)], atol=1e-12)
        head = ends[~is_bed]
        heights = np.round(head[..., 1] / 0.075, 9)
        assert np.all(head[:, 0, 0] == head[:, 1, 0])
        assert lengths(head) == pytest.approx(sum(3 if course % 2 == 0 else 4 for course in range(6)) * 0.075)
        assert np.all(np.floor(heights[:, 0]) == np.ceil(heights[:, 1]) - 1)  # within one course


class TestShape:
    def test_corner_of_a_turned_brick(self, history):
        motion = REST.copy()
        motion[2] = 2e-4, -1e-4, 1e-3
        figure = wall_picture(history(snapshots={0.1: motion}), 10, magnify=50)
        x, z = LAYOUT.bodies.x[2], LAYOUT.bodies.z[2]
        arm = complex(LAYOUT.bodies.length[2], LAYOUT.bodies.height[2]) / 2
        upper_right = complex(x, z) + 50 * complex(2e-4, -1e-4) + arm * np.exp(1j * 50 * 1e-3)
        drawn = collection(figure, "bricks").get_paths()[2].vertices[2]
        assert_allclose(drawn, [upper_right.real, upper_right.imag], rtol=SINGLE)
        assert "displacements × 50" in title(figure)

    def test_a_rigid_motion_carries_joints_along_and_base_joints_halfway(self, history):
        run = history()
        turn = 0.02
        rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
        centres = np.column_stack([LAYOUT.bodies.x, LAYOUT.bodies.z])
        motion = np.column_stack([centres @ rotation.T - centres, np.full(len(centres), turn)])
        ends = tributary_ends(run.joints)
        carried = ends @ rotation.T
        at_base = (run.joints["first_body"] == -1).to_numpy()
        assert at_base.any()
        moved = joint_segments(run.joints, run.bodies, motion)
        assert_allclose(moved[~at_base], carried[~at_base], atol=1e-12)
        assert_allclose(moved[at_base], (carried[at_base] + ends[at_base]) / 2, atol=1e-12)

    @pytest.mark.parametrize(("push_m", "factor"), [
        (6e-4, 20),     # 3 % of 0.45 m over 0.6 mm is 22.5
        (3e-5, 500),    # 450
        (1e-9, 1000),   # what cannot be seen stays so
        (0.05, 1),      # a collapse is drawn as it is
        (0.0, 1),
    ])
    def test_automatic_magnification(self, history, push_m, factor):
        motion = REST.copy()
        motion[5, 0] = push_m
        run = history(snapshots={0.1: motion})
        shape = wall_shape(run, 10)
        assert shape.magnification == factor
        assert f"displacements × {factor}" in title(wall_picture(run, 10))
        moved = shape.corners[5] - body_corners(run.bodies, REST)[5]
        assert_allclose(moved, np.full((4, 2), (factor * push_m, 0.0)), atol=SINGLE)

    def test_round_125_is_nearest_in_ratio(self):
        assert [round_125(value) for value in (1.4, 1.5, 3.1, 3.2, 7.0, 7.1, 0.014)] == [
            1, 2, 2, 5, 5, 10, 0.01]

    def test_snapshot_nearest_in_time(self, history):
        left, right = REST - [1e-3, 0, 0], REST + [1e-3, 0, 0]
        run = history(snapshots={0.08: left, 0.11: right})
        assert wall_shape(run, 10).snapshot_time_s == 0.11
        assert wall_shape(run, 10).corners.mean() > wall_shape(run, 9).corners.mean()

    @pytest.mark.parametrize("snapshots", [{}, {0.0: REST + 1e-3}])
    def test_without_a_snapshot_near_the_wall_is_undeformed_and_says_so(self, history, snapshots):
        run = history(snapshots=snapshots)
        figure = wall_picture(run, 10)
        shape = wall_shape(run, 10)
        assert shape.snapshot_time_s is None
        assert_allclose(shape.corners, body_corners(run.bodies, REST))
        assert "undeformed" in title(figure)

    def test_supports_are_in_the_legend_where_there_are_several(self, cracked, tmp_path):
        assert "supports" not in labels(wall_picture(cracked))
        layout = lay_out(Wall("small", 0.9, 0.45), ModelOptions(supports="bricks"))
        figure = wall_picture(make_history(tmp_path / "bricks.h5", layout))
        drawn = collection(figure, "supports")
        assert len(drawn.get_paths()) == len(layout.supports.x) == 4
        assert "supports" in labels(figure)
        shown = figure.legends[0].get_patches()[-1]
        assert_allclose(shown.get_facecolor(), drawn.get_facecolor()[0])

    def test_true_scale_and_caps_apart(self, cracked):
        figure = wall_picture(cracked)
        figure.draw_without_rendering()
        ax = figure.axes[0]
        (x0, z0), (x1, z1) = ax.transData.transform([(0, 0), (1, 1)])
        assert x1 - x0 == pytest.approx(z1 - z0, rel=ROUND_OFF)
        assert len(collection(figure, "masses").get_paths()) == 1
        assert len(collection(figure, "bricks").get_paths()) == LAYOUT.n_bricks

    @pytest.mark.parametrize(("sample", "expected"), [("max", 10), ("end", 20), (3, 3), (-2, 19)])
    def test_choice_of_the_sample(self, cracked, sample, expected):
        shape = wall_shape(cracked, sample)
        assert shape.sample == expected
        assert shape.time_s == pytest.approx(0.01 * expected, rel=ROUND_OFF)
        assert shape.index == cracked.index()["DI"].iloc[expected]

    @pytest.mark.parametrize("options", [{"sample": "middle"}, {"sample": 21}, {"magnify": -1.0},
                                         {"magnify": np.nan}, {"slip": "often"}, {"threshold": 0.0}])
    def test_bad_options_are_refused(self, cracked, options):
        refused_with("expected", wall_picture, cracked, **options)


class TestInAxesOfAnother:
    """`damage.plot_wall`: the picture's own drawing, at a time."""

    @pytest.mark.parametrize(("t", "sample"), [(0.1004, 10), (0.2, 20), ("max", 10), ("end", 20), (-0.005, 0)])
    def test_the_sample_nearest_to_a_time_is_drawn(self, cracked, t, sample):
        ax = Figure(dpi=200).subplots()
        shape = plot_wall(cracked, ax, t, magnify=3.0)
        expected = wall_shape(cracked, sample, magnify=3.0)
        assert shape.sample == sample and np.all(shape.state == expected.state)
        bricks, = (one for one in ax.collections if one.get_label() == "bricks")
        drawn = np.array([path.vertices[:4] for path in bricks.get_paths()])
        assert_allclose(drawn, expected.corners[expected.kinds == "bricks"])
        lines, = (one for one in ax.collections if one.get_label() == "both")
        assert len(lines.get_segments()) == np.sum(expected.state == STATES.index("both"))
        assert f"{expected.index:.3f} at {expected.time_s:.3f} s" in ax.get_title() and ax.get_aspect() == 1.0

    def test_lines_are_as_wide_as_the_axes_allow(self, cracked):
        widths = [plot_wall(cracked, Figure(figsize=size).subplots()).widest_pt for size in ((1, 1), (10, 10))]
        assert widths[0] < widths[1]

    @pytest.mark.parametrize("t", [-0.1, 0.3, np.nan, None, "now"])
    def test_a_time_outside_the_run_is_refused(self, cracked, t):
        assert "expected seconds from 0 to 0.2, 'max' or 'end'" in one_line_error(plot_wall, cracked, None, t)


class TestIndexPicture:
    def test_lines_are_the_index(self, cracked):
        below = index_picture(cracked).axes[1]
        index, latched = cracked.index(), cracked.index(slip="shear-limit")
        for label, column in (("DI", index["DI"]), (r"DI$_\mathrm{drift}$", index["DI_drift"]),
                              (r"DI$_\mathrm{open}$", index["DI_open"]),
                              (r"DI$_\mathrm{slip}$", index["DI_slip"])):
            drawn, = (one for one in below.get_lines() if one.get_label() == label)
            assert_allclose(drawn.get_ydata(), column)
            assert drawn.get_linestyle() == "-"
        assert_allclose(line(below, "DI, shear limit").get_ydata(), latched["DI"])
        assert line(below, "DI, shear limit").get_linestyle() == "--"

    def test_maximum_and_residual_are_marked_with_their_values(self, cracked):
        below = index_picture(cracked).axes[1]
        damage = cracked.index()["DI"]
        largest, residual = line(below, "maximum"), line(below, "residual")
        assert_allclose([*largest.get_xdata(), *largest.get_ydata()], [0.10, damage[10]])
        assert_allclose([*residual.get_xdata(), *residual.get_ydata()], [0.20, damage[20]], atol=ROUND_OFF)
        assert float(re.search(r"maximum (\S+) at", largest.get_label())[1]) == round(damage[10], 3)

    def test_an_interrupted_run_has_no_residual(self, history):
        figure = index_picture(history(**CASES["no settling"]))
        assert not any("residual" in label or "settling" in label for label in labels(figure))
        assert "interrupted" in title(figure)

    def test_settling_is_shaded_from_its_first_sample_to_the_last(self, cracked):
        for ax in index_picture(cracked).axes:
            shade, = (patch for patch in ax.patches if patch.get_label() == "settling")
            x = shade.get_path().transformed(shade.get_patch_transform()).vertices[:, 0]
            assert [x.min(), x.max()] == pytest.approx([0.16, 0.20])

    def test_base_acceleration_in_g_with_the_vertical_one_where_there_is_one(self, cracked, history):
        above = index_picture(cracked).axes[0]
        assert_allclose(line(above, "base, horizontal").get_ydata()[5], 0.05)
        assert not any("vertical" in label for label in labels(index_picture(cracked)))
        shaken = index_picture(history(row={"base_acceleration_z_m_s2": 0.981}))
        assert_allclose(line(shaken.axes[0], "base, vertical").get_ydata(), 0.1)
        assert "base, vertical" in labels(shaken)

    def test_the_base_shear_of_a_wall_whose_base_stands_still_is_drawn(self, history):
        run = history(loading="cyclic", drift=1e-3 * PULSE, row={"base_acceleration_x_m_s2": 0.0})
        above = index_picture(run).axes[0]
        assert above.get_ylabel() == "base shear [kN]"
        assert_allclose(above.get_lines()[0].get_ydata(), LAYOUT.drift_height * PULSE)

    def test_nothing_happened_is_drawn_from_zero(self, history):
        below = index_picture(history()).axes[1]
        assert below.get_ylim()[0] == 0 < below.get_ylim()[1]


class TestTitles:
    @pytest.mark.parametrize(("loading", "words"), [
        ("harmonic", "Small wall, harmonic motion of 0.2 s and 0.05 g, three cycles"),
        ("cyclic", "Small wall, top moved to and fro by a drift of 0.2 %, three cycles, free to rotate"),
        ("free_vibration", "Small wall, free vibration in its first mode from 1 mm/s at the top"),
        ("record", "Small wall, record NL.BGAR.HG1_x2_17-27s_vertical_baseline1_0.1-40Hz")])
    def test_wall_and_motion_are_named_in_words_and_the_file_below(self, history, loading, words):
        run = history(loading=loading)
        assert run_title(run) == words
        lines = title(drift_picture(run)).split("\n")
        first = "".join(lines[:lines.index("reference solver, small.h5")]).replace(" ", "")
        assert first == words.replace(" ", "")  # without the ends of lines

    def test_a_record_is_named_by_its_station_and_preparation(self):
        motion = RecordedMotion("code", {"record": "BGAR_HGE"}, {"record": "BGAR_HGZ"}, scale=2.0,
                                window_s=(17.0, 27.0), baseline_order=1, band_hz=(0.1, 40.0))
        assert motion_words(motion) == (
            "record Zeerijp, BGAR east, with its vertical component, times 2, 17 to 27 s of the file, baseline of "
            "order 1 removed, band-pass 0.1 to 40 Hz")

    def test_events_are_counted(self, cracked):
        run = replace(cracked, parameters=cracked.parameters | {"sequence": [1.0, 0.5]})
        assert run_title(run).endswith("three cycles, two events × 1, 0.5")


class TestOtherPictures:
    @pytest.mark.parametrize(("drift", "shown"), [
        (1e-4, []), (6e-4, ["0.050", "0.058"]), (-1.5e-3, ["0.050", "0.058", "0.070", "0.120"]), (0.05, [])])
    def test_drift_limits_within_the_range(self, history, drift, shown):
        figure = drift_picture(history(drift=drift * PULSE))
        assert [label.split()[0] for label in labels(figure) if "%" in label] == shown
        levels = sorted({round(abs(one.get_ydata()[0]), 6) for one in figure.axes[0].get_lines()[:2 * len(shown)]})
        assert levels == [float(value) for value in shown]
        assert_allclose(figure.axes[0].get_lines()[-1].get_ydata(), 100 * drift * PULSE)

    @pytest.mark.parametrize(("drift", "unit", "largest"), [
        (5e-4, "%", 0.05), (2e-5, "%", 2e-3), (2e-6, "µm per m", 2.0), (0.0, "%", 0.0)])
    def test_drift_stands_without_a_power_of_ten(self, history, drift, unit, largest):
        for draw, axis in ((drift_picture, "y"), (hysteresis_picture, "x")):
            figure = draw(history(drift=drift * PULSE))
            figure.draw_without_rendering()
            ax = figure.axes[0]
            assert getattr(ax, f"get_{axis}label")() == f"drift ratio [{unit}]"
            assert getattr(ax, f"{axis}axis").get_offset_text().get_text() == ""
            drawn = max(np.abs(getattr(one, f"get_{axis}data")()).max() for one in ax.get_lines()[-2:])
            assert drawn == pytest.approx(largest, rel=SINGLE)

    def test_hysteresis_in_percent_and_kilonewton(self, cracked):
        ax = hysteresis_picture(cracked).axes[0]
        motion, rest = line(ax, "motion"), line(ax, "rest")
        assert_allclose(motion.get_xdata(), 0.1 * PULSE[:10])
        assert_allclose(motion.get_ydata(), LAYOUT.drift_height * PULSE[:10])  # 1 MN/m times 1e-3
        assert_allclose(rest.get_xdata(), 0.1 * PULSE[9:16])  # joined to the motion, without settling

    def test_energy_lines_and_imbalance_in_percent(self, history):
        lost_j = np.linspace(0, 0.02, 21)
        row = {"input_energy_j": np.linspace(0, 4.0, 21), "elastic_energy_j": np.linspace(0, 4.0, 21) - lost_j}
        above, below = energy_picture(history(row=row)).axes
        assert_allclose(line(above, "stored").get_ydata(), row["elastic_energy_j"])
        # Settling starts at sample 16: the largest input before is 3 J.
        assert_allclose(below.get_lines()[-1].get_ydata(), -100 * lost_j / 3, atol=1e-12)
        assert below.get_ylabel() == "imbalance [%]"

    def test_energies_are_supplied_stored_dissipated_and_damped(self, history):
        parts = {f"{name}_energy_j": factor * np.arange(21.0) for factor, name in enumerate(
            ("kinetic", "elastic", "gravity", "friction", "fracture", "damping"), start=1)}
        figure = energy_picture(history(row=parts | {"input_energy_j": 21 * np.arange(21.0)}))
        drawn = {one.get_label(): one.get_ydata() for one in figure.axes[0].get_lines()}
        assert list(drawn) == ["supplied", "stored", "dissipated in joints", "damped"]
        for label, factor in zip(drawn, (21, 1 + 2 + 3, 4 + 5, 6)):
            assert_allclose(drawn[label], factor * np.arange(21.0))
        assert_allclose(figure.axes[1].get_lines()[-1].get_ydata(), 0, atol=ROUND_OFF)

    def test_energies_that_a_solver_does_not_record_are_left_out(self, history):
        figure = energy_picture(history(drift=1e-3 * PULSE, row={"damping_energy_j": np.nan}))
        assert not any(label.startswith("damp") for label in labels(figure))
        assert np.all(np.isfinite(figure.axes[1].get_lines()[-1].get_ydata()))

    @pytest.mark.parametrize("draw", [index_picture, drift_picture, energy_picture])
    def test_a_collapse_is_marked_at_its_time(self, history, draw):
        figure = draw(history(**CASES["collapsed"]))
        for ax in figure.axes:
            assert_allclose(line(ax, "collapse").get_xdata(), 0.2)
        assert "collapse at 0.200 s" in labels(figure)
        assert "collapsed at 0.200 s" in title(figure)

    def test_a_history_without_samples_is_refused(self, history):
        run = history(stages=())
        for draw in PICTURES.values():
            refused_with("no sample", draw, run)


def assert_apart(boxes):
    for one, other in combinations(boxes, 2):
        across = min(one.x1, other.x1) - max(one.x0, other.x0)
        up = min(one.y1, other.y1) - max(one.y0, other.y0)
        assert min(across, up) < 1  # [pixel] of 200 an inch


def pictures_of_cases():
    """(case, name) of every picture of every case; those whose layout a case does not decide are longer checks."""
    decides = {"nothing happens": {"index", "energy"}, "one sample": {"index", "drift", "hysteresis", "energy"},
               "killed": {"index"}, "no settling": {"index"}, "failed": {"drift", "hysteresis", "energy", "wall_end"},
               "free vibration": {"index", "energy"}}
    for case in CASES:
        for name in PICTURES:
            yield pytest.param(case, name, marks=[] if name in decides.get(case, PICTURES) else pytest.mark.long)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize(("case", "name"), pictures_of_cases())
def test_nothing_overlaps_or_leaves_the_page(history, case, name):
    figure = PICTURES[name](history(**CASES[case]))
    figure.draw_without_rendering()
    page = figure.bbox.padded(1)
    boxes = [ax.get_tightbbox() for ax in figure.axes]
    boxes += [legend.get_window_extent() for legend in figure.legends] + [figure._suptitle.get_window_extent()]
    assert all(page.x0 <= box.x0 and box.x1 <= page.x1 and page.y0 <= box.y0 and box.y1 <= page.y1
               for box in boxes)
    assert_apart(boxes)
    for axis in (axis for ax in figure.axes for axis in (ax.xaxis, ax.yaxis)):
        assert_apart([tick.get_window_extent() for tick in axis.get_ticklabels()
                      if tick.get_visible() and tick.get_text()])


class TestFiles:
    def test_png_and_pdf_of_every_picture(self, cracked, tmp_path):
        folder = tmp_path / "new" / "folder"
        paths = save_all(cracked, folder)
        assert sorted(path.name for path in paths) == sorted(
            f"{name}.{ending}" for ending in ("png", "pdf")
            for name in ("wall_max", "wall_end", "index", "drift", "hysteresis", "energy"))
        assert sorted(folder.iterdir()) == sorted(paths)  # and nothing temporary
        for path in paths:
            signature = {".png": b"\x89PNG\r\n\x1a\n", ".pdf": b"%PDF-"}[path.suffix]
            assert path.read_bytes().startswith(signature)

    def test_a_heap_is_drawn_where_bricks_were_followed_into_it(self, history, tmp_path, monkeypatch):
        fallen = REST + [0.4, -0.1, 2.0]
        before, after = ({0.0: REST, time_s: fallen} for time_s in (0.2, 0.9))
        assert not has_heap(history(**CASES["collapsed"], snapshots=before))
        run = history(**CASES["collapsed"], snapshots=after)
        monkeypatch.setattr(pictures, "PICTURES", {})  # these are drawn by other tests
        assert "heap.png" in [path.name for path in save_all(run, tmp_path)]
        figure = heap_picture(run)
        assert "0.70 s after the first brick fell" in title(figure)
        drawn = np.concatenate([[path.vertices[:4] for path in collection(figure, label).get_paths()]
                                for label in ("bricks", "top mass")])
        assert_allclose(drawn, body_corners(run.bodies, run.displacement[-1].astype(float)), rtol=ROUND_OFF)
        boxes = [figure.axes[0].get_tightbbox(), figure.legends[0].get_window_extent()]
        assert_apart([*boxes, figure._suptitle.get_window_extent()])

    def test_a_run_without_a_heap_says_so(self, cracked):
        refused_with("expected a run with --new-contacts --after-fall", heap_picture, cracked)

    def test_a_picture_says_what_made_it(self, cracked, tmp_path, monkeypatch):
        monkeypatch.setattr(pictures, "PICTURES", {"index": index_picture})
        png, pdf = save_all(cracked, tmp_path)
        metadata = Image.open(png).text
        assert metadata["Software"].startswith(f"masonry-damage {damage.__version__}, commit ")
        assert cracked.command in metadata["Description"] and "model unknown" in metadata["Description"]
        assert b"/Creator (masonry-damage" in pdf.read_bytes() and b"/Subject" in pdf.read_bytes()

    def test_a_file_that_fails_leaves_the_old_one_and_nothing_half_written(self, cracked, tmp_path, monkeypatch):
        (tmp_path / "out").mkdir()
        (tmp_path / "out" / "wall_max.png").write_text("old")

        def fail(path, pixels, **options):
            path.write_text("half")
            raise OSError("disk full")

        monkeypatch.setattr("matplotlib.image.imsave", fail)
        refused_with("disk full", save_all, cracked, tmp_path / "out")
        assert [path.name for path in (tmp_path / "out").iterdir()] == ["wall_max.png"]
        assert (tmp_path / "out" / "wall_max.png").read_text() == "old"

    def test_same_run_same_bytes(self, cracked, tmp_path, monkeypatch):
        monkeypatch.setattr(pictures, "PICTURES", {"index": index_picture})
        first, second = (save_all(cracked, tmp_path / name) for name in ("a", "b"))
        assert [path.read_bytes() for path in first] == [path.read_bytes() for path in second]

    def test_a_file_where_the_folder_should_be_is_refused(self, cracked, tmp_path):
        (tmp_path / "taken").write_text("")
        refused_with("taken, or a folder above it, is no folder; expected one", save_all, cracked, tmp_path / "taken")

    def test_the_host_keeps_its_style_and_gets_no_pyplot(self, cracked, tmp_path):
        with matplotlib.rc_context({"font.size": 31, "lines.linewidth": 17}):
            before = dict(matplotlib.rcParams)
            figure = index_picture(cracked)
            assert dict(matplotlib.rcParams) == before
        assert line(figure.axes[1], "DI, shear").get_linewidth() == 0.6
        assert figure.axes[0].yaxis.label.get_size() == 7
        words = ("import sys, damage.draw.run; sys.exit('matplotlib.pyplot' in sys.modules)")
        assert subprocess.run([sys.executable, "-c", words], timeout=120).returncode == 0
