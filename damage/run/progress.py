"""A progress line: simulated time, damage index, time left."""

import sys
import time


class Progress:
    """Rewrites one line on a terminal; prints one every few seconds into a log."""

    def __init__(self, label, stream=None):
        self.label = label
        self.stream = stream or sys.stderr
        self.live = self.stream.isatty()
        self.shown, self.shown_any = time.monotonic(), False
        self.started = None  # when the first stage after the static one began

    def show(self, simulated_s, run):
        """Show the stage and the index of a Run, at most twice a second (every ten seconds in a log)."""
        now, stage = time.monotonic(), run.stage
        if stage != "static" and self.started is None:
            self.started = now
        if now - self.shown < (0.5 if self.live else 10.0):
            return
        self.shown, self.shown_any = now, True
        line = f"{self.label}  static stage, t = {simulated_s:.2f} s"
        if stage != "static":
            line = (f"{self.label}  {stage:8s} t = {simulated_s:6.2f} of {run.duration_s:.2f} s  "
                    f"DI = {run.index:.3f}  {self._left(now, simulated_s, run.duration_s)} left")
        self._write(f"\r{line}\033[K" if self.live else f"{line}\n")

    def _left(self, now, simulated_s, total_s):
        if simulated_s < 0.01 * total_s:
            return "--:--"
        left = int((now - self.started) * max(0.0, total_s / simulated_s - 1))
        return f"{left // 60}:{left % 60:02d}"

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
