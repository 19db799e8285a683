"""A report in a real browser without a network: seconds from its opening to its drawn wall, its
looks on screen and on paper.

    bash scripts/browser.sh                        # the tests of the report in the browser
    bash scripts/browser.sh FILE.html              # median of five cold starts
    bash scripts/browser.sh FILE.html --shots DIR  # and screen.png, paper-1.png in grey, ...

Chromium, headless, with its driver; every start is cold: a new process with an empty profile.  What
else the machine does at the time makes it slower; a graphics card is not used.
"""

import argparse
import base64
import statistics
import subprocess
import time
from contextlib import contextmanager
from pathlib import Path
from shutil import which

STARTS = 5
PATIENCE_S = 60
SIZE_PX = 1300, 1000
BROWSER = "chromium"
DRIVER = "chromedriver"
DRAWN = {"wall": "wall-drawn", "all": "all-drawn"}
"""Marks that the page sets once the walls, and once all is drawn."""


@contextmanager
def browser():
    """A headless Chromium that finds no other machine, as selenium's driver; it keeps logs of the
    console and of what it asked for."""
    from selenium import webdriver
    from selenium.webdriver.chrome.service import Service

    options = webdriver.ChromeOptions()
    options.binary_location = which(BROWSER)
    for word in (
        "--headless=new",
        "--no-sandbox",
        "--disable-gpu",
        "--disable-dev-shm-usage",
        "--hide-scrollbars",
        "--window-size={},{}".format(*SIZE_PX),
        "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1",
        "--disable-quic",
        "--no-first-run",
        "--disable-background-networking",
        "--disable-component-update",
        "--disable-sync",
    ):
        options.add_argument(word)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    driver = webdriver.Chrome(service=Service(which(DRIVER)), options=options)
    try:
        yield driver
    finally:
        driver.quit()


def open_report(driver, path):
    """Open a report and wait until all is drawn; {name of DRAWN: seconds since it was opened}."""
    driver.get(Path(path).resolve().as_uri())
    until = time.monotonic() + PATIENCE_S
    while time.monotonic() < until:
        found = {
            name: driver.execute_script(
                "return performance.getEntriesByName(arguments[0]).map((one) => one.startTime)",
                mark,
            )
            for name, mark in DRAWN.items()
        }
        if all(found.values()):
            return {name: times[0] / 1000 for name, times in found.items()}
        time.sleep(0.05)
    raise TimeoutError(f"{path} was not drawn in {PATIENCE_S} s: {driver.get_log('browser')}")


def cold_starts(path, n=STARTS):
    """{name of DRAWN: [seconds] of n cold starts}."""
    found = []
    for _ in range(n):
        with browser() as driver:
            found.append(open_report(driver, path))
    return {name: [one[name] for one in found] for name in DRAWN}


def screenshot(driver, path):
    """Write the whole page as it is on a screen, PNG."""
    width, height = driver.execute_script(
        "return [document.documentElement.scrollWidth, document.documentElement.scrollHeight]"
    )
    shot = driver.execute_cdp_cmd(
        "Page.captureScreenshot",
        {
            "captureBeyondViewport": True,
            "clip": {"x": 0, "y": 0, "width": width, "height": height, "scale": 1},
        },
    )
    Path(path).write_bytes(base64.b64decode(shot["data"]))


def print_pdf(driver, path):
    """Print the page to a PDF, backgrounds left out, as browsers do."""
    printed = driver.execute_cdp_cmd(
        "Page.printToPDF", {"printBackground": False, "preferCSSPageSize": True}
    )
    Path(path).write_bytes(base64.b64decode(printed["data"]))


def save_shots(report, folder):
    """Write screen.png, paper.pdf and its pages in grey, paper-1.png and so on, into a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    with browser() as driver:
        open_report(driver, report)
        screenshot(driver, folder / "screen.png")
        print_pdf(driver, folder / "paper.pdf")
    subprocess.run(
        ["pdftoppm", "-gray", "-r", "110", "-png", folder / "paper.pdf", folder / "paper"],
        check=True,
    )


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("report", type=Path, metavar="FILE.html")
    parser.add_argument("--shots", type=Path, metavar="DIR")
    asked = parser.parse_args()
    print(f"{asked.report.stat().st_size / 1e6:.2f} MB")
    for name, times in cold_starts(asked.report).items():
        print(
            f"{name} drawn after {statistics.median(times):.2f} s, median of {len(times)} cold"
            " starts: " + ", ".join(f"{one:.2f}" for one in sorted(times))
        )
    if asked.shots:
        save_shots(asked.report, asked.shots)


if __name__ == "__main__":
    main()
