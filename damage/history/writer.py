"""The history file: one HDF5 file a run, written step by step and readable while it grows.

`docs/history-schema.md` is the schema.  All datasets are made first; then the file is in HDF5's
single-writer multiple-reader mode, so that what was flushed is whole even after SIGKILL.
"""

import json
import os
import platform
import sys
from datetime import UTC, datetime
from pathlib import Path

import h5py
import numpy as np

from damage.errors import InputError
from damage.history.schema import EVENTS, SCHEMA, SCHEMA_VERSION, SERIES, STAGES, STATIC, STATUS
from damage.wall.layout import KINDS

_EVENT_COLUMNS = {
    "time_s": ("f8", "s"), "joint": ("i4", "index of joints"), "kind": ("u1", "code"),
    "normal_stress_pa": ("f8", "Pa"), "shear_stress_pa": ("f8", "Pa"),
    "opening_m": ("f8", "m"), "slip_m": ("f8", "m"),
}
SNAPSHOT_SAMPLES = 10
"""Samples between two snapshots of the bodies."""
_CHUNK = 120  # samples buffered before they are written, with their snapshots: whole chunks, each written once


class HistoryWriter:
    """Write one run.  Call `append`, `event` and `snapshot` as it goes, `finish` at the end.

    path: of the new file; an existing one raises InputError unless `overwrite`.
    layout: damage.wall.layout.Layout; parameters: JSON-able dictionary of all that defines the run, and the `command`
    that asked for it, where that is not this process's own.
    solver: "yade" or "reference"; versions: {software: version}.
    """

    def __init__(self, path, layout, *, solver, parameters, versions, overwrite=False):
        self.path = Path(path)
        self._file = _create_file(self.path, overwrite)
        self._rows, self._frames, self._events, self._snapshots = [], [], [], []
        _write_run_attributes(self._file, layout, solver, parameters, versions)
        _write_tables(self._file, layout)
        _create_growing(self._file, layout)
        self._file.swmr_mode = True
        self.flush()

    def static_stage(self, **values):
        """Store what the static stage ended with; keys are those of STATIC."""
        for name, value in values.items():
            self._file["static"][name][()] = value
        self.flush()

    def append(self, stage, row, opening, slip, state):
        """Add one sample.

        stage: one of STAGES; row: {column of SERIES: value}, missing ones become NaN;
        opening [m], slip [m], state (bits BROKEN, AT_LIMIT): arrays (n_joints,).
        """
        self._rows.append((STAGES.index(stage), *(row.get(name, np.nan) for name in SERIES)))
        self._frames.append((np.array(opening, "f4"), np.array(slip, "f4"), np.array(state, "u1")))
        if len(self._rows) >= _CHUNK:
            self.flush()

    def event(self, time_s, joint, kind, normal_stress=0.0, shear_stress=0.0, opening=0.0, slip=0.0):
        """Add one event; kind: one of EVENTS; stresses [Pa] at the break, opening and slip [m]."""
        self._events.append((time_s, joint, EVENTS.index(kind), normal_stress, shear_stress,
                             opening, slip))

    def snapshot(self, time_s, displacement):
        """Add the bodies' displacement (n_bodies, 3) [m, m, rad] since the end of the static stage."""
        self._snapshots.append((time_s, np.array(displacement, "f4")))

    def flush(self):
        """Write what is buffered and make it safe."""
        if self._rows:
            for name, column in zip(("stage", *SERIES), zip(*self._rows)):
                _extend(self._file["series"][name], column)
            for name, column in zip(("opening_m", "slip_m", "state"), zip(*self._frames)):
                _extend(self._file["frames"][name], column)
        if self._events:
            for name, column in zip(_EVENT_COLUMNS, zip(*self._events)):
                _extend(self._file["events"][name], column)
        if self._snapshots:
            for name, column in zip(("time_s", "displacement"), zip(*self._snapshots)):
                _extend(self._file["snapshots"][name], column)
        self._rows, self._frames, self._events, self._snapshots = [], [], [], []
        self._file.flush()

    def finish(self, status, collapsed_at_s=None):
        """Mark how the run ended and close the file; status: one of STATUS."""
        self.flush()
        if collapsed_at_s is not None:
            self._file["run/collapsed_at_s"][()] = collapsed_at_s
        self._file["run/status"][()] = STATUS.index(status)
        self._file.close()


def check_output(path, overwrite=False):
    """Raise InputError if a history cannot be written to `path`; make its folder where missing."""
    path = Path(path)
    if path.is_dir():
        raise InputError(f"{path} is a folder: expected a file name; give --out FILE.h5")
    if path.exists() and not overwrite:
        raise InputError(f"{path} exists already: it is kept; give --overwrite or another --out")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        probe = path.parent / f".{path.name}.{os.getpid()}.probe"
        probe.touch()
        probe.unlink()
    except OSError as error:
        raise InputError(f"cannot write to folder {path.parent}: {error.strerror}; "
                         "choose another with --out FILE.h5") from error


def _create_file(path, overwrite):
    check_output(path, overwrite)
    path.unlink(missing_ok=True)
    return h5py.File(path, "w", libver="latest")


def _write_run_attributes(file, layout, solver, parameters, versions):
    file.attrs["schema"] = SCHEMA
    file.attrs["schema_version"] = SCHEMA_VERSION
    run = file.create_group("run")
    command = parameters.get("command") or " ".join(sys.argv)
    parameters = {name: value for name, value in parameters.items() if name != "command"}
    versions = {"python": platform.python_version(), "numpy": np.__version__,
                "h5py": h5py.__version__, "hdf5": h5py.version.hdf5_version, **versions}
    run.attrs.update({
        "solver": solver, "wall": layout.wall.name, "command": command,
        "created_utc": datetime.now(UTC).isoformat(timespec="seconds"),
        "machine": f"{platform.system()} {platform.machine()}",
        "parameters_json": json.dumps(parameters, sort_keys=True),
        "versions_json": json.dumps(versions, sort_keys=True),
        "total_joint_length_m": layout.total_joint_length, "drift_height_m": layout.drift_height,
        "height_m": layout.wall.built_height, "length_m": layout.wall.length,
    })
    run.create_dataset("status", data=np.uint8(0)).attrs["codes"] = ", ".join(STATUS)
    run.create_dataset("collapsed_at_s", data=np.nan).attrs["unit"] = "s"
    for name, unit in STATIC.items():
        file.create_dataset(f"static/{name}", data=np.nan).attrs["unit"] = unit


def _write_tables(file, layout):
    """The joints and the bodies, which do not change during a run."""
    contacts, bodies, n = layout.contacts, layout.bodies, layout.n_joints
    joints = {
        "kind": (contacts.kind.astype("u1"), "code"), "first_body": (contacts.first, "index, -1 ground"),
        "second_body": (contacts.second, "index"), "x_m": (contacts.x, "m"), "z_m": (contacts.z, "m"),
        "length_m": (contacts.length, "m"), "area_m2": (contacts.area, "m2"),
        "normal_stiffness_pa_m": (contacts.normal_stiffness, "Pa/m"),
        "shear_stiffness_pa_m": (contacts.shear_stiffness, "Pa/m"), "elastic": (contacts.elastic, "bool"),
        "tensile_strength_pa": (contacts.tensile_strength, "Pa, infinite where elastic"),
        "cohesion_pa": (contacts.cohesion, "Pa, infinite where elastic"),
    }
    for name, (values, unit) in joints.items():
        file.create_dataset(f"joints/{name}", data=values[:n]).attrs["unit"] = unit
    file["joints/kind"].attrs["codes"] = ", ".join(KINDS[:2])
    table = {"x_m": (bodies.x, "m"), "z_m": (bodies.z, "m"), "length_m": (bodies.length, "m"),
             "height_m": (bodies.height, "m"), "mass_kg": (bodies.mass, "kg"),
             "inertia_kg_m2": (bodies.inertia, "kg m2"), "course": (bodies.course, "index, -1 cap")}
    for name, (values, unit) in table.items():
        file.create_dataset(f"bodies/{name}", data=values).attrs["unit"] = unit


def _create_growing(file, layout):
    def growing(name, dtype, unit, shape=(), rows=_CHUNK):
        dataset = file.create_dataset(name, shape=(0, *shape), maxshape=(None, *shape), dtype=dtype,
                                      chunks=(rows, *shape), compression="gzip", compression_opts=2, shuffle=True)
        dataset.attrs["unit"] = unit
        return dataset

    growing("series/stage", "u1", "code").attrs["codes"] = ", ".join(STAGES)
    for name, unit in SERIES.items():
        growing(f"series/{name}", "f8", unit)
    joints = (layout.n_joints,)
    growing("frames/opening_m", "f4", "m", joints)
    growing("frames/slip_m", "f4", "m", joints)
    growing("frames/state", "u1", "bits: 1 broken, 2 has been at the shear limit", joints)
    for name, (dtype, unit) in _EVENT_COLUMNS.items():
        growing(f"events/{name}", dtype, unit, rows=1024)
    file["events/kind"].attrs["codes"] = ", ".join(EVENTS)
    snapshots = _CHUNK // SNAPSHOT_SAMPLES
    growing("snapshots/time_s", "f8", "s", rows=snapshots)
    growing("snapshots/displacement", "f4", "m, m, rad", (len(layout.bodies), 3), snapshots)


def _extend(dataset, rows):
    rows = np.asarray(rows, dataset.dtype)
    start = dataset.shape[0]
    dataset.resize(start + len(rows), axis=0)
    dataset[start:] = rows
