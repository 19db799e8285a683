"""Histories that were damaged, changed or cut short: one clear line, no wait, no crash; and what a
file is worth."""

import json
import os
import shutil

import h5py
import pytest
from conftest import REPOSITORY, refused_with, run_command, written
from small_history import make_history
from test_history import open_writer, write_samples

import damage
from damage import InputError, load_wall, read_history
from damage.__main__ import main
from damage.history.head import HEAD_BYTES, read_head, seal
from damage.history.info import DAMAGED, ENDED_EARLY, OPEN, WHOLE, check
from damage.history.schema import SCHEMA_VERSION

FINISHED, KILLED = "finished", "killed"


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
    head, history = read_head(finished), read_history(finished)
    assert head.sealed and head.model == f"reference {history.versions['model']}"
    text = finished.read_bytes()[:HEAD_BYTES].decode()
    assert text.startswith(
        f"masonry-damage-history {SCHEMA_VERSION}\nsoftware {damage.__version__}\nmodel reference "
    )
    count = f"tail -c +{HEAD_BYTES + 1} {finished} | sha256sum"  # anyone can
    assert run_command("bash", "-c", count).stdout.split()[0] == head.sha256


def flipped(share):
    """The change of one bit, behind this share of what is behind the head."""

    def change(data):
        place = int(HEAD_BYTES + share * (len(data) - HEAD_BYTES))
        return data[:place] + bytes([data[place] ^ 1]) + data[place + 1 :]

    return change


@pytest.mark.parametrize(
    ("change", "complaint"),
    [
        (flipped(0.01), "SHA-256 differs"),
        (flipped(0.999), "SHA-256 differs"),
        (lambda data: data[:-1], r"bytes behind its head, \d+ were sealed"),
        (lambda data: data + b"\0", r"bytes behind its head, \d+ were sealed"),
        (lambda data: b"", "cannot be read as a history"),
        (lambda data: data[:511], "cannot be read as a history"),
        (lambda data: data[:700], "has 188 bytes behind its head"),
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
