"""Measures of a closed loop of force and drift, of a run or of a test: a CSV file of LOOP_FILE."""

import numpy as np
import scipy  # integrate where it is used: it starts slowly

from damage.applications.cracks.plausible import implausible_loops
from damage.csv_table import read_csv
from damage.errors import warn
from damage.history.schema import Column

LOOP = {
    "max_drift_pct": Column("%", "largest drift of the loop"),
    "min_drift_pct": Column("%", "the same in the negative direction"),
    "max_force_kn": Column("kN", "largest force of the loop"),
    "min_force_kn": Column("kN", "the same in the negative direction"),
    "max_at_drift_pct": Column("%", "drift at the largest force"),
    "min_at_drift_pct": Column("%", "the same in the negative direction"),
    "residual_max_pct": Column("%", "drift at zero force on unloading from the largest drift"),
    "residual_min_pct": Column("%", "the same in the negative direction"),
    "dissipated_j": Column("J", "energy of the closed loop, the integral of F du"),
    "equivalent_damping": Column(
        "1", "dissipated_j over 4 pi times F u / 2 of half the ranges of force and displacement"
    ),
}


def loop_measures(drift, force, height):
    """Values of LOOP of a closed loop, a list; a residual drift is NaN where the force keeps its
    sign.

    drift [-], force [N]: (n,) in the order of loading; the last point is joined to the first;
    height [m]: over which the drift counts.

    Equivalent viscous damping is E_d / (4 pi E_s): E_d is the energy of the loop, E_s = F u / 2
    the elastic energy of its secant stiffness (Jacobsen 1930, Trans. ASME 52; Chopra, Dynamics of
    Structures, section 3.9).  F and u are half the ranges of force and displacement, which do not
    depend on where zero is, nor on how far the force relaxes while a test holds its largest drift;
    where the force is largest there, this is the damping of ASCE/SEI 7-16, equation 17.8-2.

    An ideal friction slider at 1 m: E_d = 4 F (u - F / k).

    >>> drift = np.array([-3, -1, 3, 1]) / 1e3
    >>> dict(zip(LOOP, loop_measures(drift, np.array([-1e3, 1e3, 1e3, -1e3]), 1.0)))[
    ...     "dissipated_j"
    ... ]
    8.0
    """
    drift = np.append(drift, drift[0])
    force = np.append(force, force[0])
    high, low, most, least = (
        int(find(values)) for values in (drift, force) for find in (np.argmax, np.argmin)
    )
    lost = height * scipy.integrate.trapezoid(force, drift)
    stored = height * np.ptp(force) * np.ptp(drift) / 8
    values = [
        *(100 * drift[[high, low]]),
        *(force[[most, least]] / 1e3),
        *(100 * drift[[most, least]]),
        *(100 * _unloaded(drift, force, index) for index in (high, low)),
        lost,
        lost / (4 * np.pi * stored) if stored > 0 else np.nan,
    ]
    return [float(value) for value in values]


def loops_at(table, drift_pct):
    """Energy [J] and equivalent damping [-] of loops that reach a drift [%], arrays as it.

    table: a DataFrame with the columns of LOOP, of loops of growing drift; linear between them in
    half their ranges of drift, NaN beyond.
    """
    table = table.assign(reach=(table["max_drift_pct"] - table["min_drift_pct"]) / 2)
    table = table.sort_values("reach", kind="stable")
    return tuple(
        np.interp(drift_pct, table["reach"], table[name], left=np.nan, right=np.nan)
        for name in ("dissipated_j", "equivalent_damping")
    )


def _unloaded(drift, force, start):
    """Drift [-] at which the force of a closed loop first is zero after sample `start`."""
    drift, force = (np.roll(values[:-1], -start) for values in (drift, force))
    drift = np.append(drift, drift[0])
    force = np.append(force, force[0])
    index = int(np.argmax(force * force[0] <= 0))
    if index == 0:
        return drift[0] if force[0] == 0 else np.nan
    share = force[index - 1] / (force[index - 1] - force[index])
    return drift[index - 1] + share * (drift[index] - drift[index - 1])


LOOP_FILE = {
    "loop": Column("", "name of a closed loop", "U"),
    "height_m": Column("m", "over which the drift counts, one value a loop", least=0.01, most=100),
    "drift_pct": Column("%", "in the order of loading", least=-100, most=100),
    "force_kn": Column("kN", "there, positive as the drift", least=-1e6, most=1e6),
}
WIDEST_GAP = 0.1
"""Distance of a loop's ends along the drift over its range [-], from which it is not closed."""


def read_loops(path):
    """Measures of the loops of a file, a list of {"loop": name, **LOOP}.  Raises InputError where
    a loop is not closed or runs backwards; warns of forces and drifts that no wall has."""
    table = read_csv(path, LOOP_FILE, tuple(LOOP_FILE))
    loops = []
    table.refuse_empty(*LOOP_FILE)
    for name, points in table.rows.groupby("loop", sort=False):
        first = points.index[0]
        height = points["height_m"].to_numpy()
        drift = points["drift_pct"].to_numpy() / 100
        if np.ptp(height) > 0:
            raise table.error(first, f"loop {name} has two heights; expected one, correct it")
        if abs(drift[-1] - drift[0]) >= WIDEST_GAP * np.ptp(drift):
            raise table.error(
                first,
                f"loop {name} begins at {100 * drift[0]:g} % and ends at {100 * drift[-1]:g} %; "
                "expected a closed loop; give the points that lack, the first one again at the end",
            )
        values = loop_measures(drift, 1e3 * points["force_kn"].to_numpy(), height[0])
        row = {"loop": name, **dict(zip(LOOP, values))}
        if row["dissipated_j"] < 0:
            raise table.error(
                first,
                f"loop {name} gains {-row['dissipated_j']:.3g} J; expected its points in the order"
                " of loading and forces positive as the drift; turn them round",
            )
        loops.append(row)
    points = table.rows[["force_kn", "drift_pct"]].abs()
    drifts_pct = points["drift_pct"].groupby(table.rows["loop"]).max()
    odd = implausible_loops(points["force_kn"].max(), drifts_pct, table.rows["height_m"].iloc[0])
    warn(*(f"{path}: {message}" for message in odd))
    return loops
