"""Shards: how a study's runs are grouped, what they leave, what stays of their histories, how they go on."""

import io
import json
import multiprocessing
import os
import signal
import subprocess
import sys
import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, replace
from types import SimpleNamespace

import pandas as pd
import pytest
from conftest import REPOSITORY, contents
from small_history import make_history

from damage.studies.definition import StudyRun
from damage.studies.records import add_record, all_records, read_records, record_of

TINY = "from damage import Wall\n\n\ndef wall():\n    return Wall(name='tiny', length=0.45, height=0.6)\n"
STUDY = '''name = "s"
pictures = "none"
[[grid]]
wall = "tiny.py"
options = { harmonic = [0.1, "{g}"], cycles = 1, rest = 0, strength-cov = 0.3 }
samples = %d
vary = { g = [0.5, 0.4] }
[[runs]]
id = "alone"
wall = "tiny.py"
options = { harmonic = [0.1, 0.3], cycles = 1, rest = 0, sequence = "1,0.5" }
'''


@pytest.fixture
def workflow(monkeypatch):
    monkeypatch.syspath_prepend(str(REPOSITORY / "workflow"))


def point(name, members=2, **options):
    return StudyRun(name, "walls/symmetric.py", (), "reference", ("--strength-seed",), members, **options)


class TestRecords:
    def test_a_record_is_read_as_it_was_written_and_one_that_a_kill_tore_is_none(self, tmp_path):
        history = make_history(tmp_path / "a.h5", broken=[0])
        record = record_of(history, "a", "p")
        assert record["row"]["point"] == "p" and not record["intact"]
        path = tmp_path / "shards" / "0000.rows"
        path.parent.mkdir()
        with open(path, "w") as file:
            add_record(file, {**record, "run": "b"})
            add_record(file, record)
        text = path.read_text()
        assert read_records(path) == json.loads(json.dumps({"b": {**record, "run": "b"}, "a": record}))
        path.write_text(text[:-20])
        assert list(all_records(tmp_path)) == ["b"]
        with open(path, "a") as file:
            file.write("\n")
            add_record(file, record)
        assert list(all_records(tmp_path)) == ["b", "a"]


class TestShards:
    def test_points_are_grouped_by_how_many_runs_they_may_have(self, workflow):
        from shards import grouped

        points = [point("a", 25), point("b", 25), point("c", 5, adaptive=True), point("d", 30), point("e", 1)]
        assert [[run.point for run in shard] for shard in grouped(points, 40)] == [["a", "b"], ["c", "d"], ["e"]]
        assert [len(shard) for shard in grouped(points, 1)] == [1] * 5 and list(grouped([], 3)) == []

    def test_a_run_names_its_point(self, workflow):
        from shards import point_of

        assert point_of("drawn_s1_reference_s12") == "drawn_s1_reference"
        assert point_of("single_reference") == "single_reference"

    def test_records_move_with_their_points_and_those_of_other_inputs_go(self, workflow, tmp_path):
        from shards import write_shards

        def shards(points, size):
            write_shards(SimpleNamespace(runs=points), tmp_path, "all", size)
            return {path.stem: list(read_records(path.with_suffix(".rows")))
                    for path in sorted((tmp_path / "shards").glob("*.json"))}

        a, b = point("a"), point("b")
        assert shards([a, b], 1) == {"0000": [], "0001": []}
        for number, name in enumerate(("a_reference_s1", "b_reference_s1")):
            with open(tmp_path / "shards" / f"{number:04d}.rows", "a") as file:
                add_record(file, {"run": name})
        (tmp_path / "shards" / "0000.done").touch()
        assert shards([a, b], 10) == {"0000": ["a_reference_s1", "b_reference_s1"]}
        assert not (tmp_path / "shards" / "0000.done").exists()
        assert shards([b, a], 1) == {"0000": ["b_reference_s1"], "0001": ["a_reference_s1"]}
        changed = StudyRun("a", a.wall, ("--rest", "1"), "reference", a.varied, 2)
        assert shards([b, changed], 1) == {"0000": ["b_reference_s1"], "0001": []}
        assert shards([b], 1) == {"0000": ["b_reference_s1"]}
        assert [path.name for path in sorted((tmp_path / "shards").iterdir())] == ["0000.json", "0000.rows"]

    def test_idle_processes_get_lanes_where_there_are_enough_runs_for_all(self, workflow):
        from run_shard import take_group

        def taken(companies, idle):
            waiting = [SimpleNamespace(company=company, number=k) for k, company in enumerate(companies)]
            group = take_group(waiting, idle)
            assert len(group) + len(waiting) == len(companies)
            return [task.number for task in group]

        assert taken("a" * 20, 1) == list(range(8)) == taken("a" * 16, 2)
        assert taken("a" * 12, 2) == list(range(6)) and taken("a" * 10, 2) == [0] and taken("a" * 5, 1) == [0]
        assert taken("ab" * 8, 1) == list(range(0, 16, 2)) and taken("abcdefgh", 1) == [0]


@pytest.fixture
def study(tmp_path):
    pytest.importorskip("snakemake")
    (tmp_path / "tiny.py").write_text(TINY)
    path = tmp_path / "study.toml"
    path.write_text(STUDY % 6)
    return path


def run(study, out, *words):
    """A batch of the reference solver to its end; returns the names of histories that stay."""
    done = subprocess.run([REPOSITORY / "run_all.sh", study, "--solver", "reference", "-j2", "--out", out, *words],
                          timeout=300, capture_output=True, text=True,
                          env={**os.environ, "PYTHON": sys.executable, "MASONRY_NO_INSTALL": "1"})
    assert done.returncode == 0, done.stdout + done.stderr
    assert not list((out / "runs").glob("*.part.h5"))
    return {path.stem for path in (out / "runs").glob("*.h5")}


def tables(folder):
    return {path.name: path.read_bytes() for path in (folder / "tables").glob("*.csv")}


@pytest.mark.slow
def test_with_histories_of_a_sample_alone_the_tables_are_the_same_and_any_run_can_be_made_again(study, tmp_path):
    whole, summary = tmp_path / "whole", tmp_path / "summary"
    names = run(study, whole)
    firsts = {name for name in names if name.endswith("_s1") or name == "alone_reference"}
    assert len(names) == 13 and len(firsts) == 3
    assert run(study, summary, "--keep", "summary", "--shard", "7") == firsts
    assert tables(summary) == tables(whole) and len(tables(whole)) == 17
    assert len(list((summary / "shards").glob("*.rows"))) == 2
    shocks = pd.read_csv(io.BytesIO(tables(summary)["shocks.csv"]))
    assert set(shocks["run"]) == {"alone_reference"} and len(shocks) == 2

    again = max(names - firsts)
    run(study, summary, "--run", again)
    assert contents(summary / "runs" / f"{again}.h5") == contents(whole / "runs" / f"{again}.h5")
    before = {path: path.stat().st_mtime_ns for path in (summary / "runs").glob("*.h5")}
    (summary / "tables" / "summary.csv").unlink()
    study.write_text(STUDY % 7)  # one more of each, in other shards
    assert run(study, summary, "--keep", "summary", "--shard", "100") == firsts | {again}
    assert before == {path: path.stat().st_mtime_ns for path in before}
    assert len(pd.read_csv(summary / "tables" / "summary.csv")) == 15
    assert (summary / "logs" / "shard_0000.log").read_text().count("history: ") == 2


def test_an_interruption_says_what_it_loses(workflow, tmp_path):
    """Six walls that step together through 100 s: none has ended."""
    (tmp_path / "tiny.py").write_text(TINY)
    one = point("p", 6)
    one = replace(one, wall=str(tmp_path / "tiny.py"), words=(
        "--harmonic", "0.1", "0.5", "--rest", "100", "--strength-cov", "0.3"))
    shard = tmp_path / "shards" / "0000.json"
    shard.parent.mkdir()
    (tmp_path / "runs").mkdir()
    shard.write_text(json.dumps({"keep": "all", "points": [asdict(one)]}))
    process = subprocess.Popen([sys.executable, REPOSITORY / "workflow" / "run_shard.py", shard, "--jobs", "1"],
                               cwd=REPOSITORY, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
                               env={**os.environ, "PYTHONPATH": str(REPOSITORY)})
    until = time.monotonic() + 200
    while len([*(tmp_path / "runs").glob("*.part.h5")]) < 6 and process.poll() is None and time.monotonic() < until:
        time.sleep(0.02)
    process.send_signal(signal.SIGTERM)
    _, told = process.communicate(timeout=100)
    assert process.returncode == 130
    assert ("@@ 6 runs step together and are saved when they have ended: an interruption loses those under way\n"
            in told)
    assert "@@ interrupted: 6 runs were under way and are lost; 0 that had ended are kept\n" in told


def test_an_interrupt_while_runs_that_have_ended_leave_their_records_loses_none(workflow, tmp_path, monkeypatch):
    import run_shard

    (tmp_path / "runs").mkdir()
    tasks = [run_shard.Task(tmp_path, point("p", 3), number, True) for number in (1, 2, 3)]
    for task in tasks:
        make_history(task.history)

    def conclude(task, kept=None):
        os.kill(os.getpid(), signal.SIGTERM)  # as of Shard._interrupt
        return 0, {"run": task.name}

    monkeypatch.setattr(run_shard, "conclude", conclude)
    with ProcessPoolExecutor(1, multiprocessing.get_context("fork"), run_shard._begin_worker) as workers:
        done = workers.submit(run_shard.do_group, tasks).result(timeout=100)
    assert [(status, record["run"]) for _, status, record in done] == [(0, task.name) for task in tasks]
