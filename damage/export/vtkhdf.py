"""A history as one VTKHDF file with all its times, for ParaView 5.12 and VTK 9.3 or newer.

The grid is stored once.  Every sample of the history is a step: joints, index and series as they were then, bodies as
in the snapshot nearest to it, whose time is `snapshot_time_s`; nothing is interpolated.  The layout is that of
Kitware's VTKHDF 2.2: https://docs.vtk.org/en/latest/vtk_file_formats/vtkhdf_file_format/vtkhdf_specifications.html
"""

import io
from pathlib import Path

import h5py
import numpy as np

from damage.export.cells import WallCells
from damage.files import whole_or_nothing

VERSION = 2, 2


def write_vtkhdf(history, path):
    """Write a History as VTKHDF, whole or not at all; returns the path.  Raises InputError where it cannot be written,
    or holds no sample."""
    content = io.BytesIO()  # HDF5 itself cannot be left in order once a write has failed
    with h5py.File(content, "w") as file:
        _fill(file.create_group("VTKHDF"), WallCells(history))
    with whole_or_nothing(path) as unfinished:
        unfinished.write_bytes(content.getbuffer())
    return Path(path)


def _fill(root, cells):
    root.attrs["Version"] = np.array(VERSION, np.int64)
    root.attrs["Type"] = np.bytes_("UnstructuredGrid")
    for name, values in {"Points": cells.points, "Connectivity": cells.connectivity, "Offsets": cells.offsets,
                         "Types": cells.types, "NumberOfPoints": [len(cells.points)],
                         "NumberOfCells": [len(cells.types)],
                         "NumberOfConnectivityIds": [len(cells.connectivity)]}.items():
        root[name] = np.asarray(values)
    steps = _steps(root, cells.time_s)
    samples, n_snapshots = np.arange(len(cells.time_s)), len(cells.history.snapshot_time_s)
    shapes = [*range(n_snapshots), -1]  # the last: at rest
    shape_of = np.where(cells.snapshot_of < 0, n_snapshots, cells.snapshot_of)
    _keep(root, steps, "PointData", shapes, shape_of, lambda k: {"displacement_m": cells.displacement(k)})
    _keep(root, steps, "CellData", shapes, shape_of, cells.body_fields)
    _keep(root, steps, "CellData", [0], np.zeros_like(samples), lambda k: cells.fixed)
    _keep(root, steps, "CellData", samples, samples, cells.joint_fields)
    for name, values in cells.numbers.items():
        root[f"FieldData/{name}"] = values.to_numpy(float)
        steps[f"FieldDataOffsets/{name}"] = samples
        steps[f"FieldDataSizes/{name}"] = np.ones((len(samples), 2), np.int64)  # components, tuples


def _steps(root, time_s):
    """The group of the steps, which all have the one grid; time_s: (n_steps,)."""
    steps, zeros = root.create_group("Steps"), np.zeros(len(time_s), np.int64)
    steps.attrs["NSteps"] = len(time_s)
    steps["Values"] = time_s
    steps["NumberOfParts"] = np.ones_like(zeros)
    for name in ("PartOffsets", "PointOffsets"):
        steps[name] = zeros
    for name in ("CellOffsets", "ConnectivityIdOffsets"):
        steps[name] = zeros[:, None]  # a column for each topology, of which there is one
    return steps


def _keep(root, steps, kind, blocks, block_of_step, make):
    """Write arrays block by block, and say which block each step has, by its place; make(block): {name: array}, alike
    for all blocks, as many rows as the grid has points or cells."""
    for place, block in enumerate(blocks):
        for name, values in make(block).items():
            rows = len(values)
            if place == 0:
                root.create_dataset(f"{kind}/{name}", (len(blocks) * rows, *values.shape[1:]), values.dtype,
                                    chunks=values.shape, compression="gzip", compression_opts=1, shuffle=True)
                steps[f"{kind}Offsets/{name}"] = np.asarray(block_of_step, np.int64) * rows
            root[f"{kind}/{name}"][place * rows:(place + 1) * rows] = values
