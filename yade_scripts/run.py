"""Run one wall in YADE from the command line of `yade walls/NAME.py`."""

import sys
from pathlib import Path

import yade

from damage.errors import InputError
from damage.run.session import Backend, run_session
from damage.wall.file import wall_of
from yade_scripts.leaving import run_and_leave
from yade_scripts.solver import YadeSolver
from yade_scripts.view import open_view


def main(make_wall):
    """Run the wall that `make_wall()` returns with this command line's options, then leave YADE."""
    path = Path(sys.argv[0])
    backend = Backend("yade", {"yade": yade.config.version}, YadeSolver, Path(__file__).parent, _check, open_view)
    run_and_leave(lambda: run_session(backend, path, lambda: wall_of(make_wall, path), sys.argv[1:],
                                      prog=f"yade {path}"))


def _check(settings):
    if settings.beta_s > 0:
        raise InputError(f"--beta {settings.beta_s:g}: YADE's joint law has no viscous damping; leave it "
                         "out, or use the reference solver: python3 -m damage reference")
