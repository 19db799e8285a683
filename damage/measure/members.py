"""Ensemble members of a single run: the run repeated with slightly scattered strengths, as a measure of its precision.

`python3 -m damage reference WALL.py ... --members N` writes FILE_members.csv beside FILE.h5, the history of the first
member: a row for each member, with the columns of summary.csv.
"""

from pathlib import Path

import numpy as np
import pandas as pd

from damage.errors import InputError
from damage.measure.columns import read_table
from damage.measure.tables import summary_row, write_table
from damage.units import rounded

SHOWN = {"max_DI": ("maximum DI", 1.0, "", None), "residual_DI": ("residual DI", 1.0, "", None),
         "max_drift_ratio": ("drift ratio", 100.0, " %", 3), "max_crack_width_mm": ("widest crack", 1.0, " mm", 2),
         "max_psi": ("Psi", 1.0, "", 2), "peak_base_shear_n": ("base shear", 1e-3, " kN", 3)}
"""{column: (name, factor, unit, significant digits)} of the measures whose median and range are shown; None for three
decimals in place of significant digits."""


def members_path(path):
    """Path of the table of members beside the history file at `path`."""
    return Path(path).with_name(f"{Path(path).stem}_members.csv")


def write_members(histories, path):
    """Write the table of members beside the history file at `path`; returns the table's path.

    histories: Histories of all members, that of `path` first.
    """
    point = Path(path).stem
    rows = [summary_row(history, run=f"{point}_s{history.parameters['seed']}", point=point) for history in histories]
    return write_table(pd.DataFrame(rows), members_path(path))


def members_of(history):
    """Table of the members of a History, a DataFrame; None where there is none, or it belongs to another history."""
    path = members_path(history.path)
    if not path.is_file():
        return None
    try:
        table = read_table(path, [*SHOWN, "seed", "scatter", "collapsed_at_s"])
    except InputError:
        return None
    own = summary_row(history)
    same = len(table) > 0 and all(np.isclose(table[name].iloc[0], np.nan if own[name] is None else own[name],
                                             rtol=1e-8, atol=0, equal_nan=True) for name in SHOWN)
    return table if same else None


def spread(table):
    """Median and range over the members of a table, a plain dictionary.

    count: number of members; collapsed: how many of them collapsed; and for each column of SHOWN that has values
    {"median", "min", "max"}.
    """
    values = {name: table[name].dropna().astype(float) for name in SHOWN}
    return {"count": len(table), "collapsed": int(table["collapsed_at_s"].notna().sum())} | {
        name: {"median": float(one.median()), "min": float(one.min()), "max": float(one.max())}
        for name, one in values.items() if len(one)}


def describe_spread(spread):
    """The result of `spread` as text, a list of lines."""
    fallen = f", {spread['collapsed']} of them collapsed" if spread["collapsed"] else ""
    return [f"{spread['count']} members{fallen}: median (min to max)",
            *(f"  {SHOWN[name][0]:14s}{in_words(spread, name)}" for name in SHOWN if name in spread)]


def in_words(spread, name):
    """Text: median and range of one column of SHOWN, with its unit; spread: the result of `spread`."""
    _, factor, unit, digits = SHOWN[name]
    middle, least, most = (f"{value:.3f}" if digits is None else rounded(value, digits)
                           for value in (factor * spread[name][of] for of in ("median", "min", "max")))
    return f"{middle} ({least} to {most}){unit}"
