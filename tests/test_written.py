"""Every kind of write that fails, and every moment that a run can be ended at: one line, nothing half written.

A limit on the size of files stands in for a full disk; a tmpfs that can only be read needs root.
"""

import os
import resource
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from conftest import REPOSITORY, ROOT, disk, run_command, wall_file, without_progress
from small_history import make_history

import damage
from yade_scripts import COMMAND

SMALL = "walls/variants/small.py"
DAMAGE = (sys.executable, "-m", "damage")
ALL_BUT_20_MB = """
import mmap, os, sys
os.environ["OPENBLAS_NUM_THREADS"] = "1"
import damage.law.modes, damage.wall.file
from damage.__main__ import main
from damage.memory import hold_buffers
hold_buffers()
taken = []
try:
    while True:
        taken.append(mmap.mmap(-1, 1_000_000))
except OSError:
    del taken[-20:]
sys.exit(main(sys.argv[1:]))
"""
LARGE = "Wall('large', 36.0, 9.0)"


@pytest.fixture
def history(tmp_path):
    make_history(tmp_path / "run.h5", opening={2: 2e-4}, slip={5: -3e-4}, drift=1e-4, broken=(2, 5))
    return tmp_path / "run.h5"


def limited(kind, number):
    """An option of a command that is held to a limit of so many bytes."""
    return {"preexec_fn": lambda: resource.setrlimit(kind, (number, number))}


def one_error(done, printed):
    assert done.returncode not in (0, 120) and done.returncode > 0, done.stderr
    assert done.stderr.startswith("error: ") and done.stderr.count("\n") == 1 and printed in done.stderr, done.stderr


@pytest.mark.parametrize("words", [
    "tables run {history} --out {out}/t", "tables summary {history} --out {out}/s.csv", "plot {history} --out {out}",
    "cracks {history} --export {out}/c.csv",
    "modes walls/variants/small.py --out {out}"], ids=lambda words: words.split("{")[0].strip())
def test_a_file_that_cannot_be_written_whole_is_not_there(words, history, tmp_path):
    out = tmp_path / "out"
    words = words.format(history=history, out=out).split()
    one_error(run_command(*DAMAGE, *words, **limited(resource.RLIMIT_FSIZE, 100)), "cannot write")
    assert [path.name for path in out.iterdir()] == []


def test_tables_of_a_study_that_cannot_be_written_are_not_there(tmp_path):
    wall_file(tmp_path / "tiny.py", LARGE)
    (tmp_path / "s.toml").write_text('name = "s"\n[[runs]]\nid = "one"\nwall = "tiny.py"\noptions = { rest = 0 }\n')
    (tmp_path / "runs").mkdir()
    make_history(tmp_path / "runs" / "one_reference.h5")
    done = run_command(*DAMAGE, "study-tables", tmp_path / "s.toml", tmp_path, "--solver", "reference",
                       **limited(resource.RLIMIT_FSIZE, 20_000))
    one_error(done, "study.h5: File too large")  # points.csv is smaller
    assert sorted(path.name for path in (tmp_path / "tables").glob("*.*")) == ["points.csv"]


@pytest.mark.parametrize("unbuffered", ["", "1"], ids=["buffered", "unbuffered"])
def test_what_cannot_be_printed_is_reported(unbuffered, history):
    environment = {**os.environ, "PYTHONUNBUFFERED": unbuffered}
    with open("/dev/full", "w") as full:
        done = subprocess.run([*DAMAGE, "index", history, "--json"], cwd=REPOSITORY, stdout=full, text=True,
                              stderr=subprocess.PIPE, env=environment)
    one_error(done, "what this prints cannot be written (No space left on device)")


def test_a_closed_output_is_reported_and_a_history_never_stands_in_for_it(history):
    words = " ".join(map(str, [*DAMAGE, "index", history]))
    one_error(run_command("bash", "-c", f"{words} >&-"), "standard output is closed")
    assert run_command("bash", "-c", f"{words} 2>&-").returncode == 0


def test_no_room_for_the_progress_of_a_run_does_not_end_it(tmp_path):
    words = [*DAMAGE, "reference", SMALL, "--harmonic", "0.1", "0.1", "--cycles", "1", "--rest", "0", "--no-pictures",
             "--out", tmp_path / "run.h5"]
    with open("/dev/full", "w") as full:
        done = subprocess.run(words, cwd=REPOSITORY, stdout=subprocess.DEVNULL, stderr=full)
    assert done.returncode == 0 and damage.read_history(tmp_path / "run.h5").complete


@pytest.mark.slow
def test_a_run_whose_pictures_cannot_be_written_is_whole_and_says_so(tmp_path):
    (tmp_path / "run").write_text("no folder")  # where the pictures would go
    done = run_command(*DAMAGE, "reference", SMALL, "--harmonic", "0.1", "0.1", "--cycles", "1", "--rest", "0",
                       "--out", tmp_path / "run.h5")
    assert done.returncode == 0 and without_progress(done.stderr).count("\n") == 2  # and one of the elastic lintel
    assert "warning: the history is whole, its pictures failed (cannot write" in done.stderr
    assert damage.read_history(tmp_path / "run.h5").complete


@ROOT
def test_a_folder_that_can_only_be_read(history, tmp_path):
    with disk(tmp_path / "disk", "ro") as folder:
        one_error(run_command(*DAMAGE, "reference", SMALL, "--out", folder / "a.h5"), "Read-only file system")
        one_error(run_command(*DAMAGE, "tables", "run", history, "--out", folder / "a"), "Read-only file system")


class TestMemory:
    @pytest.mark.parametrize("megabytes", [60, 150, 400, 599])
    def test_too_little_to_begin_with_is_reported_before_a_library_hangs(self, megabytes, tmp_path):
        done = run_command(*DAMAGE, "reference", SMALL, "--out", tmp_path / "a.h5", timeout=60,
                           **limited(resource.RLIMIT_AS, megabytes * 1_000_000))
        one_error(done, f"out of memory: this process may have {megabytes} MB (ulimit -v): expected")
        assert not (tmp_path / "a.h5").exists()

    @pytest.fixture
    def modes(self, tmp_path):
        (tmp_path / "command.py").write_text(ALL_BUT_20_MB)
        return lambda wall: run_command(sys.executable, tmp_path / "command.py", "modes", wall, timeout=60,
                                        **limited(resource.RLIMIT_AS, 1_500_000_000))

    def test_what_runs_out_on_the_way_is_reported(self, modes, tmp_path):
        wall_file(tmp_path / "large.py", LARGE)
        done = modes(tmp_path / "large.py")
        assert done.returncode == 1 and "Traceback" not in done.stderr, done.stderr
        assert done.stderr.splitlines()[-1].startswith("error: out of memory")

    def test_no_library_waits_for_memory_for_ever(self, modes):
        """OpenBLAS asks for 128 MB until it gets them, unless it has them from the start."""
        done = modes(SMALL)
        assert done.returncode == 0 and "mode 1:" in done.stdout, done.stderr

    def test_a_run_whose_summary_finds_no_memory_is_kept(self, monkeypatch, tmp_path, capsys):
        from damage.reference.session import run_reference

        def none(*arguments, **named):
            raise MemoryError

        monkeypatch.chdir(REPOSITORY)
        monkeypatch.setattr("damage.run.session.report", none)
        out = tmp_path / "a.h5"
        assert run_reference([SMALL, "--harmonic", "0.1", "0.1", "--rest", "0", "--out", str(out)]) == 0
        assert damage.read_history(out).complete and f"warning: {out} is kept" in capsys.readouterr().err

    def test_a_run_without_memory_is_reported_and_its_history_says_failed(self, monkeypatch, tmp_path, capsys):
        from damage.reference.session import run_reference
        from damage.reference.solver import ReferenceSolver

        def full(solver, *arguments):
            if solver.step > 6000:
                raise MemoryError
            return whole(solver, *arguments)

        whole = ReferenceSolver.advance
        monkeypatch.chdir(REPOSITORY)
        monkeypatch.setattr(ReferenceSolver, "advance", full)
        out = tmp_path / "a.h5"
        assert run_reference([SMALL, "--harmonic", "0.1", "0.1", "--rest", "0", "--out", str(out)]) == 1
        assert damage.read_history(out).status == "failed"
        assert "error: out of memory (no more to be had)" in capsys.readouterr().err


class TestSignals:
    """Of a run; those of studies are in `test_study.py`."""

    SHAKEN = (*DAMAGE, "reference", SMALL, "--harmonic", "0.1", "0.2", "--rest", "60", "--no-pictures", "--out")

    def start(self, out, until, hangup=signal.SIG_DFL):
        """A run, as soon as `until()`, that begins with this handling of SIGHUP; returns its process."""
        process = started((*self.SHAKEN, out), hangup)
        self.wait(process, until)
        return process

    @staticmethod
    def wait(process, until):
        while not until() and process.poll() is None:
            time.sleep(0.01)

    @pytest.mark.skipif(sys.platform != "linux", reason="looks into /proc")
    @pytest.mark.parametrize("library", ["_multiarray_umath", "libhdf5", "pandas"])
    def test_an_interrupt_while_libraries_are_loaded_is_quiet(self, library, tmp_path):
        process = subprocess.Popen(list(map(str, (*self.SHAKEN, tmp_path / "a.h5"))), cwd=REPOSITORY, text=True,
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        while library not in Path(f"/proc/{process.pid}/maps").read_text() and process.poll() is None:
            time.sleep(0.001)
        process.send_signal(signal.SIGINT)
        _, printed = process.communicate(timeout=60)
        assert process.returncode == 130 and printed in ("", "interrupted\n")

    @pytest.mark.parametrize("name", ["SIGINT", "SIGTERM", "SIGHUP"])
    def test_a_polite_end_keeps_what_was_seen(self, name, tmp_path):
        process = self.start(tmp_path / "a.h5", lambda: has_samples(tmp_path / "a.h5"))
        for _ in range(2):  # a second one, while it ends, changes nothing
            process.send_signal(getattr(signal, name))
        _, printed = process.communicate(timeout=60)
        ended = {130} if name == "SIGINT" else {130, -getattr(signal, name)}  # the second may meet the summary
        assert process.returncode in ended and "Traceback" not in printed
        history = damage.read_history(tmp_path / "a.h5")
        assert history.status == "interrupted" and len(history.series) > 0

    def test_under_nohup_a_terminal_that_closes_ends_no_run(self, tmp_path):
        out = tmp_path / "a.h5"
        process = self.start(out, lambda: has_samples(out), hangup=signal.SIG_IGN)
        process.send_signal(signal.SIGHUP)
        then = len(damage.read_history(out).series)
        self.wait(process, lambda: len(damage.read_history(out).series) > then)
        assert process.poll() is None
        process.send_signal(signal.SIGTERM)
        assert process.communicate(timeout=60) and process.returncode == 130

    def test_sigkill_leaves_what_was_flushed(self, tmp_path):
        process = self.start(tmp_path / "a.h5", lambda: has_samples(tmp_path / "a.h5"))
        process.kill()
        process.communicate(timeout=60)
        history = damage.read_history(tmp_path / "a.h5")
        assert history.status == "unfinished" and len(history.series) > 0

    @pytest.mark.slow
    @pytest.mark.yade
    @pytest.mark.parametrize(("name", "status"), [("SIGTERM", "interrupted"), ("SIGHUP", "interrupted"),
                                                  ("SIGKILL", "unfinished")])
    def test_yade_too(self, name, status, tmp_path):
        """SIGINT: `test_yade_run.py`."""
        if shutil.which("yade") is None:
            pytest.skip("YADE is not installed")
        out = tmp_path / "a.h5"
        process = started((*COMMAND, SMALL, "--harmonic", "0.1", "0.2", "--no-pictures", "--out", out))
        while not out.exists() and process.poll() is None:
            time.sleep(0.05)
        time.sleep(1)  # the file is made, its first flush done
        process.send_signal(getattr(signal, name))
        _, printed = process.communicate(timeout=60)
        assert process.returncode == (-signal.SIGKILL if name == "SIGKILL" else 130), printed
        assert "Traceback" not in printed and damage.read_history(out).status == status


def started(words, hangup=signal.SIG_DFL):
    """The process of a command line.  Tests may run under nohup, which leaves SIGHUP ignored to all that they start."""
    return subprocess.Popen(list(map(str, words)), cwd=REPOSITORY, text=True, stdout=subprocess.PIPE,
                            stderr=subprocess.PIPE, preexec_fn=lambda: signal.signal(signal.SIGHUP, hangup))


def has_samples(path):
    try:
        return len(damage.read_history(path).series) > 0
    except damage.InputError:  # not there, or not yet whole
        return False
