"""What every run of a study leaves, whether its history is kept or not: a line of JSON in the file of its shard.

DIR/shards/NUMBER.rows holds a line a run, written whole as soon as the run is: {"run": its name, "intact": whether no
joint broke or reached its limit, "row": that of the summary, "cycles" and "shocks": the rows of these tables}.  A line
that a kill tore is no run.
"""

import json

from damage.measure.cycles import cycles_table
from damage.measure.tables import shocks_table, summary_row

TABLES = {"cycles": cycles_table, "shocks": shocks_table}
"""Those that every run has its rows in."""
FOLDER = "shards"


def record_of(history, name, point):
    """The record of a run from its History; point: that of the study."""
    sequence = history.series["shock"].iloc[-1] > 1
    return {"run": name, "intact": history.is_intact,
            "row": summary_row(history, run=name, point=point),
            **{table: make(history).to_dict("records") if sequence or table != "shocks" else []
               for table, make in TABLES.items()}}


def add_record(file, record):
    """Write a record as the next line of an open file, whatever stands before it."""
    file.write(f"{json.dumps(record)}\n")
    file.flush()


def read_records(path):
    """{name: record} of a file of records, the last of a name; empty where there is none."""
    try:
        lines = path.read_text(encoding="utf-8").split("\n")
    except FileNotFoundError:
        return {}
    return {record["run"]: record for record in map(_whole, lines) if record}


def _whole(line):
    try:
        return json.loads(line)
    except ValueError:
        return None


def all_records(folder):
    """{name: record} of all shards of a study's folder."""
    found = {}
    for path in sorted((folder / FOLDER).glob("*.rows*")):
        found |= read_records(path)
    return found
