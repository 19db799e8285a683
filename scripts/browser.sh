#!/usr/bin/env bash
# Opens reports (python3 -m damage report), the site of the documents and the page of a claim (python3 -m damage app) in
# a real browser, Debian's Chromium, without a network.
#
#     bash scripts/browser.sh                            # the tests of all three there
#     bash scripts/browser.sh FILE.html                  # time from its opening to its drawn wall, five cold starts
#     bash scripts/browser.sh FILE.html --shots DIR      # and pictures of it on screen and, in grey, on paper
#
# Chromium, its driver, selenium and Sphinx are installed where they are missing (300 MB); status 3 where that cannot
# be done.
set -euo pipefail

here=$PWD
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
# shellcheck source=scripts/environment.sh
source "$root/scripts/environment.sh" browser
cd "$here"
if [ $# -gt 0 ]; then
    exec "$PYTHON" "$root/benchmarks/report_in_browser.py" "$@"
fi
cd "$root"
exec "$PYTHON" -m pytest -q -m long tests/applications/report/test_html_browser.py tests/documents/test_site_browser.py tests/applications/groningen/test_app_browser.py
