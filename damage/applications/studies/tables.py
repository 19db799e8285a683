"""The tables of a whole study, of whichever runs are there: one row a run, one row a point.

`python3 -m damage study-tables STUDY.toml DIR` writes below DIR/tables: summary.csv, a row for each
run; points.csv, a row for each point and solver, with the median over its members under a measure's
NAME and their range under NAME_min and NAME_max; study.h5, both of them as HDF5; cycles.csv and
shocks.csv, those of all runs.
Records (`damage.applications.studies.records`) are all that is asked of runs; the row of a run
without one comes from its history.
"""

import io
from concurrent.futures import ProcessPoolExecutor
from contextlib import nullcontext

import h5py
import numpy as np
import pandas as pd

from damage.applications.studies.folder import command_of, way_on
from damage.applications.studies.records import TABLES, is_of_today, read_records
from damage.errors import InputError, some_of
from damage.files import whole_or_nothing
from damage.history.reader import read_history
from damage.history.schema import each
from damage.measure.columns import MADE_BY, PARAMETERS, RUN
from damage.measure.tables import repeated, summary_row, write_table


def histories_in(folder):
    """{name of a run: path} of the histories of a study's folder that are whole."""
    return {
        path.stem: path
        for path in sorted((folder / "runs").glob("*.h5"))
        if not path.stem.endswith((".part", ".differs"))
    }


def row_of(path, name, point):
    """The summary's row of a run that left no record, from its history."""
    return summary_row(read_history(path), run=name, point=point)


def refuse_other_measures(rows, histories, folder):
    """Raise InputError for rows {name of a run: row} that another version's index and measures
    made, and whose histories are not there to make others: a table has one definition."""
    lost = [name for name, row in rows.items() if not is_of_today(row) and name not in histories]
    if lost:
        file, options = way_on(folder) or ("STUDY.toml", [])
        raise InputError(
            f"{folder}: the index or measures of {len(lost)} runs are defined as in another"
            f" version, and their histories were not kept: {some_of(lost)}; expected one definition"
            " in a table, give --remake to make these runs again, or continue with the version"
            f" that made them: {command_of(file, folder, [*options, '--remake'])}"
        )


def summary_of(study, folder, jobs=1, records=None):
    """A DataFrame with a row for each run of the study that is there, of either solver.

    records: of `read_records`, where they are read already.  `members` is how many runs there are
    of the row's point in its solver.
    """
    records, histories = records or read_records(folder), histories_in(folder)
    there = [
        (name, run.point, members)
        for run in study.of_both
        for members in [records.names_of(run, histories)]
        for name in members
    ]
    if not there:
        raise InputError(
            f"{folder} holds no run of the study {study.name}; run it first:"
            f" {command_of(study.path, folder, ['--solver', 'reference'])}"
        )
    rows = {name: records.runs[name]["row"] for name, *_ in there if name in records.runs}
    refuse_other_measures(rows, histories, folder)
    rows = {name: row for name, row in rows.items() if is_of_today(row)}
    others = [(histories[name], name, point) for name, point, _ in there if name not in rows]
    with ProcessPoolExecutor(jobs) if jobs > 1 and len(others) > 8 else nullcontext() as pool:
        rows |= zip(
            (name for _, name, _ in others),
            (pool.map if pool else map)(row_of, *zip(*others)) if others else (),
        )
    table = pd.DataFrame([rows[name] for name, *_ in there])
    table.insert(
        table.columns.get_loc("solver") + 1, "members", [len(names) for *_, names in there]
    )
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
    first, fallen = runs.iloc[0], runs["collapsed_at_s"].astype(float).dropna()
    row = {name: first[name] for name in each(PARAMETERS) if name in runs}
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
        values = runs[name].dropna()
        if _is_number(values):
            numbers = values.astype(float)
            row |= {
                name: numbers.median(),
                f"{name}_min": numbers.min(),
                f"{name}_max": numbers.max(),
            }
        else:
            row[name] = values.mode().iloc[0]
    return row


def _is_number(values):
    return all(isinstance(value, (int, float, np.number)) for value in values)


def write_hdf5(tables, path):
    """Write {name: DataFrame} as HDF5, whole or not at all: a group a table, a dataset a column.

    Numbers are f8, NaN where empty; words are UTF-8, empty where missing.
    """
    content = io.BytesIO()  # HDF5 itself cannot be left in order once a write has failed
    with h5py.File(content, "w") as file:
        for table, frame in tables.items():
            group = file.create_group(table, track_order=True)
            for name, column in frame.items():
                words = not _is_number(column.dropna())
                values = (
                    column.fillna("").astype(str).to_numpy(object)
                    if words
                    else column.to_numpy(dtype="f8", na_value=np.nan)
                )
                group.create_dataset(
                    name, data=values, dtype=h5py.string_dtype() if words else "f8"
                )
    with whole_or_nothing(path) as unfinished:
        unfinished.write_bytes(content.getvalue())


def write_study_tables(study, folder, jobs=1):
    """Write summary.csv, points.csv and study.h5 of what there is; returns their paths, the summary
    last; arguments as of `summary_of`."""
    records = read_records(folder)
    summary = summary_of(study, folder, jobs, records)
    points = points_of(summary)
    tables = folder / "tables"
    paths = [write_table(points, tables / "points.csv"), tables / "study.h5"]
    write_hdf5({"runs": summary, "points": points}, paths[1])
    for name in TABLES:
        rows = [
            {"run": run, **row}
            for run in summary["run"]
            if run in records.runs and is_of_today(records.runs[run]["row"])
            for row in records.runs[run][name]
        ]
        if rows:
            paths.append(write_table(pd.DataFrame(rows), tables / f"{name}.csv"))
    return [*paths, write_table(summary, tables / "summary.csv")]
