"""A wall in YADE as its file runs it, with shorter stages: for what is decided outside of them.

    yade tests/yade/checks/briefly.py SETTLE_S=0.02 WALL [OPTIONS]

The first words set constants of damage.run.settings and damage.motion.settlement [s].
KILLED_AT=0.05 or INTERRUPTED_AT=0.05 ends the run after a checkpoint of this time of the run or
later [s]; one is written at every look.
"""

import os
import signal
import sys
from pathlib import Path

sys.path.insert(0, str(Path(sys.argv[0]).resolve().parents[3]))  # YADE does not look here by itself

from damage.memory import YADE
from damage.start import begin

begin(YADE)  # before the slow imports, as yade_scripts.run does it

from damage.motion import settlement
from damage.run import settings
from damage.run.checkpoint import Checkpoints
from damage.run.run import Run

SIGNALS = {"KILLED_AT": signal.SIGKILL, "INTERRUPTED_AT": signal.SIGINT}


def end_at(time_s, sign):
    """Have the run send itself a signal one look after its first checkpoint of a time of the run
    [s] or later."""
    times = []
    tables_of = Run.tables

    def tables(run):
        if times and times[-1] >= time_s:
            os.kill(os.getpid(), sign)
        times.append(0.0 if run.stage == "static" else run.time)
        return tables_of(run)

    Checkpoints.due = lambda checkpoints: True
    Run.tables = tables


del sys.argv[0]
while "=" in sys.argv[0]:
    name, value = sys.argv.pop(0).split("=")
    if name in SIGNALS:
        end_at(float(value), SIGNALS[name])
    elif name in {"RAMP_S", "HOLD_S", "SETTLE_S"}:
        setattr(settings, name, float(value))
    elif name == "SHORTEST_S":
        settlement.SHORTEST_S = float(value)
    else:
        sys.exit(
            f"error: {name}: expected RAMP_S, HOLD_S, SETTLE_S, SHORTEST_S, KILLED_AT or"
            " INTERRUPTED_AT"
        )
# as YADE runs a script: in its own __main__
exec(compile(Path(sys.argv[0]).read_text(), sys.argv[0], "exec"))
