"""What pyarrow and xarray read of a study's tables, as JSON: python read_tables.py DIR FILE.nc.

{kind: {table: {"columns": {name: list}, "described": {name: [unit, meaning]}}}}.
"""

import json
import sys
from pathlib import Path

import pyarrow.parquet
import xarray

found = {"parquet": {}, "netcdf": {}}
for name in ("runs", "points"):
    table = pyarrow.parquet.read_table(Path(sys.argv[1]) / f"{name}.parquet")
    described = {field.name: [(field.metadata or {}).get(key, b"").decode() for key in (b"unit", b"meaning")]
            for field in table.schema}
    found["parquet"][name] = {"columns": table.to_pydict(), "described": described}
    with xarray.open_dataset(sys.argv[2], group=name, engine="h5netcdf") as data:
        assert set(data.sizes) == {name}
        found["netcdf"][name] = {
            "columns": {one: data[one].values.tolist() for one in data},
            "described": {one: [data[one].attrs.get(key, "") for key in ("unit", "meaning")] for one in data}}
print(json.dumps(found))
