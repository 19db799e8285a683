"""Snakemake's options for jobs on a SLURM cluster, whose folder and repository all nodes share.

Snakemake 7 takes the commands that submit, watch and cancel a job by itself, Snakemake 8 and later by its plugin
cluster-generic.
"""

import re
import shlex
import shutil
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path

from damage.errors import InputError

STATUS = Path(__file__).with_name("slurm_status.sh")
PLUGIN = "snakemake-executor-plugin-cluster-generic"


class NoPlugin(Exception):
    """Snakemake lacks the plugin by which it submits jobs."""


def check():
    """Raise InputError where SLURM is missing, and NoPlugin where Snakemake cannot submit jobs."""
    if shutil.which("sbatch") is None:
        raise InputError("--slurm without sbatch on PATH: run it where SLURM is, or leave it out")
    release = version("snakemake")
    if needs_plugin(release) and find_spec(PLUGIN.replace("-", "_")) is None:
        raise NoPlugin(f"--slurm with Snakemake {release}: expected its plugin; get it with pip install {PLUGIN}")


def needs_plugin(release):
    """Whether Snakemake of a version such as "7.32.4" submits jobs by a plugin alone."""
    return int(re.match(r"\d+", release)[0]) >= 8


def words(name, folder, jobs, release=None):
    """Options of Snakemake, by default of the release installed, for so many jobs of a study at a time."""
    logs = folder / "logs" / "slurm"
    logs.mkdir(parents=True, exist_ok=True)
    submit = ["sbatch", "--parsable", "--ntasks=1", f"--job-name={name}", f"--output={logs}/%j.log"]
    commands = shlex.join(submit) + " --cpus-per-task={threads}", str(STATUS), "scancel"
    if needs_plugin(release or version("snakemake")):
        options = ("--cluster-generic-submit-cmd", "--cluster-generic-status-cmd", "--cluster-generic-cancel-cmd")
        executor = ["--executor", "cluster-generic"]
    else:
        options, executor = ("--cluster", "--cluster-status", "--cluster-cancel"), []
    return ["--jobs", str(jobs), "--latency-wait", "60", "--max-status-checks-per-second", "2", *executor,
            *(word for pair in zip(options, commands) for word in pair)]
