"""Processor time of the tests: every file has a subject, and what programs take that a test starts counts for it."""

import os
import re
import subprocess
import sys
from pathlib import Path

from conftest import REPOSITORY

from tests.processor_time import SUBJECT, SUBJECTS, spent


def test_every_file_of_tests_has_one_subject():
    assert sorted(SUBJECT) == sorted(path.name for path in (REPOSITORY / "tests").glob("test_*.py"))
    assert sum(len(names.split()) for names in SUBJECTS.values()) == len(SUBJECT)


def test_every_file_with_longer_checks_is_in_the_list_of_them():
    marked = {path.name for path in (REPOSITORY / "tests").glob("test_*.py")
              if re.search(r"mark\.long|= IN_BROWSER", path.read_text(encoding="utf-8"))} - {Path(__file__).name}
    text = (REPOSITORY / "CONTRIBUTING.md").read_text(encoding="utf-8")
    table = re.search(r"\| why they are longer checks \|\n((?:\|.*\n)+)", text)[1]
    assert marked == set(re.findall(r"`(test_\w+\.py)`", "".join(row.split("|")[1] for row in table.splitlines())))


def test_what_a_program_takes_counts():
    before = spent()
    subprocess.run([sys.executable, "-c", "import time\nwhile time.process_time() < 0.3: pass"], check=True)
    assert 0.25 < spent() - before


def test_the_table_names_test_file_and_subject(tmp_path):
    (tmp_path / "test_measures.py").write_text("""
import subprocess, sys

def test_slow():
    subprocess.run([sys.executable, "-c", "import time\\nwhile time.process_time() < 0.3: pass"], check=True)
""")
    done = subprocess.run([sys.executable, "-m", "pytest", "-q", "-p", "tests.processor_time", "-p", "no:cacheprovider",
                           "-c", os.devnull, "--rootdir", tmp_path, tmp_path], cwd=tmp_path, capture_output=True,
                          text=True, env=os.environ | {"PYTHONPATH": str(REPOSITORY)})
    lines = [line.split() for line in done.stdout.splitlines()]
    rows = {line[1]: float(line[0]) for line in lines if len(line) > 1 and line[0].replace(".", "").isdigit()}
    assert done.returncode == 0, done.stdout + done.stderr
    for name in ("test_measures.py::test_slow", "test_measures.py", "model", "all;"):
        assert 0.25 < rows[name] < 10, (name, done.stdout)
