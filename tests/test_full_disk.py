"""A disk that takes no more: the run ends at once with one line, what was flushed is readable and says unfinished.

A limit on the size of files stands in for the disk: every write beyond it fails as on a full one.
"""

import resource
import sys
from types import SimpleNamespace

import pytest
from conftest import ROOT, SHORT, disk, refused_with, run_command, without_progress

import damage
from damage.history.writer import check_output

SMALL = "walls/variants/small.py"
SHAKEN = ["--harmonic", "0.06", "0.6", "--rest", "1", "--no-pictures"]


def run_limited(kilobytes, *words):
    return run_command(*words, preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (kilobytes * 1000,) * 2))


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    out = tmp_path_factory.mktemp("whole") / "run.h5"
    run_command(sys.executable, "-m", "damage", "reference", SMALL, *SHAKEN, "--out", out)
    return damage.read_history(out)


@pytest.mark.parametrize("share", [0.4, 0.9, 0.98, *(pytest.param(share, marks=pytest.mark.long)
                                                    for share in (0.6, 0.7, 0.8))])
def test_reference_solver_ends_and_keeps_what_was_flushed(share, whole, tmp_path):
    """Sizes from the second flush to the last one, which comes when all steps are done."""
    out = tmp_path / "run.h5"
    size = whole.path.stat().st_size
    done = run_limited(int(share * size / 1000), sys.executable, "-m", "damage", "reference", SMALL, *SHAKEN,
                       "--out", out)
    assert done.returncode == 1, done.stdout + done.stderr
    printed = without_progress(done.stderr)
    assert printed.startswith(f"error: cannot write {out}") and printed.count("\n") == 1
    history = damage.read_history(out)
    assert history.status == "unfinished" and not history.complete
    n = len(history.series)
    assert 0 < n <= len(whole.series)  # the last part of a file is the state of the solver
    assert history.series.equals(whole.series.iloc[:n])
    assert (history.opening_m == whole.opening_m[:n]).all() and (history.slip_m == whole.slip_m[:n]).all()


def test_a_file_that_cannot_even_begin_is_no_history(tmp_path):
    done = run_limited(20, sys.executable, "-m", "damage", "reference", SMALL, *SHAKEN, "--out", tmp_path / "run.h5")
    assert done.returncode == 1
    assert done.stderr.splitlines()[-1].startswith("error: cannot write")
    refused_with("cannot be read as a history", damage.read_history, tmp_path / "run.h5")


@pytest.mark.yade
@pytest.mark.parametrize("kilobytes", [200, *(pytest.param(size, marks=pytest.mark.long)
                                               for size in (220, 240, 320, 400))])
def test_yade_ends_and_keeps_what_was_flushed(kilobytes, yade_command, tmp_path):
    out = tmp_path / "run.h5"
    done = yade_command("-j1", *SHORT, SMALL, *SHAKEN, "--out", out,
                        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (kilobytes * 1000,) * 2), status=1)
    assert f"error: cannot write {out}" in done.stderr and "Traceback" not in done.stderr
    history = damage.read_history(out)
    assert history.status == "unfinished" and len(history.series) % 120 == 0 < len(history.series)


def test_too_little_room_is_reported_before_the_run(monkeypatch, tmp_path):
    monkeypatch.setattr("shutil.disk_usage", lambda folder: SimpleNamespace(free=5e5))
    refused_with(r"0\.5 MB free", check_output, tmp_path / "run.h5")


@ROOT
def test_a_file_system_that_is_full(tmp_path):
    with disk(tmp_path / "disk", "size=1100k") as folder:
        done = run_command(sys.executable, "-m", "damage", "reference", SMALL, *SHAKEN, "--rest", "9", "--out",
                           folder / "run.h5")
        history = damage.read_history(folder / "run.h5")
    assert done.returncode == 1 and "No space left on device" in done.stderr, done.stderr
    assert without_progress(done.stderr).count("\n") == 1
    assert history.status == "unfinished" and len(history.series) > 120
