"""Inputs of a study's points: whatever changes one of them is noticed before a study continues."""

import json
import shutil

import pytest
from conftest import REPOSITORY

from damage.exposure import lives
from damage.motion.formats import shipped_records
from damage.studies.definition import load_study
from damage.studies.inputs import as_note, differences, inputs_of

WALL = """from damage import Wall
def wall():
    return Wall("w", 0.9, 0.45)
"""
STUDY = """name = "s"
[[runs]]
wall = "w.py"
options = {{ {options} }}
solvers = ["reference"]
{more}
"""
RECORD = "time_s,acc_m_s2\n" + "".join(f"{k / 100:.2f},{k % 3}\n" for k in range(50))


def study(folder, options, more=""):
    (folder / "w.py").write_text(WALL)
    path = folder / "study.toml"
    path.write_text(STUDY.format(options=options, more=more))
    return path


def noted(path):
    """The inputs of a study's first run as JSON keeps them."""
    return json.loads(as_note(now(path)))


def now(path):
    [run] = load_study(path, "reference", REPOSITORY).runs
    return inputs_of(run, REPOSITORY)


def changed(path, before):
    return differences(before, now(path))


def test_nothing_that_changed_is_nothing(tmp_path):
    path = study(tmp_path, 'harmonic = [0.2, 0.1]')
    assert changed(path, noted(path)) == []


@pytest.mark.parametrize("name, text, said", [
    ("w.py", WALL.replace("0.45", "0.6"), "wall.height"), ("a.csv", RECORD.replace("0.10,1", "0.10,2"), "sha256"),
    ("events.csv", "record,scale\na.csv,3\n", "sequence"), ("study.toml", STUDY.format(
        options='sequence = "events.csv", rest = 0.7', more=""), "rest_s")])
def test_a_changed_file_of_a_sequence_is_noticed(tmp_path, name, text, said):
    (tmp_path / "a.csv").write_text(RECORD)
    (tmp_path / "events.csv").write_text("record,scale\na.csv,2\n")
    path = study(tmp_path, 'sequence = "events.csv", rest = 0.5')
    before = noted(path)
    (tmp_path / name).write_text(text)
    assert any(said in line for line in changed(path, before))


def test_a_history_that_is_continued_counts_by_its_content(tmp_path):
    """Beside the study, wherever the batch runs."""
    (tmp_path / "x.h5").write_bytes(b"one")
    path = study(tmp_path, 'harmonic = [0.2, 0.1], continue = "x.h5"')
    before = noted(path)
    assert changed(path, before) == []
    (tmp_path / "x.h5").write_bytes(b"two")
    assert [line.partition(" ")[0] for line in changed(path, before)] == ["continued"]
    older = {name: value for name, value in before.items() if name not in ("continued", "drawn_from")}
    assert [line.partition(" ")[0] for line in changed(path, older)] == ["continued"]  # a note from before there were


LIVES = 'lives = 3'
ADDRESS = "latitude = 53.36786\nlongitude = 6.71359\nabove_mm_s = 20\n"


def test_a_record_that_only_later_lives_use_is_noticed(tmp_path, monkeypatch):
    """The first life of a point is parsed; a record that the others use counts, too."""
    (tmp_path / "here.toml").write_text(ADDRESS)
    path = study(tmp_path, 'address = "here.toml", rest = 0', LIVES)
    before, draws = noted(path), lives.read_address(tmp_path / "here.toml")
    assert changed(path, before) == []
    first = set(draws.life(1)["record"])
    other = next(name for name in draws.components["record"] if name not in first)
    other_file = tmp_path / shipped_records()[other].name
    shutil.copy(shipped_records()[other], other_file)
    with other_file.open("a") as file:
        file.write("\n")
    monkeypatch.setattr(lives, "shipped_records", lambda: shipped_records() | {other: other_file})
    assert [line.partition(" ")[0] for line in changed(path, before)] == ["drawn_from"]
