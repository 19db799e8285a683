"""Lives of other sessions, from their tables: only those of the same wall, options and address count, and only whole.

The head of a lives.csv has a line a point, `# POINT: wall and options DIGEST, model DIGEST, measures DIGEST`.  Tables
of earlier versions lack these lines; their events are compared with the address all the same.
"""

import hashlib
import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd

from damage.csv_table import from_words
from damage.errors import InputError, warn
from damage.studies.inputs import as_json, inputs_of

_NOTE = re.compile(r"# (\S+): wall and options (\w+), model ([\w ]+), measures ([\w ]+)")
_DRAWN = ("loading", "sequence", "events", "life", "seed")
"""Settings that differ from life to life."""
_ROUNDED = 1e-7  # of nine digits
_DRAWN_COLUMNS = {"id": "other events", "time_utc": "another time", "magnitude": "another magnitude",
                  "place": "another place", "pgv_mm_s": "another PGV", "record": "another record",
                  "scale": "another scale", "largest_mm_s": "another largest PGV"}
"""Columns that follow from the draws: {name: what is said where it differs}."""
_LOWEST = {"life": 1, "event": 0, "seed": 0, "newly_failed": 0, **dict.fromkeys(
    ("pgv_mm_s", "largest_mm_s", "max_psi", "psi", "max_DI", "DI", "crack_width_mm", "offset_after_mm"), 0.0)}
_HIGHEST = {"max_DI": 1.0, "DI": 1.0, "pgv_mm_s": 5000.0, "largest_mm_s": 5000.0}


def note_of(run, records):
    """What the lives of a StudyRun are made of, (digest of wall and options, of models, of measures), each of twelve
    hexadecimal digits; records: of its folder (`damage.studies.records`); digests are joined by a blank where they
    differ.  Files may have changed since the lives were made: they are read only where no record names its inputs."""
    there = records.of_point(run).values()
    kept = [records.inputs[one["inputs"]] for one in there if "wall" in records.inputs.get(one.get("inputs"), {})]
    inputs = kept[0] if kept else as_json(inputs_of(run, Path.cwd()))
    settings = {name: value for name, value in inputs["settings"].items() if name not in _DRAWN}
    settings["model"] = {name: value for name, value in settings["model"].items() if name != "strength_seed"}
    text = json.dumps([inputs["wall"], settings], sort_keys=True)
    digests = [" ".join(sorted({str(one["row"][name]) for one in there})) or "none"
               for name in ("model_digest", "measures_digest")]
    return hashlib.sha256(text.encode()).hexdigest()[:12], *digests


def head(notes):
    """Lines at the top of a lives.csv: {point: note}."""
    return "".join(f"# {point}: wall and options {note[0]}, model {note[1]}, measures {note[2]}\n"
                   for point, note in notes.items())


def read_lives(path, columns):
    """(table of a lives.csv with every digit, {point: note}); InputError where it is none, or a number is out of range.

    columns: that it must have.
    """
    try:
        text = Path(path).read_text(encoding="utf-8")
        table = pd.read_csv(path, comment="#", dtype={"time_utc": str}, float_precision="round_trip")
    except (OSError, ValueError) as error:
        raise InputError(f"{path}: {error}; expected lives.csv, as python3 -m damage lives writes it") from error
    if missing := [name for name in columns if name not in table]:
        raise InputError(f"{path}: no column {missing[0]}; expected lives.csv, as python3 -m damage lives writes it")
    for name, least in _LOWEST.items():
        numbers = pd.to_numeric(table[name], errors="coerce")
        wrong = ~((numbers >= least) & (numbers <= _HIGHEST.get(name, 1e6)))
        if name in ("offset_after_mm", "newly_failed"):  # which a settlement lacks
            wrong &= table["event"] != 0
        if wrong.any():
            raise InputError(f"{path}: row {np.argmax(wrong) + 1}: {name} = {table[name][wrong].iloc[0]}; expected a "
                             f"number from {least:g} to {_HIGHEST.get(name, 1e6):g}; correct it, or leave the table "
                             "out")
    table["fell"] = _flags(path, table["fell"])
    wrong = pd.to_datetime(table["time_utc"], format="%Y-%m-%dT%H:%M:%S", errors="coerce").isna()
    if wrong.any():
        raise InputError(f"{path}: row {np.argmax(wrong) + 1}: time_utc = {table['time_utc'][wrong].iloc[0]!r}; "
                         "expected such as 2018-01-08T14:00:52; correct it, or leave the table out")
    notes = {found[1]: found.groups()[1:] for found in map(_NOTE.match, text.splitlines()) if found}
    if without := sorted(set(table["point"].astype(str)) - notes.keys()):
        warn(f"{path}: no line on the wall and options of {len(without)} points, such as {without[0]}, as of an older "
             "version: their lives are counted as if they were of this study's walls")
    return from_words(table[list(columns)]), notes


def _flags(path, words):
    """A column of True and False; InputError for other words, which would count as either."""
    flags = words.astype(str).str.lower().map({"true": True, "false": False})
    if (wrong := flags.isna()).any():
        raise InputError(f"{path}: row {np.argmax(wrong) + 1}: fell = {words[wrong].iloc[0]!r}; expected True or "
                         "False; correct it, or leave the table out")
    return flags.astype(bool)


def of_point(path, table, notes, point, draws, mine):
    """The rows of a point that count: of the same wall and options, whole, with the events that its address draws.

    draws: Draws of the point's address; mine: its note.  Raises InputError where something differs.
    """
    rows = table[table["point"] == point]
    if not len(rows):
        return rows
    note = notes.get(point, mine)
    if note[0] != mine[0]:
        raise InputError(f"{path}: lives of {point} of another wall or other options ({note[0]}, here {mine[0]}); "
                         "expected those of this study, leave the table out")
    if mine[1] != "none" and note[1:] != mine[1:]:
        warn(f"{path}: lives of {point} by another version (model {note[1]}, here {mine[1]}; measures {note[2]}, here "
             f"{mine[2]})")
    for seed, of_seed in rows.groupby("seed"):
        drawn = replace(draws, choices=replace(draws.choices, seed=int(seed)))
        for life, events in of_seed.groupby("life"):
            if problem := _problem(events[events["event"] > 0], drawn, int(life)):
                raise InputError(f"{path}: {point}, seed {seed}, life {life}: {problem}; expected the whole life that "
                                 "this study's address draws, leave the table out or correct it")
    return rows


def _problem(events, draws, life):
    """What is wrong with the events of a life, in words; None where they are those that are drawn, in their order."""
    if list(events["event"]) != list(range(1, len(events) + 1)):
        return "an event is missing or there twice"
    drawn, fell = draws.life(life), events["fell"]
    if len(events) < len(drawn) and not (len(events) and fell.iloc[-1]):
        return f"{len(events)} of {len(drawn)} events of a wall that stands"
    if fell.iloc[:-1].any() and len(events) <= len(drawn):
        return "an event after the wall fell"
    drawn = drawn.assign(largest_mm_s=draws.largest([life])[0]).iloc[:len(events)]
    return next((said for name, said in _DRAWN_COLUMNS.items() if not _equal(events[name], drawn[name])), None)


def _equal(one, other):
    """Whether two columns have the same words, or the same numbers as far as a table has them."""
    if pd.api.types.is_numeric_dtype(other):
        one = pd.to_numeric(one, errors="coerce")
        return len(one) == len(other) and np.allclose(one, other, rtol=_ROUNDED, atol=0.0)
    return list(one.fillna("").astype(str)) == list(other.astype(str))
