"""What the earthquakes of a catalogue caused at a place: PGV of every event, by a ground-motion
model."""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import pandas as pd
import scipy  # optimize where it is used: it starts slowly
from scipy.special import log_ndtr

from damage.applications.groningen.exposure.catalogue import Catalogue, from_field_km
from damage.applications.groningen.exposure.columns import TABLES
from damage.applications.groningen.exposure.ground_motion import VS30_M_S, GroundMotionModel
from damage.applications.groningen.exposure.places import Place, to_wgs84
from damage.checks import check_range
from damage.elementary import hypot
from damage.errors import InputError
from damage.provenance import shown_path

LEVELS_MM_S = (1, 2, 5, 10)
"""PGV whose probability of being exceeded is reported [mm/s]."""
RARE = 0.01
"""Probability of the value that is reported beside the median."""
REACH_KM = 25.0
"""Farthest that a place may be from the nearest epicentre of the field [km]: to there the model was
compared with records."""
_NODES = 64  # of the quadrature over the site term


@dataclass(frozen=True)
class Exposure:
    """A place, the events of a catalogue and a ground-motion model; vs30_m_s: of the place [m/s].

    Raises InputError where the place is farther than REACH_KM from all epicentres, or from those of
    the field.
    """

    place: Place
    catalogue: Catalogue
    model: GroundMotionModel
    vs30_m_s: float = 200.0

    def __post_init__(self):
        check_range("--vs30 [m/s]", self.vs30_m_s, *VS30_M_S)
        nearest = int(np.argmin(self.distance_km))
        if self.distance_km[nearest] > REACH_KM:
            raise InputError(
                f"latitude {self.place.latitude:.4f}, longitude {self.place.longitude:.4f} is"
                f" {self.distance_km[nearest]:.0f} km from the nearest epicentre"
                f" ({self.catalogue.events['place'][nearest]}): expected a place within"
                f" {REACH_KM:g} km of one, as in the Groningen field; look at the coordinates"
            )
        if (km := from_field_km(self.place.x_m, self.place.y_m)) > REACH_KM:
            raise InputError(
                f"latitude {self.place.latitude:.4f}, longitude {self.place.longitude:.4f} is"
                f" {km:.0f} km from the Groningen field's nearest epicentre: expected a place"
                f" within {REACH_KM:g} km of one, to which the ground-motion model was compared"
                " with records; look at the coordinates"
            )

    @property
    def warnings(self):
        """Sentences on what is doubtful: of the catalogue, and of distances."""
        strongest = int(np.argmax(self.median_mm_s))
        km = self.distance_km[strongest]
        magnitude = self.catalogue.events["magnitude"][strongest]
        warnings = list(self.catalogue.notes)
        if km > REACH_KM:
            warnings.append(
                f"the event of the largest median, M {magnitude:g}, is {km:.0f} km away: the model"
                f" was compared with records to {REACH_KM:g} km, PGV farther away is extrapolated"
            )
        return warnings

    @cached_property
    def distance_km(self):
        """Epicentral distance of every event (n_events,) [km], in the plane of RD: its scale is
        within 1e-4 of 1."""
        epicentres = self.catalogue.events[["x_m", "y_m"]].to_numpy()
        return hypot(*(epicentres - (self.place.x_m, self.place.y_m)).T) / 1e3

    @cached_property
    def median_mm_s(self):
        """Median PGV of every event (n_events,) [mm/s]."""
        magnitude = self.catalogue.events["magnitude"].to_numpy()
        return self.model.median_mm_s(magnitude, self.distance_km, self.vs30_m_s)

    def at_least_once(self, pgv_mm_s):
        """Probability that any of the events exceeds a PGV [mm/s].

        All events share the site term, so they are independent only where it is given:
        Gauss-Hermite quadrature over it, of the product of the events' probabilities to stay below.
        """
        tau, site, within = self.model.deviations
        nodes, weights = np.polynomial.hermite_e.hermegauss(_NODES)
        over = np.log(pgv_mm_s / self.median_mm_s)[:, np.newaxis] - site * nodes
        below = np.exp(log_ndtr(over / math.hypot(tau, within)).sum(axis=0))
        return 1.0 - weights @ below / weights.sum()

    def largest_exceeded_mm_s(self, probability):
        """PGV [mm/s] that the largest of all events exceeds with a probability."""
        return np.exp(
            scipy.optimize.brentq(
                lambda ln_pgv: self.at_least_once(math.exp(ln_pgv)) - probability,
                math.log(1e-9),
                math.log(1e9),
            )
        )

    def table(self):
        """DataFrame with a row an event in the order of time; columns: `TABLES`."""
        events = self.catalogue.events
        median = self.median_mm_s
        latitude, longitude = to_wgs84(events.x_m.to_numpy(), events.y_m.to_numpy())
        columns = [
            [f"{time:%Y-%m-%dT%H:%M:%S}" for time in events.time],
            events.magnitude,
            events.place,
            events.id,
            latitude,
            longitude,
            events.x_m,
            events.y_m,
            self.distance_km,
            median,
            self.model.exceeded_mm_s(median, RARE),
            *(self.model.exceedance(median, level) for level in LEVELS_MM_S),
        ]
        return pd.DataFrame(dict(zip(TABLES["exposure.csv"], columns, strict=True)))

    def as_dict(self):
        """Everything that was found, fit for JSON; `events` is a list in the order of time."""
        largest = self.median_mm_s.max()
        return {
            "latitude": self.place.latitude,
            "longitude": self.place.longitude,
            "easting_rd_m": self.place.x_m,
            "northing_rd_m": self.place.y_m,
            "vs30_m_s": float(self.vs30_m_s),
            "model": self.model.source,
            "component": self.model.component,
            "sigma_ln": self.model.deviations.sigma,
            "catalogue": shown_path(self.catalogue.source),
            "from": self.catalogue.years[0],
            "to": self.catalogue.years[1],
            "catalogue_ends": f"{self.catalogue.end:%Y-%m-%d}",
            "largest_median_mm_s": largest,
            "one_percent_mm_s": self.model.exceeded_mm_s(largest, RARE),
            "largest_of_all_median_mm_s": self.largest_exceeded_mm_s(0.5),
            "largest_of_all_one_percent_mm_s": self.largest_exceeded_mm_s(RARE),
            "warnings": self.warnings,
            "at_least_once": {str(level): self.at_least_once(level) for level in LEVELS_MM_S},
            "events": self.table().to_dict("records"),
        }


def strongest(shaking, rows=None):
    """The events of `Exposure.as_dict`, those of the largest median first, up to so many."""
    return sorted(shaking["events"], key=lambda event: -event["median_mm_s"])[:rows]


def describe(shaking, rows=10):
    """Text: `Exposure.as_dict`, with the `rows` events of the largest median."""
    events = strongest(shaking)
    over = [sum(event["median_mm_s"] > level for event in events) for level in LEVELS_MM_S]
    lines = [
        (
            f"latitude {shaking['latitude']:.5f}, longitude {shaking['longitude']:.5f} (RD"
            f" {shaking['easting_rd_m']:.0f} {shaking['northing_rd_m']:.0f} m), VS30"
            f" {shaking['vs30_m_s']:g} m/s"
        ),
        (
            f"{len(events)} events from {shaking['from']} to {shaking['to']},"
            f" {shaking['catalogue']}; the"
            f" last is of {shaking['catalogue_ends']}, later earthquakes are not in it"
        ),
        f"PGV, component {shaking['component']}: {shaking['model']}",
        (
            f"largest median {shaking['largest_median_mm_s']:.4g} mm/s;"
            f" {shaking['one_percent_mm_s']:.4g} mm/s is exceeded with 1 % in that event"
        ),
        (
            f"largest of all events: median {shaking['largest_of_all_median_mm_s']:.4g} mm/s, "
            f"{shaking['largest_of_all_one_percent_mm_s']:.4g} mm/s is exceeded with 1 %"
        ),
        "",
        f"{'PGV over [mm/s]':<28}" + "".join(f"{level:>9}" for level in LEVELS_MM_S),
        f"{'events whose median is over':<28}" + "".join(f"{count:>9}" for count in over),
        f"{'probability, at least once':<28}"
        + "".join(f"{shaking['at_least_once'][str(level)]:>9.3f}" for level in LEVELS_MM_S),
        "",
        (
            f"{'time (UTC)':<20} {'M':>4} {'place':<18} {'km':>5} {'median':>8} {'1 %':>8}  "
            " probability of exceeding"
        ),
        f"{'[mm/s]':>59} {'[mm/s]':>8}" + "".join(f"{level:>7}" for level in LEVELS_MM_S),
        *map(_row, events[:rows]),
        *[f"... and {len(events) - rows} weaker ones"] * (len(events) > rows),
        *(f"warning: {warning}" for warning in shaking["warnings"]),
    ]
    return "\n".join(lines)


def _row(event):
    return (
        f"{event['time_utc']:<20} {event['magnitude']:>4.1f} {event['place'][:18]:<18}"
        f" {event['epicentral_km']:>5.1f} {event['median_mm_s']:>8.4g}"
        f" {event['one_percent_mm_s']:>8.4g}"
        + "".join(f"{event[f'p_over_{level}_mm_s']:>7.3f}" for level in LEVELS_MM_S)
    )
