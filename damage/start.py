"""How `python3 -m damage` begins and leaves: an interrupt at any time, or a library that is missing, is one line at
most.  Nothing is imported here that takes time."""

import os
import runpy
import signal
import sys
import traceback

EXIT_MISSING, EXIT_INTERRUPTED = 3, 130


def main():
    """The command `masonry-damage`: as `python3 -m damage`."""
    begin()
    runpy.run_module("damage", run_name="__main__", alter_sys=True)


def begin():
    """Make interrupts quiet and a missing library one line, from now on."""
    signal.signal(signal.SIGINT, _interrupted)
    sys.excepthook = _tell


def missing_library(error):
    """What to say of an ImportError of a library, None where it is a fault of this software."""
    library = (error.name or "").partition(".")[0]
    if library in ("", "damage"):
        return None
    return (f"error: {sys.executable} cannot import {library}: expected Debian's package python3-{library}, or pip "
            f"install {library}; with Debian's packages use /usr/bin/python3, as ./run_all.sh does")


def _interrupted(number, frame):
    """Raise KeyboardInterrupt, but for imports: they would swallow it, or print it."""
    while frame:
        if frame.f_code.co_filename.startswith("<frozen importlib"):
            os._exit(EXIT_INTERRUPTED)
        frame = frame.f_back
    raise KeyboardInterrupt


def _tell(kind, error, trace):
    """As Python tells an exception that nobody caught, but for an interrupt and a missing library."""
    if issubclass(kind, KeyboardInterrupt):
        os._exit(EXIT_INTERRUPTED)
    if issubclass(kind, ImportError) and missing_library(error):
        print(missing_library(error), file=sys.stderr, flush=True)
        os._exit(EXIT_MISSING)
    traceback.print_exception(kind, error, trace)
