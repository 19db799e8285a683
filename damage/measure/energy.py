"""Energy balance of a run: input = kinetic + elastic + potential + dissipated energy."""

import numpy as np
import pandas as pd

from damage.history.reader import History
from damage.history.schema import Column, is_moving, measure
from damage.units import GRAVITY

STORED = ("kinetic_energy_j", "elastic_energy_j", "gravity_energy_j")
DISSIPATED = ("friction_energy_j", "fracture_energy_j", "damping_energy_j")
ENERGY_ERROR = 0.01
"""Energy balance error [-] above which a run has a warning.

In the runs of `docs/tables` walls that stand have errors up to 0.021 in YADE and 0.0042 in the
reference solver, those that collapse up to 0.25 and 0.016.
"""
ENERGY_FAILURE = 1.0
"""Energy balance error [-] above which a run has failed: the entire input."""
NOISE = 1e-12
"""Share of weight times height [-] below which an input is rounding error: less than a microjoule
for a façade wall, whose input in free vibration is a millijoule."""


def energy_groups(series: pd.DataFrame) -> dict[str, np.ndarray]:
    """Energies over time by group, {name: (n_times,)} [J]; series: of a History.

    input_energy_j: work of the base and of prescribed velocities; stored_energy_j: kinetic, elastic
    and potential; dissipated_energy_j: friction and fracture in the joints; damping_energy_j:
    viscous damping.  NaN where the solver does not record a term.  The input is the sum of the
    others, less the energy stored at the first sample.

    >>> sorted(energy_groups(history.series))
    ['damping_energy_j', 'dissipated_energy_j', 'input_energy_j', 'stored_energy_j']
    """
    stored, dissipated = (
        series[list(names)].sum(axis=1, min_count=1) for names in (STORED, DISSIPATED[:2])
    )
    return {
        "input_energy_j": series["input_energy_j"].to_numpy(),
        "stored_energy_j": stored.to_numpy(),
        "dissipated_energy_j": dissipated.to_numpy(),
        "damping_energy_j": series["damping_energy_j"].to_numpy(),
    }


def known_energies(series: pd.DataFrame) -> pd.DataFrame:
    """All energies of a series, a DataFrame [J], zero where the solver does not record them.

    >>> len(known_energies(history.series))
    21
    """
    return series[[*STORED, *DISSIPATED, "input_energy_j"]].fillna(0.0)


def noise_j(mass_kg: float, height_m: float) -> float:
    """Least input energy [J] for an energy balance error of a wall of this mass [kg] and height
    [m].

    >>> round(noise_j(1000.0, 2.0), 12)
    1.962e-08
    """
    return NOISE * mass_kg * GRAVITY * height_m


def imbalance(series: pd.DataFrame) -> np.ndarray:
    """Imbalance of the energies, (n_times,) [J]: stored and dissipated less input, relative to the
    first sample.

    >>> imbalance(history.series).shape
    (21,)
    """
    total = sum(series[name].to_numpy() for name in (*STORED, *DISSIPATED))
    total = total - series["input_energy_j"].to_numpy()
    return total - total[0]


def energy_error(series: pd.DataFrame, noise: float = 0.0) -> float | None:
    """Energy balance error [-]: largest |imbalance| over `energy_scale`, without settling stages.

    series: of a History; noise: least scale [J].  None where the scale is not above it, or below
    two samples.

    >>> energy_error(history.series)
    0.0
    """
    before = series[series["stage"] != "settling"]
    if len(before) < 2:
        return None
    scale = energy_scale(before)
    return float(np.abs(imbalance(before)).max() / scale) if scale > noise else None


def energy_error_of(history: History) -> float | None:
    """Energy balance error of a History [-] (`energy_error`); None where its input is rounding
    error (`noise_j`).

    >>> energy_error_of(history)
    0.0
    """
    return energy_error(
        history.series, noise_j(history.bodies["mass_kg"].sum(), history.attributes["height_m"])
    )


def balance_error(history: History) -> float | None:
    """Energy balance error of a History [-] (`energy_error_of`); None for quasi-static runs of
    YADE, whose damping energy is computed from the balance.

    >>> balance_error(history)
    0.0
    """
    return (
        None
        if history.solver == "yade" and history.loading.drive.quasi_static
        else energy_error_of(history)
    )


def energy_scale(series: pd.DataFrame) -> float:
    """Reference energy of the imbalance [J]: the largest |input|, or the first kinetic energy if
    that is larger."""
    return max(np.abs(series["input_energy_j"]).max(), series["kinetic_energy_j"].iloc[0])


class Balance:
    """Energy balance error (`energy_error`) of a run in progress; noise: least scale [J].

    state: what it knows so far, (4,): imbalance of the first sample, largest one relative to it,
    scale [J], samples.
    """

    def __init__(self, noise: float) -> None:
        self._noise = noise
        self.state = np.zeros(4)

    def add(self, rows: dict) -> None:
        """Add one or more samples, {column of the series: (n,)} [J]; leave out settling stages."""
        excess = sum(map(rows.__getitem__, STORED + DISSIPATED)) - rows["input_energy_j"]
        first, largest, scale, n = self.state
        if n == 0:
            first = excess[0]
            scale = rows["kinetic_energy_j"][0]
        self.state = np.array(
            [
                first,
                max(largest, np.abs(excess - first).max()),
                max(scale, np.abs(rows["input_energy_j"]).max()),
                n + len(excess),
            ]
        )

    @property
    def error(self) -> float | None:
        """Energy balance error so far [-]; None as of `energy_error`."""
        _, largest, scale, n = self.state
        return largest / scale if n > 1 and scale > self._noise else None


@measure(
    {
        "input_energy_j": Column("J", "work of the base's inertia forces up to the run's end"),
        "friction_energy_j, fracture_energy_j": Column(
            "J",
            "taken by sliding, and lost as bonds soften and break and as "
            "joints crush, up to the run's end",
        ),
        "dissipated_energy_j": Column("J", "their sum"),
        "damping_energy_j": Column(
            "J",
            "taken by damping, settling stages left out: viscous of joints, soil and impacts, of"
            " strain modes, and that of a push",
        ),
        "energy_error_fraction": Column(
            "1", "largest imbalance over the largest input, settling stages left out"
        ),
    }
)
def energy_measures(history: History) -> tuple:
    """Energies at the end of a History [J], and its `balance_error`.  The damping of settling
    stages is a numerical means and not part of the model."""
    series = history.series
    friction, fracture, given = (
        float(series[name].iloc[-1])
        for name in ("friction_energy_j", "fracture_energy_j", "input_energy_j")
    )
    damping = series["damping_energy_j"].diff().fillna(0.0)  # of a run that another continues, too
    damping = float(damping[is_moving(series)].sum())
    return given, friction, fracture, friction + fracture, damping, balance_error(history)
