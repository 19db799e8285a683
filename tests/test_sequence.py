"""The same wall shaken again and again: the schedule, the damage carried over, the tables."""

from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from conftest import refused_with, run_here, wall_file
from numpy.testing import assert_allclose, assert_array_equal

from damage.measure.cycles import shocks_table
from damage.measure.energy import energy_error
from damage.measure.tables import write_run_tables
from damage.run.options import parse_run
from damage.run.schedule import stages
from damage.run.settings import SETTLE_S
from paper.study_figures import sequences

DT = 2e-5


def settings(*words):
    return parse_run(["--harmonic", "0.1", "0.2", "--cycles", "2", "--rest", "0.3", *words], "test", "reference")


def test_stages_follow_one_another_and_end_with_samples():
    schedule = stages(settings("--sequence", "1,0.5"), None, DT, 100)
    assert [(stage.shock, stage.name) for stage in schedule] == [
        (shock, name) for shock in (1, 2) for name in ("motion", "rest", "settling")]
    assert schedule[0].start_step == 0
    for before, after in zip(schedule, schedule[1:]):
        assert before.end_step == after.start_step
    assert all(stage.end_step % 100 == 0 for stage in schedule)
    lengths = [(stage.end_step - stage.start_step) * DT for stage in schedule]
    assert_allclose(lengths, 2 * [0.2, 0.3, SETTLE_S], atol=100 * DT)


@pytest.mark.parametrize("words, message", [
    (["--sequence", "1,x"], "numbers with commas"),
    (["--sequence", "1,nan"], "factor of --sequence = nan"),
    (["--free-vibration", "--sequence", "1,1"], "belongs to"),
])
def test_bad_sequences_are_refused(words, message):
    refused_with(message, parse_run, words, "test", "reference")


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    """{name: History}: a narrow wall shaken once, and twice."""
    folder = tmp_path_factory.mktemp("sequence")
    wall = wall_file(folder / "narrow.py", "Wall('narrow', 0.9, 1.5)")
    return {name: run_here(folder / f"{name}.h5", wall, "--harmonic", 0.15, 0.35, "--rest", 0.2, *words)
            for name, words in (("once", []), ("twice", ["--sequence", "1,1"]))}


def test_the_first_shock_is_the_run_by_itself(runs):
    once, twice = runs["once"], runs["twice"]
    n = len(once.series)
    assert_array_equal(once.series["drift_ratio"], twice.series["drift_ratio"][:n])
    assert_array_equal(once.slip_m, twice.slip_m[:n])
    assert twice.series["shock"].tolist() == [1] * n + [2] * (len(twice.series) - n)


def test_damage_is_carried_over(runs):
    table = shocks_table(runs["twice"])
    assert table["residual_DI"].iloc[0] > 0
    assert runs["twice"].broken[-1].sum() >= runs["once"].broken[-1].sum() > 0
    # The second shock finds a broken wall: its first state is the residual one of the first.
    second = runs["twice"].index()[runs["twice"].series["shock"] == 2]
    assert second["DI"].min() <= table["max_DI"].iloc[1]
    assert_allclose(table["residual_DI"].iloc[0], runs["once"].index()["DI"].iloc[-1])
    assert energy_error(runs["twice"].series) < 5e-3


def test_a_sequence_has_a_table_of_its_shocks(runs, tmp_path):
    names = [path.name for path in write_run_tables(runs["twice"], tmp_path / "t")]
    assert "t_shocks.csv" in names
    assert "o_shocks.csv" not in [path.name for path in write_run_tables(runs["once"], tmp_path / "o")]


def test_the_figure_shows_the_index_of_every_shock(runs):
    points = pd.DataFrame([{"wall": "narrow", "solver": "reference", "members": 2, "motion_period_s": 0.15,
                            "amplitude_g": 0.35, "record": np.nan, "shocks": 2}])
    results = SimpleNamespace(histories=lambda point: [runs["twice"], runs["twice"]])
    ax = sequences(results, points).axes[0]
    assert ax.get_title(loc="left") == "(a) 0.15 s, 0.35 g, 2 times"
    table = shocks_table(runs["twice"])
    drawn = [bars[0].get_ydata() for bars in ax.containers]
    for values, column in zip(drawn, ("max_DI", "residual_DI", "max_shear_limit_DI")):
        assert_allclose(np.asarray(values, float), table[column].astype(float))
