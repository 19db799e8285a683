"""Command `python3 -m damage reference WALL.py [MOTION] [OPTIONS]`: a run in the reference solver."""

import sys
from pathlib import Path

import numba

from damage.errors import one_line
from damage.provenance import shown_path
from damage.reference.members import run_members
from damage.reference.solver import ReferenceSolver
from damage.run.session import EXIT_INPUT, Backend, reported, run_session
from damage.run.settings import SELECTIVE, Softening
from damage.wall.file import load_wall, wall_path

PROG = "python3 -m damage reference"


def _make(layout, time_step, settings):
    """The ReferenceSolver of a Layout and RunSettings."""
    return ReferenceSolver(layout, time_step, beta=settings.beta_s, new_contacts=settings.new_contacts,
                           scaled=settings.mass_scaling == SELECTIVE)


BACKEND = Backend("reference", {"numba": numba.__version__}, _make, Path(__file__).parent, softening=Softening(),
                  run_members=run_members)


def run_reference(arguments):
    """Run the command with these words, the wall first (a file, or the name of a wall that ships); returns the exit
    status."""
    wall, *options = arguments or ["--help"]
    if wall.startswith("-") and wall not in ("-h", "--help"):
        print(f"error: {one_line(wall)} comes where a wall file should; give {PROG} WALL.py [OPTIONS]",
              file=sys.stderr)
        return EXIT_INPUT
    if wall.startswith("-"):
        return run_session(BACKEND, "", lambda: None, ["--help"], prog=f"{PROG} WALL")
    return reported(lambda: run_session(BACKEND, wall_path(wall), lambda: load_wall(wall), options,
                                    prog=f"{PROG} {shown_path(wall)}"))
