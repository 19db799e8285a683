"""Reading ground-motion records and preparing them: formats, bad files, windows, filters."""

import math
import sys
from dataclasses import FrozenInstanceError
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from damage.errors import InputError
from damage.motion.formats import read_record, shipped_record_path
from damage.motion.record import (
    Record,
    aligned_with,
    band_passed,
    baseline_corrected,
    scaled,
    whole_steps,
    windowed,
)
from damage.units import GRAVITY

ROUND_OFF = 1e-12  # relative: a few operations in double precision on numbers of one size
AT2_TITLES = (
    "PEER STRONG MOTION DATABASE\nQuake, Station, 090\nACCELERATION TIME SERIES IN UNITS OF G\n"
)


def write(folder, text, name="motion.csv"):
    path = folder / name
    path.write_text(text)
    return path


def sine_record(frequency_hz=2.0, step_s=0.005, duration_s=20.0, name="sine"):
    time_s = np.arange(round(duration_s / step_s) + 1) * step_s
    return Record(name, step_s, np.sin(2 * np.pi * frequency_hz * time_s), "2018-01-08T14:00:00Z")


def one_line_error(function, *arguments, **named):
    with pytest.raises(InputError) as caught:
        function(*arguments, **named)
    message = str(caught.value)
    assert "\n" not in message
    assert "expected" in message or "run pip install" in message
    return message


class TestRecord:
    def test_time_starts_at_zero_and_ends_at_the_duration(self):
        record = Record("r", 0.01, [0.0, 1.0, 2.0])
        assert_allclose(record.time_s, [0.0, 0.01, 0.02], rtol=ROUND_OFF)
        assert record.duration_s == pytest.approx(0.02, rel=ROUND_OFF)

    def test_a_record_cannot_be_changed_from_outside(self):
        samples = np.array([0.0, 1.0, 2.0])
        record = Record("r", 0.01, samples)
        samples[1] = 9.0
        assert record.acceleration_m_s2[1] == 1.0
        with pytest.raises(ValueError, match="read-only"):
            record.acceleration_m_s2[1] = 9.0
        with pytest.raises(FrozenInstanceError):
            record.time_step_s = 1.0

    @pytest.mark.parametrize("step", [0.0, -0.01, math.nan, math.inf])
    def test_time_step_must_be_positive(self, step):
        assert "time step" in one_line_error(Record, "r", step, [0.0, 1.0])

    @pytest.mark.parametrize("samples", [[], [1.0], [[0.0, 1.0], [1.0, 2.0]]])
    def test_at_least_two_samples_in_one_column(self, samples):
        assert "shape" in one_line_error(Record, "r", 0.01, samples)

    @pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
    def test_samples_must_be_finite(self, bad):
        assert "sample 2 is" in one_line_error(Record, "r", 0.01, [0.0, 1.0, bad])

    def test_start_is_kept_in_utc(self):
        assert Record("r", 1.0, [0, 1], "2018-01-08T15:00:00+01:00").start_utc == (
            "2018-01-08T14:00:00.000000Z"
        )

    def test_start_must_be_a_date(self):
        assert "yesterday" in one_line_error(Record, "r", 1.0, [0, 1], "yesterday")


class TestCsv:
    def test_header_comments_and_blank_lines(self, tmp_path):
        text = "# by hand\ntime_s,acc_m_s2\n0.00,0.1\n\n0.01,-0.2\n# middle\n0.02,0.3\n"
        path = write(tmp_path, text, "here_acc_m_s2.csv")
        record = read_record(path)
        assert (record.name, record.start_utc, record.source) == ("here", "", str(path))
        assert record.time_step_s == 0.01
        assert_allclose(record.acceleration_m_s2, [0.1, -0.2, 0.3], rtol=ROUND_OFF)
        assert len(record.sha256) == 64

    def test_without_a_header_the_unit_is_m_s2(self, tmp_path):
        record = read_record(write(tmp_path, "0,0.1\n0.01,0.2\n"))
        assert_allclose(record.acceleration_m_s2, [0.1, 0.2], rtol=ROUND_OFF)

    def test_g_in_the_header_becomes_m_s2(self, tmp_path):
        record = read_record(write(tmp_path, " Time_s , acc_g\n0,0.1\n0.01,-0.2\n"))
        assert_allclose(record.acceleration_m_s2, [0.1 * GRAVITY, -0.2 * GRAVITY], rtol=ROUND_OFF)

    def test_a_path_may_be_text_and_a_comment_in_any_encoding(self, tmp_path):
        path = tmp_path / "motion.txt"
        path.write_bytes("\ufeff# Prüfung\n0,0\n0.01,1\n".encode("latin-1", errors="ignore"))
        assert read_record(str(path)).acceleration_m_s2[1] == 1.0

    def test_times_from_another_zero_restart_and_move_the_start(self, tmp_path):
        text = "# start 2018-01-08T14:00:37.09Z\n17.00,0.1\n17.01,0.2\n17.02,0.3\n"
        record = read_record(write(tmp_path, text))
        assert record.time_s[0] == 0.0
        assert record.start_utc == "2018-01-08T14:00:54.090000Z"

    def test_rounded_times_are_uniform_enough(self, tmp_path):
        rows = "".join(f"{k / 150:.4f},{k}\n" for k in range(301))
        # the last time is exact here, so only the sum of the twelve kept digits is left
        assert read_record(write(tmp_path, rows)).time_step_s == pytest.approx(1 / 150, rel=1e-11)

    def test_a_decimal_step_stays_the_same_number(self, tmp_path):
        rows = "".join(f"{k / 100:.2f},0\n" for k in range(30))
        # 0.29 / 29 is another double than 0.01
        assert read_record(write(tmp_path, rows)).time_step_s == 0.01

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
            ("0\n0.01\n", "line 1: '0' has 1 column(s)"),
            ("0,1,2\n0.01,1,2\n", "line 1: '0,1,2' has 3 column(s)"),
            ("0 1\n0.01 2\n", "line 1: '0 1' is an unknown header"),
            ("# c\n0,1\n0.01,high\n", "line 3: '0.01,high' is not numeric"),
            ("0,1\n0.01,\n", "line 2: '0.01,' is not numeric"),
            ("0,1\n0.01,2\n0.03,3\n0.04,3\n0.05,3\n", "line 3: a step of 0.02 s among 0.01 s"),
            ("0.02,1\n0.01,2\n0,3\n", "line 2: time 0.01 s after 0.02 s"),
            ("0,1\n0.01,2\n0.01,3\n", "line 3: time 0.01 s after 0.01 s"),
            ("time_s,acc_cm_s2\n0,1\n0.01,2\n", "line 1: 'time_s,acc_cm_s2' is an unknown header"),
            ("t,acc_g\n0,1\n0.01,2\n", "line 1: 't,acc_g' is an unknown header"),
            ("acc_g\n0\n1\n", "line 1: 'acc_g' is an unknown header"),
            ("# start 2018-13-45T99:00\n0,1\n0.01,2\n", "start time '2018-13-45T99:00'"),
        ],
    )
    def test_bad_content_is_told_with_its_line(self, tmp_path, text, says):
        path = write(tmp_path, text)
        message = one_line_error(read_record, path)
        assert says in message
        assert message.startswith(str(path))

    def test_a_lost_sample_in_a_long_record_is_found(self, tmp_path):
        rows = [f"{0.005 * k:.3f},{math.sin(k):.3f}" for k in range(9304)]
        del rows[5000]
        message = one_line_error(read_record, write(tmp_path, "\n".join(rows)))
        assert "line 5001: a step of 0.01 s among 0.005 s" in message

    def test_binary_is_not_a_csv(self, tmp_path):
        path = tmp_path / "motion.csv"
        path.write_bytes(bytes(range(255, 0, -1)))
        assert "line" in one_line_error(read_record, path)

    def test_missing_file_and_directory(self, tmp_path):
        assert "No such file" in one_line_error(read_record, tmp_path / "absent.csv")
        assert "a directory" in one_line_error(read_record, tmp_path)

    def test_shipped_names_are_listed(self):
        assert "BGAR_HGE" in one_line_error(shipped_record_path, "MID1")


class TestPeerAt2:
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
        ],
    )
    @pytest.mark.parametrize("name", ["RSN1_090.AT2", "rsn1_090.at2", "RSN1_090.txt"])
    def test_both_orders_of_the_fourth_line(self, tmp_path, counts, name):
        record = read_record(write(tmp_path, AT2_TITLES + counts + "\n" + self.VALUES, name))
        assert record.name.upper() == "RSN1_090"
        assert record.time_step_s == 0.005
        expected = GRAVITY * np.array([0.01, -0.02, 0.03, 0.04, 0.05])
        assert_allclose(record.acceleration_m_s2, expected, rtol=ROUND_OFF)

    @pytest.mark.parametrize(
        ("text", "says"),
        [
            ("one line\n", "line 4: '' gives no NPTS"),
            (AT2_TITLES + "POINTS 5 STEP .005\n" + VALUES, "gives no NPTS and DT"),
            (AT2_TITLES + "NPTS= 5, DT= E SEC\n" + VALUES, "gives no NPTS and DT"),
            (AT2_TITLES + "NPTS= 6, DT= .005 SEC\n" + VALUES, "5 values; expected the NPTS = 6"),
            (AT2_TITLES + "NPTS= 4, DT= .005 SEC\n" + VALUES, "5 values; expected the NPTS = 4"),
            (AT2_TITLES + "NPTS= 5, DT= 0 SEC\n" + VALUES, "time step [s] = 0.0"),
            (AT2_TITLES + "NPTS= 5, DT= .005 SEC\n.1 .2\n.3 x .5\n", "line 6: '.3 x .5' is not"),
            (AT2_TITLES + "NPTS= 2, DT= .005 SEC\n.1 NaN\n", "line 5: '.1 NaN' is not finite"),
            (
                AT2_TITLES.replace("ACCELERATION", "VELOCITY") + "NPTS= 5, DT= .005 SEC\n" + VALUES,
                "line 3:",
            ),
            (
                AT2_TITLES.replace("OF G", "OF CM/S2") + "NPTS= 5, DT= .005 SEC\n" + VALUES,
                "line 3:",
            ),
        ],
    )
    def test_bad_files(self, tmp_path, text, says):
        assert says in one_line_error(read_record, write(tmp_path, text, "motion.AT2"))


class TestMiniSeed:
    @pytest.fixture
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

    @pytest.mark.usefixtures("obspy")
    def test_counts_become_the_shipped_csv(self):
        counts = read_record(shipped_record_path("NL.BGAR..HGE"))
        table = read_record(shipped_record_path("BGAR_HGE"))
        assert counts.name == "NL.BGAR..HGE"
        assert (counts.start_utc, counts.time_step_s) == (table.start_utc, table.time_step_s)
        # the CSV has seven digits: half a unit of the last one at its peak of 1.09 m/s2 is 5e-7
        assert_allclose(counts.acceleration_m_s2, table.acceleration_m_s2, rtol=0, atol=5.01e-7)

    @pytest.mark.usefixtures("obspy")
    def test_content_is_known_without_a_suffix(self, tmp_path):
        path = tmp_path / "motion.dat"
        path.write_bytes(shipped_record_path("NL.BGAR..HGZ").read_bytes())
        assert read_record(path, self.STATION_XML).name == "NL.BGAR..HGZ"

    def test_station_xml_is_looked_for_beside_the_file(self, trace, tmp_path):
        path = self.saved(trace, tmp_path)
        assert str(tmp_path / "NL.BGAR.xml") in one_line_error(read_record, path)
        (tmp_path / "NL.BGAR.xml").write_bytes(self.STATION_XML.read_bytes())
        assert read_record(path).acceleration_m_s2.size == 9304

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

    @pytest.mark.usefixtures("obspy")
    def test_broken_file(self, tmp_path):
        path = write(tmp_path, "no seed\n", "motion.mseed")
        assert "obspy says" in one_line_error(read_record, path)

    @pytest.mark.usefixtures("obspy")
    @pytest.mark.parametrize(
        ("old", "new", "says"),
        [
            ("M/S**2", "M/S", "M/S of NL.BGAR..HGE"),
            ('Station code="BGAR"', 'Station code="OTHER"', "obspy says"),
            ("213867.4766", "0", "no sensitivity of NL.BGAR..HGE"),
            ("<Network", "<Nonsense", "obspy says"),
        ],
    )
    def test_unfit_station_xml(self, tmp_path, old, new, says):
        text = self.STATION_XML.read_text()
        assert old in text
        path = write(tmp_path, text.replace(old, new), "other.xml")
        assert says in one_line_error(read_record, shipped_record_path("NL.BGAR..HGE"), path)

    def test_without_obspy_the_extra_is_named(self, monkeypatch):
        monkeypatch.setitem(sys.modules, "obspy", None)
        message = one_line_error(read_record, shipped_record_path("NL.BGAR..HGE"))
        assert "pip install obspy" in message
        assert "masonry-damage[obspy]" in message


class TestScaling:
    def test_every_sample_is_scaled_and_the_record_stays(self):
        record = sine_record()
        assert_allclose(
            scaled(record, -1.5).acceleration_m_s2, -1.5 * record.acceleration_m_s2, rtol=ROUND_OFF
        )
        assert record.acceleration_m_s2.max() == pytest.approx(1.0, rel=ROUND_OFF)

    @pytest.mark.parametrize("factor", [math.nan, math.inf])
    def test_factor_must_be_finite(self, factor):
        assert "scale factor" in one_line_error(scaled, sine_record(), factor)


class TestWindow:
    def test_time_restarts_and_the_start_moves(self):
        record = sine_record()
        part = windowed(record, 2.5, 4.0)
        assert part.duration_s == pytest.approx(1.5, rel=ROUND_OFF)
        assert_allclose(part.acceleration_m_s2, record.acceleration_m_s2[500:801], rtol=0, atol=0)
        assert part.start_utc == "2018-01-08T14:00:02.500000Z"

    def test_the_whole_record_is_a_window(self):
        record = sine_record()
        whole = windowed(record, 0.0, record.duration_s)
        assert whole.acceleration_m_s2.size == record.acceleration_m_s2.size

    @pytest.mark.parametrize(
        ("t0", "t1"),
        [(-1, 5), (5, 21), (5, 5), (6, 5), (math.nan, 5), (0, math.inf), (1.0, 1.001)],
    )
    def test_outside_reversed_or_too_short(self, t0, t1):
        assert "window" in one_line_error(windowed, sine_record(), t0, t1)


class TestAlignment:
    def test_the_common_part_holds_the_same_instants(self):
        whole = sine_record()
        late = windowed(whole, 3.0, 8.0)
        part = aligned_with(whole, late)
        assert part.start_utc == late.start_utc
        assert_allclose(part.acceleration_m_s2, late.acceleration_m_s2, rtol=0, atol=0)

    @pytest.mark.parametrize(("t0", "t1"), [(2.0, 4.0), (7.0, 9.0), (0.0, 20.0)])
    def test_a_record_that_starts_later_or_ends_earlier_cannot_cover(self, t0, t1):
        whole = sine_record()
        part, other = windowed(whole, 3.0, 8.0), windowed(whole, t0, t1)
        assert "to cover the other" in one_line_error(aligned_with, part, other)

    def test_without_a_start_time(self):
        timeless = Record("r", 1, [0, 1])
        assert "no start time" in one_line_error(aligned_with, sine_record(), timeless)


class TestBaseline:
    @pytest.mark.parametrize("order", [0, 1, 2, 3])
    def test_a_polynomial_of_the_order_vanishes(self, order):
        time_s = np.arange(1001) * 0.01
        drift = sum((0.3 - 0.1 * k) * time_s**k for k in range(order + 1))
        left = baseline_corrected(Record("drift", 0.01, drift), order).acceleration_m_s2
        # round-off of a least-squares fit to values up to 10^order
        assert_allclose(left, 0.0, atol=1e-13 * 10**order)

    def test_a_higher_term_stays(self):
        time_s = np.arange(1001) * 0.01
        left = baseline_corrected(Record("drift", 0.01, time_s**2), 1).acceleration_m_s2
        # t^2 on 0..L less its best line is (t - L/2)^2 - L^2/12; sampling shifts it by step/L
        assert left[0] == pytest.approx(100 / 6, rel=0.005)

    @pytest.mark.parametrize("order", [-1, 1.5, math.nan, 10])
    def test_order_must_be_a_small_whole_number(self, order):
        assert "baseline order" in one_line_error(baseline_corrected, sine_record(), order)


class TestBandPass:
    @staticmethod
    def amplitude_after(frequency_hz, **options):
        record = sine_record(frequency_hz, duration_s=60.0)
        middle = slice(4000, 8000)  # 20 s away from both ends, and whole cycles
        passed = band_passed(record, 0.5, 20.0, **options).acceleration_m_s2[middle]
        return math.sqrt(2 * np.mean(passed**2))

    def test_the_middle_of_the_band_passes(self):
        # the filter takes (0.05 Hz off its centre / 19.5 Hz)^4, nothing; whole cycles at 3.2 Hz
        assert self.amplitude_after(3.2) == pytest.approx(1.0, rel=1e-6)

    @pytest.mark.parametrize("corner_hz", [0.5, 20.0])
    @pytest.mark.parametrize("order", [2, 4, 8])
    def test_each_corner_halves_the_amplitude(self, corner_hz, order):
        # two passes of 1/sqrt(2); 20 s away the ringing of the ends has died to round-off
        assert self.amplitude_after(corner_hz, order=order) == pytest.approx(0.5, rel=1e-10)

    @pytest.mark.parametrize("frequency_hz", [0.25, 1.0, 15.0, 40.0, 60.0])
    @pytest.mark.parametrize("order", [2, 4])
    def test_amplitude_is_that_of_butterworth(self, frequency_hz, order):
        # the bilinear transform bends frequency: f -> tan(pi f step)
        bent, low, high = (math.tan(math.pi * f * 0.005) for f in (frequency_hz, 0.5, 20.0))
        place = (bent**2 - low * high) / (bent * (high - low))
        found = self.amplitude_after(frequency_hz, order=order)
        # the mean over whole cycles is exact; the ringing of the ends has died to round-off
        assert_allclose(found, 1 / (1 + place**order), rtol=1e-10)

    def test_no_delay(self):
        record = sine_record(3.0)
        passed = band_passed(record, 0.5, 20.0).acceleration_m_s2
        crossings = np.correlate(passed, record.acceleration_m_s2, "same").argmax()
        assert crossings == record.acceleration_m_s2.size // 2

    @pytest.mark.parametrize(
        ("low", "high"), [(0, 20), (-1, 20), (20, 10), (10, 10), (0.1, 100), (0.1, math.nan)]
    )
    def test_corners_must_lie_below_half_the_sampling_rate(self, low, high):
        assert "100 Hz" in one_line_error(band_passed, sine_record(), low, high)

    @pytest.mark.parametrize("order", [0, 3, -4, 2.5, math.nan])
    def test_order_is_shared_by_two_passes(self, order):
        assert "filter order" in one_line_error(band_passed, sine_record(), 0.1, 40, order)

    def test_a_few_samples_cannot_be_filtered(self):
        assert "too few" in one_line_error(band_passed, Record("r", 0.005, [0, 1, 0]), 0.1, 40)


class TestWholeSteps:
    @given(
        step_s=st.floats(1e-4, 0.1),
        max_step_s=st.floats(1e-6, 1.0),
    )
    def test_smallest_number_of_steps_below_the_limit(self, step_s, max_step_s):
        steps = whole_steps(step_s, max_step_s)
        assert step_s / steps <= max_step_s
        assert steps == 1 or step_s / (steps - 1) > max_step_s

    @pytest.mark.parametrize("share", range(1, 60))
    def test_a_limit_that_divides_the_step_is_used_itself(self, share):
        assert whole_steps(0.005, 0.005 / share) == share

    @pytest.mark.parametrize("limit", [0, -1, math.nan, math.inf])
    def test_limit_must_be_positive(self, limit):
        assert "time step" in one_line_error(whole_steps, 0.005, limit)

    def test_no_peak_is_lost_on_resampling(self):
        record = windowed(read_record(shipped_record_path()), 17.0, 23.0)
        step_s = record.time_step_s / whole_steps(record.time_step_s, 1.63e-5)
        time_s = np.arange(round(record.duration_s / step_s) + 1) * step_s
        fine = np.interp(time_s, record.time_s, record.acceleration_m_s2)
        peak = np.abs(record.acceleration_m_s2).max()
        # a step's time is k * step: round-off of the time over the slope of the record
        assert np.abs(fine).max() == pytest.approx(peak, rel=1e-10)
        missed = np.interp(np.arange(0, 6, 1.63e-5), record.time_s, record.acceleration_m_s2)
        assert np.abs(missed).max() < peak * (1 - 1e-6)


def test_shipped_files_are_named_in_their_readme():
    folder = Path(shipped_record_path()).parent
    readme = (folder / "README.md").read_text()
    for fact in ("CC BY 4.0", "10.21944/e970fd34-23b9-3411-b366-e4f72877d2c5", "KNMI"):
        assert fact in readme
