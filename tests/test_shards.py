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
from conftest import BATCH, BATCH_ENVIRONMENT, REPOSITORY, contents
from small_history import make_history

from damage.errors import InputError
from damage.measure.tables import summary_row, write_table
from damage.provenance import measures_digest
from damage.studies.definition import StudyRun, load_study
from damage.studies.records import add_record, all_records, line_of, look_at, read_records, record_of
from damage.studies.tables import summary_of

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


@pytest.mark.xfail(strict=True, raises=pytest.fail.Exception,
                   reason="the lock is a file that can be deleted: a second batch locks a new one")
def test_a_folder_whose_lock_was_deleted_takes_no_second_batch(workflow, tmp_path, monkeypatch):
    import batch

    monkeypatch.setattr(batch, "LOCK_PATIENCE_S", 0.0)
    (tmp_path / "s.toml").write_text(STUDY % 2)
    study = SimpleNamespace(name="s", path=tmp_path / "s.toml")
    with batch.claim(tmp_path / "out", study):
        (tmp_path / "out" / ".lock").unlink()
        with pytest.raises(InputError, match="another batch is at work"):
            batch.claim(tmp_path / "out", study).close()


def record(name, folder):
    """What a small run leaves, of today's measures."""
    return json.loads(json.dumps(record_of(make_history(folder / "one.h5", broken=[0], overwrite=True), name, "p")))


def shards_of(folder):
    """Writes the shards of points in a folder: ({number: names of the records in it}, warnings)."""
    from shards import write_shards

    def write(points, size=10, stale=()):
        (folder / "runs").mkdir(exist_ok=True)
        warnings = write_shards(SimpleNamespace(runs=points), folder, "all", size, stale)
        return {path.stem: list(read_records(path.with_suffix(".rows")))
                for path in sorted((folder / "shards").glob("*.json"))}, warnings
    return write


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

    @pytest.mark.parametrize(("old", "new", "what"), [
        ('"max_DI": 0.', '"max_DI": 7.', "its checksum is wrong"),
        ('"intact": false', '"intact": true', "its checksum is wrong"),
        ('"run": "b"', '"run": "c"', "its checksum is wrong"),
        ('{"run"', '{{"run"', "it is no JSON"),
        ('"row": {', '"other": {', "it lacks one of run, intact, row, cycles, shocks"),
    ])
    @pytest.mark.usefixtures("workflow")
    def test_a_changed_line_is_found_and_counts_as_not_made(self, old, new, what, tmp_path):
        from shards import write_shards

        write, path = shards_of(tmp_path), tmp_path / "shards" / "0000.rows"
        write([point("a")])
        records = [record("a_reference_s1", tmp_path), record("a_reference_s2", tmp_path)]
        path.write_text("".join(map(line_of, records)))
        assert write([point("a")]) == ({"0000": ["a_reference_s1", "a_reference_s2"]}, [])
        lines = [line_of(records[0]), line_of(records[1] | {"run": "b"}).replace(old, new, 1)]
        assert new in lines[1]
        path.write_text("".join(lines))
        found, faults = look_at(path)
        assert (list(found), [(number, fault) for number, _, fault in faults]) == (["a_reference_s1"], [(2, what)])
        (tmp_path / "shards" / "0000.done").touch()
        warnings = write_shards(SimpleNamespace(runs=[point("a")]), tmp_path, "all", 10)
        name = "c" if new.endswith('"c"') else "b"
        assert warnings == [f"{path} line 2: the record of {name} was changed since it was written ({what}): it counts "
                            "as not made"]
        assert list(read_records(path)) == ["a_reference_s1"] and not (tmp_path / "shards" / "0000.done").exists()
        assert write([point("a")])[1] == []  # reported once

    @pytest.mark.parametrize(("name", "value", "good"), [
        ("max_DI", 1.0, True), ("max_DI", 7.95, False), ("residual_accumulated_DI_slip", -0.1, False),
        ("max_slip_mm", -1e-9, False), ("residual_drift_ratio", -0.5, True), ("input_energy_j", float("inf"), False),
        ("period_s", float("nan"), True), ("collapsed_at_s", None, True)])
    def test_a_record_without_a_checksum_is_believed_if_its_numbers_can_be(self, name, value, good, tmp_path):
        path, one = tmp_path / "0000.rows", record("a", tmp_path)
        assert name in one["row"]
        one["row"][name] = value
        path.write_text(json.dumps(one) + "\n")
        found, faults = look_at(path)
        assert (len(found), len(faults)) == ((1, 0) if good else (0, 1))
        one = record("a", tmp_path)
        one["cycles"] = [{"max_DI": value if name == "max_DI" else 0.5}]
        path.write_text(json.dumps(one) + "\n")
        assert len(look_at(path)[1]) == (name == "max_DI" and not good)


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

    @pytest.mark.usefixtures("workflow")
    def test_records_move_with_their_points_and_those_of_other_inputs_go(self, tmp_path):
        def shards(points, size, stale=()):
            return shards_of(tmp_path)(points, size, stale)[0]

        a, b = point("a"), point("b")
        assert shards([a, b], 1) == {"0000": [], "0001": []}
        for number, name in enumerate(("a_reference_s1", "b_reference_s1")):
            with open(tmp_path / "shards" / f"{number:04d}.rows", "a") as file:
                add_record(file, record(name, tmp_path))
        (tmp_path / "shards" / "0000.done").touch()
        assert shards([a, b], 10) == {"0000": ["a_reference_s1", "b_reference_s1"]}
        assert not (tmp_path / "shards" / "0000.done").exists()
        assert shards([b, a], 1) == {"0000": ["b_reference_s1"], "0001": ["a_reference_s1"]}
        assert shards([b, a], 1, {a.id}) == {"0000": ["b_reference_s1"], "0001": []}
        assert shards([b], 1) == {"0000": ["b_reference_s1"]}
        assert [path.name for path in sorted((tmp_path / "shards").iterdir())] == ["0000.json", "0000.rows"]

    @pytest.mark.usefixtures("workflow")
    def test_records_of_points_that_a_study_lacks_are_set_aside_and_come_back(self, tmp_path):
        write, aside = shards_of(tmp_path), tmp_path / "shards" / "set-aside.rows"
        a, b = point("a"), point("b")
        write([a, b])
        with open(tmp_path / "shards" / "0000.rows", "a") as file:
            for name in ("a_reference_s1", "b_reference_s1"):
                add_record(file, record(name, tmp_path))
        assert not aside.exists()
        shards, warnings = write([b])
        assert shards == {"0000": ["b_reference_s1"]} and list(read_records(aside)) == ["a_reference_s1"]
        assert len(warnings) == 1 and warnings[0].startswith("1 records of points that the study no longer has are set")
        assert write([b]) == (shards, []) and list(read_records(aside)) == ["a_reference_s1"]
        assert write([b, a]) == ({"0000": ["b_reference_s1", "a_reference_s1"]}, [])
        assert not read_records(aside)
        write([b])
        assert write([b, a], stale={a.id}) == ({"0000": ["b_reference_s1"]}, [])  # of other inputs by now

    @pytest.mark.usefixtures("workflow")
    def test_records_of_other_measures_are_worked_out_of_histories_or_refused(self, tmp_path, monkeypatch):
        import versions

        a, write = point("a"), shards_of(tmp_path)
        study = SimpleNamespace(name="s", runs=[a], of_both=[a])
        write([a])
        old = record("a_reference_s1", tmp_path)
        old["row"]["measures_digest"] = "of before"
        before = record("a_reference_s2", tmp_path)
        del before["row"]["measures_digest"]  # of a version without it
        (tmp_path / "shards" / "0000.rows").write_text("".join(map(line_of, (old, before))))
        history = tmp_path / "runs" / "a_reference_s2.h5"
        (tmp_path / "runs" / "a_reference.members").write_text("a_reference_s1\na_reference_s2\n")
        message = "the index or measures of 1 runs are .*: a_reference_s1; expected one definition .* give --remake"
        both = message.replace("1 runs", "2 runs").replace("s1;", "s1, a_reference_s2;")
        for refused in (lambda: versions.of_other_measures(study, tmp_path, remake=False),
                        lambda: summary_of(study, tmp_path)):
            with pytest.raises(InputError, match=both):
                refused()
            make_history(history, overwrite=True)
            with pytest.raises(InputError, match=message):
                refused()
            history.unlink()
        make_history(history)
        assert versions.of_other_measures(study, tmp_path, remake=True) == ["a_reference_s1"]
        assert versions.of_other_measures(study, tmp_path, remake=False, stale={a.id}) == []
        assert write([a], stale=())[0] == {"0000": []}  # the shard makes others
        assert not (tmp_path / "runs" / "a_reference.members").exists()  # one is to be run again
        (tmp_path / "runs" / "a_reference.members").write_text("a_reference_s2\n")
        assert set(summary_of(study, tmp_path)["measures_digest"]) == {measures_digest()}


@pytest.fixture
def study(tmp_path):
    pytest.importorskip("snakemake")
    (tmp_path / "tiny.py").write_text(TINY)
    path = tmp_path / "study.toml"
    path.write_text(STUDY % 4)
    return path


def run(study, out, *words):
    """A batch of the reference solver to its end; returns the names of histories that stay."""
    done = subprocess.run([*BATCH, study, "--solver", "reference", "-j2", "--out", out, *words],
                          timeout=300, capture_output=True, text=True, env={**os.environ, **BATCH_ENVIRONMENT})
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
    assert len(names) == 9 and len(firsts) == 3
    assert run(study, summary, "--keep", "summary", "--shard", "5") == firsts
    assert tables(summary) == tables(whole) and len(tables(whole)) == 17
    assert len(list((summary / "shards").glob("*.rows"))) == 2
    shocks = pd.read_csv(io.BytesIO(tables(summary)["shocks.csv"]))
    assert set(shocks["run"]) == {"alone_reference"} and len(shocks) == 2

    again = max(names - firsts)
    run(study, summary, "--run", again)
    assert contents(summary / "runs" / f"{again}.h5") == contents(whole / "runs" / f"{again}.h5")
    before = {path: path.stat().st_mtime_ns for path in (summary / "runs").glob("*.h5")}
    (summary / "tables" / "summary.csv").unlink()
    study.write_text(STUDY % 5)  # one more of each, in other shards
    assert run(study, summary, "--keep", "summary", "--shard", "100") == firsts | {again}
    assert before == {path: path.stat().st_mtime_ns for path in before}
    assert len(pd.read_csv(summary / "tables" / "summary.csv")) == 11
    assert (summary / "logs" / "shard_0000.log").read_text().count("history: ") == 2


@pytest.mark.parametrize("name", [".lock", "logs/snakemake.log"])
@pytest.mark.parametrize("kind", ["link", "pipe"])
def test_what_a_batch_writes_at_a_known_name_goes_through_no_link(name, kind, workflow, tmp_path):
    import batch
    from shared import Log

    mine, there, study = tmp_path / "mine", tmp_path / "out" / name, tmp_path / "s.toml"
    mine.write_text("mine")
    study.write_text('name = "s"')
    there.parent.mkdir(parents=True)
    there.symlink_to(mine) if kind == "link" else os.mkfifo(there)
    with pytest.raises(InputError, match=f"{name} is a symbolic link, a pipe or a device"):
        Log(there) if name.endswith(".log") else batch.claim(tmp_path / "out", SimpleNamespace(name="s", path=study))
    assert mine.read_text() == "mine"


def test_what_a_batch_starts_finds_what_the_user_has_in_pythonpath(workflow, monkeypatch):
    """Behind the repository, and from any working folder."""
    import shared

    monkeypatch.setenv("PYTHONPATH", f"mine:{REPOSITORY}::/obspy")
    assert shared.python_path() == f"{REPOSITORY}:{os.getcwd()}/mine:/obspy"


class TestOneRunAgain:
    """`--run NAME` compares inputs before and values after."""

    NAME = "drawn_reference_s2"

    @pytest.fixture
    def again(self, workflow, tmp_path, monkeypatch):
        """Makes the run again, by a history made by hand; returns the exit status."""
        import again
        from stale import find_stale, note

        def simulate(run, number, history, folder):
            make_history(history, drift=simulate.drift)
            return 0

        monkeypatch.setattr(again, "_simulate", simulate)
        (tmp_path / "tiny.py").write_text(TINY)
        (tmp_path / "study.toml").write_text(STUDY.replace("[[grid]]", '[[grid]]\nid = "drawn"').replace(
            "0.5, 0.4", "0.5").replace("%d", "3"))

        def study():
            return load_study(tmp_path / "study.toml", "reference", REPOSITORY)

        note(find_stale(study(), tmp_path), tmp_path)
        simulate.drift = 1e-4
        history = make_history(tmp_path / "other.h5", drift=1e-4)
        write_table(pd.DataFrame([summary_row(history, run=self.NAME, point="drawn"),
                                  summary_row(history, run="other", point="other") | {"seed": 7.5}]),
                    tmp_path / "tables" / "summary.csv")
        return SimpleNamespace(make=lambda: again.make_again(self.NAME, study(), tmp_path), simulate=simulate)

    def test_equal_values_are_reported_and_the_history_stays(self, again, tmp_path, capsys):
        assert again.make() == 0
        assert "the values are those of" in capsys.readouterr().out
        assert (tmp_path / "runs" / f"{self.NAME}.h5").is_file()
        with pytest.raises(InputError, match="is there; expected one that is not"):
            again.make()

    def test_other_values_are_named_and_the_history_gets_another_name(self, again, tmp_path, capsys):
        again.simulate.drift = 2e-4
        assert again.make() == 1
        printed = capsys.readouterr().err.splitlines()[-1]
        assert printed.startswith(f"error: --run {self.NAME}: ") and "columns are not those of" in printed
        assert "max_DI 0.005 -> 0.01" in printed and "differs.h5" in printed
        assert [path.name for path in (tmp_path / "runs").glob("*.h5")] == [f"{self.NAME}.differs.h5"]

    def test_other_inputs_are_refused_before_anything_runs(self, again, tmp_path):
        (tmp_path / "tiny.py").write_text(TINY.replace("0.6", "0.45"))
        with pytest.raises(InputError, match="are not those that the table was made from: wall.height 0.6 -> 0.45"):
            again.make()
        assert not list((tmp_path / "runs").glob("*.h5"))

    def test_rows_of_other_versions_and_runs_without_a_row_are_reported(self, again, tmp_path, capsys):
        path = tmp_path / "tables" / "summary.csv"
        table = pd.read_csv(path)
        table.assign(model_digest="0123456789ab").to_csv(path, index=False)
        assert again.make() == 0
        assert "another version of the model made the table's row (0123456789ab, now " in capsys.readouterr().err
        (tmp_path / "runs" / f"{self.NAME}.h5").unlink()
        path.unlink()
        assert again.make() == 0 and "its values are not compared" in capsys.readouterr().err


def test_a_run_that_is_missing_is_asked_for_though_the_summary_is_there(study, tmp_path, workflow):
    """As after a run that failed: tables of the others are there, and younger than the shard."""
    from batch import note_tables
    from shards import write_shards

    out, loaded = tmp_path / "out", load_study(study, "reference", REPOSITORY)
    (out / "runs").mkdir(parents=True)
    write_shards(loaded, out, "all", 100)
    note_tables(loaded, "reference", out)
    (out / "tables").mkdir()
    for name in ("summary.csv", "points.csv", "study.h5"):
        (out / "tables" / name).touch()
    done = subprocess.run(
        [sys.executable, "-m", "snakemake", "--dry-run", "--cores", "1", "--nolock", "--rerun-triggers", "mtime",
         "--snakefile", REPOSITORY / "workflow" / "Snakefile", "--directory", out, "--config",
         f"study={json.dumps(str(study))}", "solver=reference"], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert all(f"rule {name}:" in done.stdout + done.stderr for name in ("shard", "summary"))


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
    _, printed = process.communicate(timeout=100)
    assert process.returncode == 130
    assert "@@ up to 6 runs step together in a process: an interruption loses those under way\n" in printed
    assert "@@ interrupted: 6 runs were under way and are lost; 0 that had ended are kept\n" in printed


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
        for task in tasks:
            run_shard._TASKS.put(task)
        workers.submit(run_shard.do_runs, 8).result(timeout=100)
    done = [run_shard._ENDED.get() for _ in tasks]
    assert [(status, record["run"]) for _, status, record in done] == [(0, task.name) for task in tasks]
