"""The verdict on the paper, on made-up tables: a world in which all holds, and one change at a
time."""

import json

import numpy as np
import pandas as pd
import pytest

from damage.applications.studies.tables import points_of
from damage.index import COMPONENTS
from paper.__main__ import main
from paper.criteria import AMPLITUDES_G, CLAIMS, CYCLE_LENGTHS_S, PERIODS_S, SCALES
from paper.readings import judge_readings
from paper.report import STATEMENTS
from paper.verdict import DIFFERS, HOLDS, JUDGES, UNJUDGED, judge
from scripts.documents import judge_tables
from scripts.keep_tables import keep

EIGEN_S = {"solid": 0.06, "symmetric": 0.2, "asymmetric": 0.2}
MAX_DI = {
    0.06: (0.003, 0.01, 0.02, 0.03, 0.04),
    0.2: (0.03, 0.06, 0.30, 0.33, 0.36),
    0.33: (0.013, 0.02, 0.065, 0.0975, 0.13),
    1.0: (0.01, 0.025, 0.05, 0.075, 0.10),
}
RESIDUAL_DI = {0.2: (0.0, 0.01, 0.10, 0.12, 0.15)}
RESIDUAL_DRIFT = {0.2: (0.0, 0.0, 0.005, 0.006, 0.02)}
NOTHING = (0.0,) * 5


def index_columns(kind, di, di_drift=0.0, di_open=0.0, di_slip=0.0):
    """The eight columns of the index, the same with both slip criteria."""
    values = dict(zip(COMPONENTS, (di, di_drift, di_open, di_slip)))
    return {
        f"{kind}{infix}_{name}": value
        for infix in ("", "_accumulated", "_shear_limit")
        for name, value in values.items()
    }


def row(run, wall, lintel="elastic", **columns):
    return {
        "run": run,
        "wall": wall,
        "solver": "reference",
        "motion": run,
        "status": "complete",
        "collapsed_at_s": np.nan,
        "lintel": lintel,
        "top": "piers",
        "cells": 2,
        "contacts": "interior",
        "strength_cov": 0.0,
        "beta_s": 0.0,
        "time_step_s": 3e-5,
        "shocks": 1,
        "input_energy_j": 10.0,
        "damping_energy_j": 0.0,
        "energy_error_fraction": 0.001,
        "peak_force_n": np.nan,
        "cycles": np.nan,
        "eigen_period_s": EIGEN_S.get(wall, 0.05),
        "motion_period_s": np.nan,
        "amplitude_g": np.nan,
        "scale": np.nan,
        **columns,
    }


def harmonic_row(wall, period, number, cycles=3, **columns):
    amplitude, resonant = AMPLITUDES_G[number], period == 0.2
    di = 0.3 * amplitude if wall == "solid" else MAX_DI[period][number]
    drift = (0.0, 0.0, 0.05, 0.07, 0.09)[number] if resonant else 0.0
    return row(
        f"{wall}-{period:g}-{amplitude:g}-{cycles}",
        wall,
        motion_period_s=period,
        amplitude_g=amplitude,
        cycles=cycles,
        last_cycle_s=CYCLE_LENGTHS_S[number],
        first_free_cycle_s=CYCLE_LENGTHS_S[number],
        **index_columns("max", di, drift, 0.1, 0.1),
        **index_columns(
            "residual",
            RESIDUAL_DI.get(period, NOTHING)[number],
            RESIDUAL_DRIFT.get(period, NOTHING)[number],
        ),
        **columns,
    )


def recorded_row(record, scale):
    share = np.interp(scale, SCALES, (0.05, 0.09, 0.2, 0.35, 0.5, 0.65, 0.8, 1.0))
    return row(
        f"{record}-{scale:g}",
        "symmetric",
        motion=f"{record}_x{scale:g}",
        scale=scale,
        max_drift_ratio=1e-3 * share,
        **index_columns("max", 0.2 * share),
        **index_columns("residual", 0.11 * (1 - (1 - share) ** 2), 0.001),
    )


def world_of_the_paper():
    """The table of a study in which every claim holds."""
    rows = [
        harmonic_row(wall, period, number)
        for wall in EIGEN_S
        for period in PERIODS_S
        for number in range(5)
    ]
    rows += [harmonic_row("symmetric", 0.2, number, cycles=2) for number in range(5)]
    rows += [
        recorded_row(record, scale)
        for record in ("BGAR_HGE", "MID1_N_synthetic")
        for scale in SCALES
    ]
    rows.append(
        row(
            "squat",
            "squat",
            motion="cyclic_0.1pct_1x_cantilever",
            secant_stiffness_n_per_m=150e6,
            peak_force_n=77e3,
            speed_m_s=0.002,
        )
    )
    return pd.DataFrame(rows)


@pytest.fixture
def papers_world():
    return world_of_the_paper()


CYCLES = {
    "symmetric-0.33-0.1-3": (0.13, 0.13, 0.13),
    "symmetric-0.2-0.025-3": (0.02, 0.04, 0.06),
    "symmetric-0.2-0.1-3": (0.10, 0.20, 0.36),
}


@pytest.fixture
def judged(tmp_path, monkeypatch):
    """Write a table and cycles as a study does; judge all claims, or one alone: {(claim, lintel,
    slip): Finding}."""

    def write_and_judge(table, cycles=CYCLES, alone=None):
        if alone:
            monkeypatch.setattr(
                "paper.verdict.CLAIMS", [claim for claim in CLAIMS if claim.id == alone]
            )
        folder = tmp_path / "study" / "tables"
        folder.mkdir(parents=True, exist_ok=True)
        table.to_csv(folder / "summary.csv", index=False)
        for run, values in cycles.items():
            pd.DataFrame(
                {
                    "kind": "driven",
                    "max_DI": values,
                    "max_accumulated_DI": values,
                    "max_shear_limit_DI": values,
                }
            ).to_csv(folder / f"{run}_cycles.csv", index=False)
        findings = judge(tmp_path)
        return {
            (finding.claim.id, finding.lintel, finding.slip): finding
            for finding in findings
            if not finding.model
        }

    return write_and_judge


def usual(findings, claim):
    return findings[claim, "elastic", "displacement"].verdict


def where(table, wall="symmetric", period=None, amplitude=None, cycles=3, scale=None, record=""):
    """Rows of a table, as a mask."""
    mask = (table["wall"] == wall) & table["motion"].str.startswith(record)
    for name, value in (("motion_period_s", period), ("amplitude_g", amplitude), ("scale", scale)):
        mask &= True if value is None else table[name] == value
    return mask & ((table["cycles"] == cycles) | table["cycles"].isna())


def test_every_claim_has_its_judge_and_every_statement_its_claims():
    assert [claim.id for claim in CLAIMS] == list(dict.fromkeys(claim.id for claim in CLAIMS))
    assert set(JUDGES) == {claim.id for claim in CLAIMS}
    assert (
        list(dict.fromkeys(claim.statement for claim in CLAIMS))
        == [f"P{n}" for n in range(1, 18)]
        == list(STATEMENTS)
    )


def test_all_holds_in_the_papers_world(papers_world, judged):
    findings = judged(papers_world)
    for claim in CLAIMS:
        expected = UNJUDGED if claim.id in ("P17c", "P17d") else HOLDS
        for slip in ("displacement", "shear-limit"):
            finding = findings[claim.id, "elastic", slip]
            assert finding.verdict == expected, (claim.id, finding.value)


# Claim, rows, column, value that makes the claim differ; or a run and its cycles.
CONTRADICTIONS = [
    ("P1", {"wall": "solid"}, "eigen_period_s", 0.067),
    ("P2a", {}, "eigen_period_s", 0.221),
    ("P2b", {"wall": "asymmetric"}, "eigen_period_s", 0.175),
    ("P3", {"wall": "solid", "period": 0.33, "amplitude": 0.05}, "max_DI", 0.051),
    ("P4", {"period": 0.33, "amplitude": 0.025}, "max_DI", 0.021),
    ("P7", {"wall": "asymmetric", "period": 0.2, "amplitude": 0.1}, "max_DI", 0.17),
    ("P8", {"period": 0.06, "amplitude": 0.075}, "max_DI", 0.051),
    ("P9a", {"period": 0.33, "amplitude": 0.1}, "max_DI", 0.45),
    ("P9b", {"period": 1.0, "amplitude": 0.05}, "max_DI", 0.0),
    ("P9c", {"period": 0.33, "amplitude": 0.075}, "max_DI", 0.4),
    ("P9d", {"period": 0.33, "amplitude": 0.1}, "max_DI", 0.165),
    ("P9e", {"period": 1.0, "amplitude": 0.1}, "max_DI", 0.06),
    ("P9f", {"period": 1.0, "amplitude": 0.01}, "residual_DI", 0.021),
    ("P10a", {"period": 0.33, "amplitude": 0.075}, "max_DI", 0.25),
    ("P10b", {"period": 0.2, "amplitude": 0.1}, "max_DI_open", 0.15),
    ("P10c", {"period": 0.2, "amplitude": 0.05}, "max_DI_slip", 0.07),
    ("P10d", {"period": 0.2, "amplitude": 0.1}, "max_DI_drift", 0.07),
    ("P11a", {"period": 0.06, "amplitude": 0.05}, "residual_DI", 0.021),
    ("P11b", {"period": 0.2, "amplitude": 0.075}, "residual_DI_drift", 0.04),
    ("P11c", {"period": 0.2, "amplitude": 0.1}, "residual_DI_drift", 0.009),
    ("P12a", {"period": 0.2, "amplitude": 0.1}, "last_cycle_s", 0.30),
    ("P12b", {"period": 0.2, "amplitude": 0.05}, "first_free_cycle_s", 0.19),
    ("P12c", {"period": 0.2, "amplitude": 0.1, "cycles": 2}, "first_free_cycle_s", 0.3),
    ("P12d", {"period": 0.2, "amplitude": 0.1}, "last_cycle_s", 0.345),
    ("P12e", {"period": 0.2, "amplitude": 0.01}, "first_free_cycle_s", 0.221),
    ("P12f", {"period": 0.2, "amplitude": 0.075, "cycles": 2}, "first_free_cycle_s", 0.36),
    ("P14a", {"record": "MID1", "scale": 0.75}, "residual_DI", 0.021),
    ("P14b", {"record": "MID1", "scale": 2.0}, "residual_DI", 0.15),
    ("P14c", {"record": "MID1", "scale": 1.4}, "residual_DI_drift", 0.011),
    ("P14d", {"record": "BGAR", "scale": 2.0}, "residual_DI", 0.01),
    ("P15a", {"record": "BGAR", "scale": 2.0}, "max_DI", 0.05),
    ("P15b", {"record": "MID1", "scale": 2.0}, "residual_DI", 0.9),
    ("P16", {"period": 1.0, "amplitude": 0.1}, "damping_energy_j", 0.01),
    ("P16", {"period": 1.0, "amplitude": 0.1}, "energy_error_fraction", 0.03),
    ("P17a", {"wall": "squat"}, "secant_stiffness_n_per_m", 110e6),
    ("P17b", {"wall": "squat"}, "peak_force_n", 90e3),
    ("P5", "symmetric-0.33-0.1-3", "cycles", (0.08, 0.22, 0.34)),
    ("P6a", "symmetric-0.2-0.025-3", "cycles", (0.02, 0.04, 0.04)),
    ("P6b", "symmetric-0.2-0.1-3", "cycles", (0.10, 0.20, 0.19)),
]


@pytest.mark.parametrize(
    ("claim", "rows", "column", "value"),
    CONTRADICTIONS,
    ids=[f"{claim}-{column}" for claim, _, column, _ in CONTRADICTIONS],
)
def test_one_contradiction_and_the_claim_differs(papers_world, judged, claim, rows, column, value):
    cycles = CYCLES
    if column == "cycles":
        cycles = CYCLES | {rows: value}
    else:
        mask = where(papers_world, **rows)
        assert mask.any()
        papers_world.loc[mask, column] = value
    findings = judged(papers_world, cycles, alone=claim)
    assert usual(findings, claim) == DIFFERS, findings[claim, "elastic", "displacement"].value


def test_cycles_of_an_ensemble_are_their_medians(papers_world, judged):
    """The first member and the mean contradict; one member has no table."""
    [first] = papers_world.loc[where(papers_world, period=0.33, amplitude=0.1), "run"]
    cycles = {first: (0.10, 0.10, 0.30), "second": (0.13, 0.13, 0.13), "third": (0.14, 0.14, 0.10)}
    members = [
        papers_world[papers_world["run"] == first].assign(run=name)
        for name in ("second", "third", "without-a-table")
    ]
    finding = judged(pd.concat([papers_world, *members]), {**CYCLES, **cycles})[
        "P5", "elastic", "displacement"
    ]
    assert (finding.verdict, finding.value) == (HOLDS, "0.130, 0.130, 0.130")


def test_kept_tables_say_what_the_runs_said(papers_world, judged, tmp_path):
    """Medians of three members each, with ranges and numbers of runs; two of one point's members
    fell."""
    numbers = [name for name in papers_world if name.startswith(("max_", "residual_", "energy_"))]
    members, cycles = [], {}
    for seed, factor in enumerate((0.96, 1.0, 1.05)):
        member = papers_world.assign(
            point=papers_world["run"], run=papers_world["run"] + f"_s{seed}"
        )
        member[numbers] *= factor
        member.loc[(member["point"] == "solid-0.06-0.1-3") & (seed > 0), "collapsed_at_s"] = 0.5
        members.append(member)
        cycles |= {f"{run}_s{seed}": factor * np.array(of) for run, of in CYCLES.items()}
    world = pd.concat(members, ignore_index=True)
    of_runs = judged(world, cycles)
    points_of(world).to_csv(tmp_path / "study" / "tables" / "points.csv", index=False)
    (tmp_path / "kept").mkdir()
    keep(tmp_path / "study", "study", tmp_path / "kept")
    kept = judge_tables(tmp_path / "kept")
    assert {(one.claim.id, one.lintel, one.slip): (one.value, one.verdict) for one in kept} == {
        key: (one.value, one.verdict) for key, one in of_runs.items()
    }
    assert any("fell" in one.value for one in kept)


def test_a_claim_whose_runs_are_missing_cannot_be_judged(papers_world, judged):
    """Only one motion that tries nothing hard is left."""
    left = papers_world[where(papers_world, period=1.0, amplitude=0.01)]
    findings = judged(left, {})
    decided = {claim.id for claim in CLAIMS if usual(findings, claim.id) != UNJUDGED}
    assert decided == {"P2a", "P13a", "P13b", "P13c", "P13d", "P16"}


def test_a_contradiction_decides_even_where_the_hardest_motion_is_missing(papers_world, judged):
    table = papers_world[~where(papers_world, wall="solid", amplitude=0.1)]
    assert usual(judged(table), "P3") == UNJUDGED
    table.loc[where(table, wall="solid", period=0.06, amplitude=0.075), "max_DI"] = 0.06
    assert usual(judged(table), "P3") == DIFFERS


def test_a_wall_that_fell_differs(papers_world, judged):
    mask = where(papers_world, period=0.33, amplitude=0.025)
    papers_world.loc[mask, "collapsed_at_s"] = 0.23
    findings = judged(papers_world, alone="P4")
    assert usual(findings, "P4") == DIFFERS
    assert findings["P4", "elastic", "displacement"].value == "fell at 0.23 s (0.33 s, 0.025 g)"


def test_runs_of_another_model_are_left_out(papers_world, judged):
    mask = where(papers_world, period=0.33, amplitude=0.025)
    others = [
        papers_world[mask].assign(run=f"other-{name}", max_DI=0.5, **{name: value})
        for name, value in (
            ("contacts", "corners"),
            ("top", "beam"),
            ("cells", 4),
            ("strength_cov", 0.3),
            ("beta_s", 1e-4),
            ("time_step_s", 1.5e-5),
            ("shocks", 3),
            ("status", "failed"),
            ("eigen_period_s", 0.17),
        )
    ]
    assert (
        judged(pd.concat([papers_world, *others]), alone="P4")[
            "P4", "elastic", "displacement"
        ].value
        == "0.020"
    )


def test_each_reading_is_judged_by_its_own_runs(papers_world, judged, tmp_path, output_of):
    """The default contradicts P4; loads on the piers alone, and a wall of another period, do
    not."""
    piers = papers_world.assign(run="b-" + papers_world["run"], load="piers")
    stiff = papers_world[papers_world["wall"] == "symmetric"]
    stiff = stiff.assign(run="c-" + stiff["run"], eigen_period_s=0.1742, time_step_s=1.5e-5)
    stiff = stiff.assign(load="length")
    contradicts = where(papers_world, period=0.33, amplitude=0.025)
    columns = ["max_DI", "max_accumulated_DI", "max_shear_limit_DI"]
    papers_world.loc[contradicts, columns] = 0.05
    judged(pd.concat([papers_world.assign(load="length"), piers, stiff]))
    found = {
        reading.words: [
            one.verdict for one in findings if (one.claim.id, one.slip) == ("P4", "displacement")
        ]
        for reading, findings in judge_readings(tmp_path).items()
    }
    assert found == {
        "by default": [DIFFERS],
        "0.3 MPa in the piers": [HOLDS],
        "2 cycles": [UNJUDGED],
        "T0 0.175 s": [HOLDS],
    }
    assert "0.3 MPa in the piers: gains P4, P9c; loses nothing." in output_of(
        "readings", tmp_path, of=main
    )


def test_the_command_prints_every_claim(papers_world, judged, tmp_path, output_of):
    judged(papers_world)
    words = ("verdict", tmp_path, "--markdown", tmp_path / "verdict.md", "--json")
    said = json.loads(output_of(*words, of=main))
    assert [one["statement"] for one in said["statements"]] == list(STATEMENTS)
    assert len(said["claims"]) == len(CLAIMS)
    assert (tmp_path / "verdict.md").read_text().count("\n| P") == 17
