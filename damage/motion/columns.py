"""Two columns of text, time and acceleration: CSV as programs and countries write it, and plain text with blanks."""

import math
import re

import numpy as np

from damage.errors import InputError
from damage.motion.record import MOST_SAMPLES, _shown
from damage.units import GRAVITY

UNITS_M_S2 = {"m_s2": 1.0, "cm_s2": 0.01, "gal": 0.01, "g": GRAVITY}
"""Units of the acceleration, and their factors to m/s2; 1 gal is 1 cm/s2."""

EXPECTED_HEADER = ("time_s and one of " + ", ".join(f"acc_{unit}" for unit in UNITS_M_S2)
                   + ', or with units in brackets, as "time [s]" and "acc [cm/s2]"')

_TIME = re.compile(r"(?:time|t) *[ _\[(] *(?:s|sec|seconds?) *[\])]?")
_ACCELERATION = re.compile(r"(?:a|acc|accel|acceleration) *[ _\[(] *(.+?) *[\])]?")
_DECIMAL = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+|\d+,\d+)(?:[eE][-+]?\d+)?")
"""A number with a decimal point or a decimal comma."""


def read_columns(path, lines: list[str]) -> tuple[list[int], np.ndarray]:
    """Numbers of the data lines, and time [s] and acceleration [m/s2] in them, (n_samples, 2).

    lines: of a text file, with comments that start with # and a header that names the unit (without one: m/s2).
    Between the columns stands a comma, a semicolon, a tabulator or blanks; numbers have a decimal point or, unless
    commas separate the columns, a decimal comma.  Raises InputError with the line that does not fit.
    """
    rows = [(i, line) for i, line in enumerate(lines, 1) if line.split("#")[0].strip()]
    header = rows.pop(0) if rows and not any(map(is_number, re.split(r"[,;\s]+", rows[0][1].strip()))) else None
    separator = _separator(rows[0][1]) if rows else ","
    to_m_s2 = _header_unit(path, *header, separator) if header else 1.0
    if len(rows) < 2:
        raise InputError(f"{path}: {len(rows)} data rows; expected 2 or more of time_s,acc_m_s2")
    if len(rows) > MOST_SAMPLES:
        raise InputError(f"{path}: {len(rows)} samples; expected up to {MOST_SAMPLES}, cut the record")
    values = _values(path, rows, separator)
    values[:, 1] *= to_m_s2
    return [number for number, _ in rows], values


def _separator(line: str) -> str | None:
    """The separator of the columns of a data line; None: blanks.

    >>> [_separator(line) for line in ("0.01,0.2", "0.01, 0.2", "0,01;0,2", "0,01 0,2", " 0.01  .2 ")]
    [',', ',', ';', None, None]
    """
    if ";" in line:
        return ";"
    if "\t" in line.strip():
        return "\t"
    cells = line.split()
    return None if len(cells) > 1 and all(map(_DECIMAL.fullmatch, cells)) else ","


def _header_unit(path, number: int, line: str, separator: str | None) -> float:
    """Factor from the header's unit of acceleration to m/s2."""
    # where blanks separate them, the next column begins with a letter: "time [s]  acc [g]"
    cells = line.split(separator) if separator else re.split(r"\s+(?=[A-Za-z])", line.strip())
    cells = [cell.strip(' "\t').lower() for cell in cells]
    if len(cells) > 2 and _TIME.fullmatch(cells[0]):
        raise bad_line(path, number, line, f"has {len(cells)} columns", "two, time and one component of the "
                       "acceleration; keep these two in a file of their own")
    found = len(cells) == 2 and _TIME.fullmatch(cells[0]) and _ACCELERATION.fullmatch(cells[1])
    unit = _plain_unit(found[1]) if found else None
    if unit not in UNITS_M_S2:
        raise bad_line(path, number, line, "is an unknown header",
                       f"{EXPECTED_HEADER}; name the unit there, and begin lines above the header with #")
    return UNITS_M_S2[unit]


def _plain_unit(unit: str) -> str:
    """A unit in the spelling of UNITS_M_S2, where it is one of them.

    >>> [_plain_unit(unit) for unit in ("cm/s²", "m/s^2", "cm/sec/sec", "gal", "mm")]
    ['cm_s2', 'm_s2', 'cm_s2', 'gal', 'mm']
    """
    unit = re.sub(r"[ ^*]", "", unit).replace("/", "_").replace("sec", "s").replace("_s_s", "_s2")
    return re.sub(r"s[²\ufffd]$", "s2", unit)  # \ufffd: an exponent of a text that is not in UTF-8


def _values(path, rows, separator: str | None) -> np.ndarray:
    """Time and acceleration of all lines (number, text), (n_samples, 2)."""
    if separator != ",":
        rows = _with_points(path, rows)
    try:
        values = np.array([[float(cell) for cell in line.split(separator)] for _, line in rows])
        fit = values.shape[1:] == (2,) and np.isfinite(values).all()
    except ValueError:
        fit = False
    # all at once for speed; one by one to name the line that does not fit
    return values if fit else np.array([_row(path, number, line, separator) for number, line in rows])


def _with_points(path, rows):
    """The lines with decimal points; InputError where some have commas and some have points, as of thousands."""
    if not any("," in line for _, line in rows):
        return rows
    for number, line in rows:
        if "." in line:
            raise bad_line(path, number, line, "has a decimal point in a file with decimal commas",
                           "one of them, and nothing between thousands")
    return [(number, line.replace(",", ".")) for number, line in rows]


def _row(path, number: int, line: str, separator: str | None) -> list[float]:
    """Time and acceleration of one line."""
    values = numbers(path, number, line, separator)
    if len(values) != 2:
        expected = "two, time and acceleration, with a comma, a semicolon, a tabulator or blanks between"
        raise bad_line(path, number, line, f"has {len(values)} column(s)", expected)
    return values


def is_number(cell: str) -> bool:
    """Whether a cell is a number with a decimal point; so are nan and inf."""
    try:
        float(cell)
    except ValueError:
        return False
    return True


def numbers(path, number: int, line: str, separator: str | None = None) -> list[float]:
    """The finite numbers of one line; None separates them at blanks."""
    cells = line.split(separator)
    if not all(map(is_number, cells)):
        raise bad_line(path, number, line, "is not numeric", "numbers; comments start with #")
    values = [float(cell) for cell in cells]
    if not all(map(math.isfinite, values)):
        raise bad_line(path, number, line, "is not finite", "no NaN or inf, fill or cut the gap")
    return values


def bad_line(path, number: int, line: str, problem: str, expected: str) -> InputError:
    """The error of a line that does not fit."""
    return InputError(f"{path}: line {number}: {_shown(line)} {problem}; expected {expected}")
