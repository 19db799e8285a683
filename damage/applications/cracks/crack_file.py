"""Digitised cracks of a wall at successive load levels: the CSV format of
`docs/reference/crack-format.md`.

A crack is one polyline or several.  The sizes and the mode in the row of a point hold from there to
the next point.  Width is sqrt(opening^2 + slip^2); where only the width is known, the mode says
what it is: tension all opening, shear all slip; mixed and unknown leave both open, which is NaN
here.
"""

from dataclasses import dataclass, field
from math import isnan, nan

import numpy as np
import pandas as pd

from damage.csv_table import read_csv
from damage.errors import InputError
from damage.fields import Column
from damage.files import write_text
from damage.index import THRESHOLD
from damage.measure.cracks import ENDS, cracks_at
from damage.units import MILLIMETRE
from damage.wall.parameters import LONGEST_M

MOST_MM = 1e4
OF_LEVEL = {
    "load_level": Column("1", "successive load levels", least=-1e6, most=1e6),
    "drift_pct": Column(
        "%", "top displacement over height; one value a level", least=-1e3, most=1e3
    ),
}
COLUMNS = {
    **OF_LEVEL,
    "crack": Column("", "label of a crack; all its polylines have it", "U"),
    "point": Column("1", "number along a polyline, which begins at 1", most=1e9),
    "x_m": Column("m", "place of the point, along the wall", least=-LONGEST_M, most=LONGEST_M),
    "z_m": Column("m", "the same, upwards", least=-LONGEST_M, most=LONGEST_M),
    "opening_mm": Column("mm", "across the crack, zero or more", least=0, most=MOST_MM),
    "slip_mm": Column("mm", "along it, signed", least=-MOST_MM, most=MOST_MM),
    "width_mm": Column("mm", "sqrt(opening² + slip²)", least=0, most=MOST_MM),
    "mode": Column("", "tension, shear, mixed, unknown", "U"),
}
OF_SURVEY = {
    "offset": Column("", "whether the faces are seen to be offset: yes, no, unknown", "U"),
    "detection_limit_mm": Column("mm", "width from which cracks are seen", least=1e-9, most=100),
    "width_error_mm": Column("mm", "largest error of the widths", least=0, most=100),
}
"""{name: Column} of a crack file, and those of a survey of a real wall."""
REQUIRED = ("crack", "point", "x_m", "z_m")
MODES = ("tension", "shear", "mixed", "unknown")
NO_CRACK = "none"
"""Mode of an area that was looked at and has no crack: its points 1 and 2 are opposite corners."""
SEEN = {"yes": 1.0, "no": 0.0, "unknown": nan, "": nan}
SEEN_AS = {1.0: "yes", 0.0: "no"}
"""Words of the column `offset`, read and written."""
STRETCHES = (
    *("crack", "line", *ENDS, "length_m"),
    *("opening_m", "slip_m", "width_m", "mode", "offset"),
)
MOST_DRAWN_M = 10_000.0
"""Length of all polylines of a file [m]."""
MOST_POINTS = 20_000
"""Rows of a file: each stretch is laid on the joints by itself."""
# share of the width by which a given width may miss sqrt(opening^2 + slip^2), for rounding
_AGREE = 0.02
_AGREE_MM = 0.01


@dataclass(frozen=True)
class CrackPattern:
    """All cracks of a wall at one load level.

    level: its number; drift_ratio: NaN where unknown;
    stretches: DataFrame, a row a straight part of a polyline: crack (label), line (number of the
    polyline in the level), x_start_m, z_start_m, x_end_m, z_end_m, length_m, opening_m and slip_m
    (NaN where they cannot be distinguished), width_m, mode, offset (1 where its faces are seen to
    be offset, 0 where they are not, NaN where nobody says);
    detection_limit_m, width_error_m: width from which cracks are seen, largest error of a width
    (NaN where unknown); clear: (n, 4) [m], rectangles x, z, x, z of opposite corners that have no
    crack.
    """

    level: float
    drift_ratio: float
    stretches: pd.DataFrame
    detection_limit_m: float = nan
    width_error_m: float = nan
    clear: np.ndarray = field(default_factory=lambda: np.zeros((0, 4)))


def read_cracks(path):
    """The patterns of a crack file, a list of CrackPattern in the order of the file.

    Raises InputError, with the line, for anything that is missing or contradicts itself.
    """
    table = read_csv(path, COLUMNS | OF_SURVEY, REQUIRED, MOST_POINTS)
    rows = _rows(table)
    patterns = []
    for level, here in rows.groupby("level", sort=False):
        is_area = here["mode"] == NO_CRACK
        patterns.append(
            CrackPattern(
                level,
                drift_ratio=_one_value(table, here["drift_pct"]) / 100,
                stretches=_stretches(table, here[~is_area & ~here["empty"]]),
                detection_limit_m=_one_value(table, here["detection_limit_mm"]) * MILLIMETRE,
                width_error_m=_one_value(table, here["width_error_mm"]) * MILLIMETRE,
                clear=_clear(table, here[is_area]),
            )
        )
    drawn = sum(pattern.stretches["length_m"].sum() for pattern in patterns)
    if drawn > MOST_DRAWN_M:
        raise InputError(
            f"{path}: cracks of {drawn:g} m in all; expected up to {MOST_DRAWN_M:g} m, look at the"
            " unit"
        )
    return patterns


def _rows(table):
    """Checked columns in SI units; empty: whether a row is; before: the number of the point in the
    row before, NaN where that is of another crack or level."""
    rows = table.rows.assign(level=levels_of(table), mode=table.rows["mode"].replace("", "unknown"))
    for name, known in (("mode", (*MODES, NO_CRACK)), ("offset", tuple(SEEN))):
        for row in np.flatnonzero(~rows[name].isin(known)):
            raise table.error(
                row,
                f"{name} = {rows[name][row]!r}: expected one of {', '.join(filter(None, known))}",
            )
    rows["offset"] = rows["offset"].map(SEEN)
    lacks = rows[list(REQUIRED)].isna() | rows[list(REQUIRED)].eq("")
    rows["empty"] = lacks.all(axis=1)
    for name in REQUIRED:
        table.refuse(
            (lacks[name] & ~rows["empty"]).to_numpy(),
            f"no {name}; give it, or leave crack, point, x_m and "
            "z_m all empty for a level without cracks",
        )
    for name in ("opening", "slip", "width"):
        rows[f"{name}_m"] = rows[f"{name}_mm"] * MILLIMETRE
    above = rows.shift()
    same = (
        (rows["crack"] == above["crack"])
        & (rows["level"] == above["level"])
        & (above["mode"] != NO_CRACK)
    )
    return rows.assign(before=above["point"].where(same))


def _one_value(table, column):
    """The number of a column that is of a whole level, NaN if no row gives it."""
    given = column.dropna()
    if given.empty:
        return nan
    first = given.index[0]
    for row in given.index[given != given[first]]:
        raise table.error(
            row,
            f"{column.name} = {given[row]:g}, but {given[first]:g} in line {table.line[first]} of "
            "the same load level; give one value a level",
        )
    return given[first]


def _clear(table, points):
    """Rectangles (n, 4) [m] of the rows of areas without a crack."""
    if (odd := points["point"].to_numpy() != np.arange(len(points)) % 2 + 1).any() or len(
        points
    ) % 2:
        row = points.index[int(np.argmax(odd)) if odd.any() else -1]
        raise table.error(
            row,
            f"mode = {NO_CRACK!r}: expected two rows an area, point 1 and 2, opposite corners of a "
            "rectangle without a crack",
        )
    corners = points[["x_m", "z_m"]].to_numpy(float).reshape(-1, 4)
    for row in points.index[1::2][(corners[:, :2] == corners[:, 2:]).any(axis=1)]:
        raise table.error(
            row,
            "an area without a crack that has no width or no height; expected opposite corners of "
            "a rectangle",
        )
    return corners


def _stretches(table, points):
    """The straight parts of the polylines of one level, a DataFrame with the columns STRETCHES."""
    starts = (points["point"] == 1).to_numpy()
    ends = np.append(starts, True)[1:]
    wrong = points[~starts & (points["point"] != points["before"] + 1)]
    for row, point, before, crack in wrong[["point", "before", "crack"]].itertuples():
        after, number = (
            ("", "") if isnan(before) else (f" after point {before:g}", f"{before + 1:g}, or ")
        )
        raise table.error(
            row,
            f"point = {point:g}{after} of crack {crack}: expected {number}1 where a polyline"
            " begins",
        )
    for row, crack in points["crack"][starts & ends].items():
        raise table.error(row, f"crack {crack} has a polyline of one point; expected two or more")
    here = points[~ends]
    after = points[~starts]
    places = np.hstack([rows[["x_m", "z_m"]].to_numpy(float) for rows in (here, after)])
    for row in after.index[(places[:, :2] == places[:, 2:]).all(axis=1)]:
        raise table.error(row, "the same place as the point before; leave it out")
    without_slip = here["offset"] == 0  # all that is seen is opening
    for row, mode in here["mode"][without_slip & here["mode"].isin(("shear", "mixed"))].items():
        raise table.error(
            row, f"offset = no with mode = {mode}: expected a crack without slip; correct one"
        )
    for row, slip in here["slip_m"][without_slip & (here["slip_m"] > 0)].items():
        raise table.error(
            row, f"offset = no with a slip of {slip / MILLIMETRE:g} mm: expected none; correct one"
        )
    here = here.assign(mode=here["mode"].mask(without_slip, "tension"))
    parts = []
    for row, *known in here[["opening_m", "slip_m", "width_m", "mode"]].itertuples():
        try:
            parts.append(complete_sizes(*known))
        except InputError as error:
            raise table.error(row, str(error)) from None
    here = here.assign(
        line=np.cumsum(starts)[~ends],
        length_m=np.hypot(*(places[:, 2:] - places[:, :2]).T),
        **dict(zip(ENDS, places.T)),
        **dict(zip(("opening_m", "slip_m", "width_m"), np.reshape(parts, (-1, 3)).T)),
    )
    return here[list(STRETCHES)].reset_index(drop=True)


def complete_sizes(opening, slip, width, mode):
    """Opening, slip and width [m] of what is known of them (NaN is not) and the mode.

    Raises InputError where they contradict each other or leave the width unknown.

    >>> complete_sizes(nan, nan, 0.5e-3, "shear")
    (0.0, 0.0005, 0.0005)
    """
    if mode == "tension":
        slip = 0.0 if isnan(slip) else slip
    elif mode == "shear":
        opening = 0.0 if isnan(opening) else opening
    opening, slip = _rest(opening, slip, width), _rest(slip, opening, width)
    if isnan(width) and (isnan(opening) or isnan(slip)):
        raise InputError(
            "the width is unknown: give width_mm, or opening_mm and slip_mm, or one of the two "
            "with its mode, tension or shear"
        )
    together = float(np.hypot(opening, slip))
    if abs(together - width) > _AGREE * width + _AGREE_MM * MILLIMETRE:
        raise InputError(
            f"width_mm = {width / MILLIMETRE:g}, but opening and slip give "
            f"{together / MILLIMETRE:g}; expected sqrt(opening^2 + slip^2)"
        )
    return opening, slip, width if isnan(together) else together


def _rest(wanted, other, width):
    """Opening or slip [m] from the width and the other of both, unless it is known; NaN where it
    cannot be computed."""
    return float(np.sqrt(np.maximum(width**2 - other**2, 0.0))) if isnan(wanted) else wanted


def write_cracks(path, patterns, comments=()):
    """Write patterns (CrackPattern) to `path`; comments: lines for its head.  The columns OF_SURVEY
    are there where a pattern has a value of them."""
    rows = pd.DataFrame(
        [row for pattern in patterns for row in _point_rows(pattern)],
        columns=[*COLUMNS, *OF_SURVEY],
    )
    if not (rows["mode"].eq(NO_CRACK).any() or rows[list(OF_SURVEY)].notna().any(axis=None)):
        rows = rows[list(COLUMNS)]
    numbers = rows.select_dtypes("number") + 0.0  # zero has no sign
    text = rows.assign(**numbers).to_csv(index=False, float_format="%.8g", lineterminator="\n")
    write_text(path, "".join(f"# {comment}\n" for comment in comments) + text)


def _point_rows(pattern):
    """The rows of one level: each polyline's points, the last one without sizes, then the corners
    of clear areas."""
    head = (pattern.level, 100 * pattern.drift_ratio)
    accuracy = (pattern.detection_limit_m / MILLIMETRE, pattern.width_error_m / MILLIMETRE)
    if len(pattern.stretches) == 0:
        yield (*head, *[None] * 9, *accuracy)
    for (crack, _), line in pattern.stretches.groupby(["crack", "line"], sort=False):
        for number, part in enumerate(line.itertuples(), start=1):
            yield (
                *head,
                str(crack),
                number,
                part.x_start_m,
                part.z_start_m,
                part.opening_m / MILLIMETRE,
                part.slip_m / MILLIMETRE,
                part.width_m / MILLIMETRE,
                part.mode,
                SEEN_AS.get(part.offset),
                *accuracy,
            )
        yield (*head, str(crack), number + 1, part.x_end_m, part.z_end_m, *[None] * 5, *accuracy)
    for name, (*first, x, z) in enumerate(pattern.clear, start=1):
        for point, corner in ((1, first), (2, (x, z))):
            yield (*head, f"area{name}", point, *corner, *[None] * 3, NO_CRACK, None, *accuracy)


def pattern_of(table, level, drift_ratio, threshold=THRESHOLD):
    """The CrackPattern of a `damage.measure.cracks.crack_table`: each crack as polylines along its
    joints.

    A polyline ends where the next cracked joint of its crack does not continue from its end.
    """
    is_head = (table["x_end_m"] - table["x_start_m"]).abs() < (
        table["z_end_m"] - table["z_start_m"]
    ).abs()
    start = table[["x_start_m", "z_start_m"]].to_numpy()
    across, along = np.where(is_head, start.T, start.T[::-1])
    order = np.lexsort((along, np.round(across, 6), is_head, table["crack"]))
    parts = table.iloc[order].reset_index(drop=True)
    ends = parts[list(ENDS)].to_numpy()
    goes_on = np.zeros(len(parts), bool)
    goes_on[1:] = (
        np.all(np.abs(ends[1:, :2] - ends[:-1, 2:]) < 1e-6, axis=1)
        & (np.diff(parts["crack"]) == 0)
        & (np.diff(is_head.to_numpy()[order].astype(int)) == 0)
    )
    parts["line"] = np.cumsum(~goes_on)
    parts["mode"] = modes_of(parts["opening_m"].to_numpy(), parts["slip_m"].to_numpy(), threshold)
    parts["offset"] = nan
    return CrackPattern(float(level), float(drift_ratio), parts[list(STRETCHES)])


def modes_of(opening, slip, threshold=THRESHOLD):
    """tension, shear, or mixed of openings and slips [m]: what passes the threshold, (n,) of
    words."""
    opened = opening > threshold
    slipped = np.abs(slip) > threshold
    return np.where(opened == slipped, "mixed", np.where(opened, "tension", "shear"))


def patterns_of(history, samples, threshold=THRESHOLD):
    """The CrackPatterns of a History at samples (indices), numbered from 1."""
    drift = history.series["drift_ratio"].to_numpy()
    return [
        pattern_of(cracks_at(history, sample, threshold), number, drift[sample], threshold)
        for number, sample in enumerate(samples, start=1)
    ]


MOST_LEVELS = 1000
"""Load levels of a file: what is read in seconds."""


def levels_of(table):
    """The column `load_level` (n_rows,) of a CsvTable, 1 where there is none."""
    if "load_level" not in table.names:
        return np.ones(len(table.rows))
    table.refuse_empty("load_level")
    level = table.rows["load_level"].to_numpy()
    if (level_count := len(set(level))) > MOST_LEVELS:
        raise InputError(
            f"{table.path} has {level_count} load levels: expected up to {MOST_LEVELS};"
            " take some out"
        )
    return level
