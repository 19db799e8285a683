"""Drift ratio of each storey of a wall with floors, from the snapshots of a run.

A storey reaches from floor to floor, the first from the base, the last to the bricks whose displacement is the wall's
drift.  Its drift ratio is the difference of the displacements at its two ends over the difference of their heights.  A
slab's place is its middle; a timber floor's is the course below it, over the length that it covers.
"""

import numpy as np
import pandas as pd

_TINY = 1e-6  # [m]


def storey_drifts(history):
    """Heights (n_ends,) [m] of the storeys' ends, the base among them, and drift ratios (n_snapshots, n_storeys) [-] of
    a History; of a wall without floors there is one storey."""
    top = float(history.attributes["drift_height_m"])
    levels = {}
    for z, chosen in (_place(history, floor) for floor in history.masonry_wall.floors):
        if z < top - _TINY:  # floors of one level are one end
            levels[round(z, 6)] = np.union1d(levels.get(round(z, 6), ()), chosen).astype(int)
    heights = np.array([0.0, *sorted(levels), top])
    moved = history.displacement[:, :, 0].astype(float)
    sample = np.searchsorted(history.series["time_s"].to_numpy(), history.snapshot_time_s - 1e-9)
    sample = np.minimum(sample, len(history.series) - 1)
    ends = [np.zeros(len(moved)), *(moved[:, levels[z]].mean(axis=1) for z in sorted(levels)),
            history.series["top_displacement_m"].to_numpy()[sample]]
    return heights, np.diff(np.column_stack(ends), axis=1) / np.diff(heights)


def _place(history, floor):
    """Height [m] and bodies, an index array, of a damage.Floor."""
    wall, bodies = history.masonry_wall, history.bodies
    left, right = floor.span(wall)
    first, above = floor.courses(wall)
    z, x, course = (bodies[name].to_numpy() for name in ("z_m", "x_m", "course"))
    if floor.kind == "concrete":
        middle = (first + above) / 2 * wall.brick.height
        chosen = (course < -1) & (np.abs(z - middle) < _TINY) & (np.abs(x - (left + right) / 2) < _TINY)
    else:
        half = bodies["length_m"].to_numpy() / 2
        chosen = (course == first) & (x + half > left + _TINY) & (x - half < right - _TINY)
    return float(z[chosen].mean()), np.flatnonzero(chosen)


def storeys_table(history):
    """A row for each storey of a History, from the base upwards: its ends, the largest absolute drift ratio of all
    snapshots, every tenth sample, and that of the last one."""
    heights, drift = storey_drifts(history)
    return pd.DataFrame({"storey": np.arange(1, len(heights)), "bottom_m": heights[:-1], "top_m": heights[1:],
                         "max_drift_ratio": np.abs(drift).max(axis=0), "residual_drift_ratio": drift[-1]})
