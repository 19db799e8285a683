"""What is there of a study and is not of today: other inputs, another model, other measures,
changed records, and the folders of earlier versions.  One rule finds all of it
(`damage.applications.studies.outdated`)."""

import json
import shutil

import pytest
from conftest import REPOSITORY, refused_with, written
from small_history import make_history

from damage.applications.groningen import options
from damage.applications.groningen.exposure import lives
from damage.applications.studies.definition import load_study
from damage.applications.studies.inputs import as_json, changes, differences, inputs_of
from damage.applications.studies.outdated import CODE, Results
from damage.applications.studies.plan import print_plan
from damage.applications.studies.records import NAME, line_of, read_records, record_of
from damage.applications.studies.tables import summary_of
from damage.applications.studies.tasks import Task
from damage.motion.formats import shipped_records
from damage.provenance import model_digest

WALL = "from damage import Wall\n\n\ndef wall():\n    return Wall('w', 0.9, 0.45)\n"
RECORD = "# start 2018-01-08T14:00:52Z\ntime_s,acc_m_s2\n" + "".join(
    f"{k / 100:.2f},{k % 3}\n" for k in range(50)
)
ADDRESS = "latitude = 53.36786\nlongitude = 6.71359\nabove_mm_s = 20\n"
SETTLEMENT = "x_m,uz_m\n0,0\n0.9,-0.001\n"
CRACKS = "crack,point,x_m,z_m,width_mm\na,1,0.0,0.15,0.1\na,2,0.4,0.15,0.1\n"


class Folder:
    """A study of one point, and its results: a record, and the history of its first run."""

    def __init__(self, folder, options="harmonic = [0.2, 0.1]", ensemble="", **files):
        self.folder = folder
        self.out = folder / "out"
        for name, text in {"w_py": WALL, **files}.items():
            self.write(name.replace("_", "."), text)
        self.study(options, ensemble)

    def write(self, name, text):
        (self.folder / name).write_text(text)

    def study(self, options, ensemble=""):
        self.options = options
        self.ensemble = ensemble
        self.write(
            "study.toml",
            'name = "s"\n[[runs]]\nid = "p"\nwall = "w.py"\nsolvers = ["reference"]\n'
            f"options = {{ {options} }}\n{ensemble}\n",
        )

    def load(self):
        return load_study(self.folder / "study.toml", "reference", REPOSITORY)

    def make(self, broken=(0,), **row):
        """Results as a batch of today leaves them."""
        (self.out / "runs").mkdir(parents=True)
        (self.out / "tables").mkdir()
        (run,) = self.load().runs
        history = make_history(self.out / "runs" / f"{run.name(1)}.h5", broken=broken)
        for name in (f"{run.name(1)}_index.csv", "summary.csv"):
            (self.out / "tables" / name).touch()
        record = record_of(history, run.name(1), "p")
        record["row"] |= {"model_digest": model_digest(CODE["reference"])} | row
        results = Results(self.out)
        verdict = results.judge([run])
        [(key, _)] = verdict.inputs.values()
        results.records.runs[run.name(1)] = {"inputs": key} | json.loads(json.dumps(record))
        results.write(verdict)
        assert self.judge().changed == {}

    def judge(self):
        return Results(self.out).judge(self.load().runs)

    def settle(self, remake=False):
        """Take away what is not of today; returns the warnings."""
        results = Results(self.out)
        verdict = results.judge(self.load().runs)
        said = results.bring_up_to_date(verdict, remake)
        results.write(verdict)
        return said


RECORDED = {"options": 'record = "a.csv"', "a_csv": RECORD}
SEQUENCE = {"options": 'sequence = "e.csv"', "a_csv": RECORD, "e_csv": "record,scale\na.csv,2\n"}
# What a study, a life and a sequence are made from, and what each alteration is called.
ALTERED = {
    "height of the wall": ({}, {"w.py": WALL.replace("0.45", "0.6")}, "wall.height 0.45 -> 0.6"),
    "amplitude": (
        {},
        {"options": "harmonic = [0.2, 0.2]"},
        "settings.loading.amplitude_g 0.1 -> 0.2",
    ),
    "kind of ensemble": (
        {"options": "harmonic = [0.2, 0.1], strength-cov = 0.3", "ensemble": "samples = 2"},
        {"options": "harmonic = [0.2, 0.1], strength-cov = 0.2", "ensemble": "samples = 2"},
        "settings.model.strength_cov 0.3 -> 0.2",
    ),
    "record": (
        RECORDED,
        {"a.csv": RECORD.replace("0.10,1", "0.10,2")},
        "sha256",
    ),
    "scale": (
        RECORDED,
        {"options": 'record = "a.csv", scale = 2'},
        "scale",
    ),
    "vertical record": (
        RECORDED | {"b_csv": RECORD},
        {"options": 'record = "a.csv", vertical = "b.csv"'},
        "vertical",
    ),
    "record of a sequence": (
        SEQUENCE,
        {"a.csv": RECORD.replace("0.10,1", "0.10,2")},
        "sha256",
    ),
    "scale of a sequence": (
        SEQUENCE,
        {"e.csv": "record,scale\na.csv,3\n"},
        "sequence",
    ),
    "settlement": (
        {"options": 'settle = "d.csv", rest = 1', "d_csv": SETTLEMENT},
        {"d.csv": SETTLEMENT.replace("-0.001", "-0.002")},
        "settlement",
    ),
    "cracks": (
        {"options": 'harmonic = [0.2, 0.1], cracked = "c.csv"', "c_csv": CRACKS},
        {"c.csv": CRACKS.replace("0.1\n", "0.2\n", 1)},
        "joints_without_bond",
    ),
    "history that is continued": (
        {"options": 'harmonic = [0.2, 0.1], continue = "x.h5"', "x_h5": "one"},
        {"x.h5": "two"},
        "continued",
    ),
    "seed of an address": (
        {"options": 'address = "h.toml"', "ensemble": "lives = 3", "h_toml": ADDRESS},
        {"h.toml": f"{ADDRESS}seed = 7\n"},
        "settings.loading.record",
    ),
}


class TestInputs:
    def test_an_option_that_was_removed_counts_where_it_was_not_at_its_default(self, tmp_path):
        there = Folder(tmp_path)
        (run,) = there.load().runs
        inputs = inputs_of(run, REPOSITORY)
        note = as_json(inputs)
        model = note["settings"]["model"]
        model["brick_cells"] = 0
        assert differences(note, inputs) == []
        model["brick_cells"] = 4
        assert differences(note, inputs) == ["settings.model.brick_cells 4, which was removed"]
        model["other"] = 1
        assert "settings.model.other of a later version" in differences(note, inputs)

    @pytest.mark.parametrize("name", ALTERED)
    def test_an_altered_input_makes_a_point_again_and_is_named(self, name, tmp_path):
        first, then, said = ALTERED[name]
        there = Folder(tmp_path, **first)
        there.make()
        (run,) = there.load().runs
        note = {run.id: as_json(inputs_of(run, REPOSITORY))}
        task = Task(there.out, run, 1, True)
        assert changes(task, note) == [] and changes(task, {}) == []
        if "options" in then:
            there.study(then["options"], then.get("ensemble", ""))
        for path, text in then.items():
            if path not in ("options", "ensemble"):
                there.write(path, text)
        # the process that reads a file which changes meanwhile refuses the run (`test_batch`)
        assert "options" in then or any(said in word for word in changes(task, note))
        (run,) = there.load().runs
        (words,) = there.judge().changed.values()
        assert any(said in word for word in words), words
        (warning,) = there.settle()
        assert warning.startswith(
            f"1 points were made from other inputs and are made again: {run.id} ({words[0]}"
        )
        assert not list((there.out / "runs").iterdir()) and not list(
            (there.out / "tables").iterdir()
        )
        assert there.settle() == [] and read_records(there.out).runs == {}  # said once

    def test_a_record_that_only_later_lives_use_is_noticed(self, tmp_path, monkeypatch):
        """The first life of a point is parsed; a record that the others use counts, too."""
        there = Folder(tmp_path, 'address = "h.toml", rest = 0', "lives = 3", h_toml=ADDRESS)
        there.make()
        draws = lives.read_address(tmp_path / "h.toml")
        first = set(draws.life(1)["record"])
        other = next(name for name in draws.components["record"] if name not in first)
        other_file = written(
            tmp_path / shipped_records()[other].name, f"{shipped_records()[other].read_text()}\n"
        )
        for module in (lives, options):
            monkeypatch.setattr(
                module, "shipped_records", lambda: shipped_records() | {other: other_file}
            )
        (words,) = there.judge().changed.values()
        assert [word.partition(" ")[0] for word in words] == ["drawn_from"]


def record(name, folder, **row):
    """What a small run leaves."""
    made = json.loads(
        json.dumps(
            record_of(make_history(folder / "one.h5", broken=[0], overwrite=True), name, "p")
        )
    )
    return made | {"row": made["row"] | row}


class TestRecords:
    def test_a_record_is_read_as_it_was_written_and_one_that_a_kill_tore_is_none(self, tmp_path):
        one = record("a", tmp_path)
        assert one["row"]["point"] == "p" and not one["intact"]
        path = written(tmp_path / NAME, text := line_of(one | {"run": "b"}) + line_of(one))
        assert read_records(tmp_path).runs == {
            name: {"inputs": None} | one | {"run": name} for name in ("b", "a")
        }
        path.write_text(text[:-20])
        torn = read_records(tmp_path)
        assert list(torn.runs) == ["b"] and not torn.faults
        path.write_text(f"{text[:-20]}\n{line_of(one)}")
        assert list(read_records(tmp_path).runs) == ["b", "a"]

    @pytest.mark.parametrize(
        ("old", "new", "what"),
        [
            ('"max_DI": 0.', '"max_DI": 7.', "its checksum is wrong"),
            ('"intact": false', '"intact": true', "its checksum is wrong"),
            ('"run": "b"', '"run": "c"', "its checksum is wrong"),
            ('"sha256": ', '"was": ', "its checksum is wrong"),
            ('{"run"', '{{"run"', "it is no JSON"),
            ('"row": {', '"other": {', "its checksum is wrong"),
        ],
    )
    def test_a_changed_line_is_found_and_counts_as_not_made(self, old, new, what, tmp_path):
        lines = [
            line_of(record("a", tmp_path)),
            line_of(record("b", tmp_path)).replace(old, new, 1),
        ]
        assert new in lines[1]
        (tmp_path / NAME).write_text("".join(lines))
        results = Results(tmp_path)
        name = "c" if new.endswith('"c"') else "b"
        said = [
            f"{tmp_path / NAME} line 2: the record of {name} was changed since it was written"
            f" ({what}): it counts as not made"
        ]
        assert list(results.records.runs) == ["a"] and results.records.faults == said
        verdict = results.judge([])
        assert results.bring_up_to_date(verdict) == said
        results.write(verdict)
        # reported once
        assert (tmp_path / NAME).read_text() == line_of(record("a", tmp_path) | {"inputs": None})

    def test_slices_add_to_the_records_and_a_batch_makes_one_file_of_them(self, tmp_path):
        there = Folder(tmp_path, "harmonic = [0.2, 0.1], strength-cov = 0.3", "samples = 2")
        there.make()
        (run,) = there.load().runs
        key = read_records(there.out).points[run.id]
        part = there.out / "records-1-of-2.jsonl"
        other = record(run.name(2), tmp_path, model_digest=model_digest(CODE["reference"]))
        part.write_text(line_of(other | {"inputs": "of a job that began with others"}))
        assert list(there.judge().changed) == [run]
        part.write_text(line_of(other | {"inputs": key}))
        assert Results(there.out).records.names_of(run) == [run.name(1), run.name(2)]
        assert there.settle() == [] and not part.exists()
        assert list(read_records(there.out).runs) == [run.name(1), run.name(2)]


class TestPlan:
    """What a study with --dry-run tells; nothing is made."""

    def test_the_dry_run_lists_all_runs_and_makes_nothing(self, tmp_path, output_of):
        options = 'harmonic = [0.1, "{amplitude}"], cycles = 2, rest = 0.3'
        Folder(tmp_path, options, "members = 5\nvary = { amplitude = [0.01, 0.02] }")
        text = (study := tmp_path / "study.toml").read_text()
        written(study, text.replace('[[runs]]\nid = "p"', "[[grid]]"))
        before = sorted(path.name for path in tmp_path.iterdir())
        words = "--dry-run", "--solver", "reference", "--out", tmp_path / "out"
        said = output_of("study", study, *words)
        assert "points: 2, 0 there; runs to make: up to 20" in said
        for amplitude in (0.01, 0.02):
            (line,) = (line for line in said.splitlines() if f"harmonic-0.1-{amplitude}" in line)
            assert "5 to 10 runs to make" in line
        assert sorted(path.name for path in tmp_path.iterdir()) == before

    def test_the_dry_run_says_which_lintels_an_option_replaces(self, tmp_path, capsys):
        there = Folder(tmp_path, 'harmonic = [0.2, 0.1], lintel = "none"')
        door = "'door', 1.8, 0.75, [damage.Opening(0.6, 0.6, 0.45)]"
        there.write("w.py", f"import damage\n\n\ndef wall():\n    return damage.Wall({door})\n")
        print_plan(there.load(), there.out)
        said = "--lintel none in place of the lintels of wall door: opening 1 concrete"
        assert capsys.readouterr().err.count(said) == 1

    def test_what_is_there_is_not_to_be_made(self, tmp_path, capsys):
        """But with --remake what another version of the model made."""
        there = Folder(tmp_path, ensemble="members = 5")
        there.make(broken=(), model_digest="of before")
        print_plan(there.load(), there.out)
        printed = capsys.readouterr().out
        assert "there, 1 runs" in printed and "points: 1, 1 there; runs to make: 0" in printed
        print_plan(there.load(), there.out, remake=True)
        assert "points: 1, 0 there; runs to make: up to 10" in capsys.readouterr().out


class TestVersions:
    def test_measures_of_another_version_are_worked_out_of_histories_or_refused(self, tmp_path):
        there = Folder(tmp_path)
        there.make(measures_digest="of before")
        (run,) = there.load().runs
        # the history gives others
        assert there.settle() == [] and read_records(there.out).runs == {}
        shutil.rmtree(there.out)
        there.make(measures_digest="of before")
        (there.out / "runs" / f"{run.name(1)}.h5").unlink()
        message = (
            f"the index or measures of 1 runs are .*: {run.name(1)}; expected one definition .*"
            " give --remake"
        )
        refused_with(message, there.settle)
        records = read_records(there.out)
        refused_with("run the study again", summary_of, there.load(), there.out, records)
        assert there.settle(remake=True) == [] and read_records(there.out).runs == {}

    def test_another_model_is_named_and_its_runs_are_kept_or_made_again(self, tmp_path):
        there = Folder(tmp_path)
        there.make(model_digest="of before")
        (run,) = there.load().runs
        (kept,) = there.settle()
        assert (
            kept == "1 runs were made by another version of the model (reference of before) and are"
            " kept; "
            f"--remake makes them again: {run.name(1)}"
        )
        assert list(read_records(there.out).runs) == [run.name(1)]
        (again,) = there.settle(remake=True)
        assert "are made again" in again and not list((there.out / "runs").iterdir())
