"""The least memory that a command begins with, memory that is returned, and the cache.  Nothing is
imported here that takes time.

With less, libraries cannot be loaded, and OpenBLAS, whose every thread asks for 128 MiB as soon as
it starts, asks again for ever instead of giving up: neither could be detected from within.
"""

import os
from contextlib import suppress
from functools import cache
from pathlib import Path

LEAST = 600_000_000
"""Address space that a process needs [bytes]: 547 MB measured, with one thread of OpenBLAS."""
A_THREAD = 150_000_000
"""Address space that each further thread needs [bytes]: 136 MB measured."""
YADE = 650_000_000
"""Address space that YADE needs beside [bytes]: 490 MB measured; with less than 250 MB more it
continues, but very slowly."""
CACHE = "/sys/devices/system/cpu/cpu0/cache/index3"
"""Folder in which Linux describes the third cache of a processor."""
USUAL_CACHE = 4_000_000
"""Size of the third cache that a core usually has [bytes]."""


def hold_buffers():
    """Have the OpenBLAS of numpy and scipy take their buffers now where memory is limited: once it
    is used up, they would ask for them for ever."""
    if _limit() is not None:
        import numpy as np
        from scipy.linalg.blas import dgemm

        square = np.ones((200, 200))
        dgemm(1.0, square, square @ square)


def return_freed():
    """Return freed memory to the system; does nothing where the C library has no function for it.

    glibc keeps freed arrays that lie between others: 500 runs of a study in one process held 6 GB.
    """
    import ctypes

    # TypeError: a system without a library of the process
    with suppress(AttributeError, OSError, TypeError):
        ctypes.CDLL(None).malloc_trim(0)


@cache
def cache_bytes(processes, folder=CACHE):
    """What each of so many processes has of the third cache of a processor [bytes]; USUAL_CACHE
    where the system does not say."""
    try:
        size, sharing = (Path(folder, name).read_text() for name in ("size", "shared_cpu_map"))
        cores = int(sharing.replace(",", ""), 16).bit_count()
        return 1024 * int(size.strip().removesuffix("K")) // min(processes, cores)
    except (OSError, ValueError, ZeroDivisionError):
        return USUAL_CACHE


def least_bytes(beside=0):
    """The least address space of this process on this machine [bytes]; beside: what the program
    around it takes."""
    asked = os.environ.get("OPENBLAS_NUM_THREADS") or os.environ.get("OMP_NUM_THREADS") or ""
    cores = (
        len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    )
    return (
        beside
        + LEAST
        + A_THREAD * (min(int(asked), cores) if asked.isdigit() and int(asked) else cores)
    )


def shortage(beside=0):
    """Message where this process's memory limit is too low, None where it suffices; arguments as of
    `least_bytes`."""
    limit = _limit()
    if limit is None or limit >= least_bytes(beside):
        return None
    return (
        f"out of memory: this process may have {limit / 1e6:.0f} MB (ulimit -v): expected "
        f"{least_bytes(beside) / 1e6:.0f} MB or more; raise the limit"
    )


def _limit():
    """Limit of this process's address space [bytes], None where there is none."""
    try:
        import resource
    except ImportError:  # a system without such limits
        return None
    limit = resource.getrlimit(resource.RLIMIT_AS)[0]
    return None if limit == resource.RLIM_INFINITY else limit
