"""The page's server: Flask, on the loopback interface alone.

A request is answered only with the host name of the loopback interface in its Host (other sites
that point their name here are refused), with an Origin of this page or none, and with the token
that the program printed: in the address at the first visit, then in a cookie that no script reads
and, of what changes anything, in a header besides.  The browser is given a file that leads to this
address, as everybody can read its command line.  All addresses lie below a random one, the cookie's
path: browsers send cookies to every port of a machine.  The page asks for nothing of another
machine; its Content-Security-Policy forbids it.
"""

import secrets
import threading
import webbrowser
from contextlib import contextmanager, nullcontext
from inspect import signature
from pathlib import Path
from tempfile import NamedTemporaryFile

from damage.applications.groningen.app.desk import SHOWN, Desk, words
from damage.applications.groningen.app.photo import MOST_BYTES
from damage.applications.groningen.claim.dutch import in_language
from damage.applications.report.words import LANGUAGES
from damage.errors import InputError, RunError
from damage.files import json_text

PAGE = Path(__file__).parent / "page"
ASSETS = {
    "icon.svg": "image/svg+xml",
    "app.js": "text/javascript; charset=utf-8",
    "app.css": "text/css; charset=utf-8",
}
HEADERS = {
    "Content-Security-Policy": (
        "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; "
        "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
    ),
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cache-Control": "no-store",
    "Cross-Origin-Resource-Policy": "same-origin",
}
SHEET_POLICY = "sandbox allow-modals; default-src 'none'; style-src 'unsafe-inline'; img-src data:"
"""Policy of the sheet, which has its style and pictures in itself; it can be printed."""
CALLS = ["address", "front", "sketch", "straighten", "survey", "levels", "start", "stop"]
"""Methods of Desk that the page asks for."""
COOKIE = "damage_app"
HEADER = "X-Damage-Token"
DOOR = (
    '<!DOCTYPE html><meta charset="utf-8"><title>damage</title><meta http-equiv="refresh"'
    ' content="0; url={0}">'
)
"""Text of a file that leads to the page."""
PASSING = '<!DOCTYPE html><title>damage</title><link rel="icon" href="assets/icon.svg">'
"""Text of the first answer, which leads on from an address that has the token."""


def make_app(out, port, token, root):
    """The Flask application for a claim in the folder `out`, reached at a port; token: what a
    request has to know; root: what all its addresses begin with, such as "/a3Bd"."""
    from flask import Flask

    app = Flask("damage.applications.groningen.app", static_folder=None, template_folder=str(PAGE))
    app.desk = Desk(out)
    hosts = {f"{name}:{port}" for name in ("127.0.0.1", "localhost")}
    _guard(app, hosts, token, f"{root}/")
    _pages(app, token, root)
    _calls(app, root)
    return app


def _guard(app, hosts, token, page):
    """Refuse strangers before anything else, and say in every answer what the page may do."""
    from flask import abort, request

    def known(given):
        return given is not None and secrets.compare_digest(given.encode(), token.encode())

    @app.before_request
    def check():
        origin = request.headers.get("Origin")
        here = origin is None or origin in {f"http://{host}" for host in hosts}
        elsewhere = request.headers.get("Sec-Fetch-Site") in ("cross-site", "same-site")
        first = (
            request.path == page and request.method == "GET" and known(request.args.get("token"))
        )
        # first: from a file
        if request.headers.get("Host") not in hosts or not here or (elsewhere and not first):
            abort(403)
        if not first and not known(request.cookies.get(COOKIE)):
            abort(403)
        if request.method != "GET" and not (origin and known(request.headers.get(HEADER))):
            abort(403)
        if request.method != "GET" and (
            request.content_length is None or request.content_length > MOST_BYTES
        ):
            abort(413)

    @app.after_request
    def label(response):
        for name, value in HEADERS.items():
            response.headers.setdefault(name, value)
        return response


def _pages(app, token, root):
    """The page, its program and style, and the files of the claim that it may show."""
    from flask import abort, make_response, render_template, request

    @app.get(f"{root}/")
    def page():
        asked = request.args.get("language")
        language = asked if asked in LANGUAGES else LANGUAGES[0]
        if "token" in request.args:  # out of the address, where others could read it
            # A redirection would still count as from the file, and the cookie would not be sent.
            response = make_response(PASSING, {"Refresh": f"0; url={root}/?language={language}"})
            response.set_cookie(COOKIE, token, path=f"{root}/", httponly=True, samesite="Strict")
            return response
        texts = {key: text[language] for key, text in words().items()}
        return render_template(
            "app.html", language=language, token=token, words=texts, languages=LANGUAGES
        )

    @app.get(f"{root}/assets/<name>")
    def asset(name):
        if name not in ASSETS:
            abort(404)
        return make_response((PAGE / name).read_bytes(), {"Content-Type": ASSETS[name]})

    @app.get(f"{root}/files/<path:name>")
    def file(name):
        if name not in SHOWN or not (path := app.desk.path(name)).is_file():
            abort(404)
        more = {"Content-Security-Policy": SHEET_POLICY} if name.endswith(".html") else {}
        return make_response(path.read_bytes(), {"Content-Type": SHOWN[name], **more})


def _calls(app, root):
    """What the page asks for: POST /api/NAME with a JSON object of the arguments of a method of
    Desk; a request that it does not make is answered with its status alone."""
    from flask import Response, abort, request

    lock = threading.Lock()

    def answer(work):
        language = request.accept_languages.best_match(LANGUAGES) or LANGUAGES[0]
        try:
            with lock:
                return Response(json_text(work()), content_type="application/json")
        except (InputError, RunError, OSError, UnicodeError) as error:
            # no fault of the page
            body = json_text({"error": in_language(language, str(error))})
            return Response(body, content_type="application/json")

    @app.get(f"{root}/api/<name>")
    def look(name):
        if name not in ("state", "progress"):
            abort(404)
        return answer(getattr(app.desk, name))

    @app.post(f"{root}/api/photograph")
    def photograph():
        return answer(lambda: app.desk.photograph(request.get_data()))

    @app.post(f"{root}/api/<name>")
    def call(name):
        if name not in CALLS:
            abort(404)
        method = getattr(app.desk, name)
        try:
            given = signature(method).bind(**request.get_json())
        except (TypeError, RecursionError):  # no object, or one of other arguments
            abort(400)
        return answer(lambda: method(**given.arguments))


def serve(out, opened=True):
    """Serve the page of a claim in the folder `out`, at a free port, until it is interrupted;
    opened: in the browser."""
    try:
        from werkzeug.serving import WSGIRequestHandler, make_server
    except ImportError as error:
        raise InputError(
            "the page needs Flask; install Debian's package python3-flask, or pip install "
            "'masonry-damage[groningen]'"
        ) from error

    class Quiet(WSGIRequestHandler):
        def log_request(self, *_):  # the address of the first one has the token
            pass

    token = secrets.token_urlsafe(32)
    root = f"/{secrets.token_hex(8)}"
    server = make_server("127.0.0.1", 0, None, threaded=True, request_handler=Quiet)
    server.app = app = make_app(out, server.server_port, token, root)
    address = f"http://127.0.0.1:{server.server_port}{root}/?token={token}"
    print(
        f"the page of this claim, for this machine alone: {address}\nfiles: {app.desk.out}; Ctrl-C"
        " ends it",
        flush=True,
    )
    try:
        with _door(address, app.desk.out) if opened else nullcontext():
            server.serve_forever()
    finally:
        server.server_close()
        app.desk.stop(1.5)


@contextmanager
def _door(address, folder):
    """Open an address in the browser by a file that only this user can read; it is there as long as
    this lasts."""
    with NamedTemporaryFile(
        "w", dir=folder, prefix="open-", suffix=".html", encoding="utf-8"
    ) as file:
        file.write(DOOR.format(address))
        file.flush()
        webbrowser.open(Path(file.name).as_uri())
        yield
