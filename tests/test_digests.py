"""Digests of the code that decides the values of runs and of tables: they change with it, and with nothing else."""

import os
import shutil
import subprocess
import sys

import pytest
from conftest import REPOSITORY, contents, run_command, written
from test_architecture import read_modules

from damage.provenance import (
    DECIDES_NOTHING,
    MEASURES,
    UNKNOWN,
    code_of,
    commit,
    file_origin,
    measures_digest,
    model_digest,
    model_modules,
)
from damage.reference.session import run_reference


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
        subprocess.run(["git", "-c", "user.name=a", "-c", "user.email=a@b", *words], cwd=tmp_path, check=True,
                       capture_output=True)

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
    assert (tmp_path / ".git" / "index").read_bytes() == index  # a process that is killed leaves no lock on it
    (package / "__init__.py").write_text("x = 1\n")
    assert commit.__wrapped__() == f"{clean} changed"


def test_a_file_that_is_not_there_has_no_checksum(tmp_path):
    assert file_origin(written(tmp_path / "wall.py", "words")) == {"file": "wall.py", "sha256": (
        "dba36bffa5cab0f922d087a3aeb179f9d4e745df40b323e1b1471402848c8a3e")}
    assert file_origin(tmp_path / "none.py") == {"file": "none.py", "sha256": UNKNOWN}


def test_the_same_command_gives_the_same_bits(tmp_path, monkeypatch):
    """All that a run writes of its wall; when it ran and where it wrote differ."""
    monkeypatch.chdir(REPOSITORY)
    paths = [tmp_path / name for name in ("a.h5", "b.h5")]
    for path in paths:
        words = ["walls/variants/small.py", "--harmonic", "0.06", "0.6", "--rest", "0", "--no-pictures"]
        assert run_reference([*words, "--out", str(path)]) == 0
    first, second = map(contents, paths)
    assert first.keys() == second.keys() and len(first) > 50
    assert [name for name in first if first[name] != second[name]] == []


SOLVERS = {"reference": REPOSITORY / "damage" / "reference", "yade": REPOSITORY / "yade_scripts"}


def test_the_model_s_digest_is_of_all_modules_that_a_run_loads(tmp_path):
    """A settled, cracked wall is shaken by a life at an address, in a process of its own: each module of the package
    that it has loaded counts, or is named with why it need not."""
    program = ("import sys; from damage.reference.session import run_reference; "
               "assert run_reference(sys.argv[1:]) == 0; print(*(m for m in sys.modules if m.startswith('damage.')))")
    (tmp_path / "cracks.csv").write_text("crack,point,x_m,z_m,width_mm\na,1,0.0,0.15,0.1\na,2,0.4,0.15,0.1\n")
    words = ["walls/variants/small.py", "--address", "studies/addresses/garsthuizen.toml", "--life", "1", "--settle",
             "hogging", "--distortion", "1/2000", "--cracked", str(tmp_path / "cracks.csv"), "--rest", "0",
             "--no-pictures", "--out", str(tmp_path / "a.h5")]
    done = run_command(sys.executable, "-c", program, *words, status=0)
    loaded = {name.removeprefix("damage.").replace(".", "/") for name in done.stdout.splitlines()[-1].split()}
    counted = {path.relative_to(REPOSITORY / "damage").with_suffix("").as_posix()
               for path in model_modules(SOLVERS["reference"])}
    named = [name.removesuffix(".py") for names in DECIDES_NOTHING.values() for name in names]
    folders = {path.parent.relative_to(REPOSITORY / "damage").as_posix()
               for path in (REPOSITORY / "damage").rglob("__init__.py")}
    assert [name for name in sorted(loaded - counted - folders)
            if not any(name == one or name.startswith(f"{one}/") for one in named)] == []


@pytest.mark.parametrize("solver", SOLVERS)
def test_every_module_of_the_model_changes_its_digest(solver, tmp_path, monkeypatch):
    for name in ("damage", "yade_scripts"):
        shutil.copytree(REPOSITORY / name, tmp_path / name, ignore=shutil.ignore_patterns(
            "data", "__pycache__", "page"))
    monkeypatch.setattr("damage.provenance.HERE", tmp_path / "damage")
    folder = tmp_path / SOLVERS[solver].relative_to(REPOSITORY)
    digests, modules = {model_digest.__wrapped__(folder)}, model_modules(folder)
    for path in modules:
        text = path.read_text()
        path.write_text(f"{text}\nCHANGED = 1\n")
        digests.add(model_digest.__wrapped__(folder))
        path.write_text(text)
    assert len(digests) == 1 + len(modules)
    assert {"run/watch.py", "run/before.py", "measure/crack_paths.py", "exposure/models/bommer_2022.py",
            "law/joint_law.py"} <= {path.relative_to(tmp_path / "damage").as_posix() for path in modules
                                     if path.is_relative_to(tmp_path / "damage")}


def test_a_digest_is_of_all_code_that_makes_numbers_out_of_histories():
    """What `summary_row` and patterns at rest import counts in it or is named here, with why it need not."""
    elsewhere = {
        "checks": "refuses", "csv_table": "reads, writes", "errors": "words", "files": "reads, writes",
        "version": "words", "provenance": "digests", "law/states": "names",
        "history/head": "refuses", "history/info": "words",
        "measure/columns": "words", "measure/evidence": "words", "measure/warnings": "words", "wall/as_built": "words",
        "fields": "refuses", **dict.fromkeys(
            ("elementary", "rounded", *(f"motion/{name}" for name in ("loading", "record", "samples")), *(
                f"wall/{name}" for name in (
                "floors", "kinds", "kinematics", "lintels", "model_options", "parameters", "plan", "restraints"))),
            "of the model's digest")}
    modules, found, left = read_modules(), set(), {"measure/tables", "measure/cycles", "measure/kept"}
    while left:
        found.add(name := left.pop())
        imported = modules[f"damage.{name.replace('/', '.')}"] - {"damage"}
        left |= {module.removeprefix("damage.").replace(".", "/") for module in imported} - found
    assert {f"{name}.py" for name in found - elsewhere.keys()} == set(MEASURES)
    assert elsewhere.keys() <= found
    assert len(measures_digest()) == 12 and measures_digest() != model_digest(REPOSITORY / "damage" / "reference")


def test_the_digest_of_measures_follows_the_index(tmp_path, monkeypatch):
    package = tmp_path / "damage"
    shutil.copytree(REPOSITORY / "damage", package)
    monkeypatch.setattr("damage.provenance.HERE", package)
    assert measures_digest.__wrapped__() == measures_digest()
    index = package / "index.py"
    text = index.read_text()
    index.write_text(text.replace('"""The damage index', '"""Of the damage index'))
    assert measures_digest.__wrapped__() == measures_digest()
    index.write_text(text.replace("DRIFT_LIMIT = 0.02", "DRIFT_LIMIT = 0.01"))
    assert measures_digest.__wrapped__() != measures_digest()


def test_the_digest_of_measures_follows_the_patterns_at_rest(tmp_path, monkeypatch):
    """A claim's draws of two versions are not mixed."""
    package = tmp_path / "damage"
    shutil.copytree(REPOSITORY / "damage", package)
    monkeypatch.setattr("damage.provenance.HERE", package)
    written(package / "measure" / "kept.py", (package / "measure" / "kept.py").read_text().replace(
        "opening, offset = active.opening_m[samples]", "opening, offset = 10 * active.opening_m[samples]"))
    assert measures_digest.__wrapped__() != measures_digest()


@pytest.mark.parametrize("module, said, decides", [
    ("measure/cycles.py", ("natural period of a run in free vibration", "period of a free vibration"),
     ('"period_s": Column', '"natural_period_s": Column')),
    ("wall/parameters.py", ("a brick of a scale model; a historical wall", "some brick"),
     ("default=0.1025", "default=0.1")),
    ("wall/model_options.py", ("contact points per half brick", "points of half a brick"),
     ("1, 16, whole=True, default=2", "1, 16, whole=True, default=3")),
])
def test_a_digest_follows_names_and_defaults_and_not_what_is_said_of_them(module, said, decides, tmp_path):
    text, copy, code = (REPOSITORY / "damage" / module).read_text(), tmp_path / "copy.py", []
    for version in (text, text.replace(*said), text.replace(*decides)):
        copy.write_text(version)
        code.append(code_of(copy))
    assert said[0] in text and code[0] == code[1] != code[2]
