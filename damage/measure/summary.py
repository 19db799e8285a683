"""Summary of a run: all its scalar measures, the JSON of `python3 -m damage index`."""

import pandas as pd

from damage.history.moments import check_samples
from damage.history.reader import History
from damage.index import COMPONENTS, DRIFT_LIMIT, THRESHOLD
from damage.measure import (
    cracks,
    cycles,
    damage_index,
    energy,
    ground,
    house,
    joints,
    limits,
    pushed,
)
from damage.measure.cracks import PSI_FROM
from damage.measure.evidence import evidence_for, outside
from damage.measure.warnings import warnings_of
from damage.motion.intensity import motion_measures, record_unit
from damage.units import MILLIMETRE
from damage.wall.lintels import elastic_share

_MODULES = {
    "Index, drift": [damage_index],
    "Forces": [pushed],
    "Cycles and period": [cycles],
    "Cracks": [cracks, joints],
    "Ground": [ground],
    "House": [house],
    "Energy": [energy],
    "Classes by published limits": [limits],
}
REGISTER = {
    section: [
        var
        for module in modules
        for var in vars(module).values()
        if hasattr(var, "columns") and var.__module__ == module.__name__
    ]
    for section, modules in _MODULES.items()
}
"""{section of the document: functions with `damage.history.schema.measure`}, in the order of
summary.csv."""
MEASURES = {
    section: {
        several: column for function in functions for several, column in function.columns.items()
    }
    for section, functions in REGISTER.items()
}
"""{section of the document: {names: Column}} of the results."""


def flat_summary(
    history: History,
    threshold: float = THRESHOLD,
    drift_limit: float = DRIFT_LIMIT,
    slip: str = "displacement",
    psi_from: float = PSI_FROM,
) -> dict:
    """{column: value} of what a History is, and of all MEASURES; arguments: of `summarise`.

    Raises InputError where the history has no sample.

    >>> round(flat_summary(history)["max_DI"], 4)
    0.0729
    """
    check_samples(history)
    elastic = elastic_share(history.plan, history.joints, history.bodies)
    numbers = {
        "wall": history.wall,
        "solver": history.solver,
        "motion": history.loading.name,
        "record_unit": record_unit(history),
        "status": history.status,
        "complete": history.complete,
        "collapsed_at_s": history.collapsed_at_s,
        "slip": slip,
        "psi_from_mm": psi_from / MILLIMETRE,
        "total_joint_length_m": float(history.joint_length_m.sum()),
        "elastic_joint_share": elastic.of_all,
        "elastic_joint_share_above_openings": elastic.above_openings,
        **motion_measures(history),
        "lost_by_lines": history.loading.lost_by_lines,
    }
    asked = {
        "history": history,
        "threshold": threshold,
        "drift_limit": drift_limit,
        "slip": slip,
        "psi_from": psi_from,
    }
    for function in (function for functions in REGISTER.values() for function in functions):
        known = numbers | asked
        numbers |= function(**{name: known[name] for name in function.arguments})
    evidence = evidence_for(history.masonry_wall, history.parameters, numbers)
    return numbers | {
        "evidence": evidence,
        "outside_validity": "; ".join(outside(evidence)) or None,
    }


def summarise(
    history: History,
    threshold: float = THRESHOLD,
    drift_limit: float = DRIFT_LIMIT,
    slip: str = "displacement",
    psi_from: float = PSI_FROM,
) -> dict:
    """Summary of a History, a plain dictionary; units in the names, in MEASURES and in
    `damage.measure.columns`.

    threshold: of opening and slip in the damage index [m]; drift_limit: of its drift component [-];
    slip: criterion of `max` and `residual`; psi_from: width from which a crack counts in Psi [m].

    max: maximum of each component over the run, not at one time; residual: the index in the last
    state of the settling stage, or at collapse, None where the run is not complete;
    max_accumulated, residual_shear_limit and so on: by the other criteria; warnings: conditions
    under which results are doubtful (`damage.measure.warnings`); threshold_mm, drift_limit_pct,
    contact_points: what components of the index and failures are of; evidence: which quantities are
    inside the range of validity (`damage.measure.evidence`).

    Raises InputError where the history has no sample.

    >>> sorted(summarise(history))[:3]
    ['angular_distortion', 'arias_m_s', 'avg_sa_g']
    """
    numbers = flat_summary(history, threshold, drift_limit, slip, psi_from)
    index = {
        f"{kind}{ending}": {name: numbers.pop(f"{kind}{ending}_{name}") for name in COMPONENTS}
        for ending in ("", "_accumulated", "_shear_limit")
        for kind in ("max", "residual")
    }
    index |= {kind: None for kind in index if kind.startswith("residual") and not history.complete}
    return (
        numbers
        | index
        | {
            "threshold_mm": threshold / MILLIMETRE,
            "drift_limit_pct": 100 * drift_limit,
            "contact_points": len(history.joints),
            "warnings": warnings_of(history),
        }
    )


def evidence_of(history: History) -> pd.DataFrame:
    """The range of validity (`docs/model/validity.md`) of a History, a DataFrame, a row a quantity:
    value, least, most, unit and whether this run is inside, None where the quantity does not apply.

    >>> evidence_of(history).loc["drift", ["least", "most", "unit", "inside"]].tolist()
    [0.0, 0.3, '%', True]
    """
    return pd.DataFrame(summarise(history)["evidence"]).T.rename_axis("quantity")
