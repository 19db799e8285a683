"""Measures of a run: cycles of the motion and of the drift, energies, classes by published limits.

`docs/measures.md` defines each of them for readers of the tables.
"""

from dataclasses import dataclass

import numpy as np
import pandas as pd

from damage.index import COMPONENTS

# --- cycles of the drift ----------------------------------------------------------------------------

REARM = 0.02
"""Share of the largest drift that the wall must go to the other side before its next upward crossing
counts: ripples around zero are no cycles."""


def upward_crossings(time_s, value, rearm=REARM):
    """Times (k,) [s] at which `value` passes zero upwards, linear between samples.

    time_s, value: (n_times,).  Between two that count, the value has been below -rearm max|value|.

    >>> t = np.linspace(0, 1, 1001)
    >>> upward_crossings(t, np.sin(2 * np.pi * 4 * (t - 0.1))).round(6)
    array([0.1 , 0.35, 0.6 , 0.85])
    """
    time_s, value = np.asarray(time_s, float), np.asarray(value, float)
    level = rearm * np.abs(value).max(initial=0.0)
    up = np.flatnonzero((value[:-1] < 0) & (value[1:] >= 0))
    # `armed[i]`: how often the value has entered the far side up to sample i; one crossing an entry.
    armed = np.cumsum(np.diff((value < -level).astype(int), prepend=0) > 0)
    _, first = np.unique(armed[up], return_index=True)
    up = up[first[armed[up][first] > 0]]
    share = -value[up] / (value[up + 1] - value[up])
    return time_s[up] + share * (time_s[up + 1] - time_s[up])


def last_shock(history):
    """The series of the last shock of a History without its settling stage."""
    series = history.series
    return series[(series["shock"] == series["shock"].iloc[-1]) & (series["stage"] != "settling")]


def cycle_measures(history):
    """last_cycle_s, first_free_cycle_s and period_elongation of a History's (last) shock.

    A cycle lasts from one upward zero crossing of the drift ratio to the next.  last_cycle_s: of the
    last one that begins while the base moves; first_free_cycle_s: of the first one that begins after;
    period_elongation: first_free_cycle_s over the period of the intact wall; a driven cycle would show
    the motion's period, not the wall's.  None where there is none, and in quasi-static runs.
    """
    names = ("last_cycle_s", "first_free_cycle_s", "period_elongation")
    if history.parameters["loading"]["kind"] not in ("harmonic", "record"):
        return dict.fromkeys(names)
    driven, free = (np.diff(cycles).ravel().tolist() for cycles in drift_cycles(history))
    last, free = driven[-1] if driven else None, free[0] if free else None
    eigen_period = history.parameters.get("eigen_period_s")
    return dict(zip(names, (last, free, free / eigen_period if free and eigen_period else None)))


def drift_cycles(history):
    """Start and end [s], (k, 2), of the cycles of the drift in a History's (last) shock, from one upward
    zero crossing to the next: those that begin while the base moves, and those that begin after."""
    series = last_shock(history)
    crossings = upward_crossings(series["time_s"], series["drift_ratio"])
    cycles = np.column_stack([crossings[:-1], crossings[1:]])
    begins_driven = cycles[:, 0] <= _motion_end(series)
    return cycles[begins_driven], cycles[~begins_driven]


def _motion_end(series):
    """Time of the last sample of the base motion [s]; series: of one shock."""
    return series.loc[series["stage"] == "motion", "time_s"].max()


# --- the index cycle by cycle -----------------------------------------------------------------------

CYCLE_COLUMNS = ("shock", "cycle", "kind", "start_s", "end_s", "duration_s", "max_drift_ratio",
                 *(f"max_{name}" for name in COMPONENTS), "max_DI_slip_shear_limit", "max_DI_shear_limit",
                 "cumulative_max_DI", "cumulative_max_DI_shear_limit")


def cycles_table(history):
    """A row a cycle of a History: of each shock the driven ones, then the free ones.

    Driven cycles are those of a harmonic motion, each one period long; free cycles lie between two
    upward zero crossings of the drift after the motion.  Columns CYCLE_COLUMNS: largest |drift ratio| and
    index within the cycle, and the largest index from the shock's start to the cycle's end.
    """
    index, latched = history.index(), history.index(slip="shear-limit")
    values = index[list(COMPONENTS)].assign(
        DI_slip_shear_limit=latched["DI_slip"], DI_shear_limit=latched["DI"],
        drift_ratio=history.series["drift_ratio"].abs(), time_s=history.series["time_s"])
    rows = []
    for shock, members in history.series.groupby("shock"):
        mine = values.loc[members.index]
        for number, (kind, start, end) in enumerate(_cycles(members, history.parameters["loading"]), start=1):
            within = mine[mine["time_s"].between(start, end)].max()
            so_far = mine[mine["time_s"] <= end].max()
            rows.append({"shock": shock, "cycle": number, "kind": kind, "start_s": start, "end_s": end,
                         "duration_s": end - start}
                        | {f"max_{name}": within[name] for name in values if name != "time_s"}
                        | {f"cumulative_max_{name}": so_far[name] for name in ("DI", "DI_shear_limit")})
    return pd.DataFrame(rows, columns=list(CYCLE_COLUMNS))


def _cycles(series, loading):
    """(kind, start, end) [s] of the cycles of one shock's series that have been gone through whole."""
    if loading["kind"] not in ("harmonic", "record", "free_vibration"):
        return []
    moving = series[series["stage"] != "settling"]
    time_s = moving["time_s"].to_numpy()
    found = []
    if loading["kind"] == "harmonic":
        edges = time_s[0] + loading["period_s"] * np.arange(loading["cycles"] + 1)
        half_a_sample = 0.5 * (time_s[-1] - time_s[0]) / max(len(time_s) - 1, 1)
        found = [("driven", start, end) for start, end in zip(edges, edges[1:])
                 if end <= time_s[-1] + half_a_sample]
    crossings = upward_crossings(time_s, moving["drift_ratio"])
    crossings = crossings[crossings > _motion_end(moving)] if loading["kind"] != "free_vibration" else crossings
    return found + [("free", start, end) for start, end in zip(crossings, crossings[1:])]


# --- energy ------------------------------------------------------------------------------------------

def energy_measures(history):
    """Energies of a whole History [J]: input, and what friction, fracture and damping took.

    dissipated_energy_j is friction and fracture together; damping_energy_j leaves the settling stages
    out, whose damping is no part of the model.
    """
    series = history.series
    friction, fracture, given = (float(series[name].iloc[-1]) for name in (
        "friction_energy_j", "fracture_energy_j", "input_energy_j"))
    in_motion = (series["stage"] != "settling").to_numpy()
    damping = float(np.diff(series["damping_energy_j"], prepend=0.0)[in_motion].sum())
    return {"input_energy_j": given, "friction_energy_j": friction, "fracture_energy_j": fracture,
            "dissipated_energy_j": friction + fracture, "damping_energy_j": damping}


# --- classes by published limits ----------------------------------------------------------------------

@dataclass(frozen=True)
class Limits:
    """Published limits of a measure, rising, and the names of the classes they part.

    name: of the column; measure: which figure is classified, "drift" (maximum drift ratio [-]) or "psi"
    (maximum Psi [-]); bounds: (n,); classes: (n + 1,) names, a value equal to a bound is of the upper
    class; source: where the limits come from.
    """

    name: str
    measure: str
    bounds: tuple[float, ...]
    classes: tuple[str, ...]
    source: str

    def classify(self, value):
        """The name of the class of `value`; None of None.

        >>> LIMITS[2].classify(0.0009)
        'minor'
        """
        return None if value is None else self.classes[int(np.searchsorted(self.bounds, value, side="right"))]


_KORSWAGEN = ("P. A. Korswagen, dissertation on light damage of masonry, TU Delft: in-plane tests of {} walls, "
              "light damage from {} to {} % drift")
_LIGHT = ("none", "light", "beyond light")
LIMITS = (
    Limits("drift_class_korswagen_clay", "drift", (0.00058, 0.0048), _LIGHT,
           _KORSWAGEN.format("clay brick", 0.058, 0.48)),
    Limits("drift_class_korswagen_calcium_silicate", "drift", (0.00050, 0.0029), _LIGHT,
           _KORSWAGEN.format("calcium silicate", 0.050, 0.29)),
    Limits("drift_class_graziotti", "drift", (0.0007, 0.0012), ("none", "minor", "beyond minor"),
           "Graziotti et al., shake-table tests of a terraced house's end unit, as cited by Sarhosis et al. "
           "(2021), section 1: 0.07 % no damage, 0.12 % minor structural damage"),
    Limits("drift_class_en_1998_1", "drift", (0.005, 0.0075, 0.01),
           ("up to 0.5 %", "up to 0.75 %", "up to 1 %", "over 1 %"),
           "EN 1998-1, 4.4.3.2, as cited by Sarhosis et al. (2021), section 2: storey drift under the frequent "
           "earthquake with brittle, ductile, no non-structural elements attached"),
    Limits("drift_class_asce_7_16", "drift", (1 / 600, 1 / 400), ("up to 1/600", "up to 1/400", "over 1/400"),
           "ASCE 7-16, as cited by Sarhosis et al. (2021), section 2: usual allowable drift"),
    Limits("psi_class", "psi", (1.0, 2.0, 3.5, 8.0),
           ("not visible", "visible", "light", "beyond light", "near collapse"),
           "P. A. Korswagen, dissertation on light damage of masonry, TU Delft: Psi = 1 just visible (0.1 mm), 2 "
           "about 1 mm, 3.5 about 5 mm and the end of light damage, 8 near collapse"),
)


def classes(max_drift_ratio, max_psi):
    """Names of the classes of a maximum drift ratio [-] and a maximum Psi [-] by every one of LIMITS."""
    values = {"drift": max_drift_ratio, "psi": max_psi}
    return {limits.name: limits.classify(values[limits.measure]) for limits in LIMITS}
