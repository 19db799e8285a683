"""Runs that another version of the model made: a study that goes on notices them, and makes them again where asked."""

import re
import shutil

from shared import ROOT

from damage.errors import InputError
from damage.history.head import read_head
from damage.provenance import model_digest
from damage.studies.tables import runs_there

CODE = {"reference": ROOT / "damage" / "reference", "yade": ROOT / "yade_scripts"}
"""Where each solver's own code lies."""
OLD = "one before 0.2"
_NAMED = 5  # runs that a message names


def of_other_versions(study, folder):
    """{path of a history: the model that made it} of the study's runs that are there and not of today's model."""
    found = {}
    for run in study.runs:
        today = f"{run.solver} {model_digest(CODE[run.solver])}"
        for path in histories(run, folder):
            made_by = model_of(path)
            if made_by not in (today, None):
                found[path] = made_by
    return found


def histories(run, folder):
    """Paths of the finished histories of a StudyRun, members of an ensemble whose last is not done included."""
    name = re.compile(re.escape(run.id) + (r"_s\d+" if run.is_ensemble else "") + r"\.h5")
    return sorted(path for path in (folder / "runs").glob(f"{run.id}*.h5") if name.fullmatch(path.name))


def model_of(path):
    """The solver and digest of the model's code that made a history; None of a file that is none, told elsewhere."""
    try:
        head = read_head(path)
    except InputError:
        return None
    return head.model if head else OLD


def describe(found, remake):
    """One line about such runs."""
    names = [path.stem for path in found]
    more = f" and {len(names) - _NAMED} more" if len(names) > _NAMED else ""
    what = "are made again" if remake else "are kept; --remake makes them again"
    return (f"{len(names)} runs were made by another version of the model ({', '.join(sorted(set(found.values())))}) "
            f"and {what}: {', '.join(names[:_NAMED])}{more}")


def discard(found, study, folder):
    """Take these histories away with all that was made of them, so that everything is made again: Snakemake misses no
    history while its tables are there."""
    gone = {path.stem for path in found}
    for run in study.runs:
        if run.is_ensemble and gone.intersection(runs_there(run, folder)):
            (folder / "runs" / f"{run.id}.members").unlink()
    for name in gone:
        shutil.rmtree(folder / "pictures" / name, ignore_errors=True)
        for table in (folder / "tables").glob(f"{name}_*"):
            table.unlink()
    if gone:
        (folder / "tables" / "summary.csv").unlink(missing_ok=True)
    for path in found:
        path.unlink()
