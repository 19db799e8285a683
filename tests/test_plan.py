"""What `./run_all.sh STUDY --dry-run` tells: runs, time and disk, by hand and by what is there; nothing is made."""

import os
import sys

import pytest
from conftest import REPOSITORY, run_command
from numpy.testing import assert_allclose
from small_history import make_history

from damage.studies.definition import load_study

sys.path.insert(0, str(REPOSITORY / "workflow"))
import plan

STUDY = '''
name = "s"
[[grid]]
wall = "small.py"
options = { harmonic = [0.1, "{amplitude}"], cycles = 2, rest = 0.3 }
solvers = ["reference"]
members = 5
vary = { amplitude = [0.01, 0.02] }
'''
WALL = 'from damage import Wall\n\ndef wall():\n    return Wall("small", 0.9, 0.45)\n'


@pytest.fixture
def study(tmp_path):
    (tmp_path / "small.py").write_text(WALL)
    (tmp_path / "s.toml").write_text(STUDY)
    return load_study(tmp_path / "s.toml", "both", REPOSITORY)


def test_an_estimate_by_hand(study):
    """0.2 s of motion, 0.3 s of rest, 0.5 s of settling; 0.4 s of gravity before; a sample every 2 ms or so."""
    run = study.runs[0]
    _, n_joints, critical_s, _ = plan._wall(run.wall, plan.parse_run([], "plan", "reference").model)
    steps = 1.4 / (0.643 * critical_s)
    found = plan.estimate(run)
    assert_allclose(found.seconds, steps * n_joints * 6.1e-9, rtol=1e-2)
    assert_allclose(found.n_bytes, 1.0 / 2e-3 * n_joints * 1.15, rtol=0.1)


def test_the_dry_run_tells_all_and_makes_nothing(study, tmp_path):
    before = sorted(path.name for path in tmp_path.iterdir())
    done = run_command("./run_all.sh", study.path, "--dry-run", "--solver", "reference", "-j", 2, "--out",
                       tmp_path / "out")
    assert done.returncode == 0, done.stderr
    assert "points: 2, 0 there; runs to make: up to 20" in done.stdout
    assert "with 2 at a time" in done.stdout and "by the speeds of docs/two-solvers.md" in done.stdout
    assert all(f"small_harmonic-0.1-{amplitude}" in done.stdout for amplitude in (0.01, 0.02))
    assert sorted(path.name for path in tmp_path.iterdir()) == before


def test_what_is_there_sets_the_scale(study, tmp_path, capsys):
    run, folder = study.runs[0], tmp_path / "out"
    (folder / "runs").mkdir(parents=True)
    history = make_history(folder / "runs" / f"{run.first}.h5")
    (folder / "runs" / f"{run.id}.members").write_text(run.first)
    began = plan.datetime.fromisoformat(history.attributes["created_utc"]).timestamp()
    os.utime(history.path, (began, began + 100))
    plan.tell(study, folder, 1)
    told = capsys.readouterr().out
    assert "there, 1 runs" in told and "points: 2, 1 there; runs to make: up to 10" in told
    assert "by what those that are there took (1)" in told
    assert "5 to 10 runs of 0:01:40" in told  # the other motion has as many steps


def test_a_wrong_study_is_refused(tmp_path):
    (tmp_path / "s.toml").write_text("name = 1\n")
    done = run_command("./run_all.sh", tmp_path / "s.toml", "--dry-run")
    assert done.returncode == 2 and "error: " in done.stderr
