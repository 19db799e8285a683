"""Columns of the tables at an address, of `damage/data/groningen/columns.csv`."""

import pandas as pd

from damage.fields import Column
from damage.files import DATA

TABLES = {
    table: {row.column: Column(row.unit, row.meaning) for row in rows.itertuples()}
    for table, rows in pd.read_csv(
        DATA / "groningen" / "columns.csv", keep_default_na=False
    ).groupby("table", sort=False)
}
"""{name of a table: {column: Column}}."""
