"""Dry run of a study: runs that are there, runs to make, their time and disk space.

Time follows from contact points and steps at the speed of this machine, which is measured once (`speed`), and from what
each run, picture and batch takes besides; disk from contact points and samples.  Where runs of the study are there, the
times of those that ran alone, and the bytes of all, scale both.  Nothing is written in the study's folder.
"""

import shutil
from collections import Counter, namedtuple
from contextlib import chdir
from dataclasses import replace
from datetime import datetime, timedelta
from functools import cache

import h5py
import numpy as np

from damage.batch.folder import ROOT
from damage.batch.outdated import Results
from damage.batch.speed import Speed, python_seconds, speed
from damage.batch.tasks import company_of
from damage.law.modes import natural_modes
from damage.mechanics.compiled import is_cached
from damage.reference.ensembles import LEAST_LANES
from damage.run.schedule import sample_steps
from damage.run.scheme import schemes
from damage.run.settings import HOLD_S, RAMP_S, SELECTIVE, Softening
from damage.wall.file import load_wall
from damage.wall.layout import lay_out

YADE_NS = 800.0
"""Of one processor, a contact point and step of a whole run in YADE: on three machines the record of `quick` took 580
to 1300.  It does not follow the reference solver's speed, which vector instructions decide."""
MEASURED_AT = Speed(2.6, 1.25)
"""Of the machine that the following seconds were measured on (AMD EPYC, family 26, one of two cores)."""
RUN = {"alone": (0.75, 1.5), "together": (0.25, 2.0), "yade": (5.0, 1.0)}
"""Of a run: seconds besides its steps (layout, periods, history, tables), and its steps' time over that of a wall at
rest."""
DEFORMABLE, SCALED = 16.0, 2.0
"""Time of a step and contact point with deformable bricks over that with rigid ones, in a run that is alone; and of one
with mass scaling, samples included, over that of an explicit one."""
PICTURES_S, BATCH_S, COMPILING_S, PYTHON_S = 4.5, 4.5, 25.0, 0.0114
"""Seconds of the pictures of a run; of starting a batch and of the study's tables; of compiling; and of
`speed.python_seconds`."""
LEAST, MOST, UNMEASURED = 0.6, 2.0, 1.5
"""Of the time that is expected: from and to, and by how much less and more where the machine was not measured."""
BYTES_A_CONTACT_AND_SAMPLE = 1.15
"""Of a history, compressed: the symmetric wall at 0.2 s, 0.05 g (YADE) and 0.1 g (reference)."""

Cost = namedtuple("Cost", "seconds n_bytes")


class Plan:
    """What is left of a Study in its folder, with its time and size.

    there: {StudyRun: names of its runs that are there}; left: StudyRuns; costs: {StudyRun: Cost of one run}; scale:
    Cost of factors on these; runs: fewest and most to make; seconds: (least, most) that is expected; once_s: of
    compiling; by: what the time is from, in words.
    """

    def __init__(self, study, folder, jobs, remake=False):
        """remake: runs of another version are made again."""
        ways = ways_of(study.runs, jobs)
        machine, how = machine_speed()
        self.costs = {run: estimate(run, ways[run], machine) for run in study.runs}
        self.there = _there(study, folder, remake)
        self.left = [run for run in study.runs if not self.there[run]]
        self.scale, by = scales(self.costs, self.there, ways, folder)
        counts = [{run: run.members for run in self.left}, {run: run.most_members for run in self.left}]
        self.runs = [sum(count.values()) for count in counts]
        times = [seconds_of(study, count, self.costs, self.scale.seconds, jobs, machine) for count in counts]
        compiles = not is_cached() and any(run.solver == "reference" for run in self.left)
        unsure = UNMEASURED if compiles or how is UNKNOWN else 1.0
        self.once_s = COMPILING_S * python_seconds() / PYTHON_S if compiles else 0.0
        self.seconds = (times[0] + self.once_s) * LEAST / unsure, (times[1] + self.once_s) * MOST * unsure
        self.by = f"{how}{', YADE by other machines' if 'yade' in ways.values() else ''}{by}"


def print_plan(study, folder, jobs, remake=False):
    """Print the plan of a Study in its folder; remake: runs of another version are made again."""
    plan = Plan(study, folder, jobs, remake)
    print(f"study {study.name}{': ' if study.title else ''}{study.title}")
    for run in study.runs:
        state = f"there, {len(plan.there[run])} runs" if run.is_ensemble else "there"
        print(f"  {run.id:60s}  {state if plan.there[run] else _planned(run, plan.costs[run], plan.scale)}")
    least, most = plan.runs
    on = next(path for path in (folder, *folder.parents) if path.is_dir())
    n_bytes = sum(run.most_members * plan.costs[run].n_bytes for run in plan.left) * plan.scale.n_bytes
    print(f"points: {len(study.runs)}, {len(study.runs) - len(plan.left)} there; runs to make: "
          f"{'up to ' if most != least else ''}{most}\n"
          f"expected: {duration(plan.seconds[0])} to {duration(plan.seconds[1])} with {jobs} at a time, where nothing "
          f"else runs; {n_bytes / 1e6:.3g} MB of histories in {folder}, which has "
          f"{shutil.disk_usage(on).free / 1e9:.3g} GB free\n"
          f"by {plan.by}"
          + (f"; with compiling the solver once, about {duration(plan.once_s)}" if plan.once_s else ""), flush=True)


def _there(study, folder, remake):
    """{StudyRun: names of its runs that a batch would keep, empty where it is not done}."""
    results = Results(folder)
    if not results.records.runs and not results.histories:
        return {run: [] for run in study.runs}
    verdict = results.judge(study.runs)
    again = {*verdict.models, *verdict.measures} if remake else ()
    return {run: [] if run in verdict.changed or set(names).intersection(again) else names
            for run in study.runs for names in [results.names_of(run)]}


UNKNOWN = "the speed of Python on this machine, as the solver is not compiled yet"


def machine_speed():
    """(Speed of this machine, where it is from in words)."""
    found = speed()
    if found is not None:
        return found, (f"this machine's speed, measured once: {found.alone_ns:.1f} ns a contact point and step of a "
                       f"wall alone, {found.together_ns:.1f} ns of eight together")
    factor = python_seconds() / PYTHON_S
    return Speed(*(factor * one for one in MEASURED_AT)), UNKNOWN


def ways_of(runs, jobs):
    """{StudyRun: "yade", "alone" or "together"}: whether so many runs in the reference solver are alike that groups of
    them step together in every process."""
    with chdir(ROOT):  # where the paths of runs lead from
        company = {run: company_of(run) for run in runs if run.solver == "reference"}
    count = Counter()
    for run, name in company.items():
        count[name] += run.most_members
    return {run: "yade" if run.solver == "yade" else
            "together" if count[company[run]] >= LEAST_LANES * jobs else "alone" for run in runs}


def seconds_of(study, count, costs, scale, jobs, machine):
    """Seconds of a batch; count: {StudyRun that is left: how many runs it comes to}."""
    if not count:
        return 0.0
    slower = machine.alone_ns / MEASURED_AT.alone_ns
    each = [number * costs[run].seconds * scale for run, number in count.items()]
    longest = max(costs[run].seconds * scale for run in count)  # one run is one process's
    pictures = slower * PICTURES_S * len(count) if study.pictures == "all" else 0.0
    return max(sum(each) / jobs, longest) + pictures / jobs + slower * BATCH_S


def _planned(run, cost, scale):
    """The runs to make of a run or an ensemble, in words."""
    each = f"about {duration(max(cost.seconds * scale.seconds, 1))}, {cost.n_bytes * scale.n_bytes / 1e6:.2g} MB"
    most = run.most_members
    return each if most == 1 else f"{run.members}{f' to {most}' if most != run.members else ''} runs of {each}"


def estimate(run, way, machine):
    """Cost of one run of a StudyRun; way: of `ways_of`; machine: a Speed."""
    settings = run.settings(ROOT)
    wall, n_joints, *times, height = _wall(str(ROOT / run.wall), replace(settings.model, strength_seed=0))
    (settings, step_s), *_ = schemes(settings.for_joint(wall.joint, Softening()), wall, *times)
    loading = settings.loading
    shaken_s = loading.length_s(height) if loading.drive.quasi_static else settings.duration_s
    steps = (RAMP_S + HOLD_S + shaken_s) / step_s
    samples = shaken_s / step_s / sample_steps(step_s, settings.mass_scaling)
    besides_s, factor = RUN[way]
    ns = {"together": machine.together_ns, "alone": machine.alone_ns, "yade": YADE_NS}[way]
    if settings.model.deforms:  # none step together
        ns, factor = DEFORMABLE * machine.alone_ns, RUN["alone"][1]
    if settings.mass_scaling == SELECTIVE:
        factor *= SCALED
    return Cost(besides_s * machine.alone_ns / MEASURED_AT.alone_ns + factor * steps * n_joints * ns * 1e-9,
                samples * n_joints * BYTES_A_CONTACT_AND_SAMPLE)


@cache
def _wall(path, model):
    """(damage.Wall, contact points, critical time step and period [s], height of what is pushed [m]) of a file."""
    layout = lay_out(load_wall(path), model)
    modes = natural_modes(layout)
    return (layout.wall, layout.n_joints, modes.critical_time_step_s, float(modes.period_s[0]), layout.pushed_height)


def scales(costs, there, ways, folder):
    """Factors on the estimates that make them those of the runs that are there, and what they are from, in words.

    Of runs that stepped together the bytes alone count: all of a group took the time of the group.
    """
    measured = [(costs[run], taken, ways[run]) for run, names in there.items() for name in names
                if (taken := took(folder / "runs" / f"{name}.h5")) is not None]
    if not measured:
        return Cost(1.0, 1.0), ""
    seconds = [taken.seconds / cost.seconds for cost, taken, way in measured if way != "together"]
    n_bytes = np.median([taken.n_bytes / cost.n_bytes for cost, taken, _ in measured])
    by = f", and what those that are there took ({len(measured)})"
    return Cost(np.median(seconds) if seconds else 1.0, n_bytes), by


def took(path):
    """Cost of a history's run, from its beginning to its last byte; None where it does not say."""
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
