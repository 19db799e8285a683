"""Films of a run: which moments they show, and that the wall and the cracks in them are those of the history."""

import shutil
import subprocess

import numpy as np
import pytest
from conftest import one_line_error
from PIL import Image, ImageSequence
from small_history import make_history, small_layout

from damage.draw import animation
from damage.draw.animation import choose_snapshots, write_film

N_SNAPSHOTS = 5  # of 21 samples at 0.01 s


@pytest.fixture(scope="module")
def history(tmp_path_factory):
    """At rest until 0.1 s, then the whole wall is 3 mm to the right and a joint is open."""
    layout = small_layout()
    moved = np.zeros((len(layout.bodies), 3))
    moved[:, 0] = 3e-3
    opening = np.where(np.arange(21) >= 10, 2e-3, 0.0)
    return make_history(tmp_path_factory.mktemp("film") / "small.h5", layout, opening={3: opening},
                        snapshots={time: moved * (time > 0.08) for time in (0.0, 0.05, 0.1, 0.15, 0.2)})


def test_a_gif_has_a_frame_a_snapshot_and_the_wall_moves_in_it(history, tmp_path):
    path = write_film(history, tmp_path / "film.gif")
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


def test_a_factor_is_common_to_all_frames(history):
    shown = animation._common_magnification(history, np.arange(N_SNAPSHOTS))
    assert shown == animation._common_magnification(history, np.array([4])) > 1
    assert animation._common_magnification(history, np.array([0, 1])) == 1.0  # nothing moves


def test_a_window_and_the_maximum_choose_the_frames(history):
    assert list(choose_snapshots(history)) == [0, 1, 2, 3, 4]
    assert list(choose_snapshots(history, (0.04, 0.16))) == [1, 2, 3]
    assert list(choose_snapshots(history, most=2)) == [1, 2]  # DI is largest from 0.1 s on
    assert "no snapshot from 3 to 4 s" in one_line_error(choose_snapshots, history, (3, 4))
    assert "holds 3 snapshots; expected up to 2" in one_line_error(choose_snapshots, history, (0.04, 0.16), 2)


@pytest.mark.skipif(shutil.which("ffmpeg") is None, reason="ffmpeg is not installed")
def test_an_mp4_has_a_frame_a_snapshot(history, tmp_path):
    path = write_film(history, tmp_path / "film.mp4")
    asked = "stream=nb_read_frames,codec_name"
    done = subprocess.run(["ffprobe", "-v", "error", "-count_frames", "-show_entries", asked, "-of", "csv=p=0", path],
                          capture_output=True, text=True)
    assert done.stdout.strip().split(",") == ["h264", str(N_SNAPSHOTS)], done.stderr


def test_what_cannot_be_made_is_said(history, tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path))
    assert "expected ffmpeg on PATH" in one_line_error(write_film, history, tmp_path / "film.mp4")
    assert "ends in .gif or .mp4" in one_line_error(write_film, history, tmp_path / "film.avi")
    assert not list(tmp_path.iterdir())
