"""The progress of runs on the screen, and interrupts that end them politely."""

import io
import shutil
import signal
import sys
import threading
import time
from contextlib import contextmanager

from damage.run.pace import Pace, time_left


@contextmanager
def attended(label, show=None, quiet=False, several=False):
    """While this lasts interrupts end runs politely: what it gives is the `keep_going` of Run,
    which shows their progress, too.  show: called now and then; several: whether nobody knows how
    many runs there will be."""
    progress = Progress(label, io.StringIO() if quiet else None, several)
    interrupts = []

    def keep_going(run, time_s):
        progress.show(time_s, run)
        if show:
            show()
        return not interrupts

    signals = [signal.SIGINT, signal.SIGTERM]  # Ctrl-C, a polite kill
    # a terminal that closes; nohup leaves it ignored
    if signal.getsignal(signal.SIGHUP) != signal.SIG_IGN:
        signals.append(signal.SIGHUP)
    # which alone gets signals, and may set handlers
    if threading.current_thread() is not threading.main_thread():
        signals = []
    before = {
        number: signal.signal(number, lambda *_: interrupts.append(True)) for number in signals
    }
    try:
        yield keep_going
    finally:
        progress.close()
        for number, handler in before.items():
            signal.signal(number, handler or signal.SIG_DFL)


class Progress:
    """Rewrites one line on a terminal; prints one every few seconds into a log."""

    def __init__(self, label, stream=None, several=False):
        self.label = label
        self.several = several
        self.stream = stream or sys.stderr
        self.live = self.stream.isatty()
        self.shown = time.monotonic()
        self.shown_any = False
        self.pace = Pace()

    def show(self, simulated_s, run):
        """Show the stage and the index of a Run, at most twice a second (every ten seconds in a
        log)."""
        now = time.monotonic()
        share = run.share
        self.pace.note(share)
        if now - self.shown < (0.5 if self.live else 10.0):
            return
        self.shown = now
        self.shown_any = True
        left = "" if self.several else f", {time_left(self.pace.left_s(1.0 - share))}"
        line = f"{self.label}  static stage, t = {simulated_s:.2f} s{left}"
        if run.stage != "static":
            line = (
                f"{self.label}  {run.stage:8s} t = {simulated_s:6.2f} of {run.duration_s:.2f} s  "
                f"DI = {run.index:.3f}{left}"
            )
        room = shutil.get_terminal_size().columns - 1  # a line that is wider is not written over
        self._write(f"\r{line[:room]}\033[K" if self.live else f"{line}\n")

    def close(self):
        """End the live line."""
        if self.live and self.shown_any:
            self._write("\n")

    def _write(self, text):
        try:
            self.stream.write(text)
            self.stream.flush()
        except OSError:  # no room for a log, or nobody looks any more: that ends no run
            pass
