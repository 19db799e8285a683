"""Run one wall in YADE from the command line of `yade walls/NAME.py`."""

import sys

import yade

from damage.errors import InputError
from damage.run.session import Backend, run_session
from yade_scripts.leaving import run_and_leave
from yade_scripts.shapes import BRICK_SHAPE, HAS_POLYHEDRA
from yade_scripts.solver import YadeSolver
from yade_scripts.view import open_view


def main(make_wall):
    """Run the wall that `make_wall()` returns with this command line's options, then leave YADE."""
    print(f"YADE {yade.config.version}, bricks are {BRICK_SHAPE}", flush=True)
    versions = {"yade": yade.config.version, "yade_bricks": BRICK_SHAPE}
    backend = Backend("yade", versions, YadeSolver, _check, open_view)
    run_and_leave(lambda: run_session(backend, make_wall, sys.argv[1:], prog=f"yade {sys.argv[0]}"))


def _check(settings):
    if settings.beta_s > 0:
        raise InputError(f"--beta {settings.beta_s:g}: YADE's joint law has no viscous damping; leave it "
                         "out, or use the reference solver: python3 -m damage reference")
    model = settings.model
    if model.joints == "centres" and not HAS_POLYHEDRA:
        raise InputError(f"--joints centres: needs polyhedra, which YADE {yade.config.version} was built without; "
                         "expected --joints face here, or YADE of Debian 12")
    if model.joints == "centres" and model.contacts != "interior":
        raise InputError(f"--joints centres with --contacts {model.contacts}: cells have their contact points inside; "
                         "expected --contacts interior, or --joints face")
