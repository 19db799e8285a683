# PYTHON_ARGCOMPLETE_OK
"""How `python3 -m damage` begins and leaves: an interrupt, a library that is missing, too little
memory, or an output that takes nothing is one line at most.  Nothing is imported here
that takes time: before `begin` an interrupt is Python's."""

import errno
import os
import signal
import sys

from damage.errors import InputError, RunError, WriteError, of_locale, one_line
from damage.memory import shortage

EXIT_OK = 0
"""Exit status of a command that is done."""
EXIT_FAILED = 1
"""Exit status where a command failed, or was out of memory."""
EXIT_INPUT = 2
"""Exit status where the input is bad."""
EXIT_MISSING = 3
"""Exit status where a library is missing."""
EXIT_INTERRUPTED = 130
"""Exit status of an interrupted command."""
NAMED_OTHERWISE = {"snakemake": ("snakemake", "snakemake (the extra masonry-damage[study])")}
"""Libraries whose packages have other names: {library: (Debian's, what pip installs)}."""
_OF_OUTPUT = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO, errno.EPIPE)


def main():
    """The command `masonry-damage`: as `python3 -m damage`."""
    begin()
    import runpy

    runpy.run_module("damage", run_name="__main__", alter_sys=True)


def begin(beside=0):
    """Make interrupts quiet and a missing library one line, from now on; end where memory is
    missing.

    beside: address space that the program around this takes [bytes].
    """
    signal.signal(signal.SIGINT, signal.default_int_handler)
    sys.excepthook = _print_exception
    # the next file, as a history, would get the number of a closed stream, and what is printed
    for name in ("stdin", "stdout", "stderr"):
        if getattr(sys, name) is None:
            setattr(sys, name, open(os.devnull, "r+"))  # noqa: SIM115
    if sys.stdout.errors == "strict" or sys.stdout.encoding.lower() != "utf-8":
        # an old terminal lacks letters that names and help have
        sys.stdout.reconfigure(errors="replace")
    missing = shortage(beside)
    if missing:
        print(f"error: {missing}", file=sys.stderr, flush=True)
        os._exit(EXIT_FAILED)


def reported(work):
    """The exit status of `work()`, which returns one; its errors are printed, in one line where
    they are no fault of this software.  A WriteError ends this process."""
    try:
        return work()
    except SystemExit as exit_:  # --help
        return exit_.code or EXIT_OK
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        return EXIT_INTERRUPTED
    except Exception as error:
        return report_error(error)


def report_error(error, subject=""):
    """Print an error, as `reported` does, with its subject before it; returns the exit
    status."""
    message = str(error)
    status = EXIT_FAILED
    if isinstance(error, WriteError):
        print(f"error: {error}", file=sys.stderr, flush=True)
        sys.stdout.flush()
        os._exit(EXIT_FAILED)  # HDF5 would crash on the way out
    if isinstance(error, InputError):
        status = EXIT_INPUT
    elif isinstance(error, UnicodeEncodeError) and error.encoding == sys.getfilesystemencoding():
        message = of_locale(error.object)
        status = EXIT_INPUT
    elif isinstance(error, ImportError) and missing_library(error):
        message = missing_library(error)
        status = EXIT_MISSING
    elif isinstance(error, MemoryError):
        message = (
            f"out of memory ({one_line(error) or 'no more to be had'}): expected room for it; give"
            " it more, as by ulimit -v, or a smaller file, a shorter run, fewer --cells"
        )
    elif isinstance(error, OSError) and is_of_output(error):
        return EXIT_FAILED
    elif isinstance(error, OSError):
        message = f"{one_line(error)}: expected what this user may read and write; correct that"
        status = EXIT_INPUT
    elif not isinstance(error, RunError):
        import traceback

        traceback.print_exception(error)
        return EXIT_FAILED
    print(f"error: {subject}{message}", file=sys.stderr, flush=True)
    return status


def is_of_output(error):
    """Whether an OSError is one of standard output and not of a file: it is reported, and no more
    is printed."""
    if error.filename is not None or error.errno not in _OF_OUTPUT:
        return False
    # where the reader of a pipe went away, as `| head` does, nobody asks
    if error.errno != errno.EPIPE:
        print(
            f"error: what this prints cannot be written ({error.strerror}): expected room for it;"
            " make room, or print elsewhere",
            file=sys.stderr,
        )
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    return True


def leave(status):
    """End this process with a status, 1 instead of 0 where what was printed could not be written;
    an interrupt now changes nothing any more."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        sys.stdout.flush()
    except OSError as error:
        status = status or EXIT_FAILED
        is_of_output(error)
    try:
        sys.stderr.flush()
    except OSError:  # Python would make it status 120
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stderr.fileno())
    sys.exit(status)


def missing_library(error):
    """Message for a missing library (ImportError), None where the error is a fault of this
    software."""
    # the one that others fell over
    while isinstance(error.__context__, ImportError) and error.__context__.name:
        error = error.__context__
    library = (error.name or "").partition(".")[0]
    if library in ("", "damage"):
        return None
    debian, pip = NAMED_OTHERWISE.get(library, (f"python3-{library}", library))
    return (
        f"{sys.executable} cannot import {library}: expected Debian's package {debian}, or pip "
        f"install {pip}; with Debian's packages use /usr/bin/python3, as ./run_all.sh does"
    )


def _print_exception(kind, error, trace):
    """Print an uncaught exception as Python does, except an interrupt and a missing library."""
    if issubclass(kind, KeyboardInterrupt):
        os._exit(EXIT_INTERRUPTED)
    if issubclass(kind, ImportError) and missing_library(error):
        os._exit(report_error(error))
    sys.__excepthook__(kind, error, trace)
