"""Patterns at rest: what stays of a run whose history is not kept (`--keep patterns`), some
kilobytes instead of megabytes.

A pattern file is a NumPy archive with the fields of `Patterns`; its SHA-256 is in the record of its
run (`damage.applications.studies.records`).
"""

import hashlib
import io
from typing import NamedTuple

import numpy as np

from damage.checks import check_file
from damage.errors import InputError
from damage.files import write_bytes
from damage.history.moments import nearest_snapshot

START = -1
"""Number of the moment before any motion; events count from 1."""
SETTLED = 0
"""Number of the moment at the end of the settlement."""
FOLDER = "patterns"
ENDING = ".npz"
_REMEDY = "delete it, and the same command makes it again"


class Patterns(NamedTuple):
    """The contact points and bricks of a run at rest.

    moment: (n,) START, SETTLED where the ground settled, then the numbers of the events, at the end
    of each; joints: (k,) indices of the contact points that opened or slid by then; opening_m,
    offset_m: (n, k) as of a History, [m]; displacement: (n, n_bodies, 3) [m, m, rad] since the end
    of the static stage, NaN where no snapshot is near.
    """

    moment: np.ndarray
    joints: np.ndarray
    opening_m: np.ndarray
    offset_m: np.ndarray
    displacement: np.ndarray

    def of_moment(self, moment, n_joints):
        """Opening and offset (n_joints,) [m] of all contact points at a moment; the last one where
        it is None."""
        row = (
            len(self.moment) - 1
            if moment is None
            else int(np.flatnonzero(self.moment == moment)[0])
        )
        whole = np.zeros((2, n_joints))
        whole[:, self.joints] = self.opening_m[row], self.offset_m[row]
        return whole


def patterns_of(history):
    """The Patterns of a History."""
    series = history.series
    active = history.active
    settled = np.flatnonzero(series["stage"] == "settlement")
    moving = series[series["stage"] != "settlement"]
    ends = moving.drop_duplicates("shock", keep="last")
    rows = {
        START: 0,
        **({SETTLED: settled[-1]} if len(settled) else {}),
        **dict(zip(ends["shock"], ends.index)),
    }
    samples = list(rows.values())
    opening = active.opening_m[samples]
    offset = active.offset_m[samples]
    used = ((opening != 0) | (offset != 0)).any(axis=0)
    moved = [nearest_snapshot(history, time_s) for time_s in series["time_s"].iloc[samples]]
    none = np.full(history.displacement.shape[1:], np.nan)
    displacement = np.array(
        [none if point is None else history.displacement[point] for point in moved]
    )
    return Patterns(
        np.array(list(rows), "i4"),
        active.joints[used].astype("i4"),
        *(values[:, used].astype("f4") for values in (opening, offset)),
        displacement.astype("f4"),
    )


def write_patterns(patterns, path):
    """Write Patterns into a file; returns the SHA-256 of its bytes."""
    content = io.BytesIO()
    np.savez_compressed(content, **patterns._asdict())
    write_bytes(path, content.getvalue())
    return hashlib.sha256(content.getvalue()).hexdigest()


def read_patterns(path, sha256):
    """The Patterns of a file; sha256: of its bytes, as the record of the run has it.  Raises
    InputError where the file is missing or has another."""
    path = check_file(path, "the patterns of a run (.npz)")
    content = path.read_bytes()
    if (digest := hashlib.sha256(content).hexdigest()) != sha256:
        raise InputError(
            f"{path} is not what its run wrote: SHA-256 {digest[:12]}, expected {str(sha256)[:12]}"
            f" by the run's record; {_REMEDY}"
        )
    with np.load(io.BytesIO(content), allow_pickle=False) as archive:
        return Patterns(*(archive[name] for name in Patterns._fields))
