"""Run one wall in YADE from the command line: options, stages, history, summary, pictures."""

import os
import signal
import sys
import traceback

import yade
from yade import O

from damage.errors import InputError
from damage.history import HistoryWriter, check_output
from damage.layout import lay_out
from damage.modes import natural_modes
from damage.options import SETTLE_S, free_name, parse_run
from damage.progress import Progress
from damage.report import report
from yade_scripts.simulation import Simulation, choose_time_step
from yade_scripts.view import open_view

EXIT_OK, EXIT_FAILED, EXIT_INPUT, EXIT_INTERRUPTED = 0, 1, 2, 130


def main(make_wall):
    """Run the wall that `make_wall()` returns with this command line's options, then leave YADE.

    Exit status: 0 done, 1 failed, 2 bad input, 130 interrupted.
    """
    status = EXIT_FAILED
    try:
        status = _run(make_wall, sys.argv[1:])
    except InputError as error:
        print(f"error: {error}", file=sys.stderr)
        status = EXIT_INPUT
    except SystemExit as exit_:  # --help
        status = exit_.code or EXIT_OK
    except KeyboardInterrupt:
        status = EXIT_INTERRUPTED
    except Exception:
        traceback.print_exc()
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        # YADE would open its prompt here; its threads make an orderly exit slow and unsafe.
        os._exit(status)


def _run(make_wall, arguments):
    settings = parse_run(arguments, prog=f"yade {sys.argv[0]}", solver="yade")
    if settings.beta_s > 0:
        raise InputError(f"--beta {settings.beta_s:g}: YADE's joint law has no viscous damping; "
                         "leave it out")
    wall = make_wall()
    out = settings.out or free_name(wall, settings, "yade")
    check_output(out, settings.overwrite)
    layout = lay_out(wall, settings.model)
    modes = natural_modes(layout)
    time_step = choose_time_step(settings, modes.critical_time_step_s)
    _announce(layout, settings, modes, time_step)
    parameters = {"wall": wall.describe(), **settings.describe(), "time_step_s": time_step,
                  "critical_time_step_s": modes.critical_time_step_s,
                  "eigen_period_s": float(modes.period_s[0])}
    show = open_view() if settings.view else None
    writer = HistoryWriter(out, layout, solver="yade", parameters=parameters,
                           versions={"yade": yade.config.version}, overwrite=settings.overwrite)
    print(f"history: {out}", flush=True)
    status = _simulate(layout, settings, modes, time_step, writer, show)
    report(out, pictures=settings.pictures and status == EXIT_OK)
    return status


def _announce(layout, settings, modes, time_step):
    wall = layout.wall
    print(f"wall {wall.name}: {wall.length:.3f} x {wall.built_height:.3f} m, {wall.courses} courses, "
          f"{layout.n_bricks} bricks, {layout.n_joints} contact points on "
          f"{layout.total_joint_length:.2f} m of joints\n"
          f"first period by eigenvalue {modes.period_s[0]:.4f} s; time step {time_step:.4g} s "
          f"({time_step / modes.critical_time_step_s:.2f} of the critical)\n"
          f"motion: {settings.loading.name}", flush=True)


def _simulate(layout, settings, modes, time_step, writer, show):
    """Run all stages; the history is closed and marked however this ends."""
    stop = _InterruptFlag()
    duration = settings.loading.duration_s + settings.rest_s + SETTLE_S
    progress = Progress(layout.wall.name, duration)

    def keep_going(time_s, recorder):
        progress.show(0.0 if recorder.stage == "static" else time_s, recorder.stage, recorder.index)
        if show:
            show()
        return not stop.asked

    status, collapsed = "failed", None
    try:
        simulation = Simulation(layout, settings, time_step, writer, keep_going)
        finished = simulation.settle_under_gravity()
        if finished:
            simulation.start(modes.shape[0])
            finished = simulation.run_all()
        collapsed = simulation.recorder.collapsed_at_s
        status = "complete" if finished else "interrupted"
    finally:
        progress.close()
        writer.finish(status, collapsed)
    return EXIT_OK if status == "complete" else EXIT_INTERRUPTED


class _InterruptFlag:
    """Ctrl-C and a polite kill end the run after the current chunk of steps."""

    def __init__(self):
        self.asked = False
        for name in (signal.SIGINT, signal.SIGTERM):
            signal.signal(name, self._ask)

    def _ask(self, *_):
        self.asked = True
