"""Energy balance of a run: what came in is kinetic, elastic, lifted, or dissipated."""

import numpy as np

STORED = ("kinetic_energy_j", "elastic_energy_j", "gravity_energy_j")
DISSIPATED = ("friction_energy_j", "fracture_energy_j", "damping_energy_j")


def imbalance(series):
    """Stored and dissipated energy less the input, since the first sample: (n_times,) [J]."""
    total = sum(series[name].to_numpy() for name in (*STORED, *DISSIPATED))
    total = total - series["input_energy_j"].to_numpy()
    return total - total[0]


def energy_error(series):
    """Largest absolute imbalance over the largest absolute input [-], settling stage excluded.

    In free vibration nothing comes in: the energy of the kick takes the input's place.  None where
    there is neither, or too few samples.
    """
    moving = series[series["stage"] != "settling"]
    if len(moving) < 2:
        return None
    scale = max(np.abs(moving["input_energy_j"]).max(), moving["kinetic_energy_j"].iloc[0])
    return float(np.abs(imbalance(moving)).max() / scale) if scale > 0 else None


def energy_measures(history):
    """Energies of a whole History [J]: input, and what friction, fracture and damping took.

    dissipated_energy_j is friction and fracture together; damping_energy_j leaves the settling stages
    out, whose damping is no part of the model.
    """
    series = history.series
    friction, fracture, given = (float(series[name].iloc[-1]) for name in (
        "friction_energy_j", "fracture_energy_j", "input_energy_j"))
    in_motion = (series["stage"] != "settling").to_numpy()
    damping = float(np.diff(series["damping_energy_j"], prepend=0.0)[in_motion].sum())
    return {"input_energy_j": given, "friction_energy_j": friction, "fracture_energy_j": fracture,
            "dissipated_energy_j": friction + fracture, "damping_energy_j": damping}
