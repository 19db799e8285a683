"""Lives of a wall: what is drawn, that a life is a sequence, that it continues, and the probabilities."""

import math

import numpy as np
import pandas as pd
import pytest
from conftest import one_line_error
from scipy import stats

import damage
from damage.__main__ import main
from damage.draw.life import life_picture
from damage.exposure import places
from damage.exposure.catalogue import read_catalogue
from damage.exposure.exposure import Exposure
from damage.exposure.models.bommer_2022 import Model
from damage.exposure.residuals import COMPONENTS
from damage.life.draw import Draws
from damage.life.runs import over_time, run_lives, wilson
from damage.measure.tables import shocks_table

WALL = "from damage import Wall\n\n\ndef wall():\n    return Wall('narrow', 0.9, 1.5)\n"


@pytest.fixture(scope="module")
def exposure():
    return Exposure(places.at(53.36786, 6.71359), read_catalogue().between(2012, 2014), Model())


class TestDraws:
    def test_the_same_seed_gives_the_same_life(self, exposure):
        one, other = Draws(exposure, 1.0, seed=3), Draws(exposure, 1.0, seed=3)
        other.life(1)
        assert one.life(7).equals(other.life(7))
        assert not one.life(7).equals(one.life(8))
        assert not one.life(7).equals(Draws(exposure, 1.0, seed=4).life(7))

    def test_a_threshold_leaves_events_out_and_changes_no_other(self, exposure):
        low, high = Draws(exposure, 0.5).life(1), Draws(exposure, 3.0).life(1)
        assert low[low["pgv_mm_s"] >= 3.0].reset_index(drop=True).equals(high)
        assert len(high) < len(low)

    def test_records_obey_the_rule_and_have_the_drawn_pgv(self, exposure):
        table = pd.read_csv(COMPONENTS, comment="#").set_index("record")
        lives = pd.concat([Draws(exposure, 1.0, within_km=4.0).life(number) for number in range(1, 31)])
        of = table.loc[lives["record"]]
        assert (of["epicentral_km"] <= 4).all() and set(np.sign(lives["scale"])) == {-1.0, 1.0}
        assert np.abs(lives["scale"]).between(0.1, 10).all()
        assert np.abs(lives["scale"]).to_numpy() * of["pgv_mm_s"].to_numpy() == pytest.approx(lives["pgv_mm_s"])
        assert list(lives["start_s"]) == list(of["start_s"]) and lives["record"].nunique() == 10

    def test_pgv_follows_the_model(self, exposure):
        """ln PGV of one event over 400 lives: mean and deviation within four standard errors, shape by Kolmogorov."""
        largest = int(np.argmax(exposure.median_mm_s))
        sigma, median = exposure.model.deviations.sigma, exposure.median_mm_s[largest]
        draws = Draws(exposure, median / 5)  # 2.8 sigma below
        name = exposure.catalogue.id[largest]
        drawn = [life.loc[life["id"] == name, "pgv_mm_s"] for life in map(draws.life, range(400))]
        z = np.log(np.concatenate(drawn) / median) / sigma
        assert len(z) > 390 and abs(z.mean()) < 4 / math.sqrt(400) and abs(z.std() - 1) < 4 / math.sqrt(800)
        assert stats.kstest(z, "norm").pvalue > 0.001

    def test_no_suitable_record(self, exposure):
        assert "no suitable record" in one_line_error(Draws(exposure, 1.0, within_km=0.5).life, 1)


@pytest.fixture(scope="module")
def lived(exposure, tmp_path_factory):
    """(folder, wall, table) of two lives of a narrow wall."""
    folder = tmp_path_factory.mktemp("life")
    wall = folder / "narrow.py"
    wall.write_text(WALL)
    table = run_lives(wall, Draws(exposure, 6.0), 2, folder / "out", say=lambda *_, **__: None, rest=0.2,
                      strength_cov=0.3)
    return folder, wall, table


class TestLives:
    def test_a_life_is_its_sequence(self, lived):
        """Run again by the sequence file that it left: the same numbers to the last bit."""
        folder, wall, table = lived
        for number, life in table.groupby("life"):
            history = damage.run(wall, sequence=folder / "out" / f"life_{number:05d}_sequence.csv", rest=0.2,
                                 strength_cov=0.3, strength_seed=number)
            events = shocks_table(history)
            for name in ("max_psi", "max_DI", "newly_failed", "offset_after_mm"):
                assert list(life[name]) == list(events[name])
            assert list(life["psi"]) == list(events["residual_psi"])

    def test_a_life_that_is_there_is_not_run_again(self, lived, exposure, monkeypatch):
        folder, wall, table = lived
        (folder / "out" / "life_00002.csv").unlink()  # as if killed in the second life
        asked = []
        real = __import__("damage.life.runs", fromlist=["run"]).run
        monkeypatch.setattr("damage.life.runs.run",
                            lambda *words, **named: asked.append(named) or real(*words, **named))
        again = run_lives(wall, Draws(exposure, 6.0), 2, folder / "out", say=lambda *_, **__: None, rest=0.2,
                          strength_cov=0.3)
        assert again.equals(table)
        assert [named["strength_seed"] for named in asked] == [2]

    def test_years(self):
        """Two lives: one reaches Psi 1.2 in 2013, one falls in 2014."""
        table = pd.DataFrame({"life": [1, 1, 2], "time_utc": ["2012-05-01", "2013-05-01", "2014-01-01"],
                              "psi": [0.5, 1.2, 1.5], "DI": [0.0, 0.01, 0.2], "fell": [False, False, True]})
        found = over_time(table, 2, (2012, 2014))
        assert list(found["p_psi_1"]) == [0, 0.5, 1] and list(found["p_psi_2"]) == [0, 0, 0.5]
        assert list(found["median_DI"]) == pytest.approx([0, 0.005, 0.105])

    def test_wilson_interval(self):
        """Its ends are where the normal test of the share gives 5 %: |p - x| = 1.96 sqrt(x (1 - x) / n)."""
        for hits, count in ((0, 20), (3, 20), (100, 1000), (20, 20)):
            p, *ends = wilson(hits, count)
            for end in ends:
                assert abs(p - end) == pytest.approx(1.959964 * math.sqrt(end * (1 - end) / count), abs=1e-9)
        assert "expected at least one" in one_line_error(wilson, 0, 0)

    def test_picture(self, lived):
        *_, table = lived
        yearly = over_time(table, 2, (2012, 2014))
        psi, probability = life_picture(table, yearly, "two lives").axes
        assert len(psi.get_lines()) == table["life"].nunique() + 1
        assert list(probability.get_lines()[0].get_ydata()) == list(yearly["p_psi_1"])


def test_the_command(tmp_path, capsys):
    """At Delfzijl no event of 2020 reaches 2 mm/s in the first lives: they stay whole, and are there in no time."""
    assert main(["life", "symmetric", "--at", "53.33", "6.918", "--from", "2020", "--to", "2020", "--draws", "3",
                 "--out", str(tmp_path)]) == 0
    said = capsys.readouterr().out
    assert "0 events in the median life" in said
    assert "P(Psi >= 1) = 0.000, 95 % interval over lives 0.000 to 0.56" in said
    assert {"lives.csv", "life.csv", "life.png"} <= {path.name for path in tmp_path.iterdir()}
    assert main(["life", "symmetric", "--out", str(tmp_path)]) == 2
