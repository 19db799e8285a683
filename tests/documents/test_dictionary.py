"""The data dictionary that ships is that of the code; columns that are written are in it."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from conftest import REPOSITORY
from small_history import make_history
from test_fragility import walls

from damage.applications.studies.curves import coefficients
from damage.applications.studies.fragility import at_intensities, fit_all, fragility_table
from damage.applications.studies.tables import points_of
from damage.commands.table import all_tables
from damage.measure.dictionary import TABLES, write_dictionary
from damage.measure.tables import RUN_TABLES, summary_row


def test_the_shipped_one_is_current_and_has_the_tables_of_applications(tmp_path):
    """python3 -m damage dictionary --out docs/reference."""
    path = write_dictionary(all_tables(), tmp_path)
    assert path.read_text() == (REPOSITORY / "docs/reference/dictionary.csv").read_text()
    names = {name.split(",")[0] for name in all_tables().keys() - TABLES.keys()}
    assert names >= {
        "crack files",
        "points.csv",
        "fragility_coefficients.csv",
        "exposure.csv",
        "lives.csv",
    }


def known(table):
    """{column: Column} of a table, by the first of its names."""
    return next(columns for name, columns in all_tables().items() if name.split(",")[0] == table)


@pytest.fixture(scope="module")
def history(tmp_path_factory):
    made = make_history(tmp_path_factory.mktemp("dictionary") / "a.h5", opening={3: 2e-3})
    return replace(
        made,
        joint_stress_pa=np.full((len(made.series), len(made.joints), 2), -1e5),
    )


@pytest.mark.parametrize("name", RUN_TABLES)
def test_tables_of_a_run(history, name):
    assert set(RUN_TABLES[name][0](history)) == set(known(f"RUN_{name}.csv"))


def test_tables_of_a_study(history):
    row = summary_row(history)
    columns = known("summary.csv")
    assert {*row, "members"} == set(columns)
    # two runs that differ in each number: all have their NAME_min
    numbers = [name for name in row if columns[name].unit]
    runs = pd.DataFrame([row | dict.fromkeys(numbers, value) for value in (1.0, 2.0)])
    assert set(points_of(runs)) == set(known("points.csv"))


def test_tables_of_fragility():
    fits = fit_all(walls(10, seed=1), "pga_g", replicates=2)
    curves = fragility_table(fits).assign(slip="displacement")
    assert set(curves) <= set(known("fragility_INTENSITY.csv"))
    assert set(coefficients(fits)) == set(known("fragility_coefficients.csv"))
    assert set(at_intensities(fits, [0.1])) == set(known("fragility_INTENSITY_at.csv"))
