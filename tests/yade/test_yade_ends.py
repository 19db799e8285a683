"""A joint ends where its faces no longer overlap: YADE, where bricks have faces, beside the
reference solver."""

import re

import numpy as np
import pytest
from conftest import wall_file
from numpy.testing import assert_allclose
from test_ends import HEIGHT, LENGTH

from damage import read_history
from damage.measure.summary import summarise
from damage.units import GRAVITY

pytestmark = pytest.mark.yade

PIER = (
    "Wall('pier', 0.1125, 0.225, precompression=0.0, joint=Joint(tensile_strength=0.0,"
    " cohesion=0.0))"
)
SPEED = 1.0
EASE_S = 0.1
"""Speed of the push [m/s]; how long it takes to start [s], over which half the distance is lost."""


@pytest.fixture(scope="module")
def pushed(tmp_path_factory, in_both):
    """{solver: (History, what it said)} of three bricks on each other, of which the uppermost is
    pushed off."""
    folder = tmp_path_factory.mktemp("pier")
    histories = in_both(
        folder,
        wall_file(folder / "pier.py", PIER),
        f"--pushover 100 --accept-implausible --speed {SPEED} --boundary fixed --damping 0",
        yade=("-j1",),
        reference=("--relaxation local",),
    )
    return {
        solver: (history, (folder / f"{solver}.txt").read_text())
        for solver, history in histories.items()
    }


@pytest.mark.parametrize("solver", ["yade", "reference"])
def test_a_brick_that_is_pushed_off_a_pier_is_a_collapse(pushed, solver):
    """It leaves the brick below after 0.1125 m and falls by half its height; before, it floated."""
    history, said = pushed[solver]
    by_hand = LENGTH / SPEED + EASE_S / 2 + np.sqrt(2 * (HEIGHT / 2) / GRAVITY)
    assert history.collapsed_at_s == pytest.approx(by_hand, rel=0.1)
    summary = summarise(history)
    assert summary["ended_joints"] == 1 and 1 <= summary["max_offset_over_overlap"] < 1.05
    assert summary["max_opening_mm"] < 3.0
    assert re.search(r"^ended joints +1 +whose faces no longer overlap$", said, re.MULTILINE)
    assert "1 joint ended, the bed joint at x = 0.03 m, z = 0.15 m (t = 0.1" in said
    joint = np.flatnonzero(history.joints["first_body"] == 1)
    then = int(np.argmax(history.ended[:, joint[0]]))
    assert history.ended[then:, joint].all() and not np.delete(history.ended, joint, axis=1).any()
    for frames in (history.opening_m, history.slip_m, history.offset_m):
        assert_allclose(
            frames[then:, joint], np.tile(frames[then, joint], (len(frames) - then, 1)), atol=1e-7
        )


def test_both_codes_let_it_fall_at_the_same_time(pushed):
    fallen = [history.collapsed_at_s for history, _ in pushed.values()]
    assert_allclose(*fallen, rtol=0.1)


@pytest.mark.long
def test_a_run_that_continues_after_a_joint_ended_keeps_its_stresses(tmp_path, yade_command):
    """None in the joint that ended before the checkpoint; the weight of two bricks is on the
    ground."""
    wall = wall_file(tmp_path / "pier.py", PIER)
    words = "--accept-implausible --no-pictures --stresses --dt 3e-5"
    for more in (
        f"--pushover 70 --speed {SPEED} --checkpoint 10 --out first.h5",
        "--harmonic 0.02 0.01 --cycles 1 --rest 0 --continue first.h5 --out second.h5",
    ):
        yade_command("-j1", wall, words, more, cwd=tmp_path, status=0)
    history = read_history(tmp_path / "second.h5")
    assert history.ended[0].any() and not history.joint_stress_pa[:, history.ended[0]].any()
    area = LENGTH / 2 * history.masonry_wall.brick.thickness  # of a contact point, two a joint
    pressed = -area * history.joint_stress_pa[
        :, (history.joints["first_body"] < 0).to_numpy(), 0
    ].sum(axis=1)
    assert_allclose(pressed.mean(), GRAVITY * history.bodies["mass_kg"][:2].sum(), rtol=0.01)
