"""The report as one HTML file: what is in it is what the histories and tables hold, nothing else is fetched or run."""

import base64
import gzip
import json
import re
import shutil
import tomllib
from dataclasses import replace
from fnmatch import fnmatch
from html.parser import HTMLParser
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from conftest import REPOSITORY, one_line_error, refused_with
from small_history import make_history, small_layout

from damage.__main__ import main
from damage.draw.run import ENERGIES
from damage.draw.words import run_title
from damage.history.moments import joint_states
from damage.measure.columns import read_table
from damage.measure.energy import energy_groups
from damage.measure.summary import summarise
from damage.measure.tables import summary_row, write_table
from damage.studies.tables import points_of
from damage.wall.layout import lay_out
from damage.wall.parameters import Wall
from paper.evidence import Point, load_runs

pytest.importorskip("jinja2")

from damage.html.packing import quantised
from damage.html.plain import plain
from damage.html.report import Words, page, plotly_code, write_report
from damage.html.run_part import MOST_INSTANTS, MOST_POINTS, points, preview, still
from damage.html.study_part import figures
from damage.html.tables import digits_of

VOID = {"meta", "link", "img", "input", "br", "wbr"}
RAMP = np.linspace(0, 1, 21)
MIB = 2**20


def unpack_arrays(content):
    """Flat arrays {name: array} from the result of `pack_arrays`, as the page's program makes them."""
    data = gzip.decompress(base64.b64decode(content["packed"]))
    return {name: np.frombuffer(data, f"<{kind}", length, first)
            for name, (kind, first, length) in content["arrays"].items()}


class Page(HTMLParser):
    """A page taken apart: its elements with their attributes, words of its text, its scripts; and whether it is closed
    as it is opened."""

    def __init__(self, text):
        super().__init__()
        self.elements, self.scripts, self.words, self.open = [], [], [], []
        self.feed(text)
        assert self.open == []
        self.text = re.sub(r"\s+", " ", "".join(self.words))

    def handle_starttag(self, tag, attributes):
        self.elements.append((tag, dict(attributes)))
        if tag not in VOID and tag not in ("line", "path"):
            self.open.append(tag)
        if tag == "script":
            self.scripts.append("")

    def handle_endtag(self, tag):
        assert self.open.pop() == tag, self.getpos()

    def handle_data(self, data):
        if self.open and self.open[-1] == "script":
            self.scripts[-1] += data
        elif self.open and self.open[-1] != "style":
            self.words.append(data)

    def all(self, tag):
        return [attributes for name, attributes in self.elements if name == tag]

    @property
    def data(self):
        return json.loads(self.scripts[0])


def damaged(path, **options):
    """A history in which one joint opens to 0.5 mm, another slips by 0.3 mm, and the top drifts to 0.1 %."""
    layout = small_layout()
    motion = np.zeros((len(layout.bodies), 3))
    motion[0] = 0.01, -0.002, 0.003
    return make_history(path, layout, **{
        "drift": 1e-3 * np.sin(2 * np.pi * RAMP), "opening": {2: 5e-4 * RAMP}, "slip": {3: -3e-4 * RAMP},
        "broken": (4,),
        "snapshots": {0.0: 0 * motion, 0.1: motion, 0.2: 2 * motion}} | options)


@pytest.fixture(scope="module", autouse=True)
def _quick():
    """Pictures and the library are in the pages of few tests: they take most of a page's time."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("damage.html.run_part.still", lambda history: "")
        patch.setattr("damage.html.run_part.preview", lambda history: "")
        patch.setattr("damage.html.report.plotly_code", lambda: "plotly.js (basic - minified) v0")
        yield


@pytest.fixture(scope="module")
def one(tmp_path_factory):
    return damaged(tmp_path_factory.mktemp("html") / "one.h5")


@pytest.fixture(scope="module")
def page_of_one(one):
    return Page(page([one.path], []))


def make_study(folder, *histories, title="a study"):
    """The folder of a study whose points are these histories."""
    rows = [summary_row(history, point=f"point-{history.path.stem}") for history in histories]
    summary = pd.DataFrame(rows).assign(members=1)
    (folder / "tables").mkdir(parents=True)
    write_table(summary, folder / "tables" / "summary.csv")
    write_table(points_of(summary), folder / "tables" / "points.csv")
    (folder / "study.toml").write_text(f'name = "mine"\ntitle = "{title}"\n')
    return folder


class TestInShort:
    def plain(self, language="en", members=None, collapsed=None, **changes):
        history = SimpleNamespace(sequence=(1.0,) * 3, collapsed_at_s=collapsed)
        summary = {"settled_psi": 1.2, "max_crack_width_mm": 0.9, "evidence": {}}
        row = {"settled_crack_width_mm": 0.2, "residual_crack_width_mm": 0.5, "pgv_m_s": 0.04}
        return plain(history, summary, row | changes, members, language)

    def test_what_is_left_what_was_added_and_the_velocity(self):
        found = self.plain()
        assert [(value, unit) for _, value, _, unit, _ in found["cards"]] == [
            (0.5, "mm"), (pytest.approx(0.3), "mm"), (pytest.approx(40), "mm/s")]
        assert len(found["lines"]) == 5 and "0.5 mm is left, of which 0.3 mm came with the motion" in found["lines"][3]

    def test_ranges_are_over_the_members(self):
        members = pd.DataFrame({"settled_crack_width_mm": [0.2, 0.1], "residual_crack_width_mm": [0.5, 0.9],
                                "pgv_m_s": [0.04, 0.04]})
        cards = self.plain(members=members)["cards"]
        assert [more for *_, more in cards] == ["2 members: 0.5 to 0.9", "2 members: 0.3 to 0.8", "2 members: 40 to 40"]

    def test_in_dutch(self):
        found = self.plain("nl")
        assert found["lines"][0].startswith("De muur is 3 keer geschud; de sterkste beweging had een trillingssnelheid")
        assert [shown for _, _, shown, *_ in found["cards"]] == ["0,5", "0,3", "40"]

    @pytest.mark.parametrize("changes, said", [
        ({"residual_crack_width_mm": 0.05, "settled_crack_width_mm": None}, "below 0.1 mm no crack is visible"),
        ({"residual_crack_width_mm": None}, "no end at rest"), ({"collapsed": 1.0}, "part of the wall fell")])
    def test_the_end(self, changes, said):
        assert said in self.plain(**changes)["lines"][3]

    def test_it_is_in_the_page(self, one, page_of_one):
        assert "In short" in page_of_one.text and "The technical part follows." in page_of_one.text
        dutch = Page(page([one.path], [], Words(language="nl")))
        assert "In het kort" in dutch.text and {"class": "plain", "lang": "nl", "aria-label": "In het kort"} in \
            dutch.all("section")


class TestOneRun:
    def test_lines_over_time_are_those_of_the_history(self, one, page_of_one):
        drawn = page_of_one.data["runs"][0]
        arrays, series = unpack_arrays(drawn), one.series
        expected = {"time_s": series["time_s"], "drift_ratio": series["drift_ratio"],
                    "base_shear_kn": series["base_shear_n"] / 1e3,
                    **{name: one.index()[name] for name in ("DI", "DI_drift", "DI_open", "DI_slip")}}
        for name, values in (expected | energy_groups(series)).items():
            assert np.array_equal(arrays[name], np.asarray(values).astype("f4"), equal_nan=True), name
        assert {line["series"]: line["name"] for line in page_of_one.data["states"]["energies"]} == {
            name: label for name, (label, *_) in ENERGIES.items()}
        assert drawn["settling"] == [[series["time_s"].iloc[16], series["time_s"].iloc[20]]]
        assert np.flatnonzero(arrays["settles"]).tolist() == [16, 17, 18, 19, 20] and drawn["settlement"] == []

    def test_lines_of_cracks_are_no_wider_than_half_of_a_brick(self, tmp_path):
        large = make_history(tmp_path / "large.h5", lay_out(Wall("large", 4.05, 2.7)), stages=("motion",) * 2)
        widest = {name: max(width["pixels"] for width in Page(page([path], [])).data["states"]["widths"])
                  for name, path in (("small", damaged(tmp_path / "small.h5").path), ("large", large.path))}
        assert widest["small"] > 8
        assert 0.4 < widest["large"] / (0.075 * 480 / 4.05) <= 0.5  # of the height of a brick that is drawn so wide

    def test_it_is_titled_in_words_and_has_a_dark_mode(self, one):
        text = page([one.path], [])
        assert "<h1>Small wall, harmonic motion of 0.2 s and 0.05 g, three cycles</h1>" in text
        assert "@media screen and (prefers-color-scheme: dark)" in text

    def test_joints_are_in_the_states_of_the_history(self, one, page_of_one):
        arrays = unpack_arrays(page_of_one.data["runs"][0])
        states = arrays["state"].reshape(len(arrays["instant"]), -1)
        ever = [2, 3, 4]  # all others stay whole
        assert np.array_equal(states, [joint_states(one, sample)[ever] for sample in arrays["instant"]])
        widths = arrays["width_um"].reshape(states.shape)
        assert widths[-1].tolist() == [500, 300, 0]
        assert np.array_equal(arrays["first"], one.joints["first_body"].iloc[ever])

    def test_bricks_are_where_the_nearest_snapshot_has_them(self, one, page_of_one):
        drawn = page_of_one.data["runs"][0]
        arrays = unpack_arrays(drawn)
        places = arrays["place"].reshape(len(arrays["instant"]), -1, 3) * drawn["step"]
        at = list(arrays["instant"]).index(10)  # 0.1 s
        assert places[at, 0] == pytest.approx([0.01, -0.002, 0.003], rel=1e-4)
        assert not places[at, 1:].any()

    def test_where_anything_is_largest_is_among_the_instants(self, one, page_of_one):
        instants = set(unpack_arrays(page_of_one.data["runs"][0])["instant"])
        drift = one.series["drift_ratio"]
        assert {0, 20, int(one.index()["DI"].idxmax()), int(drift.idxmax()), int(drift.idxmin())} <= instants

    def test_measures_are_those_of_the_summary_with_unit_and_meaning(self, one, page_of_one):
        parsed = [float(data["value"]) for data in page_of_one.all("data")]
        summary = summarise(one)
        for value in (summary["max"]["DI"], summary["residual"]["DI_slip"], summary["max_drift_ratio"],
                      summary["max_psi"], summary["peak_base_shear_n"], summary["input_energy_j"]):
            assert value in parsed
        for words in ("max_crack_width_mm", "Korswagen's damage parameter", "largest absolute drift ratio", "supplied"):
            assert words in page_of_one.text

    def test_results_have_three_digits_and_what_was_given_has_all(self, one, page_of_one, tmp_path):
        assert digits_of("max_DI") == digits_of("input_energy_j") == 3 < digits_of("amplitude_g") == digits_of("scale")
        text = page([damaged(tmp_path / "digits.h5", row={"input_energy_j": 1234.5678 * RAMP}).path], [])
        assert re.search(r'<data value="1234\.5\d+">1230</data>', text) and "1234.6" not in text

    def test_command_versions_and_parameters_are_there(self, one, page_of_one):
        assert one.command in page_of_one.text
        for words in ("digest of the model", "wall.brick.length", "masonry-damage", "loading.amplitude_g"):
            assert words in page_of_one.text

    def test_pictures_of_the_wall_built_and_damaged_are_there_without_scripts(self, one):
        assert base64.b64decode(still(one))[:4] == base64.b64decode(preview(one))[:4] == b"\x89PNG"

    def test_a_run_that_is_whole_has_nothing_to_be_read_first(self, page_of_one):
        assert not page_of_one.all("aside")

    def test_the_same_run_gives_the_same_bytes(self, one):
        assert page([one.path], []) == page([one.path], [])

    def test_every_drawing_has_words_and_every_control_a_name(self, page_of_one):
        drawings = [one for one in page_of_one.all("div") if one.get("role") == "img"]
        assert len(drawings) == 5
        assert all(len(one["aria-label"]) > 40 for one in drawings)
        assert all(one["alt"] for one in page_of_one.all("img"))
        labels = page_of_one.elements
        for k, (tag, attributes) in enumerate(labels):
            if tag in ("input", "select"):
                assert labels[k - 1][0] == "label", attributes


class TestNothingElse:
    FETCHED = re.compile(r"""(?:src|href|action|data|poster)\s*=\s*["']?\s*(?!data:|#)[^"'\s>]|url\(|@import|fetch\(|"""
                         r"XMLHttpRequest|import\(|sendBeacon|WebSocket", re.IGNORECASE)

    def test_nothing_is_fetched(self, one):
        text = page([one.path], [])
        assert [found[0] for found in self.FETCHED.finditer(text)] == []
        policy = Page(text).all("meta")[2]["content"]
        assert "default-src 'none'" in policy and "connect-src" not in policy  # the browser holds the library to it

    def test_what_is_fetched_is_found(self):
        for text in ('<img src="https://a.b/c.png">', "<link href=//a.b>", "<a href='x.html'>", 'fetch("x")'):
            assert self.FETCHED.search(text)

    def test_it_stays_small_though_every_joint_is_always_broken(self, tmp_path, monkeypatch):
        monkeypatch.setattr("damage.html.report.plotly_code", plotly_code)
        monkeypatch.setattr("damage.html.run_part.still", still)
        monkeypatch.setattr("damage.html.run_part.preview", preview)
        layout = lay_out(Wall("large", 4.05, 2.7))
        n_times, random = MOST_INSTANTS + 1, np.random.default_rng(1)
        opening = random.uniform(0, 2e-3, (n_times, layout.n_joints))
        places = random.normal(0, 1e-2, (n_times, len(layout.bodies), 3))
        history = make_history(
            tmp_path / "large.h5", layout, stages=("motion",) * n_times, drift=random.normal(0, 1e-3, n_times),
            opening=dict(enumerate(opening.T)), snapshots={0.01 * k: places[k] for k in range(n_times)})
        assert layout.n_joints > 2000
        path = write_report([history.path])
        assert path == tmp_path / "large.html"
        assert MIB < path.stat().st_size < 10 * MIB
        drawn = Page(path.read_text()).data["runs"][0]
        assert MOST_INSTANTS <= drawn["n_instants"] < MOST_INSTANTS + 12

    def test_the_page_is_among_the_data_of_the_package(self):
        project = tomllib.loads((REPOSITORY / "pyproject.toml").read_text())
        listed = project["tool"]["setuptools"]["package-data"]["damage"]
        for path in (REPOSITORY / "damage" / "html" / "page").iterdir():
            assert any(fnmatch(path.relative_to(REPOSITORY / "damage").as_posix(), pattern) for pattern in listed)


def test_a_collapse_whose_bricks_were_followed_shows_where_they_lie(tmp_path):
    layout = small_layout()
    fallen = np.zeros((len(layout.bodies), 3)) + [0.2, -0.1, 1.0]
    pages = [Page(page([damaged(tmp_path / f"{end}.h5", collapsed_at_s=0.15, snapshots={0.0: 0 * fallen, end: fallen}
                                ).path], [])) for end in (0.2, 0.9)]
    before, after = (["heap" in attributes.get("class", "") for attributes in one.all("img")] for one in pages)
    assert not any(before) and after.count(True) == 1


class TestSaidFirst:
    @pytest.mark.parametrize(("options", "words"), [
        ({"status": "interrupted"}, "interrupted at 0.200 s"), ({"status": "failed"}, "do not rely"),
        ({"status": "unfinished"}, "without an end"), ({"collapsed_at_s": 0.15}, "collapsed at 0.150 s"),
        ({"row": {"input_energy_j": np.linspace(0, 9, 21)}}, "energy balance error"),
    ])
    def test_a_run_that_is_not_whole_or_odd_says_so_at_the_top(self, tmp_path, options, words):
        history = damaged(tmp_path / "odd.h5", **options)
        text = page([history.path], [])
        assert words in text
        assert text.index(words) < text.index("<main")

    def test_a_residual_that_is_none_is_not_shown_as_a_number(self, tmp_path):
        text = page([damaged(tmp_path / "cut.h5", status="interrupted").path], [])
        assert "no end, no residual" in text

    @pytest.mark.parametrize(("loading", "still", "title"), [
        ("cyclic", True, "Base shear"), ("free_vibration", True, "Base shear"), ("record", False, "Base acceleration")])
    def test_whatever_drives_the_wall_is_drawn_above(self, tmp_path, loading, still, title):
        row = {"base_acceleration_x_m_s2": 0.0} if still else {"base_acceleration_z_m_s2": RAMP}
        history = damaged(tmp_path / "driven.h5", loading=loading, row=row | {"top_force_n": np.nan})
        panel = Page(page([history.path], [])).data["charts"][0]
        assert (panel["title"], len(panel["lines"])) == (title, 1 if still else 2)

    def test_a_run_without_snapshots_is_drawn_at_rest(self, tmp_path):
        drawn = Page(page([damaged(tmp_path / "bare.h5", snapshots={}).path], [])).data["runs"][0]
        arrays = unpack_arrays(drawn)
        assert not arrays["snapshot"].any() and not arrays["place"].any()


class TestSideBySide:
    def test_differences_are_from_the_first(self, one, tmp_path):
        other = damaged(tmp_path / "two.h5", opening={2: 1e-3 * RAMP, 5: 1e-3 * RAMP})
        parsed = Page(page([one.path, other.path], []))
        assert [run["letter"] for run in parsed.data["runs"]] == ["A", "B"]
        difference = summarise(other)["max"]["DI"] - summarise(one)["max"]["DI"]
        assert difference > 0
        assert repr(difference) in [data["value"] for data in parsed.all("data")]
        assert [panel["title"] for panel in parsed.data["charts"]][2:] == ["DI", "DI drift", "DI open", "DI slip"]
        assert {panel["lines"][1]["dash"] for panel in parsed.data["charts"]} == {"dash"}

    def test_only_the_odd_one_is_named_at_the_top(self, one, tmp_path):
        other = damaged(tmp_path / "two.h5", status="interrupted")
        text = page([one.path, other.path], [])
        first = text[text.index("<aside"):text.index("</aside>")]
        assert "Run B, two.h5" in first and "one.h5" not in first


class TestStudy:
    @pytest.fixture
    def study(self, tmp_path):
        folder = tmp_path / "mine"
        return make_study(folder, damaged(folder / "runs" / "a.h5"),
                          damaged(folder / "runs" / "b.h5", opening={2: 2e-4 * RAMP}))

    def test_points_are_in_a_table_that_sorts_by_their_numbers(self, study):
        parsed = Page(page([], [study]))
        (table,) = [one for one in parsed.all("table") if one.get("class") == "sortable"]
        assert table and "point-a" in parsed.text and "a study" in parsed.text
        values = {float(cell["data-sort"]) for cell in parsed.all("td") if "data-sort" in cell}
        assert set(read_table(study / "tables" / "points.csv")["max_DI"]) <= values

    def test_the_worst_runs_have_parts_of_their_own_that_are_linked(self, study):
        parsed = Page(page([], [study]))
        assert [run["letter"] for run in parsed.data["runs"]] == ["A", "B"]
        links = [one["href"] for one in parsed.all("a")]
        assert links.count("#run-A") == 2  # of the contents and of the table
        (study / "runs" / "a.h5").unlink()
        assert "a.h5" in Page(page([], [study])).text

    def test_of_every_point_the_worst_run_comes_before_its_others(self, study):
        summary = read_table(study / "tables" / "summary.csv")
        again = summary[summary["run"] == "b"].assign(run="b_again")
        shutil.copy(study / "runs" / "b.h5", study / "runs" / "b_again.h5")
        pd.concat([summary, again.assign(max_DI=again["max_DI"] * 2)]).to_csv(study / "tables" / "summary.csv",
                                                                              index=False)
        parsed = Page(page([], [study])).text
        order = sorted(("b_again.h5,", "b.h5,", "a.h5,"), key=parsed.index)
        worse = summary.set_index("run")["max_DI"]
        assert order == (["b_again.h5,", "a.h5,", "b.h5,"] if 2 * worse["b"] > worse["a"]
                         else ["a.h5,", "b_again.h5,", "b.h5,"])

    def test_documents_beside_the_tables_are_shown_as_text(self, study):
        (study / "tables" / "lives.md").write_text("# Lives\n\n| a < b |\n")
        (study.parent / "tables").mkdir()
        (study.parent / "tables" / "verdict.md").write_text("holds\n")
        alone, together = page([], [study]), page([], [study.parent])
        for text in (alone, together):
            assert "<summary>tables/lives.md</summary><pre># Lives\n\n| a &lt; b |\n</pre>" in text
        assert "<pre>holds\n</pre>" in together and "verdict.md" not in alone

    def test_without_histories_the_tables_are_left(self, study):
        for path in (study / "runs").iterdir():
            path.unlink()
        parsed = Page(page([], [study]))
        assert "point-b" in parsed.text and not parsed.all("noscript") and len(parsed.scripts) == 1

    def test_a_history_that_is_damaged_is_said_first_and_the_others_are_shown(self, study):
        (study / "runs" / "a.h5").write_bytes((study / "runs" / "a.h5").read_bytes()[:-99])
        parsed = Page(page([], [study]))
        assert "Histories that cannot be read" in parsed.text and "a.h5" in parsed.text
        assert [run["letter"] for run in parsed.data["runs"]] == ["A"]

    def test_what_is_missing_or_growing_is_said_first(self, study):
        (study / "runs" / "c.part.h5").write_bytes(b"")
        summary = read_table(study / "tables" / "summary.csv")
        summary.loc[0, "status"], summary.loc[1, "collapsed_at_s"] = "interrupted", 0.1
        write_table(summary, study / "tables" / "summary.csv")
        (study / "study.toml").write_text(
            'name = "mine"\n[[runs]]\nid = "x"\nwall = "walls/symmetric.py"\noptions = { harmonic = [0.2, 0.05] }\n' * 1
            + "".join(f'[[runs]]\nid = "x{k}"\nwall = "walls/symmetric.py"\noptions = {{ harmonic = [0.2, 0.0{k}] }}\n'
                      for k in (1, 2, 3)))
        text = page([], [study])
        first = text[text.index("<aside"):text.index("</aside>")]
        for words in ("2 of 4 points", "c.part.h5", "did not come to their end: a", "1 of 2 runs collapsed"):
            assert words in first

    def test_figures_are_embedded_up_to_a_size(self, study, monkeypatch):
        from matplotlib.figure import Figure

        (study / "figures").mkdir()
        for name in ("fig12_drift", "other"):
            Figure((2, 1)).savefig(study / "figures" / f"{name}.png", dpi=50)
        parsed = Page(page([], [study]))
        assert [one["alt"] for one in parsed.all("img") if one["alt"].endswith("(fig12_drift)")]
        monkeypatch.setattr("damage.html.study_part.MOST_FIGURES_MB", 0.0)
        assert figures(study) == {"embedded": [], "named": ["figures/fig12_drift.png", "figures/other.png"]}

    def test_scattered_strengths_have_their_fragility(self, study):
        path = study / "tables" / "summary.csv"
        summary = read_table(path)
        many = pd.concat([summary.assign(strength_cov=0.3, strength_seed=seed, pga_g=pga, max_DI=damage,
                                         run=f"r{seed}-{pga}", status="complete")
                          for seed in (1, 2, 3) for pga, damage in ((0.1, 0.01), (0.2, 0.03 * seed), (0.3, 0.2))])
        write_table(many, path)
        parsed = Page(page([], [study]))
        assert "Fragility" in parsed.text and "dispersion" in parsed.text
        assert any("exceeding" in one["alt"] for one in parsed.all("img"))


class TestEscaping:
    EVIL = "</script><script>alert(1)</script><img src=x onerror=alert(1)>\"'&"

    def test_texts_of_files_are_no_html(self, tmp_path):
        path = tmp_path / "<b>&amp;'.h5"
        folder = make_study(tmp_path / "<i>study", damaged(path))
        for name in ("points.csv", "summary.csv"):
            table = read_table(folder / "tables" / name)
            write_table(table.assign(point=self.EVIL, motion=self.EVIL, status=self.EVIL, wall=self.EVIL),
                        folder / "tables" / name)
        (folder / "study.toml").write_text(f"name = '''{self.EVIL[:-3]}'''\ntitle = '''{self.EVIL[:-2]}'''\n")
        parsed = Page(page([path], [folder]))
        assert len(parsed.scripts) == 3
        assert not [one for one in parsed.all("img") if "onerror" in one]
        assert not parsed.all("b") and not parsed.all("i")
        assert self.EVIL in parsed.text and "<b>&amp;'.h5" in parsed.text

    def test_a_command_of_a_file_is_no_html(self, tmp_path, monkeypatch):
        history = damaged(tmp_path / "evil.h5")
        monkeypatch.setattr("damage.html.report.read_history", lambda path: replace(history, command=self.EVIL))
        parsed = Page(page([history.path], []))
        assert len(parsed.scripts) == 3 and self.EVIL in parsed.text


class TestFile:
    def test_it_goes_beside_the_first(self, one, tmp_path, output_of):
        history = damaged(tmp_path / "x.h5")
        assert output_of("report", history.path) == f"{tmp_path / 'x.html'}\n"
        study = make_study(tmp_path / "study", history)
        assert write_report([study]) == study / "report.html"

    def test_bad_input_is_one_line(self, one, tmp_path):
        assert "ends in .html" in one_line_error(write_report, [one.path], tmp_path / "x.h5")
        assert "up to 6" in one_line_error(write_report, [one.path] * 7)
        assert "summary.csv" in one_line_error(write_report, [tmp_path])
        assert "check the path" in one_line_error(write_report, [tmp_path / "none.h5"])
        empty = make_history(tmp_path / "empty.h5", stages=(), status="unfinished", snapshots={}).path
        refused_with("no sample", write_report, [empty])

    def test_what_cannot_be_written_leaves_what_was_there(self, one, tmp_path):
        out = tmp_path / "out.html"
        out.mkdir()
        assert "cannot write" in one_line_error(write_report, [one.path], out)
        assert [path.name for path in tmp_path.iterdir()] == ["out.html"]


class TestNumbers:
    def test_a_long_line_keeps_its_extremes_and_what_is_needed(self):
        lines = np.random.default_rng(2).normal(size=(5, 20_000))
        kept = points(lines, [7, 19_999])
        assert len(kept) <= MOST_POINTS + 2
        assert {7, 19_999} <= set(kept)
        assert np.array_equal(lines[:, kept].max(axis=1), lines.max(axis=1))
        assert np.array_equal(lines[:, kept].min(axis=1), lines.min(axis=1))
        assert len(points(lines[:, :50], [])) == 50

    def test_steps_are_a_32767th_of_the_largest(self):
        values = np.array([[1.0, 0.0], [-0.5, 0.0], [np.nan, np.inf]])
        whole, step = quantised(values)
        assert whole.tolist() == [[32767, 0], [-16384, 0], [0, 0]]
        assert step[0] == 1 / 32767


def test_a_report_begins_with_the_words_of_its_author(one, tmp_path):
    out = tmp_path / "a.html"
    assert main(["report", str(one.path), "--out", str(out), "--title", "House 7 <b>", "--author", "N. N.", "--text",
                 "First & <i>.\n\nSecond."]) == 0
    text = out.read_text(encoding="utf-8")
    parsed = Page(text)
    assert [each["content"] for each in parsed.all("meta") if each.get("name") == "author"] == ["N. N."]
    assert not parsed.all("b") and not parsed.all("i")
    words = "".join(parsed.words)
    assert words.index("House 7 <b>") < words.index(run_title(one)) < words.index("N. N.") < words.index("First & <i>.")
    assert '<p class="text">Second.</p>' in text


def test_a_history_s_numbers_are_equal_in_json_table_point_report_and_verdict(one, tmp_path, output_of):
    parsed = json.loads(output_of("index", one.path, "--json"))
    flat = {f"{kind}_{name}": value for kind, values in parsed.items() if isinstance(values, dict)
            for name, value in values.items()} | parsed
    folder = make_study(tmp_path, one)
    row, point = (read_table(folder / "tables" / f"{name}.csv").iloc[0] for name in ("summary", "points"))
    as_evidence = Point(load_runs(folder), "the run")
    cell = r'<th scope="row"><code>(.*?)</code></th><td>[^<]*</td><td class="number"><data value="(.*?)">'
    shown = {name.replace("<wbr>", ""): float(value) for name, value in re.findall(cell, page([one.path], []))}
    numbers = {name: value for name, value in flat.items() if isinstance(value, float)}
    assert {"max_DI", "residual_shear_limit_DI", "max_drift_ratio", "residual_drift_ratio", "pgv_m_s",
            "max_crack_width_mm", "residual_psi", "elastic_joint_share"} <= set(numbers)
    for name, value in numbers.items():
        assert shown[name] == value, name
        for other in (row[name], point[name], as_evidence.plain(name)):
            assert other == pytest.approx(value, rel=1e-8, abs=1e-12), name  # tables have nine digits
