"""A progress line: simulated time, damage index, time left."""

import sys
import time


class Progress:
    """Rewrites one line on a terminal; prints one every few seconds into a log."""

    def __init__(self, label, total_s, stream=None):
        self.label, self.total_s = label, total_s
        self.stream = stream or sys.stderr
        self.live = self.stream.isatty()
        self.started = self.shown = time.monotonic()

    def show(self, simulated_s, stage, index):
        """Show the state of the run, at most twice a second (every ten seconds in a log)."""
        now = time.monotonic()
        if now - self.shown < (0.5 if self.live else 10.0):
            return
        self.shown = now
        share = min(1.0, simulated_s / self.total_s) if self.total_s > 0 else 1.0
        left = (now - self.started) * (1 - share) / share if share > 0.01 else float("nan")
        clock = "--:--" if left != left else f"{int(left) // 60:d}:{int(left) % 60:02d}"
        line = (f"{self.label}  {stage:8s} t = {simulated_s:6.2f} of {self.total_s:.2f} s  "
                f"DI = {index:.3f}  {100 * share:3.0f} %  {clock} left")
        self.stream.write(f"\r{line}\033[K" if self.live else f"{line}\n")
        self.stream.flush()

    def close(self):
        """End the live line."""
        if self.live:
            self.stream.write("\n")
            self.stream.flush()
