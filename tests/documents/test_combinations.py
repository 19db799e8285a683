"""Modelling choices combined: effects by hand, and made-up tables in which claims depend on known
choices."""

import numpy as np
import pandas as pd
import pytest
from conftest import REPOSITORY
from test_paper import harmonic_row, world_of_the_paper

from damage.applications.studies.grid import read_rows
from paper.combinations import (
    CHOICES,
    LIGHT,
    conclusions,
    effects,
    is_orthogonal,
    judge_combinations,
    signs,
    table_of_best,
    table_of_effects,
)
from paper.criteria import CLAIMS

WALLS = read_rows(REPOSITORY / "studies" / "combinations.csv", "")
PERIODS_S = {"solid": (0.06, 0.2, 0.33, 1.0), "symmetric": (0.06, 0.33, 1.0)}
PERIODS_S["asymmetric"] = PERIODS_S["solid"]
"""Periods of motions of two cycles that the world of the paper lacks."""


def levels_of(row):
    return (
        row["contacts"],
        row["load"],
        row["top"],
        str(row["lintel"]),
        "" if row["ending"] == ".py" else LIGHT,
    )


def world_of_a_combination(number, levels):
    """A table of runs in which all claims hold, but P3 with less mass, and P9d by an interaction of
    load and top."""
    contacts, load, top, lintel, mass = levels
    second = [
        harmonic_row(wall, period, amplitude, cycles=2)
        for wall, periods in PERIODS_S.items()
        for period in periods
        for amplitude in range(5)
    ]
    table = pd.concat([world_of_the_paper(), pd.DataFrame(second)], ignore_index=True)
    table["run"] = f"{number}-" + table["run"]
    table = table.assign(contacts=contacts, load=load, top=top, lintel=lintel)
    solid = table["wall"] == "solid"
    table.loc[solid, ["load", "lintel"]] = "length", "elastic"  # which are without effect on it
    columns = ["max_DI", "max_accumulated_DI", "max_shear_limit_DI"]
    if mass:
        table.loc[solid, columns] = 0.3
    if (load == "piers") != (top == "uniform"):
        strongest = (table["motion_period_s"] == 0.33) & (table["amplitude_g"] == 0.1)
        table.loc[strongest & (table["wall"] == "symmetric"), columns] = 0.2
    table["wall"] += mass
    return table


def test_effects_of_a_full_factorial_by_hand():
    """Met by 3 of 4: a or b.  Means 1/2 and 1 at the levels of each; the variance is 3/16, of which
    each has 1/16."""
    levels = np.array([[-1, -1], [-1, 1], [1, -1], [1, 1]])
    differences, alone, pairs = effects([False, True, True, True], levels)
    assert differences == pytest.approx([0.5, 0.5])
    assert (alone, pairs) == pytest.approx((2 / 3, 1.0))
    # an interaction alone
    assert effects([True, False, False, True], levels)[1:] == pytest.approx((0.0, 1.0))
    assert is_orthogonal(levels, with_pairs=True) and not is_orthogonal(levels[:3])
    # a choice with one level only has no effect
    single = np.column_stack([levels, -np.ones(4, int)])
    differences, alone, pairs = effects([False, True, True, True], single)
    assert differences == pytest.approx([0.5, 0.5, np.nan], nan_ok=True)
    assert (alone, pairs) == pytest.approx((2 / 3, 1))


def test_claims_depend_on_the_choices_that_decide_them(tmp_path, monkeypatch):
    monkeypatch.setattr(
        "paper.verdict.CLAIMS", [claim for claim in CLAIMS if claim.id in ("P3", "P9d")]
    )
    folder = tmp_path / "combinations" / "tables"
    folder.mkdir(parents=True)
    worlds = [world_of_a_combination(number, levels_of(row)) for number, row in enumerate(WALLS)]
    pd.concat(worlds).to_csv(folder / "summary.csv", index=False)
    found = judge_combinations(tmp_path)
    levels = signs(found)
    assert len(found) == 32 and is_orthogonal(levels)
    for claim, expected in (
        ("P3", ([-float(name == "mass") for name in CHOICES], 1.0, 1.0)),
        ("P9d", (np.zeros(len(CHOICES)), 0.0, 1.0)),
    ):
        differences, alone, pairs = effects([one.holds(claim) for one in found], levels)
        assert differences == pytest.approx(expected[0]), claim
        assert (alone, pairs) == pytest.approx(expected[1:]), claim
    table = "".join(table_of_effects(found))
    assert "| 50% | 0 | 0 | 0 | 0 | **-100** | 0 | 100% | 100% |" in table
    assert conclusions(found) and table_of_best(found)
