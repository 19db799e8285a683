"""Studies on their way: what they leave, interrupted, killed, without a process, with a deleted
lock, twice at once."""

import errno
import fcntl
import hashlib
import io
import os
import signal
import subprocess
import time
from contextlib import redirect_stderr, redirect_stdout
from types import SimpleNamespace

import pandas as pd
import pytest
from conftest import (
    BATCH,
    BATCH_ENVIRONMENT,
    REPOSITORY,
    TINY,
    refused_with,
    wait_until,
    wall_file,
    written,
)
from small_history import make_history

from benchmarks.resume import kill_tree
from damage.__main__ import main
from damage.applications.studies import batch, folder, yade_process
from damage.applications.studies.definition import StudyRun
from damage.applications.studies.inputs import as_json, inputs_of
from damage.applications.studies.outdated import Results
from damage.applications.studies.pool import Pool
from damage.applications.studies.records import NAME, read_records
from damage.applications.studies.tasks import CHANGED, Task
from damage.errors import InputError
from damage.history.reader import read_history

POINTS = (
    '[[grid]]\nwall = "tiny.py"\noptions = { harmonic = [0.1, "{g}"], cycles = 2, rest = "{rest}"'
    " }\nmembers = 3\nvary = { g = [%s], rest = [0.5] }\n"
)
DRAWN = """[[runs]]
id = "drawn"
wall = "tiny.py"
options = { harmonic = [0.1, 0.5], cycles = 1, rest = 0, strength-cov = 0.3 }
samples = %d
[[runs]]
id = "alone"
wall = "tiny.py"
options = { harmonic = [0.1, 0.3], cycles = 1, rest = 0, sequence = "1,0.5" }
"""


def study_here(*words):
    """What a batch says and how it ends, in this process."""
    printed = io.StringIO()
    errors = io.StringIO()
    with redirect_stdout(printed), redirect_stderr(errors):
        status = main(["study", *words])
    return SimpleNamespace(returncode=status, stdout=printed.getvalue(), stderr=errors.getvalue())


class Batches:
    """Batches of the reference solver in a folder, with the tiny wall."""

    def __init__(self, folder):
        wall_file(folder / "tiny.py", TINY)
        self.folder = folder
        self.out = folder / "out"

    def study(self, text, name="s"):
        return written(self.folder / f"{name}.toml", f'name = "{name}"\npictures = "none"\n{text}')

    def start(self, study, *words, out=None):
        return subprocess.Popen(
            [*BATCH, str(study), "-j2", "--out", str(out or self.out), *words],
            cwd=REPOSITORY,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            env={**os.environ, **BATCH_ENVIRONMENT},
        )

    def run(self, study, *words, out=None):
        """As `start`, in this process."""
        return study_here(str(study), "-j2", "--out", str(out or self.out), *words)

    def members(self):
        return sorted(path for path in (self.out / "runs").glob("*_s?.h5"))

    def checksums(self):
        return {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in self.members()}

    def tables(self, out=None):
        return {
            path.name: path.read_bytes() for path in ((out or self.out) / "tables").glob("*.csv")
        }


@pytest.fixture
def batches(tmp_path):
    return Batches(tmp_path)


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """A batch that was left alone."""
    one = Batches(tmp_path_factory.mktemp("whole"))
    one.done = one.run(one.study(POINTS % "0.5, 0.4, 0.01"))
    return one


@pytest.fixture(scope="module")
def drawn(tmp_path_factory):
    """A batch of drawn strengths and of a sequence, all of whose histories are kept."""
    one = Batches(tmp_path_factory.mktemp("drawn"))
    assert one.run(one.study(DRAWN % 4)).returncode == 0
    return one


@pytest.mark.slow
class TestBatch:
    def test_members_differ_by_seed_and_an_intact_wall_has_but_one(self, whole):
        assert whole.done.returncode == 0, whole.done.stderr
        assert "study s: 3 of 3 points done" in whole.done.stdout
        histories = [read_history(path) for path in whole.members()]
        assert [path.stem for path in whole.members()] == [
            f"tiny_harmonic-0.1-{g}_cycles-2_rest-0.5_reference_s{k}"
            for g, k in ((0.01, 1), (0.4, 1), (0.4, 2), (0.4, 3), (0.5, 1), (0.5, 2), (0.5, 3))
        ]
        assert [history.parameters["seed"] for history in histories] == [1, 1, 2, 3, 1, 2, 3]
        assert {history.parameters["scatter"] for history in histories} == {0.001}

    def test_tables_have_a_row_a_run(self, whole):
        tables = whole.out / "tables"
        summary = pd.read_csv(tables / "summary.csv")
        assert list(summary["members"]) == [3] * 6 + [1] and list(summary["pga_g"]) == [0.5] * 3 + [
            0.4
        ] * 3 + [0.01]
        assert len(list(tables.glob("*_index.csv"))) == 3
        cycles = pd.read_csv(tables / "cycles.csv")  # the verdict takes medians of them
        assert list(cycles["run"].unique()) == list(summary["run"])
        alone = pd.read_csv(tables / f"{summary['run'][0]}_cycles.csv")
        pd.testing.assert_frame_equal(
            cycles[cycles["run"] == summary["run"][0]].drop(columns="run"), alone
        )

    def test_killed_while_a_history_grows_it_goes_on_and_ends_in_the_same_tables(
        self, batches, whole
    ):
        study = batches.study(POINTS % "0.5, 0.4, 0.01")
        batch = batches.start(study)
        old = growing = set()
        # one just begun still grows when it is killed
        while len(batches.members()) < 3 or not growing - old:
            assert batch.poll() is None, "it ended before it could be killed"
            time.sleep(0.005)
            old = growing
            growing = set((batches.out / "runs").glob("*.part.h5"))
        kill_tree(batch.pid)
        batch.communicate()
        before = batches.checksums()
        times = {path: path.stat().st_mtime_ns for path in batches.members()}
        assert 3 <= len(before) < 7
        assert list((batches.out / "runs").glob("*.part.h5")), "no history was being written"
        done = batches.run(study)
        assert done.returncode == 0, done.stderr
        after = batches.checksums()
        assert len(after) == 7 and before == {name: after[name] for name in before}
        assert all(path.stat().st_mtime_ns == time_ns for path, time_ns in times.items())
        assert len(whole.tables()) == 18 and batches.tables() == whole.tables()

    @pytest.mark.long
    def test_runs_that_step_together_continue_where_they_were_interrupted(self, batches):
        long = (DRAWN % 3).replace("cycles = 1", "cycles = 12")
        study = batches.study(long)
        log = batches.out / "logs" / "reference.log"
        batch = batches.start(study, "--keep", "patterns")
        wait_until(lambda: log.is_file() and log.read_text().count("history:") >= 4)
        batch.send_signal(signal.SIGTERM)
        batch.communicate(timeout=60)
        runs = batches.out / "runs"
        stood = sorted(runs.glob("*.checkpoint"))
        assert batch.returncode == 130 and stood, "it ended before it could be interrupted"
        stood[0].write_bytes(b"of another version")
        done = batches.run(study, "--keep", "patterns")
        assert done.returncode == 0, done.stderr
        assert "no whole checkpoint" in log.read_text() and not list(runs.glob("*.checkpoint"))
        whole = batches.folder / "whole"
        assert batches.run(study, "--keep", "patterns", out=whole).returncode == 0
        assert batches.tables() == batches.tables(whole)
        for path in (whole / "patterns").iterdir():
            assert path.read_bytes() == (batches.out / "patterns" / path.name).read_bytes()

    def test_with_histories_of_a_sample_alone_the_tables_are_the_same(self, batches, drawn):
        study = batches.study(DRAWN % 4)
        summary = batches.folder / "summary"
        assert batches.run(study, "--keep", "summary", out=summary).returncode == 0
        firsts = {"drawn_reference_s1", "alone_reference"}
        assert {path.stem for path in (summary / "runs").glob("*.h5")} == firsts
        of_study = {"summary.csv", "points.csv", "cycles.csv", "shocks.csv"}
        assert batches.tables(summary) == {name: drawn.tables()[name] for name in of_study}
        assert len(drawn.tables()) == 15  # those of first runs, too
        shocks = pd.read_csv(io.BytesIO(drawn.tables()["shocks.csv"]))
        assert set(shocks["run"]) == {"alone_reference"} and len(shocks) == 2

    def test_slices_by_themselves_then_the_whole(self, batches, drawn):
        """As an array of jobs of a cluster, then a call that makes the tables."""
        study = batches.study(DRAWN % 4)
        for k in (1, 2):
            done = batches.run(study, "--slice", f"{k}/2")
            assert done.returncode == 0, done.stderr
            assert "1 of 1 points done" in done.stdout and "tables:" not in done.stdout
        assert sorted(path.name for path in batches.out.glob("records*")) == [
            "records-1-of-2.jsonl",
            "records-2-of-2.jsonl",
        ]
        histories = batches.checksums()
        done = batches.run(study)
        assert done.returncode == 0 and "started" not in done.stdout, done.stderr
        assert [path.name for path in batches.out.glob("records*")] == [NAME]
        assert batches.checksums() == histories and batches.tables() == drawn.tables()

    def test_what_a_run_takes_besides_its_steps_is_left_by_the_share_of_its_steps(
        self, monkeypatch
    ):
        """Short runs of two draws: 5.2 times as long was said as they took."""
        monkeypatch.setattr(batch, "cost_of", lambda run: batch.RUN)
        run = SimpleNamespace(solver="reference", runs_needed=lambda _: 2, runs_at_most=lambda _: 2)
        point = SimpleNamespace(run=run, records={}, pictures=0, is_drawn=False)
        pace = SimpleNamespace(note=lambda done: None, left_s=lambda least, most: (least, most))
        work = SimpleNamespace(points={"p": point}, _paces={"reference": pace})
        shares = SimpleNamespace(items=lambda: 2 * [(SimpleNamespace(point=run), 0.75)])
        left = batch.RUN + batch.TABLES
        assert batch.Batch._left_s(work, "reference", shares) == (left, left)


class TestPool:
    """Processes that do what a test says in place of runs."""

    @pytest.fixture
    def pool(self, tmp_path, monkeypatch):
        def make(work, jobs=2):
            (tmp_path / "logs").mkdir(exist_ok=True)
            monkeypatch.setattr("damage.applications.studies.pool.load_compiled", lambda *_: None)
            monkeypatch.setattr(
                "damage.applications.studies.pool.company_of", lambda point: point.options
            )
            monkeypatch.setattr(
                "damage.applications.studies.pool.batch_of", lambda point: point.point[0] == "s"
            )
            lines = []
            monkeypatch.setattr("damage.applications.studies.pool.say", lines.append)
            return Pool(jobs, work, -1, tmp_path), lines

        return make

    @staticmethod
    def tasks(folder, n=5, solver="reference"):
        return [
            Task(folder, StudyRun(f"p{k}", "w.py", (("seed", k % 2),), solver), 1, True)
            for k in range(n)
        ]

    def test_every_task_is_done_once_those_that_are_alike_one_after_the_other(self, pool, tmp_path):
        def work(connection, *_):
            while (task := connection.recv()) is not None:
                connection.send((task, 0, {"run": task.name}))

        one, _ = pool(work, jobs=1)
        done = []
        more = self.tasks(tmp_path, 7)[5:]

        def follow(task, record):
            done.append(record["run"])
            return [more.pop(0)] if more else []

        one.run(self.tasks(tmp_path), follow)
        assert sorted(done) == [f"p{k}_reference" for k in range(7)] and one.failed == []
        assert [
            name for name in done if name in ("p0_reference", "p2_reference", "p4_reference")
        ] == done[:3]

    def test_a_process_has_one_batch_at_a_time_and_batches_keep_their_order(self, pool, tmp_path):
        def work(connection, *_):
            """Ends tasks when no more come."""
            taken = []
            while True:
                while taken and not connection.poll(0.2):
                    connection.send((taken.pop(), 0, {}))
                taken.append(connection.recv())
                if taken[-1] is None:
                    return
                assert len({task.point.point[0] for task in taken}) == 1

        one, _ = pool(work, jobs=1)
        done = []
        asked = ("b0", "b1", "s2", "s3", "b4")
        tasks = [Task(tmp_path, StudyRun(k, "w.py", (), "reference"), 1, True) for k in asked]
        one.run(tasks, lambda task, _: done.append(task.point.point) or ())
        assert [name[0] for name in done] == ["b", "b", "s", "s", "b"] and one.failed == []

    def test_a_task_whose_process_is_lost_twice_has_failed_and_the_others_are_done(
        self, pool, tmp_path
    ):
        """The third ends whatever process it is in, together with what is in it."""

        def work(connection, *_):
            taken = []
            while True:
                taken.append(connection.recv())
                if taken[-1] is None:
                    return
                if taken[-1].point.point == "p2":
                    os.kill(os.getpid(), signal.SIGKILL)
                if not connection.poll(0.05):
                    for task in taken:
                        connection.send((task, 0, {}))
                    taken = []

        one, lines = pool(work)
        done = []
        one.run(self.tasks(tmp_path), lambda task, record: done.append(task.name) or ())
        assert sorted(done) == [f"p{k}_reference" for k in (0, 1, 3, 4)]
        assert [task.name for task in one.failed] == [
            "p2_reference"
        ] and "p2_reference: FAILED" in lines
        assert "its process was ended twice (SIGKILL)" in one.failed[0].log.read_text()


class TestFolder:
    def study(self, tmp_path):
        return SimpleNamespace(name="s", path=written(tmp_path / "s.toml", 'name = "s"'))

    def test_a_folder_takes_no_second_batch_whatever_is_deleted_in_it(self, tmp_path, monkeypatch):
        monkeypatch.setattr(folder, "LOCK_PATIENCE_S", 0.0)
        study = self.study(tmp_path)
        out = tmp_path / "out"
        lock = folder.claim(out, study)
        for path in out.rglob("*"):
            path.unlink() if path.is_file() else None
        for shared in (False, True):
            refused_with("another batch is at work", folder.claim, out, study, shared)
        folder.lock_as(lock, out, shared=True)
        os.close(folder.claim(out, study, shared=True))  # slices share it
        refused_with("another batch is at work", folder.claim, out, study)
        os.close(lock)
        os.close(folder.claim(out, study))

    def test_where_folders_cannot_be_locked_a_file_is(self, tmp_path, monkeypatch):
        """As on NFS, which wants a descriptor to write to."""
        flock = fcntl.flock

        def of_files(descriptor, how):
            if os.path.isdir(
                f"/proc/self/fd/{getattr(descriptor, 'fileno', lambda: descriptor)()}"
            ):
                raise OSError(errno.EBADF, "Bad file descriptor")
            return flock(descriptor, how)

        monkeypatch.setattr(fcntl, "flock", of_files)
        monkeypatch.setattr(folder, "LOCK_PATIENCE_S", 0.0)
        lock = folder.claim(tmp_path / "out", self.study(tmp_path))
        results = Results(tmp_path / "out")
        results.write(results.judge([]))  # which deletes what earlier versions kept
        refused_with(
            "another batch is at work", folder.claim, tmp_path / "out", self.study(tmp_path)
        )
        os.close(lock)
        os.close(folder.claim(tmp_path / "out", self.study(tmp_path), shared=True))

    @pytest.mark.parametrize("name", [NAME, "logs/reference.log"])
    @pytest.mark.parametrize("kind", ["link", "pipe"])
    def test_what_a_batch_writes_at_a_known_name_goes_through_no_link(self, name, kind, tmp_path):
        mine = tmp_path / "mine"
        there = tmp_path / "out" / name
        mine.write_text("mine")
        there.parent.mkdir(parents=True)
        there.symlink_to(mine) if kind == "link" else os.mkfifo(there)
        with pytest.raises(InputError, match=f"{name} is a symbolic link, a pipe or a device"):
            folder.open_log(there) if name.endswith(".log") else folder.open_records(there)
        assert mine.read_text() == "mine"


class TestInputsThatChange:
    """Files that are edited while a study runs; which ones, `test_outdated`."""

    @staticmethod
    def edited(monkeypatch, edit):
        """Let a study's files be edited once it has read them, before its processes do."""

        class Late(Pool):
            def run(self, *arguments):
                edit()
                super().run(*arguments)

        monkeypatch.setattr(batch, "Pool", Late)

    @pytest.mark.slow
    def test_a_run_of_other_inputs_is_not_made_and_said_in_a_line(
        self, batches, monkeypatch, capfd
    ):
        study = batches.study(DRAWN % 3)
        wall = batches.folder / "tiny.py"
        words = ["study", str(study), "-j1", "--keep", "summary", "--out", str(batches.out)]
        with monkeypatch.context() as patch:
            self.edited(patch, lambda: wall_file(wall, TINY.replace("0.6", "0.45")))
            assert main(words) == 1
        said = [line for line in capfd.readouterr().err.splitlines() if "changed" in line]
        assert said == [
            "error: 4 runs were not made, as inputs changed since the study began: drawn_reference"
            " (wall.height 0.6 -> 0.45), alone_reference (wall.height 0.6 -> 0.45); restore these"
            " and give the same command, or give it with the new ones: it makes all runs of these"
            " points again"
        ]
        assert not read_records(batches.out).runs and not list((batches.out / "runs").iterdir())
        wall_file(wall, TINY)
        assert main(words) == 0 and len(read_records(batches.out).runs) == 4

    def test_yade_reads_by_itself_and_is_compared_by_the_wall_of_its_history(
        self, tmp_path, monkeypatch
    ):
        wall_file(tmp_path / "tiny.py", TINY)
        run = StudyRun("p", str(tmp_path / "tiny.py"), (("harmonic", (0.1, 0.5)),), "yade")
        task = Task(tmp_path, run, 1, True)
        sent = []
        note = {run.id: as_json(inputs_of(run, REPOSITORY))}
        task.part.parent.mkdir()
        monkeypatch.setattr(
            yade_process,
            "_run_solver",
            lambda *_: sent.append("ran") or (make_history(task.part) and 0),
        )
        status, words = yade_process.run_yade(task, SimpleNamespace(send=lambda _: None), -1, note)
        assert (
            sent == ["ran"]
            and status == CHANGED
            and any(word.startswith("wall.") for word in words)
        )
        assert not task.part.exists() and not task.history.exists()
        wall_file(tmp_path / "tiny.py", TINY.replace("0.6", "0.45"))
        assert yade_process.run_yade(task, None, -1, note) == (
            CHANGED,
            ["wall.height 0.6 -> 0.45"],
        ) and sent == ["ran"]


@pytest.mark.slow
def test_all_studies_one_after_the_other_then_figures_and_verdict(batches, monkeypatch, capfd):
    points = {
        "good": POINTS % "0.01" + 'solvers = ["reference"]\n',
        "other": POINTS % "0.01" + 'solvers = ["yade"]\n',
        "bad": (
            '[[runs]]\nwall = "tiny.py"\noptions = { harmonic = [0.1, 0.5], dt = 0.1, rest = 0 }\n'
        ),
    }
    paths = {name: batches.study(text, name) for name, text in points.items()}
    from paper import __main__

    monkeypatch.setattr(__main__, "shipped_files", lambda *_: paths)

    assert __main__.main(["studies", "--out", str(batches.out), "-j2"]) == 1
    printed, errors = capfd.readouterr()
    assert "study bad: FAILED, status 1" in errors and "study good" not in errors
    assert "passed over" in printed and "expected --solver yade" in printed
    assert (batches.out / "good/tables/points.csv").is_file() and not (
        batches.out / "other"
    ).exists()
    assert (batches.out / "figures/fig06_motions.png").is_file()
    assert "P1" in printed
