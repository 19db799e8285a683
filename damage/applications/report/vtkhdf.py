"""A history as one VTKHDF file with all its times, for ParaView 5.12 and VTK 9.3 or newer.

The grid is stored once.  Every sample of the history is a step: joints, index and series as they
were then, bodies as in the snapshot nearest to it, whose time is `snapshot_time_s`; nothing is
interpolated.  The layout is that of Kitware's VTKHDF 2.2:
https://docs.vtk.org/en/latest/vtk_file_formats/vtkhdf_file_format/vtkhdf_specifications.html

Bricks are hexahedra, joints are lines.  The points lie where they are at rest and `displacement_m`
says how far they have moved: ParaView's filter Warp By Vector shows the moved wall, magnified as
one likes.  Every brick has eight points of its own and every contact point two, the ends of its
tributary length on the front face, so that a joint can open:

        3 ---- 2         z          4 to 7 in front, at y = -thickness/2, 0 to 3 behind;
        |      |         |          the joints' lines are in front
        0 ---- 1         o--- x     cells: all bodies of the history, then all its contact points
"""

import io
from dataclasses import dataclass
from functools import cached_property, partial

import h5py
import numpy as np
import pandas as pd

from damage.files import write_bytes
from damage.history.in_space import InPlane, InSpace, motion_of
from damage.history.moments import check_samples, joint_states, nearest_snapshot, support_motion
from damage.history.reader import History
from damage.wall.kinds import rows

VERSION = 2, 2
HEXAHEDRON = 12
LINE = 3
"""VTK's codes of the cells."""
SERIES = (
    "drift_ratio",
    "top_displacement_m",
    "base_acceleration_x_m_s2",
    "base_acceleration_z_m_s2",
    "base_shear_n",
    "top_force_n",
)
"""Columns of the history's series that go along, one number a time, with the index and its
components."""


def write_vtkhdf(history, path):
    """Write a History as VTKHDF, whole or not at all; returns the path.  Raises InputError where it
    cannot be written, or holds no sample."""
    check_samples(history)
    content = io.BytesIO()  # HDF5 itself cannot be left in order once a write has failed
    with h5py.File(content, "w") as file:
        _fill(file.create_group("VTKHDF"), Cells(history))
    return write_bytes(path, content.getbuffer())


def _fill(root, cells):
    root.attrs["Version"] = np.array(VERSION, np.int64)
    root.attrs["Type"] = np.bytes_("UnstructuredGrid")
    # of the cells one after the other, so that their connectivity counts them
    n_points = len(cells.points)
    for name, values in {
        "Points": cells.points,
        "Connectivity": np.arange(n_points),
        "Offsets": np.concatenate([[0], np.cumsum(cells.joined(8, 2))]),
        "Types": cells.types,
        "NumberOfPoints": [n_points],
        "NumberOfCells": [len(cells.types)],
        "NumberOfConnectivityIds": [n_points],
    }.items():
        root[name] = np.asarray(values)
    time_s = cells.history.time_s
    steps = _steps(root, time_s)
    samples = np.arange(len(time_s))
    shapes = [*range(len(cells.history.snapshot_time_s)), None]  # the last: at rest
    shape_of = cells.snapshot_of
    keep = partial(_keep, root, steps)
    keep("PointData", shapes, shape_of, lambda k: {"displacement_m": cells.displacement(k)})
    keep("CellData", shapes, shape_of, lambda k: {"rotation_rad": cells.rotation(k)})
    keep("CellData", [0], np.zeros_like(samples), lambda k: cells.fixed)
    keep("CellData", samples, samples, cells.joint_fields)
    for name, values in cells.numbers.items():
        root[f"FieldData/{name}"] = values.to_numpy(float)
        steps[f"FieldDataOffsets/{name}"] = samples
        steps[f"FieldDataSizes/{name}"] = np.ones((len(samples), 2), np.int64)  # components, tuples


def _steps(root, time_s):
    """The group of the steps, which all have the one grid; time_s: (n_steps,)."""
    steps = root.create_group("Steps")
    zeros = np.zeros(len(time_s), np.int64)
    steps.attrs["NSteps"] = len(time_s)
    steps["Values"] = time_s
    steps["NumberOfParts"] = np.ones_like(zeros)
    for name in ("PartOffsets", "PointOffsets"):
        steps[name] = zeros
    for name in ("CellOffsets", "ConnectivityIdOffsets"):
        steps[name] = zeros[:, None]  # a column for each topology, of which there is one
    return steps


def _keep(root, steps, kind, blocks, block_of_step, make):
    """Write arrays block by block, and say which block each step has, by its place; make(block):
    {name: array}, alike for all blocks, as many rows as the grid has points or cells."""
    for place, block in enumerate(blocks):
        for name, values in make(block).items():
            rows = len(values)
            if place == 0:
                root.create_dataset(
                    f"{kind}/{name}",
                    (len(blocks) * rows, *values.shape[1:]),
                    values.dtype,
                    chunks=values.shape,
                    compression="gzip",
                    compression_opts=1,
                    shuffle=True,
                )
                steps[f"{kind}Offsets/{name}"] = np.asarray(block_of_step, np.int64) * rows
            root[f"{kind}/{name}"][place * rows : (place + 1) * rows] = values


@dataclass(frozen=True)
class Cells:
    """The cells of a wall or a house, and what is known of them at the samples of its history;
    n_cells = n_bodies + n_joints."""

    history: History

    @cached_property
    def points(self):
        """Points at rest, (n_points, 3) [m]: eight a body, then two a contact point."""
        return self._placed(None)

    @cached_property
    def _space(self):
        return (InSpace if self.history.kind == "house" else InPlane)(self.history)

    def _placed(self, snapshot):
        """The points in a snapshot, None for at rest, (n_points, 3) [m]."""
        return np.concatenate(
            [places(snapshot).reshape(-1, 3) for places in (self._space.corners, self._space.ends)]
        )

    @cached_property
    def types(self):
        """VTK's code of every cell, (n_cells,)."""
        return self.joined(HEXAHEDRON, LINE).astype(np.uint8)

    @cached_property
    def fixed(self):
        """{name: (n_cells,)} of what time does not change: part, 0 brick, 1 cap, 2 bed joint, 3
        head joint, 4 cut of a brick; body and joint, rows of the history's tables, -1 in cells that
        are none; course; length_m; elastic; of a house the number of its wall, -1 of joints between
        two."""
        bodies = self.history.bodies
        joints = self.history.joints
        course = bodies["course"].to_numpy()
        kinds = joints["kind"].map({"bed": 2, "head": 3, "brick": 4})
        fixed = {
            "part": self.joined(np.where(course < 0, 1, 0), kinds.to_numpy()).astype(np.int8),
            "body": self.joined(np.arange(len(bodies)), -1),
            "joint": self.joined(-1, np.arange(len(joints))),
            "course": self.joined(course, -1),
            "length_m": self.joined(bodies["length_m"].to_numpy(), joints["length_m"].to_numpy()),
            "elastic": self.joined(0, joints["elastic"].to_numpy()).astype(np.int8),
        }
        if self.history.kind == "house":
            house = self.history.house
            fixed["wall"] = self.joined(house.body_wall, house.joint_wall)
        return fixed

    @cached_property
    def snapshot_of(self):
        """The snapshot nearest to every sample, (n_times,), their number where none is near: bodies
        are then drawn at rest."""
        none = len(self.history.snapshot_time_s)
        nearest = [nearest_snapshot(self.history, time_s) for time_s in self.history.time_s]
        return np.array([none if snapshot is None else snapshot for snapshot in nearest])

    def displacement(self, snapshot):
        """How far the points have moved in a snapshot, None for at rest, (n_points, 3) [m]."""
        return (self._placed(snapshot) - self.points).astype(np.float32)

    def rotation(self, snapshot):
        """Rotation of every cell in a snapshot in the plane of its wall, x towards z, (n_cells,)
        [rad]: of a joint the mean of its bodies'."""
        of_bodies = motion_of(self.history, snapshot)[:, 2]
        supports = support_motion(self.history, snapshot).motion[:, 2]
        joints = self.history.joints
        rotation = np.concatenate([of_bodies, supports])
        first, second = (
            rotation[np.minimum(rows(joints[name], len(of_bodies)), len(rotation) - 1)]
            for name in ("first_body", "second_body")
        )
        return np.concatenate([of_bodies, (first + second) / 2]).astype(np.float32)

    def joint_fields(self, sample):
        """{name: (n_cells,)} of the joints at a sample, zero in bodies: opening_m,
        accumulated_slip_m, offset_m, crack_width_m; state, a code of
        `damage.history.moments.JOINT_STATES`, in bodies -1; broken;
        at_shear_limit; joint_normal_stress_pa, joint_shear_stress_pa of a run with --stresses."""
        history = self.history
        opening_m = history.opening_m[sample]
        offset_m = history.offset_m[sample]
        numbers = {
            "opening_m": opening_m,
            "accumulated_slip_m": history.slip_m[sample],
            "offset_m": offset_m,
            "crack_width_m": np.hypot(opening_m, offset_m),
        }
        if history.joint_stress_pa is not None:
            numbers |= dict(
                zip(
                    ("joint_normal_stress_pa", "joint_shear_stress_pa"),
                    history.joint_stress_pa[sample].T,
                )
            )
        return {
            **{
                name: self.joined(0.0, values).astype(np.float32)
                for name, values in numbers.items()
            },
            "state": self.joined(-1, joint_states(history, sample)).astype(np.int8),
            "broken": self.joined(0, history.broken[sample]).astype(np.int8),
            "at_shear_limit": self.joined(0, history.at_limit[sample]).astype(np.int8),
        }

    @cached_property
    def numbers(self):
        """A DataFrame with a row a sample: DI and its components, of a house those of each wall
        under its name, with its drift along and displacement across; those of SERIES; time of the
        snapshot that is nearest, snapshot_time_s, NaN where none is near."""
        history = self.history
        tables = []
        for part in history.parts:
            table = part.index().drop(columns=["time_s", "drift_over_limit"])
            if part is not history:
                drift = part.series["drift_ratio"].to_numpy()
                table = table.assign(drift_ratio=drift, across_m=part.house.across_m[:, 0])
                table = table.add_suffix(f"_{part.wall}")
            tables.append(table)
        tables.append(history.series[list(SERIES)].reset_index(drop=True))
        shown_s = np.append(history.snapshot_time_s, np.nan)[self.snapshot_of]
        return pd.concat(tables, axis=1).assign(snapshot_time_s=shown_s)

    def joined(self, of_bodies, of_joints):
        """One array for all cells of values of the bodies and of the joints, arrays or numbers."""
        return np.concatenate(
            [
                np.broadcast_to(values, len(table))
                for values, table in (
                    (of_bodies, self.history.bodies),
                    (of_joints, self.history.joints),
                )
            ]
        )
