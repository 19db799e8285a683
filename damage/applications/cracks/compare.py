"""Comparison of histories: two solvers, two time steps, two discretisations, a run and an ensemble.

Up to the first failure the drift is compared sample by sample.  After it two correct solutions
diverge, since undamped joints that open and close amplify rounding errors (the system is chaotic).
Extremes of the entire run are therefore compared within TOLERANCES, which are the scatter of one
solver under rounding.  A *first* history is compared with a *second* one, or with the median of
several.
"""

import numpy as np
import pandas as pd

from damage.applications.cracks.patterns import compare_patterns, describe_patterns
from damage.errors import InputError
from damage.history.moments import BREAKS, JOINT_STATES, check_samples, state_codes
from damage.history.reader import History
from damage.index import THRESHOLD
from damage.measure.cycles import NOISE, upward_crossings
from damage.measure.summary import summarise

# share of the peak drift [-]: two runs have diverged where their drifts differ by more
DIVERGED = 0.01


TOLERANCES = {
    "max_drift_ratio": (0.0, 0.02),
    "cycle_length_s": (0.0, 0.02),
    "period_s": (0.0, 0.005),
    "peak_base_shear_n": (0.0, 0.06),
    "DI": (0.003, 0.1),
    "DI_open": (0.001, 0.3),
    "DI_slip_shear_limit": (0.003, 0.2),
    "Psi": (0.1, 0.15),
}
"""{measure: (absolute, in its unit, relative [-])}, of which the larger holds, for two solvers with
equal contact points: the scatter of one solver under rounding.

Psi: of the 49 points of `harmonic` and `ida` in `docs/tables` with Psi above 0.5 and more than two
runs, the farthest run lies within 15 % of the median in 46, within 10 % in 44; YADE within 14 % in
the 42 of `crosscheck`.  15 % are 1.6 times the mean width, or 2.5 times the number of cracks.
"""
DRIFT_TOLERANCE = 0.005  # RMS difference of the drift before the first failure over its RMS [-]


def compare(first: History, others: list[History]) -> dict:
    """Comparison of a History with others of the same wall, a plain dictionary.

    first, others: paths.  figures: {name: {"first", "median" and "range" of the others, "allowed",
    "agrees"}} of the measures of TOLERANCES.  drift, joints: `compare_drift` and `compare_joints`
    with the first of the others; patterns: `damage.applications.cracks.patterns.compare_patterns`;
    slip: criterion of DI.  agrees: whether all figures and the drift agree.

    Raises InputError where a history has no sample, they are of different walls, or some have a
    motion and some, as of ground that settles alone, have none.

    >>> sorted(compare(history, [history]))
    ['agrees', 'drift', 'figures', 'first', 'joints', 'others', 'patterns', 'slip']
    """
    for history in (first, *others):
        check_samples(history)
        if history.wall != first.wall or len(history.bodies) != len(first.bodies):
            raise InputError(
                f"{history.path} is of wall {history.wall} with {len(history.bodies)} bodies, "
                f"{first.path} of {first.wall} with {len(first.bodies)}; compare runs of one wall"
            )
        if history.moving.empty != first.moving.empty:
            still, moved = (history, first) if history.moving.empty else (first, history)
            raise InputError(
                f"{still.path} has no motion, {moved.path} has one; compare runs that both have"
                " one, or both settle alone"
            )
    numbers = _compare_numbers(first, others)
    drift = compare_drift(first, others[0])
    judged = [row["agrees"] for row in (*numbers.values(), drift) if row["agrees"] is not None]
    return {
        "first": str(first.path),
        "others": [str(other.path) for other in others],
        "slip": "displacement",
        "figures": numbers,
        "drift": drift,
        "joints": compare_joints(first, others[0]),
        "patterns": compare_patterns(first, others[0]),
        "agrees": all(judged),
    }


def numbers_of(history: History) -> dict:
    """{measure of TOLERANCES: value} of a History, None where a measure does not apply.

    >>> sorted(numbers_of(history))[:3]
    ['DI', 'DI_open', 'DI_slip_shear_limit']
    """
    summary = summarise(history)
    return {
        "max_drift_ratio": summary["max_drift_ratio"],
        "cycle_length_s": cycle_length(history.series),
        "period_s": summary["period_s"],
        "peak_base_shear_n": summary["peak_base_shear_n"],
        "DI": summary["max"]["DI"],
        "DI_open": summary["max"]["DI_open"],
        "DI_slip_shear_limit": summary["max_shear_limit"]["DI_slip"],
        "Psi": summary["max_psi"],
    }


def cycle_length(series: pd.DataFrame) -> float | None:
    """Mean duration of the full cycles of the drift in the rest stage of the first event [s], None
    without one; series: of a History."""
    rest = series[(series["stage"] == "rest") & (series["shock"] == 1)]
    # every one, ripples too
    crossings = upward_crossings(rest["time_s"], rest["drift_ratio"], rearm=0.0)
    return (
        float((crossings[-1] - crossings[0]) / (len(crossings) - 1)) if len(crossings) > 1 else None
    )


def _compare_numbers(first, others):
    mine = numbers_of(first)
    theirs = [numbers_of(other) for other in others]
    rows = {}
    for name in TOLERANCES:
        values = [numbers[name] for numbers in theirs]
        if mine[name] is None or None in values:
            continue
        median = float(np.median(values))
        allowed = allowed_difference(name, median)
        rows[name] = {
            "first": mine[name],
            "median": median,
            "range": [min(values), max(values)],
            "allowed": allowed,
            "agrees": bool(abs(mine[name] - median) <= allowed),
        }
    return rows


def allowed_difference(name: str, value: float) -> float:
    """Largest allowed difference of a measure of TOLERANCES from `value` of the second history, in
    its unit.

    >>> round(allowed_difference("DI", 0.1), 4)
    0.01
    """
    absolute, relative = TOLERANCES[name]
    return max(absolute, relative * abs(value))


def compare_drift(first: History, second: History) -> dict:
    """Differences of the drift ratios of two Histories over time, a plain dictionary.

    first_failure_s: time of the first failure in either run [s], None without one;
    rms_before_failure: RMS difference up to it over the RMS of the first run [-], compared with
    `allowed` in `agrees`, both None where it came before the drift that is compared;
    diverged_at_s: first time at which they differ by more than DIVERGED of the peak [s], None where
    they never do;
    rms_whole: the RMS difference of the entire runs [-].

    >>> bool(compare_drift(history, history)["agrees"])
    True
    """
    time, first_drift, second_drift = _common_drift(first, second)
    breaks = [
        history.events["time_s"][history.events["kind"].isin(BREAKS)] for history in (first, second)
    ]
    failure = float(np.concatenate(breaks).min(initial=np.inf))
    before = time <= failure
    difference = first_drift - second_drift
    rms = None
    if before.any():
        scale = np.sqrt(np.mean(first_drift[before] ** 2))
        rms = float(np.sqrt(np.mean(difference[before] ** 2)) / scale) if scale > NOISE else 0.0
    peak = np.abs(first_drift).max(initial=NOISE)
    apart = np.flatnonzero(np.abs(difference) > DIVERGED * peak)
    return {
        "first_failure_s": None if np.isinf(failure) else failure,
        "rms_before_failure": rms,
        "allowed": DRIFT_TOLERANCE,
        "agrees": None if rms is None else bool(rms <= DRIFT_TOLERANCE),
        "diverged_at_s": float(time[apart[0]]) if len(apart) else None,
        "rms_whole": (
            float(np.sqrt(np.mean(difference**2) / np.mean(first_drift**2)))
            if peak > NOISE
            else 0.0
        ),
    }


def _common_drift(first, second):
    """Times that both runs cover [s], and both drift ratios there, each (n,): outside the
    settlement and settling stages, or in the settlement where there is no other.

    Interpolated by cubic splines: linear interpolation between samples of 2 ms would reduce the
    amplitude of a vibration of 0.06 s by 0.4 %.
    """
    from scipy.interpolate import CubicSpline

    frames = [
        history.series if history.moving.empty else history.moving for history in (first, second)
    ]
    start = max(frame["time_s"].iloc[0] for frame in frames)
    end = min(frame["time_s"].iloc[-1] for frame in frames)
    time = frames[0]["time_s"].to_numpy()
    time = time[(time >= start) & (time <= end)]
    if len(time) < 4:
        return time, *(np.interp(time, frame["time_s"], frame["drift_ratio"]) for frame in frames)
    return time, *(CubicSpline(frame["time_s"], frame["drift_ratio"])(time) for frame in frames)


def joints_ever(history: History) -> pd.DataFrame:
    """States that the joints of a History ever had: a DataFrame indexed by (first_body,
    second_body).

    The contact points between two bodies are one joint, so that runs of different discretisations
    can be compared; all supports are body -1, so that runs on one support and on one below each
    brick can be, too.
    Columns: opened (by more than THRESHOLD), slipped (ever at the shear limit) and broken (failed),
    bool; first_break_s: time of the first failure [s], NaN without one; x_m, z_m: mean place;
    state: index of `damage.history.moments.JOINT_STATES` from opened and slipped.

    >>> sorted(joints_ever(history))
    ['broken', 'first_break_s', 'opened', 'slipped', 'state', 'x_m', 'z_m']
    """
    breaks = history.events[history.events["kind"].isin(BREAKS)]
    first = breaks.groupby("joint")["time_s"].min().reindex(range(len(history.joints)))
    points = pd.DataFrame(
        {
            "opened": (history.opening_m > THRESHOLD).any(axis=0),
            "slipped": history.at_limit.any(axis=0),
            "broken": history.broken.any(axis=0),
            "first_break_s": first.to_numpy(),
            "x_m": history.joints["x_m"],
            "z_m": history.joints["z_m"],
        }
    )
    joints = points.groupby(joint_keys(history)).agg(
        {
            "opened": "max",
            "slipped": "max",
            "broken": "max",
            "first_break_s": "min",
            "x_m": "mean",
            "z_m": "mean",
        }
    )
    joints["state"] = state_codes(joints["opened"], joints["slipped"])
    return joints


def joint_keys(history: History) -> list:
    """First and second body of each contact point of a History, by which `joints_ever` has its
    joints."""
    return [history.joints["first_body"].clip(lower=-1), history.joints["second_body"]]


def compare_joints(first: History, second: History) -> dict:
    """Agreement of two Histories on the joints that failed in either run, a plain dictionary.

    broke_in_either, broke_in_both, same_state: numbers of joints; kappa: `cohens_kappa` of their
    states; median_break_time_difference_s: of the joints that failed in both [s], None without any.

    >>> float(compare_joints(history, history)["kappa"])
    1.0
    """
    here = joints_ever(first)
    second_states = joints_ever(second)
    either = here["broken"] | second_states["broken"]
    both = here["broken"] & second_states["broken"]
    shift = (here["first_break_s"] - second_states["first_break_s"])[both].dropna()
    return {
        "broke_in_either": int(either.sum()),
        "broke_in_both": int(both.sum()),
        "kappa": cohens_kappa(here["state"][either], second_states["state"][either]),
        "same_state": int((here["state"] == second_states["state"])[either].sum()),
        "median_break_time_difference_s": float(shift.abs().median()) if len(shift) else None,
    }


def cohens_kappa(first: np.ndarray, second: np.ndarray) -> float | None:
    """Cohen's kappa [-] (1960, doi:10.1177/001316446002000104) of two classifications; None where
    they are empty.

    here, there: (n,) indices of `damage.history.moments.JOINT_STATES`.  1: they agree in all; 0: as
    often as by chance.

    >>> round(cohens_kappa(np.array([True, True, False]), np.array([True, False, False])), 2)
    0.4
    """
    first = np.asarray(first)
    second = np.asarray(second)
    if len(first) == 0:
        return None
    mine, theirs = (np.bincount(values, minlength=len(JOINT_STATES)) for values in (first, second))
    chance = float(mine @ theirs) / len(first) ** 2
    observed = float(np.mean(first == second))
    return 1.0 if chance == 1.0 else (observed - chance) / (1 - chance)


def describe(result: dict) -> str:
    """The result of `compare` as text, a line each for people.

    >>> describe(compare(history, [history])).splitlines()[-1]
    'verdict: within the tolerances'
    """
    lines = [
        f"first:  {result['first']}",
        *(f"others: {path}" for path in result["others"]),
        f"{'':22s}{'first':>12s}{'median':>12s}{'range':>26s}{'allowed':>12s}",
    ]
    for name, row in result["figures"].items():
        low, high = row["range"]
        lines.append(
            f"{name:22s}{row['first']:12.5g}{row['median']:12.5g}{low:13.5g}{high:13.5g}"
            f"{row['allowed']:12.3g}  {'agrees' if row['agrees'] else 'DIFFERS'}"
        )
    drift = result["drift"]
    joints = result["joints"]
    span = (
        "of the whole run, in which nothing fails"
        if drift["first_failure_s"] is None
        else f"before the first failure at {drift['first_failure_s']:.4f} s"
    )
    diverged = "never" if drift["diverged_at_s"] is None else f"at {drift['diverged_at_s']:.3f} s"
    judged = (
        "not compared, nothing moved yet"
        if drift["agrees"] is None
        else (
            f"RMS {100 * drift['rms_before_failure']:.3f} % (allowed {100 * drift['allowed']:.1f}"
            f" %)  {'agrees' if drift['agrees'] else 'DIFFERS'}"
        )
    )
    lines.append(f"drift {span}: {judged}; diverged by 1 % of the peak {diverged}")
    if joints["kappa"] is not None:
        lines.append(
            f"joints between bricks: {joints['broke_in_either']} failed in either run, "
            f"{joints['broke_in_both']} in both, {joints['same_state']} to the same state, "
            f"kappa {joints['kappa']:.3f}"
        )
    lines += describe_patterns(result["patterns"])
    lines.append(
        "verdict: " + ("within the tolerances" if result["agrees"] else "NOT within the tolerances")
    )
    return "\n".join(lines)
