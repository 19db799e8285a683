"""Who can reach YADE over the network: what the launcher prevents, and what is closed where a run
starts without it."""

import gc
import os
import shutil
import socket
import socketserver
import sys
import threading
from contextlib import contextmanager, suppress
from xmlrpc.server import SimpleXMLRPCServer

import pytest
from conftest import REPOSITORY, run_command, written

from yade_scripts import COMMAND, servers

AT_MOST_S = 60  # where nothing is closed a thread or an answer is waited for this long


class Prompt(socketserver.BaseRequestHandler):
    """As YADE's: executes what it is sent, once the cookie was right."""

    def handle(self):
        self.request.send(b"cookie?")
        if self.request.recv(100).decode() == self.server.cookie:
            self.request.send(b"welcome")
            while data := self.request.recv(100):
                self.server.executed.append(data)


@contextmanager
def yades_servers():
    """A prompt and an information server, each with its thread, as YADE starts them."""
    gc.collect()  # servers of the tests before, which are found otherwise
    prompt = socketserver.ThreadingTCPServer(("127.0.0.1", 0), Prompt)
    prompt.cookie = "yadesu"
    prompt.executed = []
    prompt.daemon_threads = True
    informer = SimpleXMLRPCServer(("127.0.0.1", 0), logRequests=False)
    threads = [
        threading.Thread(target=server.serve_forever, daemon=True) for server in (prompt, informer)
    ]
    for thread in threads:
        thread.start()
    try:
        yield prompt, informer, threads
    finally:
        for server in (prompt, informer):
            server.socket.close()


def connect(server):
    return socket.create_connection(server.server_address, timeout=AT_MOST_S)


def close_in_a_thread():
    """Run close_servers(), which could wait for ever; whether it returned, and what."""
    found = []
    thread = threading.Thread(target=lambda: found.append(servers.close_servers()), daemon=True)
    thread.start()
    thread.join(AT_MOST_S)
    return found


def is_closed(connection):
    try:
        return connection.recv(100) == b""
    except TimeoutError:
        return False
    except OSError:
        return True


def test_closing_ends_every_connection_and_waits_for_none():
    """An idle client holds the information server, whose only thread reads from it; another waits
    its turn."""
    with (
        yades_servers() as (prompt, informer, threads),
        connect(informer) as idle,
        connect(informer) as waiting,
        connect(prompt) as stranger,
        connect(prompt) as known,
    ):
        for client in (stranger, known):
            assert client.recv(100) == b"cookie?"
        known.sendall(b"yadesu")
        assert known.recv(100) == b"welcome"
        assert close_in_a_thread() == [2]
        for thread in threads:
            thread.join(AT_MOST_S)
        assert not any(thread.is_alive() for thread in threads)
        assert all(is_closed(client) for client in (idle, waiting, stranger, known))
        with suppress(OSError):
            known.sendall(b"code")
        assert prompt.executed == []
        for server in (prompt, informer):
            with pytest.raises(OSError, match="refused|reset"):
                socket.create_connection(server.server_address, timeout=AT_MOST_S)


def test_a_client_on_its_way_is_refused(monkeypatch):
    """A connection that is accepted but not yet answered when the servers are closed, and a cookie
    that comes then."""
    monkeypatch.setattr(servers, "_close_connections", lambda ports: None)
    with yades_servers() as (prompt, _, _), connect(prompt) as late:
        assert late.recv(100) == b"cookie?"
        assert close_in_a_thread() == [2]
        late.sendall(b"yadesu")
        assert is_closed(late) and prompt.executed == []
        ours, theirs = socket.socketpair()
        with ours, theirs:
            assert not prompt.verify_request(theirs, None)
            prompt.finish_request(theirs, None)
            prompt.shutdown_request(theirs)
            assert is_closed(ours)


FAKE_YADE = """#!{python}
import argparse, importlib, sys
print(sys.argv[3:], file=sys.stderr)
options = argparse.ArgumentParser()
options.add_argument("-L", action="append", default=[])
options.add_argument("words", nargs=argparse.REMAINDER)
asked = options.parse_args()
sys.path.append(".")
for name in asked.L:
    importlib.import_module(name)
import yade
from yade import remote
yade.remote.useQThread = True
print(yade.remote.runServers(), "." in sys.path, asked.L, asked.words, sys.stdin.read())
"""


@pytest.fixture
def system(tmp_path):
    """A folder for PATH with a YADE whose servers leave a word; `run(program, *words)` runs the
    launcher there."""
    (tmp_path / "py" / "yade").mkdir(parents=True)
    (tmp_path / "py" / "yade" / "__init__.py").write_text("")
    (tmp_path / "py" / "yade" / "remote.py").write_text(
        "def runServers():\n    return 'listening'\n"
    )
    for name in ("bash", "readlink", "dirname"):
        (tmp_path / name).symlink_to(shutil.which(name))
    program = written(tmp_path / "yade", FAKE_YADE.format(python=sys.executable))
    program.chmod(0o755)
    (tmp_path / "w.py").touch()

    def run(program, *words, before=()):
        path = os.pathsep.join(map(str, [*before, tmp_path]))
        return run_command(
            program,
            *words,
            input="typed",
            timeout=AT_MOST_S,
            env={"PATH": path, "PYTHONPATH": str(tmp_path / "py")},
            cwd=tmp_path,
        )

    return run


def test_the_launcher_prevents_the_servers(system, tmp_path):
    assert system(tmp_path / "yade", "w.py").stdout.startswith("listening")  # by the plain command
    done = system(COMMAND[0], "-L", "json", "w.py", "--out", "a b.h5")
    assert (
        done.stdout == "None False ['without_servers', 'json'] ['w.py', '--out', 'a b.h5'] typed\n"
    ), done.stderr


@pytest.mark.parametrize(
    ("words", "passed"),
    [
        (["symmetric", "--rest", "1"], ["{root}/walls/symmetric.py", "--rest", "1"]),
        (
            ["-n", "-j", "2", "shop_front"],
            ["-n", "-j", "2", "{root}/yade_scripts/wall_data.py", "{root}/walls/shop_front.toml"],
        ),
        (["small"], ["{root}/yade_scripts/wall_data.py", "{root}/houses/small.toml"]),
        (["-nx", "-f4", "w.py", "-x"], ["-nx", "-f4", "w.py", "-x"]),
        (["-n"], ["-n"]),
    ],
)
def test_the_launcher_takes_names_of_walls(system, words, passed):
    done = system(COMMAND[0], *words)
    assert done.stderr.splitlines()[0] == str([word.format(root=REPOSITORY) for word in passed])


@pytest.mark.parametrize(
    ("words", "complaint"),
    [
        (["-n", "-x"], "-x without a script: expected a script or a wall"),
        (
            ["symetric"],
            (
                "symetric: expected a script, a file of a wall or house, or the name of one that"
                " ships: asymmetric"
            ),
        ),
        (["houses/smal.toml"], "no file houses/smal.toml: expected a script, a file of a wall or"),
        (["small_front"], "small_front: expected a script"),
        (["-n", "-j"], "-j is the last word: expected a value"),
        (["--consol", "symmetric"], "--consol: expected an option of YADE before the script"),
        (["w.txt"], "w.txt: expected a script"),
        (
            ["saved.xml.gz"],
            "saved.xml.gz: expected a script, as YADE's command does not load a scene",
        ),
    ],
)
def test_a_mistake_in_its_arguments_is_an_error(system, words, complaint):
    """YADE's command ends with status 0, or waits at its prompt."""
    done = system(COMMAND[0], *words)
    assert (done.returncode, done.stdout) == (2, "") and done.stderr.startswith(
        f"error: {complaint}"
    ), done.stderr
    assert done.stderr.count("\n") == 1


def test_the_launcher_without_yade_says_so(system, tmp_path):
    (tmp_path / "yade").unlink()
    done = system(COMMAND[0], "w.py")
    assert done.returncode == 3
    assert done.stderr.count("\n") == 1 and "expected Debian's package yade" in done.stderr
