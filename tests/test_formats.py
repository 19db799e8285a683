"""Reading ground-motion records: formats, and bad files."""

import hashlib
import sys
from pathlib import Path

import numpy as np
import pytest
from conftest import one_line_error, written
from numpy.testing import assert_allclose

from damage.motion.formats import read_record, shipped_record_path
from damage.units import GRAVITY

ROUND_OFF = 1e-12  # relative: a few operations in double precision on numbers of one size

AT2_TITLES = (
    "PEER STRONG MOTION DATABASE\nQuake, Station, 090\nACCELERATION TIME SERIES IN UNITS OF G\n"
)


def write(folder, text, name="motion.csv"):
    return written(folder / name, text)


class TestCsv:
    def test_header_comments_and_blank_lines(self, tmp_path):
        text = "# by hand\ntime_s,acc_m_s2\n0.00,0.1\n\n0.01,-0.2\n# middle\n0.02,0.3\n"
        path = write(tmp_path, text, "here_acc_m_s2.csv")
        record = read_record(path)
        assert (record.name, record.start_utc, record.source) == ("here", "", str(path))
        assert record.time_step_s == 0.01
        assert_allclose(record.acceleration_m_s2, [0.1, -0.2, 0.3], rtol=ROUND_OFF)
        assert len(record.sha256) == 64

    def test_without_a_header_the_unit_is_asked_for(self, tmp_path):
        path = write(tmp_path, "0,0.1\n0.01,0.2\n")
        assert "no line names the unit" in one_line_error(read_record, path)
        record = read_record(path, unit="m_s2")
        assert_allclose(record.acceleration_m_s2, [0.1, 0.2], rtol=ROUND_OFF)
        assert (record.unit, record.given) == ("m_s2 (--unit)", {"unit": "m_s2"})

    def test_g_in_the_header_becomes_m_s2(self, tmp_path):
        record = read_record(write(tmp_path, " Time_s , acc_g\n0,0.1\n0.01,-0.2\n"))
        assert_allclose(record.acceleration_m_s2, [0.1 * GRAVITY, -0.2 * GRAVITY], rtol=ROUND_OFF)

    @pytest.mark.parametrize(("header", "m_s2"), [
        ("time_s,acc_cm_s2", 0.01), ("time_s,acc_gal", 0.01), ("Time (s), Acceleration (gal)", 0.01),
        ("t [s],a [cm/s²]", 0.01), ("time [s],acc [cm/s^2]", 0.01), ("time_s,accel m/s/s", 1.0),
        ('"time [s]","acc [m/sec2]"', 1.0), ("t_s,acc [g]", GRAVITY)])
    def test_the_header_names_the_unit_in_usual_spellings(self, tmp_path, header, m_s2):
        record = read_record(write(tmp_path, f"{header}\n0,10\n0.01,-20\n"))
        assert_allclose(record.acceleration_m_s2, [10 * m_s2, -20 * m_s2], rtol=ROUND_OFF)

    @pytest.mark.parametrize("text", [
        "time_s;acc_gal\n0;12,5\n0,01;-25\n", "time_s;acc_gal\n0;12.5\n0.01;-25\n",
        "time_s\tacc_gal\n0\t12,5\n0,01\t-25\n", "time [s]  acc [gal]\n 0.00   12.5\n 0.01  -2.5e1\n",
        "time_s acc_gal\n0,00 12,5\n0,01 -25\n", "time_s, acc_gal\n0, 12.5\n0.01, -25.\n"])
    def test_semicolons_tabulators_blanks_and_decimal_commas(self, tmp_path, text):
        record = read_record(write(tmp_path, text, "motion.txt"))
        assert record.time_step_s == 0.01
        assert_allclose(record.acceleration_m_s2, [0.125, -0.25], rtol=ROUND_OFF)

    @pytest.mark.parametrize("text", [
        '"time_s","acc_gal"\n"0.00","12.5"\n"0.01","-25"\n', '"time_s","acc_gal"\n"0,00","12,5"\n"0,01","-25"\n',
        'time_s;acc_gal\n"0,00";"12,5"\n"0,01";"-25"\n', "time_s,acc_gal,\n0,12.5,\n0.01,-25,\n",
        "time_s;acc_gal;;\n0;12,5;;\n0,01;-25;;\n", "time_s,acc_gal\n0,12.5,\n0.01,-25,\n",
        "time_s\tacc_gal\t\n0\t12,5\t\n0,01\t-25\t\n"])
    def test_quotes_and_empty_columns_of_spreadsheets(self, tmp_path, text):
        record = read_record(write(tmp_path, text, "motion.txt"))
        assert record.time_step_s == 0.01
        assert_allclose(record.acceleration_m_s2, [0.125, -0.25], rtol=ROUND_OFF)

    def test_an_exponent_that_is_not_in_utf_8_is_one(self, tmp_path):
        path = written(tmp_path / "motion.csv", "time [s];acc [cm/s²]\n0;1\n0,01;2\n".encode("latin-1"))
        assert_allclose(read_record(path).acceleration_m_s2, [0.01, 0.02], rtol=ROUND_OFF)

    def test_the_unit_is_no_part_of_a_records_name(self, tmp_path):
        assert read_record(write(tmp_path, "time_s,acc_gal\n0,1\n0.01,2\n", "here_acc_gal.csv")).name == "here"

    def test_a_record_that_ships_is_read_by_its_name(self, tmp_path, monkeypatch):
        monkeypatch.chdir(tmp_path)
        assert read_record("BGAR_HGE").sha256 == read_record(shipped_record_path("BGAR_HGE")).sha256
        write(tmp_path, "time_s,acc_g\n0,1\n0.01,2\n", "BGAR_HGE")
        assert read_record("BGAR_HGE").acceleration_m_s2.size == 2  # a file comes first
        assert one_line_error(read_record, "BGRA_HGE").endswith("; did you mean BGAR_HGE?")
        assert "tests" not in one_line_error(read_record, "absent")

    def test_a_path_may_be_text_and_a_comment_in_any_encoding(self, tmp_path):
        path = tmp_path / "motion.txt"
        path.write_bytes("\ufeff# Prüfung in m/s2\n0,0\n0.01,1\n".encode("latin-1", errors="ignore"))
        assert read_record(str(path)).acceleration_m_s2[1] == 1.0

    def test_times_from_another_zero_restart_and_move_the_start(self, tmp_path):
        text = "# start 2018-01-08T14:00:37.09Z\n17.00,0.1\n17.01,0.2\n17.02,0.3\n"
        record = read_record(write(tmp_path, text), unit="g")
        assert record.time_s[0] == 0.0
        assert record.start_utc == "2018-01-08T14:00:54.090000Z"

    def test_rounded_times_are_uniform_enough(self, tmp_path):
        rows = "".join(f"{k / 150:.4f},{k}\n" for k in range(301))
        # the last time is exact here, so only the sum of the twelve kept digits is left
        assert read_record(write(tmp_path, rows), unit="g").time_step_s == pytest.approx(1 / 150, rel=1e-11)

    def test_a_decimal_step_stays_the_same_number(self, tmp_path):
        rows = "".join(f"{k / 100:.2f},0\n" for k in range(30))
        # 0.29 / 29 is another double than 0.01
        assert read_record(write(tmp_path, rows), unit="g").time_step_s == 0.01

    def test_shipped_record(self):
        record = read_record(shipped_record_path())
        assert record.name == "BGAR_HGE"
        assert record.time_step_s == 0.005
        assert record.acceleration_m_s2.size == 9304
        assert record.start_utc == "2018-01-08T14:00:37.090000Z"
        strong_s = record.time_s[np.abs(record.acceleration_m_s2).argmax()]
        # the data's description says "near 18.8 s"
        assert strong_s == pytest.approx(18.8, abs=0.1)

    @pytest.mark.parametrize(
        ("text", "says"),
        [
            ("", "empty"),
            (" \n\n", "empty"),
            ("# only a comment\n", "0 data rows"),
            ("time_s,acc_m_s2\n", "0 data rows"),
            ("time_s,acc_m_s2\n0,1\n", "1 data rows"),
            ("0,1\n0.01,nan\n", "line 2: '0.01,nan' is not finite"),
            ("0,1\n0.01,-inf\n", "line 2: '0.01,-inf' is not finite"),
            ("nan,1\n0.01,1\n", "line 1: 'nan,1' is not finite"),
            ("0\n0.01\n", "line 1: '0' has 1 column(s)"), ("0\n0.01\n", "give --sample-step S"),
            ("0,1,2\n0.01,1,2\n", "line 1: '0,1,2' has 3 column(s)"),
            ("# c\n0,1\n0.01,high\n", "line 3: '0.01,high' is not numeric"),
            ("0,1\n0.01,\n", "line 2: '0.01,' is not numeric"),
            ("0,1\n0.01,2\n0.03,3\n0.04,3\n0.05,3\n", "line 3: a step of 0.02 s among 0.01 s"),
            ("0.02,1\n0.01,2\n0,3\n", "line 2: time 0.01 s after 0.02 s"),
            ("0,1\n0.01,2\n0.01,3\n", "line 3: time 0.01 s after 0.01 s"),
            ("t,acc_g\n0,1\n0.01,2\n", "line 1: 't,acc_g' is an unknown header"),
            ("acc_g\n0\n1\n", "line 1: 'acc_g' is an unknown header"),
            ("time_s,acc\n0,1\n0.01,2\n", "line 1: 'time_s,acc' is an unknown header; expected time_s and one"),
            ("time_s,acc_counts\n0,1\n0.01,2\n", "is an unknown header"),
            ("time_s;acc_g\n0,1\n0.01,2\n", "line 1: 'time_s;acc_g' has another separator than the rows below it"),
            ("time_ms,acc_g\n0,1\n5,2\n", "line 1: 'time_ms,acc_g' has times in milliseconds; expected seconds"),
            ("Time (s);Acc X (cm/s2);Acc Y (cm/s2)\n0,00;1;2\n0,01;1;2\n", "has 3 columns; expected two, time and one "
             "component of the acceleration"),
            ("0;1;2\n0,01;1;2\n", "line 1: '0;1;2' has 3 column(s)"),
            ("0,00;1,5\n0,01;1.200,5\n", "line 2: '0,01;1.200,5' has a decimal point in a file with decimal commas"),
            ("0,00,1,5\n0,01,1,5\n", "line 1: '0,00,1,5' has 4 column(s)"),
            ("# start 2018-13-45T99:00\ntime_s,acc_g\n0,1\n0.01,2\n", "start time '2018-13-45T99:00'"),
        ],
    )
    def test_bad_content_is_reported_with_its_line(self, tmp_path, text, says):
        path = write(tmp_path, text)
        message = one_line_error(read_record, path)
        assert says in message
        assert message.startswith(str(path))

    def test_binary_is_not_a_csv(self, tmp_path):
        path = written(tmp_path / "motion.csv", bytes(range(255, 0, -1)))
        assert "line" in one_line_error(read_record, path)

    def test_missing_file_and_directory(self, tmp_path):
        assert "No such file" in one_line_error(read_record, tmp_path / "absent.csv")
        assert "a directory" in one_line_error(read_record, tmp_path)

    def test_shipped_names_are_listed(self):
        assert "BGAR_HGE" in one_line_error(shipped_record_path, "MID1")


class TestPeerAt2:
    VALUES = "  .1000000E-01 -.2000000E-01  .3000000E-01\n  .4000000E-01  .5000000E-01\n"

    @pytest.mark.parametrize("counts", [
        "NPTS=     5, DT=   .0050 SEC,", "NPTS=5, DT=.00500 SEC", "NPTS=  5 , DT= 0.005 SEC",
        "    5    0.0050   NPTS, DT", "  5, .005, NPTS, DT", "npts= 5, dt= 5.0E-03 sec"])
    @pytest.mark.parametrize("name", ["RSN1_090.AT2", "rsn1_090.at2", "RSN1_090.txt"])
    def test_both_orders_of_the_fourth_line(self, tmp_path, counts, name):
        record = read_record(write(tmp_path, AT2_TITLES + counts + "\n" + self.VALUES, name))
        assert record.name.upper() == "RSN1_090"
        assert record.time_step_s == 0.005
        expected = GRAVITY * np.array([0.01, -0.02, 0.03, 0.04, 0.05])
        assert_allclose(record.acceleration_m_s2, expected, rtol=ROUND_OFF)

    def test_one_motion_is_the_same_in_g_and_in_m_s2(self, tmp_path):
        values_g = [float(cell) for cell in self.VALUES.split()]
        csv = {unit: f"time_s,acc_{unit}\n" + "\n".join(f"{0.005 * k:.3f},{factor * value!r}"
                                                        for k, value in enumerate(values_g))
               for unit, factor in (("g", 1.0), ("m_s2", 9.81))}
        files = {"motion.AT2": AT2_TITLES + "NPTS= 5, DT= .005 SEC\n" + self.VALUES,
                 "g.csv": csv["g"], "m_s2.csv": csv["m_s2"]}
        records = [read_record(write(tmp_path, text, name)) for name, text in files.items()]
        assert len({record.acceleration_m_s2.tobytes() for record in records}) == 1

    @pytest.mark.parametrize(
        ("text", "says"),
        [
            ("one line\n", "line 4: '' gives no NPTS"),
            (AT2_TITLES + "POINTS 5 STEP .005\n" + VALUES, "gives no NPTS and DT"),
            (AT2_TITLES + "NPTS= 5, DT= E SEC\n" + VALUES, "gives no NPTS and DT"),
            (AT2_TITLES + "NPTS= 6, DT= .005 SEC\n" + VALUES, "5 values; expected the NPTS = 6"),
            (AT2_TITLES + "NPTS= 4, DT= .005 SEC\n" + VALUES, "5 values; expected the NPTS = 4"),
            (AT2_TITLES + "NPTS= 5, DT= 0 SEC\n" + VALUES, "time step [s] = 0.0"),
            (AT2_TITLES + "NPTS= 5, DT= 5.0 MSEC\n" + VALUES, "a time step of 5 s; expected at most 0.05 s"),
            (AT2_TITLES + "NPTS= 5, DT= .005 SEC\n.1 .2\n.3 x .5\n", "line 6: '.3 x .5' is not"),
            (AT2_TITLES + "NPTS= 2, DT= .005 SEC\n.1 NaN\n", "line 5: '.1 NaN' is not finite"),
            (AT2_TITLES.replace("ACCELERATION", "VELOCITY") + "NPTS= 5, DT= .005 SEC\n" + VALUES, "line 3:"),
            (AT2_TITLES.replace("OF G", "OF CM/S2") + "NPTS= 5, DT= .005 SEC\n" + VALUES, "line 3:"),
        ],
    )
    def test_bad_files(self, tmp_path, text, says):
        assert says in one_line_error(read_record, write(tmp_path, text, "motion.AT2"))


class TestMiniSeed:
    @pytest.fixture(autouse=True)
    def obspy(self):
        return pytest.importorskip("obspy", reason="obspy is an optional extra")

    @pytest.fixture
    def trace(self, obspy):
        return obspy.read(str(shipped_record_path("NL.BGAR..HGE")))[0]

    STATION_XML = shipped_record_path("BGAR_HGE").parent / "NL.BGAR.xml"

    @staticmethod
    def saved(stream, folder, name="motion.mseed"):
        stream.write(str(folder / name), format="MSEED")
        return folder / name

    def test_counts_become_the_shipped_csv(self):
        counts = read_record(shipped_record_path("NL.BGAR..HGE"))
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

    def test_two_components_are_refused(self, trace, obspy, tmp_path):
        other = trace.copy()
        other.stats.channel = "HGN"
        path = self.saved(obspy.Stream([trace, other]), tmp_path)
        assert "NL.BGAR..HGE, NL.BGAR..HGN" in one_line_error(read_record, path, self.STATION_XML)

    def test_shorter_than_the_quiet_part(self, trace, tmp_path):
        path = self.saved(trace.slice(endtime=trace.stats.starttime + 1), tmp_path)
        assert "201 samples" in one_line_error(read_record, path, self.STATION_XML)

    def test_broken_file(self, tmp_path):
        path = write(tmp_path, "no seed\n", "motion.mseed")
        assert "obspy says" in one_line_error(read_record, path)

    @pytest.mark.parametrize(
        ("old", "new", "says"),
        [
            ("M/S**2", "M/S", "M/S of NL.BGAR..HGE"),
            ('Station code="BGAR"', 'Station code="OTHER"', "obspy says"),
            ("213867.4766", "0", "no sensitivity of NL.BGAR..HGE"),
            ("213867.4766", "427734.9532", "other.xml: sensitivity of NL.BGAR..HGE: 427735, but the gains of its 2 "
             "stages make 213867.4 (0.5099 x 419430); expected the same within 5%"),
            ("419430</Value>", "4194300</Value>", "213867.5, but the gains of its 2 stages make 2138674 "),
            ("COUNTS", "V", "other.xml: sensitivity of NL.BGAR..HGE: 213867.5 V per M/S**2 (by the gains of its 2 "
             "stages 213867.4); expected counts per M/S**2"),
            ("<Network", "<Nonsense", "obspy says"),
        ],
    )
    def test_unfit_station_xml(self, tmp_path, old, new, says):
        text = self.STATION_XML.read_text()
        assert old in text
        path = write(tmp_path, text.replace(old, new), "other.xml")
        assert says in one_line_error(read_record, shipped_record_path("NL.BGAR..HGE"), path)

    def test_a_velocity_in_the_first_stage_is_refused(self, tmp_path):
        head, stage, rest = self.STATION_XML.read_text().partition('<Stage number="1">')
        path = write(tmp_path, head + stage + rest.replace("M/S**2", "M/S", 1), "other.xml")
        message = one_line_error(read_record, shipped_record_path("NL.BGAR..HGE"), path)
        assert "is per M/S**2, but its first stage takes M/S; expected M/S**2 of both" in message

    def test_a_sensitivity_within_the_tolerance_and_one_without_stages_are_taken(self, obspy, tmp_path):
        usual = read_record(shipped_record_path("NL.BGAR..HGE"))
        text = self.STATION_XML.read_text().replace("213867.4766", "220000")
        path = write(tmp_path, text, "other.xml")
        found = read_record(shipped_record_path("NL.BGAR..HGE"), path)
        assert_allclose(found.acceleration_m_s2, usual.acceleration_m_s2 * 213867.4766 / 220000, rtol=ROUND_OFF)
        inventory = obspy.read_inventory(str(self.STATION_XML))
        for channel in inventory[0][0]:
            channel.response.response_stages = []
        inventory.write(str(path), format="STATIONXML")
        assert_allclose(read_record(shipped_record_path("NL.BGAR..HGE"), path).acceleration_m_s2,
                        usual.acceleration_m_s2, rtol=1e-6)

    def test_samples_in_a_physical_unit_are_no_counts(self, trace, tmp_path):
        """They were taken for counts: a PGA of 0.11 g was read as 5e-7 g."""
        whole = read_record(self.saved(trace, tmp_path), self.STATION_XML)
        counts, trace.data = trace.data, trace.data / 213867.4766
        del trace.stats.mseed  # with the encoding of whole numbers
        message = one_line_error(read_record, self.saved(trace, tmp_path), self.STATION_XML)
        peak = np.abs(trace.data).argmax()
        assert f"are no whole numbers, such as number {peak}, {trace.data[peak]:.6g}; expected counts" in message
        trace.data = counts.astype(np.float32)  # counts all the same
        again = read_record(self.saved(trace, tmp_path), self.STATION_XML)
        assert again.acceleration_m_s2.tobytes() == whole.acceleration_m_s2.tobytes()


def test_without_obspy_the_extra_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "obspy", None)
    message = one_line_error(read_record, shipped_record_path("NL.BGAR..HGE"))
    assert "pip install obspy" in message and "masonry-damage[obspy]" in message


def test_shipped_files_are_named_in_their_readme():
    folder = Path(shipped_record_path()).parent
    readme = (folder / "README.md").read_text()
    for fact in ("CC BY 4.0", "10.21944/e970fd34-23b9-3411-b366-e4f72877d2c5", "KNMI"):
        assert fact in readme
