"""One run of a study, or a shard: logged, its progress announced, its history put in place when it is complete.

    simulate.py RUN [--solver yade|reference] --out FILE.h5 --log FILE.log -- walls/NAME.py [OPTIONS]
    simulate.py NAME --log FILE.log --shard -- WORDS OF run_shard.py

The history grows in FILE.part.h5 and gets its name when the solver ended well and marked it complete,
so a FILE.h5 is always a whole run.  Exit status: the solver's own; 1 where its history is not complete.
A shard, of many runs, looks after its files itself.
"""

import argparse
import fcntl
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))  # PYTHONSAFEPATH leaves it out

from shared import MARK, ROOT, Log, announce, end_with_parent

from damage.errors import InputError

PATIENCE_S = 60.0
"""How long an interrupted solver may take to close its history before it is killed [s]."""
EXIT_INTERRUPTED = 130
SHARD = Path(__file__).with_name("run_shard.py")
_PROGRESS = re.compile(r"\bt = +([\d.]+) of ([\d.]+) s .* (\S+) left$")  # of damage.run.session


def main():
    """Run one simulation; returns the exit status."""
    end_with_parent(signal.SIGTERM)
    asked = _arguments()
    try:
        log = Log(asked.log)
    except InputError as error:
        announce(f"{asked.run}: FAILED, {error}")
        return 1
    fcntl.flock(log, fcntl.LOCK_EX)  # a killed batch's solver may still be closing its file
    log.clear()
    try:
        status = _shard(asked, log) if asked.shard else _single(asked, log)
    except OSError as error:
        log.write(f"error: {error.filename}: {error.strerror}\n")
        status = 1
    if status != 0:
        announce(f"{_shown(asked)}: {'interrupted' if status == EXIT_INTERRUPTED else 'FAILED'}, see {asked.log}")
    return status


def _arguments():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("run")
    parser.add_argument("--solver", default="yade", choices=("yade", "reference"))
    parser.add_argument("--out", type=_absolute)
    parser.add_argument("--log", type=_absolute, required=True)
    parser.add_argument("--shard", action="store_true")
    parser.add_argument("words", nargs="+")
    return parser.parse_args()


def _command_of(solver):
    """The command that runs a wall file; YADE's part of this software comes with a clone alone."""
    if solver == "reference":
        return [sys.executable, "-m", "damage", "reference"]
    from yade_scripts import COMMAND

    return COMMAND


def _shown(asked):
    """The name of a run, or of a job of many runs: shard_0000 is the first."""
    return f"job {int(asked.run.removeprefix('shard_')) + 1} of the reference solver" if asked.shard else asked.run


def _absolute(path):
    return Path(path).absolute()


def _shard(asked, log):
    """Run a shard; returns the exit status."""
    return _simulate(_shown(asked), [sys.executable, str(SHARD), *asked.words], log, shows_progress=False)


def _single(asked, log):
    """Run the solver into FILE.part.h5 and give it its name when it is whole; returns the exit status."""
    part = asked.out.with_name(f"{asked.out.stem}.part.h5")
    asked.out.parent.mkdir(parents=True, exist_ok=True)
    wall, *options = asked.words
    status = _simulate(asked.run, [*_command_of(asked.solver), wall, *options, "--out", str(part), "--overwrite",
                                   "--no-pictures"], log)
    if status != 0:
        return status
    complaint = _not_whole(part)
    if complaint is not None:
        log.write(f"error: {complaint}\n")
        return 1
    os.replace(part, asked.out)
    announce(f"{asked.run}: done")
    return 0


def _simulate(run, command, log, shows_progress=True):
    """Run a command with its output into `log`; returns its exit status."""
    announce(f"{run}: started")
    with _Interrupts() as interrupts:
        try:
            solver = subprocess.Popen(
                command, cwd=ROOT, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT, text=True, errors="replace",
                env={**os.environ, "PYTHONUNBUFFERED": "1"},
                pass_fds=(log.fileno(),),  # so that the lock lasts as long as the solver does
                preexec_fn=lambda: end_with_parent(signal.SIGTERM))
        except OSError as error:
            log.write(f"error: {command[0]} does not start: {error.strerror}\n")
            return 1
        interrupts.go_to(solver)
        _follow(run, solver.stdout, log, shows_progress)
        status = solver.wait()
    if interrupts.came and status != 0:
        return EXIT_INTERRUPTED
    if status < 0:
        log.write(f"error: {command[0]} was ended by signal {-status} ({signal.Signals(-status).name})\n")
    return status if status >= 0 else 128 - status


class _Interrupts:
    """While this lasts, SIGINT and SIGTERM end the solver politely; an alarm kills it if it lingers."""

    def __init__(self):
        self.came, self._process = False, None

    def __enter__(self):
        for name in (signal.SIGINT, signal.SIGTERM):
            signal.signal(name, self._pass_on)
        signal.signal(signal.SIGALRM, lambda *_: self._process.kill())
        return self

    def go_to(self, process):
        """From now on interrupts go to this process; earlier ones are made up for."""
        self._process = process
        if self.came:
            self._pass_on()

    def _pass_on(self, *_):
        self.came = True
        if self._process is not None:
            self._process.terminate()
            signal.setitimer(signal.ITIMER_REAL, PATIENCE_S)

    def __exit__(self, *_):
        signal.setitimer(signal.ITIMER_REAL, 0)


def _follow(run, lines, log, shows_progress):
    """Copy the solver's lines into the log; announce those that are marked and, if asked for, the progress at every
    tenth, or once a minute."""
    shown_share, shown_at = 0, time.monotonic()
    for line in lines:
        log.write(line)
        if line.startswith(MARK):
            announce(line[len(MARK):].rstrip("\n"))
        progress = shows_progress and _PROGRESS.search(line)
        if progress:
            share = round(100 * float(progress[1]) / max(float(progress[2]), 1e-9))
            if share >= shown_share + 10 or time.monotonic() > shown_at + 60:
                shown_share, shown_at = share, time.monotonic()
                announce(f"{run}: {share} %, {progress[3]} left")


def _not_whole(part):
    """Why the history is not a complete one, None where it is."""
    from damage.history.reader import read_history

    try:
        status = read_history(part).status
    except InputError as error:
        return str(error)
    return None if status == "complete" else f"the history is marked {status}; expected complete"


if __name__ == "__main__":
    sys.exit(main())
