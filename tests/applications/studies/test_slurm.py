"""A study on a real SLURM of one node gives the tables that it gives without; a status for every
state of a job."""

import os
import shutil
import subprocess
import sys
from importlib.util import find_spec

import pytest
from conftest import REPOSITORY, TINY, run_command, wall_file

PROGRAMS = ("munged", "slurmctld", "slurmd", "sbatch")


def test_slurm_is_asked_for_in_one_line_where_it_is_missing(tmp_path):
    done = subprocess.run(
        [REPOSITORY / "run_all.sh", "quick", "--slurm"],
        capture_output=True,
        text=True,
        env={
            "PATH": (
                "/nowhere:/bin"
                if not shutil.which("sbatch", path="/bin")
                else _without_slurm(tmp_path)
            )
        },
    )
    assert (
        done.returncode == 2
        and "--slurm without sbatch" in done.stderr
        and done.stderr.count("\n") == 1
    )


def _without_slurm(folder):
    """A PATH with what run_all.sh needs before it looks for sbatch."""
    for name in ("bash", "env", "dirname", "readlink", "basename", "nproc", "paste", "cat"):
        (folder / name).symlink_to(shutil.which(name))
    return str(folder)


def on_slurm(test):
    """Marks of a test that needs a SLURM of its own."""
    path = f"{os.environ['PATH']}:/usr/sbin"
    there = find_spec("snakemake") and all(shutil.which(name, path=path) for name in PROGRAMS)
    for mark in (
        pytest.mark.long,
        pytest.mark.skipif(not there, reason="SLURM is not installed"),
        pytest.mark.skipif(os.geteuid() != 0, reason="SLURM's node starts jobs as root only"),
    ):
        test = mark(test)
    return test


DRAWN = """name = "drawn"
pictures = "none"
[[grid]]
wall = "tiny.py"
options = { harmonic = [0.1, "{g}"], cycles = 1, rest = 0, strength-cov = 0.3 }
samples = 50
vary = { g = [0.5, 0.4, 0.3, 0.2] }
"""
KILLED = """
setsid "$@" & batch=$!
until [ "$(cat "$OUT"/records*.jsonl 2>/dev/null | grep -c '"run"')" -ge 30 ]; do sleep 0.05; done
kill -KILL -- -$batch
scancel --full --signal=KILL --name=drawn
until [ -z "$(squeue -h)" ]; do sleep 0.5; done
sha256sum "$OUT"/runs/*[0-9].h5 >"$OUT"/before
exec "$@"
"""


@on_slurm
def test_two_hundred_runs_in_slices_killed_and_gone_on_with(tmp_path):
    wall_file(tmp_path / "tiny.py", TINY)
    (tmp_path / "study.toml").write_text(DRAWN)
    batch = [
        REPOSITORY / "run_all.sh",
        tmp_path / "study.toml",
        "--solver",
        "reference",
        "-j2",
        "--out",
    ]
    environment = {
        **os.environ,
        "PYTHON": sys.executable,
        "CPUS": "2",
        "OUT": str(tmp_path / "slurm"),
    }
    done = run_command(
        REPOSITORY / "scripts" / "local_slurm.sh",
        "bash",
        "-c",
        KILLED,
        "-",
        *batch,
        tmp_path / "slurm",
        "--slurm",
        "--shard",
        "50",
        timeout=900,
        env=environment,
    )
    if done.returncode == 3:
        pytest.skip(f"SLURM does not start here: {done.stderr[-200:]}")
    assert done.returncode == 0, done.stdout + done.stderr
    kept = (tmp_path / "slurm" / "before").read_text().splitlines()
    assert 20 <= len(kept) < 200
    subprocess.run(["sha256sum", "--check", "--quiet", tmp_path / "slurm" / "before"], check=True)
    run_command(
        *batch, tmp_path / "here", "--keep", "summary", timeout=900, env=environment, status=0
    )
    tables = [
        {path.name: path.read_bytes() for path in (tmp_path / name / "tables").glob("*.csv")}
        for name in ("slurm", "here")
    ]
    assert len(tables[0]) == 4 * 4 + 3 and tables[0] == tables[1]
    assert len(list((tmp_path / "slurm" / "logs").glob("slice-*-of-4.done"))) == 4
    assert len(list((tmp_path / "slurm" / "runs").glob("*.h5"))) == 200
    assert len(list((tmp_path / "here" / "runs").glob("*.h5"))) == 4
