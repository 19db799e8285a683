"""The environment script and the command lines of the shell scripts, on machines made up of
stubs."""

import os
import shutil
import sys

import pytest
from conftest import REPOSITORY, run_command, script_file

TOOLS = ("bash", "cat", "dirname", "env", "grep", "mktemp", "rm", "tail")
NO_PACKAGES = f'exec {sys.executable} -I -S "$@"'  # a Python as it comes, without any package
MODULES = (
    "numpy",
    "scipy",
    "pandas",
    "h5py",
    "matplotlib",
    "numba",
    "snakemake",
    "pytest",
    "xdist",
    "pytest_timeout",
    "hypothesis",
    "jinja2",
    "flask",
    "obspy",
)


class Machine:
    """A path of a few tools and stubs, and a copy of the environment script to source in it."""

    def __init__(self, folder):
        self.bin, self.repository = folder / "bin", folder / "repository"
        self.bin.mkdir()
        (self.repository / "scripts").mkdir(parents=True)
        shutil.copy(REPOSITORY / "scripts" / "environment.sh", self.repository / "scripts")
        for tool in TOOLS:
            (self.bin / tool).symlink_to(shutil.which(tool))
        self.system_python = folder / "system" / "python3"
        self.system_python.parent.mkdir()
        self.modules = folder / "modules"  # empty: the real ones take seconds to import
        self.modules.mkdir()
        for name in MODULES:
            (self.modules / f"{name}.py").touch()

    def stub(self, name, script, folder=None):
        """Put an executable shell script on the path."""
        return script_file((folder or self.bin) / name, script)

    def python(self, *without, more=""):
        """The script of an interpreter that has MODULES but those `without`, behind what is in
        PYTHONPATH."""
        broken = self.repository.parent / "-".join(("without", *without))
        broken.mkdir(exist_ok=True)
        for module in without:
            (broken / f"{module}.py").write_text("raise ImportError('not here')\n")
        return (
            f"PYTHONPATH={broken}:{more}:${{PYTHONPATH:-}}:{self.modules} exec {sys.executable} -S"
            ' "$@"'
        )

    def source(self, group="run", then='echo "$PYTHON"', status=None, **variables):
        """Source the script, to this exit status if one is given; returns the completed process."""
        script = (
            f"set -euo pipefail; source {self.repository}/scripts/environment.sh {group}; {then}"
        )
        environment = {
            "PATH": str(self.bin),
            "HOME": str(self.bin),
            "MASONRY_NO_INSTALL": "1",
            "SYSTEM_PYTHON": str(self.system_python),
            **variables,
        }
        return run_command("bash", "-c", script, env=environment, timeout=120, status=status)


@pytest.fixture
def machine(tmp_path):
    """A machine with YADE, and with the tests' interpreter as the system's."""
    pytest.importorskip("snakemake")
    machine = Machine(tmp_path)
    machine.stub("yade", "exit 0")
    machine.stub("python3", machine.python(), machine.system_python.parent)
    return machine


class TestInterpreter:
    def test_a_python_without_packages_first_on_the_path_is_passed_over(self, machine):
        machine.stub("python3", NO_PACKAGES)
        done = machine.source()
        assert (done.returncode, done.stdout.strip()) == (
            0,
            str(machine.system_python),
        ), done.stderr

    def test_modules_of_the_working_folder_are_not_executed(self, machine, tmp_path, monkeypatch):
        monkeypatch.chdir(tmp_path)
        machine.stub(
            "python3",
            f'PYTHONPATH={machine.modules} exec {sys.executable} -S "$@"',
            machine.system_python.parent,
        )
        for module in ("numpy", "snakemake"):
            (tmp_path / f"{module}.py").write_text(f"open({str(tmp_path / 'executed')!r}, 'w')\n")
        # it is not exported
        assert machine.source(then='echo "${PYTHONSAFEPATH:-}"').stdout == "\n"
        assert not (tmp_path / "executed").exists()

    def test_what_it_exports(self, machine):
        done = machine.source(then="env", PYTHONPATH="/elsewhere", PYTHONHOME="/elsewhere")
        assert {
            f"PYTHON={machine.system_python}",
            f"PYTHONPATH={machine.repository}:/elsewhere",
            "MPLBACKEND=Agg",
            "PYTHONNOUSERSITE=1",
        } <= set(done.stdout.splitlines())
        assert "PYTHONHOME" not in done.stdout


class TestMissing:
    def test_all_of_it_is_named_with_the_command_that_gets_it(self, machine):
        (machine.bin / "yade").unlink()
        for folder in (machine.bin, machine.system_python.parent):
            machine.stub("python3", NO_PACKAGES, folder)
        done = machine.source("test")
        assert (done.returncode, done.stdout) == (3, "")
        missing, command = done.stderr.splitlines()
        packages = [
            "yade",
            *(
                f"python3-{name}"
                for name in ("numpy", "scipy", "pandas", "h5py", "matplotlib", "numba", "jinja2")
            ),
            "snakemake",
            "python3-pytest",
            "python3-pytest-xdist",
            "python3-pytest-timeout",
            "python3-hypothesis",
            "python3-flask",
        ]
        assert missing == f"error: missing on this machine: {' '.join(packages)}"
        assert command.endswith(f"apt-get install --no-install-recommends {' '.join(packages)}")


def run_all(*words, **variables):
    return run_command(
        REPOSITORY / "run_all.sh",
        *words,
        env={**os.environ, "MASONRY_NO_INSTALL": "1", **variables},
        timeout=120,
    )


class TestRunAll:
    @pytest.mark.parametrize(
        ("words", "printed"),
        [
            ((), "no study given: expected"),
            (("harmonik",), "no study harmonik is shipped: expected"),
            (("mine.toml",), "mine.toml: no such study file"),
            (
                ("quick", "--fast"),
                (
                    "unknown option --fast: expected -j, --out, --solver, --keep, --slice, --remake"
                    " or --dry-run"
                ),
            ),
            (("quick", "-j", "0"), "-j 0: expected a whole number"),
            (("quick", "--solver=udec"), "--solver udec: expected yade"),
        ],
        ids=str,
    )
    def test_bad_command_lines_get_one_line_and_status_2(self, words, printed):
        done = run_all(*words)
        assert (done.returncode, done.stdout) == (2, "")
        assert done.stderr.startswith("error: ") and done.stderr.count("\n") == 1
        assert printed in done.stderr
