"""Measures coverage in every Python process that has this folder on its path: see
scripts/coverage.sh.

YADE needs help twice: its scripts leave with os._exit, which skips what coverage has to save, and
its
engine calls Python from a thread that C++ starts, which Python's tracing does not reach by itself.
"""

import os
import sys
import threading

import coverage

coverage.process_startup()


def _exit_saved(status, leave=os._exit):
    process = coverage.Coverage.current()
    if process is not None:
        process.stop()
        process.save()
    leave(status)


class _EngineTracing:
    """On the first import from yade_scripts within YADE: what its PyRunners run is traced, too."""

    def __init__(self):
        self.tracer = None

    def find_spec(self, name, path=None, target=None):
        if name.startswith("yade_scripts") and "yade" in sys.modules:
            yade = sys.modules["yade"]
            plain = yade.PyRunner
            sys.meta_path.remove(self)
            sys.trace_engine = self.trace
            yade.PyRunner = lambda command, **options: plain(
                command=f"import sys; sys.trace_engine(); {command}", **options
            )

    def trace(self):
        """Trace this thread, with one tracer for all calls of the engine: each call looks like a
        new thread."""
        if self.tracer is None:
            threading.gettrace()(sys._getframe(), "call", None)
            self.tracer = sys.gettrace()
        else:
            sys.settrace(self.tracer)


os._exit = _exit_saved
sys.meta_path.insert(0, _EngineTracing())
