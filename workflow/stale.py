"""Stale results, made from other inputs than a study has now: found before a batch starts, and deleted.

runs/.inputs/RUN notes what the runs of a point were made from (`damage.studies.inputs`), of either solver.
"""

import hashlib
import json
import re
import shutil
from dataclasses import dataclass

from shards import point_of
from shared import ROOT, write_if_other

from damage.studies.definition import names_file
from damage.studies.inputs import as_note, differences, inputs_of
from damage.studies.tables import runs_there

_NAMED = 3  # points, and differences of each, that a message names
_NO_NOTE = "there is no note of them"
_FILE = re.compile(r"(.*?)(?:(?:\.part|\.differs)?\.h5|\.members)")
"""The name of a run, or of its point, in the name of a file that belongs to it."""


@dataclass(frozen=True)
class Stale:
    """inputs: {StudyRun: its Inputs}; changed: {StudyRun of other inputs than what is there: how they differ, words};
    unknown: single runs from before there were notes, which are kept."""

    inputs: dict
    changed: dict
    unknown: list

    @property
    def points(self):
        """Ids of the StudyRuns of which nothing that is there can stay."""
        return {run.id for run in self.changed}


def find_stale(study, folder):
    """The Stale of a study in its folder.  Raises InputError where a wall, an option or a record is bad."""
    inputs = {run: inputs_of(run, ROOT) for run in study.runs}
    found = {run: changes(run, inputs[run], folder) for run in study.runs}
    unknown = [run for run, changed in found.items()
               if changed == [_NO_NOTE] and not run.is_ensemble and runs_there(run, folder)]
    return Stale(inputs, {run: changed for run, changed in found.items() if changed and run not in unknown}, unknown)


def changes(run, inputs, folder):
    """How Inputs differ from those that a StudyRun was made from, a list of words; empty where they are equal."""
    try:
        text = _note(run, folder).read_text(encoding="utf-8")
    except FileNotFoundError:
        return [_NO_NOTE]
    if text == _digest_before(run):
        return []
    try:
        return differences(json.loads(text), inputs)
    except ValueError:
        return ["the note of them is of an older version, or damaged"]


def note(stale, folder):
    """Note what all points are made from: to be called when what is stale is no longer there, records included."""
    for run, inputs in stale.inputs.items():
        write_if_other(_note(run, folder), as_note(inputs))


def drop(stale, folder):
    """Take away all that was made of other inputs, but for records; returns warnings, a list of str."""
    dropped = [run for run in stale.changed if _drop(run, folder)]
    if dropped:
        (folder / "tables" / "summary.csv").unlink(missing_ok=True)
    return [f"{len(runs)} points {what}: {', '.join(map(words_of, runs[:_NAMED]))}"
            f"{f' and {len(runs) - _NAMED} more' if len(runs) > _NAMED else ''}" for runs, what, words_of in (
                (dropped, "were made from other inputs and are made again",
                 lambda run: f"{run.id} ({', '.join(stale.changed[run][:_NAMED])})"),
                (stale.unknown, "have no note of their inputs, being made by an older version, and are kept without a "
                 "comparison; delete a run's history to have it made again", lambda run: run.id)) if runs]


def _drop(run, folder):
    """Take away all that was made of a StudyRun but its records; returns whether there was anything."""
    paths = [path for path in (folder / "runs").glob(f"{run.id}*")
             if (name := _FILE.fullmatch(path.name)) and point_of(name[1]) == run.id]
    paths += [*(folder / "tables").glob(f"{run.first}_*"), *(folder / "tables" / "rows").glob(f"{run.id}.json")]
    for path in paths:
        path.unlink()
    shutil.rmtree(folder / "pictures" / run.first, ignore_errors=True)
    return bool(paths)


def _note(run, folder):
    return folder / "runs" / ".inputs" / run.id


def _digest_before(run):
    """What a note held before it named all inputs: a digest of words and files."""
    paths = [run.wall] + [word for option, word in zip(run.words, run.words[1:]) if names_file(option, word)]
    digests = [hashlib.sha256((ROOT / path).read_bytes()).hexdigest() for path in paths]
    return hashlib.sha256(json.dumps([run.wall, run.words, run.varied, digests]).encode()).hexdigest()
