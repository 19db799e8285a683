"""The environment script and the command lines of the shell scripts, on machines made up of stubs."""

import os
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from conftest import REPOSITORY, run_command, script_file

TOOLS = ("bash", "cat", "dirname", "env", "grep", "mktemp", "rm", "tail")
NO_PACKAGES = f'exec {sys.executable} -I -S "$@"'  # a Python as it comes, without any package
MODULES = ("numpy", "scipy", "pandas", "h5py", "matplotlib", "numba", "snakemake", "pytest", "xdist", "hypothesis",
           "jinja2", "flask", "obspy")


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
        """The script of an interpreter that has MODULES but those `without`, behind what is in PYTHONPATH."""
        broken = self.repository.parent / "-".join(("without", *without))
        broken.mkdir(exist_ok=True)
        for module in without:
            (broken / f"{module}.py").write_text("raise ImportError('not here')\n")
        return f'PYTHONPATH={broken}:{more}:${{PYTHONPATH:-}}:{self.modules} exec {sys.executable} -S "$@"'

    def source(self, group="run", then='echo "$PYTHON"', status=None, **variables):
        """Source the script, to this exit status if one is given; returns the completed process."""
        script = f"set -euo pipefail; source {self.repository}/scripts/environment.sh {group}; {then}"
        environment = {"PATH": str(self.bin), "HOME": str(self.bin), "MASONRY_NO_INSTALL": "1",
                       "SYSTEM_PYTHON": str(self.system_python), **variables}
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
        assert (done.returncode, done.stdout.strip()) == (0, str(machine.system_python)), done.stderr

    @pytest.mark.skipif(not Path("/usr/bin/python3").exists(), reason="no /usr/bin/python3")
    def test_the_systems_python_is_the_one_of_debian(self, machine):
        machine.stub("python3", NO_PACKAGES)
        has_all = subprocess.run(["/usr/bin/python3", "-c", "import numba, h5py, snakemake"]).returncode == 0
        if not has_all:
            pytest.skip("/usr/bin/python3 lacks the packages")
        assert machine.source(SYSTEM_PYTHON="").stdout.strip() == "/usr/bin/python3"

    def test_a_python_on_the_path_is_taken_where_the_systems_lacks_packages(self, machine):
        machine.stub("python3", NO_PACKAGES, machine.system_python.parent)
        machine.stub("python3", machine.python())
        assert machine.source().stdout.strip() == str(machine.bin / "python3")

    def test_the_users_choice_comes_first(self, machine):
        mine = machine.stub("mine", machine.python())
        assert machine.source(PYTHON=str(mine)).stdout.strip() == str(mine)

    def test_the_users_choice_is_passed_over_where_it_lacks_packages(self, machine):
        mine = machine.stub("mine", NO_PACKAGES)
        assert machine.source(PYTHON=str(mine)).stdout.strip() == str(machine.system_python)

    def test_modules_of_the_working_folder_are_not_executed(self, machine, tmp_path, monkeypatch):
        monkeypatch.chdir(tmp_path)
        machine.stub("python3", f'PYTHONPATH={machine.modules} exec {sys.executable} -S "$@"',
                     machine.system_python.parent)
        for module in ("numpy", "snakemake"):
            (tmp_path / f"{module}.py").write_text(f"open({str(tmp_path / 'executed')!r}, 'w')\n")
        assert machine.source(then='echo "${PYTHONSAFEPATH:-}"').stdout == "\n"  # it is not exported
        assert not (tmp_path / "executed").exists()

    def test_what_it_exports(self, machine):
        done = machine.source(then="env", PYTHONPATH="/elsewhere", PYTHONHOME="/elsewhere")
        assert {f"PYTHON={machine.system_python}", f"PYTHONPATH={machine.repository}:/elsewhere", "MPLBACKEND=Agg",
                "PYTHONNOUSERSITE=1"} <= set(done.stdout.splitlines())
        assert "PYTHONHOME" not in done.stdout

    def test_what_the_user_has_in_pythonpath_comes_behind_the_repository(self, machine):
        """Once each, and relative to the folder that the user is in: batches work in others."""
        done = machine.source(then="cd /; echo $PYTHONPATH", PYTHONPATH=f"a b::{machine.repository}:/c:/c:")
        assert done.stdout.strip() == f"{machine.repository}:{os.getcwd()}/a b:/c", done.stderr

    def test_what_keeps_every_python_from_its_packages_is_left_out(self, machine, tmp_path):
        (tmp_path / "numpy.py").write_text("raise ImportError('of another Python')\n")
        done = machine.source(then="echo $PYTHONPATH", PYTHONPATH=str(tmp_path))
        assert (done.returncode, done.stdout.strip()) == (0, str(machine.repository)), done.stderr
        assert done.stderr == (f"warning: {tmp_path} is left out of PYTHONPATH: with it no Python has all packages\n")


class TestMissing:
    def test_all_of_it_is_named_with_the_command_that_gets_it(self, machine):
        (machine.bin / "yade").unlink()
        for folder in (machine.bin, machine.system_python.parent):
            machine.stub("python3", NO_PACKAGES, folder)
        done = machine.source("test")
        assert (done.returncode, done.stdout) == (3, "")
        missing, command = done.stderr.splitlines()
        packages = ["yade", *(f"python3-{name}" for name in ("numpy", "scipy", "pandas", "h5py", "matplotlib",
                                                             "numba", "jinja2")),
                    "snakemake", "python3-pytest", "python3-pytest-xdist", "python3-hypothesis", "python3-flask"]
        assert missing == f"error: missing on this machine: {' '.join(packages)}"
        assert command.endswith(f"apt-get install --no-install-recommends {' '.join(packages)}")

    def test_programs_of_other_names_are_reported_by_their_packages(self, machine):
        done = machine.source("browser", status=3)
        assert done.stderr.splitlines()[0].startswith(
            "error: missing on this machine: chromium chromium-driver poppler-utils")

    def test_only_what_is_missing_is_named(self, machine):
        machine.stub("python3", machine.python("numba", "h5py"), machine.system_python.parent)
        done = machine.source(status=3)
        assert done.stderr.splitlines()[0].endswith(": python3-h5py python3-numba")

    def test_a_machine_without_any_python(self, machine):
        (machine.system_python).unlink()
        done = machine.source(status=3)
        assert "python3-numpy" in done.stderr and "yade" not in done.stderr

    def test_without_apt_get_nothing_is_tried(self, machine):
        (machine.bin / "yade").unlink()
        done = machine.source(MASONRY_NO_INSTALL="", status=3)
        assert done.stderr.splitlines()[0] == "error: missing on this machine: yade"

    def test_an_unknown_group_is_refused(self, machine):
        done = machine.source("everything", status=2)
        assert done.stderr == ("error: environment.sh everything: expected run, cluster, test, coverage, browser, app, "
                               "site or gates; correct the call\n")


OS_RELEASE = Path("/etc/os-release")


@pytest.mark.skipif(not OS_RELEASE.exists() or "debian" not in OS_RELEASE.read_text(),
                    reason="installs on Debian and its kin only")
class TestInstalling:
    @pytest.fixture
    def debian(self, machine):
        """A machine without YADE and packages whose apt-get fails once, then brings them."""
        (machine.bin / "yade").unlink()
        machine.stub("python3", NO_PACKAGES, machine.system_python.parent)
        machine.stub("sudo", '[ "$1" = -n ] && exec "${@:2}"')
        machine.stub("sleep", "exit 0")
        good = machine.stub("good", machine.python(), machine.repository)
        yade = machine.stub("yade", "exit 0", machine.repository)
        machine.stub("apt-get", f"""
            echo "${{DEBIAN_FRONTEND:-}}: $*" >>{machine.repository}/calls
            case "$*" in *install*) ;; *) exit 0 ;; esac
            if [ ! -e {machine.repository}/failed ]; then
                : >{machine.repository}/failed
                echo "E: no route" >&2
                exit 100
            fi
            cat {good} >{machine.system_python}
            cat {yade} >{machine.bin}/yade
            {shutil.which("chmod")} +x {machine.bin}/yade""")
        return machine

    def test_it_updates_installs_and_tries_twice(self, debian):
        done = debian.source(MASONRY_NO_INSTALL="")
        assert (done.returncode, done.stdout.strip()) == (0, str(debian.system_python)), done.stderr
        assert "E: no route" in done.stderr  # errors stay visible
        calls = (debian.repository / "calls").read_text().splitlines()
        assert [line.split(":")[0] for line in calls] == ["noninteractive"] * 4
        assert ["update" in line for line in calls] == [True, False, True, False]
        assert calls[1].endswith("install --no-install-recommends yade python3-numpy python3-scipy python3-pandas "
                                 "python3-h5py python3-matplotlib python3-numba python3-jinja2")

    def test_it_gives_up_after_the_second_failure(self, debian):
        debian.stub("apt-get", f"echo x >>{debian.repository}/calls; echo 'E: broken' >&2; exit 100")
        done = debian.source(MASONRY_NO_INSTALL="", status=3)
        assert done.stderr.count("E: broken") == 2
        assert "error: missing on this machine: yade" in done.stderr

    def test_it_can_be_forbidden(self, debian):
        debian.source(status=3)
        assert not (debian.repository / "calls").exists()


class TestObspy:
    def test_without_it_the_tests_go_on_and_the_reason_is_reported(self, machine):
        pytest.importorskip("hypothesis")
        machine.stub("python3", machine.python("obspy"), machine.system_python.parent)
        done = machine.source("test")
        assert (done.returncode, done.stdout.strip()) == (0, str(machine.system_python)), done.stderr
        assert "MASONRY_NO_INSTALL" in done.stderr
        assert "tests of miniSEED are skipped: they need obspy" in done.stderr

    def test_a_virtual_environment_of_other_making_is_left_alone(self, machine):
        machine.stub("python3", machine.python("obspy"), machine.system_python.parent)
        (machine.repository / ".venv").mkdir()
        (machine.repository / ".venv" / "pyvenv.cfg").write_text("include-system-site-packages = false\n")
        done = machine.source("test", MASONRY_NO_INSTALL="")
        assert done.returncode == 0 and "left alone" in done.stderr
        assert [path.name for path in (machine.repository / ".venv").iterdir()] == ["pyvenv.cfg"]

    def test_one_with_obspy_is_used(self, machine):
        machine.stub("python3", machine.python("obspy"), machine.system_python.parent)
        has = machine.repository / "has"
        has.mkdir()
        (has / "obspy.py").write_text("")
        (machine.repository / ".venv" / "bin").mkdir(parents=True)
        inside = machine.stub("python", machine.python(more=has), machine.repository / ".venv" / "bin")
        assert machine.source("test").stdout.strip() == str(inside)


class TestGates:
    """shellcheck and ruff, and no YADE."""

    @pytest.fixture
    def bare(self, machine):
        (machine.bin / "yade").unlink()
        machine.stub("shellcheck", "exit 0")
        return machine

    def test_ruff_is_fetched_only_where_that_is_allowed(self, bare):
        done = bare.source("gates")
        assert (done.returncode, done.stdout) == (3, "")
        assert done.stderr.splitlines()[0] == "ruff is missing and MASONRY_NO_INSTALL is set"
        assert done.stderr.splitlines()[1].startswith("error: missing on this machine: ruff ")

    def test_only_ruff_of_the_fixed_version_is_taken(self, bare):
        version = tomllib.loads((REPOSITORY / "pyproject.toml").read_text())["tool"]["ruff"]["required-version"]
        (bare.repository / ".venv" / "bin").mkdir(parents=True)
        ruff = bare.stub("ruff", "echo ruff 0.0.1", bare.repository / ".venv" / "bin")
        assert bare.source("gates").returncode == 3
        script_file(ruff, f"echo ruff {version.removeprefix('==')}")
        done = bare.source("gates", then='echo "$RUFF"')
        assert (done.returncode, done.stdout.strip()) == (0, str(ruff)), done.stderr

    def test_a_missing_shellcheck_is_named(self, bare):
        (bare.bin / "shellcheck").unlink()
        done = bare.source("gates", status=3)
        assert done.stderr.splitlines()[0] == "error: missing on this machine: shellcheck"


def run_all(*words, **variables):
    return run_command(REPOSITORY / "run_all.sh", *words, env={**os.environ, "MASONRY_NO_INSTALL": "1", **variables},
                       timeout=120)


class TestRunAll:
    @pytest.mark.parametrize(("words", "printed"), [
        ((), "no study given: expected"),
        (("harmonik",), "no study harmonik is shipped: expected"),
        (("../studies/quick",), "is shipped: expected"),
        (("mine.toml",), "mine.toml: no such study file"),
        (("quick", "--fast"), "unknown option --fast: expected -j, --out, --solver, --keep, --slice, --slurm, "
         "--cores, --shard, --remake or --dry-run"),
        (("quick", "quick"), "two studies"),
        (("quick", "-j"), "-j without a value"),
        (("quick", "-j", "0"), "-j 0: expected a whole number"),
        (("quick", "-jmany"), "-j many: expected a whole number"),
        (("quick", "--out="), "--out without a value"),
        (("quick", "--solver", "udec"), "expected yade, reference or both"),
        (("quick", "--solver=udec"), "--solver udec: expected yade"),
    ], ids=str)
    def test_bad_command_lines_get_one_line_and_status_2(self, words, printed):
        done = run_all(*words)
        assert (done.returncode, done.stdout) == (2, "")
        assert done.stderr.startswith("error: ") and done.stderr.count("\n") == 1
        assert printed in done.stderr

    def test_help_names_the_studies(self):
        done = run_all("--help")
        assert (done.returncode, done.stderr) == (0, "")
        assert "quick" in done.stdout and "--out DIR" in done.stdout

    @pytest.mark.yade
    @pytest.mark.skipif(shutil.which("yade") is None, reason="YADE is not installed")
    @pytest.mark.parametrize(("words", "status", "started"), [
        ((), 0, ["check", "reference", "check-bits", "study"]),
        ((), 1, ["check", "reference", "check-bits", "study"]),  # the batch says what is wrong
        ((), 130, ["check", "reference"]),
        (("--solver", "reference"), 0, ["study"]),
        (("--dry-run",), 0, ["study"]),
    ], ids=str)
    def test_quick_starts_with_a_run_in_the_reference_solver(self, tmp_path, words, status, started):
        calls = tmp_path / "calls"
        for name in MODULES:
            (tmp_path / f"{name}.py").touch()
        python = script_file(tmp_path / "python", f"""
            [ "$1" = -c ] && PYTHONPATH={tmp_path} exec {sys.executable} -S "$@"
            echo "$@" >>{calls}
            case "$*" in *" check "*) exit 1 ;; *" reference "*) exit {status} ;; esac""")
        done = run_all("quick", "--out", tmp_path / "out", *words, PYTHON=str(python))
        assert done.returncode == (130 if status == 130 else 0), done.stderr
        lines = calls.read_text().splitlines()
        assert len(lines) == len(started) and all(name in line for name, line in zip(started, lines)), lines
        assert ("first result" in done.stdout) == ("reference" in started)

    def test_it_is_refused_before_anything_is_looked_for(self, tmp_path):
        """A wrong name must not start an installation."""
        done = run_all("nothing", PYTHON="/nowhere", SYSTEM_PYTHON="/nowhere")
        assert done.returncode == 2
