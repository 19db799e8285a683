#!/usr/bin/env bash
# The gates: what must hold before the tests are worth running.  All of them, or one, on these files.
#
#     bash scripts/gates.sh                       # all, in half a minute
#     bash scripts/gates.sh lint damage/index.py
#
#     lint        ruff, with the rules and the layout of pyproject.toml
#     types       mypy, on what is annotated
#     shell       shellcheck
#     imports     folder order is import order
#     doctests    the examples in docstrings
#     terms       no replaced term in code and documents
#     habits      one assignment a line, docstrings with a subject
#     documents   generated parts of documents are what the tables and the code make of them
#
# The exit status is 1 when a gate is shut, and 3 when something that they need is missing.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
gates=(lint types shell imports doctests terms habits documents)

lint() {
    "$RUFF" check --no-cache --quiet --output-format concise "$@" &&
        "$RUFF" format --no-cache --quiet --diff "$@"
}

types() { "$MYPY" --cache-dir "${TMPDIR:-/tmp}/mypy-$UID" --python-executable "$PYTHON" --no-error-summary "${@:-damage}"; }

shell() {
    local scripts=("$@")
    [ $# -gt 0 ] || mapfile -t scripts < <(git ls-files -co --exclude-standard '*.sh' .ci/run yade)
    shellcheck --external-sources "${scripts[@]}"
}

quiet_pytest() { "$PYTHON" -m pytest -qq --no-header --tb=short -p no:cacheprovider "$@"; }

imports() { quiet_pytest "${@:-tests/core/test_architecture.py}"; }

doctests() { quiet_pytest -p tests.example_histories --doctest-modules "${@:-damage}"; }

terms() { "$PYTHON" scripts/terms.py "$@"; }

habits() { "$PYTHON" scripts/habits.py "$@"; }

documents() { "$PYTHON" scripts/documents.py "$@"; }

# Runs one gate and prints its result.
pass() {
    local start=$SECONDS output
    if output=$("$@" 2>&1); then
        printf '%-10s open, %d s\n' "$1" $((SECONDS - start))
    else
        printf '%s\n%-10s SHUT\n' "$output" "$1"
        return 1
    fi
}

if [ $# -gt 0 ] && [[ " ${gates[*]} " != *" $1 "* ]]; then
    echo "error: no gate $1: expected one of ${gates[*]}" >&2
    exit 2
fi
# shellcheck source=scripts/environment.sh
source "$root/scripts/environment.sh" gates
[ $# -gt 0 ] || cd "$root"
status=0
if [ $# -gt 0 ]; then
    pass "$@" || status=1
else
    for gate in "${gates[@]}"; do
        pass "$gate" || status=1
    done
fi
exit "$status"
