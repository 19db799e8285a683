"""What the programs of a batch share."""

import ctypes
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
MARK = "@@ "
"""Begins a line meant for the person at the terminal; everything else goes to a log only."""

_PR_SET_PDEATHSIG = 1
_LIBC = ctypes.CDLL(None)


def tell(text):
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
