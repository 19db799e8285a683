"""Lives of a wall: what is drawn, that a life is a sequence in lanes and studies,
probabilities."""

import shutil
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from conftest import (
    REPOSITORY,
    one_line_error,
    refused_with,
    wall_file,
    written,
)
from scipy import stats

import damage
from damage.__main__ import main
from damage.applications.groningen.exposure import places
from damage.applications.groningen.exposure.catalogue import read_catalogue
from damage.applications.groningen.exposure.exposure import Exposure
from damage.applications.groningen.exposure.ground_motion import COMPONENTS
from damage.applications.groningen.exposure.lives import Choices, Draws, events_of, read_address
from damage.applications.groningen.exposure.models.bommer_2022 import Model
from damage.applications.groningen.life.estimate import probability, strata
from damage.applications.groningen.life.results import (
    Lives,
    contributions,
    describe,
    largest_alone,
    life_of,
    life_study,
    lives_of,
    over_time,
)
from damage.applications.studies.definition import load_study
from damage.measure.cycles import shocks_table
from damage.motion.sequence import read_sequence
from damage.rounded import to_bits
from damage.run.banner import event_lines
from damage.run.options import parse_run

WALL = "Wall('narrow', 0.9, 1.5)"
ADDRESS = "latitude = 53.36786\nlongitude = 6.71359\nfirst_year = 2012\nlast_year = 2014\n"
FEW = "above_mm_s = 12\nstrong = [0.2, 0.3]\nwithin_km = 3.5\n"
"""Short motions, which are nonetheless strong enough for the narrow wall."""


@pytest.fixture(scope="module")
def exposure():
    return Exposure(
        places.at_degrees(53.36786, 6.71359), read_catalogue().between(2012, 2014), Model()
    )


def draws(exposure, **choices):
    return Draws(exposure, Choices(**choices))


class TestDraws:
    def test_the_same_seed_gives_the_same_life(self, exposure):
        one = draws(exposure, above_mm_s=1.0, seed=3)
        other = draws(exposure, above_mm_s=1.0, seed=3)
        other.life(1)
        assert one.life(7).equals(other.life(7))
        assert not one.life(7).equals(one.life(8))
        assert not one.life(7).equals(draws(exposure, above_mm_s=1.0, seed=4).life(7))

    def test_a_threshold_leaves_events_out_and_changes_no_other(self, exposure):
        low = draws(exposure, above_mm_s=0.5).life(1)
        high = draws(exposure, above_mm_s=3.0).life(1)
        assert low[low["pgv_mm_s"] >= 3.0].reset_index(drop=True).equals(high)
        assert len(high) < len(low)

    def test_records_obey_the_rule_and_have_the_drawn_pgv(self, exposure):
        table = pd.read_csv(COMPONENTS, comment="#").set_index("record")
        lives = pd.concat(
            [draws(exposure, above_mm_s=1.0, within_km=4.0).life(number) for number in range(1, 31)]
        )
        of = table.loc[lives["record"]]
        assert (of["epicentral_km"] <= 4).all() and set(np.sign(lives["scale"])) == {-1.0, 1.0}
        assert np.abs(lives["scale"]).between(0.1, 10).all()
        assert np.abs(lives["scale"]).to_numpy() * of["pgv_mm_s"].to_numpy() == pytest.approx(
            lives["pgv_mm_s"]
        )
        assert list(lives["start_s"]) == list(of["start_s"]) and lives["record"].nunique() == 10

    @pytest.mark.parametrize(
        "scale_to, scales",
        [
            ("pgv", ["-0x1.992de88000000p-1", "-0x1.e76bc48000000p-3", "-0x1.f5b2118000000p-2"]),
            ("sa", ["-0x1.cb5e968000000p-1", "-0x1.119aa90000000p-2", "-0x1.293cbc8000000p-1"]),
        ],
    )
    def test_a_life_has_the_same_bits_on_every_machine(self, exposure, scale_to, scales):
        lives = draws(
            exposure,
            above_mm_s=3.0,
            within_km=3.5,
            strong=(0.05, 0.1),
            scale_to=scale_to,
            settle=("hogging", "sagging"),
            distortion=(0.0002, 0.002),
        )
        life = lives.life(1)
        ground = lives.settlement(1)
        assert life["record"].tolist() == ["BLOP_HGE", "BLOP_HGE", "BWSE_HGE"]
        assert [one.hex() for one in life["pgv_mm_s"]] == [
            "0x1.8ef3d08000000p+3",
            "0x1.db3d0d8000000p+1",
            "0x1.4b7acc0000000p+2",
        ]
        assert [one.hex() for one in life["scale"]] == scales
        assert [*life["start_s"], *life["end_s"]] == pytest.approx(
            [18.7, 18.7, 20.7, 20.9, 20.9, 23.8]
        )
        assert (ground.profile, ground.distortion.hex()) == ("sagging", "0x1.789b3f8000000p-12")

    def test_events_are_those_of_the_sequence_file(self, exposure, tmp_path):
        life = draws(exposure, above_mm_s=3.0).life(1)
        life[["record", "scale", "start_s", "end_s"]].to_csv(tmp_path / "life.csv", index=False)
        of_file = read_sequence(tmp_path / "life.csv", 0.5)
        assert [
            (one.factor, one.rest_s, one.loading.as_dict()) for one in events_of(life, 0.5)
        ] == [(one.factor, one.rest_s, one.loading.as_dict()) for one in of_file]


class TestAddress:
    @pytest.mark.parametrize(
        "text, message",
        [
            ("longitude = 6.7\n", "no address"),
            (ADDRESS + "above = 2\n", "unknown key 'above'"),
            ("latitude = 52.09\nlongitude = 5.12\n", "from the nearest epicentre"),
            (ADDRESS.replace("2012", "1980"), "the first event"),
            (ADDRESS + "strong = [0.6, 0.1]\n", "strong"),
            (ADDRESS + "scale_to = 'pga'\n", "scale_to"),
            (ADDRESS + "seed = 1.5\n", "seed"),
            (ADDRESS + "catalogue = 'nowhere.csv'\n", "nowhere.csv"),
        ],
    )
    def test_what_is_wrong_is_said_in_one_line(self, tmp_path, text, message):
        assert message in one_line_error(read_address, written(tmp_path / "a.toml", text))

    def test_one_event_of_the_catalogue(self, exposure):
        """Its median PGV, or the one drawn in a life, by a record within the rule."""
        draws = Draws(exposure, Choices())
        (median,) = draws.event("2012-08-16").itertuples()
        k = list(exposure.catalogue.events["id"]).index(median.id)
        assert median.magnitude == 3.6 and median.pgv_mm_s == to_bits(exposure.median_mm_s[k])
        row = next(row for row in draws.components.itertuples() if row.record == median.record)
        assert median.scale == pytest.approx(median.pgv_mm_s / row.pgv_mm_s)
        others = median.pgv_mm_s / draws.components["pgv_mm_s"]
        assert abs(np.log(median.scale)) == pytest.approx(np.abs(np.log(others)).min())
        life = draws.life(3)
        (drawn,) = draws.event("2012-08-16T20:30", 3).itertuples(index=False)
        assert tuple(drawn) == next(life[life["id"] == median.id].itertuples(index=False))
        refused_with("--event 2006: no event then", draws.event, "2006")

    def test_a_run_of_one_event_is_that_of_its_record(self, tmp_path):
        path = written(tmp_path / "here.toml", "latitude = 53.36786\nlongitude = 6.71359\n")
        settings = parse_run(["--address", str(path), "--event", "2006-08-08"], "", "reference")
        event = settings.event
        words = "--record {record} --scale {scale!r} --window {start_s} {end_s}".format(**event)
        same = parse_run(words.split(), "", "reference")
        assert settings.loading.as_dict() == same.loading.as_dict() and settings.sequence == (1.0,)
        assert (
            settings.as_dict()["event"]["time_utc"] == "2006-08-08T05:04:00"
            and "life" not in settings.as_dict()
        )
        (said,) = event_lines(settings)
        assert "M 3.5 at Westeremden" in said and "19.6 mm/s, its median" in said
        for words in (
            ["--event", "2006-08-08"],
            ["--address", str(path)],
            ["--address", str(path), "--event", "2006-08-08", "--scale", "2"],
        ):
            refused_with("--event", parse_run, words, "", "reference")


@pytest.fixture(scope="module")
def lived(tmp_path_factory):
    """Folder of a study of six lives of a narrow wall, which stepped together; all histories are
    kept."""
    folder = tmp_path_factory.mktemp("life")
    wall_file(folder / "narrow.py", WALL)
    (folder / "a.toml").write_text(ADDRESS + FEW)
    (folder / "study.toml").write_text(
        'name = "s"\npictures = "none"\n[[runs]]\nid = "n"\nwall = "narrow.py"\n'
        'options = { address = "a.toml", rest = 0.1, strength-cov = 0.3 }\nlives = 6\n'
    )
    assert main(["study", str(folder / "study.toml"), "--out", str(folder), "-j1"]) == 0
    return folder


def history_of(folder, number):
    """The path of the history of a life of that study."""
    return folder / "runs" / f"n_from1_reference_s{number}.h5"


class TestRuns:
    def test_the_tables_of_the_study_are_those_of_the_histories(self, lived):
        (one,) = lives_of(lived)
        assert one.point == "n" and list(one.table["life"].unique()) == list(range(1, 7))
        draws = read_address(lived / "a.toml")
        for number, life in one.table.groupby("life"):
            events = shocks_table(damage.read_history(history_of(lived, number)))
            assert list(life["max_psi"]) == list(events["max_psi"])
            assert list(life["psi"]) == list(events["residual_psi"])
            assert list(life["pgv_mm_s"]) == list(draws.life(number)["pgv_mm_s"])
        assert one.table["max_psi"].max() > 0

    def test_a_folder_without_lives_is_refused(self, lived, tmp_path):
        for name in ("study.toml", "a.toml", "narrow.py"):
            shutil.copy(lived / name, tmp_path)
        assert "no life in it" in one_line_error(lives_of, tmp_path)


class TestStudy:
    def test_lives_are_divided_into_points(self, lived):
        text = (lived / "study.toml").read_text().replace("lives = 6", "lives = 100")
        points = load_study(written(lived / "many.toml", text), "both").runs
        assert [(one.point, one.members, one.options_of(1)["life"]) for one in points] == [
            ("n_from1", 48, 1),
            ("n_from49", 48, 49),
            ("n_from97", 4, 97),
        ]
        assert {one.solver for one in points} == {"reference"}
        both = written(lived / "both.toml", text + "samples = 3\n")
        assert "samples and lives" in one_line_error(load_study, both, "reference")

    def test_the_command_s_study(self, tmp_path):
        """All events, and the largest alone; what the address's file says."""
        address = {
            "latitude": 53.33,
            "longitude": 6.918,
            "above_mm_s": 2.0,
            "component": None,
            "strong": [0.05, 0.1],
        }
        study = life_study(tmp_path, "symmetric", address, {"rest": 0.2, "settle": "tilt"}, 60)
        assert load_study(study.path, root=REPOSITORY) == study
        assert [one.point for one in study.runs] == [
            "life_from1",
            "life_from49",
            "life_largest_from1",
            "life_largest_from49",
        ]
        settings = [one.settings(tmp_path) for one in study.runs]
        assert [one.life["largest_alone"] for one in settings] == [False, False, True, True]
        assert settings[0].settlement.name.startswith("tilt") and settings[1].life["number"] == 49
        assert len(settings[2].events) == 1 and settings[0].life["strong"] == [0.05, 0.1]


class TestEstimate:
    def test_strata_count_by_their_probability(self):
        """Two strata of 1/2; 5 lives in the lower one, none damaged, 15 in the upper one, 9
        damaged: 0.5 * 0.6."""
        population = np.arange(1000.0)
        largest = np.r_[np.full(5, 100.0), np.full(15, 900.0)]
        hits = np.r_[np.zeros(11), np.ones(9)]
        assert list(strata(largest, population)) == [499.5]
        assert probability(hits, largest, population).p == pytest.approx(0.3)

    def test_intervals_cover_and_are_narrower_than_those_of_the_share(self):
        """Damage by a lognormal fragility, 300 surveys of 100 lives: the interval holds the truth
        at least 93 times in a hundred, and the error is what estimates scatter by, within a
        fifth."""
        rng = np.random.default_rng(1)
        population = np.exp(rng.normal(3.2, 0.5, 20000))
        truth = stats.norm.cdf(np.log(population / 30) / 0.4).mean()
        found = []
        for _ in range(300):
            largest = np.exp(rng.normal(3.2, 0.5, 100))
            hits = rng.random(100) < stats.norm.cdf(np.log(largest / 30) / 0.4)
            found.append(probability(hits, largest, population))
        inside = np.mean([low <= truth <= high for low, high in (one.interval for one in found)])
        scatter = np.std([one.p for one in found])
        error = np.mean([one.error for one in found])
        assert inside > 0.93 and abs(
            np.mean([one.p for one in found]) - truth
        ) < 4 * scatter / np.sqrt(300)
        assert scatter == pytest.approx(error, rel=0.2)
        assert max(error, scatter) < 0.9 * np.sqrt(truth * (1 - truth) / 100)


class TestResults:
    @pytest.fixture(autouse=True)
    def few(self, monkeypatch):
        monkeypatch.setattr("damage.applications.groningen.life.results.POPULATION", 50)

    @pytest.fixture
    def lives(self, exposure):
        """Four lives: Psi 0.5, 1.2 in 2012 and 2013; falls in 2014; stays whole; 0.3."""
        rows = [
            (1, "2012-05-01", 0.5, 0.6, False),
            (1, "2013-05-01", 1.2, 2.1, False),
            (2, "2014-01-01", 1.5, 1.5, True),
            (3, "2012-05-01", 0.0, 0.0, False),
            (4, "2012-05-01", 0.3, 1.0, False),
        ]
        table = pd.DataFrame(rows, columns=["life", "time_utc", "psi", "max_psi", "fell"]).assign(
            point="p",
            seed=0,
            event=1,
            DI=0.01,
            crack_width_mm=0.1,
            largest_mm_s=10.0,
            pgv_mm_s=9.0,
            magnitude=3.0,
            place="here",
        )
        return Lives("p", draws(exposure), table.assign(id=table["time_utc"]))

    def test_years(self, lives):
        found = over_time(lives)
        assert list(found["year"]) == [2012, 2013, 2014]
        assert list(found["p_psi_1"]) == [0, 0.25, 0.5] and list(found["p_psi_2"]) == [0, 0, 0.25]
        assert list(found["p_max_psi_1"]) == [0.25, 0.5, 0.75] and list(found["p_max_psi_2"]) == [
            0,
            0.25,
            0.5,
        ]
        assert list(found["median_psi"]) == pytest.approx([0.15, 0.15, 0.75])
        assert "4 lives, 2012 to 2014" in describe([lives])

    def test_contributions(self, lives):
        found = contributions(lives)
        assert found["share"].sum() == pytest.approx(1.0)
        assert list(found["time_utc"]) == ["2014-01-01", "2012-05-01", "2013-05-01"]
        assert list(found["mean_psi"]) == pytest.approx([1.5 / 4, 0.8 / 4, 0.7 / 4])
        assert list(found["largest"]) == [0.25, 0.25, 0.25]

    def test_the_settlement_is_an_event_before_the_others(self, exposure):
        """Psi 0.7 by the settlement, 1.1 after the first of two events, 1.2 after the second: gains
        0.7, 0.4, 0.1."""
        of = draws(exposure, above_mm_s=8.0)
        number = next(number for number in range(1, 99) if len(of.life(number)) == 2)
        names = "max_psi max_DI residual_DI residual_crack_width_mm max_crack_width_mm"
        others = dict.fromkeys([*names.split(), "offset_after_mm", "newly_failed"], 0.1)
        events = [
            others | {"factor": factor, "residual_psi": psi}
            for factor, psi in zip(of.life(number)["scale"], (1.1, 1.2))
        ]
        row = {
            "collapsed_at_s": None,
            "settlement": "hogging",
            "distortion": None,
            "settled_psi": 0.7,
            "settled_DI": 0.01,
            "settled_crack_width_mm": 0.1,
        }
        table = life_of({"run": "r", "shocks": events, "row": row}, of, number).assign(point="p")
        assert list(table["event"]) == [0, 1, 2] and list(table["psi"]) == [0.7, 1.1, 1.2]
        life = Lives("p", of, pd.concat([table, table.assign(life=0)]))  # two equal lives
        assert list(life.until(2012)["psi"] >= 0.7) == [True, True]  # before any event, too
        found = contributions(life).set_index("id")
        assert found.loc["settlement", "mean_psi"] == pytest.approx(0.7)
        assert found["mean_psi"].sum() == pytest.approx(1.2) and found["largest"].sum() == 1
        assert (
            "2 events in the median life" in (said := describe([life]))
            and "after the settlement" in said
        )
        without = life_of(
            {"run": "r", "shocks": events, "row": row | {"settled_psi": None}}, of, number
        )
        assert list(without["event"]) == [1, 2]
        fewer = draws(exposure, above_mm_s=1e3)  # the largest alone
        message = one_line_error(life_of, {"run": "r", "shocks": events, "row": row}, fewer, number)
        assert "its events are not those of its address's file" in message

    def test_the_largest_alone_beside_all(self, lives):
        alone = Lives(
            "p_largest",
            replace(lives.draws, choices=replace(lives.draws.choices, largest_alone=True)),
            lives.table.drop(index=0),
        )
        (pair,) = largest_alone([lives, alone]).values()
        assert list(pair[0].index) == list(pair[1].index) == [(0, 1), (0, 2), (0, 3), (0, 4)]
        said = describe([lives, alone])
        assert "1.00 of the final Psi" in said  # of lives 1 and 4, the fallen one not counted
