"""Measures with their columns on their functions: what the decorator makes of a function, and the sections."""

import pytest
from small_history import make_history

from damage.history.schema import Column
from damage.measure import summary
from damage.measure.register import measure, names

ONE, TWO = {"length_m": Column("m", "")}, {"first_s, last_s": Column("s", "")}


def test_a_function_gives_its_values_by_name():
    assert measure(ONE)(lambda history: 3.0)(None) == {"length_m": 3.0}
    assert measure(TWO)(lambda history: (1.0, 2.0))(None) == {"first_s": 1.0, "last_s": 2.0}
    assert measure(TWO)(lambda history: None)(None) == {"first_s": None, "last_s": None}
    with pytest.raises(ValueError, match="zip"):
        measure(TWO)(lambda history: (1.0, 2.0, 3.0))(None)


def test_columns_are_named_once():
    every = [name for columns in summary.MEASURES.values() for name in names(columns)]
    assert len(every) == len(set(every)) > 60


def test_a_measure_is_asked_for_what_its_arguments_are_called(tmp_path, monkeypatch):
    """The threshold of the index, and the measures of a section before."""
    @measure({"drift_over_threshold": Column("1", "")})
    def ratio(max_drift_ratio, threshold):
        return max_drift_ratio / threshold

    monkeypatch.setitem(summary.REGISTER, "Ratios", [ratio])
    found = summary.summarise(make_history(tmp_path / "a.h5"), threshold=5e-4)
    assert found["drift_over_threshold"] == found["max_drift_ratio"] / 5e-4
