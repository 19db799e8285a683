"""The site of the documents in a real browser, from its files: no page has errors.

`bash scripts/browser.sh` installs what these need and runs them.
"""

import json
import os
import sys
import time

import pytest
from conftest import IN_BROWSER, REPOSITORY, run_command

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


def requested(driver):
    """URLs that were requested since the log was read last."""
    messages = (json.loads(entry["message"])["message"] for entry in driver.get_log("performance"))
    return {
        one["params"]["request"]["url"]
        for one in messages
        if one["method"] == "Network.requestWillBeSent"
    }


def test_every_page_opens_without_an_error_or_a_warning(driver, site):
    faults, address = {}, site.as_uri()
    names = sorted(path.relative_to(site).as_posix() for path in site.rglob("*.html"))
    assert len(names) > 40
    driver.get("about:blank")
    driver.get_log("browser"), requested(driver)
    for name in names:
        driver.get(f"{address}/{name}")
        driver.execute_script(
            "scrollTo(0, document.body.scrollHeight); dispatchEvent(new Event('resize'))"
        )
        time.sleep(0.05)  # what follows the page's position does so in the next frame
        if found := driver.get_log("browser"):
            faults[name] = [entry["message"] for entry in found]
        elsewhere = {
            url for url in requested(driver) if not url.startswith((address, "data:", "about:"))
        }
        if elsewhere:
            faults.setdefault(name, []).append(f"requests {elsewhere}")
    assert faults == {}
