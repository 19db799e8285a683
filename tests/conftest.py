"""What several tests share: the repository, the shipped walls, the real commands."""

import functools
import json
import os
import pty
import re
import select
import shutil
import signal
import subprocess
import sys
import time
import warnings
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from pathlib import Path

import h5py
import numpy as np
import pytest
from short_runs import RUNS
from small_history import make_history

import damage
from benchmarks.report_in_browser import BROWSER, DRIVER, browser
from damage.__main__ import main
from damage.errors import InputError
from damage.history.reader import read_history
from damage.mechanics.tables import INPUT
from damage.reference.session import run_reference
from damage.run.options import parse_run
from damage.units import GRAVITY
from damage.wall.file import load_wall
from yade_scripts import COMMAND

REPOSITORY = Path(__file__).resolve().parents[1]
BRIEFLY = REPOSITORY / "tests/yade/checks/briefly.py"  # runs a wall in YADE with shorter stages
BATCH = (sys.executable, "-m", "damage", "study")
"""What run_all.sh starts once it has looked for all that it needs, which takes two seconds:
`test_environment.py`."""
BATCH_ENVIRONMENT = {"PYTHONPATH": str(REPOSITORY), "OPENBLAS_NUM_THREADS": "1"}
TINY = "Wall('tiny', 0.45, 0.6)"
"""A wall of three bricks' length and eight courses: it cracks under 0.5 g and stays whole under
0.01 g."""
# of small walls, which vibrate at 0.05 s or faster
SHORT = ("-j1", BRIEFLY, "RAMP_S=0.05 HOLD_S=0.05 SETTLE_S=0.02")

MOST_S = 600.0
"""What a test may take, ten times the longest on a slow machine; it fails then [s]."""
FIRST = (
    "test_widths.py",
    "test_deformable.py",
    "test_yade_space.py",
    "test_mass_scaling.py",
    "test_yade_run.py",
    "test_study.py",
    "test_written.py",
    "test_batch.py",
    "test_together.py",
    "test_verification.py",
    "test_checkpoint.py",
    "test_yade_ground.py",
    "test_from_pip.py",
)


def pytest_collection_modifyitems(config, items):
    """First come files that compile what all others then find compiled; two that run side by side
    compile different functions, a third one needs none; then those that take longest, which would
    leave other cores idle at the end.  A test that waits for ever fails, and says where it waits;
    those that take minutes may take more."""
    items.sort(
        key=lambda item: FIRST.index(item.path.name) if item.path.name in FIRST else len(FIRST)
    )
    if config.pluginmanager.hasplugin("timeout"):
        for item in items:
            if not item.get_closest_marker("long"):
                item.add_marker(pytest.mark.timeout(MOST_S, method="thread"))


@pytest.fixture(scope="session", autouse=True)
def _texts_of_pictures_are_parsed_once():
    """matplotlib parses texts with mathematics, as tick labels are, anew in every figure: a third
    of the time of pictures.  Here parsers that make the same are equal, and its cache takes all
    texts."""
    if "matplotlib.mathtext" in sys.modules:
        parser = sys.modules["matplotlib.mathtext"].MathTextParser
        parser.__hash__ = lambda self: hash(self._output_type)
        parser.__eq__ = lambda self, other: self._output_type == other._output_type
        parser._parse_cached = functools.lru_cache(10_000)(parser._parse_cached.__wrapped__)


@pytest.fixture(scope="session", params=["solid", "symmetric", "asymmetric"])
def shipped_wall(request):
    return load_wall(REPOSITORY / "walls" / f"{request.param}.py")


@pytest.fixture(scope="session")
def symmetric_wall():
    return load_wall(REPOSITORY / "walls" / "symmetric.py")


@pytest.fixture(scope="session")
def still_history(tmp_path_factory):
    """A History of a small wall to which nothing happens, for reading alone."""
    return make_history(tmp_path_factory.mktemp("still") / "small.h5")


@pytest.fixture(scope="session")
def run_of(tmp_path_factory):
    """run_of(name): the History of one of RUNS of `short_runs.py`, whose file stays, for reading
    alone."""
    folder = tmp_path_factory.mktemp("runs")

    @functools.cache
    def run(name):
        wall, words = RUNS[name]
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", damage.RunWarning)
            return damage.run(wall, **words, out=folder / f"{name}.h5")

    return run


def without_progress(text):
    """What a command said, but for the lines of progress that a slow machine sees."""
    return "".join(
        line
        for line in text.splitlines(keepends=True)
        if not re.search(r"  .* t = +[-\d.]+ ", line)
    )


def run_command(*words, status=None, **options):
    """Run a command from the repository with no screen, to this exit status if one is given;
    returns the completed process with text."""
    environment = {key: value for key, value in os.environ.items() if key != "DISPLAY"}
    environment["OMP_NUM_THREADS"] = "1"  # of YADE: other tests run beside it
    done = subprocess.run(
        [str(word) for word in words],
        capture_output=True,
        text=True,
        **{"timeout": 3000, "cwd": REPOSITORY, "env": environment, **options},
    )
    assert status in (
        None,
        done.returncode,
    ), f"status {done.returncode}\n{done.stdout}{done.stderr}"
    return done


def in_words(arguments):
    """The words of a command: strings are split at blanks, a path is one word."""
    return [
        word for one in arguments for word in (one.split() if isinstance(one, str) else [str(one)])
    ]


def in_python(code, **environment):
    """Run code beside the tests of the core, in a Python of its own."""
    path = os.pathsep.join(
        [str(REPOSITORY), str(REPOSITORY / "tests"), os.environ.get("PYTHONPATH", "")]
    )
    run_command(
        sys.executable,
        "-c",
        code,
        cwd=REPOSITORY / "tests/core",
        env={**os.environ, **environment, "PYTHONPATH": path},
        status=0,
    )


@pytest.fixture(scope="session")
def damage_command():
    def run(*words, **options):
        return run_command(sys.executable, "-m", "damage", *in_words(words), **options)

    return run


@pytest.fixture(scope="session")
def yade_command():
    if shutil.which("yade") is None:
        pytest.skip("YADE is not installed")

    def run(*words, **options):
        return run_command(*COMMAND, *in_words(words), **options)

    return run


@pytest.fixture(scope="session")
def in_both(yade_command):
    """in_both(folder, *words): {solver: History} of the same run in YADE and, in this process, in
    the reference solver; what each said is in yade.txt and reference.txt.  yade: words before the
    others, reference: words behind them."""

    def run(folder, *words, yade=(), reference=()):
        words = [*words, "--no-pictures", "--out"]
        done = yade_command(*yade, *words, folder / "yade.h5", status=0)
        (folder / "yade.txt").write_text(done.stdout + done.stderr)
        with (
            (folder / "reference.txt").open("w") as said,
            redirect_stdout(said),
            redirect_stderr(said),
        ):
            assert run_reference(in_words([*words, folder / "reference.h5", *reference])) == 0
        return {solver: read_history(folder / f"{solver}.h5") for solver in ("yade", "reference")}

    return run


def run_here(out, *words):
    """The History of a run in the reference solver, in this process and without pictures."""
    assert run_reference([*in_words(words), "--no-pictures", "--out", str(out)]) == 0
    return read_history(out)


def parsed(words="", solver="reference"):
    """The RunSettings of options as they are typed."""
    return parse_run(words.split(), "test", solver)


def one_line_error(function, *arguments, **named):
    """The one line of the InputError that a call raises; it has to say what was expected."""
    with pytest.raises(InputError) as caught:
        function(*arguments, **named)
    message = str(caught.value)
    assert "\n" not in message
    assert "expected" in message or "run pip install" in message
    return message


def refused_with(words, function, /, *arguments, **named):
    """The one line of the InputError that a call raises; these words, a regular expression, are
    found in it."""
    with pytest.raises(InputError, match=words) as caught:
        function(*arguments, **named)
    assert "\n" not in str(caught.value)
    return str(caught.value)


def _run_in_this_process(capsys, command, words):
    """(Exit status, what was printed, what was said to standard error) of a main()."""
    capsys.readouterr()
    return command([str(word) for word in words]), *capsys.readouterr()


@pytest.fixture
def output_of(capsys):
    """output_of(*words): what a command of `damage`, or `of` another main(), prints in this process
    to a good end."""

    def run(*words, of=main):
        status, out, err = _run_in_this_process(capsys, of, words)
        assert status == 0, err
        return out

    return run


@pytest.fixture
def error_of(capsys):
    """error_of(*words): the one line of a command of `damage`, or `of` another main(), that is
    refused."""

    def run(*words, of=main):
        status, out, err = _run_in_this_process(capsys, of, words)
        assert (status, out) == (2, "")
        # fit for any terminal
        assert err.startswith("error: ") and err.endswith("\n") and err[:-1].isprintable(), err
        return err

    return run


def written(path, content, **how):
    """The path of a file, after this text or these bytes are written to it."""
    path.write_bytes(content) if isinstance(content, bytes) else path.write_text(content, **how)
    return path


def script_file(path, text):
    """The path of an executable shell script, written here."""
    written(path, f"#!{shutil.which('bash')}\n{text}\n").chmod(0o755)
    return path


def wall_file(path, expression):
    """The path of a wall's module, written here, whose wall() is this expression; both solvers run
    it."""
    return written(
        path,
        f"""import math
import sys

sys.path.insert(0, {str(REPOSITORY)!r})
from damage import Brick, Floor, Joint, Lintel, Opening, Wall
from damage.wall.restraints import Restraint


def wall():
    return {expression}


if __name__ == "__main__":
    from yade_scripts.run import main
    main(wall)
""",
    )


ROOT = pytest.mark.skipif(os.geteuid() != 0, reason="needs root, to make a file system")


@contextmanager
def disk(folder, options):
    """A file system in memory with these options of mount, such as its size, in a folder made for
    it."""
    folder.mkdir()
    if subprocess.run(
        ["mount", "-t", "tmpfs", "-o", options, "tmpfs", folder], capture_output=True
    ).returncode:
        pytest.skip("no file system can be mounted here")
    try:
        yield folder
    finally:
        subprocess.run(["umount", "--lazy", folder], check=True)


IN_BROWSER = [
    pytest.mark.long,
    pytest.mark.skipif(
        not (shutil.which(BROWSER) and shutil.which(DRIVER)),
        reason=f"{BROWSER} or {DRIVER} is not installed: bash scripts/browser.sh",
    ),
    # of selenium's own
    pytest.mark.filterwarnings("ignore::DeprecationWarning", "ignore::ResourceWarning"),
]
"""Marks of tests in a browser."""


@pytest.fixture(scope="module")
def driver():
    """A browser without a network."""
    with browser() as driver:
        yield driver


def logged(driver):
    """(Messages of the console, URLs that were requested) since these were asked for last."""
    messages = [one["message"] for one in driver.get_log("browser") if one["level"] != "DEBUG"]
    events = (json.loads(one["message"])["message"] for one in driver.get_log("performance"))
    requests = (one for one in events if one["method"] == "Network.requestWillBeSent")
    return messages, {one["params"]["request"]["url"] for one in requests}


def wait_until(condition, at_most_s=300):
    """Wait until a function of nothing returns what is true."""
    until = time.monotonic() + at_most_s
    while not condition():
        assert time.monotonic() < until, "waited in vain"
        time.sleep(0.1)


def is_running(pid):
    """Whether there is a process of this number that has not ended."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] not in "ZX"
    except OSError:
        return False


def running(folder):
    """Command lines of the processes that name this folder."""
    lines = subprocess.run(
        ["ps", "-eo", "args"], capture_output=True, text=True
    ).stdout.splitlines()
    return [line for line in lines if str(folder) in line]


def total_energy(solver):
    """Energy of a wall, weight included; constant but for what comes in, which is counted [J]."""
    lifted = GRAVITY * solver.layout.bodies.mass @ solver.displacement[:, 1]
    return (
        solver.kinetic_energy()
        + solver.elastic_energy()
        + lifted
        + solver.energy[1:].sum()
        - solver.energy[INPUT]
    )


def rigid_turn(bodies, turn):
    """Displacements (n_bodies, 3) of a rotation about the origin."""
    cos = np.cos(turn)
    sin = np.sin(turn)
    return np.column_stack(
        [
            cos * bodies.x - sin * bodies.z - bodies.x,
            sin * bodies.x + cos * bodies.z - bodies.z,
            np.full(len(bodies), turn),
        ]
    )


def typed(words, lines, cwd, timeout=300):
    """Run a command in a terminal and type these lines at its IPython prompt, each when it is asked
    for; returns its exit status and what the terminal showed, without colours."""
    child, terminal = pty.fork()
    if child == 0:
        os.chdir(cwd)
        os.environ.update(TERM="dumb", COLUMNS="200")
        os.environ.pop("DISPLAY", None)
        os.execvp(words[0], [str(word) for word in words])
    shown = b""
    waiting = list(enumerate(lines, start=1))
    deadline = time.monotonic() + timeout
    while True:
        if not select.select([terminal], [], [], max(deadline - time.monotonic(), 0))[0]:
            os.kill(child, signal.SIGKILL)
            break
        try:
            data = os.read(terminal, 65536)
        except OSError:  # the other end is closed
            data = b""
        if not data:
            break
        shown += data
        if waiting and f"In [{waiting[0][0]}]: ".encode() in shown:
            os.write(terminal, waiting.pop(0)[1].encode() + b"\r")
    os.close(terminal)
    status = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    return status, re.sub(r"\x1b\[[0-9;?]*[A-Za-z]|\r", "", shown.decode(errors="replace"))


def contents(path):
    """{name: bytes} of all datasets of a history."""
    found = {}
    with h5py.File(path) as file:
        file.visititems(
            lambda name, item: (
                found.update({name: item[()].tobytes()}) if isinstance(item, h5py.Dataset) else None
            )
        )
    return found
