"""The room on the disk of a study's folder: before a study starts, and while it runs."""

import errno
import os
import shutil

from damage.errors import InputError
from damage.studies.members import most_members
from damage.studies.tables import runs_there

LEAST_FREE = 20_000_000
"""Room for a study to start and to go on [bytes]: tens of runs write less between two looks, and tables need some."""

NO_ROOM = tuple(map(os.strerror, (errno.ENOSPC, errno.EDQUOT)))
"""What programs say on a full disk."""


def free_bytes(folder):
    """Room on the disk of a folder for this user [bytes]."""
    return shutil.disk_usage(folder).free


def is_short(folder):
    """Whether a study cannot start or go on in this folder."""
    return free_bytes(folder) < LEAST_FREE


def shortage(folder):
    """Free and needed disk space of a study, in words."""
    if not is_short(folder):
        return f"{folder} had no room left while it ran, expected {LEAST_FREE / 1e6:g} MB or more; make room"
    return f"{folder} has {free_bytes(folder) / 1e6:.2g} MB free: expected {LEAST_FREE / 1e6:g} MB or more; make room"


def check_room(folder):
    """Raise InputError where a study cannot start."""
    if is_short(folder):
        raise InputError(f"{shortage(folder)}, or choose another --out")


def forecast(study, folder, keep="all"):
    """A warning where the runs that are left will not fit if they are as large as those that are there, else None.

    Of an ensemble with adaptive members all that it may come to count, though one may do; keep: "summary" where the
    history of the first alone stays.
    """
    whole = [path.stat().st_size for path in (folder / "runs").glob("*.h5") if not path.stem.endswith(".part")]
    left = sum(most_members(run) if keep == "all" else 1 for run in study.runs if not runs_there(run, folder))
    if not whole or not left:
        return None
    mean, free = sum(whole) / len(whole), free_bytes(folder)
    if left * mean + LEAST_FREE <= free:
        return None
    return (f"up to {left} runs are left, about {left * mean / 1e6:.2g} MB if they are as large as the {len(whole)} "
            f"there; {folder} has {free / 1e6:.2g} MB free and keeps {LEAST_FREE / 1e6:g}: make room meanwhile")
