"""Intensity measures of a ground-motion record.

Every function measures the record as it is given and filters nothing.  To filter, pass what
`damage.motion.record.band_passed` returns.
"""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import scipy  # signal and integrate where they are used: half a second

from damage.errors import InputError
from damage.motion.record import LEAST_A_PERIOD, Record
from damage.units import GRAVITY

SPECTRUM_PERIODS_S = (0.06, 0.08, 0.1, 0.15, 0.2, 0.25, 0.33, 0.5, 1.0)
"""Periods of the spectrum in `summary` [s]."""

AVERAGE_PERIODS_S = tuple(np.geomspace(0.01, 1.0, 10))
"""Periods of AvgSa [s]: ten, equally far apart in their logarithm."""

APPLIED = (
    "pgv_m_s",
    "pgv_rotd100_m_s",
    "avg_sa_g",
    "sa_eigen_period_g",
    "arias_m_s",
    "d5_75_s",
    "d5_95_s",
)
"""Keys of `applied_measures`."""

WARNED_END_VELOCITY = 0.5
"""Velocity at a motion's end, as a share of PGV, above which a run warns of it.

Windows of studies/stations.csv leave up to 0.27; BLOP_HGE, whose baseline steps, leaves 1.
"""

SLOW_HZ = 0.1
"""Frequency below which a motion is a baseline's or a permanent displacement [Hz]."""
WARNED_PGV = 0.5
"""Share of PGV without such motion below which a run warns: of the components that ship one has
less than 0.87."""

POINTS_PER_PERIOD = 100
"""Instants a period at which an oscillator's peak is sought: misses 1 - cos(pi/100) < 0.05 %."""

MOST_VALUES = 10**8
"""Instants of an oscillator's response, 8 bytes each."""


def pga_g(record: Record) -> float:
    """Peak ground acceleration [g].

    >>> from damage.motion.formats import read_record, shipped_record_path
    >>> round(pga_g(read_record(shipped_record_path("BGAR_HGE"))), 4)
    0.1107
    """
    return float(np.abs(record.acceleration_m_s2).max()) / GRAVITY


def pgv_m_s(record: Record) -> float:
    """Peak velocity of a base that moves as the record says, from rest at the first sample [m/s].

    Exact for acceleration that is linear between samples, which is how a run applies it: the
    velocity's peak is at a sample or where the acceleration passes zero between two.  Nothing is
    filtered: a baseline that is off counts.

    >>> round(pgv_m_s(Record("pulse", 0.01, np.ones(11))), 4)
    0.1
    """
    a = record.acceleration_m_s2
    step_s = record.time_step_s
    at_samples = scipy.integrate.cumulative_trapezoid(a, dx=step_s, initial=0.0)
    turns = np.flatnonzero(a[:-1] * a[1:] < 0)
    until_zero_s = step_s * a[turns] / (a[turns] - a[turns + 1])
    between = at_samples[turns] + 0.5 * a[turns] * until_zero_s
    return float(max(np.abs(at_samples).max(), np.abs(between).max(initial=0.0)))


def rotd100(record: Record, across: Record) -> dict:
    """Largest of all horizontal directions (RotD100: D. M. Boore, 2010, Bull. Seism. Soc. Am.
    100(4), 1830-1835) of two components at right angles with the same step, length and start:
    "pga_rotd100_g", "pgv_rotd100_cm_s" and "sa_rotd100_g", the 5 % spectrum, {period [s]: ordinate
    [g]}.

    The largest of all directions is the largest length of the vector of both components.

    >>> sums = rotd100(Record("x", 0.01, [0.0, 3.0]), Record("y", 0.01, [0.0, 4.0]))
    >>> round(float(sums["pga_rotd100_g"]), 4)
    0.5097
    """
    pair = [component.acceleration_m_s2 for component in (record, across)]
    step_s = record.time_step_s
    spectrum = {
        str(period): (
            float(
                np.hypot(
                    *(oscillator_response(component, step_s, period) for component in pair)
                ).max()
            )
            / GRAVITY
        )
        for period in SPECTRUM_PERIODS_S
    }
    return {
        "pga_rotd100_g": float(np.hypot(*pair).max()) / GRAVITY,
        "pgv_rotd100_cm_s": 100.0 * pgv_rotd100_m_s(record, across),
        "sa_rotd100_g": spectrum,
    }


INSTANTS = 16
"""Parts of each time step of a record at whose ends `pgv_rotd100_m_s` looks for the peak
velocity."""


def pgv_rotd100_m_s(record: Record, across: Record) -> float:
    """Peak ground velocity in the direction in which it is largest [m/s]; the velocity is exact at
    each instant looked at.

    >>> round(pgv_rotd100_m_s(Record("x", 0.01, np.ones(11)), Record("y", 0.01, np.ones(11))), 4)
    0.1414
    """
    part = np.linspace(0.0, 1.0, INSTANTS + 1)[:, np.newaxis]

    def velocity(component):
        a = component.acceleration_m_s2
        step_s = component.time_step_s
        at_samples = scipy.integrate.cumulative_trapezoid(a, dx=step_s, initial=0.0)
        return at_samples[:-1] + step_s * part * (a[:-1] + 0.5 * part * np.diff(a))

    return float(np.hypot(velocity(record), velocity(across)).max())


def avg_sa_g(record: Record) -> float:
    """AvgSa: geometric mean of the 5 % pseudo-acceleration at AVERAGE_PERIODS_S [g]; 0 where one of
    them is.

    L. Eads, E. Miranda, D. G. Lignos (2015), Average spectral acceleration as an intensity measure
    for collapse risk assessment, Earthq. Eng. Struct. Dyn. 44(12), doi:10.1002/eqe.2575, with
    periods of its own: those of stiff houses.

    >>> round(avg_sa_g(Record("pulse", 0.01, np.ones(101))), 3)
    0.189
    """
    return float(
        np.prod(response_spectrum(record, AVERAGE_PERIODS_S)) ** (1 / len(AVERAGE_PERIODS_S))
    )


def applied_measures(
    record: Record | None, eigen_period_s: float, across: Record | None = None
) -> dict:
    """Measures of the horizontal motion as a run applied it, under the keys APPLIED; None where one
    does not apply.

    record: that motion, after baseline, band-pass, window and scale, or None where the base stands
    still; eigen_period_s: of the intact wall [s], or None; across: the other horizontal component,
    which is not applied, or None.
    The spectral ones have 5 % damping and the rest after the motion, as long as the longest period,
    in which an oscillator may swing further than during a short motion.

    >>> sorted(applied_measures(Record("pulse", 0.01, np.ones(101)), 0.2))[:2]
    ['arias_m_s', 'avg_sa_g']
    """
    if record is None:
        return dict.fromkeys(APPLIED)
    measures = {
        "pgv_m_s": lambda: pgv_m_s(record),
        "pgv_rotd100_m_s": lambda: None if across is None else pgv_rotd100_m_s(record, across),
        "avg_sa_g": lambda: avg_sa_g(rested(record, AVERAGE_PERIODS_S[-1])),
        "sa_eigen_period_g": lambda: (
            None if eigen_period_s is None else sa_g(record, eigen_period_s)
        ),
        "arias_m_s": lambda: arias_m_s(record),
        "d5_75_s": lambda: significant_duration_s(record, 0.05, 0.75),
        "d5_95_s": lambda: significant_duration_s(record, 0.05, 0.95),
    }
    return {name: _where_it_applies(measures[name]) for name in APPLIED}


def sa_g(record: Record, period_s: float) -> float:
    """5 % spectral acceleration at a period, the rest after the motion included [g].

    >>> round(sa_g(Record("pulse", 0.01, np.ones(101)), 0.2), 3)
    0.189
    """
    return float(response_spectrum(rested(record, period_s), [period_s])[0])


def _where_it_applies(measure):
    """A measure's value, None of a motion that it cannot be had of: one at rest, one too long."""
    try:
        return measure()
    except InputError:
        return None


def rested(record: Record, rest_s: float) -> Record:
    """The record with at least that time at rest after it [s].

    >>> len(rested(Record("pulse", 0.01, np.ones(11)), 0.1).acceleration_m_s2)
    22
    """
    more = math.ceil(rest_s / record.time_step_s) + 1
    return replace(record, acceleration_m_s2=np.pad(record.acceleration_m_s2, (0, more)))


def arias_m_s(record: Record) -> float:
    """Arias intensity, pi / (2 g) times the integral of the squared acceleration [m/s].

    >>> round(arias_m_s(Record("pulse", 0.01, np.ones(101))), 4)
    0.1601
    """
    return math.pi / (2 * GRAVITY) * float(_squared_acceleration_integral(record)[-1])


def significant_duration_s(
    record: Record, start_fraction: float = 0.05, end_fraction: float = 0.75
) -> float:
    """Time between two fractions of the Arias intensity, linear between samples [s].

    >>> round(significant_duration_s(Record("pulse", 0.01, np.ones(101))), 2)
    0.7
    """
    if not 0 <= start_fraction < end_fraction <= 1:
        raise InputError(
            f"fractions {start_fraction!r} and {end_fraction!r} of the Arias intensity;"
            " expected 0 <= start < end <= 1, such as 0.05 and 0.75"
        )
    integral = _squared_acceleration_integral(record)
    if integral[-1] == 0:
        raise InputError(f"{record.name}: no motion, all samples are 0; expected some to measure")
    bounds = np.array((start_fraction, end_fraction)) * integral[-1]
    start_s, end_s = np.interp(bounds, integral, record.time_s)
    return float(end_s - start_s)


def _squared_acceleration_integral(record):
    """Running integral of the squared acceleration, trapezoidal, (n_samples,) [m2/s3]."""
    return scipy.integrate.cumulative_trapezoid(
        record.acceleration_m_s2**2, dx=record.time_step_s, initial=0.0
    )


def response_spectrum(
    record: Record, periods_s: Sequence[float] | np.ndarray, damping: float = 0.05
) -> np.ndarray:
    """Pseudo-acceleration of oscillators that start at rest, (n_periods,) [g].

    periods_s: (n_periods,) natural periods [s], also far below the time step.
    damping: ratio to critical, 0 <= damping < 1.

    The response is exact for acceleration that is linear between samples, after Nigam & Jennings
    (1969), Bull. Seism. Soc. Am. 59(2), 909-922. The peak is looked for from the first to the last
    sample, not in the free vibration after it.

    >>> response_spectrum(Record("pulse", 0.01, np.ones(101)), [0.1, 0.2]).round(3).tolist()
    [0.189, 0.189]
    """
    periods_s = np.atleast_1d(np.asarray(periods_s, dtype=np.float64))
    if periods_s.ndim != 1 or not (np.isfinite(periods_s) & (periods_s > 0)).all():
        raise InputError(f"periods {periods_s.tolist()!r} s; expected positive, finite numbers")
    if not 0 <= damping < 1:
        raise InputError(f"damping ratio {damping!r}; expected 0 <= ratio < 1, such as 0.05")
    return (
        np.array(
            [
                np.abs(
                    oscillator_response(
                        record.acceleration_m_s2, record.time_step_s, period, damping
                    )
                ).max()
                for period in periods_s
            ]
        )
        / GRAVITY
    )


def oscillator_response(
    acceleration_m_s2: np.ndarray, time_step_s: float, period_s: float, damping: float = 0.05
) -> np.ndarray:
    """Displacement times squared angular frequency of an oscillator over time [m/s2].

    acceleration_m_s2: (n_samples,), of the base; the response is linear in it.
    Returns (instants, n_samples - 1): in each step, `instants` times equally far apart, the
    last of them the step's end, so many that POINTS_PER_PERIOD hold.

    With the pole p = w (-z + i sqrt(1 - z^2)) and q = x' - conj(p) x, the equation
    x'' + 2 z w x' + w^2 x = -a becomes q' = p q - a, and x = Im q / Im p. Over a time h in which
    a goes from a0 linearly to a1:  q1 = exp(p h) q0 - a0 phi0 - (a1 - a0) phi1.

    >>> np.shape(oscillator_response(np.ones(11), 0.01, 0.2))
    (5, 10)
    """
    omega = 2 * math.pi / period_s
    pole = omega * complex(-damping, math.sqrt(1 - damping**2))
    start = acceleration_m_s2[:-1]
    change = np.diff(acceleration_m_s2)
    phi0, phi1 = _ramp_weights(pole * time_step_s, time_step_s)
    state = scipy.signal.lfilter(
        [1.0], [1.0, -np.exp(pole * time_step_s)], -(start * phi0 + change * phi1)
    )
    state = np.concatenate(([0.0], state[:-1]))  # (n_samples - 1,) at the start of each step
    instants = math.ceil(POINTS_PER_PERIOD * time_step_s / period_s)
    if instants * start.size > MOST_VALUES:
        raise InputError(
            f"a period of {period_s:g} s of {start.size} samples {time_step_s:g} s apart: expected"
            f" up to {MOST_VALUES} instants in all, {POINTS_PER_PERIOD} a period; resample the"
            " record"
        )
    response = np.empty((instants, start.size))
    for number, part in enumerate(np.arange(1, instants + 1) / instants):
        elapsed_s = part * time_step_s
        phi0, phi1 = _ramp_weights(pole * elapsed_s, elapsed_s)
        then = np.exp(pole * elapsed_s) * state - start * phi0 - part * change * phi1
        response[number] = then.imag
    return omega**2 / pole.imag * response


def _ramp_weights(exponent, elapsed_s):
    """phi0 and phi1 [s]: what a constant 1 and a ramp from 0 to 1 leave in q; exponent = p h."""
    growth = np.expm1(exponent)
    return elapsed_s * growth / exponent, elapsed_s * (growth - exponent) / exponent**2


def end_velocity_m_s(record: Record) -> float:
    """Velocity of the base at the last sample, from rest at the first [m/s].

    It is 0 for a motion that comes to rest.  A baseline that is off and a window that cuts the
    motion leave more.

    >>> round(end_velocity_m_s(Record("pulse", 0.01, np.ones(11))), 4)
    0.1
    """
    return float(scipy.integrate.trapezoid(record.acceleration_m_s2, dx=record.time_step_s))


def drift_warnings(loading) -> list[str]:
    """Warning of a `damage.motion.loading.Recorded` one of whose components has less than
    WARNED_PGV of its PGV without a line, or without what is slower than SLOW_HZ."""
    record = loading.record
    plain = replace(loading, interpolated_for_s=None)
    without: dict[str, dict] = {}
    if loading.band_hz is not None:
        return []
    if not loading.baseline_order:
        without["a line (--baseline 1)"] = {"baseline_order": 1}
    if record.duration_s >= 1 / SLOW_HZ:
        band = SLOW_HZ, 0.4 / record.time_step_s
        without["what is below {:g} Hz (--band {:g} {:g})".format(SLOW_HZ, *band)] = {
            "band_hz": band
        }
    for change, changed in without.items():
        both = zip(loading.components, _pgv(plain), _pgv(replace(plain, **changed)))
        for component, whole, left in both:
            if left < WARNED_PGV * whole:
                return [
                    f"{component.name}: its PGV of {whole:.3g} m/s is {left:.3g} without {change};"
                    " expected nearly the same: it is that of a baseline that drifts, a permanent"
                    " displacement, or a record without rest around its motion"
                ]
    return []


def _pgv(loading):
    """PGV of each component of a Recorded as it is applied [m/s]."""
    motions = *loading.motion, loading.applied_across()
    return [pgv_m_s(motion) for motion in motions if motion is not None]


def end_warnings(record: Record) -> list[str]:
    """Warning of a motion after which the base moves on at more than WARNED_END_VELOCITY of PGV.

    >>> len(end_warnings(Record("pulse", 0.01, np.ones(101))))
    1
    """
    moving = abs(end_velocity_m_s(record))
    peak = pgv_m_s(record)
    if moving <= WARNED_END_VELOCITY * peak:
        return []
    return [
        f"when the motion ends the base still moves at {moving:.3g} m/s, {100 * moving / peak:.0f}"
        " % of PGV: PGV is that of a baseline or a window; give --band LOW_HZ HIGH_HZ, --baseline"
        " ORDER or another --window"
    ]


def summary(record: Record) -> dict:
    """Intensity measures of a record as it is, under the keys of the command line's JSON.

    PGA [g], PGV and the velocity at the end [cm/s], Arias intensity [m/s], durations [s], AvgSa [g]
    and the 5 % spectrum [g], {period [s]: ordinate}.  Those in APPLIED are the ones that a run with
    this motion has.
    Raises InputError for a record without motion.

    >>> sorted(summary(Record("pulse", 0.01, np.ones(101))))[:3]
    ['arias_m_s', 'avg_sa_g', 'd5_75_s']
    """
    spectrum_g = response_spectrum(record, SPECTRUM_PERIODS_S)
    return {
        "pga_g": pga_g(record),
        "pgv_cm_s": 100.0 * pgv_m_s(record),
        "end_velocity_cm_s": 100.0 * end_velocity_m_s(record),
        "arias_m_s": arias_m_s(record),
        "d5_75_s": significant_duration_s(record, 0.05, 0.75),
        "d5_95_s": significant_duration_s(record, 0.05, 0.95),
        "avg_sa_g": avg_sa_g(rested(record, AVERAGE_PERIODS_S[-1])),
        "sa_g": {str(t): float(g) for t, g in zip(SPECTRUM_PERIODS_S, spectrum_g, strict=True)},
    }


def motion_summary(loading, eigen_period_s: float | None = None) -> dict:
    """The `summary` of a `damage.motion.loading.Recorded` as a run applies it, with what prepared
    it; of a wall with that first period [s] also "sa_eigen_period_g", of the motion `for_period`.

    Beside the measures: "motion", its name; "unit" of the file's samples, and what says so;
    "gravity_m_s2", 1 g; "scale", "window_s", "baseline_order" and "band_hz" as given; "time_step_s"
    of the record, "interpolated_for_s", "lost_by_lines" and "late_s" of the Recorded; "filtered",
    the names of the measures that are of a band-passed motion: all of them or none.

    >>> from damage.motion.loading import Recorded
    >>> pulse = Record("pulse", 0.01, np.sin(np.arange(101) / 5))
    >>> measures = motion_summary(Recorded(pulse, scale=2.0), eigen_period_s=0.2)
    >>> round(measures["pga_g"], 3), round(measures["sa_eigen_period_g"], 3)
    (0.204, 0.479)
    """
    if eigen_period_s is not None:
        loading = loading.for_period(eigen_period_s)
    measures = summary(loading.applied())
    if eigen_period_s is not None:
        measures["sa_eigen_period_g"] = sa_g(loading.applied(), eigen_period_s)
    if loading.across is not None:
        measures |= rotd100(loading.applied(), loading.applied_across())
    return {
        "motion": loading.name,
        "unit": loading.record.unit,
        "gravity_m_s2": GRAVITY,
        "scale": loading.scale,
        "window_s": loading.window_s,
        "baseline_order": loading.baseline_order,
        "band_hz": loading.band_hz,
        "time_step_s": loading.record.time_step_s,
        "interpolated_for_s": loading.interpolated_for_s,
        "lost_by_lines": loading.lost_by_lines,
        "late_s": loading.late_s,
        "filtered": [] if loading.band_hz is None else list(measures),
        **measures,
    }


_SPECTRA = "sa_g", "sa_rotd100_g"


def _describe_sampling(measures):
    """How walls take the samples of a `motion_summary`, in words."""
    if measures["interpolated_for_s"] is None:
        return (
            "taken as it is by walls of a first period from"
            f" {LEAST_A_PERIOD * measures['time_step_s']:g} s, by stiffer ones interpolated"
            " (--period T1_S shows that motion)"
        )
    return (
        f"interpolated (band-limited) for a wall of {measures['interpolated_for_s']:g} s; lines"
        f" between samples would take off {100 * measures['lost_by_lines']:.2g} % at that period"
    )


def late_lines(late_s: dict[str, float]) -> list[str]:
    """Lines that say which components were moved in time, of `late_s` of a Recorded.

    >>> late_lines({"up": 2.0})
    ['up begins +2 s after the horizontal component by its file: moved to that time']
    """
    return [
        f"{name} begins {late:+g} s after the horizontal component by its file: moved to that time"
        for name, late in late_s.items()
    ]


def describe(values: dict) -> str:
    """A `motion_summary` as lines for people.

    >>> from damage.motion.loading import Recorded
    >>> pulse = Record("pulse", 0.01, np.sin(np.arange(101) / 5))
    >>> describe(motion_summary(Recorded(pulse))).splitlines()[0]
    'motion as applied: pulse_x1; 1 g = 9.81 m/s2'
    """
    names = list(values)
    measures = {
        name: values[name] for name in names[names.index("filtered") + 1 :] if name not in _SPECTRA
    }
    band = (
        "none (--band LOW_HZ HIGH_HZ for a band-pass)"
        if values["band_hz"] is None
        else "zero-phase band-pass {:g} to {:g} Hz, in all measures".format(*values["band_hz"])
    )
    lines = [
        f"motion as applied: {values['motion']}; 1 g = {values['gravity_m_s2']:g} m/s2",
        f"unit of the file: {values['unit'] or 'm_s2 (made in Python)'}",
        f"filter: {band}",
        f"time step: {values['time_step_s']:g} s, {_describe_sampling(values)}",
        *late_lines(values["late_s"]),
    ]
    lines += [f"{name:18s}{value:10.4f}" for name, value in measures.items()]
    lines += [
        f"{name}({period} s){value:>{25 - len(period) - len(name)}.4f}"
        for name in _SPECTRA
        if name in values
        for period, value in values[name].items()
    ]
    return "\n".join(lines)


_POWERS = {"arias_m_s": 2, "d5_75_s": 0, "d5_95_s": 0}
"""{measure: power of the factor on the motion to which it is proportional}; 1 where not listed."""


def motion_measures(history) -> dict:
    """{measure: value} of APPLIED for the strongest event of a History; None where a measure does
    not apply.

    Units: `damage.measure.columns.PARAMETERS`.
    """
    parameters = history.parameters
    factor = history.strongest_factor
    return {
        name: parameters.get(name) and parameters[name] * factor ** _POWERS.get(name, 1)
        for name in APPLIED
    }


def record_unit(history) -> str | None:
    """Which unit the records of a History were taken to be in, and what says so; None without a
    record, or in an older file."""
    origins = [loading.as_dict().get("horizontal") or {} for loading in history.event_loadings]
    return (
        "; ".join(dict.fromkeys(origin["unit"] for origin in origins if origin.get("unit"))) or None
    )
