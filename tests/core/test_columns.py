"""Columns of tables and datasets of histories: each named once, with unit and meaning, and so in
the documents."""

import h5py
import pandas as pd
import pytest
from conftest import one_line_error

from damage.applications.studies.fragility import LEVELS, load_runs
from damage.applications.studies.read import check_names
from damage.applications.studies.tables import points_of
from damage.history.schema import HOUSE, PLACING, TABLES, Column, each, measure
from damage.measure import columns
from damage.measure.summary import MEASURES
from damage.measure.tables import summary_row

SUMMARY = {
    "parameters": columns.PARAMETERS,
    "run": columns.RUN,
    "made by": columns.MADE_BY,
    **MEASURES,
}


def test_a_summary_has_these_columns_and_no_others(still_history):
    row = summary_row(still_history)
    known = [name for table in SUMMARY.values() for name in each(table)]
    assert sorted(row) == sorted(known) and len(known) == len(set(known)) > 60


ONE = {"length_m": Column("m", "")}
TWO = {"first_s, last_s": Column("s", "")}


def test_a_measure_gives_its_values_by_name():
    assert measure(ONE)(lambda history: 3.0)(None) == {"length_m": 3.0}
    assert measure(TWO)(lambda history: (1.0, 2.0))(None) == {"first_s": 1.0, "last_s": 2.0}
    assert measure(TWO)(lambda history: None)(None) == {"first_s": None, "last_s": None}
    with pytest.raises(ValueError, match="zip"):
        measure(TWO)(lambda history: (1.0, 2.0, 3.0))(None)


def test_a_point_has_the_range_of_what_its_runs_do_not_share(still_history):
    """Motions of lives differ so, whose first one the row had."""
    row = summary_row(still_history)
    (point,) = points_of(
        pd.DataFrame(
            [
                row | {"pgv_m_s": pgv, "record": record, "point": "p"}
                for pgv, record in ((0.01, "A"), (0.05, "B"), (0.02, "B"))
            ]
        )
    ).to_dict("records")
    assert [point[f"pgv_m_s{end}"] for end in ("", "_min", "_max")] == [0.02, 0.01, 0.05]
    assert point["record"] is None and point["wall"] == row["wall"] and "scale_min" not in point


def test_a_history_has_these_datasets_with_their_units(still_history):
    of_some_runs = {
        "snapshots/out_of_plane",
        "stresses/joint_stress_pa",
        *(f"placing/{name}" for name in PLACING),
        *(f"house/{name}" for name in HOUSE),
    }
    with h5py.File(still_history.path) as file:
        for group, table in TABLES.items():
            assert {name: data.attrs["unit"] for name, data in file.get(group, {}).items()} == {
                name: column.unit
                for name, column in table.items()
                if f"{group}/{name}" not in of_some_runs
            }


@pytest.mark.parametrize("column", ["run", "wall"])
@pytest.mark.parametrize("name", ["../../elsewhere", "/etc/x", "a\x01b", "a\x9bb"])
def test_a_name_that_would_lead_elsewhere_or_spoil_a_file_is_refused(column, name, tmp_path):
    """Pictures and curves are named after walls, histories are looked for by runs' names."""
    table = pd.DataFrame({"run": ["r"], "point": ["p"], "wall": ["w"], column: [name]})
    said = f"summary.csv: {column} {name!r}: expected a name without slashes"
    assert said in one_line_error(check_names, table, "summary.csv")
    runs = {
        "strength_cov": [0.3],
        "strength_seed": [1],
        "pga_g": [0.1],
        "status": ["complete"],
        "record": ["x"],
        "collapsed_at_s": [""],
        **{level: [0.1] for level in LEVELS},
    }
    (tmp_path / "tables").mkdir()
    table.assign(**runs).to_csv(tmp_path / "tables" / "summary.csv", index=False)
    assert said in one_line_error(load_runs, tmp_path)
