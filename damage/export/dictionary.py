"""The data dictionary: every column of every table that this software writes, with unit and meaning.

`python3 -m damage dictionary --out docs/reference` writes dictionary.csv.  Columns that have their
definition elsewhere are taken from there: those of histories from `damage.history.schema`, those of summaries from
`damage.measure.columns` and `damage.measure.summary`.
"""

from pathlib import Path

import pandas as pd

from damage.exposure.exposure import COLUMNS as EXPOSURE
from damage.history.schema import EVENT_COLUMNS, JOINTS, STATE_COLUMN, STATIC_STAGE, TABLES, Column, each
from damage.index import COMPONENTS
from damage.life.comparison import CHOICES, READINGS
from damage.life.results import COLUMNS as LIVES
from damage.life.results import CONTRIBUTIONS, YEARLY
from damage.measure.columns import MADE_BY, PARAMETERS, RUN
from damage.measure.cycles import BY_OTHERS
from damage.measure.joint_stress import JOINT, SECTIONS, STRESSES
from damage.measure.joint_stress import POINTS as MATERIAL_POINTS
from damage.measure.summary import MEASURES
from damage.measure.tables import write_table
from damage.studies.after_damage import BEFORE
from damage.studies.fragility import OVER
from damage.studies.states import INTENSITIES, LEVELS, unit_of

CRITERION_WORDS = {"": "", "accumulated_": ", slip accumulated", "shear_limit_": ", slip by the shear limit"}
COMPONENT_WORDS = {"DI": "damage index", "DI_drift": "of it by drift", "DI_open": "of it by opened joints",
                   "DI_slip": "of it by slipped joints"}
SLIP = {"slip": Column("", "criterion of slip in the columns that name none: displacement, or accumulated of a history "
                       "without offsets")}


def _index(kind="", what=""):
    """Columns of the index and its components, by all criteria of slip; kind: before the name, what: in the meaning."""
    plain = {f"{kind}{name}": Column("1", f"{what}{COMPONENT_WORDS[name]}, slip by displacement"
                                     if name in ("DI", "DI_slip") else f"{what}{COMPONENT_WORDS[name]}")
             for name in COMPONENTS}
    others = {f"{kind}{name}": Column("1", what + COMPONENT_WORDS[component] + CRITERION_WORDS[
        name.removesuffix(component)]) for name, (_, component) in BY_OTHERS.items()}
    return plain | others


INDEX = {
    "time_s": Column("s", "since the start of the (first) motion"),
    "stage": Column("", "motion, rest, settling"), **_index(),
    "drift_over_limit": Column("1", "absolute drift ratio over its limit, not clipped"),
    "drift_ratio": Column("1", "top displacement over the height of the top course's centres"), **SLIP}
EVENTS = {**EVENT_COLUMNS, "joint_kind": Column("code", "bed, head, brick"), "joint_x_m": JOINTS["x_m"],
          "joint_z_m": JOINTS["z_m"]}
JOINTS_OF_A_RUN = {
    "joint": Column("index", "row of `joints` of the history"), **JOINTS,
    "final_opening_m": Column("m", "opening at the last sample"),
    "max_opening_m": Column("m", "largest opening of all samples"),
    "final_slip_m": Column("m", "accumulated slip at the last sample, signed"),
    "max_abs_slip_m": Column("m", "largest absolute accumulated slip of all samples"),
    "broken": Column("bool", "whether the bond had failed at the last sample"),
    "at_shear_limit": Column("bool", "whether it had failed in shear or slid by then"),
    "crushed": Column("bool", "whether it had been crushed by then"),
    "ended": Column("bool", "whether it had ended by then, as its faces no longer overlapped"),
    "final_offset_m": Column("m", "offset of the faces at the last sample, signed; empty of a history without offsets"),
    "max_abs_offset_m": Column("m", "largest absolute offset of all samples; empty of a history without offsets")}
_SPAN = {"start_s": Column("s", "its start"), "end_s": Column("s", "its end")}
CYCLES = {
    "shock": Column("1", "number of the shock, from 1"), "cycle": Column("1", "number within the shock, from 1"),
    "kind": Column("", "driven: one period of a harmonic motion; free: between upward zero crossings of the drift"),
    **_SPAN, "duration_s": Column("s", "from start to end"),
    "max_drift_ratio": Column("1", "largest absolute drift ratio in the cycle"),
    **_index("max_", "largest in the cycle: "),
    **{f"cumulative_max_{prefix}DI": Column("1", "largest index from the shock's start to the cycle's end" + words)
       for prefix, words in CRITERION_WORDS.items()}, **SLIP}
SHOCKS = {
    "shock": Column("1", "number of the shock, from 1"), "motion": Column("", "name of the motion"),
    "factor": Column("1", "on the motion"), **_SPAN,
    "max_drift_ratio": Column("1", "largest absolute drift ratio in the shock"),
    "residual_drift_ratio": Column("1", "drift ratio at its end, with its sign"),
    **_index("max_", "largest in the shock: "), **_index("residual_", "at its end: "),
    **{f"{kind}_{name}": Column(unit, f"{words}: {meaning}")
       for kind, words in (("max", "largest in the shock"), ("residual", "at its end"))
       for name, unit, meaning in (("psi", "1", "Korswagen's damage parameter of the cracks"),
                                   ("crack_width_mm", "mm", "width of the widest crack"))},
    "offset_before_mm": Column("mm", "largest offset of a joint's faces when the event begins, absolute"),
    "offset_after_mm": Column("mm", "the same at its end"),
    "newly_failed": Column("1", "contact points whose bonds failed in the event"), **SLIP}
STOREYS = {
    "storey": Column("1", "from the base upwards"), "bottom_m": Column("m", "height of its lower end"),
    "top_m": Column("m", "of its upper end: middle of a slab, the course below a timber floor, or the bricks of the "
                    "wall's drift"),
    "max_drift_ratio": Column("1", "largest absolute drift ratio of the storey at the snapshots, every tenth sample"),
    "residual_drift_ratio": Column("1", "drift ratio at the last snapshot, with its sign")}
BRICKS = {
    "brick": Column("1", "row of the history's bodies"), "course": Column("1", "from 0 at the base"),
    "x_m, z_m": Column("m", "of its centre"),
    "max_tension_pa, max_compression_pa": Column("Pa", "largest and smallest principal stress of the middle section "
                                                 "over all snapshots, tension positive"),
    "place": Column("", "of the largest: lower edge, centre or upper edge"), "time_s": Column("s", "of the largest"),
    "splits_at_s": Column("s", "first snapshot above the tensile strength, empty without one")}

RUNS = {name: column for table in (PARAMETERS, RUN, MADE_BY, *MEASURES.values())
        for name, column in each(table).items()}
MEMBERS = {"members": Column("1", "runs of the point in its solver")}
POINTS = {
    **each(PARAMETERS), **MEMBERS, "status": Column("", "complete when all runs are"),
    "collapsed": Column("1", "runs that collapsed"),
    "repeated": Column("1", "runs that were repeated in smaller steps"),
    "collapsed_at_s": Column("s", "median over these, where they are half of the runs or more"), **each(MADE_BY),
    **{name: column._replace(meaning=f"median of the runs: {column.meaning}") if column.unit else column
       for table in MEASURES.values() for name, column in each(table).items()},
    **{f"{name}_{end}": column._replace(meaning=f"{words} of the runs of `{name}`")
       for table in MEASURES.values() for name, column in each(table).items() if column.unit
       for end, words in (("min", "least"), ("max", "largest"))}}

_STATE = {
    "wall": Column("", "name of the wall"), "state": Column("", "damage state: its name, or the condition"),
    "measure": Column("", f"of damage, a column of summary.csv: by default {', '.join(LEVELS)}"),
    "level": Column("of the measure", "level that is exceeded"),
    "intensity": Column("", f"of the motion, a column of summary.csv: {', '.join(INTENSITIES)} or another")}
_CURVE = _STATE | {
    "runs": Column("1", "runs of the wall"), "exceeding": Column("1", "runs that exceed the level"),
    "records": Column("1", "records that the runs come from"),
    "dispersion": Column("1", "standard deviation of the intensity's logarithm at which the level is exceeded; 0 of a "
                         "step, whose dispersion the runs do not give"),
    "undetermined": Column("", "why the runs determine no curve, so that median and dispersion are empty; empty where "
                           "they do")}
_ENDS = ("low", "lower"), ("high", "upper")
UNITS = dict([unit_of(name) for name in INTENSITIES])
FRAGILITY = {
    **_CURVE, **{f"median_{name}": Column(unit, "intensity at which half of the runs exceed the level")
                 for name, unit in UNITS.items()},
    **{f"median_{over}_{end}_{name}": Column(unit, f"{words} bound of the median, {over} drawn anew")
       for over in OVER for end, words in _ENDS for name, unit in UNITS.items()},
    **{f"dispersion_{over}_{end}": Column("1", f"{words} bound of the dispersion, {over} drawn anew")
       for over in OVER for end, words in _ENDS},
    **{f"fitted_{over}": Column("1", f"bootstrap samples that determine a curve, {over} drawn anew; the others count "
                               "as beyond the bounds, which are empty where 5 % or more do") for over in OVER},
    **{f"median_new_record_{end}_{name}": Column(unit, f"{words} bound of a new record's own median")
       for end, words in _ENDS for name, unit in UNITS.items()},
    "confidence": Column("1", "of the bounds"), "replicates": Column("1", "bootstrap samples that were drawn"), **SLIP}
AFTER_DAMAGE = FRAGILITY.copy()
del AFTER_DAMAGE["slip"]
AFTER_DAMAGE["before"] = Column("", f"damage at rest before the shock: {', '.join(BEFORE)}, more")
_VALUE = _STATE | {"value": Column("as `unit` says", "of the intensity"), "unit": Column("", "of the intensity")}
AT = _VALUE | {
    "probability": Column("1", "of exceeding the level, by the curve through all records"),
    **{f"mean_{end}": Column("1", f"{words} bound of it, walls and records drawn anew") for end, words in _ENDS},
    "new_record": Column("1", "probability in a new record, averaged over what it may be"),
    **{f"new_record_{end}": Column("1", f"{words} bound of a new record's own probability") for end, words in _ENDS},
    "undetermined": _CURVE["undetermined"]}
LEFT_OUT = _VALUE | {
    "record": Column("", "record that the curves do not know"),
    "runs": Column("1", "runs of it at this value"), "exceeding": Column("1", "runs of these that exceed the level"),
    "observed": Column("1", "their share"), "pooled": Column("1", "probability by the curve through all other records"),
    "predicted": Column("1", "probability in a new record, after the other records"),
    **{end: Column("1", f"{words} bound of the share of as many runs in a new record") for end, words in _ENDS},
    "inside": Column("1", "1 where the observed share lies between the bounds, else 0"),
    **{f"{name}_{end}": Column("as `unit` says", f"{words} bound of {of}") for name, of in (
        ("own_median", "the record's median: equal where it is known, of a step its two intensities, 0 or inf where "
         "all or no runs exceed"), ("median", "a new record's own median, after the other records"))
       for end, words in _ENDS},
    "median_inside": Column("1", "share of ln(own median) between the latter: 0 or 1 where it is known, empty where it "
                            "may lie on either side")}
SCORES = _STATE | {
    "records": Column("1", "records that are compared"), "runs": Column("1", "runs that are compared"),
    "compared": Column("1", "shares, one for each record and value"),
    "inside": Column("1", "shares of these that lie between their bounds"),
    "medians": Column("1", "records whose own median can be compared"),
    "medians_inside": Column("1", "how many of these lie in the interval for a new record; a step counts in part"),
    **{f"{score}{ending}": Column("1", f"mean {words} of {of}") for ending, of in (
        ("", "the prediction for a new record"), ("_pooled", "the curve through all other records"))
       for score, words in (("brier", "Brier score"), ("log_score", "logarithmic score"))}}
EFFICIENCY = {
    **_CURVE, "scatter": Column("1", "standard deviation of ln(measure) about a line over ln(intensity)"),
    "median": Column("as `unit` says", "intensity at which half of the runs exceed the level"),
    "unit": Column("", "of the median")}
COEFFICIENTS = {
    **_CURVE, "level_unit": Column("", "unit of the level"), "intensity_unit": Column("", "unit of the median"),
    "distribution": Column("", "lognormal: P = Phi(ln(x / median) / dispersion); step: the median is bounded, no "
                           "dispersion is known; none: the runs determine no curve"),
    "median": Column("as `intensity_unit` says", "intensity at which half of the runs exceed the level"),
    "step_low": Column("as `intensity_unit` says", "of a step: intensity up to which no run exceeds the level"),
    "step_high": Column("as `intensity_unit` says", "of a step: intensity from which on all runs do"),
    **{f"new_record_{end}": Column("as `intensity_unit` says", f"{words} bound of a new record's own median")
       for end, words in _ENDS}}
COEFFICIENTS["dispersion"] = Column("1", "standard deviation of the intensity's logarithm, empty of a step")
CRACKS = {
    "load_level": Column("1", "successive load levels"),
    "drift_pct": Column("%", "top displacement over height; one value a level"),
    "crack": Column("", "label of a crack; all its polylines have it"),
    "point": Column("1", "number along a polyline, which begins at 1"),
    "x_m": Column("m", "place of the point, along the wall"), "z_m": Column("m", "the same, upwards"),
    "opening_mm": Column("mm", "across the crack, zero or more"), "slip_mm": Column("mm", "along it, signed"),
    "width_mm": Column("mm", "sqrt(opening² + slip²)"), "mode": Column("", "tension, shear, mixed, unknown")}

DICTIONARY = {
    "summary.csv, study.h5 runs": RUNS | MEMBERS, "points.csv, study.h5 points": POINTS,
    "RUN_index.csv": INDEX, "RUN_events.csv": EVENTS, "RUN_joints.csv": JOINTS_OF_A_RUN, "RUN_cycles.csv": CYCLES,
    "RUN_shocks.csv": SHOCKS, "RUN_storeys.csv": STOREYS, "RUN_bricks.csv": each(BRICKS),
    "RUN_static_stage.csv": STATIC_STAGE, "RUN_stresses.csv": STRESSES, "RUN_sections.csv": SECTIONS,
    "RUN_points.csv": MATERIAL_POINTS, "joint_N.csv": JOINT,
    "fragility_INTENSITY.csv": FRAGILITY,
    "fragility_after_damage_INTENSITY.csv": AFTER_DAMAGE, "fragility_INTENSITY_at.csv": AT,
    "efficiency.csv": EFFICIENCY, "left_out.csv, unseen.csv": LEFT_OUT,
    "left_out_scores.csv, unseen_scores.csv": SCORES,
    "fragility_coefficients.csv": COEFFICIENTS, "crack files": CRACKS, "exposure.csv": EXPOSURE,
    "lives.csv": LIVES, "life.csv": YEARLY, "contributions.csv": CONTRIBUTIONS,
    "choices.csv": CHOICES, "readings.csv": READINGS,
    **{f"RUN.h5 {group}": columns for group, columns in TABLES.items()},
    "RUN.h5 state": {"solver": STATE_COLUMN}}
"""{tables, as their files are called: {column: Column}}; `summary.csv` of `python3 -m damage tables` has no members."""


def dictionary_table():
    """A DataFrame with a row a column: table, column, unit ("" of words), meaning."""
    rows = [(table, name, column.unit, column.meaning) for table, columns in DICTIONARY.items()
            for name, column in columns.items()]
    return pd.DataFrame(rows, columns=["table", "column", "unit", "meaning"])


def write_dictionary(folder):
    """Write dictionary.csv into a folder; returns its path."""
    return write_table(dictionary_table(), Path(folder) / "dictionary.csv")
