"""The history file: round trip, growth, refusal to overwrite; files that were damaged, changed or
cut short, and what a file is worth."""

import json
import os
import shutil

import h5py
import numpy as np
import pytest
from conftest import REPOSITORY, refused_with, run_command, written
from numpy.testing import assert_allclose
from small_history import make_history

import damage
from damage import Brick, InputError, ModelOptions, Opening, Wall, load_wall, read_history
from damage.__main__ import main
from damage.history.head import HEAD_BYTES, read_head, seal
from damage.history.info import DAMAGED, ENDED_EARLY, OPEN, WHOLE, check
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
        opening = np.full((1, LAYOUT.n_joints), 1e-5 * k)
        slip = np.full((1, LAYOUT.n_joints), -2e-5 * k)
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
    content = path.read_bytes()
    head = f"masonry-damage-history {SCHEMA_VERSION}\n".encode()
    assert content.startswith(head)
    path.write_bytes(f"masonry-damage-history {version}\n".encode() + content[len(head) :])
    refused_with(
        f"schema version {version}, this software reads {SCHEMA_VERSION}; {remedy}",
        read_history,
        path,
    )


# --- damaged, changed or cut short ----------------------------------------------------------------

FINISHED = "finished"
KILLED = "killed"


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """One run as {kind: path}: finished, and as SIGKILL leaves it at its end."""
    folder = tmp_path_factory.mktemp("originals")
    paths = {FINISHED: folder / "finished.h5", KILLED: folder / "killed.h5"}
    with pytest.MonkeyPatch.context() as patch:
        copy_before_it_closes(patch, paths[KILLED])
        damage.run(
            load_wall(REPOSITORY / "walls" / "variants" / "small.py"),
            harmonic=(0.06, 0.6),
            cycles=2,
            rest=0.05,
            out=paths[FINISHED],
        )
    return paths


def copy_before_it_closes(patch, path):
    """Have the first file that HDF5 closes in the folder copied before, as a writer leaves it that
    is killed there."""
    close = h5py.File.close

    def copy_and_close(self):
        if (
            self
            and self.mode == "r+"
            and not path.exists()
            and os.path.dirname(self.filename) == str(path.parent)
        ):
            self.flush()
            shutil.copy(self.filename, path)
        close(self)

    patch.setattr(h5py.File, "close", copy_and_close)


@pytest.fixture
def finished(files, tmp_path):
    return written(tmp_path / "a.h5", files[FINISHED].read_bytes())


def altered(path, what):
    """Have `what(file)` change the history as HDF5 does, and seal it anew; returns the path."""
    with h5py.File(path, "r+", libver="latest") as file:
        what(file)
    seal(path)
    return path


# --- the seal -------------------------------------------------------------------------------------


def test_a_finished_history_is_sealed_and_its_head_says_what_made_it(finished):
    head = read_head(finished)
    history = read_history(finished)
    assert head.sealed and head.model == f"reference {history.versions['model']}"
    text = finished.read_bytes()[:HEAD_BYTES].decode()
    assert text.startswith(
        f"masonry-damage-history {SCHEMA_VERSION}\nsoftware {damage.__version__}\nmodel reference "
    )
    count = f"tail -c +{HEAD_BYTES + 1} {finished} | sha256sum"  # anyone can
    assert run_command("bash", "-c", count).stdout.split()[0] == head.sealed.split()[1]


def flipped(share):
    """The change of one bit, behind this share of what is behind the head."""

    def change(data):
        place = int(HEAD_BYTES + share * (len(data) - HEAD_BYTES))
        return data[:place] + bytes([data[place] ^ 1]) + data[place + 1 :]

    return change


@pytest.mark.parametrize(
    ("change", "complaint"),
    [
        (flipped(0.01), "is not what its run sealed"),
        (flipped(0.999), "is not what its run sealed"),
        (lambda data: data[:-1], r"of \d+ bytes, .* of \d+ bytes were sealed: it was cut short"),
        (lambda data: data + b"\0", r"of \d+ bytes, .* of \d+ bytes were sealed: it was cut short"),
        (lambda data: b"", "cannot be read as a history"),
        (lambda data: data[:511], "cannot be read as a history"),
        (lambda data: data[:700], "of 188 bytes, "),
        (
            lambda data: data.replace(b"sealed sha256", b"sealed sha257", 1),
            "cannot be read as a history",
        ),
        (lambda data: data.replace(b" bytes\n\0", b" bytes\n\1", 1), "cannot be read as a history"),
    ],
)
def test_a_damaged_history_is_refused(change, complaint, finished):
    whole = finished.read_bytes()
    finished.write_bytes(change(whole))
    assert finished.read_bytes() != whole
    refused_with(complaint, read_history, finished)


def test_what_no_run_closed_has_no_end_whatever_it_says(tmp_path, monkeypatch):
    """As where the machine stops between the last byte and the seal."""
    copy_before_it_closes(monkeypatch, tmp_path / "stopped.h5")
    writer = open_writer(tmp_path / "a.h5")
    write_samples(writer, 5)
    writer.finish("complete")
    history = read_history(tmp_path / "stopped.h5")
    assert history.status == "unfinished" and len(history.series) == 5


def test_a_live_history_is_read_apart_and_alike(tmp_path):
    writer = open_writer(tmp_path / "a.h5")
    write_samples(writer, 130)
    writer.flush()
    growing = read_history(tmp_path / "a.h5")
    writer.finish("complete")
    whole = read_history(tmp_path / "a.h5")
    assert growing.status == "unfinished" and whole.complete
    assert growing.series.equals(whole.series) and growing.joints.equals(whole.joints)
    assert (growing.opening_m == whole.opening_m).all()


def test_a_dataset_that_no_schema_names_yet_is_left_alone(finished):
    whole = read_history(finished)
    history = read_history(
        altered(finished, lambda file: file.create_dataset("series/later_m", data=[1.0]))
    )
    assert history.series.equals(whole.series)


# --- check ----------------------------------------------------------------------------------------


def test_check_says_what_each_file_is_worth(files, finished, tmp_path, capsys):
    def run(*words):
        status = main(["check", *map(str, words)])
        return status, *capsys.readouterr()

    make_history(tmp_path / "early.h5", status="interrupted")
    paths = {
        WHOLE: finished,
        OPEN: files[KILLED],
        ENDED_EARLY: tmp_path / "early.h5",
        DAMAGED: written(tmp_path / "bad.h5", "words"),
    }
    for worth, path in paths.items():
        assert check(path)["worth"] == worth
    status, out, err = run(*paths.values())
    assert status == 2 and err == ""
    assert [line.split(":")[0] for line in out.splitlines()] == list(paths)
    assert run(paths[WHOLE])[0] == 0
    status, out, _ = run(paths[WHOLE], paths[OPEN], "--json")
    assert status == 1 and [one["status"] for one in json.loads(out)] == ["complete", "unfinished"]


# --- two writers ----------------------------------------------------------------------------------


@pytest.mark.parametrize("overwrite", [False, True])
def test_a_second_run_on_one_history_is_refused(overwrite, tmp_path):
    path = tmp_path / "a.h5"
    writer = open_writer(path)
    write_samples(writer, 3)
    writer.flush()
    with pytest.raises(
        InputError, match="in use: another run writes it" if overwrite else "exists already"
    ):
        open_writer(path, overwrite=overwrite)
    write_samples(writer, 3, first=3)
    writer.finish("complete")
    assert len(read_history(path).series) == 6
    open_writer(path, overwrite=True).finish("complete")
