"""Walls tested in a laboratory: their measured numbers beside those of a simulated wall.

EUCENTRE's in-plane cyclic tests (Graziotti et al. 2016), `damage/data/eucentre`.
"""

from collections import Counter
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pandas as pd

from damage.applications.cracks import capacity
from damage.applications.cracks.loops import LOOP, loops_at
from damage.errors import InputError
from damage.files import DATA
from damage.measure.pushed import first_loading, hand_capacities

TESTS = DATA / "eucentre" / "tests.csv"
TESTED = pd.read_csv(TESTS, float_precision="round_trip").set_index("Specimen")
"""The file's rows by specimen."""
SPECIMENS = {
    "squat": "COMP1_3",
    "squat_tested": "COMP1_3",
    **{name.lower(): name for name in TESTED.index},
}
"""Name of a wall -> the test that it models."""
MODES = {"F": "flexure", "S": "shear", "H-FS": "flexure and shear", "SL": "sliding"}
FIGURES = {
    "stiffness_n_per_m": ("stiffness, secant to 0.7 of the peak", "kN/mm", 1e6),
    "peak_force_n": ("peak force", "kN", 1e3),
    "drift_at_peak": ("drift at the peak force", "%", 0.01),
    "force_n": ("bilinear force", "kN", 1e3),
    "mean_force_n": ("mean force to {}", "kN", 1e3),
    "left_n": ("force left at {}", "kN", 1e3),
    "energy_j": ("energy below the bilinear line", "J", 1.0),
    "elastic_drift": ("elastic drift", "%", 0.01),
    "ultimate_drift": ("ultimate drift", "%", 0.01),
}
"""{figure of `capacity.capacity` and of a test: (words, unit, its size in SI)}; {}: a drift."""
MEASURED = {
    "peak_force_n": "Vmax{}_kN",
    "drift_at_peak": "dVmax{}_pct",
    "force_n": "Vbil{}_kN",
    "elastic_drift": "de{}_pct",
    "ultimate_drift": "du{}_pct",
}
"""{figure that was measured: its columns in the file}; {}: the direction, + or -."""


class LaboratoryTest(NamedTuple):
    """Measured numbers of one wall.

    directions: DataFrame with the columns of FIGURES, but left_n, a row for loading in positive and
    one for loading in negative direction; stiffness, energy and mean force are those of the
    bilinear idealisation; first_crack: the drift at which one was seen, None where none was; mode:
    of MODES.
    """

    specimen: str
    mode: str
    directions: pd.DataFrame
    first_crack: float | None

    @property
    def figures(self):
        """{name: mean over both directions} of FIGURES; at its ultimate drift 0.8 of the peak are
        left."""
        means = self.directions.mean().to_dict()
        return means | {"left_n": capacity.ULTIMATE_SHARE * means["peak_force_n"]}


def read_test(specimen):
    """The LaboratoryTest of that name."""
    if specimen not in TESTED.index:
        raise InputError(f"no test {specimen}; expected one of {', '.join(TESTED.index)}")
    row = TESTED.loc[specimen]
    height = row["H_m"]
    directions = pd.DataFrame(
        {
            name: [row[column.format(sign)] * FIGURES[name][2] for sign in "+-"]
            for name, column in MEASURED.items()
        }
    )
    force, elastic, ultimate = (
        directions[name] for name in ("force_n", "elastic_drift", "ultimate_drift")
    )
    energy = force * (ultimate - elastic / 2) * height
    return LaboratoryTest(
        specimen=specimen,
        mode=MODES[row["Failure mode"]],
        directions=directions.assign(
            stiffness_n_per_m=force / (elastic * height),
            energy_j=energy,
            mean_force_n=energy / ultimate / height,
        ),
        first_crack=0.01 * row["dcr+_pct"] if np.isfinite(row["dcr+_pct"]) else None,
    )


def _measured(history, to):
    """The LaboratoryTest that a run's wall models, its figures, and the drift [-] to which mean
    forces count: `to`, else that of the test; None and {} where there is no test."""
    if history.wall not in SPECIMENS:
        return None, {}, to
    test = read_test(SPECIMENS[history.wall])
    figures = test.figures
    own_drift = figures["ultimate_drift"]
    if to is not None and not np.isclose(to, own_drift, rtol=1e-3):
        del figures["mean_force_n"], figures["left_n"]
    return test, figures, own_drift if to is None else to


def _title(name, to):
    return FIGURES[name][0].format(
        "the ultimate drift" if to is None else f"{100 * to:.3g} % drift"
    )


def figures(history, to=None):
    """Rows (figure, unit, simulated, measured) of a pushed wall, means over the directions of
    loading; measured: of the test that it models; None where there is no figure.  to: the drift [-]
    of mean forces, None for the test's ultimate drift, without a test the run's."""
    test, measured, to = _measured(history, to)
    means = capacity.capacity(history, to)
    initial = first_loading(history)["initial_stiffness_n_per_m"]
    shares = means["failure"]
    over = "" if means["ended"] else ", not reached: over"
    rows = [("stiffness, initial", "kN/mm", initial and initial / 1e6, None)]
    for name, (_, unit, size) in FIGURES.items():
        title = _title(name, to) + over * (name == "ultimate_drift")
        values = means[name], measured.get(name)
        rows.append((title, unit, *(value and value / size for value in values)))
    cracks = capacity.drift_at_first_crack(history), test and test.first_crack
    return [
        *rows,
        ("drift at the first crack (of 0.1 mm)", "%", *(drift and 100 * drift for drift in cracks)),
        ("share of the slipped length on stairs", "1", shares["stair_share"], None),
        ("failure mode at the ultimate drift", "", shares["mode"], test and test.mode),
    ]


def pushed_report(history, to=None, tested_loops=()):
    """Everything about a pushed run as a plain dictionary: cycles, envelope, mode and `figures`;
    tested_loops: of `read_loops`, beside which energy and damping of the cycles are put."""
    height = history.attributes["drift_height_m"]
    table = capacity.cycles_table(history)
    means = capacity.capacity(history, to)
    if tested_loops and table.empty:
        raise InputError(
            f"{history.path} has no whole cycle to put beside a test; expected a run of --cyclic"
        )
    return {
        "wall": history.wall,
        "solver": history.solver,
        "motion": history.loading.name,
        "status": history.status,
        "slip": "displacement",
        "test": SPECIMENS.get(history.wall),
        "cycles": table.to_dict("records"),
        "tested_loops": [_beside(table, loop) for loop in tested_loops],
        "bilinear": {
            side: capacity.bilinear(curve, height)
            for side, curve in capacity.loaded_curves(history).items()
        },
        "ultimate_drift_note": means["ultimate_drift_note"],
        "first_crack_drift": capacity.drift_at_first_crack(history),
        "failure": means["failure"],
        "by_hand_n": hand_capacities(history.masonry_wall, history.loading.boundary),
        "figures": [
            dict(zip(("figure", "unit", "simulated", "measured"), row))
            for row in figures(history, to)
        ],
    }


def _beside(table, loop):
    """A tested loop with what the cycles of a run have at the same half of the range of drift."""
    reach = (loop["max_drift_pct"] - loop["min_drift_pct"]) / 2
    energy, damping = loops_at(table, reach)
    return loop | {"run_dissipated_j": energy, "run_equivalent_damping": damping}


def drawn_range(values):
    """5 %, 50 % and 95 % quantiles of draws, by Weibull's plotting position k / (n + 1): a further
    draw lies in the 90 % between with that probability from n = 19 on.

    >>> drawn_range(range(1, 20))
    [1.0, 10.0, 19.0]
    """
    return np.quantile(values, (0.05, 0.5, 0.95), method="weibull").tolist()


def _common(history):
    """What draws of a wall share: all of it where its inputs are given, else its shape; push, model
    and solver."""
    wall = history.masonry_wall
    shape = wall.name, wall.length, wall.height, wall.openings, wall.outline
    return (
        wall if history.model.inputs == "given" else shape,
        capacity.pushed_loading(history),
        replace(history.model, strength_seed=0),
        history.solver,
    )


def draws_report(histories, to=None):
    """Medians and quantiles of the `figures` of several draws of a wall, a plain
    dictionary.

    Raises InputError where runs are not of one wall and one push, or a draw is there twice."""
    first = histories[0]
    drawn = {}
    for history in histories:
        if _common(history) != _common(first):
            raise InputError(
                f"{history.path}: another wall, push or model than {first.path}; expected draws of"
                " one, which differ in --strength-seed alone; leave it out"
            )
        model = history.model
        seeds = history.parameters
        draw = (model.draws and model.strength_seed, seeds.get("scatter") and seeds.get("seed"))
        if draw in drawn:
            raise InputError(
                f"{history.path}: the same draw of the wall as {drawn[draw]}; expected "
                "--strength-cov or --inputs, and another --strength-seed; leave one out"
            )
        drawn[draw] = history.path
    test, measured, to = _measured(first, to)
    draws = [capacity.capacity(history, to) for history in histories]
    rows = []
    for name, (_, unit, size) in FIGURES.items():
        values = [draw[name] / size for draw in draws if draw[name] is not None]
        whole = len(values) == len(draws)
        low, middle, high = drawn_range(values) if whole else [None] * 3
        rows.append(
            {
                "figure": _title(name, to),
                "unit": unit,
                "median": middle,
                "quantile_05": low,
                "quantile_95": high,
                "measured": measured.get(name) and measured[name] / size,
                "draws_needed": capacity.draws_needed(values) if whole else None,
            }
        )
    return {
        "wall": first.wall,
        "motion": first.loading.name,
        "draws": len(draws),
        "test": test and test.specimen,
        "figures": rows,
        "ultimate_drift_note": draws[0]["ultimate_drift_note"],
        "not_ended": sum(not draw["ended"] for draw in draws),
        "failure": dict(Counter(draw["failure"]["mode"] or "none" for draw in draws).most_common()),
        "failure_measured": test and test.mode,
    }


def describe_draws(report):
    """A `draws_report` as lines for people."""
    lines = [
        f"{report['wall']} / {report['motion']}: {report['draws']} draws",
        f"{'':42s}{'median':>10s}{'5 %':>10s}{'95 %':>10s}{'measured':>10s}{'draws needed':>14s}",
    ]
    lines += [
        f"{row['figure'] + ', ' + row['unit']:42s}"
        + "".join(
            f"{_shown(row[name]):>10s}"
            for name in ("median", "quantile_05", "quantile_95", "measured")
        )
        + f"{_shown(row['draws_needed']):>14s}"
        + _note(report, row)
        for row in report["figures"]
    ]
    lines.append(
        "failure mode at the ultimate drift: "
        + ", ".join(f"{mode} in {count}" for mode, count in report["failure"].items())
        + (f"; in the test {report['failure_measured']}" if report["failure_measured"] else "")
    )
    if report["not_ended"]:
        lines.append(
            f"{report['not_ended']} of {report['draws']} kept 0.8 of the peak to the end: their"
            " ultimate drift is the largest one"
        )
    return "\n".join([*lines, "draws needed: for the median within 5 %"])


def describe(report):
    """A `pushed_report` as lines for people."""
    lines = [
        f"{report['wall']} / {report['motion']} / {report['solver']}: {report['status']}; slip by"
        f" {report['slip']}"
    ]
    if report["cycles"]:
        lines += [
            "cycles",
            *_loop_lines(report["cycles"], "amplitude_pct", "DI_at_max", "DI_at_min"),
        ]
    if report["tested_loops"]:
        more = "run_dissipated_j", "run_equivalent_damping"
        lines += ["loops of the test", *_loop_lines(report["tested_loops"], "loop", *more)]
    for side, line in report["bilinear"].items():
        lines.append(
            f"bilinear, {side}: {line['stiffness_n_per_m'] / 1e6:.1f} kN/mm,"
            f" {line['force_n'] / 1e3:.1f} kN, to an ultimate drift of"
            f" {100 * line['ultimate_drift']:.3f} % ({report['ultimate_drift_note']})"
        )
    failure = report["failure"]
    hand = ", ".join(
        f"{name.replace('_', ' ')} {force / 1e3:.0f}" for name, force in report["by_hand_n"].items()
    )
    lines += [f"by hand [kN]: {hand}"] if hand else []
    lines.append(
        f"failure at the ultimate drift: {failure['mode']}; bed joints opened over "
        f"{failure['opened_m']:.2f} m, slipped over {failure['slipped_m']:.2f} m, "
        f"{100 * failure['stair_share']:.0f} % of that on stairs"
    )
    lines.append(
        f"{'beside the test ' + report['test'] if report['test'] else '':42s}{'simulated':>12s}"
        + f"{'measured':>12s}" * bool(report["test"])
    )
    lines += [
        f"{', '.join(filter(None, (row['figure'], row['unit']))):42s}"
        f"{_shown(row['simulated']):>12s}"
        + f"  {_shown(row['measured']):>10s}" * bool(report["test"])
        + _note(report, row)
        for row in report["figures"]
    ]
    return "\n".join(lines)


def _note(report, row):
    """The end of the line of a row of figures of a report: of the ultimate drift how far it was
    off."""
    is_ultimate = row["figure"].startswith("ultimate drift")
    return f"  ({report['ultimate_drift_note']})" * is_ultimate


def _loop_lines(rows, label, *more):
    """Lines of loops: label, the columns of LOOP with their units, and more columns."""
    table = pd.DataFrame(rows)[[label, *LOOP, *more]]
    return table.to_string(index=False, float_format="{:.4g}".format).splitlines()


def describe_loops(report):
    """Loops of `read_loops` as lines for people."""
    return "\n".join(_loop_lines(report, "loop"))


def _shown(value):
    return "-" if value is None else f"{value:.3g}" if isinstance(value, float) else str(value)
