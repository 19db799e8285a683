"""The history file: round trip, growth, crash, refusal to overwrite."""

import json
import os

import h5py
import numpy as np
import pytest
from conftest import refused_with
from numpy.testing import assert_allclose

from damage import Brick, ModelOptions, Opening, Wall, read_history
from damage.history.schema import GROUND, SCHEMA_VERSION
from damage.history.writer import HistoryWriter
from damage.law.states import AT_LIMIT, BROKEN
from damage.motion.formats import read_record, shipped_record_path
from damage.motion.intensity import pga_g
from damage.motion.loading import (
    FreeVibration,
    Harmonic,
    Recorded,
    TopDisplacement,
    loading_from_dict,
)
from damage.run.settings import RunSettings
from damage.wall.layout import lay_out

LAYOUT = lay_out(Wall("small", 0.45, 0.15))
PARAMETERS = {"loading": Harmonic(0.2, 0.05).as_dict(), "wall": LAYOUT.wall.as_dict()}


def open_writer(path, **options):
    return HistoryWriter(
        path, LAYOUT, solver="yade", parameters=PARAMETERS, versions={"yade": "0"}, **options
    )


def write_samples(writer, n, first=0):
    for k in range(first, first + n):
        opening, slip = (
            np.full((1, LAYOUT.n_joints), 1e-5 * k),
            np.full((1, LAYOUT.n_joints), -2e-5 * k),
        )
        state = np.full((1, LAYOUT.n_joints), BROKEN | AT_LIMIT if k > 2 else 0)
        writer.extend(
            "motion",
            {"time_s": np.array([0.1 * k]), "drift_ratio": np.array([1e-4 * k])},
            slice(None),
            {"opening_m": opening, "slip_m": slip, "offset_m": 2 * slip, "state": state},
            {f"ground/{name}": np.zeros((1, len(LAYOUT.supports), 3)) for name in GROUND},
        )


def test_round_trip(tmp_path):
    writer = open_writer(tmp_path / "a.h5")
    writer.static_stage(base_reaction_n=12.5, broken_joints=0)
    write_samples(writer, 200)
    writer.event(0.31, 4, "tension", normal_stress=0.21e6, shear_stress=-1e3)
    writer.event(0.5, 4, "opened", opening=1.1e-4)
    writer.snapshot(0.2, np.ones((len(LAYOUT.bodies), 3)))
    writer.finish("complete")
    history = read_history(tmp_path / "a.h5")
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
    assert_allclose(index.DI_slip.iloc[[2, 3]], [0, 1])
    assert_allclose(history.index(slip="accumulated").DI_slip.iloc[[4, 6]], [0, 1])


LOADINGS = [
    Harmonic(0.3, 0.05, 4),
    FreeVibration(2e-3),
    TopDisplacement((0.1, 0.2), 1, "fixed", 0.01, 0.5),
    TopDisplacement((0.3,), 0),
]
RECORDED = Recorded(
    read_record(shipped_record_path("BGAR_HGE")), scale=2.0, window_s=(17.0, 25.0), baseline_order=1
)


@pytest.mark.parametrize("loading", LOADINGS, ids=lambda loading: loading.name)
def test_a_history_gives_its_records_back(tmp_path, loading):
    wall = Wall(
        "w", 1.8, 0.9, openings=(Opening(0.6, 0.5, 0.3, 0.15),), brick=Brick(density=2000.0)
    )
    model = ModelOptions(lintel=2, load="piers", cells=3)
    settings = RunSettings(loading, model, sequence=(1.0, 0.5), command="yade w.py")
    HistoryWriter(
        tmp_path / "a.h5",
        lay_out(wall, model),
        solver="yade",
        versions={},
        parameters={"wall": wall.as_dict(), **settings.as_dict(), "time_step_s": 2e-5},
    ).finish("complete")
    history = read_history(tmp_path / "a.h5")
    assert (history.loading, history.model, history.masonry_wall) == (loading, model, wall)
    assert (history.sequence, history.time_step_s, history.eigen_period_s) == (
        (1.0, 0.5),
        2e-5,
        None,
    )
    assert history.command == "yade w.py" and "command" not in history.parameters


def test_a_recorded_motion_comes_back_without_its_samples():
    found = loading_from_dict(json.loads(json.dumps(RECORDED.as_dict())))
    for name in ("name", "duration_s", "window_s", "scale"):
        assert getattr(found, name) == getattr(RECORDED, name)
    refused_with("expected the record's file", found.drive.base, np.zeros(1))
    assert found.as_dict() == json.loads(json.dumps(RECORDED.as_dict())) | {
        "window_s": (17.0, 25.0)
    }
    assert (found.pga_g, found.sa_02_s_g) == pytest.approx(
        (pga_g(RECORDED.motion[0]), found.as_dict()["sa_0.2_s_g"])
    )
    assert found.horizontal["record"] == RECORDED.record.name and found.vertical is None
    assert loading_from_dict({"kind": "record", "name": "old"}).pga_g is None


@pytest.mark.parametrize(
    ("make", "complaint"),
    [
        (lambda: loading_from_dict({"kind": "blast"}), "kind 'blast'.*expected one of harmonic"),
        (
            lambda: loading_from_dict({"kind": "harmonic", "period_s": 0.2}),
            "amplitude_g.*expected a table",
        ),
        (
            lambda: loading_from_dict(LOADINGS[0].as_dict() | {"jerk": 1.0}),
            "Harmonic with jerk = 1.0.*update",
        ),
    ],
)
def test_tables_of_later_versions_are_refused(make, complaint):
    refused_with(complaint, make)


def test_every_dataset_names_its_unit(tmp_path):
    open_writer(tmp_path / "a.h5").finish("complete")
    with h5py.File(tmp_path / "a.h5", "r") as file:
        missing = []
        file.visititems(
            lambda name, item: (
                missing.append(name)
                if isinstance(item, h5py.Dataset) and not {"unit", "codes"} & set(item.attrs)
                else None
            )
        )
    assert missing == []


@pytest.mark.parametrize(
    "make", [lambda path: path.write_text("notes"), os.mkfifo], ids=["text", "pipe"]
)
def test_overwrite_replaces_histories_alone(make, tmp_path):
    path = tmp_path / "notes.h5"
    make(path)
    refused_with("no history", open_writer, path, overwrite=True)
    assert path.exists() and path.is_fifo() == (make is os.mkfifo)


@pytest.mark.parametrize(
    ("make", "complaint"),
    [
        (lambda path: None, "No such file or directory; expected a history"),
        (lambda path: h5py.File(path, "w").close(), "no history of this software|begins otherwise"),
    ],
)
def test_what_is_no_history_is_refused(tmp_path, make, complaint):
    path = tmp_path / "a.h5"
    make(path)
    refused_with(complaint, read_history, path)


@pytest.mark.parametrize(
    ("version", "remedy"), [(SCHEMA_VERSION + 1, "update the software"), (8, "run it again")]
)
def test_another_schema_is_refused(version, remedy, tmp_path):
    path = tmp_path / "a.h5"
    open_writer(path).finish("complete")
    content, head = path.read_bytes(), f"masonry-damage-history {SCHEMA_VERSION}\n".encode()
    assert content.startswith(head)
    path.write_bytes(f"masonry-damage-history {version}\n".encode() + content[len(head) :])
    refused_with(
        f"schema version {version}, this software reads {SCHEMA_VERSION}; {remedy}",
        read_history,
        path,
    )
