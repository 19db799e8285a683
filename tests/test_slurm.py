"""A study on a real SLURM of one node gives the tables that it gives without; a status for every state of a job."""

import os
import shutil
import subprocess
import sys
from importlib.util import find_spec

import pytest
from conftest import REPOSITORY, TINY, run_command, script_file, wall_file

from damage.batch import cluster

STATUS = REPOSITORY / "damage" / "batch" / "slurm_status.sh"
PROGRAMS = ("munged", "slurmctld", "slurmd", "sbatch")
STUDY = '''name = "s"
pictures = "none"
[[grid]]
wall = "tiny.py"
options = { harmonic = [0.1, "{g}"], cycles = 2, rest = 0.05 }
members = 2
vary = { g = [0.5, 0.01] }
[[runs]]
id = "bad"
wall = "tiny.py"
options = { rest = 0, dt = 0.1 }
'''


@pytest.mark.parametrize(("printed", "status"), [
    ("JobId=7 JobState=PENDING Reason=None", "running"), ("JobId=7 JobState=RUNNING Reason=None", "running"),
    ("JobId=7 JobState=COMPLETED Reason=None", "success"), ("JobId=7 JobState=TIMEOUT Reason=None", "failed"),
    ("JobId=7 JobState=FAILED Reason=NonZeroExitCode", "failed"), ("JobId=7 JobState=CANCELLED Reason=x", "failed"),
    ("slurm_load_jobs error: Invalid job id specified", "failed"),
    ("slurm_load_jobs error: Unable to contact slurm controller", "running"),
])
def test_states_of_jobs(tmp_path, printed, status):
    script_file(tmp_path / "scontrol", f'echo "{printed}"')
    done = run_command(STATUS, "7", env={"PATH": f"{tmp_path}{os.pathsep}/usr/bin{os.pathsep}/bin"})
    assert done.stdout.strip() == status


def test_slurm_is_asked_for_in_one_line_where_it_is_missing(tmp_path):
    done = subprocess.run([REPOSITORY / "run_all.sh", "quick", "--slurm"], capture_output=True, text=True,
                          env={"PATH": "/nowhere:/bin" if not shutil.which("sbatch", path="/bin") else _without_slurm(
                              tmp_path)})
    assert done.returncode == 2 and "--slurm without sbatch" in done.stderr and done.stderr.count("\n") == 1


@pytest.mark.parametrize(("release", "submits", "others"), [
    ("7.32.4", "--cluster", {"--cluster-status", "--cluster-cancel"}),
    ("9.27.1", "--cluster-generic-submit-cmd", {"--cluster-generic-status-cmd", "--cluster-generic-cancel-cmd"}),
])
def test_snakemake_submits_jobs_by_itself_or_by_its_plugin(tmp_path, release, submits, others):
    words = cluster.slurm_words("mine", tmp_path, 3, release)
    assert words[words.index(submits) + 1].startswith("sbatch --parsable") and others <= set(words)
    assert ("cluster-generic" in words) == release.startswith("9")


def test_a_missing_plugin_is_named(monkeypatch):
    monkeypatch.setattr(cluster.shutil, "which", lambda name: "/usr/bin/sbatch")
    monkeypatch.setattr(cluster, "version", lambda name: "9.27.1")
    monkeypatch.setattr(cluster, "find_spec", lambda name: None)
    with pytest.raises(cluster.NoPlugin, match="pip install snakemake-executor-plugin-cluster-generic"):
        cluster.check()
    monkeypatch.setattr(cluster, "version", lambda name: "7.32.4")
    cluster.check()


def _without_slurm(folder):
    """A PATH with what run_all.sh needs before it looks for sbatch."""
    for name in ("bash", "env", "dirname", "readlink", "basename", "nproc", "paste", "cat"):
        (folder / name).symlink_to(shutil.which(name))
    return str(folder)


def on_slurm(test):
    """Marks of a test that needs a SLURM of its own."""
    path = f"{os.environ['PATH']}:/usr/sbin"
    there = find_spec("snakemake") and all(shutil.which(name, path=path) for name in PROGRAMS)
    for mark in (pytest.mark.long, pytest.mark.skipif(not there, reason="SLURM is not installed"),
                 pytest.mark.skipif(os.geteuid() != 0, reason="SLURM's node starts jobs as root only")):
        test = mark(test)
    return test


@on_slurm
def test_a_study_on_slurm(tmp_path):
    wall_file(tmp_path / "tiny.py", TINY)
    (tmp_path / "study.toml").write_text(STUDY)
    batch = [REPOSITORY / "run_all.sh", tmp_path / "study.toml", "--solver", "reference", "-j2", "--out"]
    tables = {}
    for name, words in (("slurm", [REPOSITORY / "scripts" / "local_slurm.sh"]), ("here", [])):
        command = [*words, *batch, tmp_path / name, *(["--slurm"] if words else [])]
        done = run_command(*command, timeout=500, env={**os.environ, "PYTHON": sys.executable, "CPUS": "2"})
        if done.returncode == 3:
            pytest.skip(f"SLURM does not start here: {done.stderr[-200:]}")
        assert done.returncode == 1, done.stderr  # of the run with too large a step, which stops no other
        assert "failed: bad_reference; see" in done.stderr and "2 of 3 points done" in done.stdout
        tables[name] = {path.name: path.read_bytes() for path in (tmp_path / name / "tables").glob("*.csv")}
    assert len(list((tmp_path / "slurm" / "logs" / "slurm").glob("*.log"))) == 1  # of the slice
    assert len(tables["here"]) == 11 and tables["slurm"] == tables["here"]


DRAWN = '''name = "drawn"
pictures = "none"
[[grid]]
wall = "tiny.py"
options = { harmonic = [0.1, "{g}"], cycles = 1, rest = 0, strength-cov = 0.3 }
samples = 50
vary = { g = [0.5, 0.4, 0.3, 0.2] }
'''
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
    batch = [REPOSITORY / "run_all.sh", tmp_path / "study.toml", "--solver", "reference", "-j2", "--out"]
    environment = {**os.environ, "PYTHON": sys.executable, "CPUS": "2", "OUT": str(tmp_path / "slurm")}
    done = run_command(REPOSITORY / "scripts" / "local_slurm.sh", "bash", "-c", KILLED, "-", *batch, tmp_path / "slurm",
                       "--slurm", "--shard", "50", timeout=900, env=environment)
    if done.returncode == 3:
        pytest.skip(f"SLURM does not start here: {done.stderr[-200:]}")
    assert done.returncode == 0, done.stdout + done.stderr
    kept = (tmp_path / "slurm" / "before").read_text().splitlines()
    assert 20 <= len(kept) < 200
    subprocess.run(["sha256sum", "--check", "--quiet", tmp_path / "slurm" / "before"], check=True)
    run_command(*batch, tmp_path / "here", "--keep", "summary", timeout=900, env=environment, status=0)
    tables = [{path.name: path.read_bytes() for path in (tmp_path / name / "tables").glob("*.csv")}
              for name in ("slurm", "here")]
    assert len(tables[0]) == 4 * 4 + 3 and tables[0] == tables[1]
    assert len(list((tmp_path / "slurm" / "logs").glob("slice-*-of-4.done"))) == 4
    assert len(list((tmp_path / "slurm" / "runs").glob("*.h5"))) == 200
    assert len(list((tmp_path / "here" / "runs").glob("*.h5"))) == 4
