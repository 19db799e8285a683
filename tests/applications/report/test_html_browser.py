"""The report in a real browser without a network: drawn without an error, moved by mouse and keys,
printed.

`bash scripts/browser.sh` installs what these need and runs them.
"""

import numpy as np
import pytest
from conftest import IN_BROWSER, logged
from test_html import damaged, make_study

from damage.applications.report.report import write_report

pytest.importorskip("selenium", reason="selenium is not installed: bash scripts/browser.sh")
from selenium.webdriver.common.keys import Keys

from benchmarks.report_in_browser import open_report

pytestmark = IN_BROWSER


@pytest.fixture(scope="module")
def reports(tmp_path_factory):
    """{name: path} of reports of a run, of two side by side, and of a study."""
    folder = tmp_path_factory.mktemp("browser")
    many = np.linspace(0, 1, 21)
    one = damaged(folder / "study" / "runs" / "one.h5", drift=1e-3 * many)
    two = damaged(
        folder / "study" / "runs" / "two.h5",
        opening={2: 2e-3 * many, 5: 1e-3 * many},
        slip={3: 3e-4 * many, 5: 1e-3 * many},
    )
    study = make_study(folder / "study", one, two)
    return {
        "one": write_report([one.path], folder / "one.html"),
        "two": write_report([one.path, two.path], folder / "two.html"),
        "study": write_report([study]),
    }


@pytest.fixture
def opened(driver, reports, request):
    """The driver with a report open, by its name."""
    driver.get("about:blank")
    logged(driver)
    if request.param == "study":  # it has no walls that are drawn
        driver.get(reports["study"].as_uri())
    else:
        open_report(driver, reports[request.param])
    return driver


of = lambda *names: pytest.mark.parametrize("opened", names, indirect=True)  # noqa: E731


def by_id(driver, name):
    return driver.find_element("id", name)


def paths(driver, letter="A"):
    """What the wall's lines are drawn along."""
    return driver.execute_script(
        f"return Array.from(document.querySelectorAll('#wall-{letter} .scatterlayer path.js-line'),"
        " (line) => line.getAttribute('d'))"
    )


def shown(driver):
    """(time in words, lines of the wall, place of the cursor over the lines in time, of the ring of
    the hysteresis)."""
    place = "const at = document.querySelector('{}').style; return [at.left, at.top]"
    return (
        by_id(driver, "time-shown").text,
        paths(driver),
        *(
            driver.execute_script(place.format(where))
            for where in ("#over-time .cursor", "#hysteresis-A .ring")
        ),
    )


@of("one", "two", "study")
def test_it_is_drawn_without_an_error_and_asks_for_nothing(opened):
    messages, requested = logged(opened)
    assert messages == []
    assert {url.partition(":")[0] for url in requested} <= {"file", "data", "blob"}
    failed = opened.find_elements("id", "failed")
    assert all(one.get_attribute("hidden") for one in failed)


@of("one")
def test_the_slider_moves_wall_cursor_and_ring_by_keys(opened):
    slider = by_id(opened, "time-slider")
    slider.send_keys(Keys.HOME)
    before = shown(opened)
    assert before[0] == "0.000 s"
    slider.send_keys(Keys.END)
    after = shown(opened)
    assert after[0] == "0.200 s" == slider.get_attribute("aria-valuetext")
    assert all(old != new for old, new in zip(before, after))
    slider.send_keys(Keys.ARROW_LEFT)
    assert shown(opened)[0] < after[0]
    assert "1 slipped, 1 opened" in by_id(opened, "shown-A").text
