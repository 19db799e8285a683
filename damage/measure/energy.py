"""Energy balance of a run: what came in is kinetic, elastic, lifted, or dissipated."""

import numpy as np

from damage.history.moments import is_moving, moving

STORED = ("kinetic_energy_j", "elastic_energy_j", "gravity_energy_j")
DISSIPATED = ("friction_energy_j", "fracture_energy_j", "damping_energy_j")


def imbalance(series):
    """Stored and dissipated energy less the input, since the first sample: (n_times,) [J]."""
    total = sum(series[name].to_numpy() for name in (*STORED, *DISSIPATED))
    total = total - series["input_energy_j"].to_numpy()
    return total - total[0]


def energy_error(series):
    """Largest absolute imbalance over the largest absolute input [-], settling stage excluded.

    None where nothing came in, or of too few samples.
    """
    before = moving(series)
    if len(before) < 2:
        return None
    scale = energy_scale(before)
    return float(np.abs(imbalance(before)).max() / scale) if scale > 0 else None


def energy_scale(series):
    """What an imbalance is measured by [J]: the largest input or, in free vibration, the energy of the kick."""
    return max(np.abs(series["input_energy_j"]).max(), series["kinetic_energy_j"].iloc[0])


def energy_measures(history):
    """Energies of a whole History [J]: input, and what friction, fracture and damping took.

    dissipated_energy_j is friction and fracture together; damping_energy_j leaves the settling stages
    out, whose damping is no part of the model.
    """
    series = history.series
    friction, fracture, given = (float(series[name].iloc[-1]) for name in (
        "friction_energy_j", "fracture_energy_j", "input_energy_j"))
    damping = float(np.diff(series["damping_energy_j"], prepend=0.0)[is_moving(series)].sum())
    return {"input_energy_j": given, "friction_energy_j": friction, "fracture_energy_j": fracture,
            "dissipated_energy_j": friction + fracture, "damping_energy_j": damping}
