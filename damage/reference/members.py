"""Ensemble members of a single run: runs with slightly scattered strengths that advance together."""

import io
import sys
from contextlib import nullcontext, redirect_stderr, redirect_stdout
from dataclasses import replace
from pathlib import Path

from damage.errors import warn
from damage.history.in_memory import HistoryInMemory, HistoryKept
from damage.measure.energy import balance_error
from damage.measure.tables import members_path, write_members
from damage.measure.warnings import energy_warnings
from damage.reference.ensembles import Ensemble
from damage.reference.lanes import MOST_LANES
from damage.run.options import free_name
from damage.run.report import report
from damage.run.session import EXIT_INTERRUPTED, EXIT_OK, attended, prepare, simulate, with_errors_reported
from damage.run.turns import take_turns


def run_members(backend, wall_file, make_wall, settings):
    """Run all members of a run, up to eight at a time; returns the exit status.

    settings: RunSettings; other arguments as of `damage.run.session.run_session`.  The history of the first member is
    the file of the run, with the table of all members beside it (`damage.measure.tables`).  Histories of other members
    are discarded, unless they failed or were interrupted: then they are in FILE_sSEED.h5.  After an
    interruption the table is of the members that had ended.  The exit status is that of
    the first member where it failed, else the largest of all.
    """
    out = Path(settings.out or free_name(make_wall(), settings, backend.name))
    members = settings.of_members()
    names = [out, *(out.with_name(f"{out.stem}_s{one.seed}{out.suffix}") for one in members[1:])]
    statuses, ended = [], {}
    for first in range(0, len(members), MOST_LANES):
        group = [_prepare(backend, wall_file, make_wall, one, path, HistoryKept if path == out else HistoryInMemory)
                 for one, path in zip(members[first:first + MOST_LANES], names[first:])]
        if first == 0:
            members_path(out).unlink(missing_ok=True)  # of the run that this one replaces
        with attended(f"{group[0].layout.wall.name}, {len(members)} members", quiet=settings.quiet) as keep_going:
            statuses += take_turns([with_errors_reported(f"member of seed {one.settings.seed}: ",
                                                         simulate(one, keep_going))
                                    for one in group], Ensemble().move)
        ended |= {one.writer.path: one.writer.history() for one, status in zip(group, statuses[first:])
                  if status == EXIT_OK}
        if EXIT_INTERRUPTED in statuses:
            print(f"interrupted: {len(ended)} of {len(members)} members had ended", file=sys.stderr)
            break
    if out not in ended:
        return max(statuses[0], EXIT_INTERRUPTED * (EXIT_INTERRUPTED in statuses))
    print(f"members: {write_members(list(ended.values()), out)}")
    for path in ended.keys() - {out}:
        path.unlink(missing_ok=True)  # written where a history outgrew the memory
    warn(*(f"member of seed {history.parameters['seed']}: {text}" for path, history in ended.items() if path != out
           for text in energy_warnings(balance_error(history))))
    report(ended[out], pictures=settings.pictures)
    if len(ended) < len(members):
        print(f"{len(ended)} of {len(members)} members ended: median and range are of these")
    return max(statuses)


def _prepare(backend, wall_file, make_wall, settings, path, write):
    """Prepared run of a member; only the first one prints its opening lines."""
    settings, is_first = replace(settings, out=path), write is HistoryKept
    with nullcontext() if is_first else redirect_stdout(io.StringIO()), \
            nullcontext() if is_first else redirect_stderr(io.StringIO()):
        return prepare(backend, wall_file, make_wall, settings, write)
