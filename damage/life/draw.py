"""Drawing lives: a motion for every event of a catalogue at an address."""

from dataclasses import dataclass

import numpy as np
import pandas as pd

from damage.errors import InputError
from damage.exposure.residuals import COMPONENTS
from damage.files import write_text

_COLUMNS = ["time_utc", "magnitude", "place", "id", "pgv_mm_s", "record", "scale", "start_s", "end_s"]
FACTORS = 0.1, 10.0
"""Bounds of the factor on a record: the README beside the components has the reason."""


@dataclass(frozen=True)
class Draws:
    """What lives are drawn from.

    exposure: damage.exposure.exposure.Exposure; from_mm_s: PGV from which an event is part of a life [mm/s];
    within_km: farthest station whose records are used [km]; seed: of all lives.
    """

    exposure: object
    from_mm_s: float = 2.0
    within_km: float = 10.0
    seed: int = 0

    def life(self, number):
        """Table of the events of a life, by its number from 1, in the order of time.

        Columns: time_utc, magnitude, place, id, pgv_mm_s, record, scale, start_s, end_s.  The same seed and number give
        the same life, whatever else is drawn; the threshold leaves events out and changes no other.  Raises InputError
        where no component may be scaled to a PGV.
        """
        rng, exposure = np.random.default_rng([self.seed, number]), self.exposure
        n_events = len(exposure.median_mm_s)
        terms = exposure.model.draw(rng, 1, n_events)
        choice, sign = rng.random(n_events), rng.choice([-1.0, 1.0], n_events)
        pgv = exposure.median_mm_s * np.exp(sum(terms)[0, :, 0])
        events, rows = exposure.catalogue, []
        for k in np.flatnonzero(pgv >= self.from_mm_s):
            component = self._component(pgv[k], choice[k])
            rows.append({"time_utc": f"{events.time[k]:%Y-%m-%dT%H:%M:%S}", "magnitude": events.magnitude[k],
                         "place": events.place[k], "id": events.id[k], "pgv_mm_s": pgv[k], "record": component.record,
                         "scale": sign[k] * pgv[k] / component.pgv_mm_s, "start_s": component.start_s,
                         "end_s": component.end_s})
        return pd.DataFrame(rows, columns=_COLUMNS)

    def _component(self, pgv_mm_s, choice):
        """The component at a share `choice` of those that may be scaled to a PGV."""
        table = pd.read_csv(COMPONENTS, comment="#")
        factor = pgv_mm_s / table["pgv_mm_s"]
        fit = table[(table["epicentral_km"] <= self.within_km) & (factor >= FACTORS[0]) & (factor <= FACTORS[1])]
        if fit.empty:
            raise InputError(f"no suitable record for a PGV of {pgv_mm_s:.3g} mm/s: expected a component within "
                             f"{self.within_km:g} km that a factor of {FACTORS[0]:g} to {FACTORS[1]:g} brings there; "
                             "give more stations, or a larger threshold")
        return next(fit.iloc[[int(choice * len(fit))]].itertuples())


def write_sequence(life, path):
    """Write a life as a sequence file, which a run takes; returns its path."""
    return write_text(path, life[["record", "scale", "start_s", "end_s"]].to_csv(index=False))
