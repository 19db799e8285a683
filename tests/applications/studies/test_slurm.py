"""A study as jobs of Snakemake, here and on a real SLURM of one node, gives the tables that it
gives without."""

import os
import shutil
import subprocess
import sys
from importlib.util import find_spec

import pytest
from conftest import REPOSITORY, TINY, run_command, wall_file
from test_batch import study_here

PROGRAMS = ("munged", "slurmctld", "slurmd", "sbatch")


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


def jobs(folder, slices, *more):
    """A command that runs tiny.py's study in slices by Snakemake."""
    return [
        sys.executable,
        "-m",
        "snakemake",
        "--snakefile",
        REPOSITORY / "damage" / "applications" / "studies" / "Snakefile",
        "--directory",
        folder / "jobs",
        "--jobs",
        "2",
        *more,
        "--config",
        f"study={folder / 'study.toml'}",
        f"slices={slices}",
        "options=--solver reference",
    ]


def tables(folder):
    return {path.name: path.read_bytes() for path in (folder / "tables").glob("*.csv")}


def whole(folder):
    """The tables of the study without slices."""
    out = folder / "here"
    words = "--solver", "reference", "-j2", "--out", str(out)
    assert study_here(str(folder / "study.toml"), *words).returncode == 0
    return tables(out)


@pytest.mark.slow
def test_slices_by_snakemake_give_the_tables_of_the_whole(tmp_path):
    pytest.importorskip("snakemake")
    wall_file(tmp_path / "tiny.py", TINY)
    (tmp_path / "study.toml").write_text(
        DRAWN.replace("samples = 50", "samples = 2").replace(", 0.3, 0.2]", "]")
    )
    # the Snakefile finds the package itself
    without = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    run_command(*jobs(tmp_path, 2), timeout=300, env=without, status=0)
    assert len(list((tmp_path / "jobs" / "logs").glob("slice-*-of-2.done"))) == 2
    assert tables(tmp_path / "jobs") == whole(tmp_path)


@on_slurm
def test_two_hundred_runs_in_slices_killed_and_gone_on_with(tmp_path):
    wall_file(tmp_path / "tiny.py", TINY)
    (tmp_path / "study.toml").write_text(DRAWN)
    environment = {
        **os.environ,
        "PYTHONPATH": str(REPOSITORY),
        "PYTHON": sys.executable,
        "CPUS": "2",
        "OUT": str(tmp_path / "jobs"),
    }
    submit = "sbatch --parsable --job-name=drawn --cpus-per-task={threads}"
    done = run_command(
        REPOSITORY / "scripts" / "local_slurm.sh",
        "bash",
        "-c",
        KILLED,
        "-",
        *jobs(tmp_path, 4, "--cluster", submit, "--nolock", "--rerun-incomplete"),
        timeout=900,
        env=environment,
    )
    if done.returncode == 3:
        pytest.skip(f"SLURM does not start here: {done.stderr[-200:]}")
    assert done.returncode == 0, done.stdout + done.stderr
    kept = (tmp_path / "jobs" / "before").read_text().splitlines()
    assert 20 <= len(kept) < 200
    subprocess.run(["sha256sum", "--check", "--quiet", tmp_path / "jobs" / "before"], check=True)
    assert tables(tmp_path / "jobs") == whole(tmp_path)
    assert len(list((tmp_path / "jobs" / "logs").glob("slice-*-of-4.done"))) == 4
    assert len(list((tmp_path / "jobs" / "runs").glob("*.h5"))) == 200
