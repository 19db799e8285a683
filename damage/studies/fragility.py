"""Fragility of a wall: the probability that a measure of damage exceeds a level, by the motion's intensity.

The curve is the lognormal one, P(x) = Phi(ln(x / median) / dispersion), fitted by maximum likelihood to how many of
the runs at each intensity exceed the level: J. W. Baker (2015), Efficient analytical fragility function fitting
using dynamic structural analysis, Earthquake Spectra 31(1), doi:10.1193/021113EQS025M, equation (11).  Bounds are
percentiles over bootstrap samples, drawn anew with replacement, of the walls, which are the seeds of their joints'
strengths, of the records, or of both, each with all its runs.  Those over walls hold the records and tell nothing of
other earthquakes; of few records those over records are themselves uncertain.  Samples drawn from few scatter less than
new ones would: so they are stretched about the fit, the more the fewer there are (`stretch`).
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
from scipy.optimize import minimize
from scipy.special import log_ndtr, ndtr, ndtri
from scipy.stats import t as student

from damage.errors import InputError
from damage.measure.columns import check_names, read_table

LEVELS = {"max_DI": (0.02, 0.05, 0.1), "max_crack_width_mm": (0.1, 1.0), "max_psi": (1.0, 2.0)}
"""Levels by measure, a column of summary.csv: index [-], crack width [mm], Korswagen's Psi [-]."""
INTENSITIES = {"pga_g": "PGA [g]", "pgv_m_s": "PGV [m/s]", "sa_0.2_s_g": r"S$_\mathrm{a}$(0.2 s, 5 %) [g]",
               "sa_eigen_period_g": r"S$_\mathrm{a}$(T$_1$, 5 %) [g]", "avg_sa_g": "AvgSa [g]",
               "arias_m_s": "Arias intensity [m/s]"}
"""Columns of summary.csv that curves can be fitted against; what an axis says."""
OVER = ("walls", "records", "both")
"""What bootstrap samples draw anew."""
FEW_RECORDS = 10
"""Fewer are said to be few: 10 to 20 usually serve, D. Vamvatsikos, C. A. Cornell (2002), doi:10.1002/eqe.141."""
REPLICATES, CONFIDENCE = 500, 0.9
_PERCENTILES = 50 * (1 - CONFIDENCE), 50 * (1 + CONFIDENCE)
DISPERSIONS = 1e-3, 3.0
"""Range of a fitted dispersion [-]."""


@dataclass(frozen=True)
class Fragility:
    """A fitted curve with its bounds.

    intensity: a name of INTENSITIES, in the unit of which all intensities are; median, dispersion [-]: NaN where no run
    or every run exceeds the level; n_runs, n_exceeding, n_records, n_walls; replicates: by a name of OVER (n, 2)
    medians and dispersions of the bootstrap samples that could be fitted; n_replicates: how many were drawn of each.
    step: the two neighbouring intensities where up to one no run exceeds the level and from the other on all do;
    the dispersion is then 0 and the median lies anywhere between.  None where there are none.
    """

    measure: str
    level: float
    median: float
    dispersion: float
    n_runs: int
    n_exceeding: int
    replicates: dict[str, np.ndarray]
    n_replicates: int
    n_records: int
    n_walls: int
    intensity: str
    step: tuple[float, float] | None = None

    def probability(self, intensity):
        """P(measure > level) at intensities of any shape."""
        return curve(intensity, self.median, self.dispersion)

    def bounds(self, intensity, over="walls"):
        """Lower and upper bound of the probability, (2, n), at intensities (n,); over: a name of OVER.

        None where there is nothing to draw anew: a single wall or record, or no sample that could be fitted.
        """
        x, replicates = np.asarray(intensity, float), self._samples(over)
        step = [curve(x, end, 0.0) for end in self.step[::-1]] if self.step else None
        if step and over == "walls":
            return np.array(step)  # walls that are drawn all turn between its ends
        if len(replicates) < 2:
            return None
        curves = curve(x[None, :], *(column[:, None] for column in replicates.T))
        low, high = np.percentile(curves, _PERCENTILES, axis=0)
        return np.array([np.minimum(low, step[0]), np.maximum(high, step[1])] if step else [low, high])

    def median_bounds(self, over="walls"):
        """Lower and upper bound of (median, dispersion), (2, 2), NaN where there are none."""
        replicates = self._samples(over)
        low, high = np.percentile(replicates, _PERCENTILES, axis=0) if len(replicates) > 1 \
            else np.full((2, 2), np.nan)
        if self.step and over == "walls":
            return np.array([[end, np.nan] for end in self.step])
        if self.step and np.isfinite(low[0]):
            low[0], high[0] = min(low[0], self.step[0]), max(high[0], self.step[1])
        return np.array([low, high])

    def _samples(self, over):
        """Medians and dispersions (n, 2) of the bootstrap samples, stretched about the fit."""
        samples = self.replicates.get(over, np.zeros((0, 2)))
        drawn = {"walls": self.n_walls, "records": self.n_records}.get(over, min(self.n_walls, self.n_records))
        if len(samples) == 0 or not np.isfinite(self.median):
            return samples
        fit = np.array([self.median, self.dispersion])
        with np.errstate(divide="ignore", invalid="ignore"):
            stretched = fit * (samples / fit) ** stretch(drawn)
        return np.where((samples > 0) & (fit > 0), stretched, samples)

    def row(self):
        """The fit as a flat dictionary: a row of the table; medians have the intensity's unit in their names."""
        unit = unit_of(self.intensity)[0]
        row = {"measure": self.measure, "level": self.level, "runs": self.n_runs, "exceeding": self.n_exceeding,
               "records": self.n_records, f"median_{unit}": self.median, "dispersion": self.dispersion}
        for over in OVER:
            (low, least), (high, largest) = self.median_bounds(over)
            row |= {f"median_{over}_low_{unit}": low, f"median_{over}_high_{unit}": high,
                    f"dispersion_{over}_low": least, f"dispersion_{over}_high": largest,
                    f"fitted_{over}": len(self.replicates.get(over, ()))}
        return row | {"confidence": CONFIDENCE, "replicates": self.n_replicates}


def stretch(n):
    """By how much bootstrap samples of n tell too little: samples of n scatter less than n new ones, by
    sqrt((n - 1) / n), and Student's quantile is further out than the normal one, as their scatter is itself
    uncertain.  After T. C. Hesterberg (2015), What teachers should know about the bootstrap, The American Statistician
    69(4), doi:10.1080/00031305.2015.1089789, whose narrowness bias this mends.

    >>> [round(float(stretch(n)), 2) for n in (2, 5, 25, 1000)]
    [5.43, 1.45, 1.06, 1.0]
    """
    low = (1 - CONFIDENCE) / 2
    return np.sqrt(n / (n - 1)) * student.ppf(low, n - 1) / ndtri(low)


def unit_of(intensity):
    """The unit of an intensity as it stands in a column's name, and as one writes it."""
    return ("m_s", "m/s") if intensity.endswith("_m_s") else ("g", "g")


def curve(intensity, median, dispersion):
    """The lognormal fragility curve, with no dispersion a step; broadcasts."""
    return ndtr(np.log(np.asarray(intensity) / median) / np.maximum(dispersion, 1e-12))


def fit(intensity, exceeding, runs):
    """(median, dispersion) by maximum likelihood.

    intensity: (n,) [g]; exceeding, runs: (n,) how many of how many runs exceed the level there.
    NaN where none or all do: the data then bound the median on one side only.  Where intensities tell runs that exceed
    from those that do not, all medians between are as likely, and no dispersion is the likeliest: their geometric mean
    and 0.
    """
    x, y, n = np.log(np.asarray(intensity, float)), np.asarray(exceeding, float), np.asarray(runs, float)
    if y.sum() in (0, n.sum()):
        return np.nan, np.nan
    if ends := step_of(intensity, exceeding, runs):
        return float(np.sqrt(ends[0] * ends[1])), 0.0

    def misfit(parameters):  # Baker (2015), equation (11), with the sign changed
        z = (x - parameters[0]) / np.exp(parameters[1])
        below, above = log_ndtr(z), log_ndtr(-z)
        density = -0.5 * z**2 - 0.5 * np.log(2 * np.pi)
        dz = y * np.exp(density - below) - (n - y) * np.exp(density - above)
        return (-np.sum(y * below + (n - y) * above), np.array([np.sum(dz) / np.exp(parameters[1]), np.sum(dz * z)]))

    centre = np.average(x, weights=n)
    best = minimize(misfit, (centre, np.log(0.5)), jac=True, method="L-BFGS-B",
                    bounds=((x.min() - 5, x.max() + 5), tuple(np.log(DISPERSIONS))))
    return float(np.exp(best.x[0])), float(np.exp(best.x[1]))


def step_of(intensity, exceeding, runs):
    """The neighbouring intensities between which none exceeding turns into all, None where some do in between."""
    x, y, n = np.asarray(intensity, float), np.asarray(exceeding), np.asarray(runs)
    none, all_ = x[(n > 0) & (y == 0)], x[(n > 0) & (y == n)]
    if len(none) + len(all_) < np.count_nonzero(n) or not len(none) or not len(all_) or none.max() > all_.min():
        return None
    return float(none.max()), float(all_.min())


def exceeding(runs, measure, level):
    """Which runs exceed a level, a Series of bool: a wall that collapsed exceeds every one."""
    return (runs[measure] > level) | runs["collapsed_at_s"].notna()


def fragility(runs, measure, level, intensity="pga_g", replicates=REPLICATES, seed=1, over=OVER):
    """The Fragility of runs (rows of a study's summary.csv); a wall that collapsed exceeds every level.

    The runs' walls are told apart by `strength_seed`; over: names of OVER of what is drawn anew.
    """
    exceeds = exceeding(runs, measure, level)
    records = runs["record"].fillna("") if "record" in runs else pd.Series("", runs.index)
    (wall, walls), (record, known), (place, values) = (
        pd.factorize(column, sort=True) for column in (runs["strength_seed"], records, runs[intensity].astype(float)))
    sizes = len(walls), len(known)
    counts = np.zeros((2, *sizes, len(values)))  # runs of a wall in a record at an intensity, and those that exceed
    np.add.at(counts[0], (wall, record, place), 1)
    np.add.at(counts[1], (wall, record, place), exceeds.to_numpy(float))
    found = {}
    for name in over:
        random = [np.random.default_rng((seed, kind)) for kind in range(2)]  # so that "both" has the draws of either
        drawn = [name in (kind, "both") and size > 1 for kind, size in zip(OVER, sizes)]
        if not any(drawn) or (name == "both" and not all(drawn)):
            continue
        fits = [fit(values, *_drawn(counts, sizes, drawn, random)[::-1]) for _ in range(replicates)]
        fits = np.array(fits).reshape(-1, 2)
        found[name] = fits[np.isfinite(fits).all(axis=1)]
    n, y = counts.sum(axis=(1, 2))
    return Fragility(measure, level, *fit(values, y, n), len(runs), int(exceeds.sum()), found, replicates, len(known),
                     len(walls), intensity, step_of(values, y, n))


def _drawn(counts, sizes, drawn, random):
    """Runs, and those that exceed, by intensity, of walls and records of which the drawn ones are drawn anew."""
    walls, records = (np.bincount(one.integers(size, size=size), minlength=size) if anew else np.ones(size)
                      for one, size, anew in zip(random, sizes, drawn))
    return np.einsum("kwri,w,r->ki", counts, walls, records)


def load_runs(folder):
    """The runs of a study's folder whose strengths scatter: rows of its tables/summary.csv."""
    path = Path(folder) / "tables" / "summary.csv"
    if not path.is_file():
        raise InputError(f"{folder} holds no tables/summary.csv; expected the folder of a study, run one with "
                         "./run_all.sh fragility --solver reference")
    runs = read_table(path, (*LEVELS, "pga_g", "strength_cov", "strength_seed"))
    check_names(runs, path)
    runs = runs[(runs["strength_cov"] > 0) & (runs["status"] == "complete")]
    if len(runs) == 0:
        raise InputError(f"{path} holds no finished run with scattered strengths; expected some with strength-cov, "
                         "as in studies/fragility.toml")
    return runs


def fit_all(runs, intensity="pga_g", replicates=REPLICATES):
    """{wall: [Fragility of each level]} of runs."""
    if intensity not in INTENSITIES:
        raise InputError(f"--intensity {intensity}: expected {' or '.join(INTENSITIES)}; mend it")
    if replicates < 0:
        raise InputError(f"--replicates {replicates}: expected zero or more; mend it")
    if intensity not in there(runs):
        raise InputError(f"not every run has {intensity}; expected a study of recorded motions, its tables of this "
                         f"version; choose {' or '.join(there(runs)) or 'another study'}")
    return {wall: [fragility(of_wall, measure, level, intensity, replicates) for measure, levels in LEVELS.items()
                   for level in levels] for wall, of_wall in runs.groupby("wall", sort=False)}


def there(runs):
    """Names of the INTENSITIES that every one of the runs has."""
    return [name for name in INTENSITIES if name in runs and runs[name].notna().all()]


def fragility_table(fits, intensity):
    """A DataFrame with a row for each wall, measure and level."""
    return pd.DataFrame([{"wall": wall, "intensity": intensity, **one.row()} for wall, ones in fits.items()
                         for one in ones])


def efficiency_table(runs):
    """Which intensity serves best: a DataFrame with a row for each wall, measure, level and intensity, best first.

    dispersion: of the fitted curve, 0 where the intensity tells those that exceed from the others; NaN where no run or
    every run exceeds.  scatter: standard deviation of ln(measure) about a straight line over ln(intensity), of the runs
    that stand and have some damage, whatever the level: N. Luco, C. A. Cornell (2007), doi:10.1193/1.2723158, call an
    intensity efficient where it is small.  median: in `unit`.
    """
    rows = [{"wall": wall, **row} for wall, of_wall in runs.groupby("wall", sort=False) for intensity in there(runs)
            for measure in LEVELS for row in _efficiencies(of_wall, measure, intensity)]
    by = ["wall", "measure", "level", "dispersion", "scatter"]
    table = pd.DataFrame(rows)
    order = {name: place for place, name in enumerate(LEVELS)}
    return table.sort_values(by, key=lambda column: column.map(order) if column.name == "measure" else column,
                             kind="stable", ignore_index=True)


def _efficiencies(runs, measure, intensity):
    """Rows of the table for one wall, measure and intensity."""
    scatter = _scatter(runs, measure, intensity)
    ones = [fragility(runs, measure, level, intensity, replicates=0) for level in LEVELS[measure]]
    return [{"measure": measure, "level": one.level, "intensity": intensity, "dispersion": one.dispersion,
             "scatter": scatter, "median": one.median, "unit": unit_of(intensity)[1], "runs": one.n_runs,
             "exceeding": one.n_exceeding, "records": one.n_records} for one in ones]


def _scatter(runs, measure, intensity):
    """Standard deviation of ln(measure) about its line over ln(intensity), NaN of fewer than three runs."""
    x, y = (runs[name].astype(float) for name in (intensity, measure))
    chosen = (x > 0) & (y > 0) & runs["collapsed_at_s"].isna()
    x, y = np.log(x[chosen]), np.log(y[chosen])
    if x.nunique() < 2 or len(x) < 3:
        return np.nan
    rest = y - np.polynomial.Polynomial.fit(x, y, 1)(x)
    return float(np.sqrt(np.sum(rest**2) / (len(x) - 2)))
