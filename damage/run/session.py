"""One run from its command line to its pictures, whichever solver does it."""

import io
import os
import signal
import sys
import threading
import time
import traceback
from collections.abc import Callable
from contextlib import contextmanager, nullcontext, redirect_stderr, redirect_stdout
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from weakref import WeakKeyDictionary

import pandas as pd

from damage.errors import InputError, RunError, WriteError, warn
from damage.history.buffer import Buffer
from damage.history.in_memory import HistoryInMemory, HistoryKept
from damage.history.reader import read_history
from damage.history.writer import HistoryWriter, check_output
from damage.law.modes import Modes, natural_modes
from damage.measure.energy import ENERGY_FAILURE, balance_error
from damage.measure.evidence import evidence_for, outside
from damage.measure.tables import member_row, members_path, write_table
from damage.measure.warnings import energy_warnings
from damage.memory import hold_buffers
from damage.motion.intensity import applied_measures, end_warnings
from damage.motion.loading import Recorded
from damage.motion.plausible import faint_warnings, record_warnings
from damage.provenance import file_origin, versions
from damage.run.before import read_state, without_bond
from damage.run.checkpoint import Checkpoints, checkpoint_path, read_end, resumed, schemes_left
from damage.run.opening import event_lines, kept_lines, opening_lines, record_lines, sequence_lines
from damage.run.options import free_name, parse_run
from damage.run.report import check_pictures, report
from damage.run.run import Run
from damage.run.schedule import check_size, check_top, deformable_warnings, softening_warnings
from damage.run.scheme import check_energy, scaling_warnings, schemes
from damage.run.settings import RunSettings, Softening
from damage.run.turns import as_they_end, run_each, take_turns
from damage.run.watch import DROP, FAILURE
from damage.start import is_of_output
from damage.wall.layout import Layout, lay_out
from damage.wall.soil import fastest_decay

EXIT_OK, EXIT_FAILED, EXIT_INPUT, EXIT_INTERRUPTED = 0, 1, 2, 130


@dataclass(frozen=True)
class Backend:
    """A solver as a session needs it.

    versions: {software: version} beside this software's own; code: the folder of the solver's modules;
    make(layout, time_step, settings): a damage.run.solver.Solver; check(settings, wall): raises InputError on what it
    cannot do; open_view: opens a live view and returns a function that refreshes it; None where there is none;
    softening: what it gives joints with fracture energies; None where it does not know them;
    brick_cells: of deformable bricks where nothing else is asked for, 0 for strain modes;
    keeps_state: whether the history has the state at its end, from which another run continues; it is in a checkpoint
    otherwise;
    begins(run): called with the Run before its first step; move, most: takes steps of so many runs at a time, as of
    `damage.run.turns.as_they_end`.
    """

    name: str
    versions: dict
    make: Callable
    code: Path
    check: Callable = lambda settings, wall: None
    open_view: Callable | None = None
    softening: Softening | None = None
    brick_cells: int = 0
    keeps_state: bool = True
    begins: Callable = lambda run: None
    move: Callable = run_each
    most: int = 1


def run_session(backend, wall_file, make_wall, arguments, prog):
    """Run the wall that `make_wall()` returns, made by `wall_file`, with the words of a command line; the exit status:
    0 done, 1 failed, 2 bad input, 130 interrupted."""
    return reported(lambda: _run(backend, wall_file, make_wall, arguments, prog))


def reported(work):
    """The exit status of `work()`, which returns one; its errors are printed, in one line where they are no fault of
    this software.  A WriteError ends this process."""
    try:
        return work()
    except SystemExit as exit_:  # --help
        return exit_.code or EXIT_OK
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        return EXIT_INTERRUPTED
    except Exception as error:
        return report_error(error)


def report_error(error, of=""):
    """Print an error, as `reported` does, with the words `of` before it; returns the exit status."""
    if isinstance(error, WriteError):
        print(f"error: {error}", file=sys.stderr, flush=True)
        sys.stdout.flush()
        os._exit(EXIT_FAILED)  # HDF5 would crash on the way out
    if isinstance(error, MemoryError):
        error = RunError(f"out of memory ({str(error) or 'no more to be had'}): expected room for the run; give it "
                         "more, as by ulimit -v, or a shorter one, fewer --cells")
    elif isinstance(error, OSError) and is_of_output(error):
        return EXIT_FAILED
    elif isinstance(error, OSError):
        error = InputError(f"{error}: expected what this user may read and write; correct that")
    if not isinstance(error, InputError | RunError):
        traceback.print_exception(error)
        return EXIT_FAILED
    print(f"error: {of}{error}", file=sys.stderr)
    return EXIT_INPUT if isinstance(error, InputError) else EXIT_FAILED


def with_errors_reported(name, run):
    """A run, as of `simulate`, whose errors are printed with its name and end no other; it returns the exit status."""
    try:
        return (yield from run)
    except Exception as error:
        return report_error(error, name)


def _run(backend, wall_file, make_wall, arguments, prog):
    hold_buffers()
    settings = parse_run(arguments, prog=prog, solver=backend.name)
    with redirect_stdout(io.StringIO()) if settings.quiet else nullcontext():
        if settings.members > 1:
            return _run_members(backend, wall_file, make_wall, settings)
        show = backend.open_view() if settings.view and backend.open_view else None  # before there is a history
        return _run_to_its_pictures(prepare(backend, wall_file, make_wall, settings), show)


def _run_members(backend, wall_file, make_wall, settings):
    """Run all members of a run, some at a time, the next where one has ended, as a study runs those of a point; returns
    the exit status, that of the first member where it failed, else the largest of all.

    The history of the first member is the file of the run, with the table of all that ended beside it.  Histories of
    the others are discarded, unless they failed or were interrupted: then they are in FILE_sSEED.h5.
    """
    if backend.most == 1:
        raise InputError(f"--members: the {backend.name} solver runs one wall at a time; expected the reference "
                         "solver, python3 -m damage reference WALL.py --members N; or give --scatter 0.001 --seed 1, "
                         "then 2, ..., a run each")
    out = Path(settings.out or free_name(make_wall(), settings, backend.name))
    first, *others = (replace(one, out=out.with_name(f"{out.stem}_s{one.seed}{out.suffix}"))
                      for one in settings.of_members())
    for one in others:
        check_output(one.out, settings.overwrite)
    begun = [prepare(backend, wall_file, make_wall, replace(first, out=out), HistoryKept)]
    members_path(out).unlink(missing_ok=True)  # of the run that this one replaces
    statuses, ended = {}, {}

    def runs(keep_going):
        """Each member as it begins; only the first prints its opening lines."""
        for number in range(settings.members):
            if EXIT_INTERRUPTED in statuses.values():
                return
            if number > 0:
                with redirect_stdout(io.StringIO()), redirect_stderr(io.StringIO()):
                    begun.append(prepare(backend, wall_file, make_wall, others[number - 1], HistoryInMemory))
            yield with_errors_reported(f"member of seed {first.seed + number}: ", simulate(begun[number], keep_going))

    label = f"{begun[0].layout.wall.name}, {settings.members} members"
    with attended(label, quiet=settings.quiet, runs=settings.members) as keep_going:
        for number, status in as_they_end(runs(keep_going), backend.move, backend.most):
            statuses[number], one, begun[number] = status, begun[number], None  # which held its history in memory
            if status == EXIT_OK:
                ended[number] = _ended_member(one, out)
    return _report_members(settings, statuses, ended, out)


def _ended_member(prepared, out):
    """(row of the table of members, warnings on its energy balance, None); of the first member, of which `report`
    warns, (row, no warnings, its History); out: path of the first one's history."""
    history, path = prepared.writer.history(), prepared.writer.path
    row = member_row(history, out)
    if path == out:
        return row, (), history
    path.unlink(missing_ok=True)  # written where a history outgrew the memory
    return row, [f"member of seed {prepared.settings.seed}: {text}"
                 for text in energy_warnings(balance_error(history))], None


def _report_members(settings, statuses, ended, out):
    """Print and write what members left; returns the exit status.

    statuses: {number: exit status} of those that began; ended: {number: as of `_ended_member`}; out: path of the first
    one's history.
    """
    worst = max(statuses.values())
    if worst == EXIT_INTERRUPTED:
        print(f"interrupted: {len(ended)} of {settings.members} members had ended", file=sys.stderr)
    if 0 not in ended:
        return max(statuses[0], EXIT_INTERRUPTED * (worst == EXIT_INTERRUPTED))
    in_order = [ended[number] for number in sorted(ended)]
    print(f"members: {write_table(pd.DataFrame([row for row, *_ in in_order]), members_path(out))}")
    warn(*(text for _, warnings, _ in in_order for text in warnings))
    report(ended[0][2], pictures=settings.pictures)
    if len(ended) < settings.members:
        print(f"{len(ended)} of {settings.members} members ended: median and range are of these")
    return worst


def _run_to_its_pictures(prepared, show):
    settings, out = prepared.settings, prepared.writer.path
    with attended(prepared.layout.wall.name, show, settings.quiet) as keep_going:
        (status,) = take_turns([simulate(prepared, keep_going)])
    if status == EXIT_INTERRUPTED and checkpoint_path(out).exists():
        print(f"to continue it, give the same command with --resume {out} in place of --out")
    try:
        report(read_history(out), pictures=settings.pictures and status == EXIT_OK)
    except MemoryError:
        warn(f"{out} is kept, its summary failed for want of memory; where there is more: python3 -m damage index "
             f"{out}")
    return status


@dataclass(frozen=True)
class Prepared:
    """A run that can begin: its wall is laid out and its history is there, without a sample; time_step [s];
    state: of the run that it continues, None without one; resumed: tables of the checkpoint from which it continues,
    None of a run that begins; checkpoints: what writes them, None where there is no file; repeats: (RunSettings, time
    step [s]) of runs that follow until one is accepted (`damage.run.scheme`); parameters: of the history;
    write(parameters=...): makes a history."""

    backend: Backend
    settings: RunSettings
    layout: Layout
    modes: Modes
    time_step: float
    writer: Buffer
    state: dict | None
    resumed: dict | None
    checkpoints: Checkpoints | None
    repeats: tuple[tuple[RunSettings, float], ...]
    parameters: dict
    write: Callable

    def repeated(self, reason):
        """The Prepared run that follows one that was not accepted, by a RunError; its history begins anew."""
        code = getattr(reason, "code", FAILURE)
        skipped = len(self.repeats) - 1 if code == DROP else 0
        (settings, time_step), *others = self.repeats[skipped:]
        parameters = self.parameters | settings.as_dict() | {
            "time_step_s": time_step, "repeats": self.parameters["repeats"] + 1, "repeated_for": code}
        print(f"{reason}: repeated {'explicitly' if not others else f'in steps of {time_step:.3g} s'}", flush=True)
        if self.checkpoints:
            self.checkpoints.remove()
        self.writer.begin_again(partial(self.write, parameters=parameters))
        return replace(self, settings=settings, time_step=time_step, repeats=tuple(others), parameters=parameters,
                       resumed=None)


def prepare(backend, wall_file, make_wall, settings, write=HistoryWriter):
    """A Prepared run, of RunSettings and otherwise the arguments of `run_session`; what it will be is printed.

    write: makes what keeps the history, HistoryInMemory in place of HistoryWriter where there is to be no file.
    """
    wall = make_wall()
    settings.check_plausible(wall)
    if wall.joint.softens and not backend.softening:
        raise InputError(f"wall {wall.name}: its joints have fracture energies, which the {backend.name} solver does "
                         "not know; leave them out, or use the reference solver: python3 -m damage reference")
    settings = settings.for_joint(wall.joint, backend.softening or Softening()).for_bricks(backend.brick_cells)
    backend.check(settings, wall)
    out = settings.out or free_name(wall, settings, backend.name)
    if not settings.resumed:
        check_output(out, settings.overwrite)
        if settings.pictures:
            check_pictures(out, settings.overwrite)
    layout = _laid_out(wall, settings)
    modes = natural_modes(layout)
    settings = settings.for_period(float(modes.period_s[0]))
    options = schemes(settings, wall, modes.critical_time_step_s, float(modes.period_s[0]), fastest_decay(layout))
    ((settings, time_step), *repeats), so_far = schemes_left(settings.resumed, options)
    check_size(settings, layout, time_step)
    check_top(settings, layout, time_step)
    _warn_of(backend, settings, wall, time_step, modes.critical_time_step_s)
    made_by = versions(backend.code) | backend.versions
    origin = backend.name, made_by["model"]
    state = _past(backend, settings, layout, origin, time_step)
    print(*opening_lines(layout, settings.loading, modes, time_step, settings.mass_scaling), *event_lines(settings),
          *record_lines(settings), *sequence_lines(settings), *kept_lines(settings, layout, time_step), sep="\n",
          flush=True)
    parameters = {"wall": wall.as_dict(), "wall_file": file_origin(wall_file), **settings.as_dict(),
                  "time_step_s": time_step, **so_far, "critical_time_step_s": modes.critical_time_step_s,
                  "eigen_period_s": float(modes.period_s[0]), "pier_stress_pa": layout.pier_stress,
                  **applied_measures(settings.loading.applied(), float(modes.period_s[0]),
                                     settings.loading.applied_across())}
    parameters["outside_validity"] = "; ".join(outside(evidence_for(wall, parameters))) or None
    write = partial(write, out, layout, solver=backend.name, versions=made_by, overwrite=settings.overwrite)
    if settings.resumed:
        like = None  # of a solver whose checkpoints hold a scene
        if backend.keeps_state:
            like = Run(layout, settings, backend.make(layout, time_step, settings), None, None).tables()
        writer, tables = resumed(settings.resumed, layout, parameters, origin, like)
    else:
        writer, tables = write(parameters=parameters), None
    checkpoints = None
    if isinstance(writer, HistoryWriter):
        checkpoints = Checkpoints(writer, settings.checkpoint_s, keeps_end=not backend.keeps_state)
        if not settings.resumed:
            checkpoints.remove()  # of the run that this one replaces
    print(f"history: {writer.where}", flush=True)
    return Prepared(backend, settings, layout, modes, time_step, writer, state, tables, checkpoints, tuple(repeats),
                    parameters, write)


def _laid_out(wall, settings):
    """The Layout of a wall with the cracks that it has before the run; RunSettings that do not suit it are refused."""
    layout = lay_out(wall, settings.model, scatter=settings.scatter, seed=settings.seed)
    if settings.joints_without_bond:
        layout = without_bond(layout, settings.joints_without_bond.joints(layout))
    if settings.settlement:
        settings.settlement.check_length(wall.length)
    return layout


def _warn_of(backend, settings, wall, time_step, critical_s):
    warn(*deformable_warnings(settings.model, wall), code="deformable_bricks")
    warn(*scaling_warnings(settings, wall), code="mass_scaling")
    if settings.recorded:
        warn(*faint_warnings(settings.peak_g), code="faint_motion")
    for text in dict.fromkeys(text for event in settings.recorded for text in record_warnings(event.loading)):
        warn(text, code="record")
    if isinstance(settings.loading, Recorded) and not settings.events:
        warn(*end_warnings(settings.loading.applied()), code="end_velocity")
    if wall.joint.softens:
        warn(*softening_warnings(settings, time_step, critical_s, backend.softening), code="softening_step")


def _past(backend, settings, layout, origin, time_step):
    """`state` of a Prepared run; origin: as of `read_earlier`; time_step [s]."""
    if not settings.continued:
        return None
    if backend.keeps_state:
        return read_state(settings.continued, layout, origin, backend.make(layout, time_step, settings))
    return read_end(settings.continued, layout, origin, time_step)


@contextmanager
def attended(label, show=None, quiet=False, runs=1):
    """While this lasts interrupts end runs politely: what it gives is the `keep_going` of Run, which shows their
    progress, too.  show: called now and then; runs: how many equally long ones there will be, 0 where nobody knows."""
    progress, interrupts = Progress(label, io.StringIO() if quiet else None, runs), []

    def keep_going(run, time_s):
        progress.show(time_s, run)
        if show:
            show()
        return not interrupts

    signals = [signal.SIGINT, signal.SIGTERM]  # Ctrl-C, a polite kill
    if signal.getsignal(signal.SIGHUP) != signal.SIG_IGN:  # a terminal that closes; nohup leaves it ignored
        signals.append(signal.SIGHUP)
    if threading.current_thread() is not threading.main_thread():  # which alone gets signals, and may set handlers
        signals = []
    before = {number: signal.signal(number, lambda *_: interrupts.append(True)) for number in signals}
    try:
        yield keep_going
    finally:
        progress.close()
        for number, handler in before.items():
            signal.signal(number, handler or signal.SIG_DFL)


def simulate(prepared, keep_going, settled=None):
    """Run all stages of a Prepared run, until one is accepted; the history is closed and marked however this ends.  A
    generator for `take_turns`, which returns the exit status; settled: as of Run."""
    while prepared.repeats:
        try:
            return (yield from _simulate(prepared, keep_going, settled))
        except RunError as reason:
            prepared, settled = prepared.repeated(reason), None
    return (yield from _simulate(prepared, keep_going, settled))


def _simulate(prepared, keep_going, settled):
    layout, writer, status, collapsed = prepared.layout, prepared.writer, "failed", None
    try:
        solver = prepared.backend.make(layout, prepared.time_step, prepared.settings)
        run = Run(layout, prepared.settings, solver, writer, keep_going, settled, prepared.state,
                  checkpoints=prepared.checkpoints, resumed=prepared.resumed)
        prepared.backend.begins(run)
        finished = yield from run.settle_under_gravity()
        if finished:
            run.start()
            finished = yield from run.run_all()
        keep_going(run, run.duration_s)  # nothing is left of one that ended early
        if run.fall:
            print(run.fall, flush=True)
        collapsed = run.collapsed_at_s
        if collapsed is not None and collapsed <= 0 and prepared.settings.settlement:
            raise RunError(f"wall {layout.wall.name}: bricks fell while the ground settled, {-collapsed:.2f} s before "
                           "time zero; expected a wall that stands; give a smaller --distortion")
        if finished:
            check_energy(prepared.settings, run.energy_error)
        if run.energy_error is not None and run.energy_error > ENERGY_FAILURE:
            raise RunError(f"energy balance error {100 * run.energy_error:.3g} % of the input, expected up to "
                           f"{100 * ENERGY_FAILURE:g} %: the run has failed; give a smaller --dt, or look at the wall")
        status = "complete" if finished else "interrupted"
        if finished and prepared.checkpoints and not (prepared.checkpoints.keeps_end and collapsed is None):
            prepared.checkpoints.remove()
    except RunError:
        status = None if prepared.repeats else status  # its history begins again
        raise
    finally:
        if status is not None:
            writer.finish(status, collapsed)
    return EXIT_OK if status == "complete" else EXIT_INTERRUPTED


class Progress:
    """Rewrites one line on a terminal; prints one every few seconds into a log."""

    def __init__(self, label, stream=None, runs=1):
        self.label, self.runs = label, runs
        self.stream = stream or sys.stderr
        self.live = self.stream.isatty()
        self.shown, self.shown_any = time.monotonic(), False
        self.started = None  # when the first stage after the static one began
        self._simulated_s, self._reached_s = 0.0, WeakKeyDictionary()  # by all runs, {Run: by this one}

    def show(self, simulated_s, run):
        """Show the stage and the index of a Run, at most twice a second (every ten seconds in a log)."""
        now, stage = time.monotonic(), run.stage
        if stage != "static":
            self.started = self.started or now
            reached_s = min(max(simulated_s, 0.0), run.duration_s)
            self._simulated_s += reached_s - self._reached_s.get(run, 0.0)
            self._reached_s[run] = reached_s
        if now - self.shown < (0.5 if self.live else 10.0):
            return
        self.shown, self.shown_any = now, True
        line = f"{self.label}  static stage, t = {simulated_s:.2f} s"
        if stage != "static":
            line = (f"{self.label}  {stage:8s} t = {simulated_s:6.2f} of {run.duration_s:.2f} s  "
                    f"DI = {run.index:.3f}  {self._left(now, run.duration_s)} left")
        self._write(f"\r{line}\033[K" if self.live else f"{line}\n")

    def _left(self, now, duration_s):
        """Time left for all runs, each of this length [s], by what they have simulated so far."""
        share = self._simulated_s / (self.runs * duration_s) if self.runs * duration_s else 0.0
        if share < 0.01:
            return "--:--"
        left = int((now - self.started) * max(0.0, 1 / share - 1))
        return f"{left // 60}:{left % 60:02d}"

    def close(self):
        """End the live line."""
        if self.live and self.shown_any:
            self._write("\n")

    def _write(self, text):
        try:
            self.stream.write(text)
            self.stream.flush()
        except OSError:  # no room for a log, or nobody looks any more: that ends no run
            pass
