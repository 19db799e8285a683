"""The site of the documents in a real browser, from files and from a server: no errors, search,
narrow screens.

`bash scripts/browser.sh` installs what these need and runs them.
"""

import json
import os
import sys
import threading
import time
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer

import pytest
from conftest import IN_BROWSER, REPOSITORY, run_command

for module in ("selenium", "sphinx", "myst_parser", "furo"):
    pytest.importorskip(module, reason=f"{module} is not installed: bash scripts/browser.sh")
pytestmark = IN_BROWSER

NARROW_PX, SEARCH_S = 390, 20


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


class Quiet(SimpleHTTPRequestHandler):
    """What `python3 -m http.server` answers with, without its log."""

    def log_message(self, *words):
        pass


@pytest.fixture(scope="module", params=["file", "server"])
def address(request, site):
    """Where the site is opened, without the page's name."""
    if request.param == "file":
        yield site.as_uri()
        return
    with ThreadingHTTPServer(("127.0.0.1", 0), partial(Quiet, directory=site)) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_address[1]}"
        server.shutdown()


@pytest.fixture
def narrow(driver):
    """The driver with the screen of a telephone."""
    driver.execute_cdp_cmd(
        "Emulation.setDeviceMetricsOverride",
        {"width": NARROW_PX, "height": 844, "deviceScaleFactor": 2, "mobile": True},
    )
    yield driver
    driver.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})


def pages(site):
    """Names of all pages of the site."""
    return sorted(path.relative_to(site).as_posix() for path in site.rglob("*.html"))


def requested(driver):
    """URLs that were requested since the log was read last."""
    messages = (json.loads(entry["message"])["message"] for entry in driver.get_log("performance"))
    return {
        one["params"]["request"]["url"]
        for one in messages
        if one["method"] == "Network.requestWillBeSent"
    }


def test_every_page_opens_without_an_error_or_a_warning(driver, site, address):
    faults, names = {}, pages(site)
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


@pytest.mark.parametrize(
    "word, page",
    [
        ("lintel", "model/model"),
        ("softening", "guides/own-wall"),
        ("precompression", "model/model"),
    ],
)
def test_the_search_shows_the_text_around_the_word(driver, address, word, page):
    driver.get("about:blank")
    driver.get_log("browser")
    driver.get(f"{address}/search.html?q={word}")
    until, hits = time.monotonic() + SEARCH_S, {}
    while time.monotonic() < until and page not in hits:
        time.sleep(0.2)
        hits = {
            link.partition(".html")[0]: text
            for link, text in driver.execute_script(
                "return Array.from(document.querySelectorAll('#search-results li'), (hit) =>"
                " [hit.querySelector('a').getAttribute('href'), (hit.querySelector('.context') ||"
                " {innerText: ''}).innerText])"
            )
        }
    assert word in hits[page].lower()
    assert 60 < len(hits[page]) < 300
    assert all(hits.values())
    assert driver.get_log("browser") == []


def test_a_narrow_screen_scrolls_up_and_down_only(narrow, site):
    """Tables that are wider scroll in a box of their own."""
    wide, cut = {}, {}
    for name in pages(site):
        narrow.get((site / name).as_uri())
        width = narrow.execute_script("return document.documentElement.scrollWidth")
        if width > NARROW_PX:
            wide[name] = width
        hidden = narrow.execute_script(
            "const boxed = (one) => one && (/auto|scroll/.test(getComputedStyle(one).overflowX) ||"
            " boxed(one.parentElement)), wider = (one) => one.scrollWidth > one.clientWidth + 1 &&"
            " one.clientWidth > 0;return Array.from(document.querySelectorAll('article"
            " *')).filter((one) => (wider(one) || one.getBoundingClientRect().right > arguments[0])"
            " && !boxed(one)).map((one) => `${one.tagName} ${one.textContent.slice(0, 60)}`)",
            NARROW_PX,
        )
        if hidden:
            cut[name] = hidden
    assert (wide, cut) == ({}, {})
