"""Probability of an outcome of lives, by post-stratification over the largest PGV of a life.

Whether a wall is damaged follows mostly from the largest PGV of its life, whose distribution is
known from lives that are drawn and not run.  The lives that were run are divided into strata of
that PGV; the share of each counts by the stratum's probability, not by the number of lives that
happened to fall into it (Cochran, Sampling Techniques, 3rd edition, section 5A.9):

    p = sum W_h p_h,    var p = sum W_h v_h / n + sum (1 - W_h) v_h / n^2,
    v_h = n_h p'_h (1 - p'_h) / (n_h - 1)

with n lives, n_h of them in stratum h, its probability W_h, and p'_h = (hits + 1/2) / (n_h + 1) in
the variance, so that a stratum whose lives all agree is not taken for certain.
"""

from typing import NamedTuple

import numpy as np

from damage.errors import InputError

Z95 = 1.959964
MOST_STRATA = 10
LEAST_IN_STRATUM = 5


class Estimate(NamedTuple):
    """A probability, the standard error of its estimate, and the number of lives."""

    p: float
    error: float
    lives: int

    @property
    def interval(self):
        """95 % interval (low, high), within 0 and 1."""
        return max(0.0, self.p - Z95 * self.error), min(1.0, self.p + Z95 * self.error)

    def lives_for(self, half_width):
        """Number of lives for which the 95 % interval is so wide to each side, with the same
        strata."""
        return int(np.ceil(self.lives * (Z95 * self.error / half_width) ** 2))


def probability(hits, largest, population):
    """Estimate of the probability of an outcome.

    hits: (n,) bool, whether each life has it; largest: (n,) largest PGV of each [mm/s]; population:
    (m,) the same of lives that were drawn only, m much larger than n.  Raises InputError without a
    life.
    """
    hits, largest, population = (
        np.asarray(values, float) for values in (hits, largest, population)
    )
    if len(hits) < 2:
        raise InputError(f"{len(hits)} lives: expected at least two; give --draws 100")
    edges = strata(largest, population)
    mine = np.searchsorted(edges, largest)
    theirs = np.searchsorted(edges, population)
    count = np.bincount(mine, minlength=len(edges) + 1)
    weight = np.bincount(theirs, minlength=len(edges) + 1) / len(population)
    counts = np.bincount(mine, hits, minlength=len(edges) + 1)
    smooth = (counts + 0.5) / (count + 1)
    spread = smooth * (1 - smooth) * count / (count - 1)
    n = len(hits)
    variance = (weight @ spread) / n + ((1 - weight) @ spread) / n**2
    return Estimate(weight @ (counts / count), np.sqrt(variance), n)


def strata(largest, population):
    """Inner edges (k - 1,) [mm/s] of k strata of about equal probability, each with
    LEAST_IN_STRATUM lives or more."""
    for k in range(min(MOST_STRATA, len(largest) // LEAST_IN_STRATUM), 1, -1):
        edges = np.quantile(population, np.arange(1, k) / k)
        if np.bincount(np.searchsorted(edges, largest), minlength=k).min() >= LEAST_IN_STRATUM:
            return edges
    return np.zeros(0)
