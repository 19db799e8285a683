"""Columns of text, time and acceleration: CSV as programs and countries write it, and plain text
with blanks."""

import math
import re
from functools import lru_cache
from pathlib import Path

import numpy as np

from damage.csv_table import CsvTable, as_float, is_number, uncommented
from damage.errors import InputError, warn
from damage.fields import Column
from damage.files import text_lines
from damage.motion.record import MOST_SAMPLES, Record, _shown, _utc
from damage.units import GRAVITY

MOST_LINES = 2 * MOST_SAMPLES
"""Largest number of lines of a record's file that is text."""
UNITS_M_S2 = {
    "m_s2": 1.0,
    "cm_s2": 0.01,
    "mm_s2": 0.001,
    "gal": 0.01,
    "g": GRAVITY,
    "mg": GRAVITY / 1000,
}
"""Units of the acceleration, and their factors to m/s2; 1 gal is 1 cm/s2, 1 mg a thousandth of
g."""

COLUMNS = {"time": Column("s", "of a sample"), "acceleration": Column("as named", "of the ground")}
EXPECTED_HEADER = (
    "two columns, separated as the rows: time_s, then one of "
    + ", ".join(f"acc_{unit}" for unit in UNITS_M_S2)
    + ', or with units in brackets, as "time [s]" and "acc [cm/s2]"'
)
EXPECTED_UNIT = (
    f"a header such as time_s,acc_m_s2, or IN UNITS OF G of AT2, or --unit {'|'.join(UNITS_M_S2)}"
)

_START_UTC = re.compile(
    r"#.*\bstart(?:[ _]?time)?(?:[ _]?utc)?\s*[:=]?\s*"
    r"(\d{4}-\d\d-\d\d[T ][\d:.]+(?:Z|[-+]\d\d:?\d\d)?)",
    re.IGNORECASE,
)
"""Start of the time column in a comment."""
_TIME = re.compile(r"(?:time|t) *[ _\[(] *(?:s|sec|seconds?) *[\])]?")
_ACCELERATION = re.compile(r"(?:a|acc|accel|acceleration)(?: *[ _\[(] *(.+?) *[\])]?)?")
_DECIMAL = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+|\d+,\d+)(?:[eEdD][-+]?\d+)?")
"""A number with a decimal point or a decimal comma."""
_FORTRAN = re.compile(r"[-+]?(?:\d+\.\d*|\.\d+)(?:[eEdD][-+]?\d+|[-+]\d{3}(?![\d.]))?")
"""A number in a fixed column, which may touch the one before it by its sign."""


@lru_cache(maxsize=40)  # members and lives of a study ask again for components that ship
def read(path, data, unit=None, sample_step_s=None):
    """Return the Record of the bytes of a table; the rest as in `read_columns`."""
    lines = lines_of(path, data)
    step_s, first_s, acceleration_m_s2, unit = read_columns(path, lines, unit, sample_step_s)
    if abs(first_s) > step_s / 2:
        warn(
            f"{path}: times begin at {first_s:g} s, which is 0 s of the record: windows count from"
            " there"
        )
    starts = filter(None, map(_START_UTC.match, lines))
    start_utc = next((_utc(start.group(1), first_s, path) for start in starts), "")
    return Record(
        record_name(path),
        step_s,
        acceleration_m_s2,
        start_utc,
        str(path),
        unit=unit,
        first_s=first_s,
    )


def lines_of(path, data):
    """Lines of a record's text; a comment may be in any encoding, and a binary file fails as a line
    that is not numeric."""
    return text_lines(path, data, MOST_LINES, errors="replace")


def record_name(path):
    """Name of a record by its file's: without the quantity and unit at the end."""
    return re.sub(rf"_acc_({'|'.join(UNITS_M_S2)})$", "", Path(path).stem)


def read_columns(path, lines, unit=None, sample_step_s=None):
    """Time step and first time [s], accelerations (n_samples,) [m/s2], and their unit with what
    says so, of a table: time and acceleration, or the acceleration alone where `sample_step_s` is
    given.

    lines: of a text file, with comments that start with # and a header, which may be the comment
    right above the rows; unit: one of UNITS_M_S2 where no header names it; sample_step_s: where
    there are no times in seconds [s].  Between the columns stands a comma, a semicolon, a tabulator
    or blanks; numbers have a decimal point or, unless commas separate the columns, a decimal comma.
    Raises InputError with the line that does not fit.
    """
    rows = uncommented(lines)
    header = rows.pop(0) if rows and _is_header(rows[0][1]) else None
    if len(rows) < 2:
        raise InputError(f"{path}: {len(rows)} data rows; expected 2 or more of time_s,acc_m_s2")
    if len(rows) > MOST_SAMPLES:
        raise InputError(
            f"{path}: {len(rows)} samples; expected up to {MOST_SAMPLES}, cut the record"
        )
    first = rows[0][1].rstrip(" ,;\t")
    separator = _separator(first)
    alone = len(first.split(separator)) == 1
    if alone and sample_step_s is None:
        raise bad_line(
            path,
            *rows[0],
            "has one column",
            "two, time and one component of the "
            "acceleration, with a comma, a semicolon, a tabulator or blanks between; of "
            "accelerations alone give --sample-step S",
        )
    named_by = header or _comment_above(lines, rows[0][0])
    named = _named_unit(named_by[1], separator, alone)
    if header and not named and not (unit and named == ""):
        raise bad_line(
            path,
            *header,
            "is an unknown header",
            f"{EXPECTED_HEADER}; name the unit there, and begin lines above the header with #",
        )
    names = ["acceleration"] if alone else ["time", "acceleration"]
    table = CsvTable(path, names, rows, separator, COLUMNS)
    table.refuse_empty(*names)
    time_s, acceleration = table.rows.to_numpy().T
    _refuse_doubled(table, time_s, acceleration)
    step_s = sample_step_s if alone else uniform_step(path, table.line, time_s, sample_step_s)
    check_step(path, step_s)
    taken, unit_origin = taken_unit(path, named_by, named, unit)
    first_s = 0.0 if alone else float(time_s[0])
    if first_s and sample_step_s is not None:  # of milliseconds, or of sample numbers
        first_s *= step_s * (time_s.size - 1) / float(time_s[-1] - time_s[0])
    return step_s, first_s, acceleration * UNITS_M_S2[taken], unit_origin


def _refuse_doubled(table, time_s, acceleration):
    """Raise InputError where rows are there twice; times that are rounded have other accelerations
    where they are equal."""
    again = np.append(False, np.diff(time_s) == 0)
    if not np.diff(acceleration, prepend=0.0)[again].any():
        table.refuse(again, "the row before it once more; expected each once, take it out")


def _is_header(line):
    return not any(map(is_number, re.split(r"[,;\s]+", line.strip())))


def _comment_above(lines, first):
    """The line (number, text) above the first row, the line of this number, where it is a comment,
    as `numpy.savetxt` writes a header; otherwise the row."""
    is_comment = first > 1 and lines[first - 2].lstrip().startswith("#")
    number = first - is_comment
    return number, lines[number - 1]


def _named_unit(header, separator, alone):
    """The unit that a header names, one of UNITS_M_S2, or "" where it names time and acceleration
    without; None of any other line.  alone: of a single column.

    >>> _named_unit("# time [s]; acc [cm/s2]", ";", False), _named_unit("n-s (g)", ",", True)
    ('cm_s2', None)
    >>> _named_unit("time,acc", ",", False), _named_unit("time_s,acc_kn", ",", False)
    ('', None)
    """
    # where blanks separate them, the next column begins with a letter: "time [s]  acc [g]"
    between = re.escape(separator) if separator else r"\s+(?=[A-Za-z])"
    names = [header] if alone else re.split(between, header.strip(" \t#,;"))
    *time, acceleration = (name.strip(' "\t#').lower() for name in names)
    match = _ACCELERATION.fullmatch(acceleration)
    if not match or (not alone and len(time) != 1):
        return None
    unit = _plain_unit(match[1] or "")
    of_time = all(_TIME.fullmatch(name) or (not unit and name in ("t", "time")) for name in time)
    return unit if of_time and unit in ("", *UNITS_M_S2) else None


def taken_unit(path, header, named, given):
    """(unit, words that say it and where it was named) by the header, a line (number, text), and
    the unit that it names or None, or by --unit, which cannot replace it."""
    if given and named and UNITS_M_S2[given] != UNITS_M_S2[named]:
        raise bad_line(
            path,
            *header,
            f"names {named}, --unit {given}",
            "the same unit; leave --unit out, or correct the header",
        )
    if given:
        return given, f"{given} (--unit)"
    if not named:
        raise bad_line(path, *header, "names no unit of the acceleration", EXPECTED_UNIT)
    number, line = header
    return named, f"{named} (line {number}: {_shown(line.strip())})"


def _separator(line):
    """The separator of the columns of a data line; None: blanks.

    >>> lines = "0.01,0.2", "0.01, 0.2", "0,01;0,2", "0,01 0,2", " 0.01  .2 "
    >>> [_separator(line) for line in lines]
    [',', ',', ';', None, None]
    """
    if ";" in line:
        return ";"
    if "\t" in line.strip():
        return "\t"
    cells = line.split()
    return None if len(cells) > 1 and all(map(_DECIMAL.fullmatch, cells)) else ","


def _plain_unit(unit):
    """A unit in the spelling of UNITS_M_S2, where it is one of them.

    >>> [_plain_unit(unit) for unit in ("cm/s²", "m/s^2", "cm/sec/sec", "gals", "mm", "m s-2")]
    ['cm_s2', 'm_s2', 'cm_s2', 'gal', 'mm', 'm_s2']
    """
    unit = re.sub(r"^in ", "", unit)
    unit = re.sub(r"[ ^*()._/]", "", unit).replace("sec", "s")
    # \ufffd: an exponent of a text that is not in UTF-8
    unit = re.sub(r"(?<=m)(?:ss|s-?[2²\ufffd])$", "_s2", unit)
    return "gal" if unit == "gals" else unit


def numbers(path, number, line):
    """The finite numbers of one line, separated by blanks or by the sign of the next fixed
    column."""
    cells = line.split()
    if not all(map(is_number, cells)):
        cells = [part for cell in cells for part in _fixed_columns(cell)]
    if not all(map(is_number, cells)):
        joined = re.search(r"\.\d+\.\d", line)
        raise bad_line(
            path,
            number,
            line,
            "is not numeric",
            (
                "a blank between numbers, which touch here"
                if joined
                else "numbers; comments start with #"
            ),
        )
    values = [as_float(cell) for cell in cells]
    if not all(map(math.isfinite, values)):
        raise bad_line(path, number, line, "is not finite", "no NaN or inf, fill or cut the gap")
    return values


def _fixed_columns(cell):
    """The numbers of a cell that touch by their signs; the cell where it is no such.

    >>> tuple(map(_fixed_columns, ("-0.100E+00-0.200E-01-0.5", "1.52.5", "2018-01-08")))
    (['-0.100E+00', '-0.200E-01', '-0.5'], ['1.52.5'], ['2018-01-08'])
    """
    parts = _FORTRAN.findall(cell)
    return (
        parts if "".join(parts) == cell and all(part[0] in "+-" for part in parts[1:]) else [cell]
    )


def bad_line(path, number, line, problem, expected):
    """The error of a line that does not fit."""
    return InputError(f"{path}: line {number}: {_shown(line)} {problem}; expected {expected}")


TIME_TOLERANCE = 0.01
"""Largest distance of a CSV time from a uniform grid, as a share of the step.

Room for the rounding of the printed times: four decimals at 150 Hz are 0.75 % of the step.
"""

LONGEST_STEP_S = 0.05
"""Largest step of a record's samples [s]: beyond it nothing above 10 Hz is recorded, and walls have
their first mode at 5 to 30 Hz."""

_ROUNDED_SHARE = 0.05
"""Share of the steps that differ from the usual one [-]: fewer are lost samples, more are
rounding."""

_WAY_OUT = "write seconds, or give --sample-step S, the time between two samples [s]"


def check_step(path, step_s):
    """Raise InputError where samples are too far apart for the motion of a wall."""
    if step_s > LONGEST_STEP_S:
        raise InputError(
            f"{path}: a time step of {step_s:g} s; expected at most {LONGEST_STEP_S:g} s, or the"
            f" motion of a wall is not in the record: {_WAY_OUT}"
        )


@np.errstate(over="ignore", invalid="ignore")  # of times that no clock shows, which are refused
def uniform_step(path, lines, time_s, given_s=None):
    """The constant step [s] of a column of times (n_samples,) in these lines; given_s: what
    --sample-step says of it.

    Raises InputError with the line, or with what the column has in place of seconds.
    """
    if given_s is not None:
        return _given_step(path, time_s, given_s)
    steps = np.diff(time_s)
    usual = float(np.median(steps))
    step = (time_s[-1] - time_s[0]) / steps.size
    off_grid = np.abs(time_s - time_s[0] - step * np.arange(time_s.size))
    uniform = steps.min() > 0 and off_grid.max() <= TIME_TOLERANCE * step
    if not uniform:
        _refuse_rounded(path, time_s, steps, usual, off_grid.max())
    if not steps.min() > 0:
        k = int(np.argmax(steps <= 0))
        correction = "sort the rows, or keep one of several records"
        if not steps[k]:
            correction = "keep one of the two rows"
        raise InputError(
            f"{path}: line {lines[k + 1]}: time {time_s[k + 1]:g} s after {time_s[k]:g} s;"
            f" expected times that increase: {correction}"
        )
    if not uniform:
        k = int(np.argmax(np.abs(steps - usual)))
        raise InputError(
            f"{path}: line {lines[k + 1]}: a step of {steps[k]:g} s among {usual:g} s;"
            f" expected uniform times within {TIME_TOLERANCE:.0%} of the step, resample the record"
        )
    # twelve digits: the 0.01 s that was meant, not the nearest double of 0.29 s / 29
    step = float(f"{step:.12g}")
    if step > LONGEST_STEP_S and step == round(step) <= 50:
        what = (
            "sample numbers, or milliseconds at 1000 Hz"
            if step == 1
            else "milliseconds, or every so many samples"
        )
        raise InputError(
            f"{path}: times {time_s[0]:g}, {time_s[1]:g}, {time_s[2 % time_s.size]:g}, ... are no"
            f" seconds but {what}; expected a step of at most {LONGEST_STEP_S:g} s: {_WAY_OUT}"
        )
    return step


def _refuse_rounded(path, time_s, steps, usual, off_grid):
    """Raise InputError where times have too few decimals for their step; off_grid: their largest
    distance from uniform ones, to which rounding adds half a unit of the last place at either
    end."""
    decimals = _decimals(time_s)
    last_place = 10.0**-decimals
    unlike = np.abs(steps - usual) > 0.5 * last_place
    if off_grid > 1.001 * last_place or unlike.sum() < max(2, _ROUNDED_SHARE * steps.size):
        return
    places = f"{decimals} decimal{'s' if decimals != 1 else ''}"
    raise InputError(
        f"{path}: times are rounded to {places}: {time_s.size} samples from {time_s[0]:g} to"
        f" {time_s[-1]:g} s; expected steps that are equal within {TIME_TOLERANCE:.0%}: write times"
        f" with {decimals + 1} or more decimals, or give --sample-step S, the time between two"
        " samples [s]"
    )


def _decimals(time_s):
    """Decimals with which times are printed, up to nine."""
    for decimals in range(9):
        scaled = time_s * 10.0**decimals
        if np.abs(scaled - np.round(scaled)).max() < 1e-4:
            return decimals
    return 9


def _given_step(path, time_s, given_s):
    """The step by --sample-step; InputError unless the times are multiples of it in seconds or
    milliseconds, as far as they are rounded, or numbers of samples."""
    if not (math.isfinite(given_s) and given_s > 0):
        raise InputError(
            f"--sample-step {given_s:g}: expected the time between two samples [s]; correct it"
        )
    elapsed = time_s - time_s[0]
    numbers = np.arange(time_s.size)
    room = 10.0 ** -_decimals(time_s)
    for step in (given_s, 1e3 * given_s, 1.0):
        if np.abs(elapsed - step * numbers).max() <= max(
            TIME_TOLERANCE * step, room if step != 1.0 else 0.0
        ):
            return given_s
    raise InputError(
        f"{path}: times step by {np.median(np.diff(time_s)):g} s, --sample-step by {given_s:g} s; "
        "expected the same; leave --sample-step out, or keep the column of accelerations alone"
    )
