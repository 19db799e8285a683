"""A study on its way: runs in its folder, tables, and what is said meanwhile."""

import os
import shlex
import subprocess
import sys
import time
from contextlib import chdir
from functools import partial

from damage.applications.studies.cost import DRAWING, RUN, TABLES, cost_of
from damage.applications.studies.definition import CONCLUSION
from damage.applications.studies.folder import (
    ROOT,
    claim,
    command_of,
    environment,
    is_short,
    last_words,
    open_records,
    shortage,
    way_on,
)
from damage.applications.studies.outdated import Results
from damage.applications.studies.plan import solver_lines
from damage.applications.studies.pool import Pool, say
from damage.applications.studies.read import describe_table, read_table
from damage.applications.studies.records import NAME, line_of
from damage.applications.studies.tables import write_study_tables
from damage.applications.studies.tasks import Point, slices
from damage.applications.studies.worker import work
from damage.errors import InputError, some_of, warn
from damage.run.pace import Pace, time_left
from damage.start import EXIT_INTERRUPTED


def run(study, folder, jobs, keep="all", *, remake=False, part=None, lock=None):
    """Run a Study; what is done is not done again.

    Parameters
    ----------
    study : Study
    folder : Path
        For runs, tables and pictures; absolute.
    jobs : int
        Number of processes.
    keep : {"all", "summary", "patterns"}
        What stays of runs: all histories; those of each point's first run; these, and of each run
        its patterns at rest.
    remake : bool
        Whether runs that another version made are made again.
    part : (int, int), optional
        K, N: the K-th of N parts alone, without tables of the whole study.
    lock : int, optional
        Of the folder, where the caller holds it
        (`damage.applications.studies.folder.while_locked`).

    Returns
    -------
    int
        Exit status: 0 all done, 1 a run failed or was not made, 130 interrupted.

    Raises
    ------
    InputError
        Where a wall, a record or the folder is bad.
    """
    again = [] if lock is not None else ["--solver", study.solver, "--keep", keep]
    lock = claim(folder, study, part is not None, lock, again)
    try:
        with chdir(ROOT):
            return Batch(study, folder, jobs, keep=keep, part=part, lock=lock).run(remake)
    except OSError as error:
        if error.filename is None:
            raise
        raise InputError(
            f"cannot write {error.filename}: {error.strerror}; correct that, and the same command "
            "continues from here"
        ) from error
    finally:
        os.close(lock)


WATCH_S = 10.0
"""Between two lines on how far runs are [s]."""


class Batch:
    """Points of a study on their way in one folder; arguments: `run`."""

    def __init__(self, study, folder, jobs, keep, part, lock):
        self.study = study
        self.runs = slices(study.runs, part[1])[part[0] - 1] if part else study.runs
        self.folder = folder
        self.jobs = jobs
        self.keep = keep
        self.part = part
        self.lock = lock
        self.unit = "points" if any(run.varied for run in study.runs) else "runs"
        self.what = f"study {study.name}{' slice {}/{}'.format(*part) if part else ''}"

    def run(self, remake):
        """Bring all up to date; returns the exit status."""
        results = Results(self.folder)
        verdict = results.judge(self.runs)
        messages = results.bring_up_to_date(verdict, remake)
        print(
            f"{self.what}{': ' if self.study.title else ''}{self.study.title}",
            f"{self.unit}: {len(self.runs)}, {self.jobs} at a time, into {self.folder}",
            *solver_lines(self.study, self.folder),
            sep="\n",
            flush=True,
        )
        self.points = {
            run.id: Point(run, results, self.keep, self.study.pictures == "all")
            for run in self.runs
        }
        warn(*messages)
        name = "records-{}-of-{}.jsonl".format(*self.part) if self.part else NAME
        if not self.part:
            results.write(verdict)
        with open_records(self.folder / name) as file:
            if self.part:
                file.write(results.lines_of(verdict))
            pool = self._simulate(file, verdict.inputs)
            return self._end(pool)

    def _simulate(self, file, inputs):
        """Do what is left on this machine; returns the Pool that did it.

        file: open file of records; inputs: {StudyRun: (key of its inputs, these as JSON)}.
        """
        self._last_report = time.monotonic()
        self._paces = {run.solver: Pace() for run in self.runs}

        def follow(task, record):
            """Write the record of a run; returns the tasks that follow."""
            if task.draws:
                return []
            file.write(line_of({"run": record["run"], "inputs": inputs[task.point][0]} | record))
            file.flush()
            if not task.keeps_history:
                task.part.unlink(missing_ok=True)
            point = self.points[task.point.id]
            point.records[task.number] = record
            if point.done:
                say(
                    f"{point.run.id}: done\n{self.what}: {self._done} of {len(self.points)}"
                    f" {self.unit} simulated"
                )
            return point.next_tasks()

        notes = {run.id: content for run, (_, content) in inputs.items()}
        work_on = partial(work, inputs=notes, processes=self.jobs)
        pool = Pool(self.jobs, work_on, self.lock, self.folder, self._watch)
        pool.run([task for point in self.points.values() for task in point.next_tasks()], follow)
        return pool

    def _end(self, pool):
        """Write the tables where all was done, and print how it ended; returns the exit status."""
        if pool.interrupted:
            if pool.n_lost:
                say(
                    f"interrupted: {pool.n_lost} runs were under way; {self._runs_done} that had"
                    " ended are kept"
                )
            self._count()
            way = way_on(self.folder)
            command = f":\n  {command_of(way[0], self.folder, way[1])}" if way else ""
            print(
                "interrupted: runs that had ended are kept, those that were under way continue"
                " from where they stood, of YADE they begin again: the same command continues from"
                f" here{command}",
                file=sys.stderr,
            )
            return EXIT_INTERRUPTED
        if pool.short or (pool.failed and is_short(self.folder)):
            self._count()
            print(
                f"error: {shortage(self.folder)}, and the same command continues from here",
                file=sys.stderr,
            )
            return 1
        status = 0 if self.part else self._sum_up()
        self._report()
        self._name_failed(pool)
        return 1 if pool.failed or pool.changed else status

    @property
    def _done(self):
        return sum(point.done for point in self.points.values())

    @property
    def _runs_done(self):
        return sum(len(point.records) for point in self.points.values())

    def _watch(self, shares):
        """Say now and then how far the runs are; shares: as of Pool."""
        lefts = [self._left_s(solver, shares) for solver in self._paces]
        if time.monotonic() < self._last_report + WATCH_S:
            return
        self._last_report = time.monotonic()
        runs = sum(point.run.runs_needed(point.records) for point in self.points.values())
        share = 100 * (self._runs_done + sum(shares.values())) / runs
        left_s = None if None in lefts else sum(lefts)
        say(f"{self._runs_done} of {runs} runs, {share:.1f} % simulated; {time_left(left_s)}")

    def _left_s(self, solver, shares):
        """Time [s] that is left of the runs in a solver and of their pictures, None where it is
        not known; shares: as of Pool."""
        done = 0.0
        least = TABLES
        most = TABLES
        for point in self.points.values():
            if point.run.solver != solver:
                continue
            cost = cost_of(point.run)
            drawing = DRAWING * point.pictures
            begun = sum(part for task, part in shares.items() if task.point is point.run)
            made = (cost + RUN) * (len(point.records) + begun) + drawing * point.is_drawn
            done += made
            least += (cost + RUN) * point.run.runs_needed(point.records) + drawing - made
            most += (cost + RUN) * point.run.runs_at_most(point.records) + drawing - made
        self._paces[solver].note(done)
        return self._paces[solver].left_s(least, most)

    def _count(self):
        print(f"\n{self.what}: {self._done} of {len(self.points)} {self.unit} done", flush=True)

    def _sum_up(self):
        """Write the tables of the study, and let the command that sums it up do so; returns the
        exit status."""
        if not self._done:
            return 0
        write_study_tables(self.study, self.folder)
        if self.study.conclusion is None or self._done < len(self.points):
            return 0
        package, command = CONCLUSION.fullmatch(self.study.conclusion).groups()
        document = self.folder / "tables" / f"{command}.md"
        say(f"{command}: {document}")
        return subprocess.run(
            [sys.executable, "-m", package, command, str(self.folder), "--markdown", str(document)],
            env=environment(),
            check=False,
        ).returncode

    def _report(self):
        """Print the summary table, of ensembles that of their points, where things are, and the
        commands that follow."""
        self._count()
        tables = self.folder / "tables"
        if self.part or not (tables / "summary.csv").is_file():
            return
        summary = shown = read_table(tables / "summary.csv")
        if self.unit == "points":
            # in one block: a column added to many warns
            points = read_table(tables / "points.csv").copy()
            shown = points.assign(run=points["point"] + "_" + points["solver"])
        print(describe_table(shown))
        print(f"tables:   {tables}")
        if self.study.pictures == "all":
            print(f"pictures: {self.folder / 'pictures'}")
        where = shlex.quote(str(self.folder))
        print(f"next, one HTML file:\n  python3 -m damage report {where}")
        if summary["strength_cov"].astype(float).gt(0).any():
            print(
                f"and its fragility curves:\n  python3 -m damage fragility {where} --out"
                f" {where}/fragility"
            )

    @staticmethod
    def _name_failed(pool):
        """Say which runs failed, and in a line which were not made as their inputs changed."""
        sys.stdout.flush()
        named = {}
        for task in pool.failed:
            what = f"pictures of {task.name}" if task.draws else task.point.id
            named.setdefault(what, f"{task.log}{last_words(task.log, task.name)}")
        for what, where in named.items():
            print(f"failed: {what}; see {where}", file=sys.stderr)
        if pool.changed:
            points = {
                task.point.id: f"{task.point.id} ({some_of(differences, 3)})"
                for task, differences in pool.changed
            }
            print(
                f"error: {len(pool.changed)} runs were not made, as inputs changed since the study"
                f" began: {some_of(list(points.values()), 3)}; restore these and give the same"
                " command, or give it with the new ones: it makes all runs of these points again",
                file=sys.stderr,
            )
