"""Shards: the points of a study in the reference solver, grouped to jobs of about an hour.

DIR/shards/NUMBER.json lists the points of one, `run_shard.py` runs them into NUMBER.rows, and NUMBER.done says that
it did.  The batch writes them before it starts, and is alone then: records move with their points.
"""

import json
import os
import re
from dataclasses import asdict

from shared import write_if_other

from damage.files import write_text
from damage.studies.members import most_members
from damage.studies.records import (
    FOLDER,
    all_records,
    is_of_today,
    line_of,
    look_at,
    paths_of,
    read_records,
)
from damage.studies.tables import runs_there

RUNS_AN_HOUR = 1500
"""Of a processor, about: walls of 400 bricks, 5 s."""
FIRST_TABLES = ("index", "events", "joints", "cycles")
"""Of the first run of a point; of sequences shocks, too."""


SET_ASIDE = "set-aside.rows"
"""Records of points that the study does not have now."""


def write_shards(study, folder, keep, size, stale=frozenset(), forgotten=()):
    """Write the shards of a study, of `size` runs or a point more; returns warnings, a list of str.

    keep: "all" histories, or those of a "summary"; stale: ids of points of which no record stays; forgotten: names of
    runs to be made again.  Records of index or measures that this version defines otherwise are not kept: what has a
    history gets another one out of it.  Those of points that the study lacks are set aside.
    """
    points = [run for run in study.runs if run.solver == "reference"]
    if not points:  # those of another call stay
        return []
    base, warnings = folder / FOLDER, _faults(folder)
    records, aside = _sorted(all_records(folder), {run.id for run in points}, stale, forgotten)
    if more := aside.keys() - read_records(base / SET_ASIDE).keys():
        warnings.append(f"{len(more)} records of points that the study no longer has are set aside in "
                        f"{base / SET_ASIDE}: they count again when their points return with equal inputs")
    base.mkdir(exist_ok=True)
    shards = list(grouped(points, size))
    _write_rows({f"{number:04d}.rows": [record for run in shard for record in records.get(run.id, {}).values()]
                 for number, shard in enumerate(shards)} | {SET_ASIDE: list(aside.values())}, base)
    for number, shard in enumerate(shards):
        path = base / f"{number:04d}.json"
        write_if_other(path, json.dumps({"keep": keep, "points": [asdict(run) for run in shard]}, indent=1))
        undone = [run for run in shard if not is_done(run, folder, keep, records.get(run.id, {}))]
        if undone:
            path.with_suffix(".done").unlink(missing_ok=True)
        for run in undone:
            _forget_members(run, folder, records.get(run.id, {}))
    for path in base.iterdir():
        if path.name != SET_ASIDE and (not path.name[:4].isdigit() or int(path.name[:4]) >= len(shards)):
            path.unlink()
    return warnings


def _sorted(found, mine, stale, forgotten):
    """Of {name: record}: {id of a point: {name: record}} of those that stay, {name: record} of those of points that are
    not among `mine`."""
    records, aside = {}, {}
    for name, record in found.items():
        point = point_of(name)
        if point not in mine:
            aside[name] = record
        elif point not in stale and name not in forgotten and is_of_today(record["row"]):
            records.setdefault(point, {})[name] = record
    return records, aside


def _forget_members(run, folder, records):
    """Take away the list of an ensemble's members where one of them left nothing: the point counts as not done."""
    there = runs_there(run, folder)
    if run.is_ensemble and not all(name in records or (folder / "runs" / f"{name}.h5").is_file() for name in there):
        (folder / "runs" / f"{run.id}.members").unlink()


def _faults(folder):
    """A warning for each line of records that was changed since it was written."""
    return [f"{path} line {number}: the record of {name or 'a run'} was changed since it was written ({what}): it "
            "counts as not made" for path in paths_of(folder) for number, name, what in look_at(path)[1]]


def _write_rows(files, base):
    """Write {file: records} where a file does not hold just these."""
    changed = {base / name: rows for name, rows in files.items() if not _holds(base / name, rows)}
    for path, rows in changed.items():  # all are there before one that held them goes
        write_text(path.with_suffix(".rows.new"), "".join(map(line_of, rows)))
    for path in changed:
        os.replace(path.with_suffix(".rows.new"), path)


def _holds(path, rows):
    """Whether a file of records holds these and no line that was changed."""
    found, faults = look_at(path)
    return not faults and [*found.values()] == rows


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


def is_done(run, folder, keep, records):
    """Whether all that a point leaves is there; records: {name: record} of its runs."""
    names = runs_there(run, folder)
    kept = names if keep == "all" else [run.first]
    return bool(names) and all(name in records for name in names) and all(
        (folder / "runs" / f"{name}.h5").is_file() for name in kept) and all(
        (folder / "tables" / f"{run.first}_{table}.csv").is_file() for table in FIRST_TABLES)
