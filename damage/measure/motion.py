"""Intensity of the motion that a run applied."""

from damage.motion.intensity import APPLIED, applied_measures

_POWERS = {"arias_m_s": 2, "d5_75_s": 0, "d5_95_s": 0}
"""With which power of the factor on the motion a measure grows; 1 where it is not listed."""


def motion_measures(history):
    """{measure: value} of APPLIED for a History, of its strongest shock; None where one does not apply.

    A run writes them into its history.  Of an older file those of a harmonic motion are worked out from it, those of a
    record are None: its samples are not in the file.
    """
    found = {name: history.parameters.get(name) for name in APPLIED}
    if not any(name in history.parameters for name in APPLIED):
        found = applied_measures(history.loading.applied(), history.eigen_period_s)
    factor = max(map(abs, history.sequence))
    return {name: value if value is None else value * factor ** _POWERS.get(name, 1) for name, value in found.items()}
