"""`python3 -m damage reference WALL.py [MOTION] [OPTIONS]`: a run in the built-in solver."""

import sys

import numba

from damage.reference.run import ReferenceRun
from damage.reference.wall import choose_time_step
from damage.run.session import EXIT_INPUT, Solver, run_session
from damage.wall.file import load_wall

PROG = "python3 -m damage reference"
SOLVER = Solver("reference", {"numba": numba.__version__}, lambda settings: None, choose_time_step, ReferenceRun)


def run_reference(arguments):
    """Run with the words of a command line, the wall file first; returns the exit status."""
    wall, *options = arguments or ["--help"]
    if wall.startswith("-") and wall not in ("-h", "--help"):
        print(f"error: {wall} comes where a wall file should; give {PROG} walls/NAME.py [OPTIONS]",
              file=sys.stderr)
        return EXIT_INPUT
    if wall.startswith("-"):
        wall, options = "walls/NAME.py", ["--help"]
    return run_session(SOLVER, lambda: load_wall(wall), options, prog=f"{PROG} {wall}")
