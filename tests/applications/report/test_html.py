"""The report as one HTML file: what is in it is what the histories and tables hold, nothing else is
fetched or run."""

import base64
import gzip
import json
import re
from html.parser import HTMLParser
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from small_history import make_history, small_layout

from damage.applications.studies.read import read_table
from damage.applications.studies.tables import points_of
from damage.history.moments import joint_states
from damage.measure.energy import energy_groups
from damage.measure.summary import summarise
from damage.measure.tables import summary_row, write_table
from paper.evidence import Point, load_runs

pytest.importorskip("jinja2")

from damage.applications.report import study_part
from damage.applications.report.plain import plain
from damage.applications.report.report import Heading, page
from damage.applications.report.study_charts import BELOW, LEFT, TALL, axes, charts
from damage.applications.report.study_part import labels
from damage.applications.report.tables import OTHER_CRITERIA
from damage.applications.studies.states import column_words

VOID = {"meta", "link", "img", "input", "br", "wbr"}
RAMP = np.linspace(0, 1, 21)


def unpack_arrays(content):
    """Flat arrays {name: array} from the result of `pack_arrays`, as the page's program makes
    them."""
    data = gzip.decompress(base64.b64decode(content["packed"]))
    return {
        name: np.frombuffer(data, f"<{kind}", length, first)
        for name, (kind, first, length) in content["arrays"].items()
    }


class Page(HTMLParser):
    """A page taken apart: its elements with their attributes, words of its text, its scripts; and
    whether it is closed as it is opened."""

    def __init__(self, text):
        super().__init__()
        self.elements = []
        self.scripts = []
        self.words = []
        self.open = []
        self.feed(text)
        assert self.open == []
        self.text = re.sub(r"\s+", " ", "".join(self.words))

    def handle_starttag(self, tag, attributes):
        self.elements.append((tag, dict(attributes)))
        if tag not in VOID:
            self.open.append(tag)
        if tag == "script":
            self.scripts.append("")

    def handle_startendtag(self, tag, attributes):
        self.elements.append((tag, dict(attributes)))

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
    """A history in which one joint opens to 0.5 mm, another slips by 0.3 mm, and the top drifts to
    0.1 %."""
    layout = small_layout()
    motion = np.zeros((len(layout.bodies), 3))
    motion[0] = 0.01, -0.002, 0.003
    return make_history(
        path,
        layout,
        **{
            "drift": 1e-3 * np.sin(2 * np.pi * RAMP),
            "opening": {2: 5e-4 * RAMP},
            "slip": {3: -3e-4 * RAMP},
            "broken": (4,),
            "snapshots": {0.0: 0 * motion, 0.1: motion, 0.2: 2 * motion},
        }
        | options,
    )


@pytest.fixture(scope="module", autouse=True)
def _quick():
    """Pictures and the library are in the pages of few tests: they take most of a page's time."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("damage.applications.report.run_part.still", lambda history: "")
        patch.setattr("damage.applications.report.run_part.preview", lambda history: "")
        patch.setattr(
            "damage.applications.report.report.plotly_code",
            lambda: "plotly.js (basic - minified) v0",
        )
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
    def plain(self, language="en"):
        history = SimpleNamespace(sequence=(1.0,) * 3, collapsed_at_s=None)
        summary = {"settled_psi": 1.2, "max_crack_width_mm": 0.9, "evidence": {}}
        row = {"settled_crack_width_mm": 0.2, "residual_crack_width_mm": 0.5, "pgv_m_s": 0.04}
        return plain(history, summary, row, language)

    def test_what_is_left_what_was_added_and_the_velocity(self):
        found = self.plain()
        assert "shaken 3 times" in found[0] and "40 mm/s" in found[0]
        assert "0.5 mm is left, of which 0.3 mm" in found[3]

    def test_numbers_in_dutch_have_a_comma(self):
        assert "0,5 mm blijft over, waarvan 0,3 mm" in self.plain("nl")[3]

    def test_it_is_in_the_page(self, one, page_of_one):
        assert "In short" in page_of_one.text
        assert "In het kort" in Page(page([one.path], [], Heading(language="nl"))).text


class TestOneRun:
    def test_lines_over_time_are_those_of_the_history(self, one, page_of_one):
        drawn = page_of_one.data["runs"][0]
        arrays = unpack_arrays(drawn)
        series = one.series
        expected = {
            "time_s": series["time_s"],
            "drift_ratio": series["drift_ratio"],
            "base_shear_kn": series["base_shear_n"] / 1e3,
            **{name: one.index()[name] for name in ("DI", "DI_drift", "DI_open", "DI_slip")},
        }
        for name, values in (expected | energy_groups(series)).items():
            assert np.array_equal(arrays[name], np.asarray(values).astype("f4"), equal_nan=True), (
                name
            )
        assert drawn["settling"] == [[series["time_s"].iloc[16], series["time_s"].iloc[20]]]

    def test_joints_are_in_the_states_of_the_history(self, one, page_of_one):
        arrays = unpack_arrays(page_of_one.data["runs"][0])
        states = arrays["state"].reshape(len(arrays["instant"]), -1)
        ever = [2, 3, 4]  # all others stay whole
        assert np.array_equal(
            states, [joint_states(one, sample)[ever] for sample in arrays["instant"]]
        )
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
        assert places.shape[1] == len(one.bodies) + len(arrays["support_x"]) == len(one.bodies) + 1

    def test_where_anything_is_largest_is_among_the_instants(self, one, page_of_one):
        instants = set(unpack_arrays(page_of_one.data["runs"][0])["instant"])
        drift = one.series["drift_ratio"]
        assert {
            0,
            20,
            int(one.index()["DI"].idxmax()),
            int(drift.idxmax()),
            int(drift.idxmin()),
        } <= instants


class TestNothingElse:
    FETCHED = re.compile(
        r"""(?:src|href|action|data|poster)\s*=\s*["']?\s*(?!data:|#)[^"'\s>]|url\(|@import|fetch\(|"""
        r"XMLHttpRequest|import\(|sendBeacon|WebSocket",
        re.IGNORECASE,
    )

    def test_nothing_is_fetched(self, one):
        text = page([one.path], [])
        assert [found[0] for found in self.FETCHED.finditer(text)] == []
        policy = Page(text).all("meta")[2]["content"]
        # the browser holds the library to it
        assert "default-src 'none'" in policy and "connect-src" not in policy


class TestSaidFirst:
    @pytest.mark.parametrize(
        ("options", "words"),
        [
            ({"status": "interrupted"}, "interrupted at 0.200 s"),
            ({"status": "failed"}, "do not rely"),
            ({"status": "unfinished"}, "without an end"),
            ({"collapsed_at_s": 0.15}, "collapsed at 0.150 s"),
            ({"row": {"input_energy_j": np.linspace(0, 9, 21)}}, "energy balance error"),
        ],
    )
    def test_a_run_that_is_not_whole_or_odd_says_so_at_the_top(self, tmp_path, options, words):
        history = damaged(tmp_path / "odd.h5", **options)
        text = page([history.path], [])
        assert words in text
        assert text.index(words) < text.index("<main")


class TestSideBySide:
    def test_differences_are_from_the_first(self, one, tmp_path):
        other = damaged(tmp_path / "two.h5", opening={2: 1e-3 * RAMP, 5: 1e-3 * RAMP})
        parsed = Page(page([one.path, other.path], []))
        assert [run["letter"] for run in parsed.data["runs"]] == ["A", "B"]
        difference = summarise(other)["max"]["DI"] - summarise(one)["max"]["DI"]
        assert difference > 0
        assert repr(difference) in [data["value"] for data in parsed.all("data")]


class TestStudy:
    @pytest.fixture
    def study(self, tmp_path):
        folder = tmp_path / "mine"
        return make_study(
            folder,
            damaged(folder / "runs" / "a.h5"),
            damaged(folder / "runs" / "b.h5", opening={2: 2e-4 * RAMP}),
        )

    def test_points_are_marks_over_intensity_and_rows(self, study):
        text = page([], [study])
        parsed = Page(text)
        points = read_table(study / "tables" / "points.csv")
        values = {float(cell["data-sort"]) for cell in parsed.all("td") if "data-sort" in cell}
        assert set(points["max_DI"]) <= values and "a study" in parsed.text
        shown = {one.get("id") for one in parsed.all("article")}
        links = [one["href"][1:] for one in parsed.all("a") if "#point" in one["href"]]
        # a mark in both charts and a row, and the wall of the largest DI; each opens its wall
        assert sorted(links) == 4 * ["point-1-0"] + 3 * ["point-1-1"] and set(links) <= shown
        assert parsed.text.count("one run a point") == 2 and "the median" not in parsed.text
        assert "maximum DI" in parsed.text and column_words("mode_i_fracture_energy_j_m2") == (
            "mode i fracture energy [J/m2]"
        )
        assert len(text.encode()) < 1e6

    def test_colours_and_marks_show_what_varies(self):
        one = ["Small wall"]
        own = {"lintel": ["none", "elastic"], "cohesion_pa": list("123456789")}
        alike = {"wall": one, "solver": ["reference", "yade"], "motion": ["harmonic, 0.2 s"]}
        assert axes(alike) == ["wall", "wall"]
        assert axes(alike | own) == ["lintel", "cohesion_pa"]
        assert axes(alike | own | {"motion": ["a", "b"]}) == ["lintel", "motion"]
        assert axes(alike | {"motion": ["a", "b"]}) == ["motion", "motion"]

    def test_places_are_to_scale(self):
        table = pd.DataFrame(
            {
                "wall": ["one", "two", "one"],
                "solver": "reference",
                "record": ["BGAR_HGE", "BGAR_HGE", None],
                "scale": [2.0, 2.0, np.nan],
                "motion_period_s": [np.nan, np.nan, 0.2],
                "amplitude_g": [np.nan, np.nan, 0.1],
                "lintel": ["none", "none", "elastic"],
                "pgv_m_s": [0.05, 0.1, 0.1],
                "max_DI": [0.2, 0.4, 0.1],
                "max_DI_max": [0.4, 0.4, 0.1],
                "residual_DI": [0.0, 0.2, np.nan],
            }
        )
        _, of = labels(table)
        first, second = charts(table, list(zip(*of.values())))
        (x0, y0, _, high), (x1, y1, *_), _ = first["dots"]
        assert x0 - LEFT == pytest.approx((x1 - LEFT) / 2, abs=0.1) and high == y1
        assert TALL - BELOW - y0 == pytest.approx((TALL - BELOW - y1) / 2, abs=0.1)
        assert second["dots"][2] is None

    def test_a_history_that_is_damaged_is_said_first_and_the_others_are_shown(self, study):
        (study / "runs" / "a.h5").write_bytes((study / "runs" / "a.h5").read_bytes()[:-99])
        parsed = Page(page([], [study]))
        assert "cannot be read" in parsed.text and "a.h5" in parsed.text
        assert len({one["src"] for one in parsed.all("img")}) == 1

    def test_fragility_has_the_intensity_and_states_of_the_study(self, study, monkeypatch):
        asked = []

        def fit(runs, intensity, replicates, states):
            asked.append((intensity, states))
            return {}

        monkeypatch.setattr(study_part, "fit_all", fit)
        path = study / "tables" / "summary.csv"
        drawn = {"strength_cov": 0.3, "strength_seed": 1, "pga_g": 0.1, "pgv_m_s": 0.02}
        write_table(read_table(path).assign(record="r", **drawn), path)
        choices = 'intensity = "pgv_m_s"\nstates = ["moderate: max_psi > 2"]\n'
        (study / "study.toml").write_text((study / "study.toml").read_text() + choices)
        page([], [study])
        ((intensity, (state,)),) = asked
        assert (intensity, state.name, state.level) == ("pgv_m_s", "moderate", 2)


class TestEscaping:
    EVIL = "</script><script>alert(1)</script><img src=x onerror=alert(1)>\"'&"

    def test_texts_of_files_are_no_html(self, tmp_path):
        path = tmp_path / "<b>&amp;'.h5"
        folder = make_study(tmp_path / "<i>study", damaged(path))
        for name in ("points.csv", "summary.csv"):
            table = read_table(folder / "tables" / name)
            write_table(
                table.assign(point=self.EVIL, motion=self.EVIL, status=self.EVIL, wall=self.EVIL),
                folder / "tables" / name,
            )
        (folder / "study.toml").write_text(
            f"name = '''{self.EVIL[:-3]}'''\ntitle = '''{self.EVIL[:-2]}'''\n"
        )
        parsed = Page(page([path], [folder]))
        assert len(parsed.scripts) == 3
        assert not [one for one in parsed.all("img") if "onerror" in one]
        assert not parsed.all("b") and not parsed.all("i")
        assert self.EVIL in parsed.text and "<b>&amp;'.h5" in parsed.text


def test_a_history_s_numbers_are_equal_in_json_table_point_report_and_verdict(
    one, tmp_path, output_of
):
    parsed = json.loads(output_of("index", one.path, "--json"))
    flat = {
        f"{kind}_{name}": value
        for kind, values in parsed.items()
        if isinstance(values, dict)
        for name, value in values.items()
    } | parsed
    folder = make_study(tmp_path, one)
    row, point = (
        read_table(folder / "tables" / f"{name}.csv").iloc[0] for name in ("summary", "points")
    )
    as_evidence = Point(load_runs(folder), "the run")
    cell = (
        r'<th scope="row"><code>(.*?)</code></th><td>[^<]*</td><td class="number"><data'
        r' value="(.*?)">'
    )
    shown = {
        name.replace("<wbr>", ""): float(value)
        for name, value in re.findall(cell, page([one.path], []))
    }
    asked = {"threshold_mm", "drift_limit_pct"}
    numbers = {
        name: value
        for name, value in flat.items()
        if isinstance(value, float) and name not in asked
    }
    assert {
        "max_DI",
        "residual_shear_limit_DI",
        "max_drift_ratio",
        "residual_drift_ratio",
        "max_crack_width_mm",
        "residual_psi",
        "elastic_joint_share",
    } <= set(numbers)
    for name, value in numbers.items():
        assert name.startswith(OTHER_CRITERIA) or shown[name] == value, name
        for other in (row[name], point[name], as_evidence.plain(name)):
            # tables have nine digits
            assert other == pytest.approx(value, rel=1e-8, abs=1e-12), name
