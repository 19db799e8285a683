"""What `./run_all.sh STUDY --dry-run` tells: runs, time and disk, by hand and by what is there; nothing is made."""

import os
from dataclasses import replace

import pytest
from conftest import REPOSITORY, run_command, wall_file, written
from numpy.testing import assert_allclose
from small_history import make_history

from damage.batch import plan, speed
from damage.batch.outdated import Results
from damage.run.options import parse_run
from damage.studies.definition import load_study
from damage.studies.records import NAME, line_of, record_of

STUDY = '''
name = "s"
[[grid]]
wall = "small.py"
options = { harmonic = [0.1, "{amplitude}"], cycles = 2, rest = 0.3 }
solvers = ["reference"]
members = 5
vary = { amplitude = [0.01, 0.02] }
'''


@pytest.fixture
def study(tmp_path):
    wall_file(tmp_path / "small.py", "Wall('small', 0.9, 0.45)")
    return load_study(written(tmp_path / "s.toml", STUDY), "both", REPOSITORY)


@pytest.fixture
def known(monkeypatch):
    """A machine that is twice as slow as the one that the plan's seconds were measured on, its solver compiled."""
    machine = plan.Speed(*(2 * one for one in plan.MEASURED_AT))
    monkeypatch.setattr(plan, "speed", lambda: machine)
    monkeypatch.setattr(plan, "is_cached", lambda: True)
    return machine


def test_an_estimate_by_hand(study, known):
    """0.2 s of motion, 0.3 s of rest, 0.5 s of settling; 0.4 s of gravity before; a sample every 2 ms or so."""
    run = study.runs[0]
    _, n_joints, critical_s, *_ = plan._wall(run.wall, parse_run([], "plan", "reference").model)
    steps = 1.4 / (0.643 * critical_s)
    alone, together, yade = (plan.estimate(run, way, known) for way in ("alone", "together", "yade"))
    assert_allclose(alone.seconds, 2 * 0.75 + 1.5 * steps * n_joints * 5.2e-9, rtol=1e-2)
    assert_allclose(together.seconds, 2 * 0.25 + 2.0 * steps * n_joints * 2.5e-9, rtol=1e-2)
    assert_allclose(yade.seconds, 2 * 5.0 + steps * n_joints * 800e-9, rtol=1e-2)
    assert_allclose(alone.n_bytes, 1.0 / 2e-3 * n_joints * 1.15, rtol=0.1)


def test_a_run_with_deformable_bricks_takes_longer_by_its_steps_and_their_time(study, known):
    """Of a third and less of the rigid wall's time step, each of 16 times the time; none together."""
    run = replace(study.runs[0], words=(*study.runs[0].words, "--bricks", "deformable"))
    rigid, deformable = (plan.estimate(one, "alone", known) for one in (study.runs[0], run))
    assert_allclose(plan.estimate(run, "together", known).seconds - 2 * 0.25, deformable.seconds - 2 * 0.75)
    critical_s = [plan._wall(run.wall, parse_run(words, "plan", "reference").model)[2]
                  for words in ([], ["--bricks", "deformable"])]
    assert_allclose((deformable.seconds - 1.5) / (rigid.seconds - 1.5), 16 * critical_s[0] / critical_s[1], rtol=0.05)


def test_runs_step_together_where_there_are_enough_for_all_processes(study):
    most = 20 // plan.LEAST_LANES  # of 20 runs that are alike
    assert set(plan.ways_of(study.runs, most).values()) == {"together"}
    assert set(plan.ways_of(study.runs, most + 1).values()) == {"alone"}


def test_the_time_is_a_range_with_what_the_batch_itself_takes(study, tmp_path, capsys, known, monkeypatch):
    """Of ten or twenty runs, pictures of two of them, and one batch."""
    one_s = plan.estimate(study.runs[0], "together", known).seconds
    around_s = 2 * (2 * plan.PICTURES_S + plan.BATCH_S)
    plan.print_plan(study, tmp_path / "out", 1)
    printed = capsys.readouterr().out
    assert (f"expected: {plan.duration(0.6 * (10 * one_s + around_s))} to {plan.duration(2 * (20 * one_s + around_s))} "
            "with 1 at a time") in printed
    assert "by this machine's speed, measured once: 5.2 ns" in printed and "compiling" not in printed
    monkeypatch.setattr(plan, "is_cached", lambda: False)
    monkeypatch.setattr(plan, "speed", lambda: None)
    monkeypatch.setattr(plan, "python_seconds", lambda: 3 * plan.PYTHON_S)
    plan.print_plan(study, tmp_path / "out", 1)
    printed = capsys.readouterr().out
    assert "with compiling the solver once, about 0:01:15" in printed and "not compiled yet" in printed


def test_the_dry_run_tells_all_and_makes_nothing(study, tmp_path):
    before = sorted(path.name for path in tmp_path.iterdir())
    done = run_command("./run_all.sh", study.path, "--dry-run", "--solver", "reference", "-j", 2, "--out",
                       tmp_path / "out", status=0)
    assert "points: 2, 0 there; runs to make: up to 20" in done.stdout
    assert "with 2 at a time, where nothing else runs" in done.stdout and "this machine" in done.stdout
    assert all(f"small_harmonic-0.1-{amplitude}" in done.stdout for amplitude in (0.01, 0.02))
    assert sorted(path.name for path in tmp_path.iterdir()) == before


def test_what_is_there_sets_the_scale(study, tmp_path, capsys, known):
    run, folder = study.runs[0], tmp_path / "out"
    (folder / "runs").mkdir(parents=True)
    history = make_history(folder / "runs" / f"{run.first}.h5")
    record = record_of(history, run.first, run.point) | {"intact": True}
    results = Results(folder)
    results.records.runs[run.first], results.records.orderly = record, False
    results.write(Results(tmp_path / "none").judge([run]))
    (key,) = Results(folder).records.inputs
    (folder / NAME).write_text((folder / NAME).read_text() + line_of(record | {"inputs": key}))
    began = plan.datetime.fromisoformat(history.attributes["created_utc"]).timestamp()
    os.utime(history.path, (began, began + 100))
    plan.print_plan(study, folder, 20 // plan.LEAST_LANES + 1)  # too few runs for groups in all processes
    printed = capsys.readouterr().out
    assert "there, 1 runs" in printed and "points: 2, 1 there; runs to make: up to 10" in printed
    assert "and what those that are there took (1)" in printed
    assert "5 to 10 runs of about 0:01:40" in printed  # the other motion has as many steps
    plan.print_plan(study, folder, 1)  # those of a group took the group's time
    assert "5 to 10 runs of about 0:00:01" in capsys.readouterr().out


def test_the_speed_is_measured_once(tmp_path, monkeypatch):
    measured = []
    monkeypatch.setattr(speed, "is_cached", lambda: True)
    monkeypatch.setattr(speed, "kept_in", lambda: tmp_path)
    monkeypatch.setattr(speed, "_measure", lambda n_walls: measured.append(n_walls) or 3.0 / n_walls)
    assert speed.speed() == speed.speed() == speed.Speed(3.0, 3.0 / 8) and measured == [1, 8]
    (path,) = tmp_path.glob("speed-*.json")
    path.write_text("{torn")
    assert speed.speed() == (3.0, 3.0 / 8) and measured == [1, 8] * 2
    monkeypatch.setattr(speed, "is_cached", lambda: False)
    assert speed.speed() is None


def test_measuring_gives_a_speed():
    """Some nanoseconds: a contact point's step takes hundreds of instructions, and eight walls share them."""
    assert 0.01 < speed._measure(1) < 1e4 and speed.python_seconds() > 0


def test_a_wrong_study_is_refused(tmp_path):
    done = run_command("./run_all.sh", written(tmp_path / "s.toml", "name = 1\n"), "--dry-run", status=2)
    assert "error: " in done.stderr
