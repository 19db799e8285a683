"""The program behind docs/validation/shaken-walls.md: the table's motions, the kept prediction."""

import hashlib
import math
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_allclose

from damage.law.modes import natural_modes
from damage.wall.layout import lay_out
from damage.wall.model_options import ModelOptions
from paper import shaken_wall
from paper.shaken_wall import Case

TABLES = Path(__file__).resolve().parents[2] / "docs" / "tables"


@pytest.fixture
def folder(tmp_path):
    """A made-up folder of motions: sines of 8 Hz, three runs."""
    for name, (file, _) in shaken_wall.MOTIONS.items():
        velocity = 100 * np.sin(2 * math.pi * 8 * 0.005 * np.arange(240)) * np.hanning(240)
        rows = "\n".join(
            " ".join(f"{value:.3f}" for value in row) for row in velocity.reshape(-1, 20)
        )
        (tmp_path / file).write_text(f"# {name}, mm/s\n{rows}\n")
    (tmp_path / "US1_IM_vs_EDP.csv").write_text(
        "run,rec,pga,sd_T1\n1,HU12,0.05,0.3\n2,EC40,0.09,0.28\n3,FR76,0.1,0.6\n"
    )
    return tmp_path


def test_each_run_has_its_spectral_displacement(folder):
    runs = shaken_wall.read_runs(folder)
    for with_synthetic, expected in ((False, [1, 3]), (True, [1, 2, 3])):
        events, numbers = shaken_wall.events_of(folder, runs, with_synthetic)
        assert numbers == expected
        for event, run in zip(events, runs.set_index("run").loc[numbers].itertuples()):
            assert abs(event.factor) * shaken_wall.displacement_mm(
                event.loading.record
            ) == pytest.approx(run.sd_T1, rel=5e-3)


def test_the_joints_are_as_stiff_as_the_measured_period_asks_for():
    wall = shaken_wall.fitted(Case())
    layout = lay_out(wall, ModelOptions(contacts="gauss", cells=8))
    assert natural_modes(layout).period_s[0] == pytest.approx(shaken_wall.PERIOD_S, rel=1e-3)
    assert layout.bodies.mass[:-1].sum() == pytest.approx(1885 * 2.58 * 1.292 * 0.21)


def test_peaks_residuals_and_periods_are_those_of_each_event():
    """Two events of three stages, 0.1 s period at rest; the second one starts where the first one
    ended."""
    time_s = np.arange(0, 6, 2e-3)
    stage = (time_s // 1.0).astype(int)
    moved = 1e-3 * np.where(stage < 3, 0, 2) + np.where(
        stage % 3 == 1, 1e-4 * np.sin(20 * math.pi * time_s), 0
    )
    moved[stage == 0] = 5e-3 * np.sin(4 * math.pi * time_s[stage == 0])
    table = shaken_wall.table_of(np.column_stack([stage, time_s, moved, moved, moved]), None)
    assert_allclose(table["peak_mm_2060"], [5.0, 2.1], rtol=2e-3)
    assert_allclose(table["residual_mm_2060"], [0.0, 2.0], atol=1e-9)
    assert_allclose(table["period_after_s"], 0.1, rtol=1e-4)


def test_predictions_are_those_that_were_committed():
    names = "us2_later", "shear_walls", "us2"
    for path in (TABLES / f"{name}_prediction.csv" for name in names):
        digest, name = path.with_suffix(".sha256").read_text().split()
        assert name == path.name and digest == hashlib.sha256(path.read_bytes()).hexdigest()
    table = pd.read_csv(path)
    assert list(table["run"]) == list(range(1, 26)) and table[
        table["run"].isin([3, 6, 8, 11])
    ].iloc[:, 1:].isna().all(axis=None)


def test_the_bearing_has_the_least_error_and_of_equal_ones_the_longest_play(tmp_path, monkeypatch):
    (tmp_path / "benchmarks").mkdir()
    rows = "27e3,5e6,0.1,0.04,0.31\n10e3,2e6,0.1,0.003,0.3\n10e3,2e6,0.1,0.02,0.3001\n"
    (tmp_path / "benchmarks/us1_bearings.csv").write_text(
        f"load_n,stiffness_n_m,friction,play_m,error\n{rows}"
    )
    monkeypatch.setattr(shaken_wall, "TABLES", tmp_path)
    assert shaken_wall.chosen()[:4] == (10e3, 2e6, 0.1, 0.02)


def test_ranges_of_19_draws_are_their_least_and_largest():
    """And the period before a run is that after the one before."""
    draws = pd.DataFrame(
        [
            {
                "case": "later",
                "seed": seed,
                "run": run,
                "collapsed": seed == 19 and run == 2,
                "residual_mm_2060": 0.1 * seed,
                "period_after_s": 0.09 + 0.001 * seed,
                **dict.fromkeys(shaken_wall.MOVED, float(seed * run)),
            }
            for seed in range(1, 20)
            for run in (1, 2)
        ]
    )
    found = shaken_wall.quantiles(draws)
    assert found["peak_mm_660_5"].tolist() == [1.0, 2.0]
    assert found["peak_mm_2060_50"].tolist() == [10.0, 20.0]
    assert found["peak_mm_2060_95"].tolist() == [19.0, np.inf]
    assert np.isnan(found["period_s_50"][1]) and found["period_s_95"][2] == pytest.approx(0.109)
