"""A run of a study in YADE, a process of its own."""

import os
import re
import signal
import subprocess
from functools import partial

from damage.applications.studies.conclude import conclude
from damage.applications.studies.folder import ROOT, end_with_parent, environment
from damage.applications.studies.inputs import changes
from damage.applications.studies.tasks import CHANGED
from damage.errors import InputError
from damage.files import YADE
from damage.history.reader import read_history
from damage.run.options import words_of
from damage.start import EXIT_FAILED, EXIT_INTERRUPTED, EXIT_OK

PATIENCE_S = 60
"""How long an interrupted solver may take to close its history before it is killed [s]."""
# of damage.run.progress.Progress
_PROGRESS = re.compile(r"\bt = +(-?[\d.]+) of ([\d.]+) s ")


def run_yade(task, connection, lock, inputs):
    """Run YADE into the part of a history; returns (exit status, record or None), or as of
    CHANGED."""
    if task.history.is_file():
        return conclude(task)
    try:
        return _run_yade_on(task, connection, lock, inputs)
    except InputError as error:
        print(f"error: {task.name}: {error}")
        return EXIT_FAILED, None


def _run_yade_on(task, connection, lock, inputs):
    """As `_run_yade`: the inputs are compared before and after, as YADE reads them by itself."""
    if changed := changes(task, inputs):
        return CHANGED, changed
    connection.send((None, f"{task.name}: started", None))
    status = _run_solver(
        [*YADE, task.point.wall, *words_of(task.point.options_of(task.number) | task.place)],
        task.folder,
        lock,
        lambda share: connection.send((None, None, {task.name: share})),
    )
    if status == EXIT_OK:
        history = read_history(task.part)
        # the files of a house are read once more
        if changed := changes(task, inputs, None if history.house else history.masonry_wall):
            task.part.unlink()
            return CHANGED, changed
    return conclude(task) if status == EXIT_OK else (status, None)


def _run_solver(command, folder, lock, announce):
    """Run a command with its output into this process's; returns its exit status.  SIGTERM ends it
    politely, an alarm kills it if it lingers."""
    came = []
    try:
        solver = subprocess.Popen(
            command,
            cwd=ROOT,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            errors="replace",
            env=environment(folder),
            pass_fds=(lock,),
            process_group=0,
            preexec_fn=partial(end_with_parent, os.getpid()),
        )
    except OSError as error:
        print(f"error: {command[0]} does not start: {error.strerror}")
        return EXIT_FAILED

    def end(*_):
        if not came:
            solver.terminate()
            signal.alarm(PATIENCE_S)
        came.append(True)

    before = signal.signal(signal.SIGTERM, end)
    signal.signal(signal.SIGALRM, lambda *_: solver.kill())
    try:
        _follow(solver.stdout, announce)
        status = solver.wait()
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGTERM, before)
    if came and status != 0:
        return EXIT_INTERRUPTED
    if status < 0:
        print(f"error: {command[0]} was ended by signal {-status} ({signal.Signals(-status).name})")
    return status if status >= 0 else 128 - status


def _follow(lines, announce):
    """Print a solver's lines; announce the share that is simulated."""
    for line in lines:
        print(line, end="")
        if (progress := _PROGRESS.search(line)) is not None:
            time_s, duration_s = map(float, progress.groups())
            announce(max(0.0, time_s) / max(duration_s, 1e-9))
