"""Random legal walls and motions: the command line against `damage.run`, energies that balance or a
warning."""

import pytest

pytest.importorskip("obspy")  # of vertical records, which ship as miniSEED

from benchmarks.random_runs import runs


def check(seeds):
    table = runs(seeds)
    assert table.loc[table["fault"] != "", ["seed", "fault"]].to_dict("records") == []
    assert (table["status"] == 0).mean() > 0.9


def test_a_few_random_runs():
    check(range(6))


@pytest.mark.long
def test_five_hundred_random_runs():
    check(range(6, 512))
