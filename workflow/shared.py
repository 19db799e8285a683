"""Functions shared by the programs of a batch."""

import ctypes
import os
import sys
from pathlib import Path

from damage.errors import InputError
from damage.files import plain_file, write_text

ROOT = Path(__file__).resolve().parents[1]
RESULTS = ROOT / "results" if (ROOT / "run_all.sh").is_file() else Path.cwd() / "results"
"""Where studies go unless --out says it: into the repository; of an installed package, below the working folder."""
MARK = "@@ "
"""Begins a line meant for the person at the terminal; everything else goes to a log only."""

_PR_SET_PDEATHSIG = 1
_LIBC = ctypes.CDLL(None)


class Log:
    """Lines at the end of a file, as far as its disk takes them: nothing ends for want of a log.

    Where the file cannot be made, InputError.
    """

    def __init__(self, path):
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            self._file = open(path, "ab", buffering=0, opener=plain_file)  # noqa: SIM115, open as long as this process
        except OSError as error:
            raise InputError(f"cannot write {path}: {error.strerror}; expected a folder that can be written to, make "
                             "room or choose another --out") from error

    def write(self, text):
        """Add text, or what of it fits."""
        try:
            self._file.write(text.encode(errors="replace"))
        except OSError:
            pass

    def fileno(self):
        """Of the open file."""
        return self._file.fileno()

    def clear(self):
        """Drop what is in the file."""
        self._file.truncate(0)


def python_path():
    """PYTHONPATH for what a batch starts, in any folder: the repository, then what the user had, as obspy's folder."""
    given = os.environ.get("PYTHONPATH", "").split(os.pathsep)
    return os.pathsep.join(dict.fromkeys([str(ROOT), *(os.path.abspath(folder) for folder in given if folder)]))


def environment():
    """Environment of what a batch starts: this one's, with `python_path`, and without modules of the working folder,
    which `python -m` would import before others: a folder that was sent may hold a numpy.py."""
    return {**os.environ, "PYTHONPATH": python_path(), "PYTHONSAFEPATH": "1"}


def write_if_other(path, text):
    """Write a text file, whole or not at all, unless it holds the text already: its time says when it changed."""
    if not path.is_file() or path.read_text(encoding="utf-8", errors="replace") != text:
        write_text(path, text)


def announce(text):
    """Send one line up to the terminal."""
    try:
        sys.stderr.write(f"{MARK}{text}\n")  # at once, lest two programs' lines mix
        sys.stderr.flush()
    except OSError:  # the batch is gone, and this process about to go
        pass


def end_with_parent(signal_number):
    """Have this process sent a signal when its parent dies, however that happens (Linux only)."""
    if sys.platform == "linux":
        _LIBC.prctl(_PR_SET_PDEATHSIG, int(signal_number), 0, 0, 0)
