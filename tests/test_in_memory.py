"""A history in memory is the one that its file would be, and becomes that file where it has to."""

from dataclasses import fields

import numpy as np
import pandas as pd
import pytest
from small_history import make_history

from damage.history import in_memory
from damage.history.in_memory import HistoryInMemory
from damage.history.reader import read_history
from damage.studies.records import record_of

TOLD = {  # several chunks of samples, with joints that are told of in one alone; minus zero is a number of its own
    "stages": ("motion",) * 200 + ("rest",) * 60 + ("settling",) * 20,
    "opening": {3: np.where(np.arange(280) < 50, 0.0, 2e-4)}, "slip": {5: np.linspace(0.0, 3e-4, 280), 7: -0.0},
    "broken": [9], "drift": np.linspace(0.0, 1e-3, 280), "collapsed_at_s": 2.0,
}


def differences(one, other):
    """Names of the fields of two histories that differ in any bit, but for when they were made."""
    def differ(a, b):
        if isinstance(a, pd.DataFrame):
            return not a.equals(b) or list(a.dtypes) != list(b.dtypes)
        if isinstance(a, np.ndarray):
            return a.dtype != b.dtype or a.shape != b.shape or a.tobytes() != b.tobytes()
        if isinstance(a, dict):
            return a.keys() != b.keys() or any(differ(a[name], b[name]) for name in a.keys() - {"created_utc"})
        return a != b and not (a != a and b != b)

    return [field.name for field in fields(one) if field.name != "path" and differ(
        getattr(one, field.name), getattr(other, field.name))]


def test_it_is_what_would_be_read_and_leaves_no_file(tmp_path):
    written = make_history(tmp_path / "a.h5", **TOLD)
    kept = make_history(tmp_path / "b.h5", **TOLD, write=HistoryInMemory)
    assert written.broken.any() and np.signbit(written.slip_m[:, 7]).all() and len(written.snapshot_time_s) == 56
    assert differences(written, kept) == [] and not (tmp_path / "b.h5").exists()
    assert record_of(kept, "run", "point") == record_of(written, "run", "point")
    assert differences(written, make_history(tmp_path / "c.h5", **TOLD | {"drift": 0.0}, write=HistoryInMemory)) == [
        "series"]


@pytest.mark.parametrize("most_bytes", [0, 6000])
def test_one_that_grows_too_large_goes_on_in_its_file(most_bytes, tmp_path, monkeypatch):
    written = make_history(tmp_path / "a.h5", **TOLD)
    monkeypatch.setattr(in_memory, "MOST_BYTES", most_bytes)
    kept = make_history(tmp_path / "b.h5", **TOLD, write=HistoryInMemory)
    assert (tmp_path / "b.h5").exists() and differences(written, kept) == []


@pytest.mark.parametrize("status", ["failed", "interrupted"])
def test_a_run_without_an_end_leaves_its_file(status, tmp_path):
    written = make_history(tmp_path / "a.h5", **TOLD | {"status": status})
    make_history(tmp_path / "b.h5", **TOLD | {"status": status}, write=HistoryInMemory)
    assert differences(written, read_history(tmp_path / "b.h5")) == []


def test_one_without_samples_is_read_as_its_file_is(tmp_path):
    written = make_history(tmp_path / "a.h5", stages=(), snapshots={})
    assert differences(written, make_history(tmp_path / "b.h5", stages=(), snapshots={}, write=HistoryInMemory)) == []
