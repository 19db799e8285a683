"""Claims: twins are the bits of single runs, but-for by hand, weights, refusals, and the sheet in
two languages."""

import json
import os
import re
import shutil
import string
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from conftest import REPOSITORY, one_line_error, wall_file, written

import damage
from damage.__main__ import main
from damage.applications.cracks.at_rest import SETTLED, patterns_of, read_patterns
from damage.applications.cracks.crack_file import CrackPattern
from damage.applications.cracks.survey import (
    Survey,
    distance,
    distances,
    read_survey,
    seen_of,
    surveyed,
)
from damage.applications.groningen.claim import make, terminal
from damage.applications.groningen.claim.answer import (
    BUT_FOR,
    PRIORS,
    WITHOUT,
    effective,
    of_cracks,
    reasons,
    share,
    table,
    verdict,
    widths,
    wilson,
    worlds_of,
)
from damage.applications.groningen.claim.dutch import in_language
from damage.applications.groningen.claim.likeness import (
    FARTHEST,
    KERNEL,
    NEAREST,
    kernel,
    strange_share,
)
from damage.applications.groningen.claim.make import layout_of
from damage.applications.groningen.claim.numbers import Likeness, answers, evidence_of
from damage.applications.groningen.claim.sheet import in_words, sheet, whether_more_draws_help
from damage.applications.groningen.claim.terminal import describe
from damage.applications.groningen.claim.twins import (
    BOTH,
    SHAKEN,
    STATES,
    Twins,
    causes_of,
    read_twins,
    twins_study,
)
from damage.applications.groningen.exposure.lives import read_address
from damage.applications.report.words import LANGUAGES, all_words, number
from damage.applications.studies import folder
from damage.applications.studies.definition import load_study
from damage.applications.studies.records import read_records
from damage.history.reader import read_history
from damage.linear.modes import Modes
from damage.measure.cracks import ENDS
from damage.measure.evidence import QUANTITIES
from damage.motion.settlement import PROFILES
from damage.provenance import commit, measures_digest
from damage.run.options import parse_run
from damage.run.scheme import schemes
from damage.wall.file import load_wall

CRACKS = (
    "crack,point,x_m,z_m,width_mm,offset,detection_limit_mm,width_error_mm\n"
    "A,1,0,0.075,0.15,no,0.1,0.05\nA,2,0.16,0.075,,,,\nB,1,0.78,0.075,0.15,no,0.1,0.05\nB,2,0.9,0.075,,,,\n"
)
WORDS = "--at 53.36786 6.71359 --from 2012 --to 2014 --above 12 --strong 0.2 0.3 --rest 0.1 -j 1"
"""Short motions of the narrow wall."""


@pytest.fixture(scope="module")
def claimed(tmp_path_factory):
    """Folder of a claim of three draws; the survey and the wall lie above it."""
    folder = tmp_path_factory.mktemp("claim")
    wall_file(folder / "narrow.py", "Wall('narrow', 0.9, 1.5)")
    (folder / "survey.csv").write_text(CRACKS)
    assert main(words(folder)) == 0
    return folder / "out"


def words(folder, *more, draws=3):
    return [
        "claim",
        str(folder / "narrow.py"),
        *WORDS.split(),
        "--cracks",
        str(folder / "survey.csv"),
        "--draws",
        str(draws),
        "--out",
        str(folder / "out"),
        *more,
    ]


def read(claimed):
    """(Layout, Twins, Survey) of that claim."""
    layout = layout_of(claimed.parent / "narrow.py")
    return layout, read_twins(claimed, layout), read_survey(claimed.parent / "survey.csv", layout)


def equal(one, other):
    return all(
        np.array_equal(mine, theirs, equal_nan=True)
        for mine, theirs in zip(one, other, strict=True)
    )


def kept(folder, point, number):
    run = f"{point}_from1_reference_s{number}"
    return read_patterns(
        folder / "patterns" / f"{run}.npz", read_records(folder).runs[run]["patterns"]
    )


class TestTwins:
    def test_a_twin_is_the_single_run_bit_for_bit(self, claimed):
        """With both causes, by the earthquakes alone and by the settlement alone, which no
        earthquake follows (the time step is that of the twins: by default it follows the
        records')."""
        wall = claimed.parent / "narrow.py"
        out = claimed.parent / "alone"
        for point in (SHAKEN, BOTH):
            history = damage.run(
                wall,
                address=claimed / f"{point}.address.toml",
                life=2,
                rest=0.1,
                strength_cov=0.3,
                inputs="typical",
                supports="bricks",
                settling="adaptive",
                out=out / f"{point}.h5",
            )
            assert equal(patterns_of(history), kept(claimed, point, 2))
        ground = read_address(claimed / f"{BOTH}.address.toml").settlement(2)
        settled = patterns_of(
            damage.run(
                wall,
                settle=ground.profile,
                distortion=ground.distortion,
                strength_cov=0.3,
                inputs="typical",
                strength_seed=2,
                settling="adaptive",
                dt=history.time_step_s,
                out=out / "settled.h5",
            )
        )
        twin = kept(claimed, BOTH, 2)
        whole = [one.of_moment(SETTLED, 1000) for one in (settled, twin)]
        assert np.array_equal(*whole) and whole[0].any()

    @pytest.mark.parametrize("wall", ["terrace_end", "solid"])
    def test_twins_settle_alike_and_end_in_the_same_explicit_steps(self, tmp_path, wall):
        """With one damping of settling stages, which the cracks at rest depend on, and down to the
        same explicit step."""
        address = {"latitude": 53.36786, "longitude": 6.71359, "above_mm_s": 12.0, "within_km": 3.5}
        study = twins_study(tmp_path, wall, causes_of(address, {}, {}), 2)
        assert load_study(study.path, root=REPOSITORY) == study
        modes = Modes(np.array([0.1]), None, 5e-5, 5e-5)
        found = {}
        for point in study.runs:
            steps = schemes(point.settings(REPOSITORY), load_wall(REPOSITORY / point.wall), modes)
            found[point.entry] = [(one.settles, one.mass_scaling, step) for one, step in steps]
        explicit = found[BOTH]
        assert {one[:2] for one in explicit} == {("adaptive", "none")}
        scaled = len(found[SHAKEN]) - len(explicit)
        assert found[SHAKEN][scaled:] == explicit
        assert {one[:2] for one in found[SHAKEN][:scaled]} == (
            {("adaptive", "selective")} if wall == "terrace_end" else set()
        )

    def test_what_was_lost_is_made_again_and_more_draws_change_no_other(self, claimed):
        """The patterns of one run, and what a kill left out of the record of another."""
        before = {path.name: path.read_bytes() for path in (claimed / "patterns").iterdir()}
        (claimed / "patterns" / f"{BOTH}_from1_reference_s2.npz").unlink()
        records = read_records(claimed)
        seal = records.runs[f"{BOTH}_from1_reference_s3"].pop("patterns")
        (claimed / "records.jsonl").write_text(records.text())
        assert main(words(claimed.parent, draws=4)) == 0
        after = {path.name: path.read_bytes() for path in (claimed / "patterns").iterdir()}
        assert len(after) == 8 and {name: after[name] for name in before} == before
        assert read_records(claimed).runs[f"{BOTH}_from1_reference_s3"]["patterns"] == seal

    def test_patterns_of_two_runs_that_were_exchanged_are_refused(self, claimed):
        one, other = (
            claimed / "patterns" / f"{BOTH}_from1_reference_s{number}.npz" for number in (1, 2)
        )
        before = one.read_bytes()
        one.write_bytes(other.read_bytes())
        try:
            said = one_line_error(read, claimed)
        finally:
            one.write_bytes(before)
        assert (
            f"{one} is not what its run wrote" in said
            and "delete it, and the same command makes it again" in said
        )


class TestGround:
    ADDRESS = "latitude = 53.36786\nlongitude = 6.71359\nfirst_year = 2012\nlast_year = 2014\n"

    def draws(self, tmp_path, more=""):
        return read_address(written(tmp_path / "a.toml", self.ADDRESS + more))

    def test_the_ground_is_drawn_beside_the_motions(self, tmp_path):
        rest = self.draws(tmp_path)
        moved = self.draws(tmp_path, "settle = ['hogging', 'knick']\ndistortion = [0.001, 0.004]\n")
        assert moved.life(5).equals(rest.life(5)) and rest.settlement(5) is None
        found = [moved.settlement(k) for k in range(1, 401)]
        log = np.log([one.distortion for one in found])
        assert {one.profile for one in found} == {"hogging", "knick"}
        assert log.min() >= np.log(0.001) and log.max() <= np.log(0.004)
        assert log.mean() == pytest.approx(np.log(0.002), abs=4 * log.std() / 20)
        assert found[3] == moved.settlement(4)

    def test_two_settlements_are_refused(self, tmp_path):
        self.draws(tmp_path, "settle = ['tilt']\ndistortion = [0.001, 0.002]\n")
        line = ["--address", str(tmp_path / "a.toml"), "--life", "1"]
        assert parse_run(line, "t", "reference").settlement.profile == "tilt"
        assert "lives draw the settlement" in one_line_error(
            parse_run, [*line, "--settle", "knick"], "t", "reference"
        )


def made(**width_mm):
    """Twins whose contact points have these widths [mm] by what acted: a number, or a number a
    contact point, of each draw."""
    n = len(width_mm["both"])
    opening = {name: np.reshape(mm, (n, -1)) * 1e-3 for name, mm in width_mm.items()}
    at_rest = np.zeros_like(opening["both"])
    opening = dict.fromkeys(STATES, at_rest) | opening
    n_joints = at_rest.shape[1]
    return Twins(
        np.arange(1, n + 1),
        opening,
        dict.fromkeys(STATES, at_rest),
        {name: np.isinf(values).any(axis=1) for name, values in opening.items()},
        np.zeros((n_joints, 2, 2)),
        {},
        pd.DataFrame({"profile": ["knick"] * n, "distortion": 0.001}),
    )


FOUR = made(
    both=[0.5, 0.5, 0.05, 0.3],
    earthquakes=[0.2, 0.05, 0.05, 0.2],
    settlement=[0.05, 0.05, 0.01, 0.3],
)
"""Draws: earthquakes alone do it; neither alone; nothing; each does."""


class TestButFor:
    def test_shares_by_hand(self):
        """By a prior of 0.5 all eight worlds weigh the same; where the ground rested, E stands."""
        found = table(worlds_of(FOUR.width_m, 0.5))
        assert {name: row["share"] for name, row in found.items()} == pytest.approx(
            {
                "both": 5 / 8,
                "earthquakes": 2 / 4,
                "settlement": 1 / 8,
                "none": 0.0,
                "not_without_earthquakes": 4 / 5,
                "not_without_settlement": 1 / 5,
                "neither_alone": 1 / 5,
            }
        )

    def test_weights_take_the_place_of_draws(self):
        like = np.array([[0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 0.0]])
        found = table(worlds_of(FOUR.width_m, 0.5, like))
        assert found["neither_alone"]["share"] == 1.0 and found["neither_alone"]["draws"] == 1.0

    def test_both_worlds_of_a_draw_are_one_draw(self):
        assert effective(worlds_of(FOUR.width_m, 0.3).weight) == pytest.approx(4)
        assert effective(np.array([[1.0, 3.0], [0.0, 0.0]])) == pytest.approx(16 / 10)
        assert (
            effective(np.zeros((2, 3))) == 0
            and share(np.ones((2, 3)), np.zeros((2, 3)))["share"] is None
        )

    def test_wilson(self):
        """10 of 10: Brown, Cai and DasGupta (2001), 0.722 to 1."""
        assert wilson(1.0, 10) == pytest.approx((0.7225, 1.0), abs=1e-4)
        assert wilson(0.5, 20) == pytest.approx((0.2993, 0.7007), abs=1e-4)

    def test_widths_of_a_survey(self):
        """What is left is measured: the earthquakes added what the draws do not have without
        them."""
        found = widths(worlds_of(FOUR.width_m, 1.0), surveyed_mm=0.8, error_mm=0.05)
        assert found["left"] == pytest.approx([0.75, 0.8, 0.85]) and found[
            "before"
        ] == pytest.approx([0.01, 0.05, 0.3])
        assert found["added"] == pytest.approx([0.75 - 0.3, 0.8 - 0.05, 0.85 - 0.01])
        assert widths(worlds_of(FOUR.width_m, 0.5, np.zeros((2, 4))), 0.8) == dict.fromkeys(
            ("before", "added", "left")
        )

    def test_a_wall_that_fell_counts_as_visible_and_has_no_width(self):
        fell = made(both=[np.inf, 0.5], earthquakes=[0.05, 0.05], settlement=[0.05, 0.05])
        assert table(worlds_of(fell.width_m, 1.0))["both"]["share"] == 1.0
        assert widths(worlds_of(fell.width_m, 1.0))["left"] == pytest.approx([0.5, 0.5, 0.5])
        assert list(kernel(np.zeros(2), ~fell.fell["both"])) == [0.0, 1.0]


def crack_survey(stretches, joints, looked_at=(True, True)):
    """A Survey by rows of its stretches, (crack, x, z, x, z, width [m]), each 1 m long, and of its
    joints."""
    parts = pd.DataFrame(stretches, columns=["crack", *ENDS, "width_m"]).assign(length_m=1.0)
    table = pd.DataFrame(joints, columns=["crack", "joint"])
    return Survey(
        *("survey.csv", "", CrackPattern(1, np.nan, parts), table, 2),
        *(1.0, 0.0, 1e-4, 0.0, np.array(looked_at), ()),
    )


class TestCracks:
    """Each of two joints has a crack of the survey; a third crack lies on no joint."""

    TWO = made(
        both=[[0.5, 0.4]] * 4,
        earthquakes=[[0.0, 0.4]] * 4,
        settlement=[[0.3, 0.05]] * 3 + [[0.3, 0.2]],
    )

    def found(self, like, twins=TWO):
        stretches = [["a", 0, 0, 1, 0, 5e-4], ["b", 1, 0, 2, 0, 4e-4], ["c", 3, 0, 3, 1, 2e-4]]
        return of_cracks(twins, like, crack_survey(stretches, [["a", 0], ["b", 1]]))

    def test_each_crack_by_hand(self):
        """Where all ground settled, by weights: `a` is the settlement's, `b` the earthquakes'."""
        settled = np.array([[1.0] * 3 + [0.0], [0.0] * 4])
        a, b, c = self.found(settled)
        assert [one["crack"] for one in (a, b, c)] == ["a", "b", "c"]
        share = {case: a[case]["shares"]["0.5"]["share"] for case in WITHOUT}
        assert share == {"without_earthquakes": 1.0, "without_settlement": 0.0}
        assert b["without_earthquakes"]["shares"]["0.5"]["share"] == 0.0
        assert b["without_earthquakes"]["width_mm"] == pytest.approx([0.05] * 3)
        assert a["without_earthquakes"]["said"] == "open", "three draws are no answer"
        assert c["without_earthquakes"] == {"said": "open", "shares": {}, "width_mm": None}
        assert a["from_m"] == [0, 0] and a["to_m"] == [1, 0] and a["width_mm"] == 0.5

    def test_the_prior_decides_where_both_causes_make_a_crack(self):
        """Without the settlement nothing changes on ground at rest: `b` stays in every world."""
        b = self.found(np.ones((2, 4)))[1]
        assert b["without_settlement"]["shares"]["0.1"]["share"] == pytest.approx(1.0)
        shares = [b["without_earthquakes"]["shares"][str(p)]["share"] for p in PRIORS]
        assert shares == pytest.approx([p / 4 for p in PRIORS])

    def test_worlds_have_the_crack_now(self):
        """`a` is there where the ground settled alone, and there without the earthquakes, too."""
        a = self.found(np.ones((2, 4)))[0]
        assert [one["share"] for one in a["without_earthquakes"]["shares"].values()] == [1.0] * 3

    def test_nothing_is_said_without_a_settlement_that_was_drawn(self):
        drawn = self.TWO.settlement.assign(distortion=[0.001, 0.002, 0.003, 0.004])
        a = self.found(np.ones((2, 4)), replace(self.TWO, settlement=drawn))[0]
        assert a["without_settlement"]["said"] == "open" and a["without_earthquakes"]["shares"]


class TestAnswer:
    def tables(self, *bounds, draws=50.0):
        return {
            str(k): {
                name: {"share": (low + high) / 2, "low": low, "high": high, "draws": draws}
                for name in BUT_FOR
            }
            for k, (low, high) in enumerate(bounds)
        }

    def test_all_priors_have_to_agree_by_their_whole_intervals(self):
        name = BUT_FOR[0]
        assert verdict(self.tables((0.9, 1.0), (0.95, 1.0)))[name] == "yes"
        assert verdict(self.tables((0.0, 0.1), (0.0, 0.05)))[name] == "no"
        few = self.tables((0.0, 0.1), (0.0, 0.05), draws=49.0)
        assert verdict(few)[name] == "open", "as few of those that resemble it count"
        for bounds in (
            ((0.9, 1.0), (0.89, 1.0)),
            ((0.0, 0.1), (0.9, 1.0)),
            ((0.0, 0.11), (0.0, 0.1)),
        ):
            assert verdict(self.tables(*bounds))[name] == "open"

    @pytest.mark.parametrize(
        "change, draws, strange, why",
        [
            ({}, 50.0, 0.95, []),
            ({}, 49.9, 0.0, ["draws"]),
            ({}, 60.0, 0.951, ["strange"]),
            ({"share_on_joints": 0.79}, 60.0, 0.0, ["off_joints"]),
            ({"max_width_mm": 0.09}, 60.0, 0.0, ["small"]),
        ],
    )
    def test_no_answer(self, change, draws, strange, why):
        survey = {"max_width_mm": 0.1, "share_on_joints": 0.8} | change
        assert [code for code, _ in reasons(survey, draws, strange)] == why


class TestLikeness:
    def test_distances_are_those_of_the_survey(self, claimed):
        layout, twins, survey = read(claimed)
        mine, known = surveyed(survey, layout)
        seen = seen_of(survey, twins.opening_m["both"], twins.offset_m["both"], layout)
        found = distances(mine, seen, survey.width_error_m, known)
        assert known.any() and found == pytest.approx(
            [
                distance(survey, twins.opening_m["both"][k], twins.offset_m["both"][k], layout)
                for k in range(len(twins))
            ]
        )

    def test_cracks_where_nobody_looked_do_not_count(self):
        """60 draws resemble the survey of one joint; by settlement all have a wide crack at
        another."""
        twins = made(
            both=[[0.4, 5.0]] * 60, earthquakes=[[0.4, 0.0]] * 60, settlement=[[0.0, 5.0]] * 60
        )
        like = Likeness(np.zeros((2, 60)), np.ones((2, 60)), 0.0)
        one = crack_survey([["a", 0, 0, 1, 0, 4e-4]], [["a", 0]], looked_at=[True, False])
        found = answers(twins, like, one)
        assert found["no_answer"] == [] and found["verdict"]["not_without_earthquakes"] == "yes"
        assert found["crack_width_mm"]["0.5"]["like_survey"]["added"] == pytest.approx([0.4] * 3)
        assert found["cracks"][0]["without_earthquakes"]["said"] == "no"
        whole = answers(twins, like, replace(one, looked_at=np.ones(2, bool)))
        assert whole["verdict"]["not_without_earthquakes"] == "open"
        strange = answers(twins, like._replace(strange=0.96), one)
        assert set(strange["verdict"].values()) == {"open"}, "no answer in claim.json, either"
        assert strange["cracks"][0]["without_earthquakes"]["said"] == "open"

    def test_a_wall_without_visible_cracks_is_not_near(self, claimed):
        """Within the error of widths it is at a distance of 0.47, below FARTHEST."""
        numbers = json.loads((claimed / "claim.json").read_text())
        like = [one for one in numbers["nearest"] if one["distance"] <= FARTHEST]
        assert len(like) == round(numbers["effective_draws"]["0.5"])

    @pytest.mark.parametrize(
        "draws, to_come, said",
        [
            (10, 800, "More draws can help: of 10 none.*nearest at a distance of 0.8.*below 26 %"),
            (96, 800, "More draws cannot help: of 96 none.* below 3.1 %"),
        ],
    )
    def test_whether_more_draws_help(self, draws, to_come, said):
        """0.26 of 800 are more than the 50 of an answer, 0.031 are not: 25."""
        numbers = {"no_answer": [{"why": "draws", "value": 0.0}], "effective_draws": {"0.5": 0.0}}
        numbers |= {"draws": draws, "draws_to_come": to_come, "farthest": FARTHEST}
        numbers["nearest"] = [{"distance": 0.8}]
        assert re.match(said, whether_more_draws_help(numbers, "en"))
        numbers["effective_draws"]["0.5"] = 2.0
        few = f"{number('en', 25 * draws)} would resemble"
        assert whether_more_draws_help(numbers, "en").endswith(f"50 of about {few} the survey.")
        numbers["no_answer"].append({"why": "strange", "value": 0.99})
        assert whether_more_draws_help(numbers, "en") == "More draws alone give no answer."
        assert whether_more_draws_help({"no_answer": []}, "en") is None

    def test_a_few_patterns_say_of_none_that_it_is_strange(self):
        assert strange_share(np.full(NEAREST, 0.9), np.zeros((NEAREST, NEAREST))) == 0.0
        assert strange_share(np.full(NEAREST + 1, 0.9), np.zeros((NEAREST + 1,) * 2)) == 1.0

    def test_kernel(self):
        assert kernel(np.array([0.0, KERNEL]), np.ones(2, bool)) == pytest.approx(
            [1.0, np.exp(-0.5)]
        )
        away = np.full(100, FARTHEST + 1e-9)
        assert effective(kernel(away, np.ones(100, bool))) == 0, (
            "draws equally far away do not resemble the survey"
        )
        assert effective(np.exp(-((away / KERNEL) ** 2) / 2)) == pytest.approx(100)


class TestSheet:
    def test_every_share_of_the_sheet_is_in_the_json(self, claimed):
        page = (claimed / "claim.html").read_text()
        numbers = json.loads((claimed / "claim.json").read_text())
        for row in numbers["all_draws"]["0.5"].values():
            if row["share"] is not None:
                shown = (f"{100 * row[name]:.0f}" for name in ("share", "low", "high"))
                assert "{} ({}\u2011{})".format(*shown) in page
        assert numbers["shaking"]["catalogue_ends"] == "2014-12-30" and "2014-12-30" in page
        assert "from 20 to 70 % of its Arias intensity" in page
        assert numbers["no_answer"][0]["why"] == "draws" and "No answer" in page
        assert [one["crack"] for one in numbers["cracks"]] == ["A", "B"]
        assert page.count("no answer") == 0 and "No answer for any of the 2 cracks" in page
        assert "A 0.15 mm</text>" in page, "the picture has letters and widths"
        assert "Outside the model" in page.partition("</section>")[0], "beside the headline"
        assert numbers["more_draws"] in page
        like = number("en", min(numbers["effective_draws"].values()))
        assert like != "0" and f"only {like} of the computed walls" in describe(numbers)

    def test_evidence_is_that_of_all_runs(self, claimed):
        _, twins, _ = read(claimed)
        history = read_history(next((claimed / "runs").glob("both*.h5")))
        found = evidence_of(history, ["", "drift 0.4 % (up to 0.3 %); slip of a joint 11 mm"])
        assert len(twins.outside) == 2 * len(twins)
        assert found["drift"]["outside_share"] == 0.5 and found["drift"]["inside"] is False
        assert found["corners with other walls"]["outside_share"] == 0

    def test_an_answer_says_what_the_earthquakes_added(self, claimed):
        """Cracks of other causes may have become wider."""
        layout, twins, survey = read(claimed)
        numbers = json.loads((claimed / "claim.json").read_text()) | {"no_answer": []}
        numbers["survey"]["share_looked_at"] = 0.404
        for k, one in enumerate(numbers["crack_width_mm"].values()):
            one["like_survey"]["added"] = [0.03 - 0.01 * k, 0.1, 0.2 + 0.01 * k]
        page = sheet(numbers, layout, survey, twins, "en", "claim.json")
        assert "No answer" not in page and "40 of 100 joints" in page
        assert "added 0.01 to 0.22 mm to the widest crack, which is 0.15 mm wide" in page
        one["like_survey"]["added"][0] = -0.1
        page = sheet(numbers, layout, survey, twins, "en", "claim.json")
        assert "by -0.1 to 0.22 mm" in page

    def test_both_languages_are_whole(self):
        for key, texts in [*all_words().items(), *all_words("app").items()]:
            assert texts.keys() == set(LANGUAGES) and all(texts.values()), key
            fields = [
                {name for _, name, *_ in string.Formatter().parse(text) if name}
                for text in texts.values()
            ]
            assert fields[0] == fields[1], key
        wanted = [
            *(f"quantity {one.name}" for one in QUANTITIES if one.value),
            *(f"profile_{one}" for one in PROFILES),
            *(f"{name}_{said}" for name in BUT_FOR for said in ("yes", "no", "open")),
            *(f"why_{why}" for why in ("draws", "strange", "off_joints", "small")),
        ]
        assert [key for key in wanted if key not in all_words()] == []

    def test_a_sentence_is_not_taken_for_the_part_of_another(self):
        said = "crack A (0.15 mm) would be there without earthquakes: yes, without settlement: no"
        assert in_language("nl", said) == (
            "scheur A (0,15 mm) zou er zijn zonder aardbevingen: ja, zonder zetting: nee"
        )

    def test_a_value_differs_from_its_limit(self):
        numbers = {"no_answer": [{"why": "draws", "value": 49.96}]}
        numbers |= {"like_survey": {}, "crack_width_mm": {}, "settlement": {}}
        numbers["survey"] = {"detection_limit_known": True}
        numbers["verdict"] = dict.fromkeys(BUT_FOR, "open")
        assert in_words(numbers)["why"][0].startswith("only 49.96 of the computed walls")

    def test_a_dutch_sheet_has_no_english_text(self, claimed, capsys):
        assert main(words(claimed.parent, "--language", "nl", draws=4)) == 0
        printed = capsys.readouterr()
        assert not re.search(r"(?<![\w-])(the|draws|expected)(?![\w-])", printed.out + printed.err)
        page = re.sub(r"\s+", " ", (claimed / "claim.html").read_text())
        assert '<html lang="nl">' in page and "Geen antwoord" in page
        parts = [
            part.strip()
            for texts in all_words().values()
            for part in re.split(r"\{\w+\}", texts["en"])
            if texts["en"] != texts["nl"]
        ]
        assert [part for part in parts if len(part) > 12 and part in page] == []


class TestOneFolder:
    """What other claims, edited files and other versions do to a claim."""

    def test_a_second_claim_is_refused_before_it_writes_anything(
        self, claimed, capsys, monkeypatch
    ):
        monkeypatch.setattr(folder, "LOCK_PATIENCE_S", 0.0)
        before = {path: path.read_bytes() for path in claimed.rglob("*") if path.is_file()}
        with folder.while_locked(claimed, "claim"):
            assert main(words(claimed.parent, "--seed", "7", "--settle", "hogging", draws=4)) == 2
        assert "another batch is at work" in capsys.readouterr().err
        assert before == {path: path.read_bytes() for path in claimed.rglob("*") if path.is_file()}

    def test_a_first_sheet_comes_before_that_of_all_draws(
        self, claimed, tmp_path, capsys, monkeypatch
    ):
        monkeypatch.setattr(make, "STEPS", (2, 3, 8))
        written_numbers = []
        monkeypatch.setattr(
            make,
            "sheet",
            lambda numbers, *_, **__: written_numbers.append(dict(numbers)) or "a sheet",
        )
        out = shutil.copytree(claimed, tmp_path / "out")
        assert main(words(claimed.parent, "--out", str(out), draws=4)) == 0
        of_sheets = [(one["draws"], one["draws_to_come"]) for one in written_numbers]
        assert of_sheets == [(2, 4), (4, None)]
        assert "2 draws, not yet the answer" in capsys.readouterr().out
        assert make.steps_to(None) == make.STEPS and make.steps_to(8) == (2, 3, 8)

    def test_a_wall_that_was_edited_meanwhile_makes_no_sheet(
        self, claimed, tmp_path, capsys, monkeypatch
    ):
        """The survey was put on the joints of another one than those of the runs."""
        out = shutil.copytree(claimed, tmp_path / "out")
        (out / "claim.html").unlink()
        wall_file(tmp_path / "narrow.py", "Wall('narrow', 0.9, 1.35)")
        shutil.copy(claimed.parent / "survey.csv", tmp_path)
        monkeypatch.setattr(make, "_draw", lambda *_: 0)
        assert main(words(tmp_path)) == 2
        assert "narrow.py changed since this claim began" in capsys.readouterr().err
        assert not (out / "claim.html").exists()

    def test_draws_of_another_version_are_refused_or_made_again(self, claimed, tmp_path, capsys):
        out = shutil.copytree(claimed, tmp_path / "out")
        (new,) = {one["row"]["model_digest"] for one in read_records(claimed).runs.values()}
        records = read_records(out)
        records.runs["both_from1_reference_s1"]["row"]["model_digest"] = "of before"
        (out / "records.jsonl").write_text(records.text())
        assert "draws of 2 versions, model_digest" in one_line_error(
            read_twins, out, layout_of(claimed.parent / "narrow.py")
        )
        line = words(claimed.parent, "--out", str(out))
        before = (out / "claim.html").read_bytes()
        assert main(line) == 2 and (out / "former-claim.html").read_bytes() == before
        assert not (out / "claim.html").exists()
        said = capsys.readouterr().err
        assert "made 1 runs: both_from1_reference_s1" in said and "give --remake" in said
        assert main([*line, "--remake"]) == 0
        made_by = json.loads((out / "claim.json").read_text())["made_by"]
        digests = {"model_digest": new, "measures_digest": measures_digest()}
        assert made_by["commit"] == commit() and digests.items() <= made_by["draws"].items()
        page = (out / "claim.html").read_text()
        assert all(digest in page for digest in digests.values())


def test_the_size_of_a_draw_does_not_depend_on_their_number(tmp_path):
    """More draws are in more points of 48."""
    address = {"latitude": 53.36786, "longitude": 6.71359, "above_mm_s": 8.0}
    sizes = []
    for draws in (10, 192):
        (folder := tmp_path / str(draws)).mkdir()
        wall = REPOSITORY / "walls/variants/small.py"
        causes = causes_of(address, {"rest": 0.2}, {})
        sizes.append(terminal.size_of(twins_study(folder, wall, causes, draws)))
    assert sizes[0] == sizes[1]


def test_a_wall_of_the_repository_is_found_from_any_folder(claimed, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(make, "_draw", lambda study, *_: study.runs[0].wall.endswith("small.py"))
    wall = os.path.relpath(REPOSITORY / "walls/variants/small.py")
    _, _, *more = words(claimed.parent, draws=2)[:-1]
    assert main(["claim", wall, *more, "out"]) == 1


class TestBadInput:
    @pytest.mark.parametrize(
        "more, said",
        [
            (["--levels", "l.csv", "--settle", "knick"], "expected one of them"),
            (["--distortion", "1/500"], "--distortion belongs to --settle"),
            (["--settle", "dome"], "--settle dome"),
            (["--at", "52.09", "5.12"], "from the nearest epicentre"),
            (["--language", "fr"], "invalid choice"),
        ],
    )
    def test_what_is_wrong_is_said_before_anything_runs(
        self, claimed, tmp_path, error_of, more, said
    ):
        assert said in error_of(*words(claimed.parent), *more, "--out", tmp_path / "new")
        assert not (tmp_path / "new" / "runs").exists()

    def test_a_sheet_of_former_inputs_does_not_stay(self, claimed, tmp_path, error_of):
        """A refused command removes it."""
        (out := tmp_path / "out").mkdir()
        for name in ("claim.html", "claim.json"):
            written(out / name, "of the former house")
        far = written(tmp_path / "far.csv", CRACKS.replace("0.16,0.075,", "9,0,"))
        error_of(*words(claimed.parent), "--out", out, "--cracks", far)
        assert {path.name: path.read_text() for path in out.iterdir()} == dict.fromkeys(
            ("former-claim.html", "former-claim.json"), "of the former house"
        )
