"""Pictures of modes and of two histories, films of a run: what they show, and that the commands write them."""

import json
import shutil

import numpy as np
import pytest
from conftest import one_line_error, run_command
from PIL import Image, ImageSequence
from small_history import make_history, small_layout

from damage.__main__ import main
from damage.draw import animation
from damage.draw.animation import choose_snapshots, write_film
from damage.draw.compare import JOINTS, compare_picture, joint_agreement, run_labels
from damage.draw.preview import modes_picture
from damage.law.modes import natural_modes
from damage.wall.layout import lay_out
from damage.wall.parameters import Opening, Wall


def test_agreement_of_joints(tmp_path):
    layout = small_layout()
    pairs = list(zip(layout.contacts.first, layout.contacts.second))[:layout.n_joints]
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


def test_elastic_joints_are_drawn_as_such(tmp_path):
    layout = lay_out(Wall("pier", 1.35, 0.6, [Opening(0.45, 0.45, 0.3)], lintel="courses"))
    first, second = (make_history(tmp_path / f"{name}.h5", layout) for name in "ab")
    figure = compare_picture(first, second)
    drawn, = (lines for lines in figure.axes[1].collections if lines.get_label() == "elastic")
    n = int(first.joints["elastic"].sum())
    assert len(drawn.get_segments()) == n > 0 and drawn.get_linestyle()[0][1] is not None  # dashed
    texts = [text.get_text() for text in figure.legends[0].get_texts()]
    assert f"elastic, cannot fail: {n} points" in texts
    assert f"intact in both: {layout.n_joints - n} points" in texts


def test_two_runs_never_carry_one_label(tmp_path):
    (tmp_path / "other").mkdir()
    a, b, namesake = (make_history(tmp_path / name) for name in ("a.h5", "b.h5", "other/a.h5"))
    assert run_labels(a, b) == ["first: reference, a", "second: reference, b"]
    long, short = ("".join(label.split()) for label in run_labels(a, namesake))  # without the lines' ends
    assert (long, short) == (f"first:reference,{tmp_path.name}/a", "second:reference,other/a")
    legend, = compare_picture(a, b).legends
    assert [text.get_text() for text in legend.get_texts()][:2] == run_labels(a, b)


def test_every_mode_is_drawn_with_its_period():
    layout = small_layout()
    modes = natural_modes(layout, 4)
    titles = [ax.get_title() for ax in modes_picture(layout, modes).axes]
    assert titles == [f"mode {k + 1}: {period:.4f} s" for k, period in enumerate(modes.period_s)]


def test_commands_write_the_pictures(tmp_path, output_of):
    out = tmp_path / "pictures"
    assert len(json.loads(output_of("modes", "walls/solid.py", "--json", "--out", out))["period_s"]) == 6
    for name in "ab":
        make_history(tmp_path / f"{name}.h5", drift=np.linspace(0, 1e-3, 21))
    assert main(["compare", str(tmp_path / "a.h5"), str(tmp_path / "b.h5"), "--out", str(out)]) == 0
    assert {path.name for path in out.iterdir()} == {f"{n}.{e}" for n in ("modes", "compare") for e in ("png", "pdf")}
    (tmp_path / "file").touch()
    assert main(["modes", "walls/solid.py", "--out", str(tmp_path / "file")]) == 2


# --- films ------------------------------------------------------------------------------------------

N_SNAPSHOTS = 5  # of 21 samples at 0.01 s


@pytest.fixture(scope="module")
def moved(tmp_path_factory):
    """At rest until 0.1 s, then the whole wall is 3 mm to the right and a joint is open."""
    layout = small_layout()
    shift = np.zeros((len(layout.bodies), 3))
    shift[:, 0] = 3e-3
    opening = np.where(np.arange(21) >= 10, 2e-3, 0.0)
    return make_history(tmp_path_factory.mktemp("film") / "small.h5", layout, opening={3: opening},
                        snapshots={time: shift * (time > 0.08) for time in (0.0, 0.05, 0.1, 0.15, 0.2)})


def test_a_gif_has_a_frame_a_snapshot_and_the_wall_moves_in_it(moved, tmp_path):
    path = write_film(moved, tmp_path / "film.gif")
    with Image.open(path) as film:
        frames = [np.asarray(frame.convert("RGB"), int) for frame in ImageSequence.Iterator(film)]
        assert film.info["loop"] == 0
    assert len(frames) == N_SNAPSHOTS
    wall = slice(0, 6 * frames[0].shape[0] // 10)  # down to its lowest joint, above the panel over time
    orange = [np.count_nonzero((frame[wall, :, 0] > 200) & (frame[wall, :, 2] < 60)) for frame in frames]
    assert orange[0] == orange[1] == 0 and min(orange[2:]) > 0
    changed = [np.count_nonzero(np.abs(one[wall] - other[wall]).max(axis=2) > 30)
               for one, other in zip(frames, frames[1:])]
    assert changed[1] > 5 * max(changed[0], changed[3])  # else only the clock


def test_a_factor_is_common_to_all_frames(moved):
    shown = animation._common_magnification(moved, np.arange(N_SNAPSHOTS))
    assert shown == animation._common_magnification(moved, np.array([4])) > 1
    assert animation._common_magnification(moved, np.array([0, 1])) == 1.0  # nothing moves


def test_a_window_and_the_maximum_choose_the_frames(moved):
    assert list(choose_snapshots(moved)) == [0, 1, 2, 3, 4]
    assert list(choose_snapshots(moved, (0.04, 0.16))) == [1, 2, 3]
    assert list(choose_snapshots(moved, most=2)) == [1, 2]  # DI is largest from 0.1 s on
    assert "no snapshot from 3 to 4 s" in one_line_error(choose_snapshots, moved, (3, 4))
    assert "holds 3 snapshots; expected up to 2" in one_line_error(choose_snapshots, moved, (0.04, 0.16), 2)


@pytest.mark.skipif(shutil.which("ffmpeg") is None, reason="ffmpeg is not installed")
def test_an_mp4_has_a_frame_a_snapshot(moved, tmp_path):
    path = write_film(moved, tmp_path / "film.mp4")
    asked = "stream=nb_read_frames,codec_name"
    done = run_command("ffprobe", "-v", "error", "-count_frames", "-show_entries", asked, "-of", "csv=p=0", path)
    assert done.stdout.strip().split(",") == ["h264", str(N_SNAPSHOTS)], done.stderr


def test_what_cannot_be_made_is_said(moved, tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path))
    assert "expected ffmpeg on PATH" in one_line_error(write_film, moved, tmp_path / "film.mp4")
    assert "ends in .gif or .mp4" in one_line_error(write_film, moved, tmp_path / "film.avi")
    assert not list(tmp_path.iterdir())
