"""miniSEED: counts of a digitiser, and the StationXML that says what a count is."""

import hashlib
import io
import math
import sys
import warnings
from pathlib import Path

import numpy as np

from damage.checks import check_file
from damage.errors import InputError
from damage.motion.record import MOST_MB, Record, _shown

QUIET_S = 2.0
"""The mean of this first part of a miniSEED trace is taken as the instrument's offset [s]."""

ACCELERATION_UNITS = {"M/S**2", "M/S^2", "M/S2", "M/SEC**2", "M/S/S"}
"""Spellings of m/s2 that StationXML files use, in capitals."""
COUNTS_UNITS = {"COUNTS", "COUNT"}
"""Units of a digitiser's counts."""
SENSITIVITY_TOLERANCE = 0.05
"""Largest difference of an overall sensitivity from the product of its stages' gains, as a share:
room for gains at several frequencies."""


def read(path, data, response=None):
    """Return the Record of counts over the instrument's overall sensitivity, minus the mean of the
    first 2 s; response: the StationXML, by default NET.STA.xml beside the file."""
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
        unit="counts (sensitivity in the StationXML)",
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
    sensitivity = response.instrument_sensitivity
    units = (
        str(sensitivity.input_units).upper()
        if sensitivity and sensitivity.value and math.isfinite(sensitivity.value)
        else "no sensitivity"
    )
    if units not in ACCELERATION_UNITS:
        raise InputError(
            f"{station_xml}: {units} of {trace.id}; expected the sensitivity of an accelerometer"
            " in counts per M/S**2, give an acceleration channel"
        )
    _check_sensitivity(
        f"{station_xml}: sensitivity of {trace.id}", sensitivity, response.response_stages
    )
    return sensitivity.value, hashlib.sha256(text).hexdigest()


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
    """Return XML that declares no document type, by which entities could stand for other files or
    for any length; raises ValueError for any other."""
    from lxml import etree  # obspy brings it

    parser = etree.XMLParser(resolve_entities=False, no_network=True, load_dtd=False)
    if etree.fromstring(xml, parser).getroottree().docinfo.doctype:
        raise ValueError("it declares a document type (DOCTYPE)")
    return xml


def _quietly(path, wanted, read):
    """The result of `read()`, which uses obspy; its errors, printed errors and warnings become an
    InputError."""
    problems = []
    hook = sys.unraisablehook
    # in what its C code calls
    sys.unraisablehook = lambda problem: problems.append(problem.exc_value)
    try:
        with warnings.catch_warnings(record=True) as warned:
            warnings.simplefilter("always")
            stream = read()
    except Exception as error:  # obspy lets errors of several libraries through
        raise InputError(f"{path}: obspy says {_shown(error)}; expected {wanted}") from error
    finally:
        sys.unraisablehook = hook
    # what obspy warns of
    problems += [warning.message for warning in warned if issubclass(warning.category, UserWarning)]
    if problems:
        raise InputError(f"{path}: obspy says {_shown(problems[0])}; expected {wanted}")
    return stream
