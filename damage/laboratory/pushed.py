"""Walls tested in a laboratory: their measured numbers beside those of a simulated wall.

EUCENTRE's in-plane cyclic tests (Graziotti et al. 2016), `damage/data/eucentre`.
"""

from dataclasses import dataclass

import numpy as np
import pandas as pd

from damage.errors import InputError
from damage.files import DATA
from damage.measure import pushed
from damage.measure.summary import summarise

TESTS = DATA / "eucentre" / "tests.csv"
SPECIMENS = {"squat": "COMP1_3", "squat_tested": "COMP1_3", "comp2_1": "COMP2_1", "comp2_3": "COMP2_3",
             "comp2_4": "COMP2_4"}
"""Name of a shipped wall -> the test that it models."""
MODES = {"F": "flexure", "S": "shear", "H-FS": "flexure and shear"}


@dataclass(frozen=True)
class LaboratoryTest:
    """Measured numbers of one wall; pairs are of the two directions of loading.

    peak_force_n, drift_at_peak, bilinear_force_n, elastic_drift, ultimate_drift: (positive, negative);
    drifts are ratios; first_crack: the drift at which one was seen, None where none was; mode: of MODES; height [m].
    """

    specimen: str
    mode: str
    height: float
    peak_force_n: tuple[float, float]
    drift_at_peak: tuple[float, float]
    bilinear_force_n: tuple[float, float]
    elastic_drift: tuple[float, float]
    ultimate_drift: tuple[float, float]
    first_crack: float | None

    @property
    def stiffness_n_per_m(self):
        """Of the bilinear idealisation, in both directions."""
        return tuple(force / (drift * self.height) for force, drift in zip(self.bilinear_force_n, self.elastic_drift))

    @property
    def energy_j(self):
        """Energy below the bilinear idealisation up to the ultimate drift, in both directions."""
        return tuple(force * (ultimate - elastic / 2) * self.height for force, elastic, ultimate in zip(
            self.bilinear_force_n, self.elastic_drift, self.ultimate_drift))

    def bilinear_curve(self, direction):
        """Drift ratios and forces [N] of the idealised envelope, (3,) each; direction 0 or 1."""
        force = self.bilinear_force_n[direction]
        return (np.array([0.0, self.elastic_drift[direction], self.ultimate_drift[direction]]),
                np.array([0.0, force, force]))


def read_test(specimen):
    """The LaboratoryTest of that name."""
    table = pd.read_csv(TESTS).set_index("Specimen")
    if specimen not in table.index:
        raise InputError(f"no test {specimen}; expected one of {', '.join(table.index)}")
    row = table.loc[specimen]

    def pair(name, unit, factor):
        return tuple(float(row[f"{name}{sign}_{unit}"]) * factor for sign in "+-")

    return LaboratoryTest(specimen, MODES[row["Failure mode"]], float(row["H_m"]), pair("Vmax", "kN", 1e3),
                          pair("dVmax", "pct", 0.01), pair("Vbil", "kN", 1e3), pair("de", "pct", 0.01),
                          pair("du", "pct", 0.01), 0.01 * row["dcr+_pct"] if np.isfinite(row["dcr+_pct"]) else None)


def test_of(history):
    """The LaboratoryTest that a run's wall models; InputError where it models none."""
    if history.wall not in SPECIMENS:
        raise InputError(f"{history.path}: wall {history.wall} models no test; expected one of {', '.join(SPECIMENS)}")
    return read_test(SPECIMENS[history.wall])


def beside_test(history):
    """Rows (figure, unit, simulated, measured) of a pushed laboratory wall; None where there is no figure."""
    test, summary, shares = test_of(history), summarise(history), pushed.mode_shares(history)
    curve = pushed.capacity_curve(history)
    line = pushed.bilinear(curve, history.attributes["drift_height_m"])
    crack = pushed.drift_at_first_crack(history)
    measured = {name: float(np.mean(getattr(test, name))) for name in (
        "stiffness_n_per_m", "peak_force_n", "drift_at_peak", "bilinear_force_n", "elastic_drift", "ultimate_drift",
        "energy_j")}
    reached = float(curve["drift_ratio"].max()) >= measured["ultimate_drift"]
    return [
        ("stiffness, initial", "kN/mm", summary["initial_stiffness_n_per_m"] / 1e6, None),
        ("stiffness, secant to 0.7 of the peak", "kN/mm", summary["secant_stiffness_n_per_m"] / 1e6,
         measured["stiffness_n_per_m"] / 1e6),
        ("peak force", "kN", summary["peak_force_n"] / 1e3, measured["peak_force_n"] / 1e3),
        ("drift at the peak force", "%", 100 * summary["drift_at_peak_force"], 100 * measured["drift_at_peak"]),
        ("bilinear force", "kN", line["force_n"] / 1e3, measured["bilinear_force_n"] / 1e3),
        ("mean force to the test's ultimate drift", "kN", pushed.mean_force(
            curve, measured["ultimate_drift"]) / 1e3 if reached else None,
         measured["energy_j"] / (measured["ultimate_drift"] * test.height) / 1e3),
        ("energy below the bilinear line", "J", line["energy_j"], measured["energy_j"]),
        ("elastic drift", "%", 100 * line["elastic_drift"], 100 * measured["elastic_drift"]),
        ("ultimate drift, or the largest", "%", 100 * line["ultimate_drift"], 100 * measured["ultimate_drift"]),
        ("drift at the first crack (of 0.1 mm)", "%", *(None if drift is None else 100 * drift
                                                        for drift in (crack, test.first_crack))),
        ("share of the slipped length on stairs", "1", shares["stair_share"], None),
        ("failure mode", "", shares["mode"], test.mode),
    ]


def pushed_report(history):
    """Everything about a pushed run as a plain dictionary: cycles, envelope, mode, and the test beside it."""
    height, sides = history.attributes["drift_height_m"], {}
    for name, sign in (("positive", 1), ("negative", -1)):
        curve = pushed.capacity_curve(history, sign)
        if len(curve) and curve["force_n"].max() > 0:
            sides[name] = pushed.bilinear(curve, height)
    cyclic = pushed.pushed_loading(history).cycles > 0
    return {"wall": history.wall, "solver": history.solver, "motion": history.loading.name,
            "status": history.status, "slip": history.judged_by("displacement"),
            "cycles": pushed.cycles_table(history).to_dict("records") if cyclic else [],
            "bilinear": sides, "first_crack_drift": pushed.drift_at_first_crack(history),
            "failure": pushed.mode_shares(history), "by_hand_n": pushed.hand_capacities(history),
            "beside_test": [dict(zip(("figure", "unit", "simulated", "measured"), row))
                            for row in beside_test(history)] if history.wall in SPECIMENS else None}


def describe(found):
    """A `pushed_report` as lines for people."""
    lines = [f"{found['wall']} / {found['motion']} / {found['solver']}: {found['status']}; slip by {found['slip']}"]
    if found["cycles"]:
        columns = ("amplitude_pct", "max_drift_pct", "min_drift_pct", "max_force_kn", "min_force_kn", "dissipated_j",
                   "equivalent_damping", "DI_at_max", "DI_at_min")
        lines.append("cycle  amplitude      drift [%]       force [kN]  lost [J]  damping [-]    DI at both ends")
        lines += ["{:5d}{:9g} %{:10.4f}{:9.4f}{:9.1f}{:8.1f}{:10.1f}{:12.3f}{:11.4f}{:8.4f}".format(
            row["cycle"], *(row[name] for name in columns)) for row in found["cycles"]]
    for side, line in found["bilinear"].items():
        lines.append(f"bilinear, {side}: {line['stiffness_n_per_m'] / 1e6:.1f} kN/mm, {line['force_n'] / 1e3:.1f} kN, "
                     f"to {100 * line['ultimate_drift']:.3f} % drift")
    failure = found["failure"]
    hand = ", ".join(f"{name.replace('_', ' ')} {force / 1e3:.0f}" for name, force in found["by_hand_n"].items())
    lines += [f"by hand [kN]: {hand}"] if hand else []
    lines.append(f"failure: {failure['mode']}; bed joints opened over {failure['opened_m']:.2f} m, slipped over "
                 f"{failure['slipped_m']:.2f} m, {100 * failure['stair_share']:.0f} % of that on stairs")
    if found["beside_test"]:
        lines.append(f"{'beside the test ' + SPECIMENS[found['wall']]:42s}{'simulated':>12s}{'measured':>12s}")
        lines += [f"{row['figure'] + (', ' + row['unit'] if row['unit'] else ''):42s}{_shown(row['simulated']):>12s}"
                  f"{_shown(row['measured']):>12s}" for row in found["beside_test"]]
    return "\n".join(lines)


def _shown(value):
    return "-" if value is None else value if isinstance(value, str) else f"{value:.3g}"
