"""The members of a single run, `reference ... --members N`: a study of one point in a temporary
folder."""

import math
import os
import shutil
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import pandas as pd

from damage.applications.studies.definition import StudyRun, option_table, with_paths
from damage.applications.studies.folder import last_words, while_locked
from damage.applications.studies.pool import Pool
from damage.applications.studies.spread import member_row, members_path
from damage.applications.studies.tasks import Task
from damage.applications.studies.worker import work
from damage.errors import warn
from damage.history.reader import read_history
from damage.measure.tables import write_table
from damage.measure.warnings import energy_warnings
from damage.reference.session import BACKEND
from damage.run.prepare import announced
from damage.run.report import report
from damage.run.settings import SCATTER
from damage.start import EXIT_FAILED, EXIT_INTERRUPTED, EXIT_OK

OF_MEMBERS = "members", "seed", "scatter", "out", "overwrite", "no-pictures", "quiet"
"""Options of a run with members that its members have otherwise."""


def run_members(wall_file, make_wall, settings, words):
    """Run all members of a run, up to eight of which step together; returns the exit status.
    Arguments as of `damage.run.options.RUN_MEMBERS`.

    The history of the first member is the file of the run, with the table of all that ended beside
    it; those of the others are not kept.
    """
    plan, out = announced(BACKEND, make_wall, settings)
    out = Path(out)
    print(f"history of the first member: {out}", flush=True)
    members_path(out).unlink(missing_ok=True)  # of the run that this one replaces
    point = _point(wall_file, settings, words)
    with TemporaryDirectory(prefix="masonry-damage-") as folder:
        tasks = [
            Task(Path(folder), point, number, keeps_history=number == 1)
            for number in range(1, point.members + 1)
        ]
        rows, pool = _made(tasks, plan.layout.wall.name)
        for task in pool.failed:
            print(
                "error: member of seed"
                f" {point.offset + task.number}{last_words(task.log, task.name)}",
                file=sys.stderr,
            )
        if 1 in rows:
            out.parent.mkdir(parents=True, exist_ok=True)
            shutil.move(tasks[0].history, out)
    if pool.interrupted:
        print(f"interrupted: {len(rows)} of {point.members} members had ended", file=sys.stderr)
    _report(rows, point.members, out, settings.pictures)
    return (
        EXIT_INTERRUPTED
        if pool.interrupted
        else EXIT_FAILED
        if pool.failed or pool.short
        else EXIT_OK
    )


def _point(wall_file, settings, words):
    """The StudyRun of the members, with absolute paths, as a batch changes its folder."""
    alike = {name: value for name, value in option_table(words).items() if name not in OF_MEMBERS}
    given = with_paths(alike | {"scatter": settings.scatter or SCATTER}, os.path.abspath)
    return StudyRun(
        point="members",
        wall=os.path.abspath(wall_file),
        options=tuple(given.items()),
        solver=BACKEND.name,
        varied="seed",
        members=settings.members,
        offset=(settings.seed or 1) - 1,
    )


def _made(tasks, name):
    """Do tasks; returns {number of a member: row of summary.csv} of those that ended, and the Pool
    that did them."""
    folder = tasks[0].folder
    rows = {}

    def follow(task, record):
        rows[task.number] = record["row"]
        if not task.keeps_history:
            task.part.unlink(missing_ok=True)
        print(f"{name}: {len(rows)} of {len(tasks)} members ended", flush=True)
        return ()

    with while_locked(folder, "members") as lock:
        jobs = min(os.cpu_count(), math.ceil(len(tasks) / BACKEND.most))
        pool = Pool(jobs, work, lock, folder)
        pool.run(tasks, follow)
    return rows, pool


def _report(rows, n_members, out, pictures):
    """Write the table of members, print the summary of the first with the median and range of
    all."""
    if 1 not in rows:
        return
    table = [member_row(row, out) for _, row in sorted(rows.items())]
    print(f"members: {write_table(pd.DataFrame(table), members_path(out))}")
    warn(
        *(
            f"member of seed {row['seed']}: {text}"
            for row in table[1:]
            for text in energy_warnings(row["energy_error_fraction"])
        )
    )
    report(read_history(out), pictures=pictures)
    if len(rows) < n_members:
        print(f"{len(rows)} of {n_members} members ended: median and range are of these")
