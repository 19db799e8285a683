"""Histories that were damaged, changed or cut short: one clear line, no wait, no crash; and what a file is worth."""

import json
import os
import re
import shutil
import zlib

import h5py
import numpy as np
import pytest
from conftest import REPOSITORY, refused_with, run_command, written
from small_history import make_history
from test_history import open_writer, write_samples

import damage
from damage.__main__ import main
from damage.errors import InputError
from damage.history import apart as in_a_child
from damage.history.head import HEAD_BYTES, read_head, seal
from damage.history.info import DAMAGED, ENDED_EARLY, OPEN, UNSEALED, WHOLE, check
from damage.history.schema import SCHEMA_VERSION
from damage.wall.file import load_wall

FINISHED, OLD, KILLED = "finished", "finished, schema version 1", "killed"


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """One run as {kind: path}: finished, as the first schema version had it, and as SIGKILL leaves it at its end."""
    folder = tmp_path_factory.mktemp("originals")
    paths = {FINISHED: folder / "finished.h5", OLD: folder / "old.h5", KILLED: folder / "killed.h5"}
    with pytest.MonkeyPatch.context() as patch:
        copy_before_it_closes(patch, paths[KILLED])
        damage.run(load_wall(REPOSITORY / "walls" / "variants" / "small.py"), harmonic=(0.06, 0.6), cycles=2, rest=0.05,
                   out=paths[FINISHED])
    paths[OLD].write_bytes(paths[FINISHED].read_bytes()[HEAD_BYTES:])  # addresses count from the superblock on
    with h5py.File(paths[OLD], "r+", libver="latest") as file:
        file.attrs["schema_version"] = 1
        file["joints/kind"].attrs["codes"] = "bed, head"
        file["series/stage"].attrs["codes"] = "motion, rest, settling"
        del file["frames/offset_m"]
    return paths


def copy_before_it_closes(patch, path):
    """Have the first file that HDF5 closes in the folder copied before, as a writer leaves it that is killed there."""
    close = h5py.File.close

    def copy_and_close(self):
        if self and self.mode == "r+" and not path.exists() and os.path.dirname(self.filename) == str(path.parent):
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


def replaced(name, value):
    def change_it(file):
        del file[name]
        file[name] = value
    return change_it


def repacked(name, **how):
    """Store a dataset in another way, with its attributes; unpacked: what gzip makes of its one chunk, otherwise."""
    unpacked = how.pop("unpacked", None)

    def change_it(file):
        values, attributes = file[name][()], dict(file[name].attrs)
        del file[name]
        dataset = file.create_dataset(name, values.shape, values.dtype, **how)
        dataset.attrs.update(attributes)
        if unpacked:
            dataset.id.write_direct_chunk((0,), zlib.compress(unpacked, 1))
    return change_it


def stored_elsewhere(name, virtual):
    """Have a dataset take its values out of another file."""
    def change_it(file):
        values, attributes = file[name][()], dict(file[name].attrs)
        del file[name]
        if virtual:
            layout = h5py.VirtualLayout(values.shape, values.dtype)
            layout[:] = h5py.VirtualSource("/dev/zero", "x", values.shape)
            file.create_virtual_dataset(name, layout)
        else:
            file.create_dataset(name, values.shape, values.dtype, external=[("/dev/zero", 0, values.nbytes)])
        file[name].attrs.update(attributes)
    return change_it


def put(name, value):
    def change_it(file):
        file[name][0] = value
    return change_it


# --- the seal -------------------------------------------------------------------------------------

def test_a_finished_history_is_sealed_and_its_head_says_what_made_it(finished):
    head, history = read_head(finished), damage.read_history(finished)
    assert head.sealed and head.model == f"reference {history.versions['model']}"
    text = finished.read_bytes()[:HEAD_BYTES].decode()
    assert text.startswith(f"masonry-damage-history {SCHEMA_VERSION}\nsoftware {damage.__version__}\nmodel reference ")
    count = f"tail -c +{HEAD_BYTES + 1} {finished} | sha256sum"  # anyone can
    assert run_command("bash", "-c", count).stdout.split()[0] == head.sha256


@pytest.mark.parametrize("place", [0.01, 0.999])
def test_one_changed_byte_is_found(place, finished):
    data = bytearray(finished.read_bytes())
    data[int(HEAD_BYTES + place * (len(data) - HEAD_BYTES))] ^= 1
    finished.write_bytes(data)
    refused_with("SHA-256 differs", damage.read_history, finished)


@pytest.mark.parametrize("change_size", [-1, 1])
def test_a_file_of_another_length_is_found(change_size, finished):
    size = finished.stat().st_size + change_size
    os.truncate(finished, size)
    refused_with(rf"has {size - HEAD_BYTES} bytes behind its head, \d+ were sealed", damage.read_history, finished)


@pytest.mark.parametrize("length", [0, 511, 700])
def test_a_stump_is_refused(length, finished):
    os.truncate(finished, length)
    refused_with(r"cannot be read as a history|were sealed", damage.read_history, finished)


@pytest.mark.parametrize(("old", "new"), [(b"sealed sha256", b"sealed sha257"), (b" bytes\n\0", b" bytes\n\1"),
                                          (b"history 8", b"history 0"), (b"history 8", b"history 2"),
                                          (b"software 0", b"software 7")])
def test_a_damaged_head_is_refused(old, new, finished):
    finished.write_bytes(finished.read_bytes().replace(old, new, 1))
    refused_with("cannot be read as a history", damage.read_history, finished)


def test_what_no_run_closed_has_no_end_whatever_it_says(tmp_path, monkeypatch):
    """As where the machine stops between the last byte and the seal."""
    copy_before_it_closes(monkeypatch, tmp_path / "stopped.h5")
    writer = open_writer(tmp_path / "a.h5")
    write_samples(writer, 5)
    writer.finish("complete")
    history = damage.read_history(tmp_path / "stopped.h5")
    assert history.status == "unfinished" and len(history.series) == 5


# --- many faults ----------------------------------------------------------------------------------

@pytest.mark.parametrize("header", [0, 11])
def test_a_file_that_grew_and_is_damaged_is_an_error_after_a_while(header, files, tmp_path, monkeypatch):
    """In the checksummed headers of groups and datasets HDF5 waits for the writer to correct them."""
    monkeypatch.setattr(in_a_child, "SECONDS", 1)
    path = tmp_path / "a.h5"
    data = bytearray(files[KILLED].read_bytes())
    place = [found.start() for found in re.finditer(rb"OHDR", data)][header]
    data[place + 9] ^= 1
    path.write_bytes(data)
    refused_with(r"HDF5 found no end in 1 s|cannot be read as a history", damage.read_history, path)


def test_a_reader_that_crashes_is_an_error(files):
    def crash(path, believe):
        os.kill(os.getpid(), 11)

    refused_with(r"HDF5 crashes on it \(signal 11\)", in_a_child.apart, files[OLD], crash)


def test_a_reader_that_cannot_send_what_it_read_is_an_error(files):
    with pytest.raises(InputError, match="too little memory"):
        in_a_child.apart(files[OLD], lambda path, believe: lambda: None)  # nothing that can be sent


def test_a_reader_gets_no_more_memory_than_it_may_believe(files, monkeypatch):
    def greedy(path, believe):
        return len(np.empty(250_000_000))  # 2 GB, of which no page is touched: more than a heap ever holds unused

    monkeypatch.setattr(in_a_child, "FREE_BYTES", 20e6)
    refused_with(r"cannot be read \(Unable to allocate", in_a_child.apart, files[OLD], greedy)
    assert in_a_child.apart(files[OLD], lambda path, believe: (believe(2e9), greedy(path, believe))[1]) == 250_000_000


def test_a_live_history_is_read_apart_and_alike(tmp_path):
    writer = open_writer(tmp_path / "a.h5")
    write_samples(writer, 130)
    writer.flush()
    growing = damage.read_history(tmp_path / "a.h5")
    writer.finish("complete")
    whole = damage.read_history(tmp_path / "a.h5")
    assert growing.status == "unfinished" and whole.complete
    assert growing.series.equals(whole.series) and growing.joints.equals(whole.joints)
    assert (growing.opening_m == whole.opening_m).all()


# --- what cannot be -------------------------------------------------------------------------------

def put_parameter(file, name, value):
    """Give a parameter of the run another value."""
    run = file["run"].attrs
    run.modify("parameters_json", json.dumps(json.loads(run["parameters_json"]) | {name: value}))


@pytest.mark.parametrize(("what", "complaint"), [
    (lambda file: file.pop("series/time_s"), "no dataset series/time_s"),
    (replaced("joints/x_m", h5py.SoftLink("/joints/z_m")), "no dataset joints/x_m"),
    (replaced("joints/x_m", h5py.ExternalLink("/dev/zero", "x")), "no dataset joints/x_m"),
    (replaced("run", h5py.SoftLink("/joints")), "it has no group run"),
    (stored_elsewhere("bodies/x_m", virtual=True), "bodies/x_m is no dataset of this file"),
    (stored_elsewhere("bodies/x_m", virtual=False), "bodies/x_m is no dataset of this file"),
    (repacked("series/time_s", chunks=(8,), compression="lzf"), "series/time_s is packed by HDF5 filter 32000"),
    (repacked("series/time_s", chunks=(65536,), maxshape=(None,), compression="gzip", unpacked=bytes(2**30)),
     "memory allocation failed|filter returned failure"),  # HDF5 1.10 and 1.14
    (lambda file: file["run"].attrs.__setitem__("wall", "../w"), "attribute wall of run is '../w', expected a name"),
    (replaced("static/weight_n", b"heavy"), "static/weight_n is of type object, expected float64"),
    (lambda file: file["series/time_s"].resize(7, axis=0), r"series/time_s has shape \(7,\), expected \d+ samples"),
    (lambda file: [rows.resize(10**12, axis=0) for rows in file["events"].values()], "8000000000000 bytes where"),
    (lambda file: file["joints/x_m"].attrs.modify("unit", "ft"), "joints/x_m has the unit 'ft', expected m"),
    (lambda file: file["events/kind"].attrs.modify("codes", "a, b"), "events/kind has the codes 'a, b', expected ten"),
    (lambda file: file["run"].attrs.modify("parameters_json", "{"), "Expecting property name"),
    (lambda file: put_parameter(file, "sequence", [1e300]), "a factor of parameter sequence = 1e[+]300: expected a"),
    (lambda file: put_parameter(file, "points", "abc"), "parameter points is 'abc', expected what a run writes there"),
    (lambda file: put_parameter(file, "time_step_s", "x"), "parameter time_step_s is 'x', expected a number"),
    (lambda file: file["run"].attrs.pop("machine"), "attribute machine of run is None, expected words"),
    (lambda file: file["run"].attrs.modify("height_m", np.nan), "attribute height_m of run is nan, expected a length"),
    (lambda file: file["run"].attrs.modify("drift_height_m", -1.0), "attribute drift_height_m of run is -1"),
    (replaced("run/status", np.zeros(7, "u1")), "run/status has the codes None, expected unfinished, complete"),
    (put("series/drift_ratio", np.nan), "series/drift_ratio is nan in row 0"),
    (put("series/time_s", 1e9), "time_s is .* in row 1, expected a later time"),
    (put("events/joint", 10**6), "joint is 1e\\+06 in row 0, expected 0 to 145"),
    (put("joints/length_m", 0), "length_m is 0 in row 0, expected a number above zero"),
])
def test_a_history_that_says_what_cannot_be_is_refused(what, complaint, finished):
    assert str(finished) in refused_with(complaint, damage.read_history, altered(finished, what))


def test_a_dataset_that_no_schema_names_yet_is_left_alone(finished):
    whole = damage.read_history(finished)
    history = damage.read_history(altered(finished, lambda file: file.create_dataset("series/later_m", data=[1.0])))
    assert history.series.equals(whole.series)


# --- check ----------------------------------------------------------------------------------------

def test_check_says_what_each_file_is_worth(files, finished, tmp_path, capsys):
    def run(*words):
        status = main(["check", *map(str, words)])
        return status, *capsys.readouterr()

    make_history(tmp_path / "early.h5", status="interrupted")
    paths = {WHOLE: finished, UNSEALED: files[OLD], OPEN: files[KILLED], ENDED_EARLY: tmp_path / "early.h5",
             DAMAGED: written(tmp_path / "bad.h5", "words")}
    for worth, path in paths.items():
        assert check(path)["worth"] == worth
    status, out, err = run(*paths.values())
    assert status == 2 and err == ""
    assert [line.split(":")[0] for line in out.splitlines()] == list(paths)
    assert run(paths[WHOLE], paths[UNSEALED])[0] == 0
    status, out, _ = run(paths[WHOLE], paths[OPEN], "--json")
    assert status == 1 and [one["status"] for one in json.loads(out)] == ["complete", "unfinished"]


@pytest.mark.parametrize("command", [
    "index ?", "plot ? --out x", "laboratory ? --out x", "tables summary ? --out x.csv"])
def test_a_command_refuses_a_damaged_history_in_one_line(command, finished, tmp_path, monkeypatch, error_of):
    monkeypatch.chdir(tmp_path)
    os.truncate(finished, 20000)
    said = error_of(*command.replace("?", str(finished)).split())
    assert re.fullmatch(r"error: \S+a\.h5 has 19488 bytes behind its head, \d+ were sealed: .*\n", said)


# --- two writers ----------------------------------------------------------------------------------

@pytest.mark.parametrize("overwrite", [False, True])
def test_a_second_run_on_one_history_is_refused(overwrite, tmp_path):
    path = tmp_path / "a.h5"
    writer = open_writer(path)
    write_samples(writer, 3)
    writer.flush()
    with pytest.raises(InputError, match="in use: another run writes it" if overwrite else "exists already"):
        open_writer(path, overwrite=overwrite)
    write_samples(writer, 3, first=3)
    writer.finish("complete")
    assert len(damage.read_history(path).series) == 6
    open_writer(path, overwrite=True).finish("complete")
