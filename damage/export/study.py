"""Tables of a study for other programs: Parquet, and netCDF by xarray, each column with its unit and meaning.

Both need libraries that the package does not: `pip install masonry-damage[parquet]` brings pyarrow, `[netcdf]` xarray
and h5netcdf.  The tables are those that the study's own folder holds, tables/summary.csv (runs) and tables/points.csv.
"""

from pathlib import Path

from damage.errors import InputError
from damage.export.dictionary import MEMBERS, POINTS, RUNS
from damage.files import whole_or_nothing
from damage.measure.columns import read_table

TABLES = {"runs": ("summary.csv", RUNS | MEMBERS), "points": ("points.csv", POINTS)}
"""Name of a table: its file in a study's folder, and what its columns are."""


def study_tables(folder):
    """{name: DataFrame} of a study's folder; words are strings, numbers floats or integers, as they were read.

    Raises InputError where the folder holds no tables.
    """
    paths = {name: Path(folder) / "tables" / file for name, (file, _) in TABLES.items()}
    if not all(path.is_file() for path in paths.values()):
        raise InputError(f"{folder} holds no tables/summary.csv and tables/points.csv; expected the folder of a study, "
                         "run one with ./run_all.sh, or give a history with --vtkhdf")
    return {name: _tidy(read_table(path), TABLES[name][1]) for name, path in paths.items()}


def _tidy(table, columns):
    """Columns that are words as such, empty where missing; others, empty ones included, as numbers."""
    words = [name for name in table if table[name].dtype == object
             or (name in columns and not columns[name].unit and table[name].isna().all())]
    return table.assign(**{name: table[name].astype(object).fillna("").astype(str) for name in words})


def _attributes_of(name, columns):
    """{unit, meaning} of a column, as attributes of a file; empty of one that is not known."""
    return {"unit": columns[name].unit, "meaning": columns[name].meaning} if name in columns else {}


def write_parquet(folder, out):
    """Write OUT/runs.parquet and OUT/points.parquet of a study's folder, unit and meaning in the columns' metadata;
    returns their paths."""
    import pyarrow
    import pyarrow.parquet

    paths = []
    for name, frame in study_tables(folder).items():
        table = pyarrow.Table.from_pandas(frame, preserve_index=False)
        fields = [field.with_metadata(_attributes_of(field.name, TABLES[name][1])) for field in table.schema]
        table = table.cast(pyarrow.schema(fields, metadata=table.schema.metadata))
        paths.append(Path(out) / f"{name}.parquet")
        with whole_or_nothing(paths[-1]) as unfinished:
            pyarrow.parquet.write_table(table, unfinished)
    return paths


def write_netcdf(folder, path):
    """Write the tables of a study's folder as one netCDF-4 file, groups `runs` and `points`, each of a dimension of
    that name, unit and meaning in the variables' attributes; returns the path."""
    import h5netcdf  # noqa: F401, by it xarray writes groups
    import xarray

    with whole_or_nothing(path) as unfinished:
        for number, (name, frame) in enumerate(study_tables(folder).items()):
            data = xarray.Dataset({column: (name, values.to_numpy(), _attributes_of(column, TABLES[name][1]))
                                   for column, values in frame.items()})
            data.to_netcdf(unfinished, mode="a" if number else "w", group=name, engine="h5netcdf")
    return Path(path)
