"""Tables of histories as CSV for spreadsheets and scripts, with units in the column names.

`python3 -m damage tables run FILE.h5 --out STEM` writes STEM_index.csv, _events.csv, _joints.csv,
_cycles.csv, _static_stage.csv (the unbalanced force over it), for a sequence _shocks.csv, for a
wall with floors _storeys.csv, with --stresses _stresses.csv and
_sections.csv, and STEM_info.json, their origin; of a house STEM_walls.csv, STEM_corners.csv and
those of each wall.  `python3 -m damage tables summary FILE.h5 ... --out FILE.csv` writes a row for
each history.
"""

from dataclasses import asdict
from pathlib import Path

import numpy as np
import pandas as pd

from damage.csv_table import as_words
from damage.files import json_text, whole_or_nothing, write_text
from damage.history.info import info, made_by
from damage.history.moments import check_samples
from damage.history.reader import read_history
from damage.history.schema import EVENT_COLUMNS, JOINTS, STATIC_STAGE, Column
from damage.index import COMPONENTS
from damage.measure.cycles import CYCLES, SHOCKS, cycles_table, shocks_table
from damage.measure.damage_index import SLIP, STOREYS, index_by_all, index_columns, storeys_table
from damage.measure.house import CORNERS, WALLS, corners_table, walls_table
from damage.measure.joint_stress import MOMENTS, SECTIONS, STRESSES, sections_table, stresses_table
from damage.measure.summary import flat_summary
from damage.motion.intensity import APPLIED
from damage.provenance import measures_digest


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
    loading = history.loading
    factor = history.strongest_factor
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
    """`summary_row` of each history file of `paths`, in their order, a DataFrame, a row for each
    wall of a house; runs are named by their files."""
    return pd.DataFrame([summary_row(part) for path in paths for part in read_history(path).parts])


def index_table(history):
    """Damage index of a History over time, a DataFrame, a row for each sample; columns: INDEX."""
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
    JOINTS_OF_A_RUN."""
    table = _with_first(
        history.joints.rename_axis("joint").reset_index(), "joint", "kind", "x_m", "z_m"
    )
    if history.house is None:
        table = table.assign(y_m=0.0, share=1.0)
    contacts = history.contacts

    def whole(values):
        """A column for all contact points: values (n,) of `contacts`, zero of the others."""
        column = np.zeros(len(table), values.dtype)
        column[contacts.joints] = values
        return column

    return table.assign(
        final_opening_m=whole(contacts.opening_m[-1]),
        max_opening_m=whole(contacts.opening_m.max(axis=0)),
        final_slip_m=whole(contacts.slip_m[-1]),
        max_abs_slip_m=whole(np.abs(contacts.slip_m).max(axis=0)),
        broken=whole(contacts.broken[-1]),
        at_shear_limit=whole(contacts.at_limit[-1]),
        crushed=whole(contacts.crushed[-1]),
        ended=whole(contacts.ended[-1]),
        final_offset_m=whole(contacts.offset_m[-1]),
        max_abs_offset_m=whole(np.abs(contacts.offset_m).max(axis=0)),
    )


def _with_first(table, *columns):
    """A copy of the table that begins with these columns."""
    return table[[*columns, *(name for name in table if name not in columns)]]


INDEX = {
    "time_s": Column("s", "since the start of the (first) motion"),
    "stage": Column("", "motion, rest, settling"),
    **index_columns(),
    "drift_over_limit": Column("1", "absolute drift ratio over its limit, not clipped"),
    "drift_ratio": Column("1", "top displacement over the height of the top course's centres"),
    **SLIP,
}
EVENTS = {
    **EVENT_COLUMNS,
    "joint_kind": Column("code", "bed, head, brick"),
    "joint_x_m": JOINTS["x_m"],
    "joint_z_m": JOINTS["z_m"],
}
JOINTS_OF_A_RUN = {
    "joint": Column("index", "row of `joints` of the history"),
    **JOINTS,
    "final_opening_m": Column("m", "opening at the last sample"),
    "max_opening_m": Column("m", "largest opening of all samples"),
    "final_slip_m": Column("m", "accumulated slip at the last sample, signed"),
    "max_abs_slip_m": Column("m", "largest absolute accumulated slip of all samples"),
    "broken": Column("bool", "whether the bond had failed at the last sample"),
    "at_shear_limit": Column("bool", "whether it had failed in shear or slid by then"),
    "crushed": Column("bool", "whether it had been crushed by then"),
    "ended": Column("bool", "whether it had ended by then, as its faces no longer overlapped"),
    "final_offset_m": Column("m", "offset of the faces at the last sample, signed"),
    "max_abs_offset_m": Column("m", "largest absolute offset of all samples"),
    "y_m": Column("m", "place from the middle of the thickness; 0 but in a house"),
    "share": Column("1", "of the thickness, which `length_m` has; 1 but in a house"),
}
RUN_TABLES = {
    "index": (index_table, INDEX),
    "events": (events_table, EVENTS),
    "joints": (joints_table, JOINTS_OF_A_RUN),
    "cycles": (cycles_table, CYCLES),
    "shocks": (shocks_table, SHOCKS),
    "storeys": (storeys_table, STOREYS),
    "static_stage": (lambda history: history.static_stage, STATIC_STAGE),
    "stresses": (stresses_table, STRESSES),
    "sections": (sections_table, SECTIONS),
}
HOUSE_TABLES = {"walls": (walls_table, WALLS), "corners": (corners_table, CORNERS)}
"""{end of a file's name: (function of a History, columns of the table)}."""


def write_run_tables(history, stem):
    """Write the RUN_TABLES that a run has to STEM_index.csv and so on, and their origin to
    STEM_info.json; returns the paths.  Of a house STEM_walls.csv, STEM_corners.csv, and those of
    each wall, STEM_WALL_index.csv and so on.  Raises InputError where the history has no sample."""
    check_samples(history)
    if history.kind == "house":
        return [
            *(
                write_table(table_of(history), Path(f"{stem}_{name}.csv"))
                for name, (table_of, _) in HOUSE_TABLES.items()
            ),
            *(
                path
                for part in history.parts
                for path in write_run_tables(part, f"{stem}_{part.wall}")
            ),
        ]
    has = {
        "shocks": history.series["shock"].iloc[-1] > 1,
        "storeys": history.masonry_wall.floors,
        **dict.fromkeys(("stresses", "sections"), history.joint_stress_pa is not None),
    }
    return [
        write_text(f"{stem}_info.json", json_text(info(history), indent=1)),
        *(
            write_table(table_of(history), Path(f"{stem}_{name}.csv"))
            for name, (table_of, _) in RUN_TABLES.items()
            if has.get(name, True)
        ),
    ]


def write_stresses(history, folder, moments=MOMENTS):
    """Write stresses.csv and sections.csv of a History at moments; returns the paths."""
    return [
        write_table(table_of(history, moments), Path(folder) / f"{name}.csv")
        for name, table_of in (("stresses", stresses_table), ("sections", sections_table))
    ]


def write_table(table, path):
    """Write a DataFrame as CSV, numbers with nine significant digits, words so that no spreadsheet
    executes them (`damage.csv_table`); returns the path."""
    with whole_or_nothing(path) as unfinished:
        as_words(table).to_csv(unfinished, index=False, float_format="%.9g")
    return path
