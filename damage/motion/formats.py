"""Formats of ground-motion files, a table, and reading a record in any of them."""

import hashlib
import re
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from inspect import signature
from pathlib import Path
from typing import NamedTuple

from damage.checks import check_choice, check_file, check_path
from damage.errors import InputError, did_you_mean
from damage.files import DATA, encoding_of, is_there
from damage.motion import at2, columns, miniseed
from damage.motion.columns import UNITS_M_S2, check_step, record_name
from damage.motion.record import MOST_MB, Record

_OPTIONS = {"unit": "--unit", "sample_step_s": "--sample-step", "response": "a response"}
"""What may say how a file is to be read."""
HEAD = 10_000
"""Bytes of a file in which its format is looked for."""


class Format(NamedTuple):
    """A format of record files.

    name: of the format;
    begins: regular expression of how a file begins, one character a byte unless it is in UTF-16;
    help: how it is read, or what to do with a file where the format is not read; documents show it;
    read: function of a path and the file's bytes that returns a Record, or None; its further
        arguments, of _OPTIONS, are what such a file does not say;
    suffixes: of files that have this format however they begin.
    """

    name: str
    begins: str
    help: str
    read: Callable | None = None
    suffixes: tuple[str, ...] = ()


_CSV = "write time and acceleration as CSV"
_OBSPY = f"read it with ObsPy (obspy.read) and {_CSV}"
_COUNTS = f"read it with ObsPy (obspy.read), divide counts by the sensitivity, and {_CSV}"
_GMPROCESS = f"read it with gmprocess and {_CSV}"
FORMATS = (
    Format(
        "miniSEED",
        r"\d{6}[DRQM][ \0]|MS\x03",
        "with its StationXML, `NET.STA.xml`, beside it; needs ObsPy",
        miniseed.read,
        (".mseed", ".miniseed", ".msd"),
    ),
    Format("COSMOS", r"[^\r\n]*\(Format v\d", _GMPROCESS),
    Format("SMC (USGS)", r"[0-9*] (?:UN)?CORRECTED ACCELEROGRAM", _GMPROCESS),
    Format(
        "USC",
        r"[^\r\n]*FILE +\d+ OF UNCORRECTED ACCELEROGRAM|CORRECTED ACCELEROGRAM  \w+ +[\d.]+ COMP",
        _GMPROCESS,
    ),
    Format("GeoNet V1A/V2A", r"(?:Unc|C)orrected accelerogram[^\r\n]*GNS Science", _GMPROCESS),
    Format(
        "CSMIP (V1, V2, V3), RENADIC",
        r"(?i:(?:un)?corrected accelerogram|response and fourier amplitude)",
        _GMPROCESS,
    ),
    Format("BHRC (Iran)", r"\* ?VOL", _GMPROCESS),
    Format("K-NET, KiK-net", r"Origin Time  ", _OBSPY),
    Format(
        "ESM, ITACA (DYNA)",
        r"EVENT_NAME:",
        "cut its 64 header lines (tail -n +65 FILE), give --unit cm_s2 and its SAMPLING_INTERVAL_S"
        " as --sample-step",
    ),
    Format("AFAD, NSMN (Turkey)", r"STRONG GROUND MOTION RECORDS? OF TURK", _GMPROCESS),
    Format("UNAM (Mexico)", r"\*{20}[*\s]*INSTITUTO DE INGENIERIA", _GMPROCESS),
    Format("SLIST or TSPAIR", r"TIMESERIES \w", _COUNTS),
    Format("GSE2 or IMS1", r"(?:WID[12]|XW01|BEGIN (?:GSE2|IMS1)|DATA_TYPE WAVEFORM)", _COUNTS),
    Format(
        "SAC",
        r"(?s:.{304}(?:[\x06\x07]\0\0\0|\0\0\0[\x06\x07])|\s*-?\d+\.\d+(?:\s+-?\d+\.\d+)*\s+-12345\.)",
        f"{_OBSPY}; its header names no unit",
    ),
    Format("Kinemetrics EVT", r"KMI", _OBSPY),
    Format("SEG-Y", r"C 1 CLIENT|\xc3\x40\xf1", _OBSPY),
    Format("HDF5, as ASDF", r"\x89HDF", f"read it with the program that wrote it, and {_CSV}"),
    Format("MATLAB", r"MATLAB \d", f"read it with scipy.io.loadmat, and {_CSV}"),
    Format("NumPy", r"\x93NUMPY", f"read it with numpy.load, and {_CSV}"),
    Format(
        "spreadsheet or ZIP", r"PK\x03\x04|\xd0\xcf\x11\xe0", "unpack it, or save the sheet as CSV"
    ),
    Format("gzip", r"\x1f\x8b", "unpack it with gunzip"),
    Format("PDF", r"%PDF", "it is a document; fetch the record"),
    Format(
        "web page",
        r"\s*<(?i:!doctype html|html)",
        "the download was answered by a page; log in, and fetch it anew",
    ),
    Format(
        "XML, as StationXML or QuakeML",
        r"\s*<\?xml",
        "it is no waveform; give the record beside it",
    ),
    Format(
        "PEER AT2",
        at2.BEGINS,
        "header of up to 12 lines with NPTS and DT; a line says `IN UNITS OF G` or `IN G`;"
        " otherwise `--unit`",
        at2.read,
        (".at2",),
    ),
    Format(
        "CSV",
        "",
        "or text with tabulators or blanks: time [s] and acceleration; header `Time (s);Acc"
        " (cm/s2)`, `time_s,acc_gal`, or the same behind `#`, as `numpy.savetxt` writes it right"
        " above the rows (other comments are not read); decimal commas; UTF-8 or UTF-16; Fortran's"
        " `1.0D-02`",
        columns.read,
    ),
)
"""A file has the format of the first row that fits; anything may be CSV."""
READ = [row for row in reversed(FORMATS) if row.read]
"""Formats that are read, the general ones first."""
NAMES = ", ".join(row.name for row in READ)
"""Names of the formats that are read."""


def shipped_record_path(name: str = "BGAR_HGE") -> Path:
    """Path of a record that comes with the package; damage/data/*/README.md say what each is.

    >>> shipped_record_path("BGAR_HGE").name
    'BGAR_HGE_acc_m_s2.csv'
    """
    shipped = shipped_records()
    if name not in shipped:
        raise InputError(
            f"record {name!r} is not shipped; expected one of {', '.join(shipped)}"
            f"{did_you_mean(name, shipped)}"
        )
    return shipped[name]


@cache  # a study asks for each of its runs
def shipped_records() -> dict[str, Path]:
    """{name: path} of the records that come with the package, in the order of their names.

    >>> "BGAR_HGE" in shipped_records()
    True
    """
    shipped = {path.name.split("__")[0]: path for path in DATA.glob("*/*.mseed")}
    shipped |= {record_name(path): path for path in DATA.glob("*/*_acc_m_s2.csv")}
    return dict(sorted(shipped.items()))


def record_path(word: str | Path) -> Path:
    """Path of a record, given by its path or by the name of a record that ships, like BGAR_HGE; a
    file of that name comes first.  What is neither is taken for a path, but for a name without
    ending: InputError.

    >>> record_path("BGAR_HGE").name
    'BGAR_HGE_acc_m_s2.csv'
    """
    path = check_path(word)
    named = shipped_records()
    if str(path) in named and not is_there(path):
        return named[str(path)]
    if not path.suffix and len(path.parts) == 1 and not path.exists():
        raise InputError(
            f"{path}: no such file; expected a record file ({NAMES}), or the name of a record that"
            f" ships: {', '.join(named)}{did_you_mean(path, named)}"
        )
    return path


def format_of(path: str | Path, data: bytes) -> Format:
    """Return the Format of a file's bytes.

    >>> format_of("FILE", b"Origin Time       2018/01/24 19:51:00").name
    'K-NET, KiK-net'
    """
    encoding = encoding_of(data)
    head = data[:HEAD].removeprefix(b"\xef\xbb\xbf")
    text = head.decode("latin-1" if encoding == "utf-8-sig" else encoding, "replace")
    suffix = Path(path).suffix.lower()
    return next(row for row in FORMATS if suffix in row.suffixes or re.match(row.begins, text))


def read_record(
    path: str | Path,
    response: str | Path | None = None,
    unit: str | None = None,
    sample_step_s: float | None = None,
) -> Record:
    """Read one component of acceleration from a file in one of FORMATS.

    path: of the file, or the name of a record that ships (`record_path`).
    `response` is the StationXML of a miniSEED file; without it NET.STA.xml beside the file is
    taken. unit: one of UNITS_M_S2, of a text whose header does not name it; sample_step_s: of one
    that has no times in seconds [s].
    The record holds the SHA-256 of every file that was read: a format that reads further ones names
    theirs in `beside_sha256`.

    >>> record = read_record(shipped_record_path("BGAR_HGE"))
    >>> record.time_step_s, len(record.acceleration_m_s2)
    (0.005, 9304)
    """
    path = record_path(path)
    data = _content(path)
    options = {"unit": unit, "sample_step_s": sample_step_s, "response": response}
    options = {name: value for name, value in options.items() if value is not None}
    if unit is not None:
        check_choice("--unit", unit, UNITS_M_S2)
    kind = format_of(path, data)
    if kind.read is None:
        raise InputError(
            f"{path}: its format is {kind.name}, which is not read; expected"
            f" {NAMES}: {kind.help} (docs/reference/record-formats.md)"
        )
    for name in sorted(set(options) - set(signature(kind.read).parameters)):
        raise InputError(
            f"{path}: {_OPTIONS[name]} of a {kind.name} file: expected what the file says; leave it"
            " out"
        )
    record = kind.read(path, data, **options)
    check_step(path, record.time_step_s)
    options.pop("response", None)
    return replace(record, sha256=hashlib.sha256(data).hexdigest(), given=options)


def _content(path):
    """Bytes of a file that must exist and hold something."""
    try:
        data = check_file(path, f"a record file ({NAMES})", MOST_MB).read_bytes()
    except OSError as error:
        raise InputError(f"{path}: {error.strerror}; expected a file, check the path") from error
    if not data.strip():
        raise InputError(f"{path}: empty; expected a record file ({NAMES})")
    return data
