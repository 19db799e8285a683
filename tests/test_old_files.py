"""What version 0.1 wrote stays good: a history, a study's file, a study that goes on.

tests/old/study_0.1.tar.gz is a study of two points in the reference solver with the folder that version 0.1 made of it,
machine's paths and logs taken out.
"""

import hashlib
import json
import os
import subprocess
import sys

import pandas as pd
import pytest
from conftest import REPOSITORY, run_command, written

import damage
from damage.history.info import UNSEALED, check
from damage.history.schema import each
from damage.index import THRESHOLD
from damage.measure.columns import MADE_BY, read_table
from damage.measure.summary import summarise
from damage.measure.tables import index_table, summary_row
from damage.provenance import UNKNOWN
from damage.studies.definition import load_study


@pytest.fixture
def old(tmp_path):
    """The folder of the study, unpacked."""
    subprocess.run(["tar", "xzf", REPOSITORY / "tests/old/study_0.1.tar.gz", "-C", tmp_path], check=True)
    return tmp_path


@pytest.mark.parametrize("run", ["single_reference", "drawn_reference_s1"])
def test_a_history_says_what_it_said_then(run, old):
    history = damage.read_history(old / f"out/runs/{run}.h5")
    assert history.complete and check(history.path)["worth"] == UNSEALED
    then = json.loads((old / f"out/tables/rows/{run}.json").read_text())
    # Slip was accumulated, and cracks counted from 0.1 mm.
    assert then.pop("slip") == "displacement"
    visible = summarise(history, psi_from=THRESHOLD)
    now = summary_row(history, run=run, point=then["point"]) | {name: visible[name] for name in (
        "max_psi", "residual_psi", "psi_class", "max_crack_width_mm", "residual_crack_width_mm")}
    assert (now["slip"], now["max_accumulated_DI"]) == ("accumulated", now["max_DI"])
    assert any("no offsets" in warning for warning in visible["warnings"])
    for name, value in then.items():
        assert now[name] == (pytest.approx(value, rel=1e-12) if isinstance(value, float) else value), name
    assert {now[name] for name in each(MADE_BY) if name != "measures_digest"} == {UNKNOWN}
    index = pd.read_csv(old / f"out/tables/{run}_index.csv")
    found = index_table(history).reset_index(drop=True)
    pd.testing.assert_frame_equal(found[list(index)], index, rtol=1e-8, check_dtype=False)
    assert set(found["slip"]) == {"accumulated"} and found["accumulated_DI"].equals(found["DI"])
    assert summarise(history)["max"]["DI"] > 0.1


def test_a_studys_file_and_its_tables_are_read(old):
    study = load_study(old / "study.toml", "reference", REPOSITORY)
    assert [run.id for run in study.runs] == ["single_reference", "drawn_reference"]
    runs = read_table(old / "out/tables/summary.csv")
    assert runs["max_accumulated_DI"].equals(runs["max_DI"])
    assert set(runs["slip"]) == {"accumulated"} and set(runs["psi_from_mm"]) == {0.1}


def note_of_then(wall_text):
    """What version 0.1 noted of the second point of the study: a digest of its words and of its wall's file."""
    words = ["--harmonic", "0.06", "0.6", "--cycles", "1", "--rest", "0", "--strength-cov", "0.3"]
    parts = ["walls/variants/small.py", words, ["--strength-seed"], [hashlib.sha256(wall_text.encode()).hexdigest()]]
    return hashlib.sha256(json.dumps(parts).encode()).hexdigest()


@pytest.mark.slow
def test_a_study_goes_on_with_what_is_there_and_says_so(old):
    before = {path.name: (path.read_bytes(), path.stat().st_mtime_ns) for path in (old / "out/runs").glob("*.h5")}
    # The wall's file names its lintel since, which was the only kind then: the note is made as if the file had always.
    note, wall = old / "out/runs/.inputs/drawn_reference", (REPOSITORY / "walls/variants/small.py").read_text()
    assert note.read_text() == note_of_then(wall.replace('        lintel="courses",\n', ""))
    note.write_text(note_of_then(wall))
    study = written(old / "study.toml", (old / "study.toml").read_text().replace("samples = 1", "samples = 2"))
    done = run_command(sys.executable, "-m", "damage", "study", study, "--out", old / "out", "--solver", "reference",
                       "-j2", cwd=old, env=os.environ | {"PYTHONPATH": str(REPOSITORY)}, status=0)
    assert "warning: 2 runs were made by another version of the model (one before 0.2) and are kept" in done.stderr
    after = {path.name: (path.read_bytes(), path.stat().st_mtime_ns) for path in (old / "out/runs").glob("*.h5")}
    assert len(after) == 3 and all(after[name] == state for name, state in before.items())
    made = pd.read_csv(old / "out/tables/summary.csv").set_index("run")["model_digest"]
    assert (made.fillna(UNKNOWN) == UNKNOWN).sum() == 2  # empty where the row of then was kept
