"""The site of the documents in a real browser, from its files: no page has errors.

`bash scripts/browser.sh` installs what these need and runs them.
"""

import os
import sys
import time

import pytest
from conftest import IN_BROWSER, REPOSITORY, logged, run_command

for module in ("selenium", "sphinx", "myst_parser", "furo"):
    pytest.importorskip(module, reason=f"{module} is not installed: bash scripts/browser.sh")
pytestmark = IN_BROWSER


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """The folder of the site."""
    folder = tmp_path_factory.mktemp("site") / "html"
    run_command(
        "bash",
        REPOSITORY / "scripts" / "site.sh",
        "--out",
        folder,
        env={**os.environ, "PYTHON": sys.executable, "MASONRY_NO_INSTALL": "1"},
        status=0,
    )
    return folder


def test_every_page_opens_without_an_error_or_a_warning(driver, site):
    faults = {}
    address = site.as_uri()
    names = sorted(path.relative_to(site).as_posix() for path in site.rglob("*.html"))
    assert len(names) > 40
    driver.get("about:blank")
    logged(driver)
    for name in names:
        driver.get(f"{address}/{name}")
        driver.execute_script(
            "scrollTo(0, document.body.scrollHeight); dispatchEvent(new Event('resize'))"
        )
        time.sleep(0.05)  # what follows the page's position does so in the next frame
        messages, requested = logged(driver)
        own = address, "data:", "about:"
        if wrong := messages + [url for url in requested if not url.startswith(own)]:
            faults[name] = wrong
    assert faults == {}
