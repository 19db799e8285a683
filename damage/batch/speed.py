"""How fast the reference solver is on this machine: measured once, in about a second, and kept beside its machine
code.

What counts is the processor's time, and the least of several pieces: eight other programs a processor made it 1.6 times
as long.
"""

import json
import platform
import time
import timeit
from contextlib import suppress
from typing import NamedTuple

from llvmlite.binding import get_host_cpu_name

from damage.files import write_text
from damage.mechanics.compiled import DIGEST, is_cached, kept_in
from damage.reference.lanes import MOST_LANES, run_together
from damage.reference.solver import ReferenceSolver
from damage.wall.layout import lay_out
from damage.wall.parameters import Wall

PIECES, STEPS = 7, 300


class Speed(NamedTuple):
    """Nanoseconds of one processor a contact point, step and wall, of a wall alone and of eight that step together."""

    alone_ns: float
    together_ns: float


def speed():
    """The Speed of this machine, measured where it is not known; None where the solver is not compiled yet."""
    if not is_cached():
        return None
    path = kept_in() / f"speed-{DIGEST}-{platform.node()}-{get_host_cpu_name()}.json"
    try:
        return Speed(**json.loads(path.read_text(encoding="utf-8")))
    except (OSError, ValueError, TypeError):  # not there, or not of this form
        found = Speed(_measure(1), _measure(MOST_LANES))
    with suppress(OSError):  # it is measured again the next time
        write_text(path, json.dumps(found._asdict()))
    return found


def _measure(n_walls):
    """Nanoseconds a contact point, step and wall of so many walls at rest."""
    layout = lay_out(Wall("speed", length=2.7, height=2.1))
    walls = [ReferenceSolver(layout, 1e-6) for _ in range(n_walls)]
    run_together(walls, 1)  # loads what is compiled
    seconds = _least_seconds(lambda: run_together(walls, STEPS), PIECES)
    return 1e9 * seconds / (STEPS * n_walls * len(layout.contacts))


def python_seconds():
    """Seconds of the processor that a fixed piece of Python takes, by which compiling is foreseen."""
    return _least_seconds(lambda: sorted(str(number * number % 7919) for number in range(40_000)), 5)


def _least_seconds(piece, pieces):
    return min(timeit.repeat(piece, timer=time.process_time, repeat=pieces, number=1))
