"""Study files, tables, and whole batches with a YADE made up of a script (one with YADE itself)."""

import json
import os
import re
import shutil
import signal
import subprocess
import sys
import tomllib
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from conftest import (
    BATCH,
    BATCH_ENVIRONMENT,
    REPOSITORY,
    refused_with,
    run_command,
    running,
    script_file,
    wait_until,
    wall_file,
    written,
)
from numpy.testing import assert_allclose
from small_history import make_history
from test_batch import study_here

from damage.applications.studies import batch
from damage.applications.studies.definition import load_study, option_table, run_name
from damage.applications.studies.read import describe_table
from damage.applications.studies.records import NAME as RECORDS
from damage.applications.studies.schema import study_schema
from damage.draw import run
from damage.measure.tables import (
    joints_table,
    summary_row,
    summary_table,
)
from damage.run.options import words_of

HARMONIC = "options = { harmonic = [0.2, 0.05] }\n"
SHIPPED = sorted((REPOSITORY / "studies").glob("*.toml"))
WALL = 'wall = "walls/symmetric.py"\n'
NAME = 'name = "s"\n'
BGAR = "damage/data/zeerijp_20180108/BGAR_HGE_acc_m_s2.csv"
RUN = f"{NAME}[[runs]]\n{WALL}"
GRID = f"{NAME}[[grid]]\n"
GRID_OF_R = f'{GRID}{WALL}options = {{ rest = "{{r}}" }}\n'


def write_study(folder, text, name="study.toml"):
    return written(folder / name, text)


class TestLoading:
    @pytest.mark.parametrize("path", SHIPPED, ids=lambda path: path.stem)
    def test_shipped_studies_are_named_like_their_files_and_fit_the_schema(self, validator, path):
        study = load_study(path, "both")
        assert study.name == path.stem and study.title
        assert all(not Path(run.wall).is_absolute() for run in study.runs)
        text = path.read_text()
        assert text.startswith("#:schema ./study.schema.json\n")
        validator.validate(tomllib.loads(text))

    def test_a_table_and_a_list_of_words_mean_the_same(self):
        table = {"harmonic": [0.2, 0.05], "cycles": 2, "lintel": "none", "free-vibration": False}
        words = ["--harmonic", 0.2, "0.05", "--cycles=2", "--lintel", "none"]
        assert words_of(option_table(table)) == words_of(option_table(words))
        assert option_table(["--free-vibration"]) == {"free-vibration": True}

    def test_long_names_are_cut_and_stay_different(self):
        drifts = [k / 1000 for k in range(1, 60)]
        one, other = (
            run_name("walls/a.py", {"cyclic": values}) for values in (drifts, [*drifts, 0.06])
        )
        assert one != other and max(len(one), len(other)) <= 108

    @pytest.mark.parametrize(
        ("text", "message"),
        [
            ('name = "s', "is no TOML"),
            (
                f'{RUN}samples = 2\nsolvers = ["yade"]\n{HARMONIC}',
                "run 1: solvers = ['yade'] with samples or lives",
            ),
            (RUN.replace("symmetric", "no"), "run 1: no file walls/no.py"),
            (f'{RUN}options = {{ record = "no.csv" }}', "run 1: no file no.csv"),
            (f"{RUN}options = {{ scale = 2 }}", "--scale belongs to --record"),
            (f"{RUN}{HARMONIC}[[runs]]\n{WALL}{HARMONIC}", "runs 1 and 2 are both"),
            (f"{GRID}{WALL}{HARMONIC}vary = {{ a = [1] }}", "vary names 'a', which nothing uses"),
            (f'{GRID}wall = "{{b}}"\noptions = {{ rest = "{{a}}" }}\nvary = {{ a = [1] }}', "'b'"),
            (f"{RUN}{HARMONIC}samples = 2", "walls that do not differ"),
            (f"{RUN}options = {{ seed = 3 }}\nmembers = 2", "--seed is set by members"),
            (f'{RUN}{HARMONIC}solvers = ["yade"]', "expected --solver yade"),
            (f'{RUN}options = {{ record = ["no.csv", "nor.csv"] }}', "no file no.csv or nor.csv"),
        ],
        ids=str,
    )
    def test_a_bad_study_is_refused_in_one_line(self, tmp_path, text, message):
        assert message in refused_with("", load_study, write_study(tmp_path, text), "reference")


@pytest.fixture(scope="module")
def validator():
    jsonschema = pytest.importorskip("jsonschema")
    jsonschema.Draft7Validator.check_schema(study_schema())
    return jsonschema.Draft7Validator(study_schema())


class TestSchema:
    def test_the_shipped_schema_is_the_generated_one(self):
        """python3 -m damage study-schema > studies/study.schema.json."""
        shipped = json.loads((REPOSITORY / "studies/study.schema.json").read_text())
        assert shipped == study_schema()

    @pytest.mark.parametrize(
        "text",
        [
            RUN,
            RUN + 'options = ["--harmonic", 0.2, "0.05"]\n',
            RUN + 'options = { lintel = 2, harmonic = ["0.2", 0.05] }\n',
            RUN + "members = 3\nscatter = 0.01\n",
            RUN + 'id = "a-1"\nsolvers = ["yade"]\n',
            GRID + WALL + 'members = "{m}"\noptions = { rest = "{r}" }\n'
            "vary = { m = [2], r = { from = 1, to = 2 } }\n",
            f'{RUN}options = {{ record = ["a.csv", "{BGAR}"], free-vibration = false }}\n',
        ],
    )
    def test_what_the_software_takes_passes(self, validator, tmp_path, text):
        validator.validate(tomllib.loads(text))
        assert load_study(written(tmp_path / "s.toml", text), "both", REPOSITORY).of_both

    @pytest.mark.parametrize(
        ("text", "message"),
        [
            ("", "name = None"),
            (NAME, "no runs"),
            (RUN.replace('"s"', '"a/b"'), "name = 'a/b'"),
            (
                NAME + "run = []",
                "unknown key 'run'; expected conclusion, grid, intensity, name, pictures, runs",
            ),
            (NAME + 'states = "max_psi > 2"', "expected a list of texts"),
            ('pictures = "some"\n' + RUN, "pictures = 'some'"),
            (NAME + "grid = 3", "grid is no list of tables"),
            (NAME + "[[runs]]\nmembers = 3", "run 1: wall = None"),
            (RUN + "option = 1", "run 1: unknown key 'option'"),
            (RUN + 'id = "a b"', "run 1: run id 'a b_yade'"),
            (RUN + 'solvers = ["udec"]', "solvers = ['udec']"),
            (RUN + "options = { harmonics = [0.2, 1] }", "no option harmonics: expected one of"),
            (RUN + "options = { harmonic = [0.2] }", "expected 2 arguments"),
            (RUN + 'options = { harmonic = ["a", "b"] }', "invalid float value"),
            (RUN + 'options = { top = "arch" }', "arch"),
            (RUN + "options = { cells = 1.5 }", "1.5"),
            (RUN + 'options = { out = "a.h5" }', "--out is set by the batch"),
            (RUN + "members = 0", "members = 0"),
            (RUN + "samples = 2\nmembers = 2", "expected one kind"),
            (RUN + "scatter = 0.01", "scatter"),
            (GRID_OF_R, "grid 1: vary = None"),
            (GRID_OF_R + "vary = { r = [] }", "vary holds r = []"),
            (GRID_OF_R + "vary = { r = [1] }\nmembres = 3", "grid 1: unknown key 'membres'"),
        ],
        ids=str,
    )
    def test_a_wrong_form_is_refused_by_the_software_and_by_the_schema(
        self, validator, tmp_path, text, message
    ):
        path = write_study(tmp_path, text)
        assert message in refused_with("", load_study, path, "reference", REPOSITORY)
        assert not validator.is_valid(tomllib.loads(text))


class TestTables:
    @pytest.fixture
    def history(self, tmp_path):
        """One joint opens by 0.2 mm at once and stays so, another slips by -0.3 mm and half
        back."""
        slip = np.concatenate([np.full(10, -3e-4), np.full(11, -1.5e-4)])
        return make_history(tmp_path / "one.h5", opening={2: 2e-4}, slip={5: slip}, drift=1e-4)

    def test_a_row_a_run_with_the_figures_of_the_summary(self, history):
        row = summary_row(history)
        assert (
            row["run"] == "one"
            and row["motion"] == "harmonic_0.2s_0.05g"
            and row["status"] == "complete"
        )
        assert_allclose(row["max_slip_mm"], 0.3, rtol=1e-6)
        length = history.joints["length_m"]
        assert_allclose(row["max_DI_open"], length[2] / length.sum())
        assert_allclose(row["max_DI_drift"], 1e-4 / 0.02)
        assert row["residual_DI"] == history.index()["DI"].iloc[-1]

    def test_an_unfinished_run_has_the_same_columns_and_no_residual(self, history, tmp_path):
        make_history(tmp_path / "two.h5", status="interrupted")
        table = summary_table([tmp_path / "one.h5", tmp_path / "two.h5"])
        assert list(table["run"]) == ["one", "two"]
        assert table["residual_DI"].isna().tolist() == [False, True]
        assert "two" in describe_table(table) and "interrupted" in describe_table(table)

    def test_joints_end_with_their_last_and_largest_values(self, history):
        table = joints_table(history)
        assert len(table) == len(history.joints) and list(table.columns[:2]) == ["joint", "kind"]
        single = {"rtol": 1e-6}  # the file's precision
        assert_allclose(table["final_slip_m"][5], -1.5e-4, **single)
        assert_allclose(table["max_abs_slip_m"][5], 3e-4, **single)
        assert_allclose(
            table.loc[2, ["final_opening_m", "max_opening_m"]].astype(float), 2e-4, **single
        )
        assert table["broken"].sum() == 2


FAKE_YADE = """
import shutil, sys, time
launched, words = sys.argv[1:3], sys.argv[3:]
assert launched == ["-L", "without_servers"] and words[:2] == ["-n", "-j1"], sys.argv
assert words[-2:] == ["--overwrite", "--no-pictures"], words
with open({calls!r}, "a") as calls:
    calls.write(" ".join(words[3:-4]) + "\\n")
rest = float(words[words.index("--rest") + 1])
status = "unfinished" if rest in (3, 4) else "complete"
shutil.copyfile({folder!r} + f"/{{status}}.h5", words[words.index("--out") + 1])
print("wall w  motion   t =   1.00 of 2.00 s  DI = 0.012, time left about 0:07", flush=True)
time.sleep(60 if rest == 4 else 0)
sys.exit(3 if rest == 2 else 0)
"""


class Batches:
    """Runs batches of studies in a folder, with a yade that copies small histories, made once.

    The length of the rest tells it what to do: 2 fails, 3 leaves an unfinished history, 4 takes a
    minute, anything else is done at once.
    """

    def __init__(self, folder):
        self.folder = folder
        self.calls = folder / "calls"
        self.out = folder / "out of {it}"
        (folder / "bin").mkdir()
        wall_file(folder / "small.py", "Wall('small', 0.9, 0.45)")  # of the histories
        for status in ("complete", "unfinished"):
            make_history(folder / "bin" / f"{status}.h5", status=status)
        (folder / "yade.py").write_text(
            FAKE_YADE.format(calls=str(self.calls), folder=str(folder / "bin"))
        )
        script_file(folder / "bin" / "yade", f'exec {sys.executable} "{folder / "yade.py"}" "$@"')

    def study(self, pictures="none", **rests):  # pictures take longer than all else
        runs = [
            f'[[runs]]\nid = "{name}"\nwall = "small.py"\noptions = {{ rest = {rest} }}\n'
            for name, rest in rests.items()
        ]
        return write_study(self.folder, f'name = "s"\npictures = "{pictures}"\n' + "".join(runs))

    def words(self, study):
        self.calls.write_text("")
        return [str(study), "--solver", "yade", "--out", str(self.out), "-j2"]

    def run(self, study):
        """Run a batch to its end in this process; returns what is left of it and the rests that
        yade was run with."""
        done = study_here(*self.words(study))
        return done, sorted(line.split()[-1] for line in self.calls.read_text().splitlines())

    def start(self, study):
        """Start a batch and wait until yade runs."""
        process = subprocess.Popen(
            [*BATCH, *self.words(study)],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            env={**os.environ, **BATCH_ENVIRONMENT},
        )
        wait_until(self.calls.read_text)
        return process


@pytest.fixture
def batches(tmp_path, monkeypatch):
    folder = tmp_path / "a {b} \N{BRICK}"  # JSON escapes letters of other planes
    folder.mkdir()
    monkeypatch.setenv("PATH", f"{folder / 'bin'}{os.pathsep}{os.environ['PATH']}")
    return Batches(folder)


@pytest.mark.slow
class TestBatch:
    def test_failing_runs_stop_no_other_and_nothing_is_made_twice(self, batches, monkeypatch):
        """Then with the parameters that failed corrected, which touches no other run."""
        monkeypatch.setattr(run, "PICTURES", {"drift": run.PICTURES["drift"]})
        monkeypatch.setattr(batch, "WATCH_S", 0.0)
        done, calls = batches.run(batches.study("all", good=1, fails=2, unfinished=3))
        assert (done.returncode, calls) == (1, ["1", "2", "3"])
        assert " % simulated; time left not known yet" in done.stdout
        logs = batches.out / "logs"
        assert f"failed: fails_yade; see {logs / 'fails_yade.log'}" in done.stderr
        assert f"failed: unfinished_yade; see {logs / 'unfinished_yade.log'}" in done.stderr
        assert "the history is marked unfinished" in done.stderr and "good" not in done.stderr
        assert list(pd.read_csv(batches.out / "tables" / "summary.csv")["run"]) == ["good_yade"]
        pictures = list((batches.out / "pictures" / "good_yade").iterdir())
        assert {path.suffix for path in pictures} == {".png", ".pdf"}
        before = [path.stat().st_mtime_ns for path in pictures]
        done, calls = batches.run(batches.study("all", good=1, fails=1.5, unfinished=1.6))
        assert (done.returncode, calls) == (0, ["1.5", "1.6"]), done.stderr
        assert "study s: 3 of 3 runs done" in done.stdout
        assert len(pd.read_csv(batches.out / "tables" / "summary.csv")) == 3
        assert [path.stat().st_mtime_ns for path in pictures] == before

    def test_an_interrupt_ends_all_and_the_next_call_goes_on(self, batches, error_of):
        process = batches.start(batches.study(a=4, b=1))
        records = batches.out / RECORDS
        wait_until(lambda: '"run": "b_yade"' in records.read_text())
        process.send_signal(signal.SIGTERM)
        _, printed = process.communicate(timeout=300)
        assert process.returncode == 130 and "continues from here" in printed
        assert running(batches.folder) == []
        again = re.search(r"^  python3 (-m damage study .*)$", printed, re.MULTILINE)[1]
        for words in (["fragility", batches.out, "--out", "x"], ["report", batches.out]):
            said = error_of(*words)
            assert "1 of 2 points are done" in said and said.endswith(f"{again}\n")
        done, calls = batches.run(batches.study(a=1.2, b=1))
        assert (done.returncode, calls) == (0, ["1.2"]), done.stderr


@pytest.mark.slow
@pytest.mark.yade
@pytest.mark.skipif(shutil.which("yade") is None, reason="YADE is not installed")
def test_a_study_with_both_solvers(tmp_path):
    wall_file(tmp_path / "t{in}y.py", "Wall('tiny', 0.45, 0.15)")
    study = write_study(
        tmp_path,
        'name = "tiny"\npictures = "none"\n[[runs]]\nwall = "t{in}y.py"\n'
        "options = { harmonic = [0.05, 0.05], cycles = 1, rest = 0.05 }\n",
    )
    run_command(
        REPOSITORY / "run_all.sh",
        study,
        "--solver",
        "both",
        "--out",
        tmp_path / "out",
        timeout=900,
        env={**os.environ, "PYTHON": sys.executable},
        status=0,
    )
    summary = pd.read_csv(tmp_path / "out" / "tables" / "summary.csv")
    name = "t-in-y_harmonic-0.05-0.05_cycles-1_rest-0.05"
    assert list(summary["run"]) == [f"{name}_yade", f"{name}_reference"]
    assert list(summary["solver"]) == ["yade", "reference"] and set(summary["status"]) == {
        "complete"
    }
    drifts = summary["max_drift_ratio"]
    # Elastic: the two sample at slightly different instants, 2 ms apart.
    assert drifts[1] == pytest.approx(drifts[0], rel=0.02)
