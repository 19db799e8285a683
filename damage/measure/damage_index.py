"""Maximum and residual damage index of a run, by all criteria of slip, and its drift, that of each
storey, too.

A storey of a wall with floors reaches from floor to floor, the first from the base, the last to the
bricks whose displacement is the wall's drift.  Its drift ratio is the difference of the
displacements at its two ends over the difference of their heights.  A slab's place is its middle; a
timber floor's is the course below it, over the length that it covers.
"""

import numpy as np
import pandas as pd

from damage.history.schema import Column, measure
from damage.index import COMPONENTS

CRITERIA = {"displacement": "", "accumulated": "accumulated_", "shear-limit": "shear_limit_"}
"""{slip criterion: prefix of a component's name in its columns}."""
CRITERION_WORDS = {
    "": ", slip by displacement",
    "accumulated_": ", slip accumulated",
    "shear_limit_": ", slip by the shear limit",
}
OF_SLIP = ("DI_slip", "DI")
"""Components that depend on slip."""
COMPONENT_WORDS = {
    "DI": "damage index",
    "DI_drift": "of it by drift",
    "DI_open": "of it by opened joints",
    "DI_slip": "of it by slipped joints",
}
SLIP = {"slip": Column("", "criterion of slip in the columns that name none")}


def index_by_all(history):
    """Damage index of a History by all slip criteria: a DataFrame, a row a sample, columns
    COMPONENTS (slip by displacement), then OF_SLIP by the other criteria [-]."""
    return pd.concat(
        [
            history.index(slip=slip)[list(OF_SLIP if prefix else COMPONENTS)].add_prefix(prefix)
            for slip, prefix in CRITERIA.items()
        ],
        axis=1,
    )


def index_columns(kind="", what=""):
    """{column: Column} of `index_by_all`; kind: before the name, what: in the meaning."""
    return {
        f"{kind}{prefix}{name}": Column(
            "1", f"{what}{COMPONENT_WORDS[name]}{slip * (name in OF_SLIP)}"
        )
        for prefix, slip in CRITERION_WORDS.items()
        for name in (OF_SLIP if prefix else COMPONENTS)
    }


@measure(
    {
        ", ".join(f"{kind}_{prefix}{name}" for name in COMPONENTS): Column("1", f"{what}{slip}")
        for prefix, slip in CRITERION_WORDS.items()
        for kind, what in (
            ("max", "each its own maximum over the run"),
            ("residual", "the last state of the settling stage, or of a collapse"),
        )
    }
)
def index_measures(history, threshold, drift_limit, slip):
    """Damage index of a History; arguments, and what is maximum and residual:
    `damage.measure.summary.summarise`."""
    values = []
    for criterion in (slip, "accumulated", "shear-limit"):
        over_time = history.index(threshold, drift_limit, criterion)[list(COMPONENTS)]
        values += [
            *over_time.max(),
            *(over_time.iloc[-1] if history.complete else [None] * len(COMPONENTS)),
        ]
    return values


@measure(
    {
        "max_drift_ratio, residual_drift_ratio": Column(
            "1", "largest absolute drift ratio; drift ratio at the end, with its sign"
        )
    }
)
def drift_measures(history):
    """Drift of a History; the residual is None where the run is not complete."""
    drift = history.series["drift_ratio"]
    return float(np.abs(drift).max()), float(drift.iloc[-1]) if history.complete else None


_TINY = 1e-6  # [m]


def storey_drifts(history):
    """Heights (n_ends,) [m] of the storeys' ends, the base among them, and drift ratios
    (n_snapshots, n_storeys) [-] of a History; of a wall without floors there is one storey."""
    top = float(history.attributes["drift_height_m"])
    levels = {}
    for z, chosen in (_place(history, place) for place in history.plan.floors):
        if z < top - _TINY:  # floors of one level are one end
            levels[round(z, 6)] = np.union1d(levels.get(round(z, 6), ()), chosen).astype(int)
    heights = np.array([0.0, *sorted(levels), top])
    moved = history.displacement[:, :, 0].astype(float)
    sample = np.searchsorted(history.time_s, history.snapshot_time_s - 1e-9)
    sample = np.minimum(sample, len(history.series) - 1)
    ends = [
        *(moved[:, levels[z]].mean(axis=1) for z in sorted(levels)),
        history.series["top_displacement_m"].to_numpy()[sample],
    ]
    # the rigid motion of the base, which the wall's drift leaves out, too
    along, turn = (
        np.nan_to_num(history.series[name].to_numpy())[sample, np.newaxis]
        for name in ("base_translation_m", "base_rotation_rad")
    )
    base = history.bodies["z_m"][history.bodies["course"] == 0].mean()
    from_base = np.column_stack(ends) - along + np.sin(turn) * (heights[1:] - base)
    return heights, np.diff(from_base, axis=1, prepend=0.0) / np.diff(heights)


def _place(history, place):
    """Height [m] and bodies, an index array, of a floor, whose place is a
    damage.wall.floors.FloorPlace."""
    (floor, left, right, first, above) = place
    bodies = history.bodies
    z, x, course = (bodies[name].to_numpy() for name in ("z_m", "x_m", "course"))
    if floor.is_body:
        middle = (first + above) / 2 * history.masonry_wall.brick.height
        chosen = (
            (course < -1) & (np.abs(z - middle) < _TINY) & (np.abs(x - (left + right) / 2) < _TINY)
        )
    else:
        half = bodies["length_m"].to_numpy() / 2
        chosen = (course == first) & (x + half > left + _TINY) & (x - half < right - _TINY)
    return float(z[chosen].mean()), np.flatnonzero(chosen)


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


def storeys_table(history):
    """A row for each storey of a History, from the base upwards; columns: STOREYS."""
    heights, drift = storey_drifts(history)
    return pd.DataFrame(
        {
            "storey": np.arange(1, len(heights)),
            "bottom_m": heights[:-1],
            "top_m": heights[1:],
            "max_drift_ratio": np.abs(drift).max(axis=0),
            "residual_drift_ratio": drift[-1],
        }
    )
