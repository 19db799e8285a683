"""Which results of a study are those of today: the one rule for done, made again and another
version.

A result is of today where its point has the inputs, its solver the model and the tables the
measures that its record names.  Other inputs make the runs of a point again.  Another model keeps
runs, and names them, unless they are to be made again.  Other measures are worked out of the
history, or refused where it was not kept.
"""

import shutil
from collections import defaultdict
from pathlib import Path
from typing import NamedTuple

from damage.applications.cracks.at_rest import ENDING, FOLDER
from damage.applications.studies.folder import ROOT
from damage.applications.studies.inputs import as_json, differences, inputs_of
from damage.applications.studies.records import (
    NAME,
    is_of_today,
    key_of,
    parts_of,
    point_line,
    point_of,
    read_records,
)
from damage.errors import InputError, some_of
from damage.files import write_text
from damage.provenance import model_digest
from damage.wall.as_built import replaced_lintels

CODE = {"reference": Path(__file__).parents[2] / "reference", "yade": ROOT / "yade_scripts"}
"""Where each solver's own code lies."""
FIRST_TABLES = "index", "events", "joints", "cycles"
"""Tables of the first run of a point where all histories are kept; of sequences shocks, too."""
_DIFFERENCES = 3  # points, and differences of each, that a message names


class Verdict(NamedTuple):
    """inputs: {StudyRun: (key, its inputs as JSON)}; changed: {StudyRun of other inputs: how they
    differ, words}; models: {name of a run: the other model that made it}; measures: names of runs
    of other measures; lintels: what options replace of walls' lintels, {line: None}."""

    inputs: dict
    changed: dict
    models: dict
    measures: list
    lintels: dict


class Results:
    """What is there of a study in its folder: records, and {name: path} of whole histories."""

    def __init__(self, folder):
        self.folder = folder
        self.records = read_records(folder)
        self.histories = {}
        self._files = defaultdict(list)  # {name of a run: its files}, unfinished ones included
        for path in sorted((folder / "runs").glob("*.h5")):
            self._files[path.stem.removesuffix(".part")].append(path)
            if not path.stem.endswith((".part", ".differs")):
                self.histories[path.stem] = path

    def judge(self, runs):
        """The Verdict on StudyRuns.  Raises InputError where a wall, an option or a record is
        bad."""
        verdict = Verdict({}, {}, {}, [], {})
        histories = defaultdict(list)
        for name in sorted({*self.records.runs, *self.histories}):
            histories[point_of(name)].append(name)
        for run in runs:
            inputs = inputs_of(run, ROOT)
            names = histories[run.id]
            for wall in inputs.wall.each_wall:
                replaced = replaced_lintels(wall, inputs.settings.model.lintel)
                verdict.lintels.update(dict.fromkeys(replaced))
            content = as_json(inputs)
            verdict.inputs[run] = key_of(content), content
            differing = list(
                dict.fromkeys(
                    change
                    for key in {self._key(name) for name in names}
                    for change in self._changes(inputs, key)
                )
            )
            if differing:
                verdict.changed[run] = differing
                continue
            for name in self.records.runs.keys() & names:
                row = self.records.runs[name]["row"]
                code = CODE[row["solver"]]
                # an installed package is without YADE's
                if code.is_dir() and row["model_digest"] != model_digest(code):
                    verdict.models[name] = f"{row['solver']} {row['model_digest']}"
                if not is_of_today(row):
                    verdict.measures.append(name)
        return verdict

    def _key(self, name):
        """The key of the inputs that a run was made from; None where nothing says it."""
        if name in self.records.runs:
            return self.records.runs[name]["inputs"]
        return self.records.points.get(point_of(name))

    def _changes(self, inputs, key):
        """How Inputs differ from those with this key, a list of words; empty where they are
        equal."""
        then = self.records.inputs.get(key)
        return ["there is no note of them"] if then is None else differences(then, inputs)

    def bring_up_to_date(self, verdict, remake=False):
        """Take away what is to be made again; returns warnings, a list of str.

        remake: runs of another model, and of other measures without a history, too; otherwise the
        latter raise InputError, before anything is done.
        """
        lost = [name for name in verdict.measures if name not in self.histories]
        if lost and not remake:
            raise InputError(
                f"{self.folder}: the index or measures of {len(lost)} runs are defined as in"
                f" another version, and their histories were not kept: {some_of(lost)}; expected"
                " one definition in a table, give --remake to make these runs again, or continue"
                " with the version that made them"
            )
        changed = {run.id for run in verdict.changed}
        gone = [name for name in {*self.records.runs, *self._files} if point_of(name) in changed]
        for name in [*gone, *lost, *(verdict.models if remake else ())]:
            self._remove(name)
        for name in verdict.measures:
            self._forget(name)
        # tables of the whole have rows that are gone
        if gone or verdict.measures or (remake and verdict.models):
            for name in ("summary.csv", "points.csv"):
                (self.folder / "tables" / name).unlink(missing_ok=True)
        return [*self.records.faults, *_warnings(verdict, remake)]

    def _remove(self, name):
        """Take away all that was made of a run."""
        for path in (
            *self._files.pop(name, []),
            *(self.folder / "tables").glob(f"{name}_*.csv"),
            *(self.folder / FOLDER).glob(f"{name}{ENDING}"),
        ):
            path.unlink()
        shutil.rmtree(self.folder / "pictures" / name, ignore_errors=True)
        self._forget(name)
        self.histories.pop(name, None)

    def _forget(self, name):
        """Take the record of a run away."""
        self.records.runs.pop(name, None)

    def lines_of(self, verdict):
        """Today's inputs of points, as a slice writes them before its records."""
        return "".join(
            point_line(run.id, key, inputs)
            for run, (key, inputs) in verdict.inputs.items()
            if self.records.points.get(run.id) != key
        )

    def write(self, verdict):
        """Write the one file of records, with today's inputs of all points, where it does not hold
        just this; files of slices go."""
        for run, (key, inputs) in verdict.inputs.items():
            self.records.points[run.id] = key
            self.records.inputs[key] = inputs
        path = self.folder / NAME
        text = self.records.text()
        if not path.is_file() or path.read_text("utf-8", "replace") != text:
            write_text(path, text)
        for path in self.folder.glob("records-*.jsonl"):
            path.unlink()

    def is_whole(self, task):
        """Whether all that a run leaves is there, its record included."""
        record = self.records.runs.get(task.name)
        if record is None or (task.keeps_history and task.name not in self.histories):
            return False
        if task.patterns and not ("patterns" in record and task.pattern.is_file()):
            return False
        return not task.tables or all(
            (self.folder / "tables" / f"{name}_{table}.csv").is_file()
            for part in parts_of(record)
            for name in [part["row"]["run"].replace(":", "_")]
            for table in FIRST_TABLES
        )


def _warnings(verdict, remake):
    """What a Verdict has to say: a list of str."""
    warnings = list(verdict.lintels)
    if verdict.changed:
        warnings.append(
            f"{len(verdict.changed)} points were made from other inputs and are made again: "
            + some_of(
                [
                    f"{run.id} ({', '.join(differences[:_DIFFERENCES])})"
                    for run, differences in verdict.changed.items()
                ],
                _DIFFERENCES,
            )
        )
    if verdict.models:
        what = "are made again" if remake else "are kept; --remake makes them again"
        warnings.append(
            f"{len(verdict.models)} runs were made by another version of the model"
            f" ({', '.join(sorted(set(verdict.models.values())))}) and {what}:"
            f" {some_of(list(verdict.models))}"
        )
    return warnings
