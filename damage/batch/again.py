"""One run of a study made again, whose history was not kept: to the values of its record, or it says otherwise."""

import sys

import pandas as pd

from damage.batch.folder import ROOT
from damage.batch.outdated import other_versions
from damage.batch.tasks import Task
from damage.errors import InputError, some_of, warn
from damage.history.reader import read_history
from damage.history.schema import each
from damage.measure.columns import MADE_BY
from damage.measure.tables import summary_row
from damage.studies.inputs import as_json, inputs_of


def make_again(name, study, results, simulate):
    """Make the history of one run of a study, which is not there; returns the exit status: 1 where the run fails, or
    its values are not those of its record.  Raises InputError where it would not be the same run.

    results: `damage.batch.outdated.Results` of its folder; simulate(Task, inputs): does it, returns the exit status;
    inputs: as of `damage.batch.worker.work`.
    """
    found = {run.name(number): (run, number) for run in study.runs for number in range(1, run.most_members + 1)}
    if name not in found:
        raise InputError(f"--run {name}: no run of the study {study.name} with this solver; expected a name from the "
                         "column run of tables/summary.csv")
    run, number = found[name]
    history = results.folder / "runs" / f"{name}.h5"
    if name in results.histories:
        raise InputError(f"--run {name}: {history} is there; expected one that is not, delete it first")
    record = results.records.runs.get(name, {})
    key = record.get("inputs") or results.records.points.get(run.id)
    inputs = inputs_of(run, ROOT)
    changed = results.changes(run, inputs, key)
    if changed:
        raise InputError(f"--run {name}: its inputs are not those that the table was made from: "
                         f"{some_of(changed)}; expected the same, restore them, or run the study again")
    row = record.get("row")
    if row is None:
        warn(f"--run {name}: no record of it in {results.folder}: its values are not compared")
    warn(*(f"--run {name}: {warning}" for warning in other_versions(row, run.solver)))
    status = simulate(Task(results.folder, run, number, True), {run.id: as_json(inputs)})
    if status != 0 or row is None:
        return status
    differing = differing_columns(row, summary_row(read_history(history), run=name, point=run.point))
    if not differing:
        print(f"{name}: the values are those of its record")
        return 0
    aside = history.with_name(f"{name}.differs.h5")
    history.rename(aside)
    print(f"error: --run {name}: {len(differing)} columns are not those of its record: "
          f"{some_of(differing)}; the history is {aside}", file=sys.stderr)
    return 1


def differing_columns(row, new):
    """The columns in which the row of a record and a new one differ, a list of "NAME 0.94 -> 1"; those that say what
    made them do not count."""
    return [f"{name} {_word(row[name]) or 'empty'} -> {_word(value) or 'empty'}" for name, value in new.items()
            if name in row and name not in each(MADE_BY) and _word(row[name]) != _word(value)]


def _word(value):
    """A value with the digits that tables have."""
    return "" if pd.isna(value) else f"{value:.9g}" if isinstance(value, float | int) else str(value)
