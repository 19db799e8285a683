"""Columns of the tables of studies and of fragility, for the data dictionary."""

from damage.applications.studies.after_damage import BEFORE
from damage.applications.studies.fragility import OVER
from damage.applications.studies.states import INTENSITIES, LEVELS, unit_of
from damage.history.schema import Column, each
from damage.measure.columns import MADE_BY, PARAMETERS, RUN
from damage.measure.damage_index import SLIP
from damage.measure.summary import MEASURES

RUNS = {
    name: column
    for table in (PARAMETERS, RUN, MADE_BY, *MEASURES.values())
    for name, column in each(table).items()
}
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
        for table in MEASURES.values()
        for name, column in each(table).items()
    },
    **{
        f"{name}_{end}": column._replace(meaning=f"{words} of the runs of `{name}`")
        for table in MEASURES.values()
        for name, column in each(table).items()
        if column.unit
        for end, words in (("min", "least"), ("max", "largest"))
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
ENDS = ("low", "lower"), ("high", "upper")
UNITS = dict([unit_of(name) for name in INTENSITIES])
FRAGILITY = {
    **CURVE,
    **{
        f"median_{name}": Column(unit, "intensity at which half of the runs exceed the level")
        for name, unit in UNITS.items()
    },
    **{
        f"median_{over}_{end}_{name}": Column(
            unit, f"{words} bound of the median, {over} drawn anew"
        )
        for over in OVER
        for end, words in ENDS
        for name, unit in UNITS.items()
    },
    **{
        f"dispersion_{over}_{end}": Column(
            "1", f"{words} bound of the dispersion, {over} drawn anew"
        )
        for over in OVER
        for end, words in ENDS
    },
    **{
        f"fitted_{over}": Column(
            "1",
            f"bootstrap samples that determine a curve, {over} drawn anew; the others count "
            "as beyond the bounds, which are empty where 5 % or more do",
        )
        for over in OVER
    },
    **{
        f"median_new_record_{end}_{name}": Column(
            unit, f"{words} bound of a new record's own median"
        )
        for end, words in ENDS
        for name, unit in UNITS.items()
    },
    "confidence": Column("1", "of the bounds"),
    "replicates": Column("1", "bootstrap samples that were drawn"),
    **SLIP,
}
AFTER_DAMAGE = FRAGILITY.copy()
del AFTER_DAMAGE["slip"]
AFTER_DAMAGE["before"] = Column("", f"damage at rest before the shock: {', '.join(BEFORE)}, more")
_VALUE = _STATE | {
    "value": Column("as `unit` says", "of the intensity"),
    "unit": Column("", "of the intensity"),
}
AT = _VALUE | {
    "probability": Column("1", "of exceeding the level, by the curve through all records"),
    **{
        f"mean_{end}": Column("1", f"{words} bound of it, strengths and records drawn anew")
        for end, words in ENDS
    },
    "new_record": Column("1", "probability in a new record, averaged over what it may be"),
    **{
        f"new_record_{end}": Column("1", f"{words} bound of a new record's own probability")
        for end, words in ENDS
    },
    "undetermined": CURVE["undetermined"],
}
LEFT_OUT = _VALUE | {
    "record": Column("", "record that the curves do not know"),
    "runs": Column("1", "runs of it at this value"),
    "exceeding": Column("1", "runs of these that exceed the level"),
    "observed": Column("1", "their share"),
    "pooled": Column("1", "probability by the curve through all other records"),
    "predicted": Column("1", "probability in a new record, after the other records"),
    **{
        end: Column("1", f"{words} bound of the share of as many runs in a new record")
        for end, words in ENDS
    },
    "inside": Column("1", "1 where the observed share lies between the bounds, else 0"),
    **{
        f"{name}_{end}": Column("as `unit` says", f"{words} bound of {of}")
        for name, of in (
            (
                "own_median",
                (
                    "the record's median: equal where it is known, of a step its two intensities, 0"
                    " or inf where all or no runs exceed"
                ),
            ),
            ("median", "a new record's own median, after the other records"),
        )
        for end, words in ENDS
    },
    "median_inside": Column(
        "1",
        "share of ln(own median) between the latter: 0 or 1 where it is known, empty where it "
        "may lie on either side",
    ),
}
SCORES = _STATE | {
    "records": Column("1", "records that are compared"),
    "runs": Column("1", "runs that are compared"),
    "compared": Column("1", "shares, one for each record and value"),
    "inside": Column("1", "shares of these that lie between their bounds"),
    "medians": Column("1", "records whose own median can be compared"),
    "medians_inside": Column(
        "1", "how many of these lie in the interval for a new record; a step counts in part"
    ),
    **{
        f"{score}{ending}": Column("1", f"mean {words} of {of}")
        for ending, of in (
            ("", "the prediction for a new record"),
            ("_pooled", "the curve through all other records"),
        )
        for score, words in (("brier", "Brier score"), ("log_score", "logarithmic score"))
    },
}
EFFICIENCY = {
    **CURVE,
    "scatter": Column("1", "standard deviation of ln(measure) about a line over ln(intensity)"),
    "median": Column("as `unit` says", "intensity at which half of the runs exceed the level"),
    "unit": Column("", "of the median"),
}

TABLES = {
    "summary.csv, study.h5 runs": RUNS | MEMBERS,
    "points.csv, study.h5 points": POINTS,
    "fragility_INTENSITY.csv": FRAGILITY,
    "fragility_after_damage_INTENSITY.csv": AFTER_DAMAGE,
    "fragility_INTENSITY_at.csv": AT,
    "efficiency.csv": EFFICIENCY,
    "left_out.csv, unseen.csv": LEFT_OUT,
    "left_out_scores.csv, unseen_scores.csv": SCORES,
}
"""{tables, as their files are called: {column: Column}}; `summary.csv` of `python3 -m damage
tables` has no members."""
