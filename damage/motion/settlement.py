"""Settlement of the ground below a wall: profiles, and how the supports follow them."""

import math
from dataclasses import dataclass
from datetime import date

import numpy as np

from damage.checks import check_range
from damage.csv_table import read_csv
from damage.elementary import atan, sin, sin_of_turns
from damage.errors import InputError, warn
from damage.fields import Column, check_fields
from damage.motion.loading import mean_velocities
from damage.motion.samples import linear
from damage.rounded import DISPLACEMENT, to_bits, to_grid

PROFILES = ("hogging", "sagging", "tilt", "knick")
DISTORTIONS = (1e-7, 0.02)
"""Least and largest distortion [-]: more than 1/50 is a wall that is pulled down."""
MOST_M = 1.0
"""Largest displacement of a profile from a file [m]."""
MOST_POINTS = 1000
"""Largest number of points of a profile from a file."""
COLUMNS = {
    "x_m": Column("m", "along the wall"),
    "uz_m": Column("m", "of the ground, upwards"),
    "height_m": Column("m", "of a level"),
    "date": Column("", "of a level", "U"),
}
SHORTEST_S = 1.0
"""Least duration of a settlement [s], which is quasi-static."""
FASTEST_M_S = 5e-3
"""Largest velocity of the ground [m/s], which is quasi-static."""
_EDGE_M = 1e-6
END_M = 0.5
"""Distance beyond the outermost levels that a wall may reach [m]: the profile continues straight
there."""


@dataclass(frozen=True)
class Settlement:
    """Vertical displacement of the ground along the wall, which grows smoothly from zero.

    profile: one of PROFILES, or the name of a file; distortion [-]: angular distortion of a named
    profile, with the length L of the wall (Burland and Wroth 1974):
    "hogging", "sagging": a parabola, largest relative deflection over L / 2, so that its deflection
        ratio is half of it and its slope at the ends twice of it; in hogging the ends settle, in
        sagging the middle;
    "tilt": rotation of the whole base about its left end, finite, the right end settles;
    "knick": the right half tilts by that angle, the left half rests.
    x_m, uz_m: (n,) points of a profile from a file [m], upwards positive, straight lines between
    them; what all points have in common does nothing to a wall and is taken off (`common_m`).

    J. B. Burland, C. P. Wroth: Settlement of buildings and associated damage, Proc. Conf.
    Settlement of Structures, Cambridge, 1974, 611-654.
    """

    profile: str
    distortion: float | None = None
    x_m: tuple[float, ...] = ()
    uz_m: tuple[float, ...] = ()

    def __post_init__(self):
        check_fields(self)
        if not self.x_m:
            if self.profile not in PROFILES:
                raise InputError(
                    f"--settle {self.profile}: expected {', '.join(PROFILES)}, or a CSV file with"
                    " columns x_m,uz_m; correct it"
                )
            check_range("--distortion", self.distortion, *DISTORTIONS)
            return
        if self.distortion is not None:
            raise InputError(
                f"--distortion {self.distortion:g} beside the profile {self.profile}: expected"
                " none, as the file says how far the ground settles; leave it out"
            )
        _check_points(self.profile, self.x_m, self.uz_m)

    @property
    def name(self):
        """Name fit for a file's name."""
        return (
            f"{self.profile}-{self.distortion:.4g}"
            if not self.x_m
            else "".join(c if c.isalnum() or c in "-_" else "-" for c in self.profile)
        )

    @property
    def common_m(self):
        """Displacement that all points of a file have in common, upwards positive [m]."""
        return max(min(self.uz_m, default=0.0), 0.0) + min(max(self.uz_m, default=0.0), 0.0)

    def check_length(self, length):
        """Raise InputError where a profile from a file does not reach along a wall of this length
        [m]."""
        if self.x_m and (self.x_m[0] > _EDGE_M or self.x_m[-1] < length - _EDGE_M):
            raise InputError(
                f"{self.profile}: the profile reaches from x = {self.x_m[0]:g} to {self.x_m[-1]:g}"
                f" m, the wall from 0 to {length:g} m; expected points along all of it; add them"
            )

    def vertical(self, x, length):
        """Final vertical displacement (n,) [m] at x (n,) [m] of a wall of this length [m]."""
        x = np.asarray(x, float)
        half = length / 2
        if self.x_m:
            return linear(x, self.x_m, self.uz_m) - self.common_m
        if self.profile == "tilt":
            return -x * sin(self.distortion)
        if self.profile == "knick":
            return -self.distortion * np.maximum(x - half, 0.0)
        from_middle = x / half - 1
        deflection = self.distortion * half * (1 - from_middle * from_middle)
        return deflection - self.distortion * half if self.profile == "hogging" else -deflection

    def displacement(self, time_s, supports):
        """Displacement of damage.wall.layout.Supports (n, n_supports, 3) [m, m, rad] at times (n,)
        [s] since its begin; each support follows the chord of the profile over its part of the
        base.

        Where each one goes is rounded once (`damage.rounded`), so that the last bits of the wall's
        lengths do not reach a run: displacements, and angles as those over a metre, to
        DISPLACEMENT."""
        left = supports.left
        right = supports.right
        length = supports.right.max()
        time_s = np.clip(np.asarray(time_s, float) / self.moving_s(length), 0.0, 1.0)
        root = sin_of_turns(time_s / 4)[:, np.newaxis]
        share = root * root  # (1 - cos(pi time_s)) / 2
        if self.profile == "tilt" and not self.x_m:
            angle = -to_bits(self.distortion) * share
            x = to_grid(supports.x, DISPLACEMENT)
            half = sin(angle / 2)
            return np.stack([x * -2 * (half * half), x * sin(angle), angle + 0 * x], axis=-1)
        ends = self.vertical(left, length), self.vertical(right, length)
        up = to_grid((ends[0] + ends[1]) / 2, DISPLACEMENT)
        angle = to_grid(atan((ends[1] - ends[0]) / (right - left)), DISPLACEMENT)
        return np.stack([0 * share * up, share * up, share * angle], axis=-1)

    def velocities(self, interval_s, n, supports):
        """Velocities of Supports in the first n intervals (n, n_supports, 3) [m/s, m/s, rad/s]."""
        return mean_velocities(self.displacement, interval_s, n, supports)

    def moving_s(self, length):
        """Time for which the ground below a wall of this length [m] moves [s]: at most at
        FASTEST_M_S."""
        largest = np.abs(self.vertical(self.x_m or np.array([0, length / 2, length]), length)).max()
        return max(SHORTEST_S, float(to_bits(math.pi / 2 * largest / FASTEST_M_S)))


def _check_points(profile, x, up):
    if len(x) != len(up) or not 2 <= len(x) <= MOST_POINTS:
        raise InputError(
            f"{profile}: a profile of {len(x)} points; expected 2 to {MOST_POINTS}, x_m and uz_m of"
            " each"
        )
    for value in up:
        check_range(f"{profile}: displacement [m]", value, -MOST_M, MOST_M)
    if not np.all(np.diff(x) > 0):
        raise InputError(
            f"{profile}: x_m does not rise from point to point; sort them, one row each"
        )
    if min(up) == max(up):
        raise InputError(
            f"{profile}: uz_m is {up[0]:g} m at every point; expected ground that bends or tilts;"
            " correct it"
        )


def read_profile(path):
    """Settlement by a CSV file with the columns x_m and uz_m [m], upwards positive; or of levels,
    by x_m, height_m and, of several surveys, date.

    Raises InputError, with the line, where the file does not fit.
    """
    table = read_csv(path, COLUMNS, ("x_m",), MOST_POINTS)
    names = [name for name in ("uz_m", "height_m") if name in table.names]
    if len(names) != 1 or (names == ["uz_m"] and "date" in table.names):
        raise InputError(
            f"{path}: columns {', '.join(table.names)}; expected x_m and uz_m of a profile, or x_m,"
            " height_m and date of levels; correct the header"
        )
    table.refuse_empty("x_m", *names)
    x, up = table.rows[["x_m", *names]].to_numpy().T
    x, up = (x, up) if names == ["uz_m"] else _of_levels(table, x, up)
    return Settlement(table.path.name, None, *(tuple(map(float, values)) for values in (x, up)))


def _of_levels(table, x, height):
    """Points (x, uz) [m] of a table of levels: those of the last date less those of the first, of
    one date those of a course that was level when it was built.  The highest point has not settled;
    the ends are extended by END_M."""
    dated = "date" in table.names
    day_of = np.array(
        [_day(table, *row) if dated else date.min for row in enumerate(table.rows["date"])]
    )
    days = sorted(set(day_of))
    first_x, first_height = _rising(table, x, height, np.flatnonzero(day_of == days[0]))
    x, up = _rising(table, x, height, np.flatnonzero(day_of == days[-1]))
    if len(days) == 1:
        warn(f"{table.path}: levels of one date: the course is taken as level when it was built")
    elif x[0] < first_x[0] - END_M or x[-1] > first_x[-1] + END_M:
        raise InputError(
            f"{table.path}: levels of {days[-1]} from x = {x[0]:g} to {x[-1]:g} m, of {days[0]}"
            f" from {first_x[0]:g} to {first_x[-1]:g} m; expected the same places; give those"
        )
    else:
        up = up - linear(x, *_longer(first_x, first_height))
    x, up = _longer(x, up)
    return x, up - up.max()


def _longer(x, up):
    """Points, x and up (n,) [m], with one more at either end, END_M further on the same slope."""
    first, last = END_M * (np.diff(up)[[0, -1]] / np.diff(x)[[0, -1]])
    return (
        np.array([x[0] - END_M, *x, x[-1] + END_M]),
        np.array([up[0] - first, *up, up[-1] + last]),
    )


def _rising(table, x, height, rows):
    """(x, height) of rows in the order of x; InputError where there are too few, or two at one
    place."""
    rows = rows[np.argsort(x[rows], kind="stable")]
    if len(rows) < 2:
        raise InputError(
            f"{table.path}: {len(rows)} level of one date; expected two or more along the wall; add"
            " them"
        )
    for row in rows[1:][np.diff(x[rows]) <= 0]:
        raise table.error(row, f"a second level at x = {x[row]:g} m of one date; leave one out")
    return x[rows], height[rows]


def _day(table, row, word):
    """The day of a word in a row of a table; InputError, with the line, where it is none."""
    try:
        return date.fromisoformat(word)
    except ValueError as error:
        raise table.error(
            row, f"date = {word!r}: expected a day like 2019-05-22; correct it"
        ) from error
