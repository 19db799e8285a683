"""Pictures of modes and of two histories, films of a run: what they show, and that the commands
write them."""

import json
import shutil

import numpy as np
import pytest
from conftest import one_line_error, run_command
from PIL import Image, ImageSequence
from small_history import make_history, small_layout

from damage.__main__ import main
from damage.applications.cracks.compare_picture import JOINTS, compare_picture, joint_agreement
from damage.applications.report.animation import choose_snapshots, write_film
from damage.draw.preview import modes_picture
from damage.linear.modes import natural_modes


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


def test_every_mode_is_drawn_with_its_period():
    layout = small_layout()
    modes = natural_modes(layout, 4)
    titles = [ax.get_title() for ax in modes_picture(layout, modes).axes]
    assert titles == [f"mode {k + 1}: {period:.4f} s" for k, period in enumerate(modes.period_s)]


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
