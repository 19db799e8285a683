"""What a batch would do, without doing it: which runs are there and which are to be made, how long, how much disk.

    plan.py STUDY.toml|STUDIES [-j N] [--out DIR] [--solver yade|reference|both]

`run_all.sh --dry-run` starts this.  Time goes by contact points and steps at the speeds of docs/two-solvers.md, disk by
contact points and samples; where runs of the study are there, both are scaled by what these took.  Nothing is written.
Exit status: 0 told, 2 bad input.
"""

from damage.start import begin, leave

if __name__ == "__main__":
    begin()  # before what takes its time to import

import argparse
import sys
from collections import namedtuple
from datetime import datetime, timedelta
from functools import cache
from pathlib import Path

import h5py
import numpy as np
from room import free_bytes
from shared import ROOT

from damage.errors import InputError
from damage.run.options import parse_run
from damage.run.schedule import choose_time_step, sample_steps
from damage.run.settings import HOLD_S, RAMP_S, SETTLE_S, Softening
from damage.studies.definition import PATH_OPTIONS, load_study
from damage.studies.members import most_members
from damage.studies.tables import runs_there
from damage.wall.file import load_wall
from damage.wall.layout import lay_out
from damage.wall.modes import natural_modes

NS_A_CONTACT_AND_STEP = {"reference": 6.1, "yade": 310.0}
"""Of one core, the symmetric wall: python3 benchmarks/speed.py."""
BYTES_A_CONTACT_AND_SAMPLE = 1.15
"""Of a history, compressed: the symmetric wall at 0.2 s, 0.05 g (YADE) and 0.1 g (reference)."""

Cost = namedtuple("Cost", "seconds n_bytes")


def main():
    """Tell the plan of one study or of a folder of them; returns the exit status."""
    parser = argparse.ArgumentParser(prog="plan.py", description=__doc__.splitlines()[0])
    parser.add_argument("study", type=Path)
    parser.add_argument("-j", dest="jobs", type=int, default=1)
    parser.add_argument("--out", type=Path)
    parser.add_argument("--solver", default="yade")
    asked, _ = parser.parse_known_args()  # the others change nothing of the plan
    out = (asked.out or ROOT / "results").absolute()
    try:
        if not asked.study.is_dir():
            study = load_study(asked.study, asked.solver, ROOT)
            tell(study, out if asked.out else out / study.name, asked.jobs)
            return 0
        for path in sorted(asked.study.glob("*.toml")):
            try:
                study = load_study(path, asked.solver, ROOT)
            except InputError as error:
                print(f"passed over: {error}")
            else:
                tell(study, out / study.name, asked.jobs)
    except InputError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    return 0


def tell(study, folder, jobs):
    """Print the plan of a Study in its folder."""
    costs = {run: estimate(run) for run in study.runs}
    there = {run: runs_there(run, folder) for run in study.runs}
    left = [run for run in study.runs if not there[run]]
    scale, by = scales(costs, there, folder)
    print(f"study {study.name}{': ' if study.title else ''}{study.title}")
    for run in study.runs:
        told = f"there, {len(there[run])} runs" if run.is_ensemble else "there"
        print(f"  {run.id:60s}  {told if there[run] else _planned(run, costs[run], scale)}")
    least, most = (sum(count(run) for run in left) for count in (lambda run: run.members, most_members))
    each = [most_members(run) * costs[run].seconds * scale.seconds for run in left]
    seconds = max(sum(each) / jobs, *each, 0)  # the members of an ensemble come one after the other
    n_bytes = sum(most_members(run) * costs[run].n_bytes for run in left) * scale.n_bytes
    up_to = "up to " if most != least else ""
    print(f"points: {len(study.runs)}, {len(study.runs) - len(left)} there; runs to make: {up_to}{most}\n"
          f"expected: {up_to}about {duration(seconds)} with {jobs} at a time, {n_bytes / 1e6:.3g} MB of histories in "
          f"{folder}, which has {free_bytes(_existing(folder)) / 1e9:.3g} GB free\n"
          f"by {by}; compiling, tables and pictures come to it", flush=True)


def _planned(run, cost, scale):
    """What is to be made of a run or an ensemble, in words."""
    each = f"{duration(cost.seconds * scale.seconds)}, {cost.n_bytes * scale.n_bytes / 1e6:.2g} MB"
    most = most_members(run)
    return each if most == 1 else f"{run.members}{f' to {most}' if most != run.members else ''} runs of {each}"


def estimate(run):
    """Cost of one run of a StudyRun, by the speeds above."""
    words = [str(ROOT / word) if option in PATH_OPTIONS else word for option, word in zip(["", *run.words], run.words)]
    settings = parse_run(words, prog="plan", solver=run.solver)
    softens, n_joints, critical_s, height = _wall(str(ROOT / run.wall), settings.model)
    settings = settings.for_joint(load_wall(ROOT / run.wall).joint, Softening())
    loading, step_s = settings.loading, choose_time_step(settings, critical_s, softens)
    shocks = len(settings.sequence)
    shaken_s = loading.length_s(height) if loading.drives_top else \
        shocks * (loading.duration_s + settings.rest_s + SETTLE_S)
    steps = (RAMP_S + HOLD_S + shaken_s) / step_s
    samples = shaken_s / step_s / sample_steps(step_s)
    return Cost(steps * n_joints * NS_A_CONTACT_AND_STEP[run.solver] * 1e-9,
                samples * n_joints * BYTES_A_CONTACT_AND_SAMPLE)


@cache
def _wall(path, model):
    """(whether its joints soften, contact points, critical time step [s], height of what is pushed [m]) of a wall."""
    layout = lay_out(load_wall(path), model)
    return (layout.wall.joint.softens, layout.n_joints, natural_modes(layout).critical_time_step_s,
            layout.pushed_height)


def scales(costs, there, folder):
    """Factors on the estimates that make them those of the runs that are there, of both solvers alike, and by what all
    is reckoned, in words."""
    measured = [(costs[run], taken) for run, names in there.items() for name in names
                if (taken := took(folder / "runs" / f"{name}.h5")) is not None]
    if not measured:
        return Cost(1.0, 1.0), "the speeds of docs/two-solvers.md, no run being there"
    factors = np.median([[real / guess for guess, real in zip(*pair)] for pair in measured], axis=0)
    return Cost(*factors), f"what those that are there took ({len(measured)})"


def took(path):
    """Cost of a history's run, from its beginning to its last byte; None where it does not tell."""
    try:
        with h5py.File(path, "r") as file:
            began = datetime.fromisoformat(file["run"].attrs["created_utc"]).timestamp()
        status = path.stat()
    except (OSError, KeyError, ValueError):
        return None
    return Cost(max(status.st_mtime - began, 1.0), status.st_size)


def duration(seconds):
    """Seconds as hours, minutes and seconds.

    >>> duration(3725.2)
    '1:02:05'
    """
    return str(timedelta(seconds=round(seconds)))


def _existing(folder):
    """The folder, or the first above it that is there."""
    return next(path for path in (folder, *folder.parents) if path.is_dir())


if __name__ == "__main__":
    leave(main())
