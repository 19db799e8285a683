"""Formats of records that are not read, known by how their files begin, and by what they are converted."""

import re

_OBSPY = "read it with ObsPy (obspy.read) and write time and acceleration as CSV"
_GMPROCESS = "read it with gmprocess and write time and acceleration as CSV"

FOREIGN = (
    ("COSMOS", rb"[^\r\n]*\(Format v\d", _GMPROCESS),
    ("SMC (USGS)", rb"[0-9*] (?:UN)?CORRECTED ACCELEROGRAM", _GMPROCESS),
    ("USC", rb"[^\r\n]*FILE +\d+ OF UNCORRECTED ACCELEROGRAM|CORRECTED ACCELEROGRAM  \w+ +[\d.]+ COMP", _GMPROCESS),
    ("GeoNet V1A/V2A", rb"(?:Unc|C)orrected accelerogram[^\r\n]*GNS Science", _GMPROCESS),
    ("CSMIP (V1, V2, V3), RENADIC", rb"(?i:(?:un)?corrected accelerogram|response and fourier amplitude)", _GMPROCESS),
    ("BHRC (Iran)", rb"\* ?VOL", _GMPROCESS),
    ("K-NET, KiK-net", rb"Origin Time  ", _OBSPY),
    ("ESM, ITACA (DYNA)", rb"EVENT_NAME:", "cut its 64 header lines (tail -n +65), give --unit cm_s2 and "
     "its SAMPLING_INTERVAL_S as --sample-step"),
    ("AFAD, NSMN (Turkey)", rb"STRONG GROUND MOTION RECORDS? OF TURK", _GMPROCESS),
    ("UNAM (Mexico)", rb"\*{20}[*\s]*INSTITUTO DE INGENIERIA", _GMPROCESS),
    ("SLIST or TSPAIR", rb"TIMESERIES \w", "read it with ObsPy (obspy.read), divide counts by the sensitivity, and "
     "write time and acceleration as CSV"),
    ("GSE2 or IMS1", rb"(?:WID[12]|XW01|BEGIN (?:GSE2|IMS1)|DATA_TYPE WAVEFORM)", _OBSPY),
    ("SAC", rb"(?s:.{304}(?:[\x06\x07]\0\0\0|\0\0\0[\x06\x07])|\s*-?\d+\.\d+(?:\s+-?\d+\.\d+)*\s+-12345\.)", _OBSPY),
    ("Kinemetrics EVT", rb"KMI", _OBSPY),
    ("SEG-Y", rb"C 1 CLIENT|\xc3\x40\xf1", _OBSPY),
    ("HDF5, as ASDF", rb"\x89HDF", "read it with the program that wrote it, and write time and acceleration as CSV"),
    ("MATLAB", rb"MATLAB \d", "read it with scipy.io.loadmat, and write time and acceleration as CSV"),
    ("NumPy", rb"\x93NUMPY", "read it with numpy.load, and write time and acceleration as CSV"),
    ("spreadsheet or ZIP", rb"PK\x03\x04|\xd0\xcf\x11\xe0", "unpack it, or save the sheet as CSV"),
    ("gzip", rb"\x1f\x8b", "unpack it with gunzip"),
    ("PDF", rb"%PDF", "it is a document; fetch the record"),
    ("web page", rb"\s*<(?i:!doctype html|html)", "the download was answered by a page; log in, and fetch it anew"),
    ("XML, as StationXML or QuakeML", rb"\s*<\?xml", "it is no waveform; give the record beside it"),
)
"""(format, how a file begins, what to do with it); docs/guides/own-record.md has a row for each."""

_KNOWN = [(name, re.compile(begins), correction) for name, begins, correction in FOREIGN]


def foreign(data: bytes) -> tuple[str, str] | None:
    """The format of a file's bytes, where it is one of FOREIGN, and what to do with it.

    >>> foreign(b"Origin Time       2018/01/24 19:51:00")[0]
    'K-NET, KiK-net'
    """
    data = data.removeprefix(b"\xef\xbb\xbf")
    return next(((name, correction) for name, begins, correction in _KNOWN if begins.match(data)), None)
