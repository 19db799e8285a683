"""What the members of a run say of its scatter: their table beside the history, median and range.

With `--members N`, a run repeated with slightly scattered strengths as a measure of its precision,
FILE_members.csv beside FILE.h5, the history of the first member, has a row for each member with the
columns of summary.csv.
"""

import numpy as np

from damage.applications.studies.read import read_table
from damage.errors import InputError
from damage.measure.results import KEY, result_of
from damage.measure.tables import summary_row


def repeated(table):
    """How many runs of a table were repeated in smaller steps (`damage.run.scheme`)."""
    return int((table.reindex(columns=["repeats"])["repeats"] > 0).sum())


def members_path(path):
    """Path of the table of members beside the history file at `path`."""
    return path.with_name(f"{path.stem}_members.csv")


def member_row(row, path):
    """A row of summary.csv as that of a member in the table beside the history file at `path`."""
    point = path.stem
    return row | {"run": f"{point}_s{row['seed']}", "point": point}


def members_of(history):
    """Table of the members of a History, a DataFrame; None where there is none, or it belongs to
    another history."""
    path = members_path(history.path)
    if not path.is_file():
        return None
    try:
        table = read_table(path, [*KEY, "seed", "scatter", "collapsed_at_s"])
    except InputError:
        return None
    summary = summary_row(history)
    key = list(KEY)
    expected = np.array([summary[name] for name in key], float)
    same = len(table) > 0 and np.allclose(
        table[key].iloc[0].astype(float), expected, rtol=1e-8, atol=0, equal_nan=True
    )
    return table if same else None


def spread(table):
    """Median and range over the members of a table, a plain dictionary.

    count: number of members; collapsed, repeated: how many of them collapsed, or were repeated in
    smaller steps; and for each column of KEY that has values {"median", "min", "max"}.
    """
    values = table[list(KEY)].astype(float).agg(["median", "min", "max"]).dropna(axis="columns")
    return {
        "count": len(table),
        "collapsed": int(table["collapsed_at_s"].notna().sum()),
        "repeated": repeated(table),
    } | values.to_dict()


def spread_of(history):
    """The `spread` of the members of a History; None where there are none."""
    table = members_of(history)
    return None if table is None else spread(table)


def describe_spread(spread):
    """The result of `spread` as text, a list of lines."""
    of_them = "".join(
        f", {spread[name]} of them {name}" for name in ("collapsed", "repeated") if spread.get(name)
    )
    return [
        f"{spread['count']} members{of_them}: median (min to max)",
        *(
            f"  {result_of(name).label:22s}{members_in_words(spread, name)}"
            for name in KEY
            if name in spread
        ),
    ]


def members_in_words(spread, name):
    """Text: median and range of one column of KEY, with its unit; spread: the result of
    `spread`."""
    result = result_of(name)
    interval = spread[name]
    middle, least, most = (result.shown(interval[kind]) for kind in ("median", "min", "max"))
    return f"{middle} ({least} to {most}) {result.unit}".rstrip()
