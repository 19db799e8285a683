"""Sequences of events, by factors and from a file: reading, schedule, damage carried over,
tables."""

from types import SimpleNamespace

import numpy as np
import pytest
from conftest import one_line_error, parsed, run_here, written
from numpy.testing import assert_allclose, assert_array_equal
from pytest import approx

from damage.draw.run import sequence_picture
from damage.draw.words import run_title
from damage.measure.cycles import shocks_table
from damage.measure.energy import energy_error
from damage.measure.tables import summary_row, write_run_tables
from damage.motion.sequence import read_sequence
from damage.rounded import ACCELERATION
from damage.run.banner import sequence_lines
from damage.run.paths import free_name
from damage.run.report import describe_events
from damage.run.schedule import base_acceleration, stages
from damage.run.settings import SETTLE_S

DT = 2e-5
RECORD = "damage/data/zeerijp_20180108/BGAR_HGE_acc_m_s2.csv"
DIFFERENT = (
    "record,component,scale,start_s,end_s,rest_s\nBGAR,HGE,2,18.4,19.4,0.1\n"
    "G100_HG2,,8,6,7,\nBWSE_HGN,,-3,20,20.8,0.3\n"
)


def file_of(folder, text, name="sequence.csv"):
    return written(folder / name, text)


def settings(path, words=""):
    return parsed(f"--sequence {path} {words}")


class TestReading:
    def test_rows_become_events(self, tmp_path):
        first, second, third = read_sequence(file_of(tmp_path, DIFFERENT), 0.7)
        assert [event.factor for event in (first, second, third)] == [2, 8, -3]
        assert [event.rest_s for event in (first, second, third)] == [0.1, 0.7, 0.3]
        assert [event.loading.record.name for event in (first, second, third)] == [
            "BGAR_HGE",
            "G100_HG2",
            "BWSE_HGN",
        ]
        assert first.loading.window_s == (18.4, 19.4) and first.loading.scale == 1.0

    def test_only_a_record_is_needed(self, tmp_path):
        (event,) = read_sequence(
            file_of(tmp_path, "record\nMID1_N_synthetic\n"), 2.0, band_hz=(0.5, 40.0)
        )
        assert (event.factor, event.rest_s, event.loading.window_s) == (1.0, 2.0, None)
        assert event.loading.band_hz == (0.5, 40.0)

    def test_the_working_folder_does_not_decide_which_record_is_meant(self, tmp_path, monkeypatch):
        """A batch and its shards have other working folders than the file's, each with a file of
        that name."""
        elsewhere = tmp_path / "elsewhere"
        elsewhere.mkdir()
        (tmp_path / "mine.csv").write_text("time_s,acc_m_s2\n0,0\n0.005,1\n0.01,0\n")
        (elsewhere / "mine.csv").write_text("time_s,acc_m_s2\n0,0\n0.005,5\n0.01,0\n")
        (elsewhere / "other.csv").write_text("time_s,acc_m_s2\n0,0\n0.005,5\n0.01,0\n")
        monkeypatch.chdir(elsewhere)
        (event,) = read_sequence(file_of(tmp_path, "record\nmine.csv\n"), 2.0)
        assert event.loading.peak_g == approx(1 / 9.81)
        assert (
            "is in the working folder; expected it from the folder of this file"
            in one_line_error(read_sequence, file_of(tmp_path, "record\nother.csv\n"), 2.0)
        )

    @pytest.mark.parametrize(
        "text, message",
        [
            ("record,scale\nBGAR_HGE,1\nBGAR_HGX,1\n", "line 3: BGAR_HGX: no such file"),
            ("record,scale\nBGAR_HGE,large\n", "line 2: scale = 'large'"),
            ("record,start_s,end_s\nBGAR_HGE,18,\n", "line 2: a window with one end"),
            ("record,start_s,end_s\nBGAR_HGE,18,99\n", "line 2: window 18.0 to 99.0 s"),
            ('record\n""\n', "line 2: no record"),
            ("record,factor\nBGAR_HGE,1\n", "unknown column 'factor'"),
            ("record\n", "no row"),
            (
                "record\nBGAR_HGE\nten_ms.csv\n",
                "line 3: a record with another time step than the 0.005 s",
            ),
        ],
    )
    def test_a_bad_row_is_named(self, tmp_path, text, message):
        (tmp_path / "ten_ms.csv").write_text("time_s,acc_m_s2\n0,0\n0.01,1\n0.02,0\n")
        assert message in one_line_error(read_sequence, file_of(tmp_path, text), 2.0)

    @pytest.mark.parametrize(
        "words, message",
        [
            ("--record BGAR_HGE", "and --record"),
            ("--window 1 2", "--window"),
            ("--harmonic 0.2 0.1", "--harmonic"),
        ],
    )
    def test_other_motions_beside_it_are_refused(self, tmp_path, words, message):
        assert message in one_line_error(settings, file_of(tmp_path, DIFFERENT), words)

    def test_a_factor_and_a_rest_out_of_range(self, tmp_path):
        for row in ("BGAR_HGE,1e6,1", "BGAR_HGE,1,-1", "BGAR_HGE,1,1e6"):
            one_line_error(settings, file_of(tmp_path, f"record,scale,rest_s\n{row}\n"))


class TestSchedule:
    def test_stages_follow_one_another_with_lengths_of_their_own(self, tmp_path):
        asked = settings(file_of(tmp_path, DIFFERENT), "--rest 0.7")
        schedule = stages(asked, None, DT, 100)
        assert [stage.name for stage in schedule] == 3 * ["motion", "rest", "settling"]
        assert schedule[0].start_step == 0 and all(stage.end_step % 100 == 0 for stage in schedule)
        assert all(
            before.end_step == after.start_step for before, after in zip(schedule, schedule[1:])
        )
        lengths = [(stage.end_step - stage.start_step) * DT for stage in schedule]
        assert lengths == approx(
            [1, 0.1, SETTLE_S, 1, 0.7, SETTLE_S, 0.8, 0.3, SETTLE_S], abs=100 * DT
        )

    def test_the_base_follows_each_record_times_its_factor(self, tmp_path):
        asked = settings(file_of(tmp_path, DIFFERENT))
        schedule = stages(asked, None, DT, 100)
        base = base_acceleration(asked, schedule, DT)
        for event, stage in zip(asked.events, schedule[::3]):
            n = round(event.loading.duration_s / DT) + 1
            assert_allclose(
                base[stage.start_step : stage.start_step + n],
                event.factor * event.loading.base_acceleration(np.arange(n) * DT),
                atol=ACCELERATION / 2,
            )
            # rest and settling
            assert not base[stage.start_step + n : stage.start_step + n + 1000].any()

    def test_equal_rows_are_the_list_of_factors(self, tmp_path):
        rows = "".join(f"{RECORD},{factor},18.4,19.4\n" for factor in (1, -0.5, 0.3))
        of_file = settings(file_of(tmp_path, "record,scale,start_s,end_s\n" + rows), "--rest 0.4")
        of_list = parsed(f"--record {RECORD} --window 18.4 19.4 --sequence 1,-0.5,0.3 --rest 0.4")
        assert stages(of_file, None, DT, 100) == stages(of_list, None, DT, 100)
        schedule = stages(of_file, None, DT, 100)
        assert_array_equal(
            base_acceleration(of_file, schedule, DT), base_acceleration(of_list, schedule, DT)
        )
        assert of_file.peak_g == approx(of_list.peak_g, rel=1e-12)

    def test_the_strongest_motion_names_the_run(self, tmp_path):
        asked = settings(file_of(tmp_path, DIFFERENT))
        peaks = [event.loading.peak_g * abs(event.factor) for event in asked.events]
        assert asked.loading is asked.events[int(np.argmax(peaks))].loading and asked.peak_g == max(
            peaks
        )
        assert free_name(SimpleNamespace(name="w"), asked, "reference").name.startswith(
            "w_sequence-of-3_BGAR_HGE_x1"
        )
        assert "3 events of 3 records" in sequence_lines(asked)[0]


def test_a_row_an_event(tmp_path):
    stronger = file_of(tmp_path, DIFFERENT.replace("HGE,2", "HGE,12"))
    history = run_here(
        tmp_path / "a.h5", "walls/variants/small.py --sequence", stronger, "--rest 0.1"
    )
    table = shocks_table(history)
    assert list(table["factor"]) == [12, 8, -3]
    assert [name.split("_x1")[0] for name in table["motion"]] == [
        "BGAR_HGE",
        "G100_HG2",
        "BWSE_HGN",
    ]
    assert_array_equal(
        table["offset_before_mm"].to_numpy()[1:], table["offset_after_mm"].to_numpy()[:-1]
    )
    assert table["offset_before_mm"].iloc[0] == 0 and (table["newly_failed"] >= 0).all()
    ends = np.flatnonzero(np.diff(history.series["shock"], append=4))
    assert_array_equal(np.cumsum(table["newly_failed"]), history.broken[ends].sum(axis=1))
    assert table["newly_failed"].sum() > 0
    peak = np.abs(history.series["base_acceleration_x_m_s2"]).max() / 9.81
    # of the strongest event, between samples
    assert summary_row(history)["pga_g"] == approx(peak, rel=0.02)
    assert run_title(history) == "Small wall, sequence of three events, three records"
    assert len(describe_events(table)) == 4 and "G100_HG2" in describe_events(table)[2]
    figure = sequence_picture(history)
    assert_array_equal([bar.get_height() for bar in figure.axes[4].patches], table["newly_failed"])


def test_the_first_shock_is_the_run_by_itself_and_damage_is_carried_over(run_of, tmp_path):
    once = run_of("shaken")
    twice = run_of("twice")
    n = len(once.series)
    table = shocks_table(twice)
    assert_array_equal(once.series["drift_ratio"], twice.series["drift_ratio"][:n])
    assert_array_equal(once.slip_m, twice.slip_m[:n])
    assert twice.series["shock"].tolist() == [1] * n + [2] * (len(twice.series) - n)
    assert twice.broken[-1].sum() >= once.broken[-1].sum() > 0 and energy_error(twice.series) < 5e-3
    assert table["residual_DI"].iloc[0] == approx(once.index()["DI"].iloc[-1], abs=1e-12)
    assert twice.opening_m[n].max() > 1e-4  # where the second shock begins
    assert tmp_path / "t_shocks.csv" in write_run_tables(twice, tmp_path / "t")
    assert tmp_path / "o_shocks.csv" not in write_run_tables(once, tmp_path / "o")
