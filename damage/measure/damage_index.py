"""Maximum and residual damage index of a run, by all criteria of slip, and its drift."""

import numpy as np

from damage.history.schema import Column
from damage.index import COMPONENTS
from damage.measure.register import measure

CRITERIA = {"displacement": "", "accumulated": "accumulated_", "shear-limit": "shear_limit_"}
"""{slip criterion: prefix of a component's name in its columns}."""


def _names(kind, slip):
    return ", ".join(f"{kind}_{CRITERIA[slip]}{name}" for name in COMPONENTS)


@measure({
    _names("max", "displacement"): Column("1", "each its own maximum over the run, slip by displacement"),
    _names("residual", "displacement"): Column("1", "the last state of the settling stage, or of a collapse"),
    _names("max", "accumulated"): Column("1", "the same with slip accumulated"),
    _names("residual", "accumulated"): Column("1", "the same with slip accumulated"),
    _names("max", "shear-limit"): Column("1", "the same with slip by the shear limit"),
    _names("residual", "shear-limit"): Column("1", "the same with slip by the shear limit")})
def index_measures(history, threshold, drift_limit, slip):
    """Damage index of a History; arguments, and what is maximum and residual: `damage.measure.summary.summarise`."""
    values = []
    for criterion in (slip, "accumulated", "shear-limit"):
        over_time = history.index(threshold, drift_limit, criterion)[list(COMPONENTS)]
        values += [*over_time.max(), *(over_time.iloc[-1] if history.complete else [None] * len(COMPONENTS))]
    return values


@measure({"max_drift_ratio, residual_drift_ratio": Column("1", "largest absolute drift ratio; drift ratio at the end, "
                                                          "with its sign")})
def drift_measures(history):
    """Drift of a History; the residual is None where the run is not complete."""
    drift = history.series["drift_ratio"]
    return float(np.abs(drift).max()), float(drift.iloc[-1]) if history.complete else None
