"""Names that were removed are refused with what to use instead, wherever a user may give them."""

from dataclasses import dataclass

import pytest
from conftest import parsed, refused_with

import damage
from damage.checks import record_from
from damage.errors import heard
from damage.retired import RETIRED, Retired
from damage.run.options import SOLVERS, options_of_a_run


def test_no_retired_name_is_an_option():
    taken = {name.replace("_", "-") for name in options_of_a_run()}
    assert not taken & set(RETIRED)


@pytest.mark.parametrize("solver", SOLVERS)
def test_on_a_command_line(solver):
    said = r"--past-collapse; --past-collapse was removed in 0\.2; give"
    refused_with(said, parsed, "--past-collapse", solver)


def test_in_python():
    said = "no option perturb: .*; --perturb was removed in 0.2; members"
    refused_with(said, damage.run, "walls/symmetric.py", perturb=1e-9)


def test_in_a_file_of_an_older_version(monkeypatch):
    @dataclass(frozen=True)
    class Record:
        kept: int = 1

    monkeypatch.setitem(
        RETIRED, "old-field", Retired("--old-field was removed in 9.9; give --kept", 4)
    )
    assert record_from(Record, {"kept": 2, "old_field": 4}) == Record(2)
    with heard() as warnings:
        assert record_from(Record, {"kept": 2, "old_field": 5}) == Record(2)
    assert warnings == [
        "made with old_field = 5 by an older version: --old-field was removed in 9.9; give --kept"
    ]
    refused_with("a later version wrote it", record_from, Record, {"other": 5})
