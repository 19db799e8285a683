"""Tables of studies, read: checks of names and columns, bounds of values, and a summary as text."""

import math
from dataclasses import fields

import pandas as pd

from damage.checks import check_file, is_plain_name
from damage.csv_table import from_words
from damage.errors import InputError
from damage.index import COMPONENTS
from damage.measure.columns import MADE_BY
from damage.wall.model_options import ModelOptions

MOST_MB = 500
"""Largest size of a table that is read: about 100 000 runs."""
WORDS = {
    attribute.name: str for attribute in fields(ModelOptions) if isinstance(attribute.default, str)
}
"""{column: str} of the columns that are text even where they look like numbers, as a lintel of "2"
courses."""


def made_by_words(table):
    """Text: the versions of software (MADE_BY) that made the runs of a table, a DataFrame."""
    return "; ".join(
        f"{name} {', '.join(sorted(set(table[name].dropna())))}"
        for name in MADE_BY
        if name in table
    )


def bounds_of(name):
    """Bounds (least, most) of the values of a column, by its name; infinite where there is none.

    >>> names = "max_accumulated_DI_slip", "max_slip_mm", "residual_drift_ratio"
    >>> tuple(map(bounds_of, names))
    ((0.0, 1.0), (0.0, inf), (-inf, inf))
    >>> bounds_of("max_brick_compression_pa")  # stresses have a sign
    (-inf, inf)
    """
    if name.endswith(COMPONENTS):
        return 0.0, 1.0
    is_size = name.startswith(("max_", "peak_")) and not name.endswith("_pa")
    return (0.0 if is_size else -math.inf), math.inf


def read_table(path, needed=()):
    """A table of a study as a DataFrame.

    needed: names of columns.  Only an empty cell is missing; "none" is text.  Raises InputError
    where the file cannot be read or lacks a needed column.
    """
    try:
        check_file(path, "a CSV file of a study", MOST_MB)
        table = pd.read_csv(
            path,
            keep_default_na=False,
            na_values=[""],
            dtype=WORDS,
            low_memory=False,
            index_col=False,
            float_precision="round_trip",
        )
        table = from_words(table)
    except (OSError, ValueError) as error:  # of the file, or of its text
        raise InputError(
            f"{path} cannot be read as a table ({str(error).splitlines()[0]}); expected a CSV file"
            " of a study, run it again with ./run_all.sh"
        ) from error
    if lacking := [name for name in needed if name not in table]:
        raise InputError(
            f"{path} has no column {lacking[0]}; expected the tables of a study of this version,"
            " run it again with ./run_all.sh, or make them anew: python3 -m damage tables summary"
        )
    return table


def check_names(table, path):
    """Raise InputError where a run or a wall of a table has a name that files cannot be called
    after; path: of it."""
    for name in sorted({"run", "wall"} & set(table)):
        odd = [
            word for word in table[name].dropna().astype(str).unique() if not is_plain_name(word)
        ]
        if odd:
            raise InputError(
                f"{path}: {name} {odd[0]!r:.80}: expected a name without slashes and control"
                " characters; take another copy of the table"
            )


def describe_table(table):
    """The summary table as text for people: the index and its components for each run, below its
    name where both are wider than a terminal."""
    columns = {
        "max_DI": "DI",
        "max_DI_drift": "DI_drift",
        "max_DI_open": "DI_open",
        "max_DI_slip": "DI_slip",
        "residual_DI": "residual",
    }
    width = max(len("run"), *table["run"].str.len())
    below = ""
    if width > 80 - len("  complete") - 10 * len(columns):
        width = 3
        below = "\n   "
    lines = [
        f"{'run':{width}s}" + "".join(f"{name:>10s}" for name in columns.values()) + "  status"
    ]
    for _, row in table.iterrows():
        status = row["status"] + (
            f", collapsed at {row['collapsed_at_s']:.2f} s"
            if pd.notna(row["collapsed_at_s"])
            else ""
        )
        lines.append(
            f"{row['run']:{width}s}{below}"
            + "".join(f"{row[key]:10.3f}" for key in columns)
            + f"  {status}"
        )
    return "\n".join(lines)
