"""Earthquake catalogues: a CSV table, as the one that ships, KNMI's public list all_induced.csv, or
the text of an FDSN event service.

A catalogue of other origin may hold what the ground-motion models are not for.  Left out are events
that are no earthquakes by their type, tectonic ones by their depth, those of other places than the
Groningen field, and all but one of an earthquake that several agencies list: the shallower than
SHALLOW_KM, then the larger.  `Catalogue.notes` says which.
"""

from datetime import UTC, datetime
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd

from damage.applications.groningen.exposure.places import (
    NETHERLANDS_DEG,
    NETHERLANDS_RD_M,
    to_rd,
    within,
)
from damage.checks import check_file
from damage.csv_table import MOST_MB, MOST_ROWS, CsvTable, as_words, read_csv, uncommented
from damage.elementary import hypot
from damage.errors import InputError, some_of
from damage.fields import Column
from damage.files import DATA, text_lines, write_text

SHIPPED = DATA / "groningen" / "knmi_catalogue_1991_2022.csv"
"""The catalogue that ships: its README says what it is."""
SHALLOW_KM = 5.0
"""Depth beyond which events are named, since models take the field's 3 km."""
DEEPEST_KM = 10.0
"""Depth beyond which events are left out: agencies without near stations fix 10 km, and no gas
field is deeper."""
BESIDE_KM = 10.0
"""Farthest that an event of the field may be from the nearest epicentre of the catalogue that
ships."""
ONE_EVENT = {True: (10.0, 25.0), False: (2.0, 5.0)}
"""Largest difference of time [s] and epicentre [km] of one earthquake in two lines, by whether they
name different agencies: KNMI's own list has two events 3 s apart."""
MOST_GAP_DAYS = 60
"""Days between a catalogue and later events from which a gap is named: the field had shakes every
week or two."""
_EARTHQUAKE = "earthquake", "induced", "triggered", "extraction", "injection"
_NO_TYPE = "", "not reported", "unknown"
_GRID = ("easting_rd_m", "northing_rd_m")
_DEGREES = ("latitude", "longitude")
_WORDS = Column("", "", "U")
_CSV = {
    **dict.fromkeys(("date_utc", "time_utc", "field", "place", "knmi_id"), _WORDS),
    "magnitude": Column("1", "local magnitude", least=-3, most=10),
    **dict.fromkeys(_GRID, Column("m", "epicentre in RD")),
    **dict.fromkeys(_DEGREES, Column("degrees", "epicentre")),
    "depth_km": Column("km", "depth"),
}
_SERVICE = _CSV | dict.fromkeys(("time", "type", "agency"), _WORDS)
_FDSN = {
    "eventid": "knmi_id",
    "time": "time",
    "latitude": "latitude",
    "longitude": "longitude",
    "magnitude": "magnitude",
    "eventlocationname": "place",
    "depth/km": "depth_km",
    "eventtype": "type",
    "catalog": "agency",
}  # heading in lower case: column of _SERVICE; others are passed over
_KNMI = {
    "YYMMDD": "date_utc",
    "TIME": "time_utc",
    "LOCATION": "place",
    "LAT": "latitude",
    "LON": "longitude",
    "DEPTH": "depth_km",
    "MAG": "magnitude",
}  # of all_induced.csv, 20180419 and 093307.59
_WRITTEN = {"x_m": "easting_rd_m", "y_m": "northing_rd_m", "id": "knmi_id"}
_FDSN_NEEDED = ("time", "latitude", "longitude", "magnitude")


class Catalogue(NamedTuple):
    """Earthquakes.

    events: DataFrame, a row an event in the order of time, numbered from 0: time (datetime, UTC),
    magnitude [-], x_m, y_m (epicentre in RD [m]), place, id (text); source: path of the file;
    notes: sentences on events that were left out, or are doubtful.
    """

    events: pd.DataFrame
    source: str
    notes: tuple[str, ...] = ()

    @property
    def begin(self):
        """Time of the first event."""
        return self.events["time"].iloc[0]

    @property
    def end(self):
        """Time of the last event."""
        return self.events["time"].iloc[-1]

    @property
    def years(self):
        """Year of the first and of the last event."""
        return self.begin.year, self.end.year

    def between(self, first, last):
        """The events of the years `first` to `last`, both included, None for the catalogue's own.
        Raises InputError for years that it does not have, or that hold no event."""
        begins, ends = self.years
        first = begins if first is None else first
        last = ends if last is None else last
        for option, year in (("--from", first), ("--to", last)):
            if not begins <= year <= ends:
                raise InputError(
                    f"{option} {year}: the first event of {self.source} is of {begins}, its last of"
                    f" {ends}; expected a year from {begins} to {ends}"
                )
        chosen = [first <= time.year <= last for time in self.events["time"]]
        if not any(chosen):
            raise InputError(
                f"--from {first} --to {last}: {self.source} has no event in these years; expected a"
                " first year before the last, and a longer time"
            )
        return self._replace(events=self.events[chosen].reset_index(drop=True))


def read_catalogue(path=SHIPPED):
    """Read a Catalogue.  Raises InputError, with the line, where the file does not fit.

    CSV: columns date_utc, time_utc, magnitude and either easting_rd_m, northing_rd_m or latitude,
    longitude; depth_km, field, place, knmi_id may be there.  KNMI's all_induced.csv: as it is.
    FDSN text: a first line #EventID|Time|Latitude|Longitude|...|Magnitude, of whose other columns
    Depth/km, EventType and Catalog are read.
    """
    check_file(path, "a catalogue of earthquakes (CSV or FDSN text)", MOST_MB)
    with open(path, "rb") as file:
        first = file.readline()
    if first.lstrip(b"\xef\xbb\xbf \t\r\n").startswith((b"<", b"{", b"[")):
        raise InputError(
            f"{path}: XML or JSON; expected CSV, or the text of an FDSN event service; ask it for "
            "format=text"
        )
    by = _read_fdsn if b"|" in first else _read_knmi if b"YYMMDD" in first else _read_csv
    return by(path)


def with_later(path, base=SHIPPED):
    """The Catalogue at `base` with the events of the file at `path` that are later than its last
    one, and sentences on what the file adds.  Raises InputError where it adds none."""
    known = read_catalogue(base)
    newer = read_catalogue(path)
    new = newer.events[[time > known.end for time in newer.events["time"]]]
    if new.empty:
        raise InputError(
            f"{path}: its last event is of {newer.end:%Y-%m-%d}, the catalogue's of"
            f" {known.end:%Y-%m-%d}; expected later ones; ask the service for events from that"
            " day on"
        )
    joined = Catalogue(pd.concat([known.events, new], ignore_index=True), str(base))
    begin = new["time"].iloc[0]
    largest = new.loc[new["magnitude"].idxmax()]
    gap = (begin - known.end).days
    notes = [
        (
            f"{len(new)} of {len(newer.events)} events of {path} are later than"
            f" {known.end:%Y-%m-%d}: from {begin:%Y-%m-%d} to {newer.end:%Y-%m-%d}, the largest M"
            f" {largest.magnitude:.1f} of {largest.time:%Y-%m-%d}"
        ),
        *newer.notes,
    ]
    if len(new) == len(newer.events) and gap > MOST_GAP_DAYS:
        notes.append(
            f"between both lists are {gap} days without an event: look whether the file begins late"
            " enough before"
        )
    return joined, notes


def write_catalogue(catalogue, path):
    """Write a Catalogue as CSV that `read_catalogue` reads; returns its path."""
    events = catalogue.events
    rows = events.drop(columns="time").rename(columns=_WRITTEN)
    rows.insert(0, "date_utc", [f"{time:%Y-%m-%d}" for time in events["time"]])
    rows.insert(1, "time_utc", [time.time().isoformat() for time in events["time"]])
    return write_text(path, as_words(rows).to_csv(index=False, lineterminator="\n"))


def _read_csv(path):
    table = read_csv(path, _CSV, ("date_utc", "time_utc", "magnitude"))
    return _catalogue(path, table, table.rows["date_utc"] + "T" + table.rows["time_utc"])


def _read_knmi(path):
    """KNMI's list of all induced earthquakes of the country: what lies in the sea beside it is left
    out."""
    known = {name: _CSV[ours] for name, ours in _KNMI.items()} | {"EVALMODE": _WORDS}
    table = read_csv(path, known, tuple(_KNMI))
    table.rows = table.rows.rename(columns=_KNMI)
    # a spreadsheet takes zeros off
    digits = table.rows["time_utc"].str.extract(r"^(\d{1,6})(\.\d*)?$").fillna("")
    table.refuse(
        ~table.rows["date_utc"].str.fullmatch(r"\d{8}") | (digits[0] == ""),
        "expected a date YYYYMMDD and a time HHMMSS.ss, such as 20180419 and 093307.59; correct it",
    )
    clock = digits[0].str.zfill(6).str.replace(r"(..)(..)(..)", r"\1:\2:\3", regex=True)
    clock += digits[1].where(digits[1] != ".", "")
    return _catalogue(path, table, table.rows["date_utc"] + "T" + clock, leave_out=True)


def _read_fdsn(path):
    head, *lines = text_lines(path, Path(path).read_bytes(), 2 * MOST_ROWS, errors="replace")
    names = [_FDSN.get(word.strip().lower(), word) for word in head.lstrip("#").split("|")]
    if missing := [name for name in _FDSN_NEEDED if name not in names]:
        raise InputError(
            f"{path} line 1: no column {', '.join(missing)}; expected FDSN text that begins with "
            "#EventID|Time|Latitude|Longitude|Depth/km|Author|...|Magnitude|..."
        )
    numbered = uncommented(["#", *lines])
    if not numbered:
        raise InputError(f"{path}: no event; expected at least one line below the first")
    table = CsvTable(path, names, numbered, "|", _SERVICE)
    return _catalogue(path, table, table.rows["time"])


def _catalogue(path, table, times, leave_out=False):
    """The Catalogue of a CsvTable with columns of _SERVICE; times: words in ISO 8601; leave_out:
    whether to take events outside the country out rather than to refuse the file."""
    rows = table.rows
    pair = next((two for two in (_GRID, _DEGREES) if two[0] in rows and rows[two[0]].any()), None)
    if pair is None:
        raise InputError(
            f"{path}: no epicentres; expected the columns {' and '.join(_GRID)} [m], or "
            f"{' and '.join(_DEGREES)} [degrees]"
        )
    table.refuse_empty(*pair, "magnitude")
    bounds = NETHERLANDS_RD_M if pair == _GRID else NETHERLANDS_DEG
    epicentres = [rows[name].to_numpy() for name in pair]
    outside = ~within(bounds, *epicentres)
    table.refuse(
        outside & ~(leave_out & ~outside.all()),
        f"epicentre outside the Netherlands; expected {pair[0]} from {bounds[0][0]:g} to"
        f" {bounds[0][1]:g} and {pair[1]} from {bounds[1][0]:g} to {bounds[1][1]:g}; correct it",
    )
    x_m, y_m = epicentres if pair == _GRID else to_rd(*epicentres)
    time = pd.Series([_time(table, row, cell) for row, cell in enumerate(times)], dtype=object)
    renamed = rows.rename(columns={"knmi_id": "id", "depth_km": "depth"})
    renamed = renamed.assign(
        x_m=x_m,
        y_m=y_m,
        time=time,
        line=table.line,
        **{name: "" for name in ("id", "type", "agency") if name not in renamed},
    )
    renamed["id"] = renamed["id"].mask(renamed["id"].str.strip() == "", times)
    away = renamed["line"][outside]
    renamed = renamed[~outside].sort_values("time", kind="stable", ignore_index=True)
    notes = []
    if Path(path) != SHIPPED:
        renamed, notes = _of_the_field(renamed)
        notes = [f"left out as outside the Netherlands: {_lines(away)}"] * bool(len(away)) + notes
        if renamed.empty:
            raise InputError(
                f"{path}: no event that the ground-motion models are for; expected induced"
                f" earthquakes of the Groningen field; {notes[0]}"
            )
    events = renamed[["time", "magnitude", "x_m", "y_m", "place", "id"]].reset_index(drop=True)
    return Catalogue(events, str(path), tuple(f"{path}: {note}" for note in notes))


def _of_the_field(table):
    """The events of a table, in the order of time, that the models are for, and notes on the
    others."""
    depth = table["depth"]
    kinds = table["type"].str.strip().str.lower()
    no_quake = ~kinds.isin(_NO_TYPE) & ~kinds.str.contains("|".join(_EARTHQUAKE))
    field_km = np.array(list(map(from_field_km, table["x_m"], table["y_m"])))
    inside = np.ones(len(table), bool)
    notes = []
    for out, reason in (
        (no_quake, "no earthquake by its type"),
        (depth > DEEPEST_KM, f"deeper than {DEEPEST_KM:g} km, as tectonic earthquakes are"),
        (field_km > BESIDE_KM, f"more than {BESIDE_KM:g} km from the epicentres of the field"),
    ):
        if (out & inside).any():
            notes.append(f"left out as {reason}: {_lines(table['line'][out & inside])}")
        inside &= ~out
    deep = inside & (depth > SHALLOW_KM)
    if deep.any():
        notes.append(
            f"deeper than {SHALLOW_KM:g} km, but taken at the field's depth, 3 km: "
            f"{_lines(table['line'][deep])}; take out what is not of the field"
        )
    rank = table["magnitude"] - 100 * deep  # by which the line of an earthquake stays
    chosen, pairs = _one_by_one(table.assign(rank=rank)[inside])
    return table.loc[chosen], notes + [
        f"lines {stays.line} and {goes.line} are {seconds:.1f} s and {km:.1f} km apart (M"
        f" {stays.magnitude:g} and {goes.magnitude:g}): taken as one earthquake, line {goes.line}"
        " left out; take out the other line to have this one"
        for stays, goes, seconds, km in pairs
    ]


def _one_by_one(events):
    """The index of the events of a table without those of an earthquake that is there already, of
    which the highest rank stays, and (kept, left out, seconds, km) of each of these, rows as
    tuples."""
    events_left = []
    pairs = []
    for event in events.itertuples():
        for place in reversed(range(len(events_left))):
            other = events_left[place]
            seconds = (event.time - other.time).total_seconds()
            km = hypot(event.x_m - other.x_m, event.y_m - other.y_m) / 1e3
            most_s, most_km = ONE_EVENT[event.agency != other.agency]
            if seconds <= most_s and km <= most_km:
                events_left[place], goes = (
                    (event, other) if event.rank > other.rank else (other, event)
                )
                pairs.append((events_left[place], goes, seconds, km))
                break
            if seconds > ONE_EVENT[True][0]:
                events_left.append(event)
                break
        else:
            events_left.append(event)
    return [event.Index for event in sorted(events_left, key=lambda event: event.time)], pairs


@lru_cache(maxsize=1)
def _field():
    """Epicentres (n, 2) of the catalogue that ships [m]."""
    return read_catalogue(SHIPPED).events[["x_m", "y_m"]].to_numpy()


def from_field_km(x_m, y_m):
    """Distance of a place in RD [m] from the nearest epicentre of the Groningen field [km]."""
    return hypot(*(_field() - (x_m, y_m)).T).min() / 1e3


def _lines(numbers):
    return f"line{'s' * (len(numbers) > 1)} {some_of(list(map(str, sorted(numbers))))}"


def _time(table, row, cell):
    """The time of a row, UTC."""
    try:
        time = datetime.fromisoformat(cell.strip())
    except ValueError:
        raise table.error(
            row, f"time {cell!r}; expected such as 2018-01-08T14:00:52; correct it"
        ) from None
    return time.astimezone(UTC) if time.tzinfo else time.replace(tzinfo=UTC)
