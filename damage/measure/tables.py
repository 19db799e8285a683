"""Tables of histories as CSV for spreadsheets and scripts, with units in the column names.

`python3 -m damage tables run FILE.h5 --out STEM` writes STEM_index.csv, _events.csv, _joints.csv,
_cycles.csv, _static_stage.csv (the unbalanced force over it), for a sequence _shocks.csv, for a
wall with floors _storeys.csv, of deformable bricks _bricks.csv, with --stresses _stresses.csv and
_sections.csv, with --point _points.csv, and STEM_info.json, their origin.  `python3 -m damage
tables summary FILE.h5 ... --out FILE.csv` writes a row for each history. With `--members N`, a run
repeated with slightly scattered strengths as a measure of its precision, FILE_members.csv beside
FILE.h5, the history of the first member, has a row for each member with the columns of summary.csv.
"""

from dataclasses import asdict
from pathlib import Path

import numpy as np
import pandas as pd

from damage.csv_table import as_words
from damage.errors import InputError
from damage.files import json_text, whole_or_nothing, write_text
from damage.history.info import info, made_by
from damage.history.moments import check_samples
from damage.history.reader import read_history
from damage.index import COMPONENTS
from damage.measure.brick_stress import bricks_table, has_stresses
from damage.measure.columns import read_table
from damage.measure.cycles import cycles_table, index_by_all, shocks_table
from damage.measure.damage_index import storeys_table
from damage.measure.joint_stress import (
    MOMENTS,
    joint_history,
    points_table,
    sections_table,
    stresses_table,
)
from damage.measure.summary import flat_summary
from damage.motion.intensity import APPLIED
from damage.provenance import measures_digest
from damage.units import rounded


def summary_row(history, run="", point=""):
    """Summary of a History as a flat dictionary, a row of summary.csv; columns:
    `damage.measure.columns`.

    run: name of the row, by default the stem of the file; point: of a study, by default the run.
    Loading and model options come first, then the measures (`damage.measure.summary.MEASURES`).
    None where a column does not apply. Raises InputError where the history has no sample.
    """
    row = {"run": run or history.path.stem, "point": point or run or history.path.stem}
    numbers = flat_summary(history)
    del numbers["complete"], numbers["evidence"]  # status and outside_validity say it
    row |= {
        key: numbers[key]
        for key in ("wall", "solver", "motion", "record_unit", "status", "collapsed_at_s")
    }
    settlement = history.parameters.get("settlement") or {}
    row |= {"settlement": settlement.get("profile"), "distortion": settlement.get("distortion")}
    row |= _motion_columns(history, numbers) | asdict(history.model)
    row |= {
        name: history.parameters.get(name)
        for name in (
            "alpha_1_s",
            "beta_s",
            "scatter",
            "seed",
            "mass_scaling",
            "time_step_s",
            "repeats",
            "repeated_for",
            "eigen_period_s",
        )
    }
    joint = history.masonry_wall.joint
    row |= {
        f"{name}_j_m2": getattr(joint, name) or 0.0
        for name in ("mode_i_fracture_energy", "mode_ii_fracture_energy")
    }
    return row | made_by(history) | {"measures_digest": measures_digest()} | numbers


def _motion_columns(history, numbers):
    """Columns of the loading; intensities are of the motion as applied, with the largest factor of
    a sequence."""
    loading, factor = history.loading, history.strongest_factor
    given = loading.as_dict()
    start, end = given.get("window_s") or (None, None)
    return {
        "record": given.get("horizontal", {}).get("record"),
        "record_pga_g": loading.record_pga_g and loading.record_pga_g * factor,
        "pga_g": loading.pga_g and loading.pga_g * factor,
        "sa_0.2_s_g": loading.sa_02_s_g and loading.sa_02_s_g * factor,
        **{name: numbers[name] for name in APPLIED},
        "motion_period_s": given.get("period_s"),
        **{name: given.get(name) for name in ("amplitude_g", "cycles", "speed_m_s", "scale")},
        "window_start_s": start,
        "window_end_s": end,
        "lost_by_lines": numbers["lost_by_lines"],
        "vertical": int(given.get("vertical") is not None),
        "shocks": len(history.sequence),
        "motion_duration_s": given.get("duration_s"),
        "rest_s": history.parameters.get("rest_s"),
    }


def summary_table(paths):
    """`summary_row` of each history file of `paths`, in their order, a DataFrame; runs are named by
    their files."""
    return pd.DataFrame([summary_row(read_history(path)) for path in paths])


def index_table(history):
    """Damage index of a History over time, a DataFrame, a row for each sample; columns:
    `damage.measure.dictionary.INDEX`."""
    table = history.index()
    table.insert(1, "stage", history.series["stage"].astype(str))
    table["drift_ratio"] = history.series["drift_ratio"].to_numpy()
    others = index_by_all(history).drop(columns=list(COMPONENTS))
    return table.join(others).assign(slip="displacement")


def events_table(history):
    """Table of the failures of contact points, and of the first times that each exceeded the
    threshold, with place."""
    place = history.joints.loc[history.events["joint"], ["kind", "x_m", "z_m"]].reset_index(
        drop=True
    )
    return _with_first(history.events.join(place.add_prefix("joint_")), "time_s", "joint", "kind")


def joints_table(history):
    """Table of the contact points of a History, a DataFrame; columns:
    `damage.measure.dictionary.JOINTS_OF_A_RUN`."""
    table = _with_first(
        history.joints.rename_axis("joint").reset_index(), "joint", "kind", "x_m", "z_m"
    )
    active, states = history.active, history.states

    def column(of, values):
        """A column for all contact points, zero except for those with sparse data `of`, whose
        values (n,) are given."""
        whole = np.zeros(len(table), values.dtype)
        whole[of.joints] = values
        return whole

    opening, slip, offset = active.opening_m, active.slip_m, active.offset_m
    return table.assign(
        final_opening_m=column(active, opening[-1]),
        max_opening_m=column(active, opening.max(axis=0)),
        final_slip_m=column(active, slip[-1]),
        max_abs_slip_m=column(active, np.abs(slip).max(axis=0)),
        broken=column(states, states.broken[-1]),
        at_shear_limit=column(states, states.at_limit[-1]),
        crushed=column(states, states.crushed[-1]),
        ended=column(states, states.ended[-1]),
        final_offset_m=column(active, offset[-1]),
        max_abs_offset_m=column(active, np.abs(offset).max(axis=0)),
    )


def _with_first(table, *columns):
    """A copy of the table that begins with these columns."""
    return table[[*columns, *(name for name in table if name not in columns)]]


RUN_TABLES = {
    "index": index_table,
    "events": events_table,
    "joints": joints_table,
    "cycles": cycles_table,
    "shocks": shocks_table,
    "storeys": storeys_table,
    "bricks": bricks_table,
    "static_stage": lambda history: history.static_stage,
    "stresses": stresses_table,
    "sections": sections_table,
    "points": points_table,
}


def write_run_tables(history, stem):
    """Write the RUN_TABLES that a run has to STEM_index.csv and so on, and their origin to
    STEM_info.json; returns the paths.  Raises InputError where the history has no sample."""
    check_samples(history)
    has = {
        "shocks": history.series["shock"].iloc[-1] > 1,
        "storeys": history.masonry_wall.floors,
        "bricks": has_stresses(history),
        "points": history.point_displacement is not None,
        **dict.fromkeys(("stresses", "sections"), history.joint_stress_pa is not None),
    }
    return [
        write_text(f"{stem}_info.json", json_text(info(history), indent=1)),
        *(
            write_table(table_of(history), Path(f"{stem}_{name}.csv"))
            for name, table_of in RUN_TABLES.items()
            if has.get(name, True)
        ),
    ]


def write_stresses(history, folder, moments=MOMENTS, joints=()):
    """Write stresses.csv and sections.csv of a History at moments, and joint_N.csv of chosen joints
    over time; returns the paths."""
    folder = Path(folder)
    tables = {
        "stresses": stresses_table(history, moments),
        "sections": sections_table(history, moments),
        **{f"joint_{row}": joint_history(history, row) for row in joints},
    }
    return [write_table(table, folder / f"{name}.csv") for name, table in tables.items()]


def write_table(table, path):
    """Write a DataFrame as CSV, numbers with nine significant digits, words so that no spreadsheet
    executes them (`damage.csv_table`); returns the path."""
    with whole_or_nothing(path) as unfinished:
        as_words(table).to_csv(unfinished, index=False, float_format="%.9g")
    return path


def describe_table(table):
    """The summary table as text for people: the index and its components for each run, below its
    name where both are wider than a terminal."""
    columns = {
        "max_DI": "DI",
        "max_DI_drift": "drift",
        "max_DI_open": "open",
        "max_DI_slip": "slip",
        "residual_DI": "residual",
    }
    width, below = max(len("run"), *table["run"].str.len()), ""
    if width > 80 - len("  complete") - 10 * len(columns):
        width, below = 3, "\n   "
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


SHOWN = {
    "max_DI": ("maximum DI", 1.0, "", None),
    "residual_DI": ("residual DI", 1.0, "", None),
    "max_drift_ratio": ("drift ratio", 100.0, " %", 3),
    "max_crack_width_mm": ("widest crack", 1.0, " mm", 2),
    "max_psi": ("Psi", 1.0, "", 2),
    "peak_base_shear_n": ("base shear", 1e-3, " kN", 3),
}
"""{column: (name, factor, unit, significant digits)} of the measures whose median and range are
shown; None for three decimals in place of significant digits."""


def repeated(table):
    """How many runs of a table were repeated in smaller steps (`damage.run.scheme`)."""
    return int((table.reindex(columns=["repeats"])["repeats"] > 0).sum())


def members_path(path):
    """Path of the table of members beside the history file at `path`."""
    return Path(path).with_name(f"{Path(path).stem}_members.csv")


def member_row(row, path):
    """A row of summary.csv as that of a member in the table beside the history file at `path`."""
    point = Path(path).stem
    return row | {"run": f"{point}_s{row['seed']}", "point": point}


def members_of(history):
    """Table of the members of a History, a DataFrame; None where there is none, or it belongs to
    another history."""
    path = members_path(history.path)
    if not path.is_file():
        return None
    try:
        table = read_table(path, [*SHOWN, "seed", "scatter", "collapsed_at_s"])
    except InputError:
        return None
    own = summary_row(history)
    same = len(table) > 0 and all(
        np.isclose(
            table[name].iloc[0],
            np.nan if own[name] is None else own[name],
            rtol=1e-8,
            atol=0,
            equal_nan=True,
        )
        for name in SHOWN
    )
    return table if same else None


def spread(table):
    """Median and range over the members of a table, a plain dictionary.

    count: number of members; collapsed, repeated: how many of them collapsed, or were repeated in
    smaller steps; and for each column of SHOWN that has values {"median", "min", "max"}.
    """
    values = table[list(SHOWN)].astype(float).agg(["median", "min", "max"]).dropna(axis="columns")
    return {
        "count": len(table),
        "collapsed": int(table["collapsed_at_s"].notna().sum()),
        "repeated": repeated(table),
    } | values.to_dict()


def describe_spread(spread):
    """The result of `spread` as text, a list of lines."""
    of_them = "".join(
        f", {spread[name]} of them {name}" for name in ("collapsed", "repeated") if spread.get(name)
    )
    return [
        f"{spread['count']} members{of_them}: median (min to max)",
        *(
            f"  {SHOWN[name][0]:14s}{members_in_words(spread, name)}"
            for name in SHOWN
            if name in spread
        ),
    ]


def members_in_words(spread, name):
    """Text: median and range of one column of SHOWN, with its unit; spread: the result of
    `spread`."""
    _, factor, unit, digits = SHOWN[name]
    middle, least, most = (
        f"{value:.3f}" if digits is None else rounded(value, digits)
        for value in (factor * spread[name][of] for of in ("median", "min", "max"))
    )
    return f"{middle} ({least} to {most}){unit}"
