"""Fragility curves: known medians and dispersions come back, bounds hold what they say, bad studies are refused."""

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_allclose

from damage.__main__ import main
from damage.errors import InputError
from damage.measure.tables import write_table
from damage.studies.fragility import LEVELS, curve, fit, fragility, load_runs

MEDIAN_G, DISPERSION = 0.2, 0.4


INTENSITIES_G = np.arange(1, 9) / 20


def walls(n_walls, seed, level=0.05):
    """Runs of walls whose capacity is lognormal: each exceeds the level in all motions stronger than it."""
    random = np.random.default_rng(seed)
    capacity_g = MEDIAN_G * np.exp(DISPERSION * random.standard_normal(n_walls))
    pga_g, wall = (column.ravel() for column in np.meshgrid(INTENSITIES_G, np.arange(n_walls)))
    exceeds = pga_g > capacity_g[wall]
    return pd.DataFrame({"wall": "w", "status": "complete", "record": "r", "pga_g": pga_g, "strength_seed": wall,
                         "strength_cov": 0.3, "collapsed_at_s": np.nan, "max_DI": np.where(exceeds, 2, 0.5) * level,
                         "max_crack_width_mm": 10 * pga_g / capacity_g[wall], "max_psi": 0.0})


class TestFit:
    def test_exact_shares_give_back_the_curve(self):
        x = np.geomspace(0.05, 0.8, 9)
        assert_allclose(fit(x, 1e3 * curve(x, MEDIAN_G, DISPERSION), np.full(9, 1e3)), (MEDIAN_G, DISPERSION),
                        rtol=1e-4)

    def test_many_walls_give_back_the_curve_that_they_were_drawn_from(self):
        found = fragility(walls(20_000, seed=2), "max_DI", 0.05, replicates=0)
        assert_allclose((found.median, found.dispersion), (MEDIAN_G, DISPERSION), rtol=0.02)

    def test_its_scale_is_that_of_the_intensity(self):
        x, n = np.array([0.1, 0.2, 0.4]), np.full(3, 20)
        once, twice = fit(x, [3, 9, 18], n), fit(2 * x, [3, 9, 18], n)
        assert_allclose(twice, (2 * once[0], once[1]), rtol=1e-4)

    def test_none_or_all_exceeding_has_no_fit(self):
        assert np.isnan(fit([0.1, 0.2], [0, 0], [5, 5])).all() and np.isnan(fit([0.1, 0.2], [5, 5], [5, 5])).all()

    def test_a_step_bounds_the_median_by_its_ends_whatever_is_drawn(self):
        assert_allclose(fit([0.1, 0.2, 0.4], [0, 5, 5], [5, 5, 5]), (0.02**0.5, 0))
        runs = walls(6, seed=1)
        runs["max_psi"] = np.where(runs["pga_g"] > 0.22, 3.0, 0.0)
        found = fragility(runs, "max_psi", 2.0, replicates=20)
        row = found.row()
        assert_allclose([row["median_low_g"], row["median_high_g"], row["dispersion"]], [0.2, 0.25, 0])
        assert_allclose(found.bounds([0.19, 0.21, 0.3]), [[0, 0, 1], [0, 1, 1]])

    def test_a_collapse_exceeds_every_level(self):
        runs = walls(10, seed=3)
        runs["collapsed_at_s"] = 1.0
        assert fragility(runs, "max_psi", 2.0, replicates=0).n_exceeding == len(runs)


def test_nine_in_ten_bounds_hold_the_true_median():
    """Over 40 studies of 25 walls: 36 expected, 28 is more than four standard deviations below."""
    held = 0
    for seed in range(40):
        row = fragility(walls(25, seed=seed), "max_DI", 0.05, replicates=40).row()
        held += row["median_low_g"] <= MEDIAN_G <= row["median_high_g"]
    assert held >= 28


def test_bounds_enclose_the_curve_and_narrow_with_more_walls():
    few, many = (fragility(walls(n, seed=5), "max_DI", 0.05, replicates=100) for n in (20, 200))
    x = np.array([0.1, 0.2, 0.3])
    for one in (few, many):
        low, high = one.bounds(x)
        assert (low <= one.probability(x)).all() and (one.probability(x) <= high).all()
    assert (np.diff(many.bounds(x), axis=0) < np.diff(few.bounds(x), axis=0)).all()


def test_the_command_writes_table_and_picture(tmp_path, capsys):
    write_table(walls(12, seed=1), tmp_path / "tables" / "summary.csv")
    assert main(["fragility", str(tmp_path), "--out", str(tmp_path / "f"), "--replicates", "20"]) == 0
    table = pd.read_csv(tmp_path / "f" / "fragility_pga_g.csv")
    assert len(table) == sum(map(len, LEVELS.values())) and set(table["runs"]) == {96}
    assert table.set_index("measure").loc["max_psi", "median_g"].isna().all()
    assert {path.suffix for path in (tmp_path / "f").glob("fragility_w_pga_g.*")} == {".png", ".pdf"}
    assert "dispersion" in capsys.readouterr().out
    assert main(["fragility", str(tmp_path), "--out", str(tmp_path), "--intensity", "sa_0.2_s_g"]) == 2


def test_studies_without_scattered_strengths_are_refused(tmp_path):
    with pytest.raises(InputError, match="holds no tables/summary.csv"):
        load_runs(tmp_path)
    write_table(walls(2, seed=1).assign(strength_cov=0.0), tmp_path / "tables" / "summary.csv")
    with pytest.raises(InputError, match="no finished run with scattered strengths"):
        load_runs(tmp_path)
    write_table(pd.DataFrame({"run": ["a"]}), tmp_path / "tables" / "summary.csv")
    with pytest.raises(InputError, match="no column max_DI"):
        load_runs(tmp_path)
