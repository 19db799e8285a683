"""Modelling choices combined: effects by hand, and made-up tables in which claims depend on known
choices."""

import io
from contextlib import redirect_stdout
from functools import partial
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from conftest import REPOSITORY
from test_paper import CYCLES, harmonic_row, world_of_the_paper

from damage.applications.studies.definition import load_study
from damage.applications.studies.grid import read_rows
from paper import combinations
from paper.__main__ import main
from paper.combinations import (
    CHOICES,
    LIGHT,
    best,
    effects,
    is_orthogonal,
    judge_combinations,
    judged_by_some,
    signs,
    table_of_best,
    table_of_effects,
)

KINDS = "", "accumulated_", "shear_limit_"
WALLS = read_rows(REPOSITORY / "studies" / "combinations.csv", "")


def levels_of(row):
    return (
        row["contacts"],
        row["load"],
        row["top"],
        str(row["lintel"]),
        "" if row["ending"] == ".py" else LIGHT,
    )


def write_design(folder, spoil, walls=WALLS):
    """Write the tables of the study of combinations below a folder, in a world where all claims
    hold, but for `spoil(table, levels)`; returns the folder."""
    second = pd.DataFrame(
        [
            harmonic_row(wall, period, number, cycles=2)
            for wall in ("solid", "symmetric", "asymmetric")
            for period in (0.06, 0.33, 1.0, *((0.2,) if wall != "symmetric" else ()))
            for number in range(5)
        ]
    )
    world = pd.concat([world_of_the_paper(), second], ignore_index=True)
    cycles = CYCLES | {run.removesuffix("3") + "2": values for run, values in CYCLES.items()}
    of_study = folder / "combinations" / "tables"
    of_study.mkdir(parents=True)
    tables = []
    for number, row in enumerate(walls):
        contacts, load, top, lintel, mass = levels_of(row)
        table = world.assign(
            contacts=contacts, load=load, top=top, lintel=lintel, run=f"{number}-" + world["run"]
        )
        spoil(table, levels_of(row))
        solid = table["wall"] == "solid"
        table.loc[solid, ["load", "lintel"]] = "length", "elastic"  # which are without effect on it
        tables.append(table.assign(wall=table["wall"] + mass))
    pd.concat(tables).to_csv(of_study / "summary.csv", index=False)
    pd.concat(
        [
            pd.DataFrame(
                {
                    "run": f"{number}-{run}",
                    "kind": "driven",
                    "max_DI": values,
                    "max_accumulated_DI": values,
                    "max_shear_limit_DI": values,
                }
            )
            for number in range(len(walls))
            for run, values in cycles.items()
        ]
    ).to_csv(of_study / "cycles.csv", index=False)
    return folder / "combinations"


@pytest.fixture
def design(tmp_path):
    return partial(write_design, tmp_path)


@pytest.fixture(scope="module")
def commanded(tmp_path_factory):
    """The command on a design spoilt `by_choices`: its folder, the combinations that it judged, and
    what it wrote."""
    folder, judged, out = (
        write_design(tmp_path_factory.mktemp("design"), by_choices),
        [],
        io.StringIO(),
    )
    with pytest.MonkeyPatch.context() as patch, redirect_stdout(out):
        patch.setattr(
            combinations,
            "judge_combinations",
            lambda folder: judged.append(judge_combinations(folder)) or judged[0],
        )
        assert main(["combinations", str(folder)]) == 0
    return SimpleNamespace(folder=folder, found=judged[0], printed=out.getvalue())


def test_effects_of_a_full_factorial_by_hand():
    """Met by 3 of 4: a or b.  Means 1/2 and 1 at the levels of each; the variance is 3/16, of which
    each has 1/16."""
    levels = np.array([[-1, -1], [-1, 1], [1, -1], [1, 1]])
    differences, alone, pairs = effects([False, True, True, True], levels)
    assert differences == pytest.approx([0.5, 0.5]) and (alone, pairs) == pytest.approx(
        (2 / 3, 1.0)
    )
    # an interaction alone
    assert effects([True, False, False, True], levels)[1:] == pytest.approx((0.0, 1.0))
    assert is_orthogonal(levels, with_pairs=True) and not is_orthogonal(levels[:3])
    # a choice with one level only has no effect
    single = np.column_stack([levels, -np.ones(4, int)])
    differences, alone, pairs = effects([False, True, True, True], single)
    assert differences == pytest.approx([0.5, 0.5, np.nan], nan_ok=True) and (
        alone,
        pairs,
    ) == pytest.approx((2 / 3, 1))


def test_the_design_is_a_half_fraction_of_resolution_five():
    """16 different walls, I = ABCDE: the product of the five signs is the same in all."""
    walls = [levels_of(row) for row in WALLS]
    *of_walls, _ = (list(known) for _, known in CHOICES.values())
    column = np.array(
        [[2 * known.index(level) - 1 for known, level in zip(of_walls, wall)] for wall in walls]
    )
    assert len(set(walls)) == 16 and len(set(column.prod(axis=1))) == 1
    both = np.vstack([np.column_stack([column, np.full(16, cycles)]) for cycles in (-1, 1)])
    assert is_orthogonal(both, with_pairs=True)
    study = load_study(REPOSITORY / "studies" / "combinations.toml", "reference", REPOSITORY)
    assert len(study.runs) == 16 * (30 + 2 + 4 + 4 + 8) + 32


def at(table, period, amplitude=0.1, cycles=(2, 3)):
    """Rows of the symmetric wall's harmonic motions, as a mask."""
    return (
        (table["wall"] == "symmetric")
        & (table["motion_period_s"] == period)
        & table["cycles"].isin(cycles)
        & (table["amplitude_g"] == amplitude)
    )


def by_choices(table, levels):
    """P9d differs by an interaction of load and top, P10d with 2 cycles, P3 with less mass, P4 with
    points at the ends by displacement alone."""
    contacts, load, top, _, mass = levels
    if contacts == "corners":
        table.loc[at(table, 0.33, 0.025), "max_DI"] = 0.5
    if (load == "piers") != (top == "uniform"):
        table.loc[at(table, 0.33), [f"max_{kind}DI" for kind in KINDS]] = 0.2
    table.loc[at(table, 0.2, cycles=[2]), [f"max_{kind}DI_drift" for kind in KINDS]] = 0.0
    if mass:
        table.loc[table["wall"] == "solid", [f"max_{kind}DI" for kind in KINDS]] = 0.3


def test_claims_depend_on_the_choices_that_decide_them(commanded):
    found = commanded.found
    levels, names = signs(found), list(CHOICES)
    table = pd.read_csv(commanded.folder / "tables" / "summary.csv")
    assert len(found) == 32 and is_orthogonal(levels)
    assert frozenset.union(*(one.runs for one in found)) == set(
        table.loc[~table["wall"].str.startswith("squat"), "run"]
    )
    claims = {
        claim.id: np.array([one.holds(claim.id) for one in found])
        for claim in judged_by_some(found)
    }
    for claim, choice in (("P10d", "cycles"), ("P3", "mass")):
        differences, alone, _ = effects(claims[claim], levels)
        assert alone == pytest.approx(1.0), claim
        assert differences == pytest.approx([-float(name == choice) for name in names]), claim
    differences, alone, pairs = effects(claims["P9d"], levels)
    assert (alone, pairs) == pytest.approx((0.0, 1.0)) and differences == pytest.approx(0.0)
    assert claims["P4"].all()
    rows = {line.split(",")[0].removeprefix("| "): line for line in table_of_effects(found)[2:]}
    assert {"P10d", "P3", "P9d"} <= rows.keys() and "P4" not in rows
    assert rows["P3"].split(" | ")[1:] == [
        "50%",
        "0",
        "0",
        "0",
        "0",
        "**-100**",
        "0",
        "100%",
        "100% |",
    ]


def test_the_best_combination_is_the_one_that_spoils_nothing(commanded):
    """The default meets all; P4 by one criterion fewer at the joints' ends."""
    found = commanded.found
    first, *_ = best(found)
    assert first.levels == ("interior", "length", "piers", "elastic", "", 3)
    assert len(first.met()) == max(len(one.met()) for one in found) == len(judged_by_some(found))
    default = "| inside | length | piers | all courses | 1 | 3 | 0.200 | holds |"
    assert [line.startswith(default) for line in table_of_best(found)].index(True) == 2
    assert sum(line.startswith(default) for line in table_of_best(found)) == 1
