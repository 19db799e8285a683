"""Cycles of the drift, and the index cycle by cycle, as `docs/reference/measures.md` defines them."""

import numpy as np
import pandas as pd

from damage.history.moments import moving
from damage.index import COMPONENTS
from damage.measure.columns import CRITERIA
from damage.measure.vibration import upward_crossings

# --- cycles of the drift ----------------------------------------------------------------------------


def cycle_measures(history):
    """last_cycle_s, first_free_cycle_s and period_elongation of a History's (last) shock.

    A cycle lasts from one upward zero crossing of the drift ratio to the next.  last_cycle_s: of the
    last one that begins while the base moves; first_free_cycle_s: of the first one that begins after;
    period_elongation: first_free_cycle_s over the period of the intact wall; a driven cycle would show
    the motion's period, not the wall's.  None where there is none, and in quasi-static runs.
    """
    names = ("last_cycle_s", "first_free_cycle_s", "period_elongation")
    if history.loading.drive.base is None:
        return dict.fromkeys(names)
    driven, free = (np.diff(cycles).ravel().tolist() for cycles in drift_cycles(history))
    last, free = driven[-1] if driven else None, free[0] if free else None
    eigen_period = history.eigen_period_s
    return dict(zip(names, (last, free, free / eigen_period if free and eigen_period else None)))


def drift_cycles(history):
    """Start and end [s], (k, 2), of the cycles of the drift in a History's (last) shock, from one upward
    zero crossing to the next: those that begin while the base moves, and those that begin after."""
    series = history.moving[history.moving["shock"] == history.series["shock"].iloc[-1]]
    crossings = upward_crossings(series["time_s"], series["drift_ratio"])
    cycles = np.column_stack([crossings[:-1], crossings[1:]])
    begins_driven = cycles[:, 0] <= _motion_end(series)
    return cycles[begins_driven], cycles[~begins_driven]


def _motion_end(series):
    """Time of the last sample of the base motion [s]; series: of one event."""
    return series.loc[series["stage"] == "motion", "time_s"].max()


# --- the index cycle by cycle -----------------------------------------------------------------------

BY_OTHERS = {f"{prefix}{component}": (slip, component) for slip, prefix in CRITERIA.items() if prefix
             for component in ("DI_slip", "DI")}
"""What differs by the other slip criteria: column -> (criterion, component)."""
CYCLE_COLUMNS = ("shock", "cycle", "kind", "start_s", "end_s", "duration_s", "max_drift_ratio",
                 *(f"max_{name}" for name in COMPONENTS), *(f"max_{name}" for name in BY_OTHERS),
                 "cumulative_max_DI", "cumulative_max_accumulated_DI", "cumulative_max_shear_limit_DI", "slip")


def index_by_all(history):
    """The index of a History over time, COMPONENTS with slip by displacement, then BY_OTHERS."""
    index = {slip: history.index(slip=slip) for slip in CRITERIA}
    return index["displacement"][list(COMPONENTS)].assign(
        **{name: index[slip][component] for name, (slip, component) in BY_OTHERS.items()})


def cycles_table(history):
    """A row a cycle of a History: of each event the driven ones, then the free ones.

    Driven cycles are those of a harmonic motion, each one period long; free cycles lie between two
    upward zero crossings of the drift after the motion.  Columns CYCLE_COLUMNS: largest |drift ratio| and
    index within the cycle, and the largest index from the shock's start to the cycle's end; slip: the criterion of
    the columns that name none.
    """
    values = index_by_all(history).assign(drift_ratio=history.series["drift_ratio"].abs(),
                                           time_s=history.series["time_s"])
    rows = []
    for shock, members in history.series.groupby("shock"):
        mine = values.loc[members.index]
        for number, (kind, start, end) in enumerate(_cycles(moving(members), history.loading), start=1):
            within = mine[mine["time_s"].between(start, end)].max()
            so_far = mine[mine["time_s"] <= end].max()
            rows.append({"shock": shock, "cycle": number, "kind": kind, "start_s": start, "end_s": end,
                         "duration_s": end - start}
                        | {f"max_{name}": within[name] for name in values if name != "time_s"}
                        | {f"cumulative_max_{name}": so_far[name]
                           for name in ("DI", "accumulated_DI", "shear_limit_DI")}
                        | {"slip": history.judged_by("displacement")})
    return pd.DataFrame(rows, columns=list(CYCLE_COLUMNS))


def _cycles(series, loading):
    """(kind, start, end) [s] of the complete cycles; series: of one event, without
    settling."""
    if loading.drive.quasi_static:
        return []
    time_s = series["time_s"].to_numpy()
    edges = time_s[0] + loading.cycle_edges_s
    half_a_sample = 0.5 * (time_s[-1] - time_s[0]) / max(len(time_s) - 1, 1)
    driven = [("driven", start, end) for start, end in zip(edges, edges[1:]) if end <= time_s[-1] + half_a_sample]
    crossings = upward_crossings(time_s, series["drift_ratio"])
    crossings = crossings[crossings > _motion_end(series)] if loading.drive.base else crossings
    return driven + [("free", start, end) for start, end in zip(crossings, crossings[1:])]
