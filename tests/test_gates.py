"""Each gate is shut by a fault seeded in a copy."""

import os
import shutil
import sys
from pathlib import Path

import pytest
from conftest import REPOSITORY, run_command, written

from scripts import documents, seeded_faults

GATES = REPOSITORY / "scripts" / "gates.sh"


def pass_gate(gate, *words, folder=REPOSITORY):
    """Run one gate; skips where it lacks something, for a test installs nothing."""
    done = run_command("bash", GATES, gate, *words, cwd=folder, env={**os.environ, "MASONRY_NO_INSTALL": "1"})
    if done.returncode == 3:
        pytest.skip(f"{done.stderr.splitlines()[-1]}; bash scripts/gates.sh gets it")
    return done


def seeded(path, folder, old, new):
    """A copy of a repository's file in a folder, with one piece of its text changed; returns its path."""
    copy = folder / path
    copy.parent.mkdir(parents=True, exist_ok=True)
    if not copy.exists():
        shutil.copy(REPOSITORY / path, copy)
    text = copy.read_text(encoding="utf-8")
    assert old in text
    copy.write_text(text.replace(old, new, 1), encoding="utf-8")
    return copy


def assert_shut(done, *faults):
    assert done.returncode == 1, done.stdout + done.stderr
    assert done.stdout.endswith("SHUT\n")
    for fault in faults:
        assert fault in done.stdout


def test_lint(tmp_path):
    for old, new in (("import pandas as pd\n", "import os\nimport pandas as pd\n"), ("    return ", "    return  "),
                     ("def ", "\n\ndef "), ('"""\n', f'{"x " * 60}x"""\n')):
        module = seeded("damage/index.py", tmp_path, old, new)
    with module.open("a") as file:
        file.write("\n\ndef long(x):\n" + "    x += 1\n" * 50 + "    return x\n")
    assert_shut(pass_gate("lint", "--config", REPOSITORY / "pyproject.toml", module),
                "unused-import", "multiple-spaces-after-keyword", "too-many-blank-lines", "line-too-long",
                "too-many-statements")


def test_shell(tmp_path):
    assert_shut(pass_gate("shell", seeded("tests/run.sh", tmp_path, '"$root"', "$root")), "SC2086")


def test_imports(tmp_path):
    """In a copy of all sources a module of the lowest folder imports one of the highest."""
    listed = run_command("git", "ls-files", "-co", "--exclude-standard", "*.py", "pyproject.toml", check=True)
    for path in map(Path, listed.stdout.split()):
        if (REPOSITORY / path).exists():
            (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(REPOSITORY / path, tmp_path / path)
    with (tmp_path / "damage" / "units.py").open("a") as file:
        file.write("\n\ndef seeded():\n    import damage.run.watch\n")
    done = pass_gate("imports", "tests/test_architecture.py", "-k", "order_of_rooms", folder=tmp_path)
    assert_shut(done, "damage.units imports damage.run.watch, which comes after it")


def test_doctests(tmp_path):
    module = written(tmp_path / "module.py", '"""One and one.\n\n>>> 1 + 1\n3\n"""\n')
    assert_shut(pass_gate("doctests", module, folder=tmp_path), "Expected:\n    3")


def test_documents(tmp_path, capsys):
    """What the gate runs, in this process: the verdict is worked out once."""
    verdict, claims = "docs/paper/verdict.md", "docs/tables/verdict.csv"
    shutil.copytree(REPOSITORY / "docs" / "tables", tmp_path / "docs" / "tables")
    seeded(verdict, tmp_path, "| P8 | 0.06 s: slight", "| P8 | 0.06 s: severe")
    seeded(claims, tmp_path, "YADE,all variants,0.0637 s", "YADE,all variants,0.0737 s")
    seeded("README.md", tmp_path, "| reference solver, elastic lintel | 1", "| reference solver, elastic lintel | 2")
    assert documents.main([str(tmp_path)]) == 1
    printed = capsys.readouterr().out
    for fault in (f"{verdict}: it says '| P8 | 0.06 s: severe", f"{verdict}: docs/tables say '| P8 | 0.06 s: slight",
                  f"{claims}: it says 'P1,", f"{claims}: docs/tables say 'P1,",
                  "README.md: '| reference solver, elastic lintel | 2"):
        assert fault in printed
    assert documents.main(["--renew", str(tmp_path)]) == 0
    for name in (verdict, claims, "README.md"):
        assert (tmp_path / name).read_text() == (REPOSITORY / name).read_text()


def test_every_seeded_fault_changes_a_line_that_is_there_and_names_tests_that_are():
    for fault in seeded_faults.FAULTS:
        assert fault.right in (REPOSITORY / fault.path).read_text(encoding="utf-8"), fault.what
        assert all((REPOSITORY / "tests" / f"{name}.py").is_file() for name in fault.tests.split()), fault.what


def test_an_unknown_gate_is_refused():
    done = pass_gate("speed")
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.startswith("error: no gate speed: expected one of lint")


@pytest.mark.parametrize(("path", "text", "fault"), [
    ("damage/index.py", "n_told = 3", "damage/index.py:2: 'told': expected active contacts"),
    ("docs/model/model.md", "Mend the file.", "docs/model/model.md:2: 'mend': expected correct, fix"),
    ("README.md", "It has doubts.", "README.md:2: 'doubts': expected warnings"),
    ("walls/a.py", "# held against the paper", "walls/a.py:2: 'held against': expected validation, comparison"),
    ("walls/a.py", "# a verdict on the edge", "walls/a.py:2: 'on the edge': expected borderline"),
    ("docs/reference/glossary.md", "| replaced | by |\n| --- | --- |\n| told | x |",
     "its replaced terms are not those of"),
])
def test_terms(with_glossary, path, text, fault):
    (with_glossary / path).parent.mkdir(parents=True, exist_ok=True)
    (with_glossary / path).write_text(f"amended, untold, redoubt\n{text}\n")
    status, printed = search(with_glossary)
    assert status == 1 and fault in printed


def test_terms_are_those_of_the_glossary_and_whole_words(with_glossary):
    (with_glossary / "README.md").write_text("amended, untold, redoubt\n")
    assert search(with_glossary) == (0, "")


def test_the_gate_of_terms(with_glossary):
    (with_glossary / "README.md").write_text("Mend it.\n")
    assert_shut(pass_gate("terms", with_glossary), "README.md:1: 'mend'")


def search(folder):
    """Status and output of what the gate of terms runs."""
    done = run_command(sys.executable, REPOSITORY / "scripts" / "terms.py", folder)
    return done.returncode, done.stdout


@pytest.fixture
def with_glossary(tmp_path):
    """A folder with the glossary, and a log of changes, whose words are not searched."""
    glossary = tmp_path / "docs" / "reference" / "glossary.md"
    glossary.parent.mkdir(parents=True)
    shutil.copy(REPOSITORY / "docs" / "reference" / "glossary.md", glossary)
    (tmp_path / "CHANGELOG.md").write_text("What was told.\n")
    return tmp_path
