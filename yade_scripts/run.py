"""Run of one wall in YADE by the command line `./yade walls/NAME.py`."""

from damage.memory import YADE
from damage.start import begin

begin(YADE)  # before the slow imports

import sys
from pathlib import Path

from damage.errors import InputError
from damage.start import EXIT_MISSING, missing_library

FIBRES = 16
"""Default number of parallel elements of a softening joint (docs/model/model.md)."""
BRICK_CELLS = 4
"""Default number of cells of a deformable brick (docs/model/yade.md)."""


def main(make_wall):
    """Run the wall that `make_wall()` returns with this command line's options, then leave YADE."""
    path = Path(sys.argv[0])
    try:
        from yade_scripts.leaving import run_and_leave
    except ImportError as error:
        if error.name != "yade":
            raise
        print(f"error: {path} is run by YADE, not by {sys.executable}: expected yade {path} [OPTIONS], or in the "
              f"built-in solver python3 -m damage reference {path} [OPTIONS]", file=sys.stderr)
        sys.exit(EXIT_MISSING)
    run_and_leave(lambda: _run(make_wall, path))


def _run(make_wall, path):
    """Exit status of a run of the wall of the file at `path`.

    Libraries are imported here, so that a missing one gives a message instead of a traceback.
    """
    try:
        import yade

        from damage.provenance import shown_path
        from damage.run.session import Backend, run_session
        from damage.run.settings import Softening
        from damage.wall.file import wall_of
        from yade_scripts.shapes import BRICK_SHAPE
        from yade_scripts.solver import YadeSolver
        from yade_scripts.view import open_view
    except ImportError as error:
        if not missing_library(error):
            raise
        print(f"error: {missing_library(error)}", file=sys.stderr)
        return EXIT_MISSING
    if "--quiet" not in sys.argv:
        print(f"YADE {yade.config.version}, bricks are {BRICK_SHAPE}", flush=True)
    versions = {"yade": yade.config.version, "yade_bricks": BRICK_SHAPE}

    def make(layout, time_step, settings):
        return YadeSolver(layout, time_step, settings.new_contacts)

    backend = Backend("yade", versions, make, Path(__file__).parent, _check, open_view,
                      Softening(fibres=FIBRES, beta_s=0.0), BRICK_CELLS, keeps_state=False)
    return run_session(backend, path, lambda: wall_of(make_wall, path), sys.argv[1:], prog=f"yade {shown_path(path)}")


def _check(settings):
    if settings.model.soil_velocity:
        raise InputError(f"--soil-velocity {settings.model.soil_velocity:g}: YADE's joint law has no viscous damping; "
                         "leave it out, or use the reference solver: python3 -m damage reference")
    if settings.beta_s > 0:
        raise InputError(f"--beta {settings.beta_s:g}: YADE's joint law has no viscous damping; leave it "
                         "out, or use the reference solver: python3 -m damage reference")
