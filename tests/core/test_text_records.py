"""Text records as others write them: separators, units in the header or given, time axes that are
no seconds, AT2 of other programs.  One Ricker pulse of 0.15 g and 4 Hz, whose PGA and PGV are
known, is written in each way."""

import json

import conftest
import numpy as np
import pytest
from conftest import REPOSITORY, one_line_error, refused_with, wall_file
from numpy.testing import assert_allclose

from damage.__main__ import main
from damage.applications.studies.definition import load_study
from damage.applications.studies.inputs import as_json, differences
from damage.motion.formats import read_record
from damage.motion.intensity import pga_g, pgv_cm_s
from damage.motion.loading import Recorded, loading_from_dict
from damage.motion.plausible import faint_warnings, implausible_velocity
from damage.motion.sequence import read_sequence
from damage.run.banner import record_lines
from damage.run.options import parse_run
from damage.units import GRAVITY
from damage.wall.parameters import Wall

STEP_S = 0.005
TIME_S = STEP_S * np.arange(400)
PHASE = (np.pi * 4.0 * (TIME_S - 0.6)) ** 2
PULSE_G = 0.15 * (1 - 2 * PHASE) * np.exp(-PHASE)
PULSE_GAL = 981 * PULSE_G
PULSE_PGV_CM_S = 5.0155
HEAD = "PEER\nQuake, Station, 090\nACCELERATION TIME SERIES IN UNITS OF G\n"
COUNTS = "NPTS= 400, DT= .0050 SEC\n"
ROUND_OFF = 1e-12  # relative: a few operations in double precision on numbers of one size


def rows(times, values, text="{:.3f},{:.6f}\n"):
    return "".join(map(text.format, times, values))


def lines_of_five(values=PULSE_G, one="{: .7E}", between=" "):
    cells = [one.format(value) for value in values]
    return "\n".join(between.join(cells[k : k + 5]) for k in range(0, len(cells), 5)) + "\n"


def written(folder, text, name="pulse.txt", encoding="utf-8"):
    return conftest.written(folder / name, text, encoding=encoding)


def is_the_pulse(record, unit):
    assert (pga_g(record), pgv_cm_s(record)) == pytest.approx((0.15, PULSE_PGV_CM_S), rel=1e-4)
    return record.unit.startswith(f"{unit} (") and record.time_step_s == STEP_S


class TestColumns:
    def test_header_comments_and_blank_lines(self, tmp_path):
        text = "# by hand\ntime_s,acc_m_s2\n0.00,0.1\n\n0.01,-0.2\n# middle\n0.02,0.3\n"
        path = written(tmp_path, text, "here_acc_m_s2.csv")
        record = read_record(str(path))
        assert (record.name, record.start_utc, record.source) == ("here", "", str(path))
        assert record.time_step_s == 0.01 and len(record.sha256) == 64
        assert_allclose(record.acceleration_m_s2, [0.1, -0.2, 0.3], rtol=ROUND_OFF)

    @pytest.mark.parametrize(
        "text",
        [
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
        ],
    )
    def test_separators_decimal_commas_quotes_and_fortran(self, tmp_path, text):
        record = read_record(written(tmp_path, text))
        assert record.time_step_s == 0.01
        assert_allclose(record.acceleration_m_s2, [0.125, -0.25], rtol=ROUND_OFF)

    @pytest.mark.parametrize("encoding", ["utf-16", "utf-16-le", "utf-16-be", "utf-8-sig"])
    def test_unicode_text_of_spreadsheets(self, tmp_path, encoding):
        text = "time_s\tacc_g\n" + rows(TIME_S, PULSE_G, "{:.3f}\t{:.6f}\n")
        assert is_the_pulse(read_record(written(tmp_path, text, encoding=encoding)), "g")
        path = written(tmp_path, "record,scale\nBGAR_HGE,2\n", "events.csv", encoding)
        assert [event.factor for event in read_sequence(path, 1.0)] == [2]

    @pytest.mark.parametrize(
        ("text", "says"),
        [
            (" \n\n", "empty"),
            ("# only a comment\n", "0 data rows"),
            ("time_s,acc_m_s2\n0,1\n", "1 data rows"),
            ("0,1\n0.01,nan\n", "line 2: acceleration = 'nan': expected a finite number"),
            ("nan,1\n0.01,1\n", "line 1: time = 'nan': expected a finite number"),
            ("0\n0.01\n", "give --sample-step S"),
            ("# c\n0,1\n0.01,high\n", "line 3: acceleration = 'high': expected a finite number"),
            ("0,1\n0.01,\n", "line 2: no acceleration; expected it in every row"),
            ("0,1\n0.01,2\n0.03,3\n0.04,3\n0.05,3\n", "line 3: a step of 0.02 s among 0.01 s"),
            ("0.02,1\n0.01,2\n0,3\n", "line 2: time 0.01 s after 0.02 s"),
            ("0,1\n0.01,2\n0.01,3\n", "line 3: time 0.01 s after 0.01 s"),
            ("0;1;2\n0,01;1;2\n", "line 1: 3 cells; expected 2, time, acceleration"),
            (
                "0,00;1,5\n0,01;1.200,5\n",
                "line 2: acceleration = '1.200,5': expected a finite number",
            ),
            (
                "0,00,1,5\n0,01,1,5\n",
                "line 1: 4 cells; expected 2, time, acceleration; decimal commas need semicolons",
            ),
            (
                "# start 2018-13-45T99:00\ntime_s,acc_g\n0,1\n0.01,2\n",
                "start time '2018-13-45T99:00'",
            ),
            ("acc_g\n0\n1\n", "line 2: '0' has one column"),
            ("time_s,acc_counts\n0,1\n0.01,2\n", "is an unknown header"),
            ("time_s;acc_g\n0,1\n0.01,2\n", "line 1: 'time_s;acc_g' is an unknown header"),
            ("time_ms,acc_g\n0,1\n5,2\n", "expected two columns, separated as the rows: time_s"),
            (
                "Time (s);Acc X (cm/s2);Acc Y (cm/s2)\n0,00;1;2\n0,01;1;2\n",
                "is an unknown header; expected two columns",
            ),
        ],
    )
    def test_bad_content_is_reported_with_its_line(self, tmp_path, text, says):
        path = written(tmp_path, text, "motion.csv")
        message = one_line_error(read_record, path)
        assert says in message and message.startswith(str(path))


class TestUnits:
    @pytest.mark.parametrize(
        ("header", "m_s2"),
        [
            ("time_s,acc_cm_s2", 0.01),
            ("Time (s), Acceleration (gal)", 0.01),
            ("t [s],a [cm/s²]", 0.01),
            ("time [s],acc [cm/s^2]", 0.01),
            ("time_s,accel m/s/s", 1.0),
            ("time_s,acc_mm_s2", 0.001),
            ('"time [s]","acc [m/sec2]"', 1.0),
            (" Time_s , acc_g", GRAVITY),
            ("t_s,acc_mg", GRAVITY / 1000),
        ],
    )
    @pytest.mark.parametrize("comment", ["", "# "])
    def test_the_header_or_the_comment_in_its_place_names_it(self, tmp_path, header, m_s2, comment):
        path = written(tmp_path, f"# 2 gal\n{comment}{header}\n0,10\n0.01,-20\n")
        assert_allclose(
            read_record(path).acceleration_m_s2, [10 * m_s2, -20 * m_s2], rtol=ROUND_OFF
        )

    def test_an_exponent_that_is_not_in_utf_8_is_one(self, tmp_path):
        path = conftest.written(
            tmp_path / "a.csv", "time [s];acc [cm/s²]\n0;1\n0,01;2\n".encode("latin-1")
        )
        assert_allclose(read_record(path).acceleration_m_s2, [0.01, 0.02], rtol=ROUND_OFF)

    @pytest.mark.parametrize(
        "comment",
        [
            "#AmplitudeUnit: gal\n#Time Acc",
            "# units: g",
            "# acceleration in g",
            "# N-S (cm/s/s)",
            "",
        ],
    )
    def test_other_comments_name_none_and_it_may_be_given(self, tmp_path, comment):
        path = written(tmp_path, f"{comment}\n" + rows(TIME_S, PULSE_G))
        message = one_line_error(read_record, path)
        shown = comment.splitlines()[-1] if comment else "0.000,-0.000000"
        assert (
            f"'{shown}' names no unit of the acceleration; expected a header such as"
            " time_s,acc_m_s2, or " in message
        )
        record = read_record(path, unit="g")
        assert is_the_pulse(record, "g")
        assert (record.unit, record.given) == ("g (--unit)", {"unit": "g"})

    @pytest.mark.parametrize("header", ["time_s,acc", "Time,Acc", "time (s),acceleration"])
    def test_a_header_may_name_no_unit_where_it_is_given(self, tmp_path, header):
        path = written(tmp_path, f"{header}\n" + rows(TIME_S, PULSE_G))
        assert is_the_pulse(read_record(path, unit="g"), "g")
        assert "is an unknown header" in one_line_error(read_record, path)

    def test_a_given_one_is_that_of_the_header(self, tmp_path):
        path = written(tmp_path, "time_s,acc_cm_s2\n" + rows(TIME_S, PULSE_GAL))
        assert is_the_pulse(read_record(path, unit="gal"), "gal")
        assert "names cm_s2, --unit g; expected the same unit" in one_line_error(
            read_record, path, unit="g"
        )
        assert "expected one of m_s2, cm_s2" in one_line_error(read_record, path, unit="m/s2")

    def test_the_command_says_it(self, tmp_path, output_of):
        path = written(tmp_path, "# time_s,acc_g\n" + rows(TIME_S, PULSE_G))
        assert "unit of the file: g (line 1: '# time_s,acc_g')" in output_of("record", path)
        assert (
            json.loads(output_of("record", path, "--json"))["unit"]
            == "g (line 1: '# time_s,acc_g')"
        )

    def test_a_run_its_summary_and_its_history_say_it(self, tmp_path, output_of):
        wall = wall_file(tmp_path / "w.py", "Wall('w', 0.9, 0.6)")
        path = written(tmp_path, rows(TIME_S[100:140], PULSE_G[100:140]))
        words = [
            "reference",
            str(wall),
            "--record",
            str(path),
            "--rest",
            "0",
            "--no-pictures",
            "--out",
        ]
        assert main([*words, str(tmp_path / "a.h5")]) == 2
        printed = output_of(*words, tmp_path / "a.h5", "--unit", "g")
        assert "unit of pulse: g (--unit)\n" in printed and "record in g (--unit)" in printed
        assert (
            json.loads(output_of("index", tmp_path / "a.h5", "--json"))["record_unit"]
            == "g (--unit)"
        )
        origin = json.loads(output_of("info", tmp_path / "a.h5", "--json"))["parameters"][
            "loading"
        ]["horizontal"]
        assert (origin["unit"], origin["given"]) == ("g (--unit)", {"unit": "g"})

    def test_a_history_of_an_older_version_says_nothing(self):
        table = Recorded(read_record("BGAR_HGE")).as_dict()
        del table["horizontal"]["unit"]
        assert loading_from_dict(table).horizontal["record"] == "BGAR_HGE"

    def test_a_study_notices_another_unit_but_no_new_words(self, tmp_path):
        path = written(tmp_path, rows(TIME_S, PULSE_G))
        asked = [
            parse_run(["--record", str(path), "--unit", unit], "test", "yade")
            for unit in ("g", "m_s2")
        ]
        note = as_json(asked[0])
        assert differences(note, asked[0]) == []
        assert [line.split(" ")[0] for line in differences(note, asked[1])] == [
            "loading.record.given"
        ]

    def test_sequences_have_a_column(self, tmp_path):
        written(tmp_path, rows(TIME_S, PULSE_G))
        written(tmp_path, rows(TIME_S, PULSE_GAL, "{1:.6f}\n"), "alone.txt")
        text = (
            "record,unit,sample_step_s\npulse.txt,g,\npulse.txt,m_s2,\n"
            "alone.txt,gal,0.005\nBGAR_HGE,,\n"
        )
        path = written(tmp_path, text, "events.csv")
        peaks = [event.loading.peak_g for event in read_sequence(path, 1.0)[:3]]
        assert_allclose(peaks, [0.15, 0.15 / 9.81, 0.15], rtol=1e-4)
        lines = record_lines(parse_run(["--sequence", str(path)], "test", "reference"))
        assert "unit of alone: gal (--unit)" in lines and len(lines) == 4
        refused = one_line_error(
            read_sequence, written(tmp_path, "record\npulse.txt\n", "none.csv"), 1.0
        )
        assert "line 2: " in refused and "names no unit" in refused
        assert "--sequence" in one_line_error(
            parse_run, ["--sequence", str(path), "--unit", "g"], "test", "yade"
        )

    def test_rows_of_a_study_have_a_column(self, tmp_path):
        text = rows(TIME_S, PULSE_G)
        paths = [written(tmp_path, text), written(tmp_path, f"time_s,acc_g\n{text}", "g.txt")]
        written(tmp_path, f"record,unit\n{paths[0]},cm_s2\n{paths[1]},file\n", "rows.csv")
        study = (
            'name = "s"\n[[grid]]\nwall = "walls/solid.py"\nrows = "rows.csv"\n'
            'options = { record = "{record}", unit = "{unit}" }\n'
        )
        runs = load_study(written(tmp_path, study, "s.toml"), "reference", REPOSITORY).runs
        peaks = [run.settings(REPOSITORY).peak_g for run in runs]
        assert_allclose(peaks, [0.0015 / 9.81, 0.15], rtol=1e-3)
        written(tmp_path, f"record,unit\n{paths[0]},file\n", "rows.csv")
        refused_with(
            "names no unit", load_study, written(tmp_path, study, "s.toml"), "reference", REPOSITORY
        )
        refused_with("--unit belongs to --record", parse_run, ["--unit", "g"], "test", "yade")


class TestTimeAxis:
    def test_times_from_another_zero_restart_and_move_the_start(self, tmp_path, capsys):
        text = "# start 2018-01-08T14:00:37.09Z\ntime_s,acc_g\n17.00,0.1\n17.01,0.2\n17.02,0.3\n"
        record = read_record(written(tmp_path, text))
        assert "times begin at 17 s, which is 0 s of the record" in capsys.readouterr().err
        assert (record.time_s[0], record.start_utc) == (0.0, "2018-01-08T14:00:54.090000Z")

    def test_rounded_times_are_uniform_enough_and_a_decimal_step_stays_the_same_number(
        self, tmp_path
    ):
        text = rows(np.arange(301) / 150, np.arange(301), "{:.4f},{}\n")
        # the last time is exact here, so only the sum of the twelve kept digits is left
        assert read_record(written(tmp_path, text), unit="g").time_step_s == pytest.approx(
            1 / 150, rel=1e-11
        )
        text = rows(np.arange(30) / 100, np.zeros(30), "{:.2f},{}\n")
        # 0.29 / 29 is another double than 0.01
        assert read_record(written(tmp_path, text), unit="g").time_step_s == 0.01

    @pytest.mark.parametrize(
        "times, cause",
        [
            (
                np.arange(1, 401),
                "times 1, 2, 3, ... are no seconds but sample numbers, or milliseconds at 1000 Hz",
            ),
            (5 * np.arange(400), "times 0, 5, 10, ... are no seconds but milliseconds"),
            (0.06 * np.arange(400), "a time step of 0.06 s; expected at most 0.05 s"),
        ],
    )
    def test_what_is_no_seconds_is_refused_with_the_way_out(self, tmp_path, times, cause):
        message = one_line_error(
            read_record, written(tmp_path, "time_s,acc_g\n" + rows(times, PULSE_G))
        )
        assert cause in message and "--sample-step S" in message

    @pytest.mark.parametrize(
        "times, decimals", [(TIME_S, 2), (np.arange(400) / 300, 2), (TIME_S, 1)]
    )
    def test_rounded_times_are_named(self, tmp_path, times, decimals):
        text = "time_s,acc_g\n" + rows(times, PULSE_G, f"{{:.{decimals}f}},{{:.6f}}\n")
        message = one_line_error(read_record, written(tmp_path, text))
        assert (
            f"times are rounded to {decimals} decimal" in message
            and "400 samples from 0 to" in message
        )
        assert f"with {decimals + 1} or more decimals" in message

    @pytest.mark.parametrize(
        "times", [np.arange(1, 401), 5 * np.arange(400), np.round(TIME_S, 2), TIME_S]
    )
    def test_the_step_may_be_given(self, tmp_path, times):
        path = written(tmp_path, "time_s,acc_g\n" + rows(times, PULSE_G))
        assert is_the_pulse(read_record(path, sample_step_s=STEP_S), "g")

    def test_a_step_that_is_not_that_of_the_times_is_refused(self, tmp_path):
        path = written(tmp_path, "time_s,acc_g\n" + rows(TIME_S, PULSE_G))
        assert "times step by 0.005 s, --sample-step by 0.01 s" in one_line_error(
            read_record, path, sample_step_s=0.01
        )
        for step in (-1.0, 0.0, np.nan):
            assert "--sample-step" in one_line_error(read_record, path, sample_step_s=step)

    def test_a_column_of_accelerations_alone(self, tmp_path):
        alone = rows(TIME_S, PULSE_G, "{1:.6f}\n")
        for header in ("acc_g\n", "# acc_g\n"):
            path = written(tmp_path, header + alone)
            assert is_the_pulse(read_record(path, sample_step_s=STEP_S), "g")
        assert "time step" in one_line_error(read_record, path, sample_step_s=0.2)
        path = written(tmp_path, alone + "1,2\n")
        assert "line 401" in one_line_error(read_record, path, unit="g", sample_step_s=STEP_S)

    def test_a_lost_sample_is_no_rounding(self, tmp_path):
        times = np.delete(0.01 * np.arange(401), 200)
        path = written(tmp_path, "time_s,acc_g\n" + rows(times, PULSE_G, "{:.2f},{:.6f}\n"))
        assert "line 202: a step of 0.02 s among 0.01 s" in one_line_error(read_record, path)

    def test_a_run_needs_two_samples_in_the_walls_period(self, tmp_path):
        path = written(tmp_path, "time_s,acc_g\n" + rows(4 * TIME_S, PULSE_G))
        asked = parse_run(["--record", str(path)], "test", "reference")
        asked.for_period(0.041)
        assert (
            "a time step of 0.02 s; expected at most half of the wall's first period of 0.039 s"
            in one_line_error(asked.for_period, 0.039)
        )

    def test_peaks_that_no_earthquake_has(self, tmp_path, capsys):
        assert implausible_velocity(3.2) is None and faint_warnings(5e-4) == []
        path = written(tmp_path, "time_s,acc_g\n" + rows(8 * TIME_S, 20 * PULSE_G))
        asked = parse_run(["--record", str(path)], "test", "reference")
        said = one_line_error(asked.check_plausible, Wall("w", 0.9, 0.6))
        assert "PGV of the base motion = 8.0" in said and "--accept-implausible" in said
        assert main(["record", str(path)]) == 0
        assert "PGV of the base motion = 8.0" in capsys.readouterr().err
        path = written(tmp_path, "time_s,acc_gal\n" + rows(TIME_S, PULSE_G))
        assert main(["record", str(path)]) == 0
        assert "g, expected 0.0005 to 5 g" in capsys.readouterr().err


class TestAt2:
    VALUES = "  .1000000E-01 -.2000000E-01  .3000000E-01\n  .4000000E-01  .5000000E-01\n"

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
    def test_orders_of_counts(self, tmp_path, counts):
        for name in ("pulse.AT2", "pulse.at2", "pulse.txt"):
            record = read_record(written(tmp_path, f"{HEAD}{counts}\n{self.VALUES}", name))
            expected = GRAVITY * np.array([0.01, -0.02, 0.03, 0.04, 0.05])
            assert record.time_step_s == 0.005
            assert record.acceleration_m_s2.tobytes() == expected.tobytes()

    @pytest.mark.parametrize(
        "text",
        [
            HEAD.replace("OF G", "OF (G)") + COUNTS + lines_of_five(),
            HEAD.replace("OF G", "OF G. FILTER POINTS: HP=0.03 Hz LP=23.6 Hz")
            + COUNTS
            + lines_of_five(),
            HEAD + COUNTS + lines_of_five() + "END\n",
            "Orig PEER filename\nH1 for rotation: A\nH2 for rotation: B\nangle -37.0\nFN"
            " component\nAcceleration in g\n400 0.0050 NPTS, DT\n" + lines_of_five(),
            "El Centro\n400 points\nformat of 8F10.5, i.e., 8 points across in\na row\nThe units"
            " are (g)\n*** Begin ***\n" + COUNTS + lines_of_five(),
            HEAD + COUNTS + lines_of_five().replace("E", "D"),
            HEAD + COUNTS + lines_of_five(-PULSE_G, "{:+.6E}", ""),
            HEAD + COUNTS + lines_of_five(PULSE_G, "{:+.7f}", ""),
        ],
    )
    def test_headers_and_numbers_of_other_programs(self, tmp_path, text):
        assert is_the_pulse(read_record(written(tmp_path, text)), "g")

    @pytest.mark.parametrize(
        "line, says",
        [
            (
                "ACCELERATION TIME HISTORY (CM/SEC/SEC)",
                "'ACCELERATION TIME HISTORY (CM/SEC/SEC)' does not name g",
            ),
            ("ACCELERATION IN UNITS OF G/10", "does not name g"),
            ("", "does not name g"),
            ("ACCELERATION IN G (CM/SEC/SEC)", "does not name g"),
            ("VELOCITY TIME SERIES IN UNITS OF CM/S", "is another quantity"),
        ],
    )
    def test_another_unit_is_refused_with_its_line(self, tmp_path, line, says):
        path = written(tmp_path, f"PEER\nQuake, Station, 090\n{line}\n{COUNTS}{lines_of_five()}")
        assert "line 3: " in one_line_error(read_record, path) and says in one_line_error(
            read_record, path
        )

    def test_the_unit_may_be_given(self, tmp_path):
        path = written(
            tmp_path,
            HEAD.replace("IN UNITS OF G", "(CM/SEC/SEC)") + COUNTS + lines_of_five(PULSE_GAL),
        )
        assert is_the_pulse(read_record(path, unit="gal"), "gal")
        path = written(tmp_path, HEAD + COUNTS + lines_of_five())
        assert "names g, --unit gal" in one_line_error(read_record, path, unit="gal")
        assert "expected the DT of its header" in one_line_error(
            read_record, path, sample_step_s=STEP_S
        )

    @pytest.mark.parametrize(
        "text, says",
        [
            ("POINTS 5 STEP .005\n.1 .2\n", "line 4: 'POINTS 5 STEP .005' gives no NPTS and DT"),
            ("NPTS= 5, DT= E SEC\n", "gives no NPTS and DT"),
            ("NPTS= 1, DT= .005 SEC\n.1 .2\n", "2 values; expected"),
            ("NPTS= 5, DT= .005 SEC\n.1 .2\n", "2 values; expected the NPTS = 5"),
            ("NPTS= 2, DT= 0 SEC\n.1 .2\n", "time step [s] = 0.0"),
            ("NPTS= 2, DT= 5.0 MSEC\n.1 .2\n", "a time step of 5 s; expected at most 0.05 s"),
            ("NPTS= 2, DT= .005\n.1 NaN\n", "line 5: '.1 NaN' is not finite"),
            (
                "NPTS= 2, DT= .005\n0.0012340.001235 0.1\n",
                "is not numeric; expected a blank between numbers",
            ),
            ("NPTS= 2, DT= .005\n0.1 ******** 0.2\n", "line 5: '0.1 ******** 0.2' is not numeric"),
            ("NPTS= 2, DT= .005\n0.1 END\n0.2\n", "line 5: '0.1 END' is not numeric"),
            ("NPTS= 2, DT= .005\n0.1 0.2\nEND\n0.3\n", "3 values; expected the NPTS = 2"),
        ],
    )
    def test_bad_content_is_reported(self, tmp_path, text, says):
        assert says in one_line_error(read_record, written(tmp_path, HEAD + text, "pulse.AT2"))
