"""Where a run writes: its history, and its pictures beside it."""

import hashlib
import os
from pathlib import Path

_LONGEST_STEM = 200  # bytes; a character has up to four


def free_name(wall, settings, solver, folder="results"):
    """A path for the history that does not exist yet: WALL_MOTION_SOLVER.h5, then _2, _3, ..."""
    settled = [f"settle-{settings.settlement.name}"] if settings.settlement else []
    parts = [wall.name, *settled, settings.loading.name, solver, *settings.model.tags()]
    if settings.units != (1, 1):
        parts.append("units-{}x{}".format(*settings.units))
    if settings.events:
        parts[1 + len(settled) : 2 + len(settled)] = [
            f"sequence-of-{len(settings.events)}",
            settings.loading.name,
        ]
    elif settings.sequence != (1.0,):
        parts.append("sequence-" + "-".join(f"{factor:g}" for factor in settings.sequence))
    stem = "_".join(parts)
    count = 1
    if len(os.fsencode(stem)) > _LONGEST_STEM:
        stem = f"{stem[: _LONGEST_STEM // 4 - 9]}_{hashlib.sha256(stem.encode()).hexdigest()[:8]}"
    while True:
        path = Path(folder) / f"{stem}{'' if count == 1 else f'_{count}'}.h5"
        if not path.exists() and not (settings.pictures and pictures_folder(path).exists()):
            return path
        count += 1


def pictures_folder(path):
    """Folder for the pictures of a run whose history is FILE.h5: FILE beside it."""
    return path.with_suffix("")
