"""Fragility for a record that was not used: a wall's curve with a random effect of the record.

Records of equal intensity differ in how much damage they do.  The model: in record r a run at
intensity x exceeds the level with probability Phi((ln x - ln m_r) / beta).  Here m_r is the
record's own median, and beta the scatter of the walls within one record.  The medians are
lognormal: ln m_r ~ N(ln theta, tau^2).  A single lognormal curve through the runs of all records
does not know tau and predicts no other record.

Few records leave tau uncertain.  So theta, tau and beta are averaged over their posterior on a
grid.  The prior is uniform in ln theta and in ln beta, and proportional to 1 / (tau + tau_0) in
tau.  Where the median of each record is known exactly, tau_0 is 0, and the interval of a new median
is Student's, mean +- t(n - 1) s sqrt(1 + 1 / n) of the n logarithms (A. Gelman and others, 2013,
Bayesian Data Analysis, 3rd edition, section 3.2).  Otherwise two neighbouring intensities bound a
record's median, and the likelihood holds no information on a tau that is much less than their
distance in ln x.  So tau_0 is the standard deviation of a uniform distribution of that width, of
the median record. The runs of a record count as independent.
How often the interval holds is in docs/reference/studies.md.
"""

from dataclasses import dataclass

import numpy as np
from scipy.fft import irfft, next_fast_len, rfft
from scipy.special import log_ndtr, ndtr

LEAST_RECORDS = 3
"""In which some runs exceed the level and some do not; fewer do not bound tau: Student's quantile
of two is 6.3."""
CONFIDENCE = 0.9
TAILS = (1 - CONFIDENCE) / 2, (1 + CONFIDENCE) / 2
_STEP = 0.02
_MARGIN = 5.0
"""Grid of ln m: its step, and by how much it is longer than the intensities at either
end."""
_TAU = np.geomspace(0.01, 3.0, 24)
_BETA = np.geomspace(0.02, 2.0, 12)
_LEAST_WEIGHT = 1e-9
"""Least weight of a curve that is kept, as a share of the largest."""


@dataclass(frozen=True)
class NewRecord:
    """The next record's own curve, Phi(ln(x / median) / dispersion), as a weighted set of such
    curves.

    medians (n,), in the unit of the intensity, ascending; dispersions (n_beta,) [-]; weights
    (n_beta, n), sum 1.
    """

    medians: np.ndarray
    dispersions: np.ndarray
    weights: np.ndarray

    def median_bounds(self):
        """Lower and upper bound (2,) of the new record's own median."""
        share = np.cumsum(self.weights.sum(axis=0))
        return np.exp(np.interp(TAILS, share, np.log(self.medians) + _STEP / 2))

    def probability(self, intensity):
        """P(exceeded) at intensities (n,) in a record of which nothing is known: the mean of its
        own probability, which may lie outside the `bounds` of that, where few records do most."""
        curves, weights = self.curves(intensity)
        return curves @ weights

    def percentiles(self, intensity):
        """Lower bound, median and upper bound (3, n) of the new record's own probability at
        intensities (n,)."""
        curves, weights = self.curves(intensity)
        low, high = TAILS
        return np.array([_percentiles(curve, weights, (low, 0.5, high)) for curve in curves]).T

    def bounds(self, intensity):
        """Lower and upper bound (2, n) of the new record's own probability at intensities (n,)."""
        return self.percentiles(intensity)[::2]

    def curves(self, intensity):
        """Probabilities (n, k) of all curves that count at intensities (n,), and their weights
        (k,)."""
        counts = self.weights > _LEAST_WEIGHT * self.weights.max()
        beta, place = np.nonzero(counts)
        z = (
            np.log(np.asarray(intensity, float)[:, None] / self.medians[place])
            / self.dispersions[beta]
        )
        return ndtr(z), self.weights[counts] / self.weights[counts].sum()


def new_record(intensity, exceeding, runs):
    """The NewRecord after those of a study; None of fewer than LEAST_RECORDS that bound their own
    median.

    intensity: (n,), ascending; exceeding, runs: (n_records, n), how many of how many runs exceed
    the level there.
    """
    exceeding = np.asarray(exceeding, float)
    runs = np.asarray(runs, float)
    total = exceeding.sum(axis=1)
    if np.count_nonzero((total > 0) & (total < runs.sum(axis=1))) < LEAST_RECORDS:
        return None
    x = np.log(np.asarray(intensity, float))
    m = np.arange(x.min() - _MARGIN, x.max() + _MARGIN, _STEP)
    z = (x[:, None, None] - m) / _BETA[:, None]
    likelihood = np.tensordot(exceeding, log_ndtr(z), 1) + np.tensordot(
        runs - exceeding, log_ndtr(-z), 1
    )
    largest = likelihood.max(axis=2, keepdims=True)
    # (n_tau, n_records, n_beta, n): of a record, by theta
    scattered = _scatter(np.exp(likelihood - largest))
    # of ln tau, in which the grid is uniform
    prior = _TAU / (_TAU + _resolution(x, exceeding, runs) / np.sqrt(12))
    posterior = (
        np.log(np.maximum(scattered, 1e-300)).sum(axis=1)
        + largest.sum(axis=0)
        + np.log(prior)[:, None, None]
    )
    posterior = np.exp(posterior - posterior.max())
    weights = np.maximum(_scatter(posterior / posterior.sum(), each=True).sum(axis=0), 0.0)
    return NewRecord(np.exp(m), _BETA, weights / weights.sum())


def _resolution(x, exceeding, runs):
    """Median over the records of the distance in x (n,) between their neighbours where half of the
    runs exceed."""
    gaps = []
    for y, n in zip(exceeding, runs):
        ran = np.flatnonzero(n)
        most = np.flatnonzero(y[ran] >= n[ran] / 2)
        if len(most) and most[0] > 0:
            gaps.append(np.diff(x[ran])[most[0] - 1])
    return np.median(gaps) if gaps else 0.0


def _scatter(values, each=False):
    """Values over ln m, the last axis, smeared by every tau: (n_tau, ...); each: the first axis is
    tau's already."""
    n = values.shape[-1]
    size = next_fast_len(2 * n, real=True)
    distance = _STEP * np.minimum(np.arange(size), size - np.arange(size))
    ends = (distance + _STEP * np.array([[-0.5], [0.5]]))[:, None, :] / _TAU[:, None]
    # of cells, as tau may be less than the grid's step
    kernel = rfft(ndtr(ends[1]) - ndtr(ends[0]))
    kernel = kernel.reshape(len(_TAU), *(1,) * (values.ndim - 1 - each), -1)
    return irfft(rfft(values, size) * kernel, size)[..., :n]


def _percentiles(values, weights, shares):
    """Weighted percentiles of values (n,)."""
    order = np.argsort(values)
    return values[order][
        np.minimum(np.searchsorted(np.cumsum(weights[order]), shares), len(values) - 1)
    ]
