"""Ground-motion records and what prepares them: windows, alignment, baseline, filters."""

import hashlib
import math
from dataclasses import FrozenInstanceError, replace

import numpy as np
import pytest
import scipy
from conftest import one_line_error, refused_with
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from pytest import approx

from damage.motion.formats import read_record, shipped_record_path, shipped_records
from damage.motion.loading import Recorded
from damage.motion.plausible import record_warnings
from damage.motion.record import (
    FINER,
    KAISER_BETA,
    REACH,
    Record,
    band_passed,
    baseline_corrected,
    interpolated,
    on_axis_of,
    whole_steps,
    windowed,
)
from damage.motion.samples import linear

ROUND_OFF = 1e-12  # relative: a few operations in double precision on numbers of one size


def sine_record(frequency_hz=2.0, step_s=0.005, duration_s=20.0, name="sine"):
    time_s = np.arange(round(duration_s / step_s) + 1) * step_s
    return Record(name, step_s, np.sin(2 * np.pi * frequency_hz * time_s), "2018-01-08T14:00:00Z")


class TestRecord:
    def test_a_record_cannot_be_changed_from_outside(self):
        samples = np.array([0.0, 1.0, 2.0])
        record = Record("r", 0.01, samples)
        samples[1] = 9.0
        assert record.acceleration_m_s2[1] == 1.0
        with pytest.raises(ValueError, match="read-only"):
            record.acceleration_m_s2[1] = 9.0
        with pytest.raises(FrozenInstanceError):
            record.time_step_s = 1.0

    def test_start_is_kept_in_utc(self):
        assert (
            Record("r", 1.0, [0, 1], "2018-01-08T15:00:00+01:00").start_utc
            == "2018-01-08T14:00:00.000000Z"
        )


class TestOffsetsAndSpikes:
    """A motion about another value than zero, samples that are none: named, with what to do;
    nothing else is."""

    def test_an_offset_is_named_until_the_baseline_is_taken_off(self):
        moved = Record("moved", 0.005, sine_record().acceleration_m_s2 + 0.2)
        loading = Recorded(moved, window_s=(3.0, 8.0))
        (said,) = record_warnings(loading)
        assert (
            "moved: the mean of the first 1 s is 0.2 m/s2, 17 % of the peak" in said
            and "--baseline 0" in said
        )
        assert record_warnings(replace(loading, baseline_order=0)) == []

    @pytest.mark.parametrize(
        "samples, said",
        [
            ({1500: -9.99}, "sample 1500 (from 0) at 7.5 s is -9.99 m/s2; expected about "),
            (
                {1500: -9.99, 1501: -9.99, 3000: -9.99},
                "-9.99 m/s2, and 2 more like it; expected about",
            ),
            ({0: 4.0}, "sample 0 (from 0) at 0 s is 4 m/s2"),
        ],
    )
    def test_a_sample_that_no_motion_has(self, samples, said):
        motion = sine_record().acceleration_m_s2.copy()
        motion[list(samples)] = list(samples.values())
        assert any(said in one for one in record_warnings(Recorded(Record("r", 0.005, motion))))
        quiet = Record("quiet", 0.005, np.zeros(motion.size))
        assert any(
            said in one
            for one in record_warnings(Recorded(quiet, across=Record("r", 0.005, motion)))
        )

    @pytest.mark.parametrize(
        "horizontal, vertical",
        [("ABCD_HNE", "ABCD_HNZ"), ("NL.BGAR..HG1", "NL.BGAR..HGZ"), ("AKT013_NS2", "AKT013.UD")]
        + [("RSN6_IMPVALL.I_I-ELC180", "RSN6_IMPVALL.I_I-ELC-UP"), ("HNN", "HNZ")],
    )
    def test_a_component_in_the_other_s_place_by_its_name(self, horizontal, vertical):
        """One named as vertical gave a RotD100 of the wrong two directions without a word."""
        level, up = (replace(sine_record(), name=name) for name in (horizontal, vertical))
        other = replace(level, name="other")
        assert record_warnings(Recorded(level, vertical=up, across=other)) == []
        (said,) = record_warnings(Recorded(up))
        assert said.startswith(f"{vertical}: its name is that of a vertical component")
        (said,) = record_warnings(Recorded(other, vertical=level))
        assert "its name is that of a horizontal component, and it is taken as the vertical" in said
        refused_with("expected the other horizontal component", Recorded, level, across=up)

    @pytest.mark.parametrize("name", ["up", "SETUP", "motion_XYZ", "quake_Z", "a_ABZ", "x_180"])
    def test_other_names_say_nothing_of_a_direction(self, name):
        record = replace(sine_record(), name=name)
        assert record_warnings(Recorded(record)) == []
        Recorded(sine_record(), across=record)

    def test_no_record_that_ships_is_doubtful(self):
        paths = [path for path in shipped_records().values() if path.suffix == ".csv"]
        assert len(paths) >= 30
        assert [
            said for path in paths for said in record_warnings(Recorded(read_record(path)))
        ] == []


class TestWindow:
    def test_time_restarts_and_the_start_moves(self):
        record = sine_record()
        part = windowed(record, 2.5, 4.0)
        assert part.duration_s == approx(1.5, rel=ROUND_OFF)
        assert_allclose(part.acceleration_m_s2, record.acceleration_m_s2[500:801], rtol=0, atol=0)
        assert part.start_utc == "2018-01-08T14:00:02.500000Z"


class TestInterpolation:
    def test_a_window_is_the_part_of_the_whole(self):
        record = sine_record(step_s=0.02, duration_s=10.0)
        part = interpolated(record, (4.0, 6.0))
        whole = interpolated(record)
        cut = windowed(record, 4.0, 6.0)
        assert (part.duration_s, part.start_utc) == (approx(cut.duration_s), cut.start_utc)
        assert_allclose(
            part.acceleration_m_s2, whole.acceleration_m_s2[2000:3001], rtol=0, atol=1e-12
        )
        refused_with("expected 0 <= start < end", interpolated, record, (4.0, 60.0))

    def test_a_record_that_gets_too_long_is_refused(self):
        long = Record("long", 0.01, np.zeros(100_001))
        refused_with(
            "100001 samples of 0.01 s to interpolate; expected up to 100000", interpolated, long
        )
        assert interpolated(long, (0.0, 10.0)).duration_s == approx(10.0)

    @pytest.mark.parametrize("size", [3, 50, 2000])
    def test_values_are_those_of_scipy(self, size):
        """Within 1e-14 of the peak; shorter records than REACH are reflected again and again."""
        record = Record("noise", 0.01, np.random.default_rng(5).normal(size=size))
        window = scipy.signal.firwin(
            2 * REACH * FINER + 1, 1 / FINER, window=("kaiser", KAISER_BETA)
        )
        around = np.pad(record.acceleration_m_s2, REACH, mode="reflect", reflect_type="odd")
        expected = scipy.signal.resample_poly(around, FINER, 1, window=window)[REACH * FINER :][
            : (size - 1) * FINER + 1
        ]
        found = interpolated(record).acceleration_m_s2
        assert_allclose(found, expected, rtol=0, atol=1e-14 * np.abs(around).max())


class TestLines:
    def test_values_are_those_of_numpy(self):
        """Outside and at the points to the bit."""
        at, values = np.cumsum(np.random.default_rng(6).uniform(0.1, 2.0, (2, 30)), axis=1)
        x = np.linspace(at[0] - 1, at[-1] + 1, 1001)
        assert_allclose(linear(x, at, values), np.interp(x, at, values), rtol=1e-14)
        assert np.array_equal(
            linear([at[0] - 1, *at, at[-1] + 1], at, values), [values[0], *values, values[-1]]
        )
        assert linear(0.5, (0.0, 1.0), (2.0, 4.0)) == 3.0


class TestAlignment:
    def test_the_common_part_holds_the_same_instants(self):
        whole = sine_record()
        late = windowed(whole, 3.0, 8.0)
        part = on_axis_of(whole, late)
        assert (part.start_utc, part.late_s) == (late.start_utc, -3.0)
        assert_allclose(part.acceleration_m_s2, late.acceleration_m_s2, rtol=0, atol=0)


class TestBaseline:
    @pytest.mark.parametrize("order", [0, 1, 4, 9])
    def test_values_are_those_of_numpy(self, order):
        """Within 1e-13 of the largest; ten samples have a polynomial of the order 9 through all."""
        for size in (10, 3000):
            record = Record("walk", 0.01, np.cumsum(np.random.default_rng(7).normal(size=size)))
            fit = np.polynomial.Polynomial.fit(record.time_s, record.acceleration_m_s2, order)
            assert_allclose(
                baseline_corrected(record, order).acceleration_m_s2,
                record.acceleration_m_s2 - fit(record.time_s),
                rtol=0,
                atol=1e-13 * np.abs(record.acceleration_m_s2).max(),
            )


class TestBandPass:
    @pytest.mark.parametrize("order", [2, 4, 20])
    @pytest.mark.parametrize("band_hz", [(0.1, 40.0), (2.0, 3.0), (0.05, 99.0)])
    def test_values_are_those_of_scipy(self, order, band_hz):
        """Within 1e-10 of the peak, to the last sample, of a record that begins and ends in full
        motion."""
        record = Record("noise", 0.005, np.random.default_rng(8).normal(size=3000) + 2.0)
        sections = scipy.signal.butter(
            order // 2, band_hz, "bandpass", fs=1 / record.time_step_s, output="sos"
        )
        expected = scipy.signal.sosfiltfilt(sections, record.acceleration_m_s2)
        found = band_passed(record, *band_hz, order).acceleration_m_s2
        assert_allclose(
            found, expected, rtol=0, atol=1e-10 * np.abs(record.acceleration_m_s2).max()
        )

    @pytest.mark.parametrize("order", [2, 4, 20])
    def test_the_shortest_record_is_longer_than_what_its_ends_are_continued_by(self, order):
        record = Record("noise", 0.005, np.random.default_rng(9).normal(size=3 * order + 4))
        assert np.isfinite(band_passed(record, 0.5, 20, order).acceleration_m_s2).all()
        refused_with(
            "samples are too few for a filter",
            band_passed,
            windowed(record, 0.0, 0.005 * (3 * order + 2)),
            0.5,
            20,
            order,
        )


class TestWholeSteps:
    @given(
        step_s=st.floats(1e-4, 0.1),
        max_step_s=st.floats(1e-6, 1.0),
    )
    def test_smallest_number_of_steps_below_the_limit(self, step_s, max_step_s):
        steps = whole_steps(step_s, max_step_s)
        assert step_s / steps <= max_step_s
        assert steps == 1 or step_s / (steps - 1) > max_step_s

    @pytest.mark.parametrize("share", [1, 3, 49, 59])
    def test_a_limit_that_divides_the_step_is_used_itself(self, share):
        assert whole_steps(0.005, 0.005 / share) == share


@pytest.mark.parametrize(
    "prepared, start",
    [
        (lambda record: interpolated(record, (17.0, 23.0)), "95b99cf4bc81"),
        (lambda record: band_passed(record, 0.1, 40.0), "5aa156fd7444"),
        (lambda record: band_passed(record, 0.5, 20.0, 6), "a8d437bc2abe"),
        (lambda record: baseline_corrected(record, 9), "106235ec8f3b"),
    ],
    ids=["interpolated", "band", "band 6", "baseline"],
)
def test_bits_are_the_same_on_every_machine(prepared, start):
    """One record that ships, by the start of their SHA-256."""
    samples = prepared(read_record(shipped_record_path())).acceleration_m_s2
    assert hashlib.sha256(samples.astype("<f8").tobytes()).hexdigest()[:12] == start


SINE = sine_record()


@pytest.mark.parametrize(
    "refusal",
    [
        *(("time step", Record, "r", step, [0.0, 1.0]) for step in (0.0, math.nan)),
        *(("shape", Record, "r", 0.01, samples) for samples in ([1.0], [[0.0, 1.0], [1.0, 2.0]])),
        *(("sample 2 is", Record, "r", 0.01, [0.0, 1.0, bad]) for bad in (math.nan, -math.inf)),
        ("yesterday", Record, "r", 1.0, [0, 1], "yesterday"),
        *(("window", windowed, SINE, *ends) for ends in ((5, 21), (5, 5), (1.0, 1.001))),
        *(
            ("has samples from", on_axis_of, windowed(SINE, 3.0, 8.0), windowed(SINE, *ends))
            for ends in ((2.0, 4.0), (7.0, 9.0), (0.0, 20.0))
        ),
        *(("100 Hz", band_passed, SINE, *corners) for corners in ((20, 10), (10, 10), (0.1, 100))),
        *(("filter order", band_passed, SINE, 0.1, 40, order) for order in (0, 3, 2.5)),
        *(("time step", whole_steps, 0.005, limit) for limit in (0, math.nan)),
    ],
    ids=lambda row: row[0],
)
def test_what_cannot_be_is_refused(refusal):
    """A window outside its record or too short; a record that starts later or ends earlier than
    another.  Odd values of options: `test_bad_input.py`."""
    words, *call = refusal
    assert words in one_line_error(*call)
