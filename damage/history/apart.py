"""Reading of unsealed files in a separate process: a damaged one may make HDF5 hang, crash or allocate any memory."""

import faulthandler
import os
import pickle
import signal
import sys
import warnings
from contextlib import contextmanager, suppress
from pathlib import Path

from damage.errors import InputError

with suppress(ImportError):  # not on every system
    import resource

SECONDS = 8
"""Longest time that a small file may take: a machine may be busy."""
BYTES_A_SECOND = 10e6  # what a large one may take on top
FREE_BYTES = 500e6
"""What may be asked for beyond what this process has, by the file's word alone."""


def apart(path, read):
    """Call `read(path, believe)` in a child process, with limits of time and memory; returns its result.

    believe(n_bytes): the reader calls it after its checks, with the memory that it needs.
    Raises InputError where `read` does, or where the child dies or takes too long.
    """
    if not sys.platform.startswith("linux"):  # elsewhere a fork of a program with threads is no safe place
        return read(path, lambda n_bytes: None)
    limit_s = SECONDS + int(os.path.getsize(path) / BYTES_A_SECOND)
    receive, send = os.pipe()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # of forks beside threads: the child only reads, and ends
        child = os.fork()
    if child == 0:
        os.close(receive)
        _be_the_child(path, read, send, limit_s)
    os.close(send)
    with os.fdopen(receive, "rb") as answer:
        data = b"".join(answer)
    killed_by = os.WTERMSIG(os.waitpid(child, 0)[1])
    if killed_by == signal.SIGALRM:
        raise InputError(f"{path} cannot be read: HDF5 found no end in {limit_s} s, it is damaged")
    if killed_by:
        raise InputError(f"{path} cannot be read: HDF5 crashes on it (signal {killed_by}), it is damaged")
    try:
        found = pickle.loads(data)
    except Exception:  # the child found no memory to send what it had read
        raise InputError(f"{path} cannot be read: too little memory for what it holds; give it more, or it is damaged"
                         ) from None
    if isinstance(found, Exception):
        raise found
    return found


@contextmanager
def bounded():
    """Limit the memory of this process while a sealed file is read: gzip may unpack to any size.

    Yields the `believe` of `apart`; the limit applies from its first call.
    """
    if not sys.platform.startswith("linux"):
        yield lambda n_bytes: None
        return
    soft, hard = resource.getrlimit(resource.RLIMIT_AS)
    try:
        yield lambda n_bytes: _allow(FREE_BYTES + 4 * n_bytes, hard if soft == resource.RLIM_INFINITY else soft)
    finally:
        resource.setrlimit(resource.RLIMIT_AS, (soft, hard))


def _be_the_child(path, read, send, limit_s):
    """Read, send the result or the error, and end the child without the parent's exit handlers."""
    signal.signal(signal.SIGALRM, signal.SIG_DFL)  # ends HDF5, too, wherever it is
    signal.alarm(limit_s)
    faulthandler.disable()
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    os.dup2(os.open(os.devnull, os.O_WRONLY), 2)
    _allow(FREE_BYTES)
    try:
        found = read(path, lambda n_bytes: _allow(FREE_BYTES + 4 * n_bytes))  # arrays, tables, pickled, sent
    except Exception as error:
        found = error if isinstance(error, InputError) else InputError(f"{path} cannot be read ({error})")
    try:
        with open(send, "wb") as answer:
            pickle.dump(found, answer, protocol=5)
    finally:
        os._exit(0)


def _allow(n_bytes, most=None):
    """Allow this process n_bytes more memory than it has now, up to a total (default: its hard limit)."""
    now = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    hard = resource.getrlimit(resource.RLIMIT_AS)[1]
    most, wanted = hard if most is None else most, int(now + n_bytes)
    resource.setrlimit(resource.RLIMIT_AS, (wanted if most == resource.RLIM_INFINITY else min(wanted, most), hard))
