"""A wall in YADE as its file runs it, with shorter stages: for what is decided outside of them.

    yade tests/yade_checks/briefly.py SETTLE_S=0.02 WALL [OPTIONS]

The first words set constants of damage.run.settings [s].
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(sys.argv[0]).resolve().parents[2]))  # YADE does not look here by itself

from damage.memory import YADE
from damage.start import begin

begin(YADE)  # before the slow imports, as yade_scripts.run does it

from damage.run import settings

del sys.argv[0]
while "=" in sys.argv[0]:
    name, value = sys.argv.pop(0).split("=")
    if name not in {"RAMP_S", "HOLD_S", "SETTLE_S"}:
        sys.exit(f"error: {name}: expected RAMP_S, HOLD_S or SETTLE_S")
    setattr(settings, name, float(value))
exec(compile(Path(sys.argv[0]).read_text(), sys.argv[0], "exec"))  # as YADE runs a script: in its own __main__
