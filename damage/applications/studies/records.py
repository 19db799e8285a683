"""Records of a study: the one table of what is known of its runs, DIR/records.jsonl.

A line of a run is written as soon as the run has ended: {"run": its name, "inputs": key of what it
was made from, "intact": whether no joint broke or reached its limit, "row": that of the summary,
with the digests of the model and of the measures, "cycles" and "shocks": the rows of these tables,
"patterns": SHA-256 of its patterns at rest, where these are kept, "sha256": a checksum of all
this}; of a house row and tables are those of the first wall, and "others" has those of each other
one.  A line of a point is
{"point": its name with the solver, "inputs": key, "of": its inputs
(`damage.applications.studies.inputs.as_json`), "sha256"}.  The last good line counts.  A line that
a kill tore is none, and neither is one that was changed since.

A slice of a study writes records-K-of-N.jsonl beside it.
"""

import hashlib
import json
import math
import re
from dataclasses import dataclass, field

from damage.applications.studies.read import bounds_of
from damage.errors import InputError
from damage.measure.cycles import cycles_table, shocks_table
from damage.measure.tables import summary_row
from damage.provenance import measures_digest

TABLES = {"cycles": cycles_table, "shocks": shocks_table}
"""Those that every run has its rows in."""
NAME = "records.jsonl"
SUM = "sha256"
_NAMED = re.compile(r'"(?:run|point)": "([^"]+)"')


@dataclass
class Records:
    """What the records of a folder say.

    runs: {name: record}; inputs: {key: inputs as JSON}; points: {StudyRun.id: key}, which holds for
    histories without a record; faults: one line for each record that was changed.
    """

    runs: dict = field(default_factory=dict)
    inputs: dict = field(default_factory=dict)
    points: dict = field(default_factory=dict)
    faults: list = field(default_factory=list)

    def names_of(self, run):
        """Names of the runs of a StudyRun in their order, empty where it is not done."""
        count = run.runs_needed(self.of_point(run))
        names = [run.name(number) for number in range(1, count + 1)]
        return names if all(name in self.runs for name in names) else []

    def of_point(self, run):
        """{number from 1: record} of the runs of a StudyRun."""
        return {
            number: self.runs[run.name(number)]
            for number in range(1, run.most_members + 1)
            if run.name(number) in self.runs
        }

    def text(self):
        """The content of NAME that holds all of this."""
        others = {record.get("inputs") for record in self.runs.values()} & self.inputs.keys() - {
            *self.points.values()
        }
        lines = [point_line(point, key, self.inputs[key]) for point, key in self.points.items()]
        lines += [point_line("", key, self.inputs[key]) for key in sorted(others)]
        return "".join([*lines, *map(line_of, self.runs.values())])


def record_of(history, name, point):
    """The record of a run from its History, without the key of its inputs; point: that of the
    study.  Raises InputError where a number is none that a run can have."""
    sequence = history.series["shock"].iloc[-1] > 1 or "life" in history.parameters
    parts = []
    for part in history.parts:
        end = "" if part is history else f":{part.wall}"
        row = summary_row(part, run=name + end, point=point + end) | {"wall": history.wall + end}
        tables = {
            table: make(part).to_dict("records") if sequence or table != "shocks" else []
            for table, make in TABLES.items()
        }
        parts.append({"row": row} | tables)
    record = {"run": name, "intact": history.is_intact, **parts[0]}
    record |= {"others": parts[1:]} if len(parts) > 1 else {}
    _check_numbers(record)
    return record


def parts_of(record):
    """What a record has of each wall of a house, of a plane wall itself: tables with "row" and
    TABLES."""
    return [record, *record.get("others", ())]


def line_of(content):
    """A record as a line, its checksum included."""
    return json.dumps(content | {SUM: key_of(content)}) + "\n"


def point_line(point, key, inputs):
    """The line of a point (StudyRun.id, "" of none)."""
    return line_of({"point": point, "inputs": key, "of": inputs})


def key_of(content):
    """The key of inputs as JSON, and the checksum of a record: sixteen hexadecimal digits of the
    SHA-256."""
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()[:16]


def read_records(folder):
    """The Records of a study's folder."""
    records = Records()
    for path in sorted(folder.glob("records*.jsonl"), key=lambda path: path.stat().st_mtime_ns):
        _read_file(path, records)
    return records


def _read_file(path, records):
    """Add what a file of records says."""
    lines = path.read_text(encoding="utf-8", errors="replace").split("\n")
    for number, line in enumerate(lines, start=1):
        if not line.rstrip().endswith("}"):  # empty, or torn
            continue
        try:
            record = _believed(line)
        except ValueError as error:
            name = _NAMED.search(line)
            records.faults.append(
                f"{path} line {number}: the record of {name[1] if name else 'a run'} was changed"
                f" since it was written ({error}): it counts as not made"
            )
            continue
        if "run" in record:
            record.setdefault("inputs", None)
            records.runs[record["run"]] = record
        else:
            records.inputs[record["inputs"]] = record["of"]
            records.points |= {record["point"]: record["inputs"]} if record["point"] else {}


def point_of(name):
    """The StudyRun.id that a run belongs to, by its name."""
    return re.sub(r"_s\d+$", "", name)


def is_of_today(row):
    """Whether index and measures of a summary's row are defined as by this version."""
    return row.get("measures_digest") == measures_digest()


def _believed(line):
    """The record of a line without its checksum; ValueError, which says what is wrong, where it was
    changed."""
    try:
        record = json.loads(line)
    except ValueError:
        raise ValueError("it is no JSON") from None
    if not isinstance(record, dict) or record.pop(SUM, None) != key_of(record):
        raise ValueError("its checksum is wrong")
    return record


def _check_numbers(record):
    """Raise InputError of a number of a record that no run can have.  NaN is an empty cell."""
    rows = (
        row for part in parts_of(record) for row in (part["row"], *part["cycles"], *part["shocks"])
    )
    for row in rows:
        for name, value in row.items():
            least, most = bounds_of(name)
            if (
                isinstance(value, float | int)
                and not math.isnan(value)
                and not (math.isfinite(value) and least <= value <= most)
            ):
                raise InputError(
                    f"its {name} = {value:g}: expected a number from {least:g} to {most:g}"
                )
