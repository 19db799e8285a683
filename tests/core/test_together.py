"""Runs that advance together write the same histories as alone, whatever the others do."""

from collections import OrderedDict
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from conftest import TINY, contents, wall_file, without_progress

from damage import read_history
from damage.mechanics.tables import HAS_FAILED
from damage.reference import ensembles, lanes, rest_cache, session
from damage.reference.rest_cache import Rest
from damage.reference.session import run_reference, run_references
from damage.run.run import LOOK_STEPS

SHAKEN = "--harmonic 0.05 0.8 --cycles 2 --rest 0 --strength-cov 0.3 --inputs typical"
OTHERS = {
    3: "--harmonic 0.2 2 --strength-cov 0.3",  # falls
    4: f"{SHAKEN} --rest 0.02 --sequence 1,0.5",  # takes longer
    5: f"{SHAKEN} --scatter 0.01",
    6: f"{SHAKEN} --cells 3",
}  # cannot be in a batch with the others


@pytest.fixture
def tiny(tmp_path):
    return wall_file(tmp_path / "tiny.py", TINY)


def line(wall, folder, k, words):
    """The words of the run of member k."""
    return f"{wall} {words} --strength-seed {k} --out {folder}/m{k}.h5 --no-pictures".split()


def lines(wall, folder, count=8):
    """{name: words} of so many runs."""
    folder.mkdir()
    return {f"m{k}": line(wall, folder, k, OTHERS.get(k, SHAKEN)) for k in range(1, count + 1)}


@pytest.fixture(scope="module")
def alone(tmp_path_factory):
    """Contents of the histories of runs by themselves."""
    folder = tmp_path_factory.mktemp("alone")
    for words in lines(wall_file(folder / "tiny.py", TINY), folder / "runs").values():
        assert run_reference(words) == 0
    return {path.stem: contents(path) for path in (folder / "runs").glob("*.h5")}


@pytest.fixture
def moved(monkeypatch):
    """[{wall's step: numbers of steps}] of all that are moved together."""
    found = []
    monkeypatch.setattr(
        ensembles,
        "advance_together",
        lambda asked: (
            found.append([(wall.step, *steps) for wall, steps in asked])
            or lanes.advance_together(asked)
        ),
    )
    return found


def test_every_member_writes_the_same_bits_as_alone(tiny, alone, tmp_path, moved):
    """Whatever the others are, wherever they stop, and when they begin: the ninth where one has
    ended.  The share that is simulated only grows, the static stage is a part of it."""
    asked = lines(tiny, tmp_path / "together", 10)
    shares = {}
    watch = lambda name, share: shares.setdefault(name, []).append(share)  # noqa: E731
    ended = list(run_references(asked.items(), watch=watch))
    assert sorted(ended) == sorted(dict.fromkeys(asked, 0).items())
    assert {8, 1} <= set(map(len, moved))
    assert any(len({step for step, *_ in group}) > 1 for group in moved)  # one of them began later
    histories = {name: read_history(tmp_path / "together" / f"{name}.h5") for name in alone}
    assert all(contents(history.path) == alone[name] for name, history in histories.items())
    assert histories["m3"].collapsed_at_s is not None and histories["m1"].broken.any()
    assert len({history.series["time_s"].iloc[-1] for history in histories.values()}) >= 3
    for seen in (shares["m1"], shares["m2"]):
        assert seen == sorted(seen) and seen[0] < 0.1 and seen[-1] == 1.0 and len(seen) > 5


def test_walls_that_the_cache_can_no_longer_hold_together_go_on_one_by_one(
    tiny, alone, tmp_path, moved, monkeypatch
):
    def have_failed(walls, _room):
        return any((wall.system.limits[:, HAS_FAILED] > 0).any() for wall in walls)

    monkeypatch.setattr(ensembles, "exceeds", have_failed)
    asked = lines(tiny, tmp_path / "together")
    assert dict(run_references(asked.items())) == dict.fromkeys(asked, 0)
    assert len(moved[0]) > 5 and len(moved[-1]) == 1
    assert alone == {name: contents(tmp_path / "together" / f"{name}.h5") for name in alone}


def test_walls_at_rest_are_found_again_by_runs_that_begin_alike(tiny, tmp_path, moved):
    """The next point of a study begins so: the same joints, another motion.  The first run lays out
    a wall of its own, the others share parts of its layout."""
    wall_file(tiny, TINY.replace("0.6", "0.675"))
    walls = OrderedDict()

    def run(folder, numbers, words=""):
        (tmp_path / folder).mkdir()
        asked = {f"m{k}": line(tiny, tmp_path / folder, k, f"{SHAKEN} {words}") for k in numbers}
        moved.clear()
        assert dict(run_references(asked.items(), None, walls)) == dict.fromkeys(asked, 0)
        resting = sum(steps == [LOOK_STEPS] for group in moved for _, *steps in group)
        return {name: contents(tmp_path / folder / f"{name}.h5") for name in asked}, resting

    first, resting = run("first", range(1, 8))
    assert resting > 10
    again, none = run("again", range(1, 8), "--harmonic 0.05 0.7")
    assert none == 0 and again != first
    # the last one's wall is not there
    some, of_one = run("some", range(2, 9), "--harmonic 0.05 0.7")
    assert 10 < of_one < resting / 2
    for name in list(some)[:-1]:
        assert some[name] == again[name]
    assert run("others", range(1, 8), "--scatter 0.01")[1] > 10


def test_settled_walls_that_take_too_much_room_go_the_oldest_first(monkeypatch):
    monkeypatch.setattr(rest_cache, "MOST_BYTES", 32)
    monkeypatch.setattr(rest_cache, "digest_of", lambda name: name)
    kept = OrderedDict()
    solver = SimpleNamespace(
        checkpoint=lambda: {"place": np.zeros(1), "velocity": np.zeros(1)},
        restore=lambda tables: None,
    )
    for name in "abc":
        Rest(kept, name).keep(solver, [])
    assert list(kept) == ["b", "c"]
    assert Rest(kept, "b").recall(solver) == () and Rest(kept, "a").recall(solver) is None
    Rest(kept, "d").keep(solver, [])
    assert list(kept) == ["b", "d"]


def test_one_that_fails_is_named_and_disturbs_no_other(tiny, alone, tmp_path, monkeypatch, capsys):
    def simulate(prepared, *more):
        changed = {
            "m7": {"time_step": 20 * prepared.time_step},
            "m8": {"backend": replace(prepared.backend, make=make_none)},
        }
        return simulate_as_before(
            replace(prepared, **changed.get(prepared.writer.path.stem, {})), *more
        )

    def make_none(layout, time_step, _settings):
        raise MemoryError

    simulate_as_before = session.simulate
    monkeypatch.setattr(session, "simulate", simulate)
    monkeypatch.setattr(ensembles, "LEAST_LANES", 2)
    asked = lines(tiny, tmp_path / "together")
    asked["m2"] += ["--dt", "0.1"]
    ended = dict(run_references(asked.items()))
    assert ended == dict.fromkeys(asked, 0) | {"m2": 2, "m7": 1, "m8": 1}
    messages = without_progress(capsys.readouterr().err).splitlines()
    assert sorted(line[:24] for line in messages) == [
        "error: m2: --dt 0.1 s is",
        "error: m7: the run blew ",
        "error: m8: out of memory",
    ]
    assert {read_history(tmp_path / "together" / f"{name}.h5").status for name in ("m7", "m8")} == {
        "failed"
    }
    for name in alone.keys() - {"m2", "m7", "m8"}:
        assert contents(tmp_path / "together" / f"{name}.h5") == alone[name]


@pytest.mark.parametrize("fewest", [6, 9])
def test_an_error_of_steps_ends_those_that_took_them_together(
    fewest, tiny, alone, tmp_path, monkeypatch, capsys
):
    together_with = {"m2"}

    def advance_together(asked):
        if any(wall.layout.options.strength_seed == 2 and wall.step > 3000 for wall, _ in asked):
            together_with.update(f"m{wall.layout.options.strength_seed}" for wall, _ in asked)
            raise MemoryError
        return lanes.advance_together(asked)

    monkeypatch.setattr(ensembles, "advance_together", advance_together)
    monkeypatch.setattr(ensembles, "LEAST_LANES", fewest)
    ended = dict(run_references(lines(tiny, tmp_path / "together").items()))
    assert (len(together_with) > 5) == (fewest == 6)
    assert ended == {name: int(name in together_with) for name in ended}
    messages = without_progress(capsys.readouterr().err).splitlines()
    assert sorted(line[:24] for line in messages) == [
        f"error: {name}: out of memory" for name in sorted(together_with)
    ]
    for name in ended:
        history = tmp_path / "together" / f"{name}.h5"
        assert (
            read_history(history).status == "failed"
            if name in together_with
            else contents(history) == alone[name]
        )
