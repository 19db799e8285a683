"""A survey of the cracks of a real wall: on its joints, beside a run, and how far a simulated
pattern is from it.

The distance of a simulated pattern, in windows that slide over the wall as in
`damage.applications.cracks.patterns`,

    d^2 = sum (|f - g| - e)^2 / sum (f^2 + g^2)

compares the areas f and g of the visible cracks (width times length) of survey and pattern; e:
error of the surveyed widths times the surveyed length.  0: as the survey within its errors, 1: no
crack at the same place.  Where the survey says whether faces are offset, d^2 is the mean of this
and of the same of the lengths that are seen to be offset, in windows where it says so.
"""

from dataclasses import dataclass
from math import isnan
from typing import NamedTuple

import numpy as np
import pandas as pd
import scipy  # spatial where it is used: it starts slowly

from damage.applications.cracks.crack_file import CrackPattern, read_cracks
from damage.applications.cracks.crack_paths import crack_paths
from damage.applications.cracks.patterns import Places, in_words
from damage.applications.cracks.plausible import implausible_width
from damage.errors import InputError
from damage.index import THRESHOLD
from damage.measure.cracks import (
    close_pairs,
    crack_numbers,
    cracked,
    ends_of,
    mean_width,
    points_along,
    psi,
    psi_value,
)
from damage.provenance import file_origin
from damage.units import MILLIMETRE
from damage.wall.geometry import joint_table, tributary_ends

LEAST_SHARE = 0.5
"""Share of the drawn length that has to lie on joints [-]."""
WIDTH_ERROR = 0.05 * MILLIMETRE
"""Error of widths where a survey says none [m]: half the least step of a crack-width card."""
WIDEST_M = 1.0
"""A crack of this width [m] is none: the wall has fallen."""
NEAR_M = 0.225
"""How near a crack of the run is to one of the survey, and the other way round, to count as at its
place [m]."""


@dataclass(frozen=True)
class Survey:
    """The cracks of a survey on the joints of a wall.

    file, sha256: of the file; pattern: CrackPattern as drawn; table: DataFrame, a row each joint:
    joint, length_m, crack, width_m (of the widest crack there), offset (1 seen, 0 not, NaN
    unknown); n_joints: of the wall; share_on_joints: of the drawn length [-]; apart_m: largest
    distance of joints from the lines that they stand for; detection_limit_m, width_error_m: of the
    file, else THRESHOLD, or the narrowest surveyed width below it, and WIDTH_ERROR; looked_at:
    joints that were looked at (n_joints,): all of them where the survey names no area without a
    crack; notes: sentences on what was assumed.
    """

    file: str
    sha256: str
    pattern: CrackPattern
    table: pd.DataFrame
    n_joints: int
    share_on_joints: float
    apart_m: float
    detection_limit_m: float
    width_error_m: float
    looked_at: np.ndarray
    notes: tuple[str, ...]

    @property
    def width_m(self):
        """Crack width of each contact point (n_joints,) [m], 0 where there is none."""
        width = np.zeros(self.n_joints)
        width[self.table["joint"]] = self.table["width_m"]
        return width

    def as_dict(self):
        """Its key numbers, fit for JSON: cracks by the labels of the file, Psi as they were
        drawn."""
        parts = self.pattern.stretches
        return {
            "file": self.file,
            "sha256": self.sha256,
            "cracks": parts["crack"].nunique(),
            "crack_length_m": parts["length_m"].sum(),
            "psi": psi(parts),
            "max_width_mm": parts["width_m"].max() / MILLIMETRE if len(parts) else 0.0,
            "share_on_joints": self.share_on_joints,
            "apart_m": self.apart_m,
            "detection_limit_mm": self.detection_limit_m / MILLIMETRE,
            "width_error_mm": self.width_error_m / MILLIMETRE,
            "notes": list(self.notes),
        }


def read_survey(path, wall):
    """The Survey of a crack file, at its last load level, on the joints of a Layout.  Raises
    InputError, too, where less than LEAST_SHARE of the drawn length lies on joints."""
    return survey_of(read_cracks(path)[-1], wall, **file_origin(path))


def survey_of(pattern, wall, file="the survey", sha256=""):
    """The Survey of a CrackPattern on the joints of a Layout; errors as of `read_survey`."""
    parts = pattern.stretches
    _refuse_contradictions(pattern, file, wall)
    paths = crack_paths(parts, wall)
    check_share(paths, file, wall)
    segments = (
        paths.table[["joint", "length_m", "stretch"]]
        .join(parts[["crack", "width_m", "offset"]], on="stretch")
        .sort_values("width_m", ascending=False, kind="stable")
        .drop_duplicates("joint")
        .sort_values("joint", ignore_index=True)
    )
    x, z = (getattr(wall.contacts, name)[: wall.n_joints] for name in "xz")
    looked_at = _within(np.column_stack([x, z]), pattern.clear) | (len(pattern.clear) == 0)
    looked_at[segments["joint"]] = True
    limit = pattern.detection_limit_m
    error = pattern.width_error_m
    narrowest = float(parts["width_m"][parts["width_m"] > 0].to_numpy(float).min(initial=THRESHOLD))
    known = [narrowest if isnan(limit) else limit, WIDTH_ERROR if isnan(error) else error]
    return Survey(
        file=file,
        sha256=sha256,
        pattern=pattern,
        table=segments,
        n_joints=wall.n_joints,
        share_on_joints=paths.share,
        apart_m=paths.apart_m,
        detection_limit_m=known[0],
        width_error_m=known[1],
        looked_at=looked_at,
        notes=tuple(_assumed(pattern, known)),
    )


def _refuse_contradictions(pattern, file, wall):
    """Raise InputError of a survey that says two things."""
    parts = pattern.stretches
    widest = parts["width_m"].max() if len(parts) else 0.0
    limit = pattern.detection_limit_m
    if widest > WIDEST_M:
        raise InputError(
            f"{file}: a crack of {widest / MILLIMETRE:g} mm; expected widths of up to "
            f"{WIDEST_M / MILLIMETRE:g} mm, look at the unit"
        )
    if 0 < widest and not isnan(limit) and not cracked(widest, limit):
        raise InputError(
            f"{file}: detection_limit_mm = {limit / MILLIMETRE:g}, but the widest crack has"
            f" {widest / MILLIMETRE:g} mm; expected the width from which cracks are seen, correct"
            " one of both"
        )
    ends = ends_of(parts)
    # in either direction
    same = pd.DataFrame(np.sort(ends[..., 0] + 1j * ends[..., 1], axis=1)).duplicated()
    for k in np.flatnonzero(same)[:1]:
        start, end = (f"({x:g}, {z:g})" for x, z in ends[k])
        raise InputError(
            f"{file}: the part of crack {parts['crack'].iloc[k]} from {start} to {end} m is there"
            " twice; expected each part of a crack once, leave one out"
        )
    # by 20 points of each part
    inside = parts["length_m"] @ _within(points_along(ends), pattern.clear).mean(axis=1)
    if inside > wall.wall.brick.length / 2:
        raise InputError(
            f"{file}: {inside:.2f} m of cracks lie in areas of mode none, which have no crack;"
            " expected areas beside the cracks, make them smaller or leave them out"
        )


def _within(place, areas):
    """Whether places (..., 2) lie in one of rectangles (n, 4), opposite corners [m]."""
    low = np.minimum(areas[:, :2], areas[:, 2:])
    high = np.maximum(areas[:, :2], areas[:, 2:])
    place = place[..., np.newaxis, :]
    return ((place >= low) & (place <= high)).all(axis=-1).any(axis=-1)


def check_share(paths, file, wall):
    """Raise InputError where less than LEAST_SHARE of the length of CrackPaths lies on joints."""
    if paths.share < LEAST_SHARE:
        raise InputError(
            f"{file}: {paths.on_joints_m:.2f} of {paths.drawn_m:.2f} m of its cracks run along"
            f" joints of wall {wall.wall.name} ({100 * paths.share:.0f} %); expected at least"
            f" {100 * LEAST_SHARE:.0f} %, places on this wall, x from its left end and z from its"
            " base [m]; look at them"
        )


def _assumed(pattern, known):
    """Sentences on what a survey does not say; known: detection limit and error of widths that are
    taken [m]."""
    for quantity, given, taken in zip(
        ("detection limit", "error of widths"),
        (pattern.detection_limit_m, pattern.width_error_m),
        known,
    ):
        if isnan(given):
            yield f"the survey gives no {quantity}: {taken / MILLIMETRE:.3g} mm is taken"
    if len(pattern.clear) == 0:
        yield "the survey names no area without a crack: the whole wall is taken as looked at"
    widths = pattern.stretches["width_m"].to_numpy(float)
    if len(widths) and (wide := implausible_width(widths.max() / MILLIMETRE)):
        yield wide
    below = widths[(widths > 0) & ~cracked(widths, known[0])]
    if len(below):
        yield (
            f"cracks of {below.min() / MILLIMETRE:.3g} mm, but a detection limit of"
            f" {known[0] / MILLIMETRE:.3g} mm: cracks of a run as narrow as these are taken as not"
            " seen"
        )
    if 0 < widths.max(initial=0.0) <= known[1]:
        yield (
            f"widths have an error of {known[1] / MILLIMETRE:.3g} mm, as much as the widest crack:"
            " patterns without a crack are as near to the survey as those with it"
        )
    alone = pattern.stretches["opening_m"].isna().to_numpy()
    if alone.any():
        yield (
            f"{pattern.stretches['length_m'][alone].sum():.2f} m of cracks give their width alone:"
            " all of it is taken as opening across the line"
        )


# --- beside a simulated pattern -------------------------------------------------------------------


def visible(survey, opening_m, offset_m):
    """Widths (n_joints,) [m] of a simulated pattern as the surveyor would have seen them, 0 where
    there is nothing to be seen: below the detection limit, or where nobody looked."""
    width = np.hypot(opening_m, offset_m)
    return np.where(survey.looked_at & cracked(width, survey.detection_limit_m), width, 0.0)


class Seen(NamedTuple):
    """Visible cracks in windows, (n, n_windows) each: area [m2]; length [m]; length that is seen to
    be offset [m]."""

    area: np.ndarray
    length: np.ndarray
    offset: np.ndarray

    def patterns(self, which):
        """The Seen of these rows alone."""
        return Seen(*(values[which] for values in self))


def seen_of(survey, opening_m, offset_m, wall):
    """The Seen of patterns (n, n_joints) [m] as a surveyor of that survey would have seen them."""
    places = places_on(wall)
    width = visible(survey, opening_m, offset_m)
    moved = (width > 0) & cracked(np.abs(offset_m), survey.detection_limit_m)
    return Seen(*(places.sums(places.length * array) for array in (width, width > 0, moved)))


def surveyed(survey, wall):
    """(Seen of one row of a Survey itself, length (n_windows,) [m] of which it says whether it is
    offset)."""
    table = survey.table
    drawn = np.zeros((4, wall.n_joints))
    offset = table["offset"].to_numpy(float)
    drawn[:, table["joint"]] = (
        np.array([table["width_m"], np.ones(len(table)), offset == 1, ~np.isnan(offset)])
        * table["length_m"].to_numpy()
    )
    *seen, known = places_on(wall).sums(drawn)
    return Seen(*(values[np.newaxis] for values in seen)), known


def distance(survey, opening_m, offset_m, wall):
    """Distance [-] of a simulated pattern from a Survey, 0 to 1, as the module says.

    opening_m, offset_m: (n_joints,) of the contact points of the Layout `wall` [m].
    """
    drawn, known_m = surveyed(survey, wall)
    simulated = seen_of(survey, np.atleast_2d(opening_m), np.atleast_2d(offset_m), wall)
    return distances(drawn, simulated, survey.width_error_m, known_m)[0]


def distances(reference, patterns, error_m, known_m):
    """Distances (n,) [-] of n patterns from a reference, Seen of n rows and of one.

    error_m: of the widths [m]; known_m: (n_windows,) length of which offsets are known [m].
    """
    off = np.abs(reference.area - patterns.area) - error_m * reference.length
    squares = [_relative(np.maximum(off, 0.0), reference.area, patterns.area)]
    windows = known_m > 0
    if windows.any():
        drawn = reference.offset[:, windows]
        simulated = patterns.offset[:, windows]
        squares.append(_relative(drawn - simulated, drawn, simulated))
    return np.sqrt(np.mean(squares, axis=0))


def _relative(difference, f, g):
    size = np.sum(f**2 + g**2, axis=1)
    return np.divide(np.sum(difference**2, axis=1), size, out=np.zeros_like(size), where=size > 0)


def places_on(wall):
    """The Places of the joints of a Layout."""
    contacts = wall.contacts
    n = wall.n_joints
    return Places(
        contacts.x[:n],
        contacts.z[:n],
        contacts.length[:n],
        (wall.wall.length, wall.wall.built_height),
    )


def beside(survey, opening_m, offset_m, wall):
    """A Survey beside a simulated pattern, a plain dictionary; arguments as of `distance`.

    pattern: fractions skill score of the visible cracks with its controls, as of
    `damage.applications.cracks.patterns`; widths: of survey and run, each [survey, run]; positions:
    shares of the length of each that has a crack of the other within NEAR_M [-], None without a
    crack.
    """
    places = places_on(wall)
    drawn = survey.as_dict()
    widths = survey.width_m, visible(survey, opening_m, offset_m)
    surveyed_joints, run_joints = (width > 0 for width in widths)
    means = [mean_width(width, places.length) for width in widths]
    count = int(
        crack_numbers(run_joints, close_pairs(tributary_ends(joint_table(wall)))).max(initial=0)
    )
    return {
        "survey": drawn,
        "distance": distance(survey, opening_m, offset_m, wall),
        "pattern": places.scores(surveyed_joints, run_joints),
        "widths": {
            "cracks": [drawn["cracks"], count],
            "joints_m": [places.length[flags].sum() for flags in (surveyed_joints, run_joints)],
            "max_width_mm": [drawn["max_width_mm"], float(widths[1].max(initial=0.0) / MILLIMETRE)],
            "mean_width_mm": [float(mean / MILLIMETRE) for mean in means],
            "psi": [drawn["psi"], float(psi_value(count, means[1]))],
        },
        "positions": {
            "of_survey": _near(places, surveyed_joints, run_joints),
            "of_run": _near(places, run_joints, surveyed_joints),
            "within_m": NEAR_M,
        },
    }


def _near(places, flags, others):
    """Share of the length of flagged joints that has one of the others within NEAR_M [-]; None
    without a flag."""
    if not flags.any():
        return None
    tree = scipy.spatial.cKDTree(np.column_stack([places.x[others], places.z[others]]))
    near = tree.query(np.column_stack([places.x[flags], places.z[flags]]))[0] <= NEAR_M
    return places.length[flags][near].sum() / places.length[flags].sum()


def on_joints(survey):
    """A survey (`Survey.as_dict`) on its wall in a line."""
    return (
        f"survey {survey['file']}: {survey['cracks']} cracks, {survey['crack_length_m']:.2f} m,"
        f" {100 * survey['share_on_joints']:.0f} % of it on joints, up to"
        f" {1e3 * survey['apart_m']:.0f} mm away"
    )


def describe_beside(comparison):
    """The result of `beside` as lines."""
    survey = comparison["survey"]
    positions = comparison["positions"]
    shares = [
        "-" if positions[name] is None else f"{100 * positions[name]:.0f} %"
        for name in ("of_survey", "of_run")
    ]
    return [
        on_joints(survey),
        f"seen from {survey['detection_limit_mm']:.3g} mm, +-{survey['width_error_mm']:.3g} mm",
        f"{'':16}{'survey':>10}{'run':>10}",
        *(
            f"{name:16}{in_survey:>10.3g}{in_run:>10.3g}"
            for name, (in_survey, in_run) in comparison["widths"].items()
        ),
        f"pattern of visible cracks: {in_words(comparison['pattern'])}",
        (
            f"positions: {shares[0]} of the survey's length has a crack of the run within "
            f"{1e3 * positions['within_m']:.0f} mm, {shares[1]} of the run's one of the survey"
        ),
        f"distance {comparison['distance']:.2f} (0: as the survey, 1: nothing at the same place)",
        *(f"note: {note}" for note in survey["notes"]),
    ]
