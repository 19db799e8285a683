"""Ground-motion records: reading them (CSV, PEER AT2, miniSEED) and preparing them.

A `Record` is one component of acceleration at a constant time step. Every function that prepares
one returns a new `Record` and leaves the old one as it was.
"""

import hashlib
import io
import math
import os
import re
import warnings
from dataclasses import dataclass, replace
from datetime import UTC, datetime, timedelta
from pathlib import Path

import numpy as np
from scipy import signal

from damage.errors import InputError
from damage.units import GRAVITY

CSV_UNITS_M_S2 = {"acc_m_s2": 1.0, "acc_g": GRAVITY}
"""Names that the second CSV column may have, and the factor to m/s2."""

TIME_TOLERANCE = 0.01
"""Largest distance of a CSV time from a uniform grid, as a share of the step.

Room for the rounding of the printed times: four decimals at 150 Hz are 0.75 % of the step.
"""

QUIET_S = 2.0
"""The mean of this first part of a miniSEED trace is taken as the instrument's offset [s]."""

ACCELERATION_UNITS = {"M/S**2", "M/S^2", "M/S2", "M/SEC**2", "M/S/S"}
"""Spellings of m/s2 that StationXML files use, in capitals."""

_SHIPPED_FOLDER = Path(__file__).parent / "data"
_MINISEED_START = re.compile(rb"\d{6}[DRQM][ \0]|MS\x03")
_CSV_START_UTC = re.compile(r"#.*\bstart\s+(\d{4}-\d\d-\d\dT[\d:.]+Z?)")
_NUMBER = r"([-+.\dEe]+)"
_AT2_COUNT_AND_STEP = (
    re.compile(rf"NPTS\s*=\s*(\d+)\s*,?\s*DT\s*=\s*{_NUMBER}", re.IGNORECASE),
    re.compile(rf"^\s*(\d+)[\s,]+{_NUMBER}[\s,]+NPTS\s*,\s*DT", re.IGNORECASE),
)
_AT2_NOT_ACCELERATION_IN_G = re.compile(r"VELOCITY|DISPLACEMENT|UNITS OF (?!G\b)", re.IGNORECASE)


@dataclass(frozen=True, eq=False)
class Record:
    """One component of ground acceleration, the first sample at time 0.

    name: short name, such as "NL.BGAR..HGE".
    time_step_s: constant time step [s].
    acceleration_m_s2: (n_samples,) float64, read-only [m/s2].
    start_utc: time of the first sample in ISO 8601, UTC, or "".
    source: path of the file as it was given, or "".
    sha256: checksum of that file's bytes when it was read, or "".
    """

    name: str
    time_step_s: float
    acceleration_m_s2: np.ndarray
    start_utc: str = ""
    source: str = ""
    sha256: str = ""

    def __post_init__(self):
        where = self.source or self.name or "record"
        if not (math.isfinite(self.time_step_s) and self.time_step_s > 0):
            raise InputError(f"{where}: time step {self.time_step_s!r} s; expected above 0")
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
        acceleration.setflags(write=False)
        object.__setattr__(self, "acceleration_m_s2", acceleration)
        object.__setattr__(self, "start_utc", _utc(self.start_utc, 0.0, where))

    @property
    def duration_s(self) -> float:
        """Time from the first to the last sample [s]."""
        return (self.acceleration_m_s2.size - 1) * self.time_step_s

    @property
    def time_s(self) -> np.ndarray:
        """Times of the samples, (n_samples,) [s]."""
        return np.arange(self.acceleration_m_s2.size) * self.time_step_s


def shipped_record_path(name: str = "BGAR_HGE") -> Path:
    """Path of a record that comes with the package; damage/data/*/README.md say what each is."""
    shipped = {path.name.split("__")[0]: path for path in _SHIPPED_FOLDER.glob("*/*.mseed")}
    shipped |= {_csv_name(path): path for path in _SHIPPED_FOLDER.glob("*/*.csv")}
    if name not in shipped:
        known = ", ".join(sorted(shipped))
        raise InputError(f"record {name!r} is not shipped; expected one of {known}")
    return shipped[name]


def read_record(path, response=None) -> Record:
    """Read one component of acceleration from a CSV, PEER AT2 or miniSEED file.

    The suffix decides (.csv, .at2, .mseed), or the content where it says nothing. `response` is
    the StationXML of a miniSEED file; without it NET.STA.xml beside the file is taken.
    """
    data = _content(path)
    suffix = Path(path).suffix.lower()
    if suffix in (".mseed", ".miniseed", ".msd") or _MINISEED_START.match(data):
        record = _read_miniseed(path, data, response)
    else:
        # a comment may be in any encoding; a binary file fails as a line that is not numeric
        lines = data.decode("utf-8-sig", errors="replace").splitlines()
        like_at2 = suffix != ".csv" and len(lines) > 3 and _at2_count_and_step(lines[3])
        read = _read_at2 if suffix == ".at2" or like_at2 else _read_csv
        record = read(path, lines)
    return replace(record, sha256=hashlib.sha256(data).hexdigest())


def write_csv(record: Record, path, comments=()) -> Path:
    """Write a record as CSV in m/s2 with seven digits, each comment on a line of its own.

    Time has four decimals, so the time step must be a multiple of 0.1 ms.
    """
    rows = (f"{t:.4f},{a:.6e}" for t, a in zip(record.time_s, record.acceleration_m_s2, strict=True))
    lines = [*(f"# {comment}" for comment in comments), "time_s,acc_m_s2", *rows]
    unfinished = Path(path).with_name(f".{Path(path).name}.{os.getpid()}.tmp")
    try:
        unfinished.write_text("\n".join(lines) + "\n")
        os.replace(unfinished, path)
    except OSError as error:
        raise InputError(f"cannot write {path}: {error.strerror}; choose another place") from error
    finally:
        unfinished.unlink(missing_ok=True)
    return Path(path)


def scaled(record: Record, factor: float) -> Record:
    """The record times a factor; a negative one turns its direction."""
    if not math.isfinite(factor):
        raise InputError(f"scale factor {factor!r}; expected a finite number such as 1.5")
    return replace(record, acceleration_m_s2=record.acceleration_m_s2 * factor)


def windowed(record: Record, t0_s: float, t1_s: float) -> Record:
    """The samples nearest to t0 up to those nearest to t1, both included; time restarts at 0."""
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
    start_utc = _utc(record.start_utc, first * record.time_step_s, record.name)
    cut = record.acceleration_m_s2[first : last + 1]
    return replace(record, acceleration_m_s2=cut, start_utc=start_utc)


def aligned_with(record: Record, reference: Record) -> Record:
    """The part of a record that covers the same time as another one, by their start_utc."""
    early_s = start_difference_s(reference, record)
    spare_s = record.duration_s - reference.duration_s
    half_step_s = 0.5 * record.time_step_s
    if not -half_step_s < early_s < spare_s + half_step_s:
        raise InputError(
            f"{record.name} starts {early_s:g} s before {reference.name} and is {spare_s:g} s"
            f" longer; expected it to cover the other, cut {reference.name} with windowed() first"
        )
    early_s = max(early_s, 0.0)
    return windowed(record, early_s, early_s + reference.duration_s)


def start_difference_s(record: Record, other: Record) -> float:
    """Start of a record minus the start of another one [s]."""
    for one in (record, other):
        if not one.start_utc:
            raise InputError(f"{one.name} has no start time; expected start_utc in ISO 8601")
    return (_datetime(record.start_utc) - _datetime(other.start_utc)).total_seconds()


def baseline_corrected(record: Record, order: int = 1) -> Record:
    """The record minus its least-squares polynomial of the given order (0: minus the mean)."""
    if order not in range(min(10, record.acceleration_m_s2.size)):
        raise InputError(
            f"baseline order {order!r} for {record.acceleration_m_s2.size} samples;"
            " expected a whole number from 0 to 9 and below the number of samples"
        )
    fit = np.polynomial.Polynomial.fit(record.time_s, record.acceleration_m_s2, int(order))
    return replace(record, acceleration_m_s2=record.acceleration_m_s2 - fit(record.time_s))


def band_passed(record: Record, low_hz: float, high_hz: float, order: int = 4) -> Record:
    """Zero-phase Butterworth band-pass between two corners [Hz].

    `order` counts both passes: the filter runs forward and backward with half of it each, so
    an edge falls with 6 dB times `order` an octave and the amplitude at a corner is 1/2.
    """
    rate_hz = 1.0 / record.time_step_s
    if not 0 < low_hz < high_hz < 0.5 * rate_hz:
        raise InputError(
            f"band {low_hz!r} to {high_hz!r} Hz; expected 0 < low < high < {0.5 * rate_hz:g} Hz,"
            f" half the sampling rate of {record.name}"
        )
    if order not in range(2, 21, 2):
        raise InputError(f"filter order {order!r}; expected 2, 4, ... 20: two passes share it")
    sos = signal.butter(int(order) // 2, (low_hz, high_hz), "bandpass", fs=rate_hz, output="sos")
    try:
        filtered = signal.sosfiltfilt(sos, record.acceleration_m_s2)
    except ValueError as error:
        raise InputError(
            f"{record.name}: {record.acceleration_m_s2.size} samples are too few for a filter of"
            f" order {order}; expected a longer record"
        ) from error
    return replace(record, acceleration_m_s2=filtered)


def steps_per_sample(record: Record, max_step_s: float) -> int:
    """Smallest whole number n with time_step / n <= max_step.

    With the step time_step / n every sample falls on a step: linear interpolation loses no peak.
    """
    return whole_steps(record.time_step_s, max_step_s)


def whole_steps(interval_s: float, max_step_s: float) -> int:
    """Smallest number of equal steps, none above max_step [s], that fill an interval [s]."""
    if not (math.isfinite(max_step_s) and max_step_s > 0):
        raise InputError(f"largest time step {max_step_s!r} s; expected a positive number")
    # the quotient may be rounded up or down, so the definition has the last word
    steps = max(1, math.ceil(interval_s / max_step_s) - 1)
    while interval_s / steps > max_step_s:
        steps += 1
    return steps


def _read_csv(path, lines: list[str]) -> Record:
    """Two columns, time [s] and acceleration, after comments and a header (without: m/s2)."""
    rows = [(i, line) for i, line in enumerate(lines, 1) if line.split("#")[0].strip()]
    has_header = bool(rows) and not any(map(_is_number, rows[0][1].split(",")))
    to_m_s2 = _header_unit(path, *rows.pop(0)) if has_header else 1.0
    if len(rows) < 2:
        raise InputError(f"{path}: {len(rows)} data rows; expected 2 or more of time_s,acc_m_s2")
    values = np.array([_csv_row(path, number, line) for number, line in rows])
    step_s = _uniform_step(path, [number for number, _ in rows], values[:, 0])
    found = filter(None, map(_CSV_START_UTC.match, lines))
    start_utc = next((_utc(start.group(1), float(values[0, 0]), path) for start in found), "")
    return Record(_csv_name(path), step_s, values[:, 1] * to_m_s2, start_utc, str(path))


def _csv_name(path) -> str:
    """Name of a record by its file's: without the quantity and unit at the end."""
    return re.sub(r"_acc_(m_s2|g)$", "", Path(path).stem)


def _header_unit(path, number: int, line: str) -> float:
    """Factor from the header's unit to m/s2."""
    cells = [cell.strip().lower() for cell in line.split(",")]
    if len(cells) != 2 or cells[0] != "time_s" or cells[1] not in CSV_UNITS_M_S2:
        expected = "the header time_s,acc_m_s2 or time_s,acc_g, convert the columns to these units"
        raise _bad_line(path, number, line, "is an unknown header", expected)
    return CSV_UNITS_M_S2[cells[1]]


def _csv_row(path, number: int, line: str) -> list[float]:
    """Time [s] and acceleration [unit of the header] of one line."""
    values = _numbers(path, number, line, ",")
    if len(values) != 2:
        expected = "two, time and acceleration, parted by one comma"
        raise _bad_line(path, number, line, f"has {len(values)} column(s)", expected)
    return values


def _uniform_step(path, line_numbers: list[int], time_s: np.ndarray) -> float:
    """The constant step [s] of a time column (n_samples,)."""
    steps = np.diff(time_s)
    if (steps <= 0).any():
        k = int(np.argmax(steps <= 0))
        raise InputError(
            f"{path}: line {line_numbers[k + 1]}: time {time_s[k + 1]:g} s after {time_s[k]:g} s;"
            " expected times that increase, sort the rows"
        )
    step = (time_s[-1] - time_s[0]) / steps.size
    off_grid = np.abs(time_s - time_s[0] - step * np.arange(time_s.size))
    if off_grid.max() > TIME_TOLERANCE * step:
        usual = np.median(steps)
        k = int(np.argmax(np.abs(steps - usual)))
        raise InputError(
            f"{path}: line {line_numbers[k + 1]}: a step of {steps[k]:g} s among {usual:g} s;"
            f" expected uniform times within {TIME_TOLERANCE:.0%} of the step, resample the record"
        )
    # twelve digits: the 0.01 s that was meant, not the nearest double of 0.29 s / 29
    return float(f"{step:.12g}")


def _read_at2(path, lines: list[str]) -> Record:
    """PEER strong-motion database: four header lines, then values in g, several a line."""
    units, counts = [*lines[2:4], "", ""][:2]
    found = _at2_count_and_step(counts)
    if not found:
        expected = "a PEER AT2 header such as NPTS= 4000, DT= .0050 SEC"
        raise _bad_line(path, 4, counts, "gives no NPTS and DT", expected)
    if _AT2_NOT_ACCELERATION_IN_G.search(units):
        expected = "ACCELERATION IN UNITS OF G, give the record's AT2 file"
        raise _bad_line(path, 3, units, "is another quantity", expected)
    values = [value for i, line in enumerate(lines[4:], 5) for value in _numbers(path, i, line)]
    count, step_s = found
    if len(values) != count:
        raise InputError(
            f"{path}: {len(values)} values; expected the NPTS = {count} of line 4, fetch it anew"
        )
    return Record(Path(path).stem, step_s, np.array(values) * GRAVITY, "", str(path))


def _at2_count_and_step(line: str) -> tuple[int, float] | None:
    """NPTS and DT [s] of a fourth header line in either of PEER's orders, or None."""
    for pattern in _AT2_COUNT_AND_STEP:
        found = pattern.search(line)
        if found and _is_number(found.group(2)):
            return int(found.group(1)), float(found.group(2))
    return None


def _read_miniseed(path, data: bytes, response) -> Record:
    """Counts over the instrument's overall sensitivity, minus the mean of the first 2 s."""
    obspy = _obspy(path)
    trace = _only_trace(obspy, path, data)
    beside = Path(path).parent / f"{trace.stats.network}.{trace.stats.station}.xml"
    sensitivity = _sensitivity(obspy, Path(response) if response else beside, trace)
    counts = trace.data.astype(np.float64)
    quiet = round(QUIET_S / trace.stats.delta)
    if counts.size < quiet:
        raise InputError(
            f"{path}: {counts.size} samples; expected {quiet} or more, as the mean of the first"
            f" {QUIET_S:g} s is the instrument's offset"
        )
    acceleration = (counts - counts[:quiet].mean()) / sensitivity
    start_utc = str(trace.stats.starttime)
    return Record(trace.id, trace.stats.delta, acceleration, start_utc, str(path))


def _obspy(path):
    """The obspy module, which nothing but miniSEED needs."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # obspy's own deprecations are not the user's
            import obspy
    except ImportError:
        raise InputError(
            f"{path}: miniSEED is read with obspy, which is missing;"
            " run pip install obspy (the extra masonry-damage[obspy]) or give the record as CSV"
        ) from None
    return obspy


def _only_trace(obspy, path, data: bytes):
    """The one trace of a miniSEED file, its contiguous parts joined."""
    try:
        stream = obspy.read(io.BytesIO(data), format="MSEED").merge(method=-1)
    except Exception as error:  # obspy lets errors of several libraries through
        raise InputError(
            f"{path}: obspy says {_shown(error)}; expected miniSEED, fetch the file anew"
        ) from error
    components = sorted({trace.id for trace in stream})
    if len(components) != 1:
        raise InputError(f"{path}: holds {', '.join(components)}; expected one a file, split it")
    if len(stream) != 1:
        before, after = stream.get_gaps()[0][4:6]
        raise InputError(
            f"{path}: gap or overlap between {before} and {after};"
            " expected an unbroken record, cut the file to one side of it"
        )
    return stream[0]


def _sensitivity(obspy, station_xml: Path, trace) -> float:
    """Overall sensitivity of the trace's instrument [counts per m/s2]."""
    if not station_xml.is_file():
        raise InputError(
            f"{station_xml}: no such file; expected the StationXML of {trace.id} there,"
            " or another path given as response"
        )
    try:
        inventory = obspy.read_inventory(io.BytesIO(station_xml.read_bytes()))
        found = inventory.get_response(trace.id, trace.stats.starttime).instrument_sensitivity
    except Exception as error:  # obspy raises a bare Exception where no channel matches
        raise InputError(
            f"{station_xml}: obspy says {_shown(error)};"
            f" expected the StationXML of {trace.id} at {trace.stats.starttime}"
        ) from error
    units = str(found.input_units).upper() if found and found.value else "no sensitivity"
    if units not in ACCELERATION_UNITS:
        raise InputError(
            f"{station_xml}: {units} of {trace.id}; expected the sensitivity of an accelerometer"
            " in counts per M/S**2, give an acceleration channel"
        )
    return found.value


def _content(path) -> bytes:
    """Bytes of a file that must exist and hold something."""
    if Path(path).is_dir():
        raise InputError(f"{path}: a directory; expected a record file (CSV, AT2 or miniSEED)")
    try:
        data = Path(path).read_bytes()
    except OSError as error:
        raise InputError(f"{path}: {error.strerror}; expected a file, check the path") from error
    if not data.strip():
        raise InputError(f"{path}: empty; expected a record file (CSV, AT2 or miniSEED)")
    return data


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True


def _numbers(path, number: int, line: str, separator: str | None = None) -> list[float]:
    """The finite numbers of one line, parted by a separator (None: by spaces)."""
    cells = line.split(separator)
    if not all(map(_is_number, cells)):
        raise _bad_line(path, number, line, "is not numeric", "numbers; comments start with #")
    values = [float(cell) for cell in cells]
    if not all(map(math.isfinite, values)):
        raise _bad_line(path, number, line, "is not finite", "no NaN or inf, fill or cut the gap")
    return values


def _bad_line(path, number: int, line: str, problem: str, expected: str) -> InputError:
    return InputError(f"{path}: line {number}: {_shown(line)} {problem}; expected {expected}")


def _shown(found) -> str:
    """A piece of input or a foreign message, fit for one line."""
    text = str(found)
    return repr(text if len(text) <= 60 else text[:57] + "...")


def _datetime(start_utc: str) -> datetime:
    moment = datetime.fromisoformat(start_utc)
    return moment.astimezone(UTC) if moment.tzinfo else moment.replace(tzinfo=UTC)


def _utc(start_utc: str, later_s: float, where) -> str:
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
