"""`python3 -m damage study STUDY`: a study from its file to tables and pictures; `run_all.sh`
starts this, too."""

import os
import re
import shlex
import subprocess
import sys
import time
from argparse import ArgumentTypeError
from contextlib import chdir
from functools import partial
from pathlib import Path

import pandas as pd

from damage.applications.studies.cost import DRAWING, RUN, TABLES, cost_of
from damage.applications.studies.definition import CONCLUSION, load_study
from damage.applications.studies.folder import (
    RESULTS,
    ROOT,
    claim,
    command_of,
    environment,
    is_short,
    open_records,
    shortage,
    way_on,
)
from damage.applications.studies.outdated import Results
from damage.applications.studies.plan import print_plan, solver_lines
from damage.applications.studies.pool import Pool
from damage.applications.studies.read import describe_table, read_table
from damage.applications.studies.records import NAME, line_of
from damage.applications.studies.tables import write_study_tables
from damage.applications.studies.tasks import KEEP, PICTURES, Point, slices
from damage.applications.studies.worker import work
from damage.arguments import OneLineParser, file_path, number_from
from damage.errors import InputError, did_you_mean, some_of, warn
from damage.files import is_there, shipped_files
from damage.run.pace import Pace, time_left
from damage.start import EXIT_INTERRUPTED


def run_study(arguments, lock=None):
    """Run the study that words of a command line ask for; returns the exit status: 0
    all done, 1 a run failed or was not made, 2 bad input, 130 interrupted.
    Raises InputError.

    lock: of the study's folder, where the caller holds it
    (`damage.applications.studies.folder.held`)."""
    words = arguments or ["--help"]
    if words[0].startswith("-") and words[0] not in ("-h", "--help"):
        raise InputError(
            f"{words[0]} comes where a study should; give python3 -m damage study STUDY [OPTIONS]"
        )
    asked = parse(words)
    if asked.solver != "reference" and not (ROOT / "yade_scripts").is_dir():
        raise InputError(
            f"--solver {asked.solver}: YADE's programs are in a clone of the repository only,"
            " beside YADE; leave --solver out, or give ./run_all.sh in a clone"
        )
    return run_one(asked, study_path(asked.study), lock)


def parse(words):
    """The parsed words of a command line."""
    parser = OneLineParser(
        prog="python3 -m damage study",
        allow_abbrev=False,
        examples=(
            "python3 -m damage study quick",
            "python3 -m damage study my_study.toml -j 4 --keep summary --out mine",
        ),
        description="Run a study: simulations, tables, pictures.  What is done is not done again.",
    )
    parser.add_argument(
        "study",
        metavar="STUDY",
        help="a study file (.toml), or the name of one that ships",
    )
    parser.add_argument(
        "-j",
        dest="jobs",
        type=number_from(1, 9999, int),
        default=os.cpu_count(),
        metavar="N",
        help="simulations at a time (default: one for each core)",
    )
    parser.add_argument(
        "--out", type=file_path, metavar="DIR", help="where everything goes (default results/NAME)"
    )
    parser.add_argument(
        "--solver",
        default="reference",
        choices=("yade", "reference", "both"),
        help="what simulates (default reference)",
    )
    parser.add_argument(
        "--keep",
        default="all",
        choices=KEEP,
        help=(
            "histories: all (default); summary: those of each point's first run, and what failed;"
            " patterns: these, and of every run openings, offsets and displacements at rest, some"
            " kB each"
        ),
    )
    parser.add_argument(
        "--dry-run",
        action="store_true",
        help="make nothing: list the runs that are there and those to make",
    )
    parser.add_argument(
        "--remake", action="store_true", help="make runs again that another version made"
    )
    parser.add_argument(
        "--slice",
        type=_slice,
        metavar="K/N",
        help="the K-th of N parts alone, without tables of the whole study: a job of a cluster",
    )
    return parser.parse_args(words)


def _slice(word):
    match = re.fullmatch(r"([1-9]\d{0,4})/([1-9]\d{0,4})", word)
    if not match or int(match[1]) > int(match[2]):
        raise ArgumentTypeError(f"{word}: expected K/N with K from 1 to N, as 2/8; correct it")
    return int(match[1]), int(match[2])


def study_path(word):
    """Path of a study file given by path or by the name of a shipped study; a file has precedence.
    Raises InputError where there is neither."""
    named = shipped_files("studies", ".toml")
    if is_there(word):
        return Path(word)
    if str(word) in named:
        return named[str(word)]
    raise InputError(
        f"{word}: no such study file; expected the path of one (.toml), or the name of a study that"
        " ships:"
        f" {', '.join(named)}{did_you_mean(word, named) or did_you_mean(Path(word).stem, named)}"
    )


def run_one(asked, path, lock=None):
    """Run the study at a path as parsed words ask for; returns the exit status; lock: as of
    `run_study`."""
    study = load_study(path.absolute(), asked.solver, ROOT)
    folder = (asked.out or RESULTS / study.name).absolute()
    if asked.dry_run:
        print_plan(study, folder, asked.remake)
        return 0
    runs = slices(study.runs, asked.slice[1])[asked.slice[0] - 1] if asked.slice else study.runs
    again = [] if lock is not None else ["--solver", asked.solver, "--keep", asked.keep]
    lock = claim(folder, study, asked.slice is not None, lock, again)
    try:
        with chdir(ROOT):
            return Batch(study, runs, folder, asked, lock).run()
    except OSError as error:
        if error.filename is None:
            raise
        raise InputError(
            f"cannot write {error.filename}: {error.strerror}; correct that, and the same command "
            "continues from here"
        ) from error
    finally:
        os.close(lock)


def _say_changed(changed):
    """Say in a line which runs were not made as their inputs changed; changed: as of Pool."""
    if changed:
        points = {
            task.point.id: f"{task.point.id} ({some_of(words, 3)})" for task, words in changed
        }
        print(
            f"error: {len(changed)} runs were not made, as inputs changed since the study began:"
            f" {some_of(list(points.values()), 3)}; restore these and give the same command, or"
            " give it with the new ones: it makes all runs of these points again",
            file=sys.stderr,
        )


WATCH_S = 10.0
"""Between two lines on how far runs are [s]."""


class Batch:
    """Points of a study on their way in one folder."""

    def __init__(self, study, runs, folder, asked, lock):
        self.study = study
        self.runs = runs
        self.folder = folder
        self.asked = asked
        self.lock = lock
        self.unit = "points" if any(run.is_ensemble for run in study.runs) else "runs"
        self.what = (
            f"study {study.name}{' slice {}/{}'.format(*asked.slice) if asked.slice else ''}"
        )

    def run(self):
        """Bring all up to date; returns the exit status."""
        results = Results(self.folder)
        verdict = results.judge(self.runs)
        messages = results.bring_up_to_date(verdict, self.asked.remake)
        print(
            f"{self.what}{': ' if self.study.title else ''}{self.study.title}",
            f"{self.unit}: {len(self.runs)}, {self.asked.jobs} at a time, into {self.folder}",
            *solver_lines(self.study, self.folder),
            sep="\n",
            flush=True,
        )
        self.points = {
            run.id: Point(run, results, self.asked.keep, self.study.pictures == "all")
            for run in self.runs
        }
        warn(*messages)
        if self.asked.slice:
            name = "records-{}-of-{}.jsonl".format(*self.asked.slice)
        else:
            name = NAME
            results.write(verdict)
        with open_records(self.folder / name) as file:
            if self.asked.slice:
                file.write(results.lines_of(verdict))
            return self._simulate(file, verdict.inputs)

    def _simulate(self, file, inputs):
        """Do what is left on this machine, then the tables; returns the exit status.

        file: open file of records; inputs: {StudyRun: (key of its inputs, these as JSON)}.
        """
        self._said = time.monotonic()
        self._paces = {solver: Pace() for solver in sorted({run.solver for run in self.runs})}

        def follow(task, record):
            """Write the record of a run; returns the tasks that follow."""
            if task.kind == PICTURES:
                return []
            file.write(line_of({"run": record["run"], "inputs": inputs[task.point][0]} | record))
            file.flush()
            if not task.kept:
                task.part.unlink(missing_ok=True)
            point = self.points[task.point.id]
            point.records[task.number] = record
            more = point.next_tasks()
            if point.done:
                self._show(point)
            return [*more, *point.next_pictures()]

        notes = {run.id: content for run, (_, content) in inputs.items()}
        work_on = partial(work, inputs=notes, processes=self.asked.jobs)
        pool = Pool(
            jobs=self.asked.jobs,
            work=work_on,
            lock=self.lock,
            folder=self.folder,
            say=say,
            watch=self._watch,
        )
        pool.run(
            [
                task
                for point in self.points.values()
                for task in (*point.next_tasks(), *point.next_pictures())
            ],
            follow,
        )
        if pool.interrupted:
            if pool.n_lost:
                say(
                    f"interrupted: {pool.n_lost} runs were under way; {self._runs_done} that had"
                    " ended are kept"
                )
            self._count()
            print(
                "interrupted: runs that had ended are kept, those that were under way continue"
                " from where they stood, of YADE they begin again: the same command continues from"
                f" here{self.again}",
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
        status = 0 if self.asked.slice else self._sum_up()
        status = self._report(pool.failed) or status
        _say_changed(pool.changed)
        return status or int(bool(pool.changed))

    @property
    def again(self):
        """The command that continues it, in a line below, unless that is another's."""
        way = way_on(self.folder)
        return f":\n  {command_of(way[0], self.folder, way[1])}" if way else ""

    def _say_next(self, tables):
        """Print the commands that follow a study with tables."""
        where = shlex.quote(str(self.folder))
        print(f"next, one HTML file:\n  python3 -m damage report {where}")
        if read_table(tables / "summary.csv")["strength_cov"].astype(float).gt(0).any():
            print(
                f"and its fragility curves:\n  python3 -m damage fragility {where} --out"
                f" {where}/fragility"
            )

    @property
    def _done(self):
        return sum(point.done for point in self.points.values())

    @property
    def _runs_done(self):
        return sum(len(point.records) for point in self.points.values())

    def _watch(self, shares):
        """Say now and then how far the runs are; shares: as of Pool."""
        lefts = [self._left_s(solver, shares) for solver in self._paces]
        if time.monotonic() < self._said + WATCH_S:
            return
        self._said = time.monotonic()
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
            made = (cost + RUN) * len(point.records) + drawing * point.is_drawn
            made += cost * sum(part for task, part in shares.items() if task.point is point.run)
            done += made
            least += (cost + RUN) * point.run.runs_needed(point.records) + drawing - made
            most += (cost + RUN) * point.run.runs_at_most(point.records) + drawing - made
        self._paces[solver].note(done)
        return self._paces[solver].left_s(least, most)

    def _show(self, point):
        """Print that a point is done, and how far the study is."""
        say(
            f"{point.run.id}: done\n{self.what}: {self._done} of {len(self.points)} {self.unit}"
            " simulated"
        )

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

    def _report(self, failed):
        """Print the summary table, where things are and what failed; returns 1 where something did,
        else 0."""
        self._count()
        tables = self.folder / "tables"
        if not self.asked.slice and (tables / "summary.csv").is_file():
            print(describe_table(_shown_table(tables, self.unit)))
            print(f"tables:   {tables}")
            if self.study.pictures == "all":
                print(f"pictures: {self.folder / 'pictures'}")
            self._say_next(tables)
        sys.stdout.flush()
        named = {}
        for task in failed:
            what = f"pictures of {task.name}" if task.kind == PICTURES else task.point.id
            named.setdefault(what, task)
        for what, task in named.items():
            print(
                f"failed: {what}; see {task.log}{last_words(task.log, task.name)}", file=sys.stderr
            )
        return 1 if failed else 0


def say(line):
    """Print a line at once."""
    print(line, flush=True)


def _shown_table(tables, unit):
    """The summary, or of ensembles their points, named by point and solver."""
    if unit == "runs":
        return pd.read_csv(tables / "summary.csv")
    points = pd.read_csv(tables / "points.csv").copy()  # in one block: a column added to many warns
    return points.assign(run=points["point"] + "_" + points["solver"])


def last_words(log, run):
    """The last line of a log that is about a run, or the last of all, in brackets, where there is
    one."""
    lines = log.read_text(encoding="utf-8", errors="replace").split("\n") if log.is_file() else []
    lines = [line.strip() for line in lines if line.strip()]
    lines = [line for line in lines if line.startswith("error: ") and run in line] or lines
    return f" ({lines[-1][:200]})" if lines else ""
