"""Sequences of different records: the events that a wall undergoes one after the other."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from damage.csv_table import CsvTable
from damage.errors import InputError
from damage.fields import plausible, text
from damage.files import is_there, shipped_path
from damage.motion.formats import read_record, shipped_records
from damage.motion.loading import Loading, Recorded

REQUIRED, OPTIONAL = ("record",), ("component", "unit", "scale", "start_s", "end_s", "rest_s", "sample_step_s")
NUMBERS = OPTIONAL[2:]
MOST_EVENTS, MOST_MOTIONS = 500, 64
"""Of a sequence, and of different records and windows in it: what an attribute of a history can hold."""


@dataclass(frozen=True)
class Event:
    """One event: a motion, the factor on it [-], and the time of free vibration that follows [s]."""

    loading: Loading
    factor: float = text(usual=plausible(0.01, 100, "", "each factor, without its sign; 0 is a pause", zero=True,
                                         others={"%": 0.01}))
    rest_s: float


def read_sequence(path, rest_s, **preparation):
    """The events of a CSV file, a tuple of Event in the order of its rows.

    Columns: record, the path of a record from the file's folder or the name or path of one that ships; component, for
    such a name without its end, as HGE of BGAR; unit and sample_step_s, of a text that does not say them
    (`read_record`); scale (1 where empty); start_s, end_s, the window (whole
    record where empty); rest_s (the given one where empty).  preparation: baseline_order and band_hz of all records.
    Raises InputError with the line where one of them cannot be.
    """
    table = CsvTable(path, REQUIRED, OPTIONAL, MOST_EVENTS)
    columns = {name: table.numbers(name) for name in NUMBERS}
    table.refuse(np.isnan(columns["start_s"]) != np.isnan(columns["end_s"]),
                 "a window with one end; expected start_s and end_s, or neither")
    events, loadings = [], {}
    for row, (record, component, unit) in enumerate(zip(*map(table.words, ("record", "component", "unit")))):
        start, end, scale, rest = (columns[name][row] for name in ("start_s", "end_s", "scale", "rest_s"))
        step = columns["sample_step_s"][row]
        key = f"{record} {component} {unit} {step} {start} {end}"
        try:
            if key not in loadings:
                loadings[key] = Recorded(
                    read_record(_record(Path(path).parent, record, component), unit=unit or None,
                                sample_step_s=None if np.isnan(step) else float(step)),
                    window_s=None if np.isnan(start) else (float(start), float(end)), **preparation)
        except InputError as error:
            raise table.error(row, str(error)) from error
        events.append(Event(loadings[key], 1.0 if np.isnan(scale) else float(scale),
                            rest_s if np.isnan(rest) else float(rest)))
    steps = np.array([event.loading.record.time_step_s for event in events])
    table.refuse(steps != steps[0], f"a record with another time step than the {steps[0]:g} s of the first; expected "
                 "the same for all events, resample it")
    if len(loadings) > MOST_MOTIONS:
        raise InputError(f"{path}: {len(loadings)} different records and windows; expected up to {MOST_MOTIONS}, use "
                         "fewer")
    return tuple(events)


def as_table(events):
    """A sequence as a history keeps it, fit for JSON: `motions`, and `events` with the number of each one's motion.
    Their factors are the history's `sequence`."""
    if not events:
        return {}
    motions = list({id(event.loading): event.loading for event in events}.values())
    return {"motions": [motion.as_dict() for motion in motions],
            "events": [{"motion": [event.loading is motion for motion in motions].index(True),
                        "rest_s": float(event.rest_s)} for event in events]}


def strongest(events):
    """The Event of the largest peak acceleration."""
    return max(events, key=lambda event: event.loading.peak_g * abs(event.factor))


def _record(folder, record, component):
    """The path or name of a record of a row."""
    if not record:
        raise InputError("no record; expected its path, or the name of one that ships")
    name = f"{record}_{component}" if component else record
    beside, ships = folder / record, name in shipped_records()
    if not ships and is_there(beside):
        return beside
    if not ships and not shipped_path(record) and is_there(record):
        raise InputError(f"{record} is in the working folder; expected it from the folder of this file, {folder}, "
                         "which is the same wherever a run starts; move it, or give its path from there")
    return name if ships else shipped_path(record) or name
