"""One study from its file to tables and pictures, by way of Snakemake; `run_all.sh` starts this.

    batch.py STUDY.toml [-j N] [--out DIR] [--solver yade|reference|both] [--slurm] [--cores N] [--shard RUNS]
             [--keep all|summary] [--remake] [--run ID]

Exit status: 0 all done, 1 something failed, 2 bad input, 130 interrupted.
"""

from damage.start import EXIT_INTERRUPTED, begin, is_of_output, leave

if __name__ == "__main__":
    begin()  # before what takes its time to import

import fcntl
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import again
import pandas as pd
import slurm
import versions
from room import NO_ROOM, check_room, forecast, is_short, shortage
from shards import RUNS_AN_HOUR, point_of, shard_of, write_shards
from shared import MARK, RESULTS, ROOT, Log, end_with_parent, environment, write_if_other
from stale import drop, find_stale, note

from damage.errors import InputError, warn
from damage.files import plain_file, whole_or_nothing
from damage.measure.tables import describe_table
from damage.provenance import measures_digest
from damage.run.options import OneLineParser, number_from
from damage.studies.definition import CONCLUSION, load_study
from damage.studies.tables import runs_there

LOCK_PATIENCE_S = 10.0
"""How long to wait for a folder that a killed batch's last processes may still hold [s]."""
LOOK_S = 2.0
"""Between two looks at the room on the disk [s]."""
STARTS_FASTER = {"SETUPTOOLS_USE_DISTUTILS": "stdlib"} if sys.version_info < (3, 12) else {}
"""For Snakemake 7, which imports distutils: a virtual environment would load all of setuptools for it, 0.3 s."""
_STEPS = re.compile(r"(\d+) of (\d+) steps \(.*\) done")


def main():
    """Run one study; returns the exit status."""
    try:
        parsed = _parse()
        if parsed.dry_run:
            import plan

            return plan.main()
        study = load_study(parsed.study, parsed.solver, ROOT)
        folder = (parsed.out or RESULTS / study.name).absolute()
        lock = claim(folder, study)
        if parsed.run:
            return again.make_again(parsed.run, study, folder)
        stale = find_stale(study, folder)
        lost = versions.of_other_measures(study, folder, parsed.remake, stale.points)
    except InputError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    cores = parsed.cores or (1 if parsed.slurm else parsed.jobs)
    batch = Batch(study, folder, parsed.jobs, parsed.solver, lock, parsed.slurm, cores)
    print(f"study {study.name}{': ' if study.title else ''}{study.title}\n"
          f"{batch.unit}: {len(study.runs)}, {parsed.jobs} at a time, into {folder}", flush=True)
    if (warning := forecast(study, folder, parsed.keep)) is not None:
        warn(warning)
    others = {name: model for name, model in versions.of_other_versions(study, folder).items()
              if point_of(name) not in stale.points}
    if others:
        warn(versions.describe(others, parsed.remake))
    if parsed.remake:
        versions.discard(others, study, folder)
    for warning in (*drop(stale, folder), *write_shards(
            study, folder, parsed.keep, parsed.shard or RUNS_AN_HOUR * cores, stale.points,
            {*others, *lost} if parsed.remake else ())):
        warn(warning)
    note(stale, folder)
    note_tables(study, parsed.solver, folder)
    status = batch.snakemake()
    if status != 0 and not batch.ended and batch.simulated():
        (folder / "tables" / "summary.csv").unlink(missing_ok=True)
        pictures = [f"pictures/{run.first}" for run in batch.simulated() if study.pictures == "all"]
        batch.snakemake("tables/summary.csv", *pictures, partial="true")  # of the runs that are there
    return report(batch, status) or conclude(study, folder)


def note_tables(study, solver, folder):
    """Write the inputs of the tables beside their runs: tables are made anew where one of these files is younger."""
    write_if_other(folder / ".tables" / "measures", measures_digest())
    write_if_other(folder / ".tables" / "runs", "\n".join((solver, *(run.id for run in study.runs))))


def conclude(study, folder):
    """Run the command that sums a whole study up, where it names one; returns the exit status."""
    if study.conclusion is None:
        return 0
    package, command = CONCLUSION.fullmatch(study.conclusion).groups()
    document = folder / "tables" / f"{command}.md"
    print(f"{command}: {document}", flush=True)
    return subprocess.run([sys.executable, "-m", package, command, str(folder), "--markdown", str(document)],
                          env=environment(), check=False).returncode


def _parse():
    parser = OneLineParser(prog="python3 -m damage study", allow_abbrev=False, examples=(
        "python3 -m damage study quick", "python3 -m damage study my_study.toml -j 4 --keep summary --out mine"),
        description="Run a study: simulations, tables, pictures.  What is done is not done again.")
    parser.add_argument("study", type=Path, metavar="STUDY", help="a study file (.toml); python3 -m damage study takes "
                        "the name of one that ships, too")
    parser.add_argument("-j", dest="jobs", type=number_from(1, 9999, int), default=os.cpu_count(), metavar="N",
                        help="simulations at a time (default: one for each core)")
    parser.add_argument("--out", type=Path, metavar="DIR", help="where everything goes (default results/NAME)")
    parser.add_argument("--solver", default="yade", choices=("yade", "reference", "both"), help="what simulates "
                        "(default yade; of python3 -m damage study: reference)")
    parser.add_argument("--keep", default="all", choices=("all", "summary"), help="histories: all (default), or those "
                        "of each point's first run, and what failed")
    parser.add_argument("--run", metavar="ID", help="make the history of this run alone, which was not kept")
    parser.add_argument("--dry-run", action="store_true", help="make nothing: say what there is to do, expected time "
                        "and disk")
    parser.add_argument("--slurm", action="store_true", help="as jobs of a SLURM cluster")
    parser.add_argument("--cores", type=number_from(1, 9_999_999, int), metavar="N", help="processors for each job")
    parser.add_argument("--shard", type=number_from(1, 9_999_999, int), metavar="RUNS", help="runs of a job")
    parser.add_argument("--remake", action="store_true", help="make runs again that another version made")
    parsed = parser.parse_args()
    if parsed.slurm and not parsed.dry_run:
        slurm.check()
    return parsed


def claim(folder, study):
    """Make the folder of a study and lock it for this batch; returns the open lock.

    The lock is the operating system's: it ends with the processes that hold it, so none is ever
    stale.  A folder belongs to one study, a copy of whose file it keeps.
    """
    kept = folder / "study.toml"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        check_room(folder)
        lock = open(folder / ".lock", "a", opener=plain_file)  # noqa: SIM115, open as long as the batch lives
        _lock(lock, folder)
        owner = load_name(kept)
        if owner not in (None, study.name):
            raise InputError(f"{folder} holds the study {owner!r}, not {study.name!r}; choose another --out")
        with whole_or_nothing(kept) as unfinished:
            shutil.copyfile(study.path, unfinished)
        (folder / "logs").mkdir(exist_ok=True)
    except OSError as error:
        raise InputError(f"cannot write to {folder}: {error.strerror}; choose another --out") from error
    return lock


def _lock(lock, folder):
    until = time.monotonic() + LOCK_PATIENCE_S
    while True:
        try:
            return fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            if time.monotonic() > until:
                raise InputError(f"another batch is at work in {folder}; wait for its end, or choose "
                                 "another --out") from None
            time.sleep(0.2)


def load_name(path):
    """The name in a study file that a batch kept, None where there is none."""
    found = re.search(r'^name\s*=\s*["\']([^"\']*)', path.read_text("utf-8", "replace"), re.MULTILINE) \
        if path.is_file() else None
    return found and found[1]


class Batch:
    """A study on its way through Snakemake in one folder."""

    def __init__(self, study, folder, jobs, solver, lock, on_slurm=False, cores=1):
        self.study, self.folder, self.jobs, self.solver, self.lock = study, folder, jobs, solver, lock
        self.slurm, self.cores = on_slurm, cores
        self.interrupted = self.short = False  # ended by a signal; in want of room
        self.unit = "points" if any(run.is_ensemble for run in study.runs) else "runs"
        self._began, self._there_before = time.monotonic(), 0

    @property
    def ended(self):
        """Whether it was ended before its time."""
        return self.interrupted or self.short

    def simulated(self):
        """The points, or single runs, that are simulated."""
        return [run for run in self.study.runs if runs_there(run, self.folder)]

    def snakemake(self, *targets, **config):
        """Bring the targets up to date, all of them by default; returns Snakemake's exit status."""
        self._began, self._there_before = time.monotonic(), len(self.simulated())
        log = Log(self.folder / "logs" / "snakemake.log")
        process = subprocess.Popen(
            self._command(targets, config), cwd=self.folder, env=self._environment(), text=True,
            errors="replace", stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
            pass_fds=(self.lock.fileno(),), process_group=0, preexec_fn=_prepare_child)
        for name in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            if signal.getsignal(name) != signal.SIG_IGN:  # as nohup leaves SIGHUP
                signal.signal(name, lambda *_: self._interrupt(process))
        signal.signal(signal.SIGALRM, lambda *_: self._look(process))
        signal.setitimer(signal.ITIMER_REAL, LOOK_S, LOOK_S)
        for line in process.stdout:
            log.write(line)
            self._show(line)
        signal.setitimer(signal.ITIMER_REAL, 0)
        status = process.wait()
        self.short = self.short or (status != 0 and is_short(self.folder))
        return status

    def _command(self, targets, config):
        config = {"study": json.dumps(str(self.study.path), ensure_ascii=False), "solver": self.solver,
                  "jobs": 1 if self.slurm else self.jobs, "cores": self.cores, **config}
        where = (slurm.words(self.study.name, self.folder, self.jobs) if self.slurm
                 else ["--cores", str(self.jobs)])
        return [sys.executable, "-m", "snakemake", *targets, *where,
                "--snakefile", str(ROOT / "workflow" / "Snakefile"), "--directory", str(self.folder),
                "--scheduler", "greedy", "--nolock", "--nocolor", "--keep-going",
                "--rerun-incomplete", "--rerun-triggers", "mtime",
                "--config", *(f"{key}={value}" for key, value in config.items())]

    def _environment(self):
        """This process's, with what Snakemake, matplotlib and YADE's IPython keep inside the folder."""
        inside = self.folder / ".snakemake"
        return {**STARTS_FASTER, **environment(), "MPLBACKEND": "Agg",
                "XDG_CACHE_HOME": str(inside / "cache"), "MPLCONFIGDIR": str(inside / "matplotlib"),
                "IPYTHONDIR": str(inside / "ipython")}

    def _show(self, line):
        """Print the runs' own lines and the progress of the study."""
        self.short = self.short or any(word in line for word in NO_ROOM)  # what Snakemake itself cannot write
        steps = _STEPS.match(line)
        if line.startswith(MARK):
            print(line[len(MARK):], end="", flush=True)
        if steps or (line.startswith(MARK) and line.endswith(": done\n")):
            further = f", {steps[1]} of {steps[2]} steps done" if steps else ""
            print(f"study {self.study.name}: {len(self.simulated())} of {len(self.study.runs)} {self.unit} "
                  f"simulated{further}{self._left()}", flush=True)

    def _left(self):
        """The time that the simulations will still take, at the pace of this batch; empty before the first."""
        there = len(self.simulated())
        if there in (self._there_before, len(self.study.runs)):
            return ""
        pace_s = (time.monotonic() - self._began) / (there - self._there_before)
        minutes, seconds = divmod(round(pace_s * (len(self.study.runs) - there)), 60)
        return f", about {minutes}:{seconds:02d} left"

    def _interrupt(self, process):
        """Pass an interrupt on to Snakemake and all that it runs."""
        if not self.interrupted:
            print("interrupted: ending what runs", file=sys.stderr, flush=True)
        self.interrupted = True
        self._end(process)

    def _look(self, process):
        """End all politely where the disk has no room left."""
        if not self.ended and is_short(self.folder):
            self.short = True
            self._end(process)

    @staticmethod
    def _end(process):
        """Send an interrupt to Snakemake and all that it runs."""
        try:
            os.killpg(process.pid, signal.SIGINT)
        except ProcessLookupError:
            pass


def _prepare_child():
    """Snakemake heeds SIGINT even where this program was started without, and dies with it."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    end_with_parent(signal.SIGKILL)


def report(batch, status):
    """Print the summary table, where things are and what failed; returns the exit status."""
    folder, done = batch.folder, len(batch.simulated())
    print(f"\nstudy {batch.study.name}: {done} of {len(batch.study.runs)} {batch.unit} done")
    if batch.interrupted:
        print("interrupted: runs that had ended are kept, those that were under way begin again: the same command "
              "continues from here", file=sys.stderr)
        return EXIT_INTERRUPTED
    if batch.short:
        print(f"error: {shortage(folder)}, and the same command continues from here", file=sys.stderr)
        return 1
    failed = list(failures(batch))
    if (folder / "tables" / "summary.csv").exists():
        print(describe_table(_shown_table(folder / "tables", batch.unit)))
        print(f"tables:   {folder / 'tables'}")
        if batch.study.pictures == "all":
            print(f"pictures: {folder / 'pictures'}")
    for what, log in failed:
        found = log if log.is_file() else folder / "logs" / "snakemake.log"  # Snakemake failed before it began
        print(f"failed: {what}; see {found}{last_words(found, what)}", file=sys.stderr)
    if status != 0 and not failed:
        print(f"failed: Snakemake, status {status}; see {folder / 'logs' / 'snakemake.log'}", file=sys.stderr)
    return 1 if failed or status != 0 else 0


def _shown_table(tables, unit):
    """The summary, or of ensembles their points, named by point and solver."""
    if unit == "runs":
        return pd.read_csv(tables / "summary.csv")
    points = pd.read_csv(tables / "points.csv").copy()  # in one block: a column added to many warns
    return points.assign(run=points["point"] + "_" + points["solver"])


def failures(batch):
    """(what failed, its log) for every run that lacks its history, tables or pictures."""
    folder, logs = batch.folder, batch.folder / "logs"
    if not (folder / "tables" / "summary.csv").exists() and batch.simulated():
        yield "summary", logs / "summary.log"
    for run in batch.study.runs:
        if not runs_there(run, folder):
            yield run.id, logs / (f"{run.id}.log" if run.solver == "yade" else f"shard_{shard_of(run, folder)}.log")
            continue
        made = {"tables": folder / "tables" / f"{run.first}_joints.csv"}
        if batch.study.pictures == "all":
            made["pictures"] = folder / "pictures" / run.first
        for what, path in made.items():
            if not path.exists():
                yield f"{what} of {run.first}", logs / f"{run.first}_{what}.log"


def last_words(log, run):
    """The last line of a log that is about a run, or the last of all, in brackets, where there is one."""
    lines = log.read_text(encoding="utf-8", errors="replace").split("\n") if log.is_file() else []
    lines = [line.strip() for line in lines if line.strip() and not line.startswith(MARK)]
    lines = [line for line in lines if line.startswith("error: ") and run in line] or lines
    return f" ({lines[-1][:200]})" if lines else ""


def run_program():
    """Run `main`; returns the exit status.  An output that takes nothing ends this process."""
    try:
        return main()
    except KeyboardInterrupt:  # before Snakemake runs
        return EXIT_INTERRUPTED
    except slurm.NoPlugin as error:
        print(f"error: {error}", file=sys.stderr)
        return 3
    except InputError as error:
        print(f"error: {error}", file=sys.stderr)
    except OSError as error:
        if not is_of_output(error):
            print(f"error: cannot write {error.filename}: {error.strerror}; correct that, and the same command "
                  "continues from here", file=sys.stderr)
    return 1


if __name__ == "__main__":
    leave(run_program())
