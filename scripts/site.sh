#!/usr/bin/env bash
# Builds the documents as a site: bash scripts/site.sh [--out DIR]     # by default results/site; open DIR/index.html
# Warnings are errors: a page that is in no menu, a link to nothing, a docstring's module that does not import.
set -euo pipefail

root=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.." && pwd)
out=$root/results/site
case ${1:-} in
    '') ;;
    --out) out=${2:?error: --out wants a folder} ;;
    --out=*) out=${1#--out=} ;;
    *)
        printf 'usage: bash scripts/site.sh [--out DIR]\n' >&2
        exit 2
        ;;
esac
# shellcheck source=scripts/environment.sh
source "$root/scripts/environment.sh" site || exit 3
"$PYTHON" -m sphinx -W --keep-going -q -E -b html -d "$out/.doctrees" "$root/docs" "$out"
printf 'site: %s/index.html\n' "$out"
