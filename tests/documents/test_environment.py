"""The environment script on a machine made up of stubs, and the command lines of run_all.sh."""

import os
import shutil
import sys

import pytest
from conftest import BATCH, REPOSITORY, run_command, script_file

TOOLS = ("bash", "cat", "dirname", "env", "grep", "mktemp", "rm", "tail")
MODULES = ("numpy", "scipy", "pandas", "h5py", "matplotlib", "numba", "jinja2")


def test_what_is_missing_is_named_with_the_command_that_gets_it(tmp_path):
    """Where no Python has a package and YADE is not there."""
    found = tmp_path / "bin"
    found.mkdir()
    for tool in TOOLS:
        (found / tool).symlink_to(shutil.which(tool))
    script_file(found / "python3", f'exec {sys.executable} -I -S "$@"')
    environment = {
        "PATH": str(found),
        "HOME": str(found),
        "MASONRY_NO_INSTALL": "1",
        "SYSTEM_PYTHON": str(found / "python3"),
    }
    script = f"source {REPOSITORY}/scripts/environment.sh run"
    done = run_command("bash", "-euc", script, env=environment, cwd=tmp_path, timeout=120)
    assert (done.returncode, done.stdout) == (3, "")
    missing, command = done.stderr.splitlines()
    packages = " ".join(["yade", *(f"python3-{name}" for name in MODULES)])
    assert missing == f"error: missing on this machine: {packages}"
    assert command.endswith(f"apt-get install --no-install-recommends {packages}")


@pytest.mark.parametrize(
    ("words", "printed"),
    [
        ((), "no study given: expected"),
        (("mine.toml",), "mine.toml: no such study file"),
        (("quick", "--fast"), "unknown option --fast: expected -j, --out, --solver, --keep"),
    ],
    ids=str,
)
def test_bad_command_lines_of_run_all_get_one_line_and_status_2(words, printed):
    environment = {**os.environ, "MASONRY_NO_INSTALL": "1"}
    done = run_command(REPOSITORY / "run_all.sh", *words, env=environment, timeout=120)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.startswith(f"error: {printed}") and done.stderr.count("\n") == 1


def test_run_all_and_the_command_study_have_one_default_solver(tmp_path):
    """And both print the command that runs the study in the other one."""
    words = "quick", "--dry-run", "--out", str(tmp_path)
    environment = {**os.environ, "MASONRY_NO_INSTALL": "1", "PYTHON": sys.executable}
    plans = [
        run_command(*command, *words, env=environment, cwd=REPOSITORY, status=0).stdout
        for command in ([REPOSITORY / "run_all.sh"], BATCH)
    ]
    assert plans[0] == plans[1] and "solver: reference\n" in plans[0]
    assert f"--out {tmp_path} --solver yade\n" in plans[0]
