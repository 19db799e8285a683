"""The data dictionary that ships is that of the code, with the tables of all applications."""

from conftest import REPOSITORY

from damage.commands.table import all_tables
from damage.measure.dictionary import TABLES, write_dictionary


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
