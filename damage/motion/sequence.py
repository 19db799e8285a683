"""Sequences of different records: the events that a wall undergoes one after the other."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from damage.csv_table import read_csv
from damage.errors import InputError
from damage.fields import Column, plausible, text
from damage.files import is_there, shipped_path
from damage.motion.formats import read_record, shipped_records
from damage.motion.loading import Loading, Recorded

COLUMNS = {
    "record": Column("", "path from the file's folder, or name of a record that ships", "U"),
    "component": Column("", "end of such a name, as HGE of BGAR", "U"),
    "unit": Column("", "of a text that does not say it", "U"),
    "scale": Column("1", "factor on the record"),
    "start_s": Column("s", "start of the window"),
    "end_s": Column("s", "its end"),
    "rest_s": Column("s", "free vibration after the event"),
    "sample_step_s": Column("s", "of a text without times"),
}
MOST_EVENTS = 500
"""Largest number of events of a sequence, which an attribute of a history can hold."""
MOST_MOTIONS = 64
"""Largest number of different records and windows in a sequence, which an attribute of a history
can hold."""


@dataclass(frozen=True)
class Event:
    """One event: a motion, the factor on it [-], and the time of free vibration that follows
    [s]."""

    loading: Loading
    factor: float = text(
        usual=plausible(
            0.01,
            100,
            "",
            "each factor, without its sign; 0 is a pause",
            zero=True,
            others={"%": 0.01},
        )
    )
    rest_s: float


def read_sequence(path, rest_s, **preparation):
    """The events of a CSV file, a tuple of Event in the order of its rows.

    Columns: record, the path of a record from the file's folder or the name or path of one that
    ships; component, for such a name without its end, as HGE of BGAR; unit and sample_step_s, of a
    text that does not say them (`read_record`); scale (1 where empty); start_s, end_s, the window
    (whole record where empty); rest_s (the given one where empty).  preparation: baseline_order and
    band_hz of all records. Raises InputError with the line where one of them cannot be.
    """
    table = read_csv(path, COLUMNS, ("record",), MOST_EVENTS)
    table.refuse(
        table.rows["start_s"].isna() != table.rows["end_s"].isna(),
        "a window with one end; expected start_s and end_s, or neither",
    )
    events = []
    loadings = {}
    for row, record, component, unit, scale, start, end, rest, step in table.rows[
        [*COLUMNS]
    ].itertuples():
        key = f"{record} {component} {unit} {step} {start} {end}"
        try:
            if key not in loadings:
                loadings[key] = Recorded(
                    read_record(
                        _record(Path(path).parent, record, component),
                        unit=unit or None,
                        sample_step_s=None if np.isnan(step) else float(step),
                    ),
                    window_s=None if np.isnan(start) else (float(start), float(end)),
                    **preparation,
                )
        except InputError as error:
            raise table.error(row, str(error)) from error
        events.append(
            Event(
                loadings[key],
                1.0 if np.isnan(scale) else float(scale),
                rest_s if np.isnan(rest) else float(rest),
            )
        )
    steps = np.array([event.loading.record.time_step_s for event in events])
    table.refuse(
        steps != steps[0],
        f"a record with another time step than the {steps[0]:g} s of the first; expected "
        "the same for all events, resample it",
    )
    if len(loadings) > MOST_MOTIONS:
        raise InputError(
            f"{path}: {len(loadings)} different records and windows; expected up to {MOST_MOTIONS},"
            " use fewer"
        )
    return tuple(events)


def as_table(events):
    """A sequence as a history keeps it, fit for JSON: `motions`, and `events` with the number of
    each one's motion. Their factors are the history's `sequence`."""
    if not events:
        return {}
    motions = {id(event.loading): event.loading for event in events}
    numbers = list(motions)
    return {
        "motions": [motion.as_dict() for motion in motions.values()],
        "events": [
            {"motion": numbers.index(id(event.loading)), "rest_s": float(event.rest_s)}
            for event in events
        ],
    }


def strongest(events):
    """The Event of the largest peak acceleration."""
    return max(events, key=lambda event: event.loading.peak_g * abs(event.factor))


def _record(folder, record, component):
    """The path or name of a record of a row."""
    if not record:
        raise InputError("no record; expected its path, or the name of one that ships")
    name = f"{record}_{component}" if component else record
    beside = folder / record
    ships = name in shipped_records()
    if not ships and is_there(beside):
        return beside
    if not ships and not shipped_path(record) and is_there(record):
        raise InputError(
            f"{record} is in the working folder; expected it from the folder of this file,"
            f" {folder}, which is the same wherever a run starts; move it, or give its path from"
            " there"
        )
    return name if ships else shipped_path(record) or name
