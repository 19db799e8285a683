"""A full disk, no memory, a signal: one line, nothing half written, the same command continues.

One moment a layer: a history, a command's file, what is printed, a study.  A limit on the size of
files replaces a full disk; file systems of a few megabytes need root.
"""

import os
import resource
import shutil
import signal
import subprocess
import sys
from types import SimpleNamespace

import pytest
from conftest import (
    BATCH,
    BATCH_ENVIRONMENT,
    REPOSITORY,
    ROOT,
    SHORT,
    TINY,
    disk,
    refused_with,
    run_command,
    run_here,
    running,
    wait_until,
    wall_file,
    without_progress,
    written,
)

from damage import InputError, read_history
from damage.history.writer import check_output
from damage.reference.session import run_reference
from damage.reference.solver import ReferenceSolver

SMALL = "walls/variants/small.py"
DAMAGE = (sys.executable, "-m", "damage")
SHAKEN = "--harmonic 0.06 0.6 --rest 1 --no-pictures"
BRIEFLY = f"{REPOSITORY}/{SMALL} --harmonic 0.1 0.1 --rest 0"
STUDY = """name = "s"
pictures = "none"
[[runs]]
id = "one"
wall = "tiny.py"
options = { harmonic = [0.1, 0.5], cycles = 2, rest = 0.5 }
[[runs]]
id = "two"
wall = "tiny.py"
options = { harmonic = [0.1, 0.4], cycles = 2, rest = 0 }
members = 2
"""
WITH_LEAST = (
    "import sys; from damage.__main__ import main; from damage.applications.studies import folder\n"
    "folder.LEAST_FREE = 100_000\nsys.exit(main(['study', *sys.argv[1:]]))"
)
"""A batch that continues where a real one would end: another program may fill a disk between two
looks."""


def limited(kind, number):
    """An option of a command that is held to a limit of so many bytes."""
    return {"preexec_fn": lambda: resource.setrlimit(kind, (number, number))}


def one_error(done, printed):
    assert done.returncode not in (0, 120) and done.returncode > 0, done.stderr
    assert (
        done.stderr.startswith("error: ")
        and done.stderr.count("\n") == 1
        and printed in done.stderr
    ), done.stderr


class TestFullDisk:
    @pytest.fixture(scope="class")
    def whole(self, tmp_path_factory):
        return run_here(tmp_path_factory.mktemp("whole") / "run.h5", REPOSITORY / SMALL, SHAKEN)

    def test_a_run_ends_and_keeps_what_was_flushed(self, whole, tmp_path, damage_command):
        out = tmp_path / "run.h5"
        done = damage_command(
            "reference",
            SMALL,
            SHAKEN,
            "--out",
            out,
            **limited(resource.RLIMIT_FSIZE, int(0.9 * whole.path.stat().st_size)),
            status=1,
        )
        assert (
            without_progress(done.stderr).splitlines()[-1].startswith(f"error: cannot write {out}")
        )
        kept = read_history(out)
        n = len(kept.series)
        assert kept.status == "unfinished" and 0 < n and kept.series.equals(whole.series.iloc[:n])

    @pytest.mark.yade
    @pytest.mark.long
    def test_yade_too(self, yade_command, tmp_path):
        out = tmp_path / "run.h5"
        done = yade_command(
            *SHORT,
            SMALL,
            SHAKEN,
            "--out",
            out,
            status=1,
            **limited(resource.RLIMIT_FSIZE, 200_000),
        )
        assert f"error: cannot write {out}" in done.stderr and "Traceback" not in done.stderr
        kept = read_history(out)
        assert kept.status == "unfinished" and len(kept.series) % 120 == 0 < len(kept.series)

    def test_too_little_room_is_reported_before_the_run(self, monkeypatch, tmp_path):
        monkeypatch.setattr("shutil.disk_usage", lambda folder: SimpleNamespace(free=5e5))
        refused_with(r"0\.5 MB free", check_output, tmp_path / "run.h5")

    def test_a_run_whose_pictures_cannot_be_written_is_whole_and_says_so(self, tmp_path, capsys):
        (tmp_path / "run").write_text("no folder")  # where the pictures would go
        assert run_reference(f"{BRIEFLY} --out {tmp_path}/run.h5".split()) == 0
        said = capsys.readouterr().err
        assert "warning: the history is whole, its pictures failed (cannot write" in said
        assert read_history(tmp_path / "run.h5").complete

    @ROOT
    @pytest.mark.long
    def test_a_study_ends_in_a_line_and_goes_on_with_room(self, tmp_path):
        study = written(tmp_path / "s.toml", STUDY)
        wall_file(tmp_path / "tiny.py", TINY)
        with disk(tmp_path / "disk", "size=6000k") as folder:
            words = [sys.executable, "-c", WITH_LEAST, study, "--solver", "reference", "-j2"]
            words += ["--out", folder / "out"]
            batch = started(words)
            wait_until(
                lambda: batch.poll() is not None or list((folder / "out/runs").glob("*.part.h5"))
            )
            fill(folder, 60)  # half a history fits
            out, errors = batch.communicate(timeout=300)
            assert batch.returncode in (1, 2) and "Traceback" not in out + errors
            assert any(
                line.startswith(("error: ", "failed: "))
                and any(said in line for said in ("MB free", "No space left", "no room left"))
                for line in errors.splitlines()
            )
            done = run_command(*BATCH, *words[3:], env=os.environ | BATCH_ENVIRONMENT)
            assert (
                done.returncode == 2 and "MB free: expected 20 MB or more; make room" in done.stderr
            )
            (folder / "filler").unlink()
            subprocess.run(["mount", "-o", "remount,size=64m", folder], check=True)
            run_command(*words, status=0)
            assert (folder / "out/tables/summary.csv").read_text().count("\n") == 4
            assert not list((folder / "out/runs").glob("*.part.h5"))

    @ROOT
    @pytest.mark.slow
    def test_a_study_ends_politely_when_the_room_runs_short(self, tmp_path):
        """So long that the next look at the disk finds it at work."""
        study = written(tmp_path / "s.toml", STUDY.replace("rest = 0.5", "rest = 300"))
        wall_file(tmp_path / "tiny.py", TINY)
        with disk(tmp_path / "disk", "size=40m") as folder:
            batch = started([*BATCH, study, "-j2", "--out", folder / "out"])
            wait_until(
                lambda: batch.poll() is not None or list((folder / "out/runs").glob("*.part.h5"))
            )
            fill(folder, 15_000)
            _, errors = batch.communicate(timeout=300)
            assert batch.returncode == 1 and errors.count("\n") == 1, errors
            assert (
                "MB free: expected 20 MB" in errors
                and "the same command continues from here" in errors
            )
            assert not running(folder)


def fill(folder, leave_kilobytes):
    """Fill a disk but for so much."""
    left = shutil.disk_usage(folder).free - 1000 * leave_kilobytes
    try:
        with open(folder / "filler", "wb", buffering=0) as file:
            while left > 0:
                left -= file.write(b"x" * min(left, 65536))
    except OSError:
        pass  # full by the others' doing


class TestMemory:
    def test_too_little_to_begin_with_is_reported_before_a_library_hangs(
        self, tmp_path, damage_command
    ):
        little = limited(resource.RLIMIT_AS, 150_000_000)
        done = damage_command("reference", SMALL, "--out", tmp_path / "a.h5", timeout=60, **little)
        one_error(done, "out of memory: this process may have 150 MB (ulimit -v): expected")
        assert not (tmp_path / "a.h5").exists()

    def test_a_run_without_memory_is_reported_and_its_history_says_failed(
        self, monkeypatch, tmp_path, capsys
    ):
        def full(solver, *arguments):
            if solver.step > 6000:
                raise MemoryError
            return whole(solver, *arguments)

        whole = ReferenceSolver.advance
        monkeypatch.setattr(ReferenceSolver, "advance", full)
        out = tmp_path / "a.h5"
        assert run_reference(f"{BRIEFLY} --out {out}".split()) == 1
        assert read_history(out).status == "failed"
        assert "error: out of memory (no more to be had)" in capsys.readouterr().err


class TestSignals:
    """Signals of a run; those of studies are in `test_study.py`."""

    def started(self, out, hangup=signal.SIG_DFL):
        """A run that has written samples, and began with this handling of SIGHUP."""
        words = f"reference {SMALL} --harmonic 0.1 0.2 --rest 60 --no-pictures --out {out}"
        process = started([*DAMAGE, *words.split()], hangup)
        wait_until(lambda: n_samples(out) or process.poll() is not None)
        return process

    @pytest.mark.parametrize("name", ["SIGTERM", "SIGKILL"])
    def test_an_end_keeps_what_was_seen(self, name, tmp_path):
        process = self.started(tmp_path / "a.h5")
        for _ in range(2):  # a second one, while it ends, changes nothing
            process.send_signal(getattr(signal, name))
        _, printed = process.communicate(timeout=60)
        # the second may meet the summary
        assert process.returncode in {130, -getattr(signal, name)} and "Traceback" not in printed
        history = read_history(tmp_path / "a.h5")
        assert (
            history.status == ("unfinished" if name == "SIGKILL" else "interrupted")
            and len(history.series) > 0
        )

    def test_under_nohup_a_terminal_that_closes_ends_no_run(self, tmp_path):
        out = tmp_path / "a.h5"
        process = self.started(out, hangup=signal.SIG_IGN)
        process.send_signal(signal.SIGHUP)
        then = n_samples(out)
        wait_until(lambda: n_samples(out) > then or process.poll() is not None)
        assert process.poll() is None
        process.send_signal(signal.SIGTERM)
        assert process.communicate(timeout=60) and process.returncode == 130


def started(words, hangup=signal.SIG_DFL):
    """The process of a command line.  Tests may run under nohup, which leaves SIGHUP ignored to all
    that they start."""
    return subprocess.Popen(
        list(map(str, words)),
        cwd=REPOSITORY,
        text=True,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        env=os.environ | BATCH_ENVIRONMENT,
        preexec_fn=lambda: signal.signal(signal.SIGHUP, hangup),
    )


def n_samples(path):
    try:
        return len(read_history(path).series)
    except InputError:  # not there, or not yet whole
        return 0
