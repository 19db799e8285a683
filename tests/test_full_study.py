"""Studies that a full disk, memory or a signal ends: in a line, and the same command goes on to the same tables.

File systems of a few megabytes stand in for disks; they need root.
"""

import os
import shutil
import subprocess
import sys
import time
from types import SimpleNamespace

import h5py
import pytest
from conftest import BATCH, BATCH_ENVIRONMENT, REPOSITORY, ROOT, TINY, disk, run_command, running, wall_file, written

from damage.batch.folder import forecast
from damage.studies.definition import load_study
from damage.studies.tables import histories_in

STUDY = '''name = "s"
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
'''
WITH_LEAST = ("import sys; from damage.__main__ import main; from damage.batch import folder\n"
              "folder.LEAST_FREE = 100_000\nsys.exit(main(['study', *sys.argv[1:]]))")
"""A batch that goes on where a real one would end: another program may fill a disk between two looks."""


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    folder = tmp_path_factory.mktemp("study")
    wall_file(folder / "tiny.py", TINY)
    return written(folder / "s.toml", STUDY)


@pytest.fixture(scope="module")
def whole(study):
    """Tables of the study where there was room."""
    done = run(*command(study, study.parent / "whole"))
    assert done.returncode == 0, done.stderr
    return content(study.parent / "whole")


def environment():
    return {**os.environ, **BATCH_ENVIRONMENT, "PYTHON": sys.executable, "MASONRY_NO_INSTALL": "1"}


def run(*words):
    """Run a command; returns the completed process with text."""
    return run_command(*words, env=environment(), timeout=300)


def command(study, out, least=None):
    program = [sys.executable, "-c", WITH_LEAST] if least else BATCH
    return [*program, study, "--solver", "reference", "-j2", "--out", out]


def content(folder):
    """{name: content} of the tables of a study, of those in HDF5 dataset by dataset."""
    tables = {path.name: path.read_bytes() for path in (folder / "tables").glob("*.csv")}
    with h5py.File(folder / "tables" / "study.h5") as file:
        return tables | {f"{group}/{name}": column[()].tobytes() if column.dtype != object else list(column[()])
                         for group in file for name, column in file[group].items()}


def remount(folder, options):
    subprocess.run(["mount", "-o", f"remount,{options}", folder], check=True)


def fill(folder, leave_kilobytes):
    """Fill a disk but for so much."""
    left = shutil.disk_usage(folder).free - 1000 * leave_kilobytes
    try:
        with open(folder / "filler", "wb", buffering=0) as file:
            while left > 0:
                left -= file.write(b"x" * min(left, 65536))
    except OSError:
        pass  # full by the others' doing


def run_until_full(words, folder, when, leave_kilobytes):
    """Run a batch, and fill the disk as soon as a file `when` is there."""
    with subprocess.Popen(list(map(str, words)), cwd=REPOSITORY, env=environment(), text=True, stdout=subprocess.PIPE,
                          stderr=subprocess.PIPE) as batch:
        while when and batch.poll() is None and not list((folder / "out").glob(when)):
            time.sleep(0.002)
        if when:
            fill(folder, leave_kilobytes)
        out, errors = batch.communicate(timeout=300)
    return SimpleNamespace(returncode=batch.returncode, stdout=out, stderr=errors)


@ROOT
@pytest.mark.parametrize(("kilobytes", "when", "leave"), [
    pytest.param(6000, "runs/*.part.h5", 60, id="half a history fits"),
    *(pytest.param(*values, id=name, marks=pytest.mark.long) for name, values in {
        "nothing fits": (40, None, 0), "logs fit": (500, None, 0), "a run fits": (1300, None, 0),
        "nothing more at the start": (6000, "records.jsonl", 0),
        "a run without its record fits": (6000, "runs/one_reference.h5", 0),
        "runs and a table fit": (6000, "tables/*_index.csv", 0),
        "all but the last table fits": (6000, "tables/points.csv", 0)}.items())])
def test_a_study_on_a_full_disk_ends_in_a_line_and_goes_on_with_room(kilobytes, when, leave, study, whole, tmp_path):
    with disk(tmp_path / "disk", f"size={kilobytes}k") as folder:
        words = command(study, folder / "out", least=100_000)
        done = run_until_full(words, folder, when, leave)
        assert done.returncode in (1, 2), done.stdout
        lines = done.stderr.splitlines()
        assert "Traceback" not in done.stderr + done.stdout
        assert any(line.startswith(("error: ", "failed: ")) and ("MB free" in line or "No space left" in line
                                                                 or "no room left" in line) for line in lines), lines
        (folder / "filler").unlink(missing_ok=True)
        remount(folder, "size=64m")
        again = run(*words)
        assert again.returncode == 0, again.stderr
        assert content(folder / "out") == whole
        assert not list((folder / "out" / "runs").glob("*.part.h5"))


@ROOT
def test_a_study_does_not_start_with_too_little_room(study, tmp_path):
    with disk(tmp_path / "disk", "size=15m") as folder:
        done = run(*command(study, folder / "out"))
        assert done.returncode == 2 and done.stderr.count("\n") == 1
        assert "MB free: expected 20 MB or more; make room" in done.stderr


@ROOT
@pytest.mark.slow
def test_a_study_ends_politely_when_the_room_runs_short(study, tmp_path):
    long = tmp_path / "long.toml"  # so long that the next look at the disk finds it at work
    long.write_text(STUDY.replace("rest = 0.5", "rest = 300").replace("tiny.py", f"{study.parent}/tiny.py"))
    with disk(tmp_path / "disk", "size=40m") as folder:
        words = command(long, folder / "out")
        done = run_until_full(words, folder, "runs/*.part.h5", 15_000)
        assert done.returncode == 1, done.stderr
        assert done.stderr.count("\n") == 1 and "MB free: expected 20 MB" in done.stderr
        assert "the same command continues from here" in done.stderr
        assert not (folder / "out" / "tables" / "summary.csv").exists() and not running(folder)


@ROOT
def test_a_folder_that_can_only_be_read_is_reported_in_one_line(study, tmp_path):
    with disk(tmp_path / "disk", "size=40m") as folder:
        remount(folder, "ro")
        done = run(*command(study, folder / "out"))
        assert done.returncode == 2 and done.stderr.count("\n") == 1 and "Read-only file system" in done.stderr


def test_a_study_whose_runs_will_not_fit_is_warned_of(study, tmp_path, monkeypatch):
    (tmp_path / "runs").mkdir()
    one, two = load_study(study, "reference", REPOSITORY).runs
    assert forecast([one, two], {}, tmp_path) is None  # nothing is there to judge by
    (tmp_path / "runs" / "one_reference.h5").write_bytes(b"x" * 3_000_000)
    (tmp_path / "runs" / "two_reference_s1.part.h5").write_bytes(b"x" * 9_000_000)
    for free, said in ((26e6, None), (25.9e6, "up to 2 runs are left, about 6 MB if they are as large as the 1 there")):
        monkeypatch.setattr("shutil.disk_usage", lambda folder, free=free: SimpleNamespace(free=free))
        warning = forecast([two], histories_in(tmp_path), tmp_path)
        assert warning is None if said is None else said in warning
        assert forecast([two], histories_in(tmp_path), tmp_path, keep="summary") is None  # the first of two


def test_a_study_with_too_little_memory_is_reported_in_one_line(study, tmp_path):
    words = f"{REPOSITORY}/run_all.sh {study} --solver reference -j2 --out {tmp_path}/out"
    done = run("bash", "-c", f"ulimit -v 300000; {words}")
    assert done.returncode == 1 and done.stderr.count("\n") == 1 and "out of memory: ulimit -v is 307 MB" in done.stderr
