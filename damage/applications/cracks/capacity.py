"""Capacity of a pushed wall, from its History: envelope, cycles and failure mode.

Force is the base shear and displacement that of the top course, as measured in a laboratory.
"""

import numpy as np
import pandas as pd
import scipy  # integrate where it is used: it starts slowly

from damage.applications.cracks.loops import LOOP, loop_measures
from damage.errors import InputError
from damage.history.reader import History
from damage.index import COMPONENTS, THRESHOLD
from damage.measure.pushed import SECANT_SHARE, since_the_push
from damage.motion.loading import EASE_S, TopDisplacement
from damage.wall.layout import lay_out

CYCLE_COLUMNS = (
    "cycle",
    "amplitude_pct",
    *LOOP,
    *(f"{name}_at_max" for name in COMPONENTS),
    *(f"{name}_at_min" for name in COMPONENTS),
)
STAIR_SHARE = 1 / 3
"""Share of the slipped length on stairs [-] from which a shear mode is diagonal; 0 is sliding along
a bed joint, 1 an ideal stair."""
ULTIMATE_SHARE = 0.8
"""Share of the peak force to which the envelope falls at the ultimate drift (EN 1998-3)."""
ULTIMATE_DRIFT_NOTE = (
    "predicted ones were 0.07 to 2.3 of the tested ones, off by more than a factor of 2 in 8 of 11"
    " walls"
)
"""What a simulated ultimate drift is worth: of the ten shear walls of
docs/tables/shear_walls_prediction.csv and of COMP2_5, predicted before their results were seen."""
WINDOWS = 200
"""Windows up to the largest drift over which the curve of a push is averaged."""
FAR_ENOUGH = 0.99
"""Share of a drift that counts as the drift [-]."""


def pushed_loading(history: History) -> TopDisplacement:
    """The TopDisplacement of a pushed History; raises InputError for another loading."""
    if not isinstance(history.loading, TopDisplacement):
        raise InputError(
            f"{history.path} is a run under {history.loading.name}; give one of --pushover or"
            " --cyclic"
        )
    return history.loading


def envelope(history: History, sign: int = 1) -> pd.DataFrame:
    """Envelope of a pushed History in one direction, a DataFrame of drift_ratio [-] and force_n,
    positive on loading.

    Its points are the samples whose drift exceeds all earlier ones.  sign: +1 or -1, the direction
    along x.

    >>> envelope(pushed).round(4).iloc[-1].tolist()
    [0.002, 10000.0]
    """
    force, drift = (sign * values for values in since_the_push(history)[:2])
    reached = np.maximum.accumulate(np.concatenate([[0.0], drift[:-1]]))
    new = drift > reached
    return pd.DataFrame({"drift_ratio": drift[new], "force_n": force[new]})


def backbone(history: History, sign: int = 1) -> pd.DataFrame:
    """Envelope of a cyclic History in one direction as laboratories draw it: a DataFrame as of
    `envelope`.

    Its points are those of largest force and of largest drift of each cycle whose drift exceeds all
    earlier ones.  The branch between two cycles is left out: a wall that slides has its full force
    in the other direction before it is back at zero drift, so that the samples of an `envelope`
    begin with that force.

    >>> backbone(cyclic).iloc[-1].round(3).to_dict()
    {'drift_ratio': 0.002, 'force_n': 824.844}
    """
    force, drift = (sign * values for values in since_the_push(history)[:2])
    edges = cycle_edges(history)
    points = [0.0]
    rows = []
    for start, end in zip(edges, edges[1:]):
        for values in (force, drift):
            most = start + int(np.argmax(values[start : end + 1]))
            if drift[most] > points[-1]:
                points.append(drift[most])
                rows.append((drift[most], force[most]))
    return pd.DataFrame(rows, columns=["drift_ratio", "force_n"])


def capacity_curve(history: History, sign: int = 1) -> pd.DataFrame:
    """The `backbone` of a cyclic History, the `envelope` of one that is pushed over or ended in its
    first cycle.

    >>> capacity_curve(pushed).columns.tolist()
    ['drift_ratio', 'force_n']
    """
    curve = backbone(history, sign) if pushed_loading(history).cycles else ()
    return curve if len(curve) else envelope(history, sign)


def averaged(curve: pd.DataFrame, width: float) -> pd.DataFrame:
    """A curve whose points are means over windows of the drift, `width` [-] wide, side by side:
    without the oscillations that sudden failures cause."""
    window = np.floor(curve["drift_ratio"] / width)
    return curve.groupby(window.to_numpy(), sort=True).mean().reset_index(drop=True)


def mean_force(curve: pd.DataFrame, drift: float) -> float:
    """Mean force [N] of an `envelope` from zero to a drift [-]: the energy that it takes up over
    the displacement.

    >>> round(mean_force(capacity_curve(pushed), 0.002))
    7500
    """
    drifts, force = _from_zero(curve)
    inside = drifts < drift
    drifts, force = (
        np.append(drifts[inside], drift),
        np.append(force[inside], np.interp(drift, drifts, force)),
    )
    return float(scipy.integrate.trapezoid(force, drifts) / drift)


def bilinear(curve: pd.DataFrame, height: float) -> dict[str, float]:
    """Bilinear (elastic-plastic) idealisation of an `envelope`, of equal area up to the ultimate
    drift.

    The elastic stiffness is the secant at SECANT_SHARE of the peak force.  The ultimate drift is
    the last one at which the force is at least ULTIMATE_SHARE of the peak.  Between the points of
    the curve the force is linear.  curve: an `envelope` or `backbone`; height: of the wall [m].
    Returns {"stiffness_n_per_m", "force_n", "elastic_drift" [-], "ultimate_drift" [-], "energy_j":
    below the line}.

    >>> sorted(bilinear(capacity_curve(pushed), 0.45))
    ['elastic_drift', 'energy_j', 'force_n', 'stiffness_n_per_m', 'ultimate_drift']
    """
    drift, force = _from_zero(curve)
    peak = force.max()
    secant = int(np.argmax(force >= SECANT_SHARE * peak))
    secant_drift = _crossing(drift, force, secant - 1, SECANT_SHARE * peak)
    stiffness = SECANT_SHARE * peak / (secant_drift * height)
    last = int(np.flatnonzero(force >= ULTIMATE_SHARE * peak)[-1])
    ultimate = (
        drift[last]
        if last + 1 == len(drift)
        else _crossing(drift, force, last, ULTIMATE_SHARE * peak)
    )
    area = mean_force(curve, ultimate) * ultimate * height
    root = max(0.0, (ultimate * height) ** 2 - 2 * area / stiffness)
    yield_force = float(stiffness * (ultimate * height - np.sqrt(root)))
    return {
        "stiffness_n_per_m": float(stiffness),
        "force_n": yield_force,
        "elastic_drift": yield_force / float(stiffness * height),
        "ultimate_drift": float(ultimate),
        "energy_j": float(area),
    }


def loaded_curves(history: History) -> dict[str, pd.DataFrame]:
    """{"positive": curve, "negative": curve}, the `capacity_curve` of a History in each direction
    in which it was loaded; that of a push is `averaged` over WINDOWS windows of the drift.  Raises
    InputError where there is none.

    >>> {side: round(curve["force_n"].max()) for side, curve in loaded_curves(cyclic).items()}
    {'positive': 825, 'negative': 825}
    """
    cyclic = pushed_loading(history).cycles > 0
    curves = {}
    for side, sign in (("positive", 1), ("negative", -1))[: 1 + cyclic]:
        curve = capacity_curve(history, sign)
        if len(curve) and curve["force_n"].max() > 0:
            width = float(curve["drift_ratio"].max()) / WINDOWS
            curves[side] = curve if cyclic else averaged(curve, width)
    if not curves:
        raise InputError(
            f"{history.path}: the top was not pushed before the run ended ({history.status});"
            " expected an envelope; run it again"
        )
    return curves


def capacity(history: History, to: float | None = None) -> dict:
    """Figures of a pushed History, means over its `loaded_curves`, a plain dictionary.

    peak_force_n, drift_at_peak [-]: of the curve; those of `bilinear`; mean_force_n: up to the
    drift `to` [-], of None the ultimate drift, and left_n: force there, both None where the run did
    not go so far; farthest_drift: what was reached; ended: whether the force fell below
    ULTIMATE_SHARE of the peak; failure: `mode_shares` up to the ultimate drift;
    ultimate_drift_note: how far predicted ones were off.

    >>> round(float(capacity(pushed)["peak_force_n"]))
    10000
    """
    height = history.attributes["drift_height_m"]
    curves = loaded_curves(history).values()
    lines = [bilinear(curve, height) for curve in curves]
    means = {name: float(np.mean([line[name] for line in lines])) for name in lines[0]}
    peaks = np.mean(
        [curve.loc[curve["force_n"].idxmax(), ["force_n", "drift_ratio"]] for curve in curves],
        axis=0,
    )
    to = to or means["ultimate_drift"]
    farthest = min(float(curve["drift_ratio"].max()) for curve in curves)
    mean = left = None
    if farthest >= FAR_ENOUGH * to:
        mean = float(np.mean([mean_force(curve, to) for curve in curves]))
        left = float(
            np.mean([np.interp(to, curve["drift_ratio"], curve["force_n"]) for curve in curves])
        )
    return {
        "peak_force_n": float(peaks[0]),
        "drift_at_peak": float(peaks[1]),
        **means,
        "to": to,
        "mean_force_n": mean,
        "left_n": left,
        "farthest_drift": farthest,
        "ended": means["ultimate_drift"] <= FAR_ENOUGH * farthest,
        "failure": mode_shares(history, until=means["ultimate_drift"]),
        "ultimate_drift_note": ULTIMATE_DRIFT_NOTE,
    }


def _from_zero(curve):
    """Drift and force of a curve, arrays that begin at the origin."""
    return tuple(np.concatenate([[0.0], curve[name]]) for name in ("drift_ratio", "force_n"))


def _crossing(drift, force, before, level):
    """Drift at which the force reaches a level between the points `before` and the next one."""
    share = (level - force[before]) / (force[before + 1] - force[before])
    return drift[before] + share * (drift[before + 1] - drift[before])


def drift_at_first_crack(history: History) -> float | None:
    """|Drift ratio| at the first sample in which a contact point has opened, or slipped by
    displacement, by more than 0.1 mm [-]; None without one.

    >>> drift_at_first_crack(pushed)
    0.0002
    """
    visible = (history.opening_m > THRESHOLD) | (np.abs(history.offset_m) > THRESHOLD)
    first = np.flatnonzero(visible.any(axis=1))
    return float(abs(since_the_push(history)[1][first[0]])) if len(first) else None


def cycle_edges(history: History) -> np.ndarray:
    """Samples (n_cycles + 1,) between which the prescribed displacement completes a cycle: from
    zero up, down and back.

    A run that stopped early has its completed cycles.  Raises InputError for another loading.
    """
    loading = pushed_loading(history)
    time_s = history.time_s
    if "follows" not in history.parameters["loading"]:
        raise InputError(
            f"{history.path}: an earlier version moved its top by the drift times the top's own"
            " height; expected cycles whose drift is what was asked for; run it again"
        )
    height = history.attributes["drift_height_m"]
    if loading.floor_shares:
        layout = lay_out(history.masonry_wall, history.model)
        height = layout.height_of_push(loading.floor_shares)
    asked = loading.top_displacement(time_s, height)
    upwards = np.flatnonzero((asked[:-1] <= 0) & (asked[1:] > 0))
    whole = len(loading.amplitudes_pct) * loading.cycles
    ended = time_s[-1] >= loading.schedule(height)[0][-1] - EASE_S
    return np.append(upwards[:whole], len(asked) - 1) if ended else upwards


def cycles_table(history: History) -> pd.DataFrame:
    """Table of the cycles of a cyclic run, a DataFrame with CYCLE_COLUMNS, a row for each cycle.

    A cycle is a loop of base shear and drift (`loop_measures`).  The index is that at the samples
    of largest drift in either direction, not a running maximum.  Raises InputError for another
    loading.

    >>> cycles_table(cyclic)[["cycle", "amplitude_pct", "max_force_kn"]].round(2).values.tolist()
    [[1.0, 0.2, 0.82], [2.0, 0.2, 0.82], [3.0, 0.2, 0.82]]
    """
    loading = pushed_loading(history)
    index = history.index()
    force, drift, _ = since_the_push(history)
    edges = cycle_edges(history)
    rows = []
    for number, (start, end) in enumerate(zip(edges, edges[1:])):
        inside = slice(start, end + 1)
        ends = start + int(np.argmax(drift[inside])), start + int(np.argmin(drift[inside]))
        rows.append(
            [
                number + 1,
                loading.amplitudes_pct[number // loading.cycles],
                *loop_measures(drift[inside], force[inside], history.attributes["drift_height_m"]),
                *(index[name].iloc[sample] for sample in ends for name in COMPONENTS),
            ]
        )
    return pd.DataFrame(rows, columns=list(CYCLE_COLUMNS))


def mode_shares(history: History, until: float = np.inf) -> dict:
    """Failure mode of a wall, from the bed joints at the sample of largest |drift|, a plain
    dictionary.

    until: samples of a larger |drift| [-] do not count, as of a wall that is pushed on after its
    ultimate drift. drift_ratio: there [-]; opened_m, slipped_m: lengths that opened, or slipped by
    displacement, by more than 0.1 mm; opened_m2, slipped_m2: their opening and |slip| times length;
    stair_share: share of the slipped length beside an opened head joint, as in a stepped crack [-].
    mode: "flexure" where opened_m2 is at least slipped_m2, else "shear, diagonal" where stair_share
    is at least STAIR_SHARE, else "shear, sliding"; None where no bed joint opened or slipped.

    >>> round(float(mode_shares(pushed)["drift_ratio"]), 4)
    0.002
    """
    joints = history.joints
    brick = history.masonry_wall.brick
    drift = since_the_push(history)[1]
    sample = int(np.argmax(np.where(np.abs(drift) <= until, np.abs(drift), -1.0)))
    opening = history.opening_m[sample]
    slip = np.abs(history.offset_m[sample])
    length = joints["length_m"].to_numpy()
    bed = (joints["kind"] == "bed").to_numpy()
    slipped = bed & (slip > THRESHOLD)
    opened = bed & (opening > THRESHOLD)
    risers = (joints["kind"] == "head").to_numpy() & (opening > THRESHOLD)
    x = joints["x_m"].to_numpy()
    z = joints["z_m"].to_numpy()
    beside = (np.abs(x[slipped, None] - x[risers]) < brick.length / 2 * (1 - 1e-6)) & (
        np.abs(z[slipped, None] - z[risers]) < brick.height / 2 * (1 + 1e-6)
    )
    stairs = float(length[slipped][beside.any(axis=1)].sum())
    shares = {
        "drift_ratio": float(drift[sample]),
        "opened_m": float(length[opened].sum()),
        "slipped_m": float(length[slipped].sum()),
        "opened_m2": float((length * opening)[opened].sum()),
        "slipped_m2": float((length * slip)[slipped].sum()),
    }
    shares["stair_share"] = stairs / shares["slipped_m"] if slipped.any() else 0.0
    return {**shares, "mode": _mode(shares)}


def _mode(shares):
    if shares["opened_m2"] == shares["slipped_m2"] == 0:
        return None
    if shares["opened_m2"] >= shares["slipped_m2"]:
        return "flexure"
    return "shear, diagonal" if shares["stair_share"] >= STAIR_SHARE else "shear, sliding"


def draws_needed(values: np.ndarray) -> int:
    """Number of draws whose median's standard error, 1.25 s / sqrt(n), is a fortieth of it: 5 % at
    95 % confidence."""
    return int(np.ceil((1.2533 * np.std(values, ddof=1) / (0.025 * np.median(values))) ** 2))
