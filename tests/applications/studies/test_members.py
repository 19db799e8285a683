"""Members of a single run: how many, what is kept, what is printed; and the digits of what is
printed."""

import json
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from conftest import TINY, contents, run_here, wall_file
from small_history import make_history

from damage.applications.report.run_part import run_part
from damage.applications.studies import members
from damage.applications.studies.spread import (
    member_row,
    members_of,
    members_path,
    spread,
)
from damage.history.reader import read_history
from damage.index import COMPONENTS
from damage.measure.results import KEY
from damage.measure.summary import summarise
from damage.measure.tables import summary_row, write_table
from damage.reference import session
from damage.reference.session import run_reference
from damage.run.options import parse_run
from damage.run.prepare import Backend
from damage.run.report import describe
from damage.run.session import run_session
from damage.start import reported
from damage.units import rounded

SHAKEN = ("--harmonic", "0.05", "0.8", "--cycles", "2", "--rest", "0", "--no-pictures")


@pytest.fixture
def tiny(tmp_path):
    return str(wall_file(tmp_path / "tiny.py", TINY))


def test_members_are_the_runs_with_their_seeds_and_the_first_is_kept(
    tiny, tmp_path, capsys, output_of
):
    out = tmp_path / "run.h5"
    assert (
        run_reference([tiny, *SHAKEN, "--scatter", "0.05", "--members", "3", "--out", str(out)])
        == 0
    )
    printed = capsys.readouterr().out
    table = pd.read_csv(tmp_path / "run_members.csv")
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        "run.h5",
        "run_members.csv",
        "tiny.py",
    ]
    assert (
        table["run"].to_list() == ["run_s1", "run_s2", "run_s3"]
        and (table["scatter"] == 0.05).all()
    )
    for seed in (1, 3):
        row = summary_row(
            run_here(tmp_path / f"{seed}.h5", tiny, *SHAKEN, "--scatter", 0.05, "--seed", seed)
        )
        assert all(table[name][seed - 1] == pytest.approx(row[name], rel=1e-8) for name in KEY)
    assert contents(out) == contents(tmp_path / "1.h5")
    assert (
        f"members: {tmp_path / 'run_members.csv'}" in printed
        and "3 members: median (min to max)" in printed
    )
    drift = table["max_drift_ratio"]
    assert drift.nunique() == 3
    words = " to ".join(rounded(100 * one, 3) for one in (drift.min(), drift.max()))
    assert f"{'drift ratio':22s}{rounded(100 * drift.median(), 3)} ({words}) %" in printed
    assert "residual widest crack " in printed

    found = json.loads(output_of("index", out, "--json"))["members"]
    assert found["count"] == 3 and found["max_drift_ratio"]["median"] == drift.median()
    key = {name: rest for name, *rest in run_part(read_history(out), "A")["key"]}
    assert f"3 members: {rounded(100 * drift.median(), 3)} ({words}) %" in key["drift ratio"][-1]
    # no more digits than on the screen
    assert key["drift ratio"][1] == rounded(key["drift ratio"][0], 3)
    assert key["DI"][1] == f"{key['DI'][0]:.3f}"


def test_an_interruption_keeps_the_members_that_had_ended(tiny, tmp_path, capsys, monkeypatch):
    def made(tasks, name):
        row = summary_row(make_history(tasks[0].history))
        return {1: row, 2: row}, SimpleNamespace(failed=[], interrupted=True)

    monkeypatch.setattr(members, "_made", made)
    out = tmp_path / "run.h5"
    assert run_reference([tiny, *SHAKEN, "--members", "3", "--out", str(out)]) == 130
    printed = capsys.readouterr()
    assert len(pd.read_csv(tmp_path / "run_members.csv")) == 2 and out.is_file()
    assert "interrupted: 2 of 3 members had ended" in printed.err


def test_a_table_of_another_run_is_not_shown(tiny, tmp_path):
    """As where the history is replaced by a single run."""
    out = tmp_path / "run.h5"
    first, second = (
        make_history(tmp_path / name, drift=drift)
        for name, drift in (("run.h5", 1e-3), ("b.h5", 2e-3))
    )
    for one, seed in ((first, 1), (second, 2)):
        one.parameters["seed"] = seed
        one.parameters["scatter"] = 0.001
    write_table(
        pd.DataFrame([member_row(summary_row(one), out) for one in (first, second)]),
        members_path(out),
    )
    table = members_of(first)
    assert table["run"].to_list() == ["run_s1", "run_s2"]
    assert spread(table)["max_drift_ratio"] == {"median": 1.5e-3, "min": 1e-3, "max": 2e-3}
    assert members_of(make_history(out, drift=3e-3, overwrite=True)) is None
    assert members_of(second) is None  # beside which there is none


@pytest.mark.parametrize(
    ("words", "scatter", "seeds"),
    [((), 0.001, [1, 2]), (("--scatter", "0.01", "--seed", "7"), 0.01, [7, 8])],
)
def test_members_have_a_scatter_and_seeds(tiny, words, scatter, seeds):
    words = [*words, "--members", "2", "--settle", "hogging", "--quiet"]
    point = members._point(tiny, parse_run(words, "p", "reference"), words)
    assert [point.settings(number=number).seed for number in (1, 2)] == seeds
    assert point.settings().scatter == scatter and point.settings().members == 1
    assert point.settings().settlement.profile == "hogging"


def test_a_solver_that_runs_one_wall_refuses_members_and_names_the_other(tmp_path, capsys):
    yade = Backend("yade", {}, make=None, code=tmp_path)
    words = ["--members", "3"]
    assert reported(lambda: run_session(yade, tmp_path / "w.py", None, words, "yade w.py")) == 2
    printed = capsys.readouterr().err
    assert (
        "expected the reference solver, python3 -m damage reference WALL.py --members N" in printed
    )
    assert printed.count("\n") == 1


def test_a_member_that_fails_is_named_and_the_others_are_reported(
    tiny, tmp_path, capsys, monkeypatch
):
    def simulate(prepared, *more):
        if prepared.settings.seed == 2:
            raise MemoryError
        return (yield from simulate_as_before(prepared, *more))

    simulate_as_before = session.simulate
    monkeypatch.setattr(session, "simulate", simulate)
    assert run_reference([tiny, *SHAKEN, "--members", "3", "--out", str(tmp_path / "run.h5")]) == 1
    printed = capsys.readouterr()
    assert "error: member of seed 2 (error: members_reference_s2: out of memory" in printed.err
    assert "2 of 3 members ended: median and range are of these" in printed.out
    assert pd.read_csv(tmp_path / "run_members.csv")["run"].to_list() == ["run_s1", "run_s3"]


def test_the_screen_shows_no_more_digits_than_are_known(tmp_path):
    """A scatter of the strengths by 0.1 % changes the third digit; the JSON has all of
    them."""
    ramp = np.linspace(0, 1, 21)
    history = make_history(
        tmp_path / "a.h5",
        drift=1.23456e-3 * ramp,
        opening={2: 1.0037e-2 * ramp},
        offset={3: 1.23456e-3 * ramp},
        slip={3: 2.34567e-3 * ramp},
    )
    summary = summarise(history)
    assert summary["max_opening_mm"] == pytest.approx(10.037, rel=1e-6)
    lines = {line[:22].strip(): line[22:] for line in describe(summary).splitlines()[3:]}
    shown = {label: line.split()[0] for label, line in lines.items()}
    assert shown["drift ratio"] == "0.123" and shown["opening"] == "10"
    assert (shown["offset"], shown["accumulated slip"]) == ("1.2", "2.3")
    assert all(len(shown[name].split(".")[1]) == 3 for name in COMPONENTS)
