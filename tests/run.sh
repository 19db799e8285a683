#!/usr/bin/env bash
# Runs the tests: all of them, or what pytest's arguments choose.
#
#     bash tests/run.sh
#     bash tests/run.sh -m "not slow and not long"
#     bash tests/run.sh -m long                       # the longer checks, minutes each
#     bash tests/run.sh tests/applications/studies/test_study.py -k quick
#     bash tests/run.sh -p tests.processor_time       # also prints processor time by test, file and folder
#
# Files run side by side, at most four, one more than there are cores as some wait; the longest first.  -n 0 runs them
# one after the other.  A test that waits for ever ends its process after ten minutes, with a traceback; the others of
# its file are not run.
# Lint, import order, the examples in docstrings and the like are not among them: bash scripts/gates.sh.
# What they leave uncovered: bash scripts/coverage.sh.
# The exit status is pytest's; 3 when something that the tests need is missing.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
# shellcheck source=scripts/environment.sh
source "$root/scripts/environment.sh" test
cd "$root"
# They start a thousand times a Python, each of which would compile the modules again where bytecode is not kept.  It is
# made before: Python 3.11 keeps half a file where a test fills the disk.
unset PYTHONDONTWRITEBYTECODE
export OPENBLAS_NUM_THREADS=1 # as the program has it: processes are forked
"$PYTHON" -m compileall -q benchmarks damage scripts tests verification walls yade_scripts
cores=$(nproc)
exec "$PYTHON" -m pytest -q -n $((cores < 3 ? cores + 1 : 4)) --dist loadfile --max-worker-restart 0 "$@"
