"""One run from its command line to its pictures, whichever solver does it."""

import io
from contextlib import nullcontext, redirect_stdout

from damage.errors import InputError, RunError, warn
from damage.history.reader import read_history
from damage.measure.energy import ENERGY_FAILURE
from damage.memory import hold_buffers
from damage.run.checkpoint import checkpoint_path
from damage.run.cooperative import to_its_end
from damage.run.options import RUN_MEMBERS, parse_run
from damage.run.prepare import prepare
from damage.run.progress import attended
from damage.run.report import report
from damage.run.run import Run
from damage.run.scheme import check_energy
from damage.start import EXIT_INTERRUPTED, EXIT_OK, report_error


def run_session(backend, wall_file, make_wall, arguments, prog):
    """Run the wall that `make_wall()` returns, made by `wall_file`, with the words of a command
    line; returns the exit status: 0 done, 1 failed, 130 interrupted.  Raises what
    `damage.start.reported` prints."""
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
        show = backend.open_view() if settings.view else None
        return _run_to_its_pictures(prepare(backend, wall_file, make_wall, settings), show)


def with_errors_reported(name, run):
    """A run, as of `simulate`, whose errors are printed with its name and end no other; it returns
    the exit status."""
    try:
        return (yield from run)
    except Exception as error:
        return report_error(error, name)


def _run_to_its_pictures(prepared, show):
    settings = prepared.settings
    out = prepared.writer.path
    status = _status_of(prepared, show=show)
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


def history_of(prepared, settled=None):
    """The History of a Prepared run that steps alone; KeyboardInterrupt where it was interrupted;
    settled: as of Run."""
    if _status_of(prepared, settled) == EXIT_INTERRUPTED:
        raise KeyboardInterrupt
    return prepared.writer.history()


def _status_of(prepared, settled=None, show=None):
    """Run all stages of a Prepared run that steps alone; returns the exit status."""
    with attended(prepared.layout.wall.name, show, prepared.settings.quiet) as keep_going:
        return to_its_end(simulate(prepared, keep_going, settled))


def simulate(prepared, keep_going, settled=None):
    """Run all stages of a Prepared run, until one is accepted; the history is closed and marked
    however this ends.  A generator for `to_its_end`, which returns the exit status; settled: as of
    Run."""
    while True:
        try:
            return (yield from _simulate(prepared, keep_going, settled))
        except RunError as reason:
            if not prepared.repeats:
                raise
            prepared = prepared.repeated(reason)
            settled = None


def _simulate(prepared, keep_going, settled):
    layout = prepared.layout
    writer = prepared.writer
    status = "failed"
    collapsed = None
    try:
        solver = prepared.solver()
        run = Run(
            layout=layout,
            settings=prepared.settings,
            solver=solver,
            writer=writer,
            keep_going=keep_going,
            settled=settled,
            state=prepared.state,
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
        energy_error = run.sampler.energy_error
        if finished and prepared.repeats:
            check_energy(energy_error)
        if energy_error is not None and energy_error > ENERGY_FAILURE:
            raise RunError(
                f"energy balance error {100 * energy_error:.3g} % of the input, expected up to"
                f" {100 * ENERGY_FAILURE:g} %: the run has failed; give a smaller --dt, or look at"
                " the wall"
            )
        status = "complete" if finished else "interrupted"
        if finished and not (prepared.checkpoints.keeps_end and collapsed is None):
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
    prepared.writer.sink.add_parameters({"changed_by_hand": changed})
