"""The process that makes a claim for the page."""

import contextlib
import os
import re
import signal
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from functools import partial

from damage.applications.studies.folder import end_with_parent, environment, open_log

SHARE = re.compile(r"^\d+ \w+ \d+ \w+, (\d+)[\d.,]* %", re.MULTILINE)
"""Pattern of the log that has how much is simulated."""
TAIL = 12  # lines of the log that the page shows


class Job:
    """`python3 -m damage claim` in a process of its own, which ends with this program."""

    def __init__(self):
        self.process = None
        # whose thread lives as long as this program: a job ends with both
        self._starter = ThreadPoolExecutor(1)

    @property
    def running(self):
        return self.process is not None and self.process.poll() is None

    def start(self, words, log):
        """Begin with the words of a command line; it prints into a log (Path)."""
        with open_log(log) as file:
            self.process = self._starter.submit(
                subprocess.Popen,
                [sys.executable, "-m", "damage", "claim", *words],
                stdin=subprocess.DEVNULL,
                stdout=file,
                stderr=subprocess.STDOUT,
                start_new_session=True,
                env=environment(),
                preexec_fn=partial(end_with_parent, os.getpid()),
            ).result()

    def progress(self, log):
        """How far the runs are, and the last lines of their log."""
        text = log.read_text(encoding="utf-8", errors="replace") if log.exists() else ""
        shares = SHARE.findall(text)
        lines = [line for line in text.replace("\r", "\n").split("\n") if line.strip()]
        return {
            "share": float(shares[-1]) / 100 if shares else None,
            "running": self.running,
            "status": self.process and self.process.poll(),
            "lines": lines[-TAIL:],
        }

    def stop(self, patience_s):
        """Interrupt the runs, and kill their processes after so long [s]."""
        if self.running:
            for name in (signal.SIGTERM, signal.SIGKILL):
                with contextlib.suppress(ProcessLookupError, subprocess.TimeoutExpired):
                    os.killpg(self.process.pid, name)
                    self.process.wait(patience_s)
