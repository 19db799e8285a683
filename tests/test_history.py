"""The history file: round trip, growth, crash, refusal to overwrite."""

import os
import signal
import subprocess
import sys
import textwrap
import time

import h5py
import numpy as np
import pytest
from conftest import REPOSITORY
from numpy.testing import assert_allclose

import damage
from damage.errors import InputError
from damage.history.schema import AT_LIMIT, BROKEN, SERIES
from damage.history.writer import HistoryWriter
from damage.wall.layout import lay_out
from damage.wall.parameters import Wall

LAYOUT = lay_out(Wall("small", 0.45, 0.15))
PARAMETERS = {"loading": {"kind": "harmonic", "name": "test"}, "wall": LAYOUT.wall.describe()}


def open_writer(path, **options):
    return HistoryWriter(path, LAYOUT, solver="yade", parameters=PARAMETERS,
                         versions={"yade": "0"}, **options)


def write_samples(writer, n, first=0):
    for k in range(first, first + n):
        opening, slip = np.full(LAYOUT.n_joints, 1e-5 * k), np.full(LAYOUT.n_joints, -2e-5 * k)
        state = np.full(LAYOUT.n_joints, BROKEN | AT_LIMIT if k > 2 else 0)
        writer.append("motion", {"time_s": 0.1 * k, "drift_ratio": 1e-4 * k}, opening, slip, state)


def test_round_trip(tmp_path):
    writer = open_writer(tmp_path / "a.h5")
    writer.static_stage(base_reaction_n=12.5, broken_joints=0)
    write_samples(writer, 200)
    writer.event(0.31, 4, "tension", normal_stress=0.21e6, shear_stress=-1e3)
    writer.event(0.5, 4, "opened", opening=1.1e-4)
    writer.snapshot(0.2, np.ones((len(LAYOUT.bodies), 3)))
    writer.finish("complete")
    history = damage.read_history(tmp_path / "a.h5")
    assert history.complete and history.collapsed_at_s is None
    assert history.wall == "small" and history.solver == "yade" and history.versions["yade"] == "0"
    assert history.parameters == PARAMETERS | {"wall": history.parameters["wall"]}
    assert history.static["base_reaction_n"] == 12.5 and np.isnan(history.static["weight_n"])
    assert_allclose(history.series.time_s, 0.1 * np.arange(200))
    assert_allclose(history.opening_m[:, 3], 1e-5 * np.arange(200), rtol=1e-6)  # single precision
    assert list(history.events.kind) == ["tension", "opened"]
    assert history.events.normal_stress_pa[0] == 0.21e6
    assert_allclose(history.joints.length_m.sum(), LAYOUT.total_joint_length)
    assert set(history.joints.kind) == {"bed", "head"}
    assert not history.broken[2].any() and history.broken[3].all() and history.at_limit[3].all()
    index = history.index()
    assert_allclose(index.DI_open.iloc[[9, 11]], [0, 1])
    assert_allclose(index.DI_slip.iloc[[4, 6]], [0, 1])


def test_every_dataset_names_its_unit(tmp_path):
    open_writer(tmp_path / "a.h5").finish("complete")
    with h5py.File(tmp_path / "a.h5", "r") as file:
        missing = []
        file.visititems(lambda name, item: missing.append(name) if isinstance(item, h5py.Dataset)
                        and not {"unit", "codes"} & set(item.attrs) else None)
    assert missing == []


def test_readable_while_it_grows(tmp_path):
    writer = open_writer(tmp_path / "a.h5")
    write_samples(writer, 100)
    writer.flush()
    first = damage.read_history(tmp_path / "a.h5")
    write_samples(writer, 100, first=100)
    writer.flush()
    second = damage.read_history(tmp_path / "a.h5")
    assert (len(first.series), len(second.series)) == (100, 200)
    assert first.status == "unfinished" and not first.complete
    writer.finish("interrupted")
    assert damage.read_history(tmp_path / "a.h5").status == "interrupted"


def test_what_was_flushed_is_whole_after_sigkill(tmp_path):
    script = textwrap.dedent("""
        import sys
        sys.path[:0] = ["tests", "."]
        from test_history import open_writer, write_samples
        writer = open_writer(sys.argv[1])
        for round_ in range(10**6):
            write_samples(writer, 16, first=16 * round_)
            writer.flush()
            if round_ == 20: print("ready", flush=True)
    """)
    path = tmp_path / "a.h5"
    child = subprocess.Popen([sys.executable, "-c", script, path], cwd=REPOSITORY, stdout=subprocess.PIPE)
    assert child.stdout.readline() == b"ready\n"
    time.sleep(0.2)
    os.kill(child.pid, signal.SIGKILL)
    child.wait()
    child.stdout.close()
    history = damage.read_history(path)
    n = len(history.series)
    assert history.status == "unfinished" and n >= 16 * 20
    assert_allclose(history.series.time_s, 0.1 * np.arange(n))
    assert_allclose(history.opening_m[:, 0], 1e-5 * np.arange(n), rtol=1e-6)


def test_an_existing_history_is_kept_unless_asked(tmp_path):
    path = tmp_path / "a.h5"
    writer = open_writer(path)
    write_samples(writer, 5)
    writer.finish("complete")
    before = path.read_bytes()
    with pytest.raises(InputError, match="--overwrite"):
        open_writer(path)
    assert path.read_bytes() == before
    open_writer(path, overwrite=True).finish("complete")
    assert len(damage.read_history(path).series) == 0


@pytest.mark.parametrize(("make", "complaint"), [
    (lambda path: None, "no such file"),
    (lambda path: path.write_text("hello"), "cannot be read"),
    (lambda path: path.write_bytes(b""), "cannot be read"),
    (lambda path: h5py.File(path, "w").close(), "no history of this software"),
])
def test_what_is_no_history_is_refused(tmp_path, make, complaint):
    path = tmp_path / "a.h5"
    make(path)
    with pytest.raises(InputError, match=complaint):
        damage.read_history(path)


def test_a_newer_schema_is_refused(tmp_path):
    path = tmp_path / "a.h5"
    open_writer(path).finish("complete")
    with h5py.File(path, "r+") as file:
        file.attrs["schema_version"] = 99
    with pytest.raises(InputError, match="version 99"):
        damage.read_history(path)


def test_units_of_the_series_stand_in_the_names():
    endings = {"s": "_s", "m/s2": "_m_s2", "m": "_m", "1": "_ratio", "N": "_n", "J": "_j"}
    assert all(name.endswith(endings[unit]) for name, unit in SERIES.items())
