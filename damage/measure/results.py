"""The results of a run for people: on the screen, in a report, of its members, and of the walls and
corners of a house.

Each result has one label, one unit and one denominator everywhere.
"""

from typing import NamedTuple

import pandas as pd

from damage.units import rounded

SCALES = (
    "DI says how much of the wall moved, crack width and Psi say how visible its cracks are: a high"
    " DI may go with light cracks."
)
"""Which scale answers which question."""


class Result(NamedTuple):
    """How a result is shown.

    unit: of its values times factor; digits: how many significant ones are known, 0 of a count,
    None for three decimals; remark: what a share is of, or what else belongs to the value, a
    template of what `summarise` returns.
    """

    label: str
    unit: str = ""
    digits: int | None = None
    remark: str = ""
    factor: float = 1.0

    @property
    def heading(self):
        """The label with its unit, as a column has it."""
        return f"{self.label} [{self.unit}]" if self.unit else self.label

    def shown(self, value):
        """A value as text, without more digits than are known."""
        if value is None or value != value:
            return "-"
        number = self.factor * value
        if self.digits is None:
            return f"{number:.3f}"
        return rounded(number, self.digits) if self.digits else f"{number:.0f}"


RESULTS = {
    "max_DI": Result("DI", remark="of 1"),
    "max_DI_drift": Result("DI_drift", remark="of a drift ratio of {drift_limit_pct:g} %"),
    "max_DI_open": Result("DI_open", remark="of the joint length, opened by {threshold_mm:g} mm"),
    "max_DI_slip": Result(
        "DI_slip", remark="of the joint length, slipped by {threshold_mm:g} mm, by {slip}"
    ),
    "max_drift_ratio": Result("drift ratio", "%", 3, "of the height", 100.0),
    "max_drift_across_ratio": Result("drift ratio across", "%", 3, "of the height", 100.0),
    "max_crack_width_mm": Result("widest crack", "mm", 2, "{crack_width_class} (Burland)"),
    "max_psi": Result(
        "Psi", digits=2, remark="{psi_class} (Korswagen), cracks from {psi_from_mm:g} mm"
    ),
    "max_crack_width_outside_mm": Result("widest crack outside", "mm", 2),
    "max_crack_width_inside_mm": Result("widest crack inside", "mm", 2),
    "max_psi_outside": Result("Psi outside", digits=2),
    "max_psi_inside": Result("Psi inside", digits=2),
    "failed": Result(
        "failed contact points",
        digits=0,
        remark="of {contact_points}: {tension_breaks} in tension, {shear_breaks} in shear",
    ),
    "ended_joints": Result("ended joints", digits=0, remark="whose faces no longer overlap"),
    "max_opening_mm": Result("opening", "mm", 2),
    "max_offset_mm": Result("offset", "mm", 2),
    "max_slip_mm": Result("accumulated slip", "mm", 2),
    "peak_base_shear_n": Result("base shear", "kN", 3, "{whole}", 1e-3),
    "peak_force_n": Result("force on the top", "kN", 3, "", 1e-3),
    "peak_force_wave_n": Result(
        "its wave", "kN", 2, "by which the peak depends on the speed", 1e-3
    ),
    "drift_at_peak_force": Result("drift ratio there", "%", 3, "of the height", 100.0),
    "initial_stiffness_n_per_m": Result("stiffness at first", "kN/mm", 3, "", 1e-6),
    "secant_stiffness_n_per_m": Result("stiffness", "kN/mm", 3, "to 0.7 of the peak", 1e-6),
    "input_energy_j": Result("supplied energy", "J", 2, "{whole}"),
    "dissipated_energy_j": Result("dissipated energy", "J", 2, "by friction and fracture {whole}"),
    "energy_error_fraction": Result(
        "energy balance error", "%", None, "of the input {whole}", 100.0
    ),
    "period_s": Result("free vibration", "s", 4, "a period"),
    "first_free_cycle_s": Result(
        "first free cycle", "s", 3, "{period_elongation:.2f} of the intact wall's period"
    ),
    "angular_distortion": Result("angular distortion", digits=3, remark="of the settlement"),
    "deflection_ratio": Result("deflection ratio", digits=3, remark="of the settlement"),
    "relative_settlement_mm": Result("relative settlement", "mm", 2),
    "settled_crack_width_mm": Result("settled, widest crack", "mm", 2, "before the motion"),
    "settled_psi": Result("settled, Psi", digits=2, remark="before the motion"),
    "settled_DI": Result("settled, DI", remark="of 1, before the motion"),
    "max_base_translation_mm": Result("base translation", "mm", 2, "not in the drift"),
    "max_base_rotation_rad": Result("base rotation", "mrad", 2, "not in the drift", 1e3),
    "pgv_m_s": Result("PGV", "cm/s", 3, "of the motion as applied", 100.0),
    "elastic_joint_share": Result("elastic joints", "%", 2, "of the joint length", 100.0),
    "elastic_joint_share_above_openings": Result(
        "elastic above openings", "%", 2, "of the joint length there", 100.0
    ),
}
"""{column of summary.csv, the largest over the run: Result}, in the order of the screen."""
KEY = (
    "max_DI",
    "residual_DI",
    "max_drift_ratio",
    "max_crack_width_mm",
    "residual_crack_width_mm",
    "max_psi",
    "peak_base_shear_n",
)
"""What one asks first."""
WALLS = (
    "max_DI",
    "residual_DI",
    "max_drift_ratio",
    "max_drift_across_ratio",
    "max_psi_outside",
    "max_psi_inside",
    "max_crack_width_outside_mm",
    "max_crack_width_inside_mm",
)
"""Columns of the table of a house's walls."""
CORNERS = {
    "max_opening_mm": RESULTS["max_opening_mm"],
    "residual_opening_mm": Result("residual opening", "mm", 2),
    "max_offset_mm": RESULTS["max_offset_mm"],
    "failed_share": Result("failed contact points", "%", 3, "", 100.0),
}
"""Results of the corners of a house, {key of `damage.measure.house.house_summary`: Result}."""


def result_of(column):
    """The Result of a column, at the end of a run where it is a residual."""
    result = RESULTS[column.replace("residual_", "max_", 1)]
    return result._replace(label=f"residual {result.label}") if column[0] == "r" else result


EVENTS = {
    "factor": Result("factor", digits=3),
    **{name: result_of(name) for name in ("max_psi", "residual_psi", "max_DI", "residual_DI")},
    "offset_before_mm": Result("offset before", "mm", 2),
    "offset_after_mm": Result("offset after", "mm", 2),
    "newly_failed": Result("newly failed contact points", digits=0),
}
"""Columns of the table of a sequence's events."""


def value_in(summary, column):
    """The value of a column in a result of `summarise`; None where there is none."""
    kind, _, component = column.partition("_")
    index = kind in ("max", "residual") and summary.get(kind)
    return (index or {}).get(component, summary.get(column))


def line_of(result, value, residual=None, known=None):
    """A Result as a line for people: label, value, residual, unit, and what it is of, with what
    else is known of the run."""
    rest = "" if residual is None else result.shown(residual)
    unit = " ".join(filter(None, (result.unit, result.remark.format(**known or {"whole": ""}))))
    return f"{result.label:22s}{result.shown(value):>9s} {rest:>9s}  {unit}".rstrip()


def lines_of(summary):
    """The results of a run as lines for people."""
    known = summary | {
        "whole": "" if summary["max_across_mm"] is None else "of the whole house",
        "failed": summary["tension_breaks"] + summary["shear_breaks"],
        "ended_joints": summary["ended_joints"] or None,
    }
    lines = [SCALES, f"{'':22s}{'maximum':>9s} {'residual':>9s}"]
    for column, result in RESULTS.items():
        if (value := value_in(known, column)) is not None:
            at_end = column.replace("max_", "residual_", 1)
            residual = None if at_end == column else value_in(known, at_end)
            lines.append(line_of(result, value, residual, known))
    return lines


def table_of(rows, results):
    """Lines of a table for people: rows {name: {column: value}}; results: {column: Result}."""
    shown = {
        name: {result.heading: result.shown(values[column]) for column, result in results.items()}
        for name, values in rows.items()
    }
    return pd.DataFrame.from_dict(shown, orient="index").to_string().splitlines()
