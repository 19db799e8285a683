"""Checkpoints: a run that was killed or interrupted continues to the bits of one that was not."""

import os
import shutil
import signal
from itertools import groupby
from pathlib import Path

import numpy as np
import pytest
from conftest import REPOSITORY, SHORT, in_words, one_line_error, wall_file, written

from benchmarks.same_bits import differences, values
from damage import load_wall, read_history
from damage.law.joint_law import ContactState
from damage.reference.session import run_reference
from damage.run import run as run_module
from damage.run.checkpoint import checkpoint_path, read_checkpoint
from damage.run.initial_state import read_earlier
from damage.wall.layout import lay_out

SMALL, SOFTENS = (REPOSITORY / f"walls/variants/{name}.py" for name in ("small", "small_softening"))
OFTEN = "--checkpoint 0.001"
TOP_SHARE = (SMALL, "--pushover 0.02 --floor-share 0.6 1 --no-pictures")
SHAKE = (SMALL, "--harmonic 0.06 0.6 --rest 0.1 --no-pictures --quiet")
KAPPA = ContactState._fields.index("kappa")
SHOCK = "--harmonic 0.1 0.4 --cycles 1 --rest 0 --no-pictures"
LOOSE = 0.4e-3  # opening [m] from which bricks collide in YADE
SPLITS = ("split.py", "--pushover 0.05 --boundary fixed --speed 0.03")
RUNS = {
    "settled": ("--settle hogging --distortion 1/500 --stresses",),
    "split": (*SPLITS, "--no-pictures --quiet"),
    "spread": (*TOP_SHARE, "--relaxation local --quiet"),
    "falling": (
        SMALL,
        "--harmonic 0.1 1.5 --rest 0.1 --no-pictures --quiet",
    ),
    "deformable": ("--bricks deformable --rest 0",),
    "scaled": (
        "window.toml",
        "--harmonic 0.06 1.5 --cycles 2 --rest 0 --no-pictures --quiet",
    ),
}
SOFT = (
    'name = "soft"\nlength = 0.9\nheight = 0.6\nprecompression = 0.1e6\n'
    "joint = { mode_i_fracture_energy = 12.4, mode_ii_fracture_energy = 124.0 }\n"
)
WALLS = {
    "soft.toml": SOFT,  # the other's steps are repeated, with less and without mass scaling
    "split.py": "Wall('split', 0.675, 0.225, brick=Brick(tensile_strength=2e5, fracture_energy=6),"
    " joint=Joint(mode_i_fracture_energy=12.4, mode_ii_fracture_energy=124.0))",
    "window.toml": f"{SOFT}[[openings]]\nleft = 0.3\nwidth = 0.3\nheight = 0.3\nsill = 0.15\n",
}


def words_of(words, folder):
    """The words of a run; its wall is in the folder where it does not ship."""
    first, *more = words or [""]
    if first in WALLS:
        write = wall_file if first.endswith(".py") else written
        return [write(folder / first, WALLS[first]), *more]
    return words if isinstance(first, Path) else (*SHAKE, *words)


def in_a_child(words, looks=None, name=signal.SIGKILL):
    """Exit status of a run in a process of its own, which gets a signal at its look of this number;
    -9 where killed.

    A checkpoint is due at every third look.
    """
    if (child := os.fork()) == 0:
        status = 1
        signal.alarm(300)  # it must not be waited for longer
        try:
            seen = []
            continues = run_module.Run._continues

            def counted(run):
                seen.append(run)
                run._checkpoints.due = lambda: len(seen) % 3 == 0
                if len(seen) == looks:
                    os.kill(os.getpid(), name)
                return continues(run)

            run_module.Run._continues = counted
            status = run_reference(in_words(words))
        finally:
            os._exit(status)
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])


@pytest.mark.parametrize(
    "name",
    [pytest.param(name, marks=[pytest.mark.long] * (name == "deformable")) for name in RUNS],
)
def test_kills_leave_every_bit(name, tmp_path, monkeypatch):
    """A run is killed in the static stage, and interrupted in the middle of each stage."""
    words = words_of(RUNS[name], tmp_path)
    whole = tmp_path / "whole.h5"
    cut = tmp_path / "cut.h5"
    stages = []
    continues = run_module.Run._continues
    with monkeypatch.context() as patch:  # here: the children find all compiled
        patch.setattr(
            run_module.Run, "_continues", lambda run: stages.append(run.stage) or continues(run)
        )
        assert run_reference(in_words([*words, "--out", whole])) == 0
    assert not checkpoint_path(whole).exists()
    assert in_a_child([*words, OFTEN, "--out", cut], looks=4) == -9
    # the look that wrote a checkpoint
    words = (*words, "--resume", cut)
    here = 3
    looks = enumerate(stages, 1)
    for _, looks_of_stage in groupby(looks, lambda look: look[1]):
        numbers = [number for number, _ in looks_of_stage]
        there = numbers[len(numbers) // 2]
        assert in_a_child([*words, OFTEN], there - here + 1, signal.SIGINT) == 130
        assert checkpoint_path(cut).exists()
        here = there
    assert in_a_child(words) == 0
    assert differences(values(whole), values(cut)) == [] and not checkpoint_path(cut).exists()
    first = read_history(whole)
    second = read_history(cut)
    assert first.parameters == second.parameters and second.complete and len(second.series) > 20
    assert (second.parameters["repeats"] > 0) == (name == "scaled")


@pytest.fixture(scope="module")
def interrupted(tmp_path_factory):
    """A folder with a run that was interrupted, cut.h5."""
    folder = tmp_path_factory.mktemp("interrupted")
    assert in_a_child([*SHAKE, "--out", folder / "cut.h5"], looks=6, name=signal.SIGINT) == 130
    return folder


def refused(folder, words, capsys):
    """The one line of a run that is refused."""
    before = {path.name: path.read_bytes() for path in folder.iterdir()}
    assert run_reference(in_words(words)) == 2
    assert {path.name: path.read_bytes() for path in folder.iterdir()} == before
    (line,) = (line for line in capsys.readouterr().err.splitlines() if line.startswith("error: "))
    return line


@pytest.mark.parametrize(
    "words, said",
    [
        (
            (*SHAKE, "--scatter 0.01 --seed 1"),
            "the history of another wall, small: joints/",
        ),
        (
            (*SHAKE, "--rest 0.2"),
            "rest_s is 0.2, and was 0.1; expected the options of the run that was interrupted",
        ),
        ((*SHAKE, "--out other.h5"), "with --out or --overwrite: expected one of them"),
        (
            (*SHAKE, "--members 2"),
            "--members with --checkpoint or --resume: expected a single run",
        ),
    ],
)
def test_another_run_than_that_of_the_checkpoint_is_one_line(interrupted, words, said, capsys):
    assert said in refused(interrupted, [*words, "--resume", interrupted / "cut.h5"], capsys)


def test_a_run_of_the_other_solver_is_one_line(interrupted):
    path = interrupted / "cut.h5"
    said = one_line_error(
        read_earlier, path, lay_out(load_wall(SMALL)), ("yade", "as now"), "--resume", False
    )
    assert said.startswith(
        f"--resume {path}: a run of the reference solver; expected one of the yade solver"
    )


def test_a_damaged_checkpoint_is_one_line(interrupted, tmp_path, capsys):
    shutil.copytree(interrupted, tmp_path, dirs_exist_ok=True)
    path = tmp_path / "cut.checkpoint"
    cut = tmp_path / "cut.h5"
    content = path.read_bytes()
    resume = [*SHAKE, "--resume", cut]
    path.write_bytes(content[:1000] + bytes([content[1000] ^ 1]) + content[1001:])
    assert "is no whole checkpoint: its digest is another one" in refused(tmp_path, resume, capsys)
    path.unlink()
    assert "no checkpoint" in refused(tmp_path, resume, capsys)
    assert in_a_child([*SHAKE, "--out", tmp_path / "other.h5"], looks=8, name=signal.SIGINT) == 130
    shutil.copyfile(tmp_path / "other.checkpoint", path)
    assert "the checkpoint beside it is of another run" in refused(tmp_path, resume, capsys)


def test_a_complete_run_is_not_resumed(tmp_path, capsys):
    assert in_a_child([*SHAKE, "--rest 0 --out", tmp_path / "done.h5"]) == 0
    line = refused(tmp_path, [*SHAKE, "--rest 0 --resume", tmp_path / "done.h5"], capsys)
    assert "its run is complete" in line and "--continue" in line


@pytest.mark.yade
@pytest.mark.long
def test_kills_of_a_run_in_yade_leave_what_it_computes(tmp_path, yade_command):
    """Killed, or every third interrupted, in the static stage and then at equal distances in the
    motion; the damaged wall's bricks are loose by the last one.  Every bit is equal until they are:
    potential contacts of loose bricks are found anew, in another order of sums, which a brittle
    wall amplifies."""
    words = (SMALL, "--harmonic 0.06 0.6 --cycles 2 --rest 0.06 --no-pictures")
    yade_command(*SHORT, *words, "--out", tmp_path / "whole.h5", status=0)
    whole = read_history(tmp_path / "whole.h5")
    cut = tmp_path / "cut.h5"
    place = "--out"
    kills = 10
    for number in range(kills):
        kind, status = (
            ("INTERRUPTED_AT", 130) if number % 3 == 1 else ("KILLED_AT", -signal.SIGKILL)
        )
        time_s = number / (kills + 1) * whole.series["time_s"].iloc[-1]
        yade_command(*SHORT, f"{kind}={time_s}", *words, place, cut, status=status)
        place = "--resume"
    there = read_checkpoint(checkpoint_path(cut))
    assert there[".clock"] * whole.time_step_s >= time_s
    assert there["tracker.broken"].any() and len(there["corners"])
    done = yade_command(*SHORT, *words, "--resume", cut, status=0)
    assert "YADE executes the names of the engines" in done.stderr, done.stderr
    now = read_history(cut)
    names = whole.series.select_dtypes("number").columns
    before, after = (history.series[names].fillna(0.0).to_numpy() for history in (whole, now))
    loose = (whole.opening_m > LOOSE).any(axis=1)
    alike = next(iter(np.flatnonzero((after != before).any(axis=1))), len(before))
    assert np.array_equal(now.opening_m[:alike], whole.opening_m[:alike], equal_nan=True)
    assert np.array_equal(now.snapshot_time_s, whole.snapshot_time_s)
    for differs in np.flatnonzero((after != before).any(axis=1))[:1]:
        assert loose[:differs].any()
        # A sample is taken a hundred steps after that, in which the last bit grows.
        assert np.all(np.abs(after - before)[differs] <= 1e-10 * np.abs(before).max(axis=0))


@pytest.mark.yade
@pytest.mark.long
@pytest.mark.parametrize(
    "words, time_s, softened",
    [
        ((SMALL, "--pushover 0.02 --top-rotation 2e4 --no-pictures"), 0.02, 0),
        (TOP_SHARE, 0.02, 0),
        ((*SPLITS, "--no-pictures"), 0.03, 1),
        ((SOFTENS, SHOCK), 0.09, 11),
    ],
    ids=["held top", "spreader beam", "bricks that split", "bonds that soften"],
)
def test_what_acts_and_what_softens_continues_in_yade(
    words, time_s, softened, tmp_path, yade_command
):
    """What acts on a brick that is held, or of a spreader beam, is added between two steps, and is
    in the checkpoint, too; so are bonds, and cuts through bricks, that soften: this many or more,
    or none."""
    words = words_of(words, tmp_path)
    whole = tmp_path / "whole.h5"
    cut = tmp_path / "cut.h5"
    yade_command(*SHORT, *words, "--out", whole, status=0)
    killed = f"KILLED_AT={time_s}"
    yade_command(*SHORT, killed, *words, "--out", cut, status=-signal.SIGKILL)
    found = (read_checkpoint(checkpoint_path(cut))["bonds.tables.states"][:, KAPPA] > 0.0).sum()
    assert found >= softened and (found > 0) == (softened > 0)
    yade_command(*SHORT, *words, "--resume", cut, status=0)
    assert differences(values(whole), values(cut)) == []
