"""How like a survey the states of twins are.

A draw has the weight

    exp(-(d / KERNEL)^2 / 2)

by its distance d from the survey (`damage.applications.cracks.survey`), up to FARTHEST.  A wall
that fell, or that has no visible crack, has none: the surveyed one stands, with cracks.  Within the
error of widths a wall without cracks would be at 0.5 from a survey of the narrowest ones.
"""

import numpy as np

from damage.applications.cracks.survey import distances

KERNEL = 0.25
"""Width of the kernel [-]."""
FARTHEST = 2 * KERNEL
"""Distance [-] beyond which a draw has no weight.  Weights alone would count many draws that are
equally far away as many that resemble the survey."""
NEAREST = 10
"""Draws whose mean distance says how strange a survey is."""
STATES = "both", "earthquakes"
"""What a survey can be of: the ground settled, or it did not."""


def kernel(distance, claimed):
    """Weights (n,) by distances, of walls that stand with visible cracks."""
    return np.where(claimed & (distance <= FARTHEST), np.exp(-((distance / KERNEL) ** 2) / 2), 0.0)


def strangeness(distance):
    """Mean distance of the NEAREST of distances (n,)."""
    return np.sort(distance)[:NEAREST].mean()


def pairwise(seen, error_m, known_m):
    """Distances (n, n) [-] of all rows of Seen from one another, each once as the survey; infinite
    from itself."""
    matrix = np.empty((len(seen.area), len(seen.area)))
    for k, row in enumerate(matrix):
        row[:] = distances(seen.patterns([k]), seen, error_m, known_m)
        row[k] = np.inf
    return matrix


def strange_share(away, pairs):
    """Share of patterns [-] that are less strange among the others than a survey is among all, 0
    of too few to say; away: (n,) distances of the survey; pairs: of `pairwise`."""
    strangenesses = np.array([strangeness(row) for row in pairs])
    return np.mean(strangenesses < strangeness(away)) if len(away) > NEAREST else 0.0
