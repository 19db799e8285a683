"""Runs that another version of the model made: a resumed study detects them, and makes them again on request."""

import re
import shutil
from pathlib import Path

from shards import point_of
from shared import ROOT

import damage.reference
from damage.errors import InputError
from damage.history.head import read_head
from damage.provenance import model_digest
from damage.studies.records import all_records, is_of_today
from damage.studies.tables import refuse_other_measures, runs_there

CODE = {"reference": Path(damage.reference.__file__).parent, "yade": ROOT / "yade_scripts"}
"""Where each solver's own code lies; an installed package is without YADE's."""
OLD = "one before 0.2"
_NAMED = 5  # runs that a message names


def of_other_versions(study, folder):
    """{name of a run: the model that made it} of the study's runs that are there and not of today's model."""
    made_by, mine = {}, {run.id for run in study.runs}
    for name, record in all_records(folder).items():
        if point_of(name) in mine:
            made_by[name] = f"{record['row']['solver']} {record['row']['model_digest']}"
    for path in [path for run in study.runs for path in histories(run, folder)]:
        made_by[path.stem] = model_of(path)
    return {name: model for name, model in made_by.items() if model not in (_today(model), None)}


def _today(model):
    """Today's model of the solver that made a run; None where its code is not here.  Digests take their time: none is
    made for a study of which nothing is there yet."""
    solver = (model or "").partition(" ")[0]
    return f"{solver} {model_digest(CODE[solver])}" if solver in CODE and CODE[solver].is_dir() else None


def of_other_measures(study, folder, remake, stale=frozenset()):
    """Names of the study's runs whose index and measures are those of another version, and which left no history to
    work them out of anew: to be made again where asked, otherwise InputError.

    stale: ids of points that are made again anyway.
    """
    mine = {run.id for run in study.runs} - stale
    rows = {name: record["row"] for name, record in all_records(folder).items() if point_of(name) in mine}
    if not remake:
        refuse_other_measures(rows, folder)
    return [name for name, row in rows.items()
            if not is_of_today(row) and not (folder / "runs" / f"{name}.h5").is_file()]


def histories(run, folder):
    """Paths of the finished histories of a StudyRun, members of an ensemble whose last is not done included."""
    name = re.compile(re.escape(run.id) + (r"_s\d+" if run.is_ensemble else "") + r"\.h5")
    return sorted(path for path in (folder / "runs").glob(f"{run.id}*.h5") if name.fullmatch(path.name))


def model_of(path):
    """The solver and digest of the model's code that made a history; None of a file that is no history."""
    try:
        head = read_head(path)
    except InputError:
        return None
    return head.model if head else OLD


def describe(found, remake):
    """One line about such runs."""
    names = list(found)
    more = f" and {len(names) - _NAMED} more" if len(names) > _NAMED else ""
    what = "are made again" if remake else "are kept; --remake makes them again"
    return (f"{len(names)} runs were made by another version of the model ({', '.join(sorted(set(found.values())))}) "
            f"and {what}: {', '.join(names[:_NAMED])}{more}")


def discard(found, study, folder):
    """Take the histories of these runs away with all that was made of them, but for their records, so that everything
    is made again: Snakemake misses no history while its tables are there."""
    gone = set(found)
    for run in study.runs:
        if run.is_ensemble and gone.intersection(runs_there(run, folder)):
            (folder / "runs" / f"{run.id}.members").unlink()
    for name in gone:
        shutil.rmtree(folder / "pictures" / name, ignore_errors=True)
        for table in (folder / "tables").glob(f"{name}_*"):
            table.unlink()
    if gone:
        (folder / "tables" / "summary.csv").unlink(missing_ok=True)
    for name in gone:
        (folder / "runs" / f"{name}.h5").unlink(missing_ok=True)
