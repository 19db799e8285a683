"""The kept predictions of tested walls."""

import hashlib
from pathlib import Path

import pandas as pd

TABLES = Path(__file__).resolve().parents[2] / "docs" / "tables"


def test_predictions_are_those_that_were_committed():
    names = "us2_later", "shear_walls", "walls_elsewhere", "us2"
    for path in (TABLES / f"{name}_prediction.csv" for name in names):
        digest, name = path.with_suffix(".sha256").read_text().split()
        assert name == path.name and digest == hashlib.sha256(path.read_bytes()).hexdigest()
    table = pd.read_csv(path)
    assert list(table["run"]) == list(range(1, 26)) and table[
        table["run"].isin([3, 6, 8, 11])
    ].iloc[:, 1:].isna().all(axis=None)
