"""Why records of equal Sa(T1) differ in the damage that they do: the study stations by distance,
duration and spectrum.

    python3 -m paper record_features results/stations

Probit curves, P = Phi((ln Sa(T1) + b f - m) / beta), where f is a feature of the record: b is by
how much ln Sa(T1) may be less for each unit of the feature.  Each record at each scale counts once,
as its walls are the same.  Intervals are percentiles over samples of the 16 stations, drawn anew
with both of their components.
"""

from pathlib import Path

import numpy as np
import pandas as pd
from scipy.optimize import minimize
from scipy.special import log_ndtr

from damage.applications.studies.fragility import load_runs
from damage.motion.formats import read_record, shipped_records
from damage.motion.intensity import response_spectrum
from paper.bench import arguments, option, show

OUTCOMES = {
    "maximum DI > 0.05": lambda runs: runs["max_DI"] > 0.05,
    "maximum Psi > 1": lambda runs: runs["max_psi"] > 1,
    "Psi >= 1 at rest": lambda runs: runs["residual_psi"] >= 1,
    "maximum Psi > 2": lambda runs: runs["max_psi"] > 2,
}
NEAR = ("BGAR", "BLOP", "BWSE", "BZN1")
"""The stations within 3.5 km of the epicentre; the others are 3.9 to 9 km away."""
LONGER = 1.5
"""Period at which the spectrum is compared, over that of the intact wall."""
FEATURES = "farther station", "ln D5-95", f"ln Sa({LONGER:g} T1) / Sa(T1)"
"""0 or 1; ln of the duration between 5 and 95 % of the Arias intensity [s]; ln of a ratio [-]."""


def features(runs):
    """A DataFrame with a row a record and scale: station, shares of the OUTCOMES, ln Sa [ln g],
    FEATURES.

    runs: rows of summary.csv of the study `stations`.
    """
    period = runs["eigen_period_s"].median()
    paths, shape = shipped_records(), {}
    for record in runs["record"].unique():
        first, longer = response_spectrum(read_record(paths[record]), (period, LONGER * period))
        shape[record] = np.log(longer / first)
    exceeding = {name: outcome(runs) for name, outcome in OUTCOMES.items()}
    found = (
        runs.assign(**exceeding)
        .groupby(["record", "scale"])
        .agg({**dict.fromkeys(OUTCOMES, "mean"), "sa_eigen_period_g": "first", "d5_95_s": "first"})
        .reset_index()
    )
    station = found["record"].str.split("_").str[0]
    values = (
        (~station.isin(NEAR)).astype(float),
        np.log(found["d5_95_s"]),
        found["record"].map(shape),
    )
    return found.assign(
        station=station,
        **{"ln Sa": np.log(found["sa_eigen_period_g"]), **dict(zip(FEATURES, values))},
    )


def probit(table, outcome, names):
    """(b of each name, beta) (n + 1,) of the likeliest curve, all in ln Sa(T1)."""
    share = table[outcome].to_numpy()
    x = np.column_stack([np.ones(len(table)), *(table[name] for name in ("ln Sa", *names))])

    def misfit(b):
        return -np.sum(share * log_ndtr(x @ b) + (1 - share) * log_ndtr(-x @ b))

    start = np.r_[-2.5 * table["ln Sa"].mean(), 2.5, np.zeros(len(names))]
    b = minimize(misfit, start, method="BFGS").x
    return np.r_[b[2:], 1.0] / b[1]


def rows(table, samples, seed=1):
    """Rows of the table that is printed: outcome, features, beta, b with intervals of 95 %."""
    random, stations = np.random.default_rng(seed), table["station"].unique()
    drawn = [
        pd.concat(
            [table[table["station"] == one] for one in random.choice(stations, len(stations))]
        )
        for _ in range(samples)
    ]
    for outcome in OUTCOMES:
        for chosen in ((), *((name,) for name in FEATURES), FEATURES[:2]):
            best = probit(table, outcome, chosen)
            ends = np.percentile(
                [probit(one, outcome, chosen) for one in drawn], (2.5, 97.5), axis=0
            )
            yield (
                outcome,
                " and ".join(chosen) or "none",
                f"{best[-1]:.2f}",
                "; ".join(
                    f"{b:+.2f} ({low:+.2f} to {high:+.2f})"
                    for b, low, high in zip(best[:-1], *ends)
                ),
            )


def main():
    asked = arguments(
        __doc__, option("study", type=Path), option("--samples", type=int, default=200)
    )
    show(("outcome", "feature", "beta", "b"), rows(features(load_runs(asked.study)), asked.samples))
