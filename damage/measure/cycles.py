"""Cycles of the drift, the damage index cycle by cycle (definitions: `docs/reference/measures.md`),
events of a sequence, and periods."""

import numpy as np
import pandas as pd

from damage.history.reader import History
from damage.history.schema import Column, measure, moving
from damage.measure.cracks import psi_history
from damage.measure.damage_index import CRITERION_WORDS, SLIP, index_by_all, index_columns
from damage.units import MILLIMETRE


@measure(
    {
        "last_cycle_s": Column(
            "s",
            "length of the last cycle that begins while the base moves; it may end in free "
            "vibration",
        ),
        "first_free_cycle_s": Column(
            "s", "length of the first cycle that begins after the base has come to rest"
        ),
        "period_elongation": Column("1", "`first_free_cycle_s` over `eigen_period_s`"),
    }
)
def cycle_measures(history: History) -> tuple | None:
    """Durations of the last driven and the first free one of the `drift_cycles` of a History.
    Driven cycles have the period of the motion, so that the elongation is of the free one.  None
    where there is no such cycle, and in quasi-static runs."""
    if history.loading.drive.base is None:
        return None
    driven, free = (np.diff(cycles).ravel().tolist() for cycles in drift_cycles(history))
    last = driven[-1] if driven else None
    free = free[0] if free else None
    eigen_period = history.eigen_period_s
    return last, free, free / eigen_period if free and eigen_period else None


def drift_cycles(history: History) -> tuple[np.ndarray, np.ndarray]:
    """Start and end of the cycles of the drift in the last event of a History, two arrays (k, 2)
    [s]: of those that begin while the base moves, and of those that begin afterwards.  A cycle
    lasts from one upward zero crossing of the drift ratio to the next.

    >>> driven, free = drift_cycles(vibrating)
    >>> len(driven), free.round(3).tolist()
    (0, [[0.1, 0.2], [0.2, 0.3]])
    """
    series = history.moving[history.moving["shock"] == history.series["shock"].iloc[-1]]
    crossings = upward_crossings(series["time_s"], series["drift_ratio"])
    cycles = np.column_stack([crossings[:-1], crossings[1:]])
    begins_driven = cycles[:, 0] <= _motion_end(series)
    return cycles[begins_driven], cycles[~begins_driven]


def _motion_end(series):
    """Time of the last sample of the base motion [s]; series: of one event."""
    return series.loc[series["stage"] == "motion", "time_s"].max()


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
    **index_columns("max_", "largest in the cycle: "),
    **{
        f"cumulative_max_{prefix}DI": Column(
            "1", "largest index from the shock's start to the cycle's end" + criterion
        )
        for prefix, criterion in CRITERION_WORDS.items()
    },
    **SLIP,
}


def cycles_table(history: History) -> pd.DataFrame:
    """Table of the cycles of a History, a DataFrame: for each event the driven cycles, then the
    free ones.  columns: CYCLES.

    >>> cycles_table(vibrating)[["kind", "duration_s", "max_drift_ratio"]].round(4).values.tolist()
    [['free', 0.1, 0.001], ['free', 0.1, 0.001]]
    """
    values = index_by_all(history).assign(
        drift_ratio=history.series["drift_ratio"].abs(), time_s=history.time_s
    )
    rows = []
    for event, members in history.series.groupby("shock"):
        mine = values.loc[members.index]
        for number, (kind, start, end) in enumerate(
            _cycles(moving(members), history.loading), start=1
        ):
            within = mine[mine["time_s"].between(start, end)].max()
            so_far = mine[mine["time_s"] <= end].max()
            rows.append(
                {
                    "shock": event,
                    "cycle": number,
                    "kind": kind,
                    "start_s": start,
                    "end_s": end,
                    "duration_s": end - start,
                    **within.add_prefix("max_"),
                    **so_far.add_prefix("cumulative_max_"),
                    "slip": "displacement",
                }
            )
    return pd.DataFrame(rows, columns=list(CYCLES))


SHOCKS = {
    "shock": Column("1", "number of the shock, from 1"),
    "motion": Column("", "name of the motion"),
    "factor": Column("1", "on the motion"),
    **_SPAN,
    "max_drift_ratio": Column("1", "largest absolute drift ratio in the shock"),
    "residual_drift_ratio": Column("1", "drift ratio at its end, with its sign"),
    **index_columns("max_", "largest in the shock: "),
    **index_columns("residual_", "at its end: "),
    **{
        f"{kind}_{name}": Column(unit, f"{moment}: {meaning}")
        for kind, moment in (("max", "largest in the shock"), ("residual", "at its end"))
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


def shocks_table(history: History) -> pd.DataFrame:
    """Table of the events of a History, a DataFrame, a row for each event of its sequence; columns:
    SHOCKS.  Residual values are NaN of an event without a settling stage.

    >>> len(shocks_table(history))
    1
    """
    cracks = psi_history(history)
    series = history.series
    values = pd.DataFrame(
        {
            "drift_ratio": series["drift_ratio"],
            **index_by_all(history),
            "psi": cracks["psi"],
            "crack_width_mm": cracks["max_width_m"] / MILLIMETRE,
        }
    )
    ends = series.groupby("shock").tail(1)
    last = ends.index
    largest = values.abs().groupby(series["shock"]).max()
    residual = values.loc[last].where(ends["stage"] == "settling")
    offset = np.abs(history.active.offset_m).max(axis=1, initial=0.0)[last] / MILLIMETRE
    failed = history.states.broken.sum(axis=1)[last]
    before = int(np.nan_to_num(history.static.get("broken_joints", 0)))
    return pd.DataFrame(
        {
            "shock": ends["shock"].to_numpy(),
            "motion": [loading.name for loading in history.event_loadings[: len(ends)]],
            "factor": history.sequence[: len(ends)],
            "start_s": series.groupby("shock")["time_s"].min().to_numpy(),
            "end_s": ends["time_s"].to_numpy(),
            **{
                f"{kind}_{name}": table[name].to_numpy()
                for name in values
                for kind, table in (("max", largest), ("residual", residual))
            },
            "offset_before_mm": np.append(0.0, offset[:-1]),
            "offset_after_mm": offset,
            "newly_failed": np.diff(failed, prepend=before),
            "slip": "displacement",
        }
    )


def _cycles(series, loading):
    """(kind, start, end) of the complete cycles [s]; kind: "driven" or "free"; series: of one
    event, not settling."""
    if loading.drive.quasi_static or len(series) == 0:
        return []
    time_s = series["time_s"].to_numpy()
    edges = time_s[0] + loading.cycle_edges_s
    half_a_sample = 0.5 * (time_s[-1] - time_s[0]) / max(len(time_s) - 1, 1)
    driven = [
        ("driven", start, end)
        for start, end in zip(edges, edges[1:])
        if end <= time_s[-1] + half_a_sample
    ]
    crossings = upward_crossings(time_s, series["drift_ratio"])
    crossings = crossings[crossings > _motion_end(series)] if loading.drive.base else crossings
    return driven + [("free", start, end) for start, end in zip(crossings, crossings[1:])]


REARM = 0.02
"""Share of the largest |drift| [-] below zero that the drift must reach before its next upward
crossing counts, so that ripples around zero are not counted as cycles."""
NOISE = 1e-8
"""Drift ratio [-] below which a wall counts as at rest: 25 nm at the top of a storey.  Walls of a
house in YADE that are shaken across reach 1e-9 in their plane."""


def upward_crossings(time_s: np.ndarray, value: np.ndarray, rearm: float = REARM) -> np.ndarray:
    """Times at which `value` crosses zero upwards, (k,) [s], linearly interpolated between samples.

    time_s, value: (n_times,); rearm [-].  A crossing counts if the value has been below -max(rearm
    max|value|, NOISE) since the crossing before.

    >>> t = np.linspace(0, 1, 1001)
    >>> upward_crossings(t, np.sin(2 * np.pi * 4 * (t - 0.1))).round(6)
    array([0.1 , 0.35, 0.6 , 0.85])
    >>> upward_crossings(t, 1e-9 * np.sin(2 * np.pi * 4 * (t - 0.1))).size  # a wall at rest
    0
    """
    time_s = np.asarray(time_s, float)
    value = np.asarray(value, float)
    level = max(rearm * np.abs(value).max(initial=0.0), NOISE)
    up = np.flatnonzero((value[:-1] < 0) & (value[1:] >= 0))
    # `armed[i]`: how often the value has fallen below -level up to sample i; one crossing counts
    # for each time.
    armed = np.cumsum(np.diff((value < -level).astype(int), prepend=0) > 0)
    _, first = np.unique(armed[up], return_index=True)
    up = up[first[armed[up][first] > 0]]
    share = -value[up] / (value[up + 1] - value[up])
    return time_s[up] + share * (time_s[up + 1] - time_s[up])


@measure({"period_s": Column("s", "natural period of a run in free vibration")})
def period_of(history: History) -> float | None:
    """Natural period of a History of free vibration [s]; None for another loading.

    >>> round(period_of(vibrating)["period_s"], 4)
    0.1
    """
    if not history.loading.drive.first_mode_m_s:
        return None
    return natural_period(
        history.moving["time_s"].to_numpy(), history.moving["drift_ratio"].to_numpy()
    )


def natural_period(time_s: np.ndarray, displacement: np.ndarray) -> float | None:
    """Period of the dominant vibration [s]: that of the sinusoid with an offset that fits best by
    least squares.

    time_s, displacement: (n_times,), equally spaced.  The search is around the highest peak of the
    Fourier spectrum, and exact for a single undamped sinusoid.  None for fewer than three cycles or
    16 samples, and where the displacement varies by less than NOISE.

    >>> t = np.linspace(0, 2, 2001)
    >>> round(float(natural_period(t, np.sin(2 * np.pi * t / 0.2))), 3)
    0.2
    """
    from scipy.optimize import minimize_scalar

    if len(time_s) < 16 or np.ptp(displacement) < NOISE:
        return None
    step = (time_s[-1] - time_s[0]) / (len(time_s) - 1)
    centred = displacement - displacement.mean()
    spectrum = np.abs(np.fft.rfft(centred))
    peak = int(np.argmax(spectrum[1:]) + 1)
    if peak < 3:
        return None
    width = 1 / (step * len(time_s))

    def misfit(frequency):
        phase = 2 * np.pi * frequency * time_s
        basis = np.column_stack([np.cos(phase), np.sin(phase), np.ones_like(phase)])
        return np.sum(
            (basis @ np.linalg.lstsq(basis, displacement, rcond=None)[0] - displacement) ** 2
        )

    best = minimize_scalar(
        misfit,
        bounds=((peak - 1) * width, (peak + 1) * width),
        method="bounded",
        options={"xatol": 1e-6 * width},
    )
    return float(1 / best.x)
