"""Leave YADE with an exit status when a script is done, instead of at its prompt with status 0."""

import os
import shutil
import sys
import traceback
from pathlib import Path

from yade import O


def run_and_leave(function):
    """Call `function()` and end the process: with the status it returns (None is 0), or 1 if it raises."""
    status = 1
    try:
        status = function() or 0
    except Exception:
        traceback.print_exc()
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except OSError:
            status = status or 1
    scratch = Path(O.tmpFilename()).parent  # YADE removes it only when it exits by itself
    if scratch.name.startswith("yade-"):
        shutil.rmtree(scratch, ignore_errors=True)
    # YADE's threads make an orderly exit slow and unsafe.
    os._exit(status)
