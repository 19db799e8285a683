"""Complete runs in YADE through the real command: energy, damage, interrupts."""

import os
import signal
import subprocess
import time
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
from conftest import REPOSITORY, SHORT, in_words, wall_file
from numpy.testing import assert_allclose

from damage import InputError, load_wall, read_history
from damage.linear.modes import natural_modes
from damage.measure.energy import energy_error
from damage.measure.summary import summarise
from damage.wall.layout import lay_out
from yade_scripts import COMMAND

pytestmark = pytest.mark.yade

# A pier with a door beside it, small enough for a run of seconds; its opening asks for cut bricks.
PIER = (
    "Wall('small', length=1.53, height=0.975, precompression=0.3e6, "
    "openings=[Opening(left=0.63, width=0.4, height=0.6)], lintel='courses')"
)


@pytest.fixture(scope="module")
def small_wall(tmp_path_factory):
    return wall_file(tmp_path_factory.mktemp("walls") / "small.py", PIER)


@pytest.mark.long
@pytest.mark.parametrize("words", ["", "--contacts corners", "--contacts gauss"])
def test_cut_bricks_vibrate_as_the_eigenvalue_says(yade_command, small_wall, tmp_path, words):
    """Bricks of unequal size, at rest under their weight before they are kicked, and unbroken."""
    out = tmp_path / "small.h5"
    done = yade_command(
        *SHORT,
        small_wall,
        "--free-vibration --rest 0.17 --out",
        out,
        "--no-pictures",
        words,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    history = read_history(out)
    eigen = natural_modes(lay_out(load_wall(small_wall), history.model)).period_s[0]
    assert_allclose(summarise(history)["period_s"], eigen, rtol=5e-3)
    assert energy_error(history.series) < 5e-3
    static = history.static
    assert_allclose(static["base_reaction_n"], static["weight_n"], rtol=1e-3)
    assert static["unbalanced_force"] < 1e-5
    assert static["broken_joints"] == 0 and len(history.events) == 0 and not history.at_limit.any()
    assert history.index().DI_open.max() == 0 and history.index().DI_slip.max() == 0


@pytest.fixture(scope="module")
def shaken(yade_command, small_wall, tmp_path_factory):
    """The small wall shaken hard: 1 g at its own period."""
    out = tmp_path_factory.mktemp("shaken") / "small.h5"
    motion = "--harmonic 0.03 1.5 --cycles 2 --rest 0.02"
    yade_command(*SHORT, small_wall, motion, "--no-pictures --out", out, status=0)
    return read_history(out)


class TestDamagedWall:
    def test_breaks_are_logged_with_stresses_that_exceed_the_strength(self, shaken):
        joint = load_wall(REPOSITORY / "walls/symmetric.py").joint
        events = shaken.events
        tension = events[events.kind == "tension"]
        assert len(tension) > 0
        assert np.all(tension.normal_stress_pa > joint.tensile_strength)
        # The stress overshoots by up to what one step adds: little at the first break, when joints
        # open at a small part of the base's velocity, more in the waves that the breaks release.
        # No joint opens faster than the base moves.
        stiffness = shaken.joints.normal_stiffness_pa_m[tension.joint].to_numpy()
        one_step = shaken.parameters["pgv_m_s"] * stiffness * shaken.parameters["time_step_s"]
        assert tension.normal_stress_pa.iloc[0] < joint.tensile_strength + 0.1 * one_step[0]
        assert np.all(tension.normal_stress_pa < joint.tensile_strength + one_step)
        shear = events[events.kind == "shear"]
        assert len(shear) > 0
        strength = joint.cohesion - shear.normal_stress_pa * np.tan(joint.friction_angle)
        # The kinematic shear stress is the law's but for the tilt of YADE's normals.
        assert np.all(np.abs(shear.shear_stress_pa) > 0.98 * strength)

    def test_each_joint_fails_once_and_for_good(self, shaken):
        breaks = shaken.events[shaken.events.kind.isin(["tension", "shear"])]
        assert not breaks.joint.duplicated().any()
        assert set(np.flatnonzero(shaken.broken[-1])) == set(breaks.joint)
        assert np.all(np.diff(shaken.broken.astype(int), axis=0) >= 0)

    def test_energy_balance(self, shaken):
        assert energy_error(shaken.series) < 0.01
        friction = shaken.series.friction_energy_j.to_numpy()
        assert np.all(np.diff(friction) >= 0) and friction[-1] > 0


def count_samples(path):
    """Number of samples of a history that may not be there yet, or still be locked while its
    datasets are made."""
    try:
        return len(read_history(path).series)
    except InputError:
        return 0


def listening(pid):
    """Addresses (hexadecimal, with port) on which a process listens."""
    sockets = set()
    for link in Path(f"/proc/{pid}/fd").iterdir():
        with suppress(FileNotFoundError):  # closed meanwhile
            sockets.add(os.readlink(link))
    found = []
    for table in ("tcp", "tcp6"):
        path = Path(f"/proc/{pid}/net/{table}")
        for line in path.read_text().splitlines()[1:] if path.exists() else []:
            words = line.split()
            if words[3] == "0A" and f"socket:[{words[9]}]" in sockets:
                found.append(words[1])
    return found


@pytest.fixture(
    scope="module",
    params=[
        pytest.param((COMMAND, signal.SIGINT), id="launcher"),
        pytest.param((("yade", "-n"), signal.SIGKILL), id="plain", marks=pytest.mark.long),
    ],
)
def ended(request, tmp_path_factory, yade_command):
    """A run of two courses that a signal ends once samples are written: whether by the launcher,
    addresses at which it listened before and then, its exit status, what it printed, and its
    history."""
    command, number = request.param
    folder = tmp_path_factory.mktemp("ended")
    wall = wall_file(folder / "tiny.py", "Wall('small', 0.45, 0.15)")
    out = folder / "tiny.h5"
    log = folder / "log"
    with (
        log.open("w") as file,
        subprocess.Popen(
            [
                *command,
                *in_words([*SHORT, wall, "--harmonic 0.1 0.1 --rest 60 --no-pictures --out", out]),
            ],
            stdout=file,
            stderr=subprocess.STDOUT,
        ) as child,
    ):
        try:
            before = set()
            deadline = time.monotonic() + 300
            while time.monotonic() < deadline and count_samples(out) == 0:
                before.update(listening(child.pid))
                time.sleep(0.2)
            now = listening(child.pid)
            child.send_signal(number)
            child.wait(timeout=300)
        finally:
            child.kill()
    return (
        command is COMMAND,
        before,
        now,
        child.returncode,
        log.read_text(),
        read_history(out),
    )


def test_nobody_can_reach_a_run_over_the_network(ended):
    """By the launcher YADE opens no port, by its own command two; during a run none is open."""
    by_launcher, before, now, _, text, history = ended
    assert len(before) == (0 if by_launcher else 2)  # the test sees open ones
    assert now == [] and len(history.series) > 0
    assert ("starts YADE without them" in text) == ("cookie" in text) == (not by_launcher)


def test_interrupt_leaves_a_readable_history(ended):
    by_launcher, _, _, status, text, history = ended
    assert status == (130 if by_launcher else -signal.SIGKILL), text
    assert (
        history.status == ("interrupted" if by_launcher else "unfinished")
        and len(history.series) > 0
    )
    assert summarise(history)["residual"] is None


# Two short piers and four courses over an opening of nine bricks, as of the symmetric wall: shaken,
# they fall.
SPANDREL = "Wall('spandrel', 2.925, 0.525, [Opening(0.45, 2.025, 0.225)], precompression=0.3e6)"


@pytest.mark.long
def test_a_fallen_spandrel_ends_the_run_as_collapsed(yade_command, tmp_path):
    out = tmp_path / "none.h5"
    wall = wall_file(tmp_path / "spandrel.py", SPANDREL)
    done = yade_command(
        *SHORT,
        wall,
        "--lintel none --harmonic 0.05 0.5 --out",
        out,
        "--no-pictures",
    )
    assert done.returncode == 0 and "collapsed at" in done.stdout
    history = read_history(out)
    assert history.complete and 0 < history.collapsed_at_s < 0.6
    assert history.series.time_s.iloc[-1] == pytest.approx(history.collapsed_at_s, abs=0.02)
    # a brick has dropped by half its height, 37.5 mm
    times = history.snapshot_time_s
    at = np.flatnonzero(times <= history.series.time_s.iloc[-1])[-1]
    assert -0.06 < history.displacement[at, :, 1].min() < -0.0375
    # the piers stand
    assert np.all(history.displacement[-1, history.bodies.course == -1, 1] > -0.01)
