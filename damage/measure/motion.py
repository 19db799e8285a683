"""Intensity measures of the motion that a run applied."""

from damage.motion.intensity import APPLIED, applied_measures

_POWERS = {"arias_m_s": 2, "d5_75_s": 0, "d5_95_s": 0}
"""{measure: power of the factor on the motion to which it is proportional}; 1 where not listed."""


def motion_measures(history):
    """{measure: value} of APPLIED for the strongest event of a History; None where a measure does not apply.

    Units: `damage.measure.columns.PARAMETERS`.  They are read from the history.  In older files, which lack them, those
    of a harmonic motion are computed, and those of a record are None, as its samples are not in the file.
    """
    found = {name: history.parameters.get(name) for name in APPLIED}
    if not any(name in history.parameters for name in APPLIED):
        found = applied_measures(history.loading.applied(), history.eigen_period_s)
    factor = history.strongest_factor
    return {name: value if value is None else value * factor ** _POWERS.get(name, 1) for name, value in found.items()}


def record_unit(history):
    """Which unit the records of a History were taken to be in, and what says so; None without a record, or in an older
    file."""
    origins = [loading.as_dict().get("horizontal") or {} for loading in history.event_loadings]
    return "; ".join(dict.fromkeys(origin["unit"] for origin in origins if origin.get("unit"))) or None
