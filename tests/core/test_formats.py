"""Formats of ground-motion records: which are read, by which names, and which are refused."""

import hashlib
import re
import sys

import numpy as np
import pytest
from conftest import REPOSITORY, one_line_error, written
from numpy.testing import assert_allclose

from damage.motion.formats import FOREIGN, foreign, read_record, shipped_record_path
from damage.motion.intensity import pga_g, pgv_cm_s

ROUND_OFF = 1e-12  # relative: a few operations in double precision on numbers of one size
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


class TestNames:
    def test_a_record_that_ships_is_read_by_its_name(self, tmp_path, monkeypatch):
        monkeypatch.chdir(tmp_path)
        assert read_record("BGAR_HGE").sha256 == read_record(shipped_record_path("BGAR_HGE")).sha256
        written(tmp_path / "BGAR_HGE", "time_s,acc_g\n0,1\n0.01,2\n")
        assert read_record("BGAR_HGE").acceleration_m_s2.size == 2  # a file comes first
        assert one_line_error(read_record, "BGRA_HGE").endswith("; did you mean BGAR_HGE?")
        assert "tests" not in one_line_error(read_record, "absent")
        assert "BGAR_HGE" in one_line_error(shipped_record_path, "MID1")

    def test_shipped_record(self):
        record = read_record(shipped_record_path())
        assert (record.name, record.time_step_s) == ("BGAR_HGE", 0.005)
        assert record.acceleration_m_s2.size == 9304
        assert record.start_utc == "2018-01-08T14:00:37.090000Z"
        # the data's description says "near 18.8 s"
        strong_s = record.time_s[np.abs(record.acceleration_m_s2).argmax()]
        assert strong_s == pytest.approx(18.8, abs=0.1)

    def test_shipped_files_are_named_in_their_readme(self):
        readme = (shipped_record_path().parent / "README.md").read_text()
        for fact in ("CC BY 4.0", "10.21944/e970fd34-23b9-3411-b366-e4f72877d2c5", "KNMI"):
            assert fact in readme

    def test_missing_file_directory_and_binary(self, tmp_path):
        assert "No such file" in one_line_error(read_record, tmp_path / "absent.csv")
        assert "a directory" in one_line_error(read_record, tmp_path)
        path = written(tmp_path / "motion.csv", bytes(range(255, 0, -1)))
        assert "0 data rows" in one_line_error(read_record, path)


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
        path = written(tmp_path / "motion.mseed", "no seed\n")
        assert "obspy says" in one_line_error(read_record, path)

    @pytest.mark.parametrize(
        ("old", "new", "says"),
        [
            ("M/S**2", "M/S", "M/S of NL.BGAR..HGE"),
            ('Station code="BGAR"', 'Station code="OTHER"', "obspy says"),
            ("213867.4766", "0", "no sensitivity of NL.BGAR..HGE"),
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
    def test_unfit_station_xml(self, tmp_path, old, new, says):
        text = self.STATION_XML.read_text()
        assert old in text
        path = written(tmp_path / "other.xml", text.replace(old, new))
        assert says in one_line_error(read_record, shipped_record_path("NL.BGAR..HGE"), path)

    def test_a_velocity_in_the_first_stage_is_refused(self, tmp_path):
        head, stage, rest = self.STATION_XML.read_text().partition('<Stage number="1">')
        path = written(tmp_path / "other.xml", head + stage + rest.replace("M/S**2", "M/S", 1))
        message = one_line_error(read_record, shipped_record_path("NL.BGAR..HGE"), path)
        assert "is per M/S**2, but its first stage takes M/S; expected M/S**2 of both" in message

    def test_a_sensitivity_within_the_tolerance_and_one_without_stages_are_taken(
        self, obspy, tmp_path
    ):
        usual = read_record(shipped_record_path("NL.BGAR..HGE"))
        text = self.STATION_XML.read_text().replace("213867.4766", "220000")
        path = written(tmp_path / "other.xml", text)
        found = read_record(shipped_record_path("NL.BGAR..HGE"), path)
        assert_allclose(
            found.acceleration_m_s2, usual.acceleration_m_s2 * 213867.4766 / 220000, rtol=ROUND_OFF
        )
        inventory = obspy.read_inventory(str(self.STATION_XML))
        for channel in inventory[0][0]:
            channel.response.response_stages = []
        inventory.write(str(path), format="STATIONXML")
        assert_allclose(
            read_record(shipped_record_path("NL.BGAR..HGE"), path).acceleration_m_s2,
            usual.acceleration_m_s2,
            rtol=1e-6,
        )

    def test_samples_in_a_physical_unit_are_no_counts(self, trace, tmp_path):
        """They were taken for counts: a PGA of 0.11 g was read as 5e-7 g."""
        whole = read_record(self.saved(trace, tmp_path), self.STATION_XML)
        counts, trace.data = trace.data, trace.data / 213867.4766
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
    message = one_line_error(read_record, shipped_record_path("NL.BGAR..HGE"))
    assert "pip install obspy" in message and "masonry-damage[obspy]" in message


class TestOtherFormats:
    @pytest.mark.parametrize(
        "begins, name",
        [
            (b"Corrected acceleration    (Format v01.20 with 13 text lines) Src: f", "COSMOS"),
            (b"2 CORRECTED ACCELEROGRAM   \r\n*", "SMC (USGS)"),
            (b"Origin Time       2018/01/24 19:51:00\n", "K-NET, KiK-net"),
            (b"EVENT_NAME: GREECE\nEVENT_ID: EMSC\n", "ESM, ITACA (DYNA)"),
            (b"* VOL1DS FILE:  5520/01\r\n", "BHRC (Iran)"),
            (b"FILE     0 OF UNCORRECTED ACCELEROGRAM DATA OF VOLUME I:", "USC"),
            (b"Corrected accelerogram 20180212_211554_WPWS_20 GNS Science\n", "GeoNet V1A/V2A"),
            (
                b"UNCORRECTED ACCELEROGRAM DATA    PROCESSED: 07/16/98, CDMG",
                "CSMIP (V1, V2, V3), RENADIC",
            ),
            (b"STRONG GROUND MOTION RECORDS OF TURKIYE\r\n", "AFAD, NSMN (Turkey)"),
            (b"*" * 86 + b"\r\n            INSTITUTO DE INGENIERIA, UNAM", "UNAM (Mexico)"),
            (b"TIMESERIES NL_BGAR__HGE_R, 9304 samples, 200 sps, ...", "SLIST or TSPAIR"),
            (b"\0\0\xa0\x40" * 76 + b"\6\0\0\0" + b"\0" * 400, "SAC"),
            (b"\0\0\xa0\x40" * 76 + b"\0\0\0\6" + b"\0" * 400, "SAC"),
            (b"   0.01000000      -12345.00\n", "SAC"),
            (b"WID2 2018/01/08", "GSE2 or IMS1"),
            (b"PK\x03\x04..", "spreadsheet or ZIP"),
            (b"<!DOCTYPE html><html>", "web page"),
            (b"\xef\xbb\xbf<?xml version='1.0'?>", "XML, as StationXML or QuakeML"),
        ],
    )
    def test_a_format_that_is_not_read_is_named(self, tmp_path, begins, name):
        path = tmp_path / "record.txt"
        path.write_bytes(begins)
        message = one_line_error(read_record, path)
        assert f"its format is {name}, which is not read" in message and "record-formats.md" in message

    def test_k_net_by_the_guides_recipe_keeps_no_offset(self, tmp_path, monkeypatch):
        pytest.importorskip("obspy")
        phase = (np.pi * 4.0 * (0.005 * np.arange(400) - 0.6)) ** 2  # a Ricker pulse of 0.15 g
        pulse_gal = 0.15 * 981 * (1 - 2 * phase) * np.exp(-phase)
        counts = np.round(pulse_gal * 8388608 / 2000).astype(int) - 18000
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
        assert (pga_g(record), pgv_cm_s(record)) == pytest.approx((0.15, 5.0155), rel=2e-3)

    def test_what_is_read_is_not_foreign(self):
        assert not any(map(foreign, (b"# time_s,acc_g\n", b"0.0 0.1\n", b"acc_g\n", b"-0.5 0.2\n")))

    def test_the_guide_has_a_row_for_each(self):
        guide = (REPOSITORY / "docs/reference/record-formats.md").read_text()
        assert [name for name, *_ in FOREIGN if f"| {name} |" not in guide] == []
