"""A history in memory is the one that its file would be, and becomes that file where it has to."""

from dataclasses import fields, replace

import numpy as np
import pandas as pd
import pytest
from small_history import make_history

from damage import read_history
from damage.applications.studies.records import record_of
from damage.history import in_memory
from damage.history.contacts import Contacts
from damage.history.in_memory import HistoryInMemory, HistoryKept
from damage.history.info import check
from damage.history.writer import HistoryWriter
from damage.index import damage_index
from damage.measure.tables import joints_table

# several chunks of samples, with contact points active in one alone; minus zero is a number of its
# own
CRACKED = {
    "stages": ("motion",) * 200 + ("rest",) * 60 + ("settling",) * 20,
    "opening": {3: np.where(np.arange(280) < 50, 0.0, 2e-4)},
    "slip": {5: np.linspace(0.0, 3e-4, 280), 7: -0.0},
    "broken": [9],
    "drift": np.linspace(0.0, 1e-3, 280),
    "collapsed_at_s": 2.0,
}

FRAMES = ("opening_m", "slip_m", "offset_m", "broken", "at_limit", "crushed")


def differences(one, other):
    """Names of the fields of two histories that differ in any bit, but for when they were made."""

    def differ(a, b):
        if isinstance(a, pd.DataFrame):
            return not a.equals(b) or list(a.dtypes) != list(b.dtypes)
        if isinstance(a, np.ndarray):
            return a.dtype != b.dtype or a.shape != b.shape or a.tobytes() != b.tobytes()
        if isinstance(a, Contacts):
            return any(map(differ, a, b))
        if isinstance(a, dict):
            return a.keys() != b.keys() or any(
                differ(a[name], b[name]) for name in a.keys() - {"created_utc"}
            )
        return a != b and not (a != a and b != b)

    return [
        field.name
        for field in fields(one)
        if field.name != "path" and differ(getattr(one, field.name), getattr(other, field.name))
    ]


def test_it_is_what_would_be_read_and_leaves_no_file(tmp_path):
    written = make_history(tmp_path / "a.h5", **CRACKED)
    kept = make_history(tmp_path / "b.h5", **CRACKED, write=HistoryInMemory)
    assert (
        written.broken.any()
        and np.signbit(written.slip_m[:, 7]).all()
        and len(written.snapshot_time_s) == 56
    )
    assert differences(written, kept) == [] and not (tmp_path / "b.h5").exists()
    assert record_of(kept, "run", "point") == record_of(written, "run", "point")
    assert differences(
        written, make_history(tmp_path / "c.h5", **CRACKED | {"drift": 0.0}, write=HistoryInMemory)
    ) == ["series"]


@pytest.mark.parametrize("most_bytes", [0, 6000])
def test_one_that_grows_too_large_goes_on_in_its_file(most_bytes, tmp_path, monkeypatch):
    written = make_history(tmp_path / "a.h5", **CRACKED)
    monkeypatch.setattr(in_memory, "MOST_BYTES", most_bytes)
    kept = make_history(tmp_path / "b.h5", **CRACKED, write=HistoryInMemory)
    assert (tmp_path / "b.h5").exists() and differences(written, kept) == []


def test_one_that_has_a_checkpoint_goes_on_in_its_file(tmp_path):
    """After a kill the checkpoint is of use with the rows of the file alone."""

    def checked(*given, **more):
        writer = HistoryInMemory(*given, **more)
        assert not any(writer.sink.rows())
        return writer

    written = make_history(tmp_path / "a.h5", **CRACKED)
    kept = make_history(tmp_path / "b.h5", **CRACKED, write=checked)
    assert (tmp_path / "b.h5").exists() and differences(written, kept) == []


@pytest.mark.parametrize("most_bytes", [0, 6000, in_memory.MOST_BYTES])
def test_one_that_is_kept_is_its_file_which_is_whole(most_bytes, tmp_path, monkeypatch):
    monkeypatch.setattr(in_memory, "MOST_BYTES", most_bytes)
    kept = make_history(tmp_path / "a.h5", **CRACKED, write=HistoryKept)
    read = read_history(tmp_path / "a.h5")
    assert differences(read, kept) == [] and dict(kept.attributes) == read.attributes
    assert check(tmp_path / "a.h5")["worth"] == "whole"
    assert record_of(kept, "run", "point") == record_of(read, "run", "point")


@pytest.mark.parametrize("write", [HistoryWriter, HistoryInMemory, HistoryKept])
def test_active_contacts_are_those_with_any_value(write, tmp_path):
    history = make_history(tmp_path / "a.h5", **CRACKED, write=write)
    active = history.active
    others = np.setdiff1d(np.arange(len(history.joints)), active.joints)
    # of the one that is broken alone no number asks
    assert set(active.joints) == {3, 5, 7} and len(others) > 0
    for name in ("opening_m", "slip_m", "offset_m", "at_limit"):
        frames = getattr(history, name)
        assert (
            np.array_equal(getattr(active, name), frames[:, active.joints])
            and not frames[:, others].any()
        )
    dense = damage_index(
        history.series["time_s"],
        history.series["drift_ratio"],
        history.opening_m,
        history.offset_m,
        history.at_limit,
        history.joint_length_m,
    )
    assert np.allclose(history.index().to_numpy(), dense.to_numpy(), rtol=1e-12, atol=0)


def test_whole_frames_are_made_when_they_are_asked_for_first(tmp_path):
    written = make_history(tmp_path / "a.h5", **CRACKED)
    kept = make_history(tmp_path / "b.h5", **CRACKED, write=HistoryInMemory)
    record = record_of(kept, "run", "point")
    joints_table(kept)
    assert not vars(kept).keys() & set(FRAMES) and not record["intact"]
    assert kept.broken is kept.broken and differences(written, kept) == []
    assert all(np.array_equal(getattr(written, name), getattr(kept, name)) for name in FRAMES)
    half = replace(
        kept,
        series=kept.series.iloc[:100],
        contacts=kept.contacts._replace(
            **{
                name: rows[:100]
                for name, rows in kept.contacts._asdict().items()
                if name != "joints"
            }
        ),
    )
    assert half.active.opening_m.shape == (100, 3) and len(half.index()) == 100


@pytest.mark.parametrize("write", [HistoryWriter, HistoryInMemory, HistoryKept])
def test_states_are_those_of_the_joints_that_ever_have_one(write, tmp_path):
    history = make_history(tmp_path / "a.h5", **CRACKED, at_limit=[11], write=write)
    states = history.states
    assert set(states.joints) == {3, 5, 9, 11} and not history.is_intact
    for name in ("broken", "at_limit", "crushed"):
        assert np.array_equal(getattr(states, name), getattr(history, name)[:, states.joints])
        assert getattr(history, name).sum() == getattr(states, name).sum()
    assert make_history(tmp_path / "b.h5", stages=CRACKED["stages"], write=write).is_intact


@pytest.mark.parametrize("status", ["failed", "interrupted"])
def test_a_run_without_an_end_leaves_its_file(status, tmp_path):
    written = make_history(tmp_path / "a.h5", **CRACKED | {"status": status})
    make_history(tmp_path / "b.h5", **CRACKED | {"status": status}, write=HistoryInMemory)
    assert differences(written, read_history(tmp_path / "b.h5")) == []
