"""Columns of the tables of studies and of fragility, for the data dictionary."""

from damage.applications.studies.states import (
    COLUMNS,
    INTENSITIES,
    LEVELS,
    OF_MEASURES,
    in_unit,
    unit_of,
)
from damage.history.schema import Column, each
from damage.measure.columns import MADE_BY, OF_THE_FIRST, PARAMETERS
from damage.measure.damage_index import SLIP

MEMBERS = {"members": Column("1", "runs of the point in its solver")}
POINTS = {
    **each(PARAMETERS),
    **MEMBERS,
    "status": Column("", "complete when all runs are"),
    "collapsed": Column("1", "runs that collapsed"),
    "repeated": Column("1", "runs that were repeated in smaller steps"),
    "collapsed_at_s": Column("s", "median over these, where they are half of the runs or more"),
    **each(MADE_BY),
    **{
        name: (
            column._replace(meaning=f"median of the runs: {column.meaning}")
            if column.unit
            else column
        )
        for name, column in OF_MEASURES.items()
    },
    **{
        f"{name}_{end}": column._replace(meaning=f"{bound} of the runs of `{name}`")
        for name, column in (each(PARAMETERS) | OF_MEASURES).items()
        if column.unit and name != OF_THE_FIRST
        for end, bound in (("min", "least"), ("max", "largest"))
    },
}

_STATE = {
    "wall": Column("", "name of the wall"),
    "state": Column("", "damage state: its name, or the condition"),
    "measure": Column("", f"of damage, a column of summary.csv: by default {', '.join(LEVELS)}"),
    "level": Column("of the measure", "level that is exceeded"),
    "intensity": Column(
        "", f"of the motion, a column of summary.csv: {', '.join(INTENSITIES)} or another"
    ),
}
CURVE = _STATE | {
    "runs": Column("1", "runs of the wall"),
    "exceeding": Column("1", "runs that exceed the level"),
    "records": Column("1", "records that the runs come from"),
    "dispersion": Column(
        "1",
        "standard deviation of the intensity's logarithm at which the level is exceeded; 0 of a "
        "step, whose dispersion the runs do not give",
    ),
    "undetermined": Column(
        "",
        "why the runs determine no curve, so that median and dispersion are empty; empty where "
        "they do",
    ),
}


def _in_units(name, meaning):
    """Columns of a table by the unit of each of INTENSITIES."""
    return {in_unit(name, column): Column(unit_of(column), meaning) for column in INTENSITIES}


FRAGILITY = {
    **CURVE,
    **_in_units("median", "intensity at which half of the runs exceed the level"),
    **_in_units("median_both_low", "lower bound of the median, strengths and records drawn anew"),
    **_in_units("median_both_high", "upper bound of the median, strengths and records drawn anew"),
    "dispersion_both_low": Column(
        "1", "lower bound of the dispersion, strengths and records drawn anew"
    ),
    "dispersion_both_high": Column(
        "1", "upper bound of the dispersion, strengths and records drawn anew"
    ),
    "fitted_both": Column(
        "1",
        "bootstrap samples that determine a curve; the others count as beyond the bounds, "
        "which are empty where 5 % or more do",
    ),
    **_in_units("median_new_record_low", "lower bound of a new record's own median"),
    **_in_units("median_new_record_high", "upper bound of a new record's own median"),
    "confidence": Column("1", "of the bounds"),
    "replicates": Column("1", "bootstrap samples that were drawn"),
    **SLIP,
}
_UNIT = "as `intensity_unit` says"
COEFFICIENTS = CURVE | {
    "level_unit": Column("", "unit of the level"),
    "intensity_unit": Column("", "unit of the median"),
    "distribution": Column(
        "",
        "lognormal: P = Phi(ln(x / median) / dispersion); step: the median is bounded, no "
        "dispersion is known; none: the runs determine no curve",
    ),
    "median": Column(_UNIT, "intensity at which half of the runs exceed the level"),
    "step_low": Column(_UNIT, "of a step: intensity up to which no run exceeds the level"),
    "step_high": Column(_UNIT, "of a step: intensity from which on all runs do"),
    "new_record_low": Column(_UNIT, "lower bound of a new record's own median"),
    "new_record_high": Column(_UNIT, "upper bound of a new record's own median"),
    "dispersion": Column("1", "standard deviation of the intensity's logarithm, empty of a step"),
    "common_median": Column(
        _UNIT, "median of the curve in NRML, which has one dispersion for the levels of a measure"
    ),
    "common_dispersion": Column("1", "that dispersion"),
}
AT = _STATE | {
    "value": Column("as `unit` says", "of the intensity"),
    "unit": Column("", "of the intensity"),
    "probability": Column("1", "of exceeding the level, by the curve through all records"),
    "mean_low": Column("1", "lower bound of it, strengths and records drawn anew"),
    "mean_high": Column("1", "upper bound of it, strengths and records drawn anew"),
    "new_record_low": Column("1", "lower bound of a new record's own probability"),
    "new_record_median": Column("1", "median of a new record's own probability"),
    "new_record_high": Column("1", "upper bound of a new record's own probability"),
    "new_record": Column(
        "1",
        "probability in a new record, averaged over what it may be; the mean may lie outside the "
        "bounds of its own probability",
    ),
    "undetermined": CURVE["undetermined"],
}
TABLES = {
    "summary.csv": COLUMNS | MEMBERS,
    "points.csv": POINTS,
    "fragility_INTENSITY.csv": FRAGILITY,
    "fragility_INTENSITY_at.csv": AT,
    "fragility_coefficients.csv": COEFFICIENTS,
}
"""{tables, as their files are called: {column: Column}}; `summary.csv` of `python3 -m damage
tables` has no members."""
