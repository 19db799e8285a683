"""Records of the runs of a study, whether a history is kept or not: a line of JSON in the file of its shard.

DIR/shards/NUMBER.rows holds a line a run, written whole as soon as the run is: {"run": its name, "intact": whether no
joint broke or reached its limit, "row": that of the summary, "cycles" and "shocks": the rows of these tables, "sha256":
a checksum of all this}.  A line that a kill tore is no run, and neither is one that was changed since.  Lines of
earlier versions have no checksum; of these, too, numbers must be such as a run can have.
"""

import hashlib
import json
import math
import re

from damage.errors import InputError
from damage.measure.columns import bounds_of
from damage.measure.cycles import cycles_table
from damage.measure.tables import shocks_table, summary_row
from damage.provenance import measures_digest

TABLES = {"cycles": cycles_table, "shocks": shocks_table}
"""Those that every run has its rows in."""
FOLDER = "shards"
SUM = "sha256"
_PARTS = {"run": str, "intact": bool, "row": dict, **dict.fromkeys(TABLES, list)}
_NAME = re.compile(r'"run": "([^"]+)"')


def record_of(history, name, point):
    """The record of a run from its History; point: that of the study.  Raises InputError where a number is none that a
    run can have."""
    sequence = history.series["shock"].iloc[-1] > 1 or "life" in history.parameters
    record = {"run": name, "intact": history.is_intact,
              "row": summary_row(history, run=name, point=point),
              **{table: make(history).to_dict("records") if sequence or table != "shocks" else []
                 for table, make in TABLES.items()}}
    if (wrong := _wrong_number(record)) is not None:
        raise InputError(f"its {wrong}")
    return record


def line_of(record):
    """A record as a line, its checksum included."""
    return json.dumps(record | {SUM: _sum(record)}) + "\n"


def add_record(file, record):
    """Write a record as the next line of an open file, even after an incomplete line."""
    file.write(line_of(record))
    file.flush()


def read_records(path):
    """{name: record} of a file of records, the last good one of a name; empty where there is none."""
    return look_at(path)[0]


def look_at(path):
    """({name: record}, faults) of a file of records; faults: [(number of the line, name of the run or None, what is
    wrong)] of lines that were changed since they were written.  A line that was never written whole is none of them."""
    try:
        lines = path.read_text(encoding="utf-8", errors="replace").split("\n")
    except FileNotFoundError:
        return {}, []
    records, faults = {}, []
    for number, line in enumerate(lines, start=1):
        if not line.rstrip().endswith("}"):  # empty, or torn
            continue
        try:
            record = _believed(line)
        except ValueError as error:
            name = _NAME.search(line)
            faults.append((number, name and name[1], str(error)))
        else:
            records[record["run"]] = record
    return records, faults


def all_records(folder):
    """{name: record} of all shards of a study's folder, and of those that are set aside."""
    found = {}
    for path in paths_of(folder):
        found |= read_records(path)
    return found


def paths_of(folder):
    """All files of records of a study's folder, half-renamed ones included."""
    return sorted((folder / FOLDER).glob("*.rows*"))


def is_of_today(row):
    """Whether index and measures of a summary's row are defined as by this version."""
    return row.get("measures_digest") == measures_digest()


def _believed(line):
    """The record of a line without its checksum; ValueError, which says what is wrong, where it was changed."""
    try:
        record = json.loads(line)
    except ValueError:
        raise ValueError("it is no JSON") from None
    if not isinstance(record, dict) or any(not isinstance(record.get(name), kind) for name, kind in _PARTS.items()):
        raise ValueError(f"it lacks one of {', '.join(_PARTS)}")
    total = record.pop(SUM, None)
    if total is not None and total != _sum(record):
        raise ValueError("its checksum is wrong")
    if (wrong := _wrong_number(record)) is not None:
        raise ValueError(f"its {wrong}")
    return record


def _sum(record):
    """Sixteen hexadecimal digits of the SHA-256 of a record."""
    return hashlib.sha256(json.dumps(record, sort_keys=True).encode()).hexdigest()[:16]


def _wrong_number(record):
    """What number of a record no run can have, in words; None where there is none.  NaN is an empty cell."""
    for row in (record["row"], *(row for table in TABLES for row in record[table])):
        for name, value in row.items():
            least, most = bounds_of(name)
            if isinstance(value, float | int) and not math.isnan(value) and not (
                    math.isfinite(value) and least <= value <= most):
                return f"{name} = {value:g}: expected a number from {least:g} to {most:g}"
    return None
