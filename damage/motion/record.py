"""A ground-motion record and its operations: every function returns a new `Record`."""

import math
import re
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime, timedelta

import numpy as np

from damage.checks import check_positive, check_range
from damage.errors import InputError
from damage.fields import check_fields
from damage.motion import samples

TIME_STEPS_S = 1e-5, 1.0
"""Least and largest time step of a record [s]."""
MOST_SAMPLES = 10**6
"""Largest number of samples of a record."""
HIGHEST_M_S2 = 1e5
"""Largest acceleration of a record [m/s2]."""
MOST_SCALE = 1e3
"""Largest factor on a record."""
MOST_MB = 50
"""Largest size of a record's file [MB]."""
LOWEST_HZ = 1e-3
"""Lowest corner of a band-pass [Hz]: records last minutes."""
LEAST_A_PERIOD = 10
"""Samples of a record in the wall's first period below which a run interpolates them: lines between
them take off 1 - sinc^2(1 / 10) = 3 % there (C. Phillips et al., 2012, Soil Dyn. Earthq. Eng.)."""
FINER = 10
"""Samples of band-limited interpolation for each one of the record; lines between them take off up
to 0.8 %."""
REACH = 64
"""Samples of the record on either side that count in the interpolation."""
KAISER_BETA = 8.0
"""Shape of the Kaiser window of the interpolation: 1e-4 off up to 0.96 of half the sampling
rate."""

_CHANNEL = r"(?:.*[._-])?(?:[A-Z][GHLN]{}|{}\d?)|RSN\d.*{}"
VERTICAL = re.compile(_CHANNEL.format("Z", "UD", "(?:UP|DWN|VER)"))
"""Channels of vertical components: of SEED, as HNZ, of K-NET, as UD, and of PEER's files."""
HORIZONTAL = re.compile(_CHANNEL.format("[NE12]", "(?:NS|EW)", r"\d{3}"))
"""Channels of horizontal components, of the same three."""


@dataclass(frozen=True, eq=False)
class Record:
    """One component of ground acceleration, the first sample at time 0.

    name: short name, such as "NL.BGAR..HGE".
    time_step_s: constant time step [s].
    acceleration_m_s2: (n_samples,) float64, read-only [m/s2].
    start_utc: time of the first sample in ISO 8601, UTC, or "".
    source: path of the file as it was given, or "".
    sha256: checksum of that file's bytes when it was read, or "".
    beside_sha256: those of every other file that was read with it, as a StationXML.
    unit: which unit the file's samples were taken to be in, and what says so, or "".
    given: arguments of `read_record` that the file does not say, fit for JSON.
    first_s: time of the first sample by the file's own column, which counts where no file says
        start_utc [s].
    late_s: by how much it began later than the component on whose time axis it is [s].

    >>> pulse = Record("pulse", 0.01, [0.0, 1.0, 0.0], start_utc="2018-01-08T14:00:52Z")
    >>> pulse.duration_s, pulse.time_s.tolist(), pulse.start_utc
    (0.02, [0.0, 0.01, 0.02], '2018-01-08T14:00:52.000000Z')
    """

    name: str
    time_step_s: float
    acceleration_m_s2: np.ndarray
    start_utc: str = ""
    source: str = ""
    sha256: str = ""
    beside_sha256: tuple[str, ...] = ()
    unit: str = ""
    given: dict = field(default_factory=dict)
    first_s: float = 0.0
    late_s: float = 0.0

    def __post_init__(self) -> None:
        check_fields(self)
        where = self.source or self.name or "record"
        check_range(f"{where}: time step [s]", self.time_step_s, *TIME_STEPS_S)
        acceleration = np.array(self.acceleration_m_s2, dtype=np.float64)
        if acceleration.ndim != 1 or acceleration.size < 2:
            raise InputError(
                f"{where}: acceleration of shape {acceleration.shape};"
                " expected one column of at least 2 samples"
            )
        finite = np.isfinite(acceleration)
        if not finite.all():
            raise InputError(
                f"{where}: sample {np.argmin(finite)} is {acceleration[np.argmin(finite)]};"
                " expected finite numbers, fill or cut the gap"
            )
        if acceleration.size > MOST_SAMPLES:
            raise InputError(
                f"{where}: {acceleration.size} samples; expected up to {MOST_SAMPLES}, cut the"
                " record"
            )
        largest = np.argmax(np.abs(acceleration))
        if abs(acceleration[largest]) > HIGHEST_M_S2:
            raise InputError(
                f"{where}: sample {largest} is {acceleration[largest]:g} m/s2; expected up to "
                f"{HIGHEST_M_S2:g}, look at the unit"
            )
        acceleration.setflags(write=False)
        vars(self)["acceleration_m_s2"] = acceleration
        vars(self)["start_utc"] = _utc(self.start_utc, 0.0, where)

    @property
    def duration_s(self) -> float:
        """Time from the first to the last sample [s]."""
        return (self.acceleration_m_s2.size - 1) * self.time_step_s

    @property
    def time_s(self) -> np.ndarray:
        """Times of the samples, (n_samples,) [s]."""
        return np.arange(self.acceleration_m_s2.size) * self.time_step_s


def scaled(record: Record, factor: float) -> Record:
    """The record times a factor; a negative one reverses its direction.

    >>> scaled(Record("pulse", 0.01, [0.0, 1.0, 0.0]), 2.0).acceleration_m_s2.tolist()
    [0.0, 2.0, 0.0]
    """
    check_range("scale factor", factor, -MOST_SCALE, MOST_SCALE)
    return replace(record, acceleration_m_s2=record.acceleration_m_s2 * factor)


def windowed(record: Record, t0_s: float, t1_s: float) -> Record:
    """The samples nearest to t0 up to those nearest to t1, both included; time restarts at 0.

    >>> windowed(Record("ramp", 0.01, np.arange(5.0)), 0.01, 0.03).acceleration_m_s2.tolist()
    [1.0, 2.0, 3.0]
    """
    first, last = _ends(record, t0_s, t1_s)
    return _cut(record, first, record.acceleration_m_s2[first : last + 1])


def interpolated(record: Record, window_s: tuple[float, float] | None = None) -> Record:
    """The record, or the window that `windowed` cuts, with FINER times as many samples,
    band-limited: what a record whose samples hold all of the motion says of the time between them.

    A windowed sinc; beyond its first and last sample the record continues as its reflection in that
    point, so that neither its ends nor a baseline ring.

    >>> len(interpolated(Record("pulse", 0.01, [0.0, 1.0, 0.0])).acceleration_m_s2)
    21
    """
    first, last = _ends(record, *window_s) if window_s else (0, record.acceleration_m_s2.size - 1)
    if (last - first) * FINER >= MOST_SAMPLES:
        raise InputError(
            f"{record.name}: {last - first + 1} samples of {record.time_step_s:g} s to interpolate;"
            f" expected up to {MOST_SAMPLES // FINER}, give a --window"
        )
    around = samples.continued(record.acceleration_m_s2, REACH)[first : last + 2 * REACH + 1]
    fine = samples.finer(around, FINER, REACH, KAISER_BETA)
    return replace(_cut(record, first, fine), time_step_s=record.time_step_s / FINER)


def _ends(record, t0_s, t1_s):
    """The first and the last sample of a window."""
    # half a step of room: an end that rounds to the last sample is inside
    if not 0 <= t0_s < t1_s <= record.duration_s + 0.5 * record.time_step_s:
        raise InputError(
            f"window {t0_s!r} to {t1_s!r} s; expected 0 <= start < end"
            f" within the {record.duration_s:g} s of {record.name}"
        )
    first, last = (round(t / record.time_step_s) for t in (t0_s, t1_s))
    last = min(last, record.acceleration_m_s2.size - 1)
    if first >= last:
        raise InputError(
            f"window {t0_s!r} to {t1_s!r} s holds one sample of {record.name};"
            f" expected more than its time step of {record.time_step_s:g} s"
        )
    return first, last


def _cut(record, first, acceleration_m_s2):
    """The record with other samples, of which the first is at one of its own."""
    later_s = first * record.time_step_s
    return replace(
        record,
        acceleration_m_s2=acceleration_m_s2,
        start_utc=_utc(record.start_utc, later_s, record.name),
        first_s=record.first_s + later_s,
    )


def on_axis_of(
    record: Record, reference: Record, window_s: tuple[float, float] | None = None
) -> Record:
    """Return a record on the time axis of another one, by their start times (`start_difference_s`),
    zero where it has no samples; within the window, by default all of the other one, it has to have
    them.

    >>> one = Record("x", 0.01, np.ones(5))
    >>> on_axis_of(one, one).late_s
    0.0
    """
    step_s = reference.time_step_s
    late_s = start_difference_s(record, reference)
    if abs(record.time_step_s / step_s - 1) > 1e-9:
        raise InputError(
            f"{record.name} has a time step of {record.time_step_s:g} s, {reference.name} of"
            f" {step_s:g} s; expected the same, resample one"
        )
    first = round(late_s / step_s)
    size = reference.acceleration_m_s2.size
    begin = max(first, 0)
    end = min(first + record.acceleration_m_s2.size, size)
    lowest, highest = (0.0, reference.duration_s) if window_s is None else window_s
    if (
        begin * step_s > lowest + 0.5 * step_s
        or (end - 1) * step_s < min(highest, reference.duration_s) - 0.5 * step_s
    ):
        raise InputError(
            f"{record.name} has samples from {begin * step_s:g} to {(end - 1) * step_s:g} s of "
            f"{reference.name}, {lowest:g} to {highest:g} s are used; expected all of these, give "
            "--window T0_S T1_S"
        )
    samples = np.zeros(size)
    samples[begin:end] = record.acceleration_m_s2[begin - first : end - first]
    return replace(
        record,
        acceleration_m_s2=samples,
        start_utc=reference.start_utc,
        first_s=reference.first_s,
        late_s=record.late_s + late_s,
    )


def start_difference_s(record: Record, other: Record) -> float:
    """Start of a record minus the start of another one [s], by their own times where neither has a
    start time; 0 of two that are as long, in equal steps, and begin at the same time of their
    own.

    >>> late = Record("x", 0.01, [1.0, 2.0], first_s=0.1)
    >>> start_difference_s(late, Record("y", 0.01, [1.0, 2.0]))
    0.1
    """
    sizes = {
        (component.time_step_s, component.acceleration_m_s2.size) for component in (record, other)
    }
    late_s = record.first_s - other.first_s
    if not (record.start_utc or other.start_utc) and (late_s or len(sizes) == 1):
        return late_s
    for component in (record, other):
        if not component.start_utc:
            raise InputError(
                f"{component.name} has no start time: expected that of both components, or none of"
                " two as long, in equal steps; cut them alike, or write"
                " '# start 2018-01-08T14:00:52Z' on the first line of a CSV"
            )
    return (_datetime(record.start_utc) - _datetime(other.start_utc)).total_seconds()


def baseline_corrected(record: Record, order: int = 1) -> Record:
    """The record minus its least-squares polynomial of the given order (0: minus the mean).

    >>> corrected = baseline_corrected(Record("offset", 0.01, np.full(100, 0.1)))
    >>> bool(abs(corrected.acceleration_m_s2).max() < 1e-12)
    True
    """
    if order not in range(min(10, record.acceleration_m_s2.size)):
        raise InputError(
            f"baseline order {order!r} for {record.acceleration_m_s2.size} samples;"
            " expected a whole number from 0 to 9 and below the number of samples"
        )
    return replace(
        record, acceleration_m_s2=samples.without_polynomial(record.acceleration_m_s2, int(order))
    )


def band_passed(record: Record, low_hz: float, high_hz: float, order: int = 4) -> Record:
    """Zero-phase Butterworth band-pass between two corners [Hz].

    `order` counts both passes: the filter runs forward and backward with half of it each, so
    an edge falls with 6 dB times `order` an octave and the amplitude at a corner is 1/2.

    >>> slow = Record("slow", 0.01, np.ones(2000))
    >>> bool(abs(band_passed(slow, 0.5, 20.0).acceleration_m_s2[500:1500]).max() < 0.1)
    True
    """
    rate_hz = 1.0 / record.time_step_s
    if not LOWEST_HZ <= low_hz < high_hz < 0.5 * rate_hz:
        raise InputError(
            f"band {low_hz!r} to {high_hz!r} Hz; expected {LOWEST_HZ:g} <= low < high <"
            f" {0.5 * rate_hz:g} Hz, half the sampling rate of {record.name}"
        )
    if order not in range(2, 21, 2):
        raise InputError(f"filter order {order!r}; expected 2, 4, ... 20: two passes share it")
    edge = 3 * (int(order) + 1)
    if record.acceleration_m_s2.size <= edge:
        raise InputError(
            f"{record.name}: {record.acceleration_m_s2.size} samples are too few for a filter of"
            f" order {order}; expected a longer record"
        )
    corners = low_hz * record.time_step_s, high_hz * record.time_step_s
    filtered = samples.band_passed(record.acceleration_m_s2, corners, int(order) // 2, edge)
    return replace(record, acceleration_m_s2=filtered)


def whole_steps(interval_s: float, max_step_s: float) -> int:
    """Smallest number of equal steps, none above max_step [s], that fill an interval [s].

    >>> whole_steps(0.05, 0.003)
    17
    """
    check_positive("largest time step [s]", max_step_s)
    # the quotient may be rounded up or down, so the definition has the last word
    steps = max(1, math.ceil(interval_s / max_step_s) - 1)
    while interval_s / steps > max_step_s:
        steps += 1
    return steps


def _shown(record):
    """A piece of input or a foreign message, fit for one line."""
    text = str(record)
    return repr(text if len(text) <= 60 else text[:57] + "...")


def _datetime(start_utc):
    moment = datetime.fromisoformat(start_utc)
    return moment.astimezone(UTC) if moment.tzinfo else moment.replace(tzinfo=UTC)


def _utc(start_utc, later_s, where):
    """An ISO 8601 time, moved by some seconds, with microseconds and a Z; "" stays ""."""
    if not start_utc:
        return ""
    try:
        moment = _datetime(start_utc) + timedelta(seconds=later_s)
    except ValueError:
        raise InputError(
            f"{where}: start time {_shown(start_utc)}; expected such as 2018-01-08T14:00:37Z"
        ) from None
    return moment.strftime("%Y-%m-%dT%H:%M:%S.%fZ")
