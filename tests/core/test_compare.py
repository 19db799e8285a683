"""Comparison of histories, and fractions skill scores of crack patterns: cases whose answer is
known; their pictures, those of modes, and films."""

import json
import shutil

import numpy as np
import pytest
from conftest import one_line_error, run_command
from numpy.testing import assert_allclose
from PIL import Image, ImageSequence
from pytest import approx
from small_history import make_history, small_layout

from damage import Wall
from damage.__main__ import main
from damage.applications.cracks.compare import cohens_kappa, compare, compare_drift, describe
from damage.applications.cracks.compare_picture import JOINTS, compare_picture, joint_agreement
from damage.applications.cracks.patterns import (
    compare_patterns,
    cracked,
    fractions_skill_score,
    places_of,
)
from damage.applications.report.animation import choose_snapshots, write_film
from damage.wall.layout import lay_out

N = 1200
TIME = 1e-3 * np.arange(N)


def history(path, drift, **options):
    """A motion and rest of 1.2 s with that drift, no settling."""
    stages = options.pop("stages", ["motion"] * 200 + ["rest"] * (N - 200))
    return make_history(path, stages=stages, step_s=1e-3, drift=drift, **options)


def wave(amplitude=1e-3, period=0.1, late=0.0):
    return amplitude * np.sin(2 * np.pi * (TIME - late) / period)


def test_a_run_agrees_with_itself(tmp_path):
    run = history(tmp_path / "a.h5", wave(), opening={0: 3e-4}, broken={0: 1}, at_limit={1: 1})
    result = compare(run, [run])
    assert result["agrees"] and result["drift"]["rms_whole"] == 0.0
    assert all(row["first"] == row["median"] for row in result["figures"].values())
    assert "within the tolerances" in describe(result)
    json.dumps(result)


def test_drift_rms_is_the_relative_amplitude_of_the_difference(tmp_path):
    first = history(tmp_path / "a.h5", wave(1.00e-3))
    second = history(tmp_path / "b.h5", wave(1.01e-3))
    assert compare_drift(first, second)["rms_before_failure"] == approx(0.01, rel=1e-6)
    assert not compare_drift(first, second)["agrees"]


def test_the_median_of_an_ensemble_is_judged(tmp_path):
    first = history(tmp_path / "a.h5", wave(1.0e-3))
    others = [
        history(tmp_path / f"{k}.h5", wave(scale * 1e-3))
        for k, scale in enumerate((0.5, 0.99, 3.0))
    ]
    row = compare(first, others)["figures"]["max_drift_ratio"]
    assert row["median"] == approx(0.99e-3, rel=1e-3) and row["agrees"]
    assert row["range"] == approx([0.5e-3, 3e-3], rel=1e-3)


@pytest.mark.parametrize(("factor", "agrees"), [(1.019, True), (1.022, False)])
def test_tolerance_of_the_maximum_drift(tmp_path, factor, agrees):
    first = history(tmp_path / "a.h5", wave(factor * 1e-3))
    row = compare(first, [history(tmp_path / "b.h5", wave(1e-3))])["figures"]["max_drift_ratio"]
    assert row["agrees"] is agrees


@pytest.mark.parametrize(("width", "agrees"), [(1.58, True), (1.62, False)])
def test_psi_is_compared(tmp_path, width, agrees):
    """Psi grows as the width to the power 0.3: 1.15 times at 1.593 times the width."""
    first, second = (
        history(tmp_path / f"{name}.h5", wave(), opening={0: opening}, broken={0: 1})
        for name, opening in (("a", width * 1e-3), ("b", 1e-3))
    )
    row = compare(first, [second])["figures"]["Psi"]
    assert row["median"] == approx(2.0) and row["agrees"] is agrees
    assert "Psi " in describe(compare(first, [second]))


class TestKappa:
    def test_by_hand(self):
        # 2 x 2 table 20, 5, 10, 15: observed 0.7, by chance 0.5, kappa 0.4.
        here = [0] * 25 + [1] * 25
        there = [0] * 20 + [1] * 5 + [0] * 10 + [1] * 15
        assert cohens_kappa(here, there) == approx(0.4)


# --- patterns of cracks ---------------------------------------------------------------------------

LAYOUT = lay_out(Wall("wide", 3.6, 1.5))
X, Z = (getattr(LAYOUT.contacts, name)[: LAYOUT.n_joints] for name in ("x", "z"))


def patterned(path, joints, **more):
    """A wall of 3.6 x 1.5 m in which these joints are broken."""
    return make_history(path, LAYOUT, broken=np.flatnonzero(joints), **more)


@pytest.fixture
def left(tmp_path):
    return patterned(tmp_path / "left.h5", (X < 0.5) & (Z < 0.5))


def test_scores_by_hand():
    half = np.array([0.5, 0.5, 0.0])
    assert fractions_skill_score(half, half) == 1.0
    assert fractions_skill_score(half, np.array([0.0, 0.0, 1.0])) == 0.0
    # 1 - 0.25 / (0.5 + 0.25)
    assert fractions_skill_score(half, np.array([0.5, 0.0, 0.0])) == approx(2 / 3)
    assert fractions_skill_score(0 * half, 0 * half) is None


def test_fractions_are_shares_of_the_joint_length_in_a_window(left):
    places = places_of(left)
    broken = cracked(left, "broken")
    assert_allclose(places.fractions(np.ones(len(X), bool)), 1.0)
    share = places.fractions(broken).reshape(48, 20)  # windows every 0.075 m
    assert share[2, 2] == 1.0 and share[24, 10] == 0.0
    assert_allclose(places.mirrored.fractions(broken).reshape(48, 20), share[::-1], atol=1e-12)


def test_a_neighbour_scores_high_and_the_other_side_nothing(tmp_path, left):
    beside = patterned(tmp_path / "beside.h5", (X > 0.1) & (X < 0.6) & (Z < 0.5))
    right = patterned(tmp_path / "right.h5", (X > 3.1) & (Z < 0.5))
    near, far, same = (compare_patterns(left, other)["broken"] for other in (beside, right, left))
    assert same["fss"] == 1.0 and 0.85 < near["fss"] < 1.0 and far["fss"] == 0.0
    assert near["tells_sides"] and far["mirrored"] == approx(1.0) and not far["tells_sides"]
    assert near["shuffled"] < 0.5


def test_a_crack_counts_up_to_the_end_of_the_motion(tmp_path):
    stages = ("motion",) * 10 + ("rest",) * 6 + ("settling",) * 5
    for first, seen in ((4, True), (12, False)):
        opening = np.where(np.arange(21) == first, 3e-4, 0.0)
        run = make_history(tmp_path / f"{first}.h5", LAYOUT, stages=stages, opening={7: opening})
        assert cracked(run, "visible")[7] == seen and cracked(run, "visible").sum() == seen
        assert cracked(run, "broken")[7] == seen


# --- pictures of modes and of two histories -------------------------------------------------------


def test_agreement_of_joints(tmp_path):
    layout = small_layout()
    pairs = list(zip(layout.contacts.first, layout.contacts.second))[: layout.n_joints]
    joints = [pairs.index(pair) for pair in sorted(set(pairs))[:4]]
    first = make_history(tmp_path / "a.h5", broken=joints[:3], opening={joints[1]: 1e-3})
    second = make_history(tmp_path / "b.h5", broken=[joints[0], joints[1], joints[3]])
    agreement = joint_agreement(first, second)
    for joint, expected in zip(joints, ("same", "other", "first", "second")):
        mine = [agreement[k] for k, pair in enumerate(pairs) if pair == pairs[joint]]
        assert set(mine) == {expected}
    assert set(agreement) == set(JOINTS)
    figure = compare_picture(first, second)
    assert len(figure.axes) == 2


def test_commands_write_the_pictures(tmp_path, output_of):
    out = tmp_path / "pictures"
    assert (
        len(json.loads(output_of("modes", "walls/solid.py", "--json", "--out", out))["period_s"])
        == 6
    )
    for name in "ab":
        make_history(tmp_path / f"{name}.h5", drift=np.linspace(0, 1e-3, 21))
    assert main(["compare", str(tmp_path / "a.h5"), str(tmp_path / "b.h5"), "--out", str(out)]) == 0
    assert {path.name for path in out.iterdir()} == {
        f"{n}.{e}" for n in ("modes", "compare") for e in ("png", "pdf")
    }
    (tmp_path / "file").touch()
    assert main(["modes", "walls/solid.py", "--out", str(tmp_path / "file")]) == 2


# --- films ----------------------------------------------------------------------------------------

N_SNAPSHOTS = 5  # of 21 samples at 0.01 s


@pytest.fixture(scope="module")
def moved(tmp_path_factory):
    """At rest until 0.1 s, then the whole wall is 3 mm to the right and a joint is open."""
    layout = small_layout()
    shift = np.zeros((len(layout.bodies), 3))
    shift[:, 0] = 3e-3
    opening = np.where(np.arange(21) >= 10, 2e-3, 0.0)
    return make_history(
        tmp_path_factory.mktemp("film") / "small.h5",
        layout,
        opening={3: opening},
        snapshots={time: shift * (time > 0.08) for time in (0.0, 0.05, 0.1, 0.15, 0.2)},
    )


@pytest.mark.parametrize("ending", ["gif", "webp"])
def test_a_film_has_a_frame_a_snapshot_and_the_wall_moves_in_it(moved, tmp_path, ending):
    path = write_film(moved, tmp_path / f"film.{ending}")
    with Image.open(path) as film:
        frames = [np.asarray(frame.convert("RGB"), int) for frame in ImageSequence.Iterator(film)]
        assert film.info["loop"] == 0
    assert len(frames) == N_SNAPSHOTS
    # down to its lowest joint, above the panel over time
    wall = slice(0, 6 * frames[0].shape[0] // 10)
    orange = [
        np.count_nonzero((frame[wall, :, 0] > 200) & (frame[wall, :, 2] < 60)) for frame in frames
    ]
    assert orange[0] == orange[1] == 0 and min(orange[2:]) > 0
    changed = [
        np.count_nonzero(np.abs(one[wall] - other[wall]).max(axis=2) > 30)
        for one, other in zip(frames, frames[1:])
    ]
    assert changed[1] > 5 * max(changed[0], changed[3])  # else only the clock


def test_a_window_and_the_maximum_choose_the_frames(moved):
    assert list(choose_snapshots(moved)) == [0, 1, 2, 3, 4]
    assert list(choose_snapshots(moved, (0.04, 0.16))) == [1, 2, 3]
    assert list(choose_snapshots(moved, most=2)) == [1, 2]  # DI is largest from 0.1 s on
    assert "no snapshot from 3 to 4 s" in one_line_error(choose_snapshots, moved, (3, 4))
    assert "holds 3 snapshots; expected up to 2" in one_line_error(
        choose_snapshots, moved, (0.04, 0.16), 2
    )


@pytest.mark.skipif(shutil.which("ffmpeg") is None, reason="ffmpeg is not installed")
def test_an_mp4_has_a_frame_a_snapshot(moved, tmp_path):
    path = write_film(moved, tmp_path / "film.mp4")
    asked = "stream=nb_read_frames,codec_name"
    done = run_command(
        "ffprobe", "-v", "error", "-count_frames", "-show_entries", asked, "-of", "csv=p=0", path
    )
    assert done.stdout.strip().split(",") == ["h264", str(N_SNAPSHOTS)], done.stderr
