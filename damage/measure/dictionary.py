"""The data dictionary: every column of every table that this software writes, with unit and
meaning; here those of single runs, beside which applications register theirs
(`damage.commands.table.tables`).

`python3 -m damage dictionary --out docs/reference` writes dictionary.csv.
"""

from pathlib import Path

import pandas as pd

from damage.history.schema import EVENT_COLUMNS, JOINTS, STATE_COLUMN, STATIC_STAGE, Column, each
from damage.history.schema import TABLES as HISTORY
from damage.index import COMPONENTS
from damage.measure.cycles import BY_OTHERS
from damage.measure.joint_stress import JOINT, SECTIONS, STRESSES
from damage.measure.joint_stress import POINTS as MATERIAL_POINTS
from damage.measure.tables import write_table

CRITERION_WORDS = {
    "": "",
    "accumulated_": ", slip accumulated",
    "shear_limit_": ", slip by the shear limit",
}
COMPONENT_WORDS = {
    "DI": "damage index",
    "DI_drift": "of it by drift",
    "DI_open": "of it by opened joints",
    "DI_slip": "of it by slipped joints",
}
SLIP = {"slip": Column("", "criterion of slip in the columns that name none")}


def _index(kind="", what=""):
    """Columns of the index and its components, by all criteria of slip; kind: before the name,
    what: in the meaning."""
    plain = {
        f"{kind}{name}": Column(
            "1",
            (
                f"{what}{COMPONENT_WORDS[name]}, slip by displacement"
                if name in ("DI", "DI_slip")
                else f"{what}{COMPONENT_WORDS[name]}"
            ),
        )
        for name in COMPONENTS
    }
    others = {
        f"{kind}{name}": Column(
            "1", what + COMPONENT_WORDS[component] + CRITERION_WORDS[name.removesuffix(component)]
        )
        for name, (_, component) in BY_OTHERS.items()
    }
    return plain | others


INDEX = {
    "time_s": Column("s", "since the start of the (first) motion"),
    "stage": Column("", "motion, rest, settling"),
    **_index(),
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
}
_SPAN = {"start_s": Column("s", "its start"), "end_s": Column("s", "its end")}
CYCLES = {
    "shock": Column("1", "number of the shock, from 1"),
    "cycle": Column("1", "number within the shock, from 1"),
    "kind": Column(
        "",
        "driven: one period of a harmonic motion; free: between upward zero crossings of the drift",
    ),
    **_SPAN,
    "duration_s": Column("s", "from start to end"),
    "max_drift_ratio": Column("1", "largest absolute drift ratio in the cycle"),
    **_index("max_", "largest in the cycle: "),
    **{
        f"cumulative_max_{prefix}DI": Column(
            "1", "largest index from the shock's start to the cycle's end" + words
        )
        for prefix, words in CRITERION_WORDS.items()
    },
    **SLIP,
}
SHOCKS = {
    "shock": Column("1", "number of the shock, from 1"),
    "motion": Column("", "name of the motion"),
    "factor": Column("1", "on the motion"),
    **_SPAN,
    "max_drift_ratio": Column("1", "largest absolute drift ratio in the shock"),
    "residual_drift_ratio": Column("1", "drift ratio at its end, with its sign"),
    **_index("max_", "largest in the shock: "),
    **_index("residual_", "at its end: "),
    **{
        f"{kind}_{name}": Column(unit, f"{words}: {meaning}")
        for kind, words in (("max", "largest in the shock"), ("residual", "at its end"))
        for name, unit, meaning in (
            ("psi", "1", "Korswagen's damage parameter of the cracks"),
            ("crack_width_mm", "mm", "width of the widest crack"),
        )
    },
    "offset_before_mm": Column(
        "mm", "largest offset of a joint's faces when the event begins, absolute"
    ),
    "offset_after_mm": Column("mm", "the same at its end"),
    "newly_failed": Column("1", "contact points whose bonds failed in the event"),
    **SLIP,
}
STOREYS = {
    "storey": Column("1", "from the base upwards"),
    "bottom_m": Column("m", "height of its lower end"),
    "top_m": Column(
        "m",
        "of its upper end: middle of a slab, the course below a timber floor, or the bricks of the "
        "wall's drift",
    ),
    "max_drift_ratio": Column(
        "1", "largest absolute drift ratio of the storey at the snapshots, every tenth sample"
    ),
    "residual_drift_ratio": Column("1", "drift ratio at the last snapshot, with its sign"),
}
BRICKS = {
    "brick": Column("1", "row of the history's bodies"),
    "course": Column("1", "from 0 at the base"),
    "x_m, z_m": Column("m", "of its centre"),
    "max_tension_pa, max_compression_pa": Column(
        "Pa",
        "largest and smallest principal stress of the middle section "
        "over all snapshots, tension positive",
    ),
    "place": Column("", "of the largest: lower edge, centre or upper edge"),
    "time_s": Column("s", "of the largest"),
    "splits_at_s": Column("s", "first snapshot above the tensile strength, empty without one"),
}

TABLES = {
    "RUN_index.csv": INDEX,
    "RUN_events.csv": EVENTS,
    "RUN_joints.csv": JOINTS_OF_A_RUN,
    "RUN_cycles.csv": CYCLES,
    "RUN_shocks.csv": SHOCKS,
    "RUN_storeys.csv": STOREYS,
    "RUN_bricks.csv": each(BRICKS),
    "RUN_static_stage.csv": STATIC_STAGE,
    "RUN_stresses.csv": STRESSES,
    "RUN_sections.csv": SECTIONS,
    "RUN_points.csv": MATERIAL_POINTS,
    "joint_N.csv": JOINT,
    **{f"RUN.h5 {group}": columns for group, columns in HISTORY.items()},
    "RUN.h5 state": {"solver": STATE_COLUMN},
}
"""{tables of single runs, as their files are called: {column: Column}}."""


def dictionary_table(tables):
    """A DataFrame with a row a column of tables, which are as TABLES: table, column, unit ("" of
    words), meaning."""
    rows = [
        (table, name, column.unit, column.meaning)
        for table, columns in tables.items()
        for name, column in columns.items()
    ]
    return pd.DataFrame(rows, columns=["table", "column", "unit", "meaning"])


def write_dictionary(tables, folder):
    """Write dictionary.csv of tables, which are as TABLES, into a folder; returns its path."""
    return write_table(dictionary_table(tables), Path(folder) / "dictionary.csv")
