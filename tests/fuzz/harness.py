"""Damaged files given to a worker one after the other, with a watch that replaces it where it hangs or dies."""

import json
import os
import re
import select
import shutil
import signal
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
PROGRAM = ("-m", "tests.fuzz.worker")
SECONDS, START_S = 10, 300
"""Most processor time of a file, and as long it may sleep; of the worker's start, which may compile and run a wall."""
POLL_S = 0.1
GOOD = ("refused", "read")
"""What may come of a damaged file: one line of InputError, or what stands in it (nothing that counts was hit)."""


@dataclass(frozen=True)
class Outcome:
    """Of one damaged file: reader, number, what was done to it, word, what was reported, seconds, bytes of memory."""

    reader: str
    number: int
    done: str
    word: str
    message: str
    seconds: float
    bytes: int

    @property
    def good(self):
        return self.word in GOOD


class Worker:
    """`tests.fuzz.worker` in a process group of its own, in a folder of its own; a context manager.

    keep: a folder to copy each file to of which something else than GOOD came, None for none.
    """

    def __init__(self, seed, keep=None):
        self.seed, self.keep = seed, keep
        self.folder = Path(tempfile.mkdtemp(prefix="fuzz_"))
        self.process, self.unread = None, b""

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._end()
        shutil.rmtree(self.folder, ignore_errors=True)

    def __call__(self, reader, number):
        """The Outcome of one damaged file."""
        if self.process is None:
            self._start()
        self.process.stdin.write(f"{number} {self.seed} {reader}\n".encode())
        made = self._answer(START_S)
        if "word" in made:
            raise RuntimeError(f"the worker could not make {reader} {number}: {made['message']}")
        came = self._answer(SECONDS)
        outcome = Outcome(reader, number, made["done"], **came)
        if self.keep and not outcome.good:
            Path(self.keep).mkdir(parents=True, exist_ok=True)
            name = f"{re.sub(r'[^a-z0-9]+', '_', reader)}_{self.seed}_{number}"
            for path in self.folder.glob("damaged.*"):
                shutil.copy(path, Path(self.keep) / f"{name}{path.suffix}")
        for path in self.folder.glob("damaged.*"):
            path.unlink()
        return outcome

    def _start(self):
        self.process = subprocess.Popen(
            [sys.executable, *PROGRAM, str(self.folder)], bufsize=0, cwd=REPOSITORY,
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, start_new_session=True,
            env=os.environ | {"PYTHONPATH": str(REPOSITORY), "MPLBACKEND": "Agg", "OPENBLAS_NUM_THREADS": "1"})

    def _answer(self, seconds):
        """The worker's next line; where it hangs or dies, that, and it is ended."""
        began = last = self._used_s()
        asleep_s = 0.0
        while b"\n" not in self.unread:
            if not select.select([self.process.stdout], [], [], POLL_S)[0]:
                used = self._used_s()
                asleep_s = asleep_s + POLL_S if used == last and self._sleeps() else 0.0
                last = used
                if max(used - began, asleep_s) > seconds:
                    self._end()
                    return {"word": "hang", "message": f"no end in {seconds} s", "seconds": seconds, "bytes": 0}
                continue
            part = os.read(self.process.stdout.fileno(), 65536)
            if not part:
                message = (self.folder / "printed").read_text(errors="replace")[-600:]
                return {"word": "crash", "message": f"status {self._end()}: {message}", "seconds": 0.0, "bytes": 0}
            self.unread += part
        line, _, self.unread = self.unread.partition(b"\n")
        return json.loads(line)

    def _used_s(self):
        """Processor time of the worker and of what it started, which a busy machine does not lengthen [s]."""
        return sum(int(one[11]) + int(one[12]) for one in self._group()) / os.sysconf("SC_CLK_TCK")

    def _sleeps(self):
        """Whether none of them waits for a processor or for the disk."""
        return all(one[0] not in "RD" for one in self._group())

    def _group(self):
        """Fields of /proc/PID/stat behind the name, of each process in the worker's group."""
        for path in Path("/proc").glob("[0-9]*/stat"):
            try:
                fields = path.read_text().rpartition(")")[2].split()
            except (FileNotFoundError, ProcessLookupError):
                continue
            if int(fields[2]) == self.process.pid:
                yield fields

    def _end(self):
        """End the worker and what it started; returns its status."""
        process, self.process, self.unread = self.process, None, b""
        if process is None:
            return None
        try:
            status = process.wait(0.5)
        except subprocess.TimeoutExpired:
            status = None
        try:
            os.killpg(process.pid, signal.SIGKILL)
        except ProcessLookupError:
            pass
        process.stdin.close()
        process.stdout.close()
        return process.wait() if status is None else status
