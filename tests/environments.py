"""Environments of their own, for checks with software that the project does not need; they go when
these are over."""

import subprocess
import sys
import tempfile
from contextlib import contextmanager
from pathlib import Path

import pytest


@contextmanager
def environment(*packages, needs=()):
    """The interpreter of a fresh environment with these packages from a package index, `needs` with
    all that they need in turn; the test is skipped, by name, where they cannot be had."""
    with tempfile.TemporaryDirectory(prefix="environment-") as folder:
        python = Path(folder) / "bin" / "python"
        install = [python, "-m", "pip", "install", "--quiet", "--only-binary", ":all:"]
        _do_or_skip(sys.executable, "-m", "venv", folder)
        if needs:
            _do_or_skip(*install, *needs)
        _do_or_skip(*install, "--no-deps", *packages)
        yield python


def _do_or_skip(*words):
    done = subprocess.run(words, capture_output=True, text=True, timeout=900)
    if done.returncode:
        pytest.skip(f"{' '.join(map(str, words))} failed: {done.stderr.splitlines()[-1:]}")


def run_in(python, script, *words):
    """What a script of these tests prints in another interpreter, without this repository on its
    path."""
    done = subprocess.run(
        [python, "-I", Path(__file__).parent / "applications/other_tools" / script, *words],
        capture_output=True,
        text=True,
        timeout=900,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout
