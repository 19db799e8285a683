"""Intensities of a motion beside one another (`python3 -m paper intensities`): how efficient each
is, and fragility curves beside records that they were not fitted to: each record of a study left
out in turn, or the records of another study.

What is compared is, at each intensity of such a record, the share of the runs that exceed a level
with the probability that the other records give it: of the single lognormal curve (`pooled`), and
of a new record (`predicted`, with the interval of the share of as many runs).  The record's own
median is compared with the interval for a new record's, too. Scores are means over the runs:
Brier's, the squared difference of probability
and outcome, and the logarithmic one; less is better, and 0.25 and 0.69 are those of a probability
of one half (T. Gneiting, A. E. Raftery, 2007, doi:10.1198/016214506000001437).
"""

from itertools import product

import numpy as np
import pandas as pd
from scipy.special import bdtr

from damage.applications.studies.fragility import exceeding, fragility
from damage.applications.studies.new_record import TAILS
from damage.applications.studies.states import STATES, check_intensity, check_states, there, unit_of
from damage.errors import InputError

LEAST_PROBABILITY = 1e-3
"""Probabilities count as no less, nor as more than one less it, in the logarithmic score: of a
study's 500 runs."""


def leave_one_out(runs, states=STATES, intensities=None):
    """A DataFrame with a row for each wall, State, intensity, record and value of it: runs of the
    record beside the curves of all others.

    runs: rows of summary.csv; intensities: columns, None for those of INTENSITIES that every run
    has.
    """
    return _compare(runs, runs, states, intensities)


def beside_unseen(runs, unseen, states=STATES, intensities=None):
    """The same of the runs of another study, `unseen`: of its records that `runs` lack, beside
    curves of all `runs`."""
    return _compare(runs, unseen[~unseen["record"].isin(runs["record"])], states, intensities)


def _compare(runs, left, states, intensities):
    if left.empty:
        raise InputError(
            "every record of the other study is in this one, too; expected some that are not;"
            " choose another study"
        )
    intensities = intensities or [name for name in there(runs) if name in there(left)]
    for table in (runs, left):
        check_states(table, states)
        for name in intensities:
            check_intensity(table, name)
    rows = [
        {"wall": wall, **row}
        for wall, of_wall in left.groupby("wall", sort=False)
        for record, of_record in of_wall.groupby("record")
        for state in states
        for intensity in intensities
        for row in _rows(
            runs[(runs["wall"] == wall) & (runs["record"] != record)], of_record, state, intensity
        )
    ]
    if not rows:
        raise InputError(
            "no run of a record that the curves of its wall leave out; expected runs of the same"
            " walls, in records; choose another study"
        )
    return pd.DataFrame(rows)


def _rows(others, of_record, state, intensity):
    """Rows of one record that the curve of the others was not fitted to."""
    if others.empty:
        return
    one = fragility(others, state.measure, state.level, intensity, replicates=0, name=state.name)
    medians = _medians(one.new_record, of_record, state, intensity) if one.new_record else {}
    for value, shaken in exceeding(of_record, state.measure, state.level).groupby(
        of_record[intensity]
    ):
        row = {
            "state": one.state,
            "measure": one.measure,
            "level": one.level,
            "intensity": intensity,
            "record": of_record["record"].iloc[0],
            "value": value,
            "unit": unit_of(intensity)[1],
            "runs": len(shaken),
            "exceeding": int(shaken.sum()),
            "observed": shaken.mean(),
            "pooled": one.probability(value),
        }
        if one.new_record:
            low, high = share_bounds(one.new_record, value, len(shaken))
            row |= {
                "predicted": one.new_record.probability([value])[0],
                "low": low,
                "high": high,
                "inside": int(low <= row["observed"] <= high),
            }
        yield row | medians


def share_bounds(new_record, intensity, n_runs):
    """Lower and upper bound (2,) of the share of n_runs that exceed at one intensity of a
    NewRecord."""
    curves, weights = new_record.curves([intensity])
    chances = bdtr(np.arange(n_runs + 1.0)[:, None], n_runs, curves[0]) @ weights
    return np.searchsorted(chances, np.array(TAILS) * (1 - 1e-12)) / n_runs


def _medians(predicted, of_record, state, intensity):
    """Bounds of a record's own median, between which it is not known, those of the NewRecord that
    is predicted, and the share of the former that lies between the latter, in ln: 0 or 1 where the
    median is known, NaN where it is unbounded on one side and need not lie outside."""
    least, most = _own_median(
        fragility(of_record, state.measure, state.level, intensity, replicates=0)
    )
    low, high = predicted.median_bounds()
    if most < low or least > high:
        share = 0.0
    elif least == 0 or most == np.inf:
        share = np.nan
    else:
        share = (
            np.log(min(most, high) / max(least, low)) / np.log(most / least)
            if most > least
            else 1.0
        )
    return {
        "own_median_low": least,
        "own_median_high": most,
        "median_low": low,
        "median_high": high,
        "median_inside": share,
    }


def _own_median(one):
    """Bounds of the median of a Fragility of one record: equal where its runs determine it, else
    the intensities between which its shares pass one half."""
    if not one.step and np.isfinite(one.median):
        return one.median, one.median
    x, (exceed,), (runs,) = one.stripes
    x, most = np.asarray(x), exceed >= runs / 2
    return tuple(sorted((x[~most].max(initial=0.0), x[most].min(initial=np.inf))))


def scores(table):
    """A DataFrame with a row for each wall, state and intensity of a table of this module, best
    first by Brier's score of the prediction; `inside` of `compared` shares, and `medians_inside` of
    `medians`, lie in their interval."""
    rows, keys = [], ["wall", "state", "measure", "level", "intensity"]
    for group, every in table.assign(predicted=table.get("predicted", np.nan)).groupby(
        keys, sort=False
    ):
        part = every.dropna(subset=["predicted"])
        if part.empty:
            continue
        # of records that have one of their own
        medians = part.drop_duplicates("record")["median_inside"].dropna()
        row = {
            "records": part["record"].nunique(),
            "runs": part["runs"].sum(),
            "compared": len(part),
            "inside": int(part["inside"].sum()),
            "medians": len(medians),
            "medians_inside": medians.sum(),
        }
        for name, end in (("predicted", ""), ("pooled", "_pooled")):
            p, share = part[name], part["observed"]
            row[f"brier{end}"] = np.average(
                share * (1 - p) ** 2 + (1 - share) * p**2, weights=part["runs"]
            )
            p = p.clip(LEAST_PROBABILITY, 1 - LEAST_PROBABILITY)
            row[f"log_score{end}"] = np.average(
                -share * np.log(p) - (1 - share) * np.log(1 - p), weights=part["runs"]
            )
        rows.append(dict(zip(keys, group)) | row)
    if not rows:
        raise InputError(
            "no record could be predicted; expected runs of four records or more, of which some"
            " exceed a level and some do not; choose another study"
        )
    first = {state: place for place, state in enumerate(table["state"].unique())}
    return pd.DataFrame(rows).sort_values(
        ["wall", "state", "brier"],
        kind="stable",
        ignore_index=True,
        key=lambda column: column.map(first) if column.name == "state" else column,
    )


def efficiency_table(runs, states=STATES, intensity=None):
    """Efficiency of intensities: a DataFrame with a row for each wall, State and intensity, best
    first.

    dispersion: of the fitted curve, 0 where the intensity separates exceeding from other runs; NaN
    where the runs determine none, undetermined: the reason.  scatter: standard deviation of
    ln(measure) about a straight line over ln(intensity), of the runs that stand and have some
    damage, whatever the level: N. Luco, C. A. Cornell (2007), doi:10.1193/1.2723158, call an
    intensity efficient where it is small.  median: in `unit`.  intensity: one more than
    INTENSITIES.
    """
    rows = []
    for wall, of_wall in runs.groupby("wall", sort=False):
        for name, state in product(
            dict.fromkeys([*there(runs), *([intensity] if intensity else [])]), states
        ):
            one = fragility(
                of_wall, state.measure, state.level, name, replicates=0, name=state.name
            )
            rows.append(
                {
                    "wall": wall,
                    "state": one.state,
                    "measure": one.measure,
                    "level": one.level,
                    "intensity": name,
                    "dispersion": one.dispersion,
                    "undetermined": one.why,
                    "scatter": _scatter(of_wall, one.measure, name),
                    "median": one.median,
                    "unit": unit_of(name)[1],
                    "runs": one.n_runs,
                    "exceeding": one.n_exceeding,
                    "records": one.n_records,
                }
            )
    measures = list(dict.fromkeys(state.measure for state in states))
    return pd.DataFrame(rows).sort_values(
        ["wall", "measure", "level", "dispersion", "scatter"],
        kind="stable",
        ignore_index=True,
        key=lambda column: column.map(measures.index) if column.name == "measure" else column,
    )


def _scatter(runs, measure, intensity):
    """Standard deviation of ln(measure) about its line over ln(intensity), NaN of fewer than three
    runs."""
    x, y = (runs[name].astype(float) for name in (intensity, measure))
    chosen = (x > 0) & (y > 0) & runs["collapsed_at_s"].isna()
    x, y = np.log(x[chosen]), np.log(y[chosen])
    if x.nunique() < 2 or len(x) < 3:
        return np.nan
    rest = y - np.polynomial.Polynomial.fit(x, y, 1)(x)
    return float(np.sqrt(np.sum(rest**2) / (len(x) - 2)))
