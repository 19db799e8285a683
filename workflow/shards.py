"""Shards: the points of a study in the reference solver, grouped to jobs of about an hour.

DIR/shards/NUMBER.json lists the points of one, `run_shard.py` runs them into NUMBER.rows, and NUMBER.done says that
it did.  The batch writes them before it starts, and is alone then: what is stale goes here, and records move with their
points.
"""

import json
import os
import re
import shutil
from dataclasses import asdict

from shared import ROOT

from damage.files import write_text
from damage.studies.members import most_members
from damage.studies.records import FOLDER, all_records, read_records
from damage.studies.tables import runs_there

RUNS_AN_HOUR = 1500
"""Of a processor, about: walls of 400 bricks, 5 s."""
FIRST_TABLES = ("index", "events", "joints", "cycles")
"""Of the first run of a point; of sequences shocks, too."""


def write_shards(study, folder, keep, size, forgotten=()):
    """Write the shards of a study, of `size` runs or a point more; what is stale is taken away first.

    keep: "all" histories, or those of a "summary"; forgotten: names of runs to be made again.
    """
    points = [run for run in study.runs if run.solver == "reference"]
    if not points:  # those of another call stay
        return
    stale = {run.id for run in points if drop_stale(run, folder)}
    base, records = folder / FOLDER, {}
    for name, record in all_records(folder).items():
        if point_of(name) not in stale and name not in forgotten:
            records.setdefault(point_of(name), {})[name] = record
    base.mkdir(exist_ok=True)
    shards = list(grouped(points, size))
    _write_rows(base, [[record for run in shard for record in records.get(run.id, {}).values()] for shard in shards])
    for number, shard in enumerate(shards):
        path = base / f"{number:04d}.json"
        told = json.dumps({"keep": keep, "points": [asdict(run) for run in shard]}, indent=1)
        if not path.is_file() or path.read_text(encoding="utf-8") != told:
            write_text(path, told)
        if not all(is_done(run, folder, keep, records.get(run.id, {})) for run in shard):
            path.with_suffix(".done").unlink(missing_ok=True)
    for path in base.iterdir():
        if not path.name[:4].isdigit() or int(path.name[:4]) >= len(shards):
            path.unlink()


def _write_rows(base, shards):
    """Write the records of every shard, where they are not those that it has."""
    changed = {base / f"{number:04d}.rows": rows for number, rows in enumerate(shards)
               if [*read_records(base / f"{number:04d}.rows").values()] != rows}
    for path, rows in changed.items():  # all are there before one that held them goes
        write_text(path.with_suffix(".rows.new"), "".join(f"{json.dumps(row)}\n" for row in rows))
    for path in changed:
        os.replace(path.with_suffix(".rows.new"), path)


def grouped(points, size):
    """Lists of points, in their order, each of so many runs or a point more."""
    shard, runs = [], 0
    for point in points:
        shard.append(point)
        runs += most_members(point)
        if runs >= size:
            yield shard
            shard, runs = [], 0
    if shard:
        yield shard


def shard_of(run, folder):
    """The number of the shard that a StudyRun is in, as a word; None where it is in none."""
    for path in sorted((folder / FOLDER).glob("*.json")):
        if f'"point": {json.dumps(run.point)},' in path.read_text(encoding="utf-8"):
            return path.stem
    return None


def point_of(name):
    """The StudyRun.id that a run of the reference solver belongs to, by its name."""
    return re.sub(r"_s\d+$", "", name)


def drop_stale(run, folder):
    """Take away what was made of other inputs than a StudyRun has, and note these; returns whether there may be some.

    A single run without a note is older than notes are: it is taken as it is.
    """
    note, inputs = folder / "runs" / ".inputs" / run.id, run.inputs(ROOT)
    known = note.is_file()
    if known and note.read_text(encoding="utf-8") == inputs:
        return False
    if known or run.is_ensemble:
        for path in (folder / "runs").glob(f"{run.id}*"):
            if point_of(path.name.split(".h5")[0].removesuffix(".part").removesuffix(".members")) == run.id:
                path.unlink()
        for path in (folder / "tables").glob(f"{run.first}_*"):
            path.unlink()
        shutil.rmtree(folder / "pictures" / run.first, ignore_errors=True)
    write_text(note, inputs)
    return known or run.is_ensemble


def is_done(run, folder, keep, records):
    """Whether all that a point leaves is there; records: {name: record} of its runs."""
    names = runs_there(run, folder)
    kept = names if keep == "all" else [run.first]
    return bool(names) and all(name in records for name in names) and all(
        (folder / "runs" / f"{name}.h5").is_file() for name in kept) and all(
        (folder / "tables" / f"{run.first}_{table}.csv").is_file() for table in FIRST_TABLES)
