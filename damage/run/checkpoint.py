"""Checkpoints of a run: everything that its next steps depend on, in FILE.checkpoint beside its
history FILE.h5.

A line with the digest of the rest, then a NumPy archive without objects.  The file is written
beside and renamed, so that a kill leaves the last checkpoint whole; the run that continues omits
rows of the history that came after it. Of YADE the archive holds a scene (`O.save`).
"""

import fcntl
import hashlib
import json
import math
import os
import time
from pathlib import Path

import numpy as np

from damage.errors import InputError, one_line, warn
from damage.files import whole_or_nothing
from damage.history.buffer import Buffer
from damage.history.reader import opened, read_history
from damage.history.writer import File, lock
from damage.run.initial_state import as_bytes, read_earlier, unpacked

_HEAD = b"masonry-damage-checkpoint 1 sha256 "


def checkpoint_path(history):
    """Path of the checkpoint of a run, whose history is at this path."""
    return Path(history).with_suffix(".checkpoint")


class Checkpoints:
    """Writer of a run's checkpoints.

    writer: Buffer of the run, which leaves a file where it is interrupted; every_s: computing time
    between two [s], infinity: at an interruption only; keeps_end: whether the end of the run is
    one, too, of a solver that leaves no state in the history.
    """

    def __init__(self, writer, every_s=math.inf, keeps_end=False):
        self._writer = writer
        self._every_s = every_s
        self._last = time.monotonic()
        self.path = checkpoint_path(writer.path)
        self.keeps_end = keeps_end and every_s < math.inf

    def due(self):
        """Whether the time for the next one has come."""
        return time.monotonic() - self._last >= self._every_s

    def write(self, tables):
        """Write a checkpoint of {name: array}."""
        self._writer.flush()
        of_history = {
            "rows": np.array(self._writer.sink.rows()),
            "run": _digest_of(self._writer.sink.attributes),
        }
        content = as_bytes(tables | of_history).tobytes()
        digest = hashlib.sha256(content).hexdigest().encode()
        try:
            with whole_or_nothing(self.path) as unfinished, unfinished.open("wb") as file:
                file.write(_HEAD + digest + b"\n" + content)
                file.flush()
                os.fsync(file.fileno())
        except InputError as error:  # the last one is as it was, and the run needs none
            warn(f"no checkpoint, the run continues: {error}", code="checkpoint")
        self._last = time.monotonic()

    def remove(self):
        """Remove the last one, of a run that has come to its end."""
        self.path.unlink(missing_ok=True)


def _digest_of(attributes):
    """Digest of the attributes of a run, (32,) bytes: two runs have different ones."""
    text = json.dumps({name: str(value) for name, value in attributes.items()}, sort_keys=True)
    return np.frombuffer(hashlib.sha256(text.encode()).digest(), "u1")


def read_checkpoint(path, scene=True):
    """The tables of a checkpoint, {name: array}; scene: whether they hold a scene of YADE, of which
    is said what it may do.  Raises InputError where it is missing or damaged."""
    path = Path(path)
    if not path.is_file():
        raise InputError(
            f"no checkpoint {path}: expected the one of a run with --checkpoint MINUTES, or of one"
            " that was interrupted; run it again with --checkpoint 10"
        )
    head, _, content = path.read_bytes().partition(b"\n")
    if head != _HEAD + hashlib.sha256(content).hexdigest().encode():
        raise InputError(f"{path} is no whole checkpoint: its digest is another one; run it again")
    if scene:
        warn(
            f"{path}: YADE executes the names of the engines in the scene that it holds: continue"
            " runs of your own, or of someone you trust, only",
            code="scene",
        )
    return unpacked(np.frombuffer(content, "u1"))


def schemes_left(path, schemes):
    """What a run still has to try: of the (RunSettings, time step [s]) of
    `damage.run.scheme.schemes` those from the present one on, and {parameter: value} of how often
    it was repeated; path: of its history, None of a run that begins."""
    state = {"repeats": 0, "repeated_for": None}
    if path is None:
        return schemes, state
    had = read_history(path).parameters
    came_to = [
        k
        for k, (settings, time_step) in enumerate(schemes)
        if (settings.mass_scaling, time_step) == (had.get("mass_scaling"), had.get("time_step_s"))
    ]
    return schemes[came_to[0] :] if came_to else schemes, {
        name: had.get(name, value) for name, value in state.items()
    }


def resumed(path, layout, parameters, origin, scene):
    """What a run needs to continue from its checkpoint, (Buffer, tables of the checkpoint); path:
    its history.

    layout, parameters: of the run, which have to be those of the history; scene: as of
    `read_checkpoint`; origin: as of `damage.run.initial_state.read_earlier`.  Raises InputError.
    """
    history = read_earlier(path, layout, origin, option="--resume", ended=False)
    if history.complete:
        raise InputError(
            f"--resume {path}: its run is complete; expected one that was interrupted or killed; to"
            f" start another one from its end give --continue {path}"
        )
    now = json.loads(json.dumps(parameters, sort_keys=True))
    other = [
        name
        for name in now | history.parameters
        if name not in ("command", "wall_file", "outside_validity", "changed_by_hand")
        and history.parameters.get(name) != now.get(name)
    ]
    if other:
        raise InputError(
            f"--resume {path}: {other[0]} is {one_line(now.get(other[0]))}, and was"
            f" {one_line(history.parameters.get(other[0]))}; expected the options of the run that"
            f" was interrupted ({history.command}); give them"
        )
    tables = _checkpoint_beside(history, f"--resume {path}", scene)
    return _continued(Path(path), layout, tables["rows"].tolist(), history.attributes), tables


def _checkpoint_beside(history, option, scene=True):
    """The tables of the checkpoint beside a History, which has to be of the same run; scene: as of
    `read_checkpoint`."""
    tables = read_checkpoint(checkpoint_path(history.path), scene)
    if not np.array_equal(tables["run"], _digest_of(history.attributes)):
        raise InputError(
            f"{option}: the checkpoint beside it is of another run; expected both of one run; run"
            " it again"
        )
    return tables


def _continued(path, layout, counts, attributes):
    """A Buffer that continues the history at `path` after so many rows of each group of
    GROWING.

    What the file holds up to there is copied into a new one, which takes its place once it is
    whole; attributes: of its run, which stay.  Raises InputError where another run still writes it.
    """
    lock(path, fcntl.LOCK_EX).close()  # HDF5 takes one of its own to read
    with opened(path) as old:
        beside = path.with_name(f".{path.stem}.{os.getpid()}.h5")
        file = File(beside, layout, attributes, overwrite=True)
        try:
            file.copy_rows(old, counts)
            os.replace(beside, path)
        except BaseException:
            beside.unlink(missing_ok=True)
            raise
    file.path = path
    file.where = str(path)
    return Buffer(layout, file, active=file.active())


def read_end(path, layout, origin, time_step):
    """State at the end of the run of the history at `path`, of a solver that keeps it in a
    checkpoint alone, {name: array}; time_step [s]; other arguments and errors as of
    `damage.run.initial_state.read_earlier`."""
    history = read_earlier(path, layout, origin)
    if history.time_step_s != time_step:
        raise InputError(
            f"--continue {path}: its time step is {history.time_step_s!r} s, expected that of this"
            f" run, {time_step!r} s; give --dt {history.time_step_s!r}"
        )
    return _checkpoint_beside(history, f"--continue {path}")
