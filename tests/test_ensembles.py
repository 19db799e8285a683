"""Grids and ensembles of studies: what a file asks for, whole batches of the reference solver, their tables."""

import hashlib
import json
import os
import subprocess
import sys
import time
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from conftest import BATCH, BATCH_ENVIRONMENT, REPOSITORY
from numpy.testing import assert_allclose
from small_history import make_history

from benchmarks.resume import kill_tree
from damage.errors import InputError
from damage.history.reader import read_history
from damage.measure.tables import summary_row
from damage.studies.definition import StudyRun, load_study
from damage.studies.grid import expand
from damage.studies.members import runs_needed
from damage.studies.tables import points_of, read_study_table

SINE = 'options = { harmonic = [0.2, 0.05] }\n'
WALL = 'wall = "walls/symmetric.py"\n'
BGAR = "damage/data/zeerijp_20180108/BGAR_HGE_acc_m_s2.csv"


def write_study(folder, text):
    path = folder / "study.toml"
    path.write_text(f'name = "s"\npictures = "none"\n{text}')
    return path


class TestGrid:
    def test_every_combination_the_last_name_fastest(self):
        grid = {"wall": "{w}.py", "options": {"harmonic": ["{t}", 0.1], "x": "a{t}"}, "vary": {"w": ["a", "b"],
                                                                                          "t": [1, 2.5]}}
        tables = expand(grid, "here")
        assert [(one["wall"], one["options"]["harmonic"]) for one in tables] == [
            ("a.py", [1, 0.1]), ("a.py", [2.5, 0.1]), ("b.py", [1, 0.1]), ("b.py", [2.5, 0.1])]
        assert tables[1]["options"]["x"] == "a2.5" and "vary" not in tables[0]

    def test_a_range_stands_for_whole_numbers_and_any_value_for_a_name_alone(self):
        assert [one["a"] for one in expand({"a": "{n}", "vary": {"n": {"from": 3, "to": 5}}}, "")] == [3, 4, 5]
        assert [one["a"] for one in expand({"a": "{n}", "vary": {"n": [False, [1, 2]]}}, "")] == [False, [1, 2]]

    def test_rows_of_a_file_go_with_every_value_of_vary(self, tmp_path):
        (tmp_path / "list.csv").write_text(f"record,start,end,scale\n{BGAR},18,19,2\n{BGAR},18.5,20,0.5\n\n")
        study = load_study(write_study(tmp_path, (
            '[[grid]]\nwall = "walls/{wall}.py"\nrows = "list.csv"\nvary = { wall = ["solid", "symmetric"] }\n'
            'options = { record = "{record}", window = ["{start}", "{end}"], scale = "{scale}" }\n')), "reference")
        assert [(run.wall, *run.words[3:]) for run in study.runs] == [
            (f"walls/{wall}.py", "18" if scale == "2" else "18.5", end, "--scale", scale)
            for end, scale in (("19", "2"), ("20", "0.5")) for wall in ("solid", "symmetric")]

    @pytest.mark.parametrize(("table", "vary", "message"), [
        (None, "", "no file list.csv"),
        ("", "", "has no rows"),
        ("a\n", "", "has no rows"),
        ("a,b\n1,2\n", "", "'b', which nothing uses"),
        ("b\n1\n", "", "'b', which nothing uses"),
        ("a\n1\n2,3\n", "", "row 2 of"),
        ("a,a\n1,2\n", "", "a column 'a'"),
        ("1a\n1\n", "", "a column '1a'"),
        ("a,b\n1,\n", "", "or an empty one"),
        ("a\n1\n", "vary = { a = [1] }\n", "both name 'a'"),
        ("a\nnan\n", "", "rest"),
        (b"a\n\xff\n", "", "no table of text"),
    ], ids=str)
    def test_bad_rows_are_refused_in_one_line(self, tmp_path, table, vary, message):
        if table is not None:
            (tmp_path / "list.csv").write_bytes(table if isinstance(table, bytes) else table.encode())
        grid = f'[[grid]]\n{WALL}rows = "list.csv"\n{vary}options = {{ harmonic = [0.2, 0.05], rest = "{{a}}" }}\n'
        with pytest.raises(InputError) as caught:
            load_study(write_study(tmp_path, grid), "reference")
        assert message in str(caught.value) and "\n" not in str(caught.value)

    @pytest.mark.parametrize(("text", "message"), [
        (f'[[grid]]\n{WALL}{SINE}', "grid 1: vary = None"),
        (f'[[grid]]\n{WALL}{SINE}rows = 3', "rows = 3"),
        (f'[[grid]]\n{WALL}{SINE}vary = {{ a = [] }}', "vary holds a = []"),
        (f'[[grid]]\n{WALL}{SINE}vary = {{ a = [1] }}', "vary names 'a', which nothing uses"),
        ('[[grid]]\nwall = "{b}"\noptions = { rest = "{a}" }\nvary = { a = [1] }', "names 'b'"),
        (f'[[grid]]\n{WALL}{SINE}vary = 1\nmembres = 3', "grid 1: unknown key 'membres'"),
        (f'grid = 3\n[[runs]]\n{WALL}{SINE}', "grid is no list of tables"),
        (f'[[runs]]\n{WALL}{SINE}members = 0', "members = 0"),
        (f'[[runs]]\n{WALL}{SINE}members = true', "members = True"),
        (f'[[runs]]\n{WALL}{SINE}perturb = 1e-9', "perturb without members"),
        (f'[[runs]]\n{WALL}{SINE}perturb = -1\nmembers = 2', "perturb = -1"),
        (f'[[runs]]\n{WALL}{SINE}perturb = 1e-9\nscatter = 0.1\nmembers = 2', "expected one kind"),
        (f'[[runs]]\n{WALL}{SINE}samples = 2\nmembers = 2', "expected one kind"),
        (f'[[runs]]\n{WALL}{SINE}samples = 2', "strengths do not scatter"),
        (f'[[runs]]\n{WALL}options = {{ seed = 3 }}\nmembers = 2', "--seed is set by members"),
        (f'[[runs]]\n{WALL}{SINE}solvers = ["udec"]', "solvers = ['udec']"),
        (f'[[runs]]\n{WALL}{SINE}solvers = ["yade"]', "expected --solver yade"),
        (f'[[runs]]\n{WALL}options = {{ record = ["no.csv", "nor.csv"] }}', "none of the files"),
        (f'pictures = "some"\n[[runs]]\n{WALL}{SINE}', "TOML"),
    ], ids=str)
    def test_a_bad_grid_or_ensemble_is_refused_in_one_line(self, tmp_path, text, message):
        with pytest.raises(InputError) as caught:
            load_study(write_study(tmp_path, text), "reference")
        assert message in str(caught.value) and "\n" not in str(caught.value)

    def test_the_first_file_that_is_there_counts(self, tmp_path):
        path = write_study(tmp_path, f'[[runs]]\n{WALL}options = {{ record = ["own.csv", "{BGAR}"] }}\n')
        assert load_study(path).runs[0].words == ("--record", BGAR)
        (tmp_path / "own.csv").write_text("time_s,acc_g\n0,0\n0.01,1\n0.02,0\n")
        assert load_study(path).runs[0].words == ("--record", str(tmp_path / "own.csv"))


class TestShipped:
    def test_harmonic_is_the_papers_matrix(self):
        runs = load_study(REPOSITORY / "studies" / "harmonic.toml", "reference").runs
        assert {(run.wall, run.words[1], run.words[2]) for run in runs} == {
            (f"walls/{wall}.py", str(period), str(amplitude)) for wall in ("solid", "symmetric", "asymmetric")
            for period in (0.06, 0.2, 0.33, 1.0) for amplitude in (0.01, 0.025, 0.05, 0.075, 0.1)}
        assert {(run.members, run.adaptive, run.varied) for run in runs} == {
            (5, True, ("--scatter", "0.001", "--seed"))}

    def test_ida_is_two_records_at_eight_scales_on_two_walls(self):
        study = load_study(REPOSITORY / "studies" / "ida.toml", "both")
        for solver, members in (("yade", 1), ("reference", 5)):
            runs = [run for run in study.runs if run.solver == solver]
            assert len({(run.wall, run.words[1], run.words[3]) for run in runs}) == len(runs) == 32
            assert {run.members for run in runs} == {members}


class TestTables:
    def test_a_row_names_the_point_the_record_and_the_peak_of_the_motion_as_applied(self, tmp_path):
        row = summary_row(make_history(tmp_path / "a_s1.h5"), point="a")
        assert (row["run"], row["point"], row["record"], row["pga_g"]) == ("a_s1", "a", None, row["amplitude_g"])

    def test_a_point_is_the_median_of_its_runs_with_their_range(self):
        runs = pd.DataFrame({"run": list("abcd"), "point": ["p", "p", "p", "q"], "solver": "reference", "wall": "w",
                             "status": "complete", "collapsed_at_s": [None, 1.0, None, 2.0], "seed": [1, 2, 3, 1],
                             "max_DI": [0.1, 0.5, 0.2, 0.7], "drift_class": ["a", "b", "b", "c"]})
        points = points_of(runs).set_index("point")
        assert_allclose(points.loc["p", ["max_DI", "max_DI_min", "max_DI_max"]].astype(float), [0.2, 0.1, 0.5])
        assert points.loc["p", "drift_class"] == "b" and list(points["members"]) == [3, 1]
        assert list(points["collapsed"]) == [1, 1]
        assert_allclose(points["collapsed_at_s"].astype(float), [np.nan, 2.0])
        assert "seed" not in points


# Three bricks' length and eight courses: it cracks under 0.5 g and stays whole under 0.01 g.
TINY = "from damage import Wall\n\n\ndef wall():\n    return Wall(name='tiny', length=0.45, height=0.6)\n"
POINTS = ('[[grid]]\nwall = "tiny.py"\noptions = { harmonic = [0.1, "{g}"], cycles = 2, rest = "{rest}" }\n'
          'members = 3\nvary = { g = [%s], rest = [0.5] }\n')


class Reference:
    """Batches of the reference solver in a folder, with the tiny wall."""

    def __init__(self, folder):
        (folder / "tiny.py").write_text(TINY)
        self.folder, self.out = folder, folder / "out"

    def command(self, study, *words):
        return [*BATCH, str(study), "--solver", "reference", "-j2", *words]

    def run(self, study, *words):
        return subprocess.run(self.command(study, "--out", self.out, *words), timeout=300, capture_output=True,
                              text=True, env={**os.environ, **BATCH_ENVIRONMENT})

    def start(self, study):
        return subprocess.Popen(self.command(study, "--out", self.out), stdout=subprocess.DEVNULL,
                                stderr=subprocess.DEVNULL,
                                env={**os.environ, **BATCH_ENVIRONMENT})

    def run_all(self, *words):
        """All studies of the folder, by the program that ./run_all.sh all starts."""
        return subprocess.run([sys.executable, REPOSITORY / "workflow/all_studies.py", self.folder, "-j2", "--out",
                               self.out, *words], timeout=300, capture_output=True, text=True, cwd=REPOSITORY,
                              env={**os.environ, "PYTHONPATH": str(REPOSITORY)})

    def members(self):
        return sorted(path for path in (self.out / "runs").glob("*_s?.h5"))

    def checksums(self):
        return {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in self.members()}

    def tables(self):
        return {path.name: path.read_bytes() for path in (self.out / "tables").glob("*.csv")}


@pytest.fixture
def reference(tmp_path):
    pytest.importorskip("snakemake")
    return Reference(tmp_path)


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """A batch that was left alone."""
    pytest.importorskip("snakemake")
    reference = Reference(tmp_path_factory.mktemp("whole"))
    reference.done = reference.run(write_study(reference.folder, POINTS % "0.5, 0.4, 0.01"))
    return reference


def test_what_was_made_of_other_inputs_is_removed_and_nothing_else(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(str(REPOSITORY / "workflow"))
    from stale import drop, find_stale, note

    wall = tmp_path / "w.py"
    names = ["a_reference_s1.h5", "a_reference_s12.part.h5", "a_reference_s2.differs.h5", "a_reference.members",
             "ab_reference_s1.h5", "a.b_yade.h5"]
    others = {"ab_reference_s1.h5", "a.b_yade.h5"}
    runs = tmp_path / "runs"
    for words, text, left, message in (((), TINY, others, "no note"), ((), f"{TINY}# words", set(names), None),
                                    (("--rest", "1"), TINY, others, "settings.rest_s 2.0 -> 1.0"),
                                    (("--rest", "1"), TINY.replace("0.6", "0.45"), others, "wall.height 0.6 -> 0.45")):
        wall.write_text(text)
        for folder in (runs, tmp_path / "tables"):
            folder.mkdir(exist_ok=True)
        for name in names:
            (runs / name).touch()
        (tmp_path / "tables" / "summary.csv").touch()
        run = StudyRun("a", str(wall), words, "reference", ("--strength-seed",), 2)
        stale = find_stale(SimpleNamespace(runs=[run]), tmp_path)
        warnings = drop(stale, tmp_path)
        assert {path.name for path in runs.iterdir() if path.is_file()} == left
        assert stale.points == ({run.id} if message else set()) == {one.id for one in stale.changed}
        assert [message in warning for warning in warnings] == [True] * bool(message)
        assert (tmp_path / "tables" / "summary.csv").exists() == (message is None)
        assert find_stale(SimpleNamespace(runs=[run]), tmp_path).points == stale.points  # until it is noted
        note(stale, tmp_path)
        assert not find_stale(SimpleNamespace(runs=[run]), tmp_path).changed


def test_notes_of_an_older_version_count_and_a_single_run_without_one_is_kept(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(str(REPOSITORY / "workflow"))
    from stale import drop, find_stale

    (tmp_path / "w.py").write_text(TINY)
    wall, runs = str(tmp_path / "w.py"), tmp_path / "runs"
    (runs / ".inputs").mkdir(parents=True)
    ensemble = StudyRun("a", wall, (), "reference", ("--strength-seed",), 2)
    single = StudyRun("b", wall, (), "yade")
    digest = hashlib.sha256(TINY.encode()).hexdigest()
    (runs / ".inputs" / ensemble.id).write_text(hashlib.sha256(json.dumps(
        [wall, (), ("--strength-seed",), [digest]]).encode()).hexdigest())  # as 0.2.0.dev0 wrote it
    for name in ("a_reference_s1.h5", "b_yade.h5"):
        (runs / name).touch()
    stale = find_stale(SimpleNamespace(runs=[ensemble, single]), tmp_path)
    assert not stale.changed and stale.unknown == [single]
    (warning,) = drop(stale, tmp_path)
    assert "b_yade" in warning and "kept without a comparison" in warning
    (tmp_path / "w.py").write_text(f"{TINY}# words")  # of which an old note does not tell that they change nothing
    assert find_stale(SimpleNamespace(runs=[ensemble]), tmp_path).points == {ensemble.id}


@pytest.mark.parametrize(("intact", "spread", "needed"), [(False, 0.01, 5), (False, 0.5, 10), (True, 0.0, 1)])
def test_an_ensemble_doubles_where_its_first_members_spread_and_ends_with_one_where_nothing_breaks(
        intact, spread, needed):
    run = StudyRun("a", "w.py", (), "reference", ("--seed",), 5, adaptive=True)
    records, counts = {}, []
    for number in range(1, 6):
        counts.append(runs_needed(run, records))
        row = {"max_DI": 0.1, "max_drift_ratio": 1e-3 * (1 + spread * (number == 3))}
        records[number] = {"intact": intact, "row": row}
    assert counts == [1] + 4 * [1 if intact else 5] and runs_needed(run, records) == needed
    assert runs_needed(replace(run, adaptive=False), {}) == 5


@pytest.mark.slow
class TestBatch:
    def test_members_differ_by_seed_and_an_intact_wall_has_but_one(self, whole):
        assert whole.done.returncode == 0, whole.done.stderr
        assert "study s: 3 of 3 points done" in whole.done.stdout
        histories = [read_history(path) for path in whole.members()]
        assert [path.stem for path in whole.members()] == [
            f"tiny_harmonic-0.1-{g}_cycles-2_rest-0.5_reference_s{k}" for g, k in
            ((0.01, 1), (0.4, 1), (0.4, 2), (0.4, 3), (0.5, 1), (0.5, 2), (0.5, 3))]
        assert [history.parameters["seed"] for history in histories] == [1, 1, 2, 3, 1, 2, 3]
        assert {history.parameters["scatter"] for history in histories} == {0.001}

    def test_tables_have_a_row_a_run_and_a_row_a_point(self, whole):
        tables = whole.out / "tables"
        summary = pd.read_csv(tables / "summary.csv")
        assert list(summary["members"]) == [3] * 6 + [1] and list(summary["pga_g"]) == [0.5] * 3 + [0.4] * 3 + [0.01]
        points = pd.read_csv(tables / "points.csv").set_index("amplitude_g")
        cracked = summary[summary["amplitude_g"] == 0.5]["max_DI"]
        assert_allclose(points.loc[0.5, ["max_DI", "max_DI_min", "max_DI_max"]].astype(float),
                        [cracked.median(), cracked.min(), cracked.max()])
        stored = read_study_table(tables / "study.h5", "runs")
        assert list(stored["run"]) == list(summary["run"]) and list(stored.columns) == list(summary.columns)
        assert_allclose(stored["max_DI"], summary["max_DI"], rtol=1e-8)
        assert len(list(tables.glob("*_s1_index.csv"))) == len(list(tables.glob("*_index.csv"))) == 3
        cycles = pd.read_csv(tables / "cycles.csv")  # the verdict takes medians of them
        assert list(cycles["run"].unique()) == list(summary["run"])
        alone = pd.read_csv(tables / f"{summary['run'][0]}_cycles.csv")
        pd.testing.assert_frame_equal(cycles[cycles["run"] == summary["run"][0]].drop(columns="run"), alone)

    def test_killed_while_a_history_grows_it_goes_on_and_ends_in_the_same_tables(self, reference, whole):
        study = write_study(reference.folder, POINTS % "0.5, 0.4, 0.01")
        batch = reference.start(study)
        until = time.monotonic() + 300
        old = growing = set()
        while len(reference.members()) < 3 or not growing - old:  # one just begun still grows when it is killed
            assert batch.poll() is None and time.monotonic() < until, "it ended before it could be killed"
            time.sleep(0.005)
            old, growing = growing, set((reference.out / "runs").glob("*.part.h5"))
        kill_tree(batch.pid)
        batch.wait()
        before = reference.checksums()
        times = {path: path.stat().st_mtime_ns for path in reference.members()}
        assert 3 <= len(before) < 7
        assert list((reference.out / "runs").glob("*.part.h5")), "no history was being written"
        done = reference.run(study)
        assert done.returncode == 0, done.stderr
        after = reference.checksums()
        assert len(after) == 7 and before == {name: after[name] for name in before}
        assert all(path.stat().st_mtime_ns == time_ns for path, time_ns in times.items())
        assert len(whole.tables()) == 15 and reference.tables() == whole.tables()

        more = write_study(reference.folder, (POINTS % "0.5").replace("members = 3", "members = 4"))
        assert reference.run(more).returncode == 0
        assert len(reference.members()) == 8 and after == {name: reference.checksums()[name] for name in after}
        assert list(pd.read_csv(reference.out / "tables" / "summary.csv")["members"]) == [4] * 4

    @pytest.mark.long
    def test_a_failing_member_stops_no_other_point_and_is_named(self, reference):
        # A step above the stable one is refused when the member starts.
        bad = '[[runs]]\nid = "bad"\nwall = "tiny.py"\noptions = { rest = 0, dt = 0.1 }\nmembers = 2\n'
        done = reference.run(write_study(reference.folder, POINTS % "0.01" + bad))
        assert done.returncode == 1
        log = reference.out / "logs" / "shard_0000.log"
        assert f"failed: bad_reference; see {log} (error: bad_reference_s1: --dt 0.1 s is above" in done.stderr
        assert list(pd.read_csv(reference.out / "tables" / "summary.csv")["amplitude_g"]) == [0.01]

    def test_all_studies_one_after_the_other_then_figures_and_verdict(self, reference):
        points = {"good": POINTS % "0.01" + 'solvers = ["reference"]\n',
                  "other": POINTS % "0.01" + 'solvers = ["yade"]\n',
                  "bad": '[[runs]]\nwall = "tiny.py"\noptions = { harmonic = [0.1, 0.5], dt = 0.1, rest = 0 }\n'}
        for name, text in points.items():
            (reference.folder / f"{name}.toml").write_text(f'name = "{name}"\npictures = "none"\n{text}')
        done = reference.run_all("--solver", "reference")
        assert done.returncode == 1, done.stderr
        assert "study bad: FAILED, status 1" in done.stderr and "study good" not in done.stderr
        assert "passed over" in done.stdout and "expected --solver yade" in done.stdout
        assert (reference.out / "good/tables/points.csv").is_file() and not (reference.out / "other").exists()
        assert (reference.out / "figures/fig06_motions.png").is_file()
        assert "P1" in done.stdout
