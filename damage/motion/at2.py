"""PEER AT2: a header with NPTS and DT, then samples in g."""

import re
from functools import lru_cache
from pathlib import Path

import numpy as np

from damage.csv_table import as_float, is_number
from damage.errors import InputError
from damage.motion.columns import UNITS_M_S2, bad_line, check_step, lines_of, numbers, taken_unit
from damage.motion.record import MOST_SAMPLES, Record

MOST_HEADER = 12
"""Lines of a header: PEER writes four, files that are made of PEER's have up to seven."""

_LINE = r"[^\r\n]*(?>\r\n|\r|\n)"
BEGINS = rf"(?:{_LINE}){{0,{MOST_HEADER - 1}}}(?![ \t]*#)(?i:[^\r\n]*\bNPTS\b)"
"""Regular expression of how a file begins: a line of its header has NPTS and is no comment."""
_STEP = r"(?P<step>[-+]?(?:\d+(?:[.,]\d+)?\.?|[.,]\d+)(?:[edED][-+]?\d+)?)"
_COUNT = r"(?P<count>\d{1,12})"
_COUNT_AND_STEP = [
    re.compile(pattern, re.IGNORECASE)
    for pattern in (
        rf"\bNPTS\s*[=:]\s*{_COUNT}\b.*?\bDT\s*[=:]\s*{_STEP}",
        rf"\bDT\s*[=:]\s*{_STEP}.*?\bNPTS\s*[=:]\s*{_COUNT}\b",
        rf"^\s*{_COUNT}[\s,]+{_STEP}[\s,]+NPTS\s*,?\s*DT\b",
        rf"^\s*{_STEP}[\s,]+{_COUNT}[\s,]+DT\s*,?\s*NPTS\b",
    )
]
_IN_G = re.compile(r"\b(?:in|of|are) +\(?g\)? *(?:$|[.,;])", re.IGNORECASE)
"""How a header says the unit: ACCELERATION TIME SERIES IN UNITS OF G."""
_NOT_ACCELERATION = re.compile(r"\b(?:velocity|displacement)\b", re.IGNORECASE)


@lru_cache(maxsize=40)  # members and lives of a study ask again for components that ship
def read(path, data, unit=None):
    """Return the Record of an AT2 file's bytes; unit: one of UNITS_M_S2 where the header does not
    name g."""
    lines = lines_of(path, data)
    head = next((k for k, line in enumerate(lines[:MOST_HEADER]) if count_and_step(line)), None)
    if head is None:
        raise bad_line(
            path,
            4,
            [*lines[3:4], ""][0],
            "gives no NPTS and DT",
            "a PEER AT2 header such as NPTS= 4000, DT= .0050 SEC",
        )
    count, step_s = count_and_step(lines[head])
    taken, unit_origin = _unit(path, lines[:head] or [""], unit)
    if count > MOST_SAMPLES:
        raise InputError(f"{path}: {count} samples; expected up to {MOST_SAMPLES}, cut the record")
    check_step(path, step_s)
    values = []
    for number, line in enumerate(lines[head + 1 :], head + 2):
        if len(values) < count or any(map(is_number, line.split())):  # not a last line "END"
            values += numbers(path, number, line)
    if len(values) != count:
        raise InputError(
            f"{path}: {len(values)} values; expected the NPTS = {count} of line {head + 1}, fetch"
            " it anew"
        )
    with np.errstate(over="ignore"):  # an infinite sample is refused with its number
        return Record(
            Path(path).stem,
            step_s,
            np.array(values) * UNITS_M_S2[taken],
            "",
            str(path),
            unit=unit_origin,
        )


def _unit(path, head, given):
    """(unit, words that say it and where it was named) by the line of a header that names g, or by
    --unit where none does."""
    for number, line in enumerate(head, 1):
        if _NOT_ACCELERATION.search(line):
            raise bad_line(
                path,
                number,
                line,
                "is another quantity",
                "ACCELERATION IN UNITS OF G, give the record's AT2 file",
            )
    named = [(number, line) for number, line in enumerate(head, 1) if _IN_G.search(line.rstrip())]
    header = named[0] if named else (len(head), head[-1])
    return taken_unit(path, header, "g" if named else None, given)


def count_and_step(line):
    """NPTS and DT [s] of a header line in either of PEER's orders, or None.

    >>> lines = "NPTS=  400, DT= 0,005 SEC", "DT= .0050, NPTS= 400", "400 .005 NPTS, DT"
    >>> [count_and_step(line) for line in lines]
    [(400, 0.005), (400, 0.005), (400, 0.005)]
    """
    match = next(filter(None, (pattern.search(line) for pattern in _COUNT_AND_STEP)), None)
    return match and (
        int(match["count"]),
        as_float(match["step"].replace(",", ".").rstrip(".") or "0"),
    )
