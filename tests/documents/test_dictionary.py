"""The data dictionary: every column of every table that the software writes is in it, with unit and
meaning."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from conftest import REPOSITORY
from small_history import make_history
from test_fragility import walls

from damage.applications.report.curves import coefficients
from damage.applications.studies.fragility import (
    at_intensities,
    fit_all,
    fragility_table,
)
from damage.applications.studies.states import INTENSITIES
from damage.applications.studies.tables import points_of
from damage.commands.table import all_tables
from damage.measure.dictionary import TABLES, dictionary_table, write_dictionary
from damage.measure.tables import RUN_TABLES, summary_row, write_run_tables


@pytest.fixture(scope="module")
def history(tmp_path_factory):
    return make_history(
        tmp_path_factory.mktemp("dictionary") / "a.h5",
        opening={3: 2e-3},
        slip={5: 3e-3},
        drift=1e-3 * np.sin(np.arange(21)),
    )


def known(table):
    return set(
        next(columns for name, columns in all_tables().items() if name.split(",")[0] == table)
    )


@pytest.mark.parametrize("name", RUN_TABLES)
def test_tables_of_a_run(history, name):
    if name == "bricks":
        history = replace(
            history,
            stress_pa=np.zeros((1, len(history.bodies), 5, 3)),
            snapshot_time_s=history.snapshot_time_s[:1],
        )
    history = replace(
        history,
        joint_stress_pa=np.full((len(history.series), len(history.joints), 2), -1e5),
    )
    assert set(RUN_TABLES[name][0](history)) == known(f"RUN_{name}.csv")


def test_every_file_of_a_run_has_its_table(history, tmp_path):
    """No table is written that RUN_TABLES does not name."""
    names = {
        path.name.removeprefix("a_")
        for path in map(type(tmp_path), write_run_tables(history, tmp_path / "a"))
    }
    assert {name for name in names if name.endswith(".csv")} <= {
        f"{name}.csv" for name in RUN_TABLES
    }


def test_tables_of_a_study(history):
    runs = pd.DataFrame([summary_row(history)])
    assert set(runs) | {"members"} == known("summary.csv")
    # Numbers for each that is missing, and two that differ: then all have their NAME_min.
    numbers = [name for name in runs if name in _numbers()]
    full = runs.assign(**{name: runs[name].astype(float).fillna(1.0) for name in numbers})
    both = pd.concat([full, full.assign(**{name: full[name] + 1 for name in numbers})])
    assert set(points_of(both)) == known("points.csv")


def _numbers():
    table = dictionary_table(all_tables())
    return set(table[(table.table == "summary.csv") & (table.unit != "")].column)


@pytest.mark.parametrize("intensity", INTENSITIES)
def test_tables_of_fragility(intensity):
    runs = walls(10, seed=1)
    runs[intensity] = runs["pga_g"]
    fits = fit_all(runs, intensity, replicates=2)
    assert set(fragility_table(fits, intensity).assign(slip="displacement")) <= known(
        "fragility_INTENSITY.csv"
    )
    assert set(coefficients(fits)) == known("fragility_coefficients.csv")
    assert set(at_intensities(fits, [0.1])) == known("fragility_INTENSITY_at.csv")


def test_applications_register_their_tables():
    names = {name.split(",")[0] for name in all_tables().keys() - TABLES.keys()}
    assert names >= {
        "crack files",
        "points.csv",
        "fragility_coefficients.csv",
        "exposure.csv",
        "lives.csv",
    }


def test_the_shipped_one_is_current(tmp_path):
    """python3 -m damage dictionary --out docs/reference."""
    path = write_dictionary(all_tables(), tmp_path)
    assert path.read_text() == (REPOSITORY / "docs/reference/dictionary.csv").read_text()
