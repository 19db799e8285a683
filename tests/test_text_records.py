"""Text records as others write them: units outside the header, time axes that are no seconds, AT2 of other programs,
formats that are not read.  One Ricker pulse of 0.15 g and 4 Hz, whose PGA and PGV are known, is written in each way."""

import json
import re

import conftest
import numpy as np
import pytest
from conftest import REPOSITORY, one_line_error, refused_with, wall_file
from numpy.testing import assert_allclose

from damage.__main__ import main
from damage.motion.formats import FOREIGN, foreign, read_record
from damage.motion.intensity import pga_g, pgv_cm_s
from damage.motion.loading import Recorded, loading_from_dict
from damage.motion.plausible import faint_warnings, implausible_velocity
from damage.motion.sequence import read_sequence
from damage.run.banner import record_lines
from damage.run.options import parse_run
from damage.studies.definition import load_study
from damage.studies.inputs import as_json, differences
from damage.units import GRAVITY
from damage.wall.parameters import Wall

STEP_S = 0.005
TIME_S = STEP_S * np.arange(400)
PHASE = (np.pi * 4.0 * (TIME_S - 0.6)) ** 2
PULSE_G = 0.15 * (1 - 2 * PHASE) * np.exp(-PHASE)
PULSE_GAL = 981 * PULSE_G
PULSE_PGV_CM_S = 5.0155
HEAD = "PEER\nQuake, Station, 090\nACCELERATION TIME SERIES IN UNITS OF G\n"
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
COUNTS = "NPTS= 400, DT= .0050 SEC\n"


def rows(times, values, text="{:.3f},{:.6f}\n"):
    return "".join(map(text.format, times, values))


def lines_of_five(values=PULSE_G, one="{: .7E}", between=" "):
    cells = [one.format(value) for value in values]
    return "\n".join(between.join(cells[k:k + 5]) for k in range(0, len(cells), 5)) + "\n"


def written(folder, text, name="pulse.txt", encoding="utf-8"):
    return conftest.written(folder / name, text, encoding=encoding)


def is_the_pulse(record, unit):
    assert (pga_g(record), pgv_cm_s(record)) == pytest.approx((0.15, PULSE_PGV_CM_S), rel=1e-4)
    return record.unit.startswith(f"{unit} (") and record.time_step_s == STEP_S


class TestUnits:
    @pytest.mark.parametrize("comment", [
        "# time_s,acc_g", "#time_s, acc_g", "# Time [s], Acceleration [g]", "# units: g", "# UNITS = G",
        "# t (s)  a (g)", "# acceleration in g", "# acc, g", "# acc_g\n# PGA 147 cm/s2, PGV 5 cm/s"])
    def test_comments_name_g(self, tmp_path, comment):
        assert is_the_pulse(read_record(written(tmp_path, f"{comment}\n" + rows(TIME_S, PULSE_G))), "g")

    @pytest.mark.parametrize("comment", [
        "#AmplitudeUnit:  gal\n#AmplitudeMAX:  147.15", "# t(sec) N-S(cm/s/s)", "# cm/s^2", "# acc_cm_s2", "# cm/s**2",
        "# ACC (CM/SEC/SEC)", "# Einheit cm/s²", "# [cm s-2]"])
    def test_comments_name_gal(self, tmp_path, comment):
        text = f"#StationCode: TST\n{comment}\n" + rows(TIME_S, PULSE_GAL, "{:.3f} {:.6f}\n")
        assert read_record(written(tmp_path, text)).unit[0] in "gc"
        assert pga_g(read_record(written(tmp_path, text))) == pytest.approx(0.15, rel=1e-4)

    @pytest.mark.parametrize("comment", ["# network (G)", "# PGA 147 cm/s2", "# PGV in cm/s 2.5", "# a good day", ""])
    def test_what_names_no_unit_is_refused_and_may_be_given(self, tmp_path, comment):
        path = written(tmp_path, f"{comment}\n" + rows(TIME_S, PULSE_G))
        assert "no line names the unit of the acceleration" in one_line_error(read_record, path)
        assert is_the_pulse(read_record(path, unit="g"), "g")

    def test_comments_that_contradict_are_refused_and_the_unit_may_be_given(self, tmp_path):
        path = written(tmp_path, "# units: cm/s2\n# units: g\n" + rows(TIME_S, PULSE_G))
        assert "line 2: '# units: g' names g, line 1 cm_s2; expected one unit" in one_line_error(read_record, path)
        assert read_record(path, unit="g").unit == "g (--unit; line 1 names cm_s2)"
        path = written(tmp_path, "# AmplitudeUnit: gal\ntime_s,acc_g\n" + rows(TIME_S, PULSE_G))
        assert "names gal, line 2 g" in one_line_error(read_record, path)
        assert is_the_pulse(read_record(path, unit="g"), "g")
        assert "names g, --unit gal" in one_line_error(read_record, path, unit="gal")

    def test_units_of_one_size_agree(self, tmp_path):
        path = written(tmp_path, "# AmplitudeUnit: gal\ntime_s,acc_cm_s2\n" + rows(TIME_S, PULSE_GAL))
        assert is_the_pulse(read_record(path), "cm_s2") and is_the_pulse(read_record(path, unit="gal"), "gal")

    def test_an_unknown_unit_is_refused(self, tmp_path):
        path = written(tmp_path, rows(TIME_S, PULSE_G))
        assert "expected one of m_s2, cm_s2" in one_line_error(read_record, path, unit="m/s2")
        assert main(["record", str(path), "--unit", "furlong"]) == 2

    def test_milli_g_and_millimetres(self, tmp_path):
        assert is_the_pulse(read_record(written(tmp_path, "time_s,acc_mg\n" + rows(TIME_S, 1e3 * PULSE_G))), "mg")
        text = "time_s,acc_mm_s2\n" + rows(TIME_S, 1e3 * GRAVITY * PULSE_G)
        assert is_the_pulse(read_record(written(tmp_path, text)), "mm_s2")


class TestStatedUnit:
    """Record, run and history say which unit was taken, and a study notices that another one was given."""

    def test_the_command_says_it(self, tmp_path, output_of):
        path = written(tmp_path, "# time_s,acc_g\n" + rows(TIME_S, PULSE_G))
        assert "unit of the file: g (line 1: '# time_s,acc_g')" in output_of("record", path)
        assert json.loads(output_of("record", path, "--json"))["unit"] == "g (line 1: '# time_s,acc_g')"

    def test_a_run_its_summary_and_its_history_say_it(self, tmp_path, output_of):
        wall = wall_file(tmp_path / "w.py", "Wall('w', 0.9, 0.6)")
        path = written(tmp_path, rows(TIME_S[100:140], PULSE_G[100:140]))
        words = ["reference", str(wall), "--record", str(path), "--rest", "0", "--no-pictures", "--out"]
        assert main([*words, str(tmp_path / "a.h5")]) == 2
        printed = output_of(*words, tmp_path / "a.h5", "--unit", "g")
        assert "unit of pulse: g (--unit)\n" in printed and "record in g (--unit)" in printed
        assert json.loads(output_of("index", tmp_path / "a.h5", "--json"))["record_unit"] == "g (--unit)"
        origin = json.loads(output_of("info", tmp_path / "a.h5", "--json"))["parameters"]["loading"]["horizontal"]
        assert (origin["unit"], origin["given"]) == ("g (--unit)", {"unit": "g"})

    def test_a_history_of_an_older_version_says_nothing(self):
        table = Recorded(read_record("BGAR_HGE")).as_dict()
        del table["horizontal"]["unit"]
        assert loading_from_dict(table).horizontal["record"] == "BGAR_HGE"

    def test_a_study_notices_another_unit_but_no_new_words(self, tmp_path):
        path = written(tmp_path, rows(TIME_S, PULSE_G))
        asked = [parse_run(["--record", str(path), "--unit", unit], "test", "yade") for unit in ("g", "m_s2")]
        note = as_json(asked[0])
        assert differences(note, asked[0]) == []
        assert [line.split(" ")[0] for line in differences(note, asked[1])] == ["loading.record.given"]
        old = as_json(parse_run(["--record", "BGAR_HGE"], "test", "yade"))
        del old["loading"]["record"]["given"]
        assert differences(old, parse_run(["--record", "BGAR_HGE"], "test", "yade")) == []

    def test_sequences_have_a_column(self, tmp_path):
        written(tmp_path, rows(TIME_S, PULSE_G))
        written(tmp_path, rows(TIME_S, PULSE_GAL, "{1:.6f}\n"), "alone.txt")
        text = "record,unit,sample_step_s\npulse.txt,g,\npulse.txt,m_s2,\nalone.txt,gal,0.005\nBGAR_HGE,,\n"
        path = written(tmp_path, text, "events.csv")
        events = read_sequence(path, 1.0)
        peaks = [event.loading.peak_g for event in events[:3]]
        assert_allclose(peaks, [0.15, 0.15 / 9.81, 0.15], rtol=1e-4)
        lines = record_lines(parse_run(["--sequence", str(path)], "test", "reference"))
        assert "unit of alone: gal (--unit)" in lines and len(lines) == 4
        refused = one_line_error(read_sequence, written(tmp_path, "record\npulse.txt\n", "none.csv"), 1.0)
        assert "line 2: " in refused and "no line names the unit" in refused
        assert "--sequence" in one_line_error(parse_run, ["--sequence", str(path), "--unit", "g"], "test", "yade")

    def test_rows_of_a_study_have_a_column(self, tmp_path):
        text = rows(TIME_S, PULSE_G)
        paths = [written(tmp_path, text), written(tmp_path, f"# acc_g\n{text}", "g.txt")]
        written(tmp_path, f"record,unit\n{paths[0]},cm_s2\n{paths[1]},file\n", "rows.csv")
        study = ('name = "s"\n[[grid]]\nwall = "walls/solid.py"\nrows = "rows.csv"\n'
                 'options = { record = "{record}", unit = "{unit}" }\n')
        runs = load_study(written(tmp_path, study, "s.toml"), "reference", REPOSITORY).runs
        peaks = [run.settings(REPOSITORY).peak_g for run in runs]
        assert_allclose(peaks, [0.0015 / 9.81, 0.15], rtol=1e-3)
        written(tmp_path, f"record,unit\n{paths[0]},file\n", "rows.csv")
        refused_with("no line names the unit", load_study, written(tmp_path, study, "s.toml"), "reference", REPOSITORY)

    def test_tables_of_studies_may_name_the_files_own_unit(self, tmp_path):
        path = written(tmp_path, "time_s,acc_g\n" + rows(TIME_S, PULSE_G))
        asked = parse_run(["--record", str(path), "--unit", "file"], "test", "yade")
        assert asked.loading.record.unit.startswith("g (line 1") and asked.loading.record.given == {}
        refused_with("--unit belongs to --record", parse_run, ["--unit", "g"], "test", "yade")


class TestTimeAxis:
    @pytest.mark.parametrize("times, cause", [
        (np.arange(1, 401), "times 1, 2, 3, ... are no seconds but sample numbers, or milliseconds at 1000 Hz"),
        (5 * np.arange(400), "times 0, 5, 10, ... are no seconds but milliseconds"),
        (0.06 * np.arange(400), "a time step of 0.06 s; expected at most 0.05 s"),
        (0.5 * np.arange(400), "a time step of 0.5 s; expected at most 0.05 s")])
    def test_what_is_no_seconds_is_refused_with_the_way_out(self, tmp_path, times, cause):
        message = one_line_error(read_record, written(tmp_path, "# acc_g\n" + rows(times, PULSE_G)))
        assert cause in message and "--sample-step S" in message

    @pytest.mark.parametrize("times, decimals", [(TIME_S, 2), (np.arange(400) / 300, 2), (TIME_S, 1)])
    def test_rounded_times_are_named(self, tmp_path, times, decimals):
        text = "time_s,acc_g\n" + rows(times, PULSE_G, f"{{:.{decimals}f}},{{:.6f}}\n")
        message = one_line_error(read_record, written(tmp_path, text))
        assert f"times are rounded to {decimals} decimal" in message and "400 samples from 0 to" in message
        assert f"with {decimals + 1} or more decimals" in message

    @pytest.mark.parametrize("times", [np.arange(1, 401), 5 * np.arange(400), np.round(TIME_S, 2), TIME_S])
    def test_the_step_may_be_given(self, tmp_path, times):
        path = written(tmp_path, "# acc_g\n" + rows(times, PULSE_G))
        assert is_the_pulse(read_record(path, sample_step_s=STEP_S), "g")

    def test_a_step_that_is_not_that_of_the_times_is_refused(self, tmp_path):
        path = written(tmp_path, "time_s,acc_g\n" + rows(TIME_S, PULSE_G))
        assert "times step by 0.005 s, --sample-step by 0.01 s" in one_line_error(read_record, path, sample_step_s=0.01)
        for step in (-1.0, 0.0, np.nan):
            assert "--sample-step" in one_line_error(read_record, path, sample_step_s=step)

    def test_a_column_of_accelerations_alone(self, tmp_path):
        path = written(tmp_path, "acc_g\n" + rows(TIME_S, PULSE_G, "{1:.6f}\n"))
        assert is_the_pulse(read_record(path, sample_step_s=STEP_S), "g")
        assert "time step" in one_line_error(read_record, path, sample_step_s=0.2)
        path = written(tmp_path, rows(TIME_S, PULSE_G, "{1:.6f}\n"))
        assert "give --sample-step S" in one_line_error(read_record, path)
        assert is_the_pulse(read_record(path, unit="g", sample_step_s=STEP_S), "g")
        path = written(tmp_path, rows(TIME_S, PULSE_G, "{1:.6f}\n") + "1,2\n")
        assert "line 401" in one_line_error(read_record, path, unit="g", sample_step_s=STEP_S)

    def test_a_lost_sample_is_no_rounding(self, tmp_path):
        times = np.delete(0.01 * np.arange(401), 200)
        path = written(tmp_path, "time_s,acc_g\n" + rows(times, PULSE_G, "{:.2f},{:.6f}\n"))
        assert "line 202: a step of 0.02 s among 0.01 s" in one_line_error(read_record, path)

    def test_a_run_needs_two_samples_in_the_walls_period(self, tmp_path):
        path = written(tmp_path, "time_s,acc_g\n" + rows(4 * TIME_S, PULSE_G))
        asked = parse_run(["--record", str(path)], "test", "reference")
        asked.for_period(0.041)
        assert "a time step of 0.02 s; expected at most half of the wall's first period of 0.039 s" in one_line_error(
            asked.for_period, 0.039)

    def test_peaks_that_no_earthquake_has(self, tmp_path, capsys):
        assert implausible_velocity(3.2) is None and faint_warnings(5e-4) == []
        path = written(tmp_path, "time_s,acc_g\n" + rows(8 * TIME_S, 20 * PULSE_G))
        asked = parse_run(["--record", str(path)], "test", "reference")
        said = one_line_error(asked.check_plausible, Wall("w", 0.9, 0.6))
        assert "PGV of 8.02 m/s, expected up to 4 m/s" in said and "--accept-implausible" in said
        assert main(["record", str(path)]) == 0
        assert "PGV of 8.02 m/s" in capsys.readouterr().err
        path = written(tmp_path, "time_s,acc_gal\n" + rows(TIME_S, PULSE_G))
        assert main(["record", str(path)]) == 0
        assert "a peak of 0.000153 g, expected 0.0005 g or more" in capsys.readouterr().err


class TestAt2:
    @pytest.mark.parametrize("text", [
        HEAD.replace("OF G", "OF (G)") + COUNTS + lines_of_five(),
        HEAD.replace("OF G", "OF G. FILTER POINTS: HP=0.03 Hz LP=23.6 Hz") + COUNTS + lines_of_five(),
        HEAD + "DT= .0050 SEC, NPTS= 400\n" + lines_of_five(), HEAD + COUNTS + lines_of_five() + "END\n",
        HEAD + "NPTS=  400, DT= 0,005 SEC\n" + lines_of_five(), HEAD + "NPTS: 400 DT: 5.0D-03\n" + lines_of_five(),
        "Orig PEER filename\nH1 for rotation: A\nH2 for rotation: B\nangle -37.0\nFN component\nAcceleration in g\n"
        "400 0.0050 NPTS, DT\n" + lines_of_five(),
        "El Centro\n400 points\nformat of 8F10.5, i.e., 8 points across in\na row\nThe units are (g)\n*** Begin ***\n"
        + COUNTS + lines_of_five(),
        HEAD + COUNTS + lines_of_five().replace("E", "D"),
        HEAD + COUNTS + lines_of_five(-PULSE_G, "{:+.6E}", ""), HEAD + COUNTS + lines_of_five(PULSE_G, "{:+.7f}", "")])
    def test_headers_and_numbers_of_other_programs(self, tmp_path, text):
        for name in ("pulse.AT2", "pulse.txt"):
            assert is_the_pulse(read_record(written(tmp_path, text, name)), "g")

    @pytest.mark.parametrize("line, says", [
        ("ACCELERATION TIME HISTORY (CM/SEC/SEC)", "'ACCELERATION TIME HISTORY (CM/SEC/SEC)' does not name g"),
        ("ACCELERATION TIME HISTORY", "does not name g"), ("ACCELERATION IN UNITS OF G/10", "does not name g"),
        ("ACCELERATION IN G (CM/SEC/SEC)", "names two units"), ("", "does not name g"),
        ("VELOCITY TIME SERIES IN UNITS OF CM/S", "is another quantity")])
    def test_another_unit_is_refused_with_its_line(self, tmp_path, line, says):
        path = written(tmp_path, f"PEER\nQuake, Station, 090\n{line}\n{COUNTS}{lines_of_five()}")
        assert "line 3: " in one_line_error(read_record, path) and says in one_line_error(read_record, path)

    def test_the_unit_may_be_given(self, tmp_path):
        path = written(tmp_path, HEAD.replace("IN UNITS OF G", "(CM/SEC/SEC)") + COUNTS + lines_of_five(PULSE_GAL))
        assert is_the_pulse(read_record(path, unit="gal"), "gal")
        assert "names cm_s2, --unit g" in one_line_error(read_record, path, unit="g")
        path = written(tmp_path, HEAD.replace("ACCELERATION", "VELOCITY") + COUNTS + lines_of_five())
        assert "another quantity" in one_line_error(read_record, path, unit="g")
        path = written(tmp_path, HEAD + COUNTS + lines_of_five())
        assert "expected the DT of its header" in one_line_error(read_record, path, sample_step_s=STEP_S)

    @pytest.mark.parametrize("values, says", [
        ("0.0012340.001235 0.1\n", "line 5: '0.0012340.001235 0.1' is not numeric; expected a blank between numbers"),
        ("0.1 ******** 0.2\n", "is not numeric"), ("0.1 END\n0.2\n", "line 5: '0.1 END' is not numeric"),
        ("0.1 0.2\nEND\n0.3\n", "3 values; expected the NPTS = 2")])
    def test_values_that_cannot_be_origin_apart(self, tmp_path, values, says):
        assert says in one_line_error(read_record, written(tmp_path, f"{HEAD}NPTS= 2, DT= .005\n{values}"))


class TestOtherFormats:
    @pytest.mark.parametrize("encoding", ["utf-16", "utf-16-le", "utf-16-be", "utf-8-sig"])
    def test_unicode_text_of_spreadsheets(self, tmp_path, encoding):
        path = written(tmp_path, "time_s\tacc_g\n" + rows(TIME_S, PULSE_G, "{:.3f}\t{:.6f}\n"), encoding=encoding)
        assert is_the_pulse(read_record(path), "g")
        path = written(tmp_path, "record,scale\nBGAR_HGE,2\n", "events.csv", encoding)
        assert [event.factor for event in read_sequence(path, 1.0)] == [2]

    @pytest.mark.parametrize("begins, name", [
        (b"Corrected acceleration    (Format v01.20 with 13 text lines) Src: f", "COSMOS"),
        (b"2 CORRECTED ACCELEROGRAM   \r\n*", "SMC (USGS)"),
        (b"Origin Time       2018/01/24 19:51:00\n", "K-NET, KiK-net"),
        (b"EVENT_NAME: GREECE\nEVENT_ID: EMSC\n", "ESM, ITACA (DYNA)"), (b"* VOL1DS FILE:  5520/01\r\n", "BHRC (Iran)"),
        (b"FILE     0 OF UNCORRECTED ACCELEROGRAM DATA OF VOLUME I:", "USC"),
        (b"Corrected accelerogram 20180212_211554_WPWS_20 GNS Science\n", "GeoNet V1A/V2A"),
        (b"UNCORRECTED ACCELEROGRAM DATA    PROCESSED: 07/16/98, CDMG", "CSMIP (V1, V2, V3), RENADIC"),
        (b"STRONG GROUND MOTION RECORDS OF TURKIYE\r\n", "AFAD, NSMN (Turkey)"),
        (b"*" * 86 + b"\r\n            INSTITUTO DE INGENIERIA, UNAM", "UNAM (Mexico)"),
        (b"TIMESERIES NL_BGAR__HGE_R, 9304 samples, 200 sps, ...", "SLIST or TSPAIR"),
        (b"\0\0\xa0\x40" * 76 + b"\6\0\0\0" + b"\0" * 400, "SAC"),
        (b"\0\0\xa0\x40" * 76 + b"\0\0\0\6" + b"\0" * 400, "SAC"),
        (b"   0.01000000      -12345.00\n", "SAC"), (b"WID2 2018/01/08", "GSE2 or IMS1"),
        (b"PK\x03\x04..", "spreadsheet or ZIP"),
        (b"<!DOCTYPE html><html>", "web page"),
        (b"\xef\xbb\xbf<?xml version='1.0'?>", "XML, as StationXML or QuakeML")])
    def test_a_format_that_is_not_read_is_named(self, tmp_path, begins, name):
        path = tmp_path / "record.txt"
        path.write_bytes(begins)
        message = one_line_error(read_record, path)
        assert f"its format is {name}, which is not read" in message and "own-record.md" in message

    def test_k_net_by_the_guides_recipe_keeps_no_offset(self, tmp_path, monkeypatch):
        pytest.importorskip("obspy")
        counts = np.round(PULSE_GAL * 8388608 / 2000).astype(int) - 18000
        head = [line[:18].ljust(18) + line[18:] for line in K_NET.splitlines()]
        written(tmp_path, "\n".join([*head, *("".join(map("{:9d}".format, counts[k:k + 8]))
                                              for k in range(0, 400, 8))]) + "\n", "FILE")
        guide = (REPOSITORY / "docs/guides/own-record.md").read_text()
        recipe = re.search(r"^```\n(trace = obspy.read.*?)^```$", guide, re.MULTILINE | re.DOTALL)[1]
        monkeypatch.chdir(tmp_path)
        exec(f"import numpy, obspy\n{recipe}", {})
        record = read_record("record.csv")
        assert (pga_g(record), pgv_cm_s(record)) == pytest.approx((0.15, PULSE_PGV_CM_S), rel=2e-3)

    def test_what_is_read_is_not_foreign(self):
        assert not any(map(foreign, (b"# time_s,acc_g\n", b"0.0 0.1\n", HEAD.encode(), b"acc_g\n", b"-0.5 0.2\n")))

    def test_the_guide_has_a_row_for_each(self):
        guide = (REPOSITORY / "docs/guides/own-record.md").read_text()
        assert [name for name, *_ in FOREIGN if f"| {name} |" not in guide] == []
