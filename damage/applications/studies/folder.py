"""The folder of a study: where it is, who works in it, how these end, its logs, and the room on its
disk."""

import errno
import fcntl
import os
import re
import shlex
import shutil
import signal
import stat
import sys
import time
from contextlib import contextmanager
from ctypes import CDLL
from pathlib import Path

from damage.errors import InputError
from damage.files import shipped, whole_or_nothing
from damage.start import EXIT_INTERRUPTED

ROOT = shipped("studies").parent
"""Where the paths of studies that ship start: the repository, or damage/share of an installed
package."""
RESULTS = ROOT / "results" if (ROOT / "run_all.sh").is_file() else Path.cwd() / "results"
"""Where studies go unless --out says it: into the repository; of an installed package, below the
working folder."""
KEPT = "study.toml"
"""Copy of the study's file in its folder."""
CONTINUED = "\n# In this folder, continued by: python3 -m damage study "
"""What the copy ends with, before the path of the study's file from there, and options."""
LOCK_PATIENCE_S = 10.0
"""How long to wait for a folder that a killed batch's last processes may still hold [s]."""
LEAST_FREE = 20_000_000
"""Room for a study to start and continue [bytes]: tens of runs write less between two looks, and
tables need some."""
NO_ROOM = errno.ENOSPC, errno.EDQUOT
POLITE_ENDS = signal.SIGINT, signal.SIGTERM, signal.SIGHUP
"""Signals at which a study ends what runs and keeps what is done."""
_LIBC = CDLL(None)
_ALREADY = "another batch is at work in {}; wait for its end, or choose another --out"


def claim(folder, study, shared=False, lock=None, options=()):
    """Lock the folder of a study, which keeps a copy of its file; arguments, result and errors as
    of `locked`.

    lock: that its caller holds already, None for a new one; options: of the command that continues
    it, which the copy's last line keeps for `way_on`; () where another command does.
    """
    lock = locked(folder, study.name, shared) if lock is None else os.dup(lock)
    with _writable(folder):
        with whole_or_nothing(folder / KEPT) as unfinished:
            text = study.path.read_text("utf-8").partition(CONTINUED)[0]
            words = shlex.join([os.path.relpath(study.path, folder), *options])
            more = f"\n{CONTINUED}{words}\n" if options else "\n"
            unfinished.write_text(text.rstrip() + more, "utf-8")
        for name in ("logs", "runs", "tables"):
            (folder / name).mkdir(exist_ok=True)
    return lock


@contextmanager
def _writable(folder):
    """Raise InputError where what is written in a folder while this lasts cannot be."""
    try:
        yield
    except OSError as error:
        raise InputError(
            f"cannot write to {folder}: {error.strerror}; expected a folder that can be written to,"
            " or made; choose another --out"
        ) from error


def locked(folder, name, shared=False):
    """Make the folder of the study of a name and lock it; returns the lock, a descriptor.

    shared: with others that share it, as slices of the study do.  The lock is the system's: it ends
    with the processes that hold it, so that none is ever stale.  Raises InputError where another
    study or batch has the folder, or where it cannot be written.
    """
    with _writable(folder):
        folder.mkdir(parents=True, exist_ok=True)
        if is_short(folder):
            raise InputError(f"{shortage(folder)}, or choose another --out")
        lock = _open_lock(folder)
    try:
        lock_as(lock, folder, shared)
        kept = (folder / KEPT).read_text("utf-8", "replace") if (folder / KEPT).is_file() else ""
        owner = re.search(r'^name\s*=\s*["\']([^"\']*)', kept, re.MULTILINE)
        if owner and owner[1] != name:
            raise InputError(
                f"{folder} holds the study {owner[1]!r}, not {name!r}; choose another --out"
            )
    except BaseException:
        os.close(lock)
        raise
    return lock


def way_on(folder):
    """(Path of the file, options) of the study in a folder, None where its copy of the file does
    not say these."""
    path = folder / KEPT
    words = path.read_text("utf-8", "replace").partition(CONTINUED)[2] if path.is_file() else ""
    file, *options = shlex.split(words) or [None]
    return file and (Path(os.path.normpath(path.parent.absolute() / file)), options)


def command_of(file, folder, options):
    """The command that runs a study in a folder, to be copied."""
    words = "python3", "-m", "damage", "study", str(file), "--out", str(folder), *options
    return shlex.join(words)


@contextmanager
def while_locked(folder, name):
    """As `locked` while this lasts, for more than one command of a study."""
    lock = locked(folder, name)
    try:
        yield lock
    finally:
        os.close(lock)


def _open_lock(folder):
    """A descriptor to be locked: of the folder itself, since a file in it can be deleted while
    others hold it; of a file where folders cannot be locked, as on NFS."""
    lock = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        fcntl.flock(lock, fcntl.LOCK_UN)
    except BlockingIOError:
        pass
    except OSError:
        os.close(lock)
        return plain_file(folder / ".lock", os.O_RDWR | os.O_CREAT)
    return lock


def lock_as(lock, folder, shared=False):
    """Make the lock of a folder shared, or this batch's own.  Raises InputError where another batch
    has it."""
    until = time.monotonic() + LOCK_PATIENCE_S
    while True:
        try:
            return fcntl.flock(lock, (fcntl.LOCK_SH if shared else fcntl.LOCK_EX) | fcntl.LOCK_NB)
        except BlockingIOError:
            if time.monotonic() > until:
                raise InputError(_ALREADY.format(folder)) from None
            time.sleep(0.2)


def open_records(path):
    """The file of records, opened to be added to and locked; a line that a kill tore is ended.
    Raises InputError where another batch has it."""
    file = open(path, "a", encoding="utf-8", opener=plain_file)  # noqa: SIM115, open as long as the batch lives
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        file.close()
        raise InputError(_ALREADY.format(path.parent)) from None
    with open(path, "rb") as written:
        if path.stat().st_size and written.seek(-1, os.SEEK_END) and written.read() != b"\n":
            file.write("\n")
    return file


def open_log(path, mode="wb"):
    """A log for a process and for what it starts.  Raises InputError where it cannot be made."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        return open(path, mode, buffering=0, opener=plain_file)
    except OSError as error:
        raise InputError(
            f"cannot write {path}: {error.strerror}; expected a folder that can be written to, make"
            " room or choose another --out"
        ) from error


def last_words(log, run):
    """The last line of a log that is about a run, or the last of all, in brackets, where there is
    one."""
    lines = log.read_text(encoding="utf-8", errors="replace").split("\n") if log.is_file() else []
    lines = [line.strip() for line in lines if line.strip()]
    lines = [line for line in lines if line.startswith("error: ") and run in line] or lines
    return f" ({lines[-1][:200]})" if lines else ""


def environment(folder=None):
    """Environment of what a batch starts in any folder: this one's, with this package and then what
    the user had, as obspy's folder, on PYTHONPATH, and without modules of the working folder, which
    `python -m` would import before others: a folder that was sent may hold a numpy.py.  What
    matplotlib and YADE's IPython keep goes into the study's folder, if given."""
    places = (
        {"XDG_CACHE_HOME": "cache", "MPLCONFIGDIR": "matplotlib", "IPYTHONDIR": "ipython"}
        if folder
        else {}
    )
    package = str(Path(__file__).resolve().parents[3])
    given = os.environ.get("PYTHONPATH", "").split(os.pathsep)
    paths = [package, *(os.path.abspath(path) for path in given if path)]
    return {
        **os.environ,
        "PYTHONPATH": os.pathsep.join(dict.fromkeys(paths)),
        "PYTHONSAFEPATH": "1",
        "PYTHONUNBUFFERED": "1",
        **{name: str(folder / ".cache" / place) for name, place in places.items()},
    }


def end_with_parent(parent, signal_number=signal.SIGKILL):
    """Have this process sent a signal when the thread that started it dies, however that happens
    (Linux only); end it where its parent, by its number, is dead already."""
    if sys.platform == "linux":
        _LIBC.prctl(1, int(signal_number), 0, 0, 0)  # PR_SET_PDEATHSIG
    if os.getppid() != parent:
        os._exit(EXIT_INTERRUPTED)


@contextmanager
def handled(handler):
    """While this lasts an interrupt, a polite kill and a terminal that closes call a handler of
    signals."""
    before = {
        name: signal.signal(name, handler)
        for name in POLITE_ENDS
        if signal.getsignal(name) != signal.SIG_IGN  # as nohup leaves SIGHUP
    }
    try:
        yield
    finally:
        for name, handler in before.items():
            signal.signal(name, handler)


def is_short(folder):
    """Whether a study cannot start or continue in this folder."""
    return shutil.disk_usage(folder).free < LEAST_FREE


def shortage(folder):
    """Free and needed disk space of a study, in words."""
    free = shutil.disk_usage(folder).free
    shortage = (
        f"has {free / 1e6:.2g} MB free:" if free < LEAST_FREE else "had no room left while it ran,"
    )
    return f"{folder} {shortage} expected {LEAST_FREE / 1e6:g} MB or more; make room"


def plain_file(path, flags):
    """An `opener` for `open`: the descriptor of a regular file at a name that others can guess.

    Raises InputError where a symbolic link, a pipe or a device has that name: a folder that was
    sent may hold one, and what is written would go elsewhere.
    """
    try:
        descriptor = os.open(path, flags | os.O_NOFOLLOW | os.O_NONBLOCK, 0o666)
        if stat.S_ISREG(os.fstat(descriptor).st_mode):
            return descriptor
        os.close(descriptor)
    except OSError as error:
        if error.errno not in (errno.ELOOP, errno.ENXIO):  # ENXIO: a pipe that nobody reads
            raise
    raise InputError(
        f"{path} is a symbolic link, a pipe or a device: expected a regular file; delete it"
    )
