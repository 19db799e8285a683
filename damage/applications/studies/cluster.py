"""A study on a cluster whose nodes share its folder: slices of about an hour, each a job that
Snakemake submits.

Snakemake 7 takes the commands that submit, watch and cancel a job by itself, Snakemake 8 and later
by its plugin cluster-generic.
"""

import os
import re
import shlex
import shutil
import signal
import subprocess
import sys
from functools import partial
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec
from pathlib import Path

import numpy as np

from damage.applications.studies.folder import end_with_parent, environment, handled, open_log
from damage.errors import InputError
from damage.start import EXIT_INTERRUPTED

HERE = Path(__file__).parent
PLUGIN = "snakemake-executor-plugin-cluster-generic"
RUNS_AN_HOUR, YADE = 1500, 200
"""Runs of the reference solver in an hour of a processor, about (walls of 400 bricks, 5 s); for how
many of them a run in YADE counts."""


class NoPlugin(Exception):
    """Snakemake lacks the plugin by which it submits jobs."""


def check():
    """Raise InputError where SLURM is missing, and NoPlugin where Snakemake cannot submit jobs."""
    if shutil.which("sbatch") is None:
        raise InputError("--slurm without sbatch on PATH: run it where SLURM is, or leave it out")
    try:
        release = version("snakemake")
    except PackageNotFoundError:
        raise ModuleNotFoundError("No module named 'snakemake'", name="snakemake") from None
    if needs_plugin(release) and find_spec(PLUGIN.replace("-", "_")) is None:
        raise NoPlugin(
            f"--slurm with Snakemake {release}: expected its plugin; get it with pip install"
            f" {PLUGIN}"
        )


def needs_plugin(release):
    """Whether Snakemake of a version such as "7.32.4" submits jobs by a plugin alone."""
    return int(re.match(r"\d+", release)[0]) >= 8


def slices(runs, n):
    """Lists of the StudyRuns of n slices, of about as many runs each; neighbours, which are alike,
    stay together."""
    weights = np.array([_weight(run) for run in runs], float)
    place = np.minimum((np.cumsum(weights) - weights / 2) * n / weights.sum(), n - 1).astype(int)
    return [[run for run, here in zip(runs, place) if here == k] for k in range(n)]


def number_of_slices(runs, size):
    """How many slices of so many runs of the reference solver a study has."""
    return max(1, round(sum(map(_weight, runs)) / size))


def _weight(run):
    """Number of runs of the reference solver that a StudyRun counts as."""
    return run.most_members * (1 if run.solver == "reference" else YADE)


def run_slices(study, folder, options, n, only, jobs, cores, say):
    """Run slices (numbers from 1) of n as jobs of a cluster; returns Snakemake's exit status,
    EXIT_INTERRUPTED where an interrupt or a polite kill has cancelled them.

    options: words of `python3 -m damage study` for each; jobs: at a time; cores: of each;
    say(line): prints a line.
    """
    done = [f"logs/slice-{k}-of-{n}.done" for k in only]
    for name in done:
        (folder / name).unlink(missing_ok=True)
    config = {
        "study": study.path,
        "slices": n,
        "only": ",".join(map(str, only)),
        "cores": cores,
        "options": shlex.join(options),
    }
    command = [
        sys.executable,
        "-m",
        "snakemake",
        *done,
        *slurm_words(study.name, folder, jobs),
        "--snakefile",
        HERE / "Snakefile",
        "--directory",
        folder,
        "--scheduler",
        "greedy",
        "--nolock",
        "--nocolor",
        "--keep-going",
        "--rerun-incomplete",
        "--config",
        *(f"{key}={value}" for key, value in config.items()),
    ]
    # For Snakemake 7, which imports distutils: a virtual environment would load all of setuptools
    # for it, 0.3 s.
    faster = {"SETUPTOOLS_USE_DISTUTILS": "stdlib"} if sys.version_info < (3, 12) else {}
    say(f"{len(only)} jobs of the cluster, {jobs} at a time; {folder / 'logs' / 'snakemake.log'}")
    with open_log(folder / "logs" / "snakemake.log") as log:
        snakemake = subprocess.Popen(
            list(map(str, command)),
            cwd=folder,
            env={**environment(folder), **faster},
            stdin=subprocess.DEVNULL,
            stdout=log,
            stderr=log,
            process_group=0,
            preexec_fn=partial(_prepare, os.getpid()),
        )
    interrupted = []

    def interrupt(*_):
        interrupted.append(True)
        snakemake.send_signal(signal.SIGINT)

    with handled(interrupt):
        status = snakemake.wait()
    return EXIT_INTERRUPTED if interrupted else status


def _prepare(parent):
    """Snakemake cancels its jobs at SIGINT, even where this program was started without, and when
    this program dies."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    end_with_parent(parent, signal.SIGINT)


def slurm_words(name, folder, jobs, release=None):
    """Options of Snakemake, by default of the release installed, for so many jobs of a study at a
    time."""
    logs = folder / "logs" / "slurm"
    logs.mkdir(parents=True, exist_ok=True)
    submit = ["sbatch", "--parsable", "--ntasks=1", f"--job-name={name}", f"--output={logs}/%j.log"]
    commands = (
        shlex.join(submit) + " --cpus-per-task={threads}",
        str(HERE / "slurm_status.sh"),
        "scancel",
    )
    if needs_plugin(release or version("snakemake")):
        options = (
            "--cluster-generic-submit-cmd",
            "--cluster-generic-status-cmd",
            "--cluster-generic-cancel-cmd",
        )
        executor = ["--executor", "cluster-generic"]
    else:
        options, executor = ("--cluster", "--cluster-status", "--cluster-cancel"), []
    return [
        "--jobs",
        str(jobs),
        "--latency-wait",
        "60",
        "--max-status-checks-per-second",
        "2",
        *executor,
        *(word for pair in zip(options, commands) for word in pair),
    ]
