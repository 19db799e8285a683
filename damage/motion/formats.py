"""Ground-motion files: reading them (CSV and plain text, PEER AT2, miniSEED) and writing CSV."""

import hashlib
import io
import math
import re
import sys
import warnings
from dataclasses import replace
from functools import cache, lru_cache
from pathlib import Path

import numpy as np

from damage.checks import check_choice, check_file, check_path
from damage.csv_table import as_float, is_number
from damage.errors import InputError, did_you_mean, warn
from damage.files import DATA, is_there, text_lines
from damage.motion.columns import UNITS_M_S2, bad_line, check_step, numbers, read_columns
from damage.motion.record import MOST_SAMPLES, Record, _shown, _utc

MOST_MB, MOST_LINES = 50, 2 * MOST_SAMPLES
"""Size of a record's file, and lines of one that is text."""

QUIET_S = 2.0
"""The mean of this first part of a miniSEED trace is taken as the instrument's offset [s]."""

ACCELERATION_UNITS = {"M/S**2", "M/S^2", "M/S2", "M/SEC**2", "M/S/S"}
"""Spellings of m/s2 that StationXML files use, in capitals."""
COUNTS_UNITS = {"COUNTS", "COUNT"}
"""Those of a digitiser's counts."""
SENSITIVITY_TOLERANCE = 0.05
"""Largest difference of an overall sensitivity from the product of its stages' gains, as a share:
room for gains at several frequencies."""

_MINISEED_START = re.compile(rb"\d{6}[DRQM][ \0]|MS\x03")
_CSV_START_UTC = re.compile(r"#.*\bstart\s+(\d{4}-\d\d-\d\dT[\d:.]+Z?)")


def shipped_record_path(name="BGAR_HGE"):
    """Path of a record that comes with the package; damage/data/*/README.md say what each is."""
    shipped = shipped_records()
    if name not in shipped:
        raise InputError(
            f"record {name!r} is not shipped; expected one of {', '.join(shipped)}"
            f"{did_you_mean(name, shipped)}"
        )
    return shipped[name]


@cache  # a study asks for each of its runs
def shipped_records():
    """{name: path} of the records that come with the package, in the order of their names."""
    shipped = {path.name.split("__")[0]: path for path in DATA.glob("*/*.mseed")}
    shipped |= {_csv_name(path): path for path in DATA.glob("*/*_acc_m_s2.csv")}
    return dict(sorted(shipped.items()))


def record_path(word):
    """Path of a record, given by its path or by the name of a record that ships, like BGAR_HGE; a
    file of that name comes first.  What is neither is taken for a path, but for a name without
    ending: InputError."""
    path, named = check_path(word), shipped_records()
    if str(path) in named and not is_there(path):
        return named[str(path)]
    if not path.suffix and len(path.parts) == 1 and not path.exists():
        raise InputError(
            f"{path}: no such file; expected a record file (CSV, AT2 or miniSEED), or the name of a"
            f" record that ships: {', '.join(named)}{did_you_mean(path, named)}"
        )
    return path


def read_record(path, response=None, unit=None, sample_step_s=None):
    """Read one component of acceleration from a CSV, PEER AT2 or miniSEED file.

    path: of the file, or the name of a record that ships (`record_path`).
    The suffix decides (.csv, .at2, .mseed), or the content where it says nothing. `response` is
    the StationXML of a miniSEED file; without it NET.STA.xml beside the file is taken. unit: one of
    UNITS_M_S2, of a text whose header does not name it; sample_step_s: of one that has no times in
    seconds [s].
    The record holds the SHA-256 of every file that was read: a format that reads further ones names
    theirs in `beside_sha256`.
    """
    path = record_path(path)
    data = _content(path)
    given = {
        name: value
        for name, value in (("unit", unit), ("sample_step_s", sample_step_s))
        if value is not None
    }
    if unit is not None:
        check_choice("--unit", unit, UNITS_M_S2)
    if Path(path).suffix.lower() in (".mseed", ".miniseed", ".msd") or _MINISEED_START.match(data):
        if given:
            option = next(iter(given)).removesuffix("_s").replace("_", "-")
            raise InputError(
                f"{path}: --{option} of a miniSEED file: expected what the file and its StationXML"
                " say; leave it out"
            )
        record = replace(
            _read_miniseed(path, data, response), unit="counts (sensitivity in the StationXML)"
        )
        check_step(path, record.time_step_s)
    elif found := foreign(data):
        raise InputError(
            f"{path}: its format is {found[0]}, which is not read; expected CSV, AT2 or miniSEED: "
            f"{found[1]} (docs/reference/record-formats.md)"
        )
    else:
        record = _read_text(path, data, **given)
    return replace(record, sha256=hashlib.sha256(data).hexdigest(), given=given)


# members and lives of a study ask again and again for the components that ship
@lru_cache(maxsize=40)
def _read_text(path, data, unit=None, sample_step_s=None):
    """The record in the text of a CSV or AT2 file."""
    suffix = Path(path).suffix.lower()
    # a comment may be in any encoding; a binary file fails as a line that is not numeric
    lines = text_lines(path, data, MOST_LINES, errors="replace")
    if suffix != ".at2" and (suffix == ".csv" or not is_at2(lines)):
        return _read_csv(path, lines, unit, sample_step_s)
    if sample_step_s is not None:
        raise InputError(
            f"{path}: --sample-step {sample_step_s:g} of an AT2 file: expected the DT of its"
            " header; leave it out"
        )
    return read_at2(path, lines, unit)


def _read_csv(path, lines, unit, sample_step_s):
    """Columns as `damage.motion.columns` reads them: time and acceleration, or acceleration
    alone."""
    step_s, first_s, acceleration_m_s2, unit = read_columns(path, lines, unit, sample_step_s)
    if abs(first_s) > step_s / 2:
        warn(
            f"{path}: times begin at {first_s:g} s, which is 0 s of the record: windows count from"
            " there"
        )
    found = filter(None, map(_CSV_START_UTC.match, lines))
    start_utc = next((_utc(start.group(1), first_s, path) for start in found), "")
    return Record(_csv_name(path), step_s, acceleration_m_s2, start_utc, str(path), unit=unit)


def _csv_name(path):
    """Name of a record by its file's: without the quantity and unit at the end."""
    return re.sub(rf"_acc_({'|'.join(UNITS_M_S2)})$", "", Path(path).stem)


def _read_miniseed(path, data, response):
    """Counts over the instrument's overall sensitivity, minus the mean of the first 2 s."""
    obspy = _obspy(path)
    trace = _only_trace(obspy, path, data)
    beside = Path(path).parent / f"{trace.stats.network}.{trace.stats.station}.xml"
    sensitivity, station_sha256 = _sensitivity(obspy, Path(response) if response else beside, trace)
    counts = _counts(path, trace)
    quiet = round(QUIET_S / trace.stats.delta)
    if counts.size < quiet:
        raise InputError(
            f"{path}: {counts.size} samples; expected {quiet} or more, as the mean of the first"
            f" {QUIET_S:g} s is the instrument's offset"
        )
    with np.errstate(over="ignore"):  # an infinite sample is refused with its number
        acceleration = (counts - counts[:quiet].mean()) / sensitivity
    start_utc = str(trace.stats.starttime)
    return Record(
        trace.id,
        trace.stats.delta,
        acceleration,
        start_utc,
        str(path),
        beside_sha256=(station_sha256,),
    )


def _counts(path, trace):
    """The samples of a trace, float64; InputError of such as no digitiser gives."""
    counts = trace.data.astype(np.float64)
    off = np.abs(np.where(np.isfinite(counts) & (counts != np.round(counts)), counts, 0.0))
    if off.any():
        raise InputError(
            f"{path}: {np.count_nonzero(off)} of {counts.size} samples are no whole numbers, such"
            f" as number {off.argmax()}, {counts[off.argmax()]:.6g}; expected counts, as recorded:"
            " these were filtered or are in a physical unit already; fetch the raw record, or give"
            " it as CSV with its unit"
        )
    return counts


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


def _only_trace(obspy, path, data):
    """The one trace of a miniSEED file, its contiguous parts joined."""
    stream = _quietly(path, "miniSEED, fetch the file anew", lambda: _stream(obspy, data))
    lengths = {trace.stats.mseed.record_length for trace in stream}
    if len(lengths) == 1 and len(data) % max(lengths):
        raise InputError(
            f"{path}: {len(data)} bytes; expected whole records of {max(lengths)} bytes, it is cut"
            " off: fetch the file anew"
        )
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


def _stream(obspy, data):
    """The traces of a miniSEED file, parts that continue each other joined; ValueError where they
    are no numbers, or of times that no calendar has."""
    stream = obspy.read(io.BytesIO(data), format="MSEED")
    for trace in stream.merge(method=-1):
        if trace.data.dtype.kind not in "if":
            raise ValueError("it holds no numbers")
        str(trace.stats.starttime), str(trace.stats.endtime)
    return stream


def _sensitivity(obspy, station_xml, trace):
    """Overall sensitivity of the trace's instrument [counts per m/s2], and the SHA-256 of the file
    that gives it."""
    if not station_xml.is_file():
        raise InputError(
            f"{station_xml}: no such file; expected the StationXML of {trace.id} there,"
            " or another path given as response"
        )
    text = check_file(station_xml, f"the StationXML of {trace.id}", MOST_MB).read_bytes()
    begin = trace.stats.starttime
    response = _quietly(
        station_xml,
        f"the StationXML of {trace.id} at {begin}",
        lambda: obspy.read_inventory(
            io.BytesIO(without_entities(text)), format="STATIONXML"
        ).get_response(trace.id, begin),
    )
    found = response.instrument_sensitivity
    units = (
        str(found.input_units).upper()
        if found and found.value and math.isfinite(found.value)
        else "no sensitivity"
    )
    if units not in ACCELERATION_UNITS:
        raise InputError(
            f"{station_xml}: {units} of {trace.id}; expected the sensitivity of an accelerometer"
            " in counts per M/S**2, give an acceleration channel"
        )
    _check_sensitivity(f"{station_xml}: sensitivity of {trace.id}", found, response.response_stages)
    return found.value, hashlib.sha256(text).hexdigest()


def _check_sensitivity(where, overall, stages):
    """InputError where an overall sensitivity is not in counts, or not what the gains of its stages
    say."""
    gains = [stage.stage_gain for stage in stages if stage.stage_gain is not None]
    product = math.prod(gains)
    by_stages = f" (by the gains of its {len(gains)} stages {product:.7g})" if gains else ""
    if str(overall.output_units).upper() not in COUNTS_UNITS:
        raise InputError(
            f"{where}: {overall.value:.7g} {overall.output_units} per"
            f" {overall.input_units}{by_stages}; expected counts per M/S**2 at the end of all"
            " stages: correct the StationXML, or give the record as CSV with its unit"
        )
    if gains and not abs(overall.value - product) <= SENSITIVITY_TOLERANCE * abs(product):
        raise InputError(
            f"{where}: {overall.value:.7g}, but the gains of its {len(gains)} stages make"
            f" {product:.7g} ({' x '.join(f'{gain:.7g}' for gain in gains)}); expected the same"
            f" within {SENSITIVITY_TOLERANCE:.0%}: one of the two is wrong, correct the StationXML"
        )
    for stage in stages[:1]:
        if stage.input_units and str(stage.input_units).upper() not in ACCELERATION_UNITS:
            raise InputError(
                f"{where} is per {overall.input_units}, but its first stage takes"
                f" {stage.input_units}; expected M/S**2 of both: correct the StationXML"
            )


def without_entities(xml):
    """XML as it is, if it declares no document type: entities could stand for other files or for
    any length."""
    from lxml import etree  # obspy brings it

    parser = etree.XMLParser(resolve_entities=False, no_network=True, load_dtd=False)
    if etree.fromstring(xml, parser).getroottree().docinfo.doctype:
        raise ValueError("it declares a document type (DOCTYPE)")
    return xml


def _quietly(path, wanted, read):
    """The result of `read()`, which uses obspy; its errors, printed errors and warnings become an
    InputError."""
    problems, hook = [], sys.unraisablehook
    # in what its C code calls
    sys.unraisablehook = lambda problem: problems.append(problem.exc_value)
    try:
        with warnings.catch_warnings(record=True) as warned:
            warnings.simplefilter("always")
            found = read()
    except Exception as error:  # obspy lets errors of several libraries through
        raise InputError(f"{path}: obspy says {_shown(error)}; expected {wanted}") from error
    finally:
        sys.unraisablehook = hook
    # what obspy warns of
    problems += [one.message for one in warned if issubclass(one.category, UserWarning)]
    if problems:
        raise InputError(f"{path}: obspy says {_shown(problems[0])}; expected {wanted}")
    return found


def _content(path):
    """Bytes of a file that must exist and hold something."""
    try:
        data = check_file(path, "a record file (CSV, AT2 or miniSEED)", MOST_MB).read_bytes()
    except OSError as error:
        raise InputError(f"{path}: {error.strerror}; expected a file, check the path") from error
    if not data.strip():
        raise InputError(f"{path}: empty; expected a record file (CSV, AT2 or miniSEED)")
    return data


_OBSPY = "read it with ObsPy (obspy.read) and write time and acceleration as CSV"
_GMPROCESS = "read it with gmprocess and write time and acceleration as CSV"

FOREIGN = (
    ("COSMOS", rb"[^\r\n]*\(Format v\d", _GMPROCESS),
    ("SMC (USGS)", rb"[0-9*] (?:UN)?CORRECTED ACCELEROGRAM", _GMPROCESS),
    (
        "USC",
        rb"[^\r\n]*FILE +\d+ OF UNCORRECTED ACCELEROGRAM|CORRECTED ACCELEROGRAM  \w+ +[\d.]+ COMP",
        _GMPROCESS,
    ),
    ("GeoNet V1A/V2A", rb"(?:Unc|C)orrected accelerogram[^\r\n]*GNS Science", _GMPROCESS),
    (
        "CSMIP (V1, V2, V3), RENADIC",
        rb"(?i:(?:un)?corrected accelerogram|response and fourier amplitude)",
        _GMPROCESS,
    ),
    ("BHRC (Iran)", rb"\* ?VOL", _GMPROCESS),
    ("K-NET, KiK-net", rb"Origin Time  ", _OBSPY),
    (
        "ESM, ITACA (DYNA)",
        rb"EVENT_NAME:",
        (
            "cut its 64 header lines (tail -n +65), give --unit cm_s2 and "
            "its SAMPLING_INTERVAL_S as --sample-step"
        ),
    ),
    ("AFAD, NSMN (Turkey)", rb"STRONG GROUND MOTION RECORDS? OF TURK", _GMPROCESS),
    ("UNAM (Mexico)", rb"\*{20}[*\s]*INSTITUTO DE INGENIERIA", _GMPROCESS),
    (
        "SLIST or TSPAIR",
        rb"TIMESERIES \w",
        (
            "read it with ObsPy (obspy.read), divide counts by the sensitivity, and "
            "write time and acceleration as CSV"
        ),
    ),
    ("GSE2 or IMS1", rb"(?:WID[12]|XW01|BEGIN (?:GSE2|IMS1)|DATA_TYPE WAVEFORM)", _OBSPY),
    (
        "SAC",
        rb"(?s:.{304}(?:[\x06\x07]\0\0\0|\0\0\0[\x06\x07])|\s*-?\d+\.\d+(?:\s+-?\d+\.\d+)*\s+-12345\.)",
        _OBSPY,
    ),
    ("Kinemetrics EVT", rb"KMI", _OBSPY),
    ("SEG-Y", rb"C 1 CLIENT|\xc3\x40\xf1", _OBSPY),
    (
        "HDF5, as ASDF",
        rb"\x89HDF",
        "read it with the program that wrote it, and write time and acceleration as CSV",
    ),
    (
        "MATLAB",
        rb"MATLAB \d",
        "read it with scipy.io.loadmat, and write time and acceleration as CSV",
    ),
    ("NumPy", rb"\x93NUMPY", "read it with numpy.load, and write time and acceleration as CSV"),
    ("spreadsheet or ZIP", rb"PK\x03\x04|\xd0\xcf\x11\xe0", "unpack it, or save the sheet as CSV"),
    ("gzip", rb"\x1f\x8b", "unpack it with gunzip"),
    ("PDF", rb"%PDF", "it is a document; fetch the record"),
    (
        "web page",
        rb"\s*<(?i:!doctype html|html)",
        "the download was answered by a page; log in, and fetch it anew",
    ),
    (
        "XML, as StationXML or QuakeML",
        rb"\s*<\?xml",
        "it is no waveform; give the record beside it",
    ),
)
"""(format, how a file begins, what to do with it); docs/reference/record-formats.md has a row for
each."""


def foreign(data):
    """The format of a file's bytes, where it is one of FOREIGN, and what to do with it.

    >>> foreign(b"Origin Time       2018/01/24 19:51:00")[0]
    'K-NET, KiK-net'
    """
    data = data.removeprefix(b"\xef\xbb\xbf")
    return next(
        ((name, correction) for name, begins, correction in FOREIGN if re.match(begins, data)), None
    )


MOST_HEADER = 12
"""Lines of a header: PEER writes four, files that are made of PEER's have up to seven."""

_STEP = r"(?P<step>[-+]?(?:\d+(?:[.,]\d+)?\.?|[.,]\d+)(?:[edED][-+]?\d+)?)"
_COUNT = r"(?P<count>\d{1,12})"
_COUNT_AND_STEP = [
    re.compile(pattern, re.IGNORECASE)
    for pattern in (
        rf"\bNPTS\s*[=:]\s*{_COUNT}\b.*?\bDT\s*[=:]\s*{_STEP}",
        rf"\bDT\s*[=:]\s*{_STEP}.*?\bNPTS\s*[=:]\s*{_COUNT}\b",
        rf"^\s*{_COUNT}[\s,]+{_STEP}[\s,]+NPTS\s*,?\s*DT\b",
        rf"^\s*{_STEP}[\s,]+{_COUNT}[\s,]+DT\s*,?\s*NPTS\b",
    )
]
_IN_G = re.compile(r"\b(?:in|of|are) +\(?g\)? *(?:$|[.,;])", re.IGNORECASE)
"""How a header says the unit: ACCELERATION TIME SERIES IN UNITS OF G."""
_NOT_ACCELERATION = re.compile(r"\b(?:velocity|displacement)\b", re.IGNORECASE)


def is_at2(lines):
    """Whether a text begins as an AT2 file."""
    return any(
        count_and_step(line) for line in lines[:MOST_HEADER] if not line.lstrip().startswith("#")
    )


def read_at2(path, lines, unit=None):
    """The record of an AT2 file's lines; unit: one of UNITS_M_S2 where the header does not name
    g."""
    head = next((k for k, line in enumerate(lines[:MOST_HEADER]) if count_and_step(line)), None)
    if head is None:
        raise bad_line(
            path,
            4,
            [*lines[3:4], ""][0],
            "gives no NPTS and DT",
            "a PEER AT2 header such as NPTS= 4000, DT= .0050 SEC",
        )
    count, step_s = count_and_step(lines[head])
    taken, words = _unit(path, lines[:head] or [""], unit)
    if count > MOST_SAMPLES:
        raise InputError(f"{path}: {count} samples; expected up to {MOST_SAMPLES}, cut the record")
    check_step(path, step_s)
    values = []
    for number, line in enumerate(lines[head + 1 :], head + 2):
        if len(values) < count or any(map(is_number, line.split())):  # not a last line "END"
            values += numbers(path, number, line)
    if len(values) != count:
        raise InputError(
            f"{path}: {len(values)} values; expected the NPTS = {count} of line {head + 1}, fetch"
            " it anew"
        )
    with np.errstate(over="ignore"):  # an infinite sample is refused with its number
        return Record(
            Path(path).stem, step_s, np.array(values) * UNITS_M_S2[taken], "", str(path), unit=words
        )


def _unit(path, head, given):
    """(unit, words that say it and where it was named) by the line of a header that names g, or by
    --unit where none does."""
    for number, line in enumerate(head, 1):
        if _NOT_ACCELERATION.search(line):
            raise bad_line(
                path,
                number,
                line,
                "is another quantity",
                "ACCELERATION IN UNITS OF G, give the record's AT2 file",
            )
    number = next((i for i, line in enumerate(head, 1) if _IN_G.search(line.rstrip())), None)
    if number and given not in (None, "g"):
        raise bad_line(
            path, number, head[number - 1], f"names g, --unit {given}", "the same; leave --unit out"
        )
    if given:
        return given, f"{given} (--unit)"
    if not number:
        raise bad_line(
            path,
            len(head),
            head[-1],
            "does not name g",
            f"ACCELERATION TIME SERIES IN UNITS OF G there, or --unit {'|'.join(UNITS_M_S2)}",
        )
    return "g", f"g (line {number})"


def count_and_step(line):
    """NPTS and DT [s] of a header line in either of PEER's orders, or None.

    >>> lines = "NPTS=  400, DT= 0,005 SEC", "DT= .0050, NPTS= 400", "400 .005 NPTS, DT"
    >>> [count_and_step(line) for line in lines]
    [(400, 0.005), (400, 0.005), (400, 0.005)]
    """
    found = next(filter(None, (pattern.search(line) for pattern in _COUNT_AND_STEP)), None)
    return found and (
        int(found["count"]),
        as_float(found["step"].replace(",", ".").rstrip(".") or "0"),
    )
