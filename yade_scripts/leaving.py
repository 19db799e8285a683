"""Run a script in YADE without its servers, and end the process with an exit status instead of a
prompt."""

import os
import shutil
import sys
import traceback
from pathlib import Path

from yade import O

from yade_scripts.servers import close_servers


def run_and_leave(function):
    """Close YADE's servers, call `function()` and end the process with the status that it returns
    (None is 0), or 1 if it raises."""
    status = 1
    try:
        close_with_a_word()
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


def close_with_a_word():
    """Close YADE's servers, and say so."""
    if close_servers() and "--quiet" not in sys.argv:
        print(
            "YADE's servers listened on all network interfaces until now; they are closed."
            f" {Path(__file__).resolve().parents[1] / 'yade'} starts YADE without them",
            file=sys.stderr,
            flush=True,
        )
