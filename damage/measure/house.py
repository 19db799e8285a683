"""A house beside its walls: drift across each, Psi of its faces, opening of the corners, and what
all walls have together."""

import numpy as np
import pandas as pd

from damage.history.schema import Column, measure
from damage.house.placing import FACES
from damage.measure.cracks import PSI_FROM, psi_history, psi_summary
from damage.measure.damage_index import index_columns
from damage.measure.energy import energy_measures
from damage.measure.results import CORNERS as CORNER_RESULTS
from damage.measure.results import RESULTS, line_of, result_of, table_of, value_in
from damage.measure.results import WALLS as WALL_COLUMNS
from damage.units import MILLIMETRE

_OF = "only of a wall of a house: "
WALLS = {
    "wall": Column("", "name of the wall"),
    "time_s": Column("s", "since the start of the (first) motion"),
    **{name: column for name, column in index_columns().items() if name.count("_") < 2},
    "drift_ratio": Column("1", "top displacement along the wall over its height"),
    "drift_across_ratio": Column("1", "the same across the wall"),
    "across_m": Column("m", "largest displacement of a body across the wall, signed"),
    **{f"psi_{face}": Column("1", f"Psi of the cracks of the face {face}") for face in FACES},
}
CORNERS = {
    "corner": Column("", "names of the two walls"),
    "time_s": Column("s", "since the start of the (first) motion"),
    "opening_m": Column("m", "largest opening of the contact points between both walls"),
    "offset_m": Column("m", "largest offset of their faces, along the joint"),
    "failed_share": Column("1", "share of these contact points whose bond has failed"),
}


def _of_face(face, more=""):
    """Columns of `psi_summary` of a face."""
    return {
        f"max_crack_width_{face}_mm, residual_crack_width_{face}_mm": Column(
            "mm", f"{_OF}widest crack of its face {face}{more}"
        ),
        f"max_psi_{face}, residual_psi_{face}": Column(
            "1", f"{_OF}Psi of the cracks of its face {face}"
        ),
    }


@measure(
    {
        "max_drift_across_ratio, residual_drift_across_ratio": Column(
            "1", f"{_OF}displacement across it of the top over its height; largest, and at the end"
        ),
        "max_across_mm": Column("mm", f"{_OF}largest displacement of a body across it"),
        **_of_face("outside", ", away from the middle of the plan"),
        **_of_face("inside"),
    }
)
def house_measures(history, psi_from=PSI_FROM):
    """Measures of a wall of a house, a History in its plane; psi_from: width from which a crack
    counts [m]."""
    if history.house is None:
        return None
    drift = np.abs(drift_across(history))
    return (
        float(drift.max()),
        float(drift[-1]) if history.complete else None,
        float(np.abs(history.house.across_m).max() / MILLIMETRE),
        *(
            value
            for face in FACES
            for value in psi_summary(history.of_face(face), psi_from).values()
        ),
    )


def drift_across(history):
    """Displacement across a wall of a house of its top over its height, (n_times,)."""
    return history.house.top_across_m[:, 0] / history.attributes["drift_height_m"]


def walls_table(history):
    """Damage index, drift along and across, Psi of both faces of the walls of a house over time, a
    DataFrame; columns: WALLS."""
    return pd.concat(
        [
            pd.DataFrame(
                {
                    "wall": part.wall,
                    **part.index().drop(columns="drift_over_limit"),
                    "drift_ratio": part.series["drift_ratio"].to_numpy(),
                    "drift_across_ratio": drift_across(part),
                    "across_m": part.house.across_m[:, 0],
                    **{f"psi_{face}": psi_history(part.of_face(face))["psi"] for face in FACES},
                }
            )
            for part in history.parts
        ],
        ignore_index=True,
    )


def corner_joints(history):
    """{(names of two walls): indices of the contact points between them} of a house."""
    joints = np.flatnonzero(history.house.joint_wall < 0)
    bodies = history.joints[["first_body", "second_body"]].to_numpy()[joints]
    pairs = np.sort(history.house.body_wall[bodies], axis=1)
    return {
        tuple(history.placing.names[wall] for wall in pair): joints[(pairs == pair).all(axis=1)]
        for pair in np.unique(pairs, axis=0)
    }


def corners_table(history):
    """Opening, offset and failed bonds of the corners of a house over time, a DataFrame; columns:
    CORNERS."""
    contacts = history.contacts
    tables = []
    for walls, joints in corner_joints(history).items():
        in_corner = np.isin(contacts.joints, joints)
        tables.append(
            pd.DataFrame(
                {
                    "corner": " / ".join(walls),
                    "time_s": history.time_s,
                    "opening_m": contacts.opening_m[:, in_corner].max(axis=1, initial=0.0),
                    "offset_m": np.abs(contacts.offset_m[:, in_corner]).max(axis=1, initial=0.0),
                    "failed_share": contacts.broken[:, in_corner].sum(axis=1) / len(joints),
                }
            )
        )
    return pd.concat(tables, ignore_index=True) if tables else pd.DataFrame(columns=list(CORNERS))


def house_summary(history, walls):
    """Summary of a house, a plain dictionary; walls: {name: `damage.measure.summary.summarise`}."""
    corners = {
        name: {
            "max_opening_mm": float(table["opening_m"].max() / MILLIMETRE),
            "residual_opening_mm": float(table["opening_m"].iloc[-1] / MILLIMETRE),
            "max_offset_mm": float(table["offset_m"].max() / MILLIMETRE),
            "failed_share": float(table["failed_share"].iloc[-1]),
        }
        for name, table in corners_table(history).groupby("corner", sort=False)
    }
    return {
        "house": history.parameters["house"]["name"],
        "motion": history.loading.name,
        "status": history.status,
        "collapsed_at_s": history.collapsed_at_s,
        **energy_measures(history),
        "failed_ties": int(history.house.failed_ties[-1]),
        "corners": corners,
        "walls": walls,
    }


def describe(numbers):
    """A `house_summary` as lines for people: walls, corners and energy."""
    end = numbers["collapsed_at_s"]
    walls = {
        name: {column: value_in(summary, column) for column in WALL_COLUMNS}
        for name, summary in numbers["walls"].items()
    }
    lines = [
        f"house {numbers['house']} / {numbers['motion']}: {numbers['status']}"
        + ("" if end is None else f", collapsed at {end:.2f} s"),
        *table_of(walls, {column: result_of(column) for column in WALL_COLUMNS}),
        *(table_of(numbers["corners"], CORNER_RESULTS) if numbers["corners"] else []),
        *([f"{numbers['failed_ties']} ties failed"] if numbers["failed_ties"] else []),
        *(
            line_of(RESULTS[column], numbers[column])
            for column in ("input_energy_j", "dissipated_energy_j", "energy_error_fraction")
        ),
    ]
    return "\n".join(lines)
