"""The tables of a whole study, of whichever runs are there: one row a run, one row a point.

`python3 -m damage study-tables STUDY.toml DIR` writes below DIR/tables: summary.csv, a row for each
run, of a house for each of its walls, RUN:WALL; points.csv, a row for each point and solver, with
the median over its members under a measure's NAME and their range under NAME_min and NAME_max;
cycles.csv and shocks.csv, those of all runs.
Records (`damage.applications.studies.records`) are all that is asked of runs.
"""

import numpy as np
import pandas as pd

from damage.applications.studies.folder import command_of
from damage.applications.studies.records import TABLES, is_of_today, parts_of, read_records
from damage.applications.studies.spread import repeated
from damage.errors import InputError, some_of
from damage.history.schema import each
from damage.measure.columns import MADE_BY, OF_THE_FIRST, PARAMETERS, RUN
from damage.measure.tables import write_table


def summary_of(study, folder, records):
    """A DataFrame with a row for each run of the study that is there, of either solver, or for each
    wall of a house.

    records: of `read_records`.  `members` is how many runs there are of the row's point in its
    solver.
    """
    rows = [
        part["row"] | {"members": len(names)}
        for run in study.of_both
        for names in [records.names_of(run)]
        for name in names
        for part in parts_of(records.runs[name])
    ]
    if not rows:
        raise InputError(
            f"{folder} holds no run of the study {study.name}; run it first:"
            f" {command_of(study.path, folder, ['--solver', 'reference'])}"
        )
    if other := [row["run"] for row in rows if not is_of_today(row)]:
        raise InputError(
            f"{folder}: the index or measures of {len(other)} runs are defined as in another"
            f" version: {some_of(other)}; expected one definition in a table; run the study again,"
            " which works them out of histories"
        )
    table = pd.DataFrame(rows)
    table.insert(table.columns.get_loc("solver") + 1, "members", table.pop("members"))
    return table


def points_of(summary):
    """A row for each point and solver of a summary: what its runs share, medians and ranges of what
    they do not.

    `status` is complete when all runs are, `collapsed` counts those that collapsed, `repeated`
    those that were repeated in smaller steps, and `collapsed_at_s` is the median of the collapses
    where they are half of the runs or more. Words, as of classes, are the most frequent.
    """
    return pd.DataFrame(
        [_point(runs) for _, runs in summary.groupby(["point", "solver"], sort=False)]
    )


def _point(runs):
    fallen = runs["collapsed_at_s"].astype(float).dropna()
    row = {}
    for name in filter(runs.__contains__, each(PARAMETERS)):
        if runs[name].nunique(dropna=False) == 1 or name == OF_THE_FIRST:
            row[name] = runs[name].iloc[0]
        else:  # as of the motions of lives
            row |= _spread(name, runs[name]) or {name: None}
    ended = runs["status"] == "complete"
    row |= {
        "members": len(runs),
        "status": "complete" if ended.all() else runs.loc[~ended, "status"].iloc[0],
        "collapsed": len(fallen),
        "collapsed_at_s": fallen.median() if 2 * len(fallen) >= len(runs) else None,
        "repeated": repeated(runs),
    }
    row |= {name: "; ".join(sorted(set(runs[name].dropna()))) for name in MADE_BY if name in runs}
    for name in runs.columns.difference([*row, *RUN], sort=False):
        row |= _spread(name, runs[name]) or {name: runs[name].mode().iloc[0]}
    return row


def _spread(name, values):
    """Median and range of the numbers in a column; {} where there are words."""
    values = values.dropna()
    if not all(isinstance(value, (int, float, np.number)) for value in values):
        return {}
    numbers = values.astype(float)
    return {name: numbers.median(), f"{name}_min": numbers.min(), f"{name}_max": numbers.max()}


def write_study_tables(study, folder):
    """Write summary.csv and points.csv of what there is; returns their paths, the summary last;
    arguments as of `summary_of`."""
    records = read_records(folder)
    summary = summary_of(study, folder, records)
    tables = folder / "tables"
    tables_of = {
        part["row"]["run"]: part for record in records.runs.values() for part in parts_of(record)
    }
    paths = [write_table(points_of(summary), tables / "points.csv")]
    for name in TABLES:
        rows = [{"run": run, **row} for run in summary["run"] for row in tables_of[run][name]]
        if rows:
            paths.append(write_table(pd.DataFrame(rows), tables / f"{name}.csv"))
    return [*paths, write_table(summary, tables / "summary.csv")]
