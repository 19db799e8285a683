"""The page of a claim: who is refused, what an upload may be, where it writes, words of both
languages."""

import io
import json
import os
import re
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path
from urllib.parse import unquote, urlsplit

import numpy as np
import pytest
from conftest import REPOSITORY, is_running, refused_with, wait_until, written

pytest.importorskip("flask", reason="Flask is not installed: python3-flask")
from PIL import Image, ImageDraw

from damage.__main__ import main
from damage.applications.groningen.app.desk import Desk, words
from damage.applications.groningen.app.photo import MARGIN_M, cleaned, homography, rectified
from damage.applications.groningen.app.server import HEADER, PAGE, make_app, serve

PORT = 8765
TOKEN = "a token of the test"
ROOT = "/room"
FRONT = """name = "house"
length = 1.125
height = 0.6
precompression = 0.1e6
lintel = "timber"

[[openings]]
left = 0.3375
width = 0.45
height = 0.3
sill = 0.15
"""
CRACK = {"label": "A", "points": [[0.02, 0.1], [0.3, 0.3]], "width_mm": 0.4, "offset": "no"}
HERE = f"127.0.0.1:{PORT}"


def exif_photo(width=400, height=300, orientation=1):
    """A photograph, bytes of JPEG: dark with a light upper left quarter, with a place and a camera
    in its metadata."""
    picture = Image.new("RGB", (width, height), (40, 40, 40))
    picture.paste((230, 230, 230), (0, 0, width // 2, height // 2))
    exif = picture.getexif()
    exif[0x0112] = orientation
    exif[0x010F] = "Camera of A. Name"
    exif.get_ifd(0x8825).update({1: "N", 2: (53.0, 22.0, 4.3)})
    file = io.BytesIO()
    picture.save(file, "JPEG", exif=exif, comment=b"a comment")
    return file.getvalue()


@pytest.fixture
def app(tmp_path):
    return make_app(tmp_path / "out", PORT, TOKEN, ROOT)


@pytest.fixture
def client(app):
    """A client that has the token, as the page has it."""
    client = app.test_client()
    assert get(client, f"?token={TOKEN}").status_code == 200
    return client


def get(client, path):
    """The answer to what the page asks for at an address."""
    return client.get(f"{ROOT}/{path}", headers={"Host": HERE})


def call(client, name, given, **headers):
    """(status, answer) of what the page posts."""
    usual = {"Host": HERE, "Origin": f"http://{HERE}", HEADER: TOKEN}
    more = {"data": given} if isinstance(given, bytes) else {"json": given}
    answer = client.post(
        f"{ROOT}/api/{name}",
        headers={key: value for key, value in (usual | headers).items() if value is not None},
        **more,
    )
    return answer.status_code, answer.get_json(silent=True)


def done(client, name, **given):
    status, answer = call(client, name, given)
    assert status == 200 and "error" not in answer, answer
    return answer


def refused(client, name, **given):
    status, answer = call(client, name, given)
    assert status == 200 and set(answer) == {"error"} and "\n" not in answer["error"]
    return answer["error"]


# --- who is refused -------------------------------------------------------------------------------


def test_the_token_leaves_the_address_and_becomes_a_strict_cookie(app):
    client = app.test_client()
    answer = get(client, f"?token={TOKEN}")
    assert answer.headers["Refresh"] == f"0; url={ROOT}/?language=en" and TOKEN not in answer.text
    cookie = answer.headers["Set-Cookie"]
    assert all(word in cookie for word in ("HttpOnly", "SameSite=Strict", f"Path={ROOT}/"))
    answer = get(client, "")
    assert answer.status_code == 200 and TOKEN in answer.text
    for name, word in (
        ("Content-Security-Policy", "default-src 'none'"),
        ("X-Content-Type-Options", "nosniff"),
        ("Referrer-Policy", "no-referrer"),
        ("Cache-Control", "no-store"),
    ):
        assert word in answer.headers[name]


@pytest.mark.parametrize(
    "path",
    [
        "/",
        f"/?token={TOKEN}",
        *(
            f"{ROOT}/{name}"
            for name in ("", "?token=wrong", "api/state", "assets/app.js", "files/survey.csv")
        ),
    ],
)
def test_without_the_token_nothing_is_given(app, path):
    assert app.test_client().get(path, headers={"Host": HERE}).status_code == 403


@pytest.mark.parametrize(
    "headers",
    [
        {"Host": "attacker.example"},
        {"Host": f"attacker.example:{PORT}"},
        {"Host": "127.0.0.1:80"},
        {"Origin": "http://attacker.example"},
        {"Origin": "null"},
        {"Origin": f"http://{HERE}.attacker.example"},
        {"Origin": None},
        {HEADER: None},
        {HEADER: "wrong"},
        {"Sec-Fetch-Site": "cross-site"},
        {"Sec-Fetch-Site": "same-site"},
    ],
    ids=str,
)
def test_strangers_requests_are_refused(client, headers):
    """Another name for this machine, another page in the same browser, a page of another port, all
    with the cookie."""
    assert call(client, "stop", {}, **headers)[0] == 403
    assert call(client, "stop", {})[0] == 200


@pytest.mark.parametrize(
    "body",
    [
        b'{"text": "\xff"}',
        b'{"text": ',
        b"[]",
        b"[" * 100_000,
        b'{"text": "x", "more": 1}',
        b'{"text": ' + b"9" * 5000 + b"}",
    ],
    ids=["not UTF-8", "cut", "list", "deep", "more", "digits"],
)
def test_a_body_that_no_page_sends_is_refused(client, body):
    assert call(client, "front", body, **{"Content-Type": "application/json"})[0] == 400


def test_what_is_no_call_of_the_page_is_refused(client):
    assert call(client, "stop", {"more": 1})[0] == 400 and call(client, "stop", [1])[0] == 400
    assert call(client, "progress", {})[0] == 404 and call(client, "_given", {})[0] == 404
    assert call(client, "stop", b"{}", **{"Content-Type": "text/plain"})[0] in (400, 415)
    assert call(client, "photograph", b"x" * 20_100_000)[0] == 413
    for name in ("../../etc/passwd", "claim.log", "house.toml", "claim/../survey.csv"):
        assert get(client, f"files/{name}").status_code == 404


def test_it_listens_on_the_loopback_interface_alone(tmp_path):
    """The command as a user starts it: its address answers with the token alone, and this machine's
    others do not."""
    process = subprocess.Popen(
        [sys.executable, "-m", "damage", "app", "--no-browser", "--out", str(tmp_path / "o")],
        cwd=REPOSITORY,
        stdout=subprocess.PIPE,
        text=True,
    )
    try:
        address = re.search(
            r"http://127\.0\.0\.1:(\d+)(/\w{16}/)\?token=\S{40,}", process.stdout.readline()
        )
        port = int(address[1])
        with socket.create_connection(("127.0.0.1", port), 10) as caller:
            caller.sendall(f"GET {address[2]} HTTP/1.0\r\nHost: 127.0.0.1:{port}\r\n\r\n".encode())
            assert b" 403 " in caller.recv(100)
        for host in {"127.0.0.2", socket.gethostbyname(socket.gethostname())} - {"127.0.0.1"}:
            with (
                pytest.raises((ConnectionError, TimeoutError)),
                socket.create_connection((host, port), 2),
            ):
                pass
    finally:
        process.terminate()
        process.wait(20)
        process.stdout.close()


# --- photographs ----------------------------------------------------------------------------------


def test_metadata_are_removed_and_the_picture_is_turned(client, tmp_path):
    """Orientation 6: the camera lay on its side, the light quarter is above right when it is
    upright."""
    assert call(client, "photograph", exif_photo(orientation=6))[0] == 200
    data = (tmp_path / "out/photo.jpg").read_bytes()
    for word in (b"Exif", b"Camera", b"comment", b"ICC_PROFILE"):
        assert word not in data
    picture = Image.open(io.BytesIO(data))
    assert picture.size == (300, 400) and not dict(picture.getexif())
    assert picture.getpixel((250, 50))[0] > 200 > 60 > picture.getpixel((50, 50))[0]


def png_that_claims(side):
    """A PNG of a few bytes whose header says that it has so many pixels a side."""
    import struct
    import zlib

    head = struct.pack(">IIBBBBB", side, side, 8, 0, 0, 0, 0)
    parts = [(b"IHDR", head), (b"IDAT", zlib.compress(b"\0" * 100)), (b"IEND", b"")]
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
        for name, data in parts
    )


@pytest.mark.parametrize(
    "data, said",
    [
        (b"", "cannot be read; expected JPEG or PNG"),
        (b"<svg onload='x()'/>", "cannot be read"),
        (exif_photo()[:900], "cannot be read"),
        (png_that_claims(10_000), "cannot be read; expected .* 50 million pixels"),
        (b"\xff" * 20_000_001, "cannot be read; expected .* 20 MB"),
    ],
    ids=["empty", "svg", "cut", "bomb", "bytes"],
)
def test_what_is_no_photograph_is_one_line(data, said):
    refused_with(said, cleaned, data)


def test_a_photograph_is_straightened_by_corners_of_the_outline(client):
    """A gabled front has corners at the eaves and not the height of its ridge, which would stretch
    it."""
    gable = "outline = [[0, 0.6], [0.5625, 0.75], [1.125, 0.6]]\nheight = 0.75"
    text = FRONT.replace("precompression = 0.1e6", "precompression = 0")
    found = done(client, "front", text=text.replace("height = 0.6", gable))
    assert found["corners"] == [[0, 0], [1.125, 0], [1.125, 0.6], [0, 0.6]]
    pixels = [[0, 9], [9, 9], [9, 0], [0, 0]]
    places = [[0, 0], [1.125, 0], [1.125, 0.75], [0, 0.75]]
    said = refused(client, "straighten", pixels=pixels, places=places, openings=[])
    assert "(1.125, 0.75) m; expected corners of the front's outline" in said


def test_a_photograph_whose_openings_are_elsewhere_is_refused(client):
    """The window is from 0.3375 to 0.7875 m and 0.15 to 0.45 m; a course has 0.075 m, 40 pixels."""
    done(client, "front", text=FRONT)
    assert call(client, "photograph", exif_photo(700, 400))[0] == 200
    pixels = np.array([[50, 370], [650, 370], [650, 50], [50, 50]])
    given = {
        "pixels": pixels.tolist(),
        "places": [[0, 0], [1.125, 0], [1.125, 0.6], [0, 0.6]],
    }
    window = np.array([[230, 290], [470, 130]])
    assert "no opening of the photograph" in refused(client, "straighten", **given, openings=[])
    mirrored = given | {"pixels": pixels[[1, 0, 3, 2]].tolist()}
    assert "a mirrored photograph" in refused(client, "straighten", **mirrored, openings=[])
    assert done(client, "straighten", **given, openings=[window.tolist()])["file"]
    assert done(client, "front", text="\ufeff" + FRONT)["straight"]
    table = done(client, "front", text=FRONT)["table"] | {"length": 1.575}
    assert not done(client, "sketch", table=table)["straight"], "it is of another front"
    done(client, "front", text=FRONT)
    for off in ((45, 0), (0, -45)):
        said = refused(client, "straighten", **given, openings=[(window + off).tolist()])
        assert "lies more than a course from each of the front" in said
    _, answer = call(client, "straighten", given | {"openings": []}, **{"Accept-Language": "nl"})
    assert answer["error"].startswith("er is op de foto geen opening aangewezen")


def test_a_front_is_edited_as_a_drawing(client, tmp_path):
    found = done(client, "front", text=FRONT)
    assert (tmp_path / "out/house.toml").read_text() == FRONT and found["course"] == 0.075
    assert found["outside"]["en"].startswith("Outside the model's range of validity in 2 of 8")
    assert found["openings"] == [[0.3375, 0.15, 0.7875, 0.45]]
    table = found["table"] | {
        "precompression": 0,
        "outline": [[0, 0.6], [0.5625, 0.75], [1.125, 0.6]],
    }
    table |= {"height": 0.75, "floors": [{"level": 0.6, "mass": 300}]}
    edited = done(client, "sketch", table=table)
    assert edited["outline"][3] == [0.5625, 0.75]
    assert (tmp_path / "out/house.toml").read_text() == edited["text"]
    table["openings"][0]["left"] = 0.01
    assert "opening 1" in refused(client, "sketch", table=table)


LENGTH = 2.2
EAVES = 1.2
RIDGE = 1.8
WINDOW = 0.88, 0.3, 1.32, 0.9
CRACKS = {"A": [(0.44, 0.15), (0.88, 0.45)], "B": [(1.32, 0.9), (1.54, 1.2)]}
"""A gabled front, its window (left, lower, right, upper edge) and its cracks [m]."""
CORNERS = np.array([[0, 0], [LENGTH, 0], [LENGTH, EAVES], [0, EAVES]])


def photographed():
    """(JPEG of that front seen at an angle, with red cracks, function from places on it [m] to
    pixels)."""
    seen = np.array([[120, 800], [1060, 730], [1000, 330], [160, 290]], float)
    to_pixels = homography(CORNERS, seen)

    def at(places):
        u, v, w = to_pixels @ np.column_stack([places, np.ones(len(places))]).T
        return [tuple(map(float, point)) for point in zip(u / w, v / w)]

    picture = Image.new("RGB", (1200, 900), (178, 160, 140))
    pen = ImageDraw.Draw(picture)
    for points in CRACKS.values():
        pen.line(at(points), fill=(250, 0, 0), width=5)
    file = io.BytesIO()
    picture.save(file, "JPEG", quality=95)
    return file.getvalue(), at


def red_ends(picture):
    """Both ends [m] of each red line in a straightened picture, from left to right."""
    pixels = np.asarray(Image.open(picture).convert("RGB")).astype(int)
    z, x = np.nonzero((pixels[..., 0] > 150) & (pixels[..., 1:].max(axis=2) < 90))
    places = np.column_stack([x, len(pixels) - z]) * (LENGTH + 2 * MARGIN_M) / pixels.shape[1]
    places -= MARGIN_M
    lines = [places[places[:, 0] < 1.1], places[places[:, 0] >= 1.1]]
    return [[line[line[:, 0].argmin()], line[line[:, 0].argmax()]] for line in lines]


def test_four_points_straighten_a_photograph():
    """Both cracks of a front that is seen from an angle are where they are on it."""
    photo, at = photographed()
    straight = rectified(photo, at(CORNERS), CORNERS, LENGTH, RIDGE)
    for ends, points in zip(red_ends(io.BytesIO(straight)), CRACKS.values()):
        assert np.array(ends) == pytest.approx(np.array(points), abs=0.015)


# --- the claim's parts ----------------------------------------------------------------------------


def test_a_survey_that_was_drawn_is_on_the_joints_and_read_back(client, tmp_path):
    done(client, "front", text=FRONT)
    found = done(
        client,
        "survey",
        cracks=[CRACK],
        areas=[[[0.8, 0.1], [1.1, 0.5]]],
        limit_mm=0.1,
        error_mm=0.05,
    )
    assert (
        found["share_on_joints"] == 1.0
        and len(found["joints"]) > 3
        and found["psi"] == pytest.approx(2 * 0.4**0.3)
    )
    state = get(client, "api/state").get_json()
    assert state["survey"] == found, "the stairs are there after a reload"
    assert state["drawn"] == {
        "cracks": [CRACK],
        "areas": [[0.8, 0.1, 1.1, 0.5]],
        "limit_mm": 0.1,
        "error_mm": 0.05,
    }
    assert (
        main(
            ["cracks", str(tmp_path / "out/survey.csv"), "--wall", str(tmp_path / "out/house.toml")]
        )
        == 0
    )


def drawn(*cracks):
    return {"cracks": list(cracks), "areas": [], "limit_mm": 0.1, "error_mm": 0}


LEVELS = "x_m,height_m\n0,0.5\n1.1,0.498\n"
START = {
    "latitude": 53.36786,
    "longitude": 6.71359,
    "settle": None,
    "distortion": None,
    "draws": 2,
    "language": "en",
}
AWAY = drawn(CRACK | {"points": [[5, 5], [9, 9]]})
"""A crack that is not on the wall."""


@pytest.mark.parametrize(
    "name, given, said",
    [
        ("survey", drawn(CRACK | {"width_mm": "1; rm"}), "width of crack"),
        ("survey", drawn(CRACK | {"offset": "=1+1"}), "offset of crack 1"),
        ("survey", drawn(1), "crack 1: expected"),
        ("survey", drawn(CRACK, CRACK | {"label": "#1"}), "is there twice"),
        ("survey", drawn(CRACK | {"points": [[10**400, 0.1], [0.3, 0.3]]}), "crack 1"),
        ("address", {"latitude": 53, "longitude": -(10**400)}, "longitude"),
        (
            "address",
            {"latitude": None, "longitude": 6.7},
            "^latitude is missing: expected a number",
        ),
        ("survey", AWAY, "the survey.*0 %"),
        ("front", {"text": FRONT.replace("length", "lenght")}, "lenght"),
        ("front", {"text": 3}, "characters of TOML"),
        ("front", {"text": "import os"}, "the front"),
        ("levels", {"text": "x,z\n1,1\n"}, "no column x_m"),
        ("address", {"latitude": 52.0, "longitude": 5.0}, "km"),
        ("levels", {"text": "x_m,height_m\n0,0.5\n0.2,0.498\n"}, "the file of levels"),
    ],
)
def test_what_the_page_cannot_do_is_one_line_and_leaves_what_was_accepted(
    client, tmp_path, name, given, said
):
    ready_to_start(client)
    done(client, "levels", text=LEVELS)
    before = {path.name: path.read_bytes() for path in (tmp_path / "out").iterdir()}
    message = refused(client, name, **given)
    assert re.search(said, message) and "Traceback" not in message
    assert {path.name: path.read_bytes() for path in (tmp_path / "out").iterdir()} == before


def test_a_claim_does_not_start_without_a_survey(client):
    done(client, "front", text=FRONT)
    assert refused(client, "start", **START) == (
        "the survey is missing; expected it in step 4 of the page"
    )


@pytest.mark.parametrize("name", ["claim/patterns", "claim/tables/a.csv", "claim.log"])
def test_runs_do_not_start_where_a_link_leads_out_of_the_folder(
    client, tmp_path, monkeypatch, name
):
    """In a folder that was sent."""
    monkeypatch.setattr("damage.applications.groningen.app.job.subprocess.Popen", None)
    ready_to_start(client)
    link = tmp_path / "out" / name
    link.parent.mkdir(parents=True, exist_ok=True)
    link.symlink_to(tmp_path)
    assert (
        refused(client, "start", **START)
        == f"{name} is a link, a pipe or a device; expected a file of this claim; delete it"
    )


def ready_to_start(client):
    done(client, "front", text=FRONT)
    done(client, "survey", **drawn(CRACK))


class Ended:
    """In place of the process of a claim: one that ended with an error, or that runs."""

    pid = 2**30
    status = 2
    given = None

    def __init__(self, words, **given):
        Ended.given = given

    def poll(self):
        return Ended.status


def test_the_sheet_of_other_inputs_is_not_offered(client, tmp_path, monkeypatch):
    """Another front or survey, a run that is refused, that fails or that is stopped: the former one
    has another name; what is sent once more changes nothing."""
    monkeypatch.setattr("damage.applications.groningen.app.job.subprocess.Popen", Ended)
    ready_to_start(client)
    (folder := tmp_path / "out/claim").mkdir()
    written(folder / "claim.json", '{"more_draws": "More draws can help."}')
    assert get(client, "api/progress").get_json()["more"] == "More draws can help."

    def offered(name, given):
        for one in ("claim.html", "claim.json"):
            written(folder / one, "of the former house")
        call(client, name, given)
        there = get(client, "api/state").get_json()["sheet"] is not None
        shown = get(client, "files/claim/claim.html").status_code == 200
        assert there == shown == (folder / "claim.json").exists()
        assert there or (folder / "former-claim.html").read_text() == "of the former house"
        return there

    assert offered("front", {"text": FRONT}) and offered("survey", drawn(CRACK))
    assert offered("front", {"text": "length ="}) and offered("survey", AWAY)
    assert not offered("front", {"text": FRONT + "\n"})
    assert not offered("survey", drawn(CRACK | {"width_mm": 0.5}))
    assert not offered("levels", {"text": LEVELS})
    assert not offered("start", START) and not offered(
        "start", START | {"latitude": 52.0, "longitude": 5.0}
    )


def test_the_inputs_of_runs_do_not_change_under_them(client, tmp_path, monkeypatch):
    monkeypatch.setattr("damage.applications.groningen.app.job.subprocess.Popen", Ended)
    monkeypatch.setattr(Ended, "status", None)
    ready_to_start(client)
    done(client, "start", **START)
    for name, given in (
        ("front", {"text": FRONT + "\n"}),
        ("survey", drawn(CRACK | {"width_mm": 0.5})),
        ("levels", {"text": LEVELS}),
    ):
        assert "cannot change while the computation runs" in refused(client, name, **given)
    assert (tmp_path / "out/house.toml").read_text() == FRONT
    monkeypatch.setattr(Ended, "status", 0)


def test_the_browser_s_command_line_does_not_have_the_token(tmp_path, monkeypatch):
    """It has a file that its owner alone can read."""
    opened = []

    def see(address):
        file = Path(unquote(urlsplit(address).path))
        opened.append((address, file, file.read_text(), file.stat().st_mode & 0o777))
        raise KeyboardInterrupt

    monkeypatch.setattr("webbrowser.open", see)
    with pytest.raises(KeyboardInterrupt):
        serve(tmp_path / "out")
    [(address, file, text, mode)] = opened
    assert address.startswith("file:///") and "token" not in address and mode == 0o600
    assert (
        re.search(r'content="0; url=http://127\.0\.0\.1:\d+/\w{16}/\?token=[\w-]{40,}"', text)
        and not file.exists()
    )


def test_a_computation_is_started_stopped_and_not_started_twice(tmp_path, monkeypatch):
    """Whose command line is that of the claim; modules of the working folder, which may have been
    sent, are not run."""
    written(tmp_path / "damage.py", f"open({str(tmp_path / 'ran')!r}, 'w')")
    monkeypatch.chdir(tmp_path)
    desk = Desk(tmp_path / "out")
    desk.front(FRONT)
    desk.survey([CRACK], [], 0.1, 0.05)
    start = START | {"settle": "hogging", "distortion": 1 / 2000, "draws": 200, "language": "nl"}
    for wrong in (
        {"settle": "--help"},
        {"distortion": None},
        {"draws": 1},
        {"language": "fr"},
        {"latitude": "53"},
    ):
        refused_with("", desk.start, **start | wrong)
    assert desk.start(**start)["running"]
    refused_with("running already", desk.start, **start)
    until = time.monotonic() + 120
    while not any(
        "x 200 draws" in line or "x 200 trekkingen" in line for line in desk.progress()["lines"]
    ):
        assert time.monotonic() < until and desk.job.running, desk.progress()
        time.sleep(0.2)
    assert not desk.stop()["running"] and str(tmp_path) not in json.dumps(desk.progress()["lines"])
    assert not (tmp_path / "ran").exists()


def test_a_computation_ends_with_the_page_that_is_killed(tmp_path):
    """Whose request, and the thread that answered it, have long ended."""
    desk = Desk(tmp_path / "out")
    desk.front(FRONT)
    desk.survey([CRACK], [], 0.1, 0.05)
    program = (
        "import sys, threading, time; from damage.applications.groningen.app.desk import Desk; desk"
        " = Desk(sys.argv[1]); one = threading.Thread(target=desk.start, args=(53.36786, 6.71359,"
        " None, None, 200, 'en')); one.start(); one.join(); time.sleep(1);"
        " print(desk.job.process.pid, desk.job.running, flush=True); time.sleep(600)"
    )
    with subprocess.Popen(
        [sys.executable, "-c", program, str(desk.out)],
        stdout=subprocess.PIPE,
        text=True,
        cwd=REPOSITORY,
    ) as page:
        pid, running = page.stdout.readline().split()
        wait_until(lambda: len(group(pid)) > 2)  # processes of its runs, too
        page.kill()
    assert running == "True"
    try:
        wait_until(lambda: not group(pid), at_most_s=2)
    finally:
        if group(pid):
            os.killpg(int(pid), signal.SIGKILL)


def group(leader):
    """Pids of the processes of a group that have not ended."""
    members = subprocess.run(["pgrep", "-g", str(leader)], capture_output=True, text=True).stdout
    return [pid for pid in members.split() if is_running(pid)]


def test_a_computation_that_does_not_end_politely_is_killed_with_its_children(tmp_path):
    desk = Desk(tmp_path / "out")
    shell = "trap '' TERM; (trap '' TERM; sleep 600) & echo; wait"
    desk.job.process = subprocess.Popen(
        ["sh", "-c", shell], start_new_session=True, stdout=subprocess.PIPE
    )
    desk.job.process.stdout.readline()
    assert len(group(desk.job.process.pid)) >= 2
    desk.stop(0.1)
    wait_until(lambda: not group(desk.job.process.pid), at_most_s=2)
    desk.job.process.stdout.close()


# --- words ----------------------------------------------------------------------------------------


def test_the_page_names_words_that_are_there():
    """Their texts in both languages: `test_claim`."""
    program = "".join((PAGE / name).read_text(encoding="utf-8") for name in ("app.html", "app.js"))
    named = re.findall(r"words\.(\w+)", program) + re.findall(r'fill\("(\w+)"', program)
    assert {*named} - {"get", "items"} <= {*words()}
    assert not re.search(r"\((kPa|mm|m|kg)\b[);]", str(words())), (
        "units are in brackets, as on the sheet"
    )


def test_fronts_to_begin_with_have_names_in_words(client):
    """Specimens of joints, such as couplet and triplet, are no fronts."""
    fronts = get(client, "api/state").get_json()["fronts"]
    assert {f"front_{name}" for name in fronts} == {
        key for key in words() if re.fullmatch(r"front_(?!is|text|unsent).*", key)
    }
