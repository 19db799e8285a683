"""Summary of a run: all its scalar measures, the JSON of `python3 -m damage index`."""

import numpy as np

from damage.errors import InputError
from damage.index import COMPONENTS, DRIFT_LIMIT, THRESHOLD
from damage.measure.brick_stress import stress_measures
from damage.measure.cracks import PSI_FROM, psi_summary
from damage.measure.cycles import cycle_measures
from damage.measure.energy import energy_measures
from damage.measure.evidence import evidence_for, facts, outside
from damage.measure.ground import ground_measures
from damage.measure.limits import classes
from damage.measure.motion import motion_measures, record_unit
from damage.measure.pushed import first_loading
from damage.measure.validity import ended_joints, offset_over_overlap
from damage.measure.vibration import period_of
from damage.measure.warnings import balance_error, warnings_of, with_bond
from damage.wall.lintels import elastic_share


def summarise(history, threshold=THRESHOLD, drift_limit=DRIFT_LIMIT, slip="displacement", psi_from=PSI_FROM):
    """Summary of a History, a plain dictionary; units in the names and in `damage.measure.columns`.

    threshold: of opening and slip in the damage index [m]; drift_limit: of its drift component [-]; slip: criterion of
    `max` and `residual`; psi_from: width from which a crack counts in Psi [m].

    max: maximum of each component over the run, not at one time; residual: the index in the last state of the settling
    stage, or at collapse, None where the run is not complete; max_accumulated, residual_shear_limit and so on: by the
    other criteria; slip: the criterion in fact used (`History.judged_by`); warnings: conditions under which results are
    doubtful (`damage.measure.warnings`); evidence: which quantities are inside the range of validity
    (`damage.measure.evidence`).

    Raises InputError where the history has no sample.
    """
    if len(history.series) == 0:
        raise InputError(f"{history.path} holds no sample yet ({history.status}); let the run continue")
    series, active, states, index = history.series, history.active, history.states, {}
    broken, crushed = (states.joints[frames[-1]] for frames in (states.broken, states.crushed))
    for ending, criterion in (("", slip), ("_accumulated", "accumulated"), ("_shear_limit", "shear-limit")):
        over_time = history.index(threshold, drift_limit, criterion)[list(COMPONENTS)]
        index |= {f"max{ending}": over_time.max().to_dict(),
                  f"residual{ending}": over_time.iloc[-1].to_dict() if history.complete else None}
    elastic = elastic_share(history.plan, history.joints, history.bodies)
    max_drift_ratio = float(np.abs(series["drift_ratio"]).max())
    cracks = psi_summary(history, psi_from)
    failures = history.events["kind"]
    if history.parameters.get("cracked"):  # what a survey took is no failure of the run
        failures = failures[with_bond(history)[history.events["joint"]]]
    energy_error = balance_error(history)
    return with_evidence(history, {
        "wall": history.wall, "solver": history.solver, "motion": history.loading.name,
        "record_unit": record_unit(history),
        "status": history.status, "complete": history.complete, "collapsed_at_s": history.collapsed_at_s,
        "slip": history.judged_by(slip), **index, "max_drift_ratio": max_drift_ratio,
        "residual_drift_ratio": float(series["drift_ratio"].iloc[-1]) if history.complete else None,
        "total_joint_length_m": float(history.joint_length_m.sum()),
        "elastic_joint_share": elastic.of_all, "elastic_joint_share_above_openings": elastic.above_openings,
        "peak_base_shear_n": float(np.abs(series["base_shear_n"]).max()),
        "max_opening_mm": _largest(active.opening_m) * 1e3,
        "max_slip_mm": _largest(active.slip_m) * 1e3,
        "max_offset_mm": None if active.offset_m is None else _largest(active.offset_m) * 1e3,
        "max_offset_over_overlap": _over_overlap(history), "ended_joints": getattr(ended_joints(history), "count", 0),
        "tension_breaks": int((failures == "tension").sum()), "shear_breaks": int((failures == "shear").sum()),
        "crushed_length_m": float(history.joint_length_m[crushed].sum()),
        "split_length_m": float((history.joints["length_m"] - history.joint_length_m).iloc[broken].sum()),
        "energy_error_fraction": energy_error, "warnings": warnings_of(history, energy_error, elastic),
        **motion_measures(history), "lost_by_lines": history.loading.lost_by_lines, "period_s": period_of(history),
        **first_loading(history), **cracks, **cycle_measures(history), **energy_measures(history),
        **ground_measures(history, psi_from), **stress_measures(history),
        **classes(max_drift_ratio, cracks["max_psi"], cracks["max_crack_width_mm"]),
    })


def with_evidence(history, numbers):
    """The numbers of a History with its `evidence` (`damage.measure.evidence.evidence_for`) and, in words, the
    quantities that are `outside_validity`."""
    found = evidence_for(facts(history.masonry_wall, history.parameters, numbers))
    return numbers | {"evidence": found, "outside_validity": "; ".join(outside(found)) or None}


def _over_overlap(history):
    """Largest offset over the overlap [-]; zero where nothing failed, None for a history without offsets."""
    if history.active.offset_m is None:
        return None
    found = offset_over_overlap(history)
    return 0.0 if found is None else found[0]


def _largest(frames):
    """Largest absolute value of frames (n_times, n), zero where they are empty."""
    return float(max(frames.max(initial=0.0), -frames.min(initial=0.0)))
