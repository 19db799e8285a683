"""What drives a run: sines, records with their preparation, free vibration, a pushed top."""

import hashlib
import json
import math

import numpy as np
import pytest
from conftest import refused_with
from numpy.testing import assert_allclose
from pytest import approx

from damage.motion.formats import read_record, shipped_record_path
from damage.motion.intensity import pga_g
from damage.motion.loading import (
    EASE_S,
    FreeVibration,
    Harmonic,
    Recorded,
    TopDisplacement,
    loading_from_dict,
    mean_velocities,
)
from damage.motion.record import Record, band_passed, baseline_corrected, interpolated, windowed
from damage.units import GRAVITY

STEP_LIMITS_S = (1.63e-5, 0.05)


@pytest.fixture(scope="module")
def bgar():
    return read_record(shipped_record_path())


def noise(name="noise", samples=2001, start_utc="2018-01-08T14:00:00Z", seed=1):
    samples = np.random.default_rng(seed).normal(size=samples)
    return Record(name, 0.005, samples, start_utc)


class TestHarmonic:
    def test_a_sine_from_zero(self):
        load = Harmonic(0.2, 0.05)
        time_s = np.linspace(0, 0.6, 601)
        expected = 0.05 * GRAVITY * np.sin(2 * np.pi * time_s / 0.2)
        # round-off of the sine at angles up to 6 pi
        assert_allclose(load.base_acceleration(time_s)[:, 0], expected, rtol=0, atol=1e-14)
        assert_allclose(load.base_acceleration(time_s)[:, 1], 0.0, atol=0)

    def test_nothing_before_and_after(self):
        load = Harmonic(0.2, 0.05, cycles=2)
        assert load.duration_s == approx(0.4, rel=1e-15)  # one product
        assert_allclose(load.base_acceleration([-0.05, 0.45, 1.05]), np.zeros((3, 2)), atol=0)

    @pytest.mark.parametrize("max_step_s", STEP_LIMITS_S)
    @pytest.mark.parametrize("period_s", [0.06, 0.33])
    def test_every_peak_falls_on_a_step(self, period_s, max_step_s):
        load = Harmonic(period_s, 0.1)
        step_s = load.preferred_step_s(max_step_s)
        quarter = round(period_s / 4 / step_s)
        assert step_s <= max_step_s
        assert quarter == 1 or period_s / 4 / (quarter - 1) > max_step_s
        found = load.base_acceleration(np.arange(1, 12, 2) * quarter * step_s)[:, 0] / GRAVITY
        # near its peak the sine hides the round-off of the time: only that of the product is left
        assert_allclose(found, [0.1, -0.1] * 3, rtol=1e-14)


class TestRecorded:
    def test_a_sample_is_met_at_times_that_are_off_by_rounding(self, bgar):
        """The last one, too, which is zero just after it."""
        load = Recorded(bgar)
        for time_s in (
            np.nextafter(bgar.time_s, -1.0),
            bgar.time_s,
            np.nextafter(bgar.time_s, 100.0),
            np.arange(bgar.time_s.size) * 131 * load.preferred_step_s(0.005 / 131),
        ):
            assert np.array_equal(load.base_acceleration(time_s)[:, 0], bgar.acceleration_m_s2)
        load = Recorded(Record("r", 0.1, [1.0, 3.0, 2.0]))
        assert load.base_acceleration([-1e-9, 0.2 + 1e-9]).tolist() == [[0.0, 0.0], [0.0, 0.0]]

    def test_order_of_preparation(self):
        record = noise()
        load = Recorded(record, 2.0, (3, 5), baseline_order=1, band_hz=(0.5, 20))
        expected = windowed(band_passed(baseline_corrected(record), 0.5, 20), 3, 5)
        found = load.motion[0].acceleration_m_s2
        # the same operations
        assert_allclose(found, 2 * expected.acceleration_m_s2, rtol=1e-14)
        windowed_first = band_passed(windowed(record, 3, 5), 0.5, 20).acceleration_m_s2
        assert np.abs(found / 2 - windowed_first).max() > 1e-3

    def test_a_record_is_interpolated_for_a_wall_whose_period_has_fewer_than_ten_steps(self):
        """Lines between samples took off 13 % at five steps a period, 42 % at 2.5 of them."""
        load = Recorded(noise(), -2.0, (3, 5), vertical=noise("up", seed=2), band_hz=(0.5, 20))
        # bit for bit what it was
        assert load.for_period(0.05) is load and load.lost_by_lines is None
        driven = load.for_period(0.025)
        assert driven.lost_by_lines == approx(0.125, abs=1e-3)
        assert load.for_period(0.0127).lost_by_lines == approx(0.415, abs=2e-3)
        for found, record in zip(driven.motion, (load.record, load.vertical)):
            expected = interpolated(band_passed(record, 0.5, 20), (3, 5))
            assert found.time_step_s == expected.time_step_s == 0.0005
            assert_allclose(found.acceleration_m_s2, -2 * expected.acceleration_m_s2, rtol=1e-14)
        assert driven.duration_s == approx(load.duration_s) and driven.name == load.name
        assert driven.preferred_step_s(3e-5) == approx(0.0005 / 17)
        assert driven.applied() is driven.motion[0] and driven.peak_g > load.peak_g
        # one record at one scale is one intensity, whatever the wall
        assert driven.record_pga_g == load.record_pga_g == pga_g(load.motion[0])
        assert driven.as_dict()["pga_g"] > driven.as_dict()["record_pga_g"]

    def test_the_table_of_a_motion_says_whether_it_was_interpolated(self):
        load = Recorded(noise(), 2.0, (3, 5), baseline_order=1)
        assert not {"interpolated_for_s", "lost_by_lines"} & load.as_dict().keys()
        driven = load.for_period(0.025)
        table = json.loads(json.dumps(driven.as_dict()))
        assert (table["interpolated_for_s"], table["lost_by_lines"], table["time_step_s"]) == (
            0.025,
            driven.lost_by_lines,
            0.005,
        )
        again = loading_from_dict(table)
        assert json.loads(json.dumps(again.as_dict())) == table
        assert table["pga_g"] == driven.peak_g > load.as_dict()["pga_g"]

    def test_vertical_gets_the_same_preparation(self):
        east = noise("east")
        up = noise("up", seed=2)
        load = Recorded(east, 0.5, (1, 4), vertical=up, band_hz=(0.5, 20))
        alone = Recorded(up, 0.5, (1, 4), band_hz=(0.5, 20))
        time_s = np.linspace(0, 3, 50)
        found = load.base_acceleration(time_s)
        # the same operations
        assert_allclose(found[:, 1], alone.base_acceleration(time_s)[:, 0], rtol=1e-14)
        assert np.abs(found[:, 0] - found[:, 1]).max() > 0.1

    @pytest.mark.parametrize(
        ("vertical", "refused"),
        [
            (noise("up", samples=2000), "has samples from 0 to"),
            (Record("up", 0.01, np.zeros(2001)), "has no start time"),
            (noise("up", start_utc="2018-01-08T14:00:00.1Z"), "has samples from 0.1 to"),
        ],
    )
    def test_vertical_must_be_simultaneous(self, vertical, refused):
        refused_with(refused, Recorded, noise(), vertical=vertical)

    def test_description_identifies_the_file(self, bgar):
        load = Recorded(bgar, 1.5, (17, 23), baseline_order=1, band_hz=(0.1, 40))
        found = json.loads(json.dumps(load.as_dict()))
        content = shipped_record_path().read_bytes()
        assert found["horizontal"] == {
            "record": "BGAR_HGE",
            "file": "BGAR_HGE_acc_m_s2.csv",
            "sha256": hashlib.sha256(content).hexdigest(),
            "start_utc": "2018-01-08T14:00:37.090000Z",
            "unit": "m_s2 (line 2: 'time_s,acc_m_s2')",
        }
        assert (found["kind"], found["scale"], found["window_s"]) == ("record", 1.5, [17.0, 23.0])
        assert (found["baseline_order"], found["band_hz"]) == (1, [0.1, 40.0])
        assert found["vertical"] is None


class TestFreeVibration:
    def test_last_bits_of_the_critical_step_do_not_choose_the_step(self):
        """Last bits of one wall's linear algebra differ by one thread and by two: a wall pushed so
        had peaks 0.7 % apart."""
        one = 9.270022376811165e-06
        two = 9.27002237681116e-06
        assert (
            FreeVibration().preferred_step_s(one)
            == FreeVibration().preferred_step_s(two)
            == 9.27002e-06
        )

    @pytest.mark.parametrize("velocity", [0.0, -1e-3, math.nan, math.inf])
    def test_velocity_must_be_positive(self, velocity):
        refused_with("top velocity", FreeVibration, velocity)


class TestTopDisplacement:
    HEIGHT = 2.8
    LOAD = TopDisplacement((0.01, 0.1), cycles=1, speed_m_s=2e-3)

    def test_reaches_every_turning_point_and_no_further(self):
        time_s = np.linspace(0, self.LOAD.schedule(self.HEIGHT)[0][-1] + 1, 100_001)
        top = self.LOAD.top_displacement(time_s, self.HEIGHT)
        turns = top[np.flatnonzero(np.diff(np.sign(np.diff(top))))]
        assert_allclose([turns.max(), turns.min()], [2.8e-3, -2.8e-3], rtol=1e-6)
        assert_allclose(
            self.LOAD.turning_points(self.HEIGHT), [2.8e-4, -2.8e-4, 2.8e-3, -2.8e-3, 0]
        )
        assert top[0] == 0 and abs(top[-1]) < 1e-15
        assert np.abs(top).max() <= self.LOAD.turning_points(self.HEIGHT).max() * (1 + 1e-12)

    def test_the_last_bit_of_the_height_does_not_reach_the_top(self):
        time_s = np.linspace(0, self.LOAD.length_s(self.HEIGHT), 1001)
        top = [
            self.LOAD.top_displacement(time_s, height)
            for height in (self.HEIGHT, np.nextafter(self.HEIGHT, 3.0))
        ]
        assert np.array_equal(*top)

    def velocities(self, interval_s):
        n = math.ceil(self.LOAD.length_s(self.HEIGHT) / interval_s)
        return mean_velocities(self.LOAD.drive.top, interval_s, n, self.HEIGHT)

    def test_speed_is_kept_and_changes_smoothly(self):
        interval = 1e-4
        speed = self.velocities(interval)
        assert_allclose(np.abs(speed).max(), 2e-3, rtol=1e-6)
        assert np.abs(np.diff(speed)).max() < 2e-3 * interval / EASE_S * 1.001
        assert abs(speed[0]) < 2e-5 and abs(speed[-1]) < 2e-5

    def test_velocities_add_up_to_the_displacement(self):
        interval = 2.1e-3
        moved = np.cumsum(self.velocities(interval)) * interval
        asked = self.LOAD.top_displacement(np.arange(1, len(moved) + 1) * interval, self.HEIGHT)
        assert_allclose(moved, asked, atol=1e-12)
