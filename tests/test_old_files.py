"""What version 0.1 wrote stays good: a history, a study's file, a study that goes on.

tests/old/study_0.1.tar.gz is a study of two points in the reference solver with the folder that version 0.1 made of it,
machine's paths and logs taken out.
"""

import json
import subprocess

import pandas as pd
import pytest
from conftest import REPOSITORY, written

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
    """The folder of the study, unpacked, and its wall where it was then."""
    subprocess.run(["tar", "xzf", REPOSITORY / "tests/old/study_0.1.tar.gz", "-C", tmp_path], check=True)
    now = (REPOSITORY / "walls/variants/small.py").read_text()
    then = now.replace("walls/variants/small.py", "benchmarks/small_wall.py").replace("parents[2]", "parents[1]")
    (tmp_path / "benchmarks").mkdir()
    written(tmp_path / "benchmarks/small_wall.py", then)
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
