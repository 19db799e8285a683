"""Loops of force and drift that a laboratory measured, in a CSV file of LOOP_FILE."""

import numpy as np

from damage.csv_table import read_csv
from damage.history.schema import Column
from damage.measure.loops import LOOP, loop_measures

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
    a loop is not closed or runs backwards."""
    table, found = read_csv(path, LOOP_FILE, tuple(LOOP_FILE)), []
    table.refuse_empty(*LOOP_FILE)
    for name, points in table.rows.groupby("loop", sort=False):
        first = points.index[0]
        height, drift = points["height_m"].to_numpy(), points["drift_pct"].to_numpy() / 100
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
        found.append(row)
    return found
