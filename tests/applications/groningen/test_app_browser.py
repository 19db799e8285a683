"""The page of a claim in a real browser without a network: photograph, drawing, sheet; keys,
narrow, dark, languages.

`bash scripts/browser.sh` installs what these need and runs them.
"""

import base64
import json
import re
import threading
import time

import numpy as np
import pytest
from conftest import IN_BROWSER, logged, written

pytest.importorskip("selenium", reason="selenium is not installed: bash scripts/browser.sh")
pytest.importorskip("flask", reason="Flask is not installed: bash scripts/browser.sh")
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.support.select import Select
from selenium.webdriver.support.wait import WebDriverWait
from test_app import (
    CORNERS,
    CRACKS,
    EAVES,
    FRONT,
    LENGTH,
    RIDGE,
    ROOT,
    TOKEN,
    WINDOW,
    photographed,
    red_ends,
)

from benchmarks.report_in_browser import screenshot
from damage.applications.cracks.crack_file import read_cracks
from damage.applications.cracks.survey import read_survey
from damage.applications.groningen.app.desk import words
from damage.applications.groningen.app.photo import MARGIN_M
from damage.applications.groningen.app.server import make_app
from damage.applications.groningen.claim.make import layout_of
from damage.applications.groningen.claim.sheet import sheet
from damage.applications.groningen.claim.twins import read_twins
from damage.measure.cracks import ends_of

pytestmark = IN_BROWSER
WORDS = words()
PATIENCE_S = 90


@pytest.fixture
def page(driver, tmp_path):
    """(driver, application) with the page open in English."""
    from werkzeug.serving import make_server

    server = make_server("127.0.0.1", 0, None, threaded=True)
    server.app = app = make_app(tmp_path / "claim", server.server_port, TOKEN, ROOT)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    driver.set_window_size(1300, 1000)
    driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": []})
    app.address = f"http://127.0.0.1:{server.server_port}{ROOT}/?token={TOKEN}"
    open_page(driver, app.address)
    yield driver, app
    app.desk.stop()
    driver.get("about:blank")
    server.shutdown()


def open_page(driver, address):
    logged(driver)
    driver.get(address)
    ready(driver)


def ready(driver):
    WebDriverWait(driver, PATIENCE_S).until(
        lambda driver: driver.execute_script("return document.body?.dataset.ready") == "yes"
    )


def by(driver, name):
    return driver.find_element("id", name)


def write(driver, name, text):
    """Type into a field; a text of several lines is set, as pasting does."""
    if "\n" in text:
        driver.execute_script(
            "arguments[0].value = arguments[1]; arguments[0].dispatchEvent(new Event('change'))",
            by(driver, name),
            text,
        )
    else:
        by(driver, name).clear()
        by(driver, name).send_keys(text)


def press(driver, name, said, seconds=PATIENCE_S):
    """Press a button and wait for its word; returns it."""
    driver.execute_script("arguments[0].textContent = ''", by(driver, said))
    by(driver, name).click()
    WebDriverWait(driver, seconds).until(lambda driver: by(driver, said).text)
    return by(driver, said).text


def click_at(driver, name, across, up):
    """Click on a canvas at shares of its width and height, from below left."""
    canvas = by(driver, name)
    driver.execute_script("arguments[0].scrollIntoView({block: 'center'})", canvas)
    size = canvas.size
    ActionChains(driver).move_to_element_with_offset(
        canvas, round((across - 0.5) * size["width"]), round((0.5 - up) * size["height"])
    ).click().perform()


def silent(driver):
    """The console has nothing to say, and all requests went to the loopback interface."""
    messages, requested = logged(driver)
    assert messages == []
    assert {url for url in requested if not url.startswith(("http://127.0.0.1:", "blob:"))} == set()


def fill_in(driver, name, text):
    """Type over what a field has, and leave it."""
    by(driver, name).send_keys(Keys.CONTROL, "a")
    by(driver, name).send_keys(text, Keys.TAB)


def draw_front(driver):
    """The gabled front, as a drawing that begins with a wall without openings."""
    by(driver, "tab-text").click()
    write(driver, "front-text", FRONT.replace('lintel = "timber"\n', "").partition("[[")[0])
    wait_for(driver, "said-front", "house")
    by(driver, "tab-drawing").click()
    for name, value in zip(("load", "length", "eaves", "ridge"), (0, LENGTH, EAVES, RIDGE)):
        fill_in(driver, f"wall-{name}", str(value).replace(".", ","))
    by(driver, "add-opening").click()
    left, low, right, upper = WINDOW
    sizes = {"height": upper - low, "sill": low, "width": right - left, "left": left}
    for name, value in sizes.items():
        fill_in(driver, f"part-{name}", f"{value:g}")
    by(driver, "add-floor").click()
    fill_in(driver, "part-mass", "6000")
    wait_for(driver, "said-front", "2.2 × 1.8 m", "2,2 × 1,8 m")


def straighten(driver, path):
    """The photograph by four corners, and two of the window."""
    photo, at = photographed()
    by(driver, "photo-file").send_keys(str(written(path, photo)))
    WebDriverWait(driver, PATIENCE_S).until(lambda driver: by(driver, "photo").is_displayed())
    for x, y in at([*CORNERS, WINDOW[:2], WINDOW[2:]]):
        click_at(driver, "photo", x / 1200, 1 - y / 900)
    assert press(driver, "straighten", "said-photo") == WORDS["straightened"]["nl"]


def draw_cracks(driver, folder):
    """The red lines of the straight photograph, put on joints; within 5 cm of their places."""
    wide = LENGTH + 2 * MARGIN_M
    high = RIDGE + 2 * MARGIN_M
    for ends in red_ends(folder / "straight.jpg"):
        for x, z in ends:
            click_at(driver, "front", (x + MARGIN_M) / wide, (z + MARGIN_M) / high)
        by(driver, "finish").click()
    said = press(driver, "put-on-joints", "said-cracks")
    assert re.match(r"\d+ % van \d,\d+ m scheuren ligt op voegen", said)
    (pattern,) = read_cracks(folder / "survey.csv")
    for label, points in CRACKS.items():
        line = pattern.stretches[pattern.stretches["crack"] == label]
        assert np.abs(ends_of(line)[0] - points).max() < 0.05


def test_from_an_empty_page_to_the_dutch_sheet_with_a_photograph(page, tmp_path):
    driver, app = page
    driver.get(app.address.partition("?")[0] + "?language=nl")
    ready(driver)
    write(driver, "latitude", "53.36786")
    write(driver, "longitude", "6,71359")
    assert "eindigt op 2022-01-26" in press(driver, "show-earthquakes", "said-address")
    assert len(driver.find_elements("css selector", "#earthquakes tbody tr")) == 8
    draw_front(driver)
    straighten(driver, tmp_path / "photo.jpg")
    draw_cracks(driver, tmp_path / "claim")
    screenshot(driver, tmp_path / "page.png")
    Select(by(driver, "settle")).select_by_value("hogging")
    Select(by(driver, "units")).select_by_value("2 2")
    write(driver, "draws", "2")
    by(driver, "start").click()
    WebDriverWait(driver, 400).until(
        lambda driver: WORDS["running"]["nl"] not in by(driver, "said-compute").text != ""
    )
    log = driver.execute_script("return document.getElementById('log').textContent")
    assert by(driver, "said-compute").text == WORDS["done"]["nl"], log
    silent(driver)
    by(driver, "sheet").click()
    driver.switch_to.window(driver.window_handles[-1])
    assert "Scheuren in een gevel" in driver.title
    assert "Geen antwoord" in driver.find_element("tag name", "body").text
    pdf = driver.execute_cdp_cmd("Page.printToPDF", {"preferCSSPageSize": True})["data"]
    assert re.findall(rb"/Count (\d+)", base64.b64decode(pdf)) == [b"2"], "both sides"
    driver.close()
    driver.switch_to.window(driver.window_handles[0])
    no_table_is_wider_than_a_telephone(driver, tmp_path)
    names = {"house.toml", "photo.jpg", "straight.jpg", "survey.csv", "claim.log", "claim"}
    assert {path.name for path in (tmp_path / "claim").iterdir()} == names


def no_table_is_wider_than_a_telephone(driver, folder):
    """At 390 px the sheet of a claim in a folder, as if it had an answer, shows whole tables."""
    layout = layout_of(folder / "claim/house.toml", (2, 2))
    place = folder / "claim/claim"
    numbers = json.loads((place / "claim.json").read_text()) | {"no_answer": []}
    for row in (row for table in numbers["like_survey"].values() for row in table.values()):
        row |= {"share": 0.53, "low": 0.31, "high": 0.65}
    survey = read_survey(folder / "claim/survey.csv", layout)
    page = sheet(numbers, layout, survey, read_twins(place, layout), "nl", "claim.json")
    narrow(driver)
    driver.get(written(folder / "answer.html", page.encode()).as_uri())
    wider = driver.execute_script(
        "return [...document.querySelectorAll('.scroll')].map((e) => e.scrollWidth - e.clientWidth)"
    )
    assert wider == [0, 0, 0]
    driver.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})


def narrow(driver):
    """A screen of 390 px."""
    driver.execute_cdp_cmd(
        "Emulation.setDeviceMetricsOverride",
        {"width": 390, "height": 900, "deviceScaleFactor": 1, "mobile": False},
    )


def wait_for(driver, name, *texts):
    """Wait until one of these texts is in a place."""
    until = time.monotonic() + PATIENCE_S
    while not any(text in by(driver, name).text for text in texts):
        assert time.monotonic() < until, by(driver, name).text
        time.sleep(0.1)


def test_what_is_drawn_can_be_moved_is_checked_and_outlives_a_reload(page):
    driver, _ = page
    write(driver, "front-text", FRONT)
    wait_for(driver, "said-front", "Front house")
    write(driver, "width", "x")
    assert by(driver, "width").get_attribute("aria-invalid") == "true"
    assert by(driver, "said-cracks").text == WORDS["bad_width"]["en"]
    write(driver, "width", "0,4")
    for across, up in ((0.2, 0.3), (0.4, 0.5)):
        click_at(driver, "front", across, up)
    by(driver, "finish").click()
    Select(by(driver, "tool")).select_by_value("move")
    drag(driver, "front", (0.4, 0.5), (0.5, 0.7))
    # and by keys: Enter takes the point below the cross, and drops it
    by(driver, "front").send_keys(Keys.ENTER, *[Keys.ARROW_RIGHT] * 5, Keys.ENTER, Keys.ARROW_LEFT)
    # the window, as wide as 0.4 of the front, by a quarter of a brick along it and two courses up
    canvas = by(driver, "sketch")
    drag(driver, "sketch", (0.5, 0.5), (0.5, 0.7))
    wait_for(driver, "said-front", "Front house")
    canvas.send_keys(Keys.ARROW_RIGHT)
    said = driver.execute_script("return [cracks, table.openings]")
    time.sleep(1)
    driver.refresh()
    ready(driver)
    assert driver.execute_script("return [cracks, table.openings]") == said
    (crack,), (window,) = said
    assert crack["label"] == "A" and crack["width_mm"] == 0.4
    assert crack["points"][1] == pytest.approx([0.55 * 1.325 - 0.1, 0.7 * 0.8 - 0.1], abs=0.02)
    assert window["sill"] == pytest.approx(0.3) and window["left"] > 0.3375
    silent(driver)


def test_the_page_after_a_reload_in_dutch_at_390_px(page):
    """The table of earthquakes and the stairs are there, no table is cut, numbers have commas, and
    the height is that of whole courses; the front needs no button."""
    driver, app = page
    driver.get(app.address.partition("?")[0] + "?language=nl")
    ready(driver)
    said = press(driver, "show-earthquakes", "said-address")
    assert "breedtegraad ontbreekt" in said and "None" not in said
    names = [option.text for option in by(driver, "fronts").find_elements("tag name", "option")]
    assert names and not re.search(r"couplet|triplet|_", " ".join(names))
    press(driver, "start", "said-compute")
    assert by(driver, "said-compute").text == WORDS["see_step"]["nl"].format(step=4)
    assert "teken er een" in by(driver, "said-cracks").text
    write(driver, "latitude", "53.36786")
    write(driver, "longitude", "6.71359")
    Select(by(driver, "fronts")).select_by_visible_text("Huis van twee bouwlagen")
    wait_for(driver, "said-front", "Gevel Huis van twee bouwlagen: 3,96 × 5,1 m")
    fill_in(driver, "wall-eaves", "5,2")
    wait_for(driver, "said-front", "× 5,175 m", "× 5,25 m")
    assert by(driver, "wall-eaves").get_attribute("value") in by(driver, "said-front").text
    assert (
        "geldigheidsgebied" in by(driver, "outside").text and "hoogte" in by(driver, "outside").text
    )
    for across, up in ((0.05, 0.3), (0.15, 0.45)):
        click_at(driver, "front", across, up)
    assert "op voegen" in press(driver, "put-on-joints", "said-cracks")
    joints = driver.execute_script("return joints")
    narrow(driver)
    driver.refresh()
    ready(driver)
    assert joints and driver.execute_script("return joints") == joints
    for name in ("earthquakes", "drawn"):
        table = by(driver, name)
        assert table.is_displayed() and table.rect["x"] + table.rect["width"] <= 390
    assert "53,36786" == by(driver, "latitude").get_attribute("value")
    values = driver.execute_script(
        "return [...document.querySelectorAll('input')].map((e) => e.value)"
    )
    text = driver.find_element("tag name", "body").text
    assert not [value for value in [*values, text] if re.search(r"\d\.\d", value)]
    assert not re.search(r"\((m|mm|kg|kPa|mm/s|km)\)|None", text), "units are in brackets"
    assert "[mm]" in text and "[kg]" in driver.page_source
    driver.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})
    silent(driver)


def drag(driver, name, start, end):
    """Drag on a canvas between shares of its width and height, from below left."""
    canvas = by(driver, name)
    driver.execute_script("arguments[0].scrollIntoView({block: 'center'})", canvas)
    size = canvas.size
    chain = ActionChains(driver)
    places = [
        (round((x - 0.5) * size["width"]), round((0.5 - up) * size["height"]))
        for x, up in (start, end)
    ]
    chain.move_to_element_with_offset(canvas, *places[0]).click_and_hold()
    chain.move_to_element_with_offset(canvas, *places[1]).release().perform()
