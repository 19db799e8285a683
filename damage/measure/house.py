"""A house beside its walls: drift across each, Psi of its faces, opening of the corners, and what
all walls have together."""

import numpy as np
import pandas as pd

from damage.history.schema import Column, measure
from damage.house.placing import FACES
from damage.measure.cracks import PSI_FROM, psi_history, psi_summary
from damage.measure.damage_index import index_columns
from damage.measure.energy import energy_measures
from damage.units import MILLIMETRE, rounded

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


def largest_index(history):
    """DI of a History over time, (n_times,); of a house of the wall where it is largest."""
    return np.max([part.index()["DI"] for part in history.parts], axis=0)


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
    contacts = history.contacts.with_any("state", "opening_m", "offset_m")
    found = []
    for walls, joints in corner_joints(history).items():
        of = np.isin(contacts.joints, joints)
        found.append(
            pd.DataFrame(
                {
                    "corner": " / ".join(walls),
                    "time_s": history.series["time_s"],
                    "opening_m": contacts.opening_m[:, of].max(axis=1, initial=0.0),
                    "offset_m": np.abs(contacts.offset_m[:, of]).max(axis=1, initial=0.0),
                    "failed_share": contacts.broken[:, of].sum(axis=1) / len(joints),
                }
            )
        )
    return pd.concat(found, ignore_index=True) if found else pd.DataFrame(columns=list(CORNERS))


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


def describe(found):
    """A `house_summary` as lines for people: walls, corners and energy."""
    end = found["collapsed_at_s"]
    lines = [
        f"house {found['house']} / {found['motion']}: {found['status']}"
        + ("" if end is None else f", collapsed at {end:.2f} s"),
        f"{'':20s}{'maximum':>8s}{'residual':>9s}{'drift [%]':>16s}{'Psi':>15s}{'widest':>8s}",
        f"{'wall':20s}{'DI':>8s}{'DI':>9s}{'along':>8s}{'across':>8s}{'outside':>8s}{'inside':>7s}"
        f"{'[mm]':>8s}",
    ]
    for name, one in found["walls"].items():
        residual = "-" if one["residual"] is None else f"{one['residual']['DI']:.3f}"
        drift = [100 * one[f"max_drift_{way}ratio"] for way in ("", "across_")]
        cracks = [one[f"max_{name}"] for name in ("psi_outside", "psi_inside", "crack_width_mm")]
        numbers = [f"{value:.3f}" for value in drift] + [rounded(value, 2) for value in cracks]
        lines.append(
            f"{name[:19]:20s}{one['max']['DI']:8.3f}{residual:>9s}"
            + "{:>8s}{:>8s}{:>8s}{:>7s}{:>8s}".format(*numbers)
        )
    if found["corners"]:
        lines.append(
            f"{'corner':20s}{'opening [mm]':>14s}{'at the end':>12s}{'offset [mm]':>13s}"
            f"{'failed [%]':>12s}"
        )
    for name, one in found["corners"].items():
        numbers = [
            rounded(one[key], 2)
            for key in ("max_opening_mm", "residual_opening_mm", "max_offset_mm")
        ]
        lines.append(
            f"{name:20s}"
            + "{:>14s}{:>12s}{:>13s}".format(*numbers)
            + f"{100 * one['failed_share']:12.0f}"
        )
    if found["failed_ties"]:
        lines.append(f"{found['failed_ties']} ties failed")
    error = found["energy_error_fraction"]
    lines.append(
        f"of {rounded(found['input_energy_j'], 2)} J supplied, friction and fracture dissipated"
        f" {rounded(found['dissipated_energy_j'], 2)} J"
        + ("" if error is None else f"; balance error {100 * error:.3f} % of the input")
    )
    return "\n".join(lines)
