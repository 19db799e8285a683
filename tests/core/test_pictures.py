"""Pictures: they show the data of the history."""

import re
import subprocess
import sys
from dataclasses import replace

import matplotlib
import numpy as np
import pytest
from conftest import refused_with
from matplotlib.figure import Figure
from numpy.testing import assert_allclose
from PIL import Image
from pytest import approx
from small_history import make_history, small_layout

import damage
from damage import ModelOptions, Wall
from damage.draw import run as pictures
from damage.draw import style
from damage.draw.house import save_all
from damage.draw.run import (
    drift_picture,
    energy_picture,
    has_heap,
    heap_picture,
    hysteresis_picture,
    index_picture,
    plot_wall,
    wall_picture,
)
from damage.draw.wall import line_width, wall_shape
from damage.history.moments import JOINT_STATES
from damage.motion.loading import TopDisplacement
from damage.units import MILLIMETRE
from damage.wall.geometry import body_corners, joint_segments, tributary_ends
from damage.wall.layout import lay_out

SINGLE = 1e-6  # relative: frames and snapshots are stored in single precision
ROUND_OFF = 1e-12  # a few operations in double precision
LAYOUT = small_layout()
REST = np.zeros((len(LAYOUT.bodies), 3))
PULSE = np.sin(np.pi * np.arange(21) / 20)  # largest at sample 10
OPENING = {0: 3.0e-4 * PULSE, 1: 2.0e-4 * PULSE, 20: 1.5e-4 * PULSE, 30: 0.9e-4 * PULSE}
SLIP = {0: -4.0e-4 * PULSE, 5: 2.5e-4 * PULSE}
CRACKED = {
    "opening": OPENING,
    "slip": SLIP,
    "broken": (7, 8),
    "at_limit": (12,),
    "drift": 1e-3 * PULSE,
}
COLLAPSED = {
    "stages": ("motion",) * 21,
    "collapsed_at_s": 0.2,
    "drift": 0.05 * np.arange(21) / 20,
    "opening": dict.fromkeys(range(20), 0.02),
    "row": {"base_acceleration_z_m_s2": 0.1},
}


@pytest.fixture
def history(tmp_path):
    def make(**options):
        return make_history(tmp_path / "small.h5", LAYOUT, overwrite=True, **options)

    return make


@pytest.fixture(scope="module")
def cracked(tmp_path_factory):
    return make_history(tmp_path_factory.mktemp("cracked") / "small.h5", LAYOUT, **CRACKED)


def collection(figure, label):
    (found,) = (c for c in figure.axes[0].collections if c.get_label() == label)
    return found


def lengths(segments):
    return sum(np.hypot(*(end - start)) for start, end in segments)


def title(figure):
    return figure._suptitle.get_text()


def line(ax, label):
    (found,) = (drawn for drawn in ax.get_lines() if drawn.get_label().startswith(label))
    return found


class TestJoints:
    @pytest.mark.parametrize("sample", [0, 10, 20])
    def test_drawn_lengths_are_those_the_index_counts(self, cracked, sample):
        figure = wall_picture(cracked, sample, magnify=0)
        drawn = {state: lengths(collection(figure, state).get_segments()) for state in JOINT_STATES}
        counted = cracked.index().iloc[sample]
        total = LAYOUT.total_joint_length
        assert sum(drawn.values()) == approx(total, rel=ROUND_OFF)
        assert (drawn["opened"] + drawn["both"]) / total == approx(
            counted["DI_open"], rel=ROUND_OFF
        )
        assert (drawn["slipped"] + drawn["both"]) / total == approx(
            counted["DI_slip"], rel=ROUND_OFF
        )

    def test_crack_width_joins_opening_and_slip(self, cracked):
        # 0.3 mm of opening and 0.4 mm of slip are 0.5 mm.
        drawn = collection(wall_picture(cracked, 10), "both").get_linewidths()
        assert_allclose(drawn, line_width(0.5 * MILLIMETRE), rtol=SINGLE)

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
            assert_allclose(
                [bed[0, 0], bed[-1, 1]], [(0, course * 0.075), (0.9, course * 0.075)], atol=1e-12
            )
        head = ends[~is_bed]
        heights = np.round(head[..., 1] / 0.075, 9)
        assert np.all(head[:, 0, 0] == head[:, 1, 0])
        assert lengths(head) == approx(
            sum(3 if course % 2 == 0 else 4 for course in range(6)) * 0.075
        )
        assert np.all(np.floor(heights[:, 0]) == np.ceil(heights[:, 1]) - 1)  # within one course


class TestShape:
    def test_corner_of_a_turned_brick(self, history):
        motion = REST.copy()
        motion[2] = 2e-4, -1e-4, 1e-3
        figure = wall_picture(history(snapshots={0.1: motion}), 10, magnify=50)
        x = LAYOUT.bodies.x[2]
        z = LAYOUT.bodies.z[2]
        arm = complex(LAYOUT.bodies.length[2], LAYOUT.bodies.height[2]) / 2
        upper_right = complex(x, z) + 50 * complex(2e-4, -1e-4) + arm * np.exp(1j * 50 * 1e-3)
        drawn = collection(figure, "bricks").get_paths()[2].vertices[2]
        assert_allclose(drawn, [upper_right.real, upper_right.imag], rtol=SINGLE)
        assert figure.legends[0].get_texts()[-1].get_text() == "displacements × 50"

    def test_a_residual_is_magnified_no_more_than_a_hundred_times(self, history):
        # 0.01 mm of 0.6 m: three per cent of the height would be 1800 times
        run = history(snapshots={0.1: REST + [1e-5, 0, 0]})
        assert wall_shape(run, 10).magnification == 100.0

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

    @pytest.mark.parametrize(
        "options",
        [
            {"sample": "middle"},
            {"sample": 21},
            {"magnify": -1.0},
            {"magnify": np.nan},
        ],
    )
    def test_bad_options_are_refused(self, cracked, options):
        refused_with("expected", wall_picture, cracked, **options)


class TestInAxesOfAnother:
    """`damage.plot_wall`: the picture's own drawing, at a time."""

    @pytest.mark.parametrize(
        ("t", "sample"), [(0.1004, 10), (0.2, 20), ("max", 10), ("end", 20), (-0.005, 0)]
    )
    def test_the_sample_nearest_to_a_time_is_drawn(self, cracked, t, sample):
        ax = Figure(dpi=200).subplots()
        shape = plot_wall(cracked, ax, t, magnify=3.0)
        expected = wall_shape(cracked, sample, magnify=3.0)
        assert shape.sample == sample and np.all(shape.state == expected.state)
        (bricks,) = (one for one in ax.collections if one.get_label() == "bricks")
        drawn = np.array([path.vertices[:4] for path in bricks.get_paths()])
        assert_allclose(drawn, expected.corners[expected.kinds == "bricks"])
        (lines,) = (one for one in ax.collections if one.get_label() == "both")
        assert len(lines.get_segments()) == np.sum(expected.state == JOINT_STATES.index("both"))
        assert (
            f"{expected.index:.3f} at {expected.time_s:.3f} s" in ax.get_title()
            and ax.get_aspect() == 1.0
        )


class TestIndexPicture:
    def test_lines_are_the_index(self, cracked):
        below = index_picture(cracked).axes[1]
        index = cracked.index()
        latched = cracked.index(slip="shear-limit")
        for label, column in (
            ("DI", index["DI"]),
            (r"DI$_\mathrm{drift}$", index["DI_drift"]),
            (r"DI$_\mathrm{open}$", index["DI_open"]),
            (r"DI$_\mathrm{slip}$", index["DI_slip"]),
        ):
            (drawn,) = (one for one in below.get_lines() if one.get_label() == label)
            assert_allclose(drawn.get_ydata(), column)
            assert drawn.get_linestyle() == "-"
        assert_allclose(line(below, "DI, shear limit").get_ydata(), latched["DI"])
        assert line(below, "DI, shear limit").get_linestyle() == "--"

    def test_maximum_and_residual_are_marked_with_their_values(self, cracked):
        below = index_picture(cracked).axes[1]
        damage = cracked.index()["DI"]
        largest = line(below, "maximum")
        residual = line(below, "residual")
        assert_allclose([*largest.get_xdata(), *largest.get_ydata()], [0.10, damage[10]])
        assert_allclose(
            [*residual.get_xdata(), *residual.get_ydata()], [0.20, damage[20]], atol=ROUND_OFF
        )
        assert float(re.search(r"maximum (\S+) at", largest.get_label())[1]) == round(damage[10], 3)

    def test_base_acceleration_in_g_with_the_vertical_one_where_there_is_one(
        self, cracked, history
    ):
        above = index_picture(cracked).axes[0]
        assert_allclose(line(above, "base, horizontal").get_ydata()[5], 0.05)
        assert len(above.get_lines()) == 1
        shaken = index_picture(history(row={"base_acceleration_z_m_s2": 0.981}))
        assert_allclose(line(shaken.axes[0], "base, vertical").get_ydata(), 0.1)


class TestOtherPictures:
    def test_hysteresis_in_percent_and_kilonewton(self, cracked):
        ax = hysteresis_picture(cracked).axes[0]
        motion = line(ax, "motion")
        rest = line(ax, "rest")
        assert_allclose(motion.get_xdata(), 0.1 * PULSE[:10])
        assert_allclose(motion.get_ydata(), LAYOUT.drift_height * PULSE[:10])  # 1 MN/m times 1e-3
        # joined to the motion, without settling
        assert_allclose(rest.get_xdata(), 0.1 * PULSE[9:16])
        # nor settling between two events
        stage = np.repeat(["motion", "settling", "motion", "rest"], [4, 4, 4, 9])
        twice = replace(cracked, series=cracked.series.assign(stage=stage))
        motion = line(hysteresis_picture(twice).axes[0], "motion")
        assert np.isnan(motion.get_xdata()[4:7]).all() and np.isnan(motion.get_xdata()).sum() == 3

    def test_a_push_is_named_so_and_a_line_alone_has_no_legend(
        self, cracked, tmp_path, monkeypatch
    ):
        push = TopDisplacement((0.1,), cycles=0)
        pushed = replace(cracked, parameters=cracked.parameters | {"loading": push.as_dict()})
        assert line(hysteresis_picture(pushed).axes[0], "push")
        stage = np.where(cracked.series["stage"] == "rest", "settling", cracked.series["stage"])
        alone = replace(pushed, series=cracked.series.assign(stage=stage))
        assert not hysteresis_picture(alone).legends
        monkeypatch.setattr(pictures, "PICTURES", {"hysteresis": hysteresis_picture})
        assert {path.stem for path in save_all(pushed, tmp_path)} == {"push"}
        assert {path.stem for path in save_all(cracked, tmp_path)} == {"hysteresis"}

    def test_energies_are_supplied_stored_dissipated_and_damped(self, history):
        parts = {
            f"{name}_energy_j": factor * np.arange(21.0)
            for factor, name in enumerate(
                ("kinetic", "elastic", "gravity", "friction", "fracture", "damping"), start=1
            )
        }
        figure = energy_picture(history(row=parts | {"input_energy_j": 21 * np.arange(21.0)}))
        drawn = {one.get_label(): one.get_ydata() for one in figure.axes[0].get_lines()}
        assert list(drawn) == ["supplied", "stored", "dissipated in joints", "damped"]
        for label, factor in zip(drawn, (21, 1 + 2 + 3, 4 + 5, 6)):
            assert_allclose(drawn[label], factor * np.arange(21.0))
        assert_allclose(figure.axes[1].get_lines()[-1].get_ydata(), 0, atol=ROUND_OFF)

    @pytest.mark.parametrize("draw", [index_picture, drift_picture, energy_picture])
    def test_a_collapse_is_marked_at_its_time(self, history, draw):
        figure = draw(history(**COLLAPSED))
        for ax in figure.axes:
            assert_allclose(line(ax, "collapse").get_xdata(), 0.2)


class TestFiles:
    def test_png_and_pdf_of_every_picture(self, cracked, tmp_path):
        folder = tmp_path / "new" / "folder"
        paths = save_all(cracked, folder)
        assert sorted(path.name for path in paths) == sorted(
            f"{name}.{ending}"
            for ending in ("png", "pdf")
            for name in ("wall_max", "wall_end", "index", "drift", "hysteresis", "energy")
        )
        assert sorted(folder.iterdir()) == sorted(paths)  # and nothing temporary
        for path in paths:
            signature = {".png": b"\x89PNG\r\n\x1a\n", ".pdf": b"%PDF-"}[path.suffix]
            assert path.read_bytes().startswith(signature)

    def test_a_heap_is_drawn_where_bricks_were_followed_into_it(
        self, history, tmp_path, monkeypatch
    ):
        fallen = REST + [0.4, -0.1, 2.0]
        before, after = ({0.0: REST, time_s: fallen} for time_s in (0.2, 0.9))
        assert not has_heap(history(**COLLAPSED, snapshots=before))
        run = history(**COLLAPSED, snapshots=after)
        monkeypatch.setattr(pictures, "PICTURES", {})  # these are drawn by other tests
        assert "heap.png" in [path.name for path in save_all(run, tmp_path)]
        figure = heap_picture(run)
        assert "0.70 s after the first brick fell" in title(figure)
        drawn = np.concatenate(
            [
                [path.vertices[:4] for path in collection(figure, label).get_paths()]
                for label in ("bricks", "top mass")
            ]
        )
        assert_allclose(
            drawn, body_corners(run.bodies, run.displacement[-1].astype(float)), rtol=ROUND_OFF
        )

    def test_a_picture_says_what_made_it(self, cracked, tmp_path, monkeypatch):
        monkeypatch.setattr(pictures, "PICTURES", {"index": index_picture})
        png, pdf = save_all(cracked, tmp_path)
        metadata = Image.open(png).text
        assert metadata["Software"].startswith(f"masonry-damage {damage.__version__}, commit ")
        assert (
            cracked.command in metadata["Description"]
            and "model unknown" in metadata["Description"]
        )
        assert b"/Creator (masonry-damage" in pdf.read_bytes() and b"/Subject" in pdf.read_bytes()

    def test_a_file_that_fails_leaves_the_old_one_and_nothing_half_written(
        self, cracked, tmp_path, monkeypatch
    ):
        (tmp_path / "out").mkdir()
        (tmp_path / "out" / "wall_max.png").write_text("old")

        def fail(path, pixels, **options):
            path.write_text("half")
            raise OSError("disk full")

        monkeypatch.setattr("matplotlib.image.imsave", fail)
        refused_with("disk full", save_all, cracked, tmp_path / "out")
        assert [path.name for path in (tmp_path / "out").iterdir()] == ["wall_max.png"]
        assert (tmp_path / "out" / "wall_max.png").read_text() == "old"

    def test_the_host_keeps_its_style_and_gets_no_pyplot(self, cracked):
        with matplotlib.rc_context({"font.size": 31, "lines.linewidth": 17}):
            before = dict(matplotlib.rcParams)
            index_picture(cracked)
            assert dict(matplotlib.rcParams) == before
        words = "import sys, damage.draw.run; sys.exit('matplotlib.pyplot' in sys.modules)"
        assert subprocess.run([sys.executable, "-c", words], timeout=120).returncode == 0

    def test_titles_name_no_file_and_print_has_none(self, cracked):
        screen = wall_picture(cracked)
        assert "small.h5" not in title(screen) and "reference" not in title(screen)
        with style.printed("paper"):
            paper = wall_picture(cracked)
            (legend,) = paper.legends
            outside = legend.get_window_extent().width - paper.bbox.width
        assert paper._suptitle is None and outside <= 0
        assert {text.get_fontsize() for text in legend.get_texts()} == {8.0}
        assert paper.axes[0].xaxis.label.get_fontsize() == 8.0
        assert paper.get_figwidth() == screen.get_figwidth() == style.COLUMN_WIDTH
        assert title(wall_picture(cracked)) == title(screen)
        refused_with("expected paper", style.printed("none.mplstyle").__enter__)
