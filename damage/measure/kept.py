"""Patterns at rest: what stays of a run whose history is not kept (`--keep patterns`), some kilobytes instead of
megabytes.

A pattern file is a NumPy archive with the fields of `Patterns`; its SHA-256 is in the record of its run
(`damage.studies.records`).
"""

import hashlib
import io
import zipfile
import zlib
from typing import NamedTuple

import numpy as np

from damage.checks import check_file
from damage.errors import InputError, one_line
from damage.files import whole_or_nothing
from damage.history.moments import nearest_snapshot

START, SETTLED = -1, 0
"""Numbers of the moments before any motion, and at the end of the settlement; events count from 1."""
FOLDER, ENDING, MOST_MB = "patterns", ".npz", 50
MOST_MOMENTS = 10_000
"""Moments of a file: a life at an address has tens of events."""
_TYPES = {"moment": "<i4", "joints": "<i4", "opening_m": "<f4", "offset_m": "<f4", "displacement": "<f4"}
_REMEDY = "delete it, and the same command makes it again"


class Patterns(NamedTuple):
    """The contact points and bricks of a run at rest.

    moment: (n,) START, SETTLED where the ground settled, then the numbers of the events, at the end of each; joints:
    (k,) indices of the contact points that opened or slid by then; opening_m, offset_m: (n, k) as of a History, [m];
    displacement: (n, n_bodies, 3) [m, m, rad] since the end of the static stage, NaN where no snapshot is near.
    """

    moment: np.ndarray
    joints: np.ndarray
    opening_m: np.ndarray
    offset_m: np.ndarray
    displacement: np.ndarray

    def at(self, moment, n_joints):
        """Opening and offset (n_joints,) [m] of all contact points at a moment; the last one where it is None."""
        row = len(self.moment) - 1 if moment is None else int(np.flatnonzero(self.moment == moment)[0])
        whole = np.zeros((2, n_joints))
        whole[:, self.joints] = self.opening_m[row], self.offset_m[row]
        return whole


def patterns_of(history):
    """The Patterns of a History."""
    series, active = history.series, history.active
    settled = np.flatnonzero(series["stage"] == "settlement")
    moving = series[series["stage"] != "settlement"]
    rows = {START: 0, **({SETTLED: int(settled[-1])} if len(settled) else {}),
            **{int(event): int(members.index[-1]) for event, members in moving.groupby("shock") if len(members)}}
    samples = list(rows.values())
    opening, offset = active.opening_m[samples], active.slip_by("displacement")[samples]
    used = ((opening != 0) | (offset != 0)).any(axis=0)
    moved = [nearest_snapshot(history, time_s) for time_s in series["time_s"].iloc[samples]]
    none = np.full(history.displacement.shape[1:], np.nan)
    displacement = np.array([none if one is None else history.displacement[one] for one in moved])
    return Patterns(np.array(list(rows), "i4"), active.joints[used].astype("i4"),
                    *(of[:, used].astype("f4") for of in (opening, offset)), displacement.astype("f4"))


def write_patterns(patterns, path):
    """Write Patterns into a file; returns the SHA-256 of its bytes."""
    content = io.BytesIO()
    np.savez_compressed(content, **patterns._asdict())
    with whole_or_nothing(path) as unfinished:
        unfinished.write_bytes(content.getvalue())
    return hashlib.sha256(content.getvalue()).hexdigest()


def read_patterns(path, sha256, layout):
    """The Patterns of a file; raises InputError.

    sha256: of its bytes, as the record of the run has it; layout: of the wall, whose contact points and bodies say
    what the file may hold before any of it is unpacked.
    """
    path = check_file(path, "the patterns of a run (.npz)", MOST_MB)
    content = path.read_bytes()
    if (found := hashlib.sha256(content).hexdigest()) != sha256:
        raise InputError(f"{path} is not what its run wrote: SHA-256 {found[:12]}, expected {str(sha256)[:12]} by the "
                         f"run's record; {_REMEDY}")
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            _check_shapes({name: _shape_in(archive, name) for name in Patterns._fields}, layout)
        with np.load(io.BytesIO(content), allow_pickle=False) as archive:
            patterns = Patterns(*(archive[name] for name in Patterns._fields))
        if not np.isin(patterns.joints, range(layout.n_joints)).all():
            raise ValueError("contact points that the wall does not have")
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile, zlib.error) as error:
        raise InputError(f"{path}: cannot be read as the patterns of a run ({one_line(error)}): "
                         f"expected what --keep patterns wrote for this wall; {_REMEDY}") from error
    return patterns


def _shape_in(archive, name):
    """The shape that the head of an array in a ZipFile states; ValueError where its type is another."""
    with archive.open(f"{name}.npy") as file:
        if np.lib.format.read_magic(file) != (1, 0):
            raise ValueError(f"{name} in another version of NumPy's format")
        shape, _, dtype = np.lib.format.read_array_header_1_0(file)
    if dtype != np.dtype(_TYPES[name]):
        raise ValueError(f"{name} of the type {dtype}, expected {_TYPES[name]}")
    return shape


def _check_shapes(shape, layout):
    """Raise ValueError where arrays of shapes {field: shape} cannot be of a wall with this Layout."""
    n, k = (shape[name][0] if len(shape[name]) == 1 else -1 for name in ("moment", "joints"))
    if not 0 < n <= MOST_MOMENTS or not 0 <= k <= layout.n_joints:
        raise ValueError(f"{n} moments and {k} contact points, expected up to {MOST_MOMENTS} and {layout.n_joints}")
    expected = {"opening_m": (n, k), "offset_m": (n, k), "displacement": (n, len(layout.bodies.x), 3)}
    if wrong := [name for name, one in expected.items() if shape[name] != one]:
        raise ValueError(f"{wrong[0]} of shape {shape[wrong[0]]}, expected {expected[wrong[0]]}")
