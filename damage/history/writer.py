"""Writer of the history file: one HDF5 file for each run, readable while it grows.

The schema is in `docs/reference/history-schema.md`.  All datasets exist before the file enters
HDF5's single-writer multiple-reader mode, so that flushed data survive SIGKILL.  When the file is
closed, its head is sealed with the checksum of everything behind it.
"""

import fcntl
import json
import os
import platform
import re
import shutil
import sys
from contextlib import contextmanager
from datetime import UTC, datetime
from pathlib import Path
from types import MappingProxyType

import h5py
import numpy as np
import pandas as pd
import scipy

from damage.errors import InputError, WriteError
from damage.history import schema
from damage.history.buffer import CHUNK, SNAPSHOT_SAMPLES, Buffer
from damage.history.head import HEAD_BYTES, Head, seal, write_head
from damage.history.reader import read_history
from damage.provenance import shown_command

OF_HOUSES = ("snapshots/out_of_plane", *(f"house/{name}" for name in schema.HOUSE))
_LEAST_FREE = 1_000_000  # [bytes] on the disk, for a history to begin
_LEVEL = 2  # of gzip
_COLUMNS = 64  # of a chunk, where columns are added as contact points become active
# writers whose file could not be written: closing it would write again, and tear what is whole
_LEFT_OPEN = []


class File:
    """Sink of a Buffer: the file of one run.

    Raises WriteError where the disk is full or refuses data: the file stays unfinished, as of the
    last flush.  HDF5 cannot close in order then: end the process by os._exit.
    """

    def __init__(self, path, layout, attributes, overwrite=False):
        self.path = Path(path)
        self.where = str(path)
        self.attributes = attributes
        with self._writing():
            self._file = _create_file(self.path, overwrite)
            write_head(self.path, Head.of_run(attributes))
            _write_fixed(self._file, layout, attributes)
            # Kept open: a dataset that is closed unwritten loses its rows without a word where the
            # disk is full.
            self._growing = _create_growing(self._file, layout, attributes)
            self._file.swmr_mode = True  # HDF5 takes its own lock off the file
            self._lock = lock(self.path, fcntl.LOCK_SH)
            self._file.flush()

    @property
    def is_torn(self):
        """Whether writing has failed; nothing is written from then on."""
        return self in _LEFT_OPEN

    def static_stage(self, values):
        with self._writing():
            for name, value in values.items():
                self._file["static"][name][()] = value

    def add_parameters(self, parameters):
        add_parameters(self.attributes, parameters)
        with self._writing():
            self._file["run"].attrs.update(self.attributes)
            self._file.flush()

    def discard(self):
        """Close the file and delete it."""
        with self._writing():
            self._file.close()
            self._lock.close()
            self.path.unlink()

    def rows(self):
        """Numbers of rows in the file, of each group of GROWING in turn."""
        counts = {path.partition("/")[0]: len(dataset) for path, dataset in self._growing.items()}
        return [counts.get(group, 0) for group in schema.GROWING]

    def copy_rows(self, file, counts):
        """Copy what another open file holds of the same run: the static stage, and so many rows of
        each group."""
        self.static_stage({name: file["static"][name][()] for name in schema.STATIC})
        count_of = dict(zip(schema.GROWING, counts))
        with self._writing():
            for path, dataset in self._growing.items():
                group = path.partition("/")[0]
                count = count_of.get(group, 0)
                for first in range(0, count, dataset.chunks[0]):
                    _extend(dataset, file[path][first : min(count, first + dataset.chunks[0])])
                if group == "frames":  # later samples had more
                    dataset.resize(count_of["active"], axis=1)
            self._file.flush()

    def active(self):
        """The contact points that are active, in that order."""
        return self._growing["active/joint"][:].tolist()

    def keep_state(self, state):
        with self._writing():
            _extend(self._growing[schema.STATE], state)

    def store(self, columns):
        with self._writing():
            for path, rows in columns.items():
                _extend(self._growing[path], rows)
                self._growing[path].flush()
            self._file.flush()

    def finish(self, status, collapsed_at_s):
        with self._writing():
            if collapsed_at_s is not None:
                self._file["run/collapsed_at_s"][()] = collapsed_at_s
            self._file["run/status"][()] = schema.STATUS.index(status)
            self._file.close()
            seal(self.path)
            self._lock.close()

    def history(self, path):
        return read_history(path)

    @contextmanager
    def _writing(self):
        """Raise a WriteError from HDF5's error of a failed write."""
        try:
            yield
        except (OSError, RuntimeError) as error:
            _LEFT_OPEN.append(self)
            message = re.search(r"error message = '([^']*)'", str(error))
            cause = message[1] if message else str(error).splitlines()[0]
            raise WriteError(
                f"cannot write {self.path} ({cause}):"
                " what was flushed is kept, unfinished; make room, and run it again"
            ) from error


class HistoryWriter(Buffer):
    """Buffer of a run that writes its file.

    path: of the new file; an existing one raises InputError unless `overwrite`.
    layout: damage.wall.layout.Layout; parameters: dictionary fit for JSON of everything that
    defines the run, with its `command` where it is not that of this process.
    solver: "yade" or "reference"; versions: {software: version}, with "masonry-damage" and "model",
    the digest of the model's code, where they are known.
    """

    make_sink = File

    def __init__(self, path, layout, *, solver, parameters, versions, overwrite=False):
        attributes = run_attributes(layout, solver, parameters, versions)
        super().__init__(layout, self.make_sink(path, layout, attributes, overwrite))


def check_output(path, overwrite=False):
    """Raise InputError if a history cannot be written to `path`; make its folder where missing."""
    path = Path(path)
    try:
        _check_taken(path, overwrite)
        path.parent.mkdir(parents=True, exist_ok=True)
        probe = path.parent / f".{path.name}.{os.getpid()}.probe"
        probe.touch()
        probe.unlink()
        free = shutil.disk_usage(path.parent).free
    except OSError as error:
        raise InputError(
            f"cannot write to folder {path.parent}: {error.strerror}; "
            "choose another with --out FILE.h5"
        ) from error
    if free < _LEAST_FREE:
        raise InputError(
            f"{path.parent} has {free / 1e6:.2g} MB free: expected {_LEAST_FREE / 1e6:g} MB or"
            " more; make room, or choose another with --out FILE.h5"
        )


def _check_taken(path, overwrite):
    if path.is_dir():
        raise InputError(f"{path} is a folder: expected a file name; give --out FILE.h5")
    # the pictures' folder has the name without it, so that no two runs share one
    if path.suffix != ".h5":
        raise InputError(f"--out {path}: expected a name that ends in .h5; give --out {path}.h5")
    if not path.exists():
        return
    if not overwrite:
        raise InputError(f"{path} exists already: it is kept; give --overwrite or another --out")
    if not (path.is_file() and (path.stat().st_size == 0 or h5py.is_hdf5(path))):
        raise InputError(
            f"{path} is no history, and --overwrite replaces none but those: give another --out"
        )
    lock(path, fcntl.LOCK_EX).close()


def _create_file(path, overwrite):
    check_output(path, overwrite)
    if path.exists():
        with lock(path, fcntl.LOCK_EX):
            path.unlink()
    try:
        # which Debian 12's HDF5 reads, too
        return h5py.File(path, "x", libver="v110", userblock_size=HEAD_BYTES)
    except FileExistsError:
        raise InputError(
            f"{path} exists now: another run began it at this moment; give another --out"
        ) from None


def lock(path, kind):
    """The file of a history, open and locked until it is closed: LOCK_SH by the run that writes it,
    LOCK_EX by one that would replace it.  Raises InputError where another has it; a file system
    without locks has none."""
    file = open(path, "rb")  # noqa: SIM115, open as long as the lock is held
    try:
        fcntl.flock(file, kind | fcntl.LOCK_NB)
    except BlockingIOError:
        file.close()
        raise InputError(
            f"{path} is in use: another run writes it, or a program reads it; wait for its end, or"
            " give another --out"
        ) from None
    except OSError:
        pass
    return file


def run_attributes(layout, solver, parameters, versions):
    """The attributes of a history's run, {name: words or number}; arguments as of HistoryWriter."""
    command = parameters.get("command") or shown_command(sys.argv)
    parameters = {name: value for name, value in parameters.items() if name != "command"}
    versions = {
        "python": platform.python_version(),
        "numpy": np.__version__,
        "scipy": scipy.__version__,
        "pandas": pd.__version__,
        "h5py": h5py.__version__,
        "hdf5": h5py.version.hdf5_version,
        **versions,
    }
    return {
        "solver": solver,
        "wall": layout.wall.name,
        "command": command,
        "created_utc": datetime.now(UTC).isoformat(timespec="seconds"),
        "machine": f"{platform.system()} {platform.machine()}",
        "parameters_json": json.dumps(parameters, sort_keys=True),
        "versions_json": json.dumps(versions, sort_keys=True),
        "total_joint_length_m": layout.total_joint_length,
        "drift_height_m": layout.drift_height,
        "height_m": layout.wall.built_height,
        "length_m": layout.wall.length,
    }


def add_parameters(attributes, parameters):
    """Add parameters to those in the attributes of a history's run."""
    merged = json.loads(attributes["parameters_json"]) | parameters
    attributes["parameters_json"] = json.dumps(merged, sort_keys=True)


def _write_fixed(file, layout, attributes):
    """Write the datasets that do not grow; those of `run` and `static` are filled later."""
    file.attrs["schema"] = schema.SCHEMA
    file.attrs["schema_version"] = schema.SCHEMA_VERSION
    file.create_group("run").attrs.update(attributes)
    for path, values in fixed_tables(layout).items():
        file.create_dataset(path, data=values).attrs["unit"] = schema.COLUMNS[path].unit


def fixed_tables(layout, status="unfinished", collapsed_at_s=None, static=MappingProxyType({})):
    """What does not grow in the history of a run, {"GROUP/NAME": number or array}; collapsed_at_s:
    [s], None where no brick fell; static: results of the static stage, where it has ended."""
    return {
        "run/status": np.uint8(schema.STATUS.index(status)),
        "run/collapsed_at_s": np.float64(np.nan if collapsed_at_s is None else collapsed_at_s),
        **{f"static/{name}": np.float64(static.get(name, np.nan)) for name in schema.STATIC},
        **layout_tables(layout),
    }


def layout_tables(layout):
    """The joints, bodies and supports, which do not change during a run: {"GROUP/NAME": array}."""
    points = layout.contacts
    bodies = layout.bodies
    supports = layout.supports
    n = layout.n_joints
    joints = (
        points.kind.astype("u1"),
        points.first,
        points.second,
        points.x,
        points.z,
        points.length,
        points.area,
        points.normal_stiffness,
        points.shear_stiffness,
        points.elastic,
        points.tensile_strength,
        points.cohesion,
    )
    tables = {
        "joints": [values[:n] for values in joints],
        "bodies": (
            bodies.x,
            bodies.z,
            bodies.length,
            bodies.height,
            bodies.mass,
            bodies.inertia,
            bodies.course,
        ),
        "supports": (supports.left, supports.right),
        **layout.more_tables,
    }
    return {
        f"{group}/{name}": np.asarray(data, column.dtype)
        for group, values in tables.items()
        for (name, column), data in zip(schema.TABLES[group].items(), values, strict=True)
    }


def growing_columns(layout, attributes):
    """{"GROUP/NAME": (Column, shape of a row)} of the datasets that grow during a run with these
    attributes; rows of frames begin without active contact points."""
    optional = {
        "stresses/joint_stress_pa": json.loads(attributes["parameters_json"]).get("stresses"),
        **dict.fromkeys(OF_HOUSES, layout.IN_SPACE),
    }
    sizes = {
        "joints": layout.n_joints,
        "bodies": layout.n_bodies,
        "supports": len(layout.supports),
        "active": 0,
        "walls": len(layout.walls),
    }
    columns = {}
    for path, column in schema.COLUMNS.items():
        group = path.partition("/")[0]
        if group in schema.GROWING and optional.get(path, True):
            shape = schema.ROW_SHAPES.get(path, schema.ROW_SHAPES.get(group, ()))
            columns[path] = column, tuple(sizes.get(size, size) for size in shape)
    return columns


def _create_growing(file, layout, attributes):
    """Empty datasets, {"GROUP/NAME": dataset}; attributes: of the run."""
    chunks = {
        "active": 1024,
        "events": 1024,
        "static_stage": 1024,
        "state": 1 << 16,
        "snapshots": CHUNK // SNAPSHOT_SAMPLES,
    }
    for group in schema.GROWING:
        file.create_group(group)
    made = {}
    columns = min(_COLUMNS, layout.n_joints)
    for path, (column, shape) in growing_columns(layout, attributes).items():
        rows = chunks.get(path.partition("/")[0], CHUNK)
        made[path] = file.create_dataset(
            path,
            shape=(0, *shape),
            maxshape=(None, *(size or layout.n_joints for size in shape)),
            dtype=column.dtype,
            compression="gzip",
            compression_opts=_LEVEL,
            shuffle=True,
            chunks=(rows, *(size or columns for size in shape)),
        )
        made[path].attrs["unit"] = column.unit
    for path, names in schema.CODES.items():
        file[path].attrs["codes"] = ", ".join(names)
    return made


def _extend(dataset, rows):
    """Append rows, which have as many columns as those before, or more."""
    start = len(dataset)
    dataset.resize((start + len(rows), *rows.shape[1:]))
    dataset[start:] = rows
