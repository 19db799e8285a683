"""What a study with --dry-run tells: the runs that are there and those to make; nothing is
made."""

import pytest
from conftest import REPOSITORY, wall_file, written
from test_outdated import Folder

from damage.applications.studies.definition import load_study
from damage.applications.studies.plan import print_plan

STUDY = """
name = "s"
[[grid]]
wall = "small.py"
options = { harmonic = [0.1, "{amplitude}"], cycles = 2, rest = 0.3 }
solvers = ["reference"]
members = 5
vary = { amplitude = [0.01, 0.02] }
"""


@pytest.fixture
def study(tmp_path):
    wall_file(tmp_path / "small.py", "Wall('small', 0.9, 0.45)")
    return load_study(written(tmp_path / "s.toml", STUDY), "both", REPOSITORY)


def test_the_dry_run_lists_all_runs_and_makes_nothing(study, tmp_path, output_of):
    before = sorted(path.name for path in tmp_path.iterdir())
    words = "--dry-run", "--solver", "reference", "--out", tmp_path / "out"
    said = output_of("study", study.path, *words)
    assert "points: 2, 0 there; runs to make: up to 20" in said
    for amplitude in (0.01, 0.02):
        (line,) = (line for line in said.splitlines() if f"harmonic-0.1-{amplitude}" in line)
        assert "5 to 10 runs to make" in line
    assert sorted(path.name for path in tmp_path.iterdir()) == before


def test_what_is_there_is_not_to_be_made(tmp_path, capsys):
    """But with --remake what another version of the model made."""
    there = Folder(tmp_path, ensemble="members = 5")
    there.make(broken=(), model_digest="of before")
    print_plan(there.load(), there.out)
    printed = capsys.readouterr().out
    assert "there, 1 runs" in printed and "points: 1, 1 there; runs to make: 0" in printed
    print_plan(there.load(), there.out, remake=True)
    assert "points: 1, 0 there; runs to make: up to 10" in capsys.readouterr().out
