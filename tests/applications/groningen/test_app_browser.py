"""The page of a claim in a real browser without a network: photograph, drawing, sheet; keys,
narrow, dark, languages.

`bash scripts/browser.sh` installs what these need and runs them.
"""

import re
import threading

import pytest
from conftest import IN_BROWSER, written

pytest.importorskip("selenium", reason="selenium is not installed: bash scripts/browser.sh")
pytest.importorskip("flask", reason="Flask is not installed: bash scripts/browser.sh")
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.support.select import Select
from selenium.webdriver.support.wait import WebDriverWait
from test_app import FRONT, exif_photo

from benchmarks.report_in_browser import screenshot
from damage.applications.groningen.app.desk import words
from damage.applications.groningen.app.server import make_app

pytestmark = IN_BROWSER
TOKEN, ROOT = "a token of the test", "/room"
WORDS = words()


@pytest.fixture
def page(driver, tmp_path):
    """(driver, application) with the page open in English."""
    from werkzeug.serving import make_server

    server = make_server("127.0.0.1", 0, None, threaded=True)
    server.app = app = make_app(tmp_path / "claim", server.server_port, TOKEN, ROOT)
    app.answers, inner = [], app.wsgi_app

    def watched(environ, start):
        def begin(status, *more):
            app.answers.append((environ["PATH_INFO"], status[:3]))
            return start(status, *more)

        return inner(environ, begin)

    app.wsgi_app = watched
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
    driver.get_log("browser")
    driver.get(address)
    ready(driver)


def ready(driver):
    WebDriverWait(driver, 20).until(
        lambda driver: driver.execute_script("return document.body.dataset.ready") == "yes"
    )


def by(driver, name):
    return driver.find_element("id", name)


def write(driver, name, text):
    """Type into a field; a text of several lines is set, as pasting does."""
    if "\n" in text:
        driver.execute_script("arguments[0].value = arguments[1]", by(driver, name), text)
    else:
        by(driver, name).clear()
        by(driver, name).send_keys(text)


def press(driver, name, said, seconds=20):
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
    asked = {
        url
        for entry in driver.get_log("performance")
        for url in re.findall(r'"url":"(https?://[^"]+)"', entry["message"])
    }
    assert [entry for entry in driver.get_log("browser") if entry["level"] != "DEBUG"] == []
    assert {url for url in asked if not url.startswith("http://127.0.0.1:")} == set()


def test_from_a_photograph_to_the_sheet(page, tmp_path):
    driver, _ = page
    write(driver, "latitude", "53.36786")
    write(driver, "longitude", "6,71359")
    assert "ends on 2022-01-26" in press(driver, "show-earthquakes", "said-address")
    assert (
        by(driver, "said-address")
        .find_element("tag name", "strong")
        .value_of_css_property("font-weight")
        == "700"
    )
    assert len(driver.find_elements("css selector", "#earthquakes tbody tr")) == 8
    write(driver, "front-text", FRONT)
    assert "1.125 × 0.6 m" in press(driver, "use-front", "said-front")
    photo = written(tmp_path / "photo.jpg", exif_photo())
    by(driver, "photo-file").send_keys(str(photo))
    WebDriverWait(driver, 20).until(lambda driver: by(driver, "photo").is_displayed())
    for across, up in ((0.2, 0.2), (0.8, 0.2), (0.8, 0.8), (0.2, 0.8)):
        click_at(driver, "photo", across, up)
    assert press(driver, "straighten", "said-photo") == WORDS["straightened"]["en"]
    for across, up in ((0.12, 0.3), (0.35, 0.6)):
        click_at(driver, "front", across, up)
    by(driver, "finish").click()
    assert len(driver.find_elements("css selector", "#drawn tbody tr")) == 1
    said = press(driver, "put-on-joints", "said-cracks")
    assert re.match(r"100 % of 0\.\d+ m of cracks lies on joints", said)
    screenshot(driver, tmp_path / "page.png")
    Select(by(driver, "settle")).select_by_value("hogging")
    write(driver, "draws", "2")
    by(driver, "start").click()
    WebDriverWait(driver, 240).until(
        lambda driver: by(driver, "said-compute").text not in ("", WORDS["running"]["en"])
    )
    assert by(driver, "said-compute").text == WORDS["done"]["en"], by(driver, "log").text
    silent(driver)
    by(driver, "sheet").click()
    driver.switch_to.window(driver.window_handles[-1])
    assert (
        "Cracks in a front" in driver.title and "mm" in driver.find_element("tag name", "body").text
    )
    driver.close()
    driver.switch_to.window(driver.window_handles[0])
    assert {path.name for path in (tmp_path / "claim").iterdir()} == {
        "house.toml",
        "photo.jpg",
        "straight.jpg",
        "survey.csv",
        "claim.log",
        "claim",
    }


def test_a_page_of_another_site_gets_nothing(page):
    """What a stranger's page in the same browser asks for is refused by its Origin, whatever it
    knows."""
    driver, app = page
    from http.server import BaseHTTPRequestHandler, HTTPServer

    class Stranger(BaseHTTPRequestHandler):
        def do_GET(self):
            self.send_response(200)
            self.send_header("Content-Type", "text/html")
            self.end_headers()
            self.wfile.write(b"<title>stranger</title>")

        def log_message(self, *_):
            pass

    server = HTTPServer(("127.0.0.1", 0), Stranger)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    driver.get(f"http://127.0.0.1:{server.server_port}/")
    root = app.address.partition("?")[0]
    for options in (
        "{mode: 'no-cors', credentials: 'include'}",
        "{method: 'POST', mode: 'no-cors', credentials: 'include', body: '{}'}",
    ):
        driver.execute_async_script(
            f"const done = arguments[0]; fetch('{root}api/stop', {options}).then(() => done(), ()"
            " => done())"
        )
    seen = driver.execute_async_script(
        f"const done = arguments[0]; fetch('{root}api/state', {{credentials: 'include'}})"
        ".then((answer) => done(answer.status), () => done('refused'))"
    )
    assert seen == "refused" and {
        status for path, status in app.answers if path == f"{ROOT}/api/stop"
    } == {"403"}
    assert (f"{ROOT}/api/state", "403") in app.answers
    driver.get_log("browser")
    server.shutdown()
