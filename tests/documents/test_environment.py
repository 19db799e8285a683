"""The environment script on a machine made up of stubs, and the command lines of run_all.sh."""

import os
import shutil
import sys

import pytest
from conftest import REPOSITORY, run_command, script_file

TOOLS = ("bash", "cat", "dirname", "env", "grep", "mktemp", "rm", "tail")
NO_PACKAGES = f'exec {sys.executable} -I -S "$@"'  # a Python as it comes, without any package
MODULES = ("numpy", "scipy", "pandas", "h5py", "matplotlib", "numba", "jinja2")


def sourced(folder, system_python, programs=()):
    """Sources the script where the first `python3` on the path has no package and where there are
    these programs; prints what it exports."""
    found = folder / "bin"
    found.mkdir()
    for tool in TOOLS:
        (found / tool).symlink_to(shutil.which(tool))
    for program in programs:
        script_file(found / program, "exit 0")
    script_file(found / "python3", NO_PACKAGES)
    script_file(folder / "system_python", system_python)
    return run_command(
        "bash",
        "-c",
        f"set -euo pipefail; source {REPOSITORY}/scripts/environment.sh run; env",
        env={
            "PATH": str(found),
            "HOME": str(found),
            "MASONRY_NO_INSTALL": "1",
            "SYSTEM_PYTHON": str(folder / "system_python"),
            "PYTHONPATH": "/elsewhere",
            "PYTHONHOME": "/elsewhere",
        },
        cwd=folder,
        timeout=120,
    )


def test_a_python_without_packages_is_passed_over_and_modules_of_the_folder_too(tmp_path):
    (tmp_path / "numpy.py").write_text("open('executed', 'w')")
    modules = tmp_path / "modules"  # empty: the real ones take seconds to import
    modules.mkdir()
    for name in MODULES:
        (modules / f"{name}.py").touch()
    stub = f'PYTHONPATH=${{PYTHONPATH:-}}:{modules} exec {sys.executable} -S "$@"'
    done = sourced(tmp_path, stub, ["yade"])
    assert {
        f"PYTHON={tmp_path / 'system_python'}",
        f"PYTHONPATH={REPOSITORY}:/elsewhere",
        "MPLBACKEND=Agg",
        "PYTHONNOUSERSITE=1",
    } <= set(done.stdout.splitlines()), done.stderr
    assert "PYTHONHOME" not in done.stdout and "PYTHONSAFEPATH" not in done.stdout
    assert not (tmp_path / "executed").exists()


def test_what_is_missing_is_named_with_the_command_that_gets_it(tmp_path):
    done = sourced(tmp_path, NO_PACKAGES)
    assert (done.returncode, done.stdout) == (3, "")
    missing, command = done.stderr.splitlines()
    packages = " ".join(["yade", *(f"python3-{name}" for name in MODULES)])
    assert missing == f"error: missing on this machine: {packages}"
    assert command.endswith(f"apt-get install --no-install-recommends {packages}")


@pytest.mark.parametrize(
    ("words", "printed"),
    [
        ((), "no study given: expected"),
        (("harmonik",), "no study harmonik is shipped: expected"),
        (("mine.toml",), "mine.toml: no such study file"),
        (("quick", "--fast"), "unknown option --fast: expected -j, --out, --solver, --keep"),
        (("quick", "-j", "0"), "-j 0: expected a whole number"),
        (("quick", "--solver=udec"), "--solver udec: expected yade"),
    ],
    ids=str,
)
def test_bad_command_lines_of_run_all_get_one_line_and_status_2(words, printed):
    environment = {**os.environ, "MASONRY_NO_INSTALL": "1"}
    done = run_command(REPOSITORY / "run_all.sh", *words, env=environment, timeout=120)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.startswith(f"error: {printed}") and done.stderr.count("\n") == 1
