"""A process that reads damaged files for another one: a line `NUMBER SEED READER` in, a line of JSON out.

A process of its own, since a file may crash it, hang it, or take all of its memory; one for many files, since it takes
a second to start.  What is read is remade by its reader, seed and number alone.
"""

import json
import os
import random
import re
import resource
import sys
import time
import warnings
from pathlib import Path

from damage.errors import InputError
from tests.fuzz.readers import READERS

MOST_BYTES = 1e9
"""Memory that a file may take, the process itself included."""
HELD_BYTES = 4e9
"""Address space at which the worker finds no more, so that the machine is spared."""
LONGEST_MESSAGE = 1600


def make(name, seed, number, folder):
    """(path, what was done) of one damaged file."""
    data, done = READERS[name].damage(folder, random.Random(f"{name} {seed} {number}"))
    path = folder / f"damaged{READERS[name].suffix}"
    path.write_bytes(data)
    return path, done


def read(name, path):
    """(a word, what is reported) of reading a file."""
    try:
        READERS[name].use(path)
    except InputError as error:
        message = str(error)
        return "refused" if message.isprintable() and 0 < len(message) < LONGEST_MESSAGE else "unfit words", message
    except Exception as error:
        line = error.__traceback__
        while line.tb_next:
            line = line.tb_next
        where = f"{Path(line.tb_frame.f_code.co_filename).name}:{line.tb_lineno}"
        return "exception", f"{type(error).__name__} in {where}: {str(error)[:300]}"
    return "read", ""


def forget_peak():
    """Have the kernel count this process's largest memory from now on."""
    Path("/proc/self/clear_refs").write_text("5")


def peak_bytes():
    """Largest memory of this process since `forget_peak`, or of any child of it."""
    own = re.search(r"VmHWM:\s*(\d+) kB", Path("/proc/self/status").read_text())[1]
    return 1024 * max(int(own), resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)


def judged(name, path, printed):
    """What came of one file: word, message, seconds, bytes."""
    sys.stdout.flush()
    os.ftruncate(printed, 0)
    forget_peak()
    began = time.monotonic()
    word, message = read(name, path)
    took_s, most = time.monotonic() - began, peak_bytes()
    sys.stdout.flush()
    noise = os.pread(printed, 300, 0).decode(errors="replace")
    if word in ("read", "refused") and noise:
        word, message = "printed", noise
    if most > MOST_BYTES:
        word = "memory"
    return {"word": word, "message": message, "seconds": took_s, "bytes": most}


def main(folder):
    """Answer until no more is asked.  What is printed besides goes to a file, and is a fault."""
    folder = Path(folder)
    answers = os.fdopen(os.dup(1), "w", buffering=1)
    printed = os.open(folder / "printed", os.O_RDWR | os.O_CREAT | os.O_TRUNC | os.O_APPEND)
    os.dup2(printed, 1)
    os.dup2(printed, 2)
    warnings.simplefilter("always")
    resource.setrlimit(resource.RLIMIT_AS, (int(HELD_BYTES), resource.getrlimit(resource.RLIMIT_AS)[1]))
    for line in sys.stdin:
        number, seed, name = line.rstrip("\n").split(" ", 2)
        path, done = make(name, seed, number, folder)
        answers.write(json.dumps({"done": done}) + "\n")
        answers.write(json.dumps(judged(name, path, printed)) + "\n")


if __name__ == "__main__":
    main(sys.argv[1])
