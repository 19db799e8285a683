"""Energy balance of a run: the input is kinetic, elastic, potential or dissipated energy."""

import numpy as np

from damage.history.moments import is_moving, moving
from damage.units import GRAVITY

STORED = ("kinetic_energy_j", "elastic_energy_j", "gravity_energy_j")
DISSIPATED = ("friction_energy_j", "fracture_energy_j", "damping_energy_j")
NOISE = 1e-12
"""Share of weight times height below which an input is rounding: of a façade wall less than a microjoule, where the
push of a free vibration is a millijoule."""


def energy_groups(series):
    """Energies of a series [J], {name: (n_times,)}: supplied by the base and by forces, stored (kinetic, elastic and of
    position), dissipated in the joints (friction and fracture), and damped; one that a solver does not record is NaN.

    Supplied is the sum of the others, less what was stored at the start of a free vibration.
    """
    stored, dissipated = (series[list(names)].sum(axis=1, min_count=1) for names in (STORED, DISSIPATED[:2]))
    return {"input_energy_j": series["input_energy_j"].to_numpy(), "stored_energy_j": stored.to_numpy(),
            "dissipated_energy_j": dissipated.to_numpy(), "damping_energy_j": series["damping_energy_j"].to_numpy()}


def noise_j(mass_kg, height_m):
    """Least input energy [J] of a wall of this mass and height for which the balance is judged."""
    return NOISE * mass_kg * GRAVITY * height_m


def imbalance(series):
    """Stored and dissipated energy less the input, since the first sample: (n_times,) [J]."""
    total = sum(series[name].to_numpy() for name in (*STORED, *DISSIPATED))
    total = total - series["input_energy_j"].to_numpy()
    return total - total[0]


def energy_error(series, noise=0.0):
    """Largest absolute imbalance over the largest absolute input [-], settling stage excluded.

    None where no more than `noise` [J] came in, or of too few samples.
    """
    before = moving(series)
    if len(before) < 2:
        return None
    scale = energy_scale(before)
    return float(np.abs(imbalance(before)).max() / scale) if scale > noise else None


def energy_error_of(history):
    """`energy_error` of a History, None where its input is no more than rounding."""
    return energy_error(history.series, noise_j(history.bodies["mass_kg"].sum(), history.attributes["height_m"]))


def energy_scale(series):
    """Reference of the imbalance [J]: the largest input or, in free vibration, the initial kinetic energy."""
    return max(np.abs(series["input_energy_j"]).max(), series["kinetic_energy_j"].iloc[0])


class Balance:
    """The `energy_error` of a run under way: `add` rows of the series as they come, settling stages left out."""

    def __init__(self, noise):
        self._noise, self._first, self._largest, self._scale, self._n = noise, 0.0, 0.0, 0.0, 0

    def add(self, rows):
        """rows: {column of the series: (n,)}, of one or more."""
        excess = sum(map(rows.__getitem__, STORED + DISSIPATED)) - rows["input_energy_j"]
        if self._n == 0:
            self._first, self._scale = excess[0], rows["kinetic_energy_j"][0]
        self._n += len(excess)
        self._largest = max(self._largest, np.abs(excess - self._first).max())
        self._scale = max(self._scale, np.abs(rows["input_energy_j"]).max())

    @property
    def error(self):
        """The error so far [-], None where `energy_error` has none."""
        return self._largest / self._scale if self._n > 1 and self._scale > self._noise else None


def energy_measures(history):
    """Energies of a whole History [J]: input, and dissipation by friction, fracture and damping.

    dissipated_energy_j is friction and fracture together; damping_energy_j leaves the settling stages
    out, whose damping is no part of the model.
    """
    series = history.series
    friction, fracture, given = (float(series[name].iloc[-1]) for name in (
        "friction_energy_j", "fracture_energy_j", "input_energy_j"))
    damping = float(np.diff(series["damping_energy_j"], prepend=0.0)[is_moving(series)].sum())
    return {"input_energy_j": given, "friction_energy_j": friction, "fracture_energy_j": fracture,
            "dissipated_energy_j": friction + fracture, "damping_energy_j": damping}
