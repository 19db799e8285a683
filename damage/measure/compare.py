"""Compare histories: two solvers, two time steps, two discretisations, a run and an ensemble.

After the first failure two correct runs part, since undamped joints that open and close amplify
rounding: then only numbers of the whole run are compared, against tolerances that are what scatter does to
one and the same code.  Of several second histories the median counts.
"""

from dataclasses import dataclass

import numpy as np
import pandas as pd

from damage.errors import InputError
from damage.history.moments import BREAKS, STATES, state_codes
from damage.index import THRESHOLD
from damage.measure.patterns import common_slip, compare_patterns, describe_patterns
from damage.measure.summary import summarise
from damage.measure.vibration import NOISE, upward_crossings

DIVERGED = 0.01  # of the peak drift: two runs have diverged


@dataclass(frozen=True)
class Tolerance:
    """Agreement within `absolute` or `relative` times the second value, the larger of both."""

    absolute: float = 0.0
    relative: float = 0.0

    def allowed(self, value):
        return max(self.absolute, self.relative * abs(value))


TOLERANCES = {
    "max_drift_ratio": Tolerance(relative=0.02),
    "cycle_length_s": Tolerance(relative=0.02),
    "period_s": Tolerance(relative=0.005),
    "peak_base_shear_n": Tolerance(relative=0.06),
    "DI": Tolerance(absolute=0.003, relative=0.1),
    "DI_open": Tolerance(absolute=0.001, relative=0.3),
    "DI_slip_shear_limit": Tolerance(absolute=0.003, relative=0.2),
}
"""Of correct solvers with the same contact points; runs of one code that differ by rounding spread as much."""
DRIFT_TOLERANCE = 0.005  # normalised RMS of the drift before the first failure


def compare(first, others):
    """Compare a History with others of the same wall; a plain dictionary.

    figures: {name: first, median, range of the others, allowed, agrees}; drift: RMS before the first
    failure, lag, instant of divergence; joints: Cohen's kappa and first-break times; patterns: fractions skill
    scores; each of the last three with the first of the others.  slip: the criterion of DI, `displacement` where all
    have offsets, and else `accumulated`.  agrees: figures and drift.
    """
    for history in (first, *others):
        if len(history.series) == 0:
            raise InputError(f"{history.path} holds no sample; compare runs that have begun")
        if history.wall != first.wall or len(history.bodies) != len(first.bodies):
            raise InputError(f"{history.path} is of wall {history.wall} with {len(history.bodies)} bodies, "
                             f"{first.path} of {first.wall} with {len(first.bodies)}; compare runs of one wall")
    numbers = _compare_numbers(first, others)
    drift = compare_drift(first, others[0])
    judged = [row["agrees"] for row in numbers.values()] + [drift["agrees"]]
    return {"first": str(first.path), "others": [str(other.path) for other in others],
            "slip": common_slip(first, *others), "figures": numbers,
            "drift": drift, "joints": compare_joints(first, others[0]), "patterns": compare_patterns(first, others[0]),
            "agrees": all(judged)}


# --- numbers of the whole run -------------------------------------------------------------------

def numbers_of(history, slip="displacement"):
    """The numbers that TOLERANCES judge, None where a run has none of them; slip: criterion of DI."""
    summary = summarise(history, slip=slip)
    return {"max_drift_ratio": summary["max_drift_ratio"], "cycle_length_s": cycle_length(history.series),
            "period_s": summary["period_s"], "peak_base_shear_n": summary["peak_base_shear_n"],
            "DI": summary["max"]["DI"], "DI_open": summary["max"]["DI_open"],
            "DI_slip_shear_limit": summary["max_shear_limit"]["DI_slip"]}


def cycle_length(series):
    """Mean length of the full cycles of the drift in the first event's rest [s], None without one."""
    rest = series[(series["stage"] == "rest") & (series["shock"] == 1)]
    crossings = upward_crossings(rest["time_s"], rest["drift_ratio"], rearm=0.0)  # every one, ripples too
    return float((crossings[-1] - crossings[0]) / (len(crossings) - 1)) if len(crossings) > 1 else None


def _compare_numbers(first, others):
    slip = common_slip(first, *others)
    mine, theirs = numbers_of(first, slip), [numbers_of(other, slip) for other in others]
    rows = {}
    for name, tolerance in TOLERANCES.items():
        values = [numbers[name] for numbers in theirs]
        if mine[name] is None or None in values:
            continue
        median = float(np.median(values))
        allowed = tolerance.allowed(median)
        rows[name] = {"first": mine[name], "median": median, "range": [min(values), max(values)],
                      "allowed": allowed, "agrees": bool(abs(mine[name] - median) <= allowed)}
    return rows


# --- the drift over time ------------------------------------------------------------------------

def compare_drift(first, second):
    """Drift up to the first failure in either run: normalised RMS, lag [s]; and the instant [s] from
    which the two differ by more than 1 % of the peak, None where they never do."""
    time, here, there = _common_drift(first, second)
    failure = min(_first_break(first), _first_break(second))
    before = time <= failure
    difference, scale = here - there, np.sqrt(np.mean(here[before] ** 2))
    rms = float(np.sqrt(np.mean(difference[before] ** 2)) / scale) if scale > NOISE else 0.0
    peak = np.abs(here).max(initial=NOISE)
    apart = np.flatnonzero(np.abs(difference) > DIVERGED * peak)
    return {"first_failure_s": None if np.isinf(failure) else failure, "rms_before_failure": rms,
            "allowed": DRIFT_TOLERANCE, "agrees": bool(rms <= DRIFT_TOLERANCE),
            "lag_s": _lag(time, here, there), "diverged_at_s": float(time[apart[0]]) if len(apart) else None,
            "rms_whole": float(np.sqrt(np.mean(difference**2) / np.mean(here**2))) if peak > NOISE else 0.0}


def _common_drift(first, second):
    """Times before settling that both runs have, and both drifts there.

    By cubic splines: lines between samples of 2 ms would take 0.4 % off a vibration of 0.06 s.
    """
    from scipy.interpolate import CubicSpline

    frames = [history.moving for history in (first, second)]
    end = min(frame["time_s"].iloc[-1] for frame in frames)
    time = frames[0]["time_s"].to_numpy()
    time = time[time <= end]
    if len(time) < 4:
        return time, *(np.interp(time, frame["time_s"], frame["drift_ratio"]) for frame in frames)
    return time, *(CubicSpline(frame["time_s"], frame["drift_ratio"])(time) for frame in frames)


def _first_break(history):
    breaks = history.events[history.events["kind"].isin(BREAKS)]
    return float(breaks["time_s"].min()) if len(breaks) else np.inf


def _lag(time, here, there):
    """How much later the second drift is [s], by the peak of the cross-correlation."""
    if len(time) < 8 or min(np.abs(here).max(), np.abs(there).max()) <= NOISE:
        return 0.0
    step = (time[-1] - time[0]) / (len(time) - 1)
    product = np.correlate(there, here, mode="full")
    k = int(np.clip(np.argmax(product), 1, len(product) - 2))
    low, mid, high = product[k - 1:k + 2]
    curvature = low - 2 * mid + high
    fine = 0.5 * (low - high) / curvature if curvature != 0 else 0.0
    return float((k + fine - (len(here) - 1)) * step)


# --- joint by joint -----------------------------------------------------------------------------

def joints_ever(history, threshold=THRESHOLD):
    """Extremes of each joint between two bodies: DataFrame indexed by (first_body, second_body).

    state: index of `damage.history.moments.STATES`, slipped by the shear limit, broken alone given by broken: bool;
    first_break_s (NaN: never); x_m, z_m.  Contact points of one pair of bodies are one joint, so that any
    discretisation will do.
    """
    breaks = history.events[history.events["kind"].isin(BREAKS)]
    first = breaks.groupby("joint")["time_s"].min().reindex(range(len(history.joints)))
    points = pd.DataFrame({
        "opened": (history.opening_m > threshold).any(axis=0), "slipped": history.at_limit.any(axis=0),
        "broken": history.broken.any(axis=0), "first_break_s": first.to_numpy(),
        "x_m": history.joints["x_m"], "z_m": history.joints["z_m"]})
    keys = [history.joints["first_body"], history.joints["second_body"]]
    joints = points.groupby(keys).agg({"opened": "max", "slipped": "max", "broken": "max",
                                       "first_break_s": "min", "x_m": "mean", "z_m": "mean"})
    joints["state"] = state_codes(joints["opened"], joints["slipped"])
    return joints


def compare_joints(first, second):
    """Agreement on the joints that broke in either run, as numbers."""
    here, there = joints_ever(first), joints_ever(second)
    either = here["broken"] | there["broken"]
    both = here["broken"] & there["broken"]
    shift = (here["first_break_s"] - there["first_break_s"])[both].dropna()
    return {"broke_in_either": int(either.sum()), "broke_in_both": int(both.sum()),
            "kappa": cohens_kappa(here["state"][either], there["state"][either]),
            "same_state": int((here["state"] == there["state"])[either].sum()),
            "median_break_time_difference_s": float(shift.abs().median()) if len(shift) else None}


def cohens_kappa(here, there):
    """Cohen's kappa (1960, doi:10.1177/001316446002000104) of two classifications, None without any.

    1 where they agree in all, 0 where they agree as often as by chance.
    """
    here, there = np.asarray(here), np.asarray(there)
    if len(here) == 0:
        return None
    shares = np.array([[np.mean(values == state) for state in range(len(STATES))] for values in (here, there)])
    chance, observed = float(shares[0] @ shares[1]), float(np.mean(here == there))
    return 1.0 if chance == 1.0 else (observed - chance) / (1 - chance)


def describe(result):
    """A comparison as lines for people."""
    lines = [f"first:  {result['first']}", *(f"others: {path}" for path in result["others"]),
             *([] if result["slip"] == "displacement" else
               ["slip in DI and in visible joints: accumulated, since not all histories have offsets"]),
             f"{'':22s}{'first':>12s}{'median':>12s}{'range':>26s}{'allowed':>12s}"]
    for name, row in result["figures"].items():
        low, high = row["range"]
        lines.append(f"{name:22s}{row['first']:12.5g}{row['median']:12.5g}{low:13.5g}{high:13.5g}"
                     f"{row['allowed']:12.3g}  {'agrees' if row['agrees'] else 'DIFFERS'}")
    drift, joints = result["drift"], result["joints"]
    span = ("of the whole run, in which nothing fails" if drift["first_failure_s"] is None
            else f"before the first failure at {drift['first_failure_s']:.4f} s")
    diverged = "never" if drift["diverged_at_s"] is None else f"at {drift['diverged_at_s']:.3f} s"
    lines.append(f"drift {span}: RMS {100 * drift['rms_before_failure']:.3f} % (allowed "
                 f"{100 * drift['allowed']:.1f} %)  {'agrees' if drift['agrees'] else 'DIFFERS'}; diverged by 1 % "
                 f"of the peak {diverged}; lag {1e3 * drift['lag_s']:.2f} ms")
    if joints["kappa"] is not None:
        lines.append(f"joints between bricks: {joints['broke_in_either']} broke in either run, "
                     f"{joints['broke_in_both']} in both, {joints['same_state']} to the same state, "
                     f"kappa {joints['kappa']:.3f}")
    lines += describe_patterns(result["patterns"])
    lines.append("verdict: " + ("within the tolerances" if result["agrees"] else "NOT within the tolerances"))
    return "\n".join(lines)
