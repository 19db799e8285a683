"""Digests of the code that decides the values of runs and of tables: they change with it, and with
nothing else."""

import os
import shutil
import subprocess

import pytest
from conftest import REPOSITORY

from damage.provenance import (
    HERE,
    RANGES,
    UNKNOWN,
    code_of,
    commit,
    measures_digest,
    model_digest,
)


def test_the_digest_is_of_what_decides_values_alone(tmp_path):
    """Comments, docstrings and layout do not count, a number does; each solver has its own."""
    source = '"""Words."""\n\ndef law(x):\n    """More words."""\n    return 2 * x  # twice\n'
    (tmp_path / "a.py").write_text(source)
    first = code_of(tmp_path / "a.py")
    (tmp_path / "a.py").write_text('def law(x):\n    "Other words."\n\n    return (2 * x)\n')
    assert code_of(tmp_path / "a.py") == first
    (tmp_path / "a.py").write_text(source.replace("2 *", "3 *"))
    assert code_of(tmp_path / "a.py") != first
    digests = {model_digest(REPOSITORY / name) for name in ("damage/reference", "yade_scripts")}
    assert len(digests) == 2 and all(len(digest) == 12 for digest in digests)


def test_the_commit_is_that_of_the_package_and_says_whether_files_differ(tmp_path, monkeypatch):
    def git(*words):
        subprocess.run(
            ["git", "-c", "user.name=a", "-c", "user.email=a@b", *words],
            cwd=tmp_path,
            check=True,
            capture_output=True,
        )

    package = tmp_path / "damage"
    package.mkdir()
    (package / "__init__.py").write_text("")
    monkeypatch.setattr("damage.provenance.HERE", package)
    assert commit.__wrapped__() == UNKNOWN  # in no repository, or not its file
    git("init", "-q")
    assert commit.__wrapped__() == UNKNOWN
    git("add", ".")
    git("commit", "-qm", "one")
    clean = commit.__wrapped__()
    assert len(clean) == 40
    os.utime(package / "__init__.py", (1, 1))
    index = (tmp_path / ".git" / "index").read_bytes()
    assert commit.__wrapped__() == clean
    # a process that is killed leaves no lock on it
    assert (tmp_path / ".git" / "index").read_bytes() == index
    (package / "__init__.py").write_text("x = 1\n")
    assert commit.__wrapped__() == f"{clean} changed"


SOLVERS = {"reference": REPOSITORY / "damage" / "reference", "yade": REPOSITORY / "yade_scripts"}


DECIDE = (
    "rounded",
    "run/monitor",
    "run/initial_state",
    "applications/cracks/crack_paths",
    "law/joint_law",
    "applications/groningen/exposure/models/bommer_2022",
)
MEASURE = (
    "index",
    "measure/summary",
    "applications/cracks/at_rest",
    "history/reader",
    "motion/intensity",
    "wall/geometry",
)
NAMED = (*DECIDE, *MEASURE, "version", "__main__", "motion/record", "wall/layout")


def modules_that_change(monkeypatch, tmp_path, digest_of):
    """Modules of both packages, and the table of ranges, as paths in the repository, that change a
    digest: the first of each folder, and NAMED."""
    for name in ("damage", "yade_scripts"):
        shutil.copytree(
            REPOSITORY / name,
            tmp_path / name,
            ignore=shutil.ignore_patterns("data", "__pycache__", "page"),
        )
    table = tmp_path / "damage" / RANGES
    table.parent.mkdir(parents=True)
    shutil.copy(HERE / RANGES, table)
    monkeypatch.setattr("damage.provenance.HERE", tmp_path / "damage")
    usual = digest_of()
    found = set()
    first = {}
    for path in sorted(tmp_path.rglob("*.py")):
        first.setdefault(path.parent, path)
    for path in {table, *first.values(), *(tmp_path / f"damage/{name}.py" for name in NAMED)}:
        text = path.read_text()
        path.write_text(f"{text}\nCHANGED = 1\n")
        if digest_of() != usual:
            found.add(path.relative_to(tmp_path).as_posix())
        path.write_text(text)
    return found


@pytest.mark.parametrize("solver", SOLVERS)
def test_the_digest_of_the_model_is_of_its_folders_and_those_of_applications(
    solver, tmp_path, monkeypatch
):
    """Its own solver's, and what an application registers as `exposure` draws motions; not what
    measures, draws and writes."""
    own = SOLVERS[solver].relative_to(REPOSITORY)
    found = modules_that_change(
        monkeypatch, tmp_path, lambda: model_digest.__wrapped__(tmp_path / own)
    )
    decide = {f"damage/{name}.py" for name in DECIDE} | {f"damage/{RANGES}"}
    assert decide | {f"{own.as_posix()}/__init__.py"} <= found
    folders = {path.rpartition("/")[0] for path in found}
    other = next(
        str(path.relative_to(REPOSITORY)) for path in SOLVERS.values() if path != SOLVERS[solver]
    )
    assert not folders & {
        "damage/draw",
        "damage/history",
        "damage/commands",
        "damage/applications/groningen/claim",
        other,
    }
    assert not found & {"damage/version.py", "damage/__main__.py", "damage/measure/summary.py"}


def test_the_digest_of_measures_is_of_their_folders(tmp_path, monkeypatch):
    found = modules_that_change(monkeypatch, tmp_path, measures_digest.__wrapped__)
    assert {f"damage/{name}.py" for name in MEASURE} <= found
    folders = {path.rpartition("/")[0] for path in found}
    assert folders == {
        "damage",
        "damage/history",
        "damage/measure",
        "damage/motion",
        "damage/wall",
        "damage/applications/cracks",
    }
    assert not found & {"damage/motion/record.py", "damage/wall/layout.py"}


@pytest.mark.parametrize(
    "module, said, decides",
    [
        (
            "measure/cycles.py",
            ("natural period of a run in free vibration", "period of a free vibration"),
            ('"period_s": Column', '"natural_period_s": Column'),
        ),
        (
            "wall/parameters.py",
            ("a brick of a scale model; a historical wall", "some brick"),
            ("default=0.1025", "default=0.1"),
        ),
        (
            "wall/model_options.py",
            ("contact points per half brick", "points of half a brick"),
            ("1, 16, whole=True, default=2", "1, 16, whole=True, default=3"),
        ),
    ],
)
def test_a_digest_follows_names_and_defaults_and_not_what_is_said_of_them(
    module, said, decides, tmp_path
):
    text = (REPOSITORY / "damage" / module).read_text()
    copy = tmp_path / "copy.py"
    code = []
    for version in (text, text.replace(*said), text.replace(*decides)):
        copy.write_text(version)
        code.append(code_of(copy))
    assert said[0] in text and code[0] == code[1] != code[2]
