"""The verdict on the paper: each of its claims compared with the tables of studies.

`paper.criteria` says what is claimed and when it holds, `paper.evidence` picks the runs, and here
one small function a claim decides, by how much its value is inside of its criterion or outside
(`margins`).  A claim `holds`, `differs`, or `cannot be judged`, for each solver, lintel and slip
criterion on its own.
"""

import math
from dataclasses import dataclass

import numpy as np

from damage.errors import InputError
from damage.measure.damage_index import CRITERIA
from damage.motion.formats import read_record, shipped_record_path
from damage.motion.intensity import pga_g, response_spectrum
from paper import criteria
from paper.criteria import AMPLITUDES_G, CLAIMS, SCALES, Claim
from paper.evidence import MODELS, Evidence, Fell, NotThere, comparable, gather, load_runs
from paper.margins import EDGE, above, at_least, at_most, within

HOLDS = "holds"
DIFFERS = "differs"
UNJUDGED = "cannot be judged"
IN_PART = "in part"
SOLVERS = ("yade", "reference")
RECORD_NAMES = {"zeerijp": "BGAR_HGE", "huizinge": "MID1_N_synthetic"}
"""The shipped records; the second is synthetic."""


@dataclass(frozen=True)
class Finding:
    """Finding of one solver on one claim with one lintel and one slip criterion; model: one of
    MODELS."""

    claim: Claim
    solver: str
    lintel: str
    slip: str
    value: str
    verdict: str
    margin: float | None = None
    """Margin of the criterion, as a share of its limit, below zero outside; None where nothing
    could be compared."""
    model: str = ""

    @property
    def source(self):
        """Solver and model, a pair."""
        return self.solver, self.model

    @property
    def on_edge(self):
        """Whether the verdict is borderline: a change of 5 % of the limit would reverse it."""
        return self.margin is not None and abs(self.margin) <= EDGE


def judge(folder):
    """Findings on all claims from the tables below `folder`, in the order of the claims.

    Raises InputError where there is no table of a study.
    """
    runs = load_runs(folder)
    records = shipped_records()
    of = {model: comparable(runs, changes) for model, changes in MODELS.items()}
    of = {
        (solver, model): mine
        for solver in SOLVERS
        for model, those in of.items()
        if len(mine := those[those["solver"] == solver])
    }
    if not of:
        raise InputError(
            f"{folder}: its tables hold no complete run with the default model; expected the"
            " results of studies, as ./run_all.sh harmonic writes them"
        )
    points = {source: gather(mine) for source, mine in of.items()}
    return [
        _finding(claim, solver, Evidence(mine, points[solver, model], lintel, slip, records), model)
        for claim in CLAIMS
        for (solver, model), mine in of.items()
        for lintel in _lintels(mine, every=not model)
        for slip in CRITERIA
    ]


def judge_with(solver, evidence):
    """Findings on all claims by each piece of Evidence of one solver."""
    return [_finding(claim, solver, one) for claim in CLAIMS for one in evidence]


def shipped_records():
    """{name: Record} of the paper's two."""
    return {
        name: read_record(shipped_record_path(shipped)) for name, shipped in RECORD_NAMES.items()
    }


def _lintels(runs, every):
    """The lintels to judge: of all courses, of every number that some runs have, of none; not
    every: those that some runs of walls with openings have."""
    some = set(runs.loc[runs["wall"] != "solid", "lintel"].dropna())
    numbers = map(str, sorted((int(lintel) for lintel in some if lintel.isdigit()), reverse=True))
    return [lintel for lintel in ("elastic", *numbers, "none") if every or lintel in some]


def _finding(claim, solver, evidence, model=""):
    margin = None
    try:
        value, margin = JUDGES[claim.id](evidence)
        verdict = HOLDS if margin >= 0 else DIFFERS
    except Fell as fell:
        value = str(fell)
        verdict = DIFFERS
    except NotThere as missing:
        value = str(missing)
        verdict = UNJUDGED
    return Finding(
        claim=claim,
        solver=solver,
        lintel=evidence.lintel,
        slip=evidence.slip,
        value=value,
        verdict=verdict,
        margin=margin,
        model=model,
    )


def statement_verdict(findings):
    """One verdict of the findings on a statement's claims: of those that could be judged, all, none
    or some hold."""
    judged = {finding.verdict for finding in findings} - {UNJUDGED}
    return UNJUDGED if not judged else judged.pop() if len(judged) == 1 else IN_PART


# --- judges: each returns what we find, in words, and the margin of its criterion -----------------


def _period(wall, paper_s):
    def judged(evidence):
        ours = evidence.period_s(wall)
        return f"{ours:.4f} s", _near(ours, paper_s, criteria.PRINTED_TOLERANCE)

    return judged


def _near(value, target, share):
    return within(value, target, share * target)


def _all_at_most(limit, wall, periods_s, needs, kind="max"):
    """The index stays at or below a limit in every motion of these periods; needs: (period,
    amplitude) pairs."""

    def judged(evidence):
        column = evidence.column(kind, "DI")
        points = [
            point for period in periods_s for point in evidence.harmonic(wall, period).values()
        ]
        if not points:
            raise NotThere(f"no harmonic run of the {wall} wall")
        worst = max(points, key=lambda point: point.value(column))
        text = f"{_number(worst, column)} at most, {worst.label}; {len(points)} motions"
        margin = at_most(worst.value(column), limit)
        for period, amplitude in needs if margin >= 0 else ():
            evidence.harmonic_at(wall, period, [amplitude])
        return text, margin

    return judged


def _number(point, column):
    """The median with, in brackets, the range over a point's members."""
    spread = point.spread(column)
    text = f"{point.plain(column):.3f}"
    return text if spread is None else f"{text} ({spread[0]:.3f} to {spread[1]:.3f})"


def _of_one_point(kind, component, margin, find, *where):
    """The margin of one value of the index; find, where: a method of Evidence and what it takes."""

    def judged(evidence):
        [point] = find(evidence, *where)
        column = evidence.column(kind, component)
        return _number(point, column), margin(point.value(column))

    return judged


def _of_points(kind, component, margin, find, *where):
    """Finding on the values of several points."""

    def judged(evidence):
        column = evidence.column(kind, component)
        values = [point.value(column) for point in find(evidence, *where)]
        return listed(values), margin(values)

    return judged


def _close_to(target):
    return lambda di: within(di, target, criteria.DI_TOLERANCE)


def listed(values, digits=3, unit=""):
    return ", ".join(f"{value:.{digits}f}" for value in values) + unit


def _rises(values, factor=criteria.GROWS):
    """Each value is at least this multiple of the one before."""
    return min(
        (at_least(value, factor * before) for before, value in zip(values[:-1], values[1:])),
        default=math.inf,
    )


def _cycle_by_cycle(period_s, amplitude_g, margin):
    def judged(evidence):
        [point] = evidence.harmonic_at("symmetric", period_s, [amplitude_g])
        cycles = point.cycles(evidence.column("max", "DI"))
        return listed(cycles), margin(cycles)

    return judged


def _first_is_not_exceeded(cycles):
    return min(
        (at_most(cycle, criteria.NOT_EXCEEDED * cycles[0]) for cycle in cycles[1:]),
        default=math.inf,
    )


def _asymmetric_is_similar(evidence):
    column = evidence.column("max", "DI")
    pairs = []
    margins = [math.inf]
    apart = []
    for period in criteria.PERIODS_S:
        symmetric, asymmetric = (
            evidence.harmonic(wall, period) for wall in ("symmetric", "asymmetric")
        )
        for amplitude in sorted(symmetric.keys() & asymmetric.keys()):
            both = symmetric[amplitude].value(column), asymmetric[amplitude].value(column)
            pairs.append(both)
            margins.append(
                at_most(max(both), max(criteria.SLIGHT_DI, criteria.SIMILAR * min(both)))
            )
            if margins[-1] < 0:
                apart.append(f"{both[1]:.3f} against {both[0]:.3f} at {symmetric[amplitude].label}")
    if apart:
        return "; ".join(apart), min(margins)
    for period, amplitude in ((0.2, 0.1), (0.33, 0.05)):
        evidence.harmonic_at("asymmetric", period, [amplitude])
        evidence.harmonic_at("symmetric", period, [amplitude])
    factors = [max(both) / min(both) for both in pairs if max(both) > criteria.SLIGHT_DI]
    return (
        f"{len(pairs)} motions, up to a factor of {max(factors, default=1.0):.2f} where not slight",
        min(margins),
    )


def _linear(period_s, amplitudes_g):
    def judged(evidence):
        column = evidence.column("max", "DI")
        values = [
            point.value(column)
            for point in evidence.harmonic_at("symmetric", period_s, amplitudes_g)
        ]
        r2 = _r_squared(amplitudes_g, values)
        return f"R² {r2:.4f} of {listed(values)}", _is_linear(r2)

    return judged


def _r_squared(x, y):
    """Share of the variance of y (n,) that a straight line of x (n,) explains, by least squares."""
    return float(np.corrcoef(x, y)[0, 1] ** 2) if np.ptp(y) > 0 else 1.0


def _is_linear(r2):
    """The margin of R², by the share of the variance that it leaves unexplained."""
    return at_most(1 - r2, 1 - criteria.LINEAR_R2)


HIGHER_G = AMPLITUDES_G[2:]
"""The amplitudes of P10 [g]."""


def _substantially_higher(evidence):
    column = evidence.column("max", "DI")
    ratios = []
    for amplitude in HIGHER_G:
        [at_resonance] = evidence.harmonic_at("symmetric", 0.2, [amplitude])
        evidence.harmonic_at("symmetric", 0.33, [amplitude])
        others = [
            points[amplitude]
            for period in criteria.PERIODS_S
            if period != 0.2
            if amplitude in (points := evidence.harmonic("symmetric", period))
        ]
        ratios.append(at_resonance.value(column) / max(point.value(column) for point in others))
    return f"ratios {listed(ratios, 2)}", at_least(min(ratios), criteria.SUBSTANTIALLY_HIGHER)


def _same(values):
    return at_most(float(np.ptp(values)), criteria.SAME_VALUES * float(np.mean(values)))


def _residual_cracks(evidence):
    points = evidence.harmonic_at("symmetric", 0.2, [0.05, 0.075])
    whole, drift = (
        [point.value(evidence.column("residual", name)) for point in points]
        for name in ("DI", "DI_drift")
    )
    return f"{listed(whole)}, of drift {listed(drift)}", min(
        min(above(di, criteria.NEGLIGIBLE_DI), at_most(of_drift, criteria.MOSTLY_CRACKS * di))
        for di, of_drift in zip(whole, drift)
    )


def _cycle_lengths(column, cycles, margin):
    def judged(evidence):
        points = evidence.harmonic_at("symmetric", 0.2, AMPLITUDES_G, cycles)
        lengths = [point.value(column) for point in points]
        return listed(lengths, 3, " s"), margin(lengths)

    return judged


def _lengthen(lengths):
    return min(
        _rises(lengths, criteria.NOT_FALLING),
        at_least(lengths[-1], criteria.ELONGATION * lengths[0]),
    )


def _as_in_figure_9(lengths):
    return min(
        _near(ours, paper, criteria.PRINTED_TOLERANCE)
        for ours, paper in zip(lengths, criteria.CYCLE_LENGTHS_S)
    )


def _of_the_record(name, measure, target, share):
    def judged(evidence):
        record = evidence.records[name]
        ours = float(measure(record))
        synthetic = ", synthetic" if "synthetic" in record.name else ""
        return f"{ours:.3f} g ({record.name}{synthetic})", _near(ours, target, share)

    return judged


def _at_0_2_s(record):
    return response_spectrum(record, [0.2])[0]


def _scales_were_run(evidence):
    counts = [len(set(SCALES) & evidence.shaken(name).keys()) for name in RECORD_NAMES]
    text = ", ".join(
        f"{count} of {len(SCALES)} with {name}" for name, count in zip(RECORD_NAMES, counts)
    )
    if min(counts) < len(SCALES):
        raise NotThere(text)
    return text, math.inf


def _cracks_without_drift(record):
    def judged(evidence):
        points = evidence.shaken(record).values()
        whole, drift = (evidence.column("residual", name) for name in ("DI", "DI_drift"))
        largest_drift = max((point.value(drift) for point in points), default=0.0)
        text = f"DI_drift at most {largest_drift:.4f}"
        margin = at_most(largest_drift, criteria.INSIGNIFICANT_DI_DRIFT)
        if margin < 0:
            return text, margin
        [strongest] = evidence.shaken_at(record, [2.0])
        text += f", DI {_number(strongest, whole)} at twice the record"
        return text, min(margin, above(strongest.value(whole), criteria.NEGLIGIBLE_DI))

    return judged


def _ida_points(evidence, column):
    """Maximum drift ratios and an index of all scaled records, both (n,)."""
    points = [point for name in RECORD_NAMES for point in evidence.shaken(name).values()]
    if len(points) < criteria.FEWEST_POINTS:
        raise NotThere(f"{len(points)} runs with records")
    return (
        np.array([point.value(name) for point in points]) for name in ("max_drift_ratio", column)
    )


def _maximum_is_linear(evidence):
    drift, index = _ida_points(evidence, evidence.column("max", "DI"))
    r2 = _r_squared(drift, index)
    return f"R² {r2:.4f}, {len(drift)} runs", _is_linear(r2)


def _residual_levels_off(evidence):
    drift, index = _ida_points(evidence, evidence.column("residual", "DI"))
    slope = np.polyder(np.polyfit(drift, index, 2))
    first, last = np.polyval(slope, [drift.min(), drift.max()])
    text = f"slope {first / 100:.3f}, then {last / 100:.3f} per % of drift, {len(drift)} runs"
    return text, min(above(first, 0.0), at_most(last, criteria.PLATEAU * first))


def _no_damping(evidence):
    rows = evidence.runs
    rows = rows[
        rows["lintel"].eq(evidence.lintel)
        & (rows["input_energy_j"] > 0)
        & (rows["beta_s"].fillna(0) == 0)
        & (rows["motion_period_s"].notna() | rows["scale"].notna())
    ]
    rows = rows[rows[["damping_energy_j", "energy_error_fraction"]].notna().all(axis=1)]
    if len(rows) == 0:
        raise NotThere("no shaken run without damping, or none with its energies")
    share = float((rows["damping_energy_j"].abs() / rows["input_energy_j"]).max())
    error = float(rows["energy_error_fraction"].max())
    text = (
        f"damping takes at most {share:.1g} of the input, imbalance at most {error:.2%},"
        f" {len(rows)} runs"
    )
    return text, min(at_most(share, criteria.NO_DAMPING), at_most(error, criteria.ENERGY_ERROR))


def _squat(column, bounds, unit, name, find):
    """find: a method of Evidence that gives the Point of the squat wall."""

    def judged(evidence):
        value = find(evidence, "squat").value(column)
        low = min(bounds) * (1 - criteria.PRINTED_TOLERANCE)
        high = max(bounds) * (1 + criteria.PRINTED_TOLERANCE)
        return f"{value / unit:.1f} {name}", min(at_least(value, low), at_most(value, high))

    return judged


def _undecidable(why):
    def judged(evidence):
        raise NotThere(why)

    return judged


_CYCLE_READINGS = {
    "a": ("last_cycle_s", 3),
    "b": ("first_free_cycle_s", 3),
    "c": ("first_free_cycle_s", 2),
}
JUDGES = {
    "P1": _period("solid", criteria.SOLID_PERIOD_S),
    "P2a": _period("symmetric", criteria.PERFORATED_PERIOD_S),
    "P2b": _period("asymmetric", criteria.PERFORATED_PERIOD_S),
    "P3": _all_at_most(criteria.SLIGHT_DI, "solid", criteria.PERIODS_S, [(0.06, 0.1), (0.2, 0.1)]),
    "P4": _of_one_point(
        "max",
        "DI",
        lambda di: at_most(di, criteria.NEGLIGIBLE_DI),
        Evidence.harmonic_at,
        "symmetric",
        0.33,
        [0.025],
    ),
    "P5": _cycle_by_cycle(0.33, 0.1, _first_is_not_exceeded),
    "P6a": _cycle_by_cycle(0.2, 0.025, _rises),
    "P6b": _cycle_by_cycle(0.2, 0.1, _rises),
    "P7": _asymmetric_is_similar,
    "P8": _all_at_most(criteria.SLIGHT_DI, "symmetric", [0.06], [(0.06, 0.1)]),
    "P9a": _linear(0.33, AMPLITUDES_G),
    "P9b": _linear(1.0, AMPLITUDES_G),
    "P9c": _linear(0.33, AMPLITUDES_G[:-1]),
    **{
        claim: _of_one_point(
            "max",
            "DI",
            _close_to(criteria.LARGEST_DI[period_s]),
            Evidence.harmonic_at,
            "symmetric",
            period_s,
            [0.1],
        )
        for claim, period_s in (("P9d", 0.33), ("P9e", 1.0))
    },
    "P9f": _all_at_most(
        criteria.NEGLIGIBLE_DI, "symmetric", [0.33, 1.0], [(0.33, 0.1), (1.0, 0.1)], "residual"
    ),
    "P10a": _substantially_higher,
    **{
        claim: _of_points(
            "max", component, margin, Evidence.harmonic_at, "symmetric", 0.2, HIGHER_G
        )
        for claim, component, margin in (
            ("P10b", "DI_open", _same),
            ("P10c", "DI_slip", _same),
            ("P10d", "DI_drift", _rises),
        )
    },
    "P11a": _all_at_most(
        criteria.NEGLIGIBLE_DI,
        "symmetric",
        [0.06, 0.33, 1.0],
        [(0.06, 0.1), (0.33, 0.1), (1.0, 0.1)],
        "residual",
    ),
    "P11b": _residual_cracks,
    "P11c": _of_one_point(
        "residual",
        "DI_drift",
        lambda di: above(di, criteria.INSIGNIFICANT_DI_DRIFT),
        Evidence.harmonic_at,
        "symmetric",
        0.2,
        [0.1],
    ),
    **{
        f"P12{letter}": _cycle_lengths(*which, _lengthen)
        for letter, which in _CYCLE_READINGS.items()
    },
    **{
        f"P12{letter}": _cycle_lengths(*which, _as_in_figure_9)
        for letter, which in zip("def", _CYCLE_READINGS.values())
    },
    "P13a": _of_the_record("zeerijp", pga_g, criteria.PGA_G["zeerijp"], criteria.PRINTED_TOLERANCE),
    "P13b": _of_the_record(
        "huizinge", pga_g, criteria.PGA_G["huizinge"], criteria.PRINTED_TOLERANCE
    ),
    "P13c": _of_the_record("zeerijp", _at_0_2_s, criteria.SA_G, criteria.ABOUT_TOLERANCE),
    "P13d": _of_the_record("huizinge", _at_0_2_s, criteria.SA_G, criteria.ABOUT_TOLERANCE),
    "P13e": _scales_were_run,
    "P14a": _of_points(
        "residual",
        "DI",
        lambda values: at_most(max(values), criteria.NEGLIGIBLE_DI),
        Evidence.shaken_at,
        "huizinge",
        SCALES[:2],
    ),
    "P14b": _of_one_point(
        "residual",
        "DI",
        _close_to(criteria.LARGEST_RESIDUAL_DI),
        Evidence.shaken_at,
        "huizinge",
        [2.0],
    ),
    "P14c": _cracks_without_drift("huizinge"),
    "P14d": _cracks_without_drift("zeerijp"),
    "P15a": _maximum_is_linear,
    "P15b": _residual_levels_off,
    "P16": _no_damping,
    "P17a": _squat(
        "secant_stiffness_n_per_m",
        criteria.SQUAT_STIFFNESS_N_PER_M,
        1e6,
        "kN/mm",
        Evidence.pushed_slowly,
    ),
    "P17b": _squat("peak_force_n", criteria.SQUAT_PEAK_N, 1e3, "kN", Evidence.cycled),
    "P17c": _undecidable("no force-displacement curve of the test is published as numbers"),
    "P17d": _undecidable("compare the pictures of the validation study with figure 5"),
}
