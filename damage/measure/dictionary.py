"""The data dictionary: every column of every table that this software writes, with unit and
meaning; here those of single runs, beside which applications register theirs
(`damage.commands.table.tables`).

`python3 -m damage dictionary --out docs/reference` writes dictionary.csv.
"""

from pathlib import Path

import pandas as pd

from damage.history.schema import TABLES as HISTORY
from damage.measure.tables import HOUSE_TABLES, RUN_TABLES, write_table

TABLES = {
    **{f"RUN_{name}.csv": columns for name, (_, columns) in (RUN_TABLES | HOUSE_TABLES).items()},
    **{f"RUN.h5 {group}": columns for group, columns in HISTORY.items()},
}
"""{tables of single runs, as their files are called: {column: Column}}."""


def dictionary_table(tables):
    """A DataFrame with a row a column of tables, which are as TABLES: table, column, unit ("" of
    words), meaning."""
    rows = [
        (table, name, column.unit, column.meaning)
        for table, columns in tables.items()
        for name, column in columns.items()
    ]
    return pd.DataFrame(rows, columns=["table", "column", "unit", "meaning"])


def write_dictionary(tables, folder):
    """Write dictionary.csv of tables, which are as TABLES, into a folder; returns its path."""
    return write_table(dictionary_table(tables), Path(folder) / "dictionary.csv")
