"""Histories and changes of them: single bits, cuts, and changes by HDF5 itself of a dataset, a link, an attribute, a
parameter.  Most changed files are sealed anew, or are of a run that was killed, so that it is not the seal that tells.
"""

import json
import os
import random
import signal
from pathlib import Path

import h5py
import numpy as np

from damage.history.head import HDF5, HEAD_BYTES, Head, read_head, seal, write_head
from damage.history.reader import read_history
from damage.measure.summary import summarise
from damage.measure.tables import cycles_table, events_table, index_table, joints_table, summary_row
from damage.reference.session import run_reference
from tests.fuzz.mutators import BYTES, mutate

SECONDS = 10
"""What a change by HDF5 may take."""
FINISHED, OLD, KILLED = "finished", "finished, schema version 1", "killed"


# --- the files ------------------------------------------------------------------------------------

def originals(folder):
    """One run as {kind: path}: finished, as the first schema version had it, and as SIGKILL leaves it."""
    paths = {FINISHED: folder / "finished.h5", OLD: folder / "old.h5", KILLED: folder / "killed.h5"}
    if all(path.is_file() for path in paths.values()):
        return paths
    wall = Path(__file__).resolve().parents[2] / "benchmarks" / "small_wall.py"
    status = run_reference([str(wall), "--harmonic", "0.06", "0.6", "--cycles", "2", "--rest", "0.05", "--out",
                            str(paths[FINISHED]), "--no-pictures", "--overwrite"])
    assert status == 0
    data = paths[FINISHED].read_bytes()
    paths[KILLED].write_bytes(data)
    with h5py.File(paths[KILLED], "r+", libver="latest") as file:
        file["run/status"][()] = 0
    mark_growing(paths[KILLED])
    paths[OLD].write_bytes(data[HEAD_BYTES:])  # addresses in a file count from its superblock on
    with h5py.File(paths[OLD], "r+", libver="latest") as file:
        file.attrs["schema_version"] = 1
        file["joints/kind"].attrs["codes"] = "bed, head"
        file["series/stage"].attrs["codes"] = "motion, rest, settling"
        del file["frames/offset_m"]
    return paths


def mark_growing(path):
    """Make the file look as if its run had not closed it: no seal, and HDF5's mark of a writer in the superblock."""
    head = read_head(path)
    write_head(path, Head(head.software, head.model))
    data = bytearray(path.read_bytes())
    data[HEAD_BYTES + 11] |= 5
    data[HEAD_BYTES + 44:HEAD_BYTES + 48] = _lookup3(bytes(data[HEAD_BYTES:HEAD_BYTES + 44])).to_bytes(4, "little")
    path.write_bytes(data)


def _lookup3(data):
    """Jenkins' hash, the checksum of HDF5's superblock: hashlittle of lookup3.c (public domain), start value 0."""
    def rotated(value, by):
        return ((value << by) | (value >> (32 - by))) & 0xFFFFFFFF

    a = b = c = (0xDEADBEEF + len(data)) & 0xFFFFFFFF
    while len(data) > 12:
        a, b, c = ((one + int.from_bytes(data[k:k + 4], "little")) & 0xFFFFFFFF
                   for one, k in ((a, 0), (b, 4), (c, 8)))
        for by_1, by_2, by_3 in ((4, 6, 8), (16, 19, 4)):
            a = ((a - c) & 0xFFFFFFFF) ^ rotated(c, by_1)
            c = (c + b) & 0xFFFFFFFF
            b = ((b - a) & 0xFFFFFFFF) ^ rotated(a, by_2)
            a = (a + c) & 0xFFFFFFFF
            c = ((c - b) & 0xFFFFFFFF) ^ rotated(b, by_3)
            b = (b + a) & 0xFFFFFFFF
        data = data[12:]
    data = data.ljust(12, b"\0")
    a, b, c = ((one + int.from_bytes(data[k:k + 4], "little")) & 0xFFFFFFFF for one, k in ((a, 0), (b, 4), (c, 8)))
    for target, by in zip("cabcabc", (14, 11, 25, 16, 4, 14, 24)):
        if target == "c":
            c = ((c ^ b) - rotated(b, by)) & 0xFFFFFFFF
        elif target == "a":
            a = ((a ^ c) - rotated(c, by)) & 0xFFFFFFFF
        else:
            b = ((b ^ a) - rotated(a, by)) & 0xFFFFFFFF
    return c


def flip(path, random_):
    """Turn one bit; returns where."""
    data = bytearray(path.read_bytes())
    place = random_.randrange(8 * len(data))
    data[place // 8] ^= 1 << place % 8
    path.write_bytes(data)
    return f"bit {place % 8} of byte {place // 8}"


def cut(path, random_):
    """Cut the file short; returns where."""
    size = random_.randrange(path.stat().st_size)
    os.truncate(path, size)
    return f"cut to {size} bytes"


# --- changes by HDF5 ------------------------------------------------------------------------------

def change(path, random_):
    """Change one thing of the file's structure; returns what.  HDF5 crashes of some: that is a fault of a file, too."""
    kind = random_.choice((_change_dataset, _change_dataset, _change_values, _change_link, _change_attribute,
                           _change_parameter))
    seed = random_.random()

    def work():
        with h5py.File(path, "r+", libver="latest") as file:
            return kind(file, random.Random(seed))

    message, signal_ = in_a_child(work)
    return message or f"HDF5 crashed (signal {signal_}) of {kind.__name__.strip('_').replace('_', ' ')}"


def in_a_child(work):
    """(what `work()` says, 0) from a child of this process, or ("", the signal that ended it)."""
    receive, send = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(receive)
        signal.alarm(SECONDS)
        os.dup2(os.open(os.devnull, os.O_WRONLY), 2)
        try:
            message = work()
        except BaseException as error:
            message = f"exception\n{type(error).__name__}: {error}"
        os.write(send, message[:4000].encode(errors="replace"))
        os._exit(0)
    os.close(send)
    with os.fdopen(receive, "rb") as answer:
        message = b"".join(answer).decode()
    return message, os.WTERMSIG(os.waitpid(child, 0)[1])


def _datasets(file):
    found = []
    file.visititems(lambda name, item: found.append(name) if isinstance(item, h5py.Dataset) else None)
    return sorted(found)


def _change_dataset(file, random_):
    name = random_.choice(_datasets(file))
    old = file[name][()]
    rows = np.atleast_1d(old)
    news = {
        "missing": None, "words": np.array([b"word"] * len(rows)), "small floats": old.astype("f4"),
        "integers": np.nan_to_num(old, posinf=0).astype("i8"), "complex": old.astype("c16"),
        "long double": old.astype("g"), "a row less": rows[:-1], "a row more": np.concatenate([rows, rows[-1:]]),
        "no row": rows[:0], "flat": np.array(rows.ravel()), "a dimension more": rows[..., None], "one number": 1.0,
        "turned": np.array(rows.T), "a compound": np.zeros(len(rows), [("a", "f8"), ("b", "i4")]),
        "bool": rows.astype(bool), "unwritten": (rows.shape, rows.dtype), "empty": h5py.Empty("f8"),
        "huge": ((10**12, *rows.shape[1:]), rows.dtype), "huge, in huge chunks": ((10**9,), rows.dtype, (10**8,)),
        "unlimited, huge": ((2**40,), rows.dtype, (1024,)), "other chunks": (rows, True, "gzip"),
        "variable length": np.array(["a"] * len(rows), object),
    }
    what = random_.choice(sorted(news))
    new = news[what]
    del file[name]
    if isinstance(new, tuple) and isinstance(new[0], tuple):
        shape, dtype, *chunks = new
        file.create_dataset(name, shape, dtype, chunks=chunks[0] if chunks else (shape[:1] > (10**9,)) or None)
    elif isinstance(new, tuple):
        file.create_dataset(name, data=new[0], chunks=new[1], compression=new[2], fletcher32=True)
    elif new is not None:
        file.create_dataset(name, data=new)
    return f"{name}: {what}"


def _change_values(file, random_):
    name = random_.choice(_datasets(file))
    dataset = file[name]
    values = np.atleast_1d(dataset[()])
    if values.size == 0:
        return f"{name}: nothing to change"
    new = random_.choice((np.nan, np.inf, -np.inf, -1, 255, 1e300, -1e300, 2**31, 0))
    with np.errstate(all="ignore"):
        values.flat[random_.randrange(values.size)] = np.array(new).astype(values.dtype)
    dataset[...] = values.reshape(dataset.shape)
    return f"{name}: {new} among its values"


def _change_link(file, random_):
    name = random_.choice([*_datasets(file), *file])
    kinds = {
        "a soft link to nowhere": lambda: h5py.SoftLink("/nowhere"),
        "a soft link to the root": lambda: h5py.SoftLink("/"),
        "a soft link to itself": lambda: h5py.SoftLink(f"/{name}"),
        "a link to another file": lambda: h5py.ExternalLink("/dev/zero", "/x"),
        "a link to a missing file": lambda: h5py.ExternalLink("missing.h5", "/x"),
        "another dataset": lambda: file[random_.choice(_datasets(file))],
        "the root": lambda: file["/"], "a type": lambda: np.dtype("f8"), "a group": None, "an external file": None,
        "a virtual dataset": None,
    }
    what = random_.choice(sorted(kinds))
    target = kinds[what] and kinds[what]()
    if name in file:
        del file[name]
    if what == "a group":
        file.create_group(name)
    elif what == "an external file":
        file.create_dataset(name, (1000,), "f8", external=[("/dev/zero", 0, h5py.h5f.UNLIMITED)])
    elif what == "a virtual dataset":
        layout = h5py.VirtualLayout((1000,), "f8")
        layout[:] = h5py.VirtualSource("missing.h5", "x", (1000,))
        file.create_virtual_dataset(name, layout)
    else:
        file[name] = target
    return f"{name}: {what}"


def _change_attribute(file, random_):
    item = file[random_.choice(["/", "run", "run", "run", *_datasets(file)])]
    name = random_.choice(sorted(item.attrs) or ["new"])
    news = ["", "word", b"bytes", "x" * 50000, 7, -1, 1e300, np.nan, [1, 2, 3], ["a", "b"], h5py.Empty("S1"), True,
            None, np.zeros((3, 3)), "{}", "[]", "null", "\x1b[31mred\n", "1" * 5000, "[" * 5000, "\ud7ff"]
    new = random_.choice(news)
    if name in item.attrs:
        del item.attrs[name]
    if new is not None:
        item.attrs[name] = new
    return f"attribute {name} of {item.name}: {str(new)[:20]!r}"


def _change_parameter(file, random_):
    """Of the JSON that the run is described by: an entry, however deep, taken out or made another."""
    attributes = file["run"].attrs
    table = json.loads(attributes["parameters_json"])
    above, key = random_.choice(list(_entries(table)))
    new = random_.choice((None, "word", 7, -1, 0, 1e300, True, [], {}, [None], {"a": 1}, "", [1, "x"], float("nan"),
                          10**400, [[[[]]]], "missing"))
    if new == "missing":
        del above[key]
    else:
        above[key] = new
    attributes["parameters_json"] = json.dumps(table)
    return f"parameter {key}: {str(new)[:20]!r}"


def _entries(table):
    for key, value in table.items() if isinstance(table, dict) else enumerate(table):
        yield table, key
        if isinstance(value, (dict, list)):
            yield from _entries(value)


# --- one of them all ------------------------------------------------------------------------------

def damaged(folder, random_, kinds):
    """(bytes, what was done) of a history of one of the kinds: a bit, a few changes of bytes, or one by HDF5.

    HDF5 cannot change those of a killed run, which have the first two alone.
    """
    paths, victim = originals(folder), folder / "victim.h5"
    kind, way = random_.choice(kinds), random_.random()
    victim.write_bytes(paths[kind].read_bytes())
    if way < 0.4:
        done = flip(victim, random_)
    elif way < 0.6 or kind == KILLED:
        data, done = mutate(victim.read_bytes(), random_, [path.read_bytes() for path in paths.values()], BYTES)
        victim.write_bytes(data)
    else:
        done = change(victim, random_)
        if kind == FINISHED and "HDF5 crashed" not in done and victim.read_bytes()[:8] != HDF5:
            seal(victim)
    return victim.read_bytes(), f"{kind}: {done}"


def use(path):
    """Read a history and work out what the commands tell of it."""
    history = read_history(path)
    summarise(history)
    for table in (index_table, events_table, joints_table, cycles_table, summary_row):
        table(history)
