"""One run from its command line to its pictures, whichever solver does it."""

import io
import shutil
import signal
import sys
import threading
import time
from collections.abc import Callable
from contextlib import contextmanager, nullcontext, redirect_stdout
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from damage.errors import InputError, RunError, warn
from damage.history.buffer import Buffer
from damage.history.reader import read_history
from damage.history.writer import HistoryWriter, check_output
from damage.house.coarser import in_units
from damage.house.drawn import drawn, ranges
from damage.house.layout import lay_out_building
from damage.house.meeting import warn_of_lone_walls
from damage.linear.modes import Modes, natural_modes
from damage.measure.energy import ENERGY_FAILURE
from damage.measure.evidence import evidence_for, outside
from damage.memory import hold_buffers
from damage.motion.intensity import applied_measures, drift_warnings, end_warnings
from damage.motion.loading import Recorded
from damage.motion.plausible import faint_warnings, record_warnings
from damage.provenance import file_origin, versions
from damage.run.banner import (
    event_lines,
    record_lines,
    sequence_lines,
    settlement_lines,
    stress_lines,
    wall_lines,
)
from damage.run.checkpoint import Checkpoints, checkpoint_path, read_end, resumed, schemes_left
from damage.run.cooperative import take_turns
from damage.run.initial_state import read_state, without_bond
from damage.run.monitor import DROP, FAILURE
from damage.run.options import RUN_MEMBERS, parse_run
from damage.run.pace import Pace, time_left
from damage.run.paths import free_name
from damage.run.report import check_pictures, report
from damage.run.run import Run
from damage.run.schedule import check_size, check_top, deformable_warnings, softening_warnings
from damage.run.scheme import check_energy, scaling_warnings, schemes
from damage.run.settings import SELECTIVE, SOFTENING_BETA_S, RunSettings
from damage.start import EXIT_INTERRUPTED, EXIT_OK, report_error, reported
from damage.wall.layout import Layout
from damage.wall.soil import fastest_decay


@dataclass(frozen=True)
class Backend:
    """A solver as a session needs it.

    versions: {software: version} beside this software's own; code: the folder of the solver's
    modules; make(layout, time_step, settings): a damage.run.solver.Solver; check(settings, wall):
    raises InputError on what it cannot do; open_view: opens a live view and returns a function that
    refreshes it; None where there is none; softening_beta_s: stiffness-proportional damping of
    joints that soften [s];
    keeps_state: whether the history has the state at its end, from which another run continues; it
    is in a checkpoint otherwise;
    begins(run): called with the Run before its first step, returns what was changed by hand since
    the wall was built, in words; most: runs that step together at most.
    """

    name: str
    versions: dict
    make: Callable
    code: Path
    check: Callable = lambda settings, wall: None
    open_view: Callable | None = None
    softening_beta_s: float = SOFTENING_BETA_S
    keeps_state: bool = True
    begins: Callable = lambda run: ""
    most: int = 1


def run_session(backend, wall_file, make_wall, arguments, prog):
    """Run the wall that `make_wall()` returns, made by `wall_file`, with the words of a command
    line; the exit status: 0 done, 1 failed, 2 bad input, 130 interrupted."""
    return reported(lambda: _run(backend, wall_file, make_wall, arguments, prog))


def with_errors_reported(name, run):
    """A run, as of `simulate`, whose errors are printed with its name and end no other; it returns
    the exit status."""
    try:
        return (yield from run)
    except Exception as error:
        return report_error(error, name)


def _run(backend, wall_file, make_wall, arguments, prog):
    hold_buffers()
    settings = parse_run(arguments, prog=prog, solver=backend.name)
    with redirect_stdout(io.StringIO()) if settings.quiet else nullcontext():
        if settings.members > 1:
            if backend.most == 1:
                raise InputError(
                    f"--members: the {backend.name} solver runs one wall at a time; expected the "
                    "reference solver, python3 -m damage reference WALL.py --members N; or give "
                    "--scatter 0.001 --seed 1, then 2, ..., a run each"
                )
            return RUN_MEMBERS[0](wall_file, make_wall, settings, arguments)
        # before there is a history
        show = backend.open_view() if settings.view and backend.open_view else None
        return _run_to_its_pictures(prepare(backend, wall_file, make_wall, settings), show)


def _run_to_its_pictures(prepared, show):
    settings, out = prepared.settings, prepared.writer.path
    with attended(prepared.layout.wall.name, show, settings.quiet) as keep_going:
        (status,) = take_turns([simulate(prepared, keep_going)])
    if status == EXIT_INTERRUPTED and checkpoint_path(out).exists():
        print(f"to continue it, give the same command with --resume {out} in place of --out")
    try:
        report(read_history(out), pictures=settings.pictures and status == EXIT_OK)
    except MemoryError:
        warn(
            f"{out} is kept, its summary failed for want of memory; where there is more: python3 -m"
            f" damage index {out}"
        )
    return status


@dataclass(frozen=True)
class RunPlan:
    """A run as it will be, before anything is written.

    Attributes
    ----------
    backend : Backend
    settings : RunSettings
    layout : Layout
    modes : Modes
    time_step : float
        [s]
    repeats : tuple of (RunSettings, float)
        Of runs with these time steps [s] that follow until one is accepted (`damage.run.scheme`).
    so_far : dict
        Parameters of a resumed run that say how it was repeated.
    """

    backend: Backend
    settings: RunSettings
    layout: Layout
    modes: Modes
    time_step: float
    repeats: tuple[tuple[RunSettings, float], ...]
    so_far: dict

    @property
    def made_by(self):
        """{software: version}."""
        return versions(self.backend.code) | self.backend.versions

    @property
    def origin(self):
        """As of `read_earlier`."""
        return self.backend.name, self.made_by["model"]

    def solver(self):
        """A new solver of the run."""
        return self.backend.make(self.layout, self.time_step, self.settings)

    def parameters_with(self, wall_file):
        """Parameters of its history."""
        loading, wall, period_s = (
            self.settings.loading,
            self.layout.wall,
            float(self.modes.period_s[0]),
        )
        found = {
            "wall": wall.as_dict(),
            "wall_file": file_origin(wall_file),
            **self.settings.as_dict(),
            "time_step_s": self.time_step,
            **self.so_far,
            "critical_time_step_s": self.modes.critical_time_step_s,
            "eigen_period_s": period_s,
            "pier_stress_pa": self.layout.pier_stress,
            **applied_measures(loading.applied(), period_s, loading.applied_across()),
            **self.layout.house_parameters,
        }
        return found | {"outside_validity": "; ".join(outside(evidence_for(wall, found))) or None}

    def past(self):
        """`state` of a Prepared run."""
        if not self.settings.continued:
            return None
        if self.backend.keeps_state:
            return read_state(self.settings.continued, self.layout, self.origin, self.solver())
        return read_end(self.settings.continued, self.layout, self.origin, self.time_step)


@dataclass(frozen=True)
class Prepared(RunPlan):
    """A run that can begin: its history is there, without a sample.

    writer: keeps it; state: of the run that it continues, None without one; resumed: tables of the
    checkpoint from which it continues, None of a run that begins; checkpoints: what writes them,
    None where there is no file; parameters: of the history; write(parameters=...): makes a history.
    """

    writer: Buffer
    state: dict | None
    resumed: dict | None
    checkpoints: Checkpoints | None
    parameters: dict
    write: Callable

    def repeated(self, reason):
        """The Prepared run that follows one that was not accepted, by a RunError; its history
        begins anew."""
        code = getattr(reason, "code", FAILURE)
        (settings, time_step), *others = [
            (one, step_s)
            for one, step_s in self.repeats
            if code != DROP or one.mass_scaling != SELECTIVE
        ]
        parameters = (
            self.parameters
            | settings.as_dict()
            | {
                "time_step_s": time_step,
                "repeats": self.parameters["repeats"] + 1,
                "repeated_for": code,
            }
        )
        how = "explicitly, " if settings.mass_scaling != SELECTIVE else ""
        print(f"{reason}: repeated {how}in steps of {time_step:.3g} s", flush=True)
        if self.checkpoints:
            self.checkpoints.remove()
        self.writer.begin_again(partial(self.write, parameters=parameters))
        return replace(
            self,
            settings=settings,
            time_step=time_step,
            repeats=tuple(others),
            parameters=parameters,
            resumed=None,
        )


def prepare(backend, wall_file, make_wall, settings, write=HistoryWriter):
    """A Prepared run, of RunSettings and otherwise the arguments of `run_session`; what it will be
    is printed.

    write: makes what keeps the history, HistoryInMemory in place of HistoryWriter where there is to
    be no file.
    """
    wall = in_units(make_wall(), settings.units)
    settings = check(backend, wall, settings)
    out = output_of(backend, wall, settings)
    plan = plan_of(backend, wall, settings)
    announce(plan)
    state = plan.past()
    return _opened(plan, state, plan.parameters_with(wall_file), out, write)


def check(backend, wall, settings):
    """RunSettings with what this solver adds to them for this wall; raises InputError where they do
    not go together."""
    wall.check_run(settings)
    settings.check_plausible(wall)
    settings = settings.for_joint(wall.masonry.joint, backend.softening_beta_s)
    for one in wall.each_wall:
        backend.check(settings, one)
    return settings


def output_of(backend, wall, settings):
    """Path of the history; raises InputError where it, or its pictures, cannot be written."""
    out = settings.out or free_name(wall.masonry, settings, backend.name)
    if not settings.resumed:
        check_output(out, settings.overwrite)
        if settings.pictures:
            check_pictures(out, settings.overwrite)
    return out


def plan_of(backend, wall, settings):
    """The RunPlan of a run of settings that were checked; raises InputError."""
    wall = drawn(wall, ranges(settings.model.inputs), settings.model.strength_seed)
    layout = _laid_out(wall, settings)
    modes = natural_modes(layout)
    settings = settings.for_period(float(modes.period_s[0]))
    options = schemes(settings, wall.masonry, modes, fastest_decay(layout))
    ((settings, time_step), *repeats), so_far = schemes_left(settings.resumed, options)
    check_size(settings, layout, time_step)
    check_top(settings, layout, time_step)
    return RunPlan(backend, settings, layout, modes, time_step, tuple(repeats), so_far)


def _opened(plan, state, parameters, out, write):
    """The Prepared run of a RunPlan, whose history is opened."""
    backend, settings, layout = plan.backend, plan.settings, plan.layout
    write = partial(
        write, out, layout, solver=backend.name, versions=plan.made_by, overwrite=settings.overwrite
    )
    if settings.resumed:
        writer, tables = resumed(
            settings.resumed, layout, parameters, plan.origin, scene=not backend.keeps_state
        )
    else:
        writer, tables = write(parameters=parameters), None
    checkpoints = None
    if writer.path:
        checkpoints = Checkpoints(writer, settings.checkpoint_s, keeps_end=not backend.keeps_state)
        if not settings.resumed:
            checkpoints.remove()  # of the run that this one replaces
    print(f"history: {writer.where}", flush=True)
    return Prepared(
        **vars(plan),
        writer=writer,
        state=state,
        resumed=tables,
        checkpoints=checkpoints,
        parameters=parameters,
        write=write,
    )


def _laid_out(wall, settings):
    """The Layout of a wall with the cracks that it has before the run; RunSettings that do not suit
    it are refused."""
    layout = lay_out_building(wall, settings.model, scatter=settings.scatter, seed=settings.seed)
    if settings.joints_without_bond:
        layout = without_bond(layout, settings.joints_without_bond.joints(layout))
    if settings.settlement:
        settings.settlement.check_length(float(layout.ground.right.max()))
    return layout


def announce(plan):
    """Print what a RunPlan will be, and warn of what is doubtful in it."""
    settings, wall, loading = plan.settings, plan.layout.wall, plan.settings.loading
    warn(*deformable_warnings(settings.model, wall), code="deformable_bricks")
    warn(*scaling_warnings(settings, wall), code="mass_scaling")
    if settings.recorded:
        warn(*faint_warnings(settings.peak_g), code="faint_motion")
    for text in dict.fromkeys(
        text for event in settings.recorded for text in record_warnings(event.loading)
    ):
        warn(text, code="record")
    if isinstance(loading, Recorded) and not settings.events:
        warn(*end_warnings(loading.applied()), code="end_velocity")
        warn(*drift_warnings(loading), code="drift")
    if wall.joint.softens:
        warn(
            *softening_warnings(
                settings,
                plan.time_step,
                plan.modes.critical_time_step_s,
                plan.backend.softening_beta_s,
            ),
            code="softening_step",
        )
    warn(*warn_of_lone_walls(plan.layout.building), code="lone_walls")
    lines = wall_lines(plan.layout, loading, plan.modes, plan.time_step, settings.mass_scaling)
    print(
        *lines,
        *settlement_lines(settings, plan.layout),
        *event_lines(settings),
        *record_lines(settings),
        *sequence_lines(settings),
        *stress_lines(settings, plan.layout, plan.time_step),
        sep="\n",
        flush=True,
    )


@contextmanager
def attended(label, show=None, quiet=False, several=False):
    """While this lasts interrupts end runs politely: what it gives is the `keep_going` of Run,
    which shows their progress, too.  show: called now and then; several: whether nobody knows how
    many runs there will be."""
    progress, interrupts = Progress(label, io.StringIO() if quiet else None, several), []

    def keep_going(run, time_s):
        progress.show(time_s, run)
        if show:
            show()
        return not interrupts

    signals = [signal.SIGINT, signal.SIGTERM]  # Ctrl-C, a polite kill
    # a terminal that closes; nohup leaves it ignored
    if signal.getsignal(signal.SIGHUP) != signal.SIG_IGN:
        signals.append(signal.SIGHUP)
    # which alone gets signals, and may set handlers
    if threading.current_thread() is not threading.main_thread():
        signals = []
    before = {
        number: signal.signal(number, lambda *_: interrupts.append(True)) for number in signals
    }
    try:
        yield keep_going
    finally:
        progress.close()
        for number, handler in before.items():
            signal.signal(number, handler or signal.SIG_DFL)


def simulate(prepared, keep_going, settled=None):
    """Run all stages of a Prepared run, until one is accepted; the history is closed and marked
    however this ends.  A generator for `take_turns`, which returns the exit status; settled: as of
    Run."""
    while prepared.repeats:
        try:
            return (yield from _simulate(prepared, keep_going, settled))
        except RunError as reason:
            prepared, settled = prepared.repeated(reason), None
    return (yield from _simulate(prepared, keep_going, settled))


def _simulate(prepared, keep_going, settled):
    layout, writer, status, collapsed = prepared.layout, prepared.writer, "failed", None
    try:
        solver = prepared.solver()
        run = Run(
            layout,
            prepared.settings,
            solver,
            writer,
            keep_going,
            settled,
            prepared.state,
            checkpoints=prepared.checkpoints,
            resumed=prepared.resumed,
        )
        _keep_changed(prepared, prepared.backend.begins(run))
        finished = yield from run.come_to_rest()
        if finished:
            run.start()
            finished = yield from run.run_all()
        keep_going(run, run.duration_s)  # nothing is left of one that ended early
        if run.fall:
            print(run.fall, flush=True)
        collapsed = run.collapsed_at_s
        if collapsed is not None and collapsed <= 0 and prepared.settings.settlement:
            raise RunError(
                f"wall {layout.wall.name}: bricks fell while the ground settled, {-collapsed:.2f} s"
                " before time zero; expected a wall that stands; give a smaller --distortion"
            )
        if finished and prepared.repeats:
            check_energy(run.energy_error)
        if run.energy_error is not None and run.energy_error > ENERGY_FAILURE:
            raise RunError(
                f"energy balance error {100 * run.energy_error:.3g} % of the input, expected up to"
                f" {100 * ENERGY_FAILURE:g} %: the run has failed; give a smaller --dt, or look at"
                " the wall"
            )
        status = "complete" if finished else "interrupted"
        if (
            finished
            and prepared.checkpoints
            and not (prepared.checkpoints.keeps_end and collapsed is None)
        ):
            prepared.checkpoints.remove()
    except RunError:
        status = None if prepared.repeats else status  # its history begins again
        raise
    finally:
        if status is not None:
            writer.finish(status, collapsed)
    return EXIT_OK if status == "complete" else EXIT_INTERRUPTED


def _keep_changed(prepared, changed):
    """Write into the history what was changed by hand, in words; raises InputError where the state
    of another run replaces it."""
    if not changed:
        return
    if prepared.state is not None or prepared.resumed is not None:
        raise InputError(
            f"changed by hand: {changed}: expected the wall as built, as the state of the run that"
            " continues replaces it; leave --continue or --resume out, or change nothing"
        )
    prepared.writer.add_parameters({"changed_by_hand": changed})


class Progress:
    """Rewrites one line on a terminal; prints one every few seconds into a log."""

    def __init__(self, label, stream=None, several=False):
        self.label, self.several = label, several
        self.stream = stream or sys.stderr
        self.live = self.stream.isatty()
        self.shown, self.shown_any, self.pace = time.monotonic(), False, Pace()

    def show(self, simulated_s, run):
        """Show the stage and the index of a Run, at most twice a second (every ten seconds in a
        log)."""
        now, share = time.monotonic(), run.share
        self.pace.note(share)
        if now - self.shown < (0.5 if self.live else 10.0):
            return
        self.shown, self.shown_any = now, True
        left = "" if self.several else f", {time_left(self.pace.left_s(1.0 - share))}"
        line = f"{self.label}  static stage, t = {simulated_s:.2f} s{left}"
        if run.stage != "static":
            line = (
                f"{self.label}  {run.stage:8s} t = {simulated_s:6.2f} of {run.duration_s:.2f} s  "
                f"DI = {run.index:.3f}{left}"
            )
        room = shutil.get_terminal_size().columns - 1  # a line that is wider is not written over
        self._write(f"\r{line[:room]}\033[K" if self.live else f"{line}\n")

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
