#!/usr/bin/env bash
# Counts the branches of damage/ and yade_scripts/ that the tests leave uncovered.
#
#     bash scripts/coverage.sh                       # by all tests; a third longer than the tests alone
#     bash scripts/coverage.sh tests/core/test_measures.py   # or by what pytest's arguments choose
#
# Every Python process of the tests is measured, those in YADE too (scripts/coverage_start); a line in .venv reaches
# those that set PYTHONPATH themselves, as batches do.  Compiled functions count by tests/core/test_widths.py, which
# runs them as plain Python.  .coverage/data.json has the lines.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
# shellcheck source=scripts/environment.sh
source "$root/scripts/environment.sh" coverage
cd "$root"
rm -rf .coverage
mkdir .coverage
export COVERAGE_ROOT=$root COVERAGE_PROCESS_START=$root/pyproject.toml
if [ -d .venv ]; then
    start=$(echo .venv/lib/python3*/site-packages)/measure_coverage.pth
    trap 'rm -f "$start"' EXIT
    "$PYTHON" - >"$start" <<'END'
from pathlib import Path

import coverage

# The line is run before Debian's packages are on the path.
start = f"sys.path.append({str(Path(coverage.__file__).parents[1])!r}), __import__('coverage').process_startup()"
print(f"import os, sys; 'COVERAGE_PROCESS_START' in os.environ and ({start})")
END
fi
cores=$(nproc)
status=0
PYTHONPATH=$root/scripts/coverage_start:$root "$PYTHON" -m pytest -q -n $((cores < 4 ? cores : 4)) --dist loadfile "$@" ||
    status=$?
"$PYTHON" -m coverage combine --quiet
"$PYTHON" -m coverage json --quiet -o .coverage/data.json
"$PYTHON" - <<'END'
import json
from pathlib import Path

measured = json.loads(Path(".coverage/data.json").read_text())["files"]
missing = {path: file["summary"]["missing_branches"] for path, file in measured.items()}
for path, count in sorted(missing.items(), key=lambda item: -item[1]):
    if count:
        print(f"{count:5d}  {path}")
total = sum(file["summary"]["num_branches"] for file in measured.values())
compiled = sum(missing.get(path, 0) for path in ("damage/mechanics/step.py", "damage/law/joint_law.py"))
print(f"{sum(missing.values()):5d} of {total} branches uncovered, {compiled} of them in compiled functions")
END
exit "$status"
