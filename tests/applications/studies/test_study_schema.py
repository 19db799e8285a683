"""The JSON Schema of study files: it is that of the definition, right studies pass it and wrong
ones do not."""

import json
import tomllib

import pytest
from conftest import REPOSITORY, refused_with, written

from damage.applications.studies.definition import load_study
from damage.applications.studies.schema import study_schema

jsonschema = pytest.importorskip("jsonschema")
SHIPPED = sorted((REPOSITORY / "studies").glob("*.toml"))
NAME, WALL = 'name = "n"\n', 'wall = "walls/solid.py"\n'
RUN = NAME + "[[runs]]\n" + WALL
GRID = NAME + "[[grid]]\n" + WALL + 'options = { rest = "{r}" }\n'


@pytest.fixture(scope="module")
def validator():
    jsonschema.Draft7Validator.check_schema(study_schema())
    return jsonschema.Draft7Validator(study_schema())


def test_the_shipped_schema_is_the_generated_one():
    """python3 -m damage study-schema > studies/study.schema.json."""
    assert json.loads((REPOSITORY / "studies/study.schema.json").read_text()) == study_schema()


@pytest.mark.parametrize("path", SHIPPED, ids=lambda path: path.stem)
def test_every_shipped_study_passes_and_names_it(validator, path):
    text = path.read_text()
    assert text.startswith("#:schema ./study.schema.json\n")
    validator.validate(tomllib.loads(text))


@pytest.mark.parametrize(
    "text",
    [
        RUN,
        RUN + 'options = ["--harmonic", 0.2, "0.05"]\n',
        RUN + 'options = { lintel = 2, harmonic = ["0.2", 0.05] }\n',
        RUN + "members = 3\nscatter = 0.01\n",
        RUN + 'id = "a-1"\nsolvers = ["yade"]\n',
        NAME + "[[grid]]\n" + WALL + 'members = "{m}"\noptions = { rest = "{r}" }\n'
        "vary = { m = [2], r = { from = 1, to = 2 } }\n",
        RUN
        + 'options = { record = ["a.csv", "damage/data/zeerijp_20180108/BGAR_HGE_acc_m_s2.csv"],'
        " free-vibration = false }\n",
    ],
)
def test_what_the_software_takes_passes(validator, tmp_path, text):
    validator.validate(tomllib.loads(text))
    assert load_study(written(tmp_path / "s.toml", text), "both", REPOSITORY).of_both


BAD = [
    ("", "name = None"),
    (NAME, "no runs"),
    (RUN.replace('"n"', '"a/b"'), "name = 'a/b'"),
    (
        NAME + "run = []",
        "unknown key 'run'; expected conclusion, grid, intensity, name, pictures, runs, states",
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
    (GRID, "grid 1: vary = None"),
    (GRID + "vary = { r = [] }", "vary holds r = []"),
    (GRID + "vary = { r = [1] }\nmembres = 3", "grid 1: unknown key 'membres'"),
]
"""Studies that are wrong by their form, and what is said."""


@pytest.mark.parametrize(("text", "message"), BAD, ids=str)
def test_a_wrong_form_is_refused_by_the_software_and_by_the_schema(
    validator, tmp_path, text, message
):
    path = written(tmp_path / "s.toml", text)
    assert message in refused_with("", load_study, path, "reference", REPOSITORY)
    assert not validator.is_valid(tomllib.loads(text))
