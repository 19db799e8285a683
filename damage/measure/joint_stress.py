"""Stresses of joints (`--stresses`): forces in contact points, thrust in piers and arches.

A section of a pier is all of its bed joints at one height, one of an arch all of its upright joints
at one place.  With the stresses sigma (tension positive), tau and areas A of its contact points, at
s along the section from its middle:

    N = sum sigma A,   V = sum tau A,   M = sum sigma A s,   e = M / N

e is the eccentricity: where the thrust passes.  Joints that transmit no tension are pressed all
over up to e = 1/6 of the section's length.  Places and directions are those of the undeformed wall:
a joint that has turned by an angle has its forces along axes turned so.
"""

from typing import NamedTuple

import numpy as np
import pandas as pd

from damage.errors import InputError
from damage.history.moments import choose_samples
from damage.history.schema import Column
from damage.wall.kinds import ARCH_COURSE

MOMENTS = "rest", "max", "end"
"""Moments of the tables: the first sample, the maximum damage index, the last sample."""
_SAME = 1e-6  # [m]


def check_stresses(history):
    """Raise InputError where a History holds no stresses of joints."""
    if history.joint_stress_pa is None:
        raise InputError(
            f"{history.path} has no stresses of joints: expected a run with --stresses; run it"
            " again so"
        )


def contact_forces(history, sample):
    """Forces of the first body on the second in all contact points at a sample, along x and z,
    (n_joints, 2) [N]."""
    check_stresses(history)
    normal, shear = (
        -history.joint_stress_pa[sample].astype(float).T * history.joints["area_m2"].to_numpy()
    )
    bed = (history.joints["kind"] == "bed").to_numpy()
    return np.column_stack([np.where(bed, shear, normal), np.where(bed, normal, shear)])


class Section(NamedTuple):
    """A section of a pier, or of an arch.

    part: "pier 1", ... from the left, "arch 1", ...; left, right [m]: of the pier along x, or of
    the arch along z; is_bed: of bed joints, else of upright ones; place [m]: height of the section
    of a pier, or place along the wall of that of an arch; joints: rows of its contact points.
    """

    part: str
    left: float
    right: float
    is_bed: bool
    place: float
    joints: np.ndarray


def sections(history):
    """The Sections of the piers, then of the arches, a list."""
    joints = history.joints
    sections = []
    x = joints["x_m"].to_numpy()
    z = joints["z_m"].to_numpy()
    is_bed = (joints["kind"] == "bed").to_numpy()
    for number, (left, right) in enumerate(history.plan.piers, 1):
        inside = is_bed & (x > left - _SAME) & (x < right + _SAME)
        sections += [
            Section(f"pier {number}", left, right, True, *row) for row in _by_place(z, inside)
        ]
    course = np.append(history.bodies["course"], 0)  # the last one of the ground
    bodies = np.maximum(joints[["first_body", "second_body"]].to_numpy(), -1)
    upright = (course[bodies] == ARCH_COURSE).any(axis=1) & ~is_bed
    arches = [place for place in history.plan.lintels if place.lintel.kind == "arch"]
    for number, arch in enumerate(arches, 1):
        inside = upright & (x > arch.left - _SAME) & (x < arch.right + _SAME)
        low = z[inside].min()
        high = z[inside].max()
        sections += [
            Section(f"arch {number}", low, high, False, *row) for row in _by_place(x, inside)
        ]
    return sections


def _by_place(places, chosen):
    """[(place, rows)] of the chosen contact points, rising."""
    rounded_off = np.round(places / _SAME).astype(int)
    return [
        (float(places[rows[0]]), rows)
        for rows in (
            np.flatnonzero(chosen & (rounded_off == place))
            for place in np.unique(rounded_off[chosen])
        )
    ]


def sections_table(history, moments=MOMENTS):
    """Forces in the sections of piers and arches at moments (`choose_samples`), a DataFrame, a row
    a section and moment; columns: SECTIONS."""
    check_stresses(history)
    area, length = (history.joints[name].to_numpy() for name in ("area_m2", "length_m"))
    places = history.joints[["x_m", "z_m"]].to_numpy()
    rows = []
    of_parts = sections(history)
    for moment, sample in zip(moments, choose_samples(history, moments)):
        stress = history.joint_stress_pa[sample].astype(float)
        time_s = float(history.time_s[sample])
        for part, _, _, is_bed, across, joints in of_parts:
            along = places[joints, 0 if is_bed else 1]
            (sigma, tau) = stress[joints].T
            middle = np.average(along, weights=area[joints])
            normal = sigma @ area[joints]
            moment_n_m = (sigma * area[joints]) @ (along - middle)
            away = moment_n_m / normal if normal < 0 else np.nan
            thrust = (middle + away, across) if is_bed else (across, middle + away)
            rows.append(
                (
                    moment,
                    time_s,
                    part,
                    across,
                    length[joints].sum(),
                    normal,
                    tau @ area[joints],
                    moment_n_m,
                    *thrust,
                    away,
                    away / length[joints].sum(),
                )
            )
    return pd.DataFrame(rows, columns=list(SECTIONS))


_AT = {
    "moment": Column("", "rest, max (of the damage index), end, or a time"),
    "time_s": Column("s", "of the sample"),
}
SECTIONS = _AT | {
    "part": Column(
        "", "pier 1, ... from the left, with its bed joints; arch 1, ... with its upright joints"
    ),
    "place_m": Column("m", "of the section: height of a pier's, along the wall of an arch's"),
    "length_m": Column("m", "of the section"),
    "normal_force_n": Column("N", "tension positive"),
    "shear_force_n": Column("N", "on the part below, or to the left, along the section"),
    "moment_n_m": Column(
        "N m",
        "of the normal stresses about the section's middle, tension on its right or upper end "
        "positive",
    ),
    "thrust_x_m": Column("m", "where the thrust passes, along the wall; empty under tension"),
    "thrust_z_m": Column("m", "the same, upwards"),
    "eccentricity_m": Column("m", "of the thrust from the section's middle"),
    "eccentricity_over_length": Column(
        "1", "over the section's length: pressed all over up to 1/6"
    ),
}


def stresses_table(history, moments=MOMENTS):
    """Stresses of all contact points at moments (`choose_samples`), a DataFrame, a row a contact
    point and moment; columns: STRESSES."""
    check_stresses(history)
    table = history.joints.rename_axis("joint").reset_index()[
        ["joint", "kind", "x_m", "z_m", "area_m2"]
    ]
    tables = []
    for moment, sample in zip(moments, choose_samples(history, moments)):
        force = contact_forces(history, sample)
        tables.append(
            table.assign(
                moment=moment,
                time_s=history.time_s[sample],
                normal_stress_pa=history.joint_stress_pa[sample, :, 0],
                shear_stress_pa=history.joint_stress_pa[sample, :, 1],
                force_x_n=force[:, 0],
                force_z_n=force[:, 1],
            )
        )
    return pd.concat(tables, ignore_index=True)[list(STRESSES)]


STRESSES = _AT | {
    "joint": Column("index", "row of `joints` of the history"),
    "kind": Column("code", "bed, head, brick"),
    "x_m": Column("m", "place in the undeformed wall, along it"),
    "z_m": Column("m", "the same, upwards"),
    "area_m2": Column("m2", "tributary length times the thickness"),
    "normal_stress_pa": Column("Pa", "tension positive"),
    "shear_stress_pa": Column("Pa", "signed as the slip"),
    "force_x_n": Column("N", "of the first body on the second, along the wall"),
    "force_z_n": Column("N", "the same, upwards"),
}


def stress_report(history, moments=MOMENTS):
    """The stresses of a History, a dictionary: at each moment extremes over the contact points, and
    the section of each pier and arch with the largest eccentricity."""
    table = sections_table(history, moments)
    of_points = stresses_table(history, moments)
    return {
        "wall": history.wall,
        "moments": [
            {
                "moment": moment,
                "time_s": float(rows["time_s"].iloc[0]),
                **_extremes(rows[["normal_stress_pa", "shear_stress_pa"]].to_numpy()),
                "sections": _most_eccentric(table[table["moment"] == moment]),
            }
            for moment, rows in of_points.groupby("moment", sort=False)
        ],
    }


def _extremes(stresses):
    """Least and largest of normal and shear stresses (n, 2) [Pa], by the names of the report."""
    return {
        f"{which}_{kind}_stress_pa": float(getattr(values, which)())
        for kind, values in zip(("normal", "shear"), stresses.T)
        for which in ("min", "max")
    }


def _most_eccentric(table):
    """Sections with the largest eccentricity, one of each part, the first where all are under
    tension: dictionaries."""
    away = table["eccentricity_over_length"].abs().fillna(-1.0)
    rows = away.groupby(table["part"], sort=False).idxmax()
    return table.loc[rows].drop(columns=["moment", "time_s"]).to_dict("records")


def describe(report):
    """A `stress_report` as text for people."""
    lines = [f"stresses of the joints of {report['wall']}, tension positive"]
    for moment in report["moments"]:
        lines.append(
            f"{moment['moment']}, {moment['time_s']:.3f} s: normal {_range(moment, 'normal')},"
            f" shear {_range(moment, 'shear')} MPa"
        )
        lines += [
            f"  {part['part']} at {part['place_m']:.3f} m: N {part['normal_force_n'] / 1e3:.3f} kN,"
            f" V {part['shear_force_n'] / 1e3:.3f} kN, M {part['moment_n_m'] / 1e3:.3f} kN m, e / L"
            f" {part['eccentricity_over_length']:.3f}"
            for part in moment["sections"]
        ]
    return "\n".join(lines)


def _range(numbers, kind):
    return " to ".join(
        f"{numbers[f'{which}_{kind}_stress_pa'] / 1e6 + 0.0:.4f}" for which in ("min", "max")
    )
