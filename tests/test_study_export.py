"""Tables of a study as Parquet and netCDF: both libraries read back what stands in the CSV (long)."""

import json

import pandas as pd
import pytest
from conftest import one_line_error, run_command
from environments import environment, run_in
from small_history import make_history

from damage.__main__ import main
from damage.export.study import study_tables
from damage.measure.tables import summary_row, write_table
from damage.studies.tables import points_of


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Two runs, one that opens and one that does not."""
    folder = tmp_path_factory.mktemp("study")
    rows = [summary_row(make_history(folder / f"{name}.h5", opening=opening), run=name, point="p")
            for name, opening in (("a", {3: 5e-4}), ("b", None))]
    summary = pd.DataFrame(rows).assign(members=2)
    write_table(summary, folder / "tables/summary.csv")
    write_table(points_of(summary), folder / "tables/points.csv")
    return folder


def test_words_are_words_and_numbers_are_numbers(folder):
    runs = study_tables(folder)["runs"]
    assert list(runs["run"]) == ["a", "b"] and runs["lintel"].map(type).eq(str).all()
    assert runs["max_DI"].dtype == float and runs["collapsed_at_s"].dtype == float  # though no wall fell
    assert runs["record"].eq("").all()  # a harmonic motion has none
    assert not [name for name in runs if runs[name].map(type).nunique() > 1]


def test_a_folder_without_tables_is_refused(tmp_path):
    assert "expected the folder of a study" in one_line_error(study_tables, tmp_path)


@pytest.mark.parametrize("option, library", [("--parquet", "pyarrow"), ("--netcdf", "h5netcdf")])
def test_a_missing_library_is_one_line(folder, tmp_path, capsys, monkeypatch, option, library):
    monkeypatch.setitem(__import__("sys").modules, library, None)
    assert main(["export", str(folder), option, str(tmp_path / "out")]) == 3
    assert f"cannot import {library}: expected " in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


@pytest.mark.long
def test_both_libraries_read_what_stands_in_the_csv(folder, tmp_path):
    with environment("pyarrow", "xarray", "h5netcdf", needs=("numpy", "pandas", "scipy", "h5py", "matplotlib",
                                                             "numba", "packaging")) as python:
        run_command(python, "-m", "damage", "export", folder, "--parquet", tmp_path, "--netcdf", tmp_path / "s.nc",
                    status=0)
        found = json.loads(run_in(python, "read_tables.py", tmp_path, tmp_path / "s.nc"))
    for kind in found.values():
        for name, table in study_tables(folder).items():
            pd.testing.assert_frame_equal(pd.DataFrame(kind[name]["columns"]), table, check_dtype=False)
        assert kind["runs"]["described"]["max_crack_width_mm"][0] == "mm"
        assert "median of the runs" in kind["points"]["described"]["max_DI"][1]
