"""Grids and ensembles of studies: what a file asks for, and the tables of points."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from conftest import REPOSITORY, one_line_error, written
from numpy.testing import assert_allclose

from damage.applications.studies.definition import StudyRun, load_study
from damage.applications.studies.grid import expand
from damage.applications.studies.tables import points_of

WALL = 'wall = "walls/symmetric.py"\n'
BGAR = "damage/data/zeerijp_20180108/BGAR_HGE_acc_m_s2.csv"


def write_study(folder, text):
    return written(folder / "study.toml", f'name = "s"\npictures = "none"\n{text}')


class TestGrid:
    def test_every_combination_the_last_name_fastest(self):
        grid = {
            "wall": "{w}.py",
            "options": {"harmonic": ["{t}", 0.1], "x": "a{t}"},
            "vary": {"w": ["a", "b"], "t": [1, 2.5]},
        }
        tables = expand(grid)
        assert [(one["wall"], one["options"]["harmonic"]) for one in tables] == [
            ("a.py", [1, 0.1]),
            ("a.py", [2.5, 0.1]),
            ("b.py", [1, 0.1]),
            ("b.py", [2.5, 0.1]),
        ]
        assert tables[1]["options"]["x"] == "a2.5" and "vary" not in tables[0]

    def test_a_range_has_both_ends(self):
        grid = {"wall": "{w}.py", "vary": {"w": {"from": 2, "to": 4}}}
        assert [one["wall"] for one in expand(grid)] == ["2.py", "3.py", "4.py"]

    def test_rows_of_a_file_go_with_every_value_of_vary(self, tmp_path):
        (tmp_path / "list.csv").write_text(
            f"record,start,end,scale\n{BGAR},18,19,2\n{BGAR},18.5,20,0.5\n\n"
        )
        study = load_study(
            write_study(
                tmp_path,
                '[[grid]]\nwall = "walls/{wall}.py"\nrows = "list.csv"\nvary = { wall = ["solid",'
                ' "symmetric"] }\noptions = { record = "{record}", window = ["{start}", "{end}"],'
                ' scale = "{scale}" }\n',
            ),
            "reference",
        )
        assert [(run.wall, *run.options[1:]) for run in study.runs] == [
            (f"walls/{wall}.py", ("window", window), ("scale", scale))
            for window, scale in (((18, 19), 2), ((18.5, 20), 0.5))
            for wall in ("solid", "symmetric")
        ]

    @pytest.mark.parametrize(
        ("table", "vary", "message"),
        [
            (None, "", "no file list.csv"),
            ("a\n", "", "has a header and no row"),
            ("a,b\n1,2\n", "", "'b', which nothing uses"),
            ("a\n1\n2,3\n", "", "line 3: 2 cells; expected 1"),
            ("a,a\n1,2\n", "", "a column twice"),
            ("a,b\n1,\n", "", "no b; expected it in every row"),
            ("a\n1\n", "vary = { a = [1] }\n", "both name 'a'"),
            (b"a\n\xff\n", "", "cannot be read as text"),
        ],
        ids=str,
    )
    def test_bad_rows_are_refused_in_one_line(self, tmp_path, table, vary, message):
        if table is not None:
            (tmp_path / "list.csv").write_bytes(
                table if isinstance(table, bytes) else table.encode()
            )
        grid = (
            f'[[grid]]\n{WALL}rows = "list.csv"\n{vary}options = {{ harmonic = [0.2, 0.05], rest ='
            ' "{a}" }\n'
        )
        assert message in one_line_error(load_study, write_study(tmp_path, grid), "reference")


def test_the_shipped_harmonic_is_the_papers_matrix():
    runs = load_study(REPOSITORY / "studies" / "harmonic.toml", "reference").runs
    assert {(run.wall, *run.options[0][1]) for run in runs} == {
        (f"walls/{wall}.py", period, amplitude)
        for wall in ("solid", "symmetric", "asymmetric")
        for period in (0.06, 0.2, 0.33, 1.0)
        for amplitude in (0.01, 0.025, 0.05, 0.075, 0.1)
    }
    assert {(run.members, run.adaptive, run.varied) for run in runs} == {(5, True, "seed")}


class TestTables:
    def test_a_point_is_the_median_of_its_runs_with_their_range(self):
        runs = pd.DataFrame(
            {
                "run": list("abcd"),
                "point": ["p", "p", "p", "q"],
                "solver": "reference",
                "wall": "w",
                "status": "complete",
                "collapsed_at_s": [None, 1.0, None, 2.0],
                "seed": [1, 2, 3, 1],
                "max_DI": [0.1, 0.5, 0.2, 0.7],
                "drift_class": ["a", "b", "b", "c"],
            }
        )
        points = points_of(runs).set_index("point")
        assert_allclose(
            points.loc["p", ["max_DI", "max_DI_min", "max_DI_max"]].astype(float), [0.2, 0.1, 0.5]
        )
        assert points.loc["p", "drift_class"] == "b" and list(points["members"]) == [3, 1]
        assert list(points["collapsed"]) == [1, 1]
        assert_allclose(points["collapsed_at_s"].astype(float), [np.nan, 2.0])
        assert "seed" not in points


@pytest.mark.parametrize(
    ("intact", "spread", "needed"), [(False, 0.01, 5), (False, 0.5, 10), (True, 0.0, 1)]
)
def test_an_ensemble_doubles_where_its_first_members_spread_and_ends_with_one_where_nothing_breaks(
    intact, spread, needed
):
    run = StudyRun("a", "w.py", (), "reference", ("--seed",), 5, adaptive=True)
    records = {}
    counts = []
    for number in range(1, 6):
        counts.append(run.runs_needed(records))
        row = {"max_DI": 0.1, "max_drift_ratio": 1e-3 * (1 + spread * (number == 3))}
        records[number] = {"intact": intact, "row": row}
    assert counts == [1] + 4 * [1 if intact else 5] and run.runs_needed(records) == needed
    assert replace(run, adaptive=False).runs_needed({}) == 5
