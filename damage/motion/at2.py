"""PEER AT2 files: header lines, the last with NPTS and DT, then accelerations in g, several a line."""

import re
from pathlib import Path

import numpy as np

from damage.errors import InputError
from damage.motion.columns import UNITS_M_S2, as_float, bad_line, is_number, numbers, units_in
from damage.motion.record import MOST_SAMPLES, Record
from damage.motion.time_axis import check_step

MOST_HEADER = 12
"""Lines of a header: PEER writes four, files that are made of PEER's have up to seven."""

_STEP = r"(?P<step>[-+]?(?:\d+(?:[.,]\d+)?\.?|[.,]\d+)(?:[edED][-+]?\d+)?)"
_COUNT = r"(?P<count>\d{1,12})"
_COUNT_AND_STEP = [re.compile(pattern, re.IGNORECASE) for pattern in (
    rf"\bNPTS\s*[=:]\s*{_COUNT}\b.*?\bDT\s*[=:]\s*{_STEP}", rf"\bDT\s*[=:]\s*{_STEP}.*?\bNPTS\s*[=:]\s*{_COUNT}\b",
    rf"^\s*{_COUNT}[\s,]+{_STEP}[\s,]+NPTS\s*,?\s*DT\b", rf"^\s*{_STEP}[\s,]+{_COUNT}[\s,]+DT\s*,?\s*NPTS\b")]
_QUANTITY = re.compile(r"\bACC|\bVEL|\bDISP|\bUNIT", re.IGNORECASE)
_NOT_ACCELERATION = re.compile(r"\bVEL|\bDISP", re.IGNORECASE)


def is_at2(lines: list[str]) -> bool:
    """Whether a text begins as an AT2 file."""
    return any(count_and_step(line) for line in lines[:MOST_HEADER] if not line.lstrip().startswith("#"))


def read_at2(path, lines: list[str], unit=None) -> Record:
    """The record of an AT2 file's lines; unit: one of UNITS_M_S2 where the header does not name g."""
    head = next((k for k, line in enumerate(lines[:MOST_HEADER]) if count_and_step(line)), None)
    if head is None:
        raise bad_line(path, 4, [*lines[3:4], ""][0], "gives no NPTS and DT",
                       "a PEER AT2 header such as NPTS= 4000, DT= .0050 SEC")
    count, step_s = count_and_step(lines[head])
    taken, words = _unit(path, lines[:head] or [""], unit)
    if count > MOST_SAMPLES:
        raise InputError(f"{path}: {count} samples; expected up to {MOST_SAMPLES}, cut the record")
    check_step(path, step_s)
    values = []
    for number, line in enumerate(lines[head + 1:], head + 2):
        if len(values) < count or any(map(is_number, line.split())):  # not a last line "END"
            values += numbers(path, number, line)
    if len(values) != count:
        raise InputError(f"{path}: {len(values)} values; expected the NPTS = {count} of line {head + 1}, fetch it anew")
    with np.errstate(over="ignore"):  # an infinite sample is refused with its number
        return Record(Path(path).stem, step_s, np.array(values) * UNITS_M_S2[taken], "", str(path), unit=words)


def _unit(path, head: list[str], given) -> tuple[str, str]:
    """(unit, words that say it and where it was named) by the last line of a header that names a quantity, the third
    where none does."""
    index = next((k for k in range(len(head) - 1, min(1, len(head) - 1), -1) if _QUANTITY.search(head[k])),
                 min(2, len(head) - 1))
    line = head[index]
    named = {*units_in(line)}
    if _NOT_ACCELERATION.search(line) or len(named) > 1:
        raise bad_line(path, index + 1, line, "is another quantity" if len(named) < 2 else "names two units",
                       "ACCELERATION IN UNITS OF G, give the record's AT2 file")
    if given and named and UNITS_M_S2[given] != UNITS_M_S2[min(named)]:
        raise bad_line(path, index + 1, line, f"names {min(named)}, --unit {given}", "the same; leave --unit out")
    if given:
        return given, f"{given} (--unit)"
    if named != {"g"}:
        raise bad_line(path, index + 1, line, "does not name g", "ACCELERATION TIME SERIES IN UNITS OF G there, or "
                       f"--unit {'|'.join(UNITS_M_S2)}")
    return "g", f"g (line {index + 1})"


def count_and_step(line: str) -> tuple[int, float] | None:
    """NPTS and DT [s] of a header line in either of PEER's orders, or None.

    >>> [count_and_step(line) for line in ("NPTS=  400, DT= 0,005 SEC", "DT= .0050, NPTS= 400", "400 .005 NPTS, DT")]
    [(400, 0.005), (400, 0.005), (400, 0.005)]
    """
    found = next(filter(None, (pattern.search(line) for pattern in _COUNT_AND_STEP)), None)
    return found and (int(found["count"]), as_float(found["step"].replace(",", ".").rstrip(".") or "0"))
