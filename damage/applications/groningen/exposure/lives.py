"""Lives: the earthquakes of a catalogue at an address, with a motion drawn for each.

An address is a TOML file of the keys in KEYS:

    latitude = 53.36786
    longitude = 6.71359
    above_mm_s = 2.0

A life is drawn by its number: the same file and number give the same life, whatever else is drawn.
Lives of one number have the same terms of ln PGV at every address, component and threshold (common
random numbers).

PGV, factors and distortions are rounded (damage.rounded) before anything is chosen by them: no last
bit decides on a record or an event.
"""

import hashlib
from dataclasses import asdict, dataclass
from functools import cached_property, lru_cache
from pathlib import Path

import numpy as np
import pandas as pd

from damage import draws
from damage.applications.groningen.exposure.catalogue import SHIPPED, read_catalogue
from damage.applications.groningen.exposure.exposure import Exposure
from damage.applications.groningen.exposure.ground_motion import COMPONENTS, model_named
from damage.applications.groningen.exposure.places import at_degrees, at_rd
from damage.checks import check_choice, check_range
from damage.elementary import exp, log
from damage.errors import InputError, did_you_mean
from damage.fields import check_fields, choice, quantity
from damage.files import is_there
from damage.motion.formats import read_record, shipped_records
from damage.motion.loading import Recorded
from damage.motion.sequence import Event
from damage.motion.settlement import DISTORTIONS, PROFILES, Settlement
from damage.rounded import to_bits
from damage.toml_file import toml_table, toml_text

COLUMNS = [
    "time_utc",
    "magnitude",
    "place",
    "id",
    "pgv_mm_s",
    "record",
    "scale",
    "start_s",
    "end_s",
]
FACTORS = 0.1, 10.0
"""Bounds of the factor on a record: the README beside the components has the reason."""
_GROUND = 1  # third number of the seed of draws of the ground
TENTH_S = 0.1
"""Windows are rounded outwards to this [s]."""
ADDRESS_FILE = "the file of an address (.toml)", 1
"""What is expected of one, and its largest size [MB]."""


@dataclass(frozen=True)
class Choices:
    """How motions are chosen.

    Attributes
    ----------
    above_mm_s : float
        PGV from which an event is part of a life [mm/s]; the largest always is.
    within_km : float
        Epicentral distance of the farthest station whose records are used [km].
    scale_to : str
        pgv: records are scaled to the drawn PGV; sa: to the spectral acceleration at 0.2 s that it
        implies by the mean ratio of the records.
    strong : tuple of float or None
        Share of a record's Arias intensity that its window leaves out at its start and at its end;
        None: the windows of components.csv, 0.01 and 0.03.
    largest_alone : bool
        Whether a life has its largest event only.
    settle : tuple of str or None
        Profiles of the ground's settlement before the first event, from which each life draws one,
        as ["hogging", "sagging"]; None for none.
    distortion : tuple of float or None
        Least and largest distortion of the drawn profile, log-uniform, as [0.0002, 0.002].
    seed : int
        Of all lives.
    """

    above_mm_s: float = quantity("mm/s", 0.01, 1000, default=2.0, called="above_mm_s [mm/s]")
    within_km: float = quantity("km", 0.1, 1000, default=10.0, called="within_km [km]")
    scale_to: str = choice(("pgv", "sa"), default="pgv", called="scale_to")
    strong: tuple[float, float] | None = None
    largest_alone: bool = False
    settle: tuple[str, ...] | None = None
    distortion: tuple[float, float] | None = None
    seed: int = quantity("1", 0, 2**31, whole=True, default=0, called="seed")

    def __post_init__(self):
        check_fields(self)
        if not isinstance(self.largest_alone, bool):
            raise InputError(
                f"largest_alone = {self.largest_alone!r}: expected true or false; correct it"
            )
        if self.strong is not None:
            vars(self)["strong"] = _pair("strong", self.strong, 0, 0.49)
        if (self.settle, self.distortion) == (None, None):
            return
        if not isinstance(self.settle, tuple) or not self.settle:
            raise InputError(
                f"settle = {self.settle!r}: expected profiles beside distortion, like"
                ' settle = ["hogging"] and distortion = [0.0002, 0.002]; correct them'
            )
        for profile in self.settle:
            check_choice("settle", profile, PROFILES)
        bounds = _pair("distortion", self.distortion, *DISTORTIONS)
        if bounds[0] > bounds[1]:
            raise InputError(
                f"distortion = {list(bounds)}: expected the smaller one first; exchange them"
            )
        vars(self)["distortion"] = bounds


KEYS = (
    *("latitude", "longitude", "easting_rd_m", "northing_rd_m", "vs30_m_s"),
    *("first_year", "last_year", "catalogue", "component", "model"),
    *Choices.__dataclass_fields__,
)
"""Keys of an address file: of the place either pair, in WGS84 [degrees] or in the Dutch grid [m];
the mean shear-wave velocity of its upper 30 m [m/s] (default 200); years of the catalogue that are
used (default: all); its file, from the address's (default: KNMI's that ships); component: LRG
(default), GEO or MAX; the ground-motion model (default bommer-2022); and those of Choices."""


def _pair(name, value, least, most):
    """Two numbers within bounds, a tuple of float; InputError for anything else."""
    if not isinstance(value, tuple) or len(value) != 2:
        raise InputError(
            f"{name} = {value!r}: expected two numbers from {least:g} to {most:g}, as"
            f" {name} = [0.001, 0.002]; correct it"
        )
    for component in value:
        check_range(name, component, least, most)
    return tuple(map(float, value))


@dataclass(frozen=True)
class Draws:
    """What lives are drawn from: an Exposure and Choices."""

    exposure: Exposure
    choices: Choices = Choices()

    def digest(self):
        """SHA-256 of what lives are drawn from besides the seed and choices: events, their medians,
        the components, and the content of their records."""
        events = self.exposure.catalogue.events
        components = self.components
        records = [
            read_record(shipped_records()[name]).sha256
            for name in sorted(set(components["record"]))
        ]
        parts = [events["time"], events["magnitude"], events["id"], self.exposure.median_mm_s]
        text = "\n".join(
            [
                components.to_csv(index=False),
                *records,
                *(str(value) for part in parts for value in part),
            ]
        )
        return hashlib.sha256(text.encode()).hexdigest()

    def pgv(self, number):
        """(PGV of every event (n_events,) [mm/s], shares (n_events,) that choose the components,
        signs (n_events,)) of a life by its number from 1."""
        random = draws.Draws([self.choices.seed, number])
        n_events = len(self.exposure.median_mm_s)
        event, site, within = self.exposure.model.draw(random, 1, n_events)
        share = random.uniform(n_events)
        sign = 2.0 * random.below(2, n_events) - 1.0
        return (
            to_bits(self.exposure.median_mm_s * exp((event + site + within)[0, :, 0])),
            share,
            sign,
        )

    def settlement(self, number):
        """The Settlement before the first event of a life, by its number from 1; None where none is
        drawn.  Its draws are apart from those of the motions."""
        if self.choices.settle is None:
            return None
        random = draws.Draws([self.choices.seed, number, _GROUND])
        profile = self.choices.settle[random.below(len(self.choices.settle), 1)[0]]
        low, high = log(self.choices.distortion)
        drawn = to_bits(exp(low + (high - low) * random.uniform(1)[0]))
        return Settlement(profile, np.clip(drawn, *self.choices.distortion))

    def largest(self, numbers):
        """Largest PGV of each of these lives, (n,) [mm/s]."""
        return np.array([self.pgv(number)[0].max() for number in numbers])

    def life(self, number):
        """Table of the events of a life, by its number from 1, in the order of time; columns:
        COLUMNS.

        Events from above_mm_s on, and the largest.  The threshold leaves events out and changes no
        other.  Raises InputError where no component may be scaled to a PGV.
        """
        pgv, share, sign = self.pgv(number)
        chosen = pgv == pgv.max()
        if not self.choices.largest_alone:
            chosen |= pgv >= self.choices.above_mm_s
        return self._table((k, pgv[k], sign[k], share[k]) for k in np.flatnonzero(chosen))

    def event(self, date, number=None):
        """Table of one row, as of `life`, of the event of a date, such as 2012-08-16 or more of its
        time; of several the one of the largest median.

        number: of the life whose motion it is; None for the median PGV, by the component whose
        factor is nearest to 1.
        """
        catalogue = self.exposure.catalogue
        times = [f"{time:%Y-%m-%dT%H:%M:%S}" for time in catalogue.events["time"]]
        matching = (
            [k for k, time in enumerate(times) if time.startswith(date)]
            if len(date) >= len("2012-08-16")
            else []
        )
        if not matching:
            raise InputError(
                f"--event {date}: no event then in {catalogue.source}, whose last is of"
                f" {times[-1]}; expected a day or a time (UTC) of one, like 2012-08-16 or"
                " 2018-01-08T14:00:52; look at python3 -m damage exposure, or give a later"
                " catalogue"
            )
        k = max(matching, key=self.exposure.median_mm_s.__getitem__)
        if number is None:
            return self._table([(k, to_bits(self.exposure.median_mm_s[k]), 1.0, None)])
        pgv, share, sign = self.pgv(number)
        return self._table([(k, pgv[k], sign[k], share[k])])

    def _table(self, motions):
        """Table of COLUMNS; motions: (index of an event, PGV [mm/s], sign, share) of each row.

        The component is that at the share of those that may be scaled to the PGV; without a share
        the one whose factor is nearest to 1.
        """
        events = self.exposure.catalogue.events
        rows = []
        for k, pgv, sign, share in motions:
            fit, factor = self._fitting(pgv)
            which = (
                int(np.argmin(to_bits(np.maximum(factor, 1 / factor))))
                if share is None
                else int(share * len(fit))
            )
            event = events.loc[k]
            component = self.components.loc[fit[which]]
            rows.append(
                [
                    f"{event.time:%Y-%m-%dT%H:%M:%S}",
                    event.magnitude,
                    event.place,
                    event.id,
                    pgv,
                    component.record,
                    sign * factor[which],
                    component.start_s,
                    component.end_s,
                ]
            )
        return pd.DataFrame(rows, columns=COLUMNS)

    @cached_property
    def components(self):
        """The components that may be used, with their windows: a DataFrame."""
        table = pd.read_csv(COMPONENTS, comment="#", float_precision="round_trip")
        table = table[table["epicentral_km"] <= self.choices.within_km].reset_index(drop=True)
        if self.choices.strong is not None:
            windows = [
                strong_window(row.record, row.start_s, row.end_s, self.choices.strong)
                for row in table.itertuples()
            ]
            table[["start_s", "end_s"]] = np.reshape(windows, (-1, 2))
        return table

    @cached_property
    def _unit_pgv(self):
        """PGV [mm/s] for which each component has a factor of one, (n,): its own, or that of its
        station in the direction in which it is largest, where that is what the model has."""
        of_all = self.exposure.model.component == "MAX"
        pgv = self.components["pgv_rotd100_mm_s" if of_all else "pgv_mm_s"].to_numpy()
        if self.choices.scale_to == "pgv":
            return pgv
        sa = self.components["sa_0.2_s_g"].to_numpy()
        return sa / exp(np.mean(log(sa / pgv)))

    def _fitting(self, pgv_mm_s):
        """Indices and factors of `components` that may be scaled to a PGV."""
        factor = to_bits(pgv_mm_s / self._unit_pgv)
        fit = np.flatnonzero((factor >= FACTORS[0]) & (factor <= FACTORS[1]))
        if len(fit) == 0:
            raise InputError(
                f"no suitable record for a PGV of {pgv_mm_s:.3g} mm/s: expected a component within"
                f" {self.choices.within_km:g} km that a factor of {FACTORS[0]:g} to {FACTORS[1]:g}"
                " brings there; give more stations, or a larger threshold"
            )
        return fit, factor[fit]

    def as_dict(self):
        """What decides the lives, fit for JSON."""
        exposure = self.exposure
        choices = {
            name: list(value) if isinstance(value, tuple) else value
            for name, value in asdict(self.choices).items()
            # older histories lack these
            if value is not None or name not in ("settle", "distortion")
        }
        return {
            "latitude": exposure.place.latitude,
            "longitude": exposure.place.longitude,
            "vs30_m_s": float(exposure.vs30_m_s),
            "model": exposure.model.source,
            "component": exposure.model.component,
            "years": [int(year) for year in exposure.catalogue.years],
            "events": len(exposure.median_mm_s),
            "sum_of_medians_mm_s": exposure.median_mm_s.sum(),
            **choices,
        }


@lru_cache(maxsize=256)
def strong_window(name, start_s, end_s, shares):
    """Part (start, end) [s] of a record's window that leaves out these shares of its Arias
    intensity, rounded outwards."""
    record = read_record(shipped_records()[name])
    time = record.time_s
    squared = record.acceleration_m_s2**2
    inside = (time >= start_s) & (time <= end_s)
    arias = np.cumsum(squared * inside) / np.sum(squared * inside)
    first, last = np.searchsorted(arias, [shares[0], 1 - shares[1]])
    first = np.floor(time[first] / TENTH_S)
    last = np.ceil(time[min(last, len(time) - 1)] / TENTH_S)
    return max(start_s, first * TENTH_S), min(end_s, last * TENTH_S)


def events_of(life, rest_s):
    """The events of a life's table, a tuple of Event, as `damage.motion.sequence.read_sequence`
    makes them."""
    return tuple(
        Event(_loading(row.record, row.start_s, row.end_s), row.scale, rest_s)
        for row in life.itertuples()
    )


@lru_cache(maxsize=256)
def _loading(name, start_s, end_s):
    return Recorded(read_record(shipped_records()[name]), window_s=(start_s, end_s))


@lru_cache(maxsize=8)
def _read(path, text):
    table = toml_table(path, text, ADDRESS_FILE[0])
    if unknown := sorted(set(table) - set(KEYS)):
        raise InputError(
            f"{path}: unknown key {unknown[0]!r}: expected one of {', '.join(KEYS)}"
            f"{did_you_mean(unknown[0], KEYS)}"
        )
    try:
        return draws_of(table, Path(path).parent)
    except (InputError, TypeError) as error:
        raise InputError(f"{path}: {error}") from error


def read_address(path):
    """Draws of an address's file; raises InputError."""
    return _read(str(path), toml_text(path, *ADDRESS_FILE))


def draws_of(table, folder=Path()):
    """Draws of a table with keys of KEYS; folder: from where the path of its catalogue starts.
    Raises InputError."""
    choices = {name: table[name] for name in Choices.__dataclass_fields__ if name in table}
    return Draws(_exposure(table, folder), Choices(**choices))


def _exposure(table, folder):
    places = [
        pair
        for pair in (("latitude", "longitude"), ("easting_rd_m", "northing_rd_m"))
        if set(pair) & set(table)
    ]
    if len(places) != 1 or not set(places[0]) <= set(table):
        raise InputError(
            "no address: expected latitude and longitude, or easting_rd_m and northing_rd_m; give"
            " one pair"
        )
    for name in places[0]:
        check_range(name, table[name], -1e7, 1e7)
    first, second = (table[name] for name in places[0])
    catalogue = SHIPPED
    if "catalogue" in table:
        beside = folder / str(table["catalogue"])
        catalogue = beside if is_there(beside) else str(table["catalogue"])
    return Exposure(
        at_degrees(first, second) if places[0][0] == "latitude" else at_rd(first, second),
        read_catalogue(catalogue).between(table.get("first_year"), table.get("last_year")),
        model_named(str(table.get("model", "bommer-2022")), table.get("component")),
        table.get("vs30_m_s", 200.0),
    )
