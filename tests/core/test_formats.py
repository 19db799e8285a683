"""Record files as others write them: which are read, to the right values, and which are refused.

One Ricker pulse of 0.15 g and 4 Hz, whose PGA and PGV are known, is written in each way that is
read: separators, units in the header or given, times that are no seconds, AT2 of other programs.
"""

import hashlib
import json
import re
import sys

import numpy as np
import pytest
from conftest import REPOSITORY, one_line_error, parsed, refused_with, wall_file, written
from numpy.testing import assert_allclose
from pytest import approx

from damage import Wall
from damage.__main__ import main
from damage.applications.studies.definition import load_study
from damage.applications.studies.inputs import as_json, differences
from damage.files import LONGEST_LINE
from damage.motion import columns
from damage.motion.formats import format_of, read_record, shipped_record_path
from damage.motion.intensity import pga_g, pgv_m_s
from damage.motion.loading import Recorded
from damage.motion.plausible import faint_warnings, implausible_velocity
from damage.motion.record import Record
from damage.motion.sequence import read_sequence
from damage.run.banner import record_lines
from damage.run.options import parse_run
from damage.units import GRAVITY

STEP_S = 0.005
TIME_S = STEP_S * np.arange(400)


def pulse_g(time_s):
    phase = (np.pi * 4.0 * (time_s - 0.6)) ** 2
    return 0.15 * (1 - 2 * phase) * np.exp(-phase)


PULSE_G = pulse_g(TIME_S)
PULSE_GAL = 981 * PULSE_G
PULSE_PGV_CM_S = 5.0155
ROUND_OFF = 1e-12  # relative: a few operations in double precision on numbers of one size
HEAD = "PEER\nQuake, Station, 090\nACCELERATION TIME SERIES IN UNITS OF G\n"
COUNTS = "NPTS= 400, DT= .0050 SEC\n"
K_NET = """Origin Time       1996/08/11 03:12:00
Lat.              38.920
Long.             140.630
Depth. (km)       7
Mag.              5.9
Station Code      AKT013
Station Lat.      39.6069
Station Long.     140.3213
Station Height(m) 34
Record Time       1996/08/11 03:12:39
Sampling Freq(Hz) 200Hz
Duration Time(s)  2
Dir.              E-W
Scale Factor      2000(gal)/8388608
Max. Acc. (gal)   147.15
Last Correction   1996/08/11 03:00:00
Memo.             made up
"""


def rows(times, values, text="{:.3f},{:.6f}\n"):
    return "".join(map(text.format, times, values))


def lines_of_five(values=PULSE_G, one="{: .7E}", between=" "):
    cells = [one.format(value) for value in values]
    return "\n".join(between.join(cells[k : k + 5]) for k in range(0, len(cells), 5)) + "\n"


def record_file(folder, text, encoding="utf-8"):
    """The path of a record with this text, named as an AT2 file where its first word is PEER's."""
    name = "pulse.AT2" if text.startswith("PEER") else "pulse.txt"
    return written(folder / name, text, encoding=encoding)


# --- text that is read ----------------------------------------------------------------------------

SEPARATED = (
    "time_s;acc_gal\n0;12,5\n0,01;-25\n",
    "time_s\tacc_gal\n0\t12,5\n0,01\t-25\n",
    "time_s\tacc_gal\t\n0\t12,5\t\n0,01\t-25\t\n",
    "time [s]  acc [gal]\n 0.00   12.5\n 0.01  -2.5e1\n",
    "time_s acc_gal\n0,00 12,5\n0,01 -25\n",
    "time_s, acc_gal\n0, 12.5\n0.01, -25.\n",
    '"time_s","acc_gal"\n"0,00","12,5"\n"0,01","-25"\n',
    'time_s;acc_gal\n"0,00";"12,5"\n"0,01";"-25"\n',
    "time_s;acc_gal;;\n0;12,5;;\n0,01;-25;;\n",
    "time_s,acc_gal\n0,12.5,\n0.01,-25,\n",
    "time_s,acc_gal\n0,.125D+02\n0.01,-25.0d0\n",
    "time_s,acc_gal\n0,12.5\n0.01,-25\n\x1a",
    "time_s;acc_gal\n0;12,5\n0,01;-25\x1a\x1a",
    "\n\n# by hand\ntime_s,acc_gal\n\n0,12.5\n# middle\n0.01,-25\n",
)
"""12.5 and -25 gal, 0.01 s apart, with separators, decimal commas, quotes, exponents of Fortran,
comments, blank lines and the Ctrl-Z that ended files of DOS."""
UNITS_M_S2 = {
    "time_s,acc_cm_s2": 0.01,
    "Time (s), Acceleration (gal)": 0.01,
    "t [s],a [cm/s²]": 0.01,
    "time [s],acc [cm/s^2]": 0.01,
    "time_s,accel m/s/s": 1.0,
    "time_s,acc_mm_s2": 0.001,
    '"time [s]","acc [m/sec2]"': 1.0,
    " Time_s , acc_g": GRAVITY,
    "t_s,acc_mg": GRAVITY / 1000,
}


@pytest.mark.parametrize("text", SEPARATED)
def test_separators_and_numbers_of_others(text, tmp_path):
    record = read_record(record_file(tmp_path, text))
    assert record.time_step_s == 0.01
    assert_allclose(record.acceleration_m_s2, [0.125, -0.25], rtol=ROUND_OFF)


@pytest.mark.parametrize("header", UNITS_M_S2)
@pytest.mark.parametrize("comment", ["", "# "])
@pytest.mark.parametrize("encoding", ["utf-8", "latin-1"])
def test_the_header_or_the_comment_in_its_place_names_the_unit(header, comment, encoding, tmp_path):
    path = record_file(tmp_path, f"# 2 gal\n{comment}{header}\n0,10\n0.01,-20\n", encoding)
    expected = UNITS_M_S2[header] * np.array([10, -20])
    assert_allclose(read_record(path).acceleration_m_s2, expected, rtol=ROUND_OFF)


@pytest.mark.parametrize(
    "counts",
    [
        "NPTS=     5, DT=   .0050 SEC,",
        "NPTS=5, DT=.00500 SEC",
        "NPTS=  5 , DT= 0.005 SEC",
        "    5    0.0050   NPTS, DT",
        "  5, .005, NPTS, DT",
        "npts= 5, dt= 5.0E-03 sec",
        "DT= .0050 SEC, NPTS= 5",
        "NPTS=  5, DT= 0,005 SEC",
        "NPTS: 5 DT: 5.0D-03",
    ],
)
def test_orders_of_counts_of_at2(counts, tmp_path):
    values = "  .1000000E-01 -.2000000E-01  .3000000E-01\n  .4000000E-01  .5000000E-01\n"
    expected = GRAVITY * np.array([0.01, -0.02, 0.03, 0.04, 0.05])
    for name in ("pulse.AT2", "pulse.at2", "pulse.txt"):
        record = read_record(written(tmp_path / name, f"{HEAD}{counts}\n{values}"))
        assert record.time_step_s == 0.005
        assert record.acceleration_m_s2.tobytes() == expected.tobytes()


BARE = rows(TIME_S, PULSE_G)
IN_G = "time_s,acc_g\n"
ALONE = rows(TIME_S, PULSE_G, "{1:.6f}\n")
TABS = "time_s\tacc_g\n" + rows(TIME_S, PULSE_G, "{:.3f}\t{:.6f}\n")
NO_UNIT = ("#AmplitudeUnit: gal\n#Time Acc\n", "# units: g\n", "# acceleration in g\n")
NO_UNIT += ("# N-S (cm/s/s)\n", "", "time_s,acc\n", "Time,Acc\n", "time (s),acceleration\n")
"""Headers and comments that name no unit of the acceleration."""
NO_SECONDS = (np.arange(1, 401), 5 * np.arange(400), np.round(TIME_S, 2))
FROM_ELSEWHERE = (
    HEAD.replace("OF G", "OF (G)") + COUNTS + lines_of_five(),
    HEAD.replace("OF G", "OF G. FILTER POINTS: HP=0.03 Hz LP=23.6 Hz") + COUNTS + lines_of_five(),
    HEAD + COUNTS + lines_of_five() + "END\n",
    HEAD + COUNTS + lines_of_five().rstrip() + "\x1a",
    "Orig PEER filename\nH1 for rotation: A\nH2 for rotation: B\nangle -37.0\nFN component\n"
    "Acceleration in g\n400 0.0050 NPTS, DT\n" + lines_of_five(),
    "El Centro\n400 points\nformat of 8F10.5, i.e., 8 points across in\na row\nThe units are (g)\n"
    "*** Begin ***\n" + COUNTS + lines_of_five(),
    HEAD + COUNTS + lines_of_five().replace("E", "D"),
    HEAD + COUNTS + lines_of_five(-PULSE_G, "{:+.6E}", ""),
    HEAD + COUNTS + lines_of_five(PULSE_G, "{:+.7f}", ""),
)
"""AT2 files of other programs."""
GAL_AT2 = HEAD.replace("IN UNITS OF G", "(CM/SEC/SEC)") + COUNTS + lines_of_five(PULSE_GAL)
READ = [
    *((text, {}, "g") for text in FROM_ELSEWHERE),
    *((TABS, {"encoding": coding}, "g") for coding in ("utf-16", "utf-16-le", "utf-16-be")),
    (TABS, {"encoding": "utf-8-sig"}, "g"),
    *((header + BARE, {"unit": "g"}, "g") for header in NO_UNIT),
    ("time_s,acc_cm_s2\n" + rows(TIME_S, PULSE_GAL), {"unit": "gal"}, "gal"),
    (GAL_AT2, {"unit": "gal"}, "gal"),
    *((IN_G + rows(times, PULSE_G), {"sample_step_s": STEP_S}, "g") for times in NO_SECONDS),
    (IN_G + BARE, {"sample_step_s": STEP_S}, "g"),
    ("acc_g\n" + ALONE, {"sample_step_s": STEP_S}, "g"),
    ("# acc_g\n" + ALONE, {"sample_step_s": STEP_S}, "g"),
]
"""(text of the pulse, what is given with it, its unit)"""


@pytest.mark.parametrize(("text", "given", "unit"), READ)
def test_the_pulse_is_read_however_it_is_written(text, given, unit, tmp_path):
    given = dict(given)
    path = record_file(tmp_path, text, given.pop("encoding", "utf-8"))
    record = read_record(path, **given)
    assert (pga_g(record), 100 * pgv_m_s(record)) == approx((0.15, PULSE_PGV_CM_S), rel=1e-4)
    assert record.unit.startswith(f"{unit} (") and record.time_step_s == STEP_S
    assert record.given == given and len(record.sha256) == 64


# --- text that is refused -------------------------------------------------------------------------

TWICE = np.sort([*range(40), 8, 9, 10, 11]) / 100
NAMES_NONE = "names no unit of the acceleration; expected a header such as time_s,acc_m_s2, or "
REFUSED = {
    " \n\n": "empty",
    "# only a comment\n": "0 data rows",
    "time_s,acc_m_s2\n0,1\n": "1 data rows",
    "0,1\n0.01,nan\n": "line 2: acceleration = 'nan': expected a finite number",
    "nan,1\n0.01,1\n": "line 1: time = 'nan': expected a finite number",
    "0\n0.01\n": "give --sample-step S",
    "# c\n0,1\n0.01,high\n": "line 3: acceleration = 'high': expected a finite number",
    "0,1\n0.01,\n": "line 2: no acceleration; expected it in every row",
    "0,1\n0.01,2\n0.03,3\n0.04,3\n0.05,3\n": "line 3: a step of 0.02 s among 0.01 s",
    "0.02,1\n0.01,2\n0,3\n": "line 2: time 0.01 s after 0.02 s",
    "0,1\n0.01,2\n0.01,3\n": (
        "line 3: time 0.01 s after 0.01 s; expected times that increase: keep one of the two rows"
    ),
    "0,1\n0.01,2\n0,1\n0.01,2\n": "sort the rows, or keep one of several records",
    IN_G + "".join(2 * line for line in BARE.splitlines(keepends=True)): (
        "line 3: the row before it once more; expected each once"
    ),
    # four rows of forty
    IN_G + rows(TWICE, [0.1] * 44): "line 11: the row before it once more",
    IN_G + rows(TWICE, np.arange(44)): "line 11: time 0.08 s after 0.08 s; expected times that in",
    "0;1;2\n0,01;1;2\n": "line 1: 3 cells; expected 2, time, acceleration",
    "0,00;1,5\n0,01;1.200,5\n": "line 2: acceleration = '1.200,5': expected a finite number",
    "0,00,1,5\n0,01,1,5\n": (
        "line 1: 4 cells; expected 2, time, acceleration; decimal commas need semicolons"
    ),
    "# start 2018-13-45T99:00\ntime_s,acc_g\n0,1\n0.01,2\n": "start time '2018-13-45T99:00'",
    "acc_g\n0\n1\n": "line 2: '0' has one column",
    "time_s,acc_counts\n0,1\n0.01,2\n": "is an unknown header",
    "time_s;acc_g\n0,1\n0.01,2\n": "line 1: 'time_s;acc_g' is an unknown header",
    "acc_g,time_s\n0,1\n0.01,2\n": "expected two columns, separated as the rows: time_s, then",
    "time_ms,acc_g\n0,1\n5,2\n": "expected two columns, separated as the rows: time_s",
    "Time (s);Acc X (cm/s2);Acc Y (cm/s2)\n0,00;1;2\n0,01;1;2\n": (
        "is an unknown header; expected two columns"
    ),
    "\0\1\2\x1b" * 100: "expected",
    **{
        header + BARE: f"'{(header or BARE).splitlines()[header.count('#') // 2]}' {NAMES_NONE}"
        for header in NO_UNIT[:5]
    },
    **{header + BARE: "is an unknown header" for header in NO_UNIT[5:]},
    # times
    IN_G + rows(NO_SECONDS[0], PULSE_G): (
        "times 1, 2, 3, ... are no seconds but sample numbers, or milliseconds at 1000 Hz"
    ),
    IN_G + rows(NO_SECONDS[1], PULSE_G): "times 0, 5, 10, ... are no seconds but milliseconds",
    IN_G + rows(0.06 * np.arange(400), PULSE_G): "a time step of 0.06 s; expected at most 0.05 s",
    IN_G + rows(TIME_S, PULSE_G, "{:.2f},{:.6f}\n"): (
        "times are rounded to 2 decimals: 400 samples from 0 to"
    ),
    IN_G + rows(np.arange(400) / 300, PULSE_G, "{:.2f},{:.6f}\n"): (
        "write times with 3 or more decimals, or give --sample-step S"
    ),
    IN_G + rows(TIME_S, PULSE_G, "{:.1f},{:.6f}\n"): (
        "times are rounded to 1 decimal: 400 samples from 0 to"
    ),
    # a lost sample is no rounding
    IN_G + rows(np.delete(0.01 * np.arange(401), 200), PULSE_G, "{:.2f},{:.6f}\n"): (
        "line 202: a step of 0.02 s among 0.01 s"
    ),
    # one sample is late by a twentieth of the step
    IN_G
    + rows(0.01 * np.arange(400) + 5e-4 * (np.arange(400) == 200), PULSE_G, "{:.4f},{:.6f}\n"): (
        " s among 0.01 s; expected uniform times within 1%"
    ),
    # AT2
    HEAD + "POINTS 5 STEP .005\n.1 .2\n": ("line 4: 'POINTS 5 STEP .005' gives no NPTS and DT"),
    HEAD + "NPTS= 5, DT= E SEC\n": "gives no NPTS and DT",
    HEAD + f"NPTS= {'9' * 5000}, DT= .005 SEC\n.1 .2\n": "NPTS",
    HEAD + "NPTS= 1, DT= .005 SEC\n.1 .2\n": "2 values; expected",
    HEAD + "NPTS= 5, DT= .005 SEC\n.1 .2\n": "2 values; expected the NPTS = 5",
    HEAD + "NPTS= 2, DT= 0 SEC\n.1 .2\n": "time step [s] = 0.0",
    HEAD + "NPTS= 2, DT= 1e-300 SEC\n.1 .2\n": "time step [s] = 1e-300",
    HEAD + "NPTS= 2, DT= 5.0 MSEC\n.1 .2\n": "a time step of 5 s; expected at most 0.05 s",
    HEAD + "NPTS= 2, DT= .005\n.1 NaN\n": "line 5: '.1 NaN' is not finite",
    HEAD + "NPTS= 2, DT= .005 SEC\n.1 1e308\n": "inf",
    HEAD + "NPTS= 2, DT= .005 SEC\n.1 \x1b[31mred\n": "\\x1b",
    HEAD + "NPTS= 2, DT= .005\n0.0012340.001235 0.1\n": (
        "is not numeric; expected a blank between numbers"
    ),
    HEAD + "NPTS= 2, DT= .005\n0.1 ******** 0.2\n": "line 5: '0.1 ******** 0.2' is not numeric",
    HEAD + "NPTS= 2, DT= .005\n0.1 END\n0.2\n": "line 5: '0.1 END' is not numeric",
    HEAD + "NPTS= 2, DT= .005\n0.1 0.2\nEND\n0.3\n": "3 values; expected the NPTS = 2",
    # refused by its count, before the words are met
    HEAD + "NPTS= 1000001, DT= .005 SEC\n.1 words\n": "1000001 samples; expected up to 1000000",
    **{
        HEAD.replace("ACCELERATION TIME SERIES IN UNITS OF G", line) + COUNTS + lines_of_five(): (
            f"line 3: '{line}' {said}"
        )
        for line, said in (
            ("ACCELERATION TIME HISTORY (CM/SEC/SEC)", "names no unit of the acceleration"),
            ("ACCELERATION IN UNITS OF G/10", "names no unit of the acceleration"),
            ("", "names no unit of the acceleration"),
            ("ACCELERATION IN G (CM/SEC/SEC)", "names no unit of the acceleration"),
            ("VELOCITY TIME SERIES IN UNITS OF CM/S", "is another quantity"),
        )
    },
}
"""{text of a record: what is said of it}"""
REFUSED_AS_GIVEN = [
    ("time_s,acc_cm_s2\n" + BARE, {"unit": "g"}, "names cm_s2, --unit g; expected the same unit"),
    (IN_G + BARE, {"unit": "m/s2"}, "expected one of m_s2, cm_s2"),
    (IN_G + BARE, {"sample_step_s": 0.01}, "times step by 0.005 s, --sample-step by 0.01 s"),
    *((IN_G + BARE, {"sample_step_s": step}, "--sample-step") for step in (-1.0, 0.0, np.nan)),
    ("acc_g\n" + ALONE, {"sample_step_s": 0.2}, "time step"),
    (ALONE + "1,2\n", {"unit": "g", "sample_step_s": STEP_S}, "line 401"),
    (HEAD + COUNTS + lines_of_five(), {"unit": "gal"}, "names g, --unit gal"),
    (
        HEAD + COUNTS,
        {"sample_step_s": STEP_S},
        "--sample-step of a PEER AT2 file: expected what the file says",
    ),
]


@pytest.mark.parametrize("text", REFUSED, ids=lambda text: REFUSED[text][:60])
def test_what_cannot_be_read_is_refused_with_its_line(text, tmp_path):
    path = record_file(tmp_path, text)
    message = one_line_error(read_record, path)
    assert REFUSED[text] in message and message.startswith((str(path), "pulse: "))


@pytest.mark.parametrize(("text", "given", "said"), REFUSED_AS_GIVEN)
def test_what_is_given_beside_a_record_is_held_to_it(text, given, said, tmp_path):
    assert said in one_line_error(read_record, record_file(tmp_path, text), **given)


def test_a_file_that_is_missing_binary_or_too_large_is_refused(tmp_path, monkeypatch):
    assert "No such file" in one_line_error(read_record, tmp_path / "absent.csv")
    assert "a directory" in one_line_error(read_record, tmp_path)
    path = written(tmp_path / "motion.csv", bytes(range(255, 0, -1)))
    assert "0 data rows" in one_line_error(read_record, path)
    for name in ("a.csv", "a.at2"):
        for before in ("", "time_s,acc_m_s2\n"):  # a header of 20 MB took no end
            path = written(tmp_path / name, before + "1," * LONGEST_LINE)
            assert "100000" in one_line_error(read_record, path)
    with path.open("w") as file:
        file.truncate(10**12)  # a hole
    assert "1e+06 MB" in one_line_error(read_record, path)
    for lines in ("\n" * 5 + "0,1\n" * 40, "0,1\n" * 40):  # 28 MB of them took ten seconds
        path = written(tmp_path / "motion.csv", lines)
        monkeypatch.setattr(columns, "MOST_LINES", 30)
        assert "more than 30 lines" in one_line_error(read_record, path)
        monkeypatch.setattr(columns, "MOST_LINES", 100)
        monkeypatch.setattr(columns, "MOST_SAMPLES", 30)
        assert "40 samples; expected up to 30" in one_line_error(read_record, path)


# --- names, times and units -----------------------------------------------------------------------


def test_a_record_that_ships_is_read_by_its_name(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    record = read_record("BGAR_HGE")
    assert record.sha256 == read_record(shipped_record_path()).sha256
    assert (record.name, record.time_step_s) == ("BGAR_HGE", 0.005)
    assert record.acceleration_m_s2.size == 9304
    assert record.start_utc == "2018-01-08T14:00:37.090000Z"
    # the data's description says "near 18.8 s"
    strong_s = record.time_s[np.abs(record.acceleration_m_s2).argmax()]
    assert strong_s == approx(18.8, abs=0.1)
    written(tmp_path / "BGAR_HGE", "time_s,acc_g\n0,1\n0.01,2\n")
    assert read_record("BGAR_HGE").acceleration_m_s2.size == 2  # a file comes first
    assert one_line_error(read_record, "BGRA_HGE").endswith("; did you mean BGAR_HGE?")
    assert "tests" not in one_line_error(read_record, "absent")
    assert "BGAR_HGE" in one_line_error(shipped_record_path, "MID1")


def test_a_record_is_named_after_its_file_and_begins_at_zero(tmp_path, capsys):
    text = "# start 2018-01-08T14:00:37.09Z\ntime_s,acc_g\n17.00,0.1\n17.01,0.2\n17.02,0.3\n"
    path = written(tmp_path / "here_acc_m_s2.csv", text)
    record = read_record(str(path))
    assert "times begin at 17 s, which is 0 s of the record" in capsys.readouterr().err
    assert (record.time_s[0], record.start_utc) == (0.0, "2018-01-08T14:00:54.090000Z")
    assert (record.name, record.source) == ("here", str(path))


def test_rounded_times_are_uniform_enough_and_a_decimal_step_stays_the_same_number(tmp_path):
    text = rows(np.arange(301) / 150, np.arange(301), "{:.4f},{}\n")
    # the last time is exact here, so only the sum of the twelve kept digits is left
    record = read_record(record_file(tmp_path, text), unit="g")
    assert record.time_step_s == approx(1 / 150, rel=1e-11)
    text = rows(np.arange(30) / 100, np.zeros(30), "{:.2f},{}\n")
    # 0.29 / 29 is another double than 0.01
    assert read_record(record_file(tmp_path, text), unit="g").time_step_s == 0.01


UTC = "# start 2018-01-08T14:00:37Z\n"


class TestComponentsThatBeginApart:
    """The same pulse at the same instants in a component that begins 0.2 s later.  Read as if they
    began together RotD100 of its PGA is 0.15 g, not 0.15 times the root of 2.

    Of miniSEED: `TestMiniSeed`.
    """

    @pytest.mark.parametrize(
        "first, later, times_s",
        [
            ("", "", TIME_S + 0.2),
            (UTC, UTC, TIME_S + 0.2),
            (UTC, "# start 2018-01-08T14:00:37.2Z\n", TIME_S),
            (UTC, "# Start time: 2018-01-08 15:00:37.2+01:00\n", TIME_S),
            (f"{HEAD}{COUNTS}", "", TIME_S + 0.2),
        ],
        ids=["columns", "columns and stamps", "stamps", "another zone", "AT2 and a column"],
    )
    def test_they_are_moved_by_their_times(self, first, later, times_s, tmp_path, output_of):
        text = first + (lines_of_five() if first[:4] == "PEER" else IN_G + BARE)
        east = record_file(tmp_path, text)
        text = later + IN_G + rows(times_s, pulse_g(TIME_S + 0.2))
        other = written(tmp_path / "other.csv", text)
        window = "--window", "0.25", "1.9"
        found = json.loads(output_of("record", east, "--across", other, *window, "--json"))
        assert found["pga_rotd100_g"] == pytest.approx(0.15 * np.sqrt(2), rel=1e-4)
        assert found["late_s"] == {"other": pytest.approx(0.2)}
        words = ["--record", str(east), "--vertical", str(other), *window]
        asked = parse_run(words, "test", "reference")
        horizontal, vertical = asked.loading.motion
        assert_allclose(vertical.acceleration_m_s2, horizontal.acceleration_m_s2, atol=1e-5)
        assert "other begins +0.2 s after the horizontal component" in record_lines(asked)[-1]
        refused_with("has samples from 0.2 to", parse_run, words[:4], "test", "reference")

    def test_without_times_they_are_as_long(self, tmp_path):
        east = written(tmp_path / "east.at2", HEAD + COUNTS + lines_of_five())
        text = HEAD + COUNTS.replace("400", "360") + lines_of_five(PULSE_G[40:])
        words = ["--record", str(east), "--across", str(written(tmp_path / "north.at2", text))]
        refused_with("has no start time: expected that of", parse_run, words, "test", "reference")
        written(tmp_path / "north.at2", HEAD + COUNTS + lines_of_five(-PULSE_G))
        assert parse_run(words, "test", "reference").loading.late_s == {}

    @pytest.mark.parametrize("per_s", [1000, 200, 1])
    def test_times_of_samples_may_be_no_seconds(self, per_s, tmp_path):
        path = record_file(tmp_path, UTC + IN_G + rows(per_s * (TIME_S + 0.2), PULSE_G))
        record = read_record(path, sample_step_s=STEP_S)
        assert record.first_s == pytest.approx(0.2)
        assert record.start_utc == "2018-01-08T14:00:37.200000Z"

    def test_two_records_in_python_are_held_to_their_times(self):
        late = Record("late", STEP_S, PULSE_G, first_s=0.2)
        refused_with("has samples from 0.2 to", Recorded, Record("r", STEP_S, PULSE_G), across=late)


class TestUnitOfARun:
    """How a record's unit is said by commands, histories, sequences and studies."""

    def test_commands_and_the_history_say_it(self, tmp_path, output_of, error_of):
        path = record_file(tmp_path, "# time_s,acc_g\n" + BARE)
        named = "g (line 1: '# time_s,acc_g')"
        assert f"unit of the file: {named}" in output_of("record", path)
        assert json.loads(output_of("record", path, "--json"))["unit"] == named
        wall = wall_file(tmp_path / "w.py", "Wall('w', 0.9, 0.6)")
        out = tmp_path / "a.h5"
        path = record_file(tmp_path, rows(TIME_S[100:140], PULSE_G[100:140]))
        words = f"reference {wall} --record {path} --rest 0 --no-pictures --out {out}".split()
        assert "names no unit" in error_of(*words)
        printed = output_of(*words, "--unit", "g")
        assert "unit of pulse: g (--unit)\n" in printed
        assert json.loads(output_of("index", out, "--json"))["record_unit"] == "g (--unit)"
        info = json.loads(output_of("info", out, "--json"))
        origin = info["parameters"]["loading"]["horizontal"]
        assert (origin["unit"], origin["given"]) == ("g (--unit)", {"unit": "g"})

    def test_a_study_notices_another_unit_but_no_new_words(self, tmp_path):
        path = record_file(tmp_path, BARE)
        asked = [parsed(f"--record {path} --unit {unit}", "yade") for unit in ("g", "m_s2")]
        note = as_json(asked[0])
        assert differences(note, asked[0]) == []
        (line,) = differences(note, asked[1])
        assert line.startswith("loading.record.given ")

    def test_sequences_have_a_column(self, tmp_path):
        record_file(tmp_path, BARE)
        written(tmp_path / "alone.txt", rows(TIME_S, PULSE_GAL, "{1:.6f}\n"))
        path = written(
            tmp_path / "events.csv",
            "record,unit,sample_step_s\npulse.txt,g,\npulse.txt,m_s2,\nalone.txt,gal,0.005\n"
            "BGAR_HGE,,\n",
            encoding="utf-16",
        )
        peaks = [event.loading.peak_g for event in read_sequence(path, 1.0)[:3]]
        assert_allclose(peaks, [0.15, 0.15 / 9.81, 0.15], rtol=1e-4)
        lines = record_lines(parsed(f"--sequence {path}"))
        assert "unit of alone: gal (--unit)" in lines and len(lines) == 4
        refused_with("--sequence", parsed, f"--sequence {path} --unit g")
        written(path, "record\npulse.txt\n")
        refused_with("line 2: .*names no unit", read_sequence, path, 1.0)

    def test_rows_of_a_study_have_a_column(self, tmp_path):
        paths = [record_file(tmp_path, BARE), written(tmp_path / "g.txt", IN_G + BARE)]
        table = tmp_path / "rows.csv"
        study = written(
            tmp_path / "s.toml",
            'name = "s"\n[[grid]]\nwall = "walls/solid.py"\nrows = "rows.csv"\n'
            'options = { record = "{record}", unit = "{unit}" }\n',
        )
        written(table, f"record,unit\n{paths[0]},cm_s2\n{paths[1]},file\n")
        runs = load_study(study, "reference", REPOSITORY).runs
        peaks = [run.settings(REPOSITORY).peak_g for run in runs]
        assert_allclose(peaks, [0.0015 / 9.81, 0.15], rtol=1e-3)
        written(table, f"record,unit\n{paths[0]},file\n")
        refused_with("names no unit", load_study, study, "reference", REPOSITORY)


def test_peaks_that_no_earthquake_has(tmp_path, capsys):
    assert implausible_velocity(3.2) is None and faint_warnings(5e-4) == []
    path = record_file(tmp_path, IN_G + rows(8 * TIME_S, 20 * PULSE_G))
    said = one_line_error(parsed(f"--record {path}").check_plausible, Wall("w", 0.9, 0.6))
    assert "PGV of the base motion = 8.0" in said and "--accept-implausible" in said
    assert main(["record", str(path)]) == 0
    assert "PGV of the base motion = 8.0" in capsys.readouterr().err
    path = record_file(tmp_path, "time_s,acc_gal\n" + BARE)
    assert main(["record", str(path)]) == 0
    assert "g, expected 0.0005 to 5 g" in capsys.readouterr().err


# --- miniSEED and what is not read ----------------------------------------------------------------


class TestMiniSeed:
    COUNTS = shipped_record_path("NL.BGAR..HGE")
    STATION_XML = COUNTS.parent / "NL.BGAR.xml"

    @pytest.fixture(autouse=True)
    def obspy(self):
        return pytest.importorskip("obspy", reason="obspy is an optional extra")

    @pytest.fixture
    def trace(self, obspy):
        return obspy.read(str(self.COUNTS))[0]

    @pytest.fixture
    def read_with(self, tmp_path):
        """read_with(old, new): the shipped counts with text of their StationXML replaced."""

        def read(old, new):
            text = self.STATION_XML.read_text()
            assert old in text
            return read_record(self.COUNTS, written(tmp_path / "other.xml", text.replace(old, new)))

        return read

    @staticmethod
    def saved(stream, folder, name="motion.mseed"):
        stream.write(str(folder / name), format="MSEED")
        return folder / name

    def test_counts_become_the_shipped_csv(self):
        counts = read_record(self.COUNTS)
        table = read_record(shipped_record_path("BGAR_HGE"))
        assert counts.name == "NL.BGAR..HGE"
        assert (counts.start_utc, counts.time_step_s) == (table.start_utc, table.time_step_s)
        # the CSV has seven digits: half a unit of the last one at its peak of 1.09 m/s2 is 5e-7
        assert_allclose(counts.acceleration_m_s2, table.acceleration_m_s2, rtol=0, atol=5.01e-7)

    def test_content_is_known_without_a_suffix(self, tmp_path):
        path = written(tmp_path / "motion.dat", shipped_record_path("NL.BGAR..HGZ").read_bytes())
        assert read_record(path, self.STATION_XML).name == "NL.BGAR..HGZ"

    def test_station_xml_is_looked_for_beside_the_file(self, trace, tmp_path):
        path = self.saved(trace, tmp_path)
        assert str(tmp_path / "NL.BGAR.xml") in one_line_error(read_record, path)
        (tmp_path / "NL.BGAR.xml").write_bytes(self.STATION_XML.read_bytes())
        record = read_record(path)
        assert record.acceleration_m_s2.size == 9304
        assert record.beside_sha256 == (hashlib.sha256(self.STATION_XML.read_bytes()).hexdigest(),)

    def test_joined_parts_are_whole_but_a_gap_is_refused(self, trace, obspy, tmp_path):
        cut = trace.stats.starttime + 10
        first = trace.slice(endtime=cut)
        after, late = (trace.slice(starttime=cut + wait) for wait in (trace.stats.delta, 1.0))
        whole = read_record(self.saved(obspy.Stream([first, after]), tmp_path), self.STATION_XML)
        assert whole.acceleration_m_s2.size == 9304
        broken = self.saved(obspy.Stream([first, late]), tmp_path)
        message = one_line_error(read_record, broken, self.STATION_XML)
        assert "gap or overlap between 2018-01-08T14:00:47.090000Z" in message

    def test_a_component_that_begins_later_is_moved(self, trace, tmp_path):
        east = self.saved(trace, tmp_path)
        (tmp_path / "NL.BGAR.xml").write_bytes(self.STATION_XML.read_bytes())
        late = trace.slice(starttime=trace.stats.starttime + 1)
        late.stats.channel = "HGN"
        north = self.saved(late, tmp_path, "north.mseed")
        words = ["--record", east, "--across", north, "--vertical", north, "--window", 3, 10]
        loading = parse_run([str(word) for word in words], "test", "reference").loading
        assert loading.late_s == {"NL.BGAR..HGN": 1.0}
        for other in (loading.motion[1], loading.applied_across()):  # but for their offsets
            assert np.ptp(other.acceleration_m_s2 - loading.motion[0].acceleration_m_s2) < 1e-12

    def test_two_components_are_refused(self, trace, obspy, tmp_path):
        other = trace.copy()
        other.stats.channel = "HGN"
        path = self.saved(obspy.Stream([trace, other]), tmp_path)
        assert "NL.BGAR..HGE, NL.BGAR..HGN" in one_line_error(read_record, path, self.STATION_XML)

    def test_shorter_than_the_quiet_part(self, trace, tmp_path):
        path = self.saved(trace.slice(endtime=trace.stats.starttime + 1), tmp_path)
        assert "201 samples" in one_line_error(read_record, path, self.STATION_XML)

    def test_what_is_cut_off_or_broken_is_refused_and_obspy_says_nothing(self, tmp_path, capfd):
        data = self.COUNTS.read_bytes()
        path = tmp_path / "cut.mseed"
        for length in (1, 48, 100, 511, 513, 600, 4097, len(data) - 1):
            one_line_error(read_record, written(path, data[:length]), self.STATION_XML)
        assert "obspy says" in one_line_error(read_record, written(path, "no seed\n"))
        whole = self.STATION_XML.read_text()
        for text in ("", "<", "<?xml version='1.0'?>", whole[: len(whole) // 2]):
            one_line_error(read_record, self.COUNTS, written(tmp_path / "odd.xml", text))
        assert capfd.readouterr() == ("", "")

    @pytest.mark.parametrize(
        ("old", "new", "says"),
        [
            ("M/S**2", "M/S", "M/S of NL.BGAR..HGE"),
            ('Station code="BGAR"', 'Station code="OTHER"', "obspy says"),
            *(("213867.4766", no, "no sensitivity of NL.BGAR..HGE") for no in ("0", "1e400")),
            ("213867.4766", "nan", "expected"),
            (
                "213867.4766",
                "427734.9532",
                (
                    "other.xml: sensitivity of NL.BGAR..HGE: 427735, but the gains of its 2 "
                    "stages make 213867.4 (0.5099 x 419430); expected the same within 5%"
                ),
            ),
            (
                "419430</Value>",
                "4194300</Value>",
                "213867.5, but the gains of its 2 stages make 2138674 ",
            ),
            (
                "COUNTS",
                "V",
                (
                    "other.xml: sensitivity of NL.BGAR..HGE: 213867.5 V per M/S**2 (by the gains of"
                    " its 2 stages 213867.4); expected counts per M/S**2"
                ),
            ),
            ("<Network", "<Nonsense", "obspy says"),
        ],
    )
    def test_unfit_station_xml(self, read_with, old, new, says):
        assert says in one_line_error(read_with, old, new)

    def test_a_velocity_in_the_first_stage_is_refused(self, read_with):
        *_, rest = self.STATION_XML.read_text().partition('<Stage number="1">')
        message = one_line_error(read_with, rest, rest.replace("M/S**2", "M/S", 1))
        assert "is per M/S**2, but its first stage takes M/S; expected M/S**2 of both" in message

    @pytest.mark.parametrize("coding", ["utf-8", "utf-16"])
    def test_no_entity_of_a_station_file_is_expanded(self, coding, tmp_path):
        """Neither another file nor entities of entities: a document type is refused whatever it
        says."""
        value = "<Value>213867.4766</Value>"
        secret = written(tmp_path / "secret", "213867.4766")
        body = self.STATION_XML.read_text().partition("?>")[2]
        assert value in body
        for entity in (f'SYSTEM "{secret.as_uri()}"', '"213867.4766"'):
            damaged = (
                f"<?xml version='1.0' encoding='{coding}'?><!DOCTYPE x [<!ENTITY v {entity}>]>"
                + body.replace(value, "<Value>&v;</Value>")
            )
            path = written(tmp_path / "a.xml", damaged.encode(coding))
            assert "document type" in one_line_error(read_record, self.COUNTS, path)

    def test_a_sensitivity_within_the_tolerance_and_one_without_stages_are_taken(
        self, obspy, read_with, tmp_path
    ):
        usual = read_record(self.COUNTS).acceleration_m_s2
        found = read_with("213867.4766", "220000").acceleration_m_s2
        assert_allclose(found, usual * 213867.4766 / 220000, rtol=ROUND_OFF)
        inventory = obspy.read_inventory(str(self.STATION_XML))
        for channel in inventory[0][0]:
            channel.response.response_stages = []
        path = tmp_path / "without.xml"
        inventory.write(str(path), format="STATIONXML")
        assert_allclose(read_record(self.COUNTS, path).acceleration_m_s2, usual, rtol=1e-6)

    def test_samples_in_a_physical_unit_are_no_counts(self, trace, tmp_path):
        """They were taken for counts: a PGA of 0.11 g was read as 5e-7 g."""
        whole = read_record(self.saved(trace, tmp_path), self.STATION_XML)
        counts = trace.data
        trace.data = trace.data / 213867.4766
        del trace.stats.mseed  # with the encoding of whole numbers
        message = one_line_error(read_record, self.saved(trace, tmp_path), self.STATION_XML)
        peak = np.abs(trace.data).argmax()
        assert (
            f"are no whole numbers, such as number {peak}, {trace.data[peak]:.6g}; expected counts"
            in message
        )
        trace.data = counts.astype(np.float32)  # counts all the same
        again = read_record(self.saved(trace, tmp_path), self.STATION_XML)
        assert again.acceleration_m_s2.tobytes() == whole.acceleration_m_s2.tobytes()


def test_without_obspy_the_extra_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "obspy", None)
    message = one_line_error(read_record, TestMiniSeed.COUNTS)
    assert "pip install obspy" in message and "masonry-damage[obspy]" in message


class TestOtherFormats:
    @pytest.mark.parametrize(
        "begins, name",
        [
            (b"Corrected acceleration    (Format v01.20 with 13 text lines) Src: f", "COSMOS"),
            (b"Origin Time       2018/01/24 19:51:00\n", "K-NET, KiK-net"),
            (b"Corrected accelerogram 20180212_211554_WPWS_20 GNS Science\n", "GeoNet V1A/V2A"),
            (
                b"UNCORRECTED ACCELEROGRAM DATA    PROCESSED: 07/16/98, CDMG",
                "CSMIP (V1, V2, V3), RENADIC",
            ),
            (b"\0\0\xa0\x40" * 76 + b"\6\0\0\0" + b"\0" * 400, "SAC"),
            (b"\0\0\xa0\x40" * 76 + b"\0\0\0\6" + b"\0" * 400, "SAC"),
            (b"   0.01000000      -12345.00\n", "SAC"),
            (b"PK\x03\x04..", "spreadsheet or ZIP"),
            (b"\xef\xbb\xbf<?xml version='1.0'?>", "XML, as StationXML or QuakeML"),
        ],
    )
    def test_a_format_that_is_not_read_is_named(self, tmp_path, begins, name):
        path = tmp_path / "record.txt"
        path.write_bytes(begins)
        message = one_line_error(read_record, path)
        assert (
            f"its format is {name}, which is not read" in message and "record-formats.md" in message
        )

    def test_k_net_by_the_guides_recipe_keeps_no_baseline(self, tmp_path, monkeypatch):
        pytest.importorskip("obspy")
        drift = np.linspace(-78000, 42000, 400)
        counts = np.round(PULSE_GAL * 8388608 / 2000 + drift).astype(int)
        head = [line[:18].ljust(18) + line[18:] for line in K_NET.splitlines()]
        data = ("".join(map("{:9d}".format, counts[k : k + 8])) for k in range(0, 400, 8))
        written(tmp_path / "FILE", "\n".join([*head, *data]) + "\n")
        guide = (REPOSITORY / "docs/reference/record-formats.md").read_text()
        recipe = re.search(r"^```\n(trace = obspy.read.*?)^```$", guide, re.MULTILINE | re.DOTALL)[
            1
        ]
        monkeypatch.chdir(tmp_path)
        exec(f"import numpy, obspy\n{recipe}", {})
        record = read_record("record.csv")
        assert (pga_g(record), 100 * pgv_m_s(record)) == approx((0.15, PULSE_PGV_CM_S), rel=2e-3)

    @pytest.mark.parametrize(
        "begins, name",
        [
            *(
                (line, "CSV")
                for line in (b"# time_s,acc_g\n", b"0.0 0.1\n", b"acc_g\n", b"-0.5 0.2\n")
            ),
            (b"# NPTS= 400, DT= .0050 SEC\n0 1\n", "CSV"),
            (b"\r\n" * 12 + COUNTS.encode(), "CSV"),
            (b"\r\n" * 11 + COUNTS.encode(), "PEER AT2"),
            (f"{HEAD}{COUNTS}".encode("utf-16"), "PEER AT2"),
        ],
    )
    def test_a_text_without_a_suffix_has_the_format_of_its_first_lines(self, begins, name):
        assert format_of("FILE", begins).name == name
