"""How like a survey the states of twins are: the distance of `damage.measure.survey` for all of them at once.

A draw that stands where the survey does has the weight

    exp(-(d / KERNEL)^2 / 2)

by its distance d, and a wall that fell has none: the surveyed one stands.
"""

from typing import NamedTuple

import numpy as np

from damage.measure.cracks import cracked
from damage.measure.survey import places_on

KERNEL = 0.25
"""Width of the kernel [-]."""
NEAREST = 10
"""Draws whose mean distance says how strange a survey is."""
STATES = "both", "earthquakes"
"""What a survey can be of: the ground settled, or it did not."""


class Seen(NamedTuple):
    """Visible cracks in windows, (n, n_windows) each: area [m2]; length [m]; length that is seen to be offset [m]."""

    area: np.ndarray
    length: np.ndarray
    offset: np.ndarray

    def at(self, which):
        return Seen(*(values[which] for values in self))


def seen_of(survey, opening_m, offset_m, wall):
    """The Seen of patterns (n, n_joints) [m] as a surveyor of that survey would have seen them."""
    places = places_on(wall)
    width = np.hypot(opening_m, offset_m)
    shown = survey.looked_at & cracked(width, survey.detection_limit_m)
    moved = shown & cracked(np.abs(offset_m), survey.detection_limit_m)
    length = places.length
    return Seen(*(places.sums(values) for values in (length * np.where(shown, width, 0.0), length * shown,
                                                     length * moved)))


def surveyed(survey, wall):
    """(Seen of one row of a Survey itself, length (n_windows,) [m] of which it says whether it is offset)."""
    places, table = places_on(wall), survey.table
    offset, drawn = table["offset"].to_numpy(float), np.zeros((4, wall.n_joints))
    drawn[:, table["joint"]] = np.array([table["width_m"], np.ones(len(table)), offset == 1, ~np.isnan(offset)]
                                        ) * table["length_m"].to_numpy()
    area, length, moved, known = places.sums(drawn)
    return Seen(area[np.newaxis], length[np.newaxis], moved[np.newaxis]), known


def distances(one, others, error_m, known_m):
    """Distances (n,) of patterns from one row of Seen, as of `damage.measure.survey.distance`.

    error_m: of the widths; known_m: (n_windows,) length of which offsets are known.
    """
    off = np.maximum(np.abs(one.area - others.area) - error_m * one.length, 0.0)
    squares = [_relative(off, one.area, others.area)]
    if (of := known_m > 0).any():
        squares.append(_relative((one.offset - others.offset)[:, of], one.offset[:, of], others.offset[:, of]))
    return np.sqrt(np.mean(squares, axis=0))


def _relative(difference, f, g):
    size = np.sum(f**2 + g**2, axis=1)
    return np.divide(np.sum(difference**2, axis=1), size, out=np.zeros_like(size), where=size > 0)


def kernel(distance, stands):
    """Weights (n,) by distances, of walls that stand."""
    return np.where(stands, np.exp(-(distance / KERNEL)**2 / 2), 0.0)


def strangeness(distance):
    """Mean distance of the NEAREST of distances (n,)."""
    return float(np.sort(distance)[:NEAREST].mean())


def pairwise(seen, error_m, known_m):
    """Distances (n, n) of all rows of Seen from one another, each once as the survey; infinite of one from itself."""
    found = np.array([distances(seen.at([k]), seen, error_m, known_m) for k in range(len(seen.area))])
    np.fill_diagonal(found, np.inf)
    return found


def strange_share(away, pairs):
    """Share of patterns [-] that are less strange among the others than a survey is among all; away: (n,) distances of
    the survey; pairs: of `pairwise`."""
    own = np.array([strangeness(row) for row in pairs])
    return float(np.mean(own < strangeness(away))) if len(away) > NEAREST else 1.0
