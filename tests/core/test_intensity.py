"""Intensity measures against closed forms and against the values of the Zeerijp records."""

import math
import re

import numpy as np
import pandas as pd
import pytest
from conftest import refused_with
from numpy.testing import assert_allclose
from pytest import approx
from scipy import integrate, signal

from damage import InputError
from damage.files import DATA
from damage.motion.formats import read_record, shipped_record_path
from damage.motion.intensity import (
    APPLIED,
    AVERAGE_PERIODS_S,
    POINTS_PER_PERIOD,
    SPECTRUM_PERIODS_S,
    applied_measures,
    describe,
    drift_warnings,
    end_warnings,
    motion_summary,
    pga_g,
    pgv_m_s,
    pgv_rotd100_m_s,
    response_spectrum,
    rested,
    rotd100,
    significant_duration_s,
    summary,
)
from damage.motion.loading import FreeVibration, Harmonic, Recorded, loading_from_dict
from damage.motion.record import Record, band_passed, on_axis_of, windowed
from damage.units import GRAVITY

# a peak between two of the instants at which it is looked for
BETWEEN_INSTANTS = 1 - math.cos(math.pi / POINTS_PER_PERIOD)


def constant(amplitude_m_s2=1.0, step_s=0.01, samples=501):
    return Record("step", step_s, np.full(samples, amplitude_m_s2))


class TestSpectrum:
    @pytest.mark.parametrize("damping", [0.0, 0.05, 0.3])
    @pytest.mark.parametrize("period_s", [0.013, 1.0])
    def test_sudden_constant_acceleration(self, period_s, damping):
        # overshoot of a step load, exp(-pi z / sqrt(1 - z^2)); constant motion is taken exactly
        overshoot = math.exp(-math.pi * damping / math.sqrt(1 - damping**2))
        sa_g = response_spectrum(constant(GRAVITY), [period_s], damping)
        assert_allclose(sa_g, 1 + overshoot, rtol=BETWEEN_INSTANTS)

    def test_a_stiff_oscillator_follows_the_ground(self):
        record = windowed(read_record(shipped_record_path()), 18.0, 20.0)
        # the overshoot is in proportion to the period: 3e-5 at step/10, 8e-6 at step/30
        for part in (10, 30):
            sa_g = response_spectrum(record, [record.time_step_s / part])
            assert_allclose(sa_g, pga_g(record), rtol=1e-3 / part)

    @pytest.mark.parametrize(
        "refusal",
        [
            *(
                ("expected 0 <= start < end <= 1", significant_duration_s, constant(), *bounds)
                for bounds in ((0.75, 0.05), (0.5, 0.5), (-0.1, 0.5), (0.5, 1.1))
            ),
            ("no motion", significant_duration_s, Record("still", 0.01, np.zeros(100))),
            *(
                ("periods", response_spectrum, constant(), periods_s)
                for periods_s in ([0.0], [-0.1], [math.nan], [[0.1, 0.2]])
            ),
            *(
                ("damping ratio", response_spectrum, constant(), [0.1], damping)
                for damping in (-0.1, 1.0, math.nan)
            ),
        ],
    )
    def test_fractions_increase_periods_are_positive_and_damping_is_below_critical(self, refusal):
        refused_with(*refusal)


def test_the_synthetic_record_has_the_published_peaks_and_spectrum():
    """Targets of damage/data/huizinge_20120816_synthetic/README.md."""
    record = read_record(shipped_record_path("MID1_N_synthetic"))
    periods_s = [0.06, 0.10, 0.12, 0.15, 0.20, 0.25, 0.33, 0.5, 1.0]
    published_g = [0.199, 0.280, 0.319, 0.290, 0.165, 0.123, 0.094, 0.072, 0.014]
    assert pga_g(record) * GRAVITY == approx(0.85, rel=0.03)
    assert pgv_m_s(record) == approx(0.0345, rel=0.1)
    assert_allclose(response_spectrum(record, periods_s), published_g, rtol=0.05)


class TestZeerijpRecords:
    """The measured values that came with the data; tolerance: half a unit of their last digit."""

    # Record, PGA [g] as it is; PGV [cm/s], Arias [m/s], D5-75 [s], D5-95 [s] after a band-pass of
    # 0.1-40 Hz.  PGV came as the sum of the samples times their step, up to 1 % from the velocity's
    # peak at 200 samples a second.
    PEAKS = (
        ("BGAR_HGE", 0.1107, 3.22, 0.0164, 0.43, 3.3),
        ("NL.BGAR..HGN", 0.0713, 2.00, 0.0099, 0.53, 4.3),
        ("NL.BGAR..HGZ", 0.0724, 0.67, 0.0043, 1.8, 4.6),
    )
    KEYS = ("pga_g", "pgv_cm_s", "arias_m_s", "d5_75_s", "d5_95_s")
    SA_G = (0.236, 0.313, 0.264, 0.213, 0.155, 0.105, 0.066, 0.027, 0.006)

    @pytest.mark.parametrize("row", PEAKS, ids=lambda row: row[0])
    def test_peaks_energy_and_durations(self, row):
        if row[0].startswith("NL."):
            pytest.importorskip("obspy", reason="obspy is an optional extra")
        record = read_record(shipped_record_path(row[0]))
        filtered = band_passed(record, 0.1, 40.0)
        found = summary(filtered) | {"pga_g": pga_g(record)}
        for key, expected in zip(self.KEYS, row[1:], strict=True):
            half_digit = 0.5 * 10.0 ** -len(str(expected).partition(".")[2])
            if key == "pgv_cm_s":
                half_digit = 0.005  # 2.00 has two decimals, Python prints one
                summed = (
                    100 * np.abs(np.cumsum(filtered.acceleration_m_s2)).max() * record.time_step_s
                )
                assert summed == approx(expected, abs=half_digit)
                half_digit += 0.01 * summed
            assert found[key] == approx(expected, abs=half_digit), key

    def test_spectrum(self):
        found = summary(read_record(shipped_record_path()))["sa_g"]
        # half a unit of the third decimal
        assert_allclose(list(found.values()), self.SA_G, rtol=0, atol=5e-4)


# 2 s of BGAR, of which a band-pass from 0.1 Hz makes another motion
CUT = {"scale": 3.0, "window_s": (18.2, 20.2)}


class TestLargestOfAllDirections:
    @staticmethod
    def rotated(pair, degrees):
        angle = math.radians(degrees)
        return Record(
            "turned",
            pair[0].time_step_s,
            math.cos(angle) * pair[0].acceleration_m_s2
            + math.sin(angle) * pair[1].acceleration_m_s2,
        )

    @pytest.mark.parametrize("station", ["BGAR", "BLOP"])
    def test_shipped_stations_against_a_turn_by_single_degrees(self, station):
        """180 directions miss the largest by up to 1 - cos(0.5 degrees), 4e-5."""
        east, north = (
            read_record(shipped_record_path(f"{station}_{end}")) for end in ("HGE", "HGN")
        )
        window = (17.0, 27.0)
        pair = [
            windowed(one, *window)
            for one in (
                band_passed(east, 0.5, 40),
                band_passed(on_axis_of(north, east, window), 0.5, 40),
            )
        ]
        turned = [self.rotated(pair, degrees) for degrees in range(180)]
        found = rotd100(*pair)
        assert found["pga_rotd100_g"] == approx(max(map(pga_g, turned)), rel=1e-4)
        assert found["pgv_rotd100_cm_s"] == approx(100 * max(map(pgv_m_s, turned)), rel=2e-4)
        for period in SPECTRUM_PERIODS_S[2::3]:
            assert found["sa_rotd100_g"][str(period)] == approx(
                max(response_spectrum(one, period)[0] for one in turned), rel=1e-3
            )
        table = pd.read_csv(DATA / "zeerijp_20180108" / "components.csv", comment="#").set_index(
            "record"
        )
        # the table's is of the whole record; BLOP steps before 17 s
        whole = 0.05 if station == "BLOP" else 0.01
        assert 0.1 * table["pgv_rotd100_mm_s"][f"{station}_HGE"] == approx(
            found["pgv_rotd100_cm_s"], rel=whole
        )

    def test_a_run_has_it_where_the_other_component_is_given(self):
        east, north = (read_record(shipped_record_path(f"BGAR_{end}")) for end in ("HGE", "HGN"))
        loading = Recorded(east, 2.0, (17, 27), across=on_axis_of(north, east, (17, 27)))
        found = applied_measures(loading.applied(), 0.2, loading.applied_across())
        assert (
            found["pgv_rotd100_m_s"]
            > found["pgv_m_s"]
            == applied_measures(loading.applied(), 0.2)["pgv_m_s"]
        )
        assert applied_measures(loading.applied(), 0.2)["pgv_rotd100_m_s"] is None
        of_both = pgv_rotd100_m_s(*(windowed(one, 17, 27) for one in (east, loading.across)))
        assert found["pgv_rotd100_m_s"] == approx(2 * of_both, rel=1e-9)
        again = loading_from_dict(loading.as_dict())
        assert again.across["record"] == north.name
        assert (
            "across" not in Recorded(east).as_dict()
            and loading.name == Recorded(east, 2.0, (17, 27)).name
        )

    def test_a_component_that_lacks_part_of_the_motion_is_refused(self):
        east, north = (read_record(shipped_record_path(f"BGAR_{end}")) for end in ("HGE", "HGN"))
        refused_with("give --window", on_axis_of, north, east)
        for other in ("BGAR_HGE", "BZN1_HGN"):
            with pytest.raises(InputError, match="of the same station"):
                Recorded(
                    east,
                    window_s=(17, 27),
                    across=on_axis_of(read_record(shipped_record_path(other)), east, (17, 27)),
                )
        refused_with(
            "time step",
            on_axis_of,
            Record("coarse", 0.02, np.ones(5000), start_utc=east.start_utc),
            east,
        )


class TestMotionSummary:
    @staticmethod
    def found(**prepared):
        return motion_summary(Recorded(read_record(shipped_record_path("BGAR_HGE")), **prepared))

    def test_a_cut_has_the_measures_of_the_run(self):
        found = self.found(**CUT)
        applied = applied_measures(
            Recorded(read_record(shipped_record_path("BGAR_HGE")), **CUT).applied(), None
        )
        assert found["pgv_cm_s"] == 100 * applied["pgv_m_s"] == approx(10.05, abs=0.005)
        assert [found[name] for name in ("avg_sa_g", "arias_m_s", "d5_75_s", "d5_95_s")] == [
            applied[name] for name in ("avg_sa_g", "arias_m_s", "d5_75_s", "d5_95_s")
        ]
        assert found["filtered"] == [] and "\nfilter: none (--band" in describe(found)

    @staticmethod
    def motion():
        return Recorded(read_record(shipped_record_path("BGAR_HGE")), **CUT).applied()

    def test_a_filter_on_request_is_named_with_all_measures_that_it_changes(self):
        found = self.found(band_hz=(0.5, 10.0))
        plain = self.found()
        assert found["filtered"] == [name for name in found if name in summary(self.motion())]
        assert all(found[name] != plain[name] for name in found["filtered"])
        assert "\nfilter: zero-phase band-pass 0.5 to 10 Hz, in all measures\n" in describe(found)

    def test_a_run_warns_of_a_baseline_that_is_off(self):
        """As recorded, BLOP east drifts to seven times its PGV; filtered it comes to rest."""
        record = read_record(shipped_record_path("BLOP_HGE"))
        (line,) = end_warnings(Recorded(record, window_s=(16.5, 24.5)).applied())
        assert line.startswith(
            "when the motion ends the base still moves at 0.117 m/s, 100 % of PGV"
        )
        assert (
            end_warnings(Recorded(record, window_s=(16.5, 24.5), band_hz=(0.5, 40.0)).applied())
            == []
        )

    @pytest.mark.parametrize("place", ["record", "vertical", "across"])
    def test_a_baseline_that_drifts_and_comes_to_rest(self, place):
        """A pulse of 0.068 m/s on a line from -c T / 2 to c T / 2, whose mean is zero: a PGV of
        c T^2 / 8 = 0.4 m/s, and an end velocity of zero."""
        step_s = 0.01
        size = 4001
        slope = 2e-3
        time_s = step_s * np.arange(size)
        phase = (np.pi * 2.0 * (time_s - 8.0)) ** 2
        pulse = 1.0 * (1 - 2 * phase) * np.exp(-phase)
        still, drifting = (
            Record(name, step_s, pulse + line)
            for name, line in (("still", 0.0), ("drifting", slope * (time_s - 20.0)))
        )
        assert pgv_m_s(still) == pytest.approx(
            math.exp(-0.5) / (math.sqrt(2) * math.pi * 2), rel=2e-3
        )
        assert pgv_m_s(drifting) == pytest.approx(slope * 40.0**2 / 8, rel=0.15)
        assert end_warnings(drifting) == [] == drift_warnings(Recorded(still))
        parts = {"record": still, place: drifting}
        (said,) = drift_warnings(Recorded(**parts))
        whole, left = re.search(r"PGV of (\S+) m/s is (\S+) without a line", said).groups()
        assert float(whole) == pytest.approx(pgv_m_s(drifting), rel=5e-3)
        assert float(left) == pytest.approx(pgv_m_s(still), rel=0.05)
        assert drift_warnings(Recorded(**parts, baseline_order=1)) == []

    def test_a_baseline_that_swings(self):
        """A cycle of 40 s, which no line takes off."""
        time_s = 0.01 * np.arange(8001)
        pulse = np.exp(-((time_s - 40.0) ** 2)) * np.sin(20.0 * time_s)
        slow = Record("slow", 0.01, 0.05 * np.sin(2 * np.pi * time_s / 40.0) + pulse)
        (said,) = drift_warnings(Recorded(slow))
        assert "without what is below 0.1 Hz (--band 0.1 40)" in said
        assert drift_warnings(Recorded(slow, band_hz=(0.1, 40.0))) == []


MOTIONS = {  # of shipped records, one with all that a run may do to it
    name: {} for name in ("BGAR_HGE", "BLOP_HGN", "MID1_N_synthetic")
} | {
    "windowed": {"window_s": (17.0, 25.0), "scale": -2.0},
    "prepared": {
        "window_s": (15.0, 30.0),
        "scale": 1.5,
        "baseline_order": 1,
        "band_hz": (0.3, 30.0),
    },
}


def fine(record, parts):
    """Time and acceleration on a grid `parts` times as fine, by straight lines between the
    samples."""
    time_s = np.linspace(0, record.duration_s, parts * (record.acceleration_m_s2.size - 1) + 1)
    return time_s, np.interp(time_s, record.time_s, record.acceleration_m_s2)


def simulated_sa_g(record, period_s):
    """Pseudo-acceleration by SciPy's own discretisation of the damped oscillator, base acceleration
    linear in steps."""
    omega = 2 * np.pi / period_s
    time_s, acceleration = fine(
        rested(record, period_s), math.ceil(100 * record.time_step_s / period_s)
    )
    over, under, _ = signal.cont2discrete(
        ([-(omega**2)], [1, 0.1 * omega, omega**2]), time_s[1], method="foh"
    )
    return np.abs(signal.lfilter(over.ravel(), under, acceleration)).max() / GRAVITY


class TestAppliedMotion:
    EIGEN_S = 0.221

    @pytest.mark.parametrize("name", MOTIONS)
    def test_shipped_records_against_scipys_own_integration_and_simulation(self, name):
        record = read_record(
            shipped_record_path(name if name in MOTIONS and not MOTIONS[name] else "BGAR_HGE")
        )
        loading = Recorded(record, **MOTIONS[name])
        found = applied_measures(loading.applied(), self.EIGEN_S)
        assert list(found) == list(APPLIED)
        # what the run itself asks the loading for, on a grid 64 times as fine
        time_s, _ = fine(loading.applied(), 64)
        time_s[-1] -= 1e-9  # the base stops after the last sample
        acceleration = loading.base_acceleration(time_s)[:, 0]
        velocity = integrate.cumulative_trapezoid(acceleration, time_s, initial=0)
        assert found["pgv_m_s"] == approx(np.abs(velocity).max(), rel=1e-5)
        expected = [simulated_sa_g(loading.applied(), period) for period in AVERAGE_PERIODS_S]
        # both look for the peak at 100 instants a period at least, and may pass it by
        # BETWEEN_INSTANTS
        assert found["avg_sa_g"] == approx(np.exp(np.mean(np.log(expected))), rel=BETWEEN_INSTANTS)
        assert found["sa_eigen_period_g"] == approx(
            simulated_sa_g(loading.applied(), self.EIGEN_S), rel=BETWEEN_INSTANTS
        )
        time_s = loading.applied().time_s
        acceleration = loading.applied().acceleration_m_s2
        energy = np.concatenate(
            [[0], np.cumsum((acceleration[1:] ** 2 + acceleration[:-1] ** 2) / 2 * np.diff(time_s))]
        )
        assert found["arias_m_s"] == approx(np.pi / 2 / GRAVITY * energy[-1], rel=1e-9)
        for key, share in (("d5_75_s", 0.75), ("d5_95_s", 0.95)):
            begin, end = np.interp([0.05 * energy[-1], share * energy[-1]], energy, time_s)
            assert found[key] == approx(end - begin, rel=1e-9)

    def test_a_harmonic_motion_by_closed_forms(self):
        found = applied_measures(Harmonic(0.2, 0.1, 3).applied(), None)
        a = 0.1 * GRAVITY
        omega = 2 * np.pi / 0.2
        # straight lines between 400 samples a cycle: (pi / 400)^2 / 3 of an integral
        assert found["pgv_m_s"] == approx(2 * a / omega, rel=3e-5)
        assert found["arias_m_s"] == approx(np.pi / 2 / GRAVITY * a**2 / 2 * 0.6, rel=3e-5)
        assert found["sa_eigen_period_g"] is None

    def test_a_slow_oscillator_peaks_in_the_rest_after_a_short_motion(self):
        # a pulse far shorter than the period leaves the velocity v: Sa = omega v exp(-z atan(q) /
        # q') of free vibration
        period_s = 1.0
        z = 0.05
        record = Record("pulse", 0.001, [0.0, 1.0, 0.0])
        phase = math.acos(z)
        expected = (
            2 * np.pi / period_s * 0.001 * math.exp(-z / math.sqrt(1 - z**2) * phase) / GRAVITY
        )
        assert applied_measures(record, period_s)["sa_eigen_period_g"] == approx(expected, rel=2e-3)
        assert response_spectrum(record, [period_s])[0] < 0.1 * expected

    def test_what_does_not_apply_is_none(self):
        assert set(applied_measures(FreeVibration().applied(), 0.2).values()) == {None}
        assert Harmonic(0.1, 0.1, 10**6).applied() is None
        still = applied_measures(Harmonic(0.1, 0.0).applied(), 0.2)
        assert [name for name, value in still.items() if value is None] == [
            "pgv_rotd100_m_s",
            "d5_75_s",
            "d5_95_s",
        ]
        assert still["avg_sa_g"] == 0
        kept = Recorded(read_record(shipped_record_path())).as_dict()
        assert loading_from_dict(kept).applied() is None  # without its samples
