"""Fragility of a wall: the probability that a measure of damage exceeds a level, by the motion's intensity.

The curve is the lognormal one, P(x) = Phi(ln(x / median) / dispersion), fitted by maximum likelihood to how many of
the runs at each intensity exceed the level: J. W. Baker (2015), Efficient analytical fragility function fitting
using dynamic structural analysis, Earthquake Spectra 31(1), doi:10.1193/021113EQS025M, equation (11).  Bounds are
percentiles over bootstrap samples: the walls, which are the seeds of their joints' strengths, are drawn anew with
replacement, each with all its runs; the records stay, so that bounds tell nothing of other earthquakes.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
from scipy.optimize import minimize
from scipy.special import log_ndtr, ndtr

from damage.errors import InputError
from damage.measure.columns import read_table

LEVELS = {"max_DI": (0.02, 0.05, 0.1), "max_crack_width_mm": (0.1, 1.0), "max_psi": (1.0, 2.0)}
"""Levels by measure, a column of summary.csv: index [-], crack width [mm], Korswagen's Psi [-]."""
INTENSITIES = {"pga_g": "PGA [g]", "sa_0.2_s_g": r"S$_\mathrm{a}$(0.2 s, 5 %) [g]"}
REPLICATES, CONFIDENCE = 500, 0.9
_PERCENTILES = 50 * (1 - CONFIDENCE), 50 * (1 + CONFIDENCE)
DISPERSIONS = 1e-3, 3.0
"""Range of a fitted dispersion [-]."""


@dataclass(frozen=True)
class Fragility:
    """A fitted curve with its bounds.

    median [g], dispersion [-]: NaN where no run or every run exceeds the level; n_runs, n_exceeding; replicates:
    (n, 2) medians and dispersions of the bootstrap samples that could be fitted; n_replicates: how many were drawn.
    step: the two neighbouring intensities [g] where up to one no run exceeds the level and from the other on all do;
    the dispersion is then 0 and the median lies anywhere between.  None where there are none.
    """

    measure: str
    level: float
    median: float
    dispersion: float
    n_runs: int
    n_exceeding: int
    replicates: np.ndarray
    n_replicates: int
    step: tuple[float, float] | None = None

    def probability(self, intensity):
        """P(measure > level) at intensities of any shape [g]."""
        return curve(intensity, self.median, self.dispersion)

    def bounds(self, intensity):
        """Lower and upper bound of the probability, (2, n), at intensities (n,) [g]."""
        if self.step:
            return np.array([curve(intensity, end, 0.0) for end in self.step[::-1]])
        curves = curve(np.asarray(intensity)[None, :], *(column[:, None] for column in self.replicates.T))
        return np.percentile(curves, _PERCENTILES, axis=0)

    def row(self):
        """The fit as a flat dictionary: a row of the table."""
        low, high = np.percentile(self.replicates, _PERCENTILES, axis=0) if len(self.replicates) > 1 \
            else np.full((2, 2), np.nan)
        if self.step:
            low, high = ((end, np.nan) for end in self.step)
        return {"measure": self.measure, "level": self.level, "runs": self.n_runs, "exceeding": self.n_exceeding,
                "median_g": self.median, "dispersion": self.dispersion, "median_low_g": low[0],
                "median_high_g": high[0], "dispersion_low": low[1], "dispersion_high": high[1],
                "confidence": CONFIDENCE, "replicates": self.n_replicates, "fitted": len(self.replicates)}


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


def fragility(runs, measure, level, intensity="pga_g", replicates=REPLICATES, seed=1):
    """The Fragility of runs (rows of a study's summary.csv); a wall that collapsed exceeds every level.

    The runs' walls are told apart by `strength_seed`.
    """
    exceeds = exceeding(runs, measure, level)
    counts = exceeds.groupby([runs["strength_seed"], runs[intensity]]).agg(["size", "sum"]).unstack(fill_value=0)
    values, n_walls = counts["size"].columns.to_numpy(float), len(counts)
    counts = np.array([counts["size"], counts["sum"]])  # runs of a wall at an intensity, and those that exceed
    n, y = counts.sum(axis=1)
    random = np.random.default_rng(seed)
    fits = []
    for _ in range(replicates if n_walls > 1 else 0):
        weights = np.bincount(random.integers(n_walls, size=n_walls), minlength=n_walls)
        drawn_n, drawn_y = np.tensordot(weights, counts, axes=(0, 1))
        fits.append(fit(values, drawn_y, drawn_n))
    fits = np.array(fits).reshape(-1, 2)
    return Fragility(measure, level, *fit(values, y, n), len(runs), int(exceeds.sum()),
                     fits[np.isfinite(fits).all(axis=1)], len(fits), step_of(values, y, n))


def load_runs(folder):
    """The runs of a study's folder whose strengths scatter: rows of its tables/summary.csv."""
    path = Path(folder) / "tables" / "summary.csv"
    if not path.is_file():
        raise InputError(f"{folder} holds no tables/summary.csv; expected the folder of a study, run one with "
                         "./run_all.sh fragility --solver reference")
    runs = read_table(path, (*LEVELS, "pga_g", "strength_cov", "strength_seed"))
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
    if intensity not in runs or runs[intensity].isna().any():
        raise InputError(f"not every run has {intensity}; expected a study of recorded motions; choose "
                         f"{' or '.join(name for name in INTENSITIES if name != intensity)}")
    return {wall: [fragility(of_wall, measure, level, intensity, replicates) for measure, levels in LEVELS.items()
                   for level in levels] for wall, of_wall in runs.groupby("wall", sort=False)}


def fragility_table(fits, intensity):
    """A DataFrame with a row for each wall, measure and level."""
    return pd.DataFrame([{"wall": wall, "intensity": intensity, **one.row()} for wall, ones in fits.items()
                         for one in ones])
